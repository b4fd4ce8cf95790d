"""Tables of what the paper study costs: wall time (s) by model and activity, and memory (MB)."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import Final

from analytical.bellows import chains
from studies.paper.cases import PRESSURES_KPA, REFERENCE, REFERENCE_SCENES
from studies.paper.results import PaperResults
from studies.report.labels import level_label, model_label
from studies.report.numbers import MISSING, count, short_time
from studies.report.scene_tables import times_of, work_of
from studies.report.tables import Table, table_of
from studies.results.run_files import RunSummary

TETS: Final = "full 3D, tetrahedra"


def by_model(results: PaperResults) -> Table:
    """Runs, wall time (s) and largest run of each model over all cases."""
    runs: dict[str, list[RunSummary]] = {label: [] for label in ("axisymmetric", "full 3D", TETS)}
    for case in results.cases:
        for run in case.runs:
            in_tets = case.case.group == "tets" and run.summary.model == "full3d"
            runs[TETS if in_tets else model_label(run.summary.model)].append(run.summary)

    def largest(value: Callable[[RunSummary], float], text: Callable[[float], str]) -> Callable[[str], str]:
        return lambda label: text(max(map(value, runs[label]))) if runs[label] else MISSING

    columns: dict[str, Callable[[str], str]] = {
        "model": str,
        "runs": lambda label: f"{len(runs[label])}",
        "all runs, s": lambda label: short_time(seconds(runs[label])) if runs[label] else MISSING,
        "longest run, s": largest(lambda run: run.time_s["total"], short_time),
        "most unknowns": largest(lambda run: run.dofs, lambda dofs: count(int(dofs))),
        "largest peak memory, MB": largest(lambda run: run.peak_mb, "{:.0f}".format),
    }
    found = table_of(runs, columns)
    closed_form = ("closed form, all chains", MISSING, short_time(closed_form_seconds()), MISSING, MISSING, MISSING)
    return Table(found.header, (closed_form, *found.rows))


def closed_form_seconds() -> float:
    """Seconds that all closed-form answers about the four actuators take, solved here."""
    begin = time.perf_counter()
    for actuator in REFERENCE:
        for chain in (chains.closed_form, chains.closed_form_printed, chains.closed_form_balanced):
            chain(actuator.dimensions, actuator.law, PRESSURES_KPA)
    return time.perf_counter() - begin


def seconds(runs: Iterable[RunSummary]) -> float:
    """Seconds of runs one after the other."""
    return sum(run.time_s["total"] for run in runs)


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
        case = results.named(name)
        models = {
            "axisymmetric": case.axisymmetric,
            "full 3D": case.full3d,
            TETS: results.variant(name, "tets").full3d,
        }
        for label, runs in models.items():
            found |= {f"{name}, {label}, {level_label(run.summary.level)}": run.summary for run in runs[-1:]}
    return found
