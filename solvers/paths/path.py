"""Equilibrium paths that hit every asked pressure exactly, in steps of volume, pressure or arc length."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.diagnosis import failed_steps, too_large
from solvers.paths.states import Path, PathMemory, PathSettings, PathState, Progress
from solvers.paths.steps import Follower, Walk
from solvers.problem import Problem

# A path by arc length that goes round for ever ends after so many states.
MOST_STATES = 2000


def follow_path(
    problem: Problem,
    factor: Factor,
    pressures_mpa: Sequence[float],
    settings: PathSettings,
    progress: Progress | None = None,
    on_state: Callable[[PathState], None] | None = None,
    on_step: Callable[[PathMemory], None] | None = None,
    resume: PathMemory | None = None,
    accept: Callable[[PathState], bool] | None = None,
) -> Path:
    """Follow the equilibrium path from the unloaded state through ascending asked pressures.

    Steps are taken in volume, which passes limit points of the pressure, in pressure, or in arc length, which passes
    those of the volume too; see PathSettings.control.
    When a step is predicted to pass an asked pressure, that pressure is solved for instead.

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
    on_step
        Called after each step, on every rank, with what is needed to go on from there.
    resume
        Such a memory: the path goes on after it, with the same steps as if it had not been interrupted.
    accept
        Called with each converged state before it is taken; where it says False it has changed the problem, and the
        step is taken anew from the last state.

    Returns
    -------
    Path
    """
    follower = Follower(problem, factor, pressures_mpa, settings, progress)
    if resume is None:
        walk = follower.start(accept)
    else:
        walk = Walk(
            list(resume.history),
            resume.control,
            resume.step,
            resume.reached,
            resume.rejected,
            resume.stiffest_mpa_per_mm3,
            resume.crossing,
            resume.limit_mpa,
        )
    states: list[PathState] = []
    cause, reason = Cause.REACHED, ""
    while walk.reached < len(follower.targets):
        aim = follower.aim(walk)
        try:
            found = follower.step(walk, aim)
            if accept is not None and not all(accept(item) for item in found):
                problem.set_state(walk.here.state)
                continue
        except StepFailed as failure:
            problem.set_state(walk.here.state)
            control = walk.control
            if follower.retry(walk, aim, failure):
                continue
            # beyond where a law softens steps fail in many ways
            failure = walk.softened or failure
            cause, reason = failed_steps(failure, walk.history, walk.crossing, control, walk.stiffest)
            break
        for item in found:
            item = follower.keep(walk, item)
            states.append(item)
            if on_state is not None:
                on_state(item)
        problem.set_state(walk.here.state)
        follower.adapt(walk, aim, max(item.newton.iterations for item in found))
        if on_step is not None:
            on_step(walk.memory())
        if walk.here.volume_mm3 - problem.volume_start_mm3 > settings.largest_volume * problem.volume_unit_mm3:
            if walk.reached < len(follower.targets):
                asked = follower.targets[walk.reached]
                cause, reason = too_large(settings.largest_volume, walk.here, walk.limit_mpa, asked, walk.crossing)
            break
        if walk.control == "arc" and len(states) >= MOST_STATES:
            endless = StepFailed(f"{MOST_STATES} states by arc length and no end")
            cause, reason = failed_steps(endless, walk.history, walk.crossing, walk.control, walk.stiffest)
            break
    return Path(tuple(states), cause is Cause.REACHED, reason, walk.rejected, cause, walk.crossing)
