"""Several scenes or runs side by side: dots for what they came to, bars for where their time went."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle
from pathlib import Path

from matplotlib.ticker import FuncFormatter, MaxNLocator

from studies.report.style import BESIDE, OTHERS, edge_of, figure_file, grid, style_of

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
        others = cycle(OTHERS)
        for place, ((model, label), values) in enumerate(values_mm.items()):
            style = (style_of(model) or next(others)) | {"linestyle": "none"}
            offset = 0.09 * (place - 0.5 * (len(values_mm) - 1))
            axes.plot(
                values,
                [row + offset for row in range(len(scenes))],
                label=label,
                markersize={"*": 13.0, "P": 10.0}.get(style["marker"], 7.5),
                markeredgecolor=edge_of(model),
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
        grid(axes, axis="x")
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
            grid(axes, axis="x")
        figure.legend(loc="outside upper center", ncols=5, frameon=False, columnspacing=1.4)
