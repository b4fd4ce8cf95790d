"""What the paper says its actuators and its simulation do, each held against the rows.

A difference that is not larger than the sum of the uncertainties decides nothing. Since the dimensions are inferred, a
claim about them is judged in every set: where the sets contradict each other, nobody can tell for the real actuators.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

from analytical.bellows.paper import PRINTED, PaperActuator
from studies.paper.cases import REFERENCE_SCENES, THICK, THIN
from studies.paper.numbers import (
    HIGHEST_KPA,
    PRESSURES_KPA,
    asked_state,
    finest,
    is_known,
    last_kpa,
    limit_kpa,
    named,
    sets,
    tip,
    unfolding,
)
from studies.paper.results import CaseResult, PaperResults
from studies.paper.verdicts import FAILS, HOLDS, UNDECIDED, Verdict, above, all_of, below, over_sets, smaller
from studies.report.labels import TIP, level_label
from studies.report.numbers import value_text
from studies.results.rows import Row
from studies.results.runs import Run

# Ours: two secants of a curve that differ by less than this still look like one straight line.
STRAIGHT_PERCENT: Final = 10.0
# Printed: largest gaps of simulation and of model to the test, cm; every printed length is good to 0.05 cm.
SIMULATION_GAP_CM, MODEL_GAP_CM, PRINT_CM = 2.6, 2.0, 0.05


@dataclass(frozen=True)
class Claim:
    """A claim of the paper in our words, what the rows say of it, and the verdict."""

    text: str
    finding: str
    verdict: Verdict


def claims(results: PaperResults) -> tuple[Claim, ...]:
    """All claims, in the order of the report."""
    return (
        larger_root_shortens(results),
        larger_root_bulges(results),
        thicker_wall_shortens(results),
        thicker_wall_shortens_alike(results),
        rises_with_pressure(results),
        bends_first(results),
        straight_last(results),
        *(unfolded_at_highest(results, name) for name in REFERENCE_SCENES),
        longest_at_highest(results),
        cost_rises(results, "axisymmetric"),
        cost_rises(results, "full3d"),
        none_beyond(results),
        simulation_gap(results),
        model_gap(results),
    )


# --- dimensions -----------------------------------------------------------------------------


def larger_root_shortens(results: PaperResults) -> Claim:
    """Elongation of the two actuators of each wall thickness."""
    text = "The larger root radius elongates less, at either wall thickness and at every pressure."
    return _by_sets(results, text, TIP, "mm", ((1, 0), (3, 2)), PRESSURES_KPA)


def larger_root_bulges(results: PaperResults) -> Claim:
    """Bulge of the roots of the two actuators of each wall thickness."""
    text = "The larger root radius bulges more at the root, at the same pressure."
    return _by_sets(results, text, "root_bulge_mm", "mm", ((0, 1), (2, 3)), PRESSURES_KPA)


def thicker_wall_shortens(results: PaperResults) -> Claim:
    """Elongation of the two actuators of each root radius."""
    text = "The thicker wall elongates less, at either root radius and every pressure (as built: silicones may differ)."
    return _by_sets(results, text, TIP, "mm", ((2, 0), (3, 1)), PRESSURES_KPA)


def thicker_wall_shortens_alike(results: PaperResults) -> Claim:
    """Elongation of both wall thicknesses in one silicone, reference dimensions."""
    verdicts, parts = [], []
    for thin, thick in zip(THIN, THICK, strict=True):
        pairs = {
            "Dragon Skin 10": (results.variant(thin, "core"), results.variant(thick, "silicone", "in-10")),
            "Dragon Skin 30": (results.variant(thin, "silicone", "in-30"), results.variant(thick, "core")),
        }
        for silicone, (soft, stiff) in pairs.items():
            verdicts += [smaller(tip(stiff, pressure_kpa=p), tip(soft, pressure_kpa=p)) for p in PRESSURES_KPA]
            parts.append(f"{thin} {value_text(tip(soft))} mm, {thick} {value_text(tip(stiff))} mm, both in {silicone}")
    text = "The thicker wall elongates less when both are of one silicone."
    return Claim(text, f"At {HIGHEST_KPA:g} kPa: {'; '.join(parts)}.", all_of(verdicts))


def _by_sets(
    results: PaperResults,
    text: str,
    quantity: str,
    unit: str,
    pairs: Sequence[tuple[int, int]],
    pressures_kpa: Sequence[float],
) -> Claim:
    """That of each pair of a set's actuators the first has the smaller value, at all pressures (kPa)."""
    verdicts, parts = [], []
    for label, actuators in sets():
        found: list[Verdict] = []
        numbers, against = [], []
        for low, high in ((actuators[a], actuators[b]) for a, b in pairs):
            one, other = named(results, low.name), named(results, high.name)
            for pressure in pressures_kpa:
                found.append(smaller(_row(one, quantity, pressure), _row(other, quantity, pressure)))
                if found[-1] == FAILS:
                    against.append(f"{low.name} at {pressure:g} kPa")
            numbers.append(_pair(low, one, quantity, unit) + ", " + _pair(high, other, quantity, unit))
        verdicts.append(all_of(found))
        if not any(is_known(_row(named(results, a.name), quantity, HIGHEST_KPA)) for a in actuators):
            parts.append(f"{label}: no numbers")
            continue
        contrary = f" (the other way round: {', '.join(against)})" if against else ""
        parts.append(f"{label} {verdicts[-1]}{contrary}: {'; '.join(numbers)}")
    return Claim(text, f"At {HIGHEST_KPA:g} kPa, {'. '.join(parts)}.", over_sets(verdicts))


def _row(case: CaseResult | None, quantity: str, pressure_kpa: float) -> Row | None:
    return tip(case, "axisymmetric", pressure_kpa, quantity)


def _pair(actuator: PaperActuator, case: CaseResult | None, quantity: str, unit: str) -> str:
    return f"{actuator.name} {value_text(_row(case, quantity, HIGHEST_KPA))} {unit}"


# --- the curve ------------------------------------------------------------------------------


def rises_with_pressure(results: PaperResults) -> Claim:
    """That the elongation of every actuator grows from one requested pressure to the next."""
    verdicts, parts = [], []
    for name in REFERENCE_SCENES:
        rows = [tip(named(results, name), pressure_kpa=p) for p in PRESSURES_KPA]
        verdicts += [smaller(one, other) for one, other in zip(rows, rows[1:], strict=False)]
        parts.append(f"{name} {', '.join(value_text(row) for row in rows)} mm")
    asked = ", ".join(f"{p:g}" for p in PRESSURES_KPA)
    return Claim("The elongation rises with the pressure.", f"At {asked} kPa: {'; '.join(parts)}.", all_of(verdicts))


def bends_first(results: PaperResults) -> Claim:
    """That the curve bends at first, and less at the end."""
    verdicts: list[Verdict] = []
    for bends in _bends(results).values():
        less = (bends[-1][0] - bends[0][0], bends[-1][1] + bends[0][1]) if bends else (math.nan, math.nan)
        verdicts += [above(bends[0], 0.0) if bends else UNDECIDED, below(less, 0.0)]
    text = "Elongation over pressure is nonlinear at first and more nearly linear later."
    return Claim(text, _bends_text(results), all_of(verdicts))


def straight_last(results: PaperResults) -> Claim:
    """That the curve is nearly straight at the end."""
    ends = {name: bends[-1] if bends else (math.nan, math.nan) for name, bends in _bends(results).items()}
    verdict = all_of(below(end, STRAIGHT_PERCENT) for end in ends.values())
    limit = f"the slopes of its last two 5 kPa differ by less than {STRAIGHT_PERCENT:g} %, a limit of ours"
    text = f"Near {HIGHEST_KPA:g} kPa the curve is nearly a straight line: {limit}."
    parts = (f"{name} {bend:.1f} ± {doubt:.1g} %" for name, (bend, doubt) in ends.items() if math.isfinite(bend))
    return Claim(text, f"They differ by: {'; '.join(parts) or 'not all reached'}.", verdict)


def _slopes(results: PaperResults) -> dict[str, list[tuple[float, float]]]:
    """By reference actuator: slope of every 5 kPa, mm per kPa, and its uncertainty; empty unless all were reached."""
    found = {}
    for name in REFERENCE_SCENES:
        rows = [tip(named(results, name), pressure_kpa=p) for p in PRESSURES_KPA]
        known = [row for row in rows if row is not None and is_known(row)]
        found[name] = _secants(known) if len(known) == len(rows) else []
    return found


def _bends(results: PaperResults) -> dict[str, list[tuple[float, float]]]:
    """By reference actuator: by how much each slope differs from the one before it, percent, and its uncertainty."""
    return {
        name: [_bend(one, other) for one, other in zip(slopes, slopes[1:], strict=False)]
        for name, slopes in _slopes(results).items()
    }


def _bends_text(results: PaperResults) -> str:
    parts = []
    for name, slopes in _slopes(results).items():
        bends = _bends(results)[name]
        per_kpa = ", ".join(f"{slope:.2f} ± {doubt:.2g}" for slope, doubt in slopes)
        changes = ", ".join(f"{bend:.1f} ± {doubt:.1g}" for bend, doubt in bends)
        parts.append(f"{name} {per_kpa} mm per kPa, apart by {changes} %" if slopes else f"{name} not all reached")
    return f"Slopes of every 5 kPa: {'; '.join(parts)}."


def _secants(rows: Sequence[Row]) -> list[tuple[float, float]]:
    """Slope of each interval from rest on, mm per kPa, and its uncertainty."""
    points = [(0.0, 0.0, 0.0), *((row.pressure_kpa, row.value, row.uncertainty) for row in rows)]
    pairs = zip(points, points[1:], strict=False)
    return [((v2 - v1) / (p2 - p1), (u1 + u2) / (p2 - p1)) for (p1, v1, u1), (p2, v2, u2) in pairs]


def _bend(one: tuple[float, float], other: tuple[float, float]) -> tuple[float, float]:
    """By how much a slope differs from the one before it, percent, and the uncertainty of that."""
    (before, doubt_before), (after, doubt_after) = one, other
    return 100.0 * abs(after - before) / abs(before), 100.0 * (doubt_before + doubt_after) / abs(before)


def unfolded_at_highest(results: PaperResults, name: str) -> Claim:
    """Whether an actuator's roots are unfolded by 20 kPa."""
    row = unfolding(results, name, "axisymmetric")
    model = unfolding(results, name, "closed_form")
    text = f"At {HIGHEST_KPA:g} kPa the roots are fully unfolded: {name}."
    unit = " kPa" if is_known(row) else ""
    model_text = f"{value_text(model)}{' kPa' if is_known(model) else ''}"
    finding = f"Unfolding in the axisymmetric model: {value_text(row)}{unit}; in the closed form: {model_text}."
    return Claim(text, finding, _unfolded(row))


def _unfolded(row: Row | None) -> Verdict:
    if row is None:
        return UNDECIDED
    if not math.isfinite(row.value):
        return FAILS if limit_kpa(row) >= HIGHEST_KPA else UNDECIDED
    doubt = row.uncertainty if math.isfinite(row.uncertainty) else 0.0
    return below((row.value, doubt), HIGHEST_KPA)


def longest_at_highest(results: PaperResults) -> Claim:
    """Elongation at 20 kPa beside that at the highest pressure that the runs to 30 kPa reached."""
    verdicts: list[Verdict] = []
    parts = []
    for name in REFERENCE_SCENES:
        case = results.variant(name, "beyond")
        pressures = case.result.scene.load.pressure_kpa if case else []
        known = [row for p in pressures if p > HIGHEST_KPA and (row := tip(case, pressure_kpa=p)) and is_known(row)]
        verdicts.append(smaller(known[-1], tip(case)) if known else UNDECIDED)
        if known:
            more = f"{value_text(known[-1])} mm at {known[-1].pressure_kpa:g} kPa"
            parts.append(f"{name} {value_text(tip(case))} mm, {more}")
    text = f"At {HIGHEST_KPA:g} kPa the actuator is at its longest; more pressure does not lengthen it."
    return Claim(text, f"{'; '.join(parts) or 'Not run'}.", all_of(verdicts))


# --- the simulation -------------------------------------------------------------------------


def cost_rises(results: PaperResults, model: Literal["axisymmetric", "full3d"]) -> Claim:
    """Newton iterations and wall time of every 5 kPa, the finest runs of the four actuators together."""
    runs = [finest(getattr(case.result, model)) for case in results.of("core")]
    done = [run for run in runs if run is not None and asked_state(run) is not None]
    label = "axisymmetric" if model == "axisymmetric" else "full 3D"
    text = f"The cost of a solution rises with the pressure: {label} runs."
    start = " Every pressure starts from the axisymmetric state." if model == "full3d" else ""
    if not done:
        return Claim(text, f"No run reached {HIGHEST_KPA:g} kPa.", UNDECIDED)
    parts = [interval_costs(run) for run in done]
    iterations = [sum(part[k][0] for part in parts) for k in range(len(PRESSURES_KPA))]
    seconds = [sum(part[k][1] for part in parts) for k in range(len(PRESSURES_KPA))]
    finding = (
        f"Runs taken together: {len(done)}; per 5 kPa: {', '.join(map(str, iterations))} Newton iterations, "
        f"{', '.join(f'{s:.1f}' for s in seconds)} s. Judged by the iterations: the machine is shared.{start}"
    )
    rising = all(one <= other for one, other in zip(iterations, iterations[1:], strict=False))
    if iterations[-1] <= iterations[0]:
        return Claim(text, finding, FAILS)
    return Claim(text, finding, HOLDS if rising else UNDECIDED)


def interval_costs(run: Run) -> list[tuple[int, float]]:
    """Newton iterations, and wall time (s), that a run spent between requested pressures; from rest on."""
    costs, spent = [], 0.0
    for low, high in zip((0.0, *PRESSURES_KPA), PRESSURES_KPA, strict=False):
        states = [s for s in run.path if low < s.pressure_kpa <= high * (1.0 + 1e-9)]
        clock = max([spent, *(s.wall_s for s in states)])  # a state between may be solved after a asked one above it
        costs.append((sum(s.newton_iterations for s in states), clock - spent))
        spent = clock
    return costs


def none_beyond(results: PaperResults) -> Claim:
    """How far the runs that are asked for 30 kPa come."""
    text = f"No solution converges above {HIGHEST_KPA:g} kPa, with any of the actuators."
    parts, passed = [], []
    for name in REFERENCE_SCENES:
        case = results.variant(name, "beyond")
        runs = case.result.axisymmetric if case else ()
        if not runs:
            continue
        reached = min(last_kpa(run) for run in runs)
        passed.append(reached > HIGHEST_KPA * (1.0 + 1e-9))
        why = "" if runs[-1].summary.status == "reached" else f" ({runs[-1].summary.reason})"
        parts.append(f"{name} to {reached:.4g} kPa on {', '.join(level_label(run.summary.level) for run in runs)}{why}")
    if any(passed):
        verdict: Verdict = FAILS
    else:
        verdict = HOLDS if len(passed) == len(REFERENCE_SCENES) else UNDECIDED
    finding = "; ".join(parts) or "not run"
    return Claim(text, f"Axisymmetric: {finding}. Of this program; why ANSYS stopped is not known.", verdict)


# --- the paper's own numbers ----------------------------------------------------------------


def simulation_gap(results: PaperResults) -> Claim:
    """Largest gap between the printed ANSYS and test columns."""
    gaps = [row.ansys_cm - row.experiment_cm for row in PRINTED]
    text = f"Simulation and test differ by {SIMULATION_GAP_CM:g} cm at most, for the 1 mm wall with R_i = 5 mm."
    return _gap(results, text, SIMULATION_GAP_CM, gaps, [row.ansys_cm for row in PRINTED], "axisymmetric")


def model_gap(results: PaperResults) -> Claim:
    """Largest gap between the printed closed-form and test columns."""
    gaps = [row.closed_form_cm - row.experiment_cm for row in PRINTED]
    text = f"Model and test differ by {MODEL_GAP_CM:g} cm at most, for the 1 mm wall with R_i = 5 mm."
    return _gap(results, text, MODEL_GAP_CM, gaps, [row.closed_form_cm for row in PRINTED], "closed_form")


def _gap(
    results: PaperResults, text: str, said_cm: float, gaps: Sequence[float], column: Sequence[float], model: str
) -> Claim:
    """That the first gap (cm) is the largest and as said; with the gaps of our own model of the kind."""
    holds = abs(abs(gaps[0]) - said_cm) < PRINT_CM and all(abs(gap) < abs(gaps[0]) for gap in gaps[1:])
    printed = ", ".join(f"{gap:+.1f}" for gap in gaps)
    percent = ", ".join(f"{100 * gap / (value - gap):+.0f}" for gap, value in zip(gaps, column, strict=True))
    ours = []
    for name, row in zip(REFERENCE_SCENES, PRINTED, strict=True):
        found = tip(named(results, name), model)
        ours.append(f"{0.1 * found.value - row.experiment_cm:+.1f}" if found and is_known(found) else "–")
    label = "axisymmetric model" if model == "axisymmetric" else "corrected closed form"
    finding = (
        f"Printed columns, test subtracted: {printed} cm ({percent} % of the test); our {label} with the inferred "
        f"dimensions: {', '.join(ours)} cm. In the order {', '.join(REFERENCE_SCENES)}."
    )
    return Claim(text, finding.replace("-0.0", "0.0"), HOLDS if holds else FAILS)
