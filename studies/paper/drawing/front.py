"""The picture of what all is about: an actuator cut open at every pressure, beside its elongation by all models."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from matplotlib.image import imread

from studies.paper.cases import REFERENCE_SCENES
from studies.paper.drawing.panels import ELONGATION, LAST_KPA, TITLE, by_base, draw_band, elongation_curves
from studies.paper.results import PaperResults
from studies.paper.setup.sizes import CALLED
from studies.report.curves import Curve, draw_curves
from studies.report.style import figure_file, grid

ACTUATOR = REFERENCE_SCENES[0]


def draw_front(path: Path, results: PaperResults, states: Path) -> str:
    """Draw the first actuator: its states, from their picture, and elongation (mm) over pressure (kPa).

    Parameters
    ----------
    path
        The PNG to write.
    results
        All cases.
    states
        The picture of the actuator's states.

    Returns
    -------
    str
        Why there is no picture, or nothing.
    """
    case = by_base(results.of("core")).get(ACTUATOR)
    if case is None or not states.exists():
        return f"{ACTUATOR} has not been run in full 3D"
    with figure_file(path, 12.6, 5.5) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.12, 1.0))
        left.imshow(imread(states), interpolation="lanczos")
        left.set_axis_off()
        entries = draw_curves(right, list(_told_apart(elongation_curves(results)(ACTUATOR))))
        draw_band(right, case)
        right.set(xlim=(0.0, LAST_KPA), ylim=(0.0, None), xlabel="cavity pressure, kPa", ylabel=ELONGATION)
        right.set_title(f"{CALLED[ACTUATOR].replace('R_i', '$R_i$')} (dimensions inferred)", fontsize=TITLE)
        grid(right)
        right.legend(handles=entries, fontsize=7.6, loc="upper left", framealpha=0.9)
    return ""


def _told_apart(curves: Sequence[Curve]) -> Iterator[Curve]:
    """Curves whose bodies are named after their outlines: the first is that near the zigzag, if there are two."""
    names = [curve.label for curve in curves]
    for place, curve in enumerate(curves):
        if names.count(curve.label) > 1:
            outline = "zigzag" if curve.label in names[place + 1 :] else "as moulded"
            curve = replace(curve, label=curve.label.replace("full 3D", f"full 3D, {outline}", 1))
        yield curve
