"""The report of the stress test: verdicts counted, a map per axis, what is not a right answer with its cause."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from studies.report.drawn import key_of as picture_key
from studies.report.drawn import once
from studies.report.numbers import MISSING, duration
from studies.report.pages import write_page
from studies.report.tables import Table, facts_table
from studies.results import provenance
from studies.results.rows import REACHED, Row, write_rows
from studies.results.rows import row as new_row
from studies.stability import plots as stability_plots
from studies.stability.cells import AXES, Axis, Bellows, Cell
from studies.stability.plots import LOOKS, Square, draw_map
from studies.stability.run import PRESSURE_TOLERANCE_PERCENT, SAME_PERCENT, TOLERANCE_PERCENT, Outcome

TITLE: Final = "Stress test: where the solver holds, refuses and stops"
ROWS_FILE: Final = "rows.csv"
# What is demanded of the study.
LEAST_CELLS, LEAST_VALUES, LEAST_RIGHT, LEAST_SHARE = 200, 5, 0.70, 0.80


@dataclass(frozen=True)
class Result:
    """A cell and how it ended."""

    cell: Cell
    outcome: Outcome


@dataclass(frozen=True)
class Demand:
    """Something demanded of the study, what was found, and whether that is enough."""

    words: str
    found: str
    met: bool


def write_report(
    folder: Path, results: Sequence[Result], compared: Sequence[tuple[Result, Result]]
) -> tuple[Path, bool]:
    """Write report.html, report.md, rows.csv and the maps.

    Parameters
    ----------
    folder
        Where to.
    results
        Cells of the product.
    compared
        Pairs of a control, which must fail, and its counterpart without the flaw.

    Returns
    -------
    tuple
        Path of report.html, and True if all demands are met.
    """
    folder.mkdir(parents=True, exist_ok=True)
    everything = [*results, *(r for pair in compared for r in pair)]
    write_rows(folder / ROWS_FILE, (line for r in everything for line in _rows(r)))
    demands = demands_of(results, compared)
    axes = [axis for axis in AXES if any(r.cell.axis == axis.name for r in results)]
    content = {
        "title": TITLE,
        "demands": Table(
            ("demanded", "found", "met"),
            tuple((d.words, d.found, "yes" if d.met else "NO") for d in demands),
            left=(0, 1, 2),
        ),
        "counts": _counts(axes, results),
        "axes": [_section(folder, axis, [r for r in results if r.cell.axis == axis.name]) for axis in axes],
        "compared": _compared(compared),
        "tolerance": f"{TOLERANCE_PERCENT:g}",
        "pressure_tolerance": f"{PRESSURE_TOLERANCE_PERCENT:g}",
        "same": f"{SAME_PERCENT:g}",
        "seconds": duration(sum(r.outcome.seconds for r in everything)),
        "provenance": _provenance(),
    }
    return write_page(folder, "stability.md.j2", content), all(d.met for d in demands)


def demands_of(results: Sequence[Result], compared: Sequence[tuple[Result, Result]]) -> list[Demand]:
    """The demands, with what was found."""
    count = len(results)
    wrong = sum(r.outcome.verdict == "wrong" for r in results)
    right = sum(r.outcome.verdict == "right" for r in results)
    stops = [r for r in results if r.outcome.verdict == "stop"]
    early = [r for r in stops if not r.outcome.share >= LEAST_SHARE]
    unnamed = [r for r in early if not (r.outcome.cause and r.outcome.reason)]
    values = {
        axis.name: len({r.cell.column for r in results if r.cell.axis == axis.name})
        for axis in AXES
        if any(r.cell.axis == axis.name for r in results)
    }
    few = [name for name, n in values.items() if n < LEAST_VALUES]
    held = [a for a, b in compared if a.outcome.verdict == "right" or b.outcome.verdict != "right"]
    return [
        Demand(f"at least {LEAST_CELLS} cells", f"{count}", count >= LEAST_CELLS),
        Demand(f"at least {LEAST_VALUES} values per axis", ", ".join(few) or "yes", not few),
        Demand("no wrong answer", f"{wrong} wrong", wrong == 0),
        Demand(
            f"at least {100 * LEAST_RIGHT:g} % right answers",
            f"{right} of {count} ({100 * right / max(count, 1):.1f} %)",
            right >= LEAST_RIGHT * count,
        ),
        Demand(
            f"stops at {100 * LEAST_SHARE:g} % or more of the load that is reachable, or their cause shown",
            f"{len(stops)} stops, {len(early)} earlier, {len(early) - len(unnamed)} of these with cause and reason",
            not unnamed,
        ),
        Demand(
            "controls fail where the solver is right", f"{len(compared) - len(held)} of {len(compared)}",
            not held,
        ),
    ]  # fmt: skip


# --- rows and tables ----------------------------------------------------------------------------------------


def _rows(result: Result) -> list[Row]:
    """The compared value, and of a reached load the count of unstable modes."""
    cell, o = result.cell, result.outcome
    quantity = "tip_mm" if isinstance(cell.body, Bellows) else "bore_mm"
    status = {
        "right": REACHED,
        "refusal": f"refused: {o.reason}",
        "stop": f"stopped at {o.reached_kpa:.6g} kPa: {o.reason}",
        "wrong": f"wrong: {o.reason}",
    }[o.verdict]
    scene, level = f"stability-{cell.axis}", f"{cell.flaw}: {cell.name}" if cell.flaw else cell.name
    out = [
        new_row(
            scene,
            quantity,
            "mm",
            cell.load_kpa,
            "axisymmetric",
            o.value_mm,
            level,
            reference=o.reference_mm,
            source=o.source,
            status=status,
        )
    ]
    if o.unstable >= 0:
        out.append(new_row(scene, "unstable_modes", "", cell.load_kpa, "axisymmetric", float(o.unstable), level))
    return out


def _counts(axes: Sequence[Axis], results: Sequence[Result]) -> Table:
    lines = []
    for axis in axes:
        of = [r for r in results if r.cell.axis == axis.name]
        errors = [abs(r.outcome.error_percent) for r in of if r.outcome.verdict == "right"]
        shares = [r.outcome.share for r in of if r.outcome.verdict == "stop"]
        rows, columns = ({getattr(r.cell, name) for r in of} for name in ("row", "column"))
        lines.append(
            (axis.title, f"{len(rows)} × {len(columns)}", f"{len(of)}", *_verdicts(of),
             f"{max(errors):.2g}" if errors else MISSING, f"{100 * min(shares):.0f}" if shares else MISSING)
        )  # fmt: skip
    lines.append(("all", "", f"{len(results)}", *_verdicts(results), "", ""))
    header = ("axis", "values", "cells", *(v for v in LOOKS), "largest error, %", "earliest stop, %")
    return Table(header, tuple(lines))


def _verdicts(results: Sequence[Result]) -> tuple[str, ...]:
    return tuple(str(sum(r.outcome.verdict == verdict for r in results)) for verdict in LOOKS)


def _section(folder: Path, axis: Axis, results: Sequence[Result]) -> dict[str, Any]:
    rows = list(dict.fromkeys(r.cell.row for r in results))
    columns = list(dict.fromkeys(r.cell.column for r in results))
    squares = {(r.cell.row, r.cell.column): Square(r.outcome.verdict, _number(r.outcome)) for r in results}
    place = Path("pictures", f"{axis.name}.png")
    labels = (axis.rows, axis.columns)
    (folder / "pictures").mkdir(exist_ok=True)
    key = picture_key(rows, columns, sorted(squares.items()), labels, code=(stability_plots,))

    def draw() -> str:
        draw_map(folder / place, rows, columns, squares, labels)
        return ""

    once(folder / place, key, draw)
    return {
        "title": axis.title,
        "picture": str(place),
        "others": _others(results),
        "unstable": _unstable(results),
        "rows": axis.rows,
        "columns": axis.columns,
    }


def _unstable(results: Sequence[Result]) -> list[str]:
    """Right answers in which unstable modes were counted, by row."""
    found: dict[str, list[str]] = {}
    for r in results:
        if r.outcome.verdict == "right" and r.outcome.unstable > 0:
            found.setdefault(r.cell.row, []).append(f"{r.outcome.unstable} at {r.cell.column}")
    return [f"{row}: {', '.join(counts)}" for row, counts in found.items()]


def _number(outcome: Outcome) -> str:
    if outcome.verdict in ("right", "wrong") and math.isfinite(outcome.error_percent):
        return _short(abs(outcome.error_percent))
    if outcome.verdict == "stop":
        return f"{100.0 * outcome.share:.0f}"
    return ""


def _short(value: float) -> str:
    return f"{value:.2g}" if value >= 1e-3 else f"{value:.0e}".replace("e-0", "e-")


def _others(results: Sequence[Result]) -> Table:
    """Cells that did not end in a right answer; those with the same ending share a line."""
    groups: dict[tuple[str, str, str, str], list[Result]] = {}
    for r in results:
        o = r.outcome
        if o.verdict != "right":
            groups.setdefault((r.cell.row, o.verdict, o.cause, o.reason), []).append(r)
    lines = []
    for (row, verdict, cause, reason), found in groups.items():
        shown = f"{100 * min(r.outcome.share for r in found):.0f}" if verdict == "stop" else MISSING
        columns = ", ".join(r.cell.column for r in found)
        lines.append((row, columns, verdict, shown, cause or MISSING, reason))
    return Table(("row", "columns", "verdict", "reached, %", "cause", "reason"), tuple(lines), left=(0, 1, 2, 4, 5))


def _compared(compared: Sequence[tuple[Result, Result]]) -> Table:
    lines = []
    for flawed, sound in compared:
        lines.append((flawed.cell.flaw, flawed.cell.name, _ending(flawed.outcome), _ending(sound.outcome)))
    header = ("control", "cell", "control ends in", "the solver ends in")
    return Table(header, tuple(lines), left=(0, 1, 2, 3))


def _ending(o: Outcome) -> str:
    if o.verdict == "right":
        return f"right answer, {_short(abs(o.error_percent))} % off"
    if o.verdict == "stop":
        return f"stop at {100 * o.share:.0f} % of the load: {o.reason}"
    return f"{o.verdict}: {o.reason}"


def _provenance() -> Table:
    stamps = {
        "commit": provenance.commit(),
        "date": provenance.now(),
        "machine": provenance.machine(),
        "BLAS": provenance.blas(),
        **provenance.versions(),
    }
    return facts_table(stamps)
