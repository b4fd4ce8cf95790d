"""What the paper study's plots are made of: curves of a case's rows and runs, panels, legends."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import takewhile
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.closed_form.tables import SILICONES
from studies.models.run_log import Run
from studies.paper.errors import PRINTED
from studies.paper.results import CaseResult
from studies.report.curves import Curve, draw_curves, set_pressure_axis
from studies.report.labels import TIP, model_label
from studies.report.style import BELOW
from studies.results.files import PathRow
from studies.results.rows import FOLDED_BACK, REACHED, Row
from studies.scene.bellows import Scene

# Lines and markers in a panel of several, relative to a plot of its own.
SCALE: Final = 0.78
TITLE, SMALL = 10.0, 8.0  # points
# A curve that no legend names.
UNNAMED: Final = "_"


# --- curves ---------------------------------------------------------------------------------


def tip(state: PathRow) -> float:
    """Elongation of a state, mm."""
    return state.tip_mm


def force(state: PathRow) -> float:
    """Force of a state at the blocked tip, N."""
    return state.tip_force_n


def path_curves(
    case: CaseResult, label: str, look: Mapping[str, Any], stopped: Callable[[Run], str] = lambda run: UNNAMED
) -> list[Curve]:
    """Elongation along the finest axisymmetric path from rest on, with a cross where it stopped; none if it was not run."""
    found = []
    for run in case.axisymmetric[-1:]:
        points = from_rest((state.pressure_kpa, state.tip_mm) for state in run.path)
        why = "" if run.summary.status == REACHED else stopped(run)
        found.append(curve("axisymmetric", label, points, look, why))
    return found


def requested_curve(run: Run, value: Callable[[PathRow], float], look: Mapping[str, Any]) -> Curve:
    """Dots at the requested states of a path."""
    points = [(state.pressure_kpa, value(state)) for state in run.path if state.status == "requested"]
    return curve("axisymmetric", UNNAMED, points, {"linestyle": "none", **look}, markers=True)


def chain_curves(case: CaseResult, model: str, quantity: str = TIP, label: str = "", **look: Any) -> list[Curve]:
    """A chain's curve from rest, up to where it folds back; none if it has no other point."""
    kept = list(takewhile(lambda row: row.status != FOLDED_BACK, series(case.rows, quantity, model)))
    points = from_rest((row.pressure_kpa, row.value) for row in kept)
    fold = ", to its fold-back" if model == "closed_form_printed" else ""
    return [curve(model, label or model_label(model) + fold, points, look, markers=True)] if kept else []


def body_curves(case: CaseResult, style: str, label: str) -> list[Curve]:
    """The finest full 3D answers with their uncertainties."""
    rows = series(case.rows, TIP, "full3d")
    if not rows:
        return []
    pressures, tips, doubts = zip(*((r.pressure_kpa, r.value, r.uncertainty) for r in rows), strict=True)
    return [Curve(style, label, pressures, tips, doubts if np.isfinite(doubts).any() else ())]


def printed_curves(case: CaseResult) -> list[Curve]:
    """What the paper prints."""
    found = {model: series(case.rows, TIP, model) for model in PRINTED}
    return [Curve(model, model_label(model), (r[-1].pressure_kpa,), (r[-1].value,)) for model, r in found.items() if r]


def curve(
    model: str,
    label: str,
    points: Sequence[tuple[float, float]],
    look: Mapping[str, Any],
    stopped: str = "",
    markers: bool = False,
) -> Curve:
    """A curve through points (kPa, mm or N) that may end in a cross."""
    pressures, values = zip(*points, strict=True) if points else ((), ())
    end = points[-1] if points else (0.0, 0.0)
    return Curve(model, label, pressures, values, (), markers, stopped, end, look)


def series(rows: Iterable[Row], quantity: str, model: str) -> list[Row]:
    """Rows of a quantity and model that were reached, one per pressure, ascending; of the finest level, the last."""
    found = {row.pressure_kpa: row for row in rows if row.quantity == quantity and row.model == model}
    return [found[pressure] for pressure in sorted(found) if math.isfinite(found[pressure].value)]


def from_rest(points: Iterable[tuple[float, float]], at_rest: float = 0.0) -> list[tuple[float, float]]:
    """Points (kPa and a value) with that at rest before them, if it is not there."""
    found = list(points)
    return found if found and found[0][0] == 0.0 else [(0.0, at_rest), *found]


def ending_of(run: Run) -> str:
    """Where a path ended, the kind of reason if it did not reach what was asked, and where it lost its stability."""
    last = run.path[-1].pressure_kpa if run.path else 0.0
    crossing = run.summary.crossing
    where = ""
    if crossing:
        digits = 1 if crossing["within_kpa"] >= 0.1 else 2
        where = f" at {crossing['pressure_kpa']:.{digits}f} ± {crossing['within_kpa']:.{digits}f} kPa"
    if run.summary.status == REACHED:
        return f"reaches {last:g} kPa" + (f" ({crossing['kind']}{where})" if crossing else "")
    return f"stops at {last:.1f} kPa ({run.summary.cause or 'no cause given'}{where})"


# --- panels ---------------------------------------------------------------------------------


def panels(figure: Figure, label: str, number: int) -> list[Axes]:
    """Panels, two in a row whose vertical axis is shared."""
    grid = figure.subplots(number // 2, 2, sharex=True, sharey="row", squeeze=False)
    for axes in grid[:, 0]:
        axes.set_ylabel(label)
    for axes in grid[-1]:
        axes.set_xlabel("cavity pressure, kPa")
    return list(grid.ravel())


def draw_actuators(
    figure: Figure,
    label: str,
    bases: Sequence[str],
    cases: Mapping[str, CaseResult],
    curves: Callable[[str], Sequence[Curve]],
) -> tuple[dict[str, Axes], list[Any]]:
    """Draw a panel per actuator.

    Returns
    -------
    dict, list
        Panels of the actuators that have been run; entries of a legend of all.
    """
    found: dict[str, Axes] = {}
    entries: list[Any] = []
    for axes, base in zip(panels(figure, label, len(bases)), bases, strict=True):
        if base not in cases:
            axes.set_title(f"{base}: not run", fontsize=TITLE)
            continue
        entries += draw_curves(axes, curves(base), SCALE)
        scene = cases[base].scene
        axes.set_title(f"{name_of(scene)}, {silicone_of(scene)}", fontsize=TITLE)
        set_pressure_axis(axes, scene.load.pressure_kpa)
        found[base] = axes
    from_zero(figure.axes)
    return found, entries


def from_zero(panels: Sequence[Axes], headroom: float = 1.0) -> None:
    """Vertical axes from zero, or from below where there are negative values; with room above for a legend."""
    for axes in panels:
        rows = axes.get_shared_y_axes().get_siblings(axes)
        drawn = [value for one in rows for line in one.lines for value in np.atleast_1d(line.get_ydata())]
        low, high = axes.get_ylim()
        axes.set_ylim(low if min(drawn, default=0.0) < 0.0 else 0.0, high)
    for axes in {min(a.get_shared_y_axes().get_siblings(a), key=id) for a in panels}:
        axes.set_ylim(top=headroom * axes.get_ylim()[1])


def legend_below(figure: Figure, entries: Iterable[Any], columns: int = 3, **look: Any) -> None:
    """A legend below all panels, each label once."""
    once = {entry.get_label(): entry for entry in reversed(list(entries))}
    figure.legend(handles=list(once.values())[::-1], ncols=columns, **BELOW, **look)


def name_of(scene: Scene) -> str:
    """An actuator by what the paper prints of it."""
    return f"t = {scene.geometry.wall_mm:g} mm, $R_i$ = {scene.geometry.root_radius_mm:g} mm"


def silicone_of(scene: Scene) -> str:
    """The paper's silicone that a scene's law stands for."""
    return SILICONES["dragon-skin-10" if scene.material.law == "yeoh" else "dragon-skin-30"]
