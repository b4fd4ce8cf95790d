"""Which cells share which facets, and how the corners of a facet go round it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from meshes.cells import CellShape, IntArray, cell_shape


@dataclass(frozen=True)
class Neighbours:
    """Facets of cells: which cells share them.

    Attributes
    ----------
    cells
        Their nodes, shape (m, k), of positively oriented cells.
    cell
        The reference cell.
    """

    cells: IntArray
    cell: CellShape

    @cached_property
    def _facets(self) -> tuple[IntArray, IntArray]:
        """Corners of all cells' facets, outwards in order, and one row of ascending corners each."""
        every = np.vstack(
            [self.cells[:, list(facet)] for facet in outward_facets(self.cell.dimension, self.cells.shape[1])]
        )
        return every, np.sort(every, axis=1)

    @cached_property
    def _unique(self) -> tuple[IntArray, IntArray, IntArray]:
        _, first, back, count = np.unique(
            self._facets[1], axis=0, return_index=True, return_inverse=True, return_counts=True
        )
        return first, back.ravel(), count

    @property
    def owner(self) -> IntArray:
        """Cell of each facet of each cell."""
        return np.tile(np.arange(len(self.cells)), len(self.cell.facets))

    @property
    def which(self) -> IntArray:
        """Which of its cell's facets each is."""
        return np.repeat(np.arange(len(self.cell.facets)), len(self.cells))

    @cached_property
    def boundary(self) -> IntArray:
        """Rows of facets that belong to one cell."""
        first, _, count = self._unique
        return np.sort(first[count == 1])

    def corners(self, rows: IntArray) -> IntArray:
        """Corners of facets, in order round them, outwards."""
        return self._facets[0][rows]

    @cached_property
    def pairs(self) -> IntArray:
        """Rows of both sides of each facet that belongs to two cells, shape (p, 2)."""
        _, back, count = self._unique
        order = np.argsort(back, kind="stable")
        starts = np.concatenate([[0], np.cumsum(count)[:-1]])[count == 2]
        return np.column_stack([order[starts], order[starts + 1]])

    @cached_property
    def crowded(self) -> IntArray:
        """Rows of facets that belong to more than two cells."""
        _, back, count = self._unique
        return np.flatnonzero(count[back] > 2)

    def alike(self, rows: IntArray) -> NDArray[np.bool_]:
        """Whether the two sides of each pair of facets go the same way round."""
        one, other = (_way_round(self.corners(rows[:, k])) for k in (0, 1))
        return np.asarray(one == other)


@lru_cache(maxsize=4)
def outward_facets(dimension: int, nodes: int) -> tuple[tuple[int, ...], ...]:
    """Corners of a reference cell's facets in order round them, so that the normal points outwards."""
    cell = cell_shape(dimension, nodes)
    centre, out = cell.nodes[: cell.corners].mean(axis=0), []
    for facet in cell.facets:
        ring = [facet[k] for k in ((0, 1, 3, 2) if len(facet) == 4 else range(len(facet)))]
        at = cell.nodes[ring]
        edge = at[1] - at[0]
        normal = np.cross(edge, at[2] - at[0]) if dimension == 3 else np.array([edge[1], -edge[0]])
        out.append(tuple(ring if normal @ (at.mean(axis=0) - centre) > 0.0 else ring[::-1]))
    return tuple(out)


def _way_round(facets: IntArray) -> NDArray[np.bool_]:
    """Which way round the corners go, beginning at the lowest number."""
    if facets.shape[1] == 2:
        return np.asarray(facets[:, 0] < facets[:, 1])
    count = facets.shape[1]
    at, row = facets.argmin(axis=1), np.arange(len(facets))
    return np.asarray(facets[row, (at + 1) % count] < facets[row, (at - 1) % count])


def ridges(facets: IntArray) -> tuple[IntArray, IntArray, IntArray]:
    """Where facets of a closed surface meet: edges in 3D, nodes of a meridian.

    Parameters
    ----------
    facets
        Corners in order round each, shape (f, c).

    Returns
    -------
    ends, facets
        Nodes of each ridge between two facets, shape (r, d - 1), and the two, shape (r, 2).
    crowded
        Nodes of ridges of more than two facets.
    """
    unique, back, number = np.unique(_ends(facets), axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(back.ravel(), kind="stable") % len(facets)
    starts = np.concatenate([[0], np.cumsum(number)[:-1]])[number == 2]
    return unique[number == 2], np.column_stack([order[starts], order[starts + 1]]), np.unique(unique[number > 2])


def rim(facets: IntArray) -> IntArray:
    """Edges that belong to one facet of a part of a surface, shape (r, 2), of facets as in `ridges`."""
    unique, number = np.unique(_ends(facets), axis=0, return_counts=True)
    return np.asarray(unique[number == 1])


def _ends(facets: IntArray) -> IntArray:
    """Nodes of the edges of facets (of a meridian: their end nodes), ascending, a row each."""
    count = facets.shape[1]
    sides = [[k] for k in range(2)] if count == 2 else [[k, (k + 1) % count] for k in range(count)]
    return np.vstack([np.sort(facets[:, side], axis=1) for side in sides])
