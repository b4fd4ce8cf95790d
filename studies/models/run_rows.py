"""What rows and pages say of an axisymmetric run that may touch: states, work of the pressure, how it went."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from studies.models.contact import MODELLED
from studies.models.run_log import CONTACT
from studies.results.rows import Row, row
from studies.results.runs import Run, stopped_text

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


def state_rows(
    run: Run,
    pressure_kpa: float,
    quantities: Sequence[str],
    model: str,
    contacts: Sequence[Mapping[str, str]],
    finest: Run | None = None,
) -> list[Row]:
    """Rows of a requested state, names of `STATE_QUANTITIES`; the first alone, without a value, if it was not reached.

    Parameters
    ----------
    contacts
        Lines of contact.csv, a line per place that touches.
    finest
        The run whose state is the reference of the first quantity.
    """
    summary, found = run.summary, run.at(pressure_kpa)
    if found is None:
        name = quantities[0]
        return [
            row(summary.scene, name, STATE_QUANTITIES[name], pressure_kpa, model, math.nan, summary.level,
                status=stopped_text(run, ".3f"))
        ]  # fmt: skip
    here = [c for c in contacts if math.isclose(float(c["pressure_kpa"]), pressure_kpa, rel_tol=1e-5)]
    touching = {
        "contact_force_n": sum(float(c["force_n"]) for c in here),
        "touching_places": float(sum(int(c["places"]) for c in here)),
    }
    other = finest.at(pressure_kpa) if finest is not None else None
    rows = []
    for name in quantities:
        value = touching[name] if name in touching else float(getattr(found, name))
        reference, source = math.nan, ""
        if other is not None and finest is not None and name == quantities[0]:
            reference, source = float(getattr(other, name)), f"{model} {finest.summary.level}"
        rows.append(
            row(summary.scene, name, STATE_QUANTITIES[name], pressure_kpa, model, value, summary.level,
                reference=reference, source=source)
        )  # fmt: skip
    return rows


def path_rows(run: Run, model: str) -> list[Row]:
    """Rows of a whole path: work of the pressure beside the energy gained, and where it lost its stability."""
    summary, rows = run.summary, []
    if len(run.path) > 1:
        rows.append(
            row(summary.scene, "pressure_work_mj", "mJ", run.path[-1].pressure_kpa, model, pressure_work_mj(run),
                summary.level, reference=energy_gain_mj(run), source="gain of stored energy from the first state")
        )  # fmt: skip
    if crossing := summary.crossing:
        name = str(crossing["kind"]).replace(" ", "_")
        rows.append(row(summary.scene, f"{name}_kpa", "kPa", math.nan, model, crossing["pressure_kpa"], summary.level))
    return rows


def pressure_work_mj(run: Run) -> float:
    """Work of the pressure from the first state of a path to its last, by the trapezoidal rule, mJ.

    It is stored whatever touches on the way, up to the rule's error: contact without friction takes none.
    """
    pressure = 1e-3 * np.array([entry.pressure_kpa for entry in run.path])
    volume = np.array([entry.volume_mm3 for entry in run.path])
    return float(np.sum(0.5 * (pressure[1:] + pressure[:-1]) * np.diff(volume)))


def energy_gain_mj(run: Run) -> float:
    """Stored energy gained from the first state of a path to its last, mJ."""
    return run.path[-1].energy_mj - run.path[0].energy_mj


def run_notes(run: Run) -> list[str]:
    """First touch, loss of stability, end and work of a run, a sentence each."""
    found = [note for note in run.summary.plan if note.startswith((MODELLED, CONTACT))]
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
