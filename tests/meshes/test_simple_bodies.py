"""Tube, half sphere and block: exact volumes and surfaces, swept both ways."""

from __future__ import annotations

import math

import numpy as np
import pytest

from meshes.bodies import (
    GRADED_BEYOND,
    block,
    cells_through,
    sphere_meridian,
    tube_meridian,
    ventricle_meridian,
)
from meshes.cells import CellKind
from meshes.errors import GeometryError
from meshes.quality import mesh_quality, region_volumes_mm3
from meshes.revolve import revolve
from meshes.solid import FACETS, SolidMesh
from meshes.sweep import revolve_hexahedra

every_kind = pytest.mark.parametrize("cells", ["triangles", "quadrilaterals"])


def names(mesh: SolidMesh) -> set[str]:
    return {name for name, number in FACETS.items() if (mesh.facet_tags == number).any()}


@every_kind
def test_tube(cells: CellKind) -> None:
    mesh = tube_meridian(4.0, 6.0, 3.0, 2, 3, cells)
    # the integrand r is in the space of the cells: exact
    assert region_volumes_mm3(mesh)["elastomer"] == pytest.approx(math.pi * (36.0 - 16.0) * 3.0, rel=1e-13)
    assert names(mesh) == {"cavity", "outer", "bottom", "top"}
    assert mesh_quality(mesh).boundary_only_cells == 0
    assert mesh.points[mesh.facets[mesh.facet_tags == FACETS["cavity"]], 0] == pytest.approx(4.0)


@every_kind
def test_half_sphere(cells: CellKind) -> None:
    exact = 2.0 / 3.0 * math.pi * (6.0**3 - 4.0**3)
    errors = []
    for along in (4, 8):
        mesh = sphere_meridian(4.0, 6.0, along, 2, cells)
        errors.append(abs(region_volumes_mm3(mesh)["elastomer"] / exact - 1.0))
        assert names(mesh) == {"cavity", "outer", "bottom", "axis"}
        assert mesh_quality(mesh).boundary_only_cells == 0
    # quadratic arcs: h^4
    assert errors[0] < 1e-3 and errors[0] / errors[1] == pytest.approx(16.0, rel=0.1)


def test_sphere_swept_into_an_octant_and_a_whole() -> None:
    exact = 2.0 / 3.0 * math.pi * (6.0**3 - 4.0**3)
    octant = revolve_hexahedra(sphere_meridian(4.0, 6.0, 6, 2, "quadrilaterals"), 4, 0.5 * math.pi)
    # quadratic arcs both ways
    assert 4.0 * region_volumes_mm3(octant)["elastomer"] == pytest.approx(exact, rel=1e-3)
    assert names(octant) == {"cavity", "outer", "bottom", "start", "end"}
    whole = revolve(sphere_meridian(4.0, 6.0, 6, 2), 16)
    assert region_volumes_mm3(whole)["elastomer"] == pytest.approx(exact, rel=1e-3)
    assert names(whole) == {"cavity", "outer", "bottom"}


def test_block() -> None:
    mesh = block((1.0, 2.0, 3.0), (2, 1, 3))
    assert region_volumes_mm3(mesh)["elastomer"] == pytest.approx(6.0, rel=1e-13)
    assert len(mesh.cells) == 6 and len(mesh.points) == 5 * 3 * 7
    assert len(mesh.facets) == 2 * (2 * 1 + 1 * 3 + 2 * 3)
    assert np.array_equal(mesh.points[mesh.tip_centre_node], np.zeros(3))


def test_impossible_bodies_are_refused() -> None:
    with pytest.raises(GeometryError, match="radii 6, 4"):
        tube_meridian(6.0, 4.0, 1.0, 1, 1)
    with pytest.raises(GeometryError, match="length 0"):
        tube_meridian(4.0, 6.0, 0.0, 1, 1)
    with pytest.raises(GeometryError, match="radii"):
        sphere_meridian(math.nan, 6.0, 1, 1)
    with pytest.raises(GeometryError, match="every edge"):
        block((1.0, -1.0, 1.0), (1, 1, 1))


def radii_of(mesh) -> np.ndarray:
    """Radii of the layers of nodes, of a sphere's meridian as of a tube's."""
    return np.unique(np.linalg.norm(mesh.points[mesh.points[:, 1] == 0.0], axis=1).round(9))


@pytest.mark.parametrize(
    "make", [lambda a, b, n: tube_meridian(a, b, 2.0, 1, n), lambda a, b, n: sphere_meridian(a, b, 2, n)]
)
def test_thick_walls_are_graded_and_others_are_not(make) -> None:
    equal = radii_of(make(5.0, 5.0 * GRADED_BEYOND, 4))
    assert np.diff(equal) == pytest.approx(np.full(8, 15.0 / 8.0), rel=1e-9)
    thick = radii_of(make(1.0, 1000.0, 10))
    assert len(thick) == 21 and (thick[0], thick[-1]) == (1.0, 1000.0)
    assert thick[1:] / thick[:-1] == pytest.approx(np.full(20, 1000.0**0.05), rel=1e-7)  # mid-nodes too


def test_cells_of_thick_walls_double_the_radius_at_most() -> None:
    for ratio in (1.01, 1.4, 2.0, 4.0):
        assert cells_through(ratio, 2) == 2
    for ratio in (4.1, 10.0, 30.0, 1000.0, 3000.0):
        for fine in (1, 2, 4):
            cells = cells_through(ratio, 2 * fine)
            assert ratio ** (fine / cells) <= 2.0 * (1.0 + 1e-12)
            assert cells == fine * cells_through(ratio, 2)  # levels are the same refinement


def test_thick_ventricles_are_graded_too() -> None:
    mesh = ventricle_meridian((1.0, 2.0), (100.0, 100.0), 0.0, 4, 8)
    base = np.unique(mesh.points[mesh.points[:, 1] == 0.0, 0].round(9))
    assert base[1:] / base[:-1] == pytest.approx(np.full(16, 100.0**0.0625), rel=1e-7)
