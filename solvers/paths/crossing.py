"""Where along a path stability is lost, and in which mode.

The count of negative pivots is that of unstable modes at held pressure. By Haynsworth the count at held volume is one
less where dP/dV < 0: at a limit point the first changes and the second does not, at a bifurcation both do.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from mpi4py import MPI

from solvers.equilibrium.controls import Control, HeldLoad, HeldVolume
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.linear.inverse_iteration import softest_mode
from solvers.paths.arc import Scale, plane_at
from solvers.paths.bisection import narrow
from solvers.paths.prediction import half_way
from solvers.paths.states import Crossing, PathPoint, point_now
from solvers.problem import Problem
from solvers.state import State, combine

# The interval shrinks at least this much, also where the pressure is flat: at a limit point.
LEAST_SHRINKING = 1e-3


def lost_stability(before: PathPoint, after: PathPoint) -> bool:
    """True if the number of unstable modes differs between two states."""
    return before.unstable is not None and after.unstable is not None and before.unstable != after.unstable


def kind_of(before: PathPoint, after: PathPoint) -> Cause:
    """Limit point or bifurcation, from the counts at held volume on both sides."""
    if before.unstable_at_volume == after.unstable_at_volume:
        return Cause.LIMIT_POINT
    return Cause.BIFURCATION


def locate_crossing(
    problem: Problem,
    factor: Factor,
    settings: NewtonSettings,
    before: PathPoint,
    after: PathPoint,
    tolerance: float,
    along: Scale | None = None,
) -> Crossing:
    """First change of the number of unstable modes between two converged states, by bisection in the volume.

    Parameters
    ----------
    problem, factor
        The problem and its factorisation; the state is left at the crossing.
    settings
        Of each Newton solve.
    before, after
        Neighbouring states of a path with different counts.
    tolerance
        The pressures of the final two states differ by less than this share.
    along
        Bisect along the path, in this scale of arc length, as on a path that is followed so.

    Returns
    -------
    Crossing
        With the critical mode. If a solve fails the interval stays as wide as it is; ``within_mpa`` says so. If no mode
        can be computed it has none: where stability was lost is known all the same.
    """
    # A load that does no work on the path to the crossing leaves the volume as it is: then by pressure.
    moves = abs(after.volume_mm3 - before.volume_mm3) > 1e-9 * problem.volume_unit_mm3

    def middle(low: PathPoint, high: PathPoint) -> tuple[float, PathPoint] | None:
        control: Control = HeldLoad(0.5 * (low.pressure_mpa + high.pressure_mpa))
        if along is not None:
            guess = combine([low.state, high.state], [0.5, 0.5])
            control = plane_at(problem, low.state, guess, along)
        elif moves:
            guess = half_way(low, high, "volume")
            control = HeldVolume(0.5 * (low.volume_mm3 + high.volume_mm3))
        else:
            guess = half_way(low, high, "pressure")
        problem.set_state(guess)
        try:
            return 0.5, point_now(problem, solve_equilibrium(problem, factor, settings, control))
        except StepFailed:
            return None

    by_pressure = along is None and not moves
    low, high = narrow(before, after, middle, tolerance, 1.0 if by_pressure else LEAST_SHRINKING)
    assert before.unstable is not None and high.unstable is not None
    pressure = 0.5 * (low.pressure_mpa + high.pressure_mpa)
    problem.set_state(high.state)
    mode, of_class = None, ""
    try:
        mode, of_class = critical_mode(problem, factor)
    except StepFailed:
        problem.set_state(high.state)
    return Crossing(
        kind=kind_of(low, high),
        pressure_mpa=pressure,
        within_mpa=0.5 * abs(high.pressure_mpa - low.pressure_mpa),
        volume_mm3=0.5 * (low.volume_mm3 + high.volume_mm3),
        modes_before=before.unstable,
        modes_after=high.unstable,
        state=high.state,
        mode=None if mode is None else replace(mode, load_mpa=pressure),
        of_class=of_class,
    )


def critical_mode(problem: Problem, factor: Factor) -> tuple[State, str]:
    """The displacement mode whose stiffness is closest to zero, scaled to 1 mm at most, and its parity class if any.

    By inverse iteration; its start is random in the caller's numbering, so that the mode does not depend on the number
    of ranks.

    Parameters
    ----------
    problem, factor
        The problem at the state in question; a factorisation of each class is made. The state is left as it was.

    Returns
    -------
    tuple
        The mode, whose ``load_mpa`` is that of the state, and the class; see `Crossing`.

    Raises
    ------
    StepFailed
        If it cannot be computed.
    """
    here = problem.get_state()
    rng = np.random.default_rng(29)
    blank = problem.zero_state()
    start = State(
        rng.standard_normal(blank.displacement_mm.shape), blank.pressure_mpa, 0.0 * blank.bodies_mm, here.load_mpa
    )
    problem.set_state(start)
    first = problem.state.x.array[: problem.owned].copy()
    problem.set_state(here)
    found = [(softest_mode(of, first), name) for name, of in factor.of_classes()]
    softest, of_class = min(found, key=lambda pair: abs(pair[0].stiffness_n_per_mm))
    moves = softest.dofs[~problem.owned_pressure]
    largest = problem.comm.allreduce(float(np.abs(moves).max(initial=0.0)), op=MPI.MAX)
    problem.state.x.array[: problem.owned] = softest.dofs / largest
    problem.state.x.scatter_forward()
    raw = problem.get_state()
    count = len(blank.bodies_mm)
    bodies = softest.bodies.reshape(count, len(softest.bodies) // max(1, count)) / largest
    # the sign of an eigenvector is nobody's: its largest component is made positive
    sign = np.sign(raw.displacement_mm.flat[np.argmax(np.abs(raw.displacement_mm))])
    mode = State(sign * raw.displacement_mm, sign * raw.pressure_mpa, sign * bodies, here.load_mpa)
    problem.set_state(here)
    return mode, of_class
