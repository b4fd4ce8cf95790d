"""Newton's method at a given cavity pressure or a given cavity volume, with every failure caught.

Volume control solves for the pressure too. With K the tangent, R the residual, g = dV/dw: a = K^-1 R and
b = K^-1 g give ``dP = (V* - V + g.a) / (g.b)`` and ``dw = -a + b dP`` from one factorisation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from solvers.domain import FloatArray
from solvers.errors import StepFailed
from solvers.linear import Factor
from solvers.problem import Problem


@dataclass(frozen=True)
class NewtonSettings:
    """When to stop and when to give up.

    Attributes
    ----------
    relative_tolerance
        On the force residual relative to the pressure load, and on the volume residual relative to the body.
    stalled_tolerance, still
        A residual below the first also counts as zero when the last increment was below the second times the
        displacement: the internal forces of a stiff ring cancel only to round-off.
    max_iterations
        Newton iterations before the step is given up.
    reuse_below
        A factor is used again while the residual falls by more than this factor in an iteration.
    max_cuts
        Halvings of an increment that would invert a cell.
    least_det_f
        An increment is cut when it would take det F below this at a quadrature point.
    """

    relative_tolerance: float = 1e-8
    stalled_tolerance: float = 1e-6
    still: float = 1e-10
    max_iterations: int = 14
    reuse_below: float = 0.1
    max_cuts: int = 6
    least_det_f: float = 0.05


@dataclass(frozen=True)
class NewtonReport:
    """What a converged solve cost and found.

    Attributes
    ----------
    iterations, factorisations
        Newton iterations, and factorisations made (one of them for the stability count).
    residual
        Final relative residual.
    min_det_f
        Smallest det F at quadrature points.
    excess_negatives
        Negative eigenvalues of the tangent at the converged state beyond the expected.
    """

    iterations: int
    factorisations: int
    residual: float
    min_det_f: float
    excess_negatives: int


def solve_equilibrium(
    problem: Problem,
    factor: Factor,
    settings: NewtonSettings,
    pressure_mpa: float | None = None,
    volume_mm3: float | None = None,
    on_iteration: Callable[[int, float], None] | None = None,
) -> NewtonReport:
    """Bring the problem's current state to equilibrium at a pressure or a volume (give exactly one).

    Parameters
    ----------
    problem, factor
        The problem, holding the first guess, and its factorisation.
    settings
        Tolerances and limits.
    pressure_mpa, volume_mm3
        The controlled quantity.
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
    assert (pressure_mpa is None) != (volume_mm3 is None)
    before = factor.count
    if pressure_mpa is not None:
        problem.pressure.value = pressure_mpa
    error = moved = np.inf
    for iteration in range(settings.max_iterations + 1):
        residual, on_bodies, gradient, new_error = _residual(problem, volume_mm3)
        if not np.isfinite(new_error):
            raise StepFailed(f"the residual is not finite in iteration {iteration}")
        if on_iteration is not None:
            on_iteration(iteration, new_error)
        stalled = new_error <= settings.stalled_tolerance and moved <= settings.still
        if new_error <= settings.relative_tolerance or stalled:
            det_f = _check_state(problem)
            factor.refresh()  # the stability count is that of the converged state
            return NewtonReport(iteration, factor.count - before, new_error, det_f, factor.excess_negatives)
        if new_error > 1e8 or iteration == settings.max_iterations:
            raise StepFailed(f"no convergence: relative residual {new_error:.1e} after {iteration} iterations")
        reuse = iteration > 0 and new_error < settings.reuse_below * error
        error = new_error
        if not reuse:
            factor.refresh()
        step, body_step = factor.solve(residual, on_bodies)
        step, body_step, pressure_step = -step, -body_step, 0.0
        if volume_mm3 is not None:
            toward, body_toward = factor.solve(gradient, np.zeros(problem.extra))
            missing = volume_mm3 - problem.cavity_volume()
            compliance = _dot(problem, gradient, toward)
            pressure_step = (missing - _dot(problem, gradient, step)) / compliance
            step, body_step = step + toward * pressure_step, body_step + body_toward * pressure_step
        moved = _advance(problem, settings, step, body_step, pressure_step)
    raise AssertionError("unreachable")


def _dot(problem: Problem, a: FloatArray, b: FloatArray) -> float:
    return float(problem.comm.allreduce(float(a @ b), op=MPI.SUM))


def _residual(problem: Problem, volume_mm3: float | None) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Residual on dofs and bodies, dV/dw, and the relative error of the state."""
    force, on_bodies = problem.internal_force()
    gradient = problem.volume_gradient()
    pressure = float(problem.pressure.value)
    residual = force - pressure * gradient
    fixed = problem.constrained_owned
    residual[fixed] = 0.0
    gradient[fixed] = 0.0
    is_p = problem.owned_pressure
    sums = np.array(
        [
            residual[~is_p] @ residual[~is_p],
            residual[is_p] @ residual[is_p],
            gradient @ gradient,
        ]
    )
    sums = problem.comm.allreduce(sums, op=MPI.SUM)
    # Below a thousandth of the shear modulus the load says nothing about the size of forces.
    load = max(abs(pressure), 1e-3 * problem.shear_modulus_mpa) * np.sqrt(sums[2])
    error = np.sqrt(sums[0] + on_bodies @ on_bodies) / load + np.sqrt(sums[1]) / problem.volume_scale
    if volume_mm3 is not None:
        error += abs(volume_mm3 - problem.cavity_volume()) / abs(volume_mm3)
    return residual, on_bodies, gradient, float(error)


def _advance(
    problem: Problem, settings: NewtonSettings, step: FloatArray, body_step: FloatArray, pressure_step: float
) -> float:
    """Add the increment, halved until no cell comes near inversion; returns its size relative to the displacement."""
    array = problem.state.x.array
    start = array.copy()
    pressure = float(problem.pressure.value)
    fraction = 1.0
    for _ in range(settings.max_cuts + 1):
        array[: problem.owned] = start[: problem.owned] + fraction * step
        problem.state.x.scatter_forward()
        det_f, i1, i2 = problem.extremes()
        in_range = i1 <= problem.law.invariant_limits[0] and i2 <= problem.law.invariant_limits[1]
        if det_f > settings.least_det_f and in_range:
            if problem.bonded is not None:
                problem.bonded.update(fraction * body_step)
            problem.pressure.value = pressure + fraction * pressure_step
            is_u = ~problem.owned_pressure
            largest, total = (
                problem.comm.allreduce(float(np.abs(v[is_u]).max(initial=0.0)), op=MPI.MAX)
                for v in (step, array[: problem.owned])
            )
            return largest / total if total > 0.0 else np.inf
        fraction *= 0.5
    raise StepFailed(
        f"an increment would invert a cell or leave the material's range even at 1/{2**settings.max_cuts} of its "
        f"length (det F {det_f:.3g}, I1 {i1:.3g}, I2 {i2:.3g})"
    )


def _check_state(problem: Problem) -> float:
    det_f, i1, i2 = problem.extremes()
    if not det_f > 0.0:
        raise StepFailed(f"converged to a state with det F = {det_f:.3g} at a quadrature point")
    limit1, limit2 = problem.law.invariant_limits
    if i1 > limit1 or i2 > limit2:
        raise StepFailed(f"out of the material law's range: I1 = {i1:.3g} (<= {limit1:g}), I2 = {i2:.3g}")
    return det_f
