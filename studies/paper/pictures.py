"""All pictures of the paper study's report: which there are, what goes into them, where they are."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Final

from studies.paper.cases import REFERENCE_SCENES
from studies.paper.numbers import HIGHEST_KPA, finest, is_known, named, tip
from studies.paper.plots import assumptions, beyond, blocked, elongations, layout, paths, rings
from studies.paper.plots.assumptions import draw_assumptions
from studies.paper.plots.beyond import draw_beyond
from studies.paper.plots.blocked import draw_blocked
from studies.paper.plots.elongations import draw_conventions, draw_dimensions_matter, draw_elongations
from studies.paper.plots.rings import draw_rings
from studies.paper.results import CaseResult, PaperResults
from studies.report import curves, style
from studies.report.drawn import key_of, once
from studies.report.numbers import value_text
from studies.report.pictures import bodies, half_sections, outside, roots
from studies.report.pictures.child import draw_side_by_side, draw_states
from studies.report.pictures.roots import RootPanel, draw_root_fields, root_panel
from studies.report.pictures.stills import Still
from studies.report.scene_page import ring_boxes
from studies.results.files import field_files

# The actuator and the pressure (kPa) of the view of the paper's Figure 4B; which one that shows is not printed.
FIGURE_4B: Final = (REFERENCE_SCENES[0], 10.0)
# Begins the names of pictures of the states of an actuator; its name follows.
STATES: Final = "states-"

# Plots of all results by the name they have in the page and in the folder.
_PLOTS: Final[Mapping[str, Callable[[Path, PaperResults], str]]] = {
    "elongations": draw_elongations,
    "dimensions": draw_dimensions_matter,
    "beyond": draw_beyond,
    "assumptions": draw_assumptions,
    "blocked": draw_blocked,
    "conventions": draw_conventions,
    "rings": draw_rings,
}
_PLOTTING: Final = (assumptions, beyond, blocked, elongations, layout, paths, rings)


def draw_all(folder: Path, results: PaperResults) -> dict[str, str]:
    """Draw all pictures into ``folder/pictures``.

    Returns
    -------
    dict of str to str
        By name the address relative to the folder, or a sentence why there is no picture.
    """
    (folder / "pictures").mkdir(parents=True, exist_ok=True)
    found = {}
    hashes = [run.summary.content_hash for case in results.cases for run in case.result.axisymmetric]
    key = key_of(results.rows, hashes, code=[*_PLOTTING, curves, style])
    for name, draw in _PLOTS.items():
        address = f"pictures/{name}.png"
        found[name] = once(folder / address, key, lambda a=address, d=draw: d(folder / a, results)) or address  # type: ignore[misc]
    found["roots"] = _drawn(folder, "roots", lambda path: _draw_roots(path, results))
    for name in REFERENCE_SCENES:
        stills = _stills(named(results, name))
        found[STATES + name] = _drawn(folder, STATES + name, lambda path, s=stills: _once(path, s, draw_states))  # type: ignore[misc]
    name, pressure = FIGURE_4B
    pair = _stills(named(results, name), (pressure,))
    found["figure4b"] = _drawn(folder, "figure4b", lambda path: _once(path, pair, draw_side_by_side))
    return found


def _drawn(folder: Path, name: str, draw: Callable[[Path], str]) -> str:
    address = f"pictures/{name}.png"
    return draw(folder / address) or address


def _once(path: Path, stills: Sequence[Still], draw: Callable[[Path, Sequence[Still]], str]) -> str:
    """Draw states of a body unless that picture is there."""
    if not stills:
        return "no fields of full 3D states were kept"
    key = key_of(stills, files=[still.vtu for still in stills], code=[bodies, half_sections, outside, style])
    return once(path, key, lambda: draw(path, stills))


def _stills(case: CaseResult | None, pressures_kpa: Sequence[float] = ()) -> list[Still]:
    """The unloaded body of the finest full 3D run, then its states, at some requested pressures (kPa) or at all."""
    run = finest(case.result.full3d) if case else None
    if case is None or run is None:
        return []
    place = case.folder / f"full3d-{run.summary.level}"
    fields = field_files(place, pressures_kpa or case.result.scene.load.pressure_kpa)
    if not fields:
        return []
    rings = ring_boxes(case.result.scene, place, run.summary.content_hash, list(fields))
    stills = [Still("0 kPa", next(iter(fields.values())), deformed=False, rings=rings.get(0.0, ()))]
    for pressure, vtu in sorted(fields.items()):
        row = tip(case, "full3d", pressure)
        reached = f"\ntip +{value_text(row)} mm" if is_known(row) else ""
        stills.append(Still(f"{pressure:g} kPa{reached}", vtu, rings=rings.get(pressure, ())))
    return stills


def _draw_roots(path: Path, results: PaperResults) -> str:
    """Draw the middle root of every reference actuator at 20 kPa, in the finest axisymmetric state."""
    panels: list[RootPanel] = []
    keys: list[object] = []
    for name in REFERENCE_SCENES:
        case = named(results, name)
        run = finest(case.result.axisymmetric) if case else None
        if case and run:
            place = case.folder / f"axisymmetric-{run.summary.level}"
            panel = root_panel(case.result.scene, run, place, HIGHEST_KPA)
            panels += [panel] if panel else []
            keys.append((name, run.summary.content_hash, run.summary.level))
    return once(path, key_of(keys, len(panels), code=[roots, style]), lambda: draw_root_fields(path, panels))
