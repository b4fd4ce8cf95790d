"""Bodies with exact answers: scenes/exact by every model each has, rows beside exact answers, a plot for each."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from studies.engine import Page, Setting, Solved, Study
from studies.models.session import SceneResult, run_all_models
from studies.report import scene_tables
from studies.report.labels import quantity_label
from studies.report.numbers import MISSING, duration, number_text, rounded_up
from studies.report.scene_page import report_of
from studies.report.scene_report import SceneReport, anchor_of, label_of
from studies.report.tables import Column, Table, facts_table, pivot, pressure_of, table_of
from studies.results import provenance
from studies.results.body_rows import OF_PATHS
from studies.results.exact_answers import exact_bore_mm, exact_crossing_kpa
from studies.results.rows import REACHED, Row
from studies.scene.bodies import BodyScene
from studies.scene.load import load_scene
from studies.verification.plots import Points, draw_against_exact

SCENES: Final = provenance.ROOT / "scenes" / "exact"
# Rows that are not compared values.
_CHECKS: Final = ("unstable_modes", "min_det_f", "crossing_modes")
# What is drawn over the load, by kind of body, else the bore; a cylinder has one load.
_DRAWN: Final = {
    "mesh": "volume_mm3",
    "block": "unstable_modes",
    "cook": "corner_mm",
    "ventricle": "apex_inside_mm",
    "cylinder": "torque_nmm",
}


def cases(options: Mapping[str, Any]) -> list[BodyScene]:
    """All scenes with exact answers, and a user's mesh, by name."""
    scenes = [load_scene(path) for path in sorted(SCENES.glob("*.toml"))]
    return [scene for scene in scenes if isinstance(scene, BodyScene)]


def solve_all_models(scene: BodyScene, at: Setting) -> SceneResult[BodyScene]:
    """Every model of a scene, all its meshes."""
    text = (SCENES / f"{scene.name}.toml").read_text(encoding="utf-8")
    return run_all_models(scene, text, at.out / scene.name, at.comm, at.progress)


def solve(scene: BodyScene, at: Setting) -> SceneReport:
    """The same, as reports take it."""
    solve_all_models(scene, at)
    return report_of(at.out / scene.name)


def page(solved: Sequence[Solved[BodyScene, SceneReport]], at: Setting) -> Page:
    """A section per scene, with its plot."""
    reports = [done.result for done in solved]
    runs = [run for report in reports for run in report.runs]
    content = {
        "summary": summary(solved),
        "scenes": [_section(at.out, done.case, done.result) for done in solved],
        "solved": duration(sum(run.time_s["total"] for run in runs)),
        "runs": facts_table(scene_tables.stamps_of(runs)),
    }
    rows = [row for report in reports for row in report.rows]
    return Page(rows, content, [f"{report.name}: {report.stopped}" for report in reports if report.stopped])


def _section(folder: Path, scene: BodyScene, report: SceneReport) -> dict[str, Any]:
    """What the page shows of a scene; draws its plot on the way."""
    quantity = _DRAWN.get(scene.geometry.kind, "bore_mm")
    known = any(row.quantity == quantity and math.isfinite(row.value) for row in report.rows)
    picture = f"pictures/{anchor_of(report)}.png" if known and scene.geometry.kind != "cylinder" else ""
    if picture:
        _draw(folder / picture, scene, report, quantity)
    return {
        "anchor": anchor_of(report),
        "name": report.name,
        "title": report.title,
        "toml": report.scene_toml.strip(),
        "compared": compared(report),
        "picture": picture,
        "quantity": quantity_label(quantity),
        "crossings": crossings(report),
        "checks": checks(report),
        "work": scene_tables.work(report),
        "times": scene_tables.times(report),
        "notes": list(dict.fromkeys(note for run in report.runs for note in run.plan)),
    }


# --- plots --------------------------------------------------------------------------------------------------


def _draw(path: Path, scene: BodyScene, report: SceneReport, quantity: str) -> None:
    levels = []
    for model, level in _finest(report):
        known = [(r.pressure_kpa, r.value) for r in _rows(report, quantity, model, level) if math.isfinite(r.value)]
        if quantity == "unstable_modes":  # counted in every state
            known = [(s.pressure_kpa, s.unstable_modes) for s in report.paths[f"{model} {level}"]]
        levels.append(_points(label_of(report, model, level), known))
    exact = _exact_bores(scene) if quantity == "bore_mm" else []
    lines = []
    last = _finest(report)[-1]
    for row in report.rows:
        if row.quantity in OF_PATHS and (row.model, row.level) == last and math.isfinite(row.value):
            lines.append((f"{row.quantity.removesuffix('_kpa')}, {label_of(report, *last)}", row.value))
            if math.isfinite(row.reference):
                lines.append(("the same, exact", exact_crossing_kpa(scene)[0]))
    curve = _points("exact", exact) if len(exact) > 1 else None
    draw_against_exact(path, quantity_label(quantity), curve, levels, lines)


def _exact_bores(scene: BodyScene) -> list[tuple[float, float]]:
    """Loads and exact displacements of the bore, as far as there are any."""
    loads = np.linspace(0.0, max(scene.loads_kpa), 61)[1:]
    curve = [(0.0, 0.0), *((float(p), exact_bore_mm(scene, float(p))[0]) for p in loads)]
    return [pair for pair in curve if math.isfinite(pair[1])]


def _points(label: str, pairs: Sequence[tuple[float, float]]) -> Points:
    return Points(label, tuple(x for x, _ in pairs), tuple(y for _, y in pairs))


# --- tables -------------------------------------------------------------------------------------------------


def summary(solved: Sequence[Solved[BodyScene, SceneReport]]) -> Table:
    """The requested quantities on the finest mesh of each model: the largest error over the loads."""
    lines = [
        _summary_line(done.result, quantity, model, level)
        for done in solved
        for quantity in done.case.quantities
        for model, level in _finest(done.result)
    ]
    header = ("scene", "quantity", "finest mesh", "values", "largest error, %", "status")
    return Table(header, tuple(lines), left=(0, 1, 2, 5))


def _summary_line(report: SceneReport, quantity: str, model: str, level: str) -> tuple[str, ...]:
    rows = _rows(report, quantity, model, level)
    errors = [abs(row.error_percent) for row in rows if math.isfinite(row.error_percent)]
    return (
        report.name,
        quantity_label(quantity),
        label_of(report, model, level),
        f"{sum(math.isfinite(row.value) for row in rows)} of {len(rows)}",
        _percent(max(errors, default=math.nan)),
        next((row.status for row in rows if row.status != REACHED), REACHED),
    )


def compared(report: SceneReport) -> Table:
    """All compared values of a scene."""
    columns = {
        "quantity": lambda row: quantity_label(row.quantity),
        "load, kPa": pressure_of,
        "mesh": lambda row: label_of(report, row.model, row.level),
        "value": _value,
        "known": lambda row: number_text(row.reference, ".6g"),
        "error, %": lambda row: _percent(row.error_percent, "+"),
        "known from": lambda row: row.source or MISSING,
    }
    return table_of([row for row in report.rows if row.quantity not in _CHECKS], columns, left=(0, 2, 6))


def checks(report: SceneReport) -> Table:
    """Unstable modes and least det F on the finest mesh of each model at each load."""
    lines = {"mesh": lambda row: label_of(report, row.model, row.level), "load, kPa": pressure_of}
    columns = [Column("unstable modes", "unstable_modes", ".0f"), Column("least det F", "min_det_f", "#.4g")]
    return pivot(report.rows, lines, columns, left=(0,))


def crossings(report: SceneReport) -> list[str]:
    """A sentence per run that lost stability."""
    return [
        f"{label_of(report, run.model, run.level)}: {c['kind']} at {c['pressure_kpa']:.6g} kPa (within "
        f"{c['within_kpa']:.1g}), unstable modes {c['modes_before']} → {c['modes_after']}"
        for run in report.runs
        if (c := run.crossing)
    ]


def _finest(report: SceneReport) -> list[tuple[str, str]]:
    """Model and finest mesh, a pair per model."""
    return list({run.model: (run.model, run.level) for run in report.runs}.values())


def _rows(report: SceneReport, quantity: str, model: str, level: str) -> list[Row]:
    return [row for row in report.rows if (row.quantity, row.model, row.level) == (quantity, model, level)]


def _value(row: Row) -> str:
    if not math.isfinite(row.value):
        return row.status
    text = f"{row.value:.6g}"
    return text if math.isnan(row.uncertainty) else f"{text} ± {rounded_up(row.uncertainty, 2):.2g}"


def _percent(value: float, sign: str = "") -> str:
    return number_text(value, f"{sign}.2g").replace("-", "\N{MINUS SIGN}")


STUDY: Final = Study(
    name="exact",
    title="Bodies with exact answers: the solver beside them",
    question="How far from exact and published answers is the solver, in every model that a body has?",
    template="verification/exact.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="all",
)
