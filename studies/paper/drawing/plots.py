"""Plots with several actuators on the same axes: assumptions of the closed form, beyond 20 kPa.

Every function returns why there is no picture, or an empty text. Cases that are missing are left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from matplotlib.axes import Axes

from analytical.bellows.chains_by_name import SILICONES, STRETCH_AT_BREAK
from studies.paper.cases import HIGHEST_KPA, REFERENCE, REFERENCE_SCENES, THICK, THIN
from studies.paper.drawing.lines import (
    UNNAMED,
    chain_pressures,
    curve,
    ending_of,
    from_rest,
    path_curves,
    requested_curve,
    series,
    smooth,
)
from studies.paper.drawing.panels import (
    SCALE,
    SMALL,
    TITLE,
    WIDTH_IN,
    by_base,
    legend_below,
    name_of,
    requested_kpa,
    silicone_of,
)
from studies.paper.results import CaseResult, PaperResults
from studies.report.curves import Curve, draw_curves, set_pressure_axis
from studies.report.style import ABOVE, BLACK, BLUE, GREY, ORANGE, SKY, VERMILION, entry, figure_file, white_edged
from studies.results.measured_rows import model_values
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
# Stretches that the closed form is most wrong about; that under the rings it has right within 1.3 %.
_MEASURED: Final[dict[str, str]] = {
    "root_stretch_outer": "root, outside: hoop",
    "wall_hoop_stretch_middle": "side wall, half-way up: hoop",
    "wall_stretch": "side wall: along it",
}
# The two actuators of a wall, the smaller root first.
_PAIR: Final[tuple[dict[str, Any], ...]] = (
    {"color": BLUE, "marker": "o", "markersize": 6.0},
    {"color": VERMILION, "marker": "o", "markersize": 6.0},
)


def draw_assumptions(path: Path, results: PaperResults) -> str:
    """Draw stretches the closed form assumes beside those measured in axisymmetric states, over pressure (kPa).

    A row per wall, so that two colours and two dashes suffice.
    """
    cases = by_base(results.of("core"))
    known = {base: case for base, case in cases.items() if any(row.quantity in _MEASURED for row in case.rows)}
    if not known:
        return "nothing has been measured in the states of the reference actuators"
    with figure_file(path, WIDTH_IN, 6.2) as figure:
        grid_ = figure.subplots(2, len(_MEASURED), sharex=True)
        for line, bases in zip(grid_, (THIN, THICK), strict=True):
            pair = [(known[base], look) for base, look in zip(bases, _PAIR, strict=True) if base in known]
            for axes, quantity in zip(line, _MEASURED, strict=True):
                curves = [found for case, look in pair for found in _assumed_and_measured(case, quantity, look)]
                draw_curves(axes, curves, SCALE)
                set_pressure_axis(axes, requested_kpa(known.values()))
            line[0].set_ylabel(f"t = {REFERENCE[REFERENCE_SCENES.index(bases[0])].printed.wall_mm:g} mm: stretch")
        for axes, title in zip(grid_[0], _MEASURED.values(), strict=True):
            axes.set_title(title, fontsize=TITLE)
        for axes in grid_[-1]:
            axes.set_xlabel("cavity pressure, kPa")
        roots = ("$R_i$ = 5 mm", "larger $R_i$ (inferred)")
        legend_below(
            figure,
            [
                *(entry(root, linewidth=4.0, color=look["color"]) for root, look in zip(roots, _PAIR, strict=True)),
                entry("axisymmetric", color=GREY, linewidth=1.5, **white_edged(marker="o")),
                entry("closed form", color=GREY, linestyle="--", linewidth=1.5),
            ],
            columns=4,
        )
    return ""


def _assumed_and_measured(case: CaseResult, quantity: str, look: Mapping[str, Any]) -> list[Curve]:
    """What the closed form has for a quantity, dashed, and what was measured: points and a smooth line from rest."""
    measured = [(row.pressure_kpa, row.value) for row in series(case.rows, quantity, "axisymmetric")]
    assumed = [(float(p), model_values(case.scene, p).get(quantity, math.nan)) for p in chain_pressures(case)[9::10]]
    line, dots = smooth(from_rest(measured, 1.0)), {**look, "linestyle": "none"}
    return [
        curve("closed_form", UNNAMED, from_rest(assumed, 1.0), {"linestyle": "--", "color": look["color"]}),
        curve("axisymmetric", UNNAMED, line, {"color": look["color"]}),
        curve("axisymmetric", UNNAMED, measured, dots, markers=True),
    ]


def _actuator_entry(base: str, label: str) -> Any:
    return entry(label, linestyle="none", **white_edged(**_ACTUATORS[base]))


def draw_beyond(path: Path, results: PaperResults) -> str:
    """Draw how far each actuator goes beyond 20 kPa in the axisymmetric model: elongation (mm), largest stretch."""
    cases = {base: case for base, case in by_base(results.of("beyond")).items() if case.axisymmetric}
    if not cases:
        return "no actuator has been taken beyond 20 kPa"
    with figure_file(path, WIDTH_IN, 7.0) as figure:
        top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(3.0, 2.4))
        entries = []
        for base, case in cases.items():
            run, look = case.axisymmetric[-1], _ACTUATORS[base]
            line = path_curves(case, UNNAMED, {"color": look["color"]})
            draw_curves(top, [*line, requested_curve(run, "tip_mm", look)], SCALE)
            peaks = [(row.pressure_kpa, row.value) for row in series(case.rows, "peak_stretch_away", "axisymmetric")]
            peak_line = curve("axisymmetric", UNNAMED, smooth(from_rest(peaks, 1.0)), {"color": look["color"]})
            dots = curve("axisymmetric", UNNAMED, peaks, {"linestyle": "none", **look}, markers=True)
            draw_curves(bottom, [peak_line, dots], SCALE)
            entries.append(_actuator_entry(base, f"{name_of(case.scene)}: {ending_of(run)}"))
        _draw_breaks(bottom, [case.scene for case in cases.values()])
        runs = [case.axisymmetric[-1] for case in cases.values()]
        top.set_title(f"axisymmetric model; {_modes_text(runs)}", fontsize=9.0, loc="left")
        top.set_ylabel("elongation at the tip, mm")
        top.set_ylim(bottom=0.0)
        bottom.set_ylabel("largest principal stretch")
        bottom.set_xlabel("cavity pressure, kPa")
        for axes in (top, bottom):
            set_pressure_axis(axes, [p for p in requested_kpa(cases.values()) if p % 5.0 == 0.0])
            axes.axvline(HIGHEST_KPA, color=BLACK, linewidth=1.0, linestyle=":", zorder=1.0)
        top.annotate(
            "the paper's ANSYS\ndid not converge beyond",
            (HIGHEST_KPA, 0.03),
            xycoords=("data", "axes fraction"),
            xytext=(4, 0),
            textcoords="offset points",
            fontsize=SMALL,
        )
        if any(run.summary.status != REACHED for run in runs):
            cross: dict[str, Any] = {"marker": "x", "linestyle": "none", "markersize": 8.0, "markeredgewidth": 2.0}
            entries.append(entry("last state of a path that stopped", color=BLACK, **cross))
        figure.legend(handles=entries, ncols=2, fontsize=9.0, **ABOVE)
    return ""


def _modes_text(runs: Sequence[Run]) -> str:
    """How many unstable modes the states of some paths have at most."""
    counts = [state.unstable_modes for run in runs for state in run.path if math.isfinite(state.unstable_modes)]
    if not counts:
        return "unstable axisymmetric modes not counted"
    return (
        f"unstable axisymmetric modes along the paths: {max(counts):.0f} at most"
        if max(counts)
        else ("no unstable axisymmetric mode along the paths")
    )


def _draw_breaks(axes: Axes, scenes: Sequence[BellowsScene]) -> None:
    """Draw the stretches at which the silicones break, and whose they are; the axis ends at the lowest."""
    lowest = min(STRETCH_AT_BREAK.values())
    for silicone, stretch in STRETCH_AT_BREAK.items():
        name = SILICONES[silicone]
        walls = sorted({f"t = {scene.geometry.wall_mm:g} mm" for scene in scenes if silicone_of(scene) == name})
        whose = f" ({', '.join(walls)})" if walls else ""
        text = f"{name}{whose} breaks at a stretch of {stretch:.3g}"
        if stretch == lowest:
            axes.axhline(stretch, color=BLACK, linewidth=1.2, linestyle="--", zorder=2.0)
        place: dict[str, Any] = {"xycoords": ("axes fraction", "data"), "textcoords": "offset points"}
        beyond = "" if stretch == lowest else ", above this axis"
        offset, va = ((0, -3), "top") if stretch == lowest else ((0, 3), "bottom")
        axes.annotate(f"{text}{beyond}", (0.01, lowest), xytext=offset, va=va, fontsize=SMALL, **place)
    axes.set_ylim(0.9, 1.1 * lowest)
