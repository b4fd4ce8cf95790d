"""First guesses for the next step: polynomials through the last converged states."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from solvers.domain import FloatArray
from solvers.records import Control, PathPoint
from solvers.state import State, combine


def coordinate(point: PathPoint, control: Control) -> float:
    """The quantity that steps are taken in: volume in mm^3 or pressure in MPa."""
    return point.volume_mm3 if control == "volume" else point.pressure_mpa


def _weights(nodes: Sequence[float], at: float) -> FloatArray:
    """Weights of the polynomial through ``nodes``, evaluated at ``at``."""
    weights = np.ones(len(nodes))
    for i, x in enumerate(nodes):
        for j, y in enumerate(nodes):
            if i != j:
                weights[i] *= (at - y) / (x - y)
    return weights


def _usable(history: Sequence[PathPoint], control: Control) -> Sequence[PathPoint]:
    """The last three states, fewer where the coordinate does not ascend: past a limit point the pressure does not."""
    last = list(history[-3:])
    while len(last) > 1 and not (np.diff([coordinate(p, control) for p in last]) > 0.0).all():
        last.pop(0)
    return last


def extrapolate(history: Sequence[PathPoint], control: Control, at: float) -> State:
    """State at a volume or a pressure, from the polynomial through the last three."""
    last = _usable(history, control)
    return combine([p.state for p in last], list(_weights([coordinate(p, control) for p in last], at)))


def predicted_pressure(history: Sequence[PathPoint], volume_mm3: float) -> float:
    """Pressure at a volume."""
    last = _usable(history, "volume")
    return float(_weights([p.volume_mm3 for p in last], volume_mm3) @ np.array([p.pressure_mpa for p in last]))


def volume_at_pressure(history: Sequence[PathPoint], low: float, high: float, pressure_mpa: float) -> float:
    """Volume in [low, high] at which the predicted pressure is the given one, by bisection."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if predicted_pressure(history, middle) < pressure_mpa else (low, middle)
    return 0.5 * (low + high)
