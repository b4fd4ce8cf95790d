"""Curves of a case of the paper study: finite-element paths, chains of the closed form, full 3D answers, the print."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Final

import numpy as np

from studies.paper.errors import PRINTED
from studies.paper.results import CaseResult
from studies.report.curves import Curve, Points, smooth
from studies.report.labels import TIP, model_label
from studies.report.numbers import rounded_up
from studies.results.closed_form_rows import closed_form_curve
from studies.results.rows import REACHED, Row
from studies.results.runs import Run, followed

# A curve that no legend names.
UNNAMED: Final = "_"
# Points of a chain's curve: its kink at full unfolding is at most a twentieth of a kilopascal wide.
CHAIN_POINTS: Final = 401
# The paper prints centimetres with one decimal.
PRINT_ROUNDING_MM: Final = 0.5
# Printed numbers stand side by side, beside their pressure, as one would cover another: the first and the step, kPa.
_BESIDE_KPA: Final = (0.45, 0.55)


# --- finite elements ------------------------------------------------------------------------


def path_curves(
    case: CaseResult, label: str, look: Mapping[str, Any], stopped: Callable[[Run], str] = lambda run: UNNAMED
) -> list[Curve]:
    """Elongation along the finest axisymmetric path that was followed, from rest on; with a cross where it stopped."""
    found = []
    for run in followed(case.axisymmetric):
        points = smooth(from_rest((state.pressure_kpa, state.tip_mm) for state in run.path))
        why = "" if run.summary.status == REACHED else stopped(run)
        found.append(curve("axisymmetric", label, points, look, why))
    return found


def requested_curve(run: Run, quantity: str, look: Mapping[str, Any]) -> Curve:
    """Dots at the requested states of a path."""
    points = [(state.pressure_kpa, getattr(state, quantity)) for state in run.path if state.status == "requested"]
    return curve("axisymmetric", UNNAMED, points, {"linestyle": "none", **look}, markers=True)


def body_curves(case: CaseResult, label: str, look: Mapping[str, Any]) -> list[Curve]:
    """The finest full 3D answers with their uncertainties."""
    rows = series(case.rows, TIP, "full3d")
    if not rows:
        return []
    pressures, tips, doubts = zip(*((r.pressure_kpa, r.value, r.uncertainty) for r in rows), strict=True)
    bars = doubts if np.isfinite(doubts).any() else ()
    return [Curve("full3d", label, pressures, tips, bars, look=look)]


# --- closed form and print ------------------------------------------------------------------


def chain_curves(case: CaseResult, model: str, label: str = "", **look: Any) -> list[Curve]:
    """A chain's curve from rest to the highest requested pressure or to where it folds back; none without rows."""
    if not any(row.model == model for row in case.rows):
        return []
    pressures = chain_pressures(case)
    values = closed_form_curve(case.scene, model, pressures)
    known = int(np.argmin(np.isfinite(values))) if not np.isfinite(values).all() else len(values)
    points = from_rest(zip(pressures[:known].tolist(), values[:known].tolist(), strict=True))
    return [curve(model, label or model_label(model), points, look)]


def chain_pressures(case: CaseResult) -> Any:
    """Pressures of a chain's curve, kPa, without rest."""
    return np.linspace(0.0, max(case.pressures_kpa), CHAIN_POINTS)[1:]


def printed_curves(case: CaseResult) -> list[Curve]:
    """What the paper prints, side by side right of its pressure, each with the rounding of the print."""
    found = {model: series(case.rows, TIP, model) for model in PRINTED}
    first, step = _BESIDE_KPA
    return [
        Curve(
            model,
            f"{model_label(model)} (± {PRINT_ROUNDING_MM:g} mm)",
            (rows[-1].pressure_kpa + first + step * place,),
            (rows[-1].value,),
            (PRINT_ROUNDING_MM,),
        )
        for place, (model, rows) in enumerate(found.items())
        if rows
    ]


# --- both -----------------------------------------------------------------------------------


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


def from_rest(points: Iterable[tuple[float, float]], at_rest: float = 0.0) -> Points:
    """Points (kPa and a value) with that at rest before them, if it is not there."""
    found = list(points)
    return found if found and found[0][0] == 0.0 else [(0.0, at_rest), *found]


def at_most(rows: Iterable[Row]) -> str:
    """The largest uncertainty of some rows for a legend, rounded up; empty if none is known."""
    largest = max((row.uncertainty for row in rows if math.isfinite(row.uncertainty)), default=0.0)
    return f" (± {rounded_up(largest, 2):g} mm at most)" if largest else ""


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
