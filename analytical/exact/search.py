"""Roots to round-off, and the first solution met on the way from rest."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq, minimize_scalar

# Stretches beyond which no solution is sought: no elastomer goes there.
STRETCH_RANGE: Final = (0.02, 50.0)

# The search takes steps this small so that it meets the first of several solutions.
_SEARCH_RATIO = 1.05


def root(function: Callable[[float], ArrayLike], near: float, far: float, within: float = 1e-15) -> float:
    """Where a function changes sign between two places, to round-off or to `within`, in the unit of the places."""
    return float(brentq(function, near, far, xtol=within, rtol=4.0 * np.finfo(float).eps))


def first_solution(
    function: Callable[[float], float], start: float, bounds: tuple[float, float], target: float
) -> tuple[float | None, float]:
    """First x, on the way up or down from `start`, at which an initially rising function has a value.

    A target above function(start) is looked for upwards, one below downwards, in steps of 5 %. A maximum on the
    way (minimum, downwards) is located, so that a target just short of it is found too.

    Parameters
    ----------
    function
        Continuous; features narrower than two steps may be missed.
    start, bounds
        Positive; the search ends at the last step inside `bounds`.
    target
        The value looked for.

    Returns
    -------
    tuple
        x to round-off, or None if the value is not met; and the furthest value met in its direction.
    """
    sign = math.copysign(1.0, target - function(start))
    ratio = _SEARCH_RATIO**sign

    def short(x: float) -> float:
        return sign * (target - function(x))

    def crossing(near: float, far: float) -> float:
        return root(short, near, far, 1e-14 * start)

    before, near, far = start, start, start * ratio
    short_before = short_near = least = short(start)
    while bounds[0] < far < bounds[1]:
        short_far = short(far)
        if short_far <= 0.0:
            return crossing(near, far), target
        least = min(least, short_far)
        if short_before >= short_near < short_far:
            # 1e-9: the value of an extremum is at round-off long before
            options = {"xatol": 1e-9 * near}
            low, high = sorted((before, far))
            turn = float(minimize_scalar(short, bounds=(low, high), method="bounded", options=options).x)
            short_turn = short(turn)
            if short_turn <= 0.0:
                return crossing(before, turn), target
            least = min(least, short_turn)
        before, near, far = near, far, far * ratio
        short_before, short_near = short_near, short_far
    return None, target - sign * least
