"""Simple bodies with exact or published answers.

Meridians of a tube, a half sphere, a cylinder and an ellipsoid open at its base; a block, and Cook's membrane.
The meridians are swept by `meshes.revolve` and `meshes.sweep` like any other.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from meshes.cells import HEXAHEDRON_NODES, QUADRILATERAL_NODES, CellKind
from meshes.errors import GeometryError
from meshes.meridian import split_quadrilaterals
from meshes.solid import FACETS, REGIONS, FloatArray, IntArray, SolidMesh

# Walls whose outer radius is more than so many times the inner one are graded. Two cells, the fewest through a wall,
# then double the radius each.
GRADED_BEYOND = 4.0


def _require_radii(inner_mm: float, outer_mm: float) -> None:
    if not 0.0 < inner_mm < outer_mm < math.inf:
        raise GeometryError(f"radii {inner_mm:g}, {outer_mm:g} mm: need 0 < inner < outer")


def cells_through(ratio: float, cells: int) -> int:
    """Cells through a wall whose outer radius is ``ratio`` times the inner one: of a graded wall more.

    As many as are given for each factor `GRADED_BEYOND`, so that no cell is longer for its radius than in other walls.
    """
    return cells * math.ceil(max(1.0, math.log(ratio) / math.log(GRADED_BEYOND)))


def _layers(inner_mm: float, outer_mm: float, through: int, ratio: float) -> FloatArray:
    """Radii of the layers of nodes through a wall, mm: equally spaced, or of a thick wall in a geometric sequence.

    Displacements fall like 1/r in a tube and 1/r^2 in a sphere, so in ln r they are as smooth near the bore as far from
    it, and so are the stresses; mid-nodes are in the sequence too, so that the mapping is smooth and the order is kept.
    """
    spaced = np.geomspace if ratio > GRADED_BEYOND else np.linspace
    return spaced(inner_mm, outer_mm, 2 * through + 1)


def tube_meridian(
    inner_mm: float, outer_mm: float, length_mm: float, along: int, through: int, cells: CellKind = "triangles"
) -> SolidMesh:
    """Meridian of a tube: 0 <= z <= length, inner <= r <= outer; a thick wall is graded, see `GRADED_BEYOND`.

    Parameters
    ----------
    inner_mm, outer_mm, length_mm
        Radii and length, mm.
    along, through
        Cells along the axis and through the wall.
    cells
        Kind of cells.

    Returns
    -------
    SolidMesh
        Surfaces ``cavity`` (inside), ``outer``, ``bottom`` and ``top``.
    """
    _require_radii(inner_mm, outer_mm)
    if not 0.0 < length_mm < math.inf:
        raise GeometryError(f"length {length_mm:g} mm: must be positive")
    z = length_mm * np.linspace(0.0, 1.0, 2 * along + 1)
    r = _layers(inner_mm, outer_mm, through, outer_mm / inner_mm)
    lattice = np.stack([np.broadcast_to(r, (len(z), len(r))), np.broadcast_to(z[:, None], (len(z), len(r)))], axis=-1)
    return lattice_meridian(lattice, ("cavity", "outer", "bottom", "top"), cells)


def sphere_meridian(
    inner_mm: float, outer_mm: float, along: int, through: int, cells: CellKind = "triangles"
) -> SolidMesh:
    """Meridian of the upper half of a sphere, from the equator z = 0 to the axis; a thick wall is graded.

    Parameters
    ----------
    inner_mm, outer_mm
        Radii, mm.
    along, through
        Cells from equator to pole and through the wall.
    cells
        Kind of cells.

    Returns
    -------
    SolidMesh
        Surfaces ``cavity`` (inside), ``outer``, ``bottom`` (the equator's plane) and ``axis``.
    """
    _require_radii(inner_mm, outer_mm)
    angle = 0.5 * math.pi * np.linspace(0.0, 1.0, 2 * along + 1)[:, None]
    radius = _layers(inner_mm, outer_mm, through, outer_mm / inner_mm)
    lattice = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    lattice[-1, :, 0] = 0.0
    lattice[0, :, 1] = 0.0
    return lattice_meridian(lattice, ("cavity", "outer", "bottom", "axis"), cells)


def cylinder_meridian(
    radius_mm: float, length_mm: float, inwards: int, along: int, cells: CellKind = "triangles"
) -> SolidMesh:
    """Meridian of a solid cylinder: 0 <= r <= radius, 0 <= z <= length.

    Parameters
    ----------
    radius_mm, length_mm
        Size, mm.
    inwards, along
        Cells from the surface to the axis, and along it.
    cells
        Kind of cells.

    Returns
    -------
    SolidMesh
        Surfaces ``outer``, ``bottom``, ``top`` and ``axis``.
    """
    if not (0.0 < radius_mm < math.inf and 0.0 < length_mm < math.inf):
        raise GeometryError(f"cylinder of radius {radius_mm:g}, length {length_mm:g} mm: both must be positive")
    r = radius_mm * np.linspace(1.0, 0.0, 2 * inwards + 1)[:, None]
    z = length_mm * np.linspace(0.0, 1.0, 2 * along + 1)
    lattice = np.stack(np.broadcast_arrays(r, z), axis=-1)
    return lattice_meridian(lattice, ("bottom", "top", "outer", "axis"), cells)


def ventricle_meridian(
    inner_mm: tuple[float, float],
    outer_mm: tuple[float, float],
    base_mm: float,
    along: int,
    through: int,
    cells: CellKind = "triangles",
) -> SolidMesh:
    """Meridian of a wall between two ellipsoids of revolution, cut off by a plane: an idealised ventricle, apex up.

    Surfaces between the two are ellipsoids too, with semi-axes in between (Land et al. 2015, problem 2); a thick wall
    is graded.

    Parameters
    ----------
    inner_mm, outer_mm
        Semi-axes of the surfaces across and along the axis, mm.
    base_mm
        The body is cut off so far below the ellipsoids' centre, z = -base.
    along, through
        Cells from the base to the apex and through the wall.
    cells
        Kind of cells.

    Returns
    -------
    SolidMesh
        Surfaces ``cavity``, ``outer``, ``clamped`` (the base) and ``axis``; the tip is the apex outside.
    """
    if not (0.0 < inner_mm[0] < outer_mm[0] and 0.0 <= base_mm < inner_mm[1] < outer_mm[1] < math.inf):
        raise GeometryError(
            f"semi-axes {inner_mm} and {outer_mm} mm, base {base_mm:g} mm: need 0 < inner < outer and base < the inner "
            "one along the axis"
        )
    ratio = max(b / a for a, b in zip(inner_mm, outer_mm, strict=True))
    across, up = (_layers(a, b, through, ratio) for a, b in zip(inner_mm, outer_mm, strict=True))
    share = np.linspace(0.0, 1.0, 2 * along + 1)[:, None]
    start = -np.arcsin(base_mm / up)
    angle = start + share * (0.5 * math.pi - start)
    lattice = np.stack([across * np.cos(angle), up * np.sin(angle)], axis=-1)
    lattice[-1, :, 0] = 0.0
    lattice[0, :, 1] = -base_mm
    return lattice_meridian(lattice, ("cavity", "outer", "clamped", "axis"), cells)


def lattice_meridian(lattice: FloatArray, sides: tuple[str, str, str, str], cells: CellKind) -> SolidMesh:
    """Mesh a lattice of nodes, shape (2 a + 1, 2 b + 1, 2); sides: second index low, high, first index low, high."""
    stations, layers, _ = lattice.shape
    points = lattice.reshape(-1, 2)
    node = np.arange(len(points)).reshape(stations, layers)
    quads = np.stack(
        [node[i : stations - 2 + i : 2, j : layers - 2 + j : 2] for i in range(3) for j in range(3)], axis=-1
    ).reshape(-1, 9)
    if cells == "triangles":
        numbers, _ = split_quadrilaterals(quads, node[[0, 0, -1, -1], [0, -1, 0, -1]], points)
    else:
        numbers = quads[:, 3 * QUADRILATERAL_NODES[:, 0] + QUADRILATERAL_NODES[:, 1]]
    edges, tags = [], []
    for name, line in zip(sides, (node[::2, 0], node[::2, -1], node[0, ::2], node[-1, ::2]), strict=True):
        edges.append(np.column_stack([line[:-1], line[1:]]))
        tags.append(np.full(len(line) - 1, FACETS[name]))
    facet_tags = np.concatenate(tags)
    return SolidMesh(
        points=points,
        cells=numbers,
        regions=np.full(len(numbers), REGIONS["elastomer"]),
        facets=np.sort(np.vstack(edges), axis=1),
        facet_tags=facet_tags,
        facet_bodies=np.full(len(facet_tags), -1),
        tip_centre_node=int(node[-1, -1]),
    )


def block(size_mm: tuple[float, float, float], counts: tuple[int, int, int]) -> SolidMesh:
    """A block 0 <= x, y, z <= size of 27-node hexahedra; all of its surface is ``outer``.

    Parameters
    ----------
    size_mm
        Edge lengths, mm.
    counts
        Cells along each edge.

    Returns
    -------
    SolidMesh
        ``tip_centre_node`` is the corner at the origin.
    """
    if not all(0.0 < size < math.inf for size in size_mm):
        raise GeometryError(f"block of {size_mm} mm: every edge must be positive")
    axes = [size * np.linspace(0.0, 1.0, 2 * n + 1) for size, n in zip(size_mm, counts, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    node = np.arange(len(points)).reshape([len(axis) for axis in axes])

    def at(i: int, j: int, k: int) -> IntArray:
        shape = node.shape
        return node[i : shape[0] - 2 + i : 2, j : shape[1] - 2 + j : 2, k : shape[2] - 2 + k : 2].ravel()

    cells = np.stack([at(*ijk) for ijk in HEXAHEDRON_NODES.tolist()], axis=1)
    facets = []
    for axis in range(3):
        for end in (0, -1):
            face = np.take(node, end, axis=axis)[::2, ::2]
            corners = (face[:-1, :-1], face[1:, :-1], face[:-1, 1:], face[1:, 1:])
            facets.append(np.stack([c.ravel() for c in corners], axis=1))
    every = np.sort(np.vstack(facets), axis=1)
    return SolidMesh(
        points=points,
        cells=cells,
        regions=np.full(len(cells), REGIONS["elastomer"]),
        facets=every,
        facet_tags=np.full(len(every), FACETS["outer"]),
        facet_bodies=np.full(len(every), -1),
        tip_centre_node=0,
    )


def cook_membrane(cells: int, thickness_mm: float = 1.0) -> SolidMesh:
    """Cook's membrane, corners (0, 0), (48, 44), (48, 60), (0, 44) mm, one layer of 27-node hexahedra thick.

    R. D. Cook, J. Struct. Div. ASCE 100 (1974) 1851. Cells crowd at the four corners, where stresses are
    singular: at the clamped ones, and where the traction on the right edge meets the free ones.

    Parameters
    ----------
    cells
        Cells along each of the two directions, an even number.
    thickness_mm
        Thickness, mm.

    Returns
    -------
    SolidMesh
        Surfaces ``clamped`` (left), ``tip`` (right), ``bottom`` and ``top`` (the two faces), ``outer``; the tip's node
        is the upper right corner of the lower face.
    """
    if cells < 2 or cells % 2:
        raise GeometryError(f"cells along an edge = {cells}: must be even and at least 2")
    mesh = block((1.0, 1.0, 1.0), (cells, cells, 1))
    lines = np.linspace(0.0, 1.0, cells + 1)
    crowded = np.where(lines <= 0.5, 2.0 * lines**2, 1.0 - 2.0 * (1.0 - lines) ** 2)
    x, y = (np.interp(mesh.points[:, i], lines, crowded) for i in (0, 1))
    z = mesh.points[:, 2]
    middle = mesh.points[mesh.facets].mean(axis=1)
    tags = np.full(len(middle), FACETS["outer"])
    for name, axis, at in (("clamped", 0, 0.0), ("tip", 0, 1.0), ("bottom", 2, 0.0), ("top", 2, 1.0)):
        tags[middle[:, axis] == at] = FACETS[name]
    low, high = 44.0 * x, 44.0 + 16.0 * x
    points = np.column_stack([48.0 * x, low + y * (high - low), thickness_mm * z])
    corner = int(np.argmin(np.abs(mesh.points - [1.0, 1.0, 0.0]).sum(axis=1)))
    return replace(mesh, points=points, facet_tags=tags, tip_centre_node=corner)


def joined(one: SolidMesh, other: SolidMesh) -> SolidMesh:
    """Two meshes of the same cells as one; they share no node, wherever they are. The tip is that of the first."""
    shift = len(one.points)
    return replace(
        one,
        points=np.vstack([one.points, other.points]),
        cells=np.vstack([one.cells, other.cells + shift]),
        regions=np.concatenate([one.regions, other.regions]),
        facets=np.vstack([one.facets, other.facets + shift]),
        facet_tags=np.concatenate([one.facet_tags, other.facet_tags]),
        facet_bodies=np.concatenate([one.facet_bodies, other.facet_bodies]),
    )
