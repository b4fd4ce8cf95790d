"""Sentences of the paper study's report: answers in short, what stopped, what was skipped."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from studies.paper import audit as paper_audit
from studies.paper import bond_tables as paper_bond_tables
from studies.paper.cases import REFERENCE_SCENES, RING_VARIANTS, THICK
from studies.paper.claims import Claim
from studies.paper.numbers import (
    HIGHEST_KPA,
    PRESSURES_KPA,
    best,
    common_levels,
    is_known,
    last_kpa,
    means_something,
    named,
    sets,
    tip,
)
from studies.paper.results import CaseResult, PaperResults
from studies.paper.tables import CHAINS
from studies.paper.variant_tables import REFERENCE_RING, nearer
from studies.paper.verdicts import HOLDS, UNDECIDED
from studies.report.labels import model_label, run_label
from studies.report.numbers import MISSING, signed
from studies.results.closed_form_rows import validity_notes
from studies.results.rows import FOLDED_BACK, REACHED, Row, difference_percent

_NAMES_SHOWN = 4


def in_short(results: PaperResults, found: Sequence[Claim]) -> tuple[str, ...]:
    """The study's answers, a sentence each; what has not been run is said to be missing."""
    return (
        _must_show(results),
        *(_chain(results, model) for model in CHAINS[:3]),
        _printed(results, "paper_ansys", "the paper's ANSYS"),
        _printed(results, "paper_experiment", "the paper's test"),
        _sets(results),
        _convention(results),
        _rings(results),
        _bonds(results),
        _beyond(results),
        _claims(found),
    )


def _must_show(results: PaperResults) -> str:
    ends = (f"at {HIGHEST_KPA:g} kPa", "all meshes, all cases")  # the other lines only say more about these
    lines = [line for line in paper_audit.acceptance(results).rows if line[0].endswith(ends)]
    met, missing = (sum(line[-1] == word for line in lines) for word in ("met", "not run"))
    others = f"{len(lines) - met - missing} are not, {missing} have not been run"
    return f"Of {len(lines)} numbers that the study must show {met} are met, {others}."


def _chain(results: PaperResults, model: str) -> str:
    """How far a chain is from the best finite-element answer, over actuators and pressures."""
    pairs = [
        (tip(named(results, name), model, pressure), best(named(results, name), pressure))
        for name in REFERENCE_SCENES
        for pressure in PRESSURES_KPA
    ]
    label = model_label(model).capitalize()
    if any(row and row.status == FOLDED_BACK for row, _ in pairs):
        label += " (where it has not folded back)"
    return f"{label} against finite elements: {_spread(pairs)} over the actuators and pressures."


def _printed(results: PaperResults, model: str, label: str) -> str:
    """How far the best finite-element answers are from printed numbers."""
    pairs = [(best(named(results, name)), tip(named(results, name), model)) for name in REFERENCE_SCENES]
    return f"Finite elements against {label} at {HIGHEST_KPA:g} kPa: {_spread(pairs)}."


def _spread(pairs: Iterable[tuple[Row | None, Row | None]]) -> str:
    """Range of the differences of pairs, percent of the second."""
    found = [
        difference_percent(one.value, other.value)
        for one, other in pairs
        if one and other and means_something(one) and is_known(other)
    ]
    return f"{signed(min(found))} to {signed(max(found))} %" if found else "not run"


def _sets(results: PaperResults) -> str:
    """How far the alternates' elongations at 20 kPa are from the reference's."""
    _, *alternates = sets()
    pairs = [
        (tip(named(results, other.name)), tip(named(results, own.name)))
        for _, actuators in alternates
        for own, other in zip(sets()[0][1], actuators, strict=True)
    ]
    return f"Other inferred dimensions move the elongation at {HIGHEST_KPA:g} kPa by {_spread(pairs)}."


def _convention(results: PaperResults) -> str:
    parts = []
    for name in THICK:
        own, other = tip(named(results, name)), tip(results.variant(name, "convention"))
        answer = nearer(own, other, tip(named(results, name), "paper_ansys"))
        parts.append(f"{name} {answer if answer != MISSING else 'not run'}")
    return f"Ogden convention nearer to the paper's ANSYS: {', '.join(parts)}."


def _rings(results: PaperResults) -> str:
    parts = []
    for suffix, label, _ in RING_VARIANTS:
        if suffix != REFERENCE_RING:
            pairs = [
                _on_one_mesh(results.variant(base, "rings", suffix), results.variant(base, "rings", REFERENCE_RING))
                for base in REFERENCE_SCENES
            ]
            parts.append(f"{label} {_spread(pairs)}")
    return f"Rings against meshed PLA at {HIGHEST_KPA:g} kPa: {', '.join(parts)}."


def _bonds(results: PaperResults) -> str:
    """How many of the softer bonds still count as bonds."""
    sentences = paper_bond_tables.verdicts(results)
    bonded = sum(": bonded" in sentence for sentence in sentences)
    changed = sum(": model change" in sentence for sentence in sentences)
    return (
        f"Of {len(sentences)} softer bonds {bonded} change the tip by at most {paper_bond_tables.BONDED_PERCENT:g} % "
        f"and count as bonded, {changed} are a change of model; the report's own bond is rigid."
    )


def _on_one_mesh(one: CaseResult | None, other: CaseResult | None) -> tuple[Row | None, Row | None]:
    """Axisymmetric elongations at 20 kPa of two cases on the finest mesh that both have."""
    level = next(iter(common_levels(one, other)), "")
    return tip(one, level=level), tip(other, level=level)


def _beyond(results: PaperResults) -> str:
    parts = [
        f"{case.case.base} {min(last_kpa(run) for run in case.result.axisymmetric):.4g} kPa"
        for case in results.of("beyond")
        if case.result.axisymmetric
    ]
    return f"Reached when asked for 30 kPa, all meshes: {', '.join(parts) or 'not run'}."


def _claims(found: Sequence[Claim]) -> str:
    hold, open_ = (sum(claim.verdict == word for claim in found) for word in (HOLDS, UNDECIDED))
    return (
        f"Of {len(found)} claims of the paper {hold} hold, {len(found) - hold - open_} do not, {open_} cannot be told."
    )


def stops(results: PaperResults) -> tuple[str, ...]:
    """A sentence per way in which a case's runs ended early, and a line for each case that has no runs."""
    sentences = []
    for case in results.cases:
        found: dict[str, list[str]] = {}
        result = case.result
        for run in result.runs:
            if run.summary.status != REACHED:
                label = f"{run_label(run.summary.model, run.summary.level)} at {last_kpa(run):.4g} kPa"
                found.setdefault(run.summary.reason, []).append(label)
        sentences += [f"{case.case.name}, {', '.join(labels)}: {why}" for why, labels in found.items()]
        if not result.runs:
            sentences.append(f"{case.case.name}: no finished run")
    return tuple(sentences)


def notes(results: PaperResults) -> tuple[str, ...]:
    """What the runs' plans skipped and what the scenes' numbers need to be read, each sentence once with its cases."""
    cases: dict[str, dict[str, None]] = {}
    for case in results.cases:
        for sentence in _sentences(case):
            cases.setdefault(sentence, {})[case.case.name] = None
    return tuple(f"{sentence} ({_named(list(names))})" for sentence, names in cases.items())


def _sentences(case: CaseResult) -> list[str]:
    result = case.result
    runs = result.runs
    return list(dict.fromkeys((*validity_notes(result.scene), *(s for run in runs for s in run.summary.plan))))


def _named(names: Sequence[str]) -> str:
    """Cases by name if they are few."""
    return ", ".join(names) if len(names) <= _NAMES_SHOWN else f"{len(names)} cases"
