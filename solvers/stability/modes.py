"""Which harmonics of the angle an axisymmetric path is unstable in, where it became so, and the shapes of the modes.

Of a body of revolution in three dimensions the count of unstable modes is that of m = 0 and twice those of m >= 1, each
of which can be turned by a quarter of its wave.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from solvers.equilibrium.controls import HeldLoad, HeldVolume
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import SolverError, StepFailed
from solvers.linear.factor import Factor
from solvers.linear.inverse_iteration import softest_mode
from solvers.paths.bisection import narrow
from solvers.paths.states import PathPoint, point_now
from solvers.problem import Problem
from solvers.stability.harmonics import Harmonics, Shape
from solvers.state import State, combine

WAVES = tuple(range(7))
# Parts of the way that are tried in turn where Newton fails half-way.
SHARES = (0.5, 0.25, 0.1)
# The interval shrinks at least this much, also where the pressure is flat: at a limit point.
LEAST_SHRINKING = 1e-2


@dataclass(frozen=True)
class ModeCrossing:
    """Where along an axisymmetric path the number of unstable modes of a harmonic changes first.

    Attributes
    ----------
    waves
        The harmonic m.
    pressure_mpa, within_mpa
        Pressure, and half the distance between the last state before and the first after.
    volume_mm3
        Volume.
    before, after
        Unstable modes of the harmonic on the two sides; m >= 1 count once.
    state, shape
        The state there, and the critical mode, 1 mm at most; None if it could not be computed.
    """

    waves: int
    pressure_mpa: float
    within_mpa: float
    volume_mm3: float
    before: int
    after: int
    state: State
    shape: Shape | None


class ModeCounter:
    """Counts and shapes of the modes of an axisymmetric problem's states; one symbolic analysis for all harmonics.

    Parameters
    ----------
    problem
        A problem on a meridian, on one rank; its state is changed.
    waves
        Harmonics to count.

    Raises
    ------
    SolverError
        See `solvers.stability.harmonics.Harmonics`.
    """

    def __init__(self, problem: Problem, waves: Sequence[int] = WAVES) -> None:
        self.problem, self.waves = problem, tuple(waves)
        self.harmonics = Harmonics(problem)
        self.factor = Factor(self.harmonics)

    def count(self, state: State, waves: int) -> int:
        """Unstable modes of a harmonic at held pressure about a converged state.

        Raises
        ------
        StepFailed
            If the factorisation fails.
        SolverError
            If fewer negative pivots come out than there are pressures: then the state is none, or the mesh is bad.
        """
        self.problem.set_state(state)
        self.harmonics.select(waves)
        self.factor.refresh()
        found = self.factor.excess_negatives
        if found is None or found < 0:
            raise SolverError(
                f"harmonic m = {waves}: {self.factor.negatives} negative pivots, at least "
                f"{self.harmonics.expected_negatives} expected: is the state an equilibrium? refine the mesh"
            )
        return found

    def counts(self, state: State) -> tuple[int, ...]:
        """Unstable modes of each harmonic at held pressure; see `count`."""
        return tuple(self.count(state, m) for m in self.waves)

    def shape(self, state: State, waves: int) -> Shape:
        """The mode of a harmonic whose stiffness is closest to zero, 1 mm at most.

        Raises
        ------
        StepFailed, SolverError
            As from `count`, or if the mode cannot be computed.
        """
        self.count(state, waves)
        h = self.harmonics
        mode = softest_mode(self.factor, np.random.default_rng(29).standard_normal(h.owned))
        raw = h.shape_of(mode.dofs, mode.bodies)
        # the sign of an eigenvector is nobody's: its largest component is made positive
        largest = raw.amplitude_mm.flat[np.argmax(np.abs(raw.amplitude_mm))]
        return Shape(waves, raw.amplitude_mm / largest, raw.bodies_mm / largest)

    def close(self) -> None:
        """Free the matrix and its factors."""
        self.factor.close()


def mode_crossings(
    counter: ModeCounter,
    factor: Factor,
    points: Sequence[PathPoint],
    counts: Sequence[tuple[int, ...]],
    tolerance: float = 1e-3,
) -> list[ModeCrossing]:
    """Where along an axisymmetric path the count of each harmonic changes first, located by bisection.

    Parameters
    ----------
    counter, factor
        Of the path's problem; the problem's state is spoilt.
    points, counts
        Converged states in the path's order, and the counts of the counter's harmonics at each.
    tolerance
        Pressures of the two states around a crossing differ by less than this share.

    Returns
    -------
    list of ModeCrossing
        At most one for each harmonic, in the order of the path; where a solve fails ``within_mpa`` is as wide as the
        interval stayed.

    Raises
    ------
    SolverError
        See `ModeCounter.count`.
    """
    found = []
    for k, waves in enumerate(counter.waves):
        of_harmonic = [count[k] for count in counts]
        place = next((i for i in range(1, len(points)) if of_harmonic[i] != of_harmonic[i - 1]), None)
        if place is not None:
            before, after = (replace(points[i], unstable=of_harmonic[i]) for i in (place - 1, place))
            found.append((place, _locate(counter, factor, waves, before, after, tolerance)))
    # a volume may come twice, a place may have several harmonics
    return [crossing for _, crossing in sorted(found, key=lambda pair: (pair[0], pair[1].volume_mm3))]


def _locate(
    counter: ModeCounter,
    factor: Factor,
    waves: int,
    before: PathPoint,
    after: PathPoint,
    tolerance: float,
) -> ModeCrossing:
    """The first change of a harmonic's count between two states, which carry its counts."""

    def part_way(low: PathPoint, high: PathPoint) -> tuple[float, PathPoint] | None:
        step = _between(counter.problem, factor, low, high)
        if step is None:
            return None
        share, middle = step
        try:
            return share, replace(middle, unstable=counter.count(middle.state, waves))
        except StepFailed:
            return None

    low, high = narrow(before, after, part_way, tolerance, LEAST_SHRINKING)
    assert before.unstable is not None and high.unstable is not None
    try:
        shape = counter.shape(high.state, waves)
    except StepFailed:
        shape = None
    return ModeCrossing(
        waves,
        0.5 * (low.pressure_mpa + high.pressure_mpa),
        0.5 * abs(high.pressure_mpa - low.pressure_mpa),
        0.5 * (low.volume_mm3 + high.volume_mm3),
        before.unstable,
        high.unstable,
        high.state,
        shape,
    )


def _between(problem: Problem, factor: Factor, low: PathPoint, high: PathPoint) -> tuple[float, PathPoint] | None:
    """Part of the way and the equilibrium there between two states, by volume; None if Newton fails."""
    settings = NewtonSettings()
    moves = abs(high.volume_mm3 - low.volume_mm3) > 1e-9 * problem.volume_unit_mm3
    for share in SHARES:
        problem.set_state(combine([low.state, high.state], [1.0 - share, share]))
        volume = low.volume_mm3 + share * (high.volume_mm3 - low.volume_mm3)
        pressure = low.pressure_mpa + share * (high.pressure_mpa - low.pressure_mpa)
        try:
            report = solve_equilibrium(problem, factor, settings, HeldVolume(volume) if moves else HeldLoad(pressure))
        except StepFailed:
            continue
        return share, point_now(problem, report)
    return None
