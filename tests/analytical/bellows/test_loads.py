"""Pressure for an elongation, and the force at a held tip."""

from __future__ import annotations

import numpy as np
import pytest

from analytical.bellows.chains import closed_form
from analytical.bellows.dimensions import BellowsError
from analytical.bellows.loads import held_tip, pressure_at_elongation_kpa
from analytical.bellows.paper import PaperActuator
from analytical.bellows.reading import Reading
from tests.analytical.bellows.cases import ACTUATORS, every_actuator, every_chain


@every_actuator
@every_chain
def test_pressure_inverts_elongation(actuator: PaperActuator, reading: Reading) -> None:
    pressures = [0.0, 1.0, 7.0, 19.0]
    elongations = closed_form(actuator.dimensions, actuator.law, pressures, reading).elongation_mm
    found = [
        pressure_at_elongation_kpa(actuator.dimensions, actuator.law, float(max(x, 0.0)), reading) for x in elongations
    ]
    # round-off of an elongation of 100 mm over a slope of a few mm per kPa
    assert found == pytest.approx(pressures, rel=1e-11, abs=1e-12)


@every_actuator
@every_chain
def test_no_force_at_the_free_tip(actuator: PaperActuator, reading: Reading) -> None:
    free = closed_form(actuator.dimensions, actuator.law, 12.0, reading)
    held = held_tip(actuator.dimensions, actuator.law, 12.0, float(free.elongation_mm[0]), reading)
    assert held.wall_stretch == pytest.approx(free.wall_stretch, rel=1e-13)
    # round-off of a force of the size of the thrust
    assert held.tip_force_n == pytest.approx([0.0], abs=1e-11 * float(free.extension_force_n[0]))


@every_actuator
@every_chain
def test_blocked_tip(actuator: PaperActuator, reading: Reading) -> None:
    pressures = np.array([0.0, 5.0, 10.0, 20.0])
    blocked = held_tip(actuator.dimensions, actuator.law, pressures, reading=reading)
    # at rest: round-off of stresses of the size of the modulus on mm2
    assert blocked.tip_force_n[0] == pytest.approx(0.0, abs=1e-12)
    assert np.all(np.diff(blocked.tip_force_n) > 0.0)
    # a root that opens leaves the blocked wall shorter than at rest: it pushes with the pressure
    assert np.all(blocked.wall_stretch[1:] < 1.0)
    assert np.all(blocked.tip_force_n[1:] > blocked.extension_force_n[1:])


def test_force_falls_with_the_elongation_it_is_held_at() -> None:
    actuator = ACTUATORS[2]
    forces = [
        float(held_tip(actuator.dimensions, actuator.law, 15.0, x).tip_force_n[0]) for x in (-5.0, 0.0, 10.0, 30.0)
    ]
    assert all(b < a for a, b in zip(forces[:-1], forces[1:], strict=True))


def test_bad_input_is_refused() -> None:
    d, law = ACTUATORS[0].dimensions, ACTUATORS[0].law
    for elongation_mm in (-1.0, float("nan"), float("inf")):
        with pytest.raises(BellowsError, match="elongation_mm"):
            pressure_at_elongation_kpa(d, law, elongation_mm)
    with pytest.raises(BellowsError, match="folds_back"):
        pressure_at_elongation_kpa(d, law, 10.0, Reading(folds_back=True))
    with pytest.raises(BellowsError, match="leaves no length"):
        held_tip(d, law, 5.0, -80.0)
    with pytest.raises(BellowsError, match="not reached"):
        pressure_at_elongation_kpa(d, law, 1e6)
