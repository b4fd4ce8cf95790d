"""Verdicts on numbers with uncertainties: what a difference decides, and what it does not."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final, Literal

from studies.results.rows import Row

Verdict = Literal["holds", "does not hold", "cannot tell"]
HOLDS: Final = "holds"
FAILS: Final = "does not hold"
UNDECIDED: Final = "cannot tell"
# Ours: of so many sets the verdict has to be one for it to be that of actuators whose dimensions nobody knows.
ALIKE: Final = 0.9


def smaller(one: Row, other: Row) -> Verdict:
    """Whether a row's value is smaller than another's by more than the sum of their uncertainties."""
    gap, doubt = other.value - one.value, one.uncertainty + other.uncertainty
    if not abs(gap) > doubt:  # NaN decides nothing
        return UNDECIDED
    return HOLDS if gap > 0.0 else FAILS


def all_of(verdicts: Iterable[Verdict]) -> Verdict:
    """Verdict on a claim made of several: one that fails settles it."""
    found = list(verdicts)
    if FAILS in found:
        return FAILS
    return HOLDS if found and UNDECIDED not in found else UNDECIDED


def over_sets(reference: Verdict, others: Sequence[Verdict]) -> Verdict:
    """Verdict of the reference, if nearly all other sets that were run have the same."""
    alike = sum(verdict == reference for verdict in others)
    return reference if alike >= ALIKE * len(others) else UNDECIDED


def above(value: tuple[float, float], limit: float) -> Verdict:
    """Whether a value with its uncertainty is above a limit."""
    if not abs(value[0] - limit) > value[1]:
        return UNDECIDED
    return HOLDS if value[0] > limit else FAILS


def below(value: tuple[float, float], limit: float) -> Verdict:
    """Whether a value with its uncertainty is below a limit."""
    opposite: dict[Verdict, Verdict] = {HOLDS: FAILS, FAILS: HOLDS, UNDECIDED: UNDECIDED}
    return opposite[above(value, limit)]
