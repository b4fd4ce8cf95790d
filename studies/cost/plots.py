"""Plots of the cost study: error over time with its fronts, and time and memory over unknowns."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.ticker import FuncFormatter

from studies.cost.rows import Point, Power, front, told_apart
from studies.report.style import BESIDE, BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, figure_file

# Of this program by model, of others by their name in turn.
COLOURS = {"closed_form": ORANGE, "axisymmetric": BLUE, "sector": SKY, "full3d": VERMILION}
LABELS = {"closed_form": "closed form", "axisymmetric": "axisymmetric", "sector": "quarter in 3D", "full3d": "full 3D"}
PEER_COLOURS = (GREEN, PURPLE, BLACK, "#777777")
MARKERS = {"hex": "s", "tet": "^", "tet-p0": "v", "tet-p1": "x", "none": "P"}
ELEMENTS = {
    "hex": "hexahedra",
    "tet": "tetrahedra",
    "tet-p0": "tetrahedra P2/P0",
    "tet-p1": "tetrahedra P1",
    "none": "no cells",
}


def short_name(point: Point) -> str:
    """Element and mesh, for instance ``hex n8r2``; also of a peer."""
    return f"{point.element} {point.mesh}"


def draw_front(path: Path, points: Sequence[Point], whole: bool = False) -> None:
    """Draw error (percent) over time (s), both logarithmic; of each model its front as a line.

    Parameters
    ----------
    path
        The PNG to write.
    points
        Of one body; those without an error or a time are left out.
    whole
        True for the time from start to end of the process, which is all that is known of other programs.
    """

    def time_of(p: Point) -> float:
        return p.wall_s if whole else p.time_s

    shown = [p for p in points if np.isfinite(p.error_percent) and np.isfinite(p.wall_s)]
    models = list(dict.fromkeys(p.model for p in shown))
    peers = [model for model in models if model.startswith("peer_")]
    colours = COLOURS | {model: PEER_COLOURS[k % len(PEER_COLOURS)] for k, model in enumerate(peers)}
    with figure_file(path, 8.6, 5.0) as figure:
        axes = figure.add_subplot()
        for model in models:
            mine = [p for p in shown if p.model == model]
            line = front([replace(p, work_s=math.nan) for p in mine] if whole else mine)
            label = LABELS.get(model, model.removeprefix("peer_"))
            axes.plot(
                [time_of(p) for p in line],
                [told_apart(p) for p in line],
                color=colours[model],
                linewidth=1.4,
                label=label,
            )
            for p in line:
                at = (time_of(p), told_apart(p))
                axes.annotate(short_name(p), at, (4, 5), textcoords="offset points", fontsize=7.5, color=colours[model])
            for element in dict.fromkeys(p.element for p in mine):
                of = [p for p in mine if p.element == element]
                marker = MARKERS.get(element, "D")
                look = {"color": colours[model], "marker": marker, "linestyle": "none", "markersize": 6.5}
                axes.plot([time_of(p) for p in of], [told_apart(p) for p in of], alpha=0.8, **look)  # type: ignore[arg-type]
        default = [p for p in shown if p.default]
        if default:
            ring = {"marker": "o", "markersize": 14, "markerfacecolor": "none", "markeredgecolor": BLACK}
            axes.plot(
                [time_of(p) for p in default],
                [told_apart(p) for p in default],
                linestyle="none",
                label="settings of study-paper",
                **ring,  # type: ignore[arg-type]
            )
        for element in dict.fromkeys(p.element for p in shown if not p.is_peer):
            axes.plot([], [], color="#777777", marker=MARKERS[element], linestyle="none", label=ELEMENTS[element])
        axes.set_xscale("log")
        axes.set_yscale("log")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.set_xlabel(
            "wall time, s, " + ("from start to end of the process" if whole else "without start and imports")
        )
        axes.set_ylabel("error, %")
        axes.grid(which="both", color="#ececec")
        axes.set_axisbelow(True)
        if shown:
            axes.legend(**BESIDE)


def draw_growth(path: Path, unknowns: Sequence[float], curves: Sequence[tuple[str, Sequence[float], Power]]) -> None:
    """Draw quantities over the number of unknowns, both logarithmic, each with its power law.

    Parameters
    ----------
    path
        The PNG to write.
    unknowns
        Sizes of the bodies.
    curves
        Label, values and power law of each, side by side.
    """
    with figure_file(path, 8.6, 3.8) as figure:
        panels = np.atleast_1d(figure.subplots(1, len(curves)))
        ends = np.array([min(unknowns), max(unknowns)])
        for axes, (label, values, law), colour in zip(panels, curves, (VERMILION, BLUE, GREEN), strict=False):
            axes.plot(unknowns, values, color=colour, marker="s", linestyle="none")
            axes.plot(
                ends, [law.at(x) for x in ends], color=colour, linewidth=1.2, label=f"exponent {law.exponent:.2f}"
            )
            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.set_xlabel("unknowns")
            axes.set_ylabel(label)
            axes.grid(which="both", color="#ececec")
            axes.set_axisbelow(True)
            axes.legend(frameon=False)
