"""First guesses for the next step: polynomials through the last converged states."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from solvers.discrete.domain import FloatArray
from solvers.paths.arc import Scale, distance
from solvers.paths.states import ControlName, PathPoint
from solvers.state import State, combine


def coordinates(history: Sequence[PathPoint], control: ControlName, scale: Scale) -> list[float]:
    """The quantity that steps are taken in: volume in mm^3, pressure in MPa, arc length (0 at the last state)."""
    if control == "volume":
        return [p.volume_mm3 for p in history]
    if control == "pressure":
        return [p.pressure_mpa for p in history]
    pairs = zip(history[:-1], history[1:], strict=True)
    chords = [distance(a.state, b.state, scale) for a, b in pairs]
    return [-sum(chords[k:]) for k in range(len(chords) + 1)]


def _weights(nodes: Sequence[float], at: float) -> FloatArray:
    """Weights of the polynomial through ``nodes``, evaluated at ``at``."""
    weights = np.ones(len(nodes))
    for i, x in enumerate(nodes):
        for j, y in enumerate(nodes):
            if i != j:
                weights[i] *= (at - y) / (x - y)
    return weights


def _usable(
    history: Sequence[PathPoint], control: ControlName, scale: Scale
) -> tuple[Sequence[PathPoint], Sequence[float]]:
    """The last three states, fewer where the coordinate does not ascend (past a limit point), and where they are."""
    last, at = list(history[-3:]), coordinates(history[-3:], control, scale)
    while len(last) > 1 and not (np.diff(at) > 0.0).all():
        last.pop(0)
        at.pop(0)
    return last, at


def extrapolate(history: Sequence[PathPoint], control: ControlName, at: float, scale: Scale) -> State:
    """State at a volume, a pressure or an arc length, from the polynomial through the last three."""
    last, nodes = _usable(history, control, scale)
    return combine([p.state for p in last], list(_weights(nodes, at)))


def predicted_pressure(history: Sequence[PathPoint], control: ControlName, at: float, scale: Scale) -> float:
    """Pressure at a volume or an arc length."""
    last, nodes = _usable(history, control, scale)
    return float(_weights(nodes, at) @ np.array([p.pressure_mpa for p in last]))


def peak(here: PathPoint, end: PathPoint) -> tuple[float, float] | None:
    """Where between two states the pressure is highest, as a share of the way in volume, and how high it is, MPa.

    By the cubic with the pressures and the slopes dP/dV of both ends; None if it has no maximum between them, or a
    slope is not known. The volume must not turn back on the way.
    """
    way, rise = end.volume_mm3 - here.volume_mm3, end.pressure_mpa - here.pressure_mpa
    first, last = here.slope_mpa_per_mm3 * way, end.slope_mpa_per_mm3 * way
    # P = P0 + first t + square t^2 + cube t^3; the root of its derivative at which the second one is negative
    square, cube = 3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise
    root = square**2 - 3.0 * cube * first
    if not 0.0 <= root < math.inf or math.sqrt(root) == square:
        return None
    t = first / (math.sqrt(root) - square)
    return (t, here.pressure_mpa + t * (first + t * (square + t * cube))) if 0.0 < t < 1.0 else None


def place_of_pressure(
    history: Sequence[PathPoint], control: ControlName, low: float, high: float, pressure_mpa: float, scale: Scale
) -> float:
    """Volume or arc length in [low, high] at which the predicted pressure is the given one, by bisection."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        below = predicted_pressure(history, control, middle, scale) < pressure_mpa
        low, high = (middle, high) if below else (low, middle)
    return 0.5 * (low + high)
