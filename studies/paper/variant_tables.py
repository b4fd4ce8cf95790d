"""Tables of the paper study's variants: unknown dimensions, convention, silicone, rings, bond, beyond, blocked tip."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from analytical.bellows.paper import PRINTED
from studies.closed_form.chains import SILICONES, STRETCH_AT_BREAK
from studies.paper.cases import RING_VARIANTS, THICK, THIN
from studies.paper.numbers import (
    HIGHEST_KPA,
    PRESSURES_KPA,
    common_levels,
    difference,
    finest,
    is_known,
    last_kpa,
    measured,
    modes,
    named,
    number,
    sets,
    slot_label,
    tip,
)
from studies.paper.results import CaseResult, PaperResults
from studies.report.labels import TIP_FORCE, run_label
from studies.report.numbers import MISSING, count, short_time, value_text
from studies.report.tables import Table
from studies.results.rows import Row, difference_percent
from studies.results.runs import Run

REFERENCE_RING: Final = "ring-pla"


# --- what is not printed --------------------------------------------------------------------


def dimension_swing(results: PaperResults) -> Table:
    """Axisymmetric elongation (mm) of each of the paper's actuators in the three inferred sets, and their range."""
    labels = [label for label, _ in sets()]
    lines = []
    for place, printed in enumerate(PRINTED):
        actuators = [actuators[place] for _, actuators in sets()]
        for pressure in PRESSURES_KPA:
            rows = [tip(named(results, actuator.name), pressure_kpa=pressure) for actuator in actuators]
            test = f"{10.0 * printed.experiment_cm:g}" if pressure == HIGHEST_KPA else MISSING
            lines.append((slot_label(actuators[0]), f"{pressure:g}", *map(value_text, rows), *_range(rows), test))
    header = ("actuator", "pressure, kPa", *(f"{label}, mm" for label in labels))
    return Table((*header, "range, mm", "range, % of the reference", "paper: experiment, mm"), tuple(lines))


def _range(rows: Sequence[Row | None]) -> tuple[str, str]:
    """Largest less smallest value, in mm and in percent of the first; a dash unless all are known."""
    values = [row.value for row in rows if row is not None and is_known(row)]
    if len(values) < len(rows):
        return MISSING, MISSING
    gap = max(values) - min(values)
    return f"{gap:.1f}", f"{100.0 * gap / values[0]:.0f}"


def conventions(results: PaperResults) -> Table:
    """Elongation (mm) at 20 kPa of the 2 mm actuators in both Ogden conventions beside ANSYS, and which is nearer."""
    lines = []
    for name in THICK:
        eq3, ansys_own = named(results, name), results.variant(name, "convention")
        first, second = tip(eq3), tip(ansys_own)
        ansys = tip(eq3, "paper_ansys")
        lines.append(
            (
                name,
                value_text(first),
                value_text(second),
                value_text(ansys),
                difference(first, ansys, 1),
                difference(second, ansys, 1),
                nearer(first, second, ansys),
            )
        )
    readings = ("2μ/α² (eq. 3)", "μ/α (eq. 20, ANSYS's own)")
    header: tuple[str, ...] = ("actuator", *(f"{reading}, mm" for reading in readings), "paper: ANSYS, mm")
    header += (*(f"{reading} less ANSYS, mm (%)" for reading in readings), "nearer to ANSYS")
    return Table(header, tuple(lines), left=(0, len(header) - 1))


def nearer(first: Row | None, second: Row | None, target: Row | None) -> str:
    """Which of two readings is nearer to a printed number, if their uncertainties and the print allow to tell."""
    if first is None or second is None or target is None or not (is_known(first) and is_known(second)):
        return MISSING
    one, other = abs(first.value - target.value), abs(second.value - target.value)
    # 0.5 mm: half of the print's last digit; it moves both distances.
    if not abs(one - other) > first.uncertainty + second.uncertainty + 2.0 * 0.5:
        return "cannot tell"
    return "2μ/α²" if one < other else "μ/α"


def silicones(results: PaperResults) -> Table:
    """Axisymmetric elongation (mm) of every reference actuator in both silicones, by pressure (kPa)."""
    lines = []
    for name in (*THIN, *THICK):
        own, other = named(results, name), results.variant(name, "silicone")
        texts = list(SILICONES.values()) if name in THIN else list(SILICONES.values())[::-1]
        for case, silicone, mark in ((own, texts[0], " (reference)"), (other, texts[1], "")):
            values = (value_text(tip(case, pressure_kpa=pressure)) for pressure in PRESSURES_KPA)
            lines.append((name, silicone + mark, *values))
    header = ("actuator", "silicone", *(f"{pressure:g} kPa, mm" for pressure in PRESSURES_KPA))
    return Table(header, tuple(lines), left=(0, 1))


def silicone_effects(results: PaperResults) -> Table:
    """Effect of the wall in one silicone and of the silicone in one wall on the elongation at 20 kPa, mm (%)."""
    lines = []
    for thin, thick in zip(THIN, THICK, strict=True):
        soft_thin, stiff_thin = tip(named(results, thin)), tip(results.variant(thin, "silicone"))
        soft_thick, stiff_thick = tip(results.variant(thick, "silicone")), tip(named(results, thick))
        lines.append(
            (
                f"{thin}, {thick}",
                difference(stiff_thick, soft_thin, 1),
                difference(soft_thick, soft_thin, 1),
                difference(stiff_thick, stiff_thin, 1),
                difference(stiff_thin, soft_thin, 1),
                difference(stiff_thick, soft_thick, 1),
            )
        )
    header: tuple[str, ...] = ("actuators", "wall 1 to 2 mm with its silicone", "wall 1 to 2 mm in Dragon Skin 10")
    header += ("wall 1 to 2 mm in Dragon Skin 30", "silicone 10 to 30 at 1 mm", "silicone 10 to 30 at 2 mm")
    return Table(header, tuple(lines))


# --- rings and tip --------------------------------------------------------------------------


def rings(results: PaperResults) -> Table:
    """Elongation (mm) at 20 kPa and cost of rigid and meshed rings; the error is that against meshed PLA."""
    lines = []
    for name in (*THIN, *THICK):
        pla = results.variant(name, "rings", REFERENCE_RING)
        for suffix, label, _ in RING_VARIANTS:
            case = results.variant(name, "rings", suffix)
            run = finest(case.result.axisymmetric) if case else None
            levels = common_levels(case, pla)[:2] if suffix != REFERENCE_RING else []
            errors = [difference(tip(case, level=level), tip(pla, level=level), 3) for level in levels]
            errors += [MISSING] * (2 - len(errors))
            lines.append(
                (
                    name,
                    label,
                    value_text(tip(case)),
                    *errors,
                    number(measured(case, "ring_hoop_stretch", "axisymmetric", HIGHEST_KPA)),
                    MISSING if run is None else count(run.summary.dofs),
                    MISSING if run is None else short_time(run.summary.time_s.get("total", math.nan)),
                    _seconds(case),
                )
            )
    header: tuple[str, ...] = ("actuator", "rings", "elongation, mm", "less meshed PLA, mm (%)")
    header += ("the same one mesh coarser, mm (%)", "hoop stretch under the ring")
    header += ("unknowns, finest mesh", "time, finest mesh, s", "time, all meshes, s")
    return Table(header, tuple(lines), left=(0, 1))


def _seconds(case: CaseResult | None) -> str:
    if case is None or not case.result.axisymmetric:
        return MISSING
    return short_time(sum(run.summary.time_s.get("total", math.nan) for run in case.result.axisymmetric))


def blocked(results: PaperResults) -> Table:
    """Force (N) at the blocked tip: closed form, thrust alone and axisymmetric, by actuator and pressure (kPa)."""
    lines = []
    for name in (*THIN, *THICK):
        case = results.variant(name, "blocked")
        for pressure in case.result.scene.load.pressure_kpa if case else ():
            held = tip(case, "closed_form", pressure, TIP_FORCE)
            thrust = tip(case, "closed_form", pressure, "extension_force_n")
            found = tip(case, "axisymmetric", pressure, TIP_FORCE)
            lines.append(
                (
                    name,
                    f"{pressure:g}",
                    value_text(held),
                    value_text(thrust),
                    value_text(found),
                    difference(held, found, 3),
                    difference(thrust, found, 3),
                    _where(found, thrust, held),
                    modes(finest(case.result.axisymmetric) if case else None, pressure),
                )
            )
    header: tuple[str, ...] = (
        "actuator",
        "pressure, kPa",
        "closed form, wall pushes",
        "closed form, thrust alone",
        "axisymmetric",
    )
    header += ("wall pushes less axisymmetric, N (%)", "thrust less axisymmetric, N (%)", "axisymmetric is")
    header += ("unstable modes",)
    return Table(header, tuple(lines), left=(0, 7))


def _where(found: Row | None, thrust: Row | None, held: Row | None) -> str:
    """Where the finite elements' force lies beside the closed form's two."""
    if found is None or thrust is None or held is None or not all(map(is_known, (found, thrust, held))):
        return MISSING
    low, high = sorted((thrust.value, held.value))
    if low <= found.value <= high:
        return "between the two"
    return "below both" if found.value < low else "above both"


# --- beyond 20 kPa --------------------------------------------------------------------------


def beyond(results: PaperResults) -> Table:
    """How far every mesh comes when asked for 30 kPa, why it ends, where it is unstable first, and what comes close."""
    lines = []
    for case in results.of("beyond"):
        for run in (*case.result.axisymmetric, *case.result.full3d):
            lines.append(
                (
                    case.case.base,
                    run_label(run.summary.model, run.summary.level),
                    f"{last_kpa(run):.4g}",
                    run.summary.reason or "all requested pressures reached",
                    unstable(run),
                    _closest(run),
                )
            )
    header = (
        "actuator",
        "model and mesh",
        "reached, kPa",
        "end",
        "unstable modes on the way",
        "smallest gap, mm (at kPa)",
    )
    return Table(header, tuple(lines), left=(0, 1, 3, 4))


def _closest(run: Run) -> str:
    """Smallest distance between folds, or of the wall to a ring beside its seat; above 0 nothing touches."""
    known = [state for state in run.path if math.isfinite(state.min_gap_mm)]
    if not known:
        return MISSING
    least = min(known, key=lambda state: state.min_gap_mm)
    return f"{least.min_gap_mm:.2f} ({least.pressure_kpa:.3g})"


def unstable(run: Run) -> str:
    """Largest number of unstable modes of a run's states and where the first was, kPa; a dash if none was counted."""
    counted = [state for state in run.path if math.isfinite(state.unstable_modes)]
    if not counted:
        return MISSING
    first = next((state for state in counted if state.unstable_modes > 0), None)
    if first is None:
        return "none"
    return f"{max(s.unstable_modes for s in counted):.0f}, first at {first.pressure_kpa:.4g} kPa"


def stretches(results: PaperResults) -> Table:
    """Largest stretch at 20 kPa and at the highest pressure beside the stretch at break (percent of it).

    Away from the edges of the bond, where it would grow with every finer mesh.
    """
    lines = []
    for actuator in sets()[0][1]:
        case = results.variant(actuator.name, "beyond")
        limit = STRETCH_AT_BREAK[actuator.silicone]
        pressures = case.result.scene.load.pressure_kpa if case else []
        rows = {p: measured(case, "peak_stretch_away", "axisymmetric", p) for p in pressures}
        known = [p for p, row in rows.items() if is_known(row)]
        at20, top = rows.get(HIGHEST_KPA), rows[known[-1]] if known else None
        lines.append(
            (
                actuator.name,
                number(at20),
                f"{known[-1]:g}" if known else MISSING,
                number(top),
                f"{limit:g} ({SILICONES[actuator.silicone]})",
                f"{difference_percent(top.value, limit) + 100.0:.0f}" if top else MISSING,
            )
        )
    header = ("actuator", f"stretch at {HIGHEST_KPA:g} kPa", "highest pressure, kPa", "stretch there")
    return Table((*header, "stretch at break", "% of it"), tuple(lines))
