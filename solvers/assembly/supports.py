"""What is held: Dirichlet conditions of surfaces and nodes, and pressures that no soft cell needs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from dolfinx import fem
from numpy.typing import NDArray
from petsc4py import PETSc

from solvers import compat
from solvers.assembly.surfaces import SOFT, Surfaces
from solvers.discrete.domain import Domain, IntArray


@dataclass(frozen=True)
class Supports:
    """Constraints of a space.

    Attributes
    ----------
    bcs
        dolfinx' Dirichlet conditions, all zero.
    is_constrained
        Which local dofs they hold, shape (local,).
    clamped_axial, blocked_axial
        Owned axial dofs on the clamped and on the blocked surface; None without one.
    """

    bcs: list[Any]
    is_constrained: NDArray[np.bool_]
    clamped_axial: IntArray
    blocked_axial: IntArray | None


def find_supports(domain: Domain, space: Any, u_dofs: IntArray, surfaces: Surfaces, has_stiff: bool) -> Supports:
    """Constraints of a mixed space (u, p) on a domain.

    Parameters
    ----------
    domain, space
        The mesh and the space on it.
    u_dofs
        Displacement dofs of each local geometry node, shape (n, d).
    surfaces
        What is clamped, held, blocked and pinned.
    has_stiff
        True if there are stiff cells, which have no pressure unknowns.
    """
    dimension = u_dofs.shape[1]
    conditions = list(surfaces.held)
    if surfaces.clamped is not None:
        conditions += [(surfaces.clamped, i) for i in range(dimension)]
    if surfaces.blocked is not None:
        conditions.append((surfaces.blocked, dimension - 1))
    fixed = [(space.sub(0).sub(i), dofs_on(domain, space, number, i)) for number, i in conditions]
    if has_stiff:
        fixed.append((space.sub(1), idle_pressures(domain, space)))
    for node, component in surfaces.pinned:
        dofs = u_dofs[domain.input_node == node, component]
        fixed.append((space.sub(0).sub(component), dofs[dofs >= 0]))
    index_map = space.dofmap.index_map
    is_constrained = np.zeros(index_map.size_local + index_map.num_ghosts, dtype=bool)
    for _, dofs in fixed:
        is_constrained[dofs] = True

    def axial(surface: int | None) -> IntArray:
        dofs = dofs_on(domain, space, surface, dimension - 1)
        return dofs[dofs < index_map.size_local]

    return Supports(
        [fem.dirichletbc(PETSc.ScalarType(0), dofs.astype(np.int32), part) for part, dofs in fixed],
        is_constrained,
        axial(surfaces.clamped),
        None if surfaces.blocked is None else axial(surfaces.blocked),
    )


def dofs_on(domain: Domain, space: Any, surface: int | None, component: int) -> IntArray:
    """Local dofs of a displacement component on a surface; none on no surface."""
    return dofs_of_facets(domain, space, domain.facet_tags.indices[domain.facet_tags.values == surface], component)


def dofs_of_facets(domain: Domain, space: Any, facets: NDArray[np.int32], component: int) -> IntArray:
    """Local dofs of a displacement component on facets."""
    part = space.sub(0).sub(component)
    return fem.locate_dofs_topological(part, domain.mesh.topology.dim - 1, facets).astype(np.int64)


def idle_pressures(domain: Domain, space: Any) -> IntArray:
    """Local pressure dofs at which no rank has a soft cell, ascending."""
    cells, tags = compat.cell_dofs(space.sub(1)), domain.cell_tags
    is_soft = np.zeros(len(cells), dtype=bool)
    owned_soft = tags.indices[tags.values == SOFT]
    is_soft[owned_soft[owned_soft < len(cells)]] = True
    # a dof is soft if any rank has a soft cell at it: sum on the owner, then back to the ghosts
    touched = fem.Function(space)
    touched.x.array[cells[is_soft].ravel()] = 1.0
    compat.sum_on_owners(touched.x)
    touched.x.scatter_forward()
    pressures = np.unique(cells).astype(np.int64)
    return pressures[~(touched.x.array[pressures] > 0.0)]
