"""Control by arc length: steps along the path where neither the pressure nor the volume rises all the way.

Distances between states are measured in the space of displacements and load factor, each by its own scale,

    |x - y|^2 = mean |u_x - u_y|^2 / c_u^2 + (P_x - P_y)^2 / c_P^2,

with the mean over nodes; pressures in the solid and motions of rigid bodies follow from the displacements. A step looks
for equilibrium in the plane through the extrapolated state x* that is normal to the way to it from the last one, x0:

    <x* - x0, x - x*> = 0

(Riks 1979, doi 10.1016/0020-7683(79)90081-7, with a normal plane that stays). The way comes from states that lie behind
on the path, so it never points back, and the border costs a second solve with the same factor, as a held volume does
(`solvers.equilibrium.controls`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solvers.discrete.sums import dot
from solvers.equilibrium.controls import HeldPlane
from solvers.errors import StepFailed
from solvers.paths.states import PathPoint
from solvers.problem import Problem
from solvers.state import State

# A solution further from where it was expected than this share of the step may lie on another part of the path, or on
# another one: two spheres on one cavity have branches a step of 0.25 apart (tests/solvers/paths/test_arc_length.py).
FARTHEST = 0.25
# A volume that falls short by so many failed steps of where dV/dP is going to vanish is taken to turn back there.
TURN_WITHIN = 3.0


@dataclass(frozen=True)
class Scale:
    """What differences of displacements and of the load factor are measured by, mm and MPa."""

    displacement_mm: float
    pressure_mpa: float


def scale_of(problem: Problem, highest_mpa: float) -> Scale:
    """The scale of a path to a pressure: that pressure, and the edge of a cube as large as the unloaded cavity.

    Where the load encloses no volume, the body's own counts (`Problem.volume_unit_mm3`).
    """
    return Scale(float(np.cbrt(problem.volume_unit_mm3)), abs(highest_mpa))


def distance(a: State, b: State, scale: Scale) -> float:
    """Distance of two states."""
    return float(np.sqrt(_product(a, b, a, b, scale)))


def _product(a: State, b: State, c: State, d: State, scale: Scale) -> float:
    """<b - a, d - c>."""
    moved = np.sum((b.displacement_mm - a.displacement_mm) * (d.displacement_mm - c.displacement_mm))
    by_load = (b.load_mpa - a.load_mpa) * (d.load_mpa - c.load_mpa) / scale.pressure_mpa**2
    return float(moved / len(a.displacement_mm) / scale.displacement_mm**2 + by_load)


def plane_at(problem: Problem, here: State, guess: State, scale: Scale) -> HeldPlane:
    """The plane through a guess, normal to the way to it; the problem is left at the guess."""
    problem.set_state(here)
    start = problem.state.x.array[: problem.owned].copy()
    problem.set_state(guess)
    through = problem.state.x.array[: problem.owned].copy()
    free = ~(problem.owned_pressure | problem.constrained_owned)
    way = (through - start) * free
    normal = way / (problem.domain.nodes * scale.displacement_mm**2)
    by_load = (guess.load_mpa - here.load_mpa) / scale.pressure_mpa**2
    length = dot(problem.comm, normal, way) + by_load * (guess.load_mpa - here.load_mpa)
    return HeldPlane(normal, by_load, through, guess.load_mpa, float(np.sqrt(length)))


def refuse_far(guess: State, new: State, size: float, scale: Scale) -> None:
    """Refuse a solution that lies far from where it was expected, for the size of the step.

    The guess lies ahead on the way that the path has gone, so what is near it is no way back either.

    Raises
    ------
    StepFailed
        With the distance.
    """
    off = distance(guess, new, scale)
    if off > FARTHEST * size:
        raise StepFailed(f"a step of arc length {size:.3g} ended {off:.3g} from where it was expected")


def volume_turns_back(history: Sequence[PathPoint], step_mm3: float) -> bool:
    """True if the volume is about to stop growing: dV/dP goes to zero within a few of the steps that failed.

    Near such a state the volume is a parabola of the pressure, so that (dV/dP)^2 falls linearly with the volume.
    """
    if len(history) < 2:
        return False
    a, b = history[-2:]
    fall = a.compliance_mm3_per_mpa**2 - b.compliance_mm3_per_mpa**2
    grown = b.volume_mm3 - a.volume_mm3
    if not (fall > 0.0 and grown > 0.0):
        return False
    return b.compliance_mm3_per_mpa**2 * grown / fall <= TURN_WITHIN * step_mm3


def refuse_jump(here: PathPoint, new: PathPoint) -> None:
    """Refuse a step in volume that ended on another branch, beyond a place where the volume turns back.

    On one branch the pressure changes by the integral of dP/dV, also past a bifurcation. A step whose end has another
    number of unstable modes at held volume and whose pressure differs from the trapezoidal rule by more than half of
    the larger of the two is not taken; smaller steps tell which it was.

    Raises
    ------
    StepFailed
        With both changes of the pressure.
    """
    if math.isnan(here.compliance_mm3_per_mpa) or here.unstable_at_volume == new.unstable_at_volume:
        return
    change = new.pressure_mpa - here.pressure_mpa
    by_slope = 0.5 * (here.slope_mpa_per_mm3 + new.slope_mpa_per_mm3) * (new.volume_mm3 - here.volume_mm3)
    off = abs(change - by_slope)
    if off > 0.5 * max(abs(change), abs(by_slope)) and off > 1e-3 * abs(new.pressure_mpa):
        raise StepFailed(
            f"a step in volume ended on another branch: unstable modes at held volume {here.unstable_at_volume} -> "
            f"{new.unstable_at_volume}, and the pressure changed by {1e3 * change:.3g} kPa where its slopes make "
            f"{1e3 * by_slope:.3g}"
        )
