"""Where paths begin: loads brought on in proportion, in steps that are cut where they fail or jump.

On the way from one pair of loads to another, (P, F)(s) with s from 0 to 1, the work-conjugate measure is
``q = P' V + F' w`` with V the volume and w the motion of the plate that the dead force F acts on. On one branch q
changes by the integral of dq/ds: a step that differs from the trapezoidal rule by more than half has jumped to another.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from solvers.discrete.sums import Joint, joint_dot
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.states import PathPoint, PathState, point_of, record
from solvers.problem import Problem
from solvers.state import State, combine

# Loads are brought on at once if that works, else in steps that are halved down to this share.
SMALLEST_STEP = 1.0 / 1024.0
GROWTH, FEW_ITERATIONS = 1.5, 6
# Where surfaces meet, Newton needs more iterations than the steps of a path; halving the step would cost more.
MOST_ITERATIONS = 25


# q and dq/ds; a share of the way with the state there and these.
Measured = tuple[float, float]
Place = tuple[float, State, Measured]


@dataclass(frozen=True)
class Loads:
    """Pressure, MPa, and dead axial force on the plate, N."""

    pressure_mpa: float
    force_n: float

    def text(self, problem: Problem) -> str:
        """In words."""
        return f"{self.force_n:.4g} N at {1e3 * problem.load.sense * self.pressure_mpa:.4g} kPa"


def dead_force(problem: Problem) -> float:
    """The dead force on the problem's plate, N; 0 without one."""
    return 0.0 if problem.bonded is None else problem.bonded.dead_force_n


def go_to_rest(
    problem: Problem,
    factor: Factor,
    settings: NewtonSettings,
    accept: Callable[[PathState], bool] | None = None,
) -> PathPoint:
    """The state without pressure: the unloaded one, or that under a dead force; ``accept`` as in `bring_on`.

    Raises
    ------
    StepFailed
        If there is no such state to be found.
    """
    problem.set_state(problem.zero_state())
    here = PathPoint(problem.get_state(), problem.cavity_volume(), float("nan"), 0)
    force = dead_force(problem)
    if force:
        try:
            for item in bring_on(problem, factor, settings, here.state, Loads(0.0, 0.0), Loads(0.0, force), accept):
                here = point_of(item)
        except StepFailed as failure:
            message = f"no equilibrium under the dead force of {force:g} N before the pressure comes: {failure}"
            raise StepFailed(message, failure.cause) from failure
    return here


def bring_on(
    problem: Problem,
    factor: Factor,
    settings: NewtonSettings,
    state: State,
    start: Loads,
    end: Loads,
    accept: Callable[[PathState], bool] | None = None,
) -> Iterator[PathState]:
    """Converged states on the way from some loads to others, the last one under the latter.

    Parameters
    ----------
    problem, factor
        The problem and its factorisation; its dead force is that of the last state then, or the end's after a failure.
    settings
        Of each Newton solve.
    state
        The state under the loads at the start.
    accept
        As in `solvers.paths.path.follow_path`; it may raise too.

    Raises
    ------
    StepFailed
        If a step fails, or jumps, however small it is.
    """
    assert problem.bonded is not None
    settings = replace(settings, max_iterations=MOST_ITERATIONS)
    begin, way = time.perf_counter(), Loads(end.pressure_mpa - start.pressure_mpa, end.force_n - start.force_n)
    problem.set_state(state)
    factor.refresh()
    before: Place | None = None
    here: Place = (0.0, state, _measured(problem, factor, way))
    done, step = 0.0, 1.0
    while done < 1.0:
        share = done + step if done + step < 1.0 - 1e-9 else 1.0
        at = replace(start, pressure_mpa=start.pressure_mpa + share * way.pressure_mpa)
        problem.bonded.dead_force_n = start.force_n + share * way.force_n
        problem.set_state(_guess(before, here, share))
        try:
            report = solve_equilibrium(problem, factor, settings, HeldLoad(at.pressure_mpa))
            measured = _measured(problem, factor, way)
            _refuse_jump(here[2], measured, share - done)
        except StepFailed as failure:
            # an extrapolation may lead deep into what the body is going to touch
            step, before = 0.5 * (share - done), None
            if step >= SMALLEST_STEP and failure.cause is not Cause.OUT_OF_MEMORY:
                continue
            reached = Loads(start.pressure_mpa + done * way.pressure_mpa, start.force_n + done * way.force_n)
            problem.bonded.dead_force_n = end.force_n
            problem.set_state(here[1])
            raise StepFailed(f"{failure}; last state under {reached.text(problem)}", failure.cause) from failure
        item = record(problem, report, False, "pressure", begin)
        try:
            taken = accept is None or accept(item)
        except StepFailed:
            problem.bonded.dead_force_n = end.force_n
            raise
        if not taken:
            problem.set_state(here[1])
            continue
        before, here, done = here, (share, item.state, measured), share
        yield item
        step = step * GROWTH if report.iterations <= FEW_ITERATIONS else step


def _guess(before: Place | None, here: Place, share: float) -> State:
    """The state extrapolated from the last two."""
    if before is None:
        return here[1]
    ahead = (share - here[0]) / (here[0] - before[0])
    return combine([here[1], before[1]], [1.0 + ahead, -ahead])


def _measured(problem: Problem, factor: Factor, way: Loads) -> Measured:
    """The current state's q, and dq/ds from the factor at it."""
    bonded = problem.bonded
    assert bonded is not None and bonded.plate_axial is not None
    unit = problem.unit_load()
    on_bodies = way.pressure_mpa * unit[1]
    on_bodies[bonded.plate_axial] += way.force_n
    loads: Joint = (way.pressure_mpa * unit[0], on_bodies)
    motion = float(problem.body_values.ravel()[bonded.plate_axial])
    q = way.pressure_mpa * problem.cavity_volume() + way.force_n * motion
    rate = joint_dot(problem.comm, loads, factor.solve(*loads))
    return q, rate


def _refuse_jump(here: Measured, new: Measured, step: float) -> None:
    """Refuse a step that has jumped to another branch.

    Raises
    ------
    StepFailed
        With both changes of the work.
    """
    change, by_rate = new[0] - here[0], 0.5 * step * (here[1] + new[1])
    if abs(change - by_rate) > 0.5 * max(abs(change), abs(by_rate)):
        raise StepFailed(
            f"the loads' work changed by {change:.3g} mJ where its rates make {by_rate:.3g}: the body snaps to another "
            "state"
        )
