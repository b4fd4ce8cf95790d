"""What the study must show: its uncertainties small, its models in agreement, its bands true.

A band is audited by the next finer mesh: made from the coarser meshes alone, it has to hold the finer one's value.
Only that the four actuators reach their pressures decides the exit code.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from studies.engine import Bar
from studies.models.run_log import Run
from studies.paper.cases import HIGHEST_KPA, PRESSURES_KPA, REFERENCE_SCENES
from studies.paper.results import CaseResult, PaperResults, find, is_known
from studies.planning.levels import fineness, ranking
from studies.report.labels import level_label, run_label
from studies.report.numbers import MISSING, rounded_up, up
from studies.report.tables import Table, table_of
from studies.results.compare import main_quantity, scene_rows, tip_at
from studies.results.rows import REACHED, Row, difference_percent

UNCERTAINTY_PERCENT: Final = 1.0
GAP_PERCENT: Final = 0.5
INSIDE_PERCENT: Final = 95.0


@dataclass(frozen=True)
class Check:
    """A band and the finer mesh's value.

    Attributes
    ----------
    case, model, pressure_kpa
        Whose.
    level, finer
        Meshes of the band and of the value that has to be in it.
    value, band, finer_value
        Elongation, mm, or force, N: on the coarser mesh, its uncertainty, on the finer mesh.
    """

    case: str
    model: str
    pressure_kpa: float
    level: str
    finer: str
    value: float
    band: float
    finer_value: float

    @property
    def inside(self) -> bool:
        """True if the band holds the finer value."""
        return abs(self.finer_value - self.value) <= self.band

    @property
    def meshes(self) -> str:
        """What is tested by what."""
        return f"{level_label(self.level)} by {level_label(self.finer)}"


def meridian_checks(results: PaperResults) -> tuple[Check, ...]:
    """Band of every axisymmetric mesh, from it and the coarser ones, against the next finer mesh; all cases."""
    return _checks(results, _meridian_checks)


def body_checks(results: PaperResults) -> tuple[Check, ...]:
    """Stated band of every full 3D mesh, from it and the coarser ones, against the finest mesh; all cases."""
    return _checks(results, _body_checks)


def _checks(results: PaperResults, of: Callable[[CaseResult, CaseResult | None], list[Check]]) -> tuple[Check, ...]:
    """Checks of every case, with that of finer meshes of the same scene if there is one."""
    found: list[Check] = []
    for case in results.cases:
        if case.case.group in ("core", "alternates"):
            found += of(case, results.variant(case.case.base, "audit"))
        elif case.case.group != "audit":
            found += of(case, None)
    return tuple(found)


def _meridian_checks(case: CaseResult, audit: CaseResult | None) -> list[Check]:
    """A band takes two meshes."""
    runs = case.axisymmetric
    own = max((fineness(run.summary.level) for run in runs), default=0)
    more = [run for run in (audit.axisymmetric if audit else ()) if fineness(run.summary.level) > own]
    found = []
    for count, finer in enumerate([*runs, *more][2:], start=2):
        if count <= len(runs):
            found += _against(case, scene_rows(case.scene, runs[:count]), runs[count - 1], finer)
    return found


def _body_checks(case: CaseResult, audit: CaseResult | None) -> list[Check]:
    """A band takes one mesh, beside the axisymmetric runs and the sectors."""
    runs = sorted([*case.full3d, *(audit.full3d if audit else ())], key=lambda run: ranking(run.summary.level))
    found = []
    for count, run in enumerate(case.full3d, start=1):
        if run is not runs[-1]:
            rows = scene_rows(case.scene, case.axisymmetric, case.sector, case.full3d[:count])
            found += _against(case, rows, run, runs[-1])
    return found


def _against(case: CaseResult, rows: Sequence[Row], run: Run, finer: Run) -> list[Check]:
    """Bands in rows of one run against another run at every requested pressure that both reached."""
    quantity, model, level = main_quantity(case.scene), run.summary.model, run.summary.level
    found = []
    for pressure in case.pressures_kpa:
        row, fine = find(rows, quantity, model, pressure, level), tip_at(finer, pressure, quantity)
        if math.isfinite(row.value + row.uncertainty + fine):
            band = (row.value, row.uncertainty, fine)
            found.append(Check(case.case.scene, model, pressure, level, finer.summary.level, *band))
    return found


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
    audits = _audits(results).items()
    return [*found, *(_share(f"{label}: all meshes, all cases", checks) for label, checks in audits)]


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
    for label, checks in _audits(results).items():
        for meshes in dict.fromkeys(check.meshes for check in checks):
            of_meshes = [check for check in checks if check.meshes == meshes]
            plain = [check for check in of_meshes if check.case in actuators]
            found.append(_share(f"{label}: {meshes}, reference and alternates", plain))
            found.append(_share(f"{label}: {meshes}, all cases", of_meshes))
    return found


def _audits(results: PaperResults) -> dict[str, tuple[Check, ...]]:
    return {
        "axisymmetric bands that hold the next finer mesh": meridian_checks(results),
        "full 3D bands that hold the finest mesh": body_checks(results),
    }


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


def _share(what: str, checks: Sequence[Check]) -> Bar:
    wanted = f"{what}: at least {INSIDE_PERCENT:g} %"
    if not checks:
        return Bar(wanted, MISSING, None, decides=False)
    inside = sum(check.inside for check in checks)
    share = 100.0 * inside / len(checks)
    return Bar(wanted, f"{share:.1f} % ({inside} of {len(checks)})", share >= INSIDE_PERCENT, decides=False)


def misses(results: PaperResults) -> Table:
    """Every band that does not hold the finer mesh's value (mm, or N of a blocked tip)."""
    columns: dict[str, Callable[[Check], str]] = {
        "case": lambda check: check.case,
        "pressure, kPa": lambda check: f"{check.pressure_kpa:g}",
        "mesh of the band": lambda check: run_label(check.model, check.level),
        "value and band": lambda check: f"{check.value:.4f} ± {up(check.band, 4)}",
        "finer mesh": lambda check: f"{level_label(check.finer)}: {check.finer_value:.4f}",
        "distance over band": lambda c: f"{abs(c.finer_value - c.value) / c.band:.2g}" if c.band else MISSING,
    }
    checks = (*meridian_checks(results), *body_checks(results))
    return table_of((check for check in checks if not check.inside), columns, left=(0, 2))
