"""Sentences of the paper study's report: answers in short, what stopped, what was skipped."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from studies.paper.acceptance import bars
from studies.paper.bonds import BONDED_PERCENT, verdicts
from studies.paper.cases import HIGHEST_KPA, PRESSURES_KPA, REFERENCE_SCENES, RING_VARIANTS, THICK
from studies.paper.errors import CHAINS, MOULDED, ZIGZAG, Outline, at_pressures
from studies.paper.results import CaseResult, PaperResults, common_levels, is_known, last_kpa, means_something
from studies.paper.sets import swing_percent
from studies.paper.setup.sizes import CALLED
from studies.paper.statements.claims import JUDGED_IN
from studies.paper.variants import REFERENCE_RING, nearer, readings
from studies.report.labels import model_label, run_label
from studies.report.numbers import MISSING, signed
from studies.results.closed_form_rows import validity_notes
from studies.results.rows import FOLDED_BACK, REACHED, Row, difference_percent

_NAMES_SHOWN = 4


def in_short(results: PaperResults) -> dict[str, str]:
    """What each section says in a sentence, by a short name; what has not been run is said to be missing."""
    return {
        "chain": _chain(results, CHAINS[0]),
        "chain_near_zigzag": _chain(results, CHAINS[0], ZIGZAG),
        "ansys": _printed(results, "paper_ansys", "the paper's ANSYS"),
        "test": _printed(results, "paper_experiment", "the paper's test"),
        "other_chains": " ".join(_chain(results, model) for model in CHAINS[1:]),
        "middle": _middle(results),
        "mechanism": _mechanism(results),
        "sets": _sets(results),
        "convention": _convention(results),
        "rings": _rings(results),
        "bonds": _bonds(results),
        "beyond": _beyond(results),
        "must_show": _must_show(results),
    }


def _must_show(results: PaperResults) -> str:
    verdicts = [bar.met for bar in bars(results)]
    met, not_met, not_run = (verdicts.count(verdict) for verdict in (True, False, None))
    return (
        f"Of {len(verdicts)} numbers that the study must show {met} are met, {not_met} are not, "
        f"{not_run} have not been run."
    )


def _middle(results: PaperResults) -> str:
    """How much further the middle of the closed end goes than its rim."""
    found = [a for a in at_pressures(results, (HIGHEST_KPA,)) if math.isfinite(a.bulge_mm())]
    if not found:
        return "How far the middle of the closed end goes has not been found."
    gaps = [a.bulge_mm() for a in found]
    ratios = [a.bulge_mm() / a.rim().uncertainty for a in found if a.rim().uncertainty > 0.0]
    times = f", {min(ratios):.0f} to {max(ratios):.0f} times the uncertainty" if ratios else ""
    return (
        f"At {HIGHEST_KPA:g} kPa the middle of the closed end goes {min(gaps):.1f} to {max(gaps):.1f} mm further than "
        f"its rim{times}."
    )


def _mechanism(results: PaperResults) -> str:
    """How long the actuators are at the lowest pressure, and how little their side walls have stretched there."""
    low = PRESSURES_KPA[0]
    cases = [results.named(name) for name in REFERENCE_SCENES]
    pairs = [(case.row("wall_stretch", pressure_kpa=low), case.best_tip(low)) for case in cases]
    known = [(wall.value, tip.value) for wall, tip in pairs if is_known(wall) and is_known(tip)]
    if not known:
        return "The stretch of the side walls has not been measured."
    (least, most), (short, long) = ((min(of), max(of)) for of in zip(*known, strict=True))
    return (
        f"At {low:g} kPa the actuators are {short:.0f} to {long:.0f} mm longer than at rest, while the side walls have "
        f"stretched by a factor of {least:.2f} to {most:.2f} along their length."
    )


def _chain(results: PaperResults, model: str, outline: Outline = MOULDED) -> str:
    """How far a chain is from the best finite-element answer of an outline, over actuators and pressures."""
    pairs = [(a.of(model), a.best()) for a in at_pressures(results, outline=outline)]
    label = f"The {model_label(model)}"
    if any(row.status == FOLDED_BACK for row, _ in pairs):
        label += " (where it has not folded back)"
    return f"{label} differs from finite elements of the actuators {outline} by {_spread(pairs)}."


def _printed(results: PaperResults, model: str, label: str) -> str:
    """How far the best finite-element answers are from printed numbers."""
    cases = [results.named(name) for name in REFERENCE_SCENES]
    spread = _spread((case.best_tip(), case.tip(model)) for case in cases)
    return f"Finite elements differ from {label} at {HIGHEST_KPA:g} kPa by {spread}."


def _spread(pairs: Iterable[tuple[Row, Row]]) -> str:
    """Range of the differences of pairs, percent of the second."""
    known = [(one.value, other.value) for one, other in pairs if means_something(one) and is_known(other)]
    found = [difference_percent(*pair) for pair in known]
    return f"{signed(min(found))} to {signed(max(found))} %" if found else f"{MISSING} (not run)"


def _sets(results: PaperResults) -> str:
    """How far the drawn sets' elongations at 20 kPa are from the reference's."""
    least, largest = swing_percent(results)
    spread = f"{signed(least)} to {signed(largest)} % from the reference's" if math.isfinite(least) else "not run"
    count = len(results.drawn(*JUDGED_IN))
    return f"Elongation at {HIGHEST_KPA:g} kPa over {count} other sets of inferred and chosen dimensions: {spread}."


def _convention(results: PaperResults) -> str:
    found = {name: nearer(*readings(results, name)) for name in THICK}
    parts = (f"{CALLED[name]}: {'not run' if answer == MISSING else answer}" for name, answer in found.items())
    return f"The convention that is nearer to the paper's ANSYS is, for {'; for '.join(parts)}."


def _rings(results: PaperResults) -> str:
    parts = []
    for suffix, label, _ in RING_VARIANTS:
        if suffix != REFERENCE_RING:
            pairs = [
                _on_one_mesh(*(results.variant(base, "rings", which) for which in (suffix, REFERENCE_RING)))
                for base in REFERENCE_SCENES
            ]
            parts.append(f"{label} {_spread(pairs)}")
    return f"Rings against meshed PLA at {HIGHEST_KPA:g} kPa: {', '.join(parts)}."


def _on_one_mesh(one: CaseResult, other: CaseResult) -> tuple[Row, Row]:
    """Axisymmetric elongations at 20 kPa of two cases on the finest mesh that both have."""
    level = next(iter(common_levels(one, other)), "")
    return one.tip(level=level), other.tip(level=level)


def _bonds(results: PaperResults) -> str:
    """How many of the softer bonds still count as bonds."""
    sentences = verdicts(results)
    bonded, changed = (sum(word in sentence for sentence in sentences) for word in (": bonded", ": model change"))
    return (
        f"Of {len(sentences)} layers of adhesive {bonded} change the tip by at most {BONDED_PERCENT:g} % "
        f"and count as bonded, {changed} are a change of model; the report's own bond is rigid."
    )


def _beyond(results: PaperResults) -> str:
    parts = [
        f"{CALLED[case.case.base]}: {min(last_kpa(run) for run in case.axisymmetric):.4g} kPa"
        for case in results.of("beyond")
        if case.axisymmetric
    ]
    return f"Requested up to 30 kPa; reached on all meshes by {'; by '.join(parts) or 'none: not run'}."


def silicone_mass(results: PaperResults) -> str:
    """Range of the mass of silicone of the four actuators, g, from their meshes."""
    rows = [results.named(name).row("silicone_g", pressure_kpa=None) for name in REFERENCE_SCENES]
    known = [row.value for row in rows if is_known(row)]
    return f"{min(known):.0f} to {max(known):.0f} g" if known else "not found"


def stops(results: PaperResults) -> tuple[str, ...]:
    """A sentence per way in which a case's runs ended early, and a line for each case that has no runs."""
    sentences = []
    for case in _one_by_one(results):
        found: dict[str, list[str]] = {}
        for run in case.runs:
            if run.summary.status != REACHED:
                label = f"{run_label(run.summary.model, run.summary.level)} at {last_kpa(run):.4g} kPa"
                found.setdefault(run.summary.reason, []).append(label)
        sentences += [f"{case.case.scene}, {', '.join(labels)}: {why}" for why, labels in found.items()]
        if not case.runs:
            sentences.append(f"{case.case.scene}: no finished run")
    return tuple(sentences)


def notes(results: PaperResults) -> tuple[str, ...]:
    """What the runs' plans skipped and what the scenes' numbers need to be read, each sentence once with its cases."""
    cases: dict[str, dict[str, None]] = {}
    for case in _one_by_one(results):
        for sentence in (*validity_notes(case.scene), *(note for run in case.runs for note in run.summary.plan)):
            cases.setdefault(sentence, {})[case.case.scene] = None
    return tuple(f"{sentence} ({_named(list(names))})" for sentence, names in cases.items())


def _one_by_one(results: PaperResults) -> list[CaseResult]:
    """All cases but those of the drawn sets, which are counted, not told one by one."""
    return [case for case in results.cases if case.case.group != "sets"]


def _named(names: Sequence[str]) -> str:
    """Cases by name if they are few."""
    return ", ".join(names) if len(names) <= _NAMES_SHOWN else f"{len(names)} cases"
