"""What the plots of the paper study share: sizes, looks of the actuators, panels and their axes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.paper.cases import REFERENCE_SCENES
from studies.paper.plots.paths import ending_of, name_of, silicone_of
from studies.paper.results import CaseResult
from studies.report.curves import mark_stop, set_pressure_axis
from studies.report.style import BLUE, ORANGE, SKY, VERMILION
from studies.results.files import PathRow
from studies.results.runs import Run

WIDTH_IN: Final = 8.2

# Lines and markers in a panel of several, relative to a plot of its own.
SCALE: Final = 0.78

TITLE, SMALL = 10.0, 8.0  # points

# The four actuators where they share axes: one hue per wall, one marker each; the second of a pair is smaller and does
# not hide the first where both agree.
ACTUATORS: Final[dict[str, dict[str, Any]]] = dict(
    zip(
        REFERENCE_SCENES,
        (
            {"color": BLUE, "marker": "o", "markersize": 8.0},
            {"color": SKY, "marker": "s", "markersize": 5.5},
            {"color": VERMILION, "marker": "^", "markersize": 9.0},
            {"color": ORANGE, "marker": "D", "markersize": 4.5},
        ),
        strict=True,
    )
)


def four_panels(figure: Figure, label: str) -> list[Axes]:
    """Two by two panels: a row per wall, its vertical axis shared."""
    grid = figure.subplots(2, 2, sharex=True, sharey="row")
    for axes in grid[:, 0]:
        axes.set_ylabel(label)
    for axes in grid[-1]:
        axes.set_xlabel("cavity pressure, kPa")
    return list(grid.ravel())


def finish_panels(panels: Sequence[Axes], bases: Sequence[str], cases: Mapping[str, CaseResult]) -> None:
    """Titles, pressure axes, and vertical axes from zero."""
    for axes, base in zip(panels, bases, strict=True):
        if base in cases:
            scene = cases[base].result.scene
            axes.set_title(f"{name_of(scene)}, {silicone_of(scene)}", fontsize=TITLE)
            set_pressure_axis(axes, scene.load.pressure_kpa)
        else:
            axes.set_title(f"{base}: not run", fontsize=TITLE)
    from_zero(panels)


def from_zero(panels: Sequence[Axes], headroom: float = 1.0) -> None:
    """Vertical axes from zero, or from below where there are negative values; with room above for a legend."""
    for axes in panels:
        low, high = axes.get_ylim()
        shared = axes.get_shared_y_axes().get_siblings(axes)
        drawn = [value for one in shared for line in one.lines for value in np.atleast_1d(line.get_ydata())]
        if not min([0.0, *drawn]) < 0.0:
            low = 0.0
        axes.set_ylim(low, high)
    if headroom != 1.0:
        for axes in {min(a.get_shared_y_axes().get_siblings(a), key=id) for a in panels}:
            axes.set_ylim(top=headroom * axes.get_ylim()[1])


def mark_end(axes: Axes, run: Run, value: Callable[[PathRow], float], colour: str, note: bool = False) -> None:
    """Draw a cross where a run stopped, the reason in the corner if asked; nothing if it reached all."""
    if run.summary.status == "reached" or not run.path:
        return
    end = (run.path[-1].pressure_kpa, value(run.path[-1]))
    mark_stop(axes, end, colour, "_", SCALE)
    if note:  # where rising curves leave room
        look: dict[str, Any] = {"transform": axes.transAxes, "fontsize": SMALL, "ha": "right", "color": colour}
        axes.text(0.98, 0.03, ending_of(run), **look)


def add_entries(legend: dict[str, Any], entries: Iterable[Any]) -> None:
    """Add entries whose label is not there yet."""
    for entry in entries:
        legend.setdefault(entry.get_label(), entry)
