"""The same answers on every stack: ``python -m studies.stacks.study results/stacks/* --out results/stacks``.

Compares the rows that `studies.stacks.figures` left in folders, one per stack, with those of the first, and writes the
table of stacks.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from studies.report.pages import write_page
from studies.report.tables import Table
from studies.results import provenance
from studies.results.rows import Row, read_rows, write_rows
from studies.stacks.figures import Figures, read_figures

# What rows may differ by between stacks: Newton ends at 1e-8 of the load.
SAME = 1e-8
# Times are no answers.
COSTS = ("s", "MB")
SHOWN = {
    "python": "Python",
    "numpy": "numpy",
    "dolfinx": "dolfinx",
    "fenics-ufl": "UFL",
    "petsc": "PETSc",
    "mpi": "MPI",
    "gmsh": "gmsh",
}


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
    lines = [(label, *(one.versions.get(key, "–") for one in figures)) for key, label in SHOWN.items()]
    lines += [
        ("BLAS", *(one.blas for one in figures)),
        (
            "`make study-smoke`, nothing compiled / all compiled, s",
            *(_times(one.smoke_cold_s, one.smoke_warm_s) for one in figures),
        ),
        ("`make study-core`, nothing compiled / all compiled, s", *(_times(one.cold_s, one.warm_s) for one in figures)),
        ("largest peak memory, MB", *(f"{one.peak_mb:.0f}" for one in figures)),
        ("unstable modes on 1 rank", *(_counts(one, "1") for one in figures)),
        ("on 2 ranks", *(_counts(one, "2") for one in figures)),
        ("rows compared", *(str(one.rows) for one in differences)),
        ("largest difference", *(f"{one.value:.1e}" for one in differences)),
        ("where", *(one.where if one.value else "–" for one in differences)),
    ]
    return Table(("", *names), tuple(lines), left=tuple(range(len(names) + 1)))


def _times(cold_s: float, warm_s: float) -> str:
    return " / ".join("–" if math.isnan(one) else f"{one:.0f}" for one in (cold_s, warm_s))


def _counts(figures: Figures, ranks: str) -> str:
    return ", ".join(map(str, figures.modes[ranks]))


def write_study(folders: Sequence[Path], out: Path) -> list[Difference]:
    """Compare the stacks of folders with the first and write the report."""
    names = [folder.name for folder in folders]
    every = [read_rows(folder / "rows.csv") for folder in folders]
    differences = [compare(every[0], rows) for rows in every]
    content = {
        "title": "The same answers on three stacks",
        "stacks": stack_table(names, [read_figures(folder) for folder in folders], differences),
        "reference": names[0],
        "same": f"{SAME:g}",
        "worst": f"{max(one.value for one in differences):.1e}",
        "met": all(one.value <= SAME for one in differences),
        "commit": provenance.commit(),
        "date": provenance.now(),
        "machine": provenance.machine(),
    }
    out.mkdir(parents=True, exist_ok=True)
    write_rows(out / "rows.csv", every[0])
    write_page(out, "stacks.md.j2", content)
    return differences


@click.command()
@click.argument("folders", nargs=-1, required=True, type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder for the report.")
def main(folders: tuple[Path, ...], out: Path) -> None:
    """Compare the stacks in FOLDERS with the first; exit code 3 if rows differ."""
    measured = [folder for folder in folders if (folder / "figures.json").exists()]
    differences = write_study(measured, out)
    for folder, one in zip(measured, differences, strict=True):
        click.echo(f"{folder.name}: {one.rows} rows, largest difference {one.value:.1e} ({one.where})")
    click.echo(f"report: {out / 'report.html'}")
    sys.exit(0 if all(one.value <= SAME for one in differences) else 3)


if __name__ == "__main__":
    main()
