"""Tables of what the paper study costs: wall time (s) by model and activity, and memory (MB)."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Final

from studies.paper.cases import REFERENCE_SCENES
from studies.paper.numbers import finest, named
from studies.paper.results import CaseResult, PaperResults
from studies.report.labels import level_label
from studies.report.numbers import MISSING, count, short_time
from studies.report.scene_tables import times_of, work_of
from studies.report.tables import Table
from studies.results.files import RunSummary
from studies.results.runs import Run

TETS: Final = "full 3D, tetrahedra"


def _runs(case: CaseResult) -> tuple[Run, ...]:
    result = case.result
    return result.runs


def by_model(results: PaperResults, wall_s: Mapping[str, float]) -> Table:
    """Runs, wall time (s) and largest run of each model over all cases; the closed form's time is the caller's."""
    closed_s = wall_s.get("closed form", math.nan)
    lines = [("closed form, all chains", MISSING, _seconds(closed_s), MISSING, MISSING, MISSING)]
    for label, runs in _models(results).items():
        seconds = [run.time_s.get("total", math.nan) for run in runs]
        lines.append(
            (
                label,
                f"{len(runs)}",
                _seconds(sum(seconds)) if runs else MISSING,
                _seconds(max(seconds)) if runs else MISSING,
                count(max(run.dofs for run in runs)) if runs else MISSING,
                f"{max(run.peak_mb for run in runs):.0f}" if runs else MISSING,
            )
        )
    header = ("model", "runs", "all runs, s", "longest run, s", "most unknowns", "largest peak memory, MB")
    return Table(header, tuple(lines))


def _models(results: PaperResults) -> dict[str, list[RunSummary]]:
    found: dict[str, list[RunSummary]] = {"axisymmetric": [], "sector": [], "full 3D": [], TETS: []}
    for case in results.cases:
        for run in _runs(case):
            label = {"axisymmetric": "axisymmetric", "sector": "sector"}.get(run.summary.model, "full 3D")
            found[TETS if label == "full 3D" and case.case.group == "tets" else label].append(run.summary)
    return found


def split(results: PaperResults) -> Table:
    """Wall time (s) by activity of the finest run of each model, by reference actuator."""
    runs = _finest_runs(results)
    return times_of(list(runs.values()), list(runs))


def work(results: PaperResults) -> Table:
    """Size, work and peak memory (MB) of the same runs."""
    runs = _finest_runs(results)
    return work_of(list(runs.values()), list(runs))


def _finest_runs(results: PaperResults) -> dict[str, RunSummary]:
    """Finest run of each model of each reference actuator by what a table calls it."""
    found: dict[str, RunSummary] = {}
    for name in REFERENCE_SCENES:
        case, tets = named(results, name), results.variant(name, "tets")
        solved: Iterable[tuple[str, CaseResult | None]]
        solved = (("axisymmetric", case), ("sector", case), ("full3d", case), ("full3d", tets))
        for model, of in solved:
            run = finest(getattr(of.result, model)) if of else None
            if run is not None:
                label = TETS if of is tets else model.replace("full3d", "full 3D")
                found[f"{name}, {label}, {level_label(run.summary.level)}"] = run.summary
    return found


def _seconds(value: float) -> str:
    return short_time(value) if math.isfinite(value) else MISSING


def core_seconds(results: PaperResults) -> float:
    """Seconds of all runs of the four actuators without the variants, one after the other."""
    runs = [run for case in results.of("core") for run in case.result.runs]
    return sum(run.summary.time_s["total"] for run in runs)
