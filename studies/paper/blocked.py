"""What the paper study says of blocked tips beside its table: where they bend sideways, where folds touch."""

from __future__ import annotations

import math
from collections.abc import Iterable

from studies.models.contact import LIMIT
from studies.models.modes import FoundCrossing
from studies.paper.results import CaseResult, PaperResults
from studies.paper.setup.sizes import CALLED


def sideways(case: CaseResult) -> FoundCrossing | None:
    """Where the axisymmetric state of a case first bends sideways (m = 1); None if it does not, or is not counted."""
    found = [crossing for crossing in case.crossings if crossing.waves == 1]
    return min(found, key=lambda crossing: crossing.pressure_kpa, default=None)


def first_touch(case: CaseResult) -> tuple[float, float] | None:
    """Pressures (kPa) of the last open state of the finest axisymmetric path and of the first in which folds touch."""
    before = 0.0
    for run in case.axisymmetric[-1:]:
        for state in run.path:
            if state.min_gap_mm <= LIMIT * case.scene.geometry.wall_mm:
                return before, state.pressure_kpa
            before = state.pressure_kpa
    return None


def blocked_sentences(results: PaperResults) -> list[str]:
    """Where blocked actuators bend sideways and where their folds touch, a sentence each."""
    cases = results.of("blocked")
    bent = [(case, at) for case in cases if (at := sideways(case))]
    touching = [(case, span) for case in cases if (span := first_touch(case))]
    said = []
    if bent:
        said.append(
            "An actuator that is not guided bends sideways (m = 1) "
            + _listed(f"from {at.pressure_kpa:.2g} kPa on ({CALLED[case.case.base]})" for case, at in bent)
            + "."
        )
    if touching:
        said.append(
            "Surfaces touch first "
            + _listed(
                f"between {low:.3g} and {high:.3g} kPa ({CALLED[case.case.base]})" for case, (low, high) in touching
            )
            + "; contact is modelled from there on."
        )
    known = [case for case in cases if case.axisymmetric and not first_touch(case)]
    gaps = [(case, min(s.min_gap_mm for s in case.axisymmetric[-1].path)) for case in known]
    known_gaps = [(case, gap) for case, gap in gaps if math.isfinite(gap)]
    if known_gaps:
        open_ = _listed(f"{gap:.2f} mm ({CALLED[case.case.base]})" for case, gap in known_gaps)
        said.append(f"Without touch, the least gap on the way is {open_}.")
    return said


def _listed(parts: Iterable[str]) -> str:
    return ", ".join(parts)
