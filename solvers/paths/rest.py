"""Where paths begin: the state without pressure."""

from __future__ import annotations

from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.problem import Problem

# A dead force is brought on at once, or else in so many equal parts.
FORCE_PARTS = (1, 4, 16)


def go_to_rest(problem: Problem, factor: Factor, settings: NewtonSettings) -> None:
    """The state without pressure: the unloaded one, or that under a dead force, brought on in parts if need be.

    Raises
    ------
    StepFailed
        If Newton fails however small the parts.
    """
    problem.set_state(problem.zero_state())
    bonded = problem.bonded
    if bonded is None or bonded.dead_force_n == 0.0:
        return
    whole = bonded.dead_force_n
    for parts in FORCE_PARTS:
        problem.set_state(problem.zero_state())
        try:
            for k in range(1, parts + 1):
                bonded.dead_force_n = whole * k / parts
                solve_equilibrium(problem, factor, settings, HeldLoad(0.0))
            return
        except StepFailed as failure:
            bonded.dead_force_n = whole
            if parts == FORCE_PARTS[-1] or failure.cause is Cause.OUT_OF_MEMORY:
                message = f"no equilibrium under the dead force of {whole:g} N before the pressure comes: {failure}"
                raise StepFailed(message, failure.cause) from failure
