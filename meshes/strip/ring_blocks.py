r"""Rings of quadrilaterals on the seats of a meridian: one structured block each, node to node with the wall.

A block has a cell on every edge of its seat. Its outer edges are rounded by two chords each, with a corner of the block
in the middle: the arc itself would leave the cell there a corner of 180 degrees. The block of a section of height h,
outer edges of radius e and L layers, of which the outermost is the chord's:

         B-------B'
      M--|-------|--M'         A = (top - e, low), B = (top, low + e): the ends of the arc
      |  |       |  |          M: its middle
      A--+-------+--A'
      |  |       |  |
    low ---seat--- high

Levels are nested: A, B and M are where they are on the coarsest.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from meshes.by_gmsh.ring import RingShape, check_ring
from meshes.cells import QUADRILATERAL_NODES, FloatArray, IntArray
from meshes.solid import FACETS, REGIONS, SolidMesh

# Layers of cells on the coarsest level: one up to the rounded edges, one for them.
LAYERS = 2


def with_ring_blocks(meridian: SolidMesh, ring: RingShape, refinement: int) -> SolidMesh:
    """A meridian of quadrilaterals with a ring on every seat.

    Parameters
    ----------
    meridian
        Nine-node quadrilaterals whose seats are the surface ``bond``.
    ring
        The rings' section. Its outer edges stay sharp where a seat has fewer than three cells on the coarsest level.
    refinement
        Of the meridian: 1, 2, 4, ...

    Returns
    -------
    SolidMesh
        Without the surface ``bond``, which is inside now; what is free of the rings joins the surface ``outer``.

    Raises
    ------
    GeometryError
        If the rounding does not fit the section.
    """
    bond = meridian.facet_tags == FACETS["bond"]
    at_seats = np.isin(meridian.cells[:, :4], meridian.facets[bond]).sum(axis=1) > 1
    middle = _edge_middles(meridian.cells[at_seats])
    points, cells = [meridian.points], [meridian.cells]
    edges: list[IntArray] = []
    count = len(meridian.points)
    for body in np.unique(meridian.facet_bodies[bond]):
        seat = _seat(meridian, meridian.facets[bond & (meridian.facet_bodies == body)], middle)
        block = ring_block(ring, meridian.points[seat], refinement)
        rows = block.shape[1]
        grid = np.empty(block.shape[:2], dtype=np.int64)
        grid[:, 0] = seat
        grid[:, 1:] = count + np.arange(len(seat) * (rows - 1)).reshape(len(seat), rows - 1)
        count += len(seat) * (rows - 1)
        points.append(block[:, 1:].reshape(-1, 2))
        lattice = [grid[a : len(seat) - 2 + a : 2, b : rows - 2 + b : 2].ravel() for a, b in QUADRILATERAL_NODES]
        cells.append(np.stack(lattice, axis=1))
        edges += [np.column_stack([side[:-2:2], side[2::2]]) for side in (grid[0], grid[:, -1], grid[-1])]
    rings = sum(map(len, cells[1:]))
    free = np.sort(np.vstack(edges), axis=1)
    return replace(
        meridian,
        points=np.vstack(points),
        cells=np.vstack(cells),
        regions=np.concatenate([meridian.regions, np.full(rings, REGIONS["ring"])]),
        facets=np.vstack([meridian.facets[~bond], free]),
        facet_tags=np.concatenate([meridian.facet_tags[~bond], np.full(len(free), FACETS["outer"])]),
        facet_bodies=np.full(int((~bond).sum()) + len(free), -1),
    )


def ring_block(ring: RingShape, seat: FloatArray, refinement: int) -> FloatArray:
    """Nodes of a block on a seat.

    Parameters
    ----------
    seat
        Corners and middles of edges along the seat, (r, z) with z ascending, mm, shape (2 k + 1, 2).
    refinement
        As in `with_ring_blocks`.

    Returns
    -------
    ndarray
        Shape (2 k + 1, 4 refinement + 1, 2), the first row being the seat.

    Raises
    ------
    GeometryError
        If the rounding does not fit the section.
    """
    (radius, low), high = seat[0], float(seat[-1, 1])
    check_ring(ring, high - low)
    top = radius + ring.height_mm
    intervals = (len(seat) - 1) // 2 // refinement  # of the coarsest level
    edge = ring.edge_radius_mm if intervals >= 3 else 0.0
    shoulder = top - (edge or ring.height_mm / LAYERS)
    cut = edge * (1.0 - math.sqrt(0.5))
    across = np.linspace(0.0, 1.0, 2 * LAYERS * refinement + 1)
    along = np.linspace(0.0, 1.0, len(seat))
    ends = [0.0, 1.0 - 1.0 / LAYERS, 1.0]
    rise = np.interp(across, ends, [radius, shoulder, top - cut])
    inwards = np.interp(across, ends, [0.0, 0.0, cut])
    stations = [0.0, 1.0 / intervals, 1.0 - 1.0 / intervals, 1.0] if edge else [0.0, 1.0]
    crown_z = np.interp(along, stations, [low + cut, low + edge, high - edge, high - cut] if edge else [low, high])
    crown_r = np.interp(along, stations, [top - cut, top, top, top - cut] if edge else [top, top])
    sides = [np.column_stack([rise, z]) for z in (low + inwards, high - inwards)]
    return _between(seat, np.column_stack([crown_r, crown_z]), *sides)


def _between(bottom: FloatArray, top: FloatArray, left: FloatArray, right: FloatArray) -> FloatArray:
    """Points between four sides by transfinite interpolation, shape (along, across, 2)."""
    s = np.linspace(0.0, 1.0, len(bottom))[:, None, None]
    t = np.linspace(0.0, 1.0, len(left))[None, :, None]
    corners = (1 - s) * (1 - t) * bottom[0] + s * (1 - t) * bottom[-1] + (1 - s) * t * top[0] + s * t * top[-1]
    across = (1 - t) * bottom[:, None] + t * top[:, None]
    along = (1 - s) * left[None] + s * right[None]
    return np.asarray(across + along - corners)


def _seat(meridian: SolidMesh, edges: IntArray, middle: dict[frozenset[int], int]) -> IntArray:
    """Nodes of a seat with the middles of its edges, upwards."""
    height = meridian.points[:, 1]
    nodes: list[int] = []
    for pair in edges[np.argsort(height[edges].mean(axis=1))]:
        first, last = sorted(map(int, pair), key=height.__getitem__)
        nodes += ([first] if not nodes else []) + [middle[frozenset((first, last))], last]
    return np.array(nodes)


def _edge_middles(cells: IntArray) -> dict[frozenset[int], int]:
    """Node in the middle of each edge of nine-node quadrilaterals (m, 9), by its corners."""
    table = {}
    for (a, b), m in zip(((0, 1), (0, 2), (1, 3), (2, 3)), (4, 5, 6, 7), strict=True):
        for low, high, node in cells[:, [a, b, m]]:
            table[frozenset((int(low), int(high)))] = int(node)
    return table
