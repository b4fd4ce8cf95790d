"""How the paper study's numbers are looked up and written: shared by its claims and its tables."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Final

from analytical.bellows.paper import FAMILIES, PRINTED_PRESSURE_KPA, InferredFamily, PaperActuator, actuators
from studies.paper.results import CaseResult, PaperResults, find
from studies.report.labels import TIP
from studies.report.numbers import MISSING, signed, up
from studies.results.files import PathRow
from studies.results.rows import FOLDED_BACK, REACHED, Row, difference_percent
from studies.results.runs import Run

PRESSURES_KPA: Final = (5.0, 10.0, 15.0, 20.0)
HIGHEST_KPA: Final = PRINTED_PRESSURE_KPA
MINUS = "\N{MINUS SIGN}"

_LIMIT = re.compile(r"up to ([\d.]+) kPa")


def sets() -> tuple[tuple[str, tuple[PaperActuator, ...]], ...]:
    """The three sets of inferred dimensions: what a table calls them, and their four actuators."""
    return tuple((set_label(family), actuators(family)) for family in FAMILIES)


def set_label(family: InferredFamily) -> str:
    """What a table calls a set of dimensions."""
    return f"alternate {family.label}" if family.label else "reference"


def slot_label(actuator: PaperActuator) -> str:
    """Which of the paper's four actuators it is, whatever its dimensions."""
    root = "larger R_i" if actuator.printed.has_larger_root else "R_i = 5 mm"
    return f"t = {actuator.printed.wall_mm:g} mm, {root}"


def named(results: PaperResults, name: str) -> CaseResult | None:
    """An actuator's own case, of the reference set or of an alternate; None if it is missing."""
    return next((case for case in results.of("core", "alternates") if case.case.name == name), None)


def tip(
    case: CaseResult | None,
    model: str = "axisymmetric",
    pressure_kpa: float = HIGHEST_KPA,
    quantity: str = TIP,
    level: str | None = None,
) -> Row | None:
    """Row of a model at a pressure (kPa), of a level or of the finest; None without the case or the row."""
    return find(case.rows, quantity, model, pressure_kpa, level) if case else None


def common_levels(one: CaseResult | None, other: CaseResult | None) -> list[str]:
    """Axisymmetric meshes that both cases have, the finest first."""
    if one is None or other is None:
        return []
    have = {run.summary.level for run in other.result.axisymmetric}
    return [run.summary.level for run in reversed(one.result.axisymmetric) if run.summary.level in have]


def measured(case: CaseResult | None, quantity: str, model: str, pressure_kpa: float | None = None) -> Row | None:
    """Finest row of what was measured in a case's states; None without it."""
    return find(case.measured, quantity, model, pressure_kpa) if case else None


def best(case: CaseResult | None, pressure_kpa: float = HIGHEST_KPA) -> Row | None:
    """Elongation (mm) of the finest full 3D run, else of the finest axisymmetric one, that reached a pressure (kPa)."""
    rows = (tip(case, model, pressure_kpa) for model in ("full3d", "axisymmetric"))
    return next((row for row in rows if is_known(row)), None)


def unfolding(results: PaperResults, base: str, model: str) -> Row | None:
    """Pressure (kPa) at which a scene's roots are unfolded; from the run to 30 kPa if that to 20 kPa ends before."""
    rows = [measured(results.variant(base, group), "unfolding_kpa", model) for group in ("core", "beyond")]
    return next((row for row in rows if is_known(row)), rows[1] or rows[0])


def limit_kpa(row: Row) -> float:
    """Up to which pressure (kPa) something was looked for and not found, from its row's status; NaN if unsaid."""
    found = _LIMIT.search(row.status)
    return float(found[1]) if found else math.nan


def is_known(row: Row | None) -> bool:
    """True for a row with a number."""
    return row is not None and math.isfinite(row.value)


def means_something(row: Row | None) -> bool:
    """True for a row with a number, except that of a closed form past its model."""
    return row is not None and is_known(row) and row.status != FOLDED_BACK


def finest(runs: Sequence[Run]) -> Run | None:
    """The last of runs that are in order, coarsest first."""
    return runs[-1] if runs else None


def last_kpa(run: Run) -> float:
    """Highest pressure of a run's states, kPa; 0 if it has none."""
    return max((state.pressure_kpa for state in run.path), default=0.0)


def asked_state(run: Run | None, pressure_kpa: float = HIGHEST_KPA) -> PathRow | None:
    """State of a run at a requested pressure (kPa); None if it was not reached."""
    asked = (s for s in run.path if s.status == "requested") if run else ()
    return next((s for s in asked if math.isclose(s.pressure_kpa, pressure_kpa, rel_tol=1e-6)), None)


def modes(run: Run | None, pressure_kpa: float = HIGHEST_KPA) -> str:
    """Number of unstable modes at a requested pressure (kPa); a dash where it was not counted."""
    state = asked_state(run, pressure_kpa)
    return MISSING if state is None or math.isnan(state.unstable_modes) else f"{state.unstable_modes:.0f}"


# --- text -----------------------------------------------------------------------------------


def number(row: Row | None) -> str:
    """Any measured number and its uncertainty; its status where there is none, a dash without a row."""
    if row is None:
        return MISSING
    if not math.isfinite(row.value):
        return row.status.split(":")[0] if row.status != REACHED else MISSING
    if not row.uncertainty > 0.0:
        return f"{row.value:.4g}"
    decimals = min(max(1 - math.floor(math.log10(row.uncertainty)), 0), 4)
    return f"{row.value:.{decimals}f} ± {up(row.uncertainty, decimals)}"


def signed_number(value: float, decimals: int = 2) -> str:
    """A number with its sign; a dash for NaN."""
    return f"{value:+.{decimals}f}".replace("-", MINUS) if math.isfinite(value) else MISSING


def difference(row: Row | None, reference: Row | None, decimals: int = 2) -> str:
    """Signed difference of two rows in their unit, and in percent of the second; a dash where one is missing."""
    if row is None or reference is None or not is_known(row) or not is_known(reference) or reference.value == 0.0:
        return MISSING
    percent = signed(difference_percent(row.value, reference.value))
    return f"{signed_number(row.value - reference.value, decimals)} ({percent} %)"
