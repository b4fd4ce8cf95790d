"""Plots of measured values against exact ones over the load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from studies.report.panels import Panel, Series, add_panel
from studies.report.style import BESIDE, BLACK, BLUE, VERMILION, figure_file

_EXACT: Final = {"color": BLACK, "linewidth": 1.6}
_MEASURED: Final = {"color": BLUE, "marker": "o", "markerfacecolor": "none", "markeredgewidth": 1.5}


@dataclass(frozen=True)
class Points:
    """Values of one quantity over the load, kPa."""

    label: str
    load_kpa: tuple[float, ...]
    value: tuple[float, ...]


def draw_against_exact(
    path: Path, name: str, exact: Points | None, levels: Sequence[Points], crossings_kpa: Sequence[tuple[str, float]]
) -> None:
    """Draw measured values as markers, the exact answer as a line, and where stability is lost.

    Parameters
    ----------
    path
        The PNG to write.
    name
        What the upright axis says, with its unit.
    exact
        The exact curve, None if there is none.
    levels
        Measured values, a series per mesh.
    crossings_kpa
        Labels and loads of upright lines.
    """
    series = [] if exact is None else [Series(exact.load_kpa, exact.value, _EXACT, exact.label)]
    for place, points in enumerate(levels):
        # rings of different sizes, so that equal values are all seen
        size = 5.0 + 4.5 * (len(levels) - 1 - place)
        look = {**_MEASURED, "linestyle": "none" if exact is not None else ":", "markersize": size}
        series.append(Series(points.load_kpa, points.value, look, points.label))
    with figure_file(path, 8.2, 4.2) as figure:
        axes = figure.add_subplot()
        add_panel(axes, Panel(series, "load, kPa", name))
        for place, (label, load) in enumerate(crossings_kpa):
            axes.axvline(load, color=VERMILION, linestyle=("-", "--")[place % 2], linewidth=1.4, label=label)
        axes.legend(**BESIDE)
