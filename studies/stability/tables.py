"""Rows, tables and maps of the stress test."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from studies.engine import Solved
from studies.report.numbers import MISSING
from studies.report.tables import Table, table_of
from studies.results.rows import REACHED, Row, read_rows, row
from studies.stability.cells import Axis, Bellows, Cell
from studies.stability.judge import Outcome
from studies.stability.plots import LOOKS, Square

Ended = Solved[Cell, Outcome]
# How generated inputs end, and how their rows' statuses begin then.
GENERATED = {"right": REACHED} | {name: name for name in ("refused", "stopped", "wrong", "crash", "time out")}


def rows_of(one: Ended) -> list[Row]:
    """The compared value, and of a reached load the count of unstable modes."""
    cell, outcome = one.case, one.result
    status = {
        "right": REACHED,
        "refusal": f"refused: {outcome.reason}",
        "stop": f"stopped at {outcome.reached_kpa:.6g} kPa: {outcome.reason}",
        "wrong": f"wrong: {outcome.reason}",
    }
    value = row(
        f"stability-{cell.axis}",
        "tip_mm" if isinstance(cell.body, Bellows) else "bore_mm",
        "mm",
        cell.load_kpa,
        "axisymmetric",
        outcome.value_mm,
        cell.label,
        reference=outcome.reference_mm,
        source=outcome.source,
        status=status[outcome.verdict],
    )
    if outcome.unstable < 0:
        return [value]
    modes = float(outcome.unstable)
    return [value, row(value.scene, "unstable_modes", "", cell.load_kpa, "axisymmetric", modes, cell.label)]


def of_axis(axis: Axis, ended: Sequence[Ended]) -> list[Ended]:
    """Those of a map."""
    return [one for one in ended if one.case.axis == axis.name]


def of_verdict(verdict: str, ended: Sequence[Ended]) -> list[Ended]:
    """Those that ended so."""
    return [one for one in ended if one.result.verdict == verdict]


def counts_table(axes: Sequence[Axis], ended: Sequence[Ended]) -> Table:
    """Verdicts of each map and of all."""
    lines = []
    for axis in axes:
        of = of_axis(axis, ended)
        values = f"{len({one.case.row for one in of})} × {len({one.case.column for one in of})}"
        errors = [abs(one.result.error_percent) for one in of_verdict("right", of)]
        largest = f"{max(errors):.2g}" if errors else MISSING
        lines.append((axis.title, values, f"{len(of)}", *_verdicts(of), largest, _earliest(of)))
    lines.append(("all", "", f"{len(ended)}", *_verdicts(ended), "", ""))
    return Table(("axis", "values", "cells", *LOOKS, "largest error, %", "earliest stop, %"), tuple(lines))


def _verdicts(ended: Sequence[Ended]) -> tuple[str, ...]:
    return tuple(str(len(of_verdict(verdict, ended))) for verdict in LOOKS)


def _earliest(ended: Sequence[Ended]) -> str:
    """Least share of the load at which one stopped."""
    shares = [one.result.share for one in of_verdict("stop", ended)]
    return f"{100 * min(shares):.0f}" if shares else MISSING


def generated(rows: Path) -> str:
    """How the inputs of `make fuzz` ended, a sentence; empty if it has not been run."""
    if not rows.exists():
        return ""
    endings = Counter(one.status.partition(":")[0] for one in read_rows(rows))
    counts = ", ".join(f"{endings[end]} {name}" for name, end in GENERATED.items())
    return f"{endings.total()} inputs: {counts}"


def others_table(ended: Sequence[Ended]) -> Table:
    """Cells that did not end in a right answer; those with the same ending share a line."""
    groups: dict[tuple[str, str, str, str], list[Ended]] = {}
    for one in ended:
        outcome = one.result
        if outcome.verdict != "right":
            ending = (one.case.row, outcome.verdict, outcome.cause, outcome.reason)
            groups.setdefault(ending, []).append(one)
    lines = []
    for (name, verdict, cause, reason), found in groups.items():
        columns = ", ".join(one.case.column for one in found)
        lines.append((name, columns, verdict, _earliest(found), cause or MISSING, reason))
    return Table(("row", "columns", "verdict", "reached, %", "cause", "reason"), tuple(lines), left=(0, 1, 2, 4, 5))


def unstable_lines(ended: Sequence[Ended]) -> list[str]:
    """Right answers in which unstable modes were counted, by row."""
    found: dict[str, list[str]] = {}
    for one in of_verdict("right", ended):
        if one.result.unstable > 0:
            found.setdefault(one.case.row, []).append(f"{one.result.unstable} at {one.case.column}")
    return [f"{name}: {', '.join(counts)}" for name, counts in found.items()]


def controls_table(pairs: Sequence[tuple[Ended, Ended]]) -> Table:
    """Each control beside the same cell without its flaw."""
    columns: dict[str, Callable[[tuple[Ended, Ended]], str]] = {
        "control": lambda pair: pair[0].case.flaw,
        "cell": lambda pair: pair[0].case.place,
        "control ends in": lambda pair: _ending(pair[0].result),
        "the solver ends in": lambda pair: _ending(pair[1].result),
    }
    return table_of(pairs, columns, left=(0, 1, 2, 3))


def _ending(outcome: Outcome) -> str:
    if outcome.verdict == "right":
        return f"right answer, {_short(abs(outcome.error_percent))} % off"
    if outcome.verdict == "stop":
        return f"stop at {100 * outcome.share:.0f} % of the load: {outcome.reason}"
    return f"{outcome.verdict}: {outcome.reason}"


def square(one: Ended) -> Square:
    """A cell's place in its map, with the error of an answer or the share of the load at a stop."""
    outcome, number = one.result, ""
    if outcome.verdict in ("right", "wrong") and math.isfinite(outcome.error_percent):
        number = _short(abs(outcome.error_percent))
    elif outcome.verdict == "stop":
        number = f"{100.0 * outcome.share:.0f}"
    return Square(one.case.row, one.case.column, outcome.verdict, number)


def _short(value: float) -> str:
    return f"{value:.2g}" if value >= 1e-3 else f"{value:.0e}".replace("e-0", "e-")
