"""Paths of a cell's body to its loads, and where they end: pressure in the cavity, or the cavity evacuated."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solvers.equilibrium.controls import HeldLoad, HeldVolume
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from solvers.state import State, combine
from studies.stability.bodies import Posed
from studies.stability.cells import Bellows, Cell

# A vacuum is brought on in steps of this share of the volume, halved at most so often.
VACUUM_STEP, VACUUM_HALVINGS = 0.01, 8


@dataclass(frozen=True)
class End:
    """Where a path ended: with a value at the requested load if that was reached, else with cause and reason."""

    reached_kpa: float
    value_mm: float = math.nan
    pressure_error_percent: float = math.nan
    unstable: int = -1
    cause: str = ""
    reason: str = ""


def ends(cell: Cell, posed: Posed, loads_kpa: Sequence[float]) -> list[End]:
    """Ends of a path at ascending loads (of a vacuum: its size), solved as a cell says."""
    factor = Factor(posed.problem)
    if cell.load_kpa < 0.0 and isinstance(cell.body, Bellows):
        found, stop = _Evacuation(posed, factor, _settings(cell).newton).run(loads_kpa)
    else:
        found, stop = _inflate(posed, factor, _settings(cell), loads_kpa)
    factor.close()
    return found + [stop] * (len(loads_kpa) - len(found))


def _settings(cell: Cell) -> PathSettings:
    newton = NewtonSettings(relative_tolerance=cell.tolerance)
    usual = PathSettings(control=cell.control, newton=newton)
    if not cell.leap:
        return usual
    return dataclasses.replace(
        usual,
        start_control="volume" if cell.control == "volume" else "pressure",
        first_step=cell.leap * usual.first_step,
        largest_step=max(cell.leap * usual.first_step, usual.largest_step),
        first_pressure_step=1.0,
        largest_pressure_step=1.0,
    )


def _inflate(posed: Posed, factor: Factor, settings: PathSettings, loads_kpa: Sequence[float]) -> tuple[list[End], End]:
    """Ends at the loads that were reached, and the one of the others."""
    path = follow_path(posed.problem, factor, [1e-3 * p for p in loads_kpa], settings)
    highest = max((1e3 * s.state.load_mpa for s in path.states), default=0.0)
    requested = [s for s in path.states if s.asked]
    found = [
        End(kpa, posed.value_mm(s.state), posed.pressure_error_percent(s.state), _unstable(s.newton.excess_negatives))
        for s, kpa in zip(requested, loads_kpa, strict=False)
    ]
    return found, End(highest, cause=str(path.cause), reason=path.reason)


def _unstable(excess: int | None) -> int:
    return -1 if excess is None else excess


class _Evacuation:
    """The path of a cavity that is evacuated, which scenes do not ask for: steps of falling volume.

    It ends where the vacuum has a largest value, as what comes after is another shape of the body, and where rings have
    moved together by the room between them.
    """

    def __init__(self, posed: Posed, factor: Factor, newton: NewtonSettings) -> None:
        self.posed, self.problem, self.factor, self.newton = posed, posed.problem, factor, newton
        self.problem.set_state(self.problem.zero_state())
        self.unit = self.problem.volume_unit_mm3
        # state and volume of the last two steps
        self.here = self.before = (self.problem.get_state(), self.problem.cavity_volume())
        self.found: list[End] = []

    @property
    def reached_kpa(self) -> float:
        """Vacuum so far."""
        return -1e3 * self.here[0].load_mpa

    def run(self, loads_kpa: Sequence[float]) -> tuple[list[End], End]:
        """Ends at the vacua that were reached, and the one of the others."""
        step = VACUUM_STEP * self.unit
        while True:
            try:
                state, volume = self._advance(step)
                if self._room_mm(state) <= 0.0:
                    why = f"rings touch beyond {self.reached_kpa:.4g} kPa; these runs are without contact"
                    return self._stopped("contact", why)
                self._pass(state, volume, loads_kpa)
            except StepFailed as failure:
                step *= 0.5
                if step < self.unit * VACUUM_STEP / 2**VACUUM_HALVINGS:
                    return self._stopped(str(failure.cause), str(failure))
                continue
            if len(self.found) == len(loads_kpa):
                return self._stopped("", "")
            if state.load_mpa >= self.here[0].load_mpa:
                why = (
                    f"limit point of the vacuum near {self.reached_kpa:.4g} kPa, at "
                    f"{100.0 * self.here[1] / self.unit:.3g} % of the volume: beyond it the bellows folds in by itself"
                )
                return self._stopped(str(Cause.LIMIT_POINT), why)
            self.before, self.here = self.here, (state, volume)

    def _stopped(self, cause: str, reason: str) -> tuple[list[End], End]:
        return self.found, End(self.reached_kpa, cause=cause, reason=reason)

    def _advance(self, step: float) -> tuple[State, float]:
        """The state with so much less volume, from a guess along the last step."""
        volume = self.here[1] - step
        span = self.here[1] - self.before[1]
        ahead = (volume - self.here[1]) / span if span else 0.0
        self.problem.set_state(combine([self.here[0], self.before[0]], [1.0 + ahead, -ahead]))
        solve_equilibrium(self.problem, self.factor, self.newton, HeldVolume(volume))
        return self.problem.get_state(), volume

    def _room_mm(self, state: State) -> float:
        """Least room between rings."""
        return self.posed.room_mm + float(np.diff(state.bodies_mm[:, 0]).min())

    def _pass(self, state: State, volume: float, loads_kpa: Sequence[float]) -> None:
        """Note the requested vacua between here and a state further on."""
        vacuum_kpa = -1e3 * state.load_mpa
        for kpa in loads_kpa[len(self.found) :]:
            if vacuum_kpa < kpa:
                break
            part = (kpa - self.reached_kpa) / (vacuum_kpa - self.reached_kpa)
            self.problem.set_state(combine([self.here[0], state], [1.0 - part, part]))
            report = solve_equilibrium(self.problem, self.factor, self.newton, HeldLoad(-1e-3 * kpa))
            if not volume - 1e-6 * self.unit <= self.problem.cavity_volume() <= self.here[1] + 1e-6 * self.unit:
                raise StepFailed("pressure control left the path")
            value_mm = self.posed.value_mm(self.problem.get_state())
            self.found.append(End(kpa, value_mm, unstable=_unstable(report.excess_negatives)))
