"""Meridian meshes: exact volumes by Pappus, curved cells of high order, no cell that would lock."""

from __future__ import annotations

import math

import numpy as np
import pytest

from meshes.errors import GeometryError
from meshes.fold import side_angle
from meshes.meridian import Resolution, default_resolution, meridian_mesh
from meshes.quality import jacobians, mesh_quality, region_volumes_mm3
from meshes.shape import BellowsShape
from meshes.solid import FACETS, REGIONS, TRIANGLE_EDGES, SolidMesh

SHAPES = {
    "t1": BellowsShape(5.0, 10.5, 1.0, 5.0, 2, 3.0, 4.0, 0.5, 5.0),
    "t2": BellowsShape(5.0, 10.5, 2.0, 5.25, 2, 3.0, 4.0, 0.5, 5.0),
    "shallow": BellowsShape(7.0, 8.5, 0.6, 6.5, 1, 4.0, 2.0, 0.4, 2.0),
}
every_shape = pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)


def wall_volume(shape: BellowsShape) -> float:
    """Exact volume of wall and collars: Pappus for tubes and cones, integrated arcs for crests and roots."""
    t, phi, n = shape.wall_mm, side_angle(shape), shape.convolutions
    small, large = shape.fillet_mm, shape.fillet_mm + t
    rho = shape.centreline_radius_mm
    drop = shape.crest_radius_mm - shape.root_radius_mm
    side = (drop - 2.0 * rho * (1.0 - math.cos(phi))) / math.sin(phi)
    crest_middle, root_middle = shape.crest_radius_mm + 0.5 * t, shape.root_radius_mm + 0.5 * t
    straight = 2.0 * shape.collar_mm - shape.fillet_mm + n * shape.seat_mm
    tubes = 2.0 * math.pi * crest_middle * t * straight
    cones = 2 * n * 2.0 * math.pi * 0.5 * (crest_middle + root_middle) * t * side
    sector = 0.5 * phi * (large**2 - small**2)
    moment = (large**3 - small**3) / 3.0 * math.sin(phi)
    crests = 2 * n * 2.0 * math.pi * ((crest_middle - rho) * sector + moment)
    roots = 2 * n * 2.0 * math.pi * ((root_middle + rho) * sector - moment)
    return tubes + cones + crests + roots


def cap_volume(shape: BellowsShape) -> float:
    """Exact volume of the cap: a disc less the filleted end of the cavity."""
    f, r = shape.fillet_mm, shape.crest_radius_mm - shape.fillet_mm
    disc = math.pi * shape.seat_radius_mm**2 * (shape.cap_mm + f)
    cavity = math.pi * (r**2 * f + 2.0 * r * math.pi * f**2 / 4.0 + 2.0 * f**3 / 3.0)
    return disc - cavity


def exact_volumes(shape: BellowsShape) -> np.ndarray:
    return np.array([wall_volume(shape), cap_volume(shape)])


def volumes(mesh: SolidMesh) -> np.ndarray:
    found = region_volumes_mm3(mesh)
    return np.array([found["elastomer"], found["cap"]])


@every_shape
def test_volume_tends_to_that_of_pappus_with_order_four(shape: BellowsShape) -> None:
    exact = exact_volumes(shape)
    errors = [
        np.abs(volumes(meridian_mesh(shape, default_resolution(shape, factor))) / exact - 1.0) for factor in (1, 2, 4)
    ]
    # arcs of at most 30 degrees as parabolas
    assert errors[0].max() < 1e-4
    # a parabola through three points of a circle: h^4; 3.5 leaves room for the coarsest mesh
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert orders.min() >= 3.5, orders


def test_straight_pieces_have_their_exact_volume() -> None:
    shape = SHAPES["t1"]
    mesh = meridian_mesh(shape, default_resolution(shape))
    z = mesh.points[mesh.cells, 1]
    collar = z.max(axis=1) <= shape.collar_mm + 1e-9
    piece = SolidMesh(
        mesh.points,
        mesh.cells[collar],
        mesh.regions[collar],
        mesh.facets,
        mesh.facet_tags,
        mesh.facet_bodies,
        0,
    )
    tube = math.pi * (shape.seat_radius_mm**2 - shape.crest_radius_mm**2) * shape.collar_mm
    # straight cells: round-off
    assert region_volumes_mm3(piece)["elastomer"] == pytest.approx(tube, rel=1e-13)


@every_shape
def test_every_level_keeps_the_corners_of_the_coarser_one(shape: BellowsShape) -> None:
    coarse, fine = (meridian_mesh(shape, default_resolution(shape, factor)) for factor in (1, 2))
    assert len(fine.cells) == 4 * len(coarse.cells)
    corners = {tuple(p) for p in np.round(fine.points[fine.corners], 9)}
    assert {tuple(p) for p in np.round(coarse.points[coarse.corners], 9)} <= corners


@every_shape
@pytest.mark.parametrize("factor", [1, 2])
def test_no_cell_is_folded_or_nearly_so(shape: BellowsShape, factor: int) -> None:
    mesh = meridian_mesh(shape, default_resolution(shape, factor))
    signed = jacobians(mesh.points, mesh.cells)
    assert np.abs(np.sign(signed).sum(axis=1)).min() == signed.shape[1]
    values = np.abs(signed)
    ratio = values.min(axis=1) / values.max(axis=1)
    wall = mesh.regions == REGIONS["elastomer"]
    # 30 degrees at most per cell, the outer arc up to five times as long as the inner: measured 0.47 to 0.76
    assert ratio[wall].min() > 0.4
    # the cap's corner turns a quarter circle into a right angle in four cells: measured 0.21 to 0.45
    assert ratio[~wall].min() > 0.15
    assert mesh_quality(mesh).min_jacobian_ratio == pytest.approx(ratio.min(), rel=1e-12)  # the same numbers


@every_shape
def test_no_triangle_has_all_corners_on_the_surface(shape: BellowsShape, boundary_of) -> None:
    mesh = meridian_mesh(shape, default_resolution(shape))
    surface = boundary_of(mesh.cells, 2)
    off_axis = surface[mesh.points[surface, 0].max(axis=1) > 0.0]
    on_surface = np.isin(mesh.cells[:, :3], off_axis).all(axis=1)
    assert not on_surface.any()
    assert mesh_quality(mesh).boundary_only_cells == 0


@every_shape
def test_at_least_two_cells_through_the_wall(shape: BellowsShape) -> None:
    mesh = meridian_mesh(shape, default_resolution(shape))
    inside = np.unique(mesh.facets[mesh.facet_tags == FACETS["cavity"]])
    outside = np.unique(mesh.facets[np.isin(mesh.facet_tags, [FACETS[k] for k in ("outer", "bond", "tip")])])
    for i, j in ((0, 1), (0, 2), (1, 2)):
        a, b = mesh.cells[:, i], mesh.cells[:, j]
        # an edge from inside to outside would be a single cell through the wall
        assert not (np.isin(a, inside) & np.isin(b, outside)).any()
        assert not (np.isin(a, outside) & np.isin(b, inside)).any()


@every_shape
def test_named_edges_are_the_whole_boundary(shape: BellowsShape, boundary_of) -> None:
    mesh = meridian_mesh(shape, default_resolution(shape))
    named = mesh.facets[np.lexsort(mesh.facets.T[::-1])]
    assert np.array_equal(named, boundary_of(mesh.cells, 2))
    ends = mesh.points[mesh.facets]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    tags = mesh.facet_tags
    # straight surfaces, so chords are exact to round-off
    assert length[tags == FACETS["clamped"]].sum() == pytest.approx(shape.wall_mm, rel=1e-12)
    assert length[tags == FACETS["axis"]].sum() == pytest.approx(shape.cap_mm, rel=1e-12)
    seats = shape.convolutions + 1
    assert length[tags == FACETS["bond"]].sum() == pytest.approx(seats * shape.seat_mm, rel=1e-12)
    for seat in range(seats):
        on_seat = ends[mesh.facet_bodies == seat]
        assert on_seat[:, :, 0] == pytest.approx(shape.seat_radius_mm, abs=1e-11)
        middle = shape.crest_positions_mm[seat]
        assert np.abs(on_seat[:, :, 1] - middle).max() == pytest.approx(0.5 * shape.seat_mm, abs=1e-11)
    assert (mesh.facet_bodies[tags != FACETS["bond"]] == -1).all()


def test_mid_edge_nodes_of_neighbours_are_shared() -> None:
    mesh = meridian_mesh(SHAPES["t1"], default_resolution(SHAPES["t1"]))
    middle: dict[tuple[int, int], int] = {}
    for k, (i, j) in enumerate(TRIANGLE_EDGES):
        for cell in mesh.cells:
            a, b = sorted((int(cell[i]), int(cell[j])))
            assert middle.setdefault((a, b), int(cell[3 + k])) == cell[3 + k]
    # corners and mid-edge nodes are all there is
    assert len(middle) + len(mesh.corners) == len(mesh.points)


def test_tip_centre_is_on_the_axis_of_the_distal_face() -> None:
    shape = SHAPES["t1"]
    mesh = meridian_mesh(shape, default_resolution(shape))
    z = shape.cavity_length_mm + shape.cap_mm
    assert mesh.points[mesh.tip_centre_node] == pytest.approx([0.0, z], abs=1e-11)
    assert set(mesh.regions) == {REGIONS["elastomer"], REGIONS["cap"]}


def test_folded_cell_is_refused_with_its_place() -> None:
    # a cap much thinner than the fillet beside it: the corner's stations cross
    shape = BellowsShape(5.0, 20.0, 1.0, 30.0, 1, 30.0, 4.0, 2.0, 0.05)
    with pytest.raises(GeometryError, match=r"cell \d+ at r = 18\.9, z = 120 mm folds over itself"):
        meridian_mesh(shape, Resolution(through=2, cell_mm=0.5))
