"""The meridian mesh of a bellows: a structured band of curved quadratic cells, plus rings.

The wall and the cap are one band of stations along the outline, each with layers from the cavity side to the
outside. The band's nine-node quadrilaterals are kept, or split along one diagonal into triangles: both meshes share
all nodes. Meshed rings are triangulated by gmsh and joined node to node.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from meshes.bellows import FloatArray, cap_band, check_shape, corner_band, wall_segments
from meshes.by_gmsh.ring import RingShape, ring_triangles
from meshes.cells import QUADRILATERAL_NODES, CellKind
from meshes.errors import GeometryError, MeshError
from meshes.quality import jacobians
from meshes.shape import BellowsShape
from meshes.solid import FACETS, REGIONS, TRIANGLE_EDGES, IntArray, SolidMesh

# Nodes closer than this are one; those of a mesh are farther apart than a micrometre.
_SAME_NODE_MM = 1e-6


@dataclass(frozen=True)
class Resolution:
    """How fine a meridian is; one level finer doubles every count, so that levels are nested.

    Attributes
    ----------
    through
        Cells through the wall.
    cell_mm
        Largest cell length along straight pieces.
    arc_rad
        Largest angle a cell turns through along arcs.
    cap_cells
        Cells along the flat part of the cap.
    refinement
        Factor on all counts: 1, 2, 4, ...
    """

    through: int
    cell_mm: float
    arc_rad: float = math.pi / 6
    cap_cells: int = 4
    refinement: int = 1


def default_resolution(shape: BellowsShape, refinement: int = 1, cells: CellKind = "triangles") -> Resolution:
    """The coarsest resolution worth using.

    Triangles: no more than 2/3 mm through the wall and half a wall along it. Quadrilaterals, whose elements see more
    with fewer: no more than 1 mm through the wall and two thirds of it along. At 20 kPa the tip on either is within
    0.5 % of the converged one for walls of 1 and 2 mm (``make study`` prints it).
    """
    if cells == "quadrilaterals":
        through = max(1, math.ceil(shape.wall_mm - 1e-9))
        return Resolution(through, shape.wall_mm / 1.5, math.pi / 4, refinement=refinement)
    return Resolution(
        through=max(2, math.ceil(1.5 * shape.wall_mm - 1e-9)),
        cell_mm=0.5 * shape.wall_mm,
        refinement=refinement,
    )


@dataclass(frozen=True)
class Band:
    """Stations along the outline (with mid-stations) and what each interval between them is.

    ``inner`` and ``outer`` have shape (2 m + 1, 2) for m intervals; ``kinds`` and ``index`` have length m.
    """

    inner: FloatArray
    outer: FloatArray
    kinds: tuple[str, ...]
    index: tuple[int, ...]


def bellows_band(shape: BellowsShape, resolution: Resolution) -> Band:
    """Stations of the whole band from the clamped end to the axis of the cap, or to the open end."""
    inner: list[FloatArray] = []
    outer: list[FloatArray] = []
    kinds: list[str] = []
    index: list[int] = []

    def add(kind: str, count: int, number: int, band: Callable[[FloatArray], tuple[FloatArray, FloatArray]]) -> None:
        first = 1 if inner else 0  # neighbours share their end station
        fraction = np.linspace(0.0, 1.0, 2 * count + 1)[first:]
        side_in, side_out = band(fraction)
        inner.append(side_in)
        outer.append(side_out)
        kinds.extend([kind] * count)
        index.extend([number] * count)

    factor = resolution.refinement
    for piece in wall_segments(shape):
        by_length = math.ceil(piece.length_mm / resolution.cell_mm - 1e-9)
        by_angle = math.ceil(piece.angle_rad / resolution.arc_rad - 1e-9)
        count = by_angle if piece.angle_rad > 0.0 else by_length
        add(piece.kind, max(1, count) * factor, piece.index, piece.band)
    if shape.has_cap:
        add("corner", 4 * factor, shape.convolutions, lambda s: corner_band(shape, s))
        add("cap", resolution.cap_cells * factor, shape.convolutions, lambda s: cap_band(shape, s))
    inner_all, outer_all = np.vstack(inner), np.vstack(outer)
    if shape.has_cap:
        inner_all[-1, 0] = outer_all[-1, 0] = 0.0  # exactly on the axis: revolved nodes there must coincide
    return Band(inner_all, outer_all, tuple(kinds), tuple(index))


def split_quadrilaterals(quads: IntArray, corner_nodes: IntArray, points: FloatArray) -> tuple[IntArray, IntArray]:
    """Split nine-node quadrilaterals into two six-node triangles each, along the diagonal that suits.

    A diagonal through a corner of the outline is taken, so that no triangle has all its corners on the
    boundary; otherwise the shorter one.

    Parameters
    ----------
    quads
        Shape (m, 9): lattice order, node 3 i + j at station i and layer j of (0, 1, 2).
    corner_nodes
        Nodes at which two boundary edges of one quadrilateral meet.

    Returns
    -------
    triangles, parents
        Shapes (2 m, 6) and (2 m,).
    """
    a, b, c, d = quads[:, 0], quads[:, 6], quads[:, 8], quads[:, 2]  # corners in turn; diagonals a-c, b-d
    length_ac = np.linalg.norm(points[a] - points[c], axis=1)
    length_bd = np.linalg.norm(points[b] - points[d], axis=1)
    use_ac = length_ac <= length_bd * (1.0 + 1e-9)
    use_ac[np.isin(a, corner_nodes) | np.isin(c, corner_nodes)] = True
    use_ac[np.isin(b, corner_nodes) | np.isin(d, corner_nodes)] = False

    # Lattice positions of the six nodes (three corners, then the mid-edge nodes of TRIANGLE_EDGES).
    with_ac = ((0, 6, 8, 7, 4, 3), (0, 8, 2, 5, 1, 4))
    with_bd = ((0, 6, 2, 4, 1, 3), (6, 8, 2, 5, 4, 7))
    triangles = np.empty((len(quads), 2, 6), dtype=np.int64)
    for k in range(2):
        triangles[use_ac, k] = quads[use_ac][:, with_ac[k]]
        triangles[~use_ac, k] = quads[~use_ac][:, with_bd[k]]
    return triangles.reshape(-1, 6), np.repeat(np.arange(len(quads)), 2)


def meridian_mesh(
    shape: BellowsShape,
    resolution: Resolution,
    ring: RingShape | None = None,
    cells: CellKind = "triangles",
) -> SolidMesh:
    """Mesh the meridian of a bellows.

    Parameters
    ----------
    shape
        The dimensions; checked first.
    resolution
        The cell counts.
    ring
        Cross-section of rings to mesh and join to every seat (triangles only); None leaves the seats as named
        surfaces.
    cells
        Kind of cells. The first axis of a quadrilateral runs along the outline, towards the axis of revolution in
        the cap; the second from the cavity side to the outside.

    Returns
    -------
    SolidMesh
        Quadratic cells in (r, z).

    Raises
    ------
    GeometryError
        If the shape cannot be built, or the mesh of it has a cell that is folded over.
    """
    check_shape(shape)
    if ring is not None and cells != "triangles":
        raise GeometryError("meshed rings need a mesh of triangles: their section is not structured")
    band = bellows_band(shape, resolution)
    layers = 2 * resolution.through * resolution.refinement + 1
    stations = len(band.inner)
    weight = np.linspace(0.0, 1.0, layers)[None, :, None]
    lattice = (1.0 - weight) * band.inner[:, None, :] + weight * band.outer[:, None, :]
    points = np.asarray(lattice, dtype=np.float64).reshape(-1, 2)
    points[np.abs(points[:, 0]) < 1e-12, 0] = 0.0
    node = np.arange(stations * layers).reshape(stations, layers)

    quads = np.stack(
        [node[i : stations - 2 + i : 2, j : layers - 2 + j : 2] for i in range(3) for j in range(3)], axis=-1
    ).reshape(-1, 9)
    rows = layers // 2  # quadrilaterals through the wall
    kinds = np.array(band.kinds)
    quad_regions = np.where(np.isin(kinds, ("corner", "cap")), REGIONS["cap"], REGIONS["elastomer"])

    regions = np.repeat(quad_regions, rows)
    if cells == "triangles":
        ends = node[[0, 0, -1, -1], [0, -1, 0, -1]]
        nodes, parents = split_quadrilaterals(quads, ends, points)
        regions = regions[parents]
    else:
        nodes = quads[:, 3 * QUADRILATERAL_NODES[:, 0] + QUADRILATERAL_NODES[:, 1]]

    edges, tags, bodies = _band_edges(band, shape, node, points)
    if ring is not None:
        points, nodes, regions, edges, tags, bodies = _join_rings(
            shape, ring, points, nodes, regions, edges, tags, bodies
        )
    _refuse_folded(points, nodes)
    return SolidMesh(points, nodes, regions, np.sort(edges, axis=1), tags, bodies, int(node[-1, -1]))


def _band_edges(
    band: Band, shape: BellowsShape, node: IntArray, points: FloatArray
) -> tuple[IntArray, IntArray, IntArray]:
    """Boundary edges of the band: corner nodes (k, 2), surface numbers (k,), seat numbers (k,)."""
    count = len(band.kinds)
    starts, stops = node[0:-2:2], node[2::2]
    cavity = np.column_stack([starts[:, 0], stops[:, 0]])
    outside = np.column_stack([starts[:, -1], stops[:, -1]])
    distal = np.isclose(points[outside][:, :, 1], shape.cavity_length_mm + shape.cap_mm).all(axis=1)
    outside_tags = np.full(count, FACETS["outer"])
    outside_bodies = np.full(count, -1)
    for k, (kind, number) in enumerate(zip(band.kinds, band.index, strict=True)):
        if kind == "seat":
            outside_tags[k], outside_bodies[k] = FACETS["bond"], number
        elif kind == "corner" and distal[k]:
            outside_tags[k] = FACETS["tip"]
    clamped = np.column_stack([node[0, 0:-2:2], node[0, 2::2]])
    last = np.column_stack([node[-1, 0:-2:2], node[-1, 2::2]])  # on the axis, or the annulus of an open end
    edges = np.vstack([cavity, outside, clamped, last])
    tags = np.concatenate(
        [
            np.full(count, FACETS["cavity"]),
            outside_tags,
            np.full(len(clamped), FACETS["clamped"]),
            np.full(len(last), FACETS["axis" if shape.has_cap else "tip"]),
        ]
    )
    bodies = np.concatenate([np.full(count, -1), outside_bodies, np.full(len(clamped) + len(last), -1)])
    return edges, tags, bodies


def _join_rings(
    shape: BellowsShape,
    ring: RingShape,
    points: FloatArray,
    cells: IntArray,
    regions: IntArray,
    edges: IntArray,
    tags: IntArray,
    bodies: IntArray,
) -> tuple[FloatArray, IntArray, IntArray, IntArray, IntArray, IntArray]:
    """Mesh one ring with gmsh, copy it to every seat and merge its nodes with the seat's."""
    seat_edges = edges[tags == FACETS["bond"]]
    seat_bodies = bodies[tags == FACETS["bond"]]
    seat_corners = points[np.unique(seat_edges[seat_bodies == 1])]
    crest_z = shape.crest_positions_mm
    seat_z = np.sort(seat_corners[:, 1]) - crest_z[1]
    ring_points, ring_cells = ring_triangles(ring, seat_z, shape.seat_radius_mm)

    all_points, all_cells = [points], [cells]
    offset = len(points)
    for z in crest_z:
        all_points.append(ring_points + np.array([0.0, z]))
        all_cells.append(ring_cells + offset)
        offset += len(ring_points)
    joined, joined_cells = np.vstack(all_points), np.vstack(all_cells)
    # A ring's nodes on its seat, corners and midsides, are the wall's; gmsh has them some 1e-13 mm away.
    distance, nearest = cKDTree(points).query(joined[len(points) :], distance_upper_bound=_SAME_NODE_MM)
    on_wall = np.isfinite(distance)
    expected = 2 * len(seat_edges) + len(crest_z)
    if len(np.unique(nearest[on_wall])) != on_wall.sum() or on_wall.sum() != expected:
        raise MeshError(
            f"rings: they share {on_wall.sum()} nodes with seats that have {expected}"
        )  # a fault of this program
    keep = np.concatenate([np.arange(len(points)), len(points) + np.flatnonzero(~on_wall)])
    merged = np.empty(len(joined), dtype=np.int64)
    merged[keep] = np.arange(len(keep))
    merged[len(points) :][on_wall] = nearest[on_wall]
    new_cells = merged[joined_cells]
    new_regions = np.concatenate([regions, np.full(len(new_cells) - len(cells), REGIONS["ring"])])

    # The seats are now inside; the ring's free edges join the outside.
    ring_edges = np.vstack([new_cells[len(cells) :][:, list(e)] for e in TRIANGLE_EDGES])
    unique, counts = np.unique(np.sort(ring_edges, axis=1), axis=0, return_counts=True)
    free = unique[counts == 1]
    on_seat = np.isclose(joined[keep][free][:, :, 0], shape.seat_radius_mm, atol=1e-9).all(axis=1)
    free = free[~on_seat]
    stay = tags != FACETS["bond"]
    return (
        joined[keep],
        new_cells,
        new_regions,
        np.vstack([edges[stay], free]),
        np.concatenate([tags[stay], np.full(len(free), FACETS["outer"])]),
        np.concatenate([bodies[stay], np.full(len(free), -1)]),
    )


def _refuse_folded(points: FloatArray, cells: IntArray) -> None:
    signed = jacobians(points, cells)
    signed = signed * np.sign(signed.mean(axis=1, keepdims=True))
    worst = int(np.argmin(signed.min(axis=1)))
    if signed[worst].min() <= 0.0:
        r, z = points[cells[worst]].mean(axis=0)
        raise GeometryError(
            f"cell {worst} at r = {r:.3g}, z = {z:.3g} mm folds over itself: in the wall, it is too thick for its "
            "curvature (take a larger fillet_mm or a thinner wall_mm); in the cap, the fillet is too large for it "
            "(take a smaller fillet_mm or a thicker cap_mm)"
        )
