"""What path following works with and hands out: settings, converged states, crossings, and what a restart needs."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

from solvers.equilibrium.forces import end_force, reaction
from solvers.equilibrium.newton import NewtonReport, NewtonSettings, at_held_volume
from solvers.errors import Cause
from solvers.problem import Problem
from solvers.state import State

ControlName = Literal["pressure", "volume", "arc"]
Progress = Callable[[str, float, int, float], None]


@dataclass(frozen=True)
class PathSettings:
    """Step control.

    Attributes
    ----------
    control
        ``pressure``, ``volume`` or ``arc`` (length, see solvers.paths.arc): what the steps are taken in; ``auto``
        starts with ``start_control`` and changes between the first two where one fails or comes near its limits, and
        to the third where the volume turns back.
    start_control
        Pressure or volume: the one that needs fewer factorisations where both work; docs/decisions.md has the count.
    first_step, largest_step
        Volume steps as fractions of the unloaded volume.
    largest_share
        Beyond a limit point, and where the volume has grown tenfold, a step in volume may be this share of it: a
        balloon may have to grow hundredfold until its pressure has risen again, or to show that it never comes to the
        one that is asked.
    first_pressure_step, largest_pressure_step
        Pressure steps as fractions of the highest asked pressure; arc length begins with one of them.
    largest_arc_step
        Arc length of a step, in the scale of `solvers.paths.arc.scale_of`.
    smallest_step
        Below this fraction, of the same, the path is given up.
    few_iterations, many_iterations
        The step grows by ``growth`` at or below the first, shrinks by ``shrink`` above the second.
    soft
        Pressure control is left when dP/dV falls below this share of the largest met, and taken up again above twice
        that share.
    largest_volume
        The path ends when the cavity exceeds this multiple of its unloaded volume.
    crossing_tolerance
        A change of the number of unstable modes is located to this share of the pressure; 0 leaves it unlocated.
    newton
        Settings of each solve.
    """

    control: Literal["auto", "pressure", "volume", "arc"] = "auto"
    start_control: ControlName = "volume"
    first_step: float = 0.3
    largest_step: float = 0.5
    largest_share: float = 0.1
    first_pressure_step: float = 0.05
    largest_pressure_step: float = 0.5
    largest_arc_step: float = 0.25
    smallest_step: float = 1e-4
    few_iterations: int = 6
    many_iterations: int = 8
    growth: float = 1.5
    shrink: float = 0.6
    soft: float = 0.1
    largest_volume: float = 40.0
    crossing_tolerance: float = 1e-5
    newton: NewtonSettings = field(default_factory=NewtonSettings)


@dataclass(frozen=True)
class PathState:
    """A converged state of a path.

    Attributes
    ----------
    state
        Fields in the caller's numbering.
    asked
        True if the pressure was one of the asked ones.
    control
        ``pressure``, ``volume`` or ``arc``: which was held in the solve.
    volume_mm3, energy_mj, reaction_n
        Enclosed volume, stored energy, axial support force.
    end_force_n
        Axial force on what holds or loads the other end, see `solvers.equilibrium.forces.end_force`.
    bond_slip_mm
        Root mean square slip of the bond to rigid bodies, weighted with its grade; NaN without bodies.
    newton
        Cost and checks of the solve.
    wall_s
        Seconds since the path began.
    limit_mpa
        Pressure of the limit point that the path has passed: under a rising pressure the body snaps from there to this
        state or one like it. NaN on the branch that begins at rest.
    """

    state: State
    asked: bool
    control: ControlName
    volume_mm3: float
    energy_mj: float
    reaction_n: float
    end_force_n: float
    bond_slip_mm: float
    newton: NewtonReport
    wall_s: float
    limit_mpa: float = math.nan


def record(problem: Problem, report: NewtonReport, asked: bool, control: ControlName, start: float) -> PathState:
    """The problem's current state as a converged state of a path that began at ``start`` (perf_counter)."""
    return PathState(
        state=problem.get_state(),
        asked=asked,
        control=control,
        volume_mm3=problem.cavity_volume(),
        energy_mj=problem.energy(),
        reaction_n=reaction(problem),
        end_force_n=end_force(problem),
        bond_slip_mm=float("nan") if problem.bonded is None else problem.bonded.rms_slip_mm(),
        newton=report,
        wall_s=time.perf_counter() - start,
    )


@dataclass(frozen=True)
class PathPoint:
    """What of a converged state decides the steps after it.

    Attributes
    ----------
    state
        Fields in the caller's numbering.
    volume_mm3
        Its volume.
    compliance_mm3_per_mpa
        dV/dP of the path there; NaN in the unloaded state, where it has not been computed.
    unstable
        Unstable modes at held pressure; None if not counted.
    rate
        Change of the state with the load factor along the path, 1/MPa; None if not known.
    """

    state: State
    volume_mm3: float
    compliance_mm3_per_mpa: float
    unstable: int | None
    rate: State | None = None

    @property
    def pressure_mpa(self) -> float:
        """Load factor."""
        return self.state.load_mpa

    @property
    def slope_mpa_per_mm3(self) -> float:
        """dP/dV; zero at a limit point, infinite where the volume does not respond."""
        compliance = self.compliance_mm3_per_mpa
        return 1.0 / compliance if compliance != 0.0 else math.inf

    @property
    def unstable_at_volume(self) -> int | None:
        """Unstable modes at held volume."""
        return at_held_volume(self.unstable, self.compliance_mm3_per_mpa)


def point_of(item: PathState) -> PathPoint:
    """The part of a converged state that decides later steps."""
    report = item.newton
    return _point(item.state, item.volume_mm3, report)


def point_now(problem: Problem, report: NewtonReport) -> PathPoint:
    """The same of the problem's current state, which a solve has just found."""
    return _point(problem.get_state(), problem.cavity_volume(), report)


def _point(state: State, volume_mm3: float, report: NewtonReport) -> PathPoint:
    return PathPoint(state, volume_mm3, report.compliance_mm3_per_mpa, report.excess_negatives, report.rate)


@dataclass(frozen=True)
class Crossing:
    """Where along a path the number of unstable modes changed first.

    Attributes
    ----------
    kind
        LIMIT_POINT: the pressure has an extremum and the count at held volume stays; BIFURCATION: it changes there too.
    pressure_mpa, within_mpa
        Pressure, and half the distance between the last state before and the first after.
    volume_mm3
        Volume.
    modes_before, modes_after
        Unstable modes at held pressure on the two sides.
    state, mode
        The state there, and the critical mode as displacements with 1 mm at most (its ``load_mpa`` is the critical
        pressure); None when only the numbers were kept, or the mode could not be computed.
    of_class
        Of a part of a body between planes of symmetry, the parity class that the mode belongs to
        (`solvers.stability.parity`), whose motions its bodies have; else empty.
    """

    kind: Cause
    pressure_mpa: float
    within_mpa: float
    volume_mm3: float
    modes_before: int
    modes_after: int
    state: State | None = None
    mode: State | None = None
    of_class: str = ""


@dataclass(frozen=True)
class Path:
    """A path and how it ended.

    Attributes
    ----------
    states
        Converged states in order (of this process; a resumed path has the later ones).
    reached
        True if all asked pressures were reached.
    cause, reason
        Why it stopped, if not reached, as a kind and in words.
    rejected
        Number of steps given up and repeated smaller.
    crossing
        Where stability was lost, if it was.
    """

    states: tuple[PathState, ...]
    reached: bool
    reason: str
    rejected: int
    cause: Cause = Cause.REACHED
    crossing: Crossing | None = None


@dataclass(frozen=True)
class PathMemory:
    """All that a path needs to go on after its last converged state as if it had not been interrupted.

    Attributes
    ----------
    history
        The last converged states, at most three, the last one last.
    control, step
        The control in force and its next step, mm^3, MPa or arc length.
    reached
        Number of asked pressures reached.
    rejected
        Steps given up so far.
    stiffest_mpa_per_mm3
        Largest dP/dV met.
    crossing
        Where stability was lost; a memory read from a file has the numbers only.
    limit_mpa
        Pressure from which the path's pressure has first fallen; NaN as long as it rises.
    """

    history: tuple[PathPoint, ...]
    control: ControlName
    step: float
    reached: int
    rejected: int
    stiffest_mpa_per_mm3: float
    crossing: Crossing | None
    limit_mpa: float = math.nan


@dataclass(frozen=True)
class GuessMemory:
    """The same for a path along given first guesses.

    Attributes
    ----------
    last, guess
        The last converged state, and the guess it came from.
    reached
        Number of guesses reached.
    share
        Part of the way to the next guess that is tried next.
    rejected, crossing
        As in PathMemory.
    """

    last: PathPoint
    guess: State
    reached: int
    share: float
    rejected: int
    crossing: Crossing | None
