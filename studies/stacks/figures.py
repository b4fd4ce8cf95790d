"""What this stack gives and costs: ``python -m studies.stacks.figures --out results/stacks/NAME``.

Runs the study in miniature, the exact scenes and the core of the paper study, all with compiled forms of their own; the
first twice, without and with its forms compiled. Leaves rows.csv, every row of the three, and figures.json.
"""

from __future__ import annotations

import json
import math
import os
import resource
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
    core_s
        The same of the paper study's core, nothing compiled.
    others_percent
        What other processes took of the machine's processors meanwhile, %.
    peak_mb
        Largest peak memory of its runs, all ranks together, MB.
    modes
        Unstable modes of a body of 90,000 unknowns at rest and under pressures that nothing balances, by ranks.
    """

    versions: dict[str, str]
    blas: str
    smoke_cold_s: float
    smoke_warm_s: float
    core_s: float
    others_percent: float
    peak_mb: float
    modes: dict[str, list[int]]


def measure(out: Path) -> Figures:
    """Run everything into a folder, which is emptied; see this module's heading."""
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    begun, own = _busy_s(), _own_s()
    smoke_cold_s = _run(out, "smoke")
    shutil.rmtree(out / "smoke")
    smoke_warm_s = _run(out, "smoke")
    _run(out, "exact")
    shutil.rmtree(out / "cache")
    core_s = _run(out, "paper", "--part", "core")
    (busy_s, all_s), own_s = (now - then for now, then in zip(_busy_s(), begun, strict=True)), _own_s() - own
    write_rows(
        out / "rows.csv", [row for name in ("smoke", "exact", "paper") for row in read_rows(out / name / "rows.csv")]
    )
    summaries = [read_summary(file.parent) for file in (out / "paper").rglob("summary.json")]
    gmsh = _ended(out, [sys.executable, "-c", "import gmsh; print(gmsh.__version__)"]).out.strip()
    figures = Figures(
        {**provenance.versions(), "gmsh": gmsh},
        provenance.blas(),
        smoke_cold_s,
        smoke_warm_s,
        core_s,
        100.0 * max(busy_s - own_s, 0.0) / all_s,
        max(summary.peak_mb for summary in summaries),
        {str(ranks): _modes(out, ranks) for ranks in (1, RANKS)},
    )
    write_text_atomically(out / FIGURES_FILE, json.dumps(asdict(figures), indent=1))
    return figures


def read_figures(folder: Path) -> Figures:
    """Figures that `measure` left in a folder."""
    return Figures(**json.loads((folder / FIGURES_FILE).read_text(encoding="utf-8")))


def _busy_s() -> tuple[float, float]:
    """What all processors were busy and were there since the machine started, s, by the kernel's count."""
    ticks = [int(part) for part in Path("/proc/stat").read_text(encoding="ascii").split("\n")[0].split()[1:9]]
    tick_s = 1.0 / os.sysconf("SC_CLK_TCK")
    return (sum(ticks) - ticks[3] - ticks[4]) * tick_s, sum(ticks) * tick_s


def _own_s() -> float:
    """Processor time of this process and of those it has waited for, s."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


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
    """Measure this stack: smoke, exact and core studies."""
    found = measure(out.absolute())
    click.echo(f"core {found.core_s:.0f} s, others {found.others_percent:.0f} %, peak {found.peak_mb:.0f} MB: {out}")


if __name__ == "__main__":
    main()
