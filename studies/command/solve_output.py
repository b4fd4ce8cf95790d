"""What ``solve`` says at its end: a table of pressures and models, the verdict on the tolerance; or JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from mpi4py import MPI
from rich import box
from rich.console import Console
from rich.table import Table

from studies.models.session import SceneResult
from studies.models.tolerance import worst_percent
from studies.planning.levels import ranking
from studies.report.labels import model_label, ordered, quantity_label, run_label
from studies.report.numbers import signed
from studies.results.rows import Row, snap_of
from studies.scene.load import Scene

# The models whose result is the answer, the best first.
BEST = ("full3d", "sector", "axisymmetric")
# Other readings of the closed form; they are in rows.csv.
OTHER_CHAINS = ("closed_form_printed", "closed_form_balanced", "closed_form_seat", "closed_form_outline")
STRETCH = "largest_stretch"
# A table that does not go to a terminal is not broken into lines.
WIDE = 160


def show(result: SceneResult[Scene]) -> None:
    """Print the answers of a scene."""
    console = Console(highlight=False)
    if not console.is_terminal or MPI.COMM_WORLD.size > 1:  # mpirun gives its ranks a terminal that is none
        console = Console(highlight=False, width=WIDE, force_terminal=False)
    for quantity in dict.fromkeys(row.quantity for row in result.headlines):
        table, against = answers(quantity, result.headlines, _of_answer(result, STRETCH))
        console.print(f"{result.scene.name}: {quantity_label(quantity)}; in brackets % from {against}", soft_wrap=True)
        console.print(table)
    for line in ("" if result.missed else verdict(result), result.remark):  # what is missed is an error
        if line:
            console.print(line, soft_wrap=True)


def _of_answer(result: SceneResult[Scene], quantity: str) -> list[Row]:
    """The answer's rows of a quantity."""
    run = result.answer
    at = ("", "") if run is None else (run.summary.model, run.summary.level)
    return [row for row in result.rows if row.quantity == quantity and (row.model, row.level) == at]


def answers(quantity: str, rows: Sequence[Row], beside: Sequence[Row] = ()) -> tuple[Table, str]:
    """A line per pressure with the finest value of each model and how far it is from the best; what that is.

    Of another quantity of the answer, ``beside``, a column comes last.
    """
    of_it = [row for row in rows if row.quantity == quantity and row.model not in OTHER_CHAINS]
    levels = {row.model: row.level for row in sorted(of_it, key=lambda row: ranking(row.level))}  # each model's finest
    models = ordered(levels)
    best = next((model for model in BEST if model in models), models[-1])
    exact = any(math.isfinite(row.reference) and row.source.startswith(("exact", "published")) for row in of_it)
    against = "the reference" if exact else model_label(best)
    table = Table(box=box.SIMPLE)
    table.add_column("kPa", justify="right")
    for model in models:
        table.add_column(run_label(model, levels[model]), justify="right", no_wrap=True)
    if exact:
        table.add_column("reference", justify="right")
    further = {row.pressure_kpa: row for row in beside}
    for name in dict.fromkeys(row.quantity for row in beside):
        table.add_column(quantity_label(name), justify="right")
    for pressure in dict.fromkeys(row.pressure_kpa for row in of_it):
        found = {r.model: r for r in of_it if r.pressure_kpa == pressure or math.isnan(pressure)}
        reference = next((r.reference for r in found.values() if math.isfinite(r.reference)), math.nan)
        compared = reference if exact else found[best].value if best in found else math.nan
        cells = ["–" if math.isnan(pressure) else f"{pressure:g}"]
        for model in models:
            row = found.get(model)
            cells.append(_value(row) + ("" if model == best and not exact else _apart(row, compared)))
        cells += [_number(reference)] if exact else []
        if further:
            cells.append(f"{further[pressure].value:.3g}" if pressure in further else "–")
        table.add_row(*cells)
    return table, against


def _number(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.6g}"


def _value(row: Row | None) -> str:
    """A value with its uncertainty and in which state, or why there is none."""
    if row is None:
        return "–"
    if math.isnan(row.value):
        return row.status.split(":")[0]
    spread = "" if math.isnan(row.uncertainty) else f" ± {row.uncertainty:.2g}"
    return ", ".join(filter(None, [f"{_number(row.value)}{spread}", snap_of(row)]))


def _apart(row: Row | None, value: float) -> str:
    """Difference of a row from a value, percent, in brackets; nothing where it is not known."""
    if row is None or math.isnan(row.value) or not value or math.isnan(value):
        return ""
    return f" ({signed(100.0 * (row.value - value) / abs(value))})"


def verdict(result: SceneResult[Scene]) -> str:
    """Whether the answer's uncertainty holds the scene's tolerance, a sentence; empty for a closed form."""
    run = result.answer
    if run is None:
        return ""
    tolerance = f"tolerance {result.scene.ask.tolerance_percent:g} %"
    name = run_label(run.summary.model, *(row.level for row in result.answers[-1:]))
    percent = worst_percent(result.answers)
    if result.missed:
        return result.shortfall
    if not result.answers:
        return f"{tolerance}: asked of no value, as there is none"
    if not math.isfinite(percent):
        return f"{tolerance}: cannot be told from one mesh ({name})"
    return f"{tolerance}: met, {name} is certain within {percent:.2g} %"


def as_json(result: SceneResult[Scene]) -> str:
    """The same for programs: status, verdict, rows; what is not known is null."""
    content: dict[str, Any] = {
        "scene": result.scene.name,
        "reached": result.reached,
        "reason": result.reason,
        "verdict": verdict(result),
        "missed": [
            {
                "quantity": short.row.quantity,
                "pressure_kpa": _known(short.row.pressure_kpa),
                "reached_percent": _known(short.reached_percent),
                "asked_percent": short.asked_percent,
            }
            for short in result.missed
        ],
        "expected": result.remark,
        "warnings": list(result.warnings),
        "rows": [_plain(row) for row in result.headlines],
        "largest_stretch": [_plain(row) for row in _of_answer(result, STRETCH)],
    }
    return json.dumps(content, indent=1, allow_nan=False)


def _plain(row: Row) -> dict[str, Any]:
    return {name: _known(value) if isinstance(value, float) else value for name, value in asdict(row).items()}


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
