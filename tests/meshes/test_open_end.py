"""A bellows whose distal end is open: its annulus is the tip, and nothing reaches the axis."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from meshes.errors import GeometryError
from meshes.meridian import CellKind, Resolution, meridian_mesh
from meshes.quality import region_volumes_mm3
from meshes.revolve import revolve
from meshes.shape import BellowsShape
from meshes.solid import FACETS
from meshes.sweep import revolve_hexahedra


@pytest.fixture(scope="module")
def open_shape(one_convolution: BellowsShape) -> BellowsShape:
    return dataclasses.replace(one_convolution, cap_mm=0.0)


@pytest.mark.parametrize("cells", ["triangles", "quadrilaterals"])
def test_annulus_is_the_tip(open_shape: BellowsShape, one_convolution, coarse: Resolution, cells: CellKind) -> None:
    mesh = meridian_mesh(open_shape, coarse, cells=cells)
    ends = mesh.points[mesh.facets[mesh.facet_tags == FACETS["tip"]]]
    assert ends[:, :, 1] == pytest.approx(open_shape.cavity_length_mm, abs=1e-12)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum()
    assert length == pytest.approx(open_shape.wall_mm, rel=1e-12)
    assert FACETS["axis"] not in mesh.facet_tags
    assert mesh.points[:, 0].min() > 4.0
    volumes = region_volumes_mm3(mesh)
    assert volumes["cap"] == 0.0
    # the collar goes on to the plane of the cavity's end, where the cap's fillet began before
    capped = region_volumes_mm3(meridian_mesh(one_convolution, coarse, cells=cells))
    outer, inner, rest = open_shape.seat_radius_mm, open_shape.crest_radius_mm, open_shape.fillet_mm
    ring = math.pi * (outer**2 - inner**2) * rest
    assert volumes["elastomer"] == pytest.approx(capped["elastomer"] + ring, rel=1e-9)  # straight cells


def test_open_meridian_makes_bodies_of_both_kinds(open_shape: BellowsShape, coarse: Resolution) -> None:
    tets = revolve(meridian_mesh(open_shape, coarse), 8)
    quads = meridian_mesh(open_shape, coarse, cells="quadrilaterals")
    # without a core any number of cells will do, also one in a thin sector
    for body, parts in (
        (tets, 1.0),
        (revolve_hexahedra(quads, 5), 1.0),
        (revolve_hexahedra(quads, 1, math.pi / 4), 8.0),
    ):
        # 45 to 72 degrees per parabola
        expected = region_volumes_mm3(quads)["elastomer"] / parts
        assert region_volumes_mm3(body)["elastomer"] == pytest.approx(expected, rel=1e-2)
        tip = np.unique(body.facets[body.facet_tags == FACETS["tip"]])
        assert body.points[tip, 2] == pytest.approx(open_shape.cavity_length_mm, abs=1e-12)


def test_negative_cap_is_refused(one_convolution: BellowsShape, coarse: Resolution) -> None:
    with pytest.raises(GeometryError, match="cap_mm = -1"):
        meridian_mesh(dataclasses.replace(one_convolution, cap_mm=-1.0), coarse)
