"""Plots of a report, drawn from plain numbers and written as PNG."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

DPI = 150

# Okabe and Ito: told apart by colour-blind readers; shape and dash say the same once more.
BLACK, ORANGE, SKY, GREEN, BLUE, VERMILION, PURPLE = (
    "#000000",
    "#E69F00",
    "#56B4E9",
    "#009E73",
    "#0072B2",
    "#D55E00",
    "#CC79A7",
)
_STYLES: dict[str, dict[str, Any]] = {
    "closed_form": {"color": ORANGE, "linestyle": "--", "marker": "^"},
    "closed_form_printed": {"color": SKY, "linestyle": "-.", "marker": "<"},
    "closed_form_balanced": {"color": GREEN, "linestyle": "-", "marker": "o"},
    "closed_form_seat": {"color": GREEN, "linestyle": ":", "marker": "v"},
    "axisymmetric": {"color": BLUE, "linestyle": "-", "marker": "o"},
    "sector": {"color": SKY, "linestyle": "-.", "marker": "h"},
    "full3d": {"color": VERMILION, "linestyle": "none", "marker": "s"},
    # large and hollow: seen round the hexahedra's where both agree
    "full3d_tets": {"color": VERMILION, "linestyle": "none", "marker": "s", "markerfacecolor": "none"},
    "paper_closed_form": {"color": ORANGE, "linestyle": "none", "marker": "P"},
    "paper_ansys": {"color": PURPLE, "linestyle": "none", "marker": "D"},
    "paper_experiment": {"color": BLACK, "linestyle": "none", "marker": "*"},
}
_OTHERS = (
    {"color": "#777777", "linestyle": "--", "marker": "<"},
    {"color": "#777777", "linestyle": ":", "marker": ">"},
    {"color": "#777777", "linestyle": "-.", "marker": "d"},
)
# Paul Tol's muted scheme, also safe; pale grey for what no clock was put on.
_ACTIVITIES = (
    "#332288",
    "#88CCEE",
    "#44AA99",
    "#117733",
    "#999933",
    "#DDCC77",
    "#CC6677",
    "#882255",
    "#AA4499",
)
_OTHER_COLOUR = "#D0D0D0"
BESIDE: dict[str, Any] = {
    "loc": "upper left",
    "bbox_to_anchor": (1.01, 1.0),
    "borderaxespad": 0.0,
    "frameon": False,
}


@dataclass(frozen=True)
class Curve:
    """Elongation of one model over the pressure.

    Attributes
    ----------
    model, label
        Decides the style; what the legend says.
    pressure_kpa, tip_mm
        Points in the order they are joined; of a blocked tip the force in N.
    uncertainty_mm
        Half height of the error bars, mm; NaN draws none, empty means there are none.
    markers
        False: a line only, for paths of many states.
    stopped, stopped_at
        Empty, or what the legend says of the cross where the run ended; its pressure (kPa) and tip (mm).
    """

    model: str
    label: str
    pressure_kpa: tuple[float, ...]
    tip_mm: tuple[float, ...]
    uncertainty_mm: tuple[float, ...] = ()
    markers: bool = True
    stopped: str = ""
    stopped_at: tuple[float, float] = (0.0, 0.0)


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
    with figure_file(path, 8.2, 4.9) as figure:
        axes = figure.add_subplot()
        entries = draw_curves(axes, curves)
        axes.set_xlabel("cavity pressure, kPa")
        axes.set_ylabel(label)
        drawn = [tip for curve in curves for tip in curve.tip_mm]
        axes.set_ylim(bottom=1.04 * min([0.0, *drawn]))
        set_pressure_axis(axes, asked_kpa)
        axes.legend(handles=entries, **BESIDE)


def draw_curves(axes: Axes, curves: Sequence[Curve], scale: float = 1.0) -> list[Any]:
    """Draw curves on axes, each in the look of its model; markers and lines are that much larger.

    Returns
    -------
    list
        Entries of a legend, in the order of the curves.
    """
    others = cycle(_OTHERS)
    entries: list[Any] = []
    for place, curve in enumerate(curves):
        style = style_of(curve.model) or dict(next(others))
        style["markersize"] = scale * {"*": 13.0, "P": 10.0}.get(style["marker"], 6.5)
        if "markerfacecolor" in style:
            style["markersize"] *= 1.6
        elif style["linestyle"] == "none":
            style |= {"markeredgecolor": _edge(curve.model), "markeredgewidth": 0.8}
        if not curve.markers:
            style["marker"] = "none"
        entries.append(
            axes.errorbar(
                curve.pressure_kpa,
                curve.tip_mm,
                yerr=curve.uncertainty_mm or None,
                label=curve.label,
                linewidth=1.8 * scale,
                elinewidth=1.2 * scale,
                capsize=3.5 * scale,
                zorder=3.0 + 0.01 * place,
                **style,
            )
        )
        if curve.stopped:
            entries += mark_stop(axes, curve.stopped_at, style["color"], curve.stopped, scale)
    return entries


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
    axes.grid(color="#e4e4e4", zorder=0)
    axes.set_axisbelow(True)


def style_of(model: str) -> dict[str, Any]:
    """Colour, dash and marker of a model; empty if it has none of its own."""
    return dict(_STYLES.get(model, {}))


def draw_overview(path: Path, scenes: Sequence[str], values_mm: Mapping[tuple[str, str], Sequence[float]]) -> None:
    """Draw the tip displacement of several scenes, one line of dots each.

    Parameters
    ----------
    path
        The PNG to write.
    scenes
        A label per scene.
    values_mm
        By model and its label, one value per scene, mm; NaN is not drawn.
    """
    with figure_file(path, 8.2, 1.2 + 0.55 * len(scenes)) as figure:
        axes = figure.add_subplot()
        others = cycle(_OTHERS)
        for place, ((model, label), values) in enumerate(values_mm.items()):
            style = (style_of(model) or next(others)) | {"linestyle": "none"}
            offset = 0.09 * (place - 0.5 * (len(values_mm) - 1))
            axes.plot(
                values,
                [row + offset for row in range(len(scenes))],
                label=label,
                markersize={"*": 13.0, "P": 10.0}.get(style["marker"], 7.5),
                markeredgecolor=_edge(model),
                markeredgewidth=0.8,
                **style,
            )
        axes.set_yticks(range(len(scenes)), scenes)
        axes.set_ylim(len(scenes) - 0.45, -0.55)
        for row in range(1, len(scenes)):
            axes.axhline(row - 0.5, color="#d0d0d0", linewidth=0.8)
        axes.set_xlim(left=0.0)
        axes.set_xlabel("elongation at the tip, mm")
        axes.tick_params(axis="y", length=0)
        axes.grid(axis="x", color="#e4e4e4")
        axes.set_axisbelow(True)
        axes.legend(**BESIDE)


def draw_times(path: Path, runs: Sequence[str], seconds: Mapping[str, Sequence[float]]) -> None:
    """Draw where the wall time of each run went: in seconds, and in percent of the run.

    Parameters
    ----------
    path
        The PNG to write.
    runs
        A label per run.
    seconds
        By activity, one number per run, s; the last activity is drawn in grey if it is called ``other``.
    """
    totals = [sum(column) for column in zip(*seconds.values(), strict=True)]
    colours = cycle(_ACTIVITIES)
    with figure_file(path, 8.2, 1.75 + 0.33 * len(runs)) as figure:
        left, right = figure.subplots(1, 2, sharey=True)
        starts = [0.0] * len(runs)
        for activity, values in seconds.items():
            colour = _OTHER_COLOUR if activity == "other" else next(colours)
            bar = {"height": 0.68, "color": colour, "edgecolor": "white", "linewidth": 0.4}
            left.barh(range(len(runs)), values, left=starts, label=activity, **bar)
            shares, begins = (
                [100.0 * part / total if total else 0.0 for part, total in zip(parts, totals, strict=True)]
                for parts in (values, starts)
            )
            right.barh(range(len(runs)), shares, left=begins, **bar)
            starts = [start + value for start, value in zip(starts, values, strict=True)]
        left.set_yticks(range(len(runs)), runs)
        left.set_ylim(len(runs) - 0.4, -0.6)
        left.set_xlabel("wall time, s")
        left.xaxis.set_major_locator(MaxNLocator(5))
        left.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        right.set_xlabel("share of the run, %")
        right.set_xlim(0.0, 100.0)
        for axes in (left, right):
            axes.tick_params(axis="y", length=0)
            axes.grid(axis="x", color="#e4e4e4")
            axes.set_axisbelow(True)
        figure.legend(loc="outside upper center", ncols=5, frameon=False, columnspacing=1.4)


def _edge(model: str) -> str:
    """Colour round a marker: printed numbers are told from computed ones by black."""
    return "black" if model.startswith("paper_") else "white"


@contextmanager
def figure_file(path: Path, width_in: float, height_in: float) -> Iterator[Figure]:
    """A figure that is written to ``path`` on leaving; no state shared with the caller's matplotlib."""
    figure = Figure(figsize=(width_in, height_in), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    yield figure
    for axes in figure.axes:
        axes.spines[["top", "right"]].set_visible(False)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=DPI)
