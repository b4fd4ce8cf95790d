"""Quadrilaterals that become smaller towards singular edges, cut from a strip.

A strip has coordinates (s, t): s counts its intervals along the outline, t its layers from the cavity side to the
outside. In them cells have straight sides, so that a cell is its four corners, in the order (0, 0), (1, 0), (0, 1),
(1, 1) of its own coordinates. A cell with a singular vertex becomes three: a small copy at half the distance from the
vertex and two beside it. The two edges away from the vertex stay whole, so that nothing propagates and neighbours that
share the vertex agree.

Finer levels cut off one more corner and then divide all cells. The other order would leave cells at the vertex that are
narrow towards it and not divided, which cost more than the corner gains; docs/decisions.md has both. So each level has
the coarser one's cells cut into pieces: levels are nested.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meshes.cells import FloatArray, IntArray
from meshes.errors import MeshError
from meshes.solid import SolidMesh

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
_NEAR = 1e-9
# Of a bilinear map whose sides are not far from parallel, to round-off.
_NEWTON_STEPS = 8


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
    _, first, back = np.unique(np.round(every, DIGITS), axis=0, return_index=True, return_inverse=True)
    return every[first], back.reshape(len(cells), 9).astype(np.int64)


def interpolation(mesh: SolidMesh, at: FloatArray) -> tuple[IntArray, FloatArray]:
    """How to read off what a meridian's nodes have at other places of its strip, such as the nodes of a finer level.

    Parameters
    ----------
    mesh, at
        As for `cells_at`.

    Returns
    -------
    nodes, weights
        Nodes of the cell that each place is in, and their weights there, shape (p, nodes of a cell) both.
    """
    cells, reference = cells_at(mesh, at)
    return mesh.cells[cells], mesh.cell.shape(reference)[0]


def cells_at(mesh: SolidMesh, at: FloatArray) -> tuple[IntArray, FloatArray]:
    """Which cells of a meridian places of its strip are in; between cells, one of them.

    Parameters
    ----------
    mesh
        A meridian with strip coordinates.
    at
        Strip coordinates, shape (p, 2).

    Returns
    -------
    cells, reference
        Numbers of the cells, shape (p,), and the places in their reference cells, shape (p, 2).

    Raises
    ------
    MeshError
        If a place is in no cell.
    """
    in_wall = np.flatnonzero((mesh.cells < len(mesh.strip)).all(axis=1))  # not those of meshed rings
    corners = mesh.strip[mesh.cells[in_wall]]
    first = np.floor(corners.mean(axis=1)[:, 0])  # no cell reaches beyond an interval of the coarsest level
    cells, found = np.full(len(at), -1), np.zeros((len(at), 2))
    for interval in np.unique(first):
        places = np.flatnonzero((at[:, 0] >= interval) & (at[:, 0] <= interval + 1.0) & (cells < 0))
        own = np.flatnonzero(first == interval)
        low, high = corners[own].min(axis=1) - _NEAR, corners[own].max(axis=1) + _NEAR
        place, cell = np.nonzero(((at[places, None] >= low) & (at[places, None] <= high)).all(axis=2))
        place, cell = places[place], own[cell]
        reference = np.tile(mesh.cell.rule[0].mean(axis=0), (len(place), 1))
        for _ in range(_NEWTON_STEPS):
            value, slope = mesh.cell.shape(reference)
            away = at[place] - np.einsum("pk,pkd->pd", value, corners[cell])
            matrix = np.einsum("pkd,pkr->pdr", corners[cell], slope)
            reference = reference + np.linalg.solve(matrix, away[..., None])[..., 0]
        inside = (reference > -_NEAR).all(axis=1) & (reference < 1.0 + _NEAR).all(axis=1)
        if mesh.cell.name == "triangle":
            inside &= reference.sum(axis=1) < 1.0 + _NEAR
        cells[place[inside]], found[place[inside]] = in_wall[cell[inside]], reference[inside]
    if (cells < 0).any():
        s, t = at[np.flatnonzero(cells < 0)[0]]
        raise MeshError(f"no cell of the meridian's strip is at s = {s:g}, t = {t:g}")
    return cells, found
