"""Compiled forms found again without being built in UFL, which takes a tenth of a small scene's time.

dolfinx finds a compiled form by the signature of its UFL expression, which has to be built for that, from the law's
derivatives on. What is built follows from this project's source, the versions of the stack and what the problem is made
of. So a file beside the compiled forms, named by a hash of these, says of each form which module it is in and which of
the problem's spaces, functions and constants it takes; it is written when a form is first built. On a version of
dolfinx that makes no form of such parts (`solvers.compat.dolfinx_09`) every form is built.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import basix
import dolfinx
import ffcx
import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import ArrayLike

from solvers.compat import JIT, compile_form
from solvers.compat import stack as _of_version

stack: Any = _of_version
_ROOT = Path(__file__).resolve().parents[2]
# Folders whose files decide how a problem's forms are written.
_WRITES_FORMS = ("solvers", "analytical/laws")
_KINDS = ("spaces", "functions", "constants")


class KnownForms:
    """The forms of a problem, and the spaces, functions and constants they are made of.

    Parameters
    ----------
    mesh
        Their mesh.
    tags
        Tags of cells and facets that measures may have, by UFL's names of the integrals: ``cell``, ``exterior_facet``.
    decides
        All that decides how the forms are written, but for the source and the parts below: its ``repr`` is taken. None
        if that cannot be said, as of a law of the user's own: then every form is written.
    """

    def __init__(self, mesh: Any, tags: Mapping[str, Any], decides: object) -> None:
        self.mesh, self._tags = mesh, tags
        self._decides = None if decides is None else repr(decides)
        self._parts: list[Any] = []

    def more(self, decides: object) -> KnownForms:
        """Further forms of the same parts and others."""
        other = KnownForms(self.mesh, self._tags, None if self._decides is None else (self._decides, decides))
        other._parts = list(self._parts)
        return other

    # ---- what forms are made of: in an order that follows from what decides them -----------------------------

    def part(self, part: Any) -> Any:
        """Take a space or a function that forms will have."""
        self._parts.append(part)
        return part

    def constant(self, value: ArrayLike) -> Any:
        """A UFL constant of this value."""
        number = np.asarray(value, dtype=np.float64)
        return self.part(fem.Constant(self.mesh, number if number.ndim else float(number)))

    def function(self, space: Any) -> Any:
        """A function in a space."""
        return self.part(fem.Function(space))

    # ---- forms -----------------------------------------------------------------------------------------------

    def compile(self, name: str, build: Callable[[], Any]) -> Any:
        """The compiled form of a name; every rank calls.

        Parameters
        ----------
        name
            One for each form that is written otherwise.
        build
            Makes it in UFL, where it is not found.
        """
        if self._decides is None or not stack.TAKES_PARTS:
            return compile_form(build())
        record = self._records.get(name)
        fits = record is not None and self._fits(record)
        module = stack.module_of(record["module"], JIT) if record is not None and fits else None
        # to make a form may be collective: not before all have it
        if self.mesh.comm.allreduce(module is not None, op=MPI.LAND):
            assert record is not None
            return self._made_of(module, record)
        form = build()
        compiled = compile_form(form)
        record = stack.parts_of(form, JIT, self._place, self._tags)
        if self.mesh.comm.rank == 0:
            self._write(name, record)
        return compiled

    def _place(self, part: Any) -> tuple[int, str]:
        """Where a part is among those taken, and what it is like."""
        number = next((i for i, other in enumerate(self._parts) if other is part), None)
        assert number is not None, f"{part} is in a form and was not taken"
        return number, _like(part)

    def _fits(self, record: Mapping[str, Any]) -> bool:
        """True if the parts that a record names are there and of the same kinds."""
        places = [place for kind in _KINDS for place in record[kind]]
        return all(i < len(self._parts) and _like(self._parts[i]) == like for i, like in places)

    def _made_of(self, module: Any, record: Mapping[str, Any]) -> Any:
        """The form of a module; every rank calls."""
        parts = {kind: [self._parts[i] for i, _ in record[kind]] for kind in _KINDS}
        return stack.form_of_parts(module, parts, {kind: self._tags[kind] for kind in record["tags"]}, self.mesh)

    @functools.cached_property
    def _file(self) -> Path:
        cell = self.mesh.ufl_domain().ufl_coordinate_element()
        decides = (_versions(), _SOURCE, stack.compiler_settings(JIT), repr(cell), self._decides)
        return _folder() / f"forms_{hashlib.sha256(repr(decides).encode()).hexdigest()[:32]}.json"

    @functools.cached_property
    def _records(self) -> dict[str, Any]:
        return self._read()

    def _read(self) -> dict[str, Any]:
        try:
            return dict(json.loads(self._file.read_text(encoding="utf-8")))
        except (OSError, ValueError):
            return {}

    def _write(self, name: str, record: Mapping[str, Any]) -> None:
        """Add a record, unless the source was edited since this process began.

        Of processes that come at once the last one's records stay; what is not kept is written again next time.
        """
        if _hash_of_source() != _SOURCE:
            return
        text = json.dumps({**self._read(), name: record})
        with contextlib.suppress(OSError), tempfile.TemporaryDirectory(dir=self._file.parent) as folder:
            whole = Path(folder) / self._file.name
            whole.write_text(text, encoding="utf-8")
            os.replace(whole, self._file)


def _folder() -> Path:
    """Where compiled forms are."""
    return Path(stack.jit_settings(JIT)["cache_dir"])


def _like(part: Any) -> str:
    """What kind of part this is, as far as a form can depend on it."""
    if isinstance(part, ufl.Constant):
        return f"constant {part.ufl_shape}"
    kind = "function" if isinstance(part, ufl.Coefficient) else "space"
    return f"{kind} {part.ufl_element()!r}"


@functools.cache
def _versions() -> tuple[str, ...]:
    return tuple(str(of.__version__) for of in (dolfinx, ufl, ffcx, basix, np))


def _hash_of_source() -> str:
    """Of the files that write forms."""
    hashed = hashlib.sha256()
    for folder in _WRITES_FORMS:
        for file in sorted((_ROOT / folder).rglob("*.py")):
            hashed.update(f"{file.relative_to(_ROOT)}\n".encode() + file.read_bytes())
    return hashed.hexdigest()


# Of what this process runs: taken before anything can be edited under it.
_SOURCE = _hash_of_source()
