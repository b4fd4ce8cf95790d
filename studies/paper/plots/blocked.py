"""Force at the blocked tip over pressure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from studies.paper.cases import REFERENCE_SCENES
from studies.paper.plots.layout import SCALE, WIDTH_IN, add_entries, finish_panels, four_panels, mark_end
from studies.paper.plots.paths import by_base, chain_curve, finest_run, force_of, path_of
from studies.paper.results import PaperResults
from studies.report.curves import draw_curves
from studies.report.labels import TIP_FORCE, model_label
from studies.report.style import BELOW, figure_file, style_of, white_edged
from studies.results.runs import Run


def draw_blocked(path: Path, results: PaperResults) -> str:
    """Draw the force (N) of the blocked tip over pressure (kPa), a panel per reference actuator."""
    cases = by_base(results.of("blocked"))
    if not cases:
        return "no actuator with a blocked tip has been run"
    with figure_file(path, WIDTH_IN, 7.0) as figure:
        panels = four_panels(figure, "force at the blocked tip, N")
        legend: dict[str, Any] = {}
        for axes, base in zip(panels, REFERENCE_SCENES, strict=True):
            if base not in cases:
                continue
            chain = chain_curve(cases[base].rows, "closed_form", TIP_FORCE)
            thrust = chain_curve(cases[base].rows, "closed_form", "extension_force_n")
            if chain:
                add_entries(legend, draw_curves(axes, [chain], SCALE))
            if thrust:
                points = (thrust.pressure_kpa, thrust.tip_mm)
                look: dict[str, Any] = {"color": "#555555", "linestyle": ":", "linewidth": 1.6}
                add_entries(legend, axes.plot(*points, label="thrust of the pressure alone", **look))
            if run := finest_run(cases[base]):
                add_entries(legend, _draw_blocked_path(axes, run))
        finish_panels(panels, REFERENCE_SCENES, cases)
        figure.legend(handles=list(legend.values()), ncols=2, **BELOW)
    return ""


def _draw_blocked_path(axes: Axes, run: Run) -> list[Any]:
    """Draw the force of a path, dashed where it has unstable modes; returns the entries of a legend."""
    points = list(zip(*path_of(run, force_of), strict=True))
    look: dict[str, Any] = {"color": style_of("axisymmetric")["color"], "linewidth": 1.8 * SCALE}
    first = next((k for k, state in enumerate(run.path) if state.unstable_modes > 0.0), len(run.path))
    stable, past = points[: first + 1], points[first + 1 :]
    if past:
        # the crossing was looked for between the states of the path
        turn = run.summary.crossing.get("pressure_kpa", stable[-1][0])
        pressures, forces = zip(stable[-1], past[0], strict=True)
        at = (turn, float(np.interp(turn, pressures, forces)))
        stable, past = [*stable, at], [at, *past]
    entries = []
    for label, part, dash in (
        (model_label("axisymmetric"), stable, "-"),
        ("axisymmetric, past the loss of stability", past, "--"),
    ):
        if len(part) > 1:
            entries += axes.plot(*zip(*part, strict=True), label=label, linestyle=dash, **look)
    asked = [(state.pressure_kpa, state.tip_force_n) for state in run.path if state.status == "requested"]
    axes.plot(*np.reshape(asked, (-1, 2)).T, linestyle="none", **white_edged(color=look["color"], marker="o"))
    mark_end(axes, run, force_of, look["color"], note=True)
    return entries
