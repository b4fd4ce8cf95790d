"""Plots with all actuators on the same axes: assumptions of the closed form, beyond 20 kPa, rings.

Every function returns why there is no picture, or an empty text. Cases that are missing are left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from analytical.bellows.chains_by_name import SILICONES, STRETCH_AT_BREAK
from studies.paper.cases import HIGHEST_KPA, REFERENCE_SCENES, RING_VARIANTS
from studies.paper.drawing.panels import (
    SCALE,
    SMALL,
    TITLE,
    UNNAMED,
    WIDTH_IN,
    by_base,
    curve,
    ending_of,
    from_rest,
    legend_below,
    name_of,
    path_curves,
    requested_curve,
    requested_kpa,
    series,
    silicone_of,
)
from studies.paper.results import PaperResults
from studies.paper.variants import REFERENCE_RING
from studies.report.curves import draw_curves, set_pressure_axis
from studies.report.style import (
    ABOVE,
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    SKY,
    VERMILION,
    entry,
    figure_file,
    grid,
    white_edged,
)
from studies.results.rows import REACHED
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene

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
_MEASURED: Final[dict[str, str]] = {
    "root_stretch_outer": "root: hoop stretch, outside",
    "wall_stretch": "side wall: stretch along it",
    "ring_hoop_stretch": "under the rings: hoop stretch",
}
_RING_MARKERS: Final = ("o", "s", "^")


def draw_assumptions(path: Path, results: PaperResults) -> str:
    """Draw stretches the closed form assumes beside those measured in axisymmetric states, over pressure (kPa)."""
    cases = by_base(results.of("core"))
    known = {base: case for base, case in cases.items() if any(row.quantity in _MEASURED for row in case.rows)}
    if not known:
        return "nothing has been measured in the states of the reference actuators"
    with figure_file(path, WIDTH_IN, 3.9) as figure:
        columns = figure.subplots(1, len(_MEASURED))
        for axes, (quantity, title) in zip(columns, _MEASURED.items(), strict=True):
            for base, case in known.items():
                look = _ACTUATORS[base]
                chain, found = (
                    [(row.pressure_kpa, row.value) for row in series(case.rows, quantity, model)]
                    for model in ("closed_form", "axisymmetric")
                )
                dashed = {"color": look["color"], "linestyle": "--"}
                curves = [curve("closed_form", UNNAMED, from_rest(chain, 1.0), dashed)] if chain else []
                dots = curve("axisymmetric", UNNAMED, found, {"linestyle": "none", **look}, markers=True)
                draw_curves(axes, [*curves, dots], SCALE)
            axes.axhline(1.0, color=BLACK, linewidth=0.8, zorder=1.0)
            axes.set_title(title, fontsize=TITLE)
            axes.set_xlabel("cavity pressure, kPa")
            set_pressure_axis(axes, requested_kpa(known.values()))
        columns[0].set_ylabel("stretch")
        legend_below(
            figure,
            [
                *(_actuator_entry(base, name_of(case.scene)) for base, case in known.items()),
                entry("closed form", color=GREY, linestyle="--", linewidth=1.5),
                entry("axisymmetric", linestyle="none", **white_edged(marker="o", color=GREY)),
            ],
        )
    return ""


def _actuator_entry(base: str, label: str) -> Any:
    return entry(label, linestyle="none", **white_edged(**_ACTUATORS[base]))


def draw_beyond(path: Path, results: PaperResults) -> str:
    """Draw how far each actuator goes beyond 20 kPa: elongation (mm), largest stretch and unstable modes over kPa."""
    cases = {base: case for base, case in by_base(results.of("beyond")).items() if case.axisymmetric}
    if not cases:
        return "no actuator has been taken beyond 20 kPa"
    with figure_file(path, WIDTH_IN, 8.6) as figure:
        top, middle, strip = figure.subplots(3, 1, sharex=True, height_ratios=(3.0, 2.6, 0.9))
        entries = []
        for base, case in cases.items():
            run, look = case.axisymmetric[-1], _ACTUATORS[base]
            line = path_curves(case, UNNAMED, {"color": look["color"]})
            draw_curves(top, [*line, requested_curve(run, "tip_mm", look)], SCALE)
            peaks = [(row.pressure_kpa, row.value) for row in series(case.rows, "peak_stretch_away", "axisymmetric")]
            middle.plot(*np.reshape(peaks, (-1, 2)).T, linewidth=1.6, **white_edged(**look))
            entries.append(_actuator_entry(base, f"{name_of(case.scene)}: {ending_of(run)}"))
        _draw_breaks(middle, [case.scene for case in cases.values()])
        runs = {name_of(case.scene): case.axisymmetric[-1] for case in cases.values()}
        _draw_modes(strip, runs)
        top.set_ylabel("elongation at the tip, mm")
        top.set_ylim(bottom=0.0)
        middle.set_ylabel("largest principal stretch")
        strip.set_xlabel("cavity pressure, kPa")
        for axes in (top, middle, strip):
            set_pressure_axis(axes, [p for p in requested_kpa(cases.values()) if p % 5.0 == 0.0])
            axes.axvline(HIGHEST_KPA, color=BLACK, linewidth=1.0, linestyle=":", zorder=1.0)
        strip.grid(axis="y", visible=False)
        top.annotate(
            "the paper's ANSYS\ndid not converge beyond",
            (HIGHEST_KPA, 0.03),
            xycoords=("data", "axes fraction"),
            xytext=(4, 0),
            textcoords="offset points",
            fontsize=SMALL,
        )
        if any(run.summary.status != REACHED for run in runs.values()):
            cross: dict[str, Any] = {"marker": "x", "linestyle": "none", "markersize": 8.0, "markeredgewidth": 2.0}
            entries.append(entry("last state of a path that stopped", color=BLACK, **cross))
        figure.legend(handles=entries, ncols=2, fontsize=9.0, **ABOVE)
    return ""


def _draw_breaks(axes: Axes, scenes: Sequence[BellowsScene]) -> None:
    """Draw the stretches at which the silicones break, and whose they are."""
    for silicone, stretch in STRETCH_AT_BREAK.items():
        axes.axhline(stretch, color=BLACK, linewidth=1.2, linestyle="--", zorder=2.0)
        name = SILICONES[silicone]
        walls = sorted({f"t = {scene.geometry.wall_mm:g} mm" for scene in scenes if silicone_of(scene) == name})
        whose = f" ({', '.join(walls)})" if walls else ""
        text = f"elongation at break of {name}{whose}: {100.0 * (stretch - 1.0):g} %"
        place: dict[str, Any] = {"xycoords": ("axes fraction", "data"), "textcoords": "offset points"}
        axes.annotate(text, (0.01, stretch), xytext=(0, -3), va="top", fontsize=SMALL, **place)
    axes.set_ylim(1.0, 1.06 * max(STRETCH_AT_BREAK.values()))


def _draw_modes(axes: Axes, runs: Mapping[str, Run]) -> None:
    """Draw a line per path: pale where it is stable, dark where it has unstable modes, their number beside a change."""
    beside: dict[str, Any] = {"textcoords": "offset points", "fontsize": SMALL, "va": "center", "ha": "right"}
    beside["bbox"] = {"facecolor": "white", "edgecolor": "none", "pad": 0.6}
    for place, run in enumerate(runs.values()):
        begin, before = 0.0, 0.0
        for state in run.path:
            if not math.isfinite(state.unstable_modes):
                continue
            colour, width = (VERMILION, 6.0) if state.unstable_modes else ("#bbbbbb", 3.0)
            ends = [begin, state.pressure_kpa]
            axes.plot(ends, [place, place], color=colour, linewidth=width, solid_capstyle="butt")
            if state.unstable_modes != before:
                axes.annotate(f"{state.unstable_modes:.0f}", (begin, place), (-3, 0), **beside)
            begin, before = state.pressure_kpa, state.unstable_modes
    axes.set_yticks(range(len(runs)), list(runs), fontsize=SMALL)
    axes.set_ylim(len(runs) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    some = any(state.unstable_modes > 0.0 for run in runs.values() for state in run.path)
    legend = "pale: none, dark: the number before it" if some else "none"
    axes.set_title(f"unstable modes along the path: {legend}", fontsize=9.0, loc="left")


def draw_rings(path: Path, results: PaperResults) -> str:
    """Draw what the rings' models cost (s) and what they change in the tip's elongation (% of meshed PLA's)."""
    found = {base: points for base in REFERENCE_SCENES if (points := _ring_points(results, base))}
    if not found:
        return "no actuator has been run with meshed PLA rings and others"
    with figure_file(path, WIDTH_IN, 4.4) as figure:
        axes = figure.add_subplot()
        axes.axhline(0.0, color=BLACK, linewidth=0.8, zorder=1.0)
        for base, points in found.items():
            colour = _ACTUATORS[base]["color"]
            axes.plot(*zip(*sorted(points.values()), strict=True), color=colour, linewidth=0.9, alpha=0.6)
            for suffix, point in points.items():
                axes.plot(*point, linestyle="none", **white_edged(8.0, color=colour, marker=_ring_marker(suffix)))
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(FuncFormatter(_seconds))
        axes.xaxis.set_minor_formatter(FuncFormatter(_seconds))
        axes.set_xlabel("wall time of the finest axisymmetric run, s")
        axes.set_ylabel("change of elongation against meshed PLA rings, %")
        axes.margins(0.12)
        grid(axes, which="both")
        entries = [
            entry(
                name_of(results.variant(base, "rings", REFERENCE_RING).scene),
                linewidth=4.0,
                color=_ACTUATORS[base]["color"],
            )
            for base in found
        ]
        for suffix, label, _ in RING_VARIANTS:
            look = white_edged(8.0, color=GREY, marker=_ring_marker(suffix))
            entries.append(entry(f"{label} rings", linestyle="none", **look))
        figure.legend(handles=entries, loc="outside right upper", frameon=False)
    return ""


def _ring_marker(suffix: str) -> str:
    return _RING_MARKERS[[variant for variant, _, _ in RING_VARIANTS].index(suffix)]


def _ring_points(results: PaperResults, base: str) -> dict[str, tuple[float, float]]:
    """By variant: wall time (s) and change of the tip (%) against meshed PLA; empty if there is nothing to compare.

    On the finest mesh, at the highest pressure that all reached.
    """
    variants = {suffix: results.variant(base, "rings", suffix).axisymmetric for suffix, _, _ in RING_VARIANTS}
    runs = {suffix: of_variant[-1] for suffix, of_variant in variants.items() if of_variant}
    tips = {
        suffix: {s.pressure_kpa: s.tip_mm for s in run.path if s.status == "requested"} for suffix, run in runs.items()
    }
    shared = set.intersection(*map(set, tips.values())) if tips else set()
    if REFERENCE_RING not in runs or len(runs) < 2 or not shared:
        return {}
    known = tips[REFERENCE_RING][max(shared)]
    return {
        suffix: (run.summary.time_s["total"], 100.0 * (tips[suffix][max(shared)] - known) / abs(known))
        for suffix, run in runs.items()
    }


def _seconds(value: float, _: int) -> str:
    """Label of a logarithmic tick; none where labels would touch."""
    text = f"{value:g}"
    return "" if text[0] in "79" else text
