"""Swept hexahedra: on the surface of revolution, conforming, no cell collapsed on the axis; whole and in sectors."""

from __future__ import annotations

import math

import numpy as np
import pytest

from meshes.errors import GeometryError, MeshError
from meshes.meridian import Resolution, default_resolution, meridian_mesh
from meshes.quality import jacobians, mesh_quality, region_volumes_mm3
from meshes.revolve import revolve_scalar, revolve_vector
from meshes.shape import BellowsShape
from meshes.solid import FACETS, SolidMesh
from meshes.sweep import FULL_CIRCLE, revolve_hexahedra

HEX_FACES = ((0, 1, 2, 3), (0, 1, 4, 5), (0, 2, 4, 6), (1, 3, 5, 7), (2, 3, 6, 7), (4, 5, 6, 7))
# (cells, degrees) in the whole circle, and in sectors with one and with two kites in the core
SWEEPS = [(6, 360.0), (8, 360.0), (12, 360.0), (16, 360.0), (2, 90.0), (4, 90.0), (2, 60.0), (2, 22.5), (4, 180.0)]
every_sweep = pytest.mark.parametrize(("around", "degrees"), SWEEPS)


@pytest.fixture(scope="module")
def quads(one_convolution: BellowsShape, coarse: Resolution) -> SolidMesh:
    return meridian_mesh(one_convolution, coarse, cells="quadrilaterals")


def sweep(meridian: SolidMesh, around: int, degrees: float) -> SolidMesh:
    return revolve_hexahedra(meridian, around, math.radians(degrees), 1)


def faces(mesh: SolidMesh) -> tuple[np.ndarray, np.ndarray]:
    every = np.vstack([np.sort(mesh.cells[:, face], axis=1) for face in HEX_FACES])
    return np.unique(every, axis=0, return_counts=True)


def test_quadrilaterals_and_triangles_share_all_nodes(one_convolution: BellowsShape) -> None:
    resolution = default_resolution(one_convolution)
    split = meridian_mesh(one_convolution, resolution)
    whole = meridian_mesh(one_convolution, resolution, cells="quadrilaterals")
    assert np.array_equal(split.points, whole.points)
    assert np.array_equal(split.facets, whole.facets) and np.array_equal(split.facet_tags, whole.facet_tags)
    assert 2 * len(whole.cells) == len(split.cells)
    # the same curved sides: quadrature of a polynomial of higher degree, measured 2e-6
    for name, volume in region_volumes_mm3(split).items():
        assert region_volumes_mm3(whole)[name] == pytest.approx(volume, rel=1e-5)
    # the cap's corner, a quarter circle against a right angle: measured 0.19
    assert mesh_quality(whole).min_jacobian_ratio > 0.15


@every_sweep
def test_each_inner_face_belongs_to_two_cells_and_the_rest_is_named(quads, around: int, degrees: float) -> None:
    mesh = sweep(quads, around, degrees)
    unique, count = faces(mesh)
    assert count.max() == 2
    named = mesh.facets[np.lexsort(mesh.facets.T[::-1])]
    assert np.array_equal(named, unique[count == 1])
    assert FACETS["axis"] not in mesh.facet_tags
    sides = {FACETS["start"], FACETS["end"]} & set(mesh.facet_tags.tolist())
    assert len(sides) == (0 if degrees == 360.0 else 2)


@every_sweep
def test_no_cell_is_folded_or_collapsed(quads, around: int, degrees: float) -> None:
    mesh = sweep(quads, around, degrees)
    signed = jacobians(mesh.points, mesh.cells)
    assert np.abs(np.sign(signed).sum(axis=1)).min() == signed.shape[1]
    # the cap's corner turns a quarter circle into a right angle: measured 0.2; the thin kite of 22.5 degrees: 0.1
    assert mesh_quality(mesh).min_jacobian_ratio > 0.09
    assert all(len(set(cell)) == 27 for cell in mesh.cells.tolist())


@every_sweep
def test_nodes_lie_on_the_surface_of_revolution(quads, around: int, degrees: float) -> None:
    mesh = sweep(quads, around, degrees)
    x, y, z = mesh.points.T
    # carrying the meridian's own positions gives the body's; round-off of 12 mm
    assert revolve_vector(quads.points, mesh) == pytest.approx(mesh.points, abs=1e-12)
    r = revolve_scalar(quads.points[:, 0], mesh)
    assert np.hypot(x, y) == pytest.approx(r, abs=1e-12)
    tip = np.unique(mesh.facets[mesh.facet_tags == FACETS["tip"]])
    assert z[tip] == pytest.approx(quads.points[quads.tip_centre_node, 1], abs=1e-12)
    angle = (np.arctan2(y, x)[r > 1e-9] + 1e-9) % FULL_CIRCLE
    assert angle.max() < math.radians(degrees) + 2e-9
    for name, at in (("start", 0.0), ("end", math.radians(degrees))):
        nodes = np.unique(mesh.facets[mesh.facet_tags == FACETS[name]])
        assert np.abs(x[nodes] * math.sin(at) - y[nodes] * math.cos(at)).max(initial=0.0) < 1e-12


def test_volume_tends_to_the_body_of_revolution_with_order_four(quads) -> None:
    exact = region_volumes_mm3(quads)
    errors = []
    for around in (8, 16, 32):
        found = region_volumes_mm3(sweep(quads, around, 360.0))
        errors.append([abs(found[name] / exact[name] - 1.0) for name in ("elastomer", "cap")])
    # parabolas for arcs: h^4, 3.5 asked; measured 3.98 to 4.00
    assert np.log2(np.array(errors[:-1]) / np.array(errors[1:])).min() >= 3.5, errors
    assert max(errors[0]) < 2e-3  # 45 degrees per parabola, measured 8e-4


@pytest.mark.parametrize("degrees", [22.5, 60.0, 90.0, 180.0])
def test_sector_is_a_part_of_the_whole(quads, degrees: float) -> None:
    # cells of 11.25 to 45 degrees: their volumes differ by the parabolas alone
    part = region_volumes_mm3(sweep(quads, 4 if degrees == 180.0 else 2, degrees))
    exact = region_volumes_mm3(quads)
    for name in ("elastomer", "cap"):
        assert part[name] == pytest.approx(exact[name] * degrees / 360.0, rel=2e-3)


def test_body_is_its_own_mirror_image(quads) -> None:
    mesh = sweep(quads, 8, 360.0)
    place = {tuple(p): k for k, p in enumerate(np.round(mesh.points, 6) + 0.0)}
    cells = {tuple(sorted(c)) for c in mesh.cells}
    for flip in ([-1.0, 1.0, 1.0], [1.0, -1.0, 1.0]):
        image = np.array([place[tuple(p)] for p in np.round(mesh.points * flip, 6) + 0.0])
        assert {tuple(sorted(c)) for c in image[mesh.cells]} == cells


def test_seats_keep_their_numbers(quads) -> None:
    mesh = sweep(quads, 8, 360.0)
    for seat in np.unique(quads.facet_bodies[quads.facet_bodies >= 0]):
        assert (mesh.facet_bodies == seat).sum() == 8 * (quads.facet_bodies == seat).sum()
    assert (mesh.facet_bodies[mesh.facet_tags != FACETS["bond"]] == -1).all()


def test_tip_centre_is_on_the_axis(quads) -> None:
    mesh = sweep(quads, 2, 90.0)
    expected = [0.0, 0.0, quads.points[quads.tip_centre_node, 1]]
    assert mesh.points[mesh.tip_centre_node] == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize(
    ("around", "degrees", "said"),
    [
        (3, 360.0, "must be at least 4"),
        (7, 360.0, "needs an even number"),
        (4, 360.0, "at least three pairs"),
        (1, 45.0, "needs an even number"),
        (2, 0.0, "must be > 0"),
        (8, 400.0, "at most 360"),
    ],
)
def test_numbers_that_do_not_fit_are_refused(quads, around: int, degrees: float, said: str) -> None:
    with pytest.raises(GeometryError, match=said):
        sweep(quads, around, degrees)


def test_what_is_no_structured_meridian_is_refused(quads, coarse_meridian) -> None:
    with pytest.raises(MeshError, match="triangles"):
        revolve_hexahedra(coarse_meridian, 8)
    with pytest.raises(MeshError, match="columns of cells lead to the axis"):
        revolve_hexahedra(quads, 8, core_columns=1000)
