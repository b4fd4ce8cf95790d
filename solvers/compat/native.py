"""C source of this project's own: compiled once, by the compiler, with the options and into the cache of the forms."""

from __future__ import annotations

import ctypes
import functools
import hashlib
import importlib.machinery
import importlib.util
import os
import platform
import tempfile
from pathlib import Path
from typing import Any

import cffi
import ffcx.codegeneration
from petsc4py import PETSc

from solvers.compat import JIT, stack

HEADERS = Path(ffcx.codegeneration.get_include_path())
# Kernels take one argument more since 2025: what a caller's own kernel may need.
MACROS = ["-DCUSTOM_DATA"] if "custom_data" in (HEADERS / "ufcx.h").read_text(encoding="utf-8") else []


@functools.cache
def library(source: Path) -> Any:
    """Functions of a C file that are declared in its header, with the ``ffi`` that knows their types.

    What is in the cache has a name of everything that decides it. It is made in a folder of its own and then moved, so
    that processes that come at once, ranks or runs, each find it whole: they need no lock.

    Parameters
    ----------
    source
        May include FFCx' ``ufcx.h``, and its own header, beside it, which cffi reads too.

    Returns
    -------
    module
        With ``lib`` and ``ffi``.
    """
    options = stack.jit_settings(JIT)
    arguments = [*options["cffi_extra_compile_args"], *MACROS]
    header, text = (file.read_text(encoding="utf-8") for file in (source.with_suffix(".h"), source))
    suffix = importlib.machinery.EXTENSION_SUFFIXES[0]
    decides = (header, text, arguments, cffi.__version__, suffix, ffcx.__version__, _processor())
    name = f"{source.stem}_{hashlib.sha256(repr(decides).encode()).hexdigest()[:24]}"
    path = Path(options["cache_dir"]) / f"{name}{suffix}"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        include = [str(HEADERS), str(source.parent)]
        builder = cffi.FFI()
        builder.cdef(header)
        builder.set_source(name, text, include_dirs=include, extra_compile_args=arguments)
        with tempfile.TemporaryDirectory(dir=path.parent) as folder:
            os.replace(builder.compile(tmpdir=folder), path)
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _processor() -> str:
    """What -march=native depends on: machines of a cluster may share the cache and not their instructions."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            return next(line for line in lines if line.startswith(("flags", "Features")))
    except (OSError, StopIteration):
        return platform.processor()


@functools.cache
def _petsc() -> ctypes.CDLL:
    """PETSc's own functions that petsc4py leaves out."""
    return ctypes.CDLL(PETSc.__file__)


class Values:
    """Values of a sparse matrix on one process where PETSc has them, for writing; a context manager.

    Entering gives their address.
    """

    def __init__(self, matrix: PETSc.Mat) -> None:
        self._matrix, self._values = ctypes.c_void_p(matrix.handle), ctypes.c_void_p()

    def __enter__(self) -> int:
        self._call("MatSeqAIJGetArray")
        return int(self._values.value or 0)

    def __exit__(self, *of: object) -> None:
        self._call("MatSeqAIJRestoreArray")

    def _call(self, name: str) -> None:
        code = getattr(_petsc(), name)(self._matrix, ctypes.byref(self._values))
        if code:
            raise PETSc.Error(code)
