"""The same answers on every stack: rows that `studies.stacks.figures` left, a folder per stack, beside the first's."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import click

from studies.engine import ROWS_FILE, Bar, Page, Setting, Solved, Study
from studies.report.numbers import MISSING
from studies.report.tables import Table
from studies.results.rows import Row, read_rows
from studies.stacks.figures import FIGURES_FILE, Figures, read_figures

# What rows may differ by between stacks: Newton ends at 1e-8 of the load.
SAME: Final = 1e-8
# Times are no answers.
COSTS: Final = ("s", "MB")
SHOWN: Final = {
    "python": "Python",
    "numpy": "numpy",
    "dolfinx": "dolfinx",
    "fenics-ufl": "UFL",
    "petsc": "PETSc",
    "mpi": "MPI",
    "gmsh": "gmsh",
}


@dataclass(frozen=True)
class Given:
    """What a stack gave."""

    rows: list[Row]
    figures: Figures


@dataclass(frozen=True)
class Difference:
    """Largest difference of a stack's rows from the reference's, and the row that has it.

    Attributes
    ----------
    value
        Relative; of percentages and of modes the absolute one, percentages as parts of one.
    where
        The row, in words.
    rows
        Number of rows compared.
    """

    value: float
    where: str
    rows: int


def cases(options: Mapping[str, Any]) -> list[Path]:
    """Folders that have been measured into; the first is what the others are compared with."""
    found = [folder for folder in options["folders"] if (folder / FIGURES_FILE).exists()]
    if not found:
        raise click.UsageError(f"none of the folders has {FIGURES_FILE}: run `python -m studies.stacks.figures` first")
    return found


def solve(folder: Path, at: Setting) -> Given:
    """What is in a folder."""
    return Given(read_rows(folder / ROWS_FILE), read_figures(folder))


def compare(reference: Sequence[Row], rows: Sequence[Row]) -> Difference:
    """Compare rows with a reference's, place by place.

    Raises
    ------
    ValueError
        If they are not rows of the same things.
    """
    a, b = ([row for row in side if row.unit not in COSTS] for side in (reference, rows))
    names = [[_name(row) for row in side] for side in (a, b)]
    if names[0] != names[1]:
        odd = sorted(set(names[0]) ^ set(names[1])) or ["their order"]
        raise ValueError(f"rows of {len(a)} and {len(b)} things differ in {odd[0]}")
    found = max(zip(map(_difference, a, b), names[0], strict=True), default=(0.0, "nothing"))
    return Difference(found[0], found[1], len(a))


def _name(row: Row) -> str:
    return " ".join(filter(None, (row.scene, row.quantity, f"{row.pressure_kpa:g} kPa", row.model, row.level)))


def _difference(a: Row, b: Row) -> float:
    if math.isnan(a.value) or math.isnan(b.value):
        return 0.0 if math.isnan(a.value) and math.isnan(b.value) and a.status == b.status else math.inf
    if a.unit == "%":
        return abs(a.value - b.value) / 100.0
    largest = max(abs(a.value), abs(b.value))
    return abs(a.value - b.value) / largest if largest > 0.0 else 0.0


def stack_table(names: Sequence[str], figures: Sequence[Figures], differences: Sequence[Difference]) -> Table:
    """A column per stack."""
    lines = [
        *((label, *(one.versions.get(key, MISSING) for one in figures)) for key, label in SHOWN.items()),
        ("BLAS", *(one.blas for one in figures)),
        (
            "`make study-smoke`, nothing compiled / all compiled, s",
            *(f"{one.smoke_cold_s:.0f} / {one.smoke_warm_s:.0f}" for one in figures),
        ),
        ("`make study-core`, nothing compiled, s", *(f"{one.core_s:.0f}" for one in figures)),
        (
            "the machine's time that other processes took meanwhile, %",
            *(f"{one.others_percent:.0f}" for one in figures),
        ),
        ("largest peak memory, MB", *(f"{one.peak_mb:.0f}" for one in figures)),
        ("unstable modes on 1 rank", *(_counts(one, "1") for one in figures)),
        ("on 2 ranks", *(_counts(one, "2") for one in figures)),
        ("rows compared", *(str(one.rows) for one in differences)),
        ("largest difference", *(f"{one.value:.1e}" for one in differences)),
        ("where", *(one.where if one.value else MISSING for one in differences)),
    ]
    return Table(("", *names), tuple(lines), left=tuple(range(len(names) + 1)))


def _counts(figures: Figures, ranks: str) -> str:
    return ", ".join(map(str, figures.modes[ranks]))


def page(solved: Sequence[Solved[Path, Given]], at: Setting) -> Page:
    """A column per stack; rows are those of the first."""
    names, given = [one.case.name for one in solved], [one.result for one in solved]
    differences = [compare(given[0].rows, one.rows) for one in given]
    worst = max(one.value for one in differences)
    bar = Bar(f"rows the same on all stacks to {SAME:g}", f"largest difference {worst:.1e}", worst <= SAME)
    table = stack_table(names, [one.figures for one in given], differences)
    return Page(given[0].rows, {"stacks": table, "reference": names[0]}, bars=[bar])


STUDY: Final = Study(
    name="stacks",
    title="The same answers on three stacks",
    question="Does the same code give the same rows on every stack, and what does each cost?",
    template="stacks/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="first",
    options=(
        click.Argument(
            ["folders"],
            nargs=-1,
            required=True,
            type=click.Path(path_type=Path, exists=True, file_okay=False),
        ),
    ),
)
