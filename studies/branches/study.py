"""The branch study: paths whose volume turns back, and branches beyond buckling, beside what is known of them."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final

import click
import numpy as np
from mpi4py import MPI

from studies.branches import exact, squirm
from studies.branches.findings import Findings, Point
from studies.engine import Page, Setting, Solved, Study
from studies.first_rank import first
from studies.report.numbers import count, duration, number_text
from studies.report.style import BLACK, BLUE, ORANGE, VERMILION, figure_file
from studies.report.tables import Table, table_of
from studies.results import provenance
from studies.results.kept import content_key, keep, read_kept
from studies.results.rows import Row, row

COLOURS: Final = (BLUE, VERMILION, ORANGE)
# Files beside the solver that decide numbers.
SOURCES: Final = (*(Path(__file__).with_name(name) for name in ("exact.py", "findings.py", "squirm.py")), squirm.SCENE)


@dataclass(frozen=True)
class Case:
    """A case.

    Attributes
    ----------
    name, solve
        What it is called, and what comes out on some ranks.
    axes
        What is drawn over what: labels of both axes, abscissa first.
    drawn
        Both numbers of a point.
    on_all_ranks
        True if all ranks share it; else rank 0 solves it.
    """

    name: str
    solve: Callable[[MPI.Comm], Findings]
    axes: tuple[str, str]
    drawn: Callable[[Point], tuple[float, float]] = lambda p: (p.move, p.load_kpa)
    on_all_ranks: bool = False


CASES: Final = (
    Case(
        "two-spheres",
        exact.two_spheres,
        ("volume of both, mm³", "pressure, kPa"),
        drawn=lambda p: (p.volume_mm3, p.load_kpa),
    ),
    Case("cube", exact.rivlin_cube, ("stretch", "tension, kPa")),
    Case("ring", exact.thin_ring, ("outward move of the long axis, of the radius", "outside pressure, kPa")),
    Case(
        squirm.NAME,
        squirm.blocked_bellows,
        ("pressure, kPa", "force on the blocked tip, N"),
        drawn=lambda p: (p.load_kpa, p.force_n),
        on_all_ranks=True,
    ),
)


def cases(options: Mapping[str, Any]) -> list[Case]:
    """The cases that are asked for, or all."""
    return [case for case in CASES if case.name in options["case"] or not options["case"]]


def solve(case: Case, at: Setting) -> Findings:
    """What is kept of a case, or comes out of it; every rank calls."""
    file = at.out / "cases" / f"{case.name}.json"
    key = content_key(case.name, provenance.code_hash(), sources=SOURCES)
    found = first(at.comm, lambda: read_kept(file, key, Findings))
    if found is None:
        begin = time.perf_counter()
        found = case.solve(at.comm) if case.on_all_ranks else first(at.comm, lambda: case.solve(MPI.COMM_SELF))
        found = dataclasses.replace(found, seconds=time.perf_counter() - begin)
        if at.comm.rank == 0:
            keep(file, key, found)
    return found


def rows_of(name: str, found: Findings) -> list[Row]:
    """Rows of a case: its numbers, and each state beside the exact load where that is known."""
    rows = list(found.facts)
    for branch, p in ((branch, p) for branch, points in found.branches.items() for p in points):
        at = partial(row, name, pressure_kpa=p.load_kpa, model="fem", level=branch)
        source = "" if math.isnan(p.exact_kpa) else f"exact at {p.move:.6g}"
        rows.append(at("load_kpa", "kPa", value=p.load_kpa, reference=p.exact_kpa, source=source))
        rows.append(at("unstable_modes", "", value=float(p.unstable)))
        if not math.isnan(p.force_n):
            rows.append(at("tip_force_n", "N", value=p.force_n))
            rows.append(at("sideways_mm", "mm", value=p.move))
    return rows


def branch_table(branches: Mapping[str, Sequence[Point]]) -> Table:
    """A line per path or branch."""

    def off(points: Sequence[Point]) -> float:
        known = [p for p in points if not math.isnan(p.exact_kpa)]
        return max((abs(100.0 * (p.load_kpa / p.exact_kpa - 1.0)) for p in known), default=math.nan)

    columns: dict[str, Callable[[tuple[str, Sequence[Point]]], str]] = {
        "path or branch": lambda b: b[0],
        "states": lambda b: str(len(b[1])),
        "load, kPa": lambda b: f"{min(p.load_kpa for p in b[1]):.5g} to {max(p.load_kpa for p in b[1]):.5g}",
        "off exact, % at most": lambda b: number_text(off(b[1]), ".2g"),
        "unstable modes on the way": lambda b: " ".join(dict.fromkeys(str(p.unstable) for p in b[1])),
        "at held volume": lambda b: " ".join(dict.fromkeys(str(p.unstable_at_volume) for p in b[1])),
        "control": lambda b: ", ".join(dict.fromkeys(p.control for p in b[1])),
    }
    return table_of(branches.items(), columns, left=(0, 4, 5, 6))


def fact_table(facts: Sequence[Row]) -> Table:
    """Numbers of a case beside their references."""
    columns: dict[str, Callable[[Row], str]] = {
        "what": lambda r: r.quantity,
        "unit": lambda r: r.unit,
        "found": lambda r: f"{r.value:.6g}",
        "reference": lambda r: number_text(r.reference, ".6g"),
        "source": lambda r: r.source,
        "off, %": lambda r: number_text(r.error_percent, "+.4f"),
    }
    return table_of(facts, columns, left=(0, 1, 4))


def draw(path: Path, case: Case, branches: Mapping[str, Sequence[Point]]) -> None:
    """Draw the branches of a case, stable states filled, and crosses for exact loads."""
    with figure_file(path, 5.6, 3.8) as figure:
        axes = figure.subplots()
        for colour, (name, points) in zip(COLOURS, branches.items(), strict=False):
            at, stable = np.array([case.drawn(p) for p in points]), np.array([p.unstable == 0 for p in points])
            axes.plot(*at.T, "-", color=colour, linewidth=1.0, label=name)
            axes.plot(*at[stable].T, "o", color=colour, markersize=4)
            axes.plot(*at[~stable].T, "o", color=colour, markerfacecolor="white", markersize=4)
            axes.plot(at[:, 0], [p.exact_kpa for p in points], "+", color=BLACK, markersize=6)
        axes.set_xlabel(case.axes[0])
        axes.set_ylabel(case.axes[1])
        axes.legend(frameon=False, fontsize=8)


def page(solved: Sequence[Solved[Case, Findings]], at: Setting) -> Page:
    """A section with a picture and two tables per case."""
    rows, sections = [], {}
    for case, found in ((done.case, done.result) for done in solved):
        rows += rows_of(case.name, found)
        picture = f"pictures/{case.name}.png"
        draw(at.out / picture, case, found.branches)
        sections[case.name] = {
            "picture": picture,
            "branches": branch_table(found.branches),
            "facts": fact_table(found.facts),
            "unknowns": count(found.unknowns),
            "seconds": duration(found.seconds),
        }
    return Page(rows, {"sections": sections})


STUDY: Final = Study(
    name="branches",
    title="Beyond limit points and bifurcations: paths by arc length, branches, a bellows that squirms",
    question="Are paths beyond limit points and branches beyond buckling those that are known exactly?",
    template="branches/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="all",
    options=(
        click.Option(
            ["--case"],
            multiple=True,
            type=click.Choice([case.name for case in CASES]),
            help="Only these; default all.",
        ),
    ),
)
