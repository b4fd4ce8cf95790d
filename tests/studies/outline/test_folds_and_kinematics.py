"""Folds of states that are known exactly, and what inputs of equation (23) change alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analytical.bellows.chains import closed_form
from analytical.bellows.paper import actuators
from studies.outline.folds import measure_folds
from studies.outline.kinematics import Fold, each_alone, kinematics_mm, stretch_beside_hoop
from studies.results.closed_form_rows import free_wall_mm
from studies.results.measures import find_places
from studies.scene.bellows import shape_of
from studies.scene.load import load_bellows

THIN = actuators()[0]


@pytest.mark.parametrize("rings", ["rigid", "none"])
def test_folds_of_an_affine_state(root: Path, rings: str) -> None:
    scene = load_bellows(root / "scenes" / "smoke-t2-ri5.toml")
    scene = scene.model_copy(update={"rings": scene.rings.model_copy(update={"model": rings})})
    shape, places = shape_of(scene), find_places(scene, 4)
    r, z = places.points.T
    tip = 0.25 * shape.cavity_length_mm
    found = measure_folds(places, np.column_stack([0.5 * r, 0.25 * z]), tip)
    seat = shape.seat_mm if rings == "rigid" else 0.0
    # round-off: ends of lines are nodes
    assert found.fold_along_mm == pytest.approx(1.25 * (shape.half_pitch_mm - 0.5 * seat), rel=1e-12)
    assert found.fold_across_mm == pytest.approx(1.5 * (shape.crest_radius_mm - shape.root_radius_mm), rel=1e-12)
    assert found.seats_longer_mm == pytest.approx(0.25 * seat * (shape.convolutions - 1), abs=1e-12)
    assert found.collars_longer_mm == pytest.approx(0.25 * (2.0 * shape.collar_mm + seat), rel=1e-12)
    # parabolas for arcs of 11 degrees: fourth order, 4e-4 of their length at 45 degrees
    assert found.fold_line_mm == pytest.approx(free_wall_mm(shape) + 0.5 * (shape.seat_mm - seat), rel=2e-6)


@pytest.mark.parametrize("pressure", [5.0, 20.0])
def test_kinematics_are_those_of_the_closed_form(pressure: float) -> None:
    for actuator in actuators():
        d, chain = actuator.dimensions, closed_form(actuator.dimensions, actuator.law, pressure)
        stretches = float(chain.root_stretch[0]), float(chain.wall_stretch[0])
        found = kinematics_mm(d, Fold(*stretches, d.side_length_mm, d.half_pitch_mm))
        # round-off
        assert found == pytest.approx(float(chain.elongation_mm[0]), rel=1e-12)


@pytest.mark.parametrize("across", [0.0, 3.0])
def test_kinematics_between_measured_ends(across: float) -> None:
    # a triangle of 3, 4 and 5 mm, or the whole line along the axis
    along = 4.0 if across else 5.0
    found = kinematics_mm(THIN.dimensions, Fold(9.0, 1.25, 4.0, 1.0), across)
    assert found == pytest.approx(2.0 * THIN.dimensions.convolutions * (along - 1.0), rel=1e-15)


def test_two_inputs_share_what_they_do_together_and_three_need_not() -> None:
    d = THIN.dimensions
    given = Fold(1.1, 1.2, d.side_length_mm, d.half_pitch_mm)
    root, wall, line = ("root", {"root_stretch": 1.5}), ("wall", {"wall_stretch": 1.0}), ("line", {"length_mm": 9.0})
    left = []
    for factors, measured in (
        (([root], [wall]), Fold(1.5, 1.0, d.side_length_mm, d.half_pitch_mm)),
        (([root], [wall], [line]), Fold(1.5, 1.0, 9.0, d.half_pitch_mm)),
    ):
        found = each_alone(d, given, factors)
        left.append(
            kinematics_mm(d, measured)
            - kinematics_mm(d, given)
            - sum(0.5 * (low + high) for low, high in found.values())
        )
    alone, beside = found["root"]
    assert alone == pytest.approx(kinematics_mm(d, Fold(1.5, 1.2, d.side_length_mm, 5.0)) - kinematics_mm(d, given))
    assert beside == pytest.approx(kinematics_mm(d, measured) - kinematics_mm(d, Fold(1.1, 1.0, 9.0, 5.0)))
    # round-off of differences of 100 mm; with three, half of what all do together is left
    assert abs(left[0]) < 1e-11 and abs(left[1]) > 0.1


def test_steps_of_one_factor_follow_one_another() -> None:
    d = THIN.dimensions
    given = Fold(1.1, 1.2, d.side_length_mm, d.half_pitch_mm)
    found = each_alone(d, given, ([("first", {"wall_stretch": 1.1}), ("second", {"wall_stretch": 1.4})],))
    whole = kinematics_mm(d, Fold(1.1, 1.4, d.side_length_mm, d.half_pitch_mm)) - kinematics_mm(d, given)
    assert found["first"][0] < 0.0 < found["second"][0]
    assert sum(low for low, _ in found.values()) == pytest.approx(whole, rel=1e-12)  # round-off
    assert all(low == pytest.approx(high, rel=1e-12) for low, high in found.values())


def test_side_wall_beside_a_hoop_stretch() -> None:
    for actuator in actuators():
        chain = closed_form(actuator.dimensions, actuator.law, 10.0)
        stress, stretch = float(chain.wall_stress_mpa[0]), float(chain.wall_stretch[0])
        # 2e-12 is where the search stops
        assert stretch_beside_hoop(actuator.law, stress, 1.0) == pytest.approx(stretch, abs=1e-11)
        assert stretch_beside_hoop(actuator.law, stress, 1.2) < stretch
        # nothing pulls: as long as in a pull round the axis
        assert stretch_beside_hoop(actuator.law, 0.0, 1.44) == pytest.approx(1.0 / 1.2, abs=1e-11)
        assert stretch_beside_hoop(actuator.law, 0.0, 0.81) == pytest.approx(1.0 / 0.9, abs=1e-11)
    assert np.isnan(stretch_beside_hoop(THIN.law, 0.1, float("nan")))
