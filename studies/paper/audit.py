"""Are the uncertainties true? Each, made from coarser meshes alone, has to hold the limit that finer ones lead to.

The limit is that of the three finest axisymmetric meshes, one of them finer than all that the uncertainty is made from
(`studies.results.uncertainty`). Where cells round the axis matter too, the limit is the same: the axisymmetric model is
exact.
"""

from __future__ import annotations

import functools
import itertools
import math
import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from studies.paper.results import CaseResult, PaperResults, find
from studies.planning.levels import LIMIT, fineness, ranking
from studies.report.labels import level_label, run_label
from studies.report.numbers import MISSING, up
from studies.report.tables import Table, table_of
from studies.results.bellows_rows import bellows_rows
from studies.results.rows import Row
from studies.results.runs import MERIDIAN_ORDERS, Run, tip_at
from studies.results.uncertainty import EDGE_ORDER, LOWEST_ORDER, convergence, extrapolated, observed_order

MERIDIANS = "axisymmetric uncertainties that hold the limit"
BODIES = "full 3D uncertainties that hold the limit"
FINER_BODIES = "full 3D uncertainties that hold a finer full 3D mesh"
AS_OBSERVED = "the same, limit by the order as it is observed"
# Below this the values have hardly begun to converge, and what the order as it is observed leads to is anything.
LEAST_ORDER = 0.05


@dataclass(frozen=True)
class Target:
    """What an uncertainty has to hold, mm or N, the meshes that tell it, and in words how they do."""

    value: float
    levels: tuple[str, ...]
    how: str = ""

    @property
    def text(self) -> str:
        """The value and where it comes from."""
        return f"{self.value:.4f} ({', '.join(level_label(level) for level in self.levels)}{self.how})"


@dataclass(frozen=True)
class Check:
    """An uncertainty, which is that of a row of a case, and what it has to hold."""

    case: str
    row: Row
    target: Target

    @property
    def inside(self) -> bool:
        """True if it holds."""
        return self.distance <= self.row.uncertainty

    @property
    def distance(self) -> float:
        """From the row's value to the target, mm or N."""
        return abs(self.target.value - self.row.value)

    @property
    def meshes(self) -> str:
        """What is tested by what."""
        return f"{level_label(self.row.level)} by {', '.join(level_label(level) for level in self.target.levels)}"


@functools.lru_cache(maxsize=1)
def checks(results: PaperResults) -> dict[str, list[Check]]:
    """All uncertainties by what they have to hold."""
    meridians = [check for case in results.cases for check in _meridian_checks(case, _all_meridians(results, case))]
    bodies = [check for case in results.of("core", "tets") for check in _body_checks(results, case)]
    finer = [check for case in results.of("core") for check in _finer_body_checks(results, case)]
    return {MERIDIANS: meridians, BODIES: bodies, FINER_BODIES: finer}


def as_observed(results: PaperResults) -> list[Check]:
    """The axisymmetric checks with limits by the observed order, however low or high; monotone values only."""
    found = ((case, _all_meridians(results, case)) for case in results.cases)
    return [check for case, runs in found for check in _meridian_checks(case, runs, _limit_as_observed)]


def limit(sizes: Sequence[float], values: Sequence[float]) -> tuple[float, str]:
    """Limit of three values, and how it was told."""
    order = observed_order(sizes, values)
    how = "not monotone" if order is None else f"order {min(max(order, EDGE_ORDER), MERIDIAN_ORDERS.smooth):.2f}"
    if order is not None and order < LOWEST_ORDER:
        how = f"both orders, {order:.2f} is none"
    return convergence(sizes, values, MERIDIAN_ORDERS).limit, f", {how}"


def _limit_as_observed(sizes: Sequence[float], values: Sequence[float]) -> tuple[float, str]:
    order = observed_order(sizes, values)
    if order is None or order < LEAST_ORDER:
        return math.nan, ""
    return extrapolated(sizes, values, order), f", order {order:.2f}"


Limit = Callable[[Sequence[float], Sequence[float]], tuple[float, str]]


def _all_meridians(results: PaperResults, case: CaseResult) -> tuple[Run, ...]:
    """A case's axisymmetric runs and finer ones of its audit, if it has any."""
    if case.case.group == "audit":
        return ()
    runs = case.axisymmetric
    audit = results.variant(case.case.base, "audit") if case.case.group in ("core", "alternates") else None
    own = _finest(runs)
    return (*runs, *(run for run in (audit.axisymmetric if audit else ()) if fineness(run.summary.level) > own))


def _finest(runs: Sequence[Run]) -> int:
    return max((fineness(run.summary.level) for run in runs), default=0)


def _meridian_checks(case: CaseResult, meridians: Sequence[Run], told: Limit = limit) -> Iterator[Check]:
    """Of every axisymmetric mesh, from it and the coarser ones; it takes two, and one that is finer."""
    runs = case.axisymmetric
    for count in range(2, len(runs) + 1):
        rows = bellows_rows(case.scene, runs[:count])
        targets = _targets(case, meridians, told, finer_than=fineness(runs[count - 1].summary.level))
        yield from _against(case, rows, runs[count - 1], targets, LIMIT)


def _body_checks(results: PaperResults, case: CaseResult) -> Iterator[Check]:
    """Of every full 3D mesh, with all meridians of its case; the limit by those of the audit.

    Tetrahedra and hexahedra lead to one limit.
    """
    core = results.variant(case.case.base, "core")
    if core.axisymmetric:
        targets = _targets(case, _all_meridians(results, core), limit, finer_than=_finest(case.axisymmetric))
        for run, rows in _body_rows(case):
            yield from _against(case, rows, run, targets, LIMIT)


def _finer_body_checks(results: PaperResults, case: CaseResult) -> Iterator[Check]:
    """Of every full 3D mesh by the audit's, where there is one."""
    audit = results.variant(case.case.base, "audit").full3d
    for finest in sorted(audit, key=lambda run: ranking(run.summary.level))[-1:]:
        values = {p: tip_at(finest, p, case.scene.main_quantity) for p in case.pressures_kpa}
        targets = {p: Target(value, (finest.summary.level,)) for p, value in values.items()}
        for run, rows in _body_rows(case):
            yield from _against(case, rows, run, targets)


def _body_rows(case: CaseResult) -> Iterator[tuple[Run, list[Row]]]:
    for count, run in enumerate(case.full3d, start=1):
        yield run, bellows_rows(case.scene, [*case.axisymmetric, *case.full3d[:count]])


def _targets(case: CaseResult, runs: Sequence[Run], told: Limit, finer_than: int) -> dict[float, Target]:
    """Limits by pressure, kPa, of the three finest runs that reached it, one of them finer than a meridian."""
    found = {}
    for pressure in case.pressures_kpa:
        values = {run.summary.level: tip_at(run, pressure, case.scene.main_quantity) for run in runs}
        levels = [level for level, value in values.items() if not math.isnan(value)][-3:]
        if len(levels) == 3 and fineness(levels[-1]) > finer_than:
            value, how = told([1.0 / fineness(level) for level in levels], [values[level] for level in levels])
            found[pressure] = Target(value, tuple(levels), how)
    return found


def _against(
    case: CaseResult, rows: Sequence[Row], run: Run, targets: Mapping[float, Target], *more: str
) -> Iterator[Check]:
    """Rows of a run, and of more levels, against targets at every requested pressure that has both."""
    for (pressure, target), level in itertools.product(targets.items(), (run.summary.level, *more)):
        row = find(rows, case.scene.main_quantity, run.summary.model, pressure, level)
        if math.isfinite(row.value + row.uncertainty + target.value):
            yield Check(case.case.scene, row, target)


# --- tables ---------------------------------------------------------------------------------


def coverage(results: PaperResults) -> Table:
    """How many uncertainties hold, by how much the worst misses, and how wide they are."""
    groups = dict(checks(results))
    groups[AS_OBSERVED] = as_observed(results)
    columns: dict[str, Callable[[tuple[str, Sequence[Check]]], str]] = {
        "what": lambda group: group[0],
        "hold": lambda group: f"{sum(check.inside for check in group[1])} of {len(group[1])}",
        "worst miss, distance over ±": lambda group: _worst(group[1]),
        "median of ± over distance": lambda group: _median(group[1]),
    }
    return table_of(((what, of) for what, of in _by_meshes(groups) if of), columns, left=(0,))


def _by_meshes(groups: Mapping[str, Sequence[Check]]) -> Iterator[tuple[str, Sequence[Check]]]:
    for what, of in groups.items():
        for meshes in dict.fromkeys(check.meshes for check in of):
            yield f"{what}: {meshes}", [check for check in of if check.meshes == meshes]


def _worst(of: Sequence[Check]) -> str:
    missed = [_factor(check) for check in of if not check.inside]
    return f"{max(missed):.2g}" if missed else MISSING


def _median(of: Sequence[Check]) -> str:
    ratios = [check.row.uncertainty / check.distance for check in of if check.distance]
    return f"{statistics.median(ratios):.2g}" if ratios else MISSING


def _factor(check: Check) -> float:
    return check.distance / check.row.uncertainty if check.row.uncertainty else math.inf


def misses(results: PaperResults) -> Table:
    """Every uncertainty that does not hold what it has to (mm, or N of a blocked tip)."""
    columns: dict[str, Callable[[Check], str]] = {
        "case": lambda check: check.case,
        "pressure, kPa": lambda check: f"{check.row.pressure_kpa:g}",
        "mesh": lambda check: run_label(check.row.model, check.row.level),
        "value": lambda check: f"{check.row.value:.4f} ± {up(check.row.uncertainty, 4)}",
        "has to hold": lambda check: check.target.text,
        "distance over ±": lambda check: f"{_factor(check):.2g}",
    }
    return table_of((c for of in checks(results).values() for c in of if not c.inside), columns, left=(0, 2, 4))
