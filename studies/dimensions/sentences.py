"""What the study of the unprinted dimensions says in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from analytical.bellows.fit.masses import MASS_WITHIN
from analytical.bellows.fit.members import ORDERS, SILICONES, TEXT_ORDER, Members, wall_stretch
from analytical.bellows.paper import PRINTED_MASS_G
from studies.dimensions.fit import ACTUATORS, Fit
from studies.dimensions.predictions import Prediction
from studies.dimensions.tables import factor


def mass_window() -> str:
    """The allowed masses."""
    low, high = _window_g()
    return f"{low:.1f} to {high:.1f} g"


def _window_g() -> tuple[float, float]:
    return PRINTED_MASS_G * (1.0 - MASS_WITHIN), PRINTED_MASS_G * (1.0 + MASS_WITHIN)


def runners_up(found: Fit) -> str:
    """By how much the reference wins."""
    drawn = found.picks.drawn
    candidates = drawn.take(found.picks.admissible & drawn.one_silicone_per_wall)
    stretch = np.sort(wall_stretch(candidates).max(axis=1))
    if len(stretch) < 2:
        return "No other set is left to choose from."
    return (
        f"{len(stretch)} of them may weigh what they do and can be built; the next after the reference has a wall "
        f"stretch of {stretch[1]:.3f} against {stretch[0]:.3f}."
    )


def finer_grids(found: Fit) -> str:
    """What the rule would win without a drawing's grid."""
    drawn, *finer = (rule for rule in found.rules if rule.shapes == "buildable")
    if not len(drawn.pick):
        return "Nothing on the drawing's grid can be built."
    parts = (f"steps of {rule.step_mm:g} mm {_gain(rule.pick, drawn.pick)}" for rule in finer)
    return f"Of what can be built, {'; '.join(parts)}."


def _gain(pick: Members, reference: Members) -> str:
    """What a pick has over the reference, both one member; the pick may be none."""
    if not len(pick):
        return "give nothing that can be built"
    gain = 100.0 * (1.0 - wall_stretch(pick).max() / wall_stretch(reference).max())
    # the same number on both grids up to a step's round-off
    if abs(gain) < 1e-6:
        return "give the same set"
    return f"a wall stretch smaller by {gain:.1f} %, for an error of {100.0 * pick.worst_error[0]:.2f} %"


def orders(found: Fit) -> str:
    """In which reading orders, and with how many choices of silicone, anything fits."""
    used = np.unique(found.fitting.order)
    choices = len(SILICONES) ** len(ACTUATORS)
    without = choices - len(np.unique(found.fitting.silicone, axis=0))
    if list(used) != [TEXT_ORDER]:
        return f"Sets fit in these orders: {'; '.join(str(ORDERS[k]) for k in used)}."
    return (
        "**Every set that fits reads the pairs as the text does**: R_i = 5 mm has the larger number of each pair "
        "(a larger root elongates less, says the text), which reverses the 2 mm pair. The other three orders, and "
        f"{without} of the {choices} choices of silicone, do not fit at all."
    )


def differences(predicted: Sequence[Prediction]) -> str:
    """By what factor the sets differ in what was not fitted, the worst actuator of each quantity."""
    factors = [(p.members.max(axis=0) / p.members.min(axis=0)).max() for p in predicted]
    texts = (f"{factor(one)} ({p.quantity.label})" for p, one in zip(predicted, factors, strict=True))
    return (
        "Largest over smallest prediction among the sets that all meet the four numbers, for the actuator where it is "
        f"most: {', '.join(texts)}."
    )


def single_masses(found: Fit) -> str:
    """Which single actuators are outside the window that their mean must be in."""
    low, high = _window_g()
    parts = []
    for of_set in found.sets:
        for what, mass in (("alone", of_set.meshed_g[:, 0]), ("with rings", of_set.meshed_g.sum(axis=1))):
            outside = [a.name for a, g in zip(of_set.actuators, mass, strict=True) if not low <= g <= high]
            if outside:
                parts.append(f"{of_set.name}, silicone {what}: {', '.join(outside)}")
    return f"Single actuators outside {mass_window()}: {'; '.join(parts) or 'none'}."
