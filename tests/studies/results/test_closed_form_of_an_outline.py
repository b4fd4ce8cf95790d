"""The closed form fed with an outline's wall: the paper's chain where walls are straight, longer where they bend."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from studies.results.closed_form_rows import closed_form_values, fed_mm, free_wall_mm
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.load import load_bellows

SCENES = Path(__file__).resolve().parents[3] / "scenes"
NAMES = ("heung-t1-ri5", "heung-t1-ri7", "heung-t2-ri5", "heung-t2-ri7")


def corrected(scene: BellowsScene, model: str, pressure_kpa: float) -> float:
    return next(value for name, value, _ in closed_form_values(scene, pressure_kpa) if name == model)


@pytest.mark.parametrize("name", NAMES)
def test_less_its_slack_it_is_the_closed_form_again_near_the_zigzag(name: str) -> None:
    """Walls that are nearly straight have nearly the paper's length: within 1 mm."""
    scene = load_bellows(SCENES / "zigzag" / f"{name}.toml")
    for pressure in scene.load.pressure_kpa:
        _, less = fed_mm(scene, pressure)
        assert less == pytest.approx(corrected(scene, "closed_form", pressure), abs=1.0)


@pytest.mark.parametrize("name", NAMES)
def test_bends_only_lengthen(name: str) -> None:
    moulded, zigzag = load_bellows(SCENES / f"{name}.toml"), load_bellows(SCENES / "zigzag" / f"{name}.toml")
    for pressure in moulded.load.pressure_kpa:
        rows = [corrected(scene, "closed_form_outline", pressure) for scene in (moulded, zigzag)]
        assert rows[0] > rows[1] > corrected(zigzag, "closed_form", pressure)


def test_the_free_wall_is_that_of_the_outlines_pieces() -> None:
    """Two arcs of radius rho and a side, by hand from the angle that fills the half pitch."""
    shape = shape_of(load_bellows(SCENES / "heung-t2-ri5.toml"))
    rho, drop = shape.fillet_mm + 0.5 * shape.wall_mm, shape.crest_radius_mm - shape.root_radius_mm
    # here arcs take the whole room beside the seat: the sides stand upright
    assert 2.0 * rho == pytest.approx(shape.half_pitch_mm - 0.5 * shape.seat_mm)
    assert free_wall_mm(shape) == pytest.approx(math.pi * rho + drop - 2.0 * rho, rel=1e-12)
