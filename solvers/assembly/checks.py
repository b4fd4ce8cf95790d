"""Checks of cells: that those of a mesh do not overlap, and how far those of a state are deformed."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import ufl
from mpi4py import MPI

from analytical.laws.isotropic import IsotropicLaw
from analytical.laws.stability import is_stable, principal_stretches, stable_stretches
from solvers import compat
from solvers.assembly.unknowns import Unknowns
from solvers.compat.known_forms import KnownForms
from solvers.discrete.domain import Domain, FloatArray
from solvers.discrete.elements import QUADRATURE_DEGREE
from solvers.discrete.kinematics import Kinematics
from solvers.energy.forms import invariants
from solvers.energy.materials import Part, limited_cells
from solvers.errors import SolverError
from solvers.state import Timer

# The cells fill what their surface encloses up to this share: the quadrature is exact for both on quadratic cells.
SAME_SIZE = 1e-9


def refuse_overlaps(domain: Domain, known: KnownForms) -> None:
    """Refuse cells that fold over or overlap: by Gauss' theorem cells fill what their surface encloses.

    Parameters
    ----------
    domain, known
        The mesh, and the forms of the problem on it.

    Raises
    ------
    SolverError
        With both sizes.
    """
    mesh, degree = domain.mesh, QUADRATURE_DEGREE[domain.cell_name]
    dimension = mesh.geometry.dim
    x, normal = ufl.SpatialCoordinate(mesh), ufl.FacetNormal(mesh)
    # the sizes of cells are never negative, so what is folded over is counted twice
    one = known.constant(1.0)
    forms = (
        known.compile("filled", lambda: one * ufl.dx(domain=mesh, degree=degree)),
        known.compile("enclosed", lambda: ufl.inner(x, normal) / dimension * ufl.ds(domain=mesh, degree=degree)),
    )
    filled, enclosed = (compat.assemble_scalar(form, domain.comm) for form in forms)
    if not abs(filled - enclosed) <= SAME_SIZE * abs(enclosed):
        unit = f"mm^{dimension}"
        raise SolverError(
            f"cells of the mesh fold over or overlap: they fill {filled:.9g} {unit}, their surface encloses "
            f"{enclosed:.9g}: mesh it anew, or look for a flipped cell or one with a corner beyond its neighbours"
        )


class Deformation:
    """How far the cells are deformed at their quadrature points in the current state.

    Parameters
    ----------
    unknowns, kin
        Of the problem.
    degree
        Of the quadrature.
    timer
        Takes the seconds.
    parts
        Soft materials of the cells.
    laws
        Their laws by the cells' numbers.
    """

    def __init__(
        self,
        unknowns: Unknowns,
        kin: Kinematics,
        degree: int,
        timer: Timer,
        parts: Sequence[Part],
        laws: Mapping[int, IsotropicLaw],
    ) -> None:
        self._domain, self._timer, self._kin, self._state = unknowns.domain, timer, kin, unknowns.state
        self._points = compat.quadrature_points(unknowns.domain.cell_name, degree)
        topology = unknowns.domain.mesh.topology
        self._cells = np.arange(topology.index_map(topology.dim).size_local, dtype=np.int32)
        numbers = unknowns.domain.cell_tags.values[: len(self._cells)]
        # all cells, where no law has a limit or all have
        self._limited = limited_cells(parts, numbers) if 1 < len(parts) else np.ones(len(numbers), dtype=bool)
        self._soft = np.repeat(np.isin(numbers, list(laws)), len(self._points))
        self._softening = [
            (law, np.repeat(numbers == number, len(self._points)))
            for number, law in laws.items()
            if any(np.isfinite(limit) for limit in stable_stretches(law).values())
        ]

    @functools.cached_property
    def _values(self) -> Any:
        """The invariants, compiled; not every problem's are looked at."""
        k = invariants(self._kin.gradient(ufl.split(self._state)[0]))
        return compat.compile_expression(ufl.as_vector([k.j, k.i1, k.i2]), self._points)

    def _now(self) -> FloatArray:
        """Det F and isochoric I1 and I2 at this rank's quadrature points, shape (points, 3)."""
        return compat.evaluate(self._values, self._domain.mesh, self._cells).reshape(-1, 3)

    def extremes(self) -> tuple[float, float, float]:
        """Smallest det F, and largest isochoric I1 and I2 where a law has a limit, at quadrature points (NaN-safe)."""
        with self._timer("checks"):
            values, comm = self._now(), self._domain.comm
            j, i1, i2 = np.inf, 0.0, 0.0
            if len(values):
                j = float(np.min(values[:, 0])) if np.isfinite(values).all() else -np.inf
                of_cells = values.reshape(len(self._cells), -1, 3)[self._limited]
                i1, i2 = (float(of_cells[..., k].max(initial=0.0)) for k in (1, 2))
            return comm.allreduce(j, op=MPI.MIN), comm.allreduce(i1, op=MPI.MAX), comm.allreduce(i2, op=MPI.MAX)

    def largest_stretch(self) -> float:
        """Largest principal stretch of soft cells; at a re-entrant corner it grows as the mesh is refined."""
        with self._timer("checks"):
            values = self._now()[self._soft]
            isochoric, _, _ = principal_stretches(values[:, 1], values[:, 2])
            largest = float((np.cbrt(values[:, 0]) * isochoric).max(initial=0.0))
            return self._domain.comm.allreduce(largest, op=MPI.MAX)

    def softened(self) -> str:
        """The least stretch at which the law of soft cells is no longer stable, and where; empty if nowhere."""
        if not self._softening:
            return ""
        with self._timer("checks"):
            values, stretch = self._now(), np.full(len(self._soft), np.inf)
            for law, points in self._softening:
                isochoric = principal_stretches(values[points, 1], values[points, 2])
                largest = np.cbrt(values[points, 0]) * isochoric[0]
                stretch[points] = np.where(is_stable(law, *isochoric), np.inf, largest)
            least, place = self._least(stretch)
            return "" if least == np.inf else f"stretch {least:.4g} at {place}"

    def worst_cell(self) -> str:
        """The smallest det F, and where its quadrature point is in the unloaded body."""
        values = self._now()[:, 0]
        det_f, place = self._least(np.where(np.isfinite(values), values, -np.inf))
        return f"det F = {det_f:.3g} at {place}"

    def _least(self, values: FloatArray) -> tuple[float, str]:
        """The least of a value per quadrature point of all ranks, and where its point is in the unloaded body."""
        domain = self._domain
        here = compat.compile_expression(ufl.SpatialCoordinate(domain.mesh), self._points)
        found = []
        if len(values):
            least = int(np.argmin(values))
            places = compat.evaluate(here, domain.mesh, self._cells).reshape(-1, domain.mesh.geometry.dim)
            found = [(float(values[least]), places[least], bool(self._soft[least]))]
        value, at, soft = min((f for part in domain.comm.allgather(found) for f in part), key=lambda f: f[0])
        names = ("r", "z") if domain.axisymmetric else ("x", "y", "z")
        place = ", ".join(f"{name} = {value:.2f}" for name, value in zip(names, at, strict=True))
        return value, f"{place} mm, {'soft' if soft else 'stiff'} region"
