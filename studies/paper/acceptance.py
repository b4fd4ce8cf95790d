"""What the study must show: its uncertainties small, its models in agreement, its bands true.

A band is audited by the next finer mesh: made from the coarser meshes alone, it has to hold the finer one's value.
Only that the four actuators reach their pressures decides the exit code.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from studies.engine import Bar
from studies.paper.cases import HIGHEST_KPA, PRESSURES_KPA, REFERENCE_SCENES
from studies.paper.results import CaseResult, PaperResults, find, is_known
from studies.planning.levels import fineness, ranking
from studies.report.labels import level_label, run_label
from studies.report.numbers import MISSING, rounded_up, up
from studies.report.tables import Table, table_of
from studies.results.bellows_rows import bellows_rows
from studies.results.rows import REACHED, Row, difference_percent
from studies.results.runs import Run, tip_at

UNCERTAINTY_PERCENT: Final = 1.0
GAP_PERCENT: Final = 0.5
INSIDE_PERCENT: Final = 95.0


@dataclass(frozen=True)
class Check:
    """A band, which is a row of a case, and the value of a finer mesh that has to be in it (mm, or N)."""

    case: str
    row: Row
    finer: str
    finer_value: float

    @property
    def inside(self) -> bool:
        """True if the band holds the finer value."""
        return self.distance <= self.row.uncertainty

    @property
    def distance(self) -> float:
        """From the band's middle to the finer value."""
        return abs(self.finer_value - self.row.value)

    @property
    def meshes(self) -> str:
        """What is tested by what."""
        return f"{level_label(self.row.level)} by {level_label(self.finer)}"


def checks(results: PaperResults) -> dict[str, list[Check]]:
    """All bands by what they have to hold."""
    pairs = []
    for case in results.cases:
        if case.case.group in ("core", "alternates"):
            pairs.append((case, results.variant(case.case.base, "audit")))
        elif case.case.group != "audit":
            pairs.append((case, CaseResult(case.case)))
    return {
        "axisymmetric bands that hold the next finer mesh": [c for pair in pairs for c in _meridian_checks(*pair)],
        "full 3D bands that hold the finest mesh": [c for pair in pairs for c in _body_checks(*pair)],
    }


def _meridian_checks(case: CaseResult, audit: CaseResult) -> Iterator[Check]:
    """Band of every axisymmetric mesh, from it and the coarser ones, by the next finer mesh; it takes two."""
    runs = case.axisymmetric
    own = max((fineness(run.summary.level) for run in runs), default=0)
    more = [run for run in audit.axisymmetric if fineness(run.summary.level) > own]
    for count, finer in enumerate([*runs, *more][2 : len(runs) + 1], start=2):
        yield from _against(case, bellows_rows(case.scene, runs[:count]), runs[count - 1], finer)


def _body_checks(case: CaseResult, audit: CaseResult) -> Iterator[Check]:
    """Band of every full 3D mesh, from it, the coarser ones and all meridians and sectors, by the finest mesh."""
    runs = sorted([*case.full3d, *audit.full3d], key=lambda run: ranking(run.summary.level))
    for count, run in enumerate(case.full3d, start=1):
        if run is not runs[-1]:
            rows = bellows_rows(case.scene, [*case.axisymmetric, *case.sector, *case.full3d[:count]])
            yield from _against(case, rows, run, runs[-1])


def _against(case: CaseResult, rows: Sequence[Row], run: Run, finer: Run) -> Iterator[Check]:
    """Bands in rows of one run against another run at every requested pressure that both reached."""
    quantity = case.scene.main_quantity
    for pressure in case.pressures_kpa:
        row = find(rows, quantity, run.summary.model, pressure, run.summary.level)
        value = tip_at(finer, pressure, quantity)
        if math.isfinite(row.value + row.uncertainty + value):
            yield Check(case.case.scene, row, finer.summary.level, value)


# --- bars -----------------------------------------------------------------------------------


def bars(results: PaperResults) -> list[Bar]:
    """All bars: those that decide the exit code, the main ones, and those that say more about these."""
    return [*(_reached(results.named(name)) for name in REFERENCE_SCENES), *main_bars(results), *_more(results)]


def main_bars(results: PaperResults) -> list[Bar]:
    """What the study must show in short: uncertainties and gaps at 20 kPa, and how many bands are true."""
    found = []
    for name in REFERENCE_SCENES:
        solid = results.named(name).tip("full3d")
        share = 100.0 * solid.uncertainty / abs(solid.value)
        found.append(_at_most(f"{name}: uncertainty of full 3D at {HIGHEST_KPA:g} kPa", UNCERTAINTY_PERCENT, share))
        gap = _gap_percent(results.named(name), [HIGHEST_KPA])
        found.append(_at_most(f"{name}: axisymmetric from full 3D at {HIGHEST_KPA:g} kPa", GAP_PERCENT, gap))
    return [*found, *(_share(f"{label}: all meshes, all cases", of) for label, of in checks(results).items())]


def _more(results: PaperResults) -> list[Bar]:
    found = [
        _at_most(
            f"{name}: axisymmetric from full 3D, worst pressure",
            GAP_PERCENT,
            _gap_percent(results.named(name), PRESSURES_KPA),
        )
        for name in REFERENCE_SCENES
    ]
    actuators = {case.case.scene for case in results.of("core", "alternates")}
    for label, of_model in checks(results).items():
        for meshes in dict.fromkeys(check.meshes for check in of_model):
            of_meshes = [check for check in of_model if check.meshes == meshes]
            plain = [check for check in of_meshes if check.case in actuators]
            found.append(_share(f"{label}: {meshes}, reference and alternates", plain))
            found.append(_share(f"{label}: {meshes}, all cases", of_meshes))
    return found


def _reached(case: CaseResult) -> Bar:
    """That the answer of an actuator reached every requested pressure."""
    wanted = f"{case.case.scene}: every requested pressure is reached"
    runs = case.full3d or case.sector or case.axisymmetric
    if not runs:
        return Bar(wanted, MISSING, None)
    answer = runs[-1].summary
    found = f"{run_label(answer.model, answer.level)}: {answer.reason or answer.status}"
    return Bar(wanted, found, answer.status == REACHED)


def _gap_percent(case: CaseResult, pressures_kpa: Sequence[float]) -> float:
    """Largest gap between the axisymmetric and the full 3D elongation where both have one; NaN where none has."""
    pairs = ((case.tip("axisymmetric", p), case.tip("full3d", p)) for p in pressures_kpa)
    gaps = [
        abs(difference_percent(flat.value, solid.value)) for flat, solid in pairs if is_known(flat) and is_known(solid)
    ]
    return max(gaps, default=math.nan)


def _at_most(what: str, limit: float, percent: float) -> Bar:
    """A bar that does not decide the exit code."""
    wanted = f"{what}: at most {limit:g} %"
    if math.isnan(percent):
        return Bar(wanted, MISSING, None, decides=False)
    return Bar(wanted, f"{rounded_up(percent, 2):g} %", percent <= limit, decides=False)


def _share(what: str, of: Sequence[Check]) -> Bar:
    wanted = f"{what}: at least {INSIDE_PERCENT:g} %"
    if not of:
        return Bar(wanted, MISSING, None, decides=False)
    inside = sum(check.inside for check in of)
    share = 100.0 * inside / len(of)
    return Bar(wanted, f"{share:.1f} % ({inside} of {len(of)})", share >= INSIDE_PERCENT, decides=False)


def misses(results: PaperResults) -> Table:
    """Every band that does not hold the finer mesh's value (mm, or N of a blocked tip)."""
    columns: dict[str, Callable[[Check], str]] = {
        "case": lambda check: check.case,
        "pressure, kPa": lambda check: f"{check.row.pressure_kpa:g}",
        "mesh of the band": lambda check: run_label(check.row.model, check.row.level),
        "value and band": lambda check: f"{check.row.value:.4f} ± {up(check.row.uncertainty, 4)}",
        "finer mesh": lambda check: f"{level_label(check.finer)}: {check.finer_value:.4f}",
        "distance over band": lambda check: _ratio(check.distance, check.row.uncertainty),
    }
    return table_of((c for of in checks(results).values() for c in of if not c.inside), columns, left=(0, 2))


def _ratio(distance: float, band: float) -> str:
    return f"{distance / band:.2g}" if band else MISSING
