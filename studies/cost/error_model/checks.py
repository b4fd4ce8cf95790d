"""How well the error model foretells scenes that it was not fitted to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from studies.cost.error_model.cases import FINEST, KINDS, in_cells
from studies.cost.error_model.fit import Limits, Sample
from studies.planning.error_model import (
    Cells,
    checked_error_percent,
    choose,
    predicted_error_percent,
    predicted_seconds,
)
from studies.planning.levels import MERIDIANS
from studies.report.tables import Table
from studies.results.rows import Row, row
from studies.scene.bellows import BellowsScene

# What a prediction has to be within.
ALLOWED_FACTOR: Final = 3.0
# Rows that name the level a tolerance chose.
CHOSEN: Final = "chosen"
ACHIEVED, PREDICTED, CHECKED = "achieved_error_percent", "predicted_error_percent", "checked_error_percent"
SECONDS: Final = "predicted_s"


def check_rows(scene: BellowsScene, s: Sample, limits: Limits) -> list[Row]:
    """Predicted, checked (from two levels of the scene itself) and achieved errors, the largest over the pressures.

    Times are predicted and achieved without start and imports; ``chosen`` marks the level that the scene's tolerance
    chooses.
    """
    of, rows = in_cells(scene, s.cells), []
    choice = choose(of, "axisymmetric")
    for level in MERIDIANS:
        name, mesh = f"{s.cells} r{level}", f"r{level}"
        achieved = s.error_percent(level, limits)
        errors = {
            ACHIEVED: achieved,
            PREDICTED: predicted_error_percent(of, "axisymmetric", mesh),
            CHECKED: checked_error_percent(s.cells, level, s.tips_mm[level], s.tips_beside_mm(level)),
        }
        numbers = [
            (quantity, "%", value, math.nan if quantity == ACHIEVED else achieved, f"hex r{FINEST}, extrapolated")
            for quantity, value in errors.items()
        ]
        numbers.append((SECONDS, "s", predicted_seconds(of, "axisymmetric", mesh), s.seconds[level], "this run"))
        if choice.level == mesh:
            numbers.append((CHOSEN, "%", scene.ask.tolerance_percent, math.nan, ""))
        rows += [
            row(s.scene, quantity, unit, math.nan, "axisymmetric", value, name, reference=reference, source=source)
            for quantity, unit, value, reference, source in numbers
        ]
    return rows


def factors(rows: Sequence[Row], quantity: str, cells: Cells) -> dict[tuple[str, str], float]:
    """Predicted over achieved, or the reverse where that is larger, by scene and level."""
    of = [r for r in rows if r.quantity == quantity and r.level.startswith(cells)]
    return {(r.scene, r.level): max(r.value / r.reference, r.reference / r.value) for r in of}


def factors_table(rows: Sequence[Row]) -> Table:
    """How many predictions are within `ALLOWED_FACTOR`, a line per kind of cells and prediction."""
    chosen = {(r.scene, r.level) for r in rows if r.quantity == CHOSEN}
    lines = []
    for cells in KINDS:
        for quantity in (PREDICTED, CHECKED, SECONDS):
            found = factors(rows, quantity, cells)
            of_chosen = [factor for key, factor in found.items() if key in chosen]
            lines.append((cells, quantity, *_within(of_chosen), *_within(list(found.values()))))
    header = (
        "cells",
        "quantity",
        f"chosen level within a factor of {ALLOWED_FACTOR:g}",
        "worst factor",
        "all levels",
        "worst factor of all",
    )
    return Table(header, tuple(lines), (0, 1))


def _within(found: Sequence[float]) -> tuple[str, str]:
    """How many factors are allowed, and the largest."""
    allowed = sum(factor <= ALLOWED_FACTOR for factor in found)
    return f"{allowed} of {len(found)}", f"{max(found, default=math.nan):.2f}"


def checks_table(rows: Sequence[Row]) -> Table:
    """Predicted, checked and achieved errors at the level that each scene's tolerance chose."""
    lines = []
    for r in rows:
        if r.quantity != CHOSEN:
            continue
        numbers = {other.quantity: other.value for other in rows if (other.scene, other.level) == (r.scene, r.level)}
        predicted, checked, achieved = (numbers[name] for name in (PREDICTED, CHECKED, ACHIEVED))
        errors = (f"{x:.2g}" for x in (predicted, checked, achieved))
        ratios = (f"{x / achieved:.2f}" for x in (predicted, checked))
        lines.append((r.scene, f"{r.value:g}", r.level, *errors, *ratios))
    header = (
        "scene",
        "tolerance, %",
        "chosen",
        "predicted, %",
        "checked, %",
        "achieved, %",
        "predicted / achieved",
        "checked / achieved",
    )
    return Table(header, tuple(lines), (0, 2))
