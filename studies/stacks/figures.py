"""What this stack gives and costs: ``python -m studies.stacks.figures --out results/stacks/NAME``.

Runs the study in miniature, the exact scenes and the core of the paper study, all with compiled forms of their own; the
first and the last twice, without and with their forms compiled. Leaves rows.csv, every row of the three, and
figures.json.
"""

from __future__ import annotations

import json
import math
import shutil
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import click

from studies import mpi_children
from studies.results import provenance
from studies.results.rows import read_rows, write_rows
from studies.results.run_files import read_summary, write_text_atomically

RANKS = 2
INERTIA = provenance.ROOT / "tests" / "studies" / "models" / "inertia_script.py"
FIGURES_FILE = "figures.json"


@dataclass(frozen=True)
class Figures:
    """A stack's costs and counts.

    Attributes
    ----------
    versions
        Of the stack.
    blas
        Of one process.
    smoke_cold_s, smoke_warm_s
        Wall time of the study in miniature on two ranks, without and with its forms compiled, s.
    cold_s, warm_s
        The same of the paper study's core.
    peak_mb
        Largest peak memory of its runs, all ranks together, MB.
    modes
        Unstable modes of a body of 90,000 unknowns at rest and under pressures that nothing balances, by ranks.
    """

    versions: dict[str, str]
    blas: str
    smoke_cold_s: float
    smoke_warm_s: float
    cold_s: float
    warm_s: float
    peak_mb: float
    modes: dict[str, list[int]]


def measure(out: Path) -> Figures:
    """Run everything into a folder, which is emptied; see this module's heading."""
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    smoke = _cold_and_warm(out, "smoke")
    _run(out, "exact")
    core = _cold_and_warm(out, "paper", "--part", "core")
    write_rows(
        out / "rows.csv", [row for name in ("smoke", "exact", "paper") for row in read_rows(out / name / "rows.csv")]
    )
    summaries = [read_summary(file.parent) for file in (out / "paper").rglob("summary.json")]
    gmsh = _ended(out, [sys.executable, "-c", "import gmsh; print(gmsh.__version__)"]).out.strip()
    figures = Figures(
        {**provenance.versions(), "gmsh": gmsh},
        provenance.blas(),
        *smoke,
        *core,
        max(summary.peak_mb for summary in summaries),
        {str(ranks): _modes(out, ranks) for ranks in (1, RANKS)},
    )
    write_text_atomically(out / FIGURES_FILE, json.dumps(asdict(figures), indent=1))
    return figures


def read_figures(folder: Path) -> Figures:
    """Figures that `measure` left in a folder."""
    return Figures(**json.loads((folder / FIGURES_FILE).read_text(encoding="utf-8")))


def _cold_and_warm(out: Path, name: str, *options: str) -> tuple[float, float]:
    """Wall times of a study without and with its forms compiled, s; the second run is kept."""
    shutil.rmtree(out / "cache", ignore_errors=True)
    cold_s = _run(out, name, *options)
    shutil.rmtree(out / name)
    return cold_s, _run(out, name, *options)


def _run(out: Path, name: str, *options: str) -> float:
    """Run a study on two ranks into a folder of its name; wall time, s."""
    command = mpi_children.on_ranks(RANKS, "-m", "studies", "study", name, "--out", str(out / name), *options)
    wall_s = _ended(out, command).wall_s
    click.echo(f"{name}: {wall_s:.0f} s")
    return wall_s


def _modes(out: Path, ranks: int) -> list[int]:
    return list(json.loads(_ended(out, mpi_children.on_ranks(ranks, str(INERTIA))).out.splitlines()[-1])["modes"])


def _ended(out: Path, command: Sequence[str]) -> mpi_children.Ended:
    """Run a command with a folder of compiled forms that starts empty; a failure ends this process too."""
    ended = mpi_children.run(command, {**mpi_children.environment(), "XDG_CACHE_HOME": str(out / "cache")}, math.inf)
    if ended.code:
        sys.exit(f"{ended.error}\nended with {ended.code}: {' '.join(command)}")
    return ended


@click.command()
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder for the results; emptied.")
def main(out: Path) -> None:
    """Measure this stack: smoke, exact and core studies, cold and warm."""
    found = measure(out.absolute())
    click.echo(f"core cold {found.cold_s:.0f} s, warm {found.warm_s:.0f} s, peak {found.peak_mb:.0f} MB: {out}")


if __name__ == "__main__":
    main()
