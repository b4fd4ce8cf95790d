"""Plots of the cost study: error over time with its fronts, and time and memory over unknowns."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from studies.cost.points import Growth, Point, front, per_factorisation
from studies.report.labels import model_label
from studies.report.panels import Panel, Series, add_legend, add_panel, draw_panels
from studies.report.style import (
    BESIDE,
    BLACK,
    BLUE,
    GREEN,
    GREY,
    INSIDE,
    PURPLE,
    VERMILION,
    WINE,
    figure_file,
    style_of,
)

# Of other programs in turn, as many as there are.
PEER_COLOURS: Final = (GREEN, PURPLE, BLACK, GREY, WINE)
# Of other programs by whether they solve the body or its meridian.
PEER_MARKERS: Final = {"axisymmetric": "D", "full 3D": "h"}
MARKERS: Final = {"hex": "s", "tet": "^", "tet-p0": "v", "tet-p1": "x", "none": "P"}
ELEMENTS: Final = {
    "hex": "hexahedra",
    "tet": "tetrahedra",
    "tet-p0": "tetrahedra P2/P0",
    "tet-p1": "tetrahedra P1",
    "none": "no cells",
}
_NAME_POINTS: Final = 7.5
_ALONE: Final = {"linestyle": "none"}
# A ring round a point.
_RING: Final = {**_ALONE, "marker": "o", "markersize": 14, "markerfacecolor": "none", "markeredgecolor": BLACK}


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
    if whole:
        points = [replace(p, cost=replace(p.cost, work_s=math.nan)) for p in points]
    shown = [p for p in points if np.isfinite(p.error_percent) and np.isfinite(p.cost.wall_s)]
    models = list(dict.fromkeys(p.model for p in shown))
    peers = [model for model in models if model.startswith("peer_")]
    colours = {model: style_of(model)["color"] for model in models if model not in peers}
    colours |= {model: PEER_COLOURS[k % len(PEER_COLOURS)] for k, model in enumerate(peers)}
    fronts = {model: front([p for p in shown if p.model == model]) for model in models}
    series = []
    for model in models:
        label = model_label(model.removeprefix("peer_"))
        series.append(_series(fronts[model], {"color": colours[model], "linewidth": 1.4}, label))
        for marker in dict.fromkeys(_marker(p) for p in shown if p.model == model):
            look = {**_ALONE, "color": colours[model], "marker": marker}
            of = [p for p in shown if (p.model, _marker(p)) == (model, marker)]
            series.append(_series(of, {**look, "markersize": 6.5, "alpha": 0.8}))
    if default := [p for p in shown if p.default]:
        series.append(_series(default, _RING, "settings of study-paper"))
    for element in dict.fromkeys(p.element for p in shown if not p.is_peer):
        series.append(_series([], {**_ALONE, "color": GREY, "marker": MARKERS[element]}, ELEMENTS[element]))
    if peers:
        for solved, marker in PEER_MARKERS.items():
            series.append(_series([], {**_ALONE, "color": GREY, "marker": marker}, f"other program, {solved}"))
    x_label = f"wall time, s, {'from start to end of the process' if whole else 'without start and imports'}"
    with figure_file(path, 8.6, 5.0) as figure:
        axes = figure.add_subplot()
        add_panel(axes, Panel(series, x_label, "error, %", logarithmic="xy"))
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        add_legend(figure, BESIDE)
        figure.draw_without_rendering()  # so that places in pixels are known
        _name(axes, [p for line in fronts.values() for p in line], colours)


def _marker(p: Point) -> str:
    """Marker of a point: by its cells, of another program by what it solves."""
    return PEER_MARKERS[p.group.removeprefix("peers, ")] if p.is_peer else MARKERS[p.element]


def _name(axes: Axes, of: Sequence[Point], colours: Mapping[str, str]) -> None:
    """Write the mesh beside points, from left to right, above what would be written over; equal names once."""
    dots_per_point = axes.figure.dpi / 72.0
    taken: list[tuple[float, float, float]] = []
    written = set()
    for p in sorted(of, key=lambda p: p.time_s):
        name = f"{p.element} {p.mesh}"
        if (p.model, name) in written:
            continue
        written.add((p.model, name))
        at = (p.time_s, p.told_apart_percent)
        x, y = axes.transData.transform(at) / dots_per_point
        low, width = y + 5.0, 0.6 * _NAME_POINTS * len(name)
        while any(x < end and x + width > begin and abs(low - height) < _NAME_POINTS for begin, end, height in taken):
            low += 1.0
        taken.append((x, x + width, low))
        look: dict[str, Any] = {"textcoords": "offset points", "fontsize": _NAME_POINTS, "color": colours[p.model]}
        axes.annotate(name, at, (4, low - y), **look)


def _series(of: Sequence[Point], look: Mapping[str, Any], label: str = "") -> Series:
    """Points at their times, s, and errors, percent."""
    return Series([p.time_s for p in of], [p.told_apart_percent for p in of], look, label)


def draw_growth(path: Path, of: Sequence[Point], laws: Growth) -> None:
    """Draw time, time per factorisation and memory over the number of unknowns, logarithmic, each with its power law.

    Parameters
    ----------
    path
        The PNG to write.
    of
        Bodies of growing size.
    laws
        Theirs.
    """
    curves = (
        ("time without start, s", [p.cost.work_s for p in of], laws.time, VERMILION),
        ("time per factorisation, s", [per_factorisation(p) for p in of], laws.iteration, BLUE),
        ("memory, MB", [p.cost.peak_mb for p in of], laws.memory, GREEN),
    )
    unknowns = [p.cost.unknowns for p in of]
    ends = [min(unknowns), max(unknowns)]
    panels = []
    for label, values, law, colour in curves:
        measured = Series(unknowns, values, {**_ALONE, "color": colour, "marker": "s"})
        look = {"color": colour, "linewidth": 1.2}
        line = Series(ends, [law.at(x) for x in ends], look, f"exponent {law.exponent:.2f}")
        panels.append(Panel([measured, line], "unknowns", label, logarithmic="xy"))
    draw_panels(path, [panels], (8.6, 3.8), INSIDE)
