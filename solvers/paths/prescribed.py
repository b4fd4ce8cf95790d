"""Equilibrium with rigid bodies moved by a prescribed amount, in steps that are cut where Newton fails.

The guess of a step is the linear one: with K the tangent at the last state and r the residual there once the held
bodies have moved, ``du = -K^-1 r`` carries the wall along. The bond's energy is quadratic in u, so its forces vanish in
the guess.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from solvers.discrete.domain import FloatArray
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause, SolverError, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.diagnosis import REMEDY
from solvers.paths.states import Path, PathState, record
from solvers.problem import Problem

# The whole motion is taken in steps of this share at first; a failed one is halved down to the smallest.
FIRST_STEP, SMALLEST_STEP, GROWTH = 0.25, 1e-3, 1.5
# No step turns a body further, rad: a whole turn in one step would look like none.
LARGEST_TURN = 0.5


def follow_motion(
    problem: Problem,
    factor: Factor,
    motion_mm: FloatArray,
    settings: NewtonSettings,
    on_state: Callable[[PathState], None] | None = None,
) -> Path:
    """Move the held bodies from rest to a motion, in proportion, and bring the body to equilibrium; no load acts.

    Parameters
    ----------
    problem, factor
        The problem, with at least one held body (`solvers.bodies.rigid.RigidBodies.plate_held`), and its factorisation.
    motion_mm
        Body unknowns at the end, shape (bodies, modes): rotation vectors times the arm. Values of bodies that are not
        held are found, not prescribed.
    settings
        Of each Newton solve.
    on_state
        Called with each converged state; the last one is asked.

    Returns
    -------
    Path

    Raises
    ------
    SolverError
        If no body is held.
    """
    bonded = problem.bonded
    if bonded is None or not bonded.is_held.any():
        raise SolverError("no rigid body is held, so none can be moved: give the problem a plate that is held")
    held = bonded.is_held.reshape(motion_mm.shape)
    begin = time.perf_counter()
    turn = float(np.abs(motion_mm[:, 3:]).max(initial=0.0)) / bonded.arm_mm
    longest = LARGEST_TURN / turn if turn > LARGEST_TURN else 1.0
    here, share, step, rejected = problem.zero_state(), 0.0, min(FIRST_STEP, longest), 0
    states: list[PathState] = []
    is_fresh = False
    while share < 1.0:
        target = 1.0 if share + step >= 1.0 - 1e-12 else share + step
        bodies = here.bodies_mm.copy()
        bodies[held] = target * motion_mm[held]
        try:
            if not is_fresh:  # the tangent of the last state
                problem.set_state(here)
                factor.refresh()
            problem.set_state(replace(here, bodies_mm=bodies))
            _carry_along(problem, factor, settings)
            report = solve_equilibrium(problem, factor, settings, HeldLoad(0.0))
        except StepFailed as failure:
            problem.set_state(here)
            is_fresh = False
            rejected += 1
            step *= 0.5
            if failure.cause is Cause.OUT_OF_MEMORY or step < SMALLEST_STEP * min(1.0, longest):
                reason = f"{failure}; {100.0 * share:.4g} % of the motion reached; {REMEDY[failure.cause]}"
                return Path(tuple(states), False, reason, rejected, failure.cause, None)
            continue
        share, step, is_fresh = target, min(GROWTH * step, longest), True
        states.append(record(problem, report, share == 1.0, "pressure", begin))
        here = states[-1].state
        if on_state is not None:
            on_state(states[-1])
    return Path(tuple(states), True, "", rejected, Cause.REACHED, None)


def _carry_along(problem: Problem, factor: Factor, settings: NewtonSettings) -> None:
    """Add the linear answer of the wall to bodies that have moved.

    Raises
    ------
    StepFailed
        If a cell would be inverted by it.
    """
    force, on_bodies = problem.internal_force()
    force[problem.constrained_owned] = 0.0
    on_bodies[problem.held_bodies] = 0.0
    step, body_step = factor.solve(force, on_bodies)
    problem.state.x.array[: problem.owned] -= step
    problem.state.x.scatter_forward()
    if problem.bonded is not None and np.any(body_step):
        problem.bonded.update(-body_step)
    if not problem.deformation.extremes()[0] > settings.least_det_f:
        raise StepFailed(f"the motion would invert a cell: {problem.deformation.worst_cell()}", Cause.INVERTED_CELL)
