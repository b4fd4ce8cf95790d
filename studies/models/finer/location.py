"""Where points are on a mesh of curved cells: in which cell, and at which place of its reference cell."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from meshes.cells import CellShape
from meshes.errors import MeshError
from meshes.solid import FloatArray, IntArray, SolidMesh

# A point is looked for in all cells at so many of the closest nodes first.
NEAREST = 2
# Newton's method for a place in a reference cell: its most iterations, when it has settled, and how far it may go.
ITERATIONS, SETTLED, FARTHEST = 20, 1e-10, 2.0
# A point may lie outside of the closest cell by this share of it: curved edges of two meshes are not the same curve.
OUTSIDE = 0.25
# One that is further outside than this is looked for in every cell that may have it.
DOUBTFUL = 0.01
# Pairs of a point and a box that are looked at together: 100 MB.
AT_ONCE = 10_000_000


@dataclass(frozen=True)
class Places:
    """Cells (n,) of points, and where in the reference cell they are, shape (n, d)."""

    cells: IntArray
    at: FloatArray


def locate(mesh: SolidMesh, points: FloatArray) -> Places:
    """The cell of each point, or the closest one.

    Parameters
    ----------
    mesh
        The mesh.
    points
        Positions, shape (n, d), mm.

    Raises
    ------
    MeshError
        If a point lies too far outside of the mesh.
    """
    found, off = _closest(mesh, points, _near(mesh, points))
    doubtful = np.flatnonzero(off > DOUBTFUL)
    if len(doubtful):
        again, off[doubtful] = _closest(mesh, points[doubtful], _around(mesh, points[doubtful], found.cells[doubtful]))
        found.cells[doubtful], found.at[doubtful] = again.cells, again.at
    worst = int(np.argmax(off))
    if not off[worst] <= OUTSIDE:
        raise MeshError(f"no cell of the mesh is close to {np.round(points[worst], 4).tolist()} mm")
    return found


def _closest(mesh: SolidMesh, points: FloatArray, pairs: IntArray) -> tuple[Places, FloatArray]:
    """Of pairs of a point and a cell, by points, the best cell of each point, and how far outside of it the point is.

    Infinitely far where Newton's method has not found it in any.
    """
    at, settled = place_in(mesh, points[pairs[:, 0]], pairs[:, 1])
    off = np.where(settled, _outside(mesh.cell, at), np.inf)
    order = np.lexsort((off, pairs[:, 0]))
    best = order[np.searchsorted(pairs[order, 0], np.arange(len(points)))]
    return Places(pairs[best, 1], at[best]), off[best]


def place_in(mesh: SolidMesh, points: FloatArray, cells: IntArray) -> tuple[FloatArray, np.ndarray]:
    """Places of points in the reference cells of given cells, and whether each has been found; also outside of them.

    Parameters
    ----------
    points, cells
        Shapes (n, d) and (n,).
    """
    shape, nodes = mesh.cell, mesh.points[mesh.cells[cells]]
    at = np.tile(shape.nodes[: shape.corners].mean(axis=0), (len(points), 1))
    settled, open_ = np.zeros(len(points), dtype=bool), np.arange(len(points))
    for _ in range(ITERATIONS):
        values, slopes = shape.shape(at[open_])
        off = points[open_] - np.einsum("qk,qki->qi", values, nodes[open_])
        jacobian = np.einsum("qkj,qki->qij", slopes, nodes[open_])
        regular = np.abs(np.linalg.det(jacobian)) > 0.0
        open_, off, jacobian = open_[regular], off[regular], jacobian[regular]
        step = np.linalg.solve(jacobian, off[..., None])[..., 0]
        at[open_] += np.clip(step, -0.5, 0.5)
        settled[open_] = np.abs(step).max(axis=1) <= SETTLED
        open_ = open_[~settled[open_] & (np.abs(at[open_] - 0.5).max(axis=1) <= FARTHEST)]
        if not len(open_):
            break
    return at, settled


def _around(mesh: SolidMesh, points: FloatArray, known: IntArray) -> IntArray:
    """Pairs of a point and each cell whose box it is in, or near, and the cell known before."""
    corners = mesh.points[mesh.cells]
    low, high = corners.min(axis=1), corners.max(axis=1)
    margin = OUTSIDE * (high - low).max(axis=1, keepdims=True)
    found = [np.column_stack([np.arange(len(points)), known])]
    for some in np.array_split(np.arange(len(points)), math.ceil(len(points) * len(low) / AT_ONCE)):
        at = points[some, None]
        pairs = np.argwhere(((at >= low - margin) & (at <= high + margin)).all(axis=2))
        found.append(np.column_stack([some[pairs[:, 0]], pairs[:, 1]]))
    return np.unique(np.vstack(found), axis=0)


def _near(mesh: SolidMesh, points: FloatArray) -> IntArray:
    """Pairs of a point and each cell at the closest nodes, shape (pairs, 2), by points."""
    count = len(mesh.points)
    nearest = cKDTree(mesh.points).query(points, k=min(NEAREST, count))[1].reshape(len(points), -1)
    order = np.argsort(mesh.cells, axis=None, kind="stable")
    of_node = order // mesh.cells.shape[1]  # cells at each node, one node after the other
    many = np.bincount(mesh.cells.ravel(), minlength=count)
    first = np.cumsum(many) - many
    repeats = many[nearest.ravel()]
    owner = np.repeat(np.arange(nearest.size), repeats)
    within = np.arange(len(owner)) - np.repeat(np.cumsum(repeats) - repeats, repeats)
    cells = of_node[first[nearest.ravel()][owner] + within]
    return np.unique(np.column_stack([owner // nearest.shape[1], cells]), axis=0)


def _outside(cell: CellShape, at: FloatArray) -> FloatArray:
    """How far places are outside of a reference cell, 0 within, shape (n,)."""
    beyond = at.sum(axis=1) - 1.0 if cell.name in ("triangle", "tetrahedron") else at.max(axis=1) - 1.0
    return np.maximum(0.0, np.maximum(-at.min(axis=1), beyond))
