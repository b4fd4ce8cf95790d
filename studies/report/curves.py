"""Curves over the pressure, each in the look of its model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.interpolate import PchipInterpolator

from studies.report.style import BESIDE, OTHERS, edge_of, figure_file, grid, style_of

Points = list[tuple[float, float]]

# Points of a smooth line between two converged states.
_BETWEEN = 16
# Width and height of a plot of elongation over pressure.
SIZE_IN: tuple[float, float] = (8.2, 4.9)


@dataclass(frozen=True)
class Curve:
    """Elongation of one model over the pressure.

    Attributes
    ----------
    model, label
        Decides the style; what the legend says, nothing of a label that begins with ``_``.
    pressure_kpa, tip_mm
        Points in the order they are joined; of a blocked tip the force in N.
    uncertainty_mm
        Half height of the error bars, mm; NaN draws none, empty means there are none.
    markers
        False: a line only, for paths of many states.
    stopped, stopped_at
        Empty, or what the legend says of the cross where the run ended; its pressure (kPa) and tip (mm).
    look
        What differs from the style of the model.
    """

    model: str
    label: str
    pressure_kpa: tuple[float, ...]
    tip_mm: tuple[float, ...]
    uncertainty_mm: tuple[float, ...] = ()
    markers: bool = True
    stopped: str = ""
    stopped_at: tuple[float, float] = (0.0, 0.0)
    look: Mapping[str, Any] = field(default_factory=dict)


def draw_elongation(
    path: Path, curves: Sequence[Curve], asked_kpa: Sequence[float], label: str = "elongation at the tip, mm"
) -> None:
    """Draw tip displacement (mm), or what the label says, over cavity pressure (kPa).

    Parameters
    ----------
    path
        The PNG to write.
    curves
        What to draw, in the order of the legend.
    asked_kpa
        Asked pressures, kPa, at least one; the axis reaches all of them also if no curve does.
    label
        Of the vertical axis.
    """
    with figure_file(path, *SIZE_IN) as figure:
        elongation_axes(figure, curves, asked_kpa, label)


def elongation_axes(figure: Figure, curves: Sequence[Curve], asked_kpa: Sequence[float], label: str) -> None:
    """Put the axes of `draw_elongation` into a figure, which may be of `SIZE_IN`."""
    axes = figure.add_subplot()
    entries = draw_curves(axes, curves)
    axes.set_xlabel("cavity pressure, kPa")
    axes.set_ylabel(label)
    drawn = [tip for curve in curves for tip in curve.tip_mm]
    axes.set_ylim(bottom=1.04 * min([0.0, *drawn]))
    set_pressure_axis(axes, asked_kpa)
    axes.legend(handles=entries, **BESIDE)


def smooth(points: Sequence[tuple[float, float]]) -> Points:
    """Points joined by a curve without corners: a monotone cubic (PCHIP) of both numbers over the length of the chord.

    Monotone where the points are, and a path may turn back in its pressure.
    """
    if len(points) < 3:
        return list(points)
    at = np.array(points)
    spans = np.ptp(at, axis=0)
    chords = np.linalg.norm(np.diff(at, axis=0) / np.where(spans > 0.0, spans, 1.0), axis=1)
    keep = np.concatenate([[True], chords > 0.0])
    at, length = at[keep], np.concatenate([[0.0], np.cumsum(chords)])[keep]
    if len(at) < 3:
        return list(points)
    places = np.interp(np.linspace(0.0, len(at) - 1.0, _BETWEEN * (len(at) - 1) + 1), np.arange(len(at)), length)
    inner = PchipInterpolator(length, at)(places[1:-1])
    return [points[0], *((float(x), float(y)) for x, y in inner), points[-1]]


def draw_curves(axes: Axes, curves: Sequence[Curve], scale: float = 1.0) -> list[Any]:
    """Draw curves on axes, each in the look of its model; markers and lines are that much larger.

    Returns
    -------
    list
        Entries of a legend, in the order of the curves.
    """
    others = cycle(OTHERS)
    entries: list[Any] = []
    for place, curve in enumerate(curves):
        style = {**(style_of(curve.model) or next(others)), **curve.look}
        style.setdefault("markersize", scale * {"*": 13.0, "P": 10.0}.get(style["marker"], 6.5))
        if style["linestyle"] == "none":
            style = {"markeredgecolor": edge_of(curve.model), "markeredgewidth": 0.8, **style}
        if not curve.markers:
            style["marker"] = "none"
        entries.append(
            axes.errorbar(
                curve.pressure_kpa,
                curve.tip_mm,
                yerr=curve.uncertainty_mm or None,
                label=curve.label,
                elinewidth=1.2 * scale,
                capsize=3.5 * scale,
                zorder=3.0 + 0.01 * place,
                **{"linewidth": 1.8 * scale, **style},
            )
        )
        if curve.stopped:
            entries += mark_stop(axes, curve.stopped_at, style["color"], curve.stopped, scale)
    return [entry for entry in entries if not entry.get_label().startswith("_")]


def mark_stop(axes: Axes, at: tuple[float, float], colour: str, label: str, scale: float = 1.0) -> list[Any]:
    """Draw the cross where a run ended, at (x, y); returns its entry of a legend."""
    look: dict[str, Any] = {
        "marker": "x",
        "markersize": 11 * scale,
        "markeredgewidth": 2.6 * scale,
        "linestyle": "none",
    }
    return list(axes.plot(*at, color=colour, label=label, zorder=5.0, **look))


def set_pressure_axis(axes: Axes, asked_kpa: Sequence[float]) -> None:
    """Limits and ticks of a pressure axis that reaches all requested pressures (kPa), and a grid behind the curves."""
    axes.set_xlim(1.04 * min(0.0, *asked_kpa), 1.04 * max(0.0, *asked_kpa))
    if len(asked_kpa) <= 8:
        axes.set_xticks([0.0, *asked_kpa])
    grid(axes)
