"""First guesses for the next step: polynomials through the last converged states."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

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


def _powers(nodes: Sequence[float], known: NDArray[np.bool_]) -> tuple[FloatArray, float]:
    """Values of 1, x, x^2, ... at ``nodes``, a row each, below them their slopes where those are ``known``; unit of x.

    x is counted from the last node, in that unit.
    """
    unit = nodes[-1] - nodes[0] if len(nodes) > 1 else 1.0
    places, sloped = (np.array(nodes) - nodes[-1]) / unit, np.flatnonzero(known)
    powers = np.arange(len(nodes) + len(sloped))
    values = places[:, None] ** powers
    slopes = powers * places[sloped, None] ** np.maximum(powers - 1, 0)
    return np.vstack([values, slopes]), unit


def _weights(nodes: Sequence[float], known: NDArray[np.bool_], at: float) -> tuple[FloatArray, FloatArray]:
    """Weights of values and slopes of the polynomial through ``nodes``, evaluated at ``at``.

    It has the slopes, too, of the nodes where they are ``known``; those of the others have no weight.
    """
    matrix, unit = _powers(nodes, known)
    # the weights give every power its value at ``at``
    weights = np.linalg.solve(matrix.T, ((at - nodes[-1]) / unit) ** np.arange(len(matrix)))
    by_slope = np.zeros(len(nodes))
    by_slope[known] = unit * weights[len(nodes) :]
    return weights[: len(nodes)], by_slope


def _slopes(last: Sequence[PathPoint], control: ControlName) -> list[float]:
    """Change of the load factor with the coordinate at each state, MPa/mm^3 or 1; NaN where that is not known.

    None are told where the last state has none: what was smooth before contact says nothing of what comes after.
    """
    if last[-1].rate is None:
        return [math.nan] * len(last)
    by_coordinate = {"volume": lambda p: p.slope_mpa_per_mm3, "pressure": lambda p: 1.0, "arc": lambda p: math.nan}
    return [by_coordinate[control](p) if p.rate is not None else math.nan for p in last]


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
    """State at a volume, a pressure or an arc length, from the polynomial through the last three.

    In volume and pressure it has their slopes too (Hermite), where they are known.
    """
    return _polynomial(*_usable(history, control, scale), control, at)


def half_way(low: PathPoint, high: PathPoint, control: ControlName) -> State:
    """State half-way between two in volume or pressure, from the polynomial through them with their slopes."""
    nodes = [p.volume_mm3 if control == "volume" else p.pressure_mpa for p in (low, high)]
    return _polynomial([low, high], nodes, control, 0.5 * sum(nodes))


def _polynomial(last: Sequence[PathPoint], nodes: Sequence[float], control: ControlName, at: float) -> State:
    slopes = _slopes(last, control)
    by_value, by_slope = _weights(nodes, np.isfinite(slopes), at)
    known = [(p.rate, w * s) for p, w, s in zip(last, by_slope, slopes, strict=True) if p.rate is not None and w]
    return combine([*(p.state for p in last), *(rate for rate, _ in known)], [*by_value, *(w for _, w in known)])


def predicted_pressure(history: Sequence[PathPoint], control: ControlName, scale: Scale) -> Callable[[float], float]:
    """Pressure by volume or arc length, MPa: the polynomial through the last three states, with their slopes."""
    last, nodes = _usable(history, control, scale)
    slopes = np.array(_slopes(last, control))
    known = np.isfinite(slopes)
    matrix, unit = _powers(nodes, known)
    of_powers = np.linalg.solve(matrix, [*(p.pressure_mpa for p in last), *(unit * slopes[known])])
    polynomial, end = np.polynomial.Polynomial(of_powers), nodes[-1]
    return lambda at: float(polynomial((at - end) / unit))


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
    predicted = predicted_pressure(history, control, scale)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if predicted(middle) < pressure_mpa else (low, middle)
    return 0.5 * (low + high)
