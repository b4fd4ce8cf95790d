"""Where a change with the load may be gone along: not once bodies have turned, whichever of their motions they have."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solvers.bodies.rigid import EVERY_MOTION
from solvers.equilibrium.newton import TURNED, _rate

TOWARD = np.zeros(0), np.zeros(0)


def problem_of(motions: tuple[int, ...], motion: int, value_mm: float) -> Any:
    """What is asked of a problem with one body, whose arm is 2 mm, at a value of one of its motions."""
    values = np.array([[value_mm if m == motion else 0.0 for m in motions]])
    bonded = SimpleNamespace(values=values, motions=motions, arm_mm=2.0)
    return SimpleNamespace(bonded=bonded, contact=None, unknowns=SimpleNamespace(rate=lambda *of: "rate"))


# the symmetric classes of a quarter and of a half, and a whole body
@pytest.mark.parametrize("motions", [(2,), (0, 2, 4), EVERY_MOTION])
def test_rotations_add_up_only_while_they_are_small(motions: tuple[int, ...]) -> None:
    for motion in motions:
        moved = problem_of(motions, motion, 1.0)
        assert (_rate(moved, TOWARD) is None) == (motion >= 3)
        assert _rate(problem_of(motions, motion, TURNED), TOWARD) is not None
