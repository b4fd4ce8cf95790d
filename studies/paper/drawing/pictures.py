"""All pictures of the paper study's report: which there are, what goes into them, where they are."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Final

from meshes import bellows, fold, meridian, sweep
from studies.paper.cases import HIGHEST_KPA, REFERENCE_SCENES
from studies.paper.drawing import blocked, front, lines, meshes, outline, panels, plots, sets
from studies.paper.results import CaseResult, PaperResults, is_known
from studies.paper.setup.sizes import ZIGZAG, scene_file
from studies.report import curves, style
from studies.report.drawn import key_of, once
from studies.report.numbers import value_text
from studies.report.pictures import bodies, half_outlines, half_sections, outside, roots
from studies.report.pictures.child import draw_side_by_side, draw_states
from studies.report.pictures.stills import Still
from studies.report.scene_page import ring_boxes
from studies.results import closed_form_rows
from studies.results.run_files import field_files

# The actuator and the pressure (kPa) of the view of the paper's Figure 4B; which one that shows is not printed.
FIGURE_4B: Final = (REFERENCE_SCENES[0], 10.0)
# Begins the names of pictures of the states of an actuator; its name follows.
STATES: Final = "states-"

# Plots of all results by the name they have in the page and in the folder.
_PLOTS: Final[Mapping[str, Callable[[Path, PaperResults], str]]] = {
    "elongations": panels.draw_elongations,
    "dimensions": panels.draw_dimensions_matter,
    "sets": sets.draw_sets,
    "beyond": plots.draw_beyond,
    "assumptions": plots.draw_assumptions,
    "blocked": blocked.draw_blocked,
    "conventions": panels.draw_conventions,
}


def draw_all(folder: Path, results: PaperResults) -> dict[str, str]:
    """Draw all pictures into ``folder/pictures``.

    Returns
    -------
    dict of str to str
        By name the address relative to the folder, or a sentence why there is no picture.
    """
    hashes = [run.content_hash for run in results.summaries if run.model == "axisymmetric"]
    crossings = [case.crossings for case in results.cases]
    code = [blocked, lines, panels, plots, sets, curves, style, closed_form_rows]
    key = key_of(results.rows, hashes, crossings, code=code)
    found: dict[str, str] = {}

    def add(name: str, draw: Callable[[Path], str]) -> None:
        address = f"pictures/{name}.png"
        found[name] = draw(folder / address) or address

    top = stretch_top(results)
    name, pressure = FIGURE_4B
    pair = _stills(results.named(name), (pressure,))
    pair = [replace(still, label=f"{name}, {still.label}") for still in pair]
    drawn = {
        STATES + name: partial(_draw_states, stills=_stills(results.named(name)), top=top) for name in REFERENCE_SCENES
    }
    drawn["figure4b"] = partial(_draw_pair, stills=pair)
    found |= dict.fromkeys([*_PLOTS, "outline", "mesh", "roots", *drawn], "")  # in this order
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as waiting:  # each is drawn by a process of its own
        done = waiting.map(add, drawn.keys(), drawn.values())
        for name, plot in _PLOTS.items():
            add(name, lambda path, plot=plot: once(path, key, lambda: plot(path, results)))  # type: ignore[misc]
        setups = (outline, half_outlines), (meshes,)
        add("outline", lambda path: _draw_setup(path, REFERENCE_SCENES[0], outline.draw_outlines, setups[0]))
        add("mesh", lambda path: _draw_setup(path, REFERENCE_SCENES[2], meshes.draw_meshes, setups[1]))
        add("roots", lambda path: _draw_roots(path, results))
        list(done)
    states = folder / f"pictures/{STATES}{front.ACTUATOR}.png"
    key = key_of(results.rows, hashes, code=[front, lines, panels, style, closed_form_rows], files=[states])
    add("front", lambda path: once(path, key, lambda: front.draw_front(path, results, states)))
    return found


def _draw_states(path: Path, stills: list[Still], top: float | None) -> str:
    return _draw_stills(path, stills, lambda: draw_states(path, stills, top), top)


def _draw_pair(path: Path, stills: list[Still]) -> str:
    return _draw_stills(path, stills, lambda: draw_side_by_side(path, stills))


def _draw_setup(path: Path, name: str, draw: Callable[[Path, str], str], code: Sequence[ModuleType]) -> str:
    """Draw an actuator at rest, from its scene files, unless that picture is there."""
    scenes = [scene_file(name, of) for of in ("", ZIGZAG)]
    key = key_of(scenes, code=[*code, bellows, fold, meridian, sweep, style])
    return once(path, key, lambda: draw(path, name))


def stretch_top(results: PaperResults) -> float | None:
    """Largest stretch of the reference actuators away from the bond's edges, where meshes agree; None if unknown."""
    rows = [row for case in results.of("core") for row in case.rows if row.quantity == "peak_stretch_away"]
    return max((row.value for row in rows if row.model == "axisymmetric" and math.isfinite(row.value)), default=None)


def _draw_stills(path: Path, stills: Sequence[Still], draw: Callable[[], str], *shown: object) -> str:
    """Draw states of a body unless that picture is there."""
    if not stills:
        return "no fields of full 3D states were kept"
    code = [bodies, half_sections, outside, style]
    return once(path, key_of(stills, *shown, files=[still.vtu for still in stills], code=code), draw)


def _stills(case: CaseResult, pressures_kpa: Sequence[float] = ()) -> list[Still]:
    """The unloaded body of the finest full 3D run, then its states, at some requested pressures (kPa) or at all."""
    if not case.full3d:
        return []
    run = case.full3d[-1].summary
    place = case.folder / f"full3d-{run.level}"
    fields = field_files(place, pressures_kpa or case.pressures_kpa)
    if not fields:
        return []
    rings = ring_boxes(case.scene, place, run.content_hash, list(fields))
    stills = [Still("0 kPa", next(iter(fields.values())), deformed=False, rings=rings.get(0.0, ()))]
    for pressure, vtu in sorted(fields.items()):
        row = case.tip("full3d", pressure)
        reached = f"\ntip +{value_text(row)} mm" if is_known(row) else ""
        stills.append(Still(f"{pressure:g} kPa{reached}", vtu, rings=rings.get(pressure, ())))
    return stills


def _draw_roots(path: Path, results: PaperResults) -> str:
    """Draw the middle root of every reference actuator at 20 kPa, in the finest axisymmetric state."""
    found = [(case, run) for case in map(results.named, REFERENCE_SCENES) for run in case.axisymmetric[-1:]]
    places = [case.folder / f"axisymmetric-{run.summary.level}" for case, run in found]
    drawn = [
        roots.root_panel(case.scene, run, place, HIGHEST_KPA) for (case, run), place in zip(found, places, strict=True)
    ]
    shown = [panel for panel in drawn if panel]
    keys = [(case.case.scene, run.summary.content_hash, run.summary.level) for case, run in found]
    return once(path, key_of(keys, len(shown), code=[roots, style]), lambda: roots.draw_root_fields(path, shown))
