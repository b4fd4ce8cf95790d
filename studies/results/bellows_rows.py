"""Rows of a bellows: closed form, axisymmetric and 3D results, the paper's printed values, each beside a reference."""

from __future__ import annotations

import math
from collections.abc import Sequence

from analytical.bellows import paper
from studies.planning.error_model import AROUND, cells_of
from studies.planning.levels import body_level
from studies.results.closed_form_rows import closed_form_values, printed_elongation, thrust_rows
from studies.results.rows import REACHED, Row, row
from studies.results.runs import (
    AROUND_ORDERS,
    MERIDIAN_ORDERS,
    Run,
    of_model,
    state_rows,
    tip_at,
    tip_convergence,
    value_status,
)
from studies.results.uncertainty import SAFETY_IN_DOUBT
from studies.scene.bellows import BellowsScene, TipQuantity

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
        Errors are against the finest full 3D run where it reached the pressure, else against the finest
        axisymmetric one.
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
    axisymmetric, full3d = of_model(runs, "axisymmetric"), of_model(runs, "full3d")
    bodies = [*of_model(runs, "sector"), *full3d]
    meridian = tip_convergence(axisymmetric, pressure, MERIDIAN_ORDERS, quantity)
    finest_axi, finest_3d = (tip_at(of[-1], pressure, quantity) if of else math.nan for of in (axisymmetric, full3d))
    reference, source = math.nan, ""
    if not math.isnan(finest_3d):
        reference, source = finest_3d, f"full3d {full3d[-1].summary.level}"
    elif not math.isnan(finest_axi):
        reference, source = finest_axi, f"axisymmetric {axisymmetric[-1].summary.level}"

    def add(model: str, value: float, level: str = "", uncertainty: float = math.nan, status: str = REACHED) -> None:
        of, by = (math.nan, "") if f"{model} {level}" == source else (reference, source)
        unit = UNITS[quantity]
        rows.append(row(scene.name, quantity, unit, pressure, model, value, level, uncertainty, of, by, status))

    if quantity == scene.main_quantity:
        for model, value, status in closed_form_values(scene, pressure):
            add(model, value, status=status)
    for run in axisymmetric:
        value = tip_at(run, pressure, quantity)
        add("axisymmetric", value, run.summary.level, meridian.uncertainty(value), value_status(run, pressure, value))
    for run in bodies:
        value = tip_at(run, pressure, quantity)
        base = tip_at(_on_meridian(run, axisymmetric), pressure, quantity)
        spread = meridian.uncertainty(base) + _error_around(scene, run, bodies, base, pressure, quantity)
        add(run.summary.model, value, run.summary.level, spread, value_status(run, pressure, value))
    printed = printed_elongation(scene)
    if printed is not None and math.isclose(pressure, paper.PRINTED_PRESSURE_KPA):
        add("paper_closed_form", 10.0 * printed.closed_form_cm)
        add("paper_ansys", 10.0 * printed.ansys_cm)
        add("paper_experiment", 10.0 * printed.experiment_cm)
    if quantity == scene.main_quantity and finest_3d and not math.isnan(finest_3d) and not math.isnan(finest_axi):
        gap, level = 100.0 * abs(finest_axi - finest_3d) / abs(finest_3d), axisymmetric[-1].summary.level
        rows.append(row(scene.name, "axisymmetric_full3d_gap_percent", "%", pressure, "axisymmetric", gap, level))
    if quantity == "tip_force_n":
        rows += thrust_rows(scene, pressure)
    return rows


def _on_meridian(run: Run, axisymmetric: Sequence[Run]) -> Run | None:
    """The axisymmetric run on the meridian that a body is made from."""
    level = f"r{body_level(run.summary.level).meridian}"
    return next((r for r in axisymmetric if r.summary.level == level), None)


def _error_around(
    scene: BellowsScene, run: Run, bodies: Sequence[Run], base: float, pressure: float, quantity: TipQuantity
) -> float:
    """What the cells round the circumference leave of error in a body's tip.

    From three numbers of cells round on one meridian, of which one is the body's own; it hardly depends on the
    meridian, and a sector's tip is that of the whole with as many. Else twice the difference to the axisymmetric tip on
    the body's meridian, to which more cells round would lead; with a core off the axis they would not, and it is three
    times what the error model expects of as many cells, a factor that it is held to.
    """
    level = body_level(run.summary.level)
    for meridian in dict.fromkeys([level.meridian, *(body_level(r.summary.level).meridian for r in bodies)]):
        alike = {}
        for body in [
            *bodies,
            *(r for r in bodies if r.summary.model == run.summary.model),
        ]:  # of its own model if it can
            at = body_level(body.summary.level)
            if at.meridian == meridian:
                alike[at.around] = body
        if len(alike) >= 3 and level.around in alike:
            found = tip_convergence(list(alike.values()), pressure, AROUND_ORDERS, quantity)
            return found.uncertainty(tip_at(alike[level.around], pressure, quantity))
    tip = tip_at(run, pressure, quantity)
    if scene.geometry.eccentricity:
        return SAFETY_IN_DOUBT * 0.01 * AROUND[cells_of(scene)].at(level.around) * abs(tip)
    return 2.0 * abs(tip - base)
