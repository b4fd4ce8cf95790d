"""Nodal forces of a manufactured solution on a mesh, the solver under them, and its errors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse
from mpi4py import MPI

from meshes.cells import HEXAHEDRON_NODES, QUADRILATERAL_NODES, cell_shape
from meshes.solid import SolidMesh
from solvers.assembly.surfaces import Surfaces
from solvers.assembly.term import Term
from solvers.discrete.domain import create_domain
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.linear.factor import Factor
from solvers.problem import Problem
from solvers.state import State
from tests.solvers.manufactured.solutions import Solution

SETTINGS = NewtonSettings(relative_tolerance=1e-10)


# ---- sums over a mesh -------------------------------------------------------------------------------------


def ring_factor(x: np.ndarray) -> np.ndarray:
    """What a meridian's length and area are multiplied by: 2 pi r, mm; 1 in 3D."""
    return 2.0 * np.pi * x[..., 0] if x.shape[-1] == 2 else np.ones(x.shape[:-1])


def reference_faces(mesh: SolidMesh) -> list[tuple[tuple[int, ...], np.ndarray, np.ndarray, np.ndarray]]:
    """Of each face of the reference cell: corners, Gauss points, weights, and its outward area vector."""
    d, corners = mesh.dimension, mesh.cell.corners
    box = corners > d + 1
    at = np.vstack([np.zeros(d), np.eye(d)])
    if box:
        at = 0.5 * (QUADRILATERAL_NODES if d == 2 else HEXAHEDRON_NODES)[:corners]
    normals = [sign * axis for axis in np.eye(d) for sign in (-1.0, 1.0)] if box else [*-np.eye(d), np.ones(d)]
    if d == 3:
        points, weights = cell_shape(2, 9 if box else 6).rule
    else:
        x, w = np.polynomial.legendre.leggauss(4)
        points, weights = 0.5 * (x + 1.0)[:, None], 0.5 * w
    faces = []
    for normal in normals:
        height = at @ normal
        on = tuple(int(k) for k in np.flatnonzero(np.isclose(height, height.max())))
        ways = at[list(on[1:d])] - at[on[0]]
        # weights of the triangle add up to its area, and the oblique face's vector is (1, 1, 1): its projections' areas
        faces.append((on, at[on[0]] + points @ ways, weights, normal))
    return faces


def nodal_forces(mesh: SolidMesh, solution: Solution, loaded: int) -> np.ndarray:
    """Work of body force and tractions in each node's shape function, shape (n, d), N."""
    out = np.zeros(mesh.points.shape)
    nodes = mesh.points[mesh.cells]
    points, weights = mesh.cell.rule
    values, slopes = mesh.cell.shape(points)
    x = np.einsum("cki,qk->cqi", nodes, values)
    size = np.abs(np.linalg.det(np.einsum("cki,qkj->cqij", nodes, slopes))) * weights * ring_factor(x)
    np.add.at(out, mesh.cells, np.einsum("cqi,cq,qk->cki", solution.body_force(x), size, values))
    tags = {tuple(facet): tag for facet, tag in zip(mesh.facets, mesh.facet_tags, strict=True)}
    for corners, points, weights, normal in reference_faces(mesh):
        named = [tags.get(tuple(key), 0) for key in np.sort(mesh.cells[:, list(corners)], axis=1)]
        cells = np.flatnonzero(named)
        values, slopes = mesh.cell.shape(points)
        x = np.einsum("cki,qk->cqi", nodes[cells], values)
        jacobian = np.einsum("cki,qkj->cqij", nodes[cells], slopes)
        cofactor = np.linalg.det(jacobian)[..., None, None] * np.linalg.inv(jacobian).swapaxes(-1, -2)
        sign = np.sign(np.linalg.det(jacobian))  # cells may be numbered left-handed
        area = np.einsum("cqij,j->cqi", cofactor, normal) * (sign * weights * ring_factor(x))[..., None]
        here = np.broadcast_to((np.array(named)[cells] == loaded)[:, None], x.shape[:-1])
        np.add.at(out, mesh.cells[cells], np.einsum("cqi,qk->cki", solution.traction(x, area, here), values))
    return out


def errors(mesh: SolidMesh, state: State, solution: Solution) -> np.ndarray:
    """Root mean squares of the errors of u, grad u (without the hoop) and p."""
    d, nodes = mesh.dimension, mesh.points[mesh.cells]
    points, weights = mesh.cell.rule
    values, slopes = mesh.cell.shape(points)
    x = np.einsum("cki,qk->cqi", nodes, values)
    jacobian = np.einsum("cki,qkj->cqij", nodes, slopes)
    size = np.abs(np.linalg.det(jacobian)) * weights
    moved = state.displacement_mm[mesh.cells]
    u = np.einsum("cki,qk->cqi", moved, values)
    f = np.einsum("cki,qkj->cqij", moved, slopes) @ np.linalg.inv(jacobian) + np.eye(d)
    p = state.pressure_mpa
    if p.ndim == 1:
        p = p[mesh.cells[:, : mesh.cell.corners]]
        linear = np.column_stack([1.0 - points.sum(axis=1), points])
    else:
        ends = 0.5 * (QUADRILATERAL_NODES if d == 2 else HEXAHEDRON_NODES)[: mesh.cell.corners]
        linear = np.prod(np.where(ends == 1.0, points[:, None], 1.0 - points[:, None]), axis=-1)
    off = (
        ((u + x - solution.place(x)) ** 2).sum(axis=-1),
        ((f - solution.gradient(x)[..., :d, :d]) ** 2).sum(axis=(-1, -2)),
        (p @ linear.T - solution.pressure(x)) ** 2,
    )
    return np.sqrt([(square * size).sum() / size.sum() for square in off])


# ---- the solver under them --------------------------------------------------------------------------------


@dataclass(frozen=True)
class DeadForces:
    """Forces on the owned dofs that do not change: a term linear in the displacements, N, shape (owned,)."""

    problem: Problem
    on_dofs: np.ndarray

    def energy(self) -> float:
        return -float(self.on_dofs @ self.problem.state.x.array[: self.problem.owned])

    def add_force(self, on_dofs: np.ndarray, on_bodies: np.ndarray) -> None:
        on_dofs -= self.on_dofs

    def pattern(self) -> scipy.sparse.csr_matrix:
        return scipy.sparse.csr_matrix((self.problem.owned, self.problem.owned), dtype=np.int8)

    def grow(self) -> bool:
        return False

    def add_to(self, matrix: Any) -> None:
        pass

    def check(self) -> None:
        pass


class Driven(Problem):
    """A problem with dead forces beside its load."""

    forces: DeadForces

    @property
    def terms(self) -> tuple[Term, ...]:
        return (*super().terms, self.forces)


def solved(mesh: SolidMesh, solution: Solution, **surfaces: Any) -> tuple[Driven, State]:
    """The discrete equilibrium; the exact one is only the first guess."""
    where = Surfaces(**surfaces)
    problem = Driven(create_domain(MPI.COMM_SELF, mesh), solution.law, solution.inverse_kappa, where)
    forces = nodal_forces(mesh, solution, where.load[1])
    on_dofs = np.zeros(problem.owned)
    on_dofs[problem.u_dofs] = forces[problem.domain.input_node]
    problem.forces = DeadForces(problem, on_dofs)
    p = solution.pressure(mesh.points)
    if len(problem.unknowns.pressure_shape) == 2:
        p = p[mesh.cells[:, : mesh.cell.corners]]
    guess = State(solution.place(mesh.points) - mesh.points, p, np.zeros((0, 0)), solution.load_mpa)
    problem.set_state(guess)
    factor = Factor(problem)
    solve_equilibrium(problem, factor, SETTINGS, HeldLoad(solution.load_mpa))
    factor.close()
    return problem, problem.get_state()


def orders(make: Callable[[int], tuple[SolidMesh, dict[str, Any]]], solution: Solution, levels) -> np.ndarray:
    """Orders of (u, grad u, p) between successive meshes, each half as coarse."""
    found = []
    for n in levels:
        mesh, surfaces = make(n)
        found.append(errors(mesh, solved(mesh, solution, **surfaces)[1], solution))
    return np.log2(np.array(found[:-1]) / np.array(found[1:]))
