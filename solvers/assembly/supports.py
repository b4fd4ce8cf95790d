"""What is held: Dirichlet conditions of surfaces and nodes, and pressures that no cell needs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from solvers import compat
from solvers.assembly.surfaces import Surfaces
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


def find_supports(
    domain: Domain, space: Any, u_dofs: IntArray, surfaces: Surfaces, fields: Sequence[Sequence[int] | None]
) -> Supports:
    """Constraints of a mixed space of u and one pressure or more on a domain.

    Parameters
    ----------
    domain, space
        The mesh and the space on it.
    u_dofs
        Displacement dofs of each local geometry node, shape (n, d).
    surfaces
        What is clamped, held, blocked and pinned.
    fields
        Numbers of the cells that need each pressure: elsewhere it is held; None for all cells.
    """
    dimension = u_dofs.shape[1]
    conditions = list(surfaces.held)
    if surfaces.clamped is not None:
        conditions += [(surfaces.clamped, i) for i in range(dimension)]
    if surfaces.blocked is not None:
        conditions.append((surfaces.blocked, dimension - 1))
    fixed = [(space.sub(0).sub(i), dofs_on(domain, space, number, i)) for number, i in conditions]
    for place, numbers in enumerate(fields, 1):
        if numbers is not None:
            fixed.append((space.sub(place), idle_pressures(domain, space, place, numbers)))
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
        [compat.hold(dofs, part) for part, dofs in fixed],
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


def idle_pressures(domain: Domain, space: Any, place: int, numbers: Sequence[int]) -> IntArray:
    """Local dofs of a mixed space's pressure, its part of that place, at which no rank has a cell of these numbers.

    Ascending.
    """
    cells, tags = compat.cell_dofs(space.sub(place)), domain.cell_tags
    needs_it = np.zeros(len(cells), dtype=bool)
    owned = tags.indices[np.isin(tags.values, numbers)]
    needs_it[owned[owned < len(cells)]] = True
    # a dof is needed if any rank has such a cell at it: sum on the owner, then back to the ghosts
    touched = fem.Function(space)
    touched.x.array[cells[needs_it].ravel()] = 1.0
    compat.sum_on_owners(touched.x)
    touched.x.scatter_forward()
    pressures = np.unique(cells).astype(np.int64)
    return pressures[~(touched.x.array[pressures] > 0.0)]
