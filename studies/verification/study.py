"""The verification table: every problem of this repository whose answer is exact, published or known by two routes.

Finite elements: all scenes of ``scenes/exact`` whose rows have a reference, by every model they have, with the observed
order of convergence. Formulas: the exact solutions themselves, by two routes each (`studies.two_routes`).
"""

from __future__ import annotations

import math
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import click

from studies import two_routes
from studies.engine import Page, Setting, Solved, Study
from studies.models.session import SCENE_FILE, SceneResult
from studies.planning.levels import fineness
from studies.report.labels import counted_along, quantity_label, run_label
from studies.report.numbers import number_text
from studies.report.tables import Table, table_of
from studies.results.rows import Row, row
from studies.scene.bodies import BodyScene
from studies.verification import exact, published
from studies.verification.published import Benchmark

# Two errors tell an order of convergence only above what Newton and the locating of crossings leave, relative.
NOISE: Final = 1e-8
ORDER_SUFFIX: Final = "_order"


@dataclass(frozen=True)
class Line:
    """A line of the table: a quantity of a problem by one model, at the load with the largest error on its finest mesh.

    Attributes
    ----------
    finest
        The row of the finest mesh at that load.
    order
        Observed order of convergence there; NaN if it cannot be told.
    loads
        Loads that were compared.
    counted
        What the mesh's cells are counted along.
    """

    finest: Row
    order: float
    loads: int
    counted: str = "round"


def cases(options: Mapping[str, Any]) -> list[BodyScene | Benchmark]:
    """All scenes with a reference, users' meshes have none; and names of those with a published answer."""
    with_reference = [scene for scene in exact.cases(options) if scene.geometry.kind != "mesh"]
    return [*with_reference, *published.benchmarks()]


def solve(scene: BodyScene | Benchmark, at: Setting) -> SceneResult[BodyScene]:
    """Every model of a scene, whose finished runs may be those of another folder; of a published one the cheapest."""
    if isinstance(scene, Benchmark):
        return published.solve(scene, at)
    folder, reuse = at.out / scene.name, at.options["reuse"]
    if at.comm.rank == 0 and reuse is not None and not folder.exists() and (reuse / scene.name / SCENE_FILE).exists():
        shutil.copytree(reuse / scene.name, folder)
    at.comm.barrier()
    return exact.solve_all_models(scene, at)


def page(solved: Sequence[Solved[BodyScene | Benchmark, SceneResult[BodyScene]]], at: Setting) -> Page:
    """The table of the solved scenes, of published answers, and of formulas by two routes."""
    lines: list[Line] = []
    compared: list[Row] = []
    printed: list[Row] = []
    for scene, result in ((done.case, done.result) for done in solved):
        if isinstance(scene, Benchmark):
            printed += published.rows(result)
            continue
        known = [row for row in result.rows if math.isfinite(row.reference)]
        lines += lines_of(known, counted_along(scene.geometry.kind))
        compared += known
    formulas = two_routes.all_routes()
    content = {
        "problems": problems(lines),
        "published": published.table(printed),
        "formulas": two_routes.table(formulas),
        "worst": f"{max(one.difference for one in formulas):.1e}",
        "goal": f"{two_routes.GOAL:.0e}",
    }
    rows = [
        *compared,
        *printed,
        *(_order_row(line) for line in lines if math.isfinite(line.order)),
        *two_routes.rows(formulas),
    ]
    stopped = [f"{d.result.scene.name}: {d.result.reason}" for d in solved if not d.result.reached]
    return Page(rows, content, stopped, bars=[published.bar(printed)])


def lines_of(compared: Sequence[Row], counted: str = "round") -> list[Line]:
    """Lines of the rows that have a reference; cells of their meshes are counted round the axis or along an edge."""
    lines = []
    for scene, quantity, model in dict.fromkeys((r.scene, r.quantity, r.model) for r in compared):
        mine = [r for r in compared if (r.scene, r.quantity, r.model) == (scene, quantity, model)]
        finest = max((r.level for r in mine), key=fineness)
        ends = [r for r in mine if r.level == finest]
        worst = max(ends, key=lambda r: abs(r.error_percent) if math.isfinite(r.error_percent) else math.inf)
        at_load = [r for r in mine if same_load(r, worst)]
        lines.append(Line(worst, observed_order(at_load), len(ends), counted))
    return lines


def observed_order(rows: Sequence[Row]) -> float:
    """Order of convergence from the errors of the two finest meshes, ``ln(e1/e2) / ln(h1/h2)``.

    Against a reference that is not exact the differences of the three finest meshes are used instead, as the
    reference's own error would stand in the way.

    Returns
    -------
    float
        NaN where there are too few meshes, where errors are at round-off or change their sign.
    """
    known = sorted((r for r in rows if math.isfinite(r.value)), key=lambda r: fineness(r.level))
    if len(known) < 2:
        return math.nan
    sizes = [1.0 / fineness(r.level) for r in known]
    if known[-1].source.startswith("exact"):
        coarse, fine = (0.01 * r.error_percent for r in known[-2:])
        if min(abs(coarse), abs(fine)) <= NOISE or coarse * fine < 0.0:
            return math.nan
        return math.log(coarse / fine) / math.log(sizes[-2] / sizes[-1])
    if len(known) < 3:
        return math.nan
    (h1, h2, h3), (f1, f2, f3) = sizes[-3:], [r.value for r in known[-3:]]
    if f2 == f3 or (f1 - f2) / (f2 - f3) <= 0.0:
        return math.nan
    low, high = 0.01, 10.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        if (h1**middle - h2**middle) / (h2**middle - h3**middle) < (f1 - f2) / (f2 - f3):
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def same_load(a: Row, b: Row) -> bool:
    """True if two rows are of one load; rows of whole paths have none."""
    if math.isnan(a.pressure_kpa) or math.isnan(b.pressure_kpa):
        return math.isnan(a.pressure_kpa) and math.isnan(b.pressure_kpa)
    return math.isclose(a.pressure_kpa, b.pressure_kpa, rel_tol=1e-9)


def _order_row(line: Line) -> Row:
    r = line.finest
    return row(r.scene, r.quantity + ORDER_SUFFIX, "1", r.pressure_kpa, r.model, line.order, r.level)


def problems(lines: Sequence[Line]) -> Table:
    """A line per problem, quantity and model."""
    columns = {
        "problem": lambda line: line.finest.scene,
        "quantity": lambda line: quantity_label(line.finest.quantity),
        "model and mesh": lambda line: run_label(line.finest.model, line.finest.level, counted=line.counted),
        "load, kPa": lambda line: number_text(line.finest.pressure_kpa or math.nan, "g"),
        "value": lambda line: _value(line.finest),
        "reference": lambda line: f"{line.finest.reference:.6g}",
        "error, %": lambda line: number_text(line.finest.error_percent, "+.2g").replace("-", "\N{MINUS SIGN}"),
        "order": lambda line: number_text(line.order, ".1f"),
        "source": lambda line: line.finest.source,
    }
    return table_of(lines, columns, left=(0, 1, 2, 8))


def _value(entry: Row) -> str:
    if not math.isfinite(entry.value):
        return entry.status
    return f"{entry.value:.6g}" + ("" if math.isnan(entry.uncertainty) else f" ± {entry.uncertainty:.1g}")


STUDY: Final = Study(
    name="verification",
    title="Verification: exact and published problems, and what this program gives",
    question="What does the program give for every problem whose answer is exact, published or known by two routes?",
    template="verification/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="all",
    options=(
        click.Option(
            ["--reuse"],
            type=click.Path(path_type=Path),
            help="Take over finished runs from this folder, such as results/exact.",
        ),
    ),
)
