"""The picture of what all is about: an actuator cut open at every pressure, beside its elongation by all models."""

from __future__ import annotations

from pathlib import Path

from matplotlib.image import imread

from studies.paper.cases import REFERENCE_SCENES
from studies.paper.drawing.panels import ELONGATION, LAST_KPA, TITLE, by_base, draw_band, elongation_curves
from studies.paper.results import PaperResults
from studies.paper.setup.sizes import CALLED
from studies.report.curves import draw_curves
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
        entries = draw_curves(right, elongation_curves(results)(ACTUATOR))
        draw_band(right, case)
        right.set(xlim=(0.0, LAST_KPA), ylim=(0.0, None), xlabel="cavity pressure, kPa", ylabel=ELONGATION)
        right.set_title(f"{CALLED[ACTUATOR]} (dimensions inferred)", fontsize=TITLE)
        grid(right)
        right.legend(handles=entries, fontsize=7.6, loc="upper left", framealpha=0.9)
    return ""
