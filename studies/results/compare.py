"""Comparison rows of a scene: closed form, axisymmetric and full 3D results, the paper's printed values."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from analytical import paper
from analytical.bellows import BellowsDimensions, BellowsError, with_seat
from analytical.bellows_loads import held_tip
from analytical.chains import ClosedFormPath, closed_form, closed_form_balanced, closed_form_printed
from analytical.materials import Law
from studies.models.run_log import Run
from studies.planning.error_model import AROUND, cells_of
from studies.planning.levels import body_level, fineness
from studies.results.rows import FOLDED_BACK, REACHED, Row, row
from studies.results.uncertainty import SAFETY_IN_DOUBT, UNKNOWN, Convergence, convergence, from_two
from studies.scene.bellows import BellowsScene, dimensions_of
from studies.scene.materials import law_of

# Order to expect of the tip displacement. In the meridian, quadratic elements would give more than 2 for a smooth
# solution, but the clamped edge and the ends of the bond are corners. Round the circumference all is smooth.
MERIDIAN_ORDER, AROUND_ORDER = 2.0, 4.0


Chain = Callable[[BellowsDimensions, Law, float], ClosedFormPath]
# What is asked of a tip, and its unit.
TipQuantity = Literal["tip_mm", "tip_force_n"]
UNITS: dict[TipQuantity, str] = {"tip_mm": "mm", "tip_force_n": "N"}


def main_quantity(scene: BellowsScene) -> TipQuantity:
    """What the finite elements have to find: the force at a blocked tip, else its elongation."""
    return "tip_force_n" if scene.blocked else "tip_mm"


def tip_at(run: Run | None, pressure_kpa: float, quantity: TipQuantity = "tip_mm") -> float:
    """Elongation, mm, or force, N, at the tip of a run at a requested pressure; NaN if it was not reached."""
    for entry in run.path if run is not None else ():
        if entry.status == "requested" and math.isclose(entry.pressure_kpa, pressure_kpa, rel_tol=1e-9):
            return entry.tip_mm if quantity == "tip_mm" else entry.tip_force_n
    return math.nan


def tip_convergence(
    runs: Sequence[Run], pressure_kpa: float, nominal_order: float, quantity: TipQuantity = "tip_mm"
) -> Convergence:
    """Convergence of the tip over the finest levels (three, or two) that reached a pressure.

    Two meshes may agree by accident where their tips cross on the way: of two, the uncertainty at a pressure is at
    least their largest relative difference over all pressures that both reached.
    """
    found = run_convergence(runs, [tip_at(run, pressure_kpa, quantity) for run in runs], nominal_order)
    reached = [run for run in runs if not math.isnan(tip_at(run, pressure_kpa, quantity))]
    if len(reached) != 2:
        return found
    differences = []
    for entry in reached[0].path:
        one, other = (tip_at(run, entry.pressure_kpa, quantity) for run in reached)
        if other and not math.isnan(one - other):
            differences.append(abs((one - other) / other))
    return replace(found, least=max(differences, default=0.0) * abs(tip_at(reached[-1], pressure_kpa, quantity)))


def run_convergence(runs: Sequence[Run], values: Sequence[float], nominal_order: float) -> Convergence:
    """Convergence of a quantity, one value per run, over the finest levels (three, or two) where it is not NaN."""
    found = [(1.0 / fineness(run.summary.level), value) for run, value in zip(runs, values, strict=True)]
    found = sorted((f for f in found if not math.isnan(f[1])), reverse=True)[-3:]
    sizes, values = [h for h, _ in found], [v for _, v in found]
    if len(found) == 3:
        return convergence(sizes, values, nominal_order)
    return from_two(sizes, values, nominal_order) if len(found) == 2 else UNKNOWN


def scene_rows(
    scene: BellowsScene, axisymmetric: Sequence[Run], sector: Sequence[Run] = (), full3d: Sequence[Run] = ()
) -> list[Row]:
    """All rows of a scene.

    Parameters
    ----------
    axisymmetric, sector, full3d
        Its runs, coarsest first.

    Returns
    -------
    list of Row
        Errors are against the finest full 3D run where it reached the pressure, else against the finest
        axisymmetric one.
    """
    quantities = dict.fromkeys(("tip_mm", main_quantity(scene)))
    rows = []
    for pressure in scene.load.pressure_kpa:
        for quantity in quantities:
            rows += _rows_at(scene, quantity, pressure, axisymmetric, sector, full3d)
        for run in [*axisymmetric[-1:], *sector[-1:], *full3d[-1:]]:
            rows += _checks(scene, run, pressure)
    for run in axisymmetric[-1:]:
        # Reference: the paper's mass of "the actuator", printed once for all four.
        mass, printed = run.summary.silicone_g, paper.PRINTED_MASS_G if _printed(scene) else math.nan
        source = paper.SOURCE if _printed(scene) else ""
        rows.append(row(scene.name, "silicone_g", "g", math.nan, "axisymmetric", mass, run.summary.level,
                        reference=printed, source=source))  # fmt: skip
        rows.append(row(scene.name, "ring_g", "g", math.nan, "axisymmetric", run.summary.ring_g, run.summary.level))
    return rows


def _rows_at(
    scene: BellowsScene,
    quantity: TipQuantity,
    pressure: float,
    axisymmetric: Sequence[Run],
    sector: Sequence[Run],
    full3d: Sequence[Run],
) -> list[Row]:
    """Rows of what is asked of the tip at one pressure, kPa."""
    rows: list[Row] = []
    printed = _printed(scene)
    meridian = tip_convergence(axisymmetric, pressure, MERIDIAN_ORDER, quantity)
    finest_axi = tip_at(axisymmetric[-1], pressure, quantity) if axisymmetric else math.nan
    finest_3d = tip_at(full3d[-1], pressure, quantity) if full3d else math.nan
    reference, source = math.nan, ""
    if not math.isnan(finest_3d):
        reference, source = finest_3d, f"full3d {full3d[-1].summary.level}"
    elif not math.isnan(finest_axi):
        reference, source = finest_axi, f"axisymmetric {axisymmetric[-1].summary.level}"

    def add(
        model: str,
        value: float,
        level: str = "",
        uncertainty: float = math.nan,
        status: str = REACHED,
    ) -> None:
        of, by = (math.nan, "") if f"{model} {level}" == source else (reference, source)
        unit = UNITS[quantity]
        rows.append(row(scene.name, quantity, unit, pressure, model, value, level, uncertainty, of, by, status))

    if quantity == main_quantity(scene):
        for model, value, status in _closed_forms(scene, pressure):
            add(model, value, status=status)
    for run in axisymmetric:
        value = tip_at(run, pressure, quantity)
        add("axisymmetric", value, run.summary.level, meridian.uncertainty(value), _status(run, value))
    for run in [*sector, *full3d]:
        value = tip_at(run, pressure, quantity)
        base = tip_at(_on_meridian(run, axisymmetric), pressure, quantity)
        error_around = _error_around(scene, run, [*sector, *full3d], base, pressure, quantity)
        add(run.summary.model, value, run.summary.level, meridian.uncertainty(base) + error_around, _status(run, value))
    if printed is not None and math.isclose(pressure, paper.PRINTED_PRESSURE_KPA):
        add("paper_closed_form", 10.0 * printed.closed_form_cm)
        add("paper_ansys", 10.0 * printed.ansys_cm)
        add("paper_experiment", 10.0 * printed.experiment_cm)
    if quantity == main_quantity(scene) and finest_3d and not math.isnan(finest_3d) and not math.isnan(finest_axi):
        gap = 100.0 * abs(finest_axi - finest_3d) / abs(finest_3d)
        rows.append(
            row(scene.name, "axisymmetric_full3d_gap_percent", "%", pressure, "axisymmetric", gap,
                axisymmetric[-1].summary.level)
        )  # fmt: skip
    if quantity == "tip_force_n":
        rows += _least_forces(scene, pressure)
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
    meridian, and a sector's tip is that of the whole with as many. Else three times the difference to the axisymmetric
    tip on the body's meridian, to which more cells round would lead; with a core off the axis they would not, and it is
    three times what the error model expects of as many cells.
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
            found = tip_convergence(list(alike.values()), pressure, AROUND_ORDER, quantity)
            return found.uncertainty(tip_at(alike[level.around], pressure, quantity))
    tip = tip_at(run, pressure, quantity)
    if scene.geometry.eccentricity:
        return SAFETY_IN_DOUBT * 0.01 * AROUND[cells_of(scene)].at(level.around) * abs(tip)
    return SAFETY_IN_DOUBT * abs(tip - base)


def _checks(scene: BellowsScene, run: Run, pressure: float) -> list[Row]:
    """Stability count, least det F, slip of the bond and displacement on the axis of a run at a pressure."""
    for entry in run.path:
        if entry.status == "requested" and math.isclose(entry.pressure_kpa, pressure, rel_tol=1e-9):
            name, level = run.summary.model, run.summary.level
            found = {
                "unstable_modes": ("1", entry.unstable_modes),
                "min_det_f": ("1", entry.min_det_f),
                "bond_slip_rms_mm": ("mm", entry.bond_slip_rms_mm),
                "tip_centre_mm": ("mm", entry.tip_centre_mm),
            }
            return [
                row(scene.name, quantity, unit, pressure, name, value, level)
                for quantity, (unit, value) in found.items()
                if not math.isnan(value)
            ]
    return []


def _status(run: Run, value: float) -> str:
    if not math.isnan(value):
        return REACHED
    last = run.path[-1].pressure_kpa if run.path else 0.0
    return f"stopped at {last:.2f} kPa: {run.summary.reason}"


def _closed_forms(scene: BellowsScene, pressure_kpa: float) -> list[tuple[str, float, str]]:
    """(model, main quantity, status) of the closed form: its chains, and the mended one with the free half pitch."""
    if scene.load.sense < 0.0:
        return []  # it has no vacuum
    nominal = dimensions_of(scene)
    variants: list[tuple[str, Chain, BellowsDimensions]] = [("closed_form", closed_form, nominal)]
    if scene.rings.model != "none":
        variants.append(("closed_form_seat", closed_form, with_seat(nominal, scene.rings.seat_mm)))
    if not scene.blocked:
        variants.append(("closed_form_printed", closed_form_printed, nominal))
        variants.append(("closed_form_balanced", closed_form_balanced, nominal))
    out = []
    for model, chain, dimensions in variants:
        try:
            value, status = _closed_form_value(scene, chain, dimensions, pressure_kpa)
            out.append((model, value, status))
        except BellowsError as error:
            out.append((model, math.nan, f"not available: {error}"))
    return out


def _closed_form_value(
    scene: BellowsScene, chain: Chain, dimensions: BellowsDimensions, pressure_kpa: float
) -> tuple[float, str]:
    """The main quantity of a scene by a chain, mm or N, and in which state the chain is if it is past the model."""
    law = law_of(scene.material)
    if scene.blocked:
        return float(held_tip(dimensions, law, pressure_kpa).tip_force_n[0]), REACHED
    if scene.load.tip_force_n:
        raise BellowsError("it has no force on its tip")
    return _elongation(chain, dimensions, law, pressure_kpa)


@functools.cache
def _elongation(chain: Chain, dimensions: BellowsDimensions, law: Law, pressure_kpa: float) -> tuple[float, str]:
    """A chain's elongation, mm, and its state; kept, for a study's variants and audits ask for the same again."""
    answer = chain(dimensions, law, pressure_kpa)
    return float(answer.elongation_mm[0]), FOLDED_BACK if answer.state[0] == "past the model" else REACHED


def _least_forces(scene: BellowsScene, pressure_kpa: float) -> list[Row]:
    """Thrust of the pressure alone by the closed form: the tip force of a wall that buckles rather than push."""
    try:
        thrust = held_tip(dimensions_of(scene), law_of(scene.material), pressure_kpa).extension_force_n
    except BellowsError:
        return []
    return [row(scene.name, "extension_force_n", "N", pressure_kpa, "closed_form", float(thrust[0]))]


def _printed(scene: BellowsScene) -> paper.PrintedElongation | None:
    if scene.blocked or scene.load.tip_force_n:
        return None  # the paper's tips are free
    g = scene.geometry
    return paper.printed(g.wall_mm, g.root_radius_mm, g.crest_radius_mm, g.half_pitch_mm, g.convolutions)


def validity_notes(scene: BellowsScene) -> list[str]:
    """What a reader must know of the closed form's and the paper's numbers for a scene."""
    dimensions, law = dimensions_of(scene), law_of(scene.material)
    notes = []
    if scene.blocked:
        notes.append(
            "The closed form's force at the tip, held at zero elongation, assumes a wall that pushes; one that buckles "
            "instead leaves the thrust of the pressure, extension_force_n."
        )
    if scene.load.tip_force_n:
        return ["The closed form has no force on its tip."]
    if scene.load.sense < 0.0:
        return ["The closed form has no vacuum."]
    answer = closed_form(dimensions, law, np.array(scene.load.pressure_kpa))
    unfolding_kpa = float(answer.unfolding_pressure_kpa[0])
    if unfolding_kpa <= scene.load.pressure_kpa[-1]:
        notes.append(
            f"The closed form is fully unfolded from {unfolding_kpa:.1f} kPa; beyond, its root "
            "stretch is held there (the paper stops at full expansion)."
        )
    else:
        notes.append(f"The closed form unfolds fully only at {unfolding_kpa:.1f} kPa, above the asked range.")
    printed = _printed(scene)
    if printed is not None:
        notes.append(f"Printed values ({printed.source}): {printed.reading}.")
        notes.append(
            "The paper prints neither R_p, e and n nor which silicone each actuator has: these are inferred from "
            "its closed-form column alone, so agreement of the closed form with that column is no validation."
        )
    return notes
