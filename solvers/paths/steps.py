"""Steps of a path: where the next one goes, its solve, and how size and control change after it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from solvers.equilibrium.controls import Control, HeldLoad, HeldVolume
from solvers.equilibrium.newton import solve_equilibrium
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.arc import plane_at, refuse_far, refuse_jump, scale_of, volume_turns_back
from solvers.paths.crossing import locate_crossing, lost_stability
from solvers.paths.onset import go_to_rest
from solvers.paths.prediction import coordinates, extrapolate, peak, place_of_pressure, predicted_pressure
from solvers.paths.states import (
    ControlName,
    Crossing,
    PathMemory,
    PathPoint,
    PathSettings,
    PathState,
    Progress,
    point_now,
    point_of,
    record,
)
from solvers.problem import Problem
from solvers.state import State

# A pressure that is lower by more than this share of the highest asked one has fallen.
FALL = 1e-6
# Solves for a peak of the pressure within a step, at most, and the share of its foreseen height above the states around
# it by which it may be higher than foreseen.
CLIMBS, CLIMB_MARGIN = 8, 0.25
# A change of the volume below this share of its unit says nothing.
RESPONDS = 1e-6


@dataclass
class Walk:
    """A path on its way: what `PathMemory` keeps, and the failures since the last converged state."""

    history: list[PathPoint]
    control: ControlName
    step: float
    reached: int
    rejected: int
    stiffest: float
    crossing: Crossing | None
    limit_mpa: float = math.nan
    failures: int = 0
    switched: bool = False
    softened: StepFailed | None = None

    @property
    def here(self) -> PathPoint:
        """The last converged state."""
        return self.history[-1]

    def memory(self) -> PathMemory:
        """What is needed to go on from here."""
        return PathMemory(
            tuple(self.history),
            self.control,
            self.step,
            self.reached,
            self.rejected,
            self.stiffest,
            self.crossing,
            self.limit_mpa,
        )


@dataclass(frozen=True)
class Aim:
    """The next solve: what is held at which value, how far that is in the walk's control, and if it was asked for."""

    control: ControlName
    value: float
    size: float
    asked: bool
    guess: State


# What counts as manifold growth of a volume.
MANIFOLD = 10.0


class Follower:
    """Settings and surroundings of one call of `follow_path`, so that its parts need not hand them on."""

    def __init__(
        self,
        problem: Problem,
        factor: Factor,
        targets: Sequence[float],
        settings: PathSettings,
        progress: Progress | None,
    ) -> None:
        self.problem, self.factor, self.targets = problem, factor, list(targets)
        self.settings, self.progress = settings, progress
        self.begin = time.perf_counter()
        self.scale = scale_of(problem, self.targets[-1])
        self.unit: dict[ControlName, float] = {
            "volume": problem.volume_unit_mm3,
            "pressure": self.targets[-1],
            "arc": settings.largest_arc_step,
        }
        self.largest: dict[ControlName, float] = {
            "volume": settings.largest_step * self.unit["volume"],
            "pressure": settings.largest_pressure_step * self.unit["pressure"],
            "arc": settings.largest_arc_step,
        }

    def largest_step(self, walk: Walk, control: ControlName) -> float:
        """Size of the largest step under a control; in volume a share of it beyond a limit point or manifold growth."""
        grown = walk.here.volume_mm3 - self.problem.volume_start_mm3
        far = not math.isnan(walk.limit_mpa) or grown > MANIFOLD * self.unit["volume"]
        return max(self.largest[control], self.settings.largest_share * grown if far and control == "volume" else 0.0)

    def first_step(self, control: ControlName) -> float:
        """Size of the first step under a control."""
        share = self.settings.first_step if control == "volume" else self.settings.first_pressure_step
        return share * self.unit[control]

    def start(self, accept: Callable[[PathState], bool] | None) -> Walk:
        """A walk from the state without pressure.

        Raises
        ------
        StepFailed
            If there is no such state under the dead force.
        """
        return self.walk_from(go_to_rest(self.problem, self.factor, self.settings.newton, accept), 0)

    def walk_from(self, point: PathPoint, reached: int) -> Walk:
        """A walk from a state, after so many asked pressures."""
        control = self.settings.start_control if self.settings.control == "auto" else self.settings.control
        if control == "arc":
            control = "pressure"  # for one step, which shows the way
        return Walk([point], control, self.first_step(control), reached, 0, 0.0, None)

    # ---- one step --------------------------------------------------------------------------------------

    def aim(self, walk: Walk) -> Aim:
        """Where the next step goes; an asked pressure that it would pass is solved for instead."""
        here, target = walk.here, self.targets[walk.reached]
        # where a step has failed, guesses of a high degree may lead astray
        past = walk.history if not walk.failures else [replace(p, rate=None) for p in walk.history]
        if walk.control == "pressure":
            left = target - here.pressure_mpa
            count = max(1, math.ceil(left / walk.step - 0.1))  # no sliver before the asked pressure
            value = target if count == 1 else here.pressure_mpa + left / count
            guess = extrapolate(past, "pressure", value, self.scale)
            return Aim("pressure", value, value - here.pressure_mpa, count == 1, guess)
        control, history = walk.control, past
        start = here.volume_mm3 if control == "volume" else 0.0
        end = start + walk.step
        foreseen = len(history) >= 3 and predicted_pressure(history, control, self.scale)(end) >= target
        if foreseen and target > here.pressure_mpa:
            end = place_of_pressure(history, control, start, end, target, self.scale)
            return Aim("pressure", target, end - start, True, extrapolate(history, control, end, self.scale))
        return Aim(control, end, walk.step, False, extrapolate(history, control, end, self.scale))

    def solve(self, aim: Aim, walk: Walk) -> PathState:
        """Equilibrium at an aim.

        Raises
        ------
        StepFailed
            Also if the solution lies behind the last state, or far from where it was expected: on another branch.
        """
        problem, settings = self.problem, self.settings.newton
        problem.set_state(aim.guess)
        what = "asked pressure" if aim.asked else f"{aim.control} step"
        shown = aim.guess.load_mpa
        seen = None if self.progress is None else (lambda k, e, p=self.progress: p(what, shown, k, e))
        control: Control = HeldLoad(aim.value)
        if aim.control == "volume":
            control = HeldVolume(aim.value)
        elif aim.control == "arc":
            control = plane_at(problem, walk.here.state, aim.guess, self.scale)
        report = solve_equilibrium(problem, self.factor, settings, control, seen)
        if aim.control == "pressure" and walk.control != "arc":
            self.stayed_on_the_path(walk, report.compliance_mm3_per_mpa)
        if walk.control == "arc":
            refuse_far(aim.guess, problem.get_state(), aim.size, self.scale)
        item = record(problem, report, aim.asked, aim.control, self.begin)
        if aim.control == "volume":
            refuse_jump(walk.here, point_of(item))
        return item

    def stayed_on_the_path(self, walk: Walk, compliance_mm3_per_mpa: float) -> None:
        """Refuse a solution at a pressure that lies behind the last state, beyond a peak or maybe a snap-through.

        Between two limit points the path turns back in pressure, and a step in pressure jumps over that part without
        a sign. So it may not change the volume by more than twice the largest step that volume control would take.
        """
        change = self.problem.cavity_volume() - walk.here.volume_mm3
        if change < -1e-9 * self.unit["volume"]:
            raise StepFailed("pressure control fell back to a smaller volume")
        if change > 2.0 * self.largest_step(walk, "volume"):
            raise StepFailed("a step in pressure changed the volume by more than could be followed")
        # where an asked pressure is met first it rises
        if change > RESPONDS * self.unit["volume"] and self.problem.conservative and compliance_mm3_per_mpa < 0.0:
            raise StepFailed("a step in pressure ended beyond a limit point, where the pressure falls")

    def step(self, walk: Walk, aim: Aim) -> list[PathState]:
        """The aimed-at state, and before it asked pressures that were passed without having been foreseen.

        Where the pressure peaks on the way and asked ones lie below the peak, the step ends near it instead.
        """
        last = self.solve(aim, walk)
        if aim.control == "pressure":
            return [last]
        last, around = self.climb(walk, aim, last)
        first, found = len(walk.history[-2:]), [last]
        passed = [p for p in self.targets[walk.reached :] if walk.here.pressure_mpa < p <= last.state.load_mpa]
        for pressure in reversed(passed):
            beyond = next(k for k in range(first, len(around)) if around[k].pressure_mpa >= pressure)
            near = around[max(beyond - 2, 0) : beyond + 1]
            start, end = coordinates(near, walk.control, self.scale)[-2:]
            place = place_of_pressure(near, walk.control, start, end, pressure, self.scale)
            guess = extrapolate(near, walk.control, place, self.scale)
            found.insert(0, self.solve(Aim("pressure", pressure, aim.size, True, guess), walk))
            around.insert(beyond, point_of(found[0]))
        # a step that went beyond the last asked pressure is not part of the answer
        return found[:-1] if walk.reached + len(passed) == len(self.targets) else found

    def climb(self, walk: Walk, aim: Aim, last: PathState) -> tuple[PathState, list[PathPoint]]:
        """Where a step ends: at its aim, or near a peak of the pressure on the way if an asked one is below that.

        The peak is foreseen from pressures and slopes of the closest states on both sides, and solved for, until it is
        above the asked pressure or known to be below.

        Returns
        -------
        tuple
            The last state; and in their order on the path up to two states before the step and all up to the last.
        """
        low, high = walk.here, point_of(last)
        rising = list(walk.history[-2:])
        around = [*rising, high]
        if walk.control == "arc" and low.unstable_at_volume != high.unstable_at_volume:
            return last, around  # the volume turns back
        if math.isnan(low.slope_mpa_per_mm3) and (high.slope_mpa_per_mm3 < 0.0 or high.pressure_mpa < low.pressure_mpa):
            self.problem.set_state(low.state)  # the unloaded one, whose slope nobody has needed yet
            held = HeldLoad(low.pressure_mpa)
            low = point_now(self.problem, solve_equilibrium(self.problem, self.factor, self.settings.newton, held))
        for _ in range(CLIMBS):
            found, reached = peak(low, high), max(low.pressure_mpa, high.pressure_mpa)
            asked = next((p for p in self.targets[walk.reached :] if p > reached), math.inf)
            if found is None or asked > found[1] + CLIMB_MARGIN * (found[1] - reached):
                break
            near = [*rising[-2:], high]
            start, end = coordinates(near, walk.control, self.scale)[-2:]
            place = start + found[0] * (end - start)
            guess = extrapolate(near, walk.control, place, self.scale)
            item = self.solve(Aim(walk.control, place, aim.size, False, guess), walk)
            new = point_of(item)
            if new.pressure_mpa >= asked:
                last, around = item, [*rising, new]
            if new.slope_mpa_per_mm3 * (high.volume_mm3 - low.volume_mm3) > 0.0:
                low = new
                rising.append(new)
            else:
                high = new
        return last, around

    # ---- after a step ----------------------------------------------------------------------------------

    def keep(self, walk: Walk, item: PathState) -> PathState:
        """Take a converged state into the walk; a change of its stability is located.

        Returns the state with the limit point that the path has passed.
        """
        new = point_of(item)
        if walk.crossing is None and self.settings.crossing_tolerance > 0.0 and lost_stability(walk.here, new):
            newton, tolerance = self.settings.newton, self.settings.crossing_tolerance
            along = self.scale if walk.control == "arc" else None
            walk.crossing = locate_crossing(self.problem, self.factor, newton, walk.here, new, tolerance, along)
        if math.isnan(walk.limit_mpa) and walk.here.pressure_mpa - new.pressure_mpa > FALL * self.unit["pressure"]:
            found = walk.crossing
            known = found is not None and found.kind is Cause.LIMIT_POINT
            walk.limit_mpa = found.pressure_mpa if found and known else walk.here.pressure_mpa
        # nearly coincident states would spoil the extrapolation
        while len(walk.history) > 1 and self.gone(walk.here, new, walk.control) < 0.05 * walk.step:
            walk.history.pop()
        walk.history.append(new)
        del walk.history[:-3]
        walk.reached += item.asked
        return replace(item, limit_mpa=walk.limit_mpa)

    def gone(self, here: PathPoint, new: PathPoint, control: ControlName) -> float:
        """From a state to another, in what the steps are taken in."""
        start, end = coordinates([here, new], control, self.scale)
        return end - start

    def adapt(self, walk: Walk, aim: Aim, iterations: int) -> None:
        """Step size, and with ``auto`` the control, after a step that worked."""
        settings = self.settings
        walk.failures, walk.switched, walk.softened = 0, False, None
        if settings.control == "arc" and walk.control != "arc":
            self._switch(walk, "arc")
            return
        if iterations > settings.many_iterations:
            walk.step *= settings.shrink
        elif iterations <= settings.few_iterations and (not aim.asked or aim.size >= 0.99 * walk.step):
            walk.step = min(walk.step * settings.growth, self.largest_step(walk, walk.control))
        if not self._volume_responds(walk):
            return  # dP/dV says nothing
        walk.stiffest = max(walk.stiffest, walk.here.slope_mpa_per_mm3)
        if settings.control != "auto":
            return
        if walk.control == "pressure":
            soft = walk.here.slope_mpa_per_mm3 < settings.soft * walk.stiffest
            if soft or walk.here.unstable or settings.start_control == "volume":
                self._switch(walk, "volume")
        elif settings.start_control == "pressure" and self._pressure_is_safe(walk, 2.0 * settings.soft):
            self._switch(walk, "pressure")

    def _pressure_is_safe(self, walk: Walk, share: float) -> bool:
        """Stable at held pressure and far from a limit point."""
        if len(walk.history) == 1:
            return True
        return not walk.here.unstable and walk.here.slope_mpa_per_mm3 > share * walk.stiffest

    def _volume_responds(self, walk: Walk) -> bool:
        """True if the last step changed the volume by more than what control by volume could not resolve."""
        change = walk.here.volume_mm3 - walk.history[-2].volume_mm3 if len(walk.history) > 1 else 0.0
        return change > RESPONDS * self.unit["volume"]

    def _switch(self, walk: Walk, control: ControlName) -> None:
        """Change the control; the step is as large as the last one was in the new measure."""
        walk.control = control
        size = self.gone(walk.history[0 if len(walk.history) == 1 else -2], walk.here, control)
        least = self.settings.smallest_step * self.unit[control]
        walk.step = min(size, self.largest_step(walk, control)) if size > least else self.first_step(control)

    def retry(self, walk: Walk, aim: Aim, failure: StepFailed) -> bool:
        """Make the next try after a failed step smaller or of the other kind; False if there is none left."""
        walk.rejected += 1
        if failure.cause is Cause.OUT_OF_MEMORY:
            return False
        walk.failures += 1
        if failure.cause is Cause.LAW_SOFTENS:
            walk.softened = failure  # another control would come to the same states
        elif self.settings.control == "auto" and not walk.switched and walk.softened is None:
            if walk.control == "pressure":
                walk.switched = True
                self._switch(walk, "volume")
                return True
            # against an obstacle a volume stops growing without turning back
            free = self.problem.contact is None
            if free and walk.control == "volume" and walk.failures > 2 and volume_turns_back(walk.history, aim.size):
                walk.switched = True
                self._switch(walk, "arc")
                return True
            hopeless = failure.cause is Cause.NO_RESPONSE or walk.failures > 2
            if hopeless and self._pressure_is_safe(walk, self.settings.soft):
                walk.switched = True
                self._switch(walk, "pressure")
                return True
        # a sheet stiffens so much in its first step that the way from rest is not that of the next: one more shows it
        from_rest = walk.control == "arc" and walk.history[0].pressure_mpa == 0.0
        if self.settings.control == "arc" and from_rest and walk.failures > 2 and not walk.switched:
            walk.switched = True
            self._switch(walk, "pressure")
            return True
        walk.step = 0.5 * min(walk.step, aim.size)
        return (
            failure.cause is not Cause.NO_RESPONSE
            and walk.step >= self.settings.smallest_step * self.unit[walk.control]
        )
