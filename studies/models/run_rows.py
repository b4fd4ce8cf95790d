"""What rows and pages say of an axisymmetric run that may touch: states, work of the pressure, how it went."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from meshes.solid import FloatArray
from studies.models.contact import CONTACT_FILE, MODELLED, read_reports
from studies.models.run_log import CONTACT
from studies.results.rows import Row, is_reached, row
from studies.results.runs import Run, value_status

# Name and unit of what a state has, in the order of its rows.
STATE_QUANTITIES: Mapping[str, str] = {
    "tip_mm": "mm",
    "tip_force_n": "N",
    "volume_mm3": "mm3",
    "min_gap_mm": "mm",
    "contact_force_n": "N",
    "touching_places": "1",
    "unstable_modes": "1",
    "min_det_f": "1",
}


def requested_rows(
    run: Run,
    folder: Path,
    pressures_kpa: Sequence[float],
    quantities: Sequence[str],
    model: str,
    finest: Run | None = None,
) -> list[Row]:
    """Rows of the requested states, names of `STATE_QUANTITIES`; of what was not reached the first without a value.

    Parameters
    ----------
    folder
        Where the run is kept.
    finest
        The run whose state is the reference of the first quantity.
    """
    contacts = read_reports(folder / CONTACT_FILE)
    return [r for p in pressures_kpa for r in _state_rows(run, p, quantities, model, contacts, finest)]


def _state_rows(
    run: Run,
    pressure_kpa: float,
    quantities: Sequence[str],
    model: str,
    contacts: Sequence[Mapping[str, str]],
    finest: Run | None,
) -> list[Row]:
    scene, level, main = run.summary.scene, run.summary.level, quantities[0]
    found = run.at(pressure_kpa)
    if found is None:
        unit, status = STATE_QUANTITIES[main], value_status(run, pressure_kpa, math.nan, ".3f")
        return [row(scene, main, unit, pressure_kpa, model, math.nan, level, status=status)]
    here = [c for c in contacts if math.isclose(float(c["pressure_kpa"]), pressure_kpa, rel_tol=1e-9)]
    touching = {
        "contact_force_n": sum(float(c["force_n"]) for c in here),
        "touching_places": float(sum(int(c["places"]) for c in here)),
    }
    rows = []
    for name in quantities:
        value = touching[name] if name in touching else float(getattr(found, name))
        known, source = _reference(finest, pressure_kpa, name, model) if name == main else (math.nan, "")
        unit = STATE_QUANTITIES[name]
        rows.append(row(scene, name, unit, pressure_kpa, model, value, level, reference=known, source=source))
    return rows


def _reference(finest: Run | None, pressure_kpa: float, quantity: str, model: str) -> tuple[float, str]:
    """What the finest run says of a quantity, and its name; NaN and empty if it says nothing."""
    found = finest.at(pressure_kpa) if finest else None
    if finest is None or found is None:
        return math.nan, ""
    return float(getattr(found, quantity)), f"{model} {finest.summary.level}"


def path_rows(run: Run, model: str) -> list[Row]:
    """Rows of a whole path: work of the pressure beside the energy gained, and where it lost its stability."""
    scene, level, rows = run.summary.scene, run.summary.level, []
    if len(run.path) > 1:
        last, work, gain = run.path[-1].pressure_kpa, pressure_work_mj(run), energy_gain_mj(run)
        source = "gain of stored energy from the first state"
        rows.append(row(scene, "pressure_work_mj", "mJ", last, model, work, level, reference=gain, source=source))
    if crossing := run.summary.crossing:
        name = str(crossing["kind"]).replace(" ", "_")
        rows.append(row(scene, f"{name}_kpa", "kPa", math.nan, model, crossing["pressure_kpa"], level))
    return rows


def stops(rows: Sequence[Row]) -> list[str]:
    """What was not reached and why, a sentence each."""
    return [f"{r.scene}, {r.model} {r.level}, {r.pressure_kpa:g} kPa: {r.status}" for r in rows if not is_reached(r)]


def work_mj(pressure_mpa: FloatArray, volume_mm3: FloatArray) -> float:
    """Work of a pressure along a path by the trapezoidal rule, mJ.

    It is stored whatever touches on the way, up to the rule's error: contact without friction takes none.
    """
    return float(np.sum(0.5 * (pressure_mpa[1:] + pressure_mpa[:-1]) * np.diff(volume_mm3)))


def pressure_work_mj(run: Run) -> float:
    """Work of the pressure from the first state of a run to its last, mJ."""
    pressure = 1e-3 * np.array([entry.pressure_kpa for entry in run.path])
    return work_mj(pressure, np.array([entry.volume_mm3 for entry in run.path]))


def energy_gain_mj(run: Run) -> float:
    """Stored energy gained from the first state of a path to its last, mJ."""
    return run.path[-1].energy_mj - run.path[0].energy_mj


def run_notes(run: Run) -> list[str]:
    """First touch, loss of stability, end and work of a run, a sentence each."""
    found = [note for note in run.summary.plan if note.startswith((MODELLED, CONTACT))] or ["nothing touches"]
    if crossing := run.summary.crossing:
        found.append(
            f"{crossing['kind']} at {crossing['pressure_kpa']:.4g} kPa (within {crossing['within_kpa']:.1g}), "
            f"unstable axisymmetric modes {crossing['modes_before']} -> {crossing['modes_after']}"
        )
    if run.summary.reason:
        found.append(run.summary.reason)
    if len(run.path) > 1:
        found.append(
            f"{len(run.path)} states, {run.summary.factorisations} factorisations; work of the pressure by the "
            f"trapezoidal rule {pressure_work_mj(run):.4g} mJ, gain of stored energy {energy_gain_mj(run):.4g} mJ"
        )
    return found
