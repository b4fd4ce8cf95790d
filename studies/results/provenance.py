"""Where a number came from: versions, BLAS, machine, commit, memory."""

from __future__ import annotations

import ctypes
import datetime
import functools
import gc
import hashlib
import os
import platform
import subprocess
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import threadpoolctl
from mpi4py import MPI

ROOT = Path(__file__).resolve().parents[2]


@functools.cache
def commit() -> str:
    """Short hash of the checked-out commit, with ``+changes`` if the tree differs from it."""
    try:
        run = functools.partial(subprocess.run, cwd=ROOT, capture_output=True, text=True, check=True, timeout=20)
        name = run(["git", "rev-parse", "--short=12", "HEAD"]).stdout.strip()
        changed = run(["git", "status", "--porcelain", "--untracked-files=no"]).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return "unknown"
    return name + ("+changes" if changed else "")


@functools.cache
def versions() -> dict[str, str]:
    """Versions of what computes and draws."""
    from petsc4py import PETSc

    from solvers.compat import dolfinx_version

    found = {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "dolfinx": dolfinx_version(),
        "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
        "mpi": f"{MPI.get_vendor()[0]} {'.'.join(map(str, MPI.get_vendor()[1]))}",
    }
    for name in ("fenics-ufl", "scipy", "mpi4py", "pyvista", "matplotlib", "pydantic"):
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def _solver_blas() -> dict[str, Any] | None:
    """What is loaded as the solver's BLAS; the wheels of numpy, scipy and basix bring one each for themselves."""
    loaded = (library for library in threadpoolctl.threadpool_info() if library["user_api"] == "blas")
    return next((one for one in loaded if not Path(one["filepath"]).parent.name.endswith(".libs")), None)


@functools.cache
def blas() -> str:
    """The solver's BLAS, its version and threads; it decides the factorisation's speed."""
    if found := _solver_blas():
        name, version, kind = found["internal_api"], found.get("version"), found.get("architecture")
        return f"{name} {version} ({kind}), {found['num_threads']} threads"
    return "reference BLAS (slow: install libopenblas0-pthread)"


def blas_threads() -> int:
    """Threads of the solver's BLAS."""
    found = _solver_blas()
    return int(found["num_threads"]) if found else 1


def machine() -> str:
    """Cores and memory."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return f"{platform.machine()}, {os.cpu_count()} cores, {memory:.0f} GiB"


def now() -> str:
    """Date and time, UTC."""
    return datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC")


def stamp(comm: MPI.Comm) -> dict[str, Any]:
    """Provenance fields of a summary."""
    return {
        "versions": versions(),
        "blas": blas(),
        "ranks": comm.size,
        "threads": blas_threads(),
        "commit": commit(),
        "when": now(),
    }


@functools.cache
def code_hash() -> str:
    """Hash of the sources that decide a finite element run's numbers, so that results of other code are not reused.

    Of ``analytical`` they know the material laws only, which a test of the layout keeps.
    """
    digest = hashlib.sha256()
    folders = ("meshes", "solvers", "analytical/laws")
    files = sorted(p for folder in folders for p in (ROOT / folder).rglob("*.py"))
    studies = (
        "models/axisymmetric.py",
        "models/body.py",
        "models/body_problem.py",
        "models/build.py",
        "models/contact.py",
        "models/finer/location.py",
        "models/finer/prolongation.py",
        "models/finer/start.py",
        "models/full3d.py",
        "models/gaps.py",
        "models/modes.py",
        "models/run_log.py",
        "scene/bellows.py",
        "scene/bellows_geometry.py",
        "scene/bodies.py",
        "scene/materials.py",
        "scene/meshes.py",
    )
    for path in [*files, *(ROOT / "studies" / name for name in studies)]:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def reset_peak_memory() -> None:
    """Give freed memory back and start the process's peak resident memory anew (Linux with glibc; else no effect)."""
    gc.collect()
    try:
        ctypes.CDLL("libc.so.6").malloc_trim(0)
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    except (OSError, AttributeError):
        return


def peak_memory_mb(comm: MPI.Comm) -> float:
    """Peak resident memory of all ranks together since the last reset, MB."""
    peak = 0.0
    for line in Path("/proc/self/status").read_text(encoding="ascii").splitlines():
        if line.startswith("VmHWM"):
            peak = float(line.split()[1]) / 1024.0
    return float(comm.allreduce(peak, op=MPI.SUM))
