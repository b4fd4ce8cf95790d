"""Paths under a pressure and a dead force on the plate: the order in which the two are brought on.

Where the state under both is unique, every order leads to it. Where it is not, the order decides: a bellows that its
load has crushed need not be lifted by the pressure that holds the same load up.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.onset import Loads, bring_on, dead_force, go_to_rest
from solvers.paths.path import follow_path
from solvers.paths.states import Path, PathMemory, PathSettings, PathState, Progress, point_of
from solvers.paths.steps import Follower
from solvers.problem import Problem

# ``auto``: the force first if the body carries it alone, stable and with nothing touching, else the pressure.
Order = Literal["auto", "force-first", "together", "pressure-first"]
# After such a stop more pressure, however it is brought on, is of no use.
HOPELESS = (Cause.OUT_OF_MEMORY, Cause.MATERIAL_RANGE, Cause.LAW_SOFTENS, Cause.TOO_LARGE)
REMEDY = '; load.order = "pressure-first" brings the pressure on before the force'
# Begins what is told of a pressure at which the force could not be brought on.
MISSED = "no state at "
# Begins what a path tells of the order of its loads.
LOADS = "loads: "
# Begins what is told of a state that the model itself counts as unstable.
UNSTABLE = "warning: unstable"


@dataclass
class _Job:
    """What `follow_loads` was asked for, and the whole dead force."""

    problem: Problem
    factor: Factor
    pressures_mpa: Sequence[float]
    settings: PathSettings
    progress: Progress | None
    on_state: Callable[[PathState], None] | None
    accept: Callable[[PathState], bool] | None
    tell: Callable[[str], None]
    force_n: float
    begin: float
    # the path without the force, as far as it was followed
    free: PathMemory | None = None

    def show(self, item: PathState) -> None:
        """Hand a state out, with the time since all began."""
        if self.on_state is not None:
            self.on_state(replace(item, wall_s=time.perf_counter() - self.begin))

    def kpa(self, place: int) -> str:
        """An asked pressure in words."""
        return f"{1e3 * self.problem.load.sense * self.pressures_mpa[place]:.6g} kPa"


def follow_loads(
    problem: Problem,
    factor: Factor,
    pressures_mpa: Sequence[float],
    settings: PathSettings,
    order: Order,
    tell: Callable[[str], None],
    touches: Callable[[PathState], bool],
    progress: Progress | None = None,
    on_state: Callable[[PathState], None] | None = None,
    on_step: Callable[[PathMemory], None] | None = None,
    resume: PathMemory | None = None,
    accept: Callable[[PathState], bool] | None = None,
) -> Path:
    """Follow the path through asked pressures under the dead force on the problem's plate, if there is one.

    - ``auto``: the force first, as long as the body carries it alone, stable and with nothing touching; the pressure
      first for what is not reached so.
    - ``force-first``: the force without pressure, then the pressure.
    - ``together``: both in proportion up to the first asked pressure at which that works, then the pressure.
    - ``pressure-first``: the pressure alone up to the first asked one at which the force can then be brought on, then
      the pressure under the force. So a payload is lifted that rests on something else until then.

    Of the latter two, asked pressures after a stop, or after a state that is crushed, are tried anew in the same way.

    Parameters
    ----------
    tell
        Called with what a reader of the states has to know: which order led to them, with ``MISSED`` at which pressures
        none did, and with ``UNSTABLE`` that the first of them is not stable.
    touches
        True if surfaces of a state touch.
    others
        As in `solvers.paths.path.follow_path`; a memory's number of reached pressures includes those that were missed.

    Returns
    -------
    Path
        ``reached`` is that of the last part; a caller adds what was missed.
    """
    force = dead_force(problem)
    job = _Job(problem, factor, pressures_mpa, settings, progress, on_state, accept, tell, force, time.perf_counter())

    def follow(memory: PathMemory | None) -> Path:
        shown = job.show if force else on_state
        return follow_path(problem, factor, pressures_mpa, settings, progress, shown, on_step, memory, accept)

    if not force:
        return follow(resume)
    path, place = Path((), False, "", 0, Cause.STEP_SIZE), 0
    if resume is not None or order in ("auto", "force-first"):
        try:
            path = follow(resume or _forced(job, partial(_alone, job, touches) if order == "auto" else accept))
        except StepFailed as failure:
            path = Path((), False, f"{failure}{REMEDY if order == 'force-first' else ''}", 0, failure.cause)
        place = (0 if resume is None else resume.reached) + sum(item.asked for item in path.states)
        if path.reached or order == "force-first" or path.cause in HOPELESS:
            return path
        tell(f"{LOADS}{path.reason}; from {job.kpa(place)} on brought on anew")
    while place < len(pressures_mpa):
        memory = _lifted(job, place, order == "together", touches)
        place += 1
        if memory is None:
            continue
        path = follow(memory)
        place += sum(item.asked for item in path.states)
        if path.cause in HOPELESS:
            return path
        if not path.reached:
            tell(f"{LOADS}{path.reason}; from {job.kpa(place)} on brought on anew")
    return Path(path.states, True, "", path.rejected, Cause.REACHED, path.crossing)


def _forced(job: _Job, accept: Callable[[PathState], bool] | None) -> PathMemory:
    """The state under the force alone.

    Raises
    ------
    StepFailed
        If there is none.
    """
    rest = go_to_rest(job.problem, job.factor, job.settings.newton, accept)
    follower = Follower(job.problem, job.factor, job.pressures_mpa, job.settings, job.progress)
    return follower.walk_from(rest, 0).memory()


def _alone(job: _Job, touches: Callable[[PathState], bool], item: PathState) -> bool:
    """True: a state that the body may be left in under the force alone.

    Raises
    ------
    StepFailed
        If it is unstable, or its surfaces touch: crushed, it may not find back to where pressure holds the force up.
    """
    under = Loads(0.0, dead_force(job.problem)).text(job.problem)
    if item.newton.excess_negatives:
        raise StepFailed(f"{item.newton.excess_negatives} unstable modes under {under}", Cause.BIFURCATION)
    if touches(item):
        raise StepFailed(f"surfaces touch under {under}", Cause.CONTACT)
    return True


def _lifted(job: _Job, place: int, together: bool, touches: Callable[[PathState], bool]) -> PathMemory | None:
    """Bring the whole force on at an asked pressure; from where the path goes on under it.

    None if it does not: where the force cannot be brought on, which is told, or where it crushes the body, whose later
    states need not be those that the pressure holds up.
    """
    problem, pressure, limit = job.problem, job.pressures_mpa[place], math.nan
    states: list[PathState] = []
    at, end = job.kpa(place), Loads(pressure, job.force_n)
    how = "in proportion with the pressure" if together else "after the pressure"
    try:
        start, state = Loads(0.0, 0.0), problem.zero_state()
        if not together:
            free = _without_force(job, place)
            start, state, limit = Loads(pressure, 0.0), free.history[-1].state, free.limit_mpa
        for item in bring_on(problem, job.factor, job.settings.newton, state, start, end, job.accept):
            states.append(replace(item, limit_mpa=limit))
    except StepFailed as failure:
        if problem.bonded is not None:
            problem.bonded.dead_force_n = job.force_n
        job.tell(f"{MISSED}{at}: {job.force_n:g} N, brought on {how}: {failure}")
        return None
    for item in states[:-1]:
        job.show(item)
    last = replace(states[-1], asked=True)
    job.show(last)
    job.tell(f"{LOADS}{job.force_n:g} N brought on {how} at {at}")
    unstable, crushed = last.newton.excess_negatives, touches(last)
    if unstable:
        job.tell(f"{UNSTABLE} under {job.force_n:g} N at {at}: {unstable} modes of the model's own")
    if unstable or crushed:
        return None
    follower = Follower(problem, job.factor, job.pressures_mpa, job.settings, job.progress)
    return replace(follower.walk_from(point_of(last), place + 1).memory(), limit_mpa=limit)


def _without_force(job: _Job, place: int) -> PathMemory:
    """The path without the force up to an asked pressure, from where it was followed to before.

    Raises
    ------
    StepFailed
        If it does not get there.
    """
    assert job.problem.bonded is not None
    job.problem.bonded.dead_force_n = 0.0
    settings = replace(job.settings, crossing_tolerance=0.0)

    def show(item: PathState) -> None:
        job.show(replace(item, asked=False))

    def keep(memory: PathMemory) -> None:
        job.free = memory

    targets = job.pressures_mpa[: place + 1]
    path = follow_path(job.problem, job.factor, targets, settings, job.progress, show, keep, job.free, job.accept)
    if not path.reached or job.free is None:
        raise StepFailed(f"without the force: {path.reason}", path.cause)
    return job.free
