"""How much the unknown dimensions matter: elongations over the drawn sets, and what of it is due to what is chosen.

A chosen dimension, such as a fillet, is as unknown as an inferred one: the paper prints neither.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from scipy.stats import spearmanr

from studies.paper.cases import DRAWN, HIGHEST_KPA
from studies.paper.results import Four, PaperResults, is_known
from studies.paper.statements.claims import JUDGED_IN
from studies.paper.statements.judges import SLOTS
from studies.report.numbers import MISSING, number_text, signed, typeset
from studies.report.tables import Table
from studies.results.rows import REACHED, difference_percent

SHOWN_KPA: Final = (20.0, 5.0)
QUANTILES: Final = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
CHOSEN: Final = ("fillet_mm", "seat_mm", "collar_mm", "cap_mm")
CHOSEN_ALONE: Final = "reference"
FEW_CONVOLUTIONS: Final = 5

Measure = Callable[[Four, int, float], float]


def elements_mm(four: Four, slot: int, pressure_kpa: float) -> float:
    """Axisymmetric elongation of one of a set's actuators, mm; NaN if it was not reached."""
    return four.cases[slot].tip(pressure_kpa=pressure_kpa).value


def chain_mm(four: Four, slot: int, pressure_kpa: float) -> float:
    """Its elongation by the chain of the closed form that its set was inferred with, mm."""
    return four.cases[slot].tip(four.chain, pressure_kpa).value


def difference(four: Four, slot: int, pressure_kpa: float) -> float:
    """The closed form of its chain less the finite elements, percent of these; NaN if one is unknown."""
    found, model = elements_mm(four, slot, pressure_kpa), chain_mm(four, slot, pressure_kpa)
    return difference_percent(model, found) if math.isfinite(found) and found else math.nan


# By what a table calls it, and how its numbers are written.
MEASURES: Final[tuple[tuple[str, Measure, str], ...]] = (
    ("finite elements, mm", elements_mm, ".1f"),
    ("closed form of its chain, mm", chain_mm, ".1f"),
    ("closed form less finite elements, %", difference, "+.1f"),
)


def known(values: Sequence[float]) -> np.ndarray:
    """Those that are numbers."""
    found = np.asarray(values, dtype=float)
    return np.asarray(found[np.isfinite(found)])


def spread(results: PaperResults) -> Table:
    """Quantiles over the drawn sets by actuator and pressure, beside the reference."""
    drawn = results.drawn(*JUDGED_IN)
    lines = []
    for slot, label in enumerate(SLOTS):
        for pressure in SHOWN_KPA:
            for what, measure, form in MEASURES:
                values = known([measure(four, slot, pressure) for four in drawn])
                if len(values):
                    reference = typeset(measure(results.reference, slot, pressure), form)
                    found = (typeset(float(q), form) for q in np.quantile(values, QUANTILES))
                    lines.append((label, f"{pressure:g}", what, f"{len(values)}", *found, reference))
    quantiles = ("least", *(f"{100.0 * q:g} %" for q in QUANTILES[1:-1]), "largest")
    return Table(("actuator", "kPa", "what", "sets", *quantiles, "reference"), tuple(lines), left=(0, 2))


def chosen_alone(results: PaperResults) -> Table:
    """What the chosen dimensions do by themselves to the reference's elongation, and which of them does it."""
    alone, drawn = results.drawn(CHOSEN_ALONE), results.drawn(*JUDGED_IN)
    lines = []
    for slot, label in enumerate(SLOTS):
        for pressure in SHOWN_KPA:
            pairs = [(_of(four.label), elements_mm(four, slot, pressure)) for four in alone]
            pairs = [(one, value) for one, value in pairs if math.isfinite(value)]
            values = np.array([value for _, value in pairs])
            if len(values) < 3 or not np.ptp(values):  # these have no rank correlation
                continue
            all_sets = known([elements_mm(four, slot, pressure) for four in drawn])
            reference = elements_mm(results.reference, slot, pressure)
            ends = (signed(difference_percent(float(end), reference)) for end in (values.min(), values.max()))
            share = 100.0 * values.var() / all_sets.var() if len(all_sets) and np.ptp(all_sets) else math.nan
            ranks = (spearmanr([one[key] for one, _ in pairs], values)[0] for key in CHOSEN)
            cells = (f"{len(values)}", f"{values.min():.1f} to {values.max():.1f}", " to ".join(ends))
            lines.append(
                (label, f"{pressure:g}", *cells, number_text(share, ".2g"), *(typeset(r, "+.2f") for r in ranks))
            )
    ranks_of = (f"rank correlation with the {key.removesuffix('_mm')}" for key in CHOSEN)
    header = (
        "actuator",
        "kPa",
        "sets",
        "finite elements, mm",
        "less the reference, %",
        "variance, % of that of all sets",
    )
    return Table((*header, *ranks_of), tuple(lines))


def _of(label: str) -> dict[str, float]:
    """Chosen dimensions of a drawn set by name."""
    (one,) = (one for one in DRAWN if one.name == label)
    return {key: getattr(one, key) for key in CHOSEN}


def sentences(results: PaperResults) -> tuple[str, ...]:
    """How far from the printed test, which set comes nearest, and how many were not reached or are unstable."""
    drawn = results.drawn(*JUDGED_IN)
    if not drawn:
        return ()
    return (
        _from_test(results, drawn),
        _nearest(results, drawn),
        _convolutions(drawn),
        _ends([*drawn, *results.drawn(CHOSEN_ALONE)]),
    )


def _convolutions(drawn: Sequence[Four]) -> str:
    """How many folds the sets have, for few and long ones look unlike the reference."""
    counts = [four.cases[0].scene.geometry.convolutions for four in drawn]
    few = sum(count < FEW_CONVOLUTIONS for count in counts)
    return (
        f"They have {min(counts)} to {max(counts)} convolutions, {few} of {len(counts)} fewer than {FEW_CONVOLUTIONS}: "
        "nothing printed excludes those."
    )


def from_test(results: PaperResults, four: Four) -> list[float]:
    """Finite elements less the printed test at 20 kPa by actuator, percent of the test; NaN if not reached."""
    tests = (case.tip("paper_experiment").value for case in results.reference.cases)
    found = (elements_mm(four, slot, HIGHEST_KPA) for slot in range(len(SLOTS)))
    return [100.0 * (value / test - 1.0) for value, test in zip(found, tests, strict=True)]


def _from_test(results: PaperResults, drawn: Sequence[Four]) -> str:
    by_slot = zip(*(from_test(results, four) for four in drawn), strict=True)
    parts = []
    for label, values in zip(SLOTS, map(known, by_slot), strict=True):
        ends = f"{signed(float(values.min()))} to {signed(float(values.max()))} %" if len(values) else MISSING
        parts.append(f"{label}: {ends}")
    return (
        f"Finite elements against the printed test at {HIGHEST_KPA:g} kPa over {len(drawn)} sets: {'; '.join(parts)}."
    )


def _nearest(results: PaperResults, drawn: Sequence[Four]) -> str:
    """The set whose worst actuator is nearest to its test."""
    worst = {
        four.label: max(abs(x) for x in gaps) for four in drawn if np.isfinite(gaps := from_test(results, four)).all()
    }
    if not worst:
        return f"No set reached {HIGHEST_KPA:g} kPa with all four actuators."
    label = min(worst, key=lambda name: worst[name])
    return f"No set is nearer to all four tests than {label}, which is within {worst[label]:.0f} % of each."


def _ends(fours: Sequence[Four]) -> str:
    cases = [case for four in fours for case in four.cases]
    stopped = [case.case.scene for case in cases if any(run.summary.status != REACHED for run in case.axisymmetric)]
    unstable = sum(case.row("unstable_modes").value > 0.0 for case in cases if is_known(case.row("unstable_modes")))
    which = f" ({', '.join(stopped)})" if stopped else ""
    return (
        f"Of {len(cases)} actuators {len(stopped)} stopped before {HIGHEST_KPA:g} kPa on a mesh{which}; "
        f"{unstable} are axisymmetrically unstable there."
    )


def swing_percent(results: PaperResults) -> tuple[float, float]:
    """Least and largest elongation at 20 kPa of the drawn sets less the reference's, percent of it; NaN if not run."""
    pairs = (
        (case.tip().value, own.tip().value)
        for four in results.drawn(*JUDGED_IN)
        for case, own in zip(four.cases, results.reference.cases, strict=True)
    )
    found = known([100.0 * (value / own - 1.0) for value, own in pairs])
    return (float(found.min()), float(found.max())) if len(found) else (math.nan, math.nan)
