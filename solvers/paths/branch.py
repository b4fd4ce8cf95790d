"""Branch switching: from where a path loses stability onto the other path that begins there.

At a bifurcation (state x0, critical mode f, found by `solvers.paths.crossing`) the first state of the branch is
looked for in the plane through x0 + a f that is normal to f, with the load factor free:

    <f, x - x0 - a f> = 0.

The path that was followed does not meet this plane close by, as it does not move along f. From x0 and that state the
branch is followed by arc length (`solvers.paths.arc`), whichever way load and volume go.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from solvers.equilibrium.newton import solve_equilibrium
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.arc import distance, plane_at, scale_of
from solvers.paths.path import follow_path
from solvers.paths.states import (
    Crossing,
    Path,
    PathMemory,
    PathPoint,
    PathSettings,
    PathState,
    Progress,
    point_of,
    record,
)
from solvers.problem import Problem
from solvers.state import State, combine

# The first state is looked for at the given amplitude, then at halves of it.
HALVINGS = 4
# A state is not on the branch if the mode is less than this share of what it was looked for with.
LEAST_SHARE = 0.5


@dataclass(frozen=True)
class BranchSettings:
    """Where a branch is picked up and how far it is followed.

    Attributes
    ----------
    amplitude_mm
        Of the mode in the first state; its sign chooses the side.
    most_states
        Converged states after which the branch is left.
    path
        Steps and solves; its control is arc length.
    """

    amplitude_mm: float
    most_states: int = 40
    path: PathSettings = field(default_factory=lambda: PathSettings(control="arc", crossing_tolerance=0.0))


class _Enough(Exception):
    """The branch has been followed as far as was asked."""


def follow_branch(
    problem: Problem,
    factor: Factor,
    crossing: Crossing,
    highest_mpa: float,
    settings: BranchSettings,
    mode: State | None = None,
    until: Callable[[PathState], bool] | None = None,
    progress: Progress | None = None,
    on_state: Callable[[PathState], None] | None = None,
) -> Path:
    """Follow the branch that begins at a crossing, away from it.

    Parameters
    ----------
    problem, factor
        The problem and its factorisation.
    crossing
        Where the path lost stability, with its state and mode.
    highest_mpa
        The load factor at which the branch is left, met exactly; the scale of arc length is made with it.
    settings
        Amplitude, steps, end.
    mode
        The direction in which the branch leaves, largest component 1 mm, where several modes cross at once; default the
        crossing's own.
    until
        Called with each state; the branch ends where it says True.
    progress, on_state
        As in `solvers.paths.path.follow_path`.

    Returns
    -------
    Path
        The first state has control ``arc``; ``reached`` says that the branch came as far as was asked: the load, the
        number of states, or ``until``.

    Raises
    ------
    StepFailed
        If there is no state of a branch at the amplitude or at smaller ones, or no mode to look along.
    """
    assert crossing.state is not None
    direction = crossing.mode if mode is None else mode
    if direction is None:
        raise StepFailed(f"no critical mode is known at {1e3 * crossing.pressure_mpa:.6g} kPa, along which to look")
    # At the crossing its modes cost nothing, and what breaks a symmetry of revolution may turn about the axis beyond.
    factor.free_motions = max(1, crossing.modes_after - crossing.modes_before)
    try:
        return _follow(problem, factor, crossing, direction, highest_mpa, settings, until, progress, on_state)
    finally:
        factor.free_motions = 0


def _follow(
    problem: Problem,
    factor: Factor,
    crossing: Crossing,
    direction: State,
    highest_mpa: float,
    settings: BranchSettings,
    until: Callable[[PathState], bool] | None,
    progress: Progress | None,
    on_state: Callable[[PathState], None] | None,
) -> Path:
    """`follow_branch` along a direction."""
    assert crossing.state is not None
    first = _first_state(problem, factor, crossing.state, direction, highest_mpa, settings)
    states = [first]

    def keep(item: PathState) -> None:
        states.append(item)
        if on_state is not None:
            on_state(item)

    def step(_: PathMemory) -> None:
        if len(states) >= settings.most_states or (until is not None and until(states[-1])):
            raise _Enough

    if on_state is not None:
        on_state(first)
    scale = scale_of(problem, highest_mpa)
    # the count at the crossing is that of neither side: nothing to compare the first state's with
    start = PathPoint(crossing.state, crossing.volume_mm3, math.nan, None)
    memory = PathMemory(
        (start, point_of(first)), "arc", distance(crossing.state, first.state, scale), 0, 0, 0.0, crossing
    )
    try:
        step(memory)
        path = follow_path(
            problem, factor, [highest_mpa], settings.path, progress, on_state=keep, on_step=step, resume=memory
        )
    except _Enough:
        return Path(tuple(states), True, "", 0, Cause.REACHED, crossing)
    return replace(path, states=tuple(states), crossing=crossing)


def _first_state(
    problem: Problem, factor: Factor, start: State, mode: State, highest_mpa: float, settings: BranchSettings
) -> PathState:
    """The first state of the branch, at the amplitude or at a half, a quarter, ... of it."""
    scale, failure = scale_of(problem, highest_mpa), ""
    level = replace(mode, load_mpa=0.0)
    for halving in range(HALVINGS + 1):
        amplitude = settings.amplitude_mm * 0.5**halving
        guess = combine([start, level], [1.0, amplitude])
        plane = plane_at(problem, start, guess, scale)
        try:
            report = solve_equilibrium(problem, factor, settings.path.newton, plane)
        except StepFailed as error:
            failure = str(error)
            continue
        item = record(problem, report, False, "arc", 0.0)
        off, size = distance(guess, item.state, scale), distance(start, guess, scale)
        if off <= LEAST_SHARE * size:
            return replace(item, wall_s=0.0)
        failure = f"the state found at {amplitude:g} mm lies {off / size:.2g} times the amplitude away from the mode"
    raise StepFailed(
        f"no branch found at {1e3 * start.load_mpa:.6g} kPa along the mode, at {settings.amplitude_mm:g} mm and "
        f"smaller: {failure}; take another amplitude, or another of the modes that cross there"
    )
