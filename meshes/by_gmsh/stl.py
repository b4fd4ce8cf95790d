"""A solid inside a closed surface of triangles, in the child process that has gmsh: its geometry, curved cells on it.

Of such surfaces gmsh's own second-order nodes are unreliable (4.8 puts some at 1e21), so cells are made with straight
edges and their nodes midway then moved onto the triangles that were read.
"""

from __future__ import annotations

import math
import sys
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from meshes.cells import FloatArray, IntArray
from meshes.quality import jacobians_with_nodes

# Pieces of the read surface in which the nearest place to a node is looked for.
_NEAREST = 12
# Cells whose least Jacobian would be a smaller part of their largest stay straight.
LEAST_RATIO = 0.15
# gmsh's order of a tetrahedron's nodes in this program's.
_TETRAHEDRON = [0, 1, 2, 3, 8, 9, 5, 7, 6, 4]


def open_stl(gmsh: Any, path: str, angle: float) -> None:
    """Make a solid of a closed surface, cut into parts where facets meet at more than an angle (radians)."""
    gmsh.merge(path)
    _, _, nodes = gmsh.model.mesh.getElements(2)
    if not len(nodes):
        sys.exit("it holds no triangles")
    corners = np.asarray(nodes[0]).reshape(-1, 3)
    edges = np.sort(np.vstack([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [0, 2]]]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    if (count != 2).any():
        sys.exit(
            f"its surface is not closed: {int((count == 1).sum())} edges belong to one triangle, "
            f"{int((count > 2).sum())} to more than two; repair it where it was made"
        )
    gmsh.model.mesh.classifySurfaces(angle, True, True, math.pi)
    gmsh.model.mesh.createGeometry()
    geo = gmsh.model.geo
    geo.addVolume([geo.addSurfaceLoop([tag for _, tag in gmsh.model.getEntities(2)])])
    geo.synchronize()
    gmsh.option.setNumber("Mesh.SecondOrderLinear", 1)


def read_pieces(gmsh: Any) -> dict[tuple[int, int], FloatArray]:
    """Segments of each curve and triangles of each surface as they were read: corners, shape (n, 2 or 3, 3)."""
    place, points = _nodes(gmsh)
    pieces = {}
    for dimension, tag in [*gmsh.model.getEntities(1), *gmsh.model.getEntities(2)]:
        _, _, nodes = gmsh.model.mesh.getElements(dimension, tag)
        if len(nodes):
            pieces[dimension, tag] = points[place[np.asarray(nodes[0], dtype=int)]].reshape(-1, dimension + 1, 3)
    return pieces


def curve_cells(gmsh: Any, pieces: dict[tuple[int, int], FloatArray], size: float) -> None:
    """Move the nodes midway on the surface onto what was read, but those of cells that would nearly fold.

    Parameters
    ----------
    pieces
        From `read_pieces`, before meshing.
    size
        Longest edge of a piece that the nearest place is looked for in.
    """
    place, points = _nodes(gmsh)
    moved, done = points.copy(), np.zeros(len(points), dtype=bool)
    for (dimension, tag), corners in pieces.items():  # curves first: their nodes are on surfaces too
        _, _, nodes = gmsh.model.mesh.getElements(dimension, tag)
        if not len(nodes):
            continue
        rows = place[np.asarray(nodes[0], dtype=int)].reshape(-1, 3 if dimension == 1 else 6)
        middle = np.unique(rows[:, dimension + 1 :])
        middle = middle[~done[middle]]
        if len(middle):
            moved[middle] = _nearest(points[middle], corners, size)
        done[middle] = True
    _, numbers = gmsh.model.mesh.getElementsByType(11)
    cells = place[np.asarray(numbers, dtype=int)].reshape(-1, 10)[:, _TETRAHEDRON]
    way = np.sign(jacobians_with_nodes(points, cells)[:, :1])
    while True:
        signed = way * jacobians_with_nodes(moved, cells)
        folded = (signed.min(axis=1) < LEAST_RATIO * signed.max(axis=1)) & (moved[cells] != points[cells]).any(
            axis=(1, 2)
        )
        if not folded.any():
            break
        moved[cells[folded]] = points[cells[folded]]
    numbers = np.flatnonzero((moved != points).any(axis=1))
    tag_of = np.zeros(len(points), dtype=int)
    tag_of[place[place >= 0]] = np.flatnonzero(place >= 0)
    for row in numbers:
        gmsh.model.mesh.setNode(int(tag_of[row]), moved[row].tolist(), [])


def _nodes(gmsh: Any) -> tuple[IntArray, FloatArray]:
    """Row of each of gmsh's numbers (-1: none), and the positions."""
    numbers, points, _ = gmsh.model.mesh.getNodes()
    place = np.full(int(max(numbers)) + 1, -1)
    place[np.asarray(numbers, dtype=int)] = np.arange(len(numbers))
    return place, np.asarray(points, dtype=float).reshape(-1, 3)


def _nearest(points: FloatArray, corners: FloatArray, size: float) -> FloatArray:
    """Nearest places on segments or triangles; large ones are cut first, so that their middles tell which are near."""
    corners = _cut(corners, size)
    _, near = cKDTree(corners.mean(axis=1)).query(points, k=min(_NEAREST, len(corners)))
    near = near.reshape(len(points), -1)
    found = np.stack([_on_piece(points, corners[near[:, k]]) for k in range(near.shape[1])])
    best = np.linalg.norm(found - points, axis=2).argmin(axis=0)
    return np.asarray(found[best, np.arange(len(points))])


def _cut(corners: FloatArray, size: float) -> FloatArray:
    """Pieces with edges of at most a size, by halving the longest edge."""
    small = []
    while len(corners):
        after = np.roll(corners, -1, axis=1)
        lengths = np.linalg.norm(after - corners, axis=2)
        longest = lengths.argmax(axis=1)
        large = lengths.max(axis=1) > size
        small.append(corners[~large])
        corners, longest = corners[large], longest[large]
        rows = np.arange(len(corners))
        ends = (longest + 1) % corners.shape[1]
        middle = 0.5 * (corners[rows, longest] + corners[rows, ends])
        one, other = corners.copy(), corners.copy()
        one[rows, longest], other[rows, ends] = middle, middle
        corners = np.concatenate([one, other])
    return np.concatenate(small)


def _on_piece(points: FloatArray, corners: FloatArray) -> FloatArray:
    """Nearest place on one segment or triangle for each point."""
    if corners.shape[1] == 2:
        return _on_segment(points, corners[:, 0], corners[:, 1])
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(ab, ac)
    size = np.einsum("ij,ij->i", normal, normal)
    v = np.einsum("ij,ij->i", np.cross(points - a, ac), normal) / size
    w = np.einsum("ij,ij->i", np.cross(ab, points - a), normal) / size
    inside = a + v[:, None] * ab + w[:, None] * ac
    sides = np.stack([_on_segment(points, corners[:, k], corners[:, (k + 1) % 3]) for k in range(3)])
    nearest = np.linalg.norm(sides - points, axis=2).argmin(axis=0)
    within = (v >= 0.0) & (w >= 0.0) & (v + w <= 1.0)
    return np.where(within[:, None], inside, sides[nearest, np.arange(len(points))])


def _on_segment(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    along = end - start
    share = np.einsum("ij,ij->i", points - start, along) / np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
    return np.asarray(start + np.clip(share, 0.0, 1.0)[:, None] * along)
