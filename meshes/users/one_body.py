"""Whether cells make one sound body: none twice, none over another, all hanging together by facets.

Nor may its surface touch itself: neither at nodes that lie in one place, nor flat upon another part.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from meshes.cells import FloatArray, IntArray, cell_shape
from meshes.errors import MeshError
from meshes.users.neighbours import Neighbours, outward_facets, ridges

# Nodes closer than this part of the box are in one place: files from CAD agree to 1e-7.
SAME_PLACE = 1e-6
# Facets of two parts of the surface that face each other closer than this part of their size touch.
TOUCHING = 1e-3
# Facets that bend by less are one flat face; faces that meet at more are meant to be two.
FLAT_DEG, SHARP_DEG = 0.1, 65.0
# Of the points on facets so many are looked at round the middle of each: its own and, if any, those of one upon it.
NEAREST = 24
# Sides of a lattice of points on a facet, enough to find a facet that lies anywhere on it.
_FINE = 6

HOW_TO_JOIN = (
    "parts that touch become one body in gmsh by BooleanFragments{ Volume{:}; Delete; }{} of the OpenCASCADE kernel "
    "(a meridian's by BooleanFragments{ Surface{:}; Delete; }{}; in Python gmsh.model.occ.fragment), which must come "
    "before physical groups and meshing; where both sides have the same nodes, Coherence Mesh; (in Python "
    "gmsh.model.mesh.removeDuplicateNodes()) joins them in the mesh"
)


def check_one_body(path: Path, points: FloatArray, cells: IntArray, numbers: IntArray) -> Neighbours:
    """Refuse cells that are there twice, overlap, or do not make one body.

    Parameters
    ----------
    points, cells
        In mm, positively oriented.
    numbers
        gmsh's numbers of the cells.

    Raises
    ------
    MeshError
        Naming what was found and what joins parts in gmsh.
    """
    found = Neighbours(cells, cell_shape(points.shape[1], cells.shape[1]))
    corners = np.sort(cells[:, : found.cell.corners], axis=1)
    _, first, count = np.unique(corners, axis=0, return_index=True, return_counts=True)
    if (count > 1).any():
        twice = numbers[(corners == corners[first[np.argmax(count)]]).all(axis=1)]
        raise MeshError(
            f"{path}: {int((count > 1).sum())} of {len(count)} cells are there more than once, for instance as "
            f"{' and '.join(map(str, twice))}: in format 2 a cell in two physical volumes (a meridian's: surfaces) is "
            "written once for each; write format 4 (Mesh.MshFileVersion = 4.1, gmsh -format msh41), or put it in one"
        )
    _check_nodes(path, points, found, numbers)
    alike = found.alike(found.pairs)
    if len(found.crowded) or alike.any():
        rows = found.crowded[:1] if len(found.crowded) else found.pairs[np.argmax(alike)]
        where = _place(points[found.corners(rows[:1])[0]].mean(axis=0))
        named = " and ".join(str(n) for n in numbers[found.owner[rows]])
        raise MeshError(
            f"{path}: cells overlap near {where}, at cell {named}: a facet has more than one cell on a side; parts "
            "that occupy the same place are made one by BooleanUnion or BooleanFragments; or mesh it anew"
        )
    _check_touching(path, points, found)
    _check_pinched(path, points, found)
    return found


def _check_nodes(path: Path, points: FloatArray, found: Neighbours, numbers: IntArray) -> None:
    """Refuse a node that is a corner here and within an edge there, or between other corners.

    Cells that meet so do not fit, and each would have a node of its own there.
    """
    cells, cell = found.cells, found.cell
    between = np.full((*cells.shape, cell.corners), -1, dtype=np.int64)  # corners that a node lies between
    simplex, ends = cell.corners == cell.dimension + 1, cell.nodes[: cell.corners]
    for node, place in enumerate(cell.nodes):
        # linear shape functions of the corners, in the reference cell from 0 to 1
        shares = np.append(1.0 - place.sum(), place) if simplex else np.prod(1.0 - np.abs(ends - place), axis=1)
        these = np.flatnonzero(shares > 1e-9)
        between[:, node, : len(these)] = np.sort(cells[:, these], axis=1)
    _, which = np.unique(between.reshape(-1, cell.corners), axis=0, return_inverse=True)
    pairs, first = np.unique(np.column_stack([cells.ravel(), which.ravel()]), axis=0, return_index=True)
    for column in (0, 1):
        values, count = np.unique(pairs[:, column], return_counts=True)
        if (count > 1).any():
            at = first[pairs[:, column] == values[np.argmax(count > 1)]]
            named = " and ".join(str(n) for n in dict.fromkeys(numbers[at // cells.shape[1]]))
            raise MeshError(
                f"{path}: cells do not fit near {_place(points[cells.ravel()[at[0]]])}, at cell {named}: a node is a "
                "corner of one and within an edge of another, or an edge has two middles; mesh it anew, all cells of "
                "one order"
            )


def _place(point: FloatArray) -> str:
    return "(" + ", ".join(f"{x:.4g}" for x in point) + ") mm"


def _check_touching(path: Path, points: FloatArray, found: Neighbours) -> None:
    """Refuse separate parts, and surfaces that lie on each other and are not joined."""
    one, other = found.owner[found.pairs].T
    count = len(found.cells)
    parts, part = connected_components(
        coo_matrix((np.ones(len(one)), (one, other)), shape=(count, count)), directed=False
    )
    sizes = np.bincount(part, minlength=parts)
    where, how = _touches(points, found, part)
    if parts > 1:
        of = f"the body is in {parts} parts of {', '.join(map(str, sorted(sizes, reverse=True)[:5]))} cells"
        if where is not None:
            raise MeshError(f"{path}: {of} that touch and are not joined ({how} near {_place(where)}): {HOW_TO_JOIN}")
        shared = _shared_nodes(found, part)
        if len(shared):
            raise MeshError(
                f"{path}: {of} that meet only in an edge or a point ({len(shared)} nodes, near "
                f"{_place(points[shared[0]])}), which carries nothing: let them overlap, or part them; {HOW_TO_JOIN}"
            )
        groups = "volumes" if points.shape[1] == 3 else "surfaces"
        raise MeshError(
            f"{path}: {of} that do not touch (or go through each other): solve one part at a time (leave the others "
            f"out of the physical {groups}), or join them by what lies between; {HOW_TO_JOIN}"
        )
    if where is not None:
        raise MeshError(
            f"{path}: two parts of the surface lie on each other and are not joined ({how} near {_place(where)}): "
            f"a slit that would open; {HOW_TO_JOIN}"
        )


def _shared_nodes(found: Neighbours, part: IntArray) -> IntArray:
    """Nodes in cells of more than one part."""
    pairs = np.unique(np.column_stack([found.cells.ravel(), np.repeat(part, found.cells.shape[1])]), axis=0)
    node, count = np.unique(pairs[:, 0], return_counts=True)
    return np.asarray(node[count > 1])


def _touches(points: FloatArray, found: Neighbours, part: IntArray) -> tuple[FloatArray | None, str]:
    """A place where the surface touches itself or another part's, and how many nodes or facets do."""
    used = np.unique(found.cells[found.owner[found.boundary]])
    size = float(np.ptp(points, axis=0).max())
    close = cKDTree(points[used]).query_pairs(SAME_PLACE * size, output_type="ndarray")
    if len(close):
        return points[used[close[0, 0]]], f"{len(close)} pairs of nodes in one place"
    faces = _surface_points(points, found)
    tree = cKDTree(faces.points.reshape(-1, points.shape[1]))
    middle = faces.points[:, faces.middle]
    normal = faces.normals[:, faces.middle]
    _, near = tree.query(middle, k=min(NEAREST, tree.n))
    face, at = np.divmod(near, faces.points.shape[1])
    gap = middle[:, None] - faces.points[face, at]
    other = faces.normals[face, at]
    across = np.abs(np.einsum("fkd,fkd->fk", gap, normal[:, None] - other)) * 0.5
    opposite = np.einsum("fd,fkd->fk", normal, other) < -0.9
    least = np.minimum(faces.size[:, None], faces.size[face])
    along = np.linalg.norm(gap, axis=2) < 0.25 * faces.size[:, None]
    corners = found.corners(found.boundary)
    apart = ~(corners[:, None, :, None] == corners[face][:, :, None, :]).any(axis=(2, 3))
    hit = opposite & along & apart & (across < TOUCHING * least)
    if not hit.any():
        return None, ""
    return middle[
        np.argmax(hit.any(axis=1))
    ], f"{int(hit.any(axis=1).sum())} facets on others whose nodes are elsewhere"


@dataclass(frozen=True)
class _Faces:
    """Points on the boundary's facets (f, q, d), unit normals outwards there, each facet's size, the middle one."""

    points: FloatArray
    normals: FloatArray
    size: FloatArray
    middle: int


def _surface_points(points: FloatArray, found: Neighbours) -> _Faces:
    cell = found.cell
    count, dimension = len(found.boundary), cell.dimension
    places, middle = _facet_lattice(len(cell.facets[0]))
    at = np.empty((count, len(places), dimension))
    normals = np.empty_like(at)
    which, owner = found.which[found.boundary], found.owner[found.boundary]
    for k, ring in enumerate(outward_facets(dimension, found.cells.shape[1])):
        mine = which == k
        corner = cell.nodes[list(ring)]
        edges = [corner[1] - corner[0], corner[-1] - corner[0]][: dimension - 1]
        values, grads = cell.shape(corner[0] + places @ np.array(edges))
        nodes = points[found.cells[owner[mine]]]
        at[mine] = np.einsum("qk,fkd->fqd", values, nodes)
        tangents = np.einsum("qkj,fkd,aj->fqad", grads, nodes, np.array(edges))
        if dimension == 3:
            normals[mine] = np.cross(tangents[:, :, 0], tangents[:, :, 1])
        else:
            normals[mine] = np.stack([tangents[:, :, 0, 1], -tangents[:, :, 0, 0]], axis=-1)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    corners = points[found.corners(found.boundary)]
    size = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    return _Faces(at, normals, size, middle)


def _facet_lattice(corners: int) -> tuple[FloatArray, int]:
    """Places inside a facet's reference line, triangle or square, and which of them is nearest to the middle."""
    step = (np.arange(_FINE) + 0.5) / _FINE
    if corners == 2:
        places = step[:, None]
        return places, len(places) // 2
    places = np.stack(np.meshgrid(step, step, indexing="ij"), axis=-1).reshape(-1, 2)
    if corners == 3:
        places = places[places.sum(axis=1) < 1.0 - 1e-9]
    centre = np.full(2, 1.0 / 3.0 if corners == 3 else 0.5)
    return places, int(np.linalg.norm(places - centre, axis=1).argmin())


def _check_pinched(path: Path, points: FloatArray, found: Neighbours) -> None:
    """Refuse nodes at which the surface meets itself: the facets round each must hang together by its edges."""
    corners = found.corners(found.boundary)
    ends, pairs, pinched = ridges(corners)
    if not len(pinched) and corners.shape[1] > 2:
        pinched = _several_fans(corners, ends, pairs)
    if len(pinched):
        raise MeshError(
            f"{path}: the body meets itself only in an edge or a point ({len(pinched)} nodes, near "
            f"{_place(points[pinched[0]])}), which carries nothing: let its parts overlap there or move them apart, "
            "and mesh it anew"
        )


def _several_fans(corners: IntArray, ends: IntArray, pairs: IntArray) -> IntArray:
    """Nodes whose facets make more than one fan, each facet joined to the next by an edge (``ends`` of ``pairs``)."""
    base = len(corners)
    code = np.unique(corners * base + np.arange(base)[:, None])  # a facet at a node
    links = [np.searchsorted(code, ends[:, [end]] * base + pairs) for end in (0, 1)]
    one, other = np.vstack(links).T
    graph = coo_matrix((np.ones(len(one)), (one, other)), shape=(len(code), len(code)))
    _, fan = connected_components(graph, directed=False)
    node, count = np.unique(np.unique(np.column_stack([code // base, fan]), axis=0)[:, 0], return_counts=True)
    return np.asarray(node[count > 1])


def check_flat_faces(path: Path, points: FloatArray, found: Neighbours) -> None:
    """Refuse first-order cells whose surface bends a little from facet to facet: it stands for a curved one.

    Raises
    ------
    MeshError
        With the bend, and how gmsh makes second-order cells.
    """
    corners = found.corners(found.boundary)
    faces = _surface_points(points, found)
    warp = np.einsum("fqd,fd->fq", faces.normals, faces.normals[:, faces.middle]).min(axis=1)
    ends, pairs, _ = ridges(corners)
    middle = faces.normals[pairs, faces.middle]
    turn = np.degrees(np.arccos(np.clip(np.einsum("rd,rd->r", middle[:, 0], middle[:, 1]), -1.0, 1.0)))
    bent = (turn > FLAT_DEG) & (turn < SHARP_DEG)
    warped = np.degrees(np.arccos(np.clip(warp, -1.0, 1.0))) > FLAT_DEG
    if bent.any() or warped.any():
        worst = int(np.argmax(np.where(bent, turn, 0.0)))
        at, how = points[ends[worst]].mean(axis=0), f"{int(bent.sum())} bends of up to {turn[worst]:.3g} degrees"
        if not bent.any():
            at, how = points[corners[np.argmax(warped)]].mean(axis=0), f"{int(warped.sum())} facets that are not flat"
        raise MeshError(
            f"{path}: first-order cells with {how} in their surface, as near {_place(at)}: straight edges stand for a "
            "curved face there; mesh it with second order (Mesh.ElementOrder = 2, or gmsh -order 2)"
        )
