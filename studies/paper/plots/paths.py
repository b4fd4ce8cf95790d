"""What the plots look up: runs and rows of a case, curves of its models, and what a case is called."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from itertools import takewhile
from typing import Final

from studies.closed_form.chains import SILICONES
from studies.paper.results import CaseResult
from studies.report.curves import Curve
from studies.report.labels import TIP, model_label
from studies.results.files import PathRow
from studies.results.rows import FOLDED_BACK, Row
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene

_PRINTED: Final = ("paper_closed_form", "paper_ansys", "paper_experiment")


def by_base(cases: Iterable[CaseResult]) -> dict[str, CaseResult]:
    """Cases by the actuator they are of."""
    return {case.case.base: case for case in cases}


def series_of(rows: Iterable[Row], quantity: str, model: str) -> list[Row]:
    """Rows of a quantity and model that were reached, one per pressure, ascending; of the finest level, the last."""
    found = {row.pressure_kpa: row for row in rows if row.quantity == quantity and row.model == model}
    return [found[pressure] for pressure in sorted(found) if math.isfinite(found[pressure].value)]


def requested_kpa(cases: Iterable[CaseResult]) -> list[float]:
    """All pressures that any of the cases asks for, kPa, ascending."""
    return sorted({pressure for case in cases for pressure in case.result.scene.load.pressure_kpa})


def finest_run(case: CaseResult) -> Run | None:
    """Finest axisymmetric run of a case; None if it has none."""
    return case.result.axisymmetric[-1] if case.result.axisymmetric else None


def tip_of(state: PathRow) -> float:
    """Elongation at the tip in a state, mm."""
    return state.tip_mm


def force_of(state: PathRow) -> float:
    """Force at the blocked tip in a state, N."""
    return state.tip_force_n


def path_of(run: Run, value: Callable[[PathRow], float]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Pressures (kPa) and values of a path from rest, in its order."""
    points = from_rest([(state.pressure_kpa, value(state)) for state in run.path], 0.0)
    return tuple(pressure for pressure, _ in points), tuple(number for _, number in points)


def from_rest(points: list[tuple[float, float]], at_rest: float) -> list[tuple[float, float]]:
    """Points that begin at rest, as given or with that point added."""
    return points if points and points[0][0] == 0.0 else [(0.0, at_rest), *points]


def chain_curve(rows: Iterable[Row], model: str, quantity: str = TIP) -> Curve | None:
    """A chain's curve from rest, up to where it folds back; None if it has no other point."""
    kept = takewhile(lambda row: row.status != FOLDED_BACK, series_of(rows, quantity, model))
    points = [(row.pressure_kpa, row.value) for row in kept]
    if not points:
        return None
    pressures, values = zip(*from_rest(points, 0.0), strict=True)
    label = model_label(model) + (", to its fold-back" if model == "closed_form_printed" else "")
    return Curve(model, label, pressures, values)


def printed_curves(rows: Iterable[Row]) -> list[Curve]:
    """What the paper prints of an actuator."""
    rows = list(rows)
    found = {model: series_of(rows, TIP, model) for model in _PRINTED}
    return [Curve(model, model_label(model), (r[-1].pressure_kpa,), (r[-1].value,)) for model, r in found.items() if r]


def ending_of(run: Run) -> str:
    """Where a path ended, the kind of reason if it did not reach what was asked, and where it lost its stability."""
    last = run.path[-1].pressure_kpa if run.path else 0.0
    crossing = run.summary.crossing
    where = ""
    if crossing:
        digits = 1 if crossing["within_kpa"] >= 0.1 else 2
        where = f" at {crossing['pressure_kpa']:.{digits}f} ± {crossing['within_kpa']:.{digits}f} kPa"
    if run.summary.status == "reached":
        return f"reaches {last:g} kPa" + (f" ({crossing['kind']}{where})" if crossing else "")
    return f"stops at {last:.1f} kPa ({run.summary.cause or 'no cause given'}{where})"


def name_of(scene: BellowsScene) -> str:
    """An actuator by its wall and root radius."""
    return f"t = {scene.geometry.wall_mm:g} mm, $R_i$ = {scene.geometry.root_radius_mm:g} mm"


def silicone_of(scene: BellowsScene) -> str:
    """The paper's silicone that a scene's law stands for."""
    return SILICONES["dragon-skin-10" if scene.material.law == "yeoh" else "dragon-skin-30"]
