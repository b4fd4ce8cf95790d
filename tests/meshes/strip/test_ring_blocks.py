"""Rings of quadrilaterals: of the section they say, joined to the wall node by node, nested, and swept with it."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from meshes.by_gmsh.ring import RingShape
from meshes.cells import HEXAHEDRON_NODES, QUADRILATERAL_NODES
from meshes.errors import GeometryError
from meshes.meridian import default_resolution, meridian_mesh
from meshes.quality import jacobians, region_volumes_mm3
from meshes.shape import BellowsShape
from meshes.solid import FACETS, REGIONS, SolidMesh
from meshes.strip.ring_blocks import ring_block
from meshes.sweep import FULL_CIRCLE, revolve_hexahedra

RING = RingShape(height_mm=2.0, edge_radius_mm=0.5)


def ringed(shape: BellowsShape, ring: RingShape | None = RING, refinement: int = 1) -> SolidMesh:
    resolution = default_resolution(shape, refinement, "quadrilaterals")
    return meridian_mesh(shape, resolution, ring, "quadrilaterals")


def outline(ring: RingShape, seat_radius: float, width: float) -> np.ndarray:
    """Corners of a section, in turn, whose outer edges are two chords each."""
    e, top, half = ring.edge_radius_mm, seat_radius + ring.height_mm, 0.5 * width
    in_arc = e * (1.0 - math.sqrt(0.5))
    side = [(seat_radius, half), (top - e, half), (top - in_arc, half - in_arc), (top, half - e)]
    return np.array(side + [(r, -z) for r, z in side[::-1]])


def swept_volume(polygon: np.ndarray) -> float:
    """Volume of a polygon (r, z) swept round the axis: 2 pi times its first moment."""
    r, z = polygon.T
    next_r, next_z = np.roll(r, -1), np.roll(z, -1)
    return abs(math.pi / 3.0 * float(((r + next_r) * (r * next_z - next_r * z)).sum()))


def boundary(mesh: SolidMesh) -> np.ndarray:
    """Corners of the facets that one cell has, ascending in each, and sorted as named ones are."""
    lattice = QUADRILATERAL_NODES if mesh.dimension == 2 else HEXAHEDRON_NODES
    corners = lattice[: 2**mesh.dimension]
    sides = [np.flatnonzero(corners[:, axis] == end) for axis in range(mesh.dimension) for end in (0, 2)]
    facets, counts = np.unique(
        np.sort(np.vstack([mesh.cells[:, s] for s in sides]), axis=1), axis=0, return_counts=True
    )
    return facets[counts == 1]


@pytest.mark.parametrize("refinement", [1, 2])
@pytest.mark.parametrize("wall", [1.0, 2.0])
def test_volume_is_that_of_the_section(one_convolution: BellowsShape, wall: float, refinement: int) -> None:
    shape = dataclasses.replace(one_convolution, wall_mm=wall)
    exact = swept_volume(outline(RING, shape.seat_radius_mm, shape.seat_mm))
    found = region_volumes_mm3(ringed(shape, refinement=refinement))["ring"]
    # straight cells: round-off
    assert found / len(shape.crest_positions_mm) == pytest.approx(exact, rel=1e-12)
    # what two chords leave of the arcs: half a percent
    arcs = 2.0 * RING.edge_radius_mm**2 * (math.pi / 4.0 - math.sqrt(0.5))
    assert arcs / (shape.seat_mm * RING.height_mm) < 0.005


def test_sharp_edges_where_the_seat_has_two_cells(one_convolution: BellowsShape) -> None:
    seat = np.column_stack([np.full(5, 11.5), np.linspace(-2.0, 2.0, 5)])
    block = ring_block(RING, seat, 1)
    assert np.array_equal(block[:, 0], seat)
    assert block[[0, -1], -1].tolist() == [[13.5, -2.0], [13.5, 2.0]]
    two_cells = dataclasses.replace(one_convolution, wall_mm=2.0, seat_mm=2.5)
    exact = swept_volume(outline(RingShape(2.0, 0.0), two_cells.seat_radius_mm, 2.5))
    assert region_volumes_mm3(ringed(two_cells))["ring"] / 2 == pytest.approx(exact, rel=1e-12)


def test_blocks_are_joined_to_their_seats(one_convolution: BellowsShape) -> None:
    mesh, bare = ringed(one_convolution), ringed(one_convolution, None)
    assert np.array_equal(mesh.points[: len(bare.points)], bare.points)
    assert np.array_equal(mesh.cells[: len(bare.cells)], bare.cells)
    assert np.array_equal(np.unique(mesh.facets, axis=0), boundary(mesh))
    assert FACETS["bond"] not in mesh.facet_tags and (mesh.facet_bodies == -1).all()
    rings, wall = (np.unique(mesh.cells[mesh.regions == REGIONS[name]]) for name in ("ring", "elastomer"))
    edges = int((bare.facet_tags == FACETS["bond"]).sum())
    assert len(np.intersect1d(rings, wall)) == 2 * edges + len(one_convolution.crest_positions_mm)


def test_cells_are_not_folded_and_levels_are_nested(one_convolution: BellowsShape) -> None:
    coarse, fine = ringed(one_convolution), ringed(one_convolution, refinement=2)
    for mesh in (coarse, fine):
        signed = jacobians(mesh.points, mesh.cells[mesh.regions == REGIONS["ring"]])
        assert np.abs(np.sign(signed).sum(axis=1)).min() == signed.shape[1]
    corners, every = (np.unique(mesh.cells[mesh.regions == REGIONS["ring"]]) for mesh in (coarse, fine))
    away = np.linalg.norm(coarse.points[corners][:, None] - fine.points[every][None], axis=-1).min(axis=1)
    assert away.max() < 1e-12


def test_a_rounding_that_does_not_fit_is_refused(one_convolution: BellowsShape) -> None:
    with pytest.raises(GeometryError, match=r"edge_radius_mm = 2\.5 must be >= 0 and less than the height 2 mm"):
        ringed(one_convolution, RingShape(2.0, 2.5))


@pytest.mark.parametrize("parts", [1, 4])
def test_the_body_conforms_and_has_the_rings_volume(one_convolution: BellowsShape, parts: int) -> None:
    body = revolve_hexahedra(ringed(one_convolution), 16 // parts, FULL_CIRCLE / parts)
    assert np.array_equal(np.unique(body.facets, axis=0), boundary(body))
    exact = swept_volume(outline(RING, one_convolution.seat_radius_mm, one_convolution.seat_mm)) * 2 / parts
    # circles of 16 parabolas: 1 - 2 pi^4 / (45 n^4) and their like
    assert region_volumes_mm3(body)["ring"] == pytest.approx(exact, rel=2e-3)
