"""What every correction of the print is worth, against the equations with and without it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import quad

from analytical.bellows.corrections import CORRECTIONS, effect_cm
from analytical.bellows.paper import PaperActuator
from analytical.laws.silicones import DRAGON_SKIN_10
from tests.analytical.bellows.by_equations import elongation_by_equations_cm
from tests.analytical.bellows.cases import ACTUATORS, every_actuator

EFFECTS: dict[str, Callable[[PaperActuator], float]] = {
    "Ogden derivative at the root": lambda actuator: elongation_by_equations_cm(actuator, ogden_derivative=True),
    "inner stretch": lambda actuator: elongation_by_equations_cm(actuator, linearised=True),
    "steps of the root stretch": lambda actuator: elongation_by_equations_cm(actuator, table=True),
    "Ogden convention of the wall": lambda actuator: elongation_by_equations_cm(actuator, ogden_wall_by_20=True),
    "full unfolding": lambda actuator: elongation_by_equations_cm(actuator, saturated=False),
}


@pytest.mark.parametrize("name", EFFECTS)
@every_actuator
def test_effect_of_each_misprint(name: str, actuator: PaperActuator) -> None:
    (correction,) = [item for item in CORRECTIONS if item.name == name]
    by_equations = elongation_by_equations_cm(actuator) - EFFECTS[name](actuator)
    # two routes through different quadratures and root finders; differences of lengths of 10 cm
    assert effect_cm(correction, actuator.dimensions, actuator.law, 20.0) == pytest.approx([by_equations], abs=1e-9)


@every_actuator
def test_effect_of_the_deformed_area(actuator: PaperActuator) -> None:
    (correction,) = [item for item in CORRECTIONS if item.name == "wall on the deformed area"]
    by_equations = elongation_by_equations_cm(actuator, wall_stress_on_deformed_area=True)
    change = by_equations - elongation_by_equations_cm(actuator)
    assert effect_cm(correction, actuator.dimensions, actuator.law, 20.0) == pytest.approx([change], abs=1e-9)


def test_corrections_are_named_and_told_apart() -> None:
    assert len({correction.name for correction in CORRECTIONS}) == len(CORRECTIONS)
    wording = [correction.name for correction in CORRECTIONS if correction.without == correction.with_]
    assert wording == ["crest radius", "local radius", "wall offset", "strain for stretch", "elongation of the whole"]
    unevaluable = [correction for correction in CORRECTIONS if correction.without is None]
    assert [correction.name for correction in unevaluable] == ["sign of the pressure"]
    assert np.isnan(effect_cm(unevaluable[0], ACTUATORS[0].dimensions, ACTUATORS[0].law, [5.0, 20.0])).all()


def test_the_printed_sign_only_lets_a_root_shrink() -> None:
    # eq. (16) as printed, from lambda_i to lambda_o: negative where the root widens, so nothing to evaluate
    def printed_16(outer: float, inner: float) -> float:
        def integrand(s: float) -> float:
            return float(DRAGON_SKIN_10.stress_difference(s, 1.0 / s, 1.0)) / (s * (1.0 - s**2))

        return -quad(integrand, inner, outer)[0]

    assert printed_16(1.2, 1.28) < 0.0
    assert printed_16(0.9, 0.85) > 0.0
