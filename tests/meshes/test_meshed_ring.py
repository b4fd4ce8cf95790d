"""Meshed rings: joined to the wall node by node, of the right volume, and failing with a message."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest
from scipy.spatial import cKDTree

from meshes.by_gmsh.ring import RingShape, ring_triangles
from meshes.errors import GeometryError, MeshError
from meshes.meridian import default_resolution, meridian_mesh
from meshes.quality import jacobians, region_volumes_mm3
from meshes.revolve import revolve
from meshes.shape import BellowsShape
from meshes.solid import FACETS, REGIONS, SolidMesh

RING = RingShape(height_mm=2.0, edge_radius_mm=0.5)
SEAT_Z = np.linspace(-2.0, 2.0, 9)


@pytest.fixture(scope="module")
def ringed(one_convolution: BellowsShape) -> SolidMesh:
    return meridian_mesh(one_convolution, default_resolution(one_convolution), RING)


def test_no_two_nodes_are_at_one_place_however_coordinates_round(boundary_of) -> None:
    # A ring that drawn inputs found: on r4 a midside node's z ends in ...4375, a tie in the sixth digit. It became two
    # nodes, whose edges ended in a segmentation fault.
    shape = BellowsShape(
        root_radius_mm=4.73,
        crest_radius_mm=9.781,
        wall_mm=1.0,
        half_pitch_mm=2.923,
        convolutions=1,
        collar_mm=2.918,
        cap_mm=0.0,
        fillet_mm=0.464,
        seat_mm=1.99,
    )
    mesh = meridian_mesh(shape, default_resolution(shape, 4), RingShape(1.0, 0.2))
    assert cKDTree(mesh.points).query_pairs(1e-6) == set()
    named = mesh.facets[np.lexsort(mesh.facets.T[::-1])]
    assert np.array_equal(named, boundary_of(mesh.cells, 2))


def ring_volume(seat_radius: float, width: float, ring: RingShape) -> float:
    """Exact volume by Pappus: a rectangle less what the rounding of two edges takes away."""
    e, h = ring.edge_radius_mm, ring.height_mm
    taken = (1.0 - math.pi / 4.0) * e**2
    # distance of the centroid of (square less quarter disc) from the outer face
    depth = (e**3 / 2.0 - math.pi * e**2 / 4.0 * (e - 4.0 * e / (3.0 * math.pi))) / taken
    moment = width * h * (seat_radius + 0.5 * h) - 2.0 * taken * (seat_radius + h - depth)
    return 2.0 * math.pi * moment


def test_ring_volume_is_that_of_pappus(ringed: SolidMesh, one_convolution: BellowsShape) -> None:
    exact = ring_volume(one_convolution.seat_radius_mm, one_convolution.seat_mm, RING)
    found = region_volumes_mm3(ringed)["ring"]
    # one parabola per rounded edge misses 0.4 % of what the rounding takes: 1e-4 of the ring
    assert found / len(one_convolution.crest_positions_mm) == pytest.approx(exact, rel=2e-4)


def test_sharp_ring_has_its_exact_volume(one_convolution: BellowsShape) -> None:
    sharp = RingShape(height_mm=1.5, edge_radius_mm=0.0)
    mesh = meridian_mesh(one_convolution, default_resolution(one_convolution), sharp)
    exact = ring_volume(one_convolution.seat_radius_mm, one_convolution.seat_mm, RingShape(1.5, 1e-9))
    # straight cells: round-off of gmsh's coordinates, and 1e-18 mm^2 of rounding in the formula
    assert region_volumes_mm3(mesh)["ring"] / 2 == pytest.approx(exact, rel=1e-10)


def test_rings_are_joined_to_their_seats_node_by_node(
    ringed: SolidMesh, one_convolution: BellowsShape, boundary_of
) -> None:
    boundary = boundary_of(ringed.cells, 2)
    named = ringed.facets[np.lexsort(ringed.facets.T[::-1])]
    assert np.array_equal(named, boundary)
    assert FACETS["bond"] not in ringed.facet_tags
    ends = ringed.points[boundary]
    on_seat = np.isclose(ends[:, :, 0], one_convolution.seat_radius_mm, atol=1e-9).all(axis=1)
    for middle in one_convolution.crest_positions_mm:
        inside = np.abs(ends[:, :, 1] - middle).max(axis=1) < 0.5 * one_convolution.seat_mm + 1e-9
        assert not (on_seat & inside).any(), "a seat has free edges"
    ring_nodes = np.unique(ringed.cells[ringed.regions == REGIONS["ring"]])
    wall_nodes = np.unique(ringed.cells[ringed.regions == REGIONS["elastomer"]])
    shared = ringed.points[np.intersect1d(ring_nodes, wall_nodes)]
    assert shared[:, 0] == pytest.approx(one_convolution.seat_radius_mm, abs=1e-9)
    # seats of 4 mm in cells of 0.5 mm: 9 corners and 8 mid-edge nodes on each of two
    assert len(shared) == 2 * 17


def test_wall_is_the_same_with_and_without_rings(ringed: SolidMesh, one_convolution: BellowsShape) -> None:
    plain = meridian_mesh(one_convolution, default_resolution(one_convolution))
    assert np.array_equal(ringed.points[: len(plain.points)], plain.points)
    assert np.array_equal(ringed.cells[: len(plain.cells)], plain.cells)


def test_ring_cells_are_not_folded(ringed: SolidMesh) -> None:
    signed = jacobians(ringed.points, ringed.cells[ringed.regions == REGIONS["ring"]])
    assert np.abs(np.sign(signed).sum(axis=1)).min() == signed.shape[1]


def test_ringed_meridian_revolves_into_a_conforming_body(ringed: SolidMesh, boundary_of) -> None:
    body = revolve(ringed, 8)
    named = body.facets[np.lexsort(body.facets.T[::-1])]
    assert np.array_equal(named, boundary_of(body.cells, 3))


@pytest.mark.parametrize(
    ("ring", "message"),
    [
        (RingShape(2.0, 2.5), r"edge_radius_mm = 2\.5 must be >= 0 and less than the height 2 mm"),
        (RingShape(5.0, 2.0), r"edge_radius_mm = 2 must be .* half the seat, 2 mm"),
        (RingShape(2.0, -0.1), r"edge_radius_mm = -0\.1 must be >= 0"),
        (RingShape(0.0, 0.0), r"less than the height 0 mm"),
    ],
)
def test_rounding_that_does_not_fit_is_refused(ring: RingShape, message: str) -> None:
    with pytest.raises(GeometryError, match=message):
        ring_triangles(ring, SEAT_Z, 11.5)


def test_failure_of_gmsh_becomes_an_error_with_its_words() -> None:
    crossing = np.array([-2.0, 1.0, -1.0, 2.0])  # an outline that runs back over itself: gmsh 4.8 aborts
    with pytest.raises(MeshError, match=r"gmsh could not mesh the ring section \(exit -?\d+\): \S"):
        ring_triangles(RING, crossing, 11.5)


# Radius of a seat that no other test asks for: a ring is meshed once a process.
NOT_MESHED_YET = 11.25


def test_death_of_the_child_process_becomes_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    run = subprocess.run

    def abort(command, **options):
        return run([sys.executable, "-c", "import os; os.abort()"], **options)

    monkeypatch.setattr("meshes.by_gmsh.child.subprocess.run", abort)
    with pytest.raises(MeshError, match=r"exit -6"):
        ring_triangles(RING, SEAT_Z, NOT_MESHED_YET)


def test_gmsh_that_hangs_becomes_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def hang(command, **options):
        raise subprocess.TimeoutExpired(command, options["timeout"])

    monkeypatch.setattr("meshes.by_gmsh.child.subprocess.run", hang)
    with pytest.raises(MeshError, match="within 300 s"):
        ring_triangles(RING, SEAT_Z, NOT_MESHED_YET)


def test_the_same_ring_is_meshed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    children, run = [], subprocess.run

    def counted(command, **options):
        children.append(command)
        return run(command, **options)

    monkeypatch.setattr("meshes.by_gmsh.child.subprocess.run", counted)
    first, again, other = (ring_triangles(RING, SEAT_Z, radius) for radius in (10.75, 10.75, 10.5))
    assert len(children) == 2
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    assert first[0][:, 0].min() == pytest.approx(10.75) and other[0][:, 0].min() == pytest.approx(10.5)
