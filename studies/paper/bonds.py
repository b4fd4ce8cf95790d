"""The bond's edge in the paper study: how far each bond comes, what it changes, and if it is still a bond."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from studies.paper.cases import HIGHEST_KPA
from studies.paper.results import CaseResult, PaperResults, ending, is_known, last_kpa
from studies.paper.setup.sizes import CALLED
from studies.report.labels import level_label
from studies.report.numbers import measured_text, number_text, rounded_up, signed
from studies.report.tables import Table
from studies.results.rows import difference_percent
from studies.results.runs import Run

RIGID: Final = "bond-rigid"
# DESIGN, section 4: what a softer bond may change in the tip's elongation, and on how many meshes of the rigid one.
BONDED_PERCENT: Final = 1.0
BONDED_MESHES: Final = 3


@dataclass(frozen=True)
class Bond:
    """A bond beside the rigid one of the same actuator."""

    case: CaseResult
    rigid: CaseResult

    def change_percent(self, level: str, pressure_kpa: float) -> float:
        """By how much its tip differs from the rigid bond's on the same mesh; NaN where one is missing."""
        if self.case == self.rigid:
            return math.nan
        own, rigid = (case.tip(pressure_kpa=pressure_kpa, level=level).value for case in (self.case, self.rigid))
        return difference_percent(own, rigid)


def of_study(results: PaperResults) -> list[Bond]:
    """All bonds that have been run."""
    return [Bond(case, results.variant(case.case.base, "bond", RIGID)) for case in results.of("bond")]


def bonds(results: PaperResults) -> Table:
    """Every bond on its finest mesh: pressure reached and why no further, tip (mm), slip and stretch at 20 kPa."""
    lines = [
        (CALLED[bond.case.case.base], bond.case.case.label, *_cells(bond, run))
        for bond in of_study(results)
        for run in bond.case.axisymmetric[-1:]
    ]
    header = (
        "actuator",
        "bond and crest",
        "mesh",
        "reached, kPa",
        f"tip at {HIGHEST_KPA:g} kPa, mm",
        "from the rigid bond, %",
        "largest slip, mm",
        "largest stretch away from the edge",
        "end",
    )
    return Table(header, tuple(lines), left=(0, 1, 2, 8))


def _cells(bond: Bond, run: Run) -> tuple[str, ...]:
    level, state = run.summary.level, run.at(HIGHEST_KPA)
    measured = (bond.case.row(name, level=level) for name in ("peak_slip_mm", "peak_stretch_away"))
    return (
        level_label(level),
        f"{last_kpa(run):.4g}",
        number_text(state.tip_mm if state else math.nan, ".3f"),
        signed(bond.change_percent(level, HIGHEST_KPA)),
        *map(measured_text, measured),
        ending(run),
    )


def verdicts(results: PaperResults) -> tuple[str, ...]:
    """A sentence per layer of adhesive: if it counts as bonded by the definition, with its slip.

    Other shapes of the crest and meshed rings are no softer bonds.
    """
    return tuple(
        f"{CALLED[bond.case.case.base]}, {bond.case.case.label}: {_verdict(bond)}"
        for bond in of_study(results)
        if bond.case.case.changes.get("rings.bond") == "adhesive"
    )


def _verdict(bond: Bond) -> str:
    """Bonded if no pressure that the rigid bond reaches on all its meshes changes the tip by more than allowed."""
    if not bond.rigid.runs:
        return "cannot tell: not run"
    common = common_pressures_kpa(bond.rigid)
    if not common:
        return f"cannot tell: the rigid bond reaches no requested pressure on {BONDED_MESHES} meshes"
    levels = [run.summary.level for run in bond.rigid.axisymmetric]
    changes = {p: max(abs(bond.change_percent(level, p)) for level in levels) for p in common}
    if not math.isfinite(sum(changes.values())):
        return "cannot tell: it does not reach all pressures that the rigid bond reaches"
    worst = max(common, key=lambda p: changes[p])
    beyond = [p for p in common if changes[p] > BONDED_PERCENT]
    verdict = f"model change from {beyond[0]:g} kPa on" if beyond else "bonded"
    slip = bond.case.row("peak_slip_mm", pressure_kpa=common[-1])
    slip_text = (
        f"largest slip {measured_text(slip)} mm at {common[-1]:g} kPa" if is_known(slip) else "slip not measured"
    )
    return (
        f"{verdict}: the tip changes by at most {rounded_up(changes[worst], 2):g} % (at {worst:g} kPa; allowed: "
        f"{BONDED_PERCENT:g} %) over the pressures up to {common[-1]:g} kPa that the rigid bond reaches on "
        f"{len(levels)} meshes; {slip_text}"
    )


def common_pressures_kpa(case: CaseResult) -> list[float]:
    """Requested pressures (kPa) that a case reached on all of its at least three meshes."""
    runs = case.axisymmetric
    if len(runs) < BONDED_MESHES:
        return []
    return [p for p in case.pressures_kpa if all(run.at(p) is not None for run in runs)]
