"""The outline: pieces join smoothly, the wall has its thickness, radii are where they are said to be."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from meshes.bellows import Segment, cap_band, check_shape, corner_band, wall_segments
from meshes.errors import GeometryError
from meshes.fold import side_angle
from meshes.shape import BellowsShape

SHAPES = (
    BellowsShape(5.0, 10.5, 1.0, 5.0, 8, 3.0, 4.0, 0.5, 5.0),  # the reference
    BellowsShape(5.0, 10.5, 2.0, 5.0, 2, 3.0, 4.0, 0.5, 5.0),  # sides at right angles to the axis
    BellowsShape(7.0, 8.5, 0.6, 6.5, 3, 4.0, 2.0, 0.4, 2.0),  # shallow, flat sides
)
every_shape = pytest.mark.parametrize("shape", SHAPES, ids=["t1", "t2", "shallow"])
GOOD: dict[str, Any] = dict(
    root_radius_mm=5.0,
    crest_radius_mm=10.5,
    wall_mm=1.0,
    half_pitch_mm=5.0,
    convolutions=2,
    collar_mm=3.0,
    seat_mm=4.0,
    fillet_mm=0.5,
    cap_mm=5.0,
)
# Lengths are a few mm, sums of tens of pieces: 1e-12 mm is round-off.
ROUND_OFF = 1e-12


def ends(piece: Segment) -> tuple[np.ndarray, np.ndarray]:
    inner, outer = piece.band(np.array([0.0, 1.0]))
    return inner, outer


@every_shape
def test_pieces_share_end_points_and_tangents(shape: BellowsShape) -> None:
    pieces = wall_segments(shape)
    for here, after in zip(pieces[:-1], pieces[1:], strict=True):
        for side, next_side in zip(ends(here), ends(after), strict=True):
            assert side[1] == pytest.approx(next_side[0], abs=ROUND_OFF)
        assert here.tangent_end_rad == after.tangent_start_rad


@every_shape
def test_tangents_are_those_of_the_surfaces(shape: BellowsShape) -> None:
    h = 1e-5
    for piece in wall_segments(shape):
        for at, angle in ((0.0, piece.tangent_start_rad), (1.0, piece.tangent_end_rad)):
            for side in piece.band(np.array([at - h, at + h])):
                step = side[1] - side[0]
                direction = np.array([-math.sin(angle), math.cos(angle)])
                # central difference of an arc of about a radian: h^2 / 6, and round-off of z <= 80 mm over h
                assert step / np.linalg.norm(step) == pytest.approx(direction, abs=1e-8)


@every_shape
def test_wall_is_t_thick_along_the_normal_everywhere(shape: BellowsShape) -> None:
    for piece in wall_segments(shape):
        inner, outer = piece.band(np.linspace(0.0, 1.0, 9))
        across = outer - inner
        assert np.linalg.norm(across, axis=1) == pytest.approx(shape.wall_mm, abs=ROUND_OFF)
        h = 1e-5
        for before, after in zip(
            piece.band(np.linspace(0, 1, 9) - h), piece.band(np.linspace(0, 1, 9) + h), strict=True
        ):
            along = (after - before) / np.linalg.norm(after - before, axis=1)[:, None]
            # central difference as above
            assert np.einsum("ki,ki->k", along, across) == pytest.approx(0.0, abs=1e-8)


@every_shape
def test_radii_and_positions_are_those_of_the_shape(shape: BellowsShape) -> None:
    pieces = wall_segments(shape)
    assert ends(pieces[0])[0][0] == pytest.approx([shape.crest_radius_mm, 0.0], abs=ROUND_OFF)
    for piece in pieces:
        inner, outer = piece.band(np.array([0.0, 0.5, 1.0]))
        if piece.kind == "seat":
            assert inner[:, 0] == pytest.approx(shape.crest_radius_mm, abs=ROUND_OFF)
            assert outer[:, 0] == pytest.approx(shape.seat_radius_mm, abs=ROUND_OFF)
            middle = shape.crest_positions_mm[piece.index]
            assert np.abs(inner[:, 1] - middle).max() == pytest.approx(0.5 * shape.seat_mm, abs=1e-11)
    first_halves = [p for p in pieces if p.kind == "root"][::2]
    assert len(first_halves) == shape.convolutions
    for k, piece in enumerate(first_halves):
        middle = ends(piece)[0][1]
        z = shape.collar_mm + (2 * k + 1) * shape.half_pitch_mm
        assert middle == pytest.approx([shape.root_radius_mm, z], abs=1e-11)
    last = ends(pieces[-1])[0][1]
    assert last == pytest.approx([shape.crest_radius_mm, shape.cavity_length_mm - shape.fillet_mm], abs=1e-11)


@every_shape
def test_concave_surfaces_have_the_fillet_radius(shape: BellowsShape) -> None:
    def radius(points: np.ndarray) -> float:
        a, b, c = points
        sides = np.linalg.norm(b - a), np.linalg.norm(c - b), np.linalg.norm(c - a)
        twice_area = abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0])
        return float(np.prod(sides) / (2.0 * twice_area))

    for piece in wall_segments(shape):
        inner, outer = piece.band(np.array([0.0, 0.5, 1.0]))
        if piece.kind in ("crest", "root"):
            concave, convex = (inner, outer) if piece.kind == "crest" else (outer, inner)
            # circle through three points: round-off over the arc's sagitta, at least 0.01 mm
            assert radius(concave) == pytest.approx(shape.fillet_mm, rel=1e-9)
            assert radius(convex) == pytest.approx(shape.fillet_mm + shape.wall_mm, rel=1e-9)


@every_shape
def test_cap_joins_the_wall_and_ends_on_the_axis(shape: BellowsShape) -> None:
    wall = ends(wall_segments(shape)[-1])
    ends_at = np.array([0.0, 1.0])
    for side, corner, cap in zip(wall, corner_band(shape, ends_at), cap_band(shape, ends_at), strict=True):
        assert side[1] == pytest.approx(corner[0], abs=1e-11)
        assert corner[1] == pytest.approx(cap[0], abs=1e-11)
        assert cap[1, 0] == 0.0
    corner_in, _ = corner_band(shape, np.linspace(0.0, 1.0, 7))
    centre = [shape.crest_radius_mm - shape.fillet_mm, shape.cavity_length_mm - shape.fillet_mm]
    assert np.linalg.norm(corner_in - centre, axis=1) == pytest.approx(shape.fillet_mm, abs=ROUND_OFF)
    _, edge = corner_band(shape, np.array([0.5]))
    assert edge[0] == pytest.approx([shape.seat_radius_mm, shape.cavity_length_mm + shape.cap_mm], abs=1e-11)


def test_side_fills_the_half_pitch_and_the_depth() -> None:
    for shape in SHAPES:
        phi = side_angle(shape)
        assert 0.0 < phi <= 0.5 * math.pi
        side = next(p for p in wall_segments(shape) if p.kind == "side")
        rho = shape.centreline_radius_mm
        room = 2 * rho * math.sin(phi) + side.length_mm * math.cos(phi)
        drop = 2 * rho * (1 - math.cos(phi)) + side.length_mm * math.sin(phi)
        # bisection to the last bit of phi
        assert room == pytest.approx(shape.half_pitch_mm - 0.5 * shape.seat_mm, abs=ROUND_OFF)
        assert drop == pytest.approx(shape.crest_radius_mm - shape.root_radius_mm, abs=ROUND_OFF)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"wall_mm": 2.5}, r"half_pitch_mm = 5 .*half_pitch >= seat/2 \+ 2 fillet \+ wall = 5\.5 mm"),
        ({"half_pitch_mm": 3.9}, r"half_pitch_mm = 3\.9 leaves 1\.9 mm .*>= .* = 4 mm"),
        ({"collar_mm": 2.4}, r"collar_mm = 2\.4 must be at least seat/2 \+ fillet = 2\.5 mm"),
        ({"fillet_mm": 0.0}, r"fillet_mm = 0\.0: must be a finite length > 0"),
        ({"fillet_mm": -0.5}, r"fillet_mm = -0\.5: must be a finite length > 0"),
        (
            {"fillet_mm": 11.0, "collar_mm": 20.0, "half_pitch_mm": 40.0},
            r"fillet_mm = 11 must be less than crest_radius_mm = 10\.5",
        ),
        ({"crest_radius_mm": 5.0}, r"crest_radius_mm = 5 must exceed root_radius_mm = 5"),
        ({"crest_radius_mm": 4.0}, r"crest_radius_mm = 4 must exceed root_radius_mm = 5"),
        ({"crest_radius_mm": 6.5}, r"crest_radius_mm - root_radius_mm = 1\.5 mm .*2 fillet \+ wall = 2 mm"),
        ({"wall_mm": 0.0}, r"wall_mm = 0\.0: must be"),
        ({"wall_mm": math.nan}, r"wall_mm = nan: must be"),
        ({"root_radius_mm": -1.0}, r"root_radius_mm = -1\.0: must be"),
        ({"cap_mm": math.inf}, r"cap_mm = inf: must be"),
    ],
)
def test_impossible_shape_is_refused_with_the_violated_inequality(change: dict, message: str) -> None:
    check_shape(BellowsShape(**GOOD))
    with pytest.raises(GeometryError, match=message):
        check_shape(BellowsShape(**{**GOOD, **change}))


@pytest.mark.parametrize(
    "change",
    [
        {"seat_mm": -1.0},
        {"seat_mm": math.nan},
        {"crest_radius_mm": math.nan},
        {"crest_radius_mm": math.inf},
        {"convolutions": 0},
        {"convolutions": -2},
    ],
)
def test_seat_crest_and_count_are_checked_too(change: dict) -> None:
    with pytest.raises(GeometryError, match=next(iter(change))):
        check_shape(BellowsShape(**{**GOOD, **change}))
