"""What the study must show: its uncertainties small, its models in agreement, its bands true.

A band is audited by the next finer mesh: made from the coarser meshes alone, it has to hold the finer one's value.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from studies.paper.cases import REFERENCE_SCENES
from studies.paper.numbers import HIGHEST_KPA, PRESSURES_KPA, is_known, named, tip
from studies.paper.results import CaseResult, PaperResults, find
from studies.planning.levels import fineness, ranking
from studies.report.labels import level_label, run_label
from studies.report.numbers import MISSING, rounded_up, up
from studies.report.tables import Table
from studies.results.bellows_rows import bellows_rows
from studies.results.rows import Row, difference_percent
from studies.results.runs import Run, tip_at

UNCERTAINTY_PERCENT, GAP_PERCENT, INSIDE_PERCENT = 1.0, 0.5, 95.0

_MET: Final = {True: "met", False: "not met"}


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


def meridian_checks(results: PaperResults) -> tuple[Check, ...]:
    """Band of every axisymmetric mesh, from it and the coarser ones, against the next finer mesh; all cases."""
    return tuple(check for case in _audited(results) for check in _meridian_checks(case, _finer(results, case)))


def body_checks(results: PaperResults) -> tuple[Check, ...]:
    """Stated band of every full 3D mesh, from it and the coarser ones, against the finest mesh; all cases."""
    return tuple(check for case in _audited(results) for check in _body_checks(case, _finer(results, case)))


def _audited(results: PaperResults) -> tuple[CaseResult, ...]:
    return tuple(case for case in results.cases if case.case.group != "audit")


def _finer(results: PaperResults, case: CaseResult) -> CaseResult | None:
    """The case with finer meshes of the same scene."""
    return results.variant(case.case.base, "audit") if case.case.group in ("core", "alternates") else None


def _meridian_checks(case: CaseResult, audit: CaseResult | None) -> list[Check]:
    """A band takes two meshes."""
    runs = list(case.result.axisymmetric)
    finest = max((fineness(run.summary.level) for run in runs), default=0)
    more = [r for r in (audit.result.axisymmetric if audit else ()) if fineness(r.summary.level) > finest]
    found = []
    for count, finer in enumerate([*runs, *more][2:], start=2):
        if count <= len(runs):
            found += _checks(case, bellows_rows(case.result.scene, runs[:count]), runs[count - 1], finer)
    return found


def _body_checks(case: CaseResult, audit: CaseResult | None) -> list[Check]:
    """A band takes one mesh, beside the axisymmetric runs and the sectors."""
    result, found = case.result, []
    runs = sorted([*result.full3d, *(audit.result.full3d if audit else ())], key=lambda r: ranking(r.summary.level))
    for count, run in enumerate(result.full3d, start=1):
        if run is not runs[-1]:
            rows = bellows_rows(result.scene, [*result.axisymmetric, *result.sector, *result.full3d[:count]])
            found += _checks(case, rows, run, runs[-1])
    return found


def _checks(case: CaseResult, rows: Sequence[Row], run: Run, finer: Run) -> list[Check]:
    """Bands in rows of one run against another run at every requested pressure that both reached."""
    quantity, model, level = case.result.scene.main_quantity, run.summary.model, run.summary.level
    found = []
    for pressure in case.result.scene.load.pressure_kpa:
        row, fine = find(rows, quantity, model, pressure, level), tip_at(finer, pressure, quantity)
        if row and is_known(row) and math.isfinite(row.uncertainty) and math.isfinite(fine):
            band = (row.value, row.uncertainty, fine)
            found.append(Check(case.case.name, model, pressure, level, finer.summary.level, *band))
    return found


def acceptance(results: PaperResults) -> Table:
    """What must be shown, what is found, and whether it is met; a dash where nothing has been run."""
    lines = [line for name in REFERENCE_SCENES for line in _actuator_lines(results, name)]
    audits = {
        "axisymmetric bands that hold the next finer mesh": meridian_checks(results),
        "full 3D bands that hold the finest mesh": body_checks(results),
    }
    actuators = {case.case.name for case in results.of("core", "alternates")}
    for label, checks in audits.items():
        for kind, of_kind in _by_levels(checks).items():
            plain = [check for check in of_kind if check.case in actuators]
            lines.append(_share(f"{label}: {kind}, reference and alternates", plain))
            lines.append(_share(f"{label}: {kind}, all cases", of_kind))
        lines.append(_share(f"{label}: all meshes, all cases", checks))
    return Table(("what must be shown", "wanted", "found", "verdict"), tuple(lines), left=(0, 3))


def misses(results: PaperResults) -> Table:
    """Every band that does not hold the finer mesh's value (mm, or N of a blocked tip)."""
    lines = tuple(
        (
            check.case,
            f"{check.pressure_kpa:g}",
            run_label(check.model, check.level),
            f"{check.value:.4f} ± {up(check.band, 4)}",
            f"{level_label(check.finer)}: {check.finer_value:.4f}",
            f"{abs(check.finer_value - check.value) / check.band:.2g}" if check.band else MISSING,
        )
        for check in (*meridian_checks(results), *body_checks(results))
        if not check.inside
    )
    header = ("case", "pressure, kPa", "mesh of the band", "value and band", "finer mesh", "distance over band")
    return Table(header, lines, left=(0, 2))


def _actuator_lines(results: PaperResults, name: str) -> list[tuple[str, ...]]:
    case = named(results, name)
    solid = tip(case, "full3d")
    shares = [100.0 * solid.uncertainty / abs(solid.value)] if solid and is_known(solid) else []
    gap = _gaps(case, [HIGHEST_KPA])
    worst = _gaps(case, PRESSURES_KPA)
    at = f"at {HIGHEST_KPA:g} kPa"
    return [
        _line(f"{name}: uncertainty of full 3D {at}", UNCERTAINTY_PERCENT, shares),
        _line(f"{name}: axisymmetric from full 3D {at}", GAP_PERCENT, gap),
        _line(f"{name}: axisymmetric from full 3D, worst pressure", GAP_PERCENT, [max(worst)] if worst else []),
    ]


def _gaps(case: CaseResult | None, pressures_kpa: Sequence[float]) -> list[float]:
    """Percent between the axisymmetric and the full 3D elongation where both have one."""
    pairs: list[tuple[Row | None, Row | None]] = [
        (tip(case, "axisymmetric", p), tip(case, "full3d", p)) for p in pressures_kpa
    ]
    return [
        abs(difference_percent(one.value, other.value))
        for one, other in pairs
        if one and other and is_known(one) and is_known(other)
    ]


def _line(what: str, limit: float, found: Sequence[float]) -> tuple[str, ...]:
    wanted = f"≤ {limit:g} %"
    if not found or math.isnan(found[0]):
        return what, wanted, MISSING, "not run"
    return what, wanted, f"{rounded_up(found[0], 2):g} %", _MET[found[0] <= limit]


def _share(what: str, checks: Sequence[Check]) -> tuple[str, ...]:
    wanted = f"≥ {INSIDE_PERCENT:g} %"
    if not checks:
        return what, wanted, MISSING, "not run"
    inside = sum(check.inside for check in checks)
    share = 100.0 * inside / len(checks)
    return what, wanted, f"{share:.1f} % ({inside} of {len(checks)})", _MET[share >= INSIDE_PERCENT]


def _by_levels(checks: Iterable[Check]) -> dict[str, list[Check]]:
    """Checks by what is tested: band of which mesh by which."""
    kinds: dict[str, list[Check]] = {}
    for check in checks:
        kinds.setdefault(f"{level_label(check.level)} by {level_label(check.finer)}", []).append(check)
    return kinds
