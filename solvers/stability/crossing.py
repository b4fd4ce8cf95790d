"""Where along a path stability is lost, and in which mode.

The count of negative pivots is that of unstable modes at held pressure. By Haynsworth the count at held volume is one
less where dP/dV < 0: at a limit point the first changes and the second does not, at a bifurcation both do.
"""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from solvers.discrete.domain import FloatArray
from solvers.equilibrium.newton import NewtonReport, NewtonSettings, solve_equilibrium
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.arc import Scale, plane_at
from solvers.paths.records import Control, Crossing, PathPoint
from solvers.problem import Problem
from solvers.state import State, combine

BISECTIONS = 40
# The interval shrinks at least this much, also where the pressure is flat: at a limit point.
LEAST_SHRINKING = 1e-3
MODE_ITERATIONS = 30


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
        With the critical mode. If a solve fails the interval stays as wide as it is; ``within_mpa`` says so.
    """
    # A load that does no work on the path to the crossing leaves the volume as it is: then by pressure.
    moves = abs(after.volume_mm3 - before.volume_mm3) > 1e-9 * problem.volume_unit_mm3
    control: Control = "arc" if along is not None else "volume" if moves else "pressure"
    low, high, width = before, after, 1.0
    for _ in range(BISECTIONS):
        near = abs(high.pressure_mpa - low.pressure_mpa) <= tolerance * abs(high.pressure_mpa)
        if near and (width <= LEAST_SHRINKING or control == "pressure"):
            break
        try:
            middle = _between(problem, factor, settings, low, high, control, along)
        except StepFailed:
            break
        width *= 0.5
        low, high = (middle, high) if middle.unstable == before.unstable else (low, middle)
    assert before.unstable is not None and high.unstable is not None
    pressure = 0.5 * (low.pressure_mpa + high.pressure_mpa)
    problem.set_state(high.state)
    mode = critical_mode(problem, factor)
    return Crossing(
        kind=kind_of(low, high),
        pressure_mpa=pressure,
        within_mpa=0.5 * abs(high.pressure_mpa - low.pressure_mpa),
        volume_mm3=0.5 * (low.volume_mm3 + high.volume_mm3),
        modes_before=before.unstable,
        modes_after=high.unstable,
        state=high.state,
        mode=State(mode.displacement_mm, mode.pressure_mpa, mode.bodies_mm, pressure),
    )


def _between(
    problem: Problem,
    factor: Factor,
    settings: NewtonSettings,
    low: PathPoint,
    high: PathPoint,
    control: Control,
    along: Scale | None,
) -> PathPoint:
    """Equilibrium half-way between two."""
    middle = combine([low.state, high.state], [0.5, 0.5])
    problem.set_state(middle)
    report: NewtonReport
    if along is not None:
        plane = plane_at(problem, low.state, middle, along)
        report = solve_equilibrium(problem, factor, settings, plane=plane)
    elif control == "volume":
        volume = 0.5 * (low.volume_mm3 + high.volume_mm3)
        report = solve_equilibrium(problem, factor, settings, volume_mm3=volume)
    else:
        pressure = 0.5 * (low.pressure_mpa + high.pressure_mpa)
        report = solve_equilibrium(problem, factor, settings, pressure_mpa=pressure)
    return PathPoint(
        problem.get_state(), problem.cavity_volume(), report.compliance_mm3_per_mpa, report.excess_negatives
    )


def critical_mode(problem: Problem, factor: Factor) -> State:
    """The displacement mode whose stiffness is closest to zero, scaled to 1 mm at most.

    Inverse iteration ``x <- K^-1 D x`` with D = 1 on displacements and bodies, 0 on pressures, which is that of the
    stiffness condensed to displacements that keep the volume of the cells. The start is random in the caller's
    numbering, so that the mode does not depend on the number of ranks.

    Parameters
    ----------
    problem, factor
        The problem at the state in question; one factorisation is made. The state is left as it was.

    Returns
    -------
    State
        The mode; ``load_mpa`` is that of the state.
    """
    here = problem.get_state()
    factor.refresh()
    rng = np.random.default_rng(29)
    blank = problem.zero_state()
    start = State(
        rng.standard_normal(blank.displacement_mm.shape), blank.pressure_mpa, 0.0 * blank.bodies_mm, here.load_mpa
    )
    problem.set_state(start)
    dofs, bodies = problem.state.x.array[: problem.owned].copy(), np.zeros(problem.extra)
    stiffness = np.inf
    for _ in range(MODE_ITERATIONS):
        dofs[problem.owned_pressure | problem.constrained_owned] = 0.0
        size = np.sqrt(_dot(problem, dofs, dofs) + bodies @ bodies)
        dofs, bodies = dofs / size, bodies / size
        new_dofs, new_bodies = factor.solve(dofs, bodies)
        is_u = ~problem.owned_pressure
        new = 1.0 / (_dot(problem, dofs[is_u], new_dofs[is_u]) + float(bodies @ new_bodies))
        dofs, bodies = new_dofs, new_bodies
        if abs(new - stiffness) <= 1e-6 * abs(new):
            break
        stiffness = new
    moves = dofs[~problem.owned_pressure]
    largest = problem.comm.allreduce(float(np.abs(moves).max(initial=0.0)), op=MPI.MAX)
    problem.state.x.array[: problem.owned] = dofs / largest
    problem.state.x.scatter_forward()
    raw = problem.get_state()
    shape = blank.bodies_mm.shape
    # the sign of an eigenvector is nobody's: its largest component is made positive
    sign = np.sign(raw.displacement_mm.flat[np.argmax(np.abs(raw.displacement_mm))])
    mode = State(
        sign * raw.displacement_mm, sign * raw.pressure_mpa, sign * (bodies / largest).reshape(shape), here.load_mpa
    )
    problem.set_state(here)
    return mode


def _dot(problem: Problem, a: FloatArray, b: FloatArray) -> float:
    return float(problem.comm.allreduce(float(a @ b), op=MPI.SUM))
