"""The one kind of cells that a user's mesh may have, in this program's order of nodes; all else is refused by name."""

from __future__ import annotations

import numpy as np

from meshes.cells import CellShape, FloatArray, IntArray, cell_shape
from meshes.errors import MeshError
from meshes.users.contents import Contents, Elements, Kind, counted
from meshes.users.refine import linear_weights, numbered

# Cells that are taken, by dimension and corners: nodes of the second-order cell that each becomes.
TAKEN = {(2, 3): 6, (2, 4): 9, (3, 4): 10, (3, 8): 27}
WANTED = {
    2: "a meridian takes triangles of 6 nodes or quadrilaterals of 9, of one kind",
    3: "a body takes tetrahedra of 10 nodes or hexahedra of 27, of one kind",
}
# How gmsh makes all cells of one kind (checked with gmsh 4.8).
_ONE_KIND = {
    2: "triangles: without Recombine Surface and Mesh.RecombineAll; quadrilaterals: Mesh.RecombineAll = 1 with "
    "Mesh.SubdivisionAlgorithm = 1",
    3: "tetrahedra: extrude without Recombine and leave out Mesh.RecombineAll and transfinite volumes that recombine; "
    "hexahedra: Mesh.SubdivisionAlgorithm = 2, or all volumes transfinite with their surfaces recombined",
}
# A mesh is flat if it leaves its plane by less than this part of its size.
FLAT = 1e-5


def cells_of(contents: Contents) -> tuple[Elements, CellShape]:
    """The elements of the highest dimension, which are the cells, and the reference cell they become.

    Raises
    ------
    MeshError
        If there are none, or of several kinds, or of one that is not taken, or a surface in space; with what the file
        holds, what is wanted, and the option of gmsh that gives it.
    """
    path = contents.path
    highest = max((part.kind.dimension for part in contents.elements), default=0)
    parts = contents.of_dimension(highest)
    if highest < 2:
        held = counted(parts) if parts else "no elements"
        raise MeshError(
            f"{path}: holds {held} and no cells: mesh it before saving (gmsh -3, a meridian -2) and save all of it "
            '(Mesh.SaveAll = 1) or name the volume (Physical Volume("body") = {1};)'
        )
    if highest == 2:
        _check_plane(contents, parts)
    if len(parts) > 1:
        raise MeshError(
            f"{path}: holds {counted(parts)}: {WANTED[highest]}; mesh it with one kind of cells and one order "
            f"({_ONE_KIND[highest]})"
        )
    kind = parts[0].kind
    if (highest, kind.corners) not in TAKEN:
        raise MeshError(f"{path}: holds {counted(parts)}: {WANTED[highest]} ({_ONE_KIND[highest]})")
    if kind.order > 2:
        raise MeshError(
            f"{path}: holds {counted(parts)}, of order {kind.order}: {WANTED[highest]}; mesh it with second order "
            "(Mesh.ElementOrder = 2, or gmsh -order 2)"
        )
    nodes = TAKEN[highest, kind.corners]
    if kind.order == 2 and kind.nodes != nodes:
        raise MeshError(
            f"{path}: holds {counted(parts)}, of second order without nodes on faces and inside: {WANTED[highest]}; "
            "mesh it with Mesh.SecondOrderIncomplete = 0"
        )
    return parts[0], cell_shape(highest, nodes)


def _check_plane(contents: Contents, parts: tuple[Elements, ...]) -> None:
    """Refuse surfaces that do not lie in gmsh's plane z = 0."""
    used = np.unique(np.concatenate([part.nodes.ravel() for part in parts]))
    points = contents.points[contents.places(used)]
    low, high = points.min(axis=0), points.max(axis=0)
    size = float((high - low).max())
    if max(abs(low[2]), abs(high[2])) <= FLAT * size:
        return
    held = f"{contents.path}: holds {counted(parts)}"
    flat = [axis for axis in range(3) if high[axis] - low[axis] <= FLAT * size]
    if flat:
        where = f"in the plane {'xyz'[flat[0]]} = {low[flat[0]]:g}"
        raise MeshError(f"{held} {where}: a meridian lies in z = 0, with x = r and y = z; move or turn it there")
    raise MeshError(
        f"{held} of a surface in space, and no cells of a volume: mesh it in 3D (gmsh -3) and save the volume too: "
        'name it (Physical Volume("body") = {1};), for once anything is named gmsh saves only that, or save all '
        "(Mesh.SaveAll = 1); a meridian lies in z = 0"
    )


def in_own_order(
    points: FloatArray, cells: IntArray, kind: Kind, cell: CellShape
) -> tuple[FloatArray, IntArray, IntArray]:
    """Cells with their nodes in this program's order; those of first order get nodes midway on their straight edges.

    Parameters
    ----------
    points, cells
        Positions and rows of them in gmsh's order, shapes (n, d) and (m, nodes of the kind).

    Returns
    -------
    points, cells
        Of second order; of a second-order mesh the points are as they were.
    place
        The row that each given point has become, shape (n,).
    """
    # gmsh's simplices are the unit ones, its squares and cubes go from -1 to 1
    places = kind.places if cell.corners == cell.dimension + 1 else 0.5 * (kind.places + 1.0)
    apart = np.linalg.norm(cell.nodes[: kind.nodes, None] - places, axis=-1)
    cells = cells[:, apart.argmin(axis=1)]
    place = np.arange(len(points))
    if kind.order == 2:
        return points, cells, place
    weights = linear_weights(cell, cell.nodes)
    raised, first = numbered(cells, np.rint(8.0 * weights).astype(np.int64))
    at, which = np.divmod(first, len(cell.nodes))
    place[cells] = raised[:, : cell.corners]
    return np.einsum("nk,nkd->nd", weights[which], points[cells[at]]), raised, place
