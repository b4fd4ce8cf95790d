"""Sides that bend at points of one's own: pieces join, radii are met, points on a straight side change nothing."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from meshes.bellows import wall_segments
from meshes.errors import GeometryError
from meshes.fold import half_fold
from meshes.meridian import default_resolution, meridian_mesh
from meshes.quality import jacobians
from meshes.shape import BellowsShape
from meshes.solid import SolidMesh

STRAIGHT = BellowsShape(5.0, 10.5, 1.0, 5.0, 3, 3.0, 2.0, 0.2, 5.0)
BENT = replace(STRAIGHT, bends_mm=((3.0, 9.0), (3.5, 7.5)))
# Lengths are a few mm, sums of tens of pieces, angles come from an arc cosine: 1e-9 mm is far below any dimension.
ROUND_OFF = 1e-9


def test_a_bend_on_the_straight_side_changes_nothing() -> None:
    crest, side, root = half_fold(STRAIGHT)
    first = next(s for s in wall_segments(STRAIGHT) if s.kind == "side")
    r, z = first.start
    middle = (
        z - STRAIGHT.collar_mm + 0.5 * side.length_mm * math.cos(side.start_rad),
        r - 0.5 * side.length_mm * math.sin(side.start_rad),
    )
    found = half_fold(replace(STRAIGHT, bends_mm=(middle,)))
    assert [p.kind for p in found] == ["crest", "side", "side", "side", "root"]
    assert found[0].length_mm == pytest.approx(crest.length_mm, abs=ROUND_OFF)
    assert found[1].length_mm + found[3].length_mm == pytest.approx(side.length_mm, abs=ROUND_OFF)
    assert found[2].length_mm == pytest.approx(0.0, abs=ROUND_OFF)
    assert found[4].length_mm == pytest.approx(root.length_mm, abs=ROUND_OFF)


def test_bent_sides_meet_crests_and_roots_where_they_are() -> None:
    pieces = wall_segments(BENT)
    for here, after in zip(pieces[:-1], pieces[1:], strict=True):
        ends_here, ends_after = here.band(np.array([1.0])), after.band(np.array([0.0]))
        for one, other in zip(ends_here, ends_after, strict=True):
            assert one[0] == pytest.approx(other[0], abs=ROUND_OFF)
        assert here.tangent_end_rad == after.tangent_start_rad
    roots = [p for p in pieces if p.kind == "root"]
    for k, piece in enumerate(roots[::2]):
        inner, _ = piece.band(np.array([1.0]))
        at = BENT.collar_mm + (2 * k + 1) * BENT.half_pitch_mm
        assert inner[0] == pytest.approx([BENT.root_radius_mm, at], abs=ROUND_OFF)
    for piece in (p for p in pieces if p.kind == "seat"):
        inner, _ = piece.band(np.array([0.5]))
        assert inner[0, 0] == pytest.approx(BENT.crest_radius_mm, abs=ROUND_OFF)


def test_bends_are_rounded_on_their_concave_side_by_the_fillet() -> None:
    arcs = [p for p in half_fold(BENT) if p.kind == "side" and p.start_rad != p.end_rad]
    assert len(arcs) == len(BENT.bends_mm)
    for arc in arcs:
        assert arc.length_mm / abs(arc.end_rad - arc.start_rad) == pytest.approx(BENT.centreline_radius_mm, rel=1e-12)


def test_a_meridian_grows_by_the_wall_times_what_bends_lengthen_it() -> None:
    """A band of constant thickness has the area of its middle line times the thickness, arcs included: the difference
    of two meridians of the same ends is that of their sides.
    Quadratic cells err on arcs by 1e-5 of their area."""
    straight, bent = (
        area(meridian_mesh(shape, default_resolution(shape, 2), cells="quadrilaterals")) for shape in (STRAIGHT, BENT)
    )
    lengths = [sum(p.length_mm for p in half_fold(shape)) for shape in (STRAIGHT, BENT)]
    longer = 2 * STRAIGHT.convolutions * (lengths[1] - lengths[0]) * STRAIGHT.wall_mm
    assert longer > 0.3
    assert bent - straight == pytest.approx(longer, rel=2e-3)


def area(mesh: SolidMesh) -> float:
    """Area of a meridian, mm^2."""
    return float((np.abs(jacobians(mesh.points, mesh.cells)) * mesh.cell.rule[1]).sum())


@pytest.mark.parametrize(
    ("bends", "reason"),
    [
        (((7.0, 8.0),), "lies between crest and root"),
        (((3.0, 0.3),), "exceeds half of wall_mm"),
        (((1.2, 10.6),), "lies within the arc"),
        (((0.5, 12.5),), "turn back"),
        (((3.0, 8.5), (3.1, 8.4)), "rounding its ends"),
        (((3.0, 7.0), (3.0, 9.0), (3.0, 7.0)), "rounding its ends"),
    ],
)
def test_what_cannot_be_built_is_refused_with_the_point(bends: tuple[tuple[float, float], ...], reason: str) -> None:
    with pytest.raises(GeometryError, match=reason):
        half_fold(replace(STRAIGHT, bends_mm=bends))
