"""Weights of nodes that integrate over a named surface: areas and first moments of tubes, spheres and blocks."""

from __future__ import annotations

import math

import numpy as np
import pytest

from meshes.bodies import block, sphere_meridian, tube_meridian
from meshes.errors import MeshError
from meshes.revolve import revolve
from meshes.surface import surface_weights
from meshes.sweep import revolve_hexahedra


@pytest.mark.parametrize("cells", ["triangles", "quadrilaterals"])
def test_surfaces_of_a_tube_are_exact_on_its_meridian(cells) -> None:
    mesh = tube_meridian(4.0, 6.0, 3.0, 2, 3, cells)
    # r and z are in the space of the cells: round-off
    assert surface_weights(mesh, "cavity").sum() == pytest.approx(2.0 * math.pi * 4.0 * 3.0, rel=1e-13)
    assert surface_weights(mesh, "top").sum() == pytest.approx(math.pi * (36.0 - 16.0), rel=1e-13)
    assert surface_weights(mesh, "outer") @ mesh.points[:, 1] == pytest.approx(2.0 * math.pi * 6.0 * 4.5, rel=1e-13)


def test_half_a_sphere_in_tetrahedra_and_a_quarter_of_it_in_hexahedra() -> None:
    whole = revolve(sphere_meridian(4.0, 6.0, 6, 2), 16)
    part = revolve_hexahedra(sphere_meridian(4.0, 6.0, 6, 2, "quadrilaterals"), 4, 0.5 * math.pi)
    for mesh, share in ((whole, 1.0), (part, 0.25)):
        weights = surface_weights(mesh, "cavity")
        # curved cells of 15 and 22 degrees: h^4
        assert weights.sum() == pytest.approx(share * 2.0 * math.pi * 16.0, rel=1e-4)
        assert weights @ mesh.points[:, 2] == pytest.approx(share * math.pi * 64.0, rel=1e-4)
        on_cavity = np.isclose(np.linalg.norm(mesh.points, axis=1), 4.0)
        assert not weights[~on_cavity].any()


def test_faces_of_a_block_and_a_surface_it_has_not() -> None:
    mesh = block((1.0, 2.0, 3.0), (2, 1, 3))
    assert surface_weights(mesh, "outer").sum() == pytest.approx(22.0, rel=1e-13)
    with pytest.raises(MeshError, match="no surface named cavity"):
        surface_weights(mesh, "cavity")
