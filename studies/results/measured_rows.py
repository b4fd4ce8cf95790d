"""Rows of what was measured in a bellows' axisymmetric states, beside what the closed form says of the same."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from scipy.interpolate import PchipInterpolator

from analytical.bellows.chains import closed_form
from analytical.bellows.dimensions import BellowsError
from analytical.bellows.loads import held_tip
from studies.planning.levels import fineness
from studies.results.measures import UNITS, Measured, find_places, measure
from studies.results.rows import Row, row
from studies.results.run_files import load_state
from studies.results.runs import MERIDIAN_ORDERS, Run, run_convergence
from studies.scene.bellows import BellowsScene, dimensions_of
from studies.scene.materials import law_of


def unfolding_pressure(pressures_kpa: Sequence[float], bulges_mm: Sequence[float], fold_mm: float) -> float:
    """Pressure at which a bulge, 0 without pressure, first reaches the depth of the folds, kPa; NaN if it does not.

    Between the pressures the bulge is interpolated monotonically (PCHIP); the answer is between the two that enclose
    it whatever the interpolation. On the reference actuators steps of 2.5 and of 5 kPa differ by 0.5 % at most.
    """
    if not pressures_kpa:
        return math.nan
    bulge = PchipInterpolator([0.0, *pressures_kpa], [0.0, *bulges_mm])
    return min((float(p) for p in bulge.solve(fold_mm, extrapolate=False)), default=math.nan)


def model_values(scene: BellowsScene, pressure_kpa: float) -> dict[str, float]:
    """What the closed form says of the measured quantities, as far as it says anything.

    At a blocked tip its roots open as at a free one; with a force on the tip it does not know the wall's stretch.
    """
    dimensions, law = dimensions_of(scene), law_of(scene.material)
    try:
        free = closed_form(dimensions, law, pressure_kpa)
        wall = held_tip(dimensions, law, pressure_kpa).wall_stretch if scene.blocked else free.wall_stretch
    except BellowsError:
        return {}
    outer, inner = float(free.root_stretch[0]), float(free.root_inner_stretch[0])
    found = {
        "root_stretch_outer": outer,
        "root_stretch_inner": inner,
        "root_bulge_mm": (outer - 1.0) * (dimensions.root_radius_mm + dimensions.wall_mm),
        "wall_hoop_stretch_middle": 1.0,
        "ring_hoop_stretch": 1.0,
        "unfolding_kpa": float(free.unfolding_pressure_kpa[0]),
    }
    if not scene.load.tip_force_n:
        largest = max(inner, float(wall[0]))
        found |= {"wall_stretch": float(wall[0]), "peak_stretch": largest, "peak_stretch_away": largest}
    return found


@dataclass(frozen=True)
class _Entry:
    """A run's value of a quantity."""

    run: Run
    value: float
    status: str = "reached"
    place: str = ""


def measured_rows(scene: BellowsScene, runs: Sequence[Run], folder: Path) -> list[Row]:
    """Rows of what the states of a scene's axisymmetric runs were measured for, beside the closed form's values.

    Parameters
    ----------
    runs
        Coarsest first; their saved states are in ``folder / "axisymmetric-<level>"``.

    Returns
    -------
    list of Row
        For each requested pressure that any level reached; then ``unfolding_kpa`` without a pressure, NaN with its
        status where the highest requested state is short of it. The uncertainty is that of the meshes; that of
        interpolating ``unfolding_kpa`` between the requested pressures comes on top. Errors are against the finest
        level that has the value. Of that level's own peaks, which are compared with nothing, ``source`` says where
        they are.
    """
    states = [_measured_run(scene, run, folder) for run in runs]
    rows = []
    for pressure in scene.load.pressure_kpa:
        model = model_values(scene, pressure)
        for quantity in UNITS:
            found = [
                _Entry(run, at[pressure].values[quantity], place=at[pressure].peak_in.get(quantity, ""))
                for run, at in zip(runs, states, strict=True)
                if pressure in at and quantity in at[pressure].values
            ]
            rows += _compared(scene.name, quantity, UNITS[quantity], pressure, found, model.get(quantity))
    unfolding = [_unfolding(scene, run, at) for run, at in zip(runs, states, strict=True)]
    model = model_values(scene, scene.load.pressure_kpa[0])
    return rows + _compared(scene.name, "unfolding_kpa", "kPa", math.nan, unfolding, model.get("unfolding_kpa"))


def _measured_run(scene: BellowsScene, run: Run, folder: Path) -> dict[float, Measured]:
    """What was measured in a run's states, by requested pressure, kPa."""
    places = find_places(scene, fineness(run.summary.level))
    found = {}
    for pressure in scene.load.pressure_kpa:
        saved = load_state(folder / f"axisymmetric-{run.summary.level}", run.summary.content_hash, 1e-3 * pressure)
        if saved is not None:
            found[pressure] = measure(scene, places, saved[0])
    return found


def _unfolding(scene: BellowsScene, run: Run, states: Mapping[float, Measured]) -> _Entry:
    pressures = sorted(states)
    fold = scene.geometry.crest_radius_mm - scene.geometry.root_radius_mm
    value = unfolding_pressure(pressures, [states[p].values["root_bulge_mm"] for p in pressures], fold)
    highest = pressures[-1] if pressures else 0.0
    return _Entry(run, value, f"not reached up to {highest:g} kPa" if math.isnan(value) else "reached")


def _compared(
    scene: str, quantity: str, unit: str, pressure: float, found: Sequence[_Entry], model: float | None
) -> list[Row]:
    """Rows of a quantity at a pressure: the closed form's, if it has one, and those of the levels."""
    reached = [entry for entry in found if not math.isnan(entry.value)]
    finest = reached[-1] if reached else None
    compared = (finest.value, f"axisymmetric {finest.run.summary.level}") if finest else (math.nan, "")
    bound = run_convergence([e.run for e in found], [e.value for e in found], MERIDIAN_ORDERS)
    rows = []
    if found and model is not None:
        reference, source = compared
        rows.append(row(scene, quantity, unit, pressure, "closed_form", model, reference=reference, source=source))
    for entry in found:
        against = (math.nan, entry.place) if entry is finest else compared
        at = (scene, quantity, unit, pressure, "axisymmetric", entry.value, entry.run.summary.level)
        rows.append(row(*at, bound.uncertainty(entry.value), *against, entry.status))
    return rows
