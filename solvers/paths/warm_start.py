"""Paths along given first guesses: states of a cheaper model, close to the wanted ones."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Sequence

from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import solve_equilibrium
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.crossing import locate_crossing, lost_stability
from solvers.paths.diagnosis import failed_steps
from solvers.paths.onset import dead_force
from solvers.paths.states import GuessMemory, Path, PathPoint, PathSettings, PathState, Progress, point_of, record
from solvers.problem import Problem
from solvers.state import State, combine


def follow_guesses(
    problem: Problem,
    factor: Factor,
    guesses: Sequence[State],
    settings: PathSettings,
    progress: Progress | None = None,
    on_state: Callable[[PathState], None] | None = None,
    on_step: Callable[[GuessMemory], None] | None = None,
    resume: GuessMemory | None = None,
) -> Path:
    """Solve at the pressures of given first guesses, each corrected by what the previous one lacked.

    If Newton fails from a guess, the way to it from the last converged state is gone in smaller parts.

    Parameters
    ----------
    guesses
        States close to the wanted ones, in order; their ``load_mpa`` are the asked pressures.
    settings
        Its Newton settings and crossing tolerance are used.
    progress, on_state, on_step, resume
        As in `follow_path`; with ``resume`` the guesses are still all of them.

    Returns
    -------
    Path
    """
    begin = time.perf_counter()
    states: list[PathState] = []
    if resume is None:
        problem.set_state(problem.zero_state())
        # under a dead force rest is no state of the path, whose stability others could be compared with
        unstable = None if dead_force(problem) else 0
        rest = PathPoint(problem.get_state(), problem.cavity_volume(), math.nan, unstable)
        memory = GuessMemory(rest, rest.state, 0, 1.0, 0, None)
    else:
        memory = resume
    stiffest = 0.0
    while memory.reached < len(guesses):
        share, last = memory.share, memory.last
        goal = guesses[memory.reached]
        target = goal if share >= 1.0 else combine([memory.guess, goal], [1.0 - share, share])
        # the guess plus what the last guess lacked
        problem.set_state(
            dataclasses.replace(combine([target, last.state, memory.guess], [1.0, 1.0, -1.0]), load_mpa=target.load_mpa)
        )
        pressure = target.load_mpa
        seen = None if progress is None else (lambda k, e, b=pressure: progress("warm start", b, k, e))
        try:
            report = solve_equilibrium(problem, factor, settings.newton, HeldLoad(pressure), seen)
        except StepFailed as failure:
            memory = dataclasses.replace(memory, rejected=memory.rejected + 1, share=0.5 * share)
            if memory.share < 1.0 / 32.0 or failure.cause is Cause.OUT_OF_MEMORY:
                problem.set_state(last.state)
                cause, why = failed_steps(failure, [last], memory.crossing, "pressure", stiffest)
                reason = f"no equilibrium found from the warm start at {1e3 * pressure:g} kPa: {why}"
                return Path(tuple(states), False, reason, memory.rejected, cause, memory.crossing)
            continue
        states.append(record(problem, report, share >= 1.0, "pressure", begin))
        new, crossing = point_of(states[-1]), memory.crossing
        if math.isfinite(new.slope_mpa_per_mm3):
            stiffest = max(stiffest, new.slope_mpa_per_mm3)
        if crossing is None and settings.crossing_tolerance > 0.0 and lost_stability(last, new):
            crossing = locate_crossing(problem, factor, settings.newton, last, new, settings.crossing_tolerance)
            problem.set_state(new.state)
        if on_state is not None:
            on_state(states[-1])
        memory = GuessMemory(
            last=new,
            guess=target,
            reached=memory.reached + (share >= 1.0),
            share=1.0 if share >= 1.0 else min(1.0, 2.0 * share),
            rejected=memory.rejected,
            crossing=crossing,
        )
        if on_step is not None:
            on_step(memory)
    return Path(tuple(states), True, "", memory.rejected, Cause.REACHED, memory.crossing)
