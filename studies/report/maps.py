"""Maps over two sizes: panels on one scale of colours, and where a bellows is fully unfolded."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any, Final

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, Colormap
from matplotlib.lines import Line2D

from analytical.arrays import FloatArray
from studies.report.numbers import MINUS
from studies.report.style import BLUE, HALO, entry, figure_file

# Of differences: orange against purple, told apart by colour-blind readers, white in between.
DIFFERENCES: Final[Colormap] = matplotlib.colormaps["PuOr"]
_UNFOLDED: Final[dict[str, Any]] = {"color": BLUE, "linestyle": "--", "linewidth": 1.6}


@dataclass(frozen=True, eq=False)
class Panel:
    """A map.

    Attributes
    ----------
    title, x_label, y_label
        Texts.
    x, y
        Coordinates, shapes (m,) and (k,).
    values
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
    values: FloatArray
    unfolded: FloatArray
    points: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    lines: Mapping[str, float] = field(default_factory=dict)
    right_axis: tuple[float, str] | None = None


def draw_panels(
    path: Path,
    panels: Sequence[Sequence[Panel]],
    draw: Callable[[Axes, Panel], ScalarMappable],
    label: str,
    legend: Sequence[Artist],
    bounds: Sequence[float] | None = None,
    size_in: float = 3.0,
) -> None:
    """Draw rows of maps above one scale of colours and a legend.

    Parameters
    ----------
    path
        The PNG to write.
    panels
        Rows of equal length.
    draw
        Draws the values of a panel; returns what the scale of colours is of, the same for all panels.
    label
        What the colours mean, with its unit.
    legend
        Its entries.
    bounds
        Values at which the colour changes, for the ticks of the scale; None if it changes everywhere.
    size_in
        Width and about the height of a panel.
    """
    with figure_file(path, size_in * len(panels[0]), size_in * len(panels) + 0.6) as figure:
        # room for the y labels, which the layout puts a little beyond the edge otherwise
        figure.set_layout_engine("constrained", w_pad=0.1)
        grid = figure.subplots(len(panels), len(panels[0]), squeeze=False)
        for axes, panel in zip(grid.ravel(), chain.from_iterable(panels), strict=True):
            drawn = draw(axes, panel)
            axes.set(title=panel.title, xlabel=panel.x_label, ylabel=panel.y_label)
            axes.title.set_fontsize(10)
            mark_unfolding(axes, panel)
        bar = figure.colorbar(drawn, ax=grid, location="bottom", aspect=50, shrink=0.7)
        if bounds is not None:
            bar.set_ticks(bounds, labels=[difference_text(bound) for bound in bounds])
        bar.set_label(label)
        figure.legend(handles=legend, loc="outside upper center", ncols=3, frameon=False)


def steps(bounds: Sequence[float]) -> BoundaryNorm:
    """A colour per interval and one for either end beyond."""
    return BoundaryNorm(bounds, 256, extend="both")


def mark_unfolding(axes: Axes, panel: Panel) -> None:
    """The line between folded and fully unfolded states, if it is on the map."""
    if np.any(panel.unfolded > 0.0) and np.any(panel.unfolded < 0.0):
        masked = np.ma.masked_invalid(panel.unfolded)
        line = axes.contour(panel.x, panel.y, masked, levels=[0.0], colors=BLUE, linestyles="--")
        line.set(linewidth=1.6, path_effects=HALO)


def unfolding_entry(label: str) -> Line2D:
    """Entry of a legend for the line of `mark_unfolding`."""
    return entry(label, **_UNFOLDED)


def difference_text(value: float) -> str:
    """A difference in short, with its sign; 0 without."""
    return f"{value:+g}".replace("-", MINUS) if value else "0"
