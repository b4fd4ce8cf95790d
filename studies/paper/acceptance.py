"""What the study must show: its uncertainties small and true (`studies.paper.audit`), its models in agreement.

Only that the four actuators reach their pressures decides the exit code.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from studies.engine import Bar
from studies.paper.audit import Check, checks
from studies.paper.cases import (
    CONTROL_BODY,
    CONTROL_BODY_LEVEL,
    CONTROL_KPA,
    HIGHEST_KPA,
    PRESSURES_KPA,
    REFERENCE_SCENES,
)
from studies.paper.results import CaseResult, PaperResults, is_known
from studies.report.labels import TIP, run_label
from studies.report.numbers import MISSING, rounded_up
from studies.results.rows import REACHED, difference_percent

UNCERTAINTY_PERCENT: Final = 1.0
GAP_PERCENT: Final = 0.5
INSIDE_PERCENT: Final = 95.0
# The whole body and the quarter are one discrete problem: what differs are round-off and Newton's last digits.
SAME: Final = 1e-9


def bars(results: PaperResults) -> list[Bar]:
    """All bars: those that decide the exit code, the main ones, and those that say more about these."""
    return [*(_reached(results.named(name)) for name in REFERENCE_SCENES), *main_bars(results), *_more(results)]


def main_bars(results: PaperResults) -> list[Bar]:
    """What the study must show in short: uncertainties and gaps at 20 kPa, and how many uncertainties hold."""
    found = []
    for name in REFERENCE_SCENES:
        solid = results.named(name).tip("full3d")
        share = 100.0 * solid.uncertainty / abs(solid.value)
        found.append(_at_most(f"{name}: uncertainty of full 3D at {HIGHEST_KPA:g} kPa", UNCERTAINTY_PERCENT, share))
        gap = _gap_percent(results.named(name), [HIGHEST_KPA])
        found.append(_at_most(f"{name}: axisymmetric from full 3D at {HIGHEST_KPA:g} kPa", GAP_PERCENT, gap))
    return [*found, *(_share(f"{label}: all meshes, all cases", of) for label, of in checks(results).items())]


def _more(results: PaperResults) -> list[Bar]:
    found = [_same_tip(results), _same_modes(results)]
    found += [
        _at_most(
            f"{name}: axisymmetric from full 3D, worst pressure",
            GAP_PERCENT,
            _gap_percent(results.named(name), PRESSURES_KPA),
        )
        for name in REFERENCE_SCENES
    ]
    for label, of_model in checks(results).items():
        for meshes in dict.fromkeys(check.meshes for check in of_model):
            found.append(_share(f"{label}: {meshes}", [check for check in of_model if check.meshes == meshes]))
    return found


def _reached(case: CaseResult) -> Bar:
    """That the answer of an actuator reached every requested pressure."""
    wanted = f"{case.case.scene}: every requested pressure is reached"
    runs = case.full3d or case.axisymmetric
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


def _controls(results: PaperResults, quantity: str) -> list[tuple[float, float]]:
    """A quantity of the actuator that is solved on a quarter too, with that of its whole body, by pressure."""
    both = results.named(CONTROL_BODY), results.variant(CONTROL_BODY, "control")
    level = CONTROL_BODY_LEVEL.name
    pairs = ([case.row(quantity, "full3d", p, level) for case in both] for p in CONTROL_KPA)
    return [(one.value, other.value) for one, other in pairs if is_known(one) and is_known(other)]


def _same_tip(results: PaperResults) -> Bar:
    """That mirrored states are the whole body's."""
    wanted = f"{CONTROL_BODY}: elongation on a quarter is the whole body's, within {SAME:g}"
    worst = max((abs(one / other - 1.0) for one, other in _controls(results, TIP)), default=math.nan)
    return Bar(wanted, MISSING if math.isnan(worst) else f"{worst:.1e}", _met(worst, SAME), decides=False)


def _same_modes(results: PaperResults) -> Bar:
    """That the count by parity classes is the whole body's."""
    wanted = f"{CONTROL_BODY}: unstable modes by parity classes are the whole body's"
    pairs = _controls(results, "unstable_modes")
    found = ", ".join(f"{one:g} and {other:g}" for one, other in pairs)
    return Bar(wanted, found or MISSING, all(one == other for one, other in pairs) if pairs else None, decides=False)


def _met(value: float, limit: float) -> bool | None:
    return None if math.isnan(value) else value <= limit


def _at_most(what: str, limit: float, percent: float) -> Bar:
    """A bar that does not decide the exit code."""
    wanted = f"{what}: at most {limit:g} %"
    found = MISSING if math.isnan(percent) else f"{rounded_up(percent, 2):g} %"
    return Bar(wanted, found, _met(percent, limit), decides=False)


def _share(what: str, of: Sequence[Check]) -> Bar:
    wanted = f"{what}: at least {INSIDE_PERCENT:g} %"
    if not of:
        return Bar(wanted, MISSING, None, decides=False)
    inside = sum(check.inside for check in of)
    share = 100.0 * inside / len(of)
    return Bar(wanted, f"{share:.1f} % ({inside} of {len(of)})", share >= INSIDE_PERCENT, decides=False)
