"""A core off the axis: the cavity moves as a whole, the outside stays, the wall goes as 1 - e cos theta."""

from __future__ import annotations

import numpy as np
import pytest

from meshes.by_gmsh.ring import RingShape
from meshes.eccentric import share_of_wall, shift_core
from meshes.errors import GeometryError
from meshes.gaps import outlines
from meshes.meridian import default_resolution, meridian_mesh
from meshes.quality import jacobians, mesh_quality, region_volumes_mm3
from meshes.revolve import revolve, revolve_scalar
from meshes.sweep import revolve_hexahedra

SHIFT = 0.1


@pytest.fixture(scope="module", params=["quadrilaterals", "triangles"])
def bodies(request, one_convolution):
    cells = request.param
    meridian = meridian_mesh(one_convolution, default_resolution(one_convolution, 1, cells), cells=cells)
    body = revolve_hexahedra(meridian, 8) if cells == "quadrilaterals" else revolve(meridian, 12)
    return meridian, body, shift_core(body, meridian, SHIFT)


def on(bodies, side: int) -> np.ndarray:
    """All nodes of the cavity's surface (0) or of the outside (1), middles of edges and faces too."""
    meridian, body, _ = bodies
    there = np.zeros(len(meridian.points))
    there[outlines(meridian)[side].nodes] = 1.0
    return np.flatnonzero(np.isclose(revolve_scalar(there, body), 1.0))


def test_cavity_moves_as_a_whole_and_the_outside_stays(bodies) -> None:
    _, body, shifted = bodies
    moved = shifted.points - body.points
    assert np.abs(moved[on(bodies, 0)] - [SHIFT, 0.0, 0.0]).max() < 1e-13
    assert np.abs(moved[on(bodies, 1)]).max() < 1e-13
    assert np.abs(moved[:, 1:]).max() == 0.0
    assert (moved[:, 0] >= -1e-13).all() and (moved[:, 0] <= SHIFT + 1e-13).all()


def test_volumes_and_names_stay(bodies) -> None:
    _, body, shifted = bodies
    before, after = region_volumes_mm3(body), region_volumes_mm3(shifted)
    assert sum(after.values()) == pytest.approx(sum(before.values()), rel=1e-12)
    assert shifted.cells is body.cells and shifted.facet_tags is body.facet_tags


def test_wall_of_the_collar_goes_as_the_cosine(bodies, one_convolution) -> None:
    _, body, shifted = bodies
    height = body.points[:, 2]
    collar = (height > 0.2) & (height < one_convolution.collar_mm - 1.2)
    inner = np.intersect1d(on(bodies, 0), np.flatnonzero(collar))
    # it is as wide as the crest that follows
    outer = one_convolution.crest_radius_mm + one_convolution.wall_mm
    angle = body.angle_rad[inner]
    assert len(np.unique(np.round(angle, 6))) >= 8
    thickness = outer - np.hypot(*shifted.points[inner, :2].T)
    thin = one_convolution.wall_mm - SHIFT * np.cos(angle)
    # second order in the shift: d^2 / (2 R)
    assert np.abs(thickness - thin).max() < 1.05 * SHIFT**2 / (2.0 * one_convolution.crest_radius_mm)


def test_share_is_linear_through_the_wall(bodies) -> None:
    meridian, _, _ = bodies
    share = share_of_wall(meridian)
    r, z = meridian.points.T
    cap = (r < 3.0) & (z > z.max() - 4.999)
    assert np.abs(share[cap] - (z.max() - z[cap]) / 5.0).max() < 1e-12


def test_cells_stay_good(bodies) -> None:
    _, body, shifted = bodies
    assert mesh_quality(shifted).min_jacobian_ratio > 0.8 * mesh_quality(body).min_jacobian_ratio
    assert (jacobians(shifted.points, shifted.cells) * jacobians(body.points, body.cells) > 0.0).all()


def test_core_that_comes_through_the_wall_is_refused(bodies) -> None:
    meridian, body, _ = bodies
    with pytest.raises(GeometryError, match=r"core shifted by 1\.2 mm: a cell at .* folds over"):
        shift_core(body, meridian, 1.2)


def test_meshed_rings_are_refused(one_convolution) -> None:
    ring = RingShape(2.0, 0.5)
    meridian = meridian_mesh(one_convolution, default_resolution(one_convolution, 1, "triangles"), ring, "triangles")
    with pytest.raises(GeometryError, match="meshed rings"):
        shift_core(revolve(meridian, 8), meridian, SHIFT)
