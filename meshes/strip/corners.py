"""Quadrilaterals that become smaller towards singular edges, cut from a strip.

A strip has coordinates (s, t): s counts its intervals along the outline, t its layers from the cavity side to the
outside. In them cells have straight sides, so that a cell is its four corners, in the order (0, 0), (1, 0), (0, 1),
(1, 1) of its own coordinates. A cell with a singular vertex becomes three: a small copy at half the distance from the
vertex and two beside it. The two edges away from the vertex stay whole, so that nothing propagates and neighbours that
share the vertex agree.

All levels have the same cuts, which come first; a finer level then divides every cell. So levels are nested. The other
order, and more cuts on finer levels, were tried: docs/decisions.md, "Edges of the seats".
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meshes.cells import FloatArray, IntArray

_UNIT = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
# The three children of the unit square for the vertex (0, 0).
_CHILDREN = np.array(
    [
        [[0.0, 0.0], [0.5, 0.0], [0.0, 0.5], [0.5, 0.5]],
        [[0.5, 0.0], [1.0, 0.0], [0.5, 0.5], [1.0, 1.0]],
        [[0.0, 0.5], [0.5, 0.5], [0.0, 1.0], [1.0, 1.0]],
    ]
)
# Positions closer than this are one: a strip's coordinates are small numbers, its cells far larger.
DIGITS = 9


def strip_cells(
    intervals: int, layers: int, vertices: Sequence[tuple[int, int]], cuts: int, divisions: int = 1
) -> FloatArray:
    """Cells of a strip that become smaller towards some vertices.

    Parameters
    ----------
    intervals, layers
        Cells along the strip and across it, on the coarsest level.
    vertices
        Singular vertices (s, t), whole numbers; no cell may have two of them.
    cuts
        How often the cells at them are cut.
    divisions
        Parts that the sides of all cells are then divided into.

    Returns
    -------
    ndarray
        Shape (cells, 4, 2): corners of each cell, the cells in ascending order of their first corners, s first.
    """
    s, t = (x.ravel() for x in np.meshgrid(np.arange(intervals), np.arange(layers), indexing="ij"))
    cells = np.stack([s, t], axis=-1)[:, None, :] + _UNIT
    for _ in range(cuts if vertices else 0):
        cells = cut_corners(cells, vertices)
    cells = divided(cells, divisions)
    return cells[np.lexsort(np.round(cells[:, 0, ::-1], DIGITS).T)]


def cut_corners(cells: FloatArray, vertices: Sequence[tuple[int, int]]) -> FloatArray:
    """Cells (m, 4, 2) with those at the vertices cut into three each."""
    at = (cells[:, :, None, :] == np.array(vertices, dtype=float)).all(axis=-1).any(axis=-1)
    assert at.sum(axis=1).max() == 1, "one cell has two singular vertices"
    found = [cells[~at.any(axis=1)]]
    for corner in range(4):
        mirrored = _UNIT[corner] > 0.0
        children = np.where(mirrored, 1.0 - _CHILDREN, _CHILDREN)
        order = np.arange(4).reshape(2, 2)[:: -1 if mirrored[1] else 1, :: -1 if mirrored[0] else 1].ravel()
        found.append(_inside(cells[at[:, corner]], children[:, order]))
    return np.vstack(found)


def divided(cells: FloatArray, into: int) -> FloatArray:
    """Cells (m, 4, 2), each divided into so many along both its sides."""
    a, b = (x.ravel() for x in np.meshgrid(np.arange(into), np.arange(into), indexing="ij"))
    return _inside(cells, (np.stack([a, b], axis=-1)[:, None, :] + _UNIT) / into)


def positions_in(cells: FloatArray, at: FloatArray) -> FloatArray:
    """Strip coordinates of positions (k, 2) in the unit square of every cell, shape (m, k, 2)."""
    a, b = at[:, 0], at[:, 1]
    weights = np.stack([(1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b], axis=-1)
    return np.einsum("kc,mcd->mkd", weights, cells)


def _inside(cells: FloatArray, children: FloatArray) -> FloatArray:
    """Children (n, 4, 2) of the unit square in every cell, shape (m n, 4, 2)."""
    return positions_in(cells, children.reshape(-1, 2)).reshape(-1, 4, 2)


def number_nodes(cells: FloatArray) -> tuple[FloatArray, IntArray]:
    """Nodes of nine-node cells.

    Returns
    -------
    positions, nodes
        Strip coordinates in ascending order, s first, shape (n, 2); node 3 i + j of each cell at the half steps i along
        and j across, shape (m, 9).
    """
    half = 0.5 * np.stack(np.meshgrid(np.arange(3), np.arange(3), indexing="ij"), axis=-1).reshape(-1, 2)
    every = positions_in(cells, half).reshape(-1, 2)
    # Thirds do not add up to whole numbers: a node past the end of its stretch by round-off would be on the next one.
    whole = np.round(every)
    every = np.where(np.abs(every - whole) < 10.0**-DIGITS, whole, every)
    _, first, back = np.unique(np.round(every, DIGITS), axis=0, return_index=True, return_inverse=True)
    return every[first], back.reshape(len(cells), 9).astype(np.int64)
