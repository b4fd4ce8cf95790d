"""What was found of a scene whose modes were counted, and its rows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

from solvers.stability.modes import WAVES
from studies.models.modes import COUNTED_LEVELS, FoundCrossing, counts_of
from studies.models.modes_model import ModesModel
from studies.results.body_rows import WITH_CORNERS
from studies.results.rows import REACHED, Row, row
from studies.results.runs import MERIDIAN_ORDERS, Run, stopped_text, value_status
from studies.results.uncertainty import UNKNOWN, Convergence, Orders, convergence
from studies.scene.bodies import BodyScene

# What rows have of a crossing: their name's end, which of its numbers, and the unit.
CROSSING: Final = (
    ("kpa", "pressure_kpa", "kPa"),
    ("volume_ratio", "volume_ratio", "1"),
    ("tip_mm", "tip_mm", "mm"),
    ("tip_force_n", "tip_force_n", "N"),
)


@dataclass(frozen=True)
class SceneModes:
    """What was found of a scene.

    Attributes
    ----------
    model
        The scene.
    runs
        Its counted runs, coarsest first.
    crossings
        By run.
    rows
        Its numbers.
    pictures
        Of the finest run's critical modes: crossing, and file relative to the study's folder.
    """

    model: ModesModel
    runs: Sequence[Run]
    crossings: Sequence[Sequence[FoundCrossing]]
    rows: Sequence[Row]
    pictures: Sequence[tuple[FoundCrossing, str]]

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self.model.scene.name

    @property
    def stops(self) -> list[str]:
        """Which runs did not reach their pressures and which states were not counted, a sentence each."""
        said = []
        for run in self.runs:
            label = f"{self.name}, {run.summary.level}"
            if run.summary.status != REACHED:
                said.append(f"{label}: {stopped_text(run)}")
            missing = [s.pressure_kpa for s in run.requested if not s.unstable_by_m]
            if missing:
                said.append(f"{label}: modes are not counted at {', '.join(f'{p:g}' for p in missing)} kPa")
        return said

    def crossing_row(self, waves: int, level: str) -> Row:
        """The row of a crossing's pressure."""
        return next(r for r in self.rows if (r.quantity, r.level) == (f"crossing_m{waves}_kpa", level))


def count_rows(model: ModesModel, runs: Sequence[Run]) -> list[Row]:
    """Unstable modes of each harmonic at each requested pressure."""
    rows = []
    for pressure, run in product(model.scene.loads_kpa, runs):
        state = run.at(pressure)
        counts = counts_of(state) if state else ()
        scene, level = model.scene.name, run.summary.level
        for m in WAVES:
            value = float(counts[m]) if counts else math.nan
            status = value_status(run, pressure, value, ".6g")
            rows.append(row(scene, f"unstable_m{m}", "1", pressure, "axisymmetric", value, level, status=status))
    return rows


def crossing_rows(model: ModesModel, runs: Sequence[Run], crossings: Sequence[Sequence[FoundCrossing]]) -> list[Row]:
    """Where each harmonic is lost, and the volume, elongation and force there; or that none is."""
    waves = sorted({c.waves for found in crossings for c in found})
    if not waves:
        return [_row(model, run, "crossing_kpa", "kPa", math.nan, status=_none_up_to(run)) for run in runs]
    rows = []
    orders = WITH_CORNERS if isinstance(model.scene, BodyScene) else MERIDIAN_ORDERS
    for m, (name, number, unit) in product(waves, CROSSING):
        of_m = [next((c for c in found if c.waves == m), None) for found in crossings]
        values = [float(getattr(c, number)) if c else math.nan for c in of_m]
        if all(math.isnan(v) for v in values):
            continue
        spread = _spread(values, orders)
        for run, crossing, value in zip(runs, of_m, values, strict=True):
            within = crossing.within_kpa if crossing and name == "kpa" else 0.0
            status = REACHED if crossing else _none_up_to(run)
            rows.append(
                _row(model, run, f"crossing_m{m}_{name}", unit, value, spread.uncertainty(value) + within, status)
            )
    return rows


def _row(
    model: ModesModel, run: Run, quantity: str, unit: str, value: float, uncertainty: float = math.nan, status: str = ""
) -> Row:
    level = run.summary.level
    return row(model.scene.name, quantity, unit, math.nan, "axisymmetric", value, level, uncertainty, status=status)


def _spread(values: Sequence[float], orders: Orders) -> Convergence:
    """What the counted meridians say of the discretisation's error."""
    if any(math.isnan(v) for v in values):
        return UNKNOWN
    return convergence([1.0 / level for level in COUNTED_LEVELS], values, orders)


def _none_up_to(run: Run) -> str:
    counted = [state.pressure_kpa for state in run.path if state.unstable_by_m]
    return f"none up to {max(counted, key=abs):.6g} kPa" if counted else "not counted"
