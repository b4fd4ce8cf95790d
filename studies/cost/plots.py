"""Plots of the cost study: error over time with its fronts, and time and memory over unknowns."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.ticker import FuncFormatter

from studies.cost.rows import Point, Power, front, told_apart
from studies.report.labels import model_label
from studies.report.panels import Panel, Series, add_legend, add_panel, draw_panels
from studies.report.style import BESIDE, BLACK, BLUE, GREEN, GREY, INSIDE, ORANGE, PURPLE, SKY, VERMILION, figure_file

# Of this program by model, of others by their name in turn.
COLOURS = {"closed_form": ORANGE, "axisymmetric": BLUE, "sector": SKY, "full3d": VERMILION}
PEER_COLOURS = (GREEN, PURPLE, BLACK, GREY)
MARKERS = {"hex": "s", "tet": "^", "tet-p0": "v", "tet-p1": "x", "none": "P"}
ELEMENTS = {
    "hex": "hexahedra",
    "tet": "tetrahedra",
    "tet-p0": "tetrahedra P2/P0",
    "tet-p1": "tetrahedra P1",
    "none": "no cells",
}
# A ring round a point.
_DEFAULT = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 14,
    "markerfacecolor": "none",
    "markeredgecolor": BLACK,
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

    def of(chosen: Iterable[Point], look: Mapping[str, Any], label: str = "") -> Series:
        places = [(p.wall_s if whole else p.time_s, told_apart(p)) for p in chosen]
        return Series([time for time, _ in places], [error for _, error in places], look, label)

    shown = [p for p in points if np.isfinite(p.error_percent) and np.isfinite(p.wall_s)]
    models = list(dict.fromkeys(p.model for p in shown))
    peers = [model for model in models if model.startswith("peer_")]
    colours = COLOURS | {model: PEER_COLOURS[k % len(PEER_COLOURS)] for k, model in enumerate(peers)}
    best = {}
    series = []
    for model, colour in ((model, colours[model]) for model in models):
        mine = [p for p in shown if p.model == model]
        best[model] = front([replace(p, work_s=math.nan) for p in mine] if whole else mine)
        label = model.removeprefix("peer_") if model in peers else model_label(model)
        series.append(of(best[model], {"color": colour, "linewidth": 1.4}, label))
        for element in dict.fromkeys(p.element for p in mine):
            look = {"color": colour, "marker": MARKERS.get(element, "D"), "markersize": 6.5, "alpha": 0.8}
            series.append(of([p for p in mine if p.element == element], {"linestyle": "none", **look}))
    default = [p for p in shown if p.default]
    if default:
        series.append(of(default, _DEFAULT, "settings of study-paper"))
    for element in dict.fromkeys(p.element for p in shown if not p.is_peer):
        look = {"color": GREY, "marker": MARKERS[element], "linestyle": "none"}
        series.append(of([], look, ELEMENTS[element]))
    x_label = f"wall time, s, {'from start to end of the process' if whole else 'without start and imports'}"
    with figure_file(path, 8.6, 5.0) as figure:
        axes = figure.add_subplot()
        add_panel(axes, Panel(series, x_label, "error, %", logarithmic="xy"))
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        for model, line in best.items():
            places = of(line, {})
            for p, *at in zip(line, places.x, places.y, strict=True):
                look = {"textcoords": "offset points", "fontsize": 7.5, "color": colours[model]}
                axes.annotate(short_name(p), at, (4, 5), **look)
        add_legend(figure, BESIDE)


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
    ends = np.array([min(unknowns), max(unknowns)])
    panels = []
    for (label, values, law), colour in zip(curves, (VERMILION, BLUE, GREEN), strict=False):
        measured = Series(unknowns, values, {"color": colour, "marker": "s", "linestyle": "none"})
        fitted = [law.at(x) for x in ends]
        line = Series(ends, fitted, {"color": colour, "linewidth": 1.2}, f"exponent {law.exponent:.2f}")
        panels.append(Panel([measured, line], "unknowns", label, logarithmic="xy"))
    draw_panels(path, [panels], (8.6, 3.8), INSIDE)
