"""Equilibrium paths: volume-controlled steps that hit every asked pressure exactly, or direct warm starts."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from solvers.domain import FloatArray
from solvers.errors import StepFailed
from solvers.linear import Factor
from solvers.newton import NewtonReport, NewtonSettings, solve_equilibrium
from solvers.problem import Problem
from solvers.state import State


@dataclass(frozen=True)
class PathSettings:
    """Step control.

    Attributes
    ----------
    first_step, largest_step
        Volume steps as fractions of the unloaded cavity volume.
    smallest_step
        Below this fraction the path is given up.
    few_iterations, many_iterations
        The step grows by ``growth`` at or below the first, shrinks by ``shrink`` above the second.
    largest_volume
        The path ends when the cavity exceeds this multiple of its unloaded volume.
    newton
        Settings of each solve.
    """

    first_step: float = 0.05
    largest_step: float = 0.5
    smallest_step: float = 1e-4
    few_iterations: int = 5
    many_iterations: int = 8
    growth: float = 1.5
    shrink: float = 0.6
    largest_volume: float = 40.0
    newton: NewtonSettings = field(default_factory=NewtonSettings)


@dataclass(frozen=True)
class PathState:
    """A converged state of a path.

    Attributes
    ----------
    state
        Fields in the caller's numbering.
    asked
        True if the pressure was one of the asked ones.
    control
        ``pressure`` or ``volume``: which was held in the solve.
    volume_mm3, energy_mj, reaction_n
        Enclosed volume, stored energy, axial support force.
    bond_slip_mm
        Root mean square slip of the bond to rigid bodies, weighted with its grade; NaN without bodies.
    newton
        Cost and checks of the solve.
    wall_s
        Seconds since the path began.
    """

    state: State
    asked: bool
    control: str
    volume_mm3: float
    energy_mj: float
    reaction_n: float
    bond_slip_mm: float
    newton: NewtonReport
    wall_s: float


@dataclass(frozen=True)
class Path:
    """A path and how it ended.

    Attributes
    ----------
    states
        Converged states in order.
    reached
        True if all asked pressures were reached.
    reason
        Why it stopped, if not reached.
    rejected
        Number of steps given up and repeated smaller.
    """

    states: tuple[PathState, ...]
    reached: bool
    reason: str
    rejected: int


Progress = Callable[[str, float, int, float], None]


@dataclass(frozen=True)
class _Point:
    """Internal copy of a state: dofs with ghosts, bodies, pressure, volume."""

    array: FloatArray
    bodies: FloatArray
    pressure: float
    volume: float


def _take(problem: Problem) -> _Point:
    return _Point(
        problem.state.x.array.copy(),
        problem.body_values.copy(),
        float(problem.pressure.value),
        problem.cavity_volume(),
    )


def _put(problem: Problem, point: _Point) -> None:
    problem.state.x.array[:] = point.array
    _put_bodies(problem, point.bodies)
    problem.pressure.value = point.pressure


def _put_bodies(problem: Problem, values: FloatArray) -> None:
    if problem.bonded is not None:
        problem.bonded.values[:] = values
        problem.bonded.update(np.zeros(0))


def _lagrange(nodes: Sequence[float], at: float) -> FloatArray:
    """Weights of the polynomial through ``nodes``, evaluated at ``at``."""
    weights = np.ones(len(nodes))
    for i, x in enumerate(nodes):
        for j, y in enumerate(nodes):
            if i != j:
                weights[i] *= (at - y) / (x - y)
    return weights


def _extrapolate(problem: Problem, history: Sequence[_Point], volume: float) -> float:
    """Set the state to the polynomial in V through the last three states; returns the pressure there."""
    last, here = history[-3:], history[-1]
    weights = _lagrange([h.volume for h in last], volume)
    problem.state.x.array[:] = sum(w * h.array for w, h in zip(weights, last, strict=True))
    _put_bodies(problem, sum((w * h.bodies for w, h in zip(weights, last, strict=True)), 0.0 * here.bodies))
    pressure = float(sum(w * h.pressure for w, h in zip(weights, last, strict=True)))
    problem.pressure.value = pressure
    return pressure


def _predicted_pressure(history: Sequence[_Point], volume: float) -> float:
    last = history[-3:]
    return float(_lagrange([h.volume for h in last], volume) @ np.array([h.pressure for h in last]))


def _volume_at_pressure(history: Sequence[_Point], low: float, high: float, pressure: float) -> float:
    """Volume in [low, high] at which the predicted pressure is the given one, by bisection."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _predicted_pressure(history, middle) < pressure else (low, middle)
    return 0.5 * (low + high)


def _record(problem: Problem, report: NewtonReport, asked: bool, control: str, start: float) -> PathState:
    return PathState(
        state=problem.get_state(),
        asked=asked,
        control=control,
        volume_mm3=problem.cavity_volume(),
        energy_mj=problem.energy(),
        reaction_n=problem.reaction(),
        bond_slip_mm=float("nan") if problem.bonded is None else problem.bonded.rms_slip_mm(),
        newton=report,
        wall_s=time.perf_counter() - start,
    )


def _solve_at(
    problem: Problem,
    factor: Factor,
    settings: PathSettings,
    pressure: float,
    least_volume: float,
    begin: float,
    progress: Progress | None,
) -> tuple[PathState, _Point]:
    """Solve at an asked pressure from the current guess.

    Raises
    ------
    StepFailed
        Also if the solution lies behind the last state, on another branch.
    """
    seen = None if progress is None else (lambda k, e: progress("asked pressure", pressure, k, e))
    report = solve_equilibrium(problem, factor, settings.newton, pressure_mpa=pressure, on_iteration=seen)
    if problem.cavity_volume() <= least_volume:
        raise StepFailed("pressure control fell back to a smaller volume")
    return _record(problem, report, True, "pressure", begin), _take(problem)


def follow_path(
    problem: Problem,
    factor: Factor,
    pressures_mpa: Sequence[float],
    settings: PathSettings,
    progress: Progress | None = None,
    on_state: Callable[[PathState], None] | None = None,
) -> Path:
    """Follow the equilibrium path from the unloaded state through ascending asked pressures.

    Steps are taken in cavity volume, which passes limit points of the pressure. When a step is predicted to
    pass an asked pressure, that pressure is solved for instead.

    Parameters
    ----------
    problem, factor
        The problem and its factorisation; the state is reset to zero.
    pressures_mpa
        Asked pressures, ascending, > 0.
    settings
        Step control.
    progress
        Called with (what, pressure in MPa, Newton iteration, relative residual).
    on_state
        Called with each converged state, before the next step is tried.

    Returns
    -------
    Path
    """
    begin = time.perf_counter()
    problem.set_state(problem.zero_state())
    history = [_take(problem)]
    unit = abs(history[0].volume)
    step = settings.first_step * unit
    states: list[PathState] = []
    rejected = 0
    targets = list(pressures_mpa)
    reason = ""

    def keep(state: PathState, point: _Point) -> None:
        """Record a converged state; nearly coincident states would spoil the extrapolation."""
        while len(history) > 1 and point.volume - history[-1].volume < 0.05 * step:
            history.pop()
        history.append(point)
        del history[:-3]
        states.append(state)
        if on_state is not None:
            on_state(state)

    while targets:
        here = history[-1]
        volume = here.volume + step
        aim: float | None = None
        if len(history) >= 3 and _predicted_pressure(history, volume) >= targets[0] > here.pressure:
            aim = targets[0]
            volume = _volume_at_pressure(history, here.volume, volume, aim)
        _extrapolate(problem, history, volume)
        found: list[tuple[PathState, _Point]] = []
        try:
            if aim is not None:
                found.append(_solve_at(problem, factor, settings, aim, here.volume, begin, progress))
            else:
                shown = float(problem.pressure.value)
                seen = None if progress is None else (lambda k, e, b=shown: progress("volume step", b, k, e))
                report = solve_equilibrium(problem, factor, settings.newton, volume_mm3=volume, on_iteration=seen)
                found.append((_record(problem, report, False, "volume", begin), _take(problem)))
                # The step may have passed asked pressures that were not foreseen: they lie between.
                passed = [p for p in targets if here.pressure < p <= found[0][1].pressure]
                around = [*history[-2:], found[0][1]]
                for pressure in reversed(passed):
                    beyond = found[0][1].volume
                    _extrapolate(problem, around, _volume_at_pressure(around, here.volume, beyond, pressure))
                    found.insert(0, _solve_at(problem, factor, settings, pressure, here.volume, begin, progress))
        except StepFailed as failure:
            rejected += 1
            _put(problem, here)
            step = 0.5 * min(step, volume - here.volume)
            if step < settings.smallest_step * unit:
                reason = f"steps became smaller than {settings.smallest_step:g} of the volume: {failure}"
                break
            continue
        for state, point in found:
            keep(state, point)
            if state.asked:
                targets.pop(0)
            if not targets:  # a volume step that went beyond the last asked pressure is not part of the answer
                break
        _put(problem, history[-1])
        iterations = max(state.newton.iterations for state, _ in found)
        if iterations > settings.many_iterations:
            step *= settings.shrink
        elif iterations <= settings.few_iterations and aim is None:
            step = min(step * settings.growth, settings.largest_step * unit)
        if history[-1].volume > settings.largest_volume * unit:
            reason = f"the cavity exceeds {settings.largest_volume:g} times its unloaded volume"
            break
    return Path(tuple(states), not targets, reason, rejected)


def follow_guesses(
    problem: Problem,
    factor: Factor,
    guesses: Sequence[State],
    settings: PathSettings,
    progress: Progress | None = None,
    on_state: Callable[[PathState], None] | None = None,
    start: tuple[State, State] | None = None,
) -> Path:
    """Solve at the pressures of given first guesses, each corrected by what the previous one lacked.

    If Newton fails from a guess, the way to it from the last converged state is gone in smaller parts.

    Parameters
    ----------
    guesses
        States close to the wanted ones, in order; their ``load_mpa`` are the asked pressures.
    settings
        Its Newton settings are used.
    progress, on_state
        As in `follow_path`.
    start
        A converged state and the guess it came from, to go on after an interruption; default unloaded.

    Returns
    -------
    Path
    """
    begin = time.perf_counter()
    states: list[PathState] = []
    rejected = 0
    last, last_guess = start if start is not None else (problem.zero_state(), problem.zero_state())
    for goal in guesses:
        share = 1.0
        while True:
            target = goal if share >= 1.0 else _blend(last_guess, goal, share)
            problem.set_state(_shift(target, last, last_guess))
            pressure = target.load_mpa
            seen = None if progress is None else (lambda k, e, b=pressure: progress("warm start", b, k, e))
            try:
                report = solve_equilibrium(problem, factor, settings.newton, pressure_mpa=pressure, on_iteration=seen)
            except StepFailed as failure:
                rejected += 1
                share *= 0.5
                if share < 1.0 / 32.0:
                    problem.set_state(last)
                    reason = f"no equilibrium found from the warm start at {1e3 * pressure:g} kPa: {failure}"
                    return Path(tuple(states), False, reason, rejected)
                continue
            states.append(_record(problem, report, share >= 1.0, "pressure", begin))
            if on_state is not None:
                on_state(states[-1])
            last, last_guess = states[-1].state, target
            if share >= 1.0:
                break
            share = min(1.0, 2.0 * share)
    return Path(tuple(states), True, "", rejected)


def _blend(a: State, b: State, share: float) -> State:
    return State(
        a.displacement_mm + share * (b.displacement_mm - a.displacement_mm),
        a.pressure_mpa + share * (b.pressure_mpa - a.pressure_mpa),
        a.bodies_mm + share * (b.bodies_mm - a.bodies_mm),
        a.load_mpa + share * (b.load_mpa - a.load_mpa),
    )


def _shift(guess: State, found: State, found_guess: State) -> State:
    """The guess plus what the last guess lacked."""
    return State(
        guess.displacement_mm + found.displacement_mm - found_guess.displacement_mm,
        guess.pressure_mpa + found.pressure_mpa - found_guess.pressure_mpa,
        guess.bodies_mm + found.bodies_mm - found_guess.bodies_mm,
        guess.load_mpa,
    )
