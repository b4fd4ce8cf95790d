"""Tables of the paper study's variants: unknown dimensions, convention, silicone, rings, beyond, blocked tip."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final

from analytical.bellows.chains_by_name import SILICONES, STRETCH_AT_BREAK
from analytical.bellows.paper import PRINTED, PaperActuator
from studies.paper.cases import (
    HIGHEST_KPA,
    PRESSURES_KPA,
    REFERENCE,
    SETS,
    THICK,
    THIN,
    cases,
)
from studies.paper.results import (
    CaseResult,
    PaperResults,
    common_levels,
    ending,
    is_known,
    last_kpa,
    modes,
    no_row,
)
from studies.paper.setup.sizes import CALLED, called
from studies.report.labels import TIP_FORCE, run_label
from studies.report.numbers import MISSING, count, difference_text, measured_text, number_text, short_time, value_text
from studies.report.tables import Table, table_of
from studies.results.rows import Row
from studies.results.runs import Run

REFERENCE_RING: Final = "ring-pla"


# --- what is not printed --------------------------------------------------------------------


def dimension_swing(results: PaperResults) -> Table:
    """Axisymmetric elongation (mm) of each of the paper's actuators in the three inferred sets, and their range."""
    lines = []
    for printed, *actuators in zip(PRINTED, *SETS.values(), strict=True):
        for pressure in PRESSURES_KPA:
            rows = [results.named(actuator.name).tip(pressure_kpa=pressure) for actuator in actuators]
            test = f"{10.0 * printed.experiment_cm:g}" if pressure == HIGHEST_KPA else MISSING
            lines.append((_slot(actuators[0]), f"{pressure:g}", *map(value_text, rows), *_range(rows), test))
    header = ("actuator", "pressure, kPa", *(f"{label}, mm" for label in SETS))
    return Table((*header, "range, mm", "range, % of the reference", "paper: experiment, mm"), tuple(lines))


def _slot(actuator: PaperActuator) -> str:
    """Which of the paper's four actuators it is, whatever its dimensions."""
    root = "larger R_i" if actuator.printed.has_larger_root else "R_i = 5 mm"
    return f"t = {actuator.printed.wall_mm:g} mm, {root}"


def _range(rows: Sequence[Row]) -> tuple[str, str]:
    """Largest less smallest value, in mm and in percent of the first; a dash unless all are known."""
    if not all(map(is_known, rows)):
        return MISSING, MISSING
    values = [row.value for row in rows]
    gap = max(values) - min(values)
    return f"{gap:.1f}", f"{100.0 * gap / values[0]:.0f}"


def conventions(results: PaperResults) -> Table:
    """Elongation (mm) at 20 kPa of the 2 mm actuators in both Ogden conventions beside ANSYS, and which is nearer."""
    lines = []
    for name in THICK:
        eq3, eq20, ansys = readings(results, name)
        values = map(value_text, (eq3, eq20, ansys))
        gaps = (difference_text(row, ansys, 1) for row in (eq3, eq20))
        lines.append((CALLED[name], *values, *gaps, nearer(eq3, eq20, ansys)))
    labels = ("2μ/α² (eq. 3)", "μ/α (eq. 20, ANSYS's own)")
    header = ("actuator", *(f"{label}, mm" for label in labels), "paper: ANSYS, mm")
    header += (*(f"{label} less ANSYS, mm (%)" for label in labels), "nearer to ANSYS")
    return Table(header, tuple(lines), left=(0, len(header) - 1))


def readings(results: PaperResults, name: str) -> tuple[Row, Row, Row]:
    """Elongation (mm) at 20 kPa of an actuator with Ogden's mu as in eq. 3, as in eq. 20, and by the paper's ANSYS."""
    own = results.named(name)
    return own.tip(), results.variant(name, "convention").tip(), own.tip("paper_ansys")


def nearer(first: Row, second: Row, target: Row) -> str:
    """Which of two readings is nearer to a printed number, if their uncertainties and the print allow to tell."""
    if not all(map(is_known, (first, second, target))):
        return MISSING
    one, other = abs(first.value - target.value), abs(second.value - target.value)
    # 0.5 mm: half of the print's last digit; it moves both distances.
    if not abs(one - other) > first.uncertainty + second.uncertainty + 2.0 * 0.5:
        return "cannot tell"
    return "2μ/α²" if one < other else "μ/α"


def silicones(results: PaperResults) -> Table:
    """Axisymmetric elongation (mm) of every reference actuator in both silicones, by pressure (kPa)."""
    lines = []
    for actuator in REFERENCE:
        own, other = results.named(actuator.name), results.variant(actuator.name, "silicone")
        (another,) = (name for silicone, name in SILICONES.items() if silicone != actuator.silicone)
        for case, label in ((own, f"{SILICONES[actuator.silicone]} (reference)"), (other, another)):
            values = (value_text(case.tip(pressure_kpa=pressure)) for pressure in PRESSURES_KPA)
            lines.append((called(actuator), label, *values))
    header = ("actuator", "silicone", *(f"{pressure:g} kPa, mm" for pressure in PRESSURES_KPA))
    return Table(header, tuple(lines), left=(0, 1))


def silicone_effects(results: PaperResults) -> Table:
    """Effect of the wall in one silicone and of the silicone in one wall on the elongation at 20 kPa, mm (%)."""
    lines = []
    for thin, thick in zip(THIN, THICK, strict=True):
        soft_thin, stiff_thin = results.named(thin).tip(), results.variant(thin, "silicone").tip()
        stiff_thick, soft_thick = results.named(thick).tip(), results.variant(thick, "silicone").tip()
        effects = {
            "wall 1 to 2 mm with its silicone": (stiff_thick, soft_thin),
            "wall 1 to 2 mm in Dragon Skin 10": (soft_thick, soft_thin),
            "wall 1 to 2 mm in Dragon Skin 30": (stiff_thick, stiff_thin),
            "silicone 10 to 30 at 1 mm": (stiff_thin, soft_thin),
            "silicone 10 to 30 at 2 mm": (stiff_thick, soft_thick),
        }
        lines.append((f"{CALLED[thin]}; {CALLED[thick]}", *(difference_text(*pair, 1) for pair in effects.values())))
    return Table(("actuators", *effects), tuple(lines))


# --- rings and tip --------------------------------------------------------------------------


def rings(results: PaperResults) -> Table:
    """Elongation (mm) at 20 kPa and cost of rigid and meshed rings; the error is that against meshed PLA."""
    columns: dict[str, Callable[[CaseResult], str]] = {
        "actuator": lambda case: CALLED[case.case.base],
        "rings": lambda case: case.case.label,
        "elongation, mm": lambda case: value_text(case.tip()),
        "less meshed PLA, mm (%)": lambda case: _ring_error(results, case, 0),
        "the same one mesh coarser, mm (%)": lambda case: _ring_error(results, case, 1),
        "hoop stretch under the ring": lambda case: measured_text(case.row("ring_hoop_stretch")),
        "unknowns, finest mesh": lambda case: count(case.axisymmetric[-1].summary.dofs) if case.runs else MISSING,
        "time, finest mesh, s": lambda case: _seconds(case.axisymmetric[-1:]),
        "time, all meshes, s": lambda case: _seconds(case.axisymmetric),
    }
    return table_of(map(results.result_of, cases("rings")), columns, left=(0, 1))


def _ring_error(results: PaperResults, case: CaseResult, place: int) -> str:
    """Elongation less that with meshed PLA, mm (%), on the finest mesh that both have, or so many meshes coarser."""
    pla = results.variant(case.case.base, "rings", REFERENCE_RING)
    levels = [] if case == pla else common_levels(case, pla)
    if place >= len(levels):
        return MISSING
    return difference_text(case.tip(level=levels[place]), pla.tip(level=levels[place]), 3)


def _seconds(runs: Sequence[Run]) -> str:
    """Wall time of some runs, s."""
    return short_time(sum(run.summary.time_s["total"] for run in runs)) if runs else MISSING


def blocked(results: PaperResults) -> Table:
    """Force (N) at the blocked tip: closed form, thrust alone and axisymmetric, by actuator and pressure (kPa)."""
    lines = []
    for case in results.of("blocked"):
        for pressure in case.pressures_kpa:
            held, found = (case.row(TIP_FORCE, model, pressure) for model in ("closed_form", "axisymmetric"))
            thrust = case.row("extension_force_n", "closed_form", pressure)
            lines.append(
                (
                    CALLED[case.case.base],
                    f"{pressure:g}",
                    *map(_newtons, (held, thrust, found)),
                    difference_text(held, found, 3),
                    difference_text(thrust, found, 3),
                    _where(found.value, thrust.value, held.value),
                    modes(case.axisymmetric, pressure),
                )
            )
    header = (
        "actuator",
        "pressure, kPa",
        "closed form, wall pushes, N",
        "closed form, thrust alone, N",
        "axisymmetric, N",
        "wall pushes less axisymmetric, N (%)",
        "thrust less axisymmetric, N (%)",
        "axisymmetric is",
        "unstable modes",
    )
    return Table(header, tuple(lines), left=(0, 7))


def _newtons(row: Row) -> str:
    """A force without its unit, which the header has."""
    return value_text(row).replace(" N", "")


def _where(found: float, *two: float) -> str:
    """Where the finite elements' force lies beside the closed form's two."""
    if not all(map(math.isfinite, (found, *two))):
        return MISSING
    if min(two) <= found <= max(two):
        return "between the two"
    return "below both" if found < min(two) else "above both"


# --- beyond 20 kPa --------------------------------------------------------------------------


def beyond(results: PaperResults) -> Table:
    """How far every mesh comes when asked for 30 kPa, why it ends, where it is unstable first, and what comes close."""
    records = [(CALLED[case.case.base], run) for case in results.of("beyond") for run in case.runs]
    columns: dict[str, Callable[[tuple[str, Run]], str]] = {
        "actuator": lambda r: r[0],
        "model and mesh": lambda r: run_label(r[1].summary.model, r[1].summary.level),
        "reached, kPa": lambda r: f"{last_kpa(r[1]):.4g}",
        "end": lambda r: ending(r[1]),
        "unstable modes on the way": lambda r: unstable(r[1]),
        "smallest gap, mm (at kPa)": lambda r: _closest(r[1]),
    }
    return table_of(records, columns, left=(0, 1, 3, 4))


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
    for actuator in REFERENCE:
        case, limit = results.variant(actuator.name, "beyond"), STRETCH_AT_BREAK[actuator.silicone]
        known = [row for p in case.pressures_kpa if is_known(row := case.row("peak_stretch_away", pressure_kpa=p))]
        top = known[-1] if known else no_row()
        lines.append(
            (
                called(actuator),
                measured_text(case.row("peak_stretch_away")),
                number_text(top.pressure_kpa, "g"),
                measured_text(top),
                f"{limit:g} ({SILICONES[actuator.silicone]})",
                number_text(100.0 * top.value / limit, ".0f"),
            )
        )
    header = ("actuator", f"stretch at {HIGHEST_KPA:g} kPa", "highest pressure, kPa", "stretch there")
    return Table((*header, "stretch at break", "% of it"), tuple(lines))
