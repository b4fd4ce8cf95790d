"""Plots of measured values against exact ones over the load."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from studies.report.style import BESIDE, BLACK, BLUE, VERMILION, figure_file


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
    with figure_file(path, 8.2, 4.2) as figure:
        axes = figure.add_subplot()
        if exact is not None:
            axes.plot(exact.load_kpa, exact.value, color=BLACK, linewidth=1.6, label=exact.label)
        for place, points in enumerate(levels):
            # rings of different sizes, so that equal values are all seen
            axes.plot(
                points.load_kpa,
                points.value,
                linestyle="none" if exact is not None else ":",
                marker="o",
                markersize=5.0 + 4.5 * (len(levels) - 1 - place),
                markerfacecolor="none",
                markeredgewidth=1.5,
                color=BLUE,
                label=points.label,
            )
        for place, (label, load) in enumerate(crossings_kpa):
            axes.axvline(load, color=VERMILION, linestyle=("-", "--")[place % 2], linewidth=1.4, label=label)
        axes.set_xlabel("load, kPa")
        axes.set_ylabel(name)
        axes.grid(color="#e4e4e4", zorder=0)
        axes.set_axisbelow(True)
        axes.legend(**BESIDE)
