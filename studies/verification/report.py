"""The report of the verification table, rendered from its rows."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

from studies.report.labels import quantity_label, run_label
from studies.report.numbers import MISSING
from studies.report.pages import write_page
from studies.report.tables import Table, facts_table
from studies.results import provenance
from studies.verification import two_routes as exact_table
from studies.verification.study import Line, Verification

TITLE: Final = "Verification: exact and published problems, and what this program gives"


def render_verification(folder: Path, found: Verification, seconds: float) -> Path:
    """Write the report into a folder that has rows.csv; returns the path of report.html."""
    stamps = {
        "commit": provenance.commit(),
        "date": provenance.now(),
        "machine": provenance.machine(),
        "BLAS": provenance.blas(),
        **provenance.versions(),
    }
    content = {
        "title": TITLE,
        "problems": problems(found.lines),
        "formulas": exact_table.table(list(found.formulas)),
        "worst": f"{max((one.difference for one in found.formulas), default=math.nan):.1e}",
        "goal": f"{exact_table.GOAL:.0e}",
        "stopped": list(found.stopped),
        "seconds": f"{seconds:.0f}",
        "provenance": facts_table(stamps),
    }
    return write_page(folder, "verification.md.j2", content)


def problems(lines: tuple[Line, ...]) -> Table:
    """A line per problem, quantity and model."""
    cells = []
    for line in lines:
        r = line.finest
        load = MISSING if math.isnan(r.pressure_kpa) or r.pressure_kpa == 0.0 else f"{r.pressure_kpa:g}"
        value = f"{r.value:.6g}" if math.isfinite(r.value) else r.status
        if math.isfinite(r.uncertainty):
            value += f" ± {r.uncertainty:.1g}"
        error = f"{r.error_percent:+.2g}".replace("-", "\N{MINUS SIGN}") if math.isfinite(r.error_percent) else MISSING
        order = f"{line.order:.1f}" if math.isfinite(line.order) else MISSING
        what = (r.scene, quantity_label(r.quantity), run_label(r.model, r.level, counted=line.counted), load, value)
        cells.append((*what, f"{r.reference:.6g}", error, order, r.source))
    header = ("problem", "quantity", "model and mesh", "load, kPa", "value", "reference", "error, %", "order", "source")
    return Table(header, tuple(cells), left=(0, 1, 2, 8))
