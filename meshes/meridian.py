"""The meridian mesh of a bellows: a structured band of curved quadratic cells, plus rings.

The wall and the cap are one band of stations along the outline, each with layers from the cavity side to the
outside. Towards the edges of the seats, where a rigid bond ends and the solution is singular, its cells may be cut into
smaller ones (`meshes.strip.corners`). The band's nine-node quadrilaterals are kept, or split along one diagonal into
triangles. Meshed rings are blocks of quadrilaterals, or triangulated by gmsh and joined node to node.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.spatial import cKDTree

from meshes.bellows import FloatArray, cap_band, check_shape, corner_band, wall_segments
from meshes.by_gmsh.ring import RingShape, ring_triangles
from meshes.cells import QUADRILATERAL_NODES, CellKind
from meshes.errors import GeometryError, MeshError
from meshes.quality import jacobians
from meshes.shape import BellowsShape
from meshes.solid import FACETS, REGIONS, TRIANGLE_EDGES, IntArray, SolidMesh
from meshes.strip.corners import number_nodes, strip_cells
from meshes.strip.ring_blocks import with_ring_blocks

# Nodes closer than this are one; those of a mesh are farther apart than a micrometre.
_SAME_NODE_MM = 1e-6


@dataclass(frozen=True)
class Resolution:
    """How fine a meridian is; one level finer cuts every cell into four, so that levels are nested.

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
    edge_cuts
        How often the cells at the edges of the seats are cut, each time to half their size, before all are divided.
    """

    through: int
    cell_mm: float
    arc_rad: float = math.pi / 6
    cap_cells: int = 4
    refinement: int = 1
    edge_cuts: int = 0


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
class Stretch:
    """A smooth part of the band.

    Attributes
    ----------
    kind, index
        What it is, and the number of the crest or root it belongs to.
    intervals
        Into how many it is cut on the coarsest level.
    band
        Its two sides, (m, 2) each, at fractions (m,) of it.
    """

    kind: str
    index: int
    intervals: int
    band: Callable[[FloatArray], tuple[FloatArray, FloatArray]]


def stretches(shape: BellowsShape, resolution: Resolution) -> tuple[Stretch, ...]:
    """The whole band from the clamped end to the axis of the cap, or to the open end."""
    found = []
    for piece in wall_segments(shape):
        by_length = math.ceil(piece.length_mm / resolution.cell_mm - 1e-9)
        by_angle = math.ceil(piece.angle_rad / resolution.arc_rad - 1e-9)
        count = by_angle if piece.angle_rad > 0.0 else by_length
        found.append(Stretch(piece.kind, piece.index, max(1, count), piece.band))
    if shape.has_cap:
        found.append(Stretch("corner", shape.convolutions, 4, partial(corner_band, shape)))
        found.append(Stretch("cap", shape.convolutions, resolution.cap_cells, partial(cap_band, shape)))
    return tuple(found)


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
    """Stations of the whole band; those of cells cut towards an edge are not among them."""
    parts, factor = stretches(shape, resolution), resolution.refinement
    counts = [part.intervals * factor for part in parts]
    sides = _sides(parts, np.arange(2 * sum(counts) + 1) / (2.0 * factor))
    kinds = [part.kind for part, count in zip(parts, counts, strict=True) for _ in range(count)]
    index = [part.index for part, count in zip(parts, counts, strict=True) for _ in range(count)]
    return Band(*sides, tuple(kinds), tuple(index))


def _starts(parts: Sequence[Stretch]) -> IntArray:
    """Strip coordinate at which each stretch begins, and that of the end."""
    return np.concatenate([[0], np.cumsum([part.intervals for part in parts])])


def _sides(parts: Sequence[Stretch], s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points on both sides, (m, 2) each, at strip coordinates (m,); where stretches meet, those of the first."""
    starts = _starts(parts)
    own = np.maximum(np.searchsorted(starts, s, side="left") - 1, 0)
    inner, outer = np.empty((len(s), 2)), np.empty((len(s), 2))
    for k, part in enumerate(parts):
        here = own == k
        inner[here], outer[here] = part.band((s[here] - starts[k]) / part.intervals)
    if parts[-1].kind == "cap":
        end = s == starts[-1]
        inner[end, 0] = outer[end, 0] = 0.0  # exactly on the axis: revolved nodes there must coincide
    return inner, outer


def seat_edges(parts: Sequence[Stretch], layers: int) -> list[tuple[int, int]]:
    """Strip coordinates of the ends of the seats, which lie on the outside."""
    on_seat = np.array([part.kind == "seat" for part in parts])
    return [(int(s), layers) for s in _starts(parts)[1:-1][on_seat[1:] != on_seat[:-1]]]


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
        Cross-section of rings to mesh and join to every seat; None leaves the seats as named surfaces.
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
    parts, through = stretches(shape, resolution), resolution.through
    strip, quads = number_nodes(
        strip_cells(
            int(_starts(parts)[-1]),
            through,
            seat_edges(parts, through),
            resolution.edge_cuts,
            resolution.refinement,
        )
    )
    points = _points(parts, through, strip)
    on_cap = np.array([part.kind in ("corner", "cap") for part in parts])
    stretch = np.searchsorted(_starts(parts), strip[quads[:, 4], 0]) - 1
    regions = np.where(on_cap[stretch], REGIONS["cap"], REGIONS["elastomer"])
    edges, tags, bodies = _band_edges(parts, through, shape, strip, quads, points)
    if cells == "triangles":
        ends = np.isin(strip[:, 0], strip[[0, -1], 0]) & np.isin(strip[:, 1], strip[[0, -1], 1])
        nodes, parents = split_quadrilaterals(quads, np.flatnonzero(ends), points)
        regions = regions[parents]
        strip[quads[:, 4]] = strip[_diagonals(nodes)].mean(axis=1)
        points = _points(parts, through, strip)
    else:
        nodes = quads[:, 3 * QUADRILATERAL_NODES[:, 0] + QUADRILATERAL_NODES[:, 1]]
    tip = len(points) - 1
    if ring is not None and cells == "triangles":
        points, nodes, regions, edges, tags, bodies = _join_rings(
            shape, ring, points, nodes, regions, edges, tags, bodies
        )
    mesh = SolidMesh(points, nodes, regions, np.sort(edges, axis=1), tags, bodies, tip, strip=strip)
    if ring is not None and cells == "quadrilaterals":
        mesh = with_ring_blocks(mesh, ring, resolution.refinement)
    _refuse_folded(mesh.points, mesh.cells)
    return mesh


def _points(parts: Sequence[Stretch], through: int, strip: FloatArray) -> FloatArray:
    """Points (n, 2) at strip coordinates (n, 2)."""
    inner, outer = _sides(parts, strip[:, 0])
    weight = strip[:, 1:] / through
    points = (1.0 - weight) * inner + weight * outer
    points[np.abs(points[:, 0]) < 1e-12, 0] = 0.0
    return points


def _diagonals(triangles: IntArray) -> IntArray:
    """Ends of the edge that the two triangles of each quadrilateral share, shape (m, 2)."""
    one, other = np.moveaxis(triangles[:, :3].reshape(-1, 2, 3), 1, 0)
    return one[(one[:, :, None] == other[:, None, :]).any(axis=2)].reshape(-1, 2)


def _band_edges(
    parts: Sequence[Stretch],
    through: int,
    shape: BellowsShape,
    strip: FloatArray,
    quads: IntArray,
    points: FloatArray,
) -> tuple[IntArray, IntArray, IntArray]:
    """Boundary edges of the band: corner nodes (k, 2), surface numbers (k,), seat numbers (k,)."""
    pairs = np.sort(np.vstack([quads[:, [0, 2]], quads[:, [6, 8]], quads[:, [0, 6]], quads[:, [2, 8]]]), axis=1)
    starts = _starts(parts)

    def on(axis: int, value: float) -> IntArray:
        """Edges on one of the four sides of the strip, in order along it."""
        found = pairs[(strip[pairs, axis] == value).all(axis=1)]
        return found[np.argsort(found[:, 0])]

    cavity, outside = on(1, 0.0), on(1, through)
    clamped, last = on(0, 0.0), on(0, starts[-1])  # the last on the axis, or the annulus of an open end
    distal = np.isclose(points[outside][:, :, 1], shape.cavity_length_mm + shape.cap_mm).all(axis=1)
    outside_tags = np.full(len(outside), FACETS["outer"])
    outside_bodies = np.full(len(outside), -1)
    for k, at in enumerate(np.searchsorted(starts, strip[outside, 0].mean(axis=1)) - 1):
        if parts[at].kind == "seat":
            outside_tags[k], outside_bodies[k] = FACETS["bond"], parts[at].index
        elif parts[at].kind == "corner" and distal[k]:
            outside_tags[k] = FACETS["tip"]
    edges = np.vstack([cavity, outside, clamped, last])
    tags = np.concatenate(
        [
            np.full(len(cavity), FACETS["cavity"]),
            outside_tags,
            np.full(len(clamped), FACETS["clamped"]),
            np.full(len(last), FACETS["axis" if shape.has_cap else "tip"]),
        ]
    )
    none = np.full(len(edges), -1)
    none[len(cavity) : len(cavity) + len(outside)] = outside_bodies
    return edges, tags, none


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
