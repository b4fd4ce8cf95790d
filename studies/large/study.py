"""Large bodies: time and memory of direct and iterative linear algebra over size, and where they cross.

Every point is a process of its own and kept; a stopped study goes on where it was.
``python -m studies.large.study --out results/large`` runs it.
"""

from __future__ import annotations

import json
import math
import os
import subprocess
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final

import click

from studies import launch
from studies.large.cell import LargeCell, Method
from studies.large.report import power_law, render_large
from studies.results import provenance
from studies.results.files import write_text_atomically
from studies.results.rows import Row, row, write_rows

METHODS: Final[tuple[Method, ...]] = ("direct", "iterative")
POINTS_FOLDER: Final = "points"
# A point is not tried if its memory, from a fit through those before, is above this share of the machine's.
MEMORY_SHARE: Final = 0.7


@dataclass(frozen=True)
class Size:
    """A body: a scene of ``scenes``, cells round its circumference, refinement of its meridian."""

    scene: str
    around: int
    refinement: int

    @property
    def label(self) -> str:
        """For file names."""
        return f"{self.scene}-n{self.around}r{self.refinement}"


# Bodies in order of size: 25,000 to 1.2 million unknowns.
SIZES: Final = (
    Size("smoke-t2-ri5", 8, 1),
    Size("smoke-t2-ri5", 16, 1),
    Size("heung-t2-ri5", 8, 1),
    Size("heung-t2-ri5", 16, 1),
    Size("heung-t2-ri5", 32, 1),
    Size("heung-t2-ri5", 24, 2),
    Size("heung-t2-ri5", 48, 2),
)
# The body that is measured on one rank and on two, for the estimate.
OF_SCALING: Final = SIZES[2]


@dataclass(frozen=True)
class Point:
    """A size, how it was solved, and what came of it; None if it was not tried, and then ``why`` says why."""

    size: Size
    method: Method
    ranks: int
    cell: LargeCell | None
    why: str = ""


def run_points(out: Path, sizes: Sequence[Size], ranks: int, minutes: float, limit: int | None) -> list[Point]:
    """Measure all sizes with both solvers on a number of ranks, and one size on one rank too.

    Parameters
    ----------
    out
        Points are kept here.
    sizes
        In order of size.
    ranks
        MPI ranks, one thread each.
    minutes
        Points are not begun after so many minutes, nor if the fit says that they would go far beyond.
    limit
        Only so many of the sizes; None for all.

    Returns
    -------
    list of Point
    """
    end = time.perf_counter() + 60.0 * minutes
    wanted = [(size, method, ranks) for size in sizes[:limit] for method in METHODS]
    if ranks > 1 and OF_SCALING in sizes[:limit]:
        wanted[4:4] = [(OF_SCALING, method, 1) for method in METHODS]
    points: list[Point] = []
    for size, method, count in wanted:
        kept = _kept(out, size, method, count)
        why = "" if kept is not None else _reason_not_to(points, size, method, end)
        if kept is None and not why:
            kept, why = _measured(out, size, method, count, max(60.0, end - time.perf_counter()))
        points.append(Point(size, method, count, kept, why))
        shown = f"{kept.unknowns} unknowns, {kept.iteration_s:.1f} s, {kept.peak_mb:.0f} MB" if kept else why
        click.echo(f"{size.label} {method}, ranks: {count}: {shown}")
    return points


def _file(out: Path, size: Size, method: Method, ranks: int) -> Path:
    return out / POINTS_FOLDER / f"{size.label}-{method}-{ranks}-{provenance.code_hash()}.json"


def _kept(out: Path, size: Size, method: Method, ranks: int) -> LargeCell | None:
    try:
        return LargeCell(**json.loads(_file(out, size, method, ranks).read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        return None


def _reason_not_to(points: Sequence[Point], size: Size, method: Method, end: float) -> str:
    """Why a point is not tried; empty if it is."""
    if time.perf_counter() > end:
        return "not tried: the time is over, go on with the same command"
    mine = [p.cell for p in points if p.method == method and p.cell is not None and not p.cell.failure]
    law = power_law(sorted(mine, key=lambda c: c.unknowns)[-3:], "peak_mb")
    if law is None:
        return ""
    # cells, and so unknowns, go with cells round the circumference and with the meridian's refinement squared
    unit = next(p for p in points if p.cell is mine[-1]).size
    if unit.scene != size.scene:
        return ""
    unknowns = mine[-1].unknowns * (size.around * size.refinement**2) / (unit.around * unit.refinement**2)
    memory = math.exp(law[0] + law[1] * math.log(unknowns))
    have = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**20
    if memory > MEMORY_SHARE * have:
        return f"not tried: about {unknowns:.0f} unknowns would need about {1e-3 * memory:.0f} GB"
    return ""


def _measured(out: Path, size: Size, method: Method, ranks: int, seconds: float) -> tuple[LargeCell | None, str]:
    """Measure a point in a child."""
    file = _file(out, size, method, ranks)
    file.parent.mkdir(parents=True, exist_ok=True)
    scene = provenance.ROOT / "scenes" / f"{size.scene}.toml"
    cell = (str(scene), str(size.around), str(size.refinement), method, str(file))
    command, environment = launch.on_ranks(ranks, "-m", "studies.large.cell", *cell), launch.environment()
    try:
        done = subprocess.run(
            command, cwd=provenance.ROOT, env=environment, capture_output=True, text=True, timeout=seconds, check=False
        )
    except subprocess.TimeoutExpired:
        return None, f"stopped after {seconds:.0f} s: the time is over"
    found = _kept(out, size, method, ranks)
    if found is None:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        write_text_atomically(file.with_suffix(".log"), done.stdout + done.stderr)
        return None, f"the process ended with code {done.returncode}: {last[:160]}"
    return found, ""


def rows_of(points: Sequence[Point]) -> list[Row]:
    """A row per number."""
    units = {"tangent_s": "s", "setup_s": "s", "solve_s": "s", "setup_cpu_s": "s", "solve_cpu_s": "s", "peak_mb": "MB"}
    rows = []
    for p in points:
        level = f"n{p.size.around}r{p.size.refinement}, {p.method}, ranks: {p.ranks}"
        if p.cell is None:
            rows.append(row(p.size.scene, "setup_s", "s", math.nan, "full3d", math.nan, level, status=p.why))
            continue
        status = f"failed: {p.cell.failure}" if p.cell.failure else "reached"
        for name, value in asdict(p.cell).items():
            if isinstance(value, int | float):
                rows.append(
                    row(
                        p.size.scene, name, units.get(name, "1"), math.nan, "full3d", float(value), level, status=status
                    )
                )
    return rows


@click.command()
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Folder for the results.")
@click.option("--ranks", default=2, show_default=True, help="MPI ranks of each point, one thread each.")
@click.option("--minutes", default=25.0, show_default=True, help="No point is begun after so many minutes.")
@click.option("--limit", default=None, type=int, help="Only so many of the sizes, the smallest first.")
def main(out: Path, ranks: int, minutes: float, limit: int | None) -> None:
    """Measure direct and iterative linear algebra on bodies of growing size; write rows, a plot and the report."""
    out.mkdir(parents=True, exist_ok=True)
    points = run_points(out, SIZES, ranks, minutes, limit)
    write_rows(out / "rows.csv", rows_of(points))
    measured = [p.cell for p in points if p.cell is not None]
    untried = [f"{p.size.label} {p.method}: {p.why}" for p in points if p.cell is None]
    click.echo(f"report: {render_large(out, measured, untried, ranks)}")


if __name__ == "__main__":
    main()
