"""Rows of a bellows: closed form, axisymmetric and 3D results, the paper's printed values, each beside a reference."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from analytical.bellows import paper
from studies.planning.error_model import AROUND, cells_of
from studies.planning.levels import LIMIT, MODELS, body_level
from studies.results.closed_form_rows import closed_form_values, printed_elongation, thrust_rows
from studies.results.rows import REACHED, Row, row
from studies.results.runs import (
    MERIDIAN_ORDERS,
    Run,
    of_model,
    state_rows,
    tip_at,
    tip_convergence,
    value_status,
)
from studies.results.uncertainty import SAFETY, SAFETY_IN_DOUBT, UNKNOWN, Convergence
from studies.scene.bellows import BellowsScene, TipQuantity, in_hexahedra
from studies.scene.elements import USUAL_ELEMENTS, locks

UNITS: dict[TipQuantity, str] = {"tip_mm": "mm", "tip_force_n": "N"}
CHECKS = {
    "unstable_modes": "1",
    "min_det_f": "1",
    "largest_stretch": "1",
    "bond_slip_rms_mm": "mm",
    "tip_centre_mm": "mm",
    "whole_residual": "1",
}


def bellows_rows(scene: BellowsScene, runs: Sequence[Run]) -> list[Row]:
    """All rows of a scene.

    Parameters
    ----------
    runs
        Of all models, those of each coarsest first.

    Returns
    -------
    list of Row
        Meshes coarsest first, then what they lead to (`LIMIT`), where that is known better than the finest mesh's
        value. Errors are against the last row of full 3D if its finest mesh reached the pressure, else against that of
        the axisymmetric model.
    """
    rows = []
    for pressure in scene.load.pressure_kpa:
        for quantity in dict.fromkeys(("tip_mm", scene.main_quantity)):
            rows += _rows_at(scene, quantity, pressure, runs)
        for model in ("axisymmetric", "sector", "full3d"):
            for run in of_model(runs, model)[-1:]:
                rows += state_rows(scene.name, run, pressure, CHECKS)
    for run in of_model(runs, "axisymmetric")[-1:]:
        rows += _mass_rows(scene, run)
    return rows


def _mass_rows(scene: BellowsScene, run: Run) -> list[Row]:
    """Masses from the mesh; reference: the paper's mass of "the actuator", printed once for all four."""
    name, level, summary = scene.name, run.summary.level, run.summary
    printed, source = (paper.PRINTED_MASS_G, paper.SOURCE) if printed_elongation(scene) else (math.nan, "")
    silicone = row(
        name, "silicone_g", "g", math.nan, "axisymmetric", summary.silicone_g, level, reference=printed, source=source
    )
    return [silicone, row(name, "ring_g", "g", math.nan, "axisymmetric", summary.ring_g, level)]


def _rows_at(scene: BellowsScene, quantity: TipQuantity, pressure: float, runs: Sequence[Run]) -> list[Row]:
    """Rows of what is requested of the tip at one pressure, kPa."""
    rows: list[Row] = []
    axisymmetric, bodies = of_model(runs, "axisymmetric"), [*of_model(runs, "sector"), *of_model(runs, "full3d")]
    meridian = UNKNOWN
    if not locks(scene.mesh):
        meridian = tip_convergence(axisymmetric, pressure, MERIDIAN_ORDERS, quantity)
    tips = [_tip_on(run, scene, axisymmetric, meridian, pressure, quantity) for run in (*axisymmetric, *bodies)]
    best = {tip.run.summary.model: tip for tip in tips}  # the finest of each model
    best = {model: tip for model, tip in best.items() if not math.isnan(tip.value)}
    extrapolates = quantity == scene.main_quantity and scene.mesh.element in USUAL_ELEMENTS
    if extrapolates and math.isfinite(meridian.of_limit):
        best |= {model: _at_limit(tip, meridian) for model, tip in best.items() if not math.isnan(tip.of_meridian)}
        tips += [tip for tip in best.values() if tip.level == LIMIT]
    flat, solid = best.get("axisymmetric"), best.get("full3d")
    against = solid or flat

    def add(model: str, value: float, level: str = "", uncertainty: float = math.nan, status: str = REACHED) -> None:
        source = "" if against is None else f"{against.run.summary.model} {against.level}"
        by = (math.nan, "") if against is None or f"{model} {level}" == source else (against.value, source)
        unit = UNITS[quantity]
        rows.append(row(scene.name, quantity, unit, pressure, model, value, level, uncertainty, *by, status))

    if quantity == scene.main_quantity:
        for model, value, status in closed_form_values(scene, pressure):
            add(model, value, status=status)
    for tip in sorted(tips, key=lambda tip: MODELS.index(tip.run.summary.model)):
        add(tip.run.summary.model, tip.value, tip.level, tip.uncertainty, value_status(tip.run, pressure, tip.value))
    printed = printed_elongation(scene)
    if printed is not None and math.isclose(pressure, paper.PRINTED_PRESSURE_KPA):
        add("paper_closed_form", 10.0 * printed.closed_form_cm)
        add("paper_ansys", 10.0 * printed.ansys_cm)
        add("paper_experiment", 10.0 * printed.experiment_cm)
    if scene.compare is not None:
        measured = scene.compare.measured(quantity, pressure)
        if measured:
            spread = 0.5 * (max(measured) - min(measured)) if len(measured) > 1 else math.nan
            add("measured", sum(measured) / len(measured), uncertainty=spread)
    if quantity == scene.main_quantity and solid and solid.value and flat:
        gap = 100.0 * abs(flat.value - solid.value) / abs(solid.value)
        rows.append(row(scene.name, "axisymmetric_full3d_gap_percent", "%", pressure, "axisymmetric", gap, flat.level))
    if quantity == "tip_force_n":
        rows += thrust_rows(scene, pressure)
    return rows


@dataclass(frozen=True)
class _Tip:
    """The tip of a run on its mesh, or with the meridian's limit in it.

    Attributes
    ----------
    of_meridian
        Tip of the axisymmetric run on the same meridian.
    around
        Error that the cells round the circumference leave.
    """

    run: Run
    level: str
    value: float
    uncertainty: float
    of_meridian: float
    around: float


def _tip_on(
    run: Run,
    scene: BellowsScene,
    axisymmetric: Sequence[Run],
    meridian: Convergence,
    pressure: float,
    quantity: TipQuantity,
) -> _Tip:
    """A run's tip: its uncertainty is the meridian's part and that of the cells round."""
    value = tip_at(run, pressure, quantity)
    base, around = value, 0.0
    if run.summary.model != "axisymmetric":
        base = tip_at(_on_meridian(run, axisymmetric), pressure, quantity)
        around = _error_around(scene, run, value, base)
    return _Tip(run, run.summary.level, value, meridian.uncertainty(base) + around, base, around)


def _at_limit(tip: _Tip, meridian: Convergence) -> _Tip:
    """The same with what the meridian lacks added; the cells round leave what they leave."""
    value = tip.value + (meridian.limit - tip.of_meridian)
    return replace(tip, level=LIMIT, value=value, uncertainty=meridian.of_limit + tip.around)


def _on_meridian(run: Run, axisymmetric: Sequence[Run]) -> Run | None:
    """The axisymmetric run on the meridian that a body is made from."""
    level = f"r{body_level(run.summary.level).meridian}"
    return next((r for r in axisymmetric if r.summary.level == level), None)


def _error_around(scene: BellowsScene, run: Run, tip: float, base: float) -> float:
    """What the cells round the circumference leave of error in a body's tip.

    With more of them the tip of hexahedra tends to the axisymmetric one on their meridian, so that the difference is
    the error (docs/decisions.md, "Uncertainty"); tetrahedra are another mesh of the meridian, too, and it counts twice.
    With a core off the axis there is no such limit, and it is three times what the error model expects of as many
    cells, a factor that it is held to.
    """
    if scene.geometry.eccentricity:
        around = body_level(run.summary.level).around
        return SAFETY_IN_DOUBT * 0.01 * AROUND[cells_of(scene)].at(around) * abs(tip)
    return (SAFETY if in_hexahedra(scene) else 2.0) * abs(tip - base)
