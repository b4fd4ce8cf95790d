"""How far the actuators go beyond the printed pressure, and where they are unstable."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes

from analytical.bellows.paper import PRINTED_PRESSURE_KPA
from studies.closed_form.chains import SILICONES, STRETCH_AT_BREAK
from studies.paper.plots.layout import ACTUATORS, SMALL, WIDTH_IN, mark_end
from studies.paper.plots.paths import (
    by_base,
    ending_of,
    finest_run,
    name_of,
    path_of,
    requested_kpa,
    series_of,
    silicone_of,
    tip_of,
)
from studies.paper.results import PaperResults
from studies.report.curves import set_pressure_axis
from studies.report.style import ABOVE, BLACK, VERMILION, entry, figure_file, white_edged
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene


def draw_beyond(path: Path, results: PaperResults) -> str:
    """Draw how far each actuator goes beyond 20 kPa: elongation (mm), largest stretch and unstable modes over kPa."""
    cases = {base: case for base, case in by_base(results.of("beyond")).items() if finest_run(case)}
    if not cases:
        return "no actuator has been taken beyond 20 kPa"
    with figure_file(path, WIDTH_IN, 8.6) as figure:
        top, middle, strip = figure.subplots(3, 1, sharex=True, height_ratios=(3.0, 2.6, 0.9))
        entries = []
        for base, case in cases.items():
            run, style = finest_run(case), ACTUATORS[base]
            assert run is not None
            label = f"{name_of(case.result.scene)}: {ending_of(run)}"
            asked = [state for state in run.path if state.status == "requested"]
            top.plot(*path_of(run, tip_of), color=style["color"], linewidth=1.6)
            look = white_edged(**style, linestyle="none")
            top.plot([s.pressure_kpa for s in asked], [s.tip_mm for s in asked], **look)
            entries.append(entry(label=label, **white_edged(**style)))
            mark_end(top, run, tip_of, style["color"])
            peaks = series_of(case.rows, "peak_stretch_away", "axisymmetric")
            line = {"linewidth": 1.6, "color": style["color"], **white_edged(**style)}
            middle.plot([r.pressure_kpa for r in peaks], [r.value for r in peaks], **line)
        _draw_breaks(middle, [case.result.scene for case in cases.values()])
        names = [name_of(case.result.scene) for case in cases.values()]
        runs = [run for case in cases.values() if (run := finest_run(case))]
        _draw_modes(strip, names, runs)
        top.set_ylabel("elongation at the tip, mm")
        top.set_ylim(bottom=0.0)
        middle.set_ylabel("largest principal stretch")
        strip.set_xlabel("cavity pressure, kPa")
        asked_kpa = [p for p in requested_kpa(cases.values()) if p % 5.0 == 0.0]
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
            fontsize=SMALL,
        )
        if any(run.summary.status != "reached" for run in runs):
            cross: dict[str, Any] = {"marker": "x", "linestyle": "none", "markersize": 8.0, "markeredgewidth": 2.0}
            entries.append(entry(color=BLACK, label="last state of a path that stopped", **cross))
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
                    "fontsize": SMALL,
                    "va": "center",
                    "ha": "right",
                }
                look["bbox"] = {"facecolor": "white", "edgecolor": "none", "pad": 0.6}
                axes.annotate(f"{state.unstable_modes:.0f}", (begin, place), (-3, 0), **look)
            before = state.unstable_modes
    axes.set_yticks(range(len(names)), names, fontsize=SMALL)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    some = any(state.unstable_modes > 0.0 for run in runs for state in run.path)
    legend = "pale: none, dark: the number before it" if some else "none"
    axes.set_title(f"unstable modes along the path: {legend}", fontsize=9.0, loc="left")
