"""The report of simple bodies: rows beside exact answers, and a plot of one against the other for each scene."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from studies.models.session import ROWS_FILE, SCENE_FILE
from studies.planning.levels import MODELS, fineness
from studies.report import scene_tables
from studies.report.labels import counted_along, quantity_label
from studies.report.numbers import MISSING, duration, rounded_up
from studies.report.pages import write_page
from studies.report.scene_report import SceneReport, anchor_of, label_of
from studies.report.tables import Column, Table, pivot, pressure_of
from studies.results import provenance
from studies.results.body_rows import OF_PATHS
from studies.results.exact_answers import exact_bore_mm, exact_crossing_kpa
from studies.results.files import SUMMARY_FILE, read_path, read_summary
from studies.results.rows import Row, read_rows, write_rows
from studies.scene.bodies import BodyScene
from studies.scene.files import kept_scene
from studies.verification.plots import Points, draw_against_exact

TITLE: Final = "Bodies with exact answers: the solver beside them"
# Rows that are not compared values.
_CHECKS: Final = ("unstable_modes", "min_det_f", "crossing_modes")


def render_exact(folder: Path, scene_folders: Sequence[Path]) -> Path:
    """Write the report of scene folders into ``folder``; returns the path of report.html.

    Raises
    ------
    FileNotFoundError
        If a folder holds no finished run.
    """
    pairs = [(_scene(place), _read(place)) for place in scene_folders]
    reports = [report for _, report in pairs]
    if len(scene_folders) != 1 or folder != scene_folders[0]:
        write_rows(folder / ROWS_FILE, (row for report in reports for row in report.rows))
    stamps = {
        "commit": provenance.commit(),
        "date": provenance.now(),
        "machine": provenance.machine(),
        "BLAS": provenance.blas(),
        **provenance.versions(),
    }
    seconds = sum(run.time_s["total"] for report in reports for run in report.runs)
    content = {
        "title": TITLE,
        "summary": _summary(pairs),
        "scenes": [_section(folder, scene, report) for scene, report in pairs],
        "provenance": scene_tables.provenance(reports, stamps),
        "wall": duration(seconds),
    }
    return write_page(folder, "exact.md.j2", content)


def _scene(folder: Path) -> BodyScene:
    """The scene kept in a folder."""
    scene = kept_scene(folder / SCENE_FILE)
    assert isinstance(scene, BodyScene)
    return scene


def _read(folder: Path) -> SceneReport:
    runs = [read_summary(p.parent) for p in folder.glob(f"*-*/{SUMMARY_FILE}")]
    rows = read_rows(folder / ROWS_FILE)
    shown = {(row.model, row.level) for row in rows}  # runs of an earlier plan may be there too
    order: dict[str, int] = {model: place for place, model in enumerate(MODELS)}
    runs = sorted((r for r in runs if (r.model, r.level) in shown), key=lambda r: (order[r.model], fineness(r.level)))
    scene = _scene(folder)
    return SceneReport(
        name=scene.name,
        title=scene.title,
        scene_toml=(folder / SCENE_FILE).read_text(encoding="utf-8"),
        pressures_kpa=scene.loads_kpa,
        rows=tuple(rows),
        runs=tuple(runs),
        paths={f"{r.model} {r.level}": read_path(folder / f"{r.model}-{r.level}") for r in runs},
        fields={},
        notes=(),
        counted=counted_along(scene.geometry.kind),
    )


def _section(folder: Path, scene: BodyScene, report: SceneReport) -> dict[str, Any]:
    place = Path("pictures", f"{anchor_of(report)}.png")
    (folder / "pictures").mkdir(parents=True, exist_ok=True)
    quantity = _plotted(scene)
    drawn = scene.geometry.kind != "cylinder" and any(
        row.quantity == quantity and math.isfinite(row.value) for row in report.rows
    )
    if drawn:
        _draw(folder / place, scene, report, quantity)
    return {
        "anchor": anchor_of(report),
        "name": report.name,
        "title": report.title,
        "toml": report.scene_toml.strip(),
        "compared": _compared(report),
        "picture": str(place) if drawn else "",
        "quantity": quantity_label(quantity),
        "crossings": _crossings(report),
        "checks": _checks(report),
        "work": scene_tables.work(report),
        "times": scene_tables.times(report),
        "notes": list(dict.fromkeys(note for run in report.runs for note in run.plan)),
    }


def _plotted(scene: BodyScene) -> str:
    """The quantity that is drawn over the load."""
    kind = scene.geometry.kind
    others = {"mesh": "volume_mm3", "block": "unstable_modes", "cook": "corner_mm", "ventricle": "apex_inside_mm"}
    return {**others, "cylinder": "torque_nmm"}.get(kind, "bore_mm")


def _draw(path: Path, scene: BodyScene, report: SceneReport, quantity: str) -> None:
    levels = []
    for model, level in _finest(report):
        rows = [r for r in report.rows if (r.quantity, r.model, r.level) == (quantity, model, level)]
        known = [(r.pressure_kpa, r.value) for r in rows if math.isfinite(r.value)]
        if quantity == "unstable_modes":  # counted in every state
            known = [(s.pressure_kpa, s.unstable_modes) for s in report.paths[f"{model} {level}"]]
        levels.append(Points(label_of(report, model, level), *_columns(known)))
    loads = np.linspace(0.0, max(scene.loads_kpa), 61)[1:]
    curve = [(0.0, 0.0), *((float(p), exact_bore_mm(scene, float(p))[0]) for p in loads)]
    known = [pair for pair in curve if math.isfinite(pair[1])] if quantity == "bore_mm" else []
    exact = Points("exact", *_columns(known)) if len(known) > 1 else None
    lines = []
    last = (report.runs[-1].model, report.runs[-1].level)
    for row in report.rows:
        if row.quantity in OF_PATHS and (row.model, row.level) == last and math.isfinite(row.value):
            lines.append((f"{row.quantity.removesuffix('_kpa')}, {label_of(report, *last)}", row.value))
            if math.isfinite(row.reference):
                lines.append(("the same, exact", exact_crossing_kpa(scene)[0]))
    draw_against_exact(path, quantity_label(quantity), exact, levels, lines)


def _columns(pairs: Sequence[tuple[float, float]]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    return tuple(x for x, _ in pairs), tuple(y for _, y in pairs)


# --- tables -------------------------------------------------------------------------------------------------


def _summary(pairs: Sequence[tuple[BodyScene, SceneReport]]) -> Table:
    """The asked quantities on the finest mesh of each model: the largest error over the loads."""
    lines = []
    for scene, report in pairs:
        for quantity in scene.quantities:
            for model, level in _finest(report):
                rows = [r for r in report.rows if (r.quantity, r.model, r.level) == (quantity, model, level)]
                errors = [abs(r.error_percent) for r in rows if math.isfinite(r.error_percent)]
                reached = sum(math.isfinite(r.value) for r in rows)
                stopped = next((r.status for r in rows if r.status != "reached"), "reached")
                lines.append(
                    (report.name, quantity_label(quantity), label_of(report, model, level), f"{reached} of {len(rows)}",
                     _percent(max(errors)) if errors else MISSING, stopped)
                )  # fmt: skip
    header = ("scene", "quantity", "finest mesh", "values", "largest error, %", "status")
    return Table(header, tuple(lines), left=(0, 1, 2, 5))


def _finest(report: SceneReport) -> list[tuple[str, str]]:
    """Model and finest mesh, a pair per model."""
    return list({run.model: (run.model, run.level) for run in report.runs}.values())


def _compared(report: SceneReport) -> Table:
    """All compared values of a scene."""
    lines = []
    for row in report.rows:
        if row.quantity not in _CHECKS:
            load = MISSING if math.isnan(row.pressure_kpa) else f"{row.pressure_kpa:g}"
            known = math.isfinite(row.reference)
            lines.append(
                (quantity_label(row.quantity), load, label_of(report, row.model, row.level), _number(row),
                 f"{row.reference:.6g}" if known else MISSING, _percent(row.error_percent, signed=True),
                 row.source or MISSING)
            )  # fmt: skip
    header = ("quantity", "load, kPa", "mesh", "value", "known", "error, %", "known from")
    return Table(header, tuple(lines), left=(0, 2, 6))


def _checks(report: SceneReport) -> Table:
    """Unstable modes and least det F on the finest mesh of each model at each load."""
    lines = {"mesh": lambda row: label_of(report, row.model, row.level), "load, kPa": pressure_of}
    columns = [Column("unstable modes", "unstable_modes", ".0f"), Column("least det F", "min_det_f", "#.4g")]
    return pivot(report.rows, lines, columns, left=(0,))


def _crossings(report: SceneReport) -> list[str]:
    """A sentence per run that lost stability."""
    out = []
    for run in report.runs:
        c = run.crossing
        if c:
            out.append(
                f"{label_of(report, run.model, run.level)}: {c['kind']} at {c['pressure_kpa']:.6g} kPa (within "
                f"{c['within_kpa']:.1g}), unstable modes {c['modes_before']} → {c['modes_after']}"
            )
    return out


def _number(row: Row) -> str:
    if not math.isfinite(row.value):
        return row.status
    text = f"{row.value:.6g}"
    return text if math.isnan(row.uncertainty) else f"{text} ± {rounded_up(row.uncertainty, 2):.2g}"


def _percent(value: float, signed: bool = False) -> str:
    if not math.isfinite(value):
        return MISSING
    return f"{value:{'+' if signed else ''}.2g}".replace("-", "\N{MINUS SIGN}")
