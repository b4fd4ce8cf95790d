"""Report of a study as Markdown and as one self-contained HTML file, rendered from rows and runs."""

from __future__ import annotations

import base64
import math
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

import markdown
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from studies.pictures import Still, draw_states
from studies.plots import Curve, draw_elongation, draw_overview, draw_times
from studies.results import PATH_FILE, PathRow, RunSummary, write_path, write_text_atomically
from studies.rows import Row, write_rows

TIP = "tip_mm"
REACHED = "reached"
MISSING = "–"

# What the report calls a rung, in the order of its columns; rungs not named here follow.
RUNGS: Mapping[str, str] = {
    "closed_form": "closed form",
    "closed_form_seat": "closed form, free pitch",
    "axisymmetric": "axisymmetric",
    "sector": "sector",
    "full3d": "full 3D",
    "paper_closed_form": "paper: closed form",
    "paper_ansys": "paper: ANSYS",
    "paper_experiment": "paper: experiment",
}
# What the others are compared with: the first of these that reached the pressure.
REFERENCES = ("full3d", "axisymmetric")
ACTIVITIES = ("mesh", "compile", "pattern", "residual", "tangent", "factor", "solve", "checks", "output")

_TEMPLATES = Path(__file__).parent / "templates"
_STOPPED = re.compile(r"stopped at ([-+.\deE]+) kPa")
_PICTURE = re.compile(r'src="(pictures/[^"]+)"')


@dataclass(frozen=True)
class SceneReport:
    """What the report says of one scene.

    Attributes
    ----------
    name, title
        Name of the scene, and its heading.
    scene_toml
        Text of the scene file.
    pressures_kpa
        Asked pressures, kPa.
    rows
        The scene's comparison rows.
    runs
        Every run behind them.
    paths
        All converged states by ``"rung level"``, for instance ``"full3d n24"``.
    fields
        By asked pressure (kPa) the .vtu of the finest full 3D run; may be empty.
    notes
        Sentences: what was skipped and why, warnings.
    """

    name: str
    title: str
    scene_toml: str
    pressures_kpa: tuple[float, ...]
    rows: tuple[Row, ...]
    runs: tuple[RunSummary, ...]
    paths: dict[str, list[PathRow]]
    fields: dict[float, Path]
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """Cells of a table as text; columns in ``left`` are left-aligned, the others right."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    left: tuple[int, ...] = (0,)


def write_report(
    folder: Path,
    title: str,
    introduction: str,
    scenes: Sequence[SceneReport],
    provenance: dict[str, str],
    wall_s: float,
) -> Path:
    """Write report.md, report.html, rows.csv, pictures/ and paths/.

    Parameters
    ----------
    folder
        Where to; made if missing.
    title, introduction
        Heading, and Markdown that follows it.
    scenes
        What to report.
    provenance
        Commit, versions, BLAS, machine, date: by the name shown.
    wall_s
        Wall time of the whole study, s.

    Returns
    -------
    Path
        report.html.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_rows(folder / "rows.csv", (row for scene in scenes for row in scene.rows))
    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES), undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["cell"] = _cell
    text = environment.get_template("report.md.j2").render(
        title=title,
        introduction=introduction,
        summary=_summary(scenes),
        overview=_draw_overview(folder, scenes),
        compared_with_paper=any(_is_printed(row) for scene in scenes for row in scene.rows),
        levels={rung: _levels(scenes, rung) for rung in REFERENCES},
        scenes=[_scene(folder, scene) for scene in scenes],
        provenance=_provenance(scenes, provenance),
        wall=_duration(wall_s),
    )
    write_text_atomically(folder / "report.md", text)
    body = markdown.markdown(text, extensions=["tables", "fenced_code", "md_in_html", "sane_lists"])
    page = environment.get_template("report.html.j2").render(
        title=title,
        style=(_TEMPLATES / "report.css").read_text(encoding="utf-8"),
        body=_PICTURE.sub(lambda found: f'src="{_data_uri(folder / found[1])}"', body),
    )
    write_text_atomically(folder / "report.html", page)
    return folder / "report.html"


def fineness(level: str) -> int:
    """Number in a level's name (``r4``: 4, ``n24``: 24); 0 if it has none."""
    found = re.search(r"\d+", level)
    return int(found[0]) if found else 0


def headline(scene: SceneReport, rung: str, pressure_kpa: float) -> Row | None:
    """The tip's row of a rung's finest level at a pressure, reached or not; None if there is none."""
    found = [row for row in scene.rows if (row.quantity, row.rung) == (TIP, rung)]
    found = [row for row in found if math.isclose(row.pressure_kpa, pressure_kpa)]
    return max(found, key=lambda row: fineness(row.level), default=None)


def verdict(scene: SceneReport) -> str:
    """How far the axisymmetric model is from full 3D over all pressures that both reached."""
    pairs = [
        (axisymmetric, full)
        for pressure in scene.pressures_kpa
        if (axisymmetric := headline(scene, "axisymmetric", pressure))
        and (full := headline(scene, "full3d", pressure))
        and math.isfinite(axisymmetric.value)
        and math.isfinite(full.value)
        and full.value != 0.0
    ]
    if not pairs:
        return "no pressure that both axisymmetric and full 3D reached"
    largest = max(abs(_difference(one.value, other.value)) for one, other in pairs)
    text = f"axisymmetric within {_rounded_up(largest, 2):g} % of full 3D"
    if len(pairs) < len(scene.pressures_kpa):
        text += f" at {len(pairs)} of {len(scene.pressures_kpa)} pressures"
    margins = [one.uncertainty + other.uncertainty - abs(one.value - other.value) for one, other in pairs]
    if all(math.isfinite(margin) for margin in margins):
        text += f", {'within' if min(margins) >= 0.0 else 'beyond'} the sum of their uncertainties"
    return text


# --- tables ---------------------------------------------------------------------------------


def _summary(scenes: Sequence[SceneReport]) -> Table:
    rungs = _ordered(row.rung for scene in scenes for row in scene.rows if row.quantity == TIP)
    lines = []
    for scene in scenes:
        highest = max(scene.pressures_kpa)
        values = [_value(headline(scene, rung, highest)) for rung in rungs]
        link = f"[{scene.name}](#{_anchor(scene)})"
        lines.append((link, f"{highest:g}", *values, _status(scene), verdict(scene)))
    header = ("scene", "kPa", *map(_label, rungs), "status", "verdict")
    return Table(header, tuple(lines), left=(0, len(header) - 2, len(header) - 1))


def _tips(scene: SceneReport) -> Table:
    """The side-by-side table: a line per pressure, a column per rung, and the negative modes."""
    rungs = _rungs(scene)
    counted = [rung for rung in RUNGS if _finest_path(scene, rung)]
    lines = []
    for pressure in scene.pressures_kpa:
        values = [_value(headline(scene, rung, pressure)) for rung in rungs]
        modes = [_modes(_finest_path(scene, rung), pressure) for rung in counted]
        lines.append((f"{pressure:g}", *values, *modes))
    header = ("pressure, kPa", *map(_label, rungs))
    header += tuple(f"unstable modes, {_label(rung)}" for rung in counted)
    return Table(header, tuple(lines), left=())


def _differences(scene: SceneReport) -> Table:
    """Differences from the best model that reached each pressure, in percent."""
    rungs = [rung for rung in _rungs(scene) if rung != REFERENCES[0]]
    lines = []
    for pressure in scene.pressures_kpa:
        reference = _reference(scene, pressure)
        if reference is None:
            lines.append((f"{pressure:g}", *(MISSING,) * (1 + len(rungs))))
            continue
        cells = []
        for rung in rungs:
            row = headline(scene, rung, pressure)
            known = row is not None and math.isfinite(row.value) and rung != reference.rung
            cells.append(_signed(_difference(row.value, reference.value)) if row and known else MISSING)
        lines.append((f"{pressure:g}", _label(reference.rung), *cells))
    header = ("pressure, kPa", "compared with", *map(_label, rungs))
    return Table(header, tuple(lines), left=(1,))


def _comparisons(scene: SceneReport) -> Table:
    """The tip's rows whose reference is another than that of `_differences`, finest level of each rung."""
    lines = []
    for rung in _rungs(scene):
        for pressure in scene.pressures_kpa:
            row, usual = headline(scene, rung, pressure), _reference(scene, pressure)
            shown = row and usual and math.isclose(row.reference, usual.value, rel_tol=1e-6)
            if row and math.isfinite(row.reference) and not shown:
                error = _signed(row.error_percent) if math.isfinite(row.error_percent) else MISSING
                model = _model(rung, row.level)
                lines.append(
                    (model, f"{pressure:g}", _value(row), f"{row.reference:.5g}", error, row.source or MISSING)
                )
    header = ("model", "pressure, kPa", "value, mm", "reference, mm", "error, %", "source of the reference")
    return Table(header, tuple(lines), left=(0, 5))


def _stops(scene: SceneReport) -> list[str]:
    """A sentence per way in which levels did not reach a pressure, with its reason."""
    stops = [row for row in scene.rows if row.quantity == TIP and row.status != REACHED]
    found: dict[tuple[str, str], dict[str, None]] = {}
    for row in stops:
        found.setdefault((row.rung, row.status), {})[row.level] = None
    sentences = []
    for (rung, status), levels in found.items():
        asked = sorted({row.pressure_kpa for row in stops if (row.rung, row.status) == (rung, status)})
        asked_text = ", ".join(f"{pressure:g}" for pressure in asked)
        sentences.append(f"{_model(rung, ', '.join(levels))}, asked for {asked_text} kPa: {status}")
    return sentences


def _convergence(scene: SceneReport) -> Table:
    """The tip at each level beside its size, so that the discretisation error is seen."""
    lines = []
    for rung in _rungs(scene):
        levels = sorted({row.level for row in scene.rows if (row.quantity, row.rung) == (TIP, rung)}, key=fineness)
        if levels == [""]:
            continue
        for level in levels:
            run = next((run for run in scene.runs if (run.rung, run.level) == (rung, level)), None)
            size = (_count(run.cells), _count(run.nodes), _count(run.dofs)) if run else (MISSING,) * 3
            tips = [_level_value(scene, rung, level, pressure) for pressure in scene.pressures_kpa]
            lines.append((_model(rung, level), *size, *tips))
        bounds = [headline(scene, rung, pressure) for pressure in scene.pressures_kpa]
        if any(row and math.isfinite(row.uncertainty) for row in bounds):
            known = (row.uncertainty if row else math.nan for row in bounds)
            texts = (MISSING if math.isnan(bound) else f"± {_up(bound, 3)}" for bound in known)
            lines.append((f"uncertainty of {_model(rung, levels[-1])}", "", "", "", *texts))
    header = (f"at {pressure:g} kPa, mm" for pressure in scene.pressures_kpa)
    return Table(("model", "cells", "nodes", "unknowns", *header), tuple(lines))


def _others(scene: SceneReport) -> Table:
    """All quantities but the tip: a line per quantity and model, a column per pressure."""
    rows = [row for row in scene.rows if row.quantity != TIP]
    pressures = sorted({row.pressure_kpa for row in rows if math.isfinite(row.pressure_kpa)})
    has_none = any(not math.isfinite(row.pressure_kpa) for row in rows)
    columns = [*([math.nan] if has_none else []), *pressures]
    lines: dict[tuple[str, str], dict[str, str]] = {}
    sources: dict[tuple[str, str], list[str]] = {}
    for row in rows:
        unit = "" if row.unit in ("", "-", "1") else f", {row.unit}"
        key = (f"{row.quantity}{unit}", _model(row.rung, row.level))
        lines.setdefault(key, {})[f"{row.pressure_kpa:g}"] = _generic(row)
        if row.source and row.source not in sources.setdefault(key, []):
            sources[key].append(row.source)
    header = [f"{p:g} kPa" if math.isfinite(p) else "any pressure" for p in columns]
    cells = tuple(
        (*key, *(line.get(f"{p:g}", MISSING) for p in columns), "; ".join(sources.get(key, [])) or MISSING)
        for key, line in lines.items()
    )
    return Table(("quantity", "model", *header, "compared with"), cells, left=(0, 1, 2 + len(columns)))


def _work(scene: SceneReport) -> Table:
    lines = tuple(
        (
            _model(run.rung, run.level),
            run.status,
            *(_count(n) for n in (run.dofs, run.factorisations, run.newton_iterations, run.rejected_steps)),
            f"{run.peak_mb:.0f}",
            f"{run.ranks}",
            f"{run.threads}",
        )
        for run in scene.runs
    )
    header = ("run", "status", "unknowns", "factorisations", "Newton iterations", "rejected steps")
    return Table((*header, "peak memory, MB", "ranks", "threads"), lines, left=(0, 1))


def _seconds(runs: Sequence[RunSummary]) -> dict[str, list[float]]:
    """Seconds by activity, a number per run; ``other`` is what no activity of the run accounts for."""
    named = [name for name in ACTIVITIES if any(name in run.time_s for run in runs)]
    more = sorted({name for run in runs for name in run.time_s} - {*ACTIVITIES, "total", "other"})
    split = {name: [run.time_s.get(name, 0.0) for run in runs] for name in (*named, *more)}
    accounted = [sum(column) for column in zip(*split.values(), strict=True)] or [0.0] * len(runs)
    totals = [run.time_s.get("total", known) for run, known in zip(runs, accounted, strict=True)]
    split["other"] = [max(0.0, total - known) for total, known in zip(totals, accounted, strict=True)]
    return split


def _times(scene: SceneReport) -> Table:
    split = _seconds(scene.runs)
    lines = []
    for place, run in enumerate(scene.runs):
        seconds = [values[place] for values in split.values()]
        total = run.time_s.get("total", sum(seconds))
        lines.append((_model(run.rung, run.level), *(_short(value) for value in (*seconds, total))))
    return Table(("run, s", *split, "total"), tuple(lines))


def _masses(scene: SceneReport) -> Table:
    """Masses of the meshes, equal ones on one line, and what the rows compare them with."""
    runs: dict[tuple[str, ...], list[RunSummary]] = {}
    for run in scene.runs:
        masses = (run.silicone_g, run.ring_g, run.silicone_g + run.ring_g)
        texts = tuple(MISSING if math.isnan(mass) else f"{mass:.2f}" for mass in masses)
        runs.setdefault(texts, []).append(run)
    lines = [(_models(equal), *masses) for masses, equal in runs.items()]
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


def _provenance(scenes: Sequence[SceneReport], provenance: Mapping[str, str]) -> Table:
    """The caller's stamps, and those of the runs: a run that was not repeated keeps its own."""
    runs = [run for scene in scenes for run in scene.runs]
    stamps = {
        "commit of the runs": sorted({run.commit for run in runs}),
        "BLAS of the runs": sorted({run.blas for run in runs}),
        "versions of the runs": sorted(
            {", ".join(f"{name} {version}" for name, version in run.versions.items()) for run in runs}
        ),
        "runs made": sorted({run.when for run in runs}),
    }
    if len(stamps["runs made"]) > 2:
        stamps["runs made"] = [f"{stamps['runs made'][0]} to {stamps['runs made'][-1]}"]
    lines = [*provenance.items(), *((name, "; ".join(values)) for name, values in stamps.items() if values)]
    return Table(("what", "value"), tuple((name, value or MISSING) for name, value in lines), left=(0, 1))


# --- a scene's pictures and files -----------------------------------------------------------


def _scene(folder: Path, scene: SceneReport) -> dict[str, Any]:
    """What the template shows of a scene; draws its pictures on the way."""
    anchor = _anchor(scene)
    elongation, states, times = (f"pictures/{anchor}-{name}.png" for name in ("elongation", "states", "times"))
    draw_elongation(folder / elongation, _curves(scene), scene.pressures_kpa)
    if scene.runs:
        draw_times(folder / times, [_model(run.rung, run.level) for run in scene.runs], _seconds(scene.runs))
    why_no_states = "no fields were kept"
    if scene.fields:
        why_no_states = draw_states(folder / states, _stills(scene))
    return {
        "anchor": anchor,
        "name": scene.name,
        "title": scene.title,
        "toml": scene.scene_toml.strip(),
        "verdict": verdict(scene),
        "tips": _tips(scene),
        "differences": _differences(scene),
        "printed_in": list(dict.fromkeys(row.source for row in scene.rows if _is_printed(row) and row.source)),
        "comparisons": _comparisons(scene),
        "stops": _stops(scene),
        "elongation": elongation,
        "states": states,
        "why_no_states": why_no_states,
        "convergence": _convergence(scene),
        "instabilities": _instabilities(scene),
        "others": _others(scene),
        "masses": _masses(scene),
        "work": _work(scene),
        "time_table": _times(scene),
        "times": times if scene.runs else "",
        "notes": [*scene.notes, *_plans(scene)],
        "files": _files(folder, scene),
    }


def _curves(scene: SceneReport) -> list[Curve]:
    """The curves of the pressure-elongation plot, the references as their paths where there are any."""
    curves = []
    for rung in _rungs(scene):
        rows = [row for p in scene.pressures_kpa if (row := headline(scene, rung, p))]
        reached = [row for row in rows if math.isfinite(row.value)]
        points = [(row.pressure_kpa, row.value) for row in reached]
        bars = [row.uncertainty for row in reached]
        path = [(state.pressure_kpa, state.tip_mm) for state in _finest_path(scene, rung)]
        if rung == "axisymmetric" and path:
            points, bars = _from_rest(path), []
        elif not rung.startswith("paper_") and rung != "full3d":
            points, bars = _from_rest(points), []
        stop = next((row.status for row in rows if row.status != REACHED), "")
        end = (path or _from_rest(points))[-1]
        curves.append(
            Curve(
                rung=rung,
                label=_label(rung),
                pressure_kpa=tuple(pressure for pressure, _ in points),
                tip_mm=tuple(tip for _, tip in points),
                uncertainty_mm=tuple(bars) if any(math.isfinite(bar) for bar in bars) else (),
                markers=not (rung == "axisymmetric" and path),
                stopped=f"{_label(rung)} {_short_status(stop)}" if stop else "",
                stopped_at=end,
            )
        )
    return curves


def _from_rest(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    return points if points and points[0][0] == 0.0 else [(0.0, 0.0), *points]


def _stills(scene: SceneReport) -> list[Still]:
    fields = sorted(scene.fields.items())
    stills = [Still("unloaded", fields[0][1], deformed=False)]
    for pressure, vtu in fields:
        row = headline(scene, "full3d", pressure)
        tip = f"\ntip +{row.value:.1f} mm" if row and math.isfinite(row.value) else ""
        stills.append(Still(f"{pressure:g} kPa{tip}", vtu))
    return stills


def _draw_overview(folder: Path, scenes: Sequence[SceneReport]) -> str:
    """Draw all scenes at their highest pressure; the picture's place, empty for a single scene."""
    if len(scenes) < 2:
        return ""
    values: dict[tuple[str, str], list[float]] = {}
    for rung in _ordered(row.rung for scene in scenes for row in scene.rows if row.quantity == TIP):
        rows = [headline(scene, rung, max(scene.pressures_kpa)) for scene in scenes]
        values[rung, _label(rung)] = [row.value if row else math.nan for row in rows]
    labels = [f"{scene.name}\n{max(scene.pressures_kpa):g} kPa" for scene in scenes]
    draw_overview(folder / "pictures/overview.png", labels, values)
    return "pictures/overview.png"


def _files(folder: Path, scene: SceneReport) -> list[tuple[str, str]]:
    """Write the paths into the report's folder; label and relative address of each file."""
    files = []
    for key, states in scene.paths.items():
        place = Path("paths", _anchor(scene), key.replace(" ", "-"))
        write_path(folder / place, states)
        files.append((f"{_model(*_split(key))}: path", quote(str(place / PATH_FILE))))
    for pressure, vtu in sorted(scene.fields.items()):
        address = quote(os.path.relpath(vtu.resolve(), folder.resolve()))
        files.append((f"full 3D, {pressure:g} kPa: fields", address))
    return files


def _plans(scene: SceneReport) -> list[str]:
    """What the runs' plans skipped, each sentence once, with the runs it holds for."""
    found: dict[str, list[RunSummary]] = {}
    for run in scene.runs:
        for sentence in run.plan:
            found.setdefault(sentence, []).append(run)
    return [f"{sentence} ({_models(runs)})" for sentence, runs in found.items()]


def _instabilities(scene: SceneReport) -> list[str]:
    """A sentence per path that has states with negative modes: the first of them."""
    sentences = []
    for key, states in scene.paths.items():
        first = next((state for state in states if state.unstable_modes > 0), None)
        if first:
            where = f"{_number(first.pressure_kpa)} kPa and {first.tip_mm:.2f} mm"
            sentences.append(f"{_model(*_split(key))}: first state with {first.unstable_modes:.0f} unstable at {where}")
    return sentences


# --- rows and levels ------------------------------------------------------------------------


def _ordered(rungs: Iterable[str]) -> list[str]:
    """Rungs once each, known ones first and in the order of `RUNGS`."""
    given = list(dict.fromkeys(rungs))
    return [*(rung for rung in RUNGS if rung in given), *(rung for rung in given if rung not in RUNGS)]


def _rungs(scene: SceneReport) -> list[str]:
    return _ordered(row.rung for row in scene.rows if row.quantity == TIP)


def _is_printed(row: Row) -> bool:
    return row.rung.startswith("paper_")


def _levels(scenes: Sequence[SceneReport], rung: str) -> list[str]:
    return sorted(
        {row.level for s in scenes for row in s.rows if (row.quantity, row.rung) == (TIP, rung)}, key=fineness
    )


def _reference(scene: SceneReport, pressure_kpa: float) -> Row | None:
    rows = (headline(scene, rung, pressure_kpa) for rung in REFERENCES)
    return next((row for row in rows if row and math.isfinite(row.value) and row.value != 0.0), None)


def _finest_path(scene: SceneReport, rung: str) -> list[PathRow]:
    keys = [key for key in scene.paths if _split(key)[0] == rung]
    return scene.paths[max(keys, key=lambda key: fineness(_split(key)[1]))] if keys else []


def _modes(states: Sequence[PathRow], pressure_kpa: float) -> str:
    """Negative modes at an asked pressure; a dash where it was not reached or they were not counted."""
    asked = (state for state in states if state.status == "asked")
    found = next((s for s in asked if math.isclose(s.pressure_kpa, pressure_kpa, rel_tol=1e-6)), None)
    return MISSING if found is None or math.isnan(found.unstable_modes) else f"{found.unstable_modes:.0f}"


def _level_value(scene: SceneReport, rung: str, level: str, pressure_kpa: float) -> str:
    for row in scene.rows:
        if (row.quantity, row.rung, row.level) == (TIP, rung, level) and math.isclose(row.pressure_kpa, pressure_kpa):
            return f"{row.value:.3f}" if math.isfinite(row.value) else _short_status(row.status)
    return MISSING


def _status(scene: SceneReport) -> str:
    stops: dict[tuple[str, str], dict[str, None]] = {}
    for row in scene.rows:
        if row.quantity == TIP and row.status != REACHED:
            stops.setdefault((row.rung, _short_status(row.status)), {})[row.level] = None
    texts = (f"{_model(rung, ', '.join(levels))} {status}" for (rung, status), levels in stops.items())
    return "; ".join(texts) or REACHED


def _split(key: str) -> tuple[str, str]:
    rung, _, level = key.partition(" ")
    return rung, level


# --- text -----------------------------------------------------------------------------------


def _label(rung: str) -> str:
    return RUNGS.get(rung, rung.replace("_", " "))


def _model(rung: str, level: str) -> str:
    return f"{_label(rung)} {level}".strip()


def _models(runs: Iterable[RunSummary]) -> str:
    levels: dict[str, list[str]] = {}
    for run in runs:
        levels.setdefault(run.rung, []).append(run.level)
    return "; ".join(_model(rung, ", ".join(of_rung)) for rung, of_rung in levels.items())


def _anchor(scene: SceneReport) -> str:
    return re.sub(r"[^a-z0-9]+", "-", scene.name.lower()).strip("-")


def _value(row: Row | None) -> str:
    """Tip, mm, and its uncertainty; printed numbers with the digits they have."""
    if row is None:
        return MISSING
    if not math.isfinite(row.value):
        return _short_status(row.status)
    if _is_printed(row):
        return f"{row.value:g}"
    text = f"{row.value:.2f}"
    return text if math.isnan(row.uncertainty) else f"{text} ± {_up(row.uncertainty, 2)}"


def _generic(row: Row) -> str:
    """Any row's value, its uncertainty and what it is compared with."""
    if not math.isfinite(row.value):
        return _short_status(row.status)
    text = f"{row.value:.4g}"
    if math.isfinite(row.uncertainty):
        text += f" ± {_rounded_up(row.uncertainty, 2):.2g}"
    if math.isfinite(row.error_percent):
        text += f" ({_signed(row.error_percent)} % from {row.reference:g})"
    return text


def _short_status(status: str) -> str:
    """A status without its reason; the reason is listed below the table."""
    found = _STOPPED.match(status)
    return found[0] if found else status


def _difference(value: float, reference: float) -> float:
    return 100.0 * (value - reference) / abs(reference)


def _signed(percent: float) -> str:
    text = f"{percent:+.2f}" if abs(percent) < 1.0 else f"{percent:+.1f}"
    return text.replace("-", "\N{MINUS SIGN}")


def _up(value: float, decimals: int) -> str:
    """An uncertainty rounded up, so that none reads as zero."""
    scale = 10.0**decimals
    return f"{math.ceil(value * scale - 1e-9) / scale:.{decimals}f}"


def _rounded_up(value: float, digits: int) -> float:
    """The next number with so many significant digits that is not smaller."""
    if value == 0.0 or not math.isfinite(value):
        return value
    scale = 10.0 ** (digits - 1 - math.floor(math.log10(abs(value))))
    return math.ceil(value * scale - 1e-9) / scale


def _count(number: int) -> str:
    return f"{number:,}".replace(",", "\N{NARROW NO-BREAK SPACE}")


def _number(value: float) -> str:
    return f"{value:.4g}"


def _short(seconds: float) -> str:
    return f"{seconds:.1f}" if seconds < 100.0 else f"{seconds:.0f}"


def _duration(seconds: float) -> str:
    if seconds < 120.0:
        return f"{seconds:.1f} s"
    return f"{seconds / 60.0:.1f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"


def _cell(text: str) -> str:
    """Text made safe for a Markdown table and for HTML."""
    text = re.sub(r"[ \t\r\n]+", " ", text).strip()
    return text.replace("&", "&amp;").replace("<", "&lt;").replace("|", "\\|")


def _data_uri(picture: Path) -> str:
    return "data:image/png;base64," + base64.b64encode(picture.read_bytes()).decode("ascii")
