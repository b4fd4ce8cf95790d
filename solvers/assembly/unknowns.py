"""Unknowns of a problem: dofs of displacement and pressure and, after them, motions of rigid bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray

from solvers import compat
from solvers.assembly.supports import Supports, find_supports
from solvers.assembly.surfaces import Surfaces
from solvers.discrete.domain import Domain, FloatArray, IntArray
from solvers.discrete.elements import Element
from solvers.errors import SolverError
from solvers.state import State


class Unknowns:
    """Numbering, supports and current values.

    Parameters
    ----------
    domain, element
        The mesh and its displacement and pressure spaces.
    surfaces, fields
        What is held, see `solvers.assembly.supports.find_supports`; a pressure for each of the fields.
    held_motions
        Which motions of the bodies are held, shape (bodies, motions).
    frame
        Directions of the displacement's components as columns, shape (3, 3); None for those of the coordinates.

    Attributes
    ----------
    state
        Function (u, p) in ``space``, or (u, p, p, ...) where pressures jump between materials.
    owned, local
        Numbers of this rank's dofs, and of those with the ghosts.
    u_dofs
        Local displacement dofs of each local geometry node, shape (n, d), -1 where it has none. Degrees other than 2
        share the corners with the geometry.
    p_dofs
        Local pressure dofs. A continuous pressure belongs to corner nodes, shape (n,), -1 elsewhere; one with jumps
        or between materials to cells, shape (owned cells, k).
    owned_pressure, constrained_owned
        Which owned dofs are pressures, and which are held, shape (owned,).
    bodies_mm
        Motions of the bodies, shape (bodies, motions).
    held_bodies
        Which of them are held, shape (extra,).
    expected_negatives
        Free pressures of all ranks: negative eigenvalues that a stable tangent has.
    """

    def __init__(
        self,
        domain: Domain,
        element: Element,
        surfaces: Surfaces,
        fields: Sequence[Sequence[int] | None],
        held_motions: NDArray[np.bool_],
        frame: FloatArray | None = None,
    ) -> None:
        mesh = domain.mesh
        self.domain, self.comm, self.element = domain, domain.comm, element
        self.dimension: int = mesh.geometry.dim
        self.space = compat.function_space(mesh, element.spaces(mesh.ufl_cell(), len(fields)))
        self.state = fem.Function(self.space)
        self.index_map = self.space.dofmap.index_map
        self.owned: int = self.index_map.size_local
        self.local: int = self.owned + self.index_map.num_ghosts
        self.u_dofs = displacement_dofs(domain, self.space, self.dimension)
        self._fields = fields
        self._number_pressures(fields)
        self.supports = self.supports_for(surfaces)
        self.constrained_owned = self.supports.is_constrained[: self.owned]
        self.expected_negatives: int = self.free_pressures(self.supports)
        self.bodies_mm = np.zeros(held_motions.shape)
        self.held_bodies, self.extra = held_motions.ravel(), held_motions.size
        self._frame = np.eye(self.dimension) if frame is None else frame
        # displacements of another degree at the quadratic nodes, for callers who expect a value at every node
        own = compat.element("Lagrange", mesh.ufl_cell(), element.displacement_degree)
        self.at_nodes = compat.basis_at(own, compat.node_positions(domain.cell_name))

    def supports_for(self, surfaces: Surfaces) -> Supports:
        """What these surfaces hold of the dofs; every rank calls."""
        return find_supports(self.domain, self.space, self.u_dofs, surfaces, self._fields)

    def free_pressures(self, supports: Supports) -> int:
        """Pressures of all ranks that are not held: negative eigenvalues of a stable tangent; every rank calls."""
        free = self.owned_pressure & ~supports.is_constrained[: self.owned]
        return int(self.comm.allreduce(int(free.sum()), op=MPI.SUM))

    def _number_pressures(self, fields: Sequence[Sequence[int] | None]) -> None:
        """Pressure dofs, and for those of cells their basis functions at the corners, shape (corners, k)."""
        domain, self._p_element = self.domain, compat.sub_elements(self.space.ufl_element())[1]
        on_cells = np.stack([compat.cell_dofs(self.space.sub(1 + k)) for k in range(len(fields))])
        self._at_nodes = self.element.pressure == "continuous" and len(fields) == 1
        if self._at_nodes:
            self.p_dofs = np.full(len(domain.input_node), -1, dtype=np.int64)
            corners = slice(0, domain.corners)
            self.p_dofs[compat.geometry_dofs(domain.mesh)[:, corners]] = on_cells[0][:, corners]
            self.pressure_shape: tuple[int, ...] = (domain.nodes,)
        else:
            numbers = domain.cell_tags.values[: on_cells.shape[1]]
            mine = [0 if cells is None else k * np.isin(numbers, cells) for k, cells in enumerate(fields)]
            self.p_dofs = on_cells[sum(mine), np.arange(len(numbers))].astype(np.int64)
            self._p_at_corners = compat.basis_at(self._p_element, compat.corner_positions(domain.cell_name))
            self.pressure_shape = (domain.cells, domain.corners)
        self.owned_pressure = np.zeros(self.owned, dtype=bool)
        self.owned_pressure[on_cells[on_cells < self.owned]] = True

    # ---- states ----------------------------------------------------------------------------------------

    def set(self, state: State) -> None:
        """Take a state in the caller's numbering; constraints are imposed exactly.

        Raises
        ------
        SolverError
            If its pressures or bodies are those of another problem.
        """
        array, domain = self.state.x.array, self.domain
        if state.pressure_mpa.shape != self.pressure_shape:
            raise SolverError(f"state has pressures of shape {state.pressure_mpa.shape}, need {self.pressure_shape}")
        known = self.u_dofs[:, 0] >= 0
        components = state.displacement_mm[domain.input_node] @ np.linalg.inv(self._frame).T
        for i in range(self.dimension):
            array[self.u_dofs[known, i]] = components[known, i]
        if self.element.displacement_degree > 2:
            self._set_richer(components, state.pressure_mpa)
        elif self._at_nodes:
            corner = self.p_dofs >= 0
            array[self.p_dofs[corner]] = state.pressure_mpa[domain.input_node[corner]]
        else:
            # the closest polynomial to the corner values: exact for those of a state of this problem
            mine = state.pressure_mpa[domain.input_cell[: len(self.p_dofs)]]
            self._set_of_cells(mine @ np.linalg.pinv(self._p_at_corners).T)
        array[: self.local][self.supports.is_constrained] = 0.0
        self.state.x.scatter_forward()
        if state.bodies_mm.shape != self.bodies_mm.shape:
            raise SolverError(f"state has bodies of shape {state.bodies_mm.shape}, need {self.bodies_mm.shape}")
        self.bodies_mm[:] = state.bodies_mm

    def _set_richer(self, components: FloatArray, pressure: FloatArray) -> None:
        """Set a state of the usual element, which a richer one has too, from displacements at the geometry's nodes."""
        domain, mesh, own = self.domain, self.domain.mesh, self.element.displacement_degree
        name, cell, geometry = domain.cell_name, mesh.ufl_cell(), compat.geometry_dofs(mesh)
        points = compat.quadrature_points(name, 10)
        quadratic, richer = (compat.basis_at(compat.element("Lagrange", cell, k), points) for k in (2, own))
        linear = compat.element("DPC" if name in ("quadrilateral", "hexahedron") else "DG", cell, 1)
        of_nodes = np.linalg.pinv(richer) @ quadratic
        of_corners = np.linalg.pinv(compat.basis_at(self._p_element, points)) @ compat.basis_at(linear, points)
        of_corners = of_corners @ np.linalg.pinv(compat.basis_at(linear, compat.corner_positions(name)))
        array = self.state.x.array
        array[self.cell_u_dofs()] = np.einsum("kn,cni->cki", of_nodes, components[geometry])
        if self._at_nodes:
            corners = domain.input_node[geometry[:, : domain.corners]]
            array[compat.cell_dofs(self.space.sub(1))] = pressure[corners] @ of_corners.T
        else:
            self._set_of_cells(pressure[domain.input_cell[: len(self.p_dofs)]] @ of_corners.T)

    def _set_of_cells(self, values: FloatArray) -> None:
        """Set the pressures of the owned cells, shape (owned cells, k); what cells share is their mean.

        The owner of a dof need not have a cell of its material: sums go to it.
        """
        sums, counts = fem.Function(self.space), fem.Function(self.space)
        for function, at_cells in ((sums, values), (counts, np.ones_like(values))):
            np.add.at(function.x.array, self.p_dofs, at_cells)
            compat.sum_on_owners(function.x)
        owned = np.flatnonzero(counts.x.array[: self.owned])
        self.state.x.array[owned] = sums.x.array[owned] / counts.x.array[owned]

    def get(self, load_mpa: float) -> State:
        """The current values under a load factor in the caller's numbering, complete on every rank."""
        return self._in_callers_numbering(self.state.x.array, self.bodies_mm, load_mpa)

    def rate(self, dofs: FloatArray, bodies: FloatArray) -> State:
        """A change by the load factor, on the owned dofs and on the bodies, in the caller's numbering; 1/MPa."""
        change = fem.Function(self.space)
        change.x.array[: self.owned] = dofs
        change.x.scatter_forward()
        return self._in_callers_numbering(change.x.array, bodies.reshape(self.bodies_mm.shape), 1.0)

    def _in_callers_numbering(self, array: FloatArray, bodies_mm: FloatArray, load_mpa: float) -> State:
        """Local values and bodies as a state, complete on every rank."""
        domain = self.domain
        known = self.u_dofs[:, 0] >= 0
        u = np.zeros((len(known), self.dimension))
        u[known] = array[self.u_dofs[known]] @ self._frame.T
        if self.element.displacement_degree != 2:
            geometry = compat.geometry_dofs(domain.mesh)
            u[geometry] = np.einsum("nk,cki,ji->cnj", self.at_nodes, array[self.cell_u_dofs()], self._frame)
            known = np.isin(np.arange(len(known)), geometry)
        if self._at_nodes:
            at = np.flatnonzero(self.p_dofs >= 0)
            where, p = domain.input_node[at], array[self.p_dofs[at]]
        else:
            where, p = domain.input_cell[: len(self.p_dofs)], array[self.p_dofs] @ self._p_at_corners.T
        out = self.zero()
        for nodes, values, places, p_values in self.comm.allgather((domain.input_node[known], u[known], where, p)):
            out.displacement_mm[nodes] = values
            out.pressure_mpa[places] = p_values
        return replace(out, bodies_mm=bodies_mm.copy(), load_mpa=load_mpa)

    def cell_u_dofs(self) -> IntArray:
        """Local displacement dofs of the owned cells, shape (cells, k, d)."""
        parts = [compat.cell_dofs(self.space.sub(0).sub(i)) for i in range(self.dimension)]
        return np.stack(parts, axis=-1).astype(np.int64)

    def zero(self) -> State:
        """The unloaded reference state."""
        nodes = (self.domain.nodes, self.dimension)
        return State(np.zeros(nodes), np.zeros(self.pressure_shape), np.zeros(self.bodies_mm.shape), 0.0)


def displacement_dofs(domain: Domain, space: Any, components: int) -> IntArray:
    """Local dofs of a mixed space's displacement at each local geometry node, -1 where it has none, shape (n, d)."""
    geometry = compat.geometry_dofs(domain.mesh)
    out = np.full((len(domain.input_node), components), -1, dtype=np.int64)
    for i in range(components):
        dofs = compat.cell_dofs(space.sub(0).sub(i))
        shared = dofs.shape[1] if dofs.shape[1] <= geometry.shape[1] else domain.corners
        out[geometry[:, :shared], i] = dofs[:, :shared]
    return out
