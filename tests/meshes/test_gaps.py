"""Gaps of known outlines: two plates, a fold, a ring; and the bellows at rest."""

from __future__ import annotations

import numpy as np
import pytest

from meshes.cells import CellKind
from meshes.gaps import Outline, outlines, ring_section, smallest_gap, smallest_gap_to_ring
from meshes.meridian import default_resolution, meridian_mesh
from meshes.shape import BellowsShape


def u_shape(gap_mm: float) -> tuple[Outline, np.ndarray]:
    """Two walls facing each other over a gap, joined at the bottom: the outline of a U seen from inside."""
    left = np.column_stack([np.zeros(11), np.linspace(10.0, 0.0, 11)])
    bottom = np.array([[0.5 * gap_mm, 0.0]])
    right = np.column_stack([np.full(10, gap_mm), np.linspace(0.0, 9.0, 10)])
    points = np.vstack([left, bottom, right])
    nodes = np.arange(len(points))
    # going down the left wall and up the right one, what is to the left is the space between
    return Outline(nodes, nodes[2:9:2], 1.0), points  # measured away from the ends, where the normals turn


@pytest.mark.parametrize("gap_mm", [3.0, 0.2])
def test_gap_between_two_walls(gap_mm: float) -> None:
    outline, points = u_shape(gap_mm)
    found = smallest_gap(outline, points, 0.5, 5.0)
    # the walls are straight and parallel: exact
    assert found.gap_mm == pytest.approx(gap_mm, rel=1e-12)


def test_gap_is_negative_once_one_wall_is_inside_the_other() -> None:
    outline, points = u_shape(3.0)
    points[12:, 0] = -0.1  # the right wall has gone through the left one
    found = smallest_gap(outline, points, 0.5, 5.0)
    assert found.gap_mm == pytest.approx(-0.1, rel=1e-12)
    # deeper than asked for is not seen as contact
    assert smallest_gap(outline, points, 0.05, 5.0).gap_mm > 0.0


def test_nothing_faces_a_straight_wall() -> None:
    points = np.column_stack([np.full(9, 5.0), np.linspace(0.0, 8.0, 9)])
    outline = Outline(np.arange(9), np.arange(0, 9, 2), -1.0)
    assert smallest_gap(outline, points, 0.5, 5.0).gap_mm == np.inf


def test_ring_section_and_distance_to_it() -> None:
    ring = ring_section(10.0, 3.0, 4.0, 2.0, 0.5)
    assert ring[:, 0].min() == 10.0 and ring[:, 0].max() == pytest.approx(12.0, rel=1e-14)
    assert ring[:, 1].min() == pytest.approx(1.0, rel=1e-14) and ring[:, 1].max() == pytest.approx(5.0, rel=1e-14)
    # area: the rectangle less what rounding two edges takes off, to the polygon's 9 points a quarter
    r, z = ring.T
    area = 0.5 * abs(np.dot(r, np.roll(z, -1)) - np.dot(z, np.roll(r, -1)))
    assert area == pytest.approx(8.0 - 2.0 * 0.25 * (1.0 - 0.25 * np.pi), rel=1e-3)
    above, inside = np.array([[11.0, 5.7]]), np.array([[11.0, 4.8]])
    assert smallest_gap_to_ring(above, ring).gap_mm == pytest.approx(0.7, rel=1e-12)
    assert smallest_gap_to_ring(inside, ring).gap_mm == pytest.approx(-0.2, rel=1e-12)
    assert smallest_gap_to_ring(np.empty((0, 2)), ring).gap_mm == np.inf
    # rounded over its whole height a ring has a corner twice: an edge of no length must not swallow the others
    twice = np.insert(ring, 1, ring[1], axis=0)
    assert smallest_gap_to_ring(above, twice).gap_mm == smallest_gap_to_ring(above, ring).gap_mm


@pytest.mark.parametrize("cells", ["triangles", "quadrilaterals"])
@pytest.mark.parametrize("wall_mm", [1.0, 2.0])
def test_bellows_at_rest(wall_mm: float, cells: CellKind) -> None:
    shape = BellowsShape(
        root_radius_mm=5.0,
        crest_radius_mm=10.5,
        wall_mm=wall_mm,
        half_pitch_mm=5.0,
        convolutions=2,
        collar_mm=3.0,
        seat_mm=4.0,
        fillet_mm=0.5,
        cap_mm=5.0,
    )
    mesh = meridian_mesh(shape, default_resolution(shape), cells=cells)
    cavity, outside = outlines(mesh)
    # both chains run from the clamped end to the axis
    for outline in (cavity, outside):
        z = mesh.points[outline.nodes, 1]
        assert z[0] == pytest.approx(0.0, abs=1e-12) and mesh.points[outline.nodes[-1], 0] == 0.0
    # Outside, the sides of a groove face each other; it is narrowest in its fillet at the bottom, whose concave
    # surface has the radius fillet_mm, or, for upright sides, everywhere twice that radius wide.
    found = smallest_gap(outside, mesh.points, 0.4 * wall_mm, 5.0)
    assert 2.0 * shape.fillet_mm * 0.85 < found.gap_mm < 2.0 * shape.fillet_mm * 1.2
    # What lies above the root's middle, pushed down by more than the groove is wide, goes into what lies below.
    middle = shape.collar_mm + shape.half_pitch_mm
    pressed = mesh.points.copy()
    pressed[mesh.points[:, 1] > middle, 1] -= found.gap_mm + 0.1
    assert -0.4 * wall_mm < smallest_gap(outside, pressed, 0.4 * wall_mm, 5.0).gap_mm < 0.0
