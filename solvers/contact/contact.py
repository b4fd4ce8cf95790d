"""Frictionless contact on meridians: of surface lines with themselves, with each other and with rigid sections.

At quadrature points of a line, with reference weights w and the gap g along the normal of what faces it, the energy

    E(u, U) = sum_q w_q phi(g_q),   contact pressure t = -phi'(g) = 0                        for g >= d
                                                                  = k (d - g)^2 / (4 d)      for |g| < d
                                                                  = -k g                     for g <= -d

is a penalty whose pressure has a continuous slope: Newton's method sees no kink, and a state is its displacements
alone, so that nothing has to be remembered between steps. Its second derivative is exact (solvers.contact.curve,
solvers.contact.obstacles) and symmetric. Lines that touch are points to each other, each with half the weight.
Pressures are per undeformed area. Rigid bodies of the problem enter by their axial motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse
from petsc4py import PETSc
from scipy.spatial import cKDTree

from solvers.assembly.unknowns import Unknowns
from solvers.contact.curve import Curve
from solvers.contact.pairs import Against, ContactSettings, Facing, Line, LinePoints, PairReport, Stop
from solvers.discrete.domain import FloatArray, IntArray
from solvers.errors import Cause, SolverError, StepFailed

# Two surfaces face each other when the angle between their normals is more than 120 degrees.
_OPPOSED = -0.5
# Where contact fades out it presses the less, so that the depth at the largest pressure grows; up to so many limits.
FADED = 5.0


@dataclass
class _Part:
    """Gaps of one pair with the derivatives by the unknowns ``dofs``, -1 where there is none."""

    what: str
    gap: FloatArray
    weight: FloatArray
    grade: FloatArray  # below one where contact fades out
    dofs: IntArray
    gradient: FloatArray
    bend: FloatArray


class Contact:
    """Contact of a problem's meridian: a `solvers.assembly.term.Term` of its equilibrium.

    Parameters
    ----------
    unknowns
        Of the problem: on a meridian, on one rank, with quadratic displacements.
    points
        Undeformed positions of the caller's nodes, shape (n, 2), mm.
    lines, pairs
        What may touch what.
    settings
        The penalty.
    boundary
        All edges of the mesh's boundary, corner, mid-edge node, corner, shape (b, 3): what they enclose is solid.

    Raises
    ------
    SolverError
        On several ranks, in 3D or with linear displacements.
    """

    def __init__(
        self,
        unknowns: Unknowns,
        points: FloatArray,
        lines: Sequence[Line],
        pairs: Sequence[Against | Facing | Stop],
        settings: ContactSettings,
        boundary: IntArray,
    ) -> None:
        ranks, dimension, degree = unknowns.comm.size, unknowns.dimension, unknowns.element.displacement_degree
        if ranks > 1 or dimension != 2 or degree != 2:
            raise SolverError(
                f"contact on {ranks} ranks in {dimension} dimensions with displacements of degree {degree}: it is "
                "there on meridians, on one rank, of degree 2"
            )
        self._unknowns, self.settings, self.lines, self.pairs = unknowns, settings, tuple(lines), tuple(pairs)
        local = np.empty(unknowns.domain.nodes, dtype=np.int64)
        local[unknowns.domain.input_node] = np.arange(len(unknowns.domain.input_node))
        fixed = np.append(unknowns.constrained_owned, unknowns.held_bodies)
        self._size = len(fixed)
        self._free = ~fixed
        self._rest = [points[line.nodes] for line in self.lines]
        self._dofs = [unknowns.u_dofs[local[line.nodes]] for line in self.lines]
        self._points = [LinePoints(*of) for of in zip(self.lines, self._rest, self._dofs, strict=True)]
        self._curves = [Curve(rest, line.side) for rest, line in zip(self._rest, self.lines, strict=True)]
        on_boundary, where = np.unique(boundary, return_inverse=True)
        self._boundary = np.vstack([where.reshape(-1, 3)[:, :2], where.reshape(-1, 3)[:, 1:]])
        self._boundary_rest, self._boundary_dofs = points[on_boundary], unknowns.u_dofs[local[on_boundary]]
        self._known = scipy.sparse.csr_matrix((self._size, self._size), dtype=np.int8)
        self._seen: tuple[FloatArray, list[_Part]] = (np.empty(0), [])

    # ---- gaps ------------------------------------------------------------------------------------------

    def _now(self) -> list[_Part]:
        """Gaps of all pairs within reach at the problem's state; those of the last state asked for are kept."""
        of = self._unknowns
        values = np.append(of.state.x.array[: of.owned], of.bodies_mm.ravel())
        if not np.array_equal(values, self._seen[0]):
            lines = [rest + values[dofs] for rest, dofs in zip(self._rest, self._dofs, strict=True)]
            parts = []
            for pair in self.pairs:
                if isinstance(pair, Against):
                    parts.append(self._against(pair, lines[pair.line], values))
                elif isinstance(pair, Facing):
                    parts.append(self._facing(pair, lines))
                else:
                    parts.append(self._stop(pair, values))
            self._seen = (values, parts)
        return self._seen[1]

    def _body(self, number: int) -> int:
        """Unknown of a body's axial motion; on a meridian it has no other."""
        return self._unknowns.owned + number

    def _against(self, pair: Against, line: FloatArray, values: FloatArray) -> _Part:
        on = self._points[pair.line]
        x = on.now(line)
        if pair.body is not None:
            x = x - np.array([0.0, values[self._body(pair.body)]])
        gap, out, bend = pair.obstacle.gaps(x)
        grade = pair.grade[on.facets].ravel() if len(pair.grade) else np.ones(len(x))
        near = np.flatnonzero((gap < self.settings.reach_mm) & (grade > 0.0))
        moves = np.zeros((len(near), 7, 2))  # six of the facet's nodes, one of the body
        shape = on.shape[near]
        moves[:, 0:6:2, 0] = moves[:, 1:6:2, 1] = shape
        moves[:, 6, 1] = 0.0 if pair.body is None else -1.0
        dofs = np.column_stack([on.dofs[near], np.full(len(near), -1 if pair.body is None else self._body(pair.body))])
        gradient = np.einsum("qki,qi->qk", moves, out[near])
        second = np.einsum("qki,qij,qlj->qkl", moves, bend[near], moves)
        return _Part(pair.what, gap[near], (on.weight * grade)[near], grade[near], dofs, gradient, second)

    def _facing(self, pair: Facing, lines: Sequence[FloatArray]) -> _Part:
        on, curve = self._points[pair.points], self._curves[pair.curve]
        line, target = self.lines[pair.curve], lines[pair.curve]
        x = on.now(lines[pair.points])
        normal = on.normals(lines[pair.points], self.lines[pair.points].side)
        tangent = np.gradient(target, axis=0)
        facing = line.side * np.column_stack([-tangent[:, 1], tangent[:, 0]])
        facing /= np.linalg.norm(facing, axis=1)[:, None]
        usable = np.zeros(len(target), dtype=bool)
        for k in range(3):
            usable[2 * np.flatnonzero(line.free) + k] = True
        usable = np.flatnonzero(usable)
        spacing = np.linalg.norm(np.diff(target, axis=0), axis=1).max()
        radius = max(self.settings.reach_mm, self.settings.depth_mm) + 0.5 * spacing
        lists = cKDTree(target[usable]).query_ball_point(x, radius)
        source = np.repeat(np.arange(len(x)), [len(found) for found in lists])
        node = usable[np.concatenate([np.asarray(f, dtype=np.int64) for f in lists])] if len(source) else source
        opposed = np.einsum("ni,ni->n", normal[source], facing[node]) < _OPPOSED
        source, node = source[opposed], node[opposed]
        distance = np.linalg.norm(x[source] - target[node], axis=1)
        order = np.lexsort((distance, source))
        source, first = np.unique(source[order], return_index=True)
        near = curve.nearest(target, x[source], node[order][first])
        keep = np.flatnonzero(
            near.found
            & (np.einsum("ni,ni->n", normal[source], near.normal) < _OPPOSED)
            & (near.gap < self.settings.reach_mm)
            & (near.gap > -self.settings.depth_mm)
            & np.isin(near.nodes[:, 1], usable)
            & np.isin(near.nodes[:, 2], usable)
        )
        q = source[keep]
        n, tau, length, bend, a = (v[keep] for v in (near.normal, near.along, near.l, near.k, near.a))
        weights = np.column_stack([on.shape[q], -near.weight[keep]])
        slopes = np.column_stack([np.zeros((len(q), 3)), -near.slope[keep]])
        across, along, turn = (
            np.einsum("qa,qi->qai", w, v).reshape(len(q), 14) for w, v in ((weights, n), (weights, tau), (slopes, n))
        )
        gap = near.gap[keep]
        mixed = along[:, :, None] * turn[:, None, :]
        second = (
            -bend[:, None, None] * along[:, :, None] * along[:, None, :]
            + length[:, None, None] * (mixed + mixed.transpose(0, 2, 1))
            - gap[:, None, None] * turn[:, :, None] * turn[:, None, :]
        ) / a[:, None, None]
        dofs = np.column_stack([on.dofs[q], self._dofs[pair.curve][near.nodes[keep]].reshape(len(q), 8)])
        return _Part(pair.what, gap, 0.5 * on.weight[q], np.ones(len(q)), dofs, across, second)

    def _stop(self, pair: Stop, values: FloatArray) -> _Part:
        dofs = np.array([[self._body(pair.lower), self._body(pair.upper)]])
        gap = pair.gap_mm + values[dofs[:, 1]] - values[dofs[:, 0]]
        near = slice(0, int(gap[0] < self.settings.reach_mm))
        return _Part(
            pair.what,
            gap[near],
            np.array([pair.area_mm2])[near],
            np.ones(1)[near],
            dofs[near],
            np.array([[-1.0, 1.0]])[near],
            np.zeros((1, 2, 2))[near],
        )

    # ---- as a term -------------------------------------------------------------------------------------

    def energy(self) -> float:
        """Energy of the penalty, mJ."""
        return float(sum(part.weight @ self.settings.pressure(part.gap)[0] for part in self._now()))

    def force(self) -> FloatArray:
        """Derivative of the energy by the owned dofs and the bodies, N, also by those that are held."""
        out = np.zeros(self._size)
        for part in self._now():
            push = -part.weight * self.settings.pressure(part.gap)[1]
            mine = part.dofs >= 0
            np.add.at(out, part.dofs[mine], (push[:, None] * part.gradient)[mine])
        return out

    def add_force(self, on_dofs: FloatArray, on_bodies: FloatArray) -> None:
        """Add `force`."""
        force = self.force()
        on_dofs += force[: len(on_dofs)]
        on_bodies += force[len(on_dofs) :]

    def _stiffness(self) -> scipy.sparse.csr_matrix:
        """Second derivative of the energy, with a place for every pair within reach."""
        rows, columns, values = [], [], []
        for part in self._now():
            _, pressure, fall = self.settings.pressure(part.gap)
            block = (part.weight * fall)[:, None, None] * part.gradient[:, :, None] * part.gradient[:, None, :]
            block -= (part.weight * pressure)[:, None, None] * part.bend
            i, j = np.broadcast_arrays(part.dofs[:, :, None], part.dofs[:, None, :])
            mine = (i >= 0) & (j >= 0) & self._free[i] & self._free[j]
            rows.append(i[mine])
            columns.append(j[mine])
            values.append(block[mine])
        if not rows:
            return scipy.sparse.csr_matrix((self._size, self._size))
        where = (np.concatenate(rows), np.concatenate(columns))
        return scipy.sparse.csr_matrix((np.concatenate(values), where), shape=(self._size, self._size))

    def pattern(self) -> scipy.sparse.csr_matrix:
        """Places in the tangent that were needed up to now."""
        return self._known

    def grow(self) -> bool:
        """Take the current state's places into `pattern`; True if there are new ones."""
        here = self._stiffness()
        here.data[:] = 1.0
        before = self._known.nnz
        self._known = (self._known + here.astype(np.int8)).sign()
        return bool(self._known.nnz > before)

    def add_to(self, matrix: Any) -> None:
        """Add the second derivative to the tangent, in flush state; `pattern` has its places."""
        stiffness = self._stiffness()
        stiffness.sort_indices()
        matrix.setValuesCSR(
            stiffness.indptr.astype(PETSc.IntType),
            stiffness.indices.astype(PETSc.IntType),
            stiffness.data,
            addv=PETSc.InsertMode.ADD_VALUES,
        )

    def check(self) -> None:
        """Refuse a state in which something has gone into something else, or through it.

        Raises
        ------
        StepFailed
            With the place and a remedy.
        """
        settings = self.settings
        for part in self._now():
            limit = settings.limit_mm * np.minimum(1.0 / part.grade, FADED)
            if np.any(part.gap < -limit):
                worst = int(np.argmin(part.gap / limit))
                raise StepFailed(
                    f"{part.what}: penetration of {-part.gap[worst]:.3g} mm, more than {limit[worst]:.3g} mm: a "
                    f"contact stiffness above {settings.stiffness_mpa_per_mm:g} MPa/mm would hold it",
                    Cause.CONTACT,
                )
        values = self._unknowns.state.x.array
        edges = (self._boundary_rest + values[self._boundary_dofs])[self._boundary]
        for line, on, rest, dofs in zip(self.lines, self._points, self._rest, self._dofs, strict=True):
            now = rest + values[dofs]
            # a little below a free surface there is its own solid, and nothing else
            at = now[on.middles] - 2.0 * settings.limit_mm * on.normals(now, line.side)[on.is_middle]
            twice = np.flatnonzero(~_enclosed(at, edges))
            if len(twice):
                r, z = at[twice[0]]
                raise StepFailed(f"a surface has gone through another at r = {r:.2f}, z = {z:.2f} mm", Cause.CONTACT)

    def report(self) -> tuple[PairReport, ...]:
        """The problem's state by kind of pair."""
        found: dict[str, PairReport] = {}
        for part in self._now():
            pressure = self.settings.pressure(part.gap)[1]
            before = found.get(part.what, PairReport(part.what, np.inf, 0.0, 0))
            shown = part.gap[(part.grade == 1.0) | (pressure > 0.0)]
            found[part.what] = PairReport(
                part.what,
                float(min(before.gap_mm, shown.min(initial=np.inf))),
                before.force_n + float(part.weight @ pressure),
                before.places + int((pressure > 0.0).sum()),
            )
        return tuple(found.values())


def _enclosed(points: FloatArray, edges: FloatArray) -> np.ndarray:
    """Which points (n, 2) lie in an odd number of polygons of edges (m, 2, 2): crossings of a ray to the axis."""
    (r0, z0), (r1, z1) = edges[:, 0].T, edges[:, 1].T
    r, z = points[:, :1], points[:, 1:]
    spans = (z0 > z) != (z1 > z)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = r0 + (z - z0) / (z1 - z0) * (r1 - r0)
    return np.asarray((spans & (at < r)).sum(axis=1) % 2 == 1)
