"""Laws that the exact solutions are tested with, and derivatives by differences as the second route."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from analytical.laws.isotropic import IsotropicLaw, Law, NeoHooke, Ogden
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30

# One of each form, for what takes its time; and all conventions and signs.
THREE_LAWS: tuple[Law, ...] = (NeoHooke(0.1), DRAGON_SKIN_10, dragon_skin_30("2mu/alpha^2"))
LAWS: tuple[IsotropicLaw, ...] = (*THREE_LAWS, dragon_skin_30("mu/alpha"), Ogden(-0.1, -3.0, "mu/alpha"))

every_law = pytest.mark.parametrize("law", LAWS, ids=str)
each_of_three_laws = pytest.mark.parametrize("law", THREE_LAWS, ids=str)

# Second difference of order 8 over h^2, by distance in steps: Fornberg, Math. Comp. 51 (1988) 699, table 1.
SECOND_DIFFERENCE = {0: -205.0 / 72.0, 1: 8.0 / 5.0, 2: -1.0 / 5.0, 3: 8.0 / 315.0, 4: -1.0 / 560.0}


def derivative(function: Callable[[float], float], at: float, step: float = 1e-2) -> float:
    """Central difference of order 8; with steps of 1e-2 `at` truncation and round-off are both about 1e-13 relative."""
    h = step * at
    weights = (4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0)
    return sum(w * (function(at + k * h) - function(at - k * h)) for k, w in enumerate(weights, start=1)) / h
