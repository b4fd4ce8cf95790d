"""Maps of the sweep study, drawn from plain numbers and written as PNG."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import matplotlib
import numpy as np
from matplotlib.colors import Normalize
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

from analytical.arrays import FloatArray
from studies.report.maps import (
    PERCENT_COLOURS,
    change_of_sign,
    colour_scale,
    mark_change_of_sign,
    percent_bands,
    percent_text,
)
from studies.report.style import ABOVE, BLACK, entry, figure_file

Kind = Literal["elongation", "percent"]
# Percent at which the colour changes: white where nobody is misled.
_BOUNDS: Final = (-60.0, -40.0, -30.0, -20.0, -10.0, 10.0, 20.0, 30.0, 40.0, 60.0)
_BORDER: Final[dict[str, Any]] = {"color": BLACK, "linewidth": 2.4, "zorder": 3.0}
_NO_ANSWER: Final[dict[str, Any]] = {"facecolor": "#e0e0e0", "edgecolor": "#8c8c8c", "hatch": "///"}


@dataclass(frozen=True, eq=False)
class MapPanel:
    """A map over root radius and wall.

    Attributes
    ----------
    title
        Silicone and pressure.
    roots_mm, walls_mm
        Swept values, shapes (m,) and (k,).
    values
        What is drawn, shape (k, m); NaN where there is no such design.
    beyond_unfolding
        Pressure less that of the closed form's full unfolding, kPa; shape (k, m).
    """

    title: str
    roots_mm: FloatArray
    walls_mm: FloatArray
    values: FloatArray
    beyond_unfolding: FloatArray


def draw_design_maps(path: Path, panels: Sequence[Sequence[MapPanel]], kind: Kind, label: str) -> None:
    """Draw rows of maps with the number in every cell and one scale of colours.

    Parameters
    ----------
    path
        The PNG to write.
    panels
        Rows of equal length.
    kind
        ``elongation`` in mm, or ``percent`` with a line at 10 %.
    label
        What the colours mean, with its unit.
    """
    drawn_values = np.concatenate([p.values.ravel() for line in panels for p in line])
    percent = kind == "percent"
    norm: Any = percent_bands(_BOUNDS) if percent else Normalize(0.0, np.nanmax(drawn_values))
    colours = matplotlib.colormaps[PERCENT_COLOURS if percent else "cividis"]
    with figure_file(path, 3.6 * len(panels[0]), 3.3 * len(panels) + 0.9) as figure:
        grid = figure.subplots(len(panels), len(panels[0]), squeeze=False, sharex=True, sharey=True)
        drawn: Any = None
        for axes, panel in zip(grid.ravel(), (panel for line in panels for panel in line), strict=True):
            drawn = _draw_panel(axes, panel, colours, norm, percent)
        for axes in grid[-1]:
            axes.set_xlabel("$R_i$, mm")
        for axes in grid[:, 0]:
            axes.set_ylabel("$t$, mm")
        colour_scale(figure, drawn, grid, label, _BOUNDS if percent else None)
        entries: list[Any] = [
            change_of_sign("closed form fully unfolded to the right"),
            Patch(label="no answer: refused or stopped", **_NO_ANSWER),
        ]
        if percent:
            entries.insert(0, entry("10 % off (within: white)", color=BLACK, linewidth=2.4))
        figure.legend(handles=entries, ncols=3, **ABOVE)


def _draw_panel(axes: Any, panel: MapPanel, colours: Any, norm: Any, percent: bool) -> Any:
    axes.set_facecolor(_NO_ANSWER["facecolor"])
    x, y = _edges(panel.roots_mm), _edges(panel.walls_mm)
    values = np.ma.masked_invalid(panel.values)
    drawn = axes.pcolormesh(x, y, values, cmap=colours, norm=norm, edgecolors="white", linewidth=0.6)
    for (row, column), value in np.ndenumerate(panel.values):
        if np.isnan(value):
            low = (x[column], y[row])
            size = (x[column + 1] - x[column], y[row + 1] - y[row])
            axes.add_patch(matplotlib.patches.Rectangle(low, *size, linewidth=0.0, **_NO_ANSWER))
            continue
        cell = colours(norm(value))
        dark = np.dot(cell[:3], (0.299, 0.587, 0.114)) < 0.5
        axes.text(
            panel.roots_mm[column],
            panel.walls_mm[row],
            _shown(float(value)) if percent else f"{value:.0f}",
            ha="center",
            va="center",
            fontsize=8,
            color="white" if dark else "black",
            path_effects=[withStroke(linewidth=3.0, foreground=cell)],
            zorder=4.0,
        )
    if percent:
        _border(axes, x, y, panel.values)
    mark_change_of_sign(axes, panel.roots_mm, panel.walls_mm, panel.beyond_unfolding)
    axes.set_xlim(x[0], x[-1])
    axes.set_ylim(y[0], y[-1])
    axes.set_xticks(panel.roots_mm)
    axes.set_yticks(panel.walls_mm)
    axes.set_title(panel.title, fontsize=10)
    return drawn


def _border(axes: Any, x: FloatArray, y: FloatArray, percent: FloatArray) -> None:
    """The line between cells within 10 % and cells beyond."""
    off = np.abs(percent) > 10.0
    known = ~np.isnan(percent)
    rows, columns = np.nonzero((off[:, 1:] != off[:, :-1]) & known[:, 1:] & known[:, :-1])
    axes.vlines(x[columns + 1], y[rows], y[rows + 1], **_BORDER)
    rows, columns = np.nonzero((off[1:] != off[:-1]) & known[1:] & known[:-1])
    axes.hlines(y[rows + 1], x[columns], x[columns + 1], **_BORDER)


def _edges(middles: FloatArray) -> FloatArray:
    """Edges of cells from their middles."""
    between = 0.5 * (middles[1:] + middles[:-1])
    first, last = 1.5 * middles[0] - 0.5 * middles[1], 1.5 * middles[-1] - 0.5 * middles[-2]
    return np.concatenate([[first], between, [last]])


def _shown(percent: float) -> str:
    """A difference in whole percent, with a decimal where it is not seen otherwise on which side of 10 it is."""
    return percent_text(round(percent, 1 if round(abs(percent)) == 10 else None))
