"""Tables of the bond's edge in the paper study: how far each bond comes, what it changes, and if it is still a bond."""

from __future__ import annotations

import math
from typing import Final

from studies.paper.numbers import (
    HIGHEST_KPA,
    asked_state,
    is_known,
    last_kpa,
    measured,
    number,
)
from studies.paper.results import CaseResult, PaperResults, find
from studies.report.labels import TIP, level_label
from studies.report.numbers import MISSING, rounded_up, signed
from studies.report.tables import Table
from studies.results.rows import difference_percent
from studies.results.runs import Run

RIGID: Final = "bond-rigid"
# DESIGN, section 4: what a softer bond may change in the tip's elongation, and on how many meshes of the rigid one.
BONDED_PERCENT: Final = 1.0
BONDED_MESHES: Final = 3
# Keys that change the crest, so that the tip differs for another reason than the bond.
SHAPE_KEYS: Final = {"rings.seat_mm", "geometry.fillet_mm"}


def bonds(results: PaperResults) -> Table:
    """Every bond on every mesh: pressure reached and why no further, tip at 20 kPa (mm), slip and stretch there."""
    lines = []
    for case in results.of("bond"):
        rigid = results.variant(case.case.base, "bond", RIGID)
        lines += [(case.case.base, case.case.label, *_mesh_line(case, rigid, run)) for run in case.result.axisymmetric]
    header: tuple[str, ...] = (
        "actuator",
        "bond and crest",
        "mesh",
        "reached, kPa",
        f"tip at {HIGHEST_KPA:g} kPa, mm",
        "from the rigid bond, %",
    )
    header += ("largest slip, mm", "largest stretch", "largest stretch away from the edge", "end")
    return Table(header, tuple(lines), left=(0, 1, 2, 9))


def _mesh_line(case: CaseResult, rigid: CaseResult | None, run: Run) -> tuple[str, ...]:
    level = run.summary.level
    state = asked_state(run)
    found = (
        find(case.measured, quantity, "axisymmetric", HIGHEST_KPA, level)
        for quantity in ("peak_slip_mm", "peak_stretch", "peak_stretch_away")
    )
    return (
        level_label(level),
        f"{last_kpa(run):.4g}",
        MISSING if state is None else f"{state.tip_mm:.3f}",
        _percent(change_percent(case, rigid, level, HIGHEST_KPA)),
        *map(number, found),
        run.summary.reason or "all requested pressures reached",
    )


def _percent(value: float) -> str:
    return signed(value) if math.isfinite(value) else MISSING


def change_percent(case: CaseResult | None, rigid: CaseResult | None, level: str, pressure_kpa: float) -> float:
    """By how much a bond's tip differs from the rigid bond's on the same mesh, percent; NaN where one is missing."""
    if case is None or rigid is None or case is rigid:
        return math.nan
    rows = [find(of.rows, TIP, "axisymmetric", pressure_kpa, level) for of in (case, rigid)]
    if rows[0] is None or rows[1] is None or not all(map(is_known, rows)):
        return math.nan
    return difference_percent(rows[0].value, rows[1].value)


def verdicts(results: PaperResults) -> tuple[str, ...]:
    """A sentence per softened bond on the same crest: if it counts as bonded by the definition, with its slip."""
    sentences = []
    for case in results.of("bond"):
        rigid = results.variant(case.case.base, "bond", RIGID)
        if case is not rigid and not SHAPE_KEYS & set(case.case.changes):
            sentences.append(f"{case.case.base}, {case.case.label}: {_verdict(case, rigid)}")
    return tuple(sentences)


def _verdict(case: CaseResult | None, rigid: CaseResult | None) -> str:
    """Bonded if no pressure that the rigid bond reaches on all its meshes changes the tip by more than allowed."""
    if case is None or rigid is None:
        return "cannot tell: not run"
    common = common_pressures_kpa(rigid)
    if not common:
        return f"cannot tell: the rigid bond reaches no requested pressure on {BONDED_MESHES} meshes"
    levels = [run.summary.level for run in rigid.result.axisymmetric]
    changes = {p: [abs(change_percent(case, rigid, level, p)) for level in levels] for p in common}
    worst = max(common, key=lambda p: max(changes[p]))
    largest = max(changes[worst])
    if not all(math.isfinite(change) for of_pressure in changes.values() for change in of_pressure):
        return "cannot tell: it does not reach all pressures that the rigid bond reaches"
    slip = measured(case, "peak_slip_mm", "axisymmetric", common[-1])
    slip_text = f"largest slip {number(slip)} mm at {common[-1]:g} kPa" if is_known(slip) else "slip not measured"
    verdict = "bonded" if largest <= BONDED_PERCENT else "model change"
    if largest > BONDED_PERCENT:
        beyond = next(p for p in common if max(changes[p]) > BONDED_PERCENT)
        verdict += f" from {beyond:g} kPa on"
    return (
        f"{verdict}: the tip changes by at most {rounded_up(largest, 2):g} % (at {worst:g} kPa; asked: at most "
        f"{BONDED_PERCENT:g} %) over the pressures up to {common[-1]:g} kPa that the rigid bond reaches on "
        f"{len(levels)} meshes; {slip_text}"
    )


def common_pressures_kpa(case: CaseResult) -> list[float]:
    """Asked pressures (kPa) that a case reached on all of its at least three meshes."""
    runs = case.result.axisymmetric
    if len(runs) < BONDED_MESHES:
        return []
    return [p for p in case.result.scene.load.pressure_kpa if all(asked_state(run, p) is not None for run in runs)]
