"""Large bodies: time and memory of direct and iterative linear algebra over size, and where they cross.

Every point is a process of its own; those before decide whether there is memory for the next one.
"""

from __future__ import annotations

import itertools
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import click

from studies import mpi_children
from studies.engine import Page, Setting, Solved, Study
from studies.large.cases import Point, cases
from studies.large.fits import power_law
from studies.large.measure import Measured
from studies.large.tables import crossings, draw, fits_table, points_table, rows_of, scaling_table
from studies.results import provenance
from studies.results.kept import content_key, read_kept
from studies.results.run_files import write_text_atomically

# A point is not tried if its memory, from a fit through those before, is above this share of the machine's.
MEMORY_SHARE: Final = 0.7


def solve(point: Point, at: Setting) -> Measured | str:
    """A point from its file or measured in a child, or why it is not: no time, no memory, no success."""
    result = kept_point(point, at.out) or _attempt(point, at)
    shown = result
    if isinstance(result, Measured):
        shown = f"{result.unknowns} unknowns, {result.iteration_s:.1f} s, {result.peak_mb:.0f} MB"
    click.echo(f"{point.name}: {shown}")
    return result


def _attempt(point: Point, at: Setting) -> Measured | str:
    earlier = itertools.takewhile(lambda other: other.name != point.name, cases(at.options))
    why = reason_not_to([(other, kept_point(other, at.out)) for other in earlier], point)
    why = why or measure_in_child(point, *_place(point, at.out))
    return kept_point(point, at.out) or why


def kept_point(point: Point, out: Path) -> Measured | None:
    """What has been measured of a point."""
    return read_kept(*_place(point, out), Measured)


def _place(point: Point, out: Path) -> tuple[Path, str]:
    """File and key of what is measured of a point."""
    key = content_key(point.size, point.method, point.ranks, provenance.code_hash())
    return (out / "points" / f"{point.label}.json").absolute(), key


def reason_not_to(before: Sequence[tuple[Point, Measured | None]], point: Point) -> str:
    """Why a point is not tried after those before; empty if it is."""
    if time.perf_counter() > point.until_s:
        return "not tried: the time is over, go on with the same command"
    done = [(p.size, m) for p, m in before if m is not None and p.method == point.method and not m.failure]
    law = power_law(sorted((m for _, m in done), key=lambda m: m.unknowns)[-3:], "peak_mb")
    if law is None or done[-1][0].scene != point.size.scene:
        return ""
    size, last = done[-1]
    # cells, and so unknowns, go with cells round the circumference and with the meridian's refinement squared
    growth = (point.size.around * point.size.refinement**2) / (size.around * size.refinement**2)
    unknowns = last.unknowns * growth
    memory_mb = law.at(unknowns)
    have_mb = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**20
    if memory_mb > MEMORY_SHARE * have_mb:
        return f"not tried: about {unknowns:.0f} unknowns would need about {1e-3 * memory_mb:.0f} GB"
    return ""


def measure_in_child(point: Point, file: Path, key: str) -> str:
    """Measure a point in a process of its own, which keeps it; why there is nothing, empty if there is."""
    scene, size = provenance.ROOT / "scenes" / f"{point.size.scene}.toml", point.size
    arguments = (str(scene), str(size.around), str(size.refinement), point.method, str(file), key)
    limit_s = max(60.0, point.until_s - time.perf_counter())
    command = mpi_children.on_ranks(point.ranks, "-m", "studies.large.measure", *arguments)
    ended = mpi_children.run(command, mpi_children.environment(), limit_s)
    if read_kept(file, key, Measured) is not None:
        return ""
    if ended.wall_s > limit_s:
        return f"stopped after {limit_s:.0f} s: the time is over"
    file.parent.mkdir(parents=True, exist_ok=True)
    write_text_atomically(file.with_suffix(".log"), ended.out + ended.error)
    last = (ended.error.strip().splitlines() or ["no message"])[-1]
    return f"the process ended with code {ended.code}: {last[:160]}"


def page(solved: Sequence[Solved[Point, Measured | str]], at: Setting) -> Page:
    """Points, where the solvers cross, and the estimate for more ranks."""
    measured = [one.result for one in solved if isinstance(one.result, Measured)]
    done = [m for m in measured if not m.failure]
    mine = [m for m in done if m.ranks == at.options["ranks"]]
    draw(at.out / "pictures" / "large.png", mine)
    content = {
        "points": points_table(measured),
        "untried": [f"{one.case.name}: {one.result}" for one in solved if isinstance(one.result, str)],
        "crossings": crossings(mine),
        "fits": fits_table(mine),
        "ranks": at.options["ranks"],
        "scaling": scaling_table(done),
    }
    return Page([row for one in solved for row in rows_of(one.case, one.result)], content)


STUDY: Final = Study(
    name="large",
    title="Large bodies: direct and iterative linear algebra",
    question="From which size on is an iterative solver cheaper than a factorisation, in time and in memory?",
    template="large/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="first",
    options=(
        click.Option(["--ranks"], default=2, show_default=True, help="MPI ranks of each point, one thread each."),
        click.Option(["--minutes"], default=25.0, show_default=True, help="No point begins after so many minutes."),
        click.Option(["--limit"], default=None, type=int, help="Only so many of the sizes, the smallest first."),
    ),
)
