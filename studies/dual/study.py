"""The study of estimated errors: richer spaces and dual-weighted residuals on one mesh beside three finer meshes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import click

from solvers.errors import StepFailed
from solvers.estimate.dual import DualEstimate, dual_estimates, goal_of
from solvers.estimate.enriched import Enriched
from studies.dual.cases import Case, twenty
from studies.engine import Bar, Page, Setting, Solved, Study
from studies.models.axisymmetric import run_axisymmetric
from studies.models.errors.estimates import errors_of, richer_problem
from studies.report.numbers import MISSING, number_text
from studies.report.panels import Panel, Series, draw_panels
from studies.report.style import BLACK, BLUE, ORANGE, VERMILION
from studies.report.tables import Table, table_of
from studies.results.body_rows import SMOOTH
from studies.results.rows import Row, row
from studies.results.run_files import load_state
from studies.results.runs import MERIDIAN_ORDERS, Run, run_convergence, tip_at
from studies.results.uncertainty import Convergence
from studies.scene.bellows import BellowsScene
from studies.scene.load import Scene

# The meshes whose limit stands for the truth.
FINER: Final = (2, 4, 8)
ENOUGH, FACTOR = 0.9, 2.0
NO_DUAL: Final = DualEstimate(math.nan, math.nan)


@dataclass(frozen=True)
class Estimate:
    """A quantity of a state and its error, in mm; what is to be added to it.

    Attributes
    ----------
    load_kpa, quantity, value
        The state, and what it says.
    true, doubt
        Error by three finer meshes, and how far that may be off.
    richer
        By the equilibrium in richer spaces; NaN where none is found.
    dual
        By the dual-weighted residual; NaN where the tangent is singular.
    """

    load_kpa: float
    quantity: str
    value: float
    true: float
    doubt: float
    richer: float
    dual: DualEstimate

    def percent(self, error: float) -> float:
        """An error in percent of the value's size."""
        return 100.0 * error / abs(self.value)

    def ratio(self, error: float) -> float:
        """An estimated error over the true one."""
        return error / self.true


@dataclass(frozen=True)
class Result:
    """Estimates of a case, and factorisations: of all of them, of the path itself and on the next mesh."""

    estimates: tuple[Estimate, ...]
    made: int
    of_path: int
    of_next: int

    @property
    def last(self) -> Estimate:
        """That of the scene's first quantity at its highest load."""
        highest = max(self.estimates, key=lambda e: e.load_kpa).load_kpa
        return next(e for e in self.estimates if e.load_kpa == highest)


def solve(case: Case, at: Setting) -> Result:
    """Runs of a scene on four meridians, and estimates on the first."""
    scene, home = case.scene, at.out / case.scene.name
    runs = [_run(scene, n, home / f"axisymmetric-r{n}", at) for n in (1, *FINER)]
    first, folder = runs[0], home / "axisymmetric-r1"
    loads = [entry.pressure_kpa for entry in first.requested]
    saved = (load_state(folder, first.summary.content_hash, 1e-3 * load) for load in loads)
    states = [found[0] for found in saved if found is not None]
    problem, quantities = richer_problem(scene, "r1")
    enriched = Enriched(problem)
    richer = list(errors_of(enriched, states, quantities))
    made = enriched.factor.count
    goals = [goal_of(value, states[0]) for value in quantities.values()]
    estimates = []
    for load, state, errors in zip(loads, states, richer, strict=True):
        try:
            duals = dual_estimates(problem, enriched.factor, state, goals)
        except StepFailed:
            duals = [NO_DUAL] * len(goals)
        for (name, function), dual in zip(quantities.items(), duals, strict=True):
            limit = _limit(scene, runs[1:], load, name)
            value = function(state)
            doubt = limit.uncertainty(_at(scene, runs[-1], load, name))
            estimates.append(Estimate(load, name, value, limit.limit - value, doubt, errors[name], dual))
    return Result(tuple(estimates), made, first.summary.factorisations, runs[1].summary.factorisations)


def _run(scene: Scene, refinement: int, folder: Path, at: Setting) -> Run:
    if isinstance(scene, BellowsScene):
        return run_axisymmetric(scene, refinement, folder, at.comm, at.progress)
    from studies.models.body import run_simple_body

    return run_simple_body(scene, "axisymmetric", f"r{refinement}", folder, at.comm, at.progress)


def _at(scene: Scene, run: Run, load: float, quantity: str) -> float:
    return tip_at(run, load) if isinstance(scene, BellowsScene) else run.measured_at(load, quantity)


def _limit(scene: Scene, runs: Sequence[Run], load: float, quantity: str) -> Convergence:
    edges = isinstance(scene, BellowsScene) or getattr(scene.geometry, "ends", "") == "bonded"
    values = [_at(scene, run, load, quantity) for run in runs]
    return run_convergence(runs, values, MERIDIAN_ORDERS if edges else SMOOTH)


# --- what is shown ------------------------------------------------------------------------------------------

Solutions = Sequence[Solved[Case, Result]]
WAYS: Final = {
    "richer spaces": lambda e: e.richer,
    "dual-weighted residual": lambda e: e.dual.error,
    "its first term": lambda e: e.dual.first,
}


def rows_of(solved: Solutions) -> list[Row]:
    """A row for each estimate, the true error its reference."""
    rows = []
    for done in solved:
        for e in done.result.estimates:
            at = (done.case.scene.name, f"error of {e.quantity}", "mm", e.load_kpa)
            for way, of in WAYS.items():
                rows.append(row(*at, way, of(e), "r1", reference=e.true, source="limit of r2, r4, r8"))
    return rows


def highest_loads(solved: Solutions) -> Table:
    """A line per scene, at its highest load."""

    def percent(error: Any) -> Any:
        return lambda done: number_text(done.result.last.percent(error(done.result.last)), "+.2g")

    def ratio(error: Any) -> Any:
        return lambda done: number_text(done.result.last.ratio(error(done.result.last)), ".2f")

    columns: dict[str, Any] = {
        "scene": lambda done: done.case.name,
        "kPa": lambda done: f"{done.result.last.load_kpa:g}",
        "quantity": lambda done: done.result.last.quantity,
        "true error, %": percent(lambda e: e.true),
        "± %": lambda done: number_text(done.result.last.percent(done.result.last.doubt), ".1g"),
        "estimate, %": percent(WAYS["richer spaces"]),
    }
    columns |= {f"{way}: ratio": ratio(of) for way, of in WAYS.items()}
    columns["factorisations: estimate / r2"] = lambda done: f"{done.result.made} / {done.result.of_next}"
    return table_of(solved, columns, left=(0, 2))


def right(estimates: Sequence[Estimate], way: str) -> tuple[int, int]:
    """How many estimates of a way are within a factor of two of the true error, and how many have its sign."""
    ratios = [e.ratio(WAYS[way](e)) for e in estimates]
    return sum(1.0 / FACTOR <= r <= FACTOR for r in ratios), sum(r > 0.0 for r in ratios)


def counts(solved: Solutions) -> Table:
    """By way: how many are right, at the highest loads and at all."""
    last = [done.result.last for done in solved]
    every = [e for done in solved for e in done.result.estimates]
    lines = []
    for way in WAYS:
        cells = [f"{n} of {len(of)}" for of in (last, every) for n in right(of, way)]
        lines.append((way, *cells))
    header = ("way", "within a factor of 2", "sign right", "all loads: within a factor of 2", "all loads: sign right")
    return Table(header, tuple(lines))


def bars_of(solved: Solutions) -> list[Bar]:
    """Within a factor of two, and the sign right, in nine of ten scenes."""
    last = [done.result.last for done in solved]
    within, signs = right(last, "richer spaces")
    enough = math.ceil(ENOUGH * len(last))
    return [
        Bar(f"estimate within a factor of {FACTOR:g} in {enough} of {len(last)}", str(within), within >= enough),
        Bar(f"sign right in {enough} of {len(last)}", str(signs), signs >= enough),
    ]


def draw_errors(path: Path, solved: Solutions) -> None:
    """Draw sizes of estimated errors over those of true ones, %, at the highest loads."""
    last = [done.result.last for done in solved]
    ends = [1e-5, 2.0]
    guide = {"color": BLACK, "linewidth": 0.8}
    series = [Series(ends, [f * x for x in ends], {**guide, "linestyle": dash}) for f, dash in _GUIDES]
    for way, colour, marker in (
        ("its first term", VERMILION, "x"),
        ("dual-weighted residual", ORANGE, "s"),
        ("richer spaces", BLUE, "o"),
    ):
        points = [(e.percent(e.true), e.percent(WAYS[way](e))) for e in last]
        for said, chosen in ((way, True), ("", False)):
            of = [(abs(x), abs(y)) for x, y in points if (x * y > 0.0) == chosen and math.isfinite(y)]
            fill = {} if chosen else {"markerfacecolor": "none"}
            look = {"color": colour, "marker": marker, "linestyle": "none", "markersize": 5.0, **fill}
            series.append(Series([x for x, _ in of], [y for _, y in of], look, said))
    panel = Panel(series, "true error, %", "estimated error, %", logarithmic="xy")
    draw_panels(path, [[panel]], (5.6, 5.0), {"loc": "lower right", "fontsize": 8.0})


_GUIDES: Final = ((1.0, "-"), (0.5, ":"), (2.0, ":"))


def page(solved: Solutions, at: Setting) -> Page:
    """One table at the highest loads, one of counts, one picture."""
    draw_errors(at.out / "pictures" / "errors.png", solved)
    missing = [f"{d.case.name}: {MISSING}" for d in solved if not d.result.estimates]
    content = {"highest": highest_loads(solved), "counts": counts(solved)}
    return Page(rows_of(solved), content, missing, bars_of(solved))


def cases(options: Mapping[str, Any]) -> list[Case]:
    """All, or those whose names hold a text."""
    return [case for case in twenty() if options["scene"] in case.name]


STUDY: Final = Study(
    name="dual",
    title="Errors with a sign",
    question="How near to the true discretisation error is what one mesh says of it?",
    template="dual/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    options=(click.Option(["--scene"], default="", help="Only scenes whose names hold this text."),),
)
