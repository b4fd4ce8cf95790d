"""Plots of the closed-form study, drawn from plain numbers and written as PNG."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.colors import BoundaryNorm

from analytical.arrays import FloatArray
from studies.report.maps import (
    PERCENT_COLOURS,
    change_of_sign,
    colour_scale,
    mark_change_of_sign,
    percent_bands,
    percent_text,
)
from studies.report.panels import Panel, Series, draw_panels
from studies.report.style import ABOVE, BLUE, GREEN, HALO, VERMILION, figure_file

# Percent at which the colour changes: white below 5 %.
_BOUNDS: Final = (-100.0, -50.0, -20.0, -10.0, -5.0, 5.0, 10.0, 20.0, 50.0, 100.0)
# Labels nearer than this would overlap, pixels.
_LABEL_ROOM: Final = 35.0
_NO_STATE: Final = "#bdbdbd"


@dataclass(frozen=True, eq=False)
class MapPanel:
    """A map of a change in percent.

    Attributes
    ----------
    title, x_label, y_label
        Texts.
    x, y
        Coordinates, shapes (m,) and (k,).
    percent
        What is drawn, shape (k, m); NaN is grey.
    unfolded
        Positive where the bellows is fully unfolded, negative where it is folded; shape (k, m).
    points
        Places (x, y) to mark, by label.
    lines
        Values of x to mark, by label.
    right_axis
        Factor and label of a second y axis on the right; None for none.
    """

    title: str
    x_label: str
    y_label: str
    x: FloatArray
    y: FloatArray
    percent: FloatArray
    unfolded: FloatArray
    points: Mapping[str, tuple[float, float]]
    lines: Mapping[str, float]
    right_axis: tuple[float, str] | None = None


def draw_maps(path: Path, panels: Sequence[Sequence[MapPanel]], colour_label: str) -> None:
    """Draw rows of maps with contour lines and one colour scale in percent.

    Parameters
    ----------
    path
        The PNG to write.
    panels
        Rows of equal length.
    colour_label
        What the colours mean, with its unit.
    """
    width = len(panels[0])
    with figure_file(path, 3.1 * width, 2.9 * len(panels) + 0.6) as figure:
        # room for the y labels, which the layout puts a little beyond the edge otherwise
        figure.set_layout_engine("constrained", w_pad=0.1)
        grid = figure.subplots(len(panels), width, squeeze=False)
        norm = percent_bands(_BOUNDS)
        drawn: Any = None
        for axes, panel in zip(grid.ravel(), (panel for line in panels for panel in line), strict=True):
            drawn = _draw_map(axes, panel, norm)
        colour_scale(figure, drawn, grid, colour_label, _BOUNDS)
        figure.legend(handles=[change_of_sign("fully unfolded from here on")], loc="outside lower right", frameon=False)


def _draw_map(axes: Any, panel: MapPanel, norm: BoundaryNorm) -> Any:
    axes.set_facecolor(_NO_STATE)
    percent = np.ma.masked_invalid(panel.percent)
    drawn = axes.contourf(panel.x, panel.y, percent, levels=_BOUNDS, cmap=PERCENT_COLOURS, norm=norm, extend="both")
    lines = axes.contour(panel.x, panel.y, percent, levels=_BOUNDS, colors="black", linewidths=0.7)
    texts = axes.clabel(lines, inline=False, colors="black", fmt=percent_text, fontsize=7)
    _thin_out(axes, texts, panel.points.values())
    mark_change_of_sign(axes, panel.x, panel.y, panel.unfolded)
    for label, (x, y) in panel.points.items():
        axes.plot(x, y, marker="o", color="black", markeredgecolor="white", markersize=7, zorder=5)
        axes.annotate(
            label, (x, y), xytext=(0, 7), textcoords="offset points", ha="center", fontsize=8, path_effects=HALO
        )
    for label, x in panel.lines.items():
        axes.axvline(x, color="black", linewidth=1.2, linestyle=":")
        axes.annotate(
            label,
            (x, 0.97),
            xycoords=("data", "axes fraction"),
            xytext=(3, 0),
            textcoords="offset points",
            rotation=90,
            va="top",
            fontsize=8,
            path_effects=HALO,
        )
    axes.set_title(panel.title, fontsize=10)
    axes.set_xlabel(panel.x_label)
    axes.set_ylabel(panel.y_label)
    if panel.right_axis is not None:
        factor, label = panel.right_axis
        right = axes.secondary_yaxis("right", functions=(lambda y: factor * y, lambda y: y / factor))
        right.set_ylabel(label)
    return drawn


def _thin_out(axes: Any, texts: Sequence[Any], points: Iterable[tuple[float, float]]) -> None:
    """Hide contour labels too near to a marked point or to another label; halo round the others."""
    to_screen = axes.transData.transform
    taken = [to_screen(point) + (0.0, 0.5 * _LABEL_ROOM) for point in points]
    for text in texts:
        text.set_path_effects(HALO)
        place = to_screen(text.get_position())
        if any(np.hypot(*(place - other)) < _LABEL_ROOM for other in taken):
            text.set_visible(False)
        else:
            taken.append(place)


def draw_stress_curves(path: Path, stretch: FloatArray, nominal_kpa: Mapping[str, Mapping[str, FloatArray]]) -> None:
    """Draw nominal stress over stretch, a panel per test, on a logarithmic scale.

    Parameters
    ----------
    path
        The PNG to write.
    stretch
        Stretches, shape (n,).
    nominal_kpa
        By test, then by material: nominal stress, shape (n,), kPa.
    """
    styles = (
        {"color": BLUE, "linestyle": "-", "linewidth": 1.8},
        {"color": GREEN, "linestyle": "--", "linewidth": 1.8},
        {"color": VERMILION, "linestyle": "-.", "linewidth": 1.8},
    )
    panels: list[Panel] = []
    for test, materials in nominal_kpa.items():
        series = [
            Series(stretch, stress, style, name)
            for (name, stress), style in zip(materials.items(), styles, strict=True)
        ]
        label = "" if panels else "nominal stress, kPa"
        panels.append(Panel(series, "stretch", label, test, logarithmic="y"))
    draw_panels(path, [panels], (9.3, 4.0), {**ABOVE, "ncols": 3}, sharey=True)
