"""Why a path ended, in words with numbers and a remedy."""

from __future__ import annotations

import math
from collections.abc import Sequence

from solvers.errors import Cause, StepFailed
from solvers.paths.states import ControlName, Crossing, PathPoint

REMEDY = {
    Cause.INVERTED_CELL: "look at the shape there (a sharp corner, a fold), refine the mesh there or soften the bond's "
    "edge",
    Cause.MATERIAL_RANGE: "the law's numbers do not hold at such stretches: ask for less pressure or use another law",
    Cause.LAW_SOFTENS: "ask for smaller loads, or fit the law so that it stiffens at such stretches",
    Cause.LINEAR_SOLVER: "the tangent may be singular: check that supports hold the body, every part of it",
    Cause.OUT_OF_MEMORY: "use more memory or ranks, fewer cells, or a larger disk in MUMPS_OOC_TMPDIR",
    Cause.NO_RESPONSE: 'use control = "pressure"',
    Cause.CONTACT: "take smaller steps, or refine the mesh where the surfaces meet",
    Cause.STEP_SIZE: "take smaller steps at first, or refine the mesh where the strain is largest",
}


def limit_pressure(history: Sequence[PathPoint]) -> float:
    """Pressure in MPa at which dP/dV is going to vanish; NaN if it does not fall.

    Near a limit point the pressure is a parabola of the volume, so that (dP/dV)^2 falls linearly with the pressure.
    """
    if len(history) < 2:
        return math.nan
    a, b = history[-2:]
    fall = a.slope_mpa_per_mm3**2 - b.slope_mpa_per_mm3**2
    if not (0.0 < fall < math.inf and b.pressure_mpa > a.pressure_mpa):
        return math.nan
    return b.pressure_mpa + b.slope_mpa_per_mm3**2 * (b.pressure_mpa - a.pressure_mpa) / fall


def loss_of_stability(crossing: Crossing | None) -> str:
    """A crossing in words; empty if there is none."""
    if crossing is None:
        return ""
    where = f"at {1e3 * crossing.pressure_mpa:.6g} kPa (within {1e3 * crossing.within_mpa:.1g})"
    counts = f"unstable modes at held pressure {crossing.modes_before} -> {crossing.modes_after}"
    if crossing.kind is Cause.LIMIT_POINT:
        return f"limit point {where}: dP/dV passes zero, {counts}"
    return f"bifurcation {where}: {counts} while dP/dV is not zero"


def failed_steps(
    failure: StepFailed, history: Sequence[PathPoint], crossing: Crossing | None, control: ControlName, stiffest: float
) -> tuple[Cause, str]:
    """Kind and sentence for a path whose steps kept failing.

    Parameters
    ----------
    failure
        The last failure.
    history
        The last converged states.
    crossing
        Where stability was lost on the way, if it was.
    control
        What was held in the steps that failed.
    stiffest
        Largest dP/dV met, MPa/mm^3.
    """
    here = history[-1]
    at = f"last state at {1e3 * here.pressure_mpa:.6g} kPa"
    lost = loss_of_stability(crossing)
    more = f"; on the way: {lost}" if lost else ""
    if failure.cause is Cause.OUT_OF_MEMORY:
        return failure.cause, f"{failure}; {at}; {REMEDY[failure.cause]}"
    if failure.cause is Cause.LAW_SOFTENS:  # at the smallest steps: this, not the structure, is what ends the path
        return failure.cause, f"{failure}; {at}{more}; {REMEDY[failure.cause]}"
    limit = limit_pressure(history)
    share = here.slope_mpa_per_mm3 / stiffest if stiffest > 0.0 else math.nan
    if control == "pressure" and share < 0.2 and limit <= 1.02 * here.pressure_mpa:
        return Cause.LIMIT_POINT, (
            f"limit point near {1e3 * limit:.6g} kPa: dP/dV has fallen to {100.0 * share:.2g} % of its largest; {at}; "
            'pressure control cannot pass it, control = "auto" or "volume" can'
        )
    if crossing is not None and crossing.kind is Cause.BIFURCATION and here.unstable:
        return Cause.BIFURCATION, (
            f"{lost}; beyond it the path followed is not the one the body takes, and its steps failed: {failure}; "
            f"{at}; give the geometry a small imperfection in the critical mode to follow the other branch"
        )
    fallen = crossing is not None and crossing.kind is Cause.LIMIT_POINT and here.pressure_mpa < crossing.pressure_mpa
    if fallen and failure.cause is Cause.LINEAR_SOLVER:  # a wall drawn so thin that it hardly has a stiffness
        return Cause.LIMIT_POINT, (
            f"{lost}; beyond it the pressure falls, and at {1e3 * here.pressure_mpa:.6g} kPa steps failed: {failure}; "
            "ask for less than the limit pressure"
        )
    kind = "" if failure.cause is Cause.MATERIAL_RANGE else f"{failure.cause}: "  # its message names itself
    return failure.cause, f"{kind}{failure}; {at}{more}; {REMEDY[failure.cause]}"


def too_large(
    multiple: float, here: PathPoint, limit_mpa: float, asked_mpa: float, crossing: Crossing | None
) -> tuple[Cause, str]:
    """Kind and sentence for a path that ended because the cavity grew beyond measure.

    A farther branch is spoken of only where the pressure rises at the end.

    Parameters
    ----------
    multiple
        The largest volume allowed, relative to the unloaded one.
    here
        The last state.
    limit_mpa
        Pressure of the limit point that the path has passed; NaN without one.
    asked_mpa
        The pressure that was asked for next.
    crossing
        Where stability was lost on the way, if it was.
    """
    end = f"the cavity exceeds {multiple:g} times its unloaded volume and {1e3 * asked_mpa:.6g} kPa is not reached"
    lost = f"; on the way: {loss_of_stability(crossing)}" if crossing is not None else ""
    if math.isnan(limit_mpa):
        return Cause.TOO_LARGE, (
            f"{end}; highest pressure {1e3 * here.pressure_mpa:.6g} kPa{lost}; check the units of the material, ask "
            "for less pressure, or set load.largest_volume higher"
        )
    limit = f"limit point at {1e3 * limit_mpa:.6g} kPa{lost}"
    if crossing is not None and crossing.kind is Cause.LIMIT_POINT:
        limit = loss_of_stability(crossing)
    limit = f"{limit}; beyond it {end}"
    if here.slope_mpa_per_mm3 > 0.0:
        return Cause.LIMIT_POINT, (
            f"{limit}, but the pressure rises again, {1e3 * here.pressure_mpa:.6g} kPa there: a farther branch begins, "
            f"which load.largest_volume above {multiple:g} follows; or ask for less than the limit pressure"
        )
    return Cause.LIMIT_POINT, (
        f"{limit}, nor does the pressure rise again, {1e3 * here.pressure_mpa:.6g} kPa there and falling: ask for less "
        "than the limit pressure"
    )
