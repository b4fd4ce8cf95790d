"""Panels of joined and marked points, for studies to name what is drawn and not how."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from studies.report.style import figure_file, grid


@dataclass(frozen=True)
class Series:
    """Points of one kind.

    Attributes
    ----------
    x, y
        Coordinates, in the order they are joined.
    look
        Colour, dash and marker, as matplotlib's lines have them.
    label
        What the legend says; empty for no entry.
    """

    x: Sequence[float] | NDArray[Any]
    y: Sequence[float] | NDArray[Any]
    look: Mapping[str, Any]
    label: str = ""


@dataclass(frozen=True)
class Panel:
    """Axes and the series on them, the first below the others.

    Attributes
    ----------
    series
        What is drawn.
    x_label, y_label, title
        Texts; empty for none.
    logarithmic
        Axes with a logarithmic scale.
    """

    series: Sequence[Series]
    x_label: str = ""
    y_label: str = ""
    title: str = ""
    logarithmic: Literal["", "x", "y", "xy"] = ""


def draw_panels(
    path: Path,
    panels: Sequence[Sequence[Panel]],
    size_in: tuple[float, float],
    legend: Mapping[str, Any],
    **sharing: Any,
) -> None:
    """Draw rows of panels.

    Parameters
    ----------
    path
        The PNG to write.
    panels
        Rows of equal length.
    size_in
        Width and height of the picture, inches.
    legend
        Where the legend is and how it looks, see `add_legend`.
    **sharing
        ``sharex``, ``sharey``, ``height_ratios`` as in matplotlib's ``subplots``.
    """
    with figure_file(path, *size_in) as figure:
        places = figure.subplots(len(panels), len(panels[0]), squeeze=False, **sharing)
        for axes, panel in zip(places.ravel(), (panel for line in panels for panel in line), strict=True):
            add_panel(axes, panel)
        add_legend(figure, legend)


def add_panel(axes: Axes, panel: Panel) -> None:
    """Draw a panel on axes."""
    for series in panel.series:
        axes.plot(series.x, series.y, label=series.label or "_", **series.look)
    for direction in panel.logarithmic if any(len(series.x) for series in panel.series) else "":
        axes.set(**{f"{direction}scale": "log"})  # which needs something to show
    axes.set(xlabel=panel.x_label, ylabel=panel.y_label)
    axes.set_title(panel.title, fontsize=10)
    grid(axes, which="both" if panel.logarithmic else "major")


def add_legend(figure: Figure, look: Mapping[str, Any]) -> None:
    """One legend of all panels if it stands outside them (`ABOVE`, `BELOW`), each label once; else one in each."""
    if str(look.get("loc", "")).startswith("outside"):
        found: dict[str, Any] = {}
        for axes in figure.axes:
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
                found.setdefault(label, handle)
        figure.legend(handles=list(found.values()), **look)
        return
    for axes in figure.axes:
        if axes.get_legend_handles_labels()[0]:
            axes.legend(**look)
