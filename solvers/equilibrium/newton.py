"""Newton's method under a control (`solvers.equilibrium.controls`), with every failure caught."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from mpi4py import MPI

from solvers.discrete.domain import FloatArray
from solvers.discrete.sums import Joint, joint_dot
from solvers.equilibrium.controls import Control, HeldLoad
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.problem import Problem
from solvers.state import State

# Rotations of bodies below this, rad, add up.
TURNED = 1e-6


@dataclass(frozen=True)
class NewtonSettings:
    """When to stop and when to give up.

    Attributes
    ----------
    relative_tolerance
        On the force residual relative to the pressure load, and on the volume residual relative to the body.
    stalled_tolerance, still
        A residual below the first also counts as zero when the last increment was below the second times the
        displacement: the internal forces of a stiff ring cancel only to round-off, to 2e-6 of the load where it is a
        million times as stiff as the wall.
    round_off
        A residual below this that an iteration with a fresh factor does not halve is that of round-off: a soft bellows
        under a small dead force moves by more than ``still`` in every iteration.
    max_iterations
        Newton iterations before the step is given up, unless the factor of the last one is still good enough.
    reuse_below
        A factor is used again while the residual falls by more than this factor in an iteration.
    reuse_for
        And where it would take no more iterations than this as fast as the last one.
    max_cuts
        Halvings of an increment that would invert a cell.
    least_det_f
        An increment is cut when it would take det F below this at a quadrature point.
    line_search
        Halvings of an increment that does not reduce the residual; the best of the lengths tried is taken.
    counted
        False where nobody asks for the stability of what is found, nor where the path goes on from it: the factor at
        the converged state, which takes one more factorisation, is left out.
    """

    relative_tolerance: float = 1e-8
    stalled_tolerance: float = 1e-4
    still: float = 1e-10
    round_off: float = 1e-7
    max_iterations: int = 14
    reuse_below: float = 0.1
    reuse_for: float = 4.0
    max_cuts: int = 6
    least_det_f: float = 0.05
    line_search: int = 1
    counted: bool = True


@dataclass(frozen=True)
class NewtonReport:
    """What a converged solve cost and found.

    Attributes
    ----------
    iterations, factorisations
        Newton iterations, and factorisations made (one of them or more for the stability count).
    residual
        Final relative residual.
    min_det_f, largest_stretch
        Smallest det F and largest principal stretch (of the elastomer) at quadrature points.
    excess_negatives
        Negative eigenvalues of the tangent at the converged state beyond the expected; None if the load is not
        conservative, or nobody asks.
    compliance_mm3_per_mpa
        dV/dP of the path at the converged state; NaN if nobody asks.
    rate
        Change of the state with the load factor along the path, 1/MPa; None if nobody asks, where bodies have turned,
        whose rotations do not add up, and with contact, which makes paths that are not smooth.
    """

    iterations: int
    factorisations: int
    residual: float
    min_det_f: float
    largest_stretch: float
    excess_negatives: int | None
    compliance_mm3_per_mpa: float
    rate: State | None = field(default=None, compare=False, repr=False)

    @property
    def excess_at_volume(self) -> int | None:
        """Unstable modes with the volume held."""
        return at_held_volume(self.excess_negatives, self.compliance_mm3_per_mpa)


def at_held_volume(unstable: int | None, compliance_mm3_per_mpa: float) -> int | None:
    """Unstable modes with the volume held: by Haynsworth those at held pressure, less one if dV/dP < 0."""
    return None if unstable is None else unstable - (compliance_mm3_per_mpa < 0.0)


def solve_equilibrium(
    problem: Problem,
    factor: Factor,
    settings: NewtonSettings,
    control: Control,
    on_iteration: Callable[[int, float], None] | None = None,
) -> NewtonReport:
    """Bring the problem's current state to equilibrium.

    Parameters
    ----------
    problem, factor
        The problem, holding the first guess, and its factorisation.
    settings
        Tolerances and limits.
    control
        What is held.
    on_iteration
        Called with (iteration, relative residual) for progress.

    Returns
    -------
    NewtonReport

    Raises
    ------
    StepFailed
        On NaN, divergence, cells that would invert, values out of the material's range, or too many
        iterations. The problem's state is then spoilt: the caller goes back to its last good one.
    """
    before = factor.count
    control.begin(problem)
    error = moved = np.inf
    fresh = False
    here = _residual(problem, control)
    for iteration in itertools.count():
        new_error = here.error
        if not np.isfinite(new_error):
            raise StepFailed(f"the residual is not finite in iteration {iteration}")
        if on_iteration is not None:
            on_iteration(iteration, new_error)
        stalled = new_error <= settings.stalled_tolerance and moved <= settings.still
        stalled |= fresh and 0.5 * error < new_error <= settings.round_off
        if new_error <= settings.relative_tolerance or stalled:
            det_f, stretch = _check_state(problem)
            if not settings.counted:
                return NewtonReport(iteration, factor.count - before, new_error, det_f, stretch, None, math.nan)
            factor.refresh()  # the stability count is that of the converged state
            toward = factor.solve(*here.force)
            compliance = joint_dot(problem.comm, here.gradient, toward)
            unstable, rate = factor.unstable_modes(), _rate(problem, toward)
            used = factor.count - before
            return NewtonReport(iteration, used, new_error, det_f, stretch, unstable, compliance, rate)
        reuse = iteration > 0 and _converges(settings, error, new_error)
        if new_error > 1e8 or (iteration >= settings.max_iterations and not reuse):
            raise StepFailed(f"no convergence: relative residual {new_error:.1e} after {iteration} iterations")
        error, fresh = new_error, not reuse
        if fresh:
            factor.refresh()
            if problem.turning is not None:
                problem.turning.mark(problem.state.x.array[: problem.owned], problem.body_values)
        moved, here = _advance(problem, settings, control, error, _increment(problem, factor, control, here))
    raise AssertionError("unreachable")


def relative_residual(problem: Problem) -> float:
    """How far the current state is from equilibrium at its load: the error that `solve_equilibrium` brings down.

    Every rank calls.
    """
    return _residual(problem, HeldLoad(float(problem.pressure.value))).error


@dataclass(frozen=True)
class _Residual:
    """Residual, force of a unit load and dV/dw on owned dofs and bodies, and the relative error of the state."""

    residual: Joint
    force: Joint
    gradient: Joint
    error: float


@dataclass(frozen=True)
class _Increment:
    """Change of the owned dofs, of the bodies and of the load factor."""

    dofs: FloatArray
    bodies: FloatArray
    load_mpa: float


def _converges(settings: NewtonSettings, error: float, new_error: float) -> bool:
    """True if the factor that has led from one relative residual to another is good enough for what is left."""
    rate = new_error / error
    left = math.log(settings.relative_tolerance / new_error) / math.log(rate) if rate < 1.0 else math.inf
    return rate < settings.reuse_below or left <= settings.reuse_for


def _rate(problem: Problem, toward: Joint) -> State | None:
    """A change with the load factor in the caller's numbering, where it can be gone along: see `NewtonReport.rate`."""
    bonded = problem.bonded
    turns = 0.0
    if bonded is not None:
        rotations = [k for k, motion in enumerate(bonded.motions) if motion >= 3]
        turns = float(np.abs(bonded.values[:, rotations]).max(initial=0.0)) / bonded.arm_mm
    return problem.unknowns.rate(*toward) if turns <= TURNED and problem.contact is None else None


def _increment(problem: Problem, factor: Factor, control: Control, here: _Residual) -> _Increment:
    """Newton's step under a control, with the current factor."""
    dofs, bodies = (-part for part in factor.solve(*here.residual))
    if not control.frees_load:
        return _Increment(dofs, bodies, 0.0)
    toward = factor.solve(*here.force)
    change = control.load_change(problem, here.gradient, (dofs, bodies), toward)
    return _Increment(dofs + toward[0] * change, bodies + toward[1] * change, change)


def _residual(problem: Problem, control: Control) -> _Residual:
    """Residual at the current state."""
    force, on_bodies = problem.internal_force()
    on_bodies[problem.held_bodies] = 0.0
    unit_load = problem.unit_load()
    gradient = unit_load if problem.conservative else problem.volume_gradient()
    pressure = float(problem.pressure.value)
    residual = force - pressure * unit_load[0]
    residual[problem.constrained_owned] = 0.0
    is_p = problem.owned_pressure
    with np.errstate(over="ignore"):  # far too long a step of an exponential law: infinitely wrong, and halved
        sums = np.array(
            [
                residual[~is_p] @ residual[~is_p],
                residual[is_p] @ residual[is_p],
                unit_load[0] @ unit_load[0],
            ]
        )
    sums = problem.comm.allreduce(sums, op=MPI.SUM)
    # Below a thousandth of the shear modulus the load says nothing about the size of forces.
    load = max(abs(pressure), 1e-3 * problem.shear_modulus_mpa) * np.sqrt(sums[2])
    if problem.bonded is not None:
        load = np.hypot(load, problem.bonded.dead_force_n)
    if load == 0.0:
        raise StepFailed("the load acts on nothing that is free to move: look which surfaces are loaded and held")
    error = np.sqrt(sums[0] + on_bodies @ on_bodies) / load + np.sqrt(sums[1]) / problem.volume_scale
    error += control.error(problem)
    return _Residual((residual, on_bodies), unit_load, gradient, float(error))


def _advance(
    problem: Problem,
    settings: NewtonSettings,
    control: Control,
    error: float,
    increment: _Increment,
) -> tuple[float, _Residual]:
    """Add the increment, cut until no cell comes near inversion and the residual falls if it can be made to.

    Returns the increment's size relative to the displacement, and the residual at the new state.
    """
    array = problem.state.x.array
    start, start_bodies = array.copy(), problem.body_values.copy()
    pressure = float(problem.pressure.value)

    def go(fraction: float) -> None:
        array[: problem.owned] = start[: problem.owned] + fraction * increment.dofs
        if problem.turning is not None:
            turned = fraction * increment.bodies.reshape(start_bodies.shape)
            problem.turning.add_rest(array[: problem.owned], start[: problem.owned], start_bodies, turned)
        problem.state.x.scatter_forward()
        problem.pressure.value = pressure + fraction * increment.load_mpa
        if problem.bonded is not None:
            problem.bonded.values[:] = start_bodies
            problem.bonded.update(fraction * increment.bodies)

    fraction = _admissible(problem, settings, go)
    here = _residual(problem, control)
    best, best_fraction = here, fraction
    for _ in range(settings.line_search):
        if best.error < error:
            break
        fraction *= 0.5
        go(fraction)
        here = _residual(problem, control)
        if here.error < best.error or np.isnan(best.error):
            best, best_fraction = here, fraction
    if best_fraction != fraction:
        go(best_fraction)
    is_u = ~problem.owned_pressure
    largest, total = (
        problem.comm.allreduce(float(np.abs(v[is_u]).max(initial=0.0)), op=MPI.MAX)
        for v in (increment.dofs, array[: problem.owned])
    )
    return (largest / total if total > 0.0 else np.inf), best


def _admissible(problem: Problem, settings: NewtonSettings, go: Callable[[float], None]) -> float:
    """Go along the increment as far as no cell comes near inversion; the fraction of it that was gone."""
    limit1, limit2 = problem.invariant_limits
    fraction = 1.0
    for _ in range(settings.max_cuts + 1):
        go(fraction)
        det_f, i1, i2 = problem.deformation.extremes()
        if det_f > settings.least_det_f and i1 <= limit1 and i2 <= limit2:
            return fraction
        fraction *= 0.5
    length = f"even at 1/{2**settings.max_cuts} of its length"
    if not det_f > settings.least_det_f:
        raise StepFailed(
            f"an increment would invert a cell {length}: {problem.deformation.worst_cell()}", Cause.INVERTED_CELL
        )
    raise StepFailed(f"an increment would leave the material's range {length}: {_range(problem)}", Cause.MATERIAL_RANGE)


def _range(problem: Problem) -> str:
    _, i1, i2 = problem.deformation.extremes()
    limit1, limit2 = problem.invariant_limits
    return f"I1 = {i1:.3g} (<= {limit1:g}), I2 = {i2:.3g} (<= {limit2:g})"


def _check_state(problem: Problem) -> tuple[float, float]:
    """Smallest det F and largest stretch of a state that may be accepted."""
    det_f, i1, i2 = problem.deformation.extremes()
    if not det_f > 0.0:
        raise StepFailed(f"converged to an inverted cell: {problem.deformation.worst_cell()}", Cause.INVERTED_CELL)
    limit1, limit2 = problem.invariant_limits
    if i1 > limit1 or i2 > limit2:
        raise StepFailed(f"out of the material law's range: {_range(problem)}", Cause.MATERIAL_RANGE)
    if softened := problem.deformation.softened():
        raise StepFailed(f"the law is no longer stable at {softened}", Cause.LAW_SOFTENS)
    for term in problem.terms:
        term.check()
    return det_f, problem.deformation.largest_stretch()
