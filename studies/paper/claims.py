"""What the paper says its actuators and its simulation do, each held against the rows.

A difference that is not larger than the sum of the uncertainties decides nothing. Since the dimensions are inferred, a
claim about them is judged in every set: where the sets contradict each other, nobody can tell for the real actuators.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, Literal

from analytical.bellows.paper import PRINTED
from studies.paper.cases import HIGHEST_KPA, PRESSURES_KPA, REFERENCE_SCENES, SETS, THICK, THIN
from studies.paper.results import CaseResult, PaperResults, is_known, last_kpa, limit_kpa
from studies.paper.verdicts import FAILS, HOLDS, UNDECIDED, Verdict, above, all_of, below, over_sets, smaller
from studies.report.labels import TIP, level_label, model_label
from studies.report.numbers import number_text, value_text
from studies.results.rows import REACHED, Row
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
    return _by_sets(results, text, TIP, ((1, 0), (3, 2)))


def larger_root_bulges(results: PaperResults) -> Claim:
    """Bulge of the roots of the two actuators of each wall thickness."""
    text = "The larger root radius bulges more at the root, at the same pressure."
    return _by_sets(results, text, "root_bulge_mm", ((0, 1), (2, 3)))


def thicker_wall_shortens(results: PaperResults) -> Claim:
    """Elongation of the two actuators of each root radius."""
    text = "The thicker wall elongates less, at either root radius and every pressure (as built: silicones may differ)."
    return _by_sets(results, text, TIP, ((2, 0), (3, 1)))


def thicker_wall_shortens_alike(results: PaperResults) -> Claim:
    """Elongation of both wall thicknesses in one silicone, reference dimensions."""
    verdicts, parts = [], []
    for thin, thick in zip(THIN, THICK, strict=True):
        pairs = {
            "Dragon Skin 10": (results.named(thin), results.variant(thick, "silicone")),
            "Dragon Skin 30": (results.variant(thin, "silicone"), results.named(thick)),
        }
        for silicone, (soft, stiff) in pairs.items():
            verdicts += [smaller(stiff.tip(pressure_kpa=p), soft.tip(pressure_kpa=p)) for p in PRESSURES_KPA]
            values = (f"{name} {value_text(case.tip())} mm" for name, case in ((thin, soft), (thick, stiff)))
            parts.append(f"{', '.join(values)}, both in {silicone}")
    text = "The thicker wall elongates less when both are of one silicone."
    return Claim(text, f"At {HIGHEST_KPA:g} kPa: {'; '.join(parts)}.", all_of(verdicts))


def _by_sets(results: PaperResults, text: str, quantity: str, pairs: Sequence[tuple[int, int]]) -> Claim:
    """That of each pair of a set's actuators the first has the smaller value, mm, at all pressures."""
    verdicts, parts = [], []
    for label, actuators in SETS.items():
        cases = [results.named(actuator.name) for actuator in actuators]
        found = {
            f"{cases[low].case.scene} at {p:g} kPa": smaller(
                cases[low].row(quantity, pressure_kpa=p), cases[high].row(quantity, pressure_kpa=p)
            )
            for low, high in pairs
            for p in PRESSURES_KPA
        }
        verdicts.append(all_of(found.values()))
        if not any(is_known(case.row(quantity)) for case in cases):
            parts.append(f"{label}: no numbers")
            continue
        against = ", ".join(where for where, verdict in found.items() if verdict == FAILS)
        contrary = f" (the other way round: {against})" if against else ""
        numbers = "; ".join(", ".join(_value(cases[place], quantity) for place in pair) for pair in pairs)
        parts.append(f"{label} {verdicts[-1]}{contrary}: {numbers}")
    return Claim(text, f"At {HIGHEST_KPA:g} kPa, {'. '.join(parts)}.", over_sets(verdicts))


def _value(case: CaseResult, quantity: str) -> str:
    return f"{case.case.scene} {value_text(case.row(quantity))} mm"


# --- the curve ------------------------------------------------------------------------------


def rises_with_pressure(results: PaperResults) -> Claim:
    """That the elongation of every actuator grows from one requested pressure to the next."""
    verdicts, parts = [], []
    for name, rows in _curves(results).items():
        verdicts += [smaller(one, other) for one, other in pairwise(rows)]
        parts.append(f"{name} {', '.join(map(value_text, rows))} mm")
    asked = ", ".join(f"{p:g}" for p in PRESSURES_KPA)
    return Claim("The elongation rises with the pressure.", f"At {asked} kPa: {'; '.join(parts)}.", all_of(verdicts))


def _curves(results: PaperResults) -> dict[str, list[Row]]:
    """By reference actuator: axisymmetric elongation at every pressure, mm."""
    return {name: [results.named(name).tip(pressure_kpa=p) for p in PRESSURES_KPA] for name in REFERENCE_SCENES}


def bends_first(results: PaperResults) -> Claim:
    """That the curve bends at first, and less at the end."""
    verdicts: list[Verdict] = []
    parts = []
    for name, slopes in _slopes(results).items():
        bends = _bends(slopes)
        (first, doubt_first), (last, doubt_last) = bends[0], bends[-1]
        verdicts += [above(bends[0], 0.0), below((last - first, doubt_last + doubt_first), 0.0)]
        if not math.isfinite(last):
            parts.append(f"{name} not all reached")
            continue
        per_kpa = ", ".join(f"{slope:.2f} ± {doubt:.2g}" for slope, doubt in slopes)
        changes = ", ".join(f"{bend:.1f} ± {doubt:.1g}" for bend, doubt in bends)
        parts.append(f"{name} {per_kpa} mm per kPa, apart by {changes} %")
    text = "Elongation over pressure is nonlinear at first and more nearly linear later."
    return Claim(text, f"Slopes of every 5 kPa: {'; '.join(parts)}.", all_of(verdicts))


def straight_last(results: PaperResults) -> Claim:
    """That the curve is nearly straight at the end."""
    ends = {name: _bends(slopes)[-1] for name, slopes in _slopes(results).items()}
    verdict = all_of(below(end, STRAIGHT_PERCENT) for end in ends.values())
    limit = f"the slopes of its last two 5 kPa differ by less than {STRAIGHT_PERCENT:g} %, a limit of ours"
    text = f"Near {HIGHEST_KPA:g} kPa the curve is nearly a straight line: {limit}."
    parts = (f"{name} {bend:.1f} ± {doubt:.1g} %" for name, (bend, doubt) in ends.items() if math.isfinite(bend))
    return Claim(text, f"They differ by: {'; '.join(parts) or 'not all reached'}.", verdict)


def _slopes(results: PaperResults) -> dict[str, list[tuple[float, float]]]:
    """By reference actuator: slope of every 5 kPa, mm per kPa, and its uncertainty; NaN unless all were reached."""
    found = {}
    for name, rows in _curves(results).items():
        unknown = 0.0 if all(map(is_known, rows)) else math.nan
        points = [(0.0, unknown, 0.0), *((row.pressure_kpa, row.value + unknown, row.uncertainty) for row in rows)]
        found[name] = [
            ((value - before) / (high - low), (doubt_before + doubt) / (high - low))
            for (low, before, doubt_before), (high, value, doubt) in pairwise(points)
        ]
    return found


def _bends(slopes: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """By how much each slope differs from the one before it, percent, and the uncertainty of that."""
    return [
        (100.0 * abs(after - before) / abs(before), 100.0 * (doubt_before + doubt_after) / abs(before))
        for (before, doubt_before), (after, doubt_after) in pairwise(slopes)
    ]


def unfolded_at_highest(results: PaperResults, name: str) -> Claim:
    """Whether an actuator's roots are unfolded by 20 kPa."""
    found, model = (results.unfolding(name, of) for of in ("axisymmetric", "closed_form"))
    texts = (f"{value_text(row)}{' kPa' if is_known(row) else ''}" for row in (found, model))
    return Claim(
        f"At {HIGHEST_KPA:g} kPa the roots are fully unfolded: {name}.",
        "Unfolding in the axisymmetric model: {}; in the closed form: {}.".format(*texts),
        _unfolded(found),
    )


def _unfolded(row: Row) -> Verdict:
    if not is_known(row):
        return FAILS if limit_kpa(row) >= HIGHEST_KPA else UNDECIDED
    doubt = row.uncertainty if math.isfinite(row.uncertainty) else 0.0
    return below((row.value, doubt), HIGHEST_KPA)


def longest_at_highest(results: PaperResults) -> Claim:
    """Elongation at 20 kPa beside that at the highest pressure that the runs to 30 kPa reached."""
    verdicts: list[Verdict] = []
    parts = []
    for name in REFERENCE_SCENES:
        case = results.variant(name, "beyond")
        rows = [case.tip(pressure_kpa=p) for p in case.pressures_kpa if p > HIGHEST_KPA]
        known = [row for row in rows if is_known(row)]
        verdicts.append(smaller(known[-1], case.tip()) if known else UNDECIDED)
        if known:
            more = f"{value_text(known[-1])} mm at {known[-1].pressure_kpa:g} kPa"
            parts.append(f"{name} {value_text(case.tip())} mm, {more}")
    text = f"At {HIGHEST_KPA:g} kPa the actuator is at its longest; more pressure does not lengthen it."
    return Claim(text, f"{'; '.join(parts) or 'Not run'}.", all_of(verdicts))


# --- the simulation -------------------------------------------------------------------------


def cost_rises(results: PaperResults, model: Literal["axisymmetric", "full3d"]) -> Claim:
    """Newton iterations and wall time of every 5 kPa, the finest runs of the four actuators together."""
    text = f"The cost of a solution rises with the pressure: {model_label(model)} runs."
    runs = [run for case in results.of("core") for run in getattr(case, model)[-1:]]
    costs = [interval_costs(run) for run in runs if run.at(HIGHEST_KPA)]
    if not costs:
        return Claim(text, f"No run reached {HIGHEST_KPA:g} kPa.", UNDECIDED)
    iterations, seconds = ([sum(of_runs) for of_runs in zip(*parts, strict=True)] for parts in zip(*costs, strict=True))
    start = " Every pressure starts from the axisymmetric state." if model == "full3d" else ""
    finding = (
        f"Runs taken together: {len(costs)}; per 5 kPa: {', '.join(map(str, iterations))} Newton iterations, "
        f"{', '.join(f'{s:.1f}' for s in seconds)} s. Judged by the iterations: the machine is shared.{start}"
    )
    if iterations[-1] <= iterations[0]:
        return Claim(text, finding, FAILS)
    rising = all(one <= other for one, other in pairwise(iterations))
    return Claim(text, finding, HOLDS if rising else UNDECIDED)


def interval_costs(run: Run) -> tuple[list[int], list[float]]:
    """Newton iterations, and wall time (s), that a run spent between requested pressures; from rest on."""
    iterations, seconds, spent = [], [], 0.0
    for low, high in pairwise((0.0, *PRESSURES_KPA)):
        states = [s for s in run.path if low < s.pressure_kpa <= high * (1.0 + 1e-9)]
        clock = max([spent, *(s.wall_s for s in states)])  # a state between may be solved after one above it
        iterations.append(sum(s.newton_iterations for s in states))
        seconds.append(clock - spent)
        spent = clock
    return iterations, seconds


def none_beyond(results: PaperResults) -> Claim:
    """How far the runs that are asked for 30 kPa come."""
    parts, passed = [], []
    for case in results.of("beyond"):
        if runs := case.axisymmetric:
            reached = min(map(last_kpa, runs))
            passed.append(reached > HIGHEST_KPA * (1.0 + 1e-9))
            why = "" if runs[-1].summary.status == REACHED else f" ({runs[-1].summary.reason})"
            meshes = ", ".join(level_label(run.summary.level) for run in runs)
            parts.append(f"{case.case.base} to {reached:.4g} kPa on {meshes}{why}")
    held: Verdict = HOLDS if len(passed) == len(REFERENCE_SCENES) else UNDECIDED
    finding = "; ".join(parts) or "not run"
    return Claim(
        f"No solution converges above {HIGHEST_KPA:g} kPa, with any of the actuators.",
        f"Axisymmetric: {finding}. Of this program; why ANSYS stopped is not known.",
        FAILS if any(passed) else held,
    )


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
    ours = [
        0.1 * results.named(name).tip(model).value - row.experiment_cm
        for name, row in zip(REFERENCE_SCENES, PRINTED, strict=True)
    ]
    label = "axisymmetric model" if model == "axisymmetric" else "corrected closed form"
    finding = (
        f"Printed columns, test subtracted: {printed} cm ({percent} % of the test); our {label} with the inferred "
        f"dimensions: {', '.join(number_text(gap, '+.1f') for gap in ours)} cm. "
        f"In the order {', '.join(REFERENCE_SCENES)}."
    )
    return Claim(text, finding.replace("-0.0", "0.0"), HOLDS if holds else FAILS)
