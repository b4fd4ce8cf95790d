"""Cylinder, ventricle and Cook's membrane: exact volumes, named surfaces, refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from meshes.bodies import cook_membrane, cylinder_meridian, ventricle_meridian
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
def test_cylinder(cells: CellKind) -> None:
    mesh = cylinder_meridian(4.0, 3.0, 4, 2, cells)
    assert region_volumes_mm3(mesh)["elastomer"] == pytest.approx(math.pi * 48.0, rel=1e-13)
    assert names(mesh) == {"outer", "bottom", "top", "axis"}
    body = revolve_hexahedra(mesh, 16) if cells == "quadrilaterals" else revolve(mesh, 16)
    # quadratic arcs
    assert region_volumes_mm3(body)["elastomer"] == pytest.approx(math.pi * 48.0, rel=1e-4)
    assert names(body) == {"outer", "bottom", "top"}


def ellipsoid_mm3(across: float, along: float, base: float) -> float:
    """Volume of an ellipsoid of revolution above z = -base: int pi a^2 (1 - z^2/c^2) dz."""
    return math.pi * across**2 * ((along + base) - (along**3 + base**3) / (3.0 * along**2))


@every_kind
def test_ventricle(cells: CellKind) -> None:
    exact = ellipsoid_mm3(10.0, 20.0, 5.0) - ellipsoid_mm3(7.0, 17.0, 5.0)
    errors = []
    for along in (6, 12):
        mesh = ventricle_meridian((7.0, 17.0), (10.0, 20.0), 5.0, along, 2, cells)
        errors.append(abs(region_volumes_mm3(mesh)["elastomer"] / exact - 1.0))
        assert names(mesh) == {"cavity", "outer", "clamped", "axis"}
        assert mesh_quality(mesh).boundary_only_cells == 0
        assert mesh.points[mesh.tip_centre_node] == pytest.approx([0.0, 20.0])
        inside = mesh.points[np.unique(mesh.facets[mesh.facet_tags == FACETS["cavity"]])]
        assert (inside[:, 0] / 7.0) ** 2 + (inside[:, 1] / 17.0) ** 2 == pytest.approx(1.0)
    # quadratic arcs: h^4
    assert errors[0] < 1e-3 and errors[0] / errors[1] == pytest.approx(16.0, rel=0.2)


def test_cooks_membrane() -> None:
    mesh = cook_membrane(4, 2.0)
    # straight cells: exact
    assert region_volumes_mm3(mesh)["elastomer"] == pytest.approx(2.0 * 48.0 * 0.5 * (44.0 + 16.0), rel=1e-13)
    assert names(mesh) == {"clamped", "tip", "bottom", "top", "outer"}
    assert mesh.points[mesh.tip_centre_node] == pytest.approx([48.0, 60.0, 0.0])
    edges = {name: np.unique(mesh.facets[mesh.facet_tags == FACETS[name]]) for name in ("clamped", "tip")}
    heights = {name: np.ptp(mesh.points[nodes, 1]) for name, nodes in edges.items()}
    assert heights == pytest.approx({"clamped": 44.0, "tip": 16.0})


def test_wrong_bodies_are_refused() -> None:
    with pytest.raises(GeometryError, match="both must be positive"):
        cylinder_meridian(0.0, 1.0, 2, 1)
    with pytest.raises(GeometryError, match="base < the inner"):
        ventricle_meridian((7.0, 17.0), (10.0, 20.0), 18.0, 4, 2)
    with pytest.raises(GeometryError, match="must be even"):
        cook_membrane(3)
