"""The page on bellows that have been run, rendered from their rows and runs."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from matplotlib.figure import Figure

from studies.planning.levels import LIMIT, ranking
from studies.report import scene_tables
from studies.report.bar_charts import draw_overview, draw_times
from studies.report.curves import SIZE_IN, Curve, draw_elongation, elongation_axes, smooth
from studies.report.labels import TIP, TIP_FORCE, level_label, model_label, ordered, runs_label, split_key
from studies.report.numbers import duration, is_printed, rounded_up, short_status, signed, value_text
from studies.report.pictures.child import draw_states
from studies.report.pictures.stills import Still
from studies.report.scene_report import (
    SceneReport,
    anchor_of,
    finest_path,
    followed_path,
    headline,
    headlines,
    label_of,
    models_of,
    quantity_of,
    unit_of,
)
from studies.report.scene_tables import REFERENCES
from studies.report.tables import facts_table
from studies.results.rows import difference_percent, is_reached, misses_tolerance
from studies.results.run_files import PATH_FILE, RunSummary, write_path


def content(folder: Path, scenes: Sequence[SceneReport]) -> dict[str, Any]:
    """What the page shows of scenes, by name; draws pictures/ and writes paths/ into its folder."""
    runs = [run for scene in scenes for run in scene.runs]
    return {
        "summary": scene_tables.summary(scenes, [verdict(scene) for scene in scenes]),
        "overview": _draw_overview(folder, scenes),
        "compared_with_paper": any(is_printed(row) for scene in scenes for row in scene.rows),
        "levels": {model: _levels(scenes, model) for model in REFERENCES},
        "scenes": [_scene(folder, scene) for scene in scenes],
        "solved": duration(sum(run.time_s["total"] for run in runs)),
        "runs": facts_table(scene_tables.stamps_of(runs)),
    }


def verdict(scene: SceneReport) -> str:
    """How far (%) the axisymmetric tip is from that of full 3D over all pressures that both reached."""
    pairs = [
        (axisymmetric, full)
        for pressure in scene.pressures_kpa
        if (axisymmetric := headline(scene, "axisymmetric", pressure))
        and (full := headline(scene, "full3d", pressure))
        and math.isfinite(axisymmetric.value)
        and math.isfinite(full.value)
        and full.value != 0.0
    ]
    solved = {run.model for run in scene.runs}
    if len(solved) == 1:
        return f"{model_label(*solved)} alone; --model full3d solves the whole body beside it"
    if not pairs:
        return "no pressure that both axisymmetric and full 3D reached"
    largest = max(abs(difference_percent(one.value, other.value)) for one, other in pairs)
    text = f"axisymmetric within {rounded_up(largest, 2):g} % of full 3D"
    if len(pairs) < len(scene.pressures_kpa):
        text += f" at {len(pairs)} of {len(scene.pressures_kpa)} pressures"
    margins = [one.uncertainty + other.uncertainty - abs(one.value - other.value) for one, other in pairs]
    if all(math.isfinite(margin) for margin in margins):
        text += f", {'within' if min(margins) >= 0.0 else 'beyond'} the sum of their uncertainties"
    return text


# --- a scene's pictures and files -----------------------------------------------------------


def _scene(folder: Path, scene: SceneReport) -> dict[str, Any]:
    """What the template shows of a scene; draws its pictures on the way."""
    anchor = anchor_of(scene)
    elongation, states, times = (f"pictures/{anchor}-{name}.png" for name in ("elongation", "states", "times"))
    what = _what(scene)
    draw_elongation(folder / elongation, _curves(scene), scene.pressures_kpa, f"{what}, {unit_of(scene)}")
    if scene.runs:
        labels = [label_of(scene, run.model, run.level) for run in scene.runs]
        draw_times(folder / times, labels, scene_tables.seconds_of(scene.runs))
    why_no_states = "no fields were kept"
    if scene.fields:
        why_no_states = draw_states(folder / states, _stills(scene))
    return {
        "anchor": anchor,
        "name": scene.name,
        "title": scene.title,
        "toml": scene.scene_toml.strip(),
        "answer": answer(scene),
        "verdict": verdict(scene),
        "what": what.split(" at the tip")[0].capitalize(),
        "unit": unit_of(scene),
        "tips": scene_tables.tips(scene),
        "differences": scene_tables.differences(scene),
        "comparisons": scene_tables.comparisons(scene),
        "stops": _stops(scene),
        "elongation": elongation,
        "states": states,
        "why_no_states": why_no_states,
        "rings_drawn": any(scene.rings.values()),
        "run_with_fields": _run_with_fields(folder, scene),
        "convergence": scene_tables.convergence(scene),
        "instabilities": _instabilities(scene),
        "others": scene_tables.others(scene),
        "masses": scene_tables.masses(scene),
        "work": scene_tables.work(scene),
        "time_table": scene_tables.times(scene),
        "times": times if scene.runs else "",
        "notes": _notes(scene),
        "files": _files(folder, scene),
    }


def answer(scene: SceneReport) -> str:
    """What came out at the highest pressure, in words: by the best model, beside the closed form; stability."""
    model = next((m for m in reversed(models_of(scene)) if m in {run.model for run in scene.runs}), "")
    rows = [row for p in scene.pressures_kpa if (row := headline(scene, model, p)) and math.isfinite(row.value)]
    if not rows:
        return "No requested pressure was reached"
    last = rows[-1]
    said = (
        f"At {last.pressure_kpa:g} kPa the {_what(scene)} is {value_text(last)} {unit_of(scene)} ({model_label(model)})"
    )
    closed = headline(scene, "closed_form", last.pressure_kpa)
    if model != "closed_form" and closed and math.isfinite(closed.value) and last.value:
        said += f"; the closed form is {signed(difference_percent(closed.value, last.value))} % from it"
    test = headline(scene, "measured", last.pressure_kpa)
    if test and test.value:
        share = signed(difference_percent(last.value, test.value))
        said += f"; measured were {value_text(test)} {unit_of(scene)}, from which it is {share} %"
    return said + _stability(scene, model)


def _stability(scene: SceneReport, model: str) -> str:
    """Which requested states are unstable: by the model's own count, and of axisymmetric ones by harmonics too."""
    finest = finest_path(scene, model)
    own = [s for s in finest if s.status == "requested" and math.isfinite(s.unstable_modes)]
    flat = [path for key, path in scene.paths.items() if split_key(key)[0] == "axisymmetric"]
    by_m = [s for path in flat for s in path if s.unstable_by_m]
    unstable = {s.pressure_kpa for s in own if s.unstable_modes > 0.0}
    unstable |= {s.pressure_kpa for s in by_m if any(int(n) for n in s.unstable_by_m.split(";"))}
    if unstable:
        return f". Unstable at {', '.join(f'{p:g}' for p in sorted(unstable, key=abs))} kPa"
    if not own:
        return ""
    against = "" if model == "full3d" or by_m else " against axisymmetric perturbations; others were not counted"
    return f". Stable at every pressure that was reached{against}"


def _what(scene: SceneReport) -> str:
    return "force at the blocked tip" if quantity_of(scene) == TIP_FORCE else "elongation at the tip"


def elongation_figure(scene: SceneReport) -> Figure:
    """The plot of elongation, or of the force at a blocked tip, over pressure, as a figure."""
    figure = Figure(figsize=SIZE_IN, layout="constrained")
    elongation_axes(figure, _curves(scene), scene.pressures_kpa, f"{_what(scene)}, {unit_of(scene)}")
    return figure


def _curves(scene: SceneReport) -> list[Curve]:
    """The curves of the pressure-elongation plot, the references as their paths where there are any."""
    curves = []
    for model in models_of(scene):
        rows = [row for p in scene.pressures_kpa if (row := headline(scene, model, p))]
        reached = [row for row in rows if math.isfinite(row.value)]
        points = [(row.pressure_kpa, row.value) for row in reached]
        bars = [row.uncertainty for row in reached]
        force = quantity_of(scene) == TIP_FORCE
        states = followed_path(scene, model)
        loaded = not force and bool(states) and abs(states[-1].tip_force_n) > 0.0
        if loaded:  # states before the whole force was on are of other loads
            states = [s for s in states if s.tip_force_n == states[-1].tip_force_n]
        path = [(state.pressure_kpa, state.tip_force_n if force else state.tip_mm) for state in states]
        if model == "axisymmetric" and path:
            points, bars = smooth(path if loaded else _from_rest(path)), []
        elif not model.startswith("paper_") and model not in ("full3d", "measured"):
            points, bars = _from_rest(points), []
        stop = next((row.status for row in rows if not is_reached(row)), "")
        end = (path or _from_rest(points))[-1]
        curves.append(
            Curve(
                model=model,
                label=model_label(model),
                pressure_kpa=tuple(pressure for pressure, _ in points),
                tip_mm=tuple(tip for _, tip in points),
                uncertainty_mm=tuple(bars) if any(math.isfinite(bar) for bar in bars) else (),
                markers=not (model == "axisymmetric" and path),
                stopped=f"{model_label(model)} {short_status(stop)}" if stop else "",
                stopped_at=end,
            )
        )
    return curves


def _from_rest(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    return points if points and points[0][0] == 0.0 else [(0.0, 0.0), *points]


def _stills(scene: SceneReport) -> list[Still]:
    fields = sorted(scene.fields.items())
    stills = [Still("unloaded", fields[0][1], deformed=False, rings=scene.rings.get(0.0, ()))]
    for pressure, vtu in fields:
        row = headline(scene, "full3d", pressure)
        tip = f"\ntip +{row.value:.1f} {row.unit}" if row and math.isfinite(row.value) else ""
        stills.append(Still(f"{pressure:g} kPa{tip}", vtu, rings=scene.rings.get(pressure, ())))
    return stills


def _draw_overview(folder: Path, scenes: Sequence[SceneReport]) -> str:
    """Draw all scenes at their highest pressure; the picture's place, empty for a single scene."""
    scenes = [scene for scene in scenes if quantity_of(scene) == TIP]
    if len(scenes) < 2:
        return ""
    values: dict[tuple[str, str], list[float]] = {}
    for model in ordered(model for scene in scenes for model in models_of(scene)):
        rows = [headline(scene, model, max(scene.pressures_kpa)) for scene in scenes]
        values[model, model_label(model)] = [row.value if row else math.nan for row in rows]
    labels = [f"{scene.name}\n{max(scene.pressures_kpa):g} kPa" for scene in scenes]
    draw_overview(folder / "pictures/overview.png", labels, values)
    return "pictures/overview.png"


def _run_with_fields(folder: Path, scene: SceneReport) -> str:
    """Address of the folder of the run that the fields are of; empty if there are none."""
    run = next((vtu.parents[1] for vtu in scene.fields.values()), None)
    return "" if run is None else os.path.relpath(run.resolve(), folder.resolve())


def _files(folder: Path, scene: SceneReport) -> list[tuple[str, str]]:
    """Write the paths into the report's folder; label and relative address of each file."""
    files = []
    for key, states in scene.paths.items():
        place = Path("paths", anchor_of(scene), key.replace(" ", "-"))
        write_path(folder / place, states)
        files.append((f"{label_of(scene, *split_key(key))}: path", quote(str(place / PATH_FILE))))
    for pressure, vtu in sorted(scene.fields.items()):
        address = quote(os.path.relpath(vtu.resolve(), folder.resolve()))
        files.append((f"full 3D, {pressure:g} kPa: fields", address))
    return files


# --- sentences ------------------------------------------------------------------------------


def _stops(scene: SceneReport) -> list[str]:
    """A sentence per way in which levels did not reach a pressure, with its reason."""
    stops = [row for row in headlines(scene) if not is_reached(row) or misses_tolerance(row)]
    found: dict[tuple[str, str], dict[str, None]] = {}
    for row in stops:
        found.setdefault((row.model, row.status), {})[row.level] = None
    sentences = []
    for (model, status), levels in found.items():
        asked = sorted({row.pressure_kpa for row in stops if (row.model, row.status) == (model, status)})
        asked_text = ", ".join(f"{pressure:g}" for pressure in asked)
        sentences.append(f"{label_of(scene, model, *levels)}, asked for {asked_text} kPa: {status}")
    return sentences


def _instabilities(scene: SceneReport) -> list[str]:
    """A sentence per path that has states with negative modes: the first of them."""
    sentences = []
    for key, states in scene.paths.items():
        first = next((state for state in states if state.unstable_modes > 0), None)
        if first:
            model = label_of(scene, *split_key(key))
            tip = f"{first.tip_mm:.2f} mm" if unit_of(scene) == "mm" else f"{first.tip_force_n:.3f} N"
            where = f"{first.pressure_kpa:.4g} kPa and {tip}"
            sentences.append(f"{model}: first state with {first.unstable_modes:.0f} unstable at {where}")
    return sentences


def _notes(scene: SceneReport) -> list[str]:
    """The scene's notes and what the runs' plans skipped, each sentence once, a plan's with the runs it holds for."""
    plans: dict[str, list[RunSummary]] = {}
    for run in scene.runs:
        for sentence in dict.fromkeys(run.plan):
            plans.setdefault(sentence, []).append(run)
    own = [note for note in dict.fromkeys(scene.notes) if note not in plans]
    return [*own, *(f"{sentence} ({runs_label(runs, scene.counted)})" for sentence, runs in plans.items())]


# --- levels and text ------------------------------------------------------------------------


def _levels(scenes: Sequence[SceneReport], model: str) -> list[str]:
    found = {row.level for s in scenes for row in headlines(s) if row.model == model and row.level != LIMIT}
    return [level_label(level) for level in sorted(found, key=ranking)]
