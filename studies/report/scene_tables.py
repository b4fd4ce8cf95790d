"""Tables of a scene.

Lengths are in mm, pressures in kPa, masses in g, times in s.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from studies.planning.levels import ranking
from studies.report.labels import MODELS, model_label, ordered, quantity_label, runs_label
from studies.report.numbers import (
    MISSING,
    count,
    quantity_text,
    short_status,
    short_time,
    signed,
    up,
    value_text,
)
from studies.report.scene_report import (
    SceneReport,
    anchor_of,
    finest_path,
    headline,
    headlines,
    label_of,
    models_of,
    quantity_of,
    unit_of,
)
from studies.report.tables import Table
from studies.results.rows import REACHED, Row, difference_percent, is_reached, misses_tolerance
from studies.results.run_files import PathRow, RunSummary

# What the others are compared with: the first of these that reached the pressure.
REFERENCES = ("full3d", "axisymmetric")

ACTIVITIES = ("mesh", "compile", "pattern", "residual", "tangent", "factor", "solve", "checks", "output")


def summary(scenes: Sequence[SceneReport], verdicts: Sequence[str]) -> Table:
    """Tip elongation (mm) or force (N) at each scene's highest requested pressure (kPa), status and verdict."""
    models = ordered(model for scene in scenes for model in models_of(scene))
    lines = []
    for scene, verdict in zip(scenes, verdicts, strict=True):
        highest = max(scene.pressures_kpa, key=abs)
        values = [value_text(headline(scene, model, highest)) for model in models]
        link = f"[{scene.name}](#{anchor_of(scene)})"
        lines.append((link, f"{highest:g}", *values, _status(scene), verdict))
    header = ("scene", "kPa", *map(model_label, models), "status", "verdict")
    return Table(header, tuple(lines), left=(0, len(header) - 2, len(header) - 1))


def tips(scene: SceneReport) -> Table:
    """Tip elongation (mm) and negative modes; a line per requested pressure (kPa), a column per model."""
    models = models_of(scene)
    counted = [model for model in MODELS if finest_path(scene, model)]
    lines = []
    for pressure in scene.pressures_kpa:
        values = [value_text(headline(scene, model, pressure)) for model in models]
        modes = [_modes(finest_path(scene, model), pressure) for model in counted]
        lines.append((f"{pressure:g}", *values, *modes))
    header = ("pressure, kPa", *map(model_label, models))
    header += tuple(f"unstable modes, {model_label(model)}" for model in counted)
    return Table(header, tuple(lines), left=())


def differences(scene: SceneReport) -> Table:
    """Differences of the tip from the best model that reached each pressure (kPa), in percent."""
    models = [model for model in models_of(scene) if model != REFERENCES[0]]
    lines = []
    for pressure in scene.pressures_kpa:
        reference = _reference(scene, pressure)
        if reference is None:
            lines.append((f"{pressure:g}", *(MISSING,) * (1 + len(models))))
            continue
        cells = []
        for model in models:
            row = headline(scene, model, pressure)
            known = row is not None and math.isfinite(row.value) and model != reference.model
            cells.append(signed(difference_percent(row.value, reference.value)) if row and known else MISSING)
        lines.append((f"{pressure:g}", model_label(reference.model), *cells))
    header = ("pressure, kPa", "compared with", *map(model_label, models))
    return Table(header, tuple(lines), left=(1,))


def comparisons(scene: SceneReport) -> Table:
    """Tip's rows (mm) whose reference is not that of `differences`; finest level of each model."""
    lines = []
    for model in models_of(scene):
        for pressure in scene.pressures_kpa:
            row, usual = headline(scene, model, pressure), _reference(scene, pressure)
            shown = row and usual and math.isclose(row.reference, usual.value, rel_tol=1e-6)
            if row and math.isfinite(row.reference) and not shown:
                error = signed(row.error_percent) if math.isfinite(row.error_percent) else MISSING
                lines.append(
                    (
                        label_of(scene, model, row.level),
                        f"{pressure:g}",
                        value_text(row),
                        f"{row.reference:.5g}",
                        error,
                        row.source or MISSING,
                    )
                )
    unit = unit_of(scene)
    header = ("model", "pressure, kPa", f"value, {unit}", f"reference, {unit}", "error, %", "source of the reference")
    return Table(header, tuple(lines), left=(0, 5))


def convergence(scene: SceneReport) -> Table:
    """Tip elongation (mm) at each level beside the level's size, so that the discretisation error is seen."""
    lines = []
    for model in models_of(scene):
        levels = sorted({row.level for row in headlines(scene) if row.model == model}, key=ranking)
        if levels == [""]:
            continue
        for level in levels:
            run = next((run for run in scene.runs if (run.model, run.level) == (model, level)), None)
            size = (count(run.cells), count(run.nodes), count(run.dofs)) if run else (MISSING,) * 3
            tips = [_level_value(scene, model, level, pressure) for pressure in scene.pressures_kpa]
            lines.append((label_of(scene, model, level), *size, *tips))
        bounds = [headline(scene, model, pressure) for pressure in scene.pressures_kpa]
        if any(row and math.isfinite(row.uncertainty) for row in bounds):
            known = (row.uncertainty if row else math.nan for row in bounds)
            texts = (MISSING if math.isnan(bound) else f"± {up(bound, 3)}" for bound in known)
            lines.append((f"uncertainty of {label_of(scene, model, levels[-1])}", "", "", "", *texts))
    header = (f"at {pressure:g} kPa, {unit_of(scene)}" for pressure in scene.pressures_kpa)
    return Table(("model", "cells", "nodes", "unknowns", *header), tuple(lines))


def others(scene: SceneReport) -> Table:
    """All quantities but the tip, units in the lines; a line per quantity and model, a column per pressure (kPa)."""
    rows = [row for row in scene.rows if row.quantity != quantity_of(scene)]
    pressures = sorted({row.pressure_kpa for row in rows if math.isfinite(row.pressure_kpa)})
    has_none = any(not math.isfinite(row.pressure_kpa) for row in rows)
    columns = [*([math.nan] if has_none else []), *pressures]
    lines: dict[tuple[str, str], dict[str, str]] = {}
    sources: dict[tuple[str, str], list[str]] = {}
    for row in rows:
        key = (quantity_label(row.quantity), label_of(scene, row.model, row.level))
        lines.setdefault(key, {})[f"{row.pressure_kpa:g}"] = quantity_text(row)
        of_line = sources.setdefault(key, [])
        if row.source and row.source not in of_line:
            of_line.append(row.source)
    header = [f"{p:g} kPa" if math.isfinite(p) else "any pressure" for p in columns]
    cells = [(*key, *(line.get(f"{p:g}", MISSING) for p in columns)) for key, line in lines.items()]
    if not any(sources.values()):
        return Table(("quantity", "model", *header), tuple(cells), left=(0, 1))
    compared = [(*line, "; ".join(sources[key]) or MISSING) for key, line in zip(lines, cells, strict=True)]
    return Table(("quantity", "model", *header, "compared with"), tuple(compared), left=(0, 1, 2 + len(columns)))


def work(scene: SceneReport) -> Table:
    """Size, work and peak memory (MB) of each run."""
    return work_of(scene.runs, [label_of(scene, run.model, run.level) for run in scene.runs])


def work_of(runs: Sequence[RunSummary], labels: Sequence[str]) -> Table:
    """As `work`, of any runs by their labels."""
    lines = tuple(
        (
            label,
            run.status,
            *(count(n) for n in (run.dofs, run.factorisations, run.newton_iterations, run.rejected_steps)),
            f"{run.peak_mb:.0f}",
            f"{run.ranks}",
            f"{run.threads}",
        )
        for label, run in zip(labels, runs, strict=True)
    )
    header = ("run", "status", "unknowns", "factorisations", "Newton iterations", "rejected steps")
    return Table((*header, "peak memory, MB", "ranks", "threads"), lines, left=(0, 1))


def times(scene: SceneReport) -> Table:
    """Wall time (s) of each run by activity."""
    return times_of(scene.runs, [label_of(scene, run.model, run.level) for run in scene.runs])


def times_of(runs: Sequence[RunSummary], labels: Sequence[str]) -> Table:
    """As `times`, of any runs by their labels."""
    split = seconds_of(runs)
    lines = []
    for place, (label, run) in enumerate(zip(labels, runs, strict=True)):
        seconds = [values[place] for values in split.values()]
        total = run.time_s.get("total", sum(seconds))
        lines.append((label, *(short_time(value) for value in (*seconds, total))))
    return Table(("run, s", *split, "total"), tuple(lines))


def masses(scene: SceneReport) -> Table:
    """Masses (g) of the meshes, equal ones on one line, and what the rows compare them with."""
    runs: dict[tuple[str, ...], list[RunSummary]] = {}
    for run in scene.runs:
        grams = (run.silicone_g, run.ring_g, run.silicone_g + run.ring_g)
        texts = tuple(MISSING if math.isnan(mass) else f"{mass:.2f}" for mass in grams)
        runs.setdefault(texts, []).append(run)
    lines = [(runs_label(equal, scene.counted), *texts) for texts, equal in runs.items()]
    references = dict.fromkeys(
        (row.quantity, f"{row.reference:g}", row.source)
        for row in scene.rows
        if row.unit == "g" and math.isfinite(row.reference)
    )
    columns = ("silicone_g", "ring_g")
    for quantity, mass, source in references:
        place = columns.index(quantity) if quantity in columns else len(columns)
        lines.append((f"reference: {source}", *("", "", "")[:place], mass, *("", "", "")[place + 1 :]))
    return Table(("mesh", "silicone, g", "rings, g", "together, g"), tuple(lines))


def stamps_of(runs: Sequence[RunSummary]) -> dict[str, str]:
    """What runs were made with, and when."""
    versions = (", ".join(f"{name} {version}" for name, version in run.versions.items()) for run in runs)
    when = sorted({run.when for run in runs})
    own = {
        "commit of the runs": sorted({run.commit for run in runs}),
        "BLAS of the runs": sorted({run.blas for run in runs}),
        "versions of the runs": sorted(set(versions)),
        "runs made": [f"{when[0]} to {when[-1]}"] if len(when) > 2 else when,
    }
    return {name: "; ".join(values) for name, values in own.items() if values}


def seconds_of(runs: Sequence[RunSummary]) -> dict[str, list[float]]:
    """Seconds by activity, a number per run; ``other`` is what no activity of the run accounts for."""
    named = [name for name in ACTIVITIES if any(name in run.time_s for run in runs)]
    more = sorted({name for run in runs for name in run.time_s} - {*ACTIVITIES, "total", "other"})
    split = {name: [run.time_s.get(name, 0.0) for run in runs] for name in (*named, *more)}
    accounted = [sum(column) for column in zip(*split.values(), strict=True)] or [0.0] * len(runs)
    totals = [run.time_s.get("total", known) for run, known in zip(runs, accounted, strict=True)]
    split["other"] = [max(0.0, total - known) for total, known in zip(totals, accounted, strict=True)]
    return split


def _reference(scene: SceneReport, pressure_kpa: float) -> Row | None:
    rows = (headline(scene, model, pressure_kpa) for model in REFERENCES)
    return next((row for row in rows if row and math.isfinite(row.value) and row.value != 0.0), None)


def _modes(states: Sequence[PathRow], pressure_kpa: float) -> str:
    """Negative modes at a requested pressure; a dash where it was not reached or they were not counted."""
    asked = (state for state in states if state.status == "requested")
    found = next((s for s in asked if math.isclose(s.pressure_kpa, pressure_kpa, rel_tol=1e-6)), None)
    return MISSING if found is None or math.isnan(found.unstable_modes) else f"{found.unstable_modes:.0f}"


def _level_value(scene: SceneReport, model: str, level: str, pressure_kpa: float) -> str:
    for row in headlines(scene):
        if (row.model, row.level) == (model, level) and math.isclose(row.pressure_kpa, pressure_kpa):
            return f"{row.value:.3f}" if math.isfinite(row.value) else short_status(row.status)
    return MISSING


def _status(scene: SceneReport) -> str:
    stops: dict[tuple[str, str], dict[str, None]] = {}
    for row in headlines(scene):
        if not is_reached(row) or misses_tolerance(row):
            stops.setdefault((row.model, short_status(row.status)), {})[row.level] = None
    texts = (f"{label_of(scene, model, *levels)} {status}" for (model, status), levels in stops.items())
    return "; ".join(texts) or REACHED
