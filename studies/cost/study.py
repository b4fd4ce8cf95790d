"""The cost study: every cell in a process of its own, one after the other, on a machine that does nothing else.

What is not there yet is measured first, then once more what other processes disturbed. Each measurement is kept, so a
study that was stopped goes on.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import click

from studies import mpi_children
from studies.cost.cases import BATCHES, CELLS, LARGE, Batch, Cell, cell_scene
from studies.cost.measure import keep_quieter, kept_measurement, measure
from studies.cost.page import content
from studies.cost.rows import batch_rows, measured_rows
from studies.engine import ROWS_FILE, Page, Setting, Solved, Study
from studies.results.rows import TIME_RATIO, Row, read_rows

KEPT: Final = "measured"


@dataclass(frozen=True)
class Turn:
    """A cell's or batch's turn to be measured: where it is missing, or again where it was disturbed."""

    of: Cell | Batch
    again: bool

    @property
    def name(self) -> str:
        """For messages."""
        return f"{self.of.name}{' again' if self.again else ''}"


def cases(options: Mapping[str, Any]) -> list[Turn]:
    """All cells that were chosen and the batches, twice."""
    bodies = options["body"]
    cells = [c for c in (*CELLS, *(LARGE if options["large"] else ())) if not bodies or c.body in bodies]
    for cell in cells:
        cell_scene(cell)
    chosen: list[Cell | Batch] = [*cells, *BATCHES]
    return [Turn(of, again) for again in (False, True) for of in chosen]


def solve(turn: Turn, at: Setting) -> None:
    """Measure, unless the time is over."""
    before = kept_measurement(turn.of, at.out / KEPT)
    wanted = before is None if not turn.again else before is not None and before.disturbed
    if not wanted or time.monotonic() > at.options["minutes"]:
        return
    found = measure(turn.of)
    keep_quieter(turn.of, found, at.out / KEPT)
    cost = f"{found.wall_s:.1f} s, {found.peak_mb:.0f} MB"
    note = f" (disturbed: others took {found.others_s:.1f} CPU s)" if found.disturbed else ""
    click.echo(f"{turn.name}: {cost}, {found.value:.6g} mm, {found.status}{note}")


def study_rows(folder: Path) -> list[Row]:
    """Rows of all that has been measured with the present content, whatever was chosen now."""
    cells = {cell: found for cell in (*CELLS, *LARGE) if (found := kept_measurement(cell, folder)) is not None}
    batches = {batch: found for batch in BATCHES if (found := kept_measurement(batch, folder)) is not None}
    return [*measured_rows(cells), *(r for batch, found in batches.items() for r in batch_rows(batch, found))]


def rows_of(file: Path) -> list[Row]:
    """Rows of another study; none if it has not been run."""
    return read_rows(file) if file.exists() else []


def peer_rows(file: Path) -> list[Row]:
    """Of the peer study's rows, the other programs' and the ratios to them."""
    return [r for r in rows_of(file) if r.model.startswith("peer_") or r.quantity.startswith(TIME_RATIO)]


def page(solved: Sequence[Solved[Turn, None]], at: Setting) -> Page:
    """All that has been measured, and beside it the other programs' runs and the error model's check."""
    rows = [*study_rows(at.out / KEPT), *peer_rows(at.options["peers"]), *rows_of(at.options["model"])]
    turns = [done.case for done in solved if not done.case.again]
    missing = [turn for turn in turns if kept_measurement(turn.of, at.out / KEPT) is None]
    stopped = [f"{len(missing)} not measured: run the same command again"] if missing else []
    return Page(rows, content(rows, at.out), stopped)


def _rows_file(option: str, study: str, text: str) -> click.Option:
    return click.Option([option], default=Path("results", study, ROWS_FILE), type=click.Path(path_type=Path), help=text)


STUDY: Final = Study(
    name="cost",
    title="What an answer costs: time, memory and error of every model, element, mesh and way of stepping",
    question="What does an answer cost in time and memory, by model, element, mesh and way of stepping?",
    template="cost/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="first",
    options=(
        _rows_file("--peers", "peers", "Rows of the peer study."),
        _rows_file("--model", "error-model", "Rows of the error model's check."),
        click.Option(
            ["--minutes"],
            default=math.inf,
            callback=mpi_children.until(60.0),
            help="Start no more cells after so long; the same command goes on.",
        ),
        click.Option(["--large"], is_flag=True, help="Also the largest bodies that fit 24 GB; they take minutes each."),
        click.Option(
            ["--body"], multiple=True, help="Only cells of this scene file below scenes/, such as exact/tube."
        ),
    ),
)
