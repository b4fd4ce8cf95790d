"""Plots of the cost study: error over time with its fronts, and time and memory over unknowns."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from studies.cost.points import Growth, Point, front, per_factorisation
from studies.report.labels import model_label
from studies.report.style import (
    BESIDE,
    BLACK,
    BLUE,
    GREEN,
    GREY,
    PURPLE,
    VERMILION,
    figure_file,
    grid,
    logarithmic,
    style_of,
)

# Of other programs by their name in turn.
PEER_COLOURS = (GREEN, PURPLE, BLACK, GREY)
MARKERS = {"hex": "s", "tet": "^", "tet-p0": "v", "tet-p1": "x", "none": "P"}
ELEMENTS = {
    "hex": "hexahedra",
    "tet": "tetrahedra",
    "tet-p0": "tetrahedra P2/P0",
    "tet-p1": "tetrahedra P1",
    "none": "no cells",
}


def draw_front(path: Path, points: Sequence[Point], whole: bool = False) -> None:
    """Draw error (percent) over time (s), both logarithmic; of each model its front as a line.

    Parameters
    ----------
    path
        The PNG to write.
    points
        Of one body; those without an error or a time are left out.
    whole
        True for the time from start to end of the process, which is all that is known of other programs.
    """
    if whole:
        points = [replace(p, cost=replace(p.cost, work_s=math.nan)) for p in points]
    shown = [p for p in points if np.isfinite(p.error_percent) and np.isfinite(p.cost.wall_s)]
    models = list(dict.fromkeys(p.model for p in shown))
    peers = [model for model in models if model.startswith("peer_")]
    colours = {model: style_of(model)["color"] for model in models if model not in peers}
    colours |= {model: PEER_COLOURS[k % len(PEER_COLOURS)] for k, model in enumerate(peers)}
    with figure_file(path, 8.6, 5.0) as figure:
        axes = figure.add_subplot()
        for model, colour in colours.items():
            mine = [p for p in shown if p.model == model]
            line = front(mine)
            label = model_label(model.removeprefix("peer_"))
            axes.plot(*_places(line), color=colour, linewidth=1.4, label=label)
            for p in line:
                at = (p.time_s, p.told_apart_percent)
                name = f"{p.element} {p.mesh}"
                axes.annotate(name, at, (4, 5), textcoords="offset points", fontsize=7.5, color=colour)
            for element in dict.fromkeys(p.element for p in mine):
                of = [p for p in mine if p.element == element]
                axes.scatter(*_places(of), s=42.0, color=colour, marker=MARKERS.get(element, "D"), alpha=0.8)
        if default := [p for p in shown if p.default]:
            label = "settings of study-paper"
            axes.scatter(*_places(default), s=196.0, facecolors="none", edgecolors=BLACK, label=label)
        for element in dict.fromkeys(p.element for p in shown if not p.is_peer):
            axes.plot([], [], color=GREY, marker=MARKERS[element], linestyle="none", label=ELEMENTS[element])
        logarithmic(axes, "x", "y")
        axes.set_xlabel(f"wall time, s, {'from start to end of the process' if whole else 'without start and imports'}")
        axes.set_ylabel("error, %")
        grid(axes, which="both")
        if shown:
            axes.legend(**BESIDE)


def _places(of: Sequence[Point]) -> tuple[list[float], list[float]]:
    """Times, s, and errors, percent."""
    return [p.time_s for p in of], [p.told_apart_percent for p in of]


def draw_growth(path: Path, of: Sequence[Point], laws: Growth) -> None:
    """Draw time, time per factorisation and memory over the number of unknowns, logarithmic, each with its power law.

    Parameters
    ----------
    path
        The PNG to write.
    of
        Bodies of growing size.
    laws
        Theirs.
    """
    curves = (
        ("time without start, s", [p.cost.work_s for p in of], laws.time, VERMILION),
        ("time per factorisation, s", [per_factorisation(p) for p in of], laws.iteration, BLUE),
        ("memory, MB", [p.cost.peak_mb for p in of], laws.memory, GREEN),
    )
    unknowns = [p.cost.unknowns for p in of]
    ends = np.array([min(unknowns), max(unknowns)])
    with figure_file(path, 8.6, 3.8) as figure:
        for axes, (label, values, law, colour) in zip(figure.subplots(1, 3), curves, strict=True):
            axes.plot(unknowns, values, color=colour, marker="s", linestyle="none")
            line = [law.at(x) for x in ends]
            axes.plot(ends, line, color=colour, linewidth=1.2, label=f"exponent {law.exponent:.2f}")
            axes.set(xscale="log", yscale="log", xlabel="unknowns", ylabel=label)
            grid(axes, which="both")
            axes.legend(frameon=False)
