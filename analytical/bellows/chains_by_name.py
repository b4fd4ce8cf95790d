"""The chains of the closed form by the names of models, what the paper prints beside them, names of the silicones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from analytical.bellows.chains import ClosedFormPath, closed_form
from analytical.bellows.paper import PaperActuator, Silicone
from analytical.bellows.reading import BALANCED, CORRECTED, PRINTED_READING, Reading
from analytical.laws.silicones import (
    DRAGON_SKIN_10_ELONGATION_AT_BREAK_PERCENT,
    DRAGON_SKIN_30_ELONGATION_AT_BREAK_PERCENT,
)

PRESSURES_KPA: Final = (5.0, 10.0, 15.0, 20.0)
# By model: how its chain reads the equations.
CHAINS: Final[Mapping[str, Reading]] = {
    "closed_form_printed": PRINTED_READING,
    "closed_form": CORRECTED,
    "closed_form_balanced": BALANCED,
}
# The same chains in tables that have no room.
SHORT: Final = {"closed_form_printed": "printed", "closed_form": "corrected", "closed_form_balanced": "balanced"}
# The balanced chain at its cuts; the first is the chain itself.
CUTS: Final[Mapping[str, Reading]] = {
    "mean": BALANCED,
    "crest": replace(BALANCED, cut="crest"),
    "root": replace(BALANCED, cut="root"),
}
SILICONES: Final[Mapping[Silicone, str]] = {"dragon-skin-10": "Dragon Skin 10", "dragon-skin-30": "Dragon Skin 30"}
STRETCH_AT_BREAK: Final[Mapping[Silicone, float]] = {
    "dragon-skin-10": 1.0 + 0.01 * DRAGON_SKIN_10_ELONGATION_AT_BREAK_PERCENT,
    "dragon-skin-30": 1.0 + 0.01 * DRAGON_SKIN_30_ELONGATION_AT_BREAK_PERCENT,
}


def path_of(
    actuator: PaperActuator, reading: Reading, pressures_kpa: Sequence[float] = PRESSURES_KPA
) -> ClosedFormPath:
    """A chain's answer for an actuator at pressures in kPa."""
    return closed_form(actuator.dimensions, actuator.law, np.asarray(pressures_kpa), reading)


def printed_mm(actuator: PaperActuator) -> dict[str, float]:
    """Printed elongations at 20 kPa by model, mm."""
    known = actuator.printed
    return {
        "paper_closed_form": 10.0 * known.closed_form_cm,
        "paper_ansys": 10.0 * known.ansys_cm,
        "paper_experiment": 10.0 * known.experiment_cm,
    }
