"""Equation (23) of DOI 10.3390/biomimetics9030160, and what one of its inputs alone changes in it.

``u = 2 n (sqrt((lambda_a L)^2 - ((R_p + t) - lambda_y (R_i + t))^2) - e)``: the inputs are the stretches lambda_y of
the root and lambda_a of the side wall, and the outline of the wall, its length L on a half pitch e.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from scipy.optimize import brentq

from analytical.bellows.dimensions import BellowsDimensions
from analytical.laws.isotropic import Law

# In the order of a factor: a cause, and the inputs it brings.
Steps = Sequence[tuple[str, Mapping[str, float]]]


@dataclass(frozen=True)
class Fold:
    """Inputs of equation (23)."""

    root_stretch: float
    wall_stretch: float
    length_mm: float
    half_pitch_mm: float


def drop_mm(d: BellowsDimensions, root_stretch: float) -> float:
    """How much further out the outside of the crests is than that of the roots, mm."""
    return d.crest_radius_mm + d.wall_mm - root_stretch * (d.root_radius_mm + d.wall_mm)


def kinematics_mm(d: BellowsDimensions, fold: Fold, across_mm: float | None = None) -> float:
    """Elongation of equation (23), mm; NaN if the wall cannot span the fold.

    Parameters
    ----------
    across_mm
        How far out the wall's ends are apart; what the root's stretch says if None.
    """
    across = drop_mm(d, fold.root_stretch) if across_mm is None else across_mm
    square = (fold.wall_stretch * fold.length_mm) ** 2 - across**2
    return 2.0 * d.convolutions * (math.sqrt(square) - fold.half_pitch_mm) if square >= 0.0 else math.nan


def each_alone(d: BellowsDimensions, closed_form: Fold, factors: Sequence[Steps]) -> dict[str, tuple[float, float]]:
    """What each cause changes when no other factor is changed, and when all others are, mm.

    Parameters
    ----------
    closed_form
        What the closed form is given.
    factors
        All together they bring what was measured; the steps of one follow one another.

    Returns
    -------
    dict
        By cause: its change beside the closed form's other inputs, and beside the measured ones. They differ where
        inputs act together.
    """
    measured = closed_form
    for steps in factors:
        for _, inputs in steps:
            measured = replace(measured, **inputs)
    found = {}
    for steps in factors:
        own = {name: getattr(closed_form, name) for _, inputs in steps for name in inputs}
        ends = [closed_form, replace(measured, **own)]
        for cause, inputs in steps:
            after = [replace(fold, **inputs) for fold in ends]
            low, high = (kinematics_mm(d, b) - kinematics_mm(d, a) for a, b in zip(ends, after, strict=True))
            found[cause], ends = (low, high), after
    return found


def stretch_beside_hoop(law: Law, stress_mpa: float, hoop_stretch: float) -> float:
    """Stretch along the wall at a Cauchy stress along it and a hoop stretch; the closed form's pure shear has 1.

    NaN of a hoop stretch that is not known.
    """
    if math.isnan(hoop_stretch):
        return math.nan

    def excess(stretch: float) -> float:
        return float(law.stress_difference(stretch, 1.0 / (stretch * hoop_stretch), hoop_stretch)) - stress_mpa

    # The stress rises with the stretch; without any the wall is 1 / sqrt(hoop_stretch) long.
    high = 1.0
    while excess(high) < 0.0:
        high *= 1.5
    low = min(1.0, 1.0 / math.sqrt(hoop_stretch)) * (1.0 - 1e-6)
    return float(brentq(excess, low, high))
