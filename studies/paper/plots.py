"""Plots of the paper study, drawn from its results and written as PNG.

Every function returns why there is no picture, or an empty text. Cases that are missing are left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import takewhile
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter

from analytical.bellows.paper import ALTERNATE_FAMILIES, PRINTED_PRESSURE_KPA, REFERENCE_FAMILY, actuators
from studies.closed_form.tables import SILICONES, STRETCH_AT_BREAK
from studies.paper.cases import REFERENCE_SCENES, RING_VARIANTS, THICK
from studies.paper.results import CaseResult, PaperResults
from studies.report.curves import Curve, draw_curves, mark_stop, set_pressure_axis
from studies.report.labels import TIP, TIP_FORCE, model_label
from studies.report.style import BLACK, BLUE, DPI, GREEN, ORANGE, SKY, VERMILION, figure_file, style_of
from studies.results.files import PathRow
from studies.results.rows import FOLDED_BACK, Row
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene

_WIDTH_IN: Final = 8.2
# Lines and markers in a panel of several, relative to a plot of its own.
_SCALE: Final = 0.78
_TITLE, _SMALL = 10.0, 8.0  # points

_CHAINS: Final = ("closed_form_printed", "closed_form", "closed_form_balanced", "closed_form_seat")
_PRINTED: Final = ("paper_closed_form", "paper_ansys", "paper_experiment")
# The four actuators where they share axes: one hue per wall, one marker each; the second of a pair is smaller and does
# not hide the first where both agree.
_ACTUATORS: Final[dict[str, dict[str, Any]]] = dict(
    zip(
        REFERENCE_SCENES,
        (
            {"color": BLUE, "marker": "o", "markersize": 8.0},
            {"color": SKY, "marker": "s", "markersize": 5.5},
            {"color": VERMILION, "marker": "^", "markersize": 9.0},
            {"color": ORANGE, "marker": "D", "markersize": 4.5},
        ),
        strict=True,
    )
)
_SETS: Final[tuple[dict[str, Any], ...]] = (
    {"color": BLUE, "linestyle": "-"},
    {"color": VERMILION, "linestyle": "--"},
    {"color": GREEN, "linestyle": "-."},
)
_MEASURED: Final[dict[str, str]] = {
    "root_stretch_outer": "root: hoop stretch, outside",
    "wall_stretch": "side wall: stretch along it",
    "ring_hoop_stretch": "under the rings: hoop stretch",
}
_RING_MARKERS: Final = ("o", "s", "^")


# --- pictures -------------------------------------------------------------------------------


def draw_elongations(path: Path, results: PaperResults) -> str:
    """Draw elongation (mm) over pressure (kPa) by every model and as printed, a panel per reference actuator.

    A chain as printed is drawn up to where it folds back.
    """
    cases = _by_base(results.of("core"))
    if not cases:
        return "no reference actuator has been run"
    with figure_file(path, _WIDTH_IN, 7.6) as figure:
        panels = _panels(figure, "elongation at the tip, mm")
        legend: dict[str, Any] = {}
        for axes, base in zip(panels, REFERENCE_SCENES, strict=True):
            if base in cases:
                tets = results.variant(base, "tets")
                _add(legend, draw_curves(axes, _elongation_curves(cases[base], tets), _SCALE))
        _finish(panels, REFERENCE_SCENES, cases)
        bands = _draw_bands({panels[k]: cases[base] for k, base in enumerate(REFERENCE_SCENES) if base in cases})
        entries = list(legend.values())
        # beside what it belongs to
        place = next((k for k, entry in enumerate(entries) if entry.get_label() == model_label("axisymmetric")), 0)
        entries[place + 1 : place + 1] = bands
        look = {"fontsize": 8.5, "columnspacing": 1.2, "handlelength": 2.4}
        figure.legend(handles=entries, loc="outside lower center", ncols=3, frameon=False, **look)
    return ""


def draw_dimensions_matter(path: Path, results: PaperResults) -> str:
    """Draw axisymmetric elongation (mm) over pressure (kPa) for the three sets of dimensions, a panel per actuator."""
    cases = _by_base(results.of("core", "alternates"))
    if not cases:
        return "no set of dimensions has been run"
    families = (REFERENCE_FAMILY, *ALTERNATE_FAMILIES)
    slots = list(zip(*([a.name for a in actuators(family)] for family in families), strict=True))
    with figure_file(path, _WIDTH_IN, 7.2) as figure:
        panels = _panels(figure, "elongation at the tip, mm")
        printed: dict[str, Any] = {}
        for k, (axes, slot) in enumerate(zip(panels, slots, strict=True)):
            found = {name: cases[name] for name in slot if name in cases}
            lines = []
            for name, style in zip(slot, _SETS, strict=True):
                if name in found and (run := _finest(found[name])):
                    what = f"{found[name].case.label}: {_sizes(found[name].result.scene)}"
                    lines += axes.plot(*_path(run, _tip), label=what, linewidth=1.6, **style)
                    _mark_end(axes, run, _tip, style["color"])
            rows = next((case.rows for case in found.values()), ())
            _add(printed, draw_curves(axes, _printed_curves(rows), _SCALE))
            wall, which = actuators()[k].printed.wall_mm, ("larger than 5", "= 5")[k % 2 == 0]
            axes.set_title(f"t = {wall:g} mm, $R_i$ {which} mm", fontsize=_TITLE)
            if lines:
                axes.legend(handles=lines, fontsize=7.0, loc="upper left", frameon=False, handlelength=2.4)
                set_pressure_axis(axes, _asked(found.values()))
        _from_zero(panels, headroom=1.42)
        figure.legend(handles=list(printed.values()), loc="outside lower center", ncols=3, frameon=False)
    return ""


def draw_beyond(path: Path, results: PaperResults) -> str:
    """Draw how far each actuator goes beyond 20 kPa: elongation (mm), largest stretch and unstable modes over kPa."""
    cases = {base: case for base, case in _by_base(results.of("beyond")).items() if _finest(case)}
    if not cases:
        return "no actuator has been taken beyond 20 kPa"
    with figure_file(path, _WIDTH_IN, 8.6) as figure:
        top, middle, strip = figure.subplots(3, 1, sharex=True, height_ratios=(3.0, 2.6, 0.9))
        entries = []
        for base, case in cases.items():
            run, style = _finest(case), _ACTUATORS[base]
            assert run is not None
            label = f"{_name(case.result.scene)}: {_ending(run)}"
            asked = [state for state in run.path if state.status == "requested"]
            top.plot(*_path(run, _tip), color=style["color"], linewidth=1.6)
            top.plot([s.pressure_kpa for s in asked], [s.tip_mm for s in asked], linestyle="none", **_dot(style))
            entries.append(Line2D([], [], label=label, **_dot(style)))
            _mark_end(top, run, _tip, style["color"])
            peaks = _series(case.rows, "peak_stretch_away", "axisymmetric")
            line = {"linewidth": 1.6, "color": style["color"], **_dot(style)}
            middle.plot([r.pressure_kpa for r in peaks], [r.value for r in peaks], **line)
        _draw_breaks(middle, [case.result.scene for case in cases.values()])
        names = [_name(case.result.scene) for case in cases.values()]
        runs = [run for case in cases.values() if (run := _finest(case))]
        _draw_modes(strip, names, runs)
        top.set_ylabel("elongation at the tip, mm")
        top.set_ylim(bottom=0.0)
        middle.set_ylabel("largest principal stretch")
        strip.set_xlabel("cavity pressure, kPa")
        asked_kpa = [p for p in _asked(cases.values()) if p % 5.0 == 0.0]
        for axes in (top, middle, strip):
            set_pressure_axis(axes, asked_kpa)
            axes.axvline(PRINTED_PRESSURE_KPA, color=BLACK, linewidth=1.0, linestyle=":", zorder=1.0)
        strip.grid(axis="y", visible=False)
        top.annotate(
            "the paper's ANSYS\ndid not converge beyond",
            (PRINTED_PRESSURE_KPA, 0.03),
            xycoords=("data", "axes fraction"),
            xytext=(4, 0),
            textcoords="offset points",
            fontsize=_SMALL,
        )
        if any(run.summary.status != "reached" for run in runs):
            cross: dict[str, Any] = {"marker": "x", "linestyle": "none", "markersize": 8.0, "markeredgewidth": 2.0}
            entries.append(Line2D([], [], color=BLACK, label="last state of a path that stopped", **cross))
        figure.legend(handles=entries, loc="outside upper center", ncols=2, frameon=False, fontsize=9.0)
    return ""


def draw_assumptions(path: Path, results: PaperResults) -> str:
    """Draw stretches the closed form assumes beside those measured in axisymmetric states, over pressure (kPa)."""
    cases = _by_base(results.of("core"))
    known = {base: case for base, case in cases.items() if any(row.quantity in _MEASURED for row in case.rows)}
    if not known:
        return "nothing has been measured in the states of the reference actuators"
    with figure_file(path, _WIDTH_IN, 3.9) as figure:
        columns = figure.subplots(1, len(_MEASURED))
        for axes, (quantity, title) in zip(columns, _MEASURED.items(), strict=True):
            for base, case in known.items():
                style = _ACTUATORS[base]
                chain = _series(case.rows, quantity, "closed_form")
                if chain:
                    points = _from_rest([(row.pressure_kpa, row.value) for row in chain], 1.0)
                    axes.plot(*zip(*points, strict=True), color=style["color"], linestyle="--", linewidth=1.5)
                found = _series(case.rows, quantity, "axisymmetric")
                axes.plot([r.pressure_kpa for r in found], [r.value for r in found], linestyle="none", **_dot(style))
            axes.axhline(1.0, color=BLACK, linewidth=0.8, zorder=1.0)
            axes.set_title(title, fontsize=_TITLE)
            axes.set_xlabel("cavity pressure, kPa")
            set_pressure_axis(axes, _asked(known.values()))
        columns[0].set_ylabel("stretch")
        marker: dict[str, Any] = {"linestyle": "none"}
        entries = [
            Line2D([], [], label=_name(case.result.scene), **marker, **_dot(_ACTUATORS[base]))
            for base, case in known.items()
        ]
        grey: dict[str, Any] = {"color": "#555555"}
        entries.append(Line2D([], [], label="closed form", linestyle="--", linewidth=1.5, **grey))
        entries.append(Line2D([], [], label="axisymmetric", **marker, **_dot({"marker": "o", **grey})))
        figure.legend(handles=entries, loc="outside lower center", ncols=3, frameon=False)
    return ""


def draw_blocked(path: Path, results: PaperResults) -> str:
    """Draw the force (N) of the blocked tip over pressure (kPa), a panel per reference actuator."""
    cases = _by_base(results.of("blocked"))
    if not cases:
        return "no actuator with a blocked tip has been run"
    with figure_file(path, _WIDTH_IN, 7.0) as figure:
        panels = _panels(figure, "force at the blocked tip, N")
        legend: dict[str, Any] = {}
        for axes, base in zip(panels, REFERENCE_SCENES, strict=True):
            if base not in cases:
                continue
            chain = _chain(cases[base].rows, "closed_form", TIP_FORCE)
            thrust = _chain(cases[base].rows, "closed_form", "extension_force_n")
            if chain:
                _add(legend, draw_curves(axes, [chain], _SCALE))
            if thrust:
                points = (thrust.pressure_kpa, thrust.tip_mm)
                look: dict[str, Any] = {"color": "#555555", "linestyle": ":", "linewidth": 1.6}
                _add(legend, axes.plot(*points, label="thrust of the pressure alone", **look))
            if run := _finest(cases[base]):
                _add(legend, _draw_blocked_path(axes, run))
        _finish(panels, REFERENCE_SCENES, cases)
        figure.legend(handles=list(legend.values()), loc="outside lower center", ncols=2, frameon=False)
    return ""


def draw_conventions(path: Path, results: PaperResults) -> str:
    """Draw the 2 mm pair with Ogden's mu read in two ways: elongation (mm) over pressure (kPa)."""
    core = _by_base(results.of("core"))
    other = _by_base(results.of("convention"))
    if not other:
        return "no actuator has been run in the other convention"
    readings = ((core, r"2$\mu/\alpha^2$", BLUE), (other, r"$\mu/\alpha$", VERMILION))
    with figure_file(path, _WIDTH_IN, 4.4) as figure:
        panels = list(figure.subplots(1, 2, sharey=True))
        legend: dict[str, Any] = {}
        for axes, base in zip(panels, THICK, strict=True):
            for cases, convention, colour in readings:
                if base not in cases:
                    continue
                if run := _finest(cases[base]):
                    label = f"axisymmetric, {convention}"
                    _add(legend, axes.plot(*_path(run, _tip), color=colour, linewidth=1.6, label=label))
                    _mark_end(axes, run, _tip, colour)
                if chain := _chain(cases[base].rows, "closed_form"):
                    look: dict[str, Any] = {"color": colour, "linestyle": "--", "marker": "^", "markersize": 5.0}
                    label = f"closed form, {convention}"
                    _add(legend, axes.plot(chain.pressure_kpa, chain.tip_mm, label=label, linewidth=1.4, **look))
            if base in core:
                _add(legend, draw_curves(axes, _printed_curves(core[base].rows), _SCALE))
            axes.set_xlabel("cavity pressure, kPa")
        panels[0].set_ylabel("elongation at the tip, mm")
        _finish(panels, THICK, {**other, **core})
        figure.legend(handles=list(legend.values()), loc="outside lower center", ncols=3, frameon=False)
    return ""


def draw_rings(path: Path, results: PaperResults) -> str:
    """Draw what the rings' models cost (s) and what they change in the tip's elongation (% of meshed PLA's)."""
    found = {
        base: points for base in REFERENCE_SCENES if (points := _ring_points(results, base))
    }  # of four actuators; a variant without its meshed PLA has nothing to be compared with
    if not found:
        return "no actuator has been run with meshed PLA rings and others"
    with figure_file(path, _WIDTH_IN, 4.4) as figure:
        axes = figure.add_subplot()
        axes.axhline(0.0, color=BLACK, linewidth=0.8, zorder=1.0)
        for base, points in found.items():
            colour = _ACTUATORS[base]["color"]
            joined = sorted(points.values())
            axes.plot(*zip(*joined, strict=True), color=colour, linewidth=0.9, alpha=0.6)
            for label, (seconds, percent) in points.items():
                marker = _RING_MARKERS[[name for _, name, _ in RING_VARIANTS].index(label)]
                axes.plot(seconds, percent, linestyle="none", **_dot({"color": colour, "marker": marker}, 8.0))
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(FuncFormatter(_seconds))
        axes.xaxis.set_minor_formatter(FuncFormatter(_seconds))
        axes.set_xlabel("wall time of the finest axisymmetric run, s")
        axes.set_ylabel("change of elongation against meshed PLA rings, %")
        axes.margins(0.12)
        axes.grid(color="#e4e4e4", which="both")
        axes.set_axisbelow(True)
        named = {case.case.base: _name(case.result.scene) for case in results.of("rings")}
        entries = [Line2D([], [], label=named[base], linewidth=4.0, color=_ACTUATORS[base]["color"]) for base in found]
        for (_, label, _), marker in zip(RING_VARIANTS, _RING_MARKERS, strict=True):
            look = _dot({"color": "#555555", "marker": marker}, 8.0)
            entries.append(Line2D([], [], label=f"{label} rings", linestyle="none", **look))
        figure.legend(handles=entries, loc="outside right upper", frameon=False)
    return ""


# --- what a panel shows ---------------------------------------------------------------------


def _elongation_curves(case: CaseResult, tets: CaseResult | None) -> list[Curve]:
    """The chains, the axisymmetric path, full 3D in hexahedra and in tetrahedra, and the printed values."""
    curves = [chain for model in _CHAINS if (chain := _chain(case.rows, model))]
    if run := _finest(case):
        pressures, tips = _path(run, _tip)
        stopped = f"axisymmetric: {_ending(run)}" if run.summary.status != "reached" else ""
        end = (pressures[-1], tips[-1])
        curves.append(Curve("axisymmetric", "axisymmetric", pressures, tips, (), False, stopped, end))
    curves += _bodies(case, "full3d", "full 3D, hexahedra")
    if tets is not None:
        curves += _bodies(tets, "full3d_tets", "full 3D, the paper's tetrahedra")
    return [*curves, *_printed_curves(case.rows)]


def _bodies(case: CaseResult, style: str, label: str) -> list[Curve]:
    rows = _series(case.rows, TIP, "full3d")
    if not rows:
        return []
    pressures, tips, bars = zip(*((r.pressure_kpa, r.value, r.uncertainty) for r in rows), strict=True)
    return [Curve(style, label, pressures, tips, bars if np.isfinite(bars).any() else ())]


def _chain(rows: Iterable[Row], model: str, quantity: str = TIP) -> Curve | None:
    """A chain's curve from rest, up to where it folds back; None if it has no other point."""
    kept = takewhile(lambda row: row.status != FOLDED_BACK, _series(rows, quantity, model))
    points = [(row.pressure_kpa, row.value) for row in kept]
    if not points:
        return None
    pressures, values = zip(*_from_rest(points, 0.0), strict=True)
    label = model_label(model) + (", to its fold-back" if model == "closed_form_printed" else "")
    return Curve(model, label, pressures, values)


def _printed_curves(rows: Iterable[Row]) -> list[Curve]:
    rows = list(rows)
    found = {model: _series(rows, TIP, model) for model in _PRINTED}
    return [Curve(model, model_label(model), (r[-1].pressure_kpa,), (r[-1].value,)) for model, r in found.items() if r]


def _draw_bands(cases: Mapping[Axes, CaseResult]) -> list[Any]:
    """Draw the uncertainty of axisymmetric paths; one entry of a legend, which says if they are hidden by the lines."""
    largest_mm, largest_px, entry = 0.0, 0.0, []
    for axes, case in cases.items():
        run, rows = _finest(case), _series(case.rows, TIP, "axisymmetric")
        rows = [row for row in rows if math.isfinite(row.uncertainty)]
        if run is None or not rows:
            continue
        pressures, tips = (np.array(values) for values in _path(run, _tip))
        half = np.interp(pressures, [0.0, *(r.pressure_kpa for r in rows)], [0.0, *(r.uncertainty for r in rows)])
        colour = style_of("axisymmetric")["color"]
        entry = [axes.fill_between(pressures, tips - half, tips + half, color=colour, alpha=0.35, linewidth=0.0)]
        up = axes.transData.transform([(0.0, 0.0), (0.0, 2.0 * half.max())])[:, 1]
        largest_mm, largest_px = max(largest_mm, half.max()), max(largest_px, up[1] - up[0])
    for band in entry:
        line_px = 1.8 * _SCALE * DPI / 72.0
        hidden = ", within its line" if largest_px < line_px else ""
        band.set_label(f"axisymmetric ± {largest_mm:.2g} mm or less{hidden}")
    return entry


def _draw_breaks(axes: Axes, scenes: Sequence[BellowsScene]) -> None:
    """Draw the stretches at which the silicones break, and whose they are."""
    for silicone, stretch in STRETCH_AT_BREAK.items():
        axes.axhline(stretch, color=BLACK, linewidth=1.2, linestyle="--", zorder=2.0)
        name = SILICONES[silicone]
        walls = sorted({f"t = {scene.geometry.wall_mm:g} mm" for scene in scenes if _silicone(scene) == name})
        whose = f" ({', '.join(walls)})" if walls else ""
        text = f"elongation at break of {name}{whose}: {100.0 * (stretch - 1.0):g} %"
        place: dict[str, Any] = {"xycoords": ("axes fraction", "data"), "textcoords": "offset points"}
        axes.annotate(text, (0.01, stretch), xytext=(0, -3), va="top", fontsize=_SMALL, **place)
    axes.set_ylim(1.0, 1.06 * max(STRETCH_AT_BREAK.values()))


def _draw_modes(axes: Axes, names: Sequence[str], runs: Sequence[Run]) -> None:
    """Draw a line per path: pale where it is stable, dark where it has unstable modes, their number beside a change."""
    for place, run in enumerate(runs):
        states = [state for state in run.path if math.isfinite(state.unstable_modes)]
        before = 0.0
        for start, state in zip([None, *states], states, strict=False):
            begin = start.pressure_kpa if start else 0.0
            colour, width = (VERMILION, 6.0) if state.unstable_modes else ("#bbbbbb", 3.0)
            line: dict[str, Any] = {"color": colour, "linewidth": width, "solid_capstyle": "butt"}
            axes.plot([begin, state.pressure_kpa], [place, place], **line)
            if state.unstable_modes != before:
                look: dict[str, Any] = {
                    "textcoords": "offset points",
                    "fontsize": _SMALL,
                    "va": "center",
                    "ha": "right",
                }
                look["bbox"] = {"facecolor": "white", "edgecolor": "none", "pad": 0.6}
                axes.annotate(f"{state.unstable_modes:.0f}", (begin, place), (-3, 0), **look)
            before = state.unstable_modes
    axes.set_yticks(range(len(names)), names, fontsize=_SMALL)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    some = any(state.unstable_modes > 0.0 for run in runs for state in run.path)
    legend = "pale: none, dark: the number before it" if some else "none"
    axes.set_title(f"unstable modes along the path: {legend}", fontsize=9.0, loc="left")


def _draw_blocked_path(axes: Axes, run: Run) -> list[Any]:
    """Draw the force of a path, dashed where it has unstable modes; returns the entries of a legend."""
    points = list(zip(*_path(run, _force), strict=True))
    look: dict[str, Any] = {"color": style_of("axisymmetric")["color"], "linewidth": 1.8 * _SCALE}
    first = next((k for k, state in enumerate(run.path) if state.unstable_modes > 0.0), len(run.path))
    stable, past = points[: first + 1], points[first + 1 :]
    if past:
        # the crossing was looked for between the states of the path
        turn = run.summary.crossing.get("pressure_kpa", stable[-1][0])
        pressures, forces = zip(stable[-1], past[0], strict=True)
        at = (turn, float(np.interp(turn, pressures, forces)))
        stable, past = [*stable, at], [at, *past]
    entries = []
    for label, part, dash in (
        (model_label("axisymmetric"), stable, "-"),
        ("axisymmetric, past the loss of stability", past, "--"),
    ):
        if len(part) > 1:
            entries += axes.plot(*zip(*part, strict=True), label=label, linestyle=dash, **look)
    asked = [(state.pressure_kpa, state.tip_force_n) for state in run.path if state.status == "requested"]
    axes.plot(*np.reshape(asked, (-1, 2)).T, linestyle="none", **_dot({"color": look["color"], "marker": "o"}))
    _mark_end(axes, run, _force, look["color"], note=True)
    return entries


def _ring_points(results: PaperResults, base: str) -> dict[str, tuple[float, float]]:
    """By variant: wall time (s) and change of the tip (%) against meshed PLA; empty if there is nothing to compare.

    On the finest mesh, at the highest pressure that all reached.
    """
    variants = {label: results.variant(base, "rings", suffix) for suffix, label, _ in RING_VARIANTS}
    runs = {label: run for label, case in variants.items() if case and (run := _finest(case))}
    reference = RING_VARIANTS[1][1]
    if reference not in runs or len(runs) < 2:
        return {}
    tips = {
        label: {s.pressure_kpa: s.tip_mm for s in run.path if s.status == "requested"} for label, run in runs.items()
    }
    shared = set.intersection(*(set(tip) for tip in tips.values()))
    if not shared:
        return {}
    highest = max(shared)
    known = tips[reference][highest]
    return {
        label: (run.summary.time_s["total"], 100.0 * (tips[label][highest] - known) / abs(known))
        for label, run in runs.items()
    }


# --- panels ---------------------------------------------------------------------------------


def _panels(figure: Figure, label: str) -> list[Axes]:
    """Two by two panels: a row per wall, its vertical axis shared."""
    grid = figure.subplots(2, 2, sharex=True, sharey="row")
    for axes in grid[:, 0]:
        axes.set_ylabel(label)
    for axes in grid[-1]:
        axes.set_xlabel("cavity pressure, kPa")
    return list(grid.ravel())


def _finish(panels: Sequence[Axes], bases: Sequence[str], cases: Mapping[str, CaseResult]) -> None:
    """Titles, pressure axes, and vertical axes from zero."""
    for axes, base in zip(panels, bases, strict=True):
        if base in cases:
            scene = cases[base].result.scene
            axes.set_title(f"{_name(scene)}, {_silicone(scene)}", fontsize=_TITLE)
            set_pressure_axis(axes, scene.load.pressure_kpa)
        else:
            axes.set_title(f"{base}: not run", fontsize=_TITLE)
    _from_zero(panels)


def _from_zero(panels: Sequence[Axes], headroom: float = 1.0) -> None:
    """Vertical axes from zero, or from below where there are negative values; with room above for a legend."""
    for axes in panels:
        low, high = axes.get_ylim()
        shared = axes.get_shared_y_axes().get_siblings(axes)
        drawn = [value for one in shared for line in one.lines for value in np.atleast_1d(line.get_ydata())]
        if not min([0.0, *drawn]) < 0.0:
            low = 0.0
        axes.set_ylim(low, high)
    if headroom != 1.0:
        for axes in {min(a.get_shared_y_axes().get_siblings(a), key=id) for a in panels}:
            axes.set_ylim(top=headroom * axes.get_ylim()[1])


def _mark_end(axes: Axes, run: Run, value: Callable[[PathRow], float], colour: str, note: bool = False) -> None:
    """Draw a cross where a run stopped, the reason in the corner if asked; nothing if it reached all."""
    if run.summary.status == "reached" or not run.path:
        return
    end = (run.path[-1].pressure_kpa, value(run.path[-1]))
    mark_stop(axes, end, colour, "_", _SCALE)
    if note:  # where rising curves leave room
        look: dict[str, Any] = {"transform": axes.transAxes, "fontsize": _SMALL, "ha": "right", "color": colour}
        axes.text(0.98, 0.03, _ending(run), **look)


def _dot(style: Mapping[str, Any], size: float = 6.0) -> dict[str, Any]:
    """Look of a marker with a white edge."""
    return {"markersize": size, **style, "markeredgecolor": "white", "markeredgewidth": 0.7}


def _add(legend: dict[str, Any], entries: Iterable[Any]) -> None:
    """Add entries whose label is not there yet."""
    for entry in entries:
        legend.setdefault(entry.get_label(), entry)


# --- looking things up ----------------------------------------------------------------------


def _by_base(cases: Iterable[CaseResult]) -> dict[str, CaseResult]:
    return {case.case.base: case for case in cases}


def _series(rows: Iterable[Row], quantity: str, model: str) -> list[Row]:
    """Rows of a quantity and model that were reached, one per pressure, ascending; of the finest level, the last."""
    found = {row.pressure_kpa: row for row in rows if row.quantity == quantity and row.model == model}
    return [found[pressure] for pressure in sorted(found) if math.isfinite(found[pressure].value)]


def _asked(cases: Iterable[CaseResult]) -> list[float]:
    return sorted({pressure for case in cases for pressure in case.result.scene.load.pressure_kpa})


def _finest(case: CaseResult) -> Run | None:
    return case.result.axisymmetric[-1] if case.result.axisymmetric else None


def _tip(state: PathRow) -> float:
    return state.tip_mm


def _force(state: PathRow) -> float:
    return state.tip_force_n


def _path(run: Run, value: Callable[[PathRow], float]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Pressures (kPa) and values of a path from rest, in its order."""
    points = _from_rest([(state.pressure_kpa, value(state)) for state in run.path], 0.0)
    return tuple(pressure for pressure, _ in points), tuple(number for _, number in points)


def _from_rest(points: list[tuple[float, float]], at_rest: float) -> list[tuple[float, float]]:
    return points if points and points[0][0] == 0.0 else [(0.0, at_rest), *points]


def _ending(run: Run) -> str:
    """Where a path ended, the kind of reason if it did not reach what was asked, and where it lost its stability."""
    last = run.path[-1].pressure_kpa if run.path else 0.0
    crossing = run.summary.crossing
    where = ""
    if crossing:
        digits = 1 if crossing["within_kpa"] >= 0.1 else 2
        where = f" at {crossing['pressure_kpa']:.{digits}f} ± {crossing['within_kpa']:.{digits}f} kPa"
    if run.summary.status == "reached":
        return f"reaches {last:g} kPa" + (f" ({crossing['kind']}{where})" if crossing else "")
    return f"stops at {last:.1f} kPa ({run.summary.cause or 'no cause given'}{where})"


def _name(scene: BellowsScene) -> str:
    return f"t = {scene.geometry.wall_mm:g} mm, $R_i$ = {scene.geometry.root_radius_mm:g} mm"


def _silicone(scene: BellowsScene) -> str:
    """The paper's silicone that a scene's law stands for."""
    return SILICONES["dragon-skin-10" if scene.material.law == "yeoh" else "dragon-skin-30"]


def _seconds(value: float, _: int) -> str:
    """Label of a logarithmic tick; none where labels would touch."""
    text = f"{value:g}"
    return "" if text[0] in "79" else text


def _sizes(scene: BellowsScene) -> str:
    g = scene.geometry
    shape = f"$R_i$ {g.root_radius_mm:g}, $R_p$ {g.crest_radius_mm:g}, $e$ {g.half_pitch_mm:g}, $n$ {g.convolutions}"
    return f"{shape}, DS {_silicone(scene)[-2:]}"
