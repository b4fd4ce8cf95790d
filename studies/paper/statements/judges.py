"""Statements of the paper that the four actuators of any set decide: elongations, bulges, the curve, unfolding.

A judge takes the four actuators of a set. A difference that is not larger than the sum of the uncertainties decides
nothing.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from studies.paper.cases import HIGHEST_KPA, PRESSURES_KPA
from studies.paper.results import CaseResult, Four, is_known, limit_kpa
from studies.paper.statements.verdicts import FAILS, UNDECIDED, Verdict, above, all_of, below, smaller
from studies.report.labels import TIP
from studies.report.numbers import MISSING, measured_text, value_text
from studies.results.rows import Row, difference_percent

# The actuators in the order of the paper's numbers.
SLOTS: Final = (
    "t = 1 mm, R_i = 5 mm",
    "t = 1 mm, larger R_i",
    "t = 2 mm, R_i = 5 mm",
    "t = 2 mm, larger R_i",
)


@dataclass(frozen=True)
class Judgement:
    """What a set says of a statement.

    Attributes
    ----------
    verdict
        Of the four together.
    pair
        The two numbers that decide it, those that are nearest to deciding otherwise.
    parts, pairs
        Of each actuator, where the statement is about each of them.
    """

    verdict: Verdict
    pair: str = MISSING
    parts: tuple[Verdict, ...] = ()
    pairs: tuple[str, ...] = ()


Judge = Callable[[Four], Judgement]


def nearest(found: Iterable[tuple[float, str]]) -> str:
    """The text of the smallest number that is one; a dash if there is none."""
    known = [(margin, text) for margin, text in found if math.isfinite(margin)]
    return min(known, default=(0.0, MISSING))[1]


def of_each(judge: Callable[[CaseResult], tuple[Verdict, float, str]]) -> Judge:
    """A judge of a statement about every actuator.

    Parameters
    ----------
    judge
        Of one: its verdict, by how much (the smaller, the nearer to failing), and its two numbers.
    """

    def of_four(four: Four) -> Judgement:
        found = [judge(case) if case.axisymmetric else (UNDECIDED, math.nan, MISSING) for case in four.cases]
        pair = nearest((margin, f"{text} ({slot})") for (_, margin, text), slot in zip(found, SLOTS, strict=True))
        parts, _, pairs = zip(*found, strict=True)
        return Judgement(all_of(parts), pair, parts, pairs)

    return of_four


# --- elongations and bulges -----------------------------------------------------------------


def ordered(quantity: str, pairs: Mapping[str, tuple[int, int]]) -> Judge:
    """That of each named pair of actuators the first has the smaller value, mm, at all pressures."""

    def of_four(four: Four) -> Judgement:
        verdicts, near = [], []
        for name, places in pairs.items():
            for pressure in PRESSURES_KPA:
                low, high = (four.cases[place].row(quantity, pressure_kpa=pressure) for place in places)
                verdicts.append(smaller(low, high))
                near.append((_margin(low, high), f"{_against(low, high)} ({name}, {pressure:g} kPa)"))
        return Judgement(all_of(verdicts), nearest(near))

    return of_four


LARGER_ROOT_SHORTENS: Final = ordered(TIP, {"t = 1 mm": (1, 0), "t = 2 mm": (3, 2)})
LARGER_ROOT_BULGES: Final = ordered("root_bulge_mm", {"t = 1 mm": (0, 1), "t = 2 mm": (2, 3)})
THICKER_WALL_SHORTENS: Final = ordered(TIP, {"R_i = 5 mm": (2, 0), "larger R_i": (3, 1)})


def rises(four: Four) -> Judgement:
    """That every actuator elongates from one requested pressure to the next."""
    verdicts, near = [], []
    for slot, rows in curves(four).items():
        for one, other in pairwise(rows):
            verdicts.append(smaller(one, other))
            at = f"{one.pressure_kpa:g} and {other.pressure_kpa:g} kPa"
            near.append((_margin(one, other), f"{_against(one, other)} ({slot}, {at})"))
    return Judgement(all_of(verdicts), nearest(near))


def _margin(low: Row, high: Row) -> float:
    """By which part of itself the second is larger; NaN where one is unknown."""
    known = is_known(low) and is_known(high) and high.value != 0.0
    return 0.01 * difference_percent(high.value, low.value) if known and low.value else math.nan


def _against(low: Row, high: Row) -> str:
    return f"{value_text(low)} against {value_text(high)} mm"


# --- the curve ------------------------------------------------------------------------------


def curves(four: Four) -> dict[str, list[Row]]:
    """By actuator: axisymmetric elongation at every pressure, mm."""
    return {
        slot: [case.tip(pressure_kpa=p) for p in PRESSURES_KPA] for slot, case in zip(SLOTS, four.cases, strict=True)
    }


def bends_first(four: Four) -> Judgement:
    """That the curve bends at first, and less at the end: slopes of every 5 kPa."""
    verdicts: list[Verdict] = []
    near = []
    for slot, rows in curves(four).items():
        bends = _bends(_slopes(rows))
        (first, doubt_first), (last, doubt_last) = bends[0], bends[-1]
        verdicts += [above(bends[0], 0.0), below((last - first, doubt_last + doubt_first), 0.0)]
        near.append((first - last, f"slope changes by {first:.1f} %, at the end by {last:.1f} % ({slot})"))
    return Judgement(all_of(verdicts), nearest(near))


def _slopes(rows: Sequence[Row]) -> list[tuple[float, float]]:
    """Slope of every 5 kPa, mm per kPa, and its uncertainty; NaN unless all were reached."""
    unknown = 0.0 if all(map(is_known, rows)) else math.nan
    points = [(0.0, unknown, 0.0), *((row.pressure_kpa, row.value + unknown, row.uncertainty) for row in rows)]
    return [
        ((value - before) / (high - low), (doubt_before + doubt) / (high - low))
        for (low, before, doubt_before), (high, value, doubt) in pairwise(points)
    ]


def _bends(slopes: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """By how much each slope differs from the one before it, percent, and the uncertainty of that."""
    return [
        (100.0 * abs(after - before) / abs(before), 100.0 * (doubt_before + doubt_after) / abs(before))
        for (before, doubt_before), (after, doubt_after) in pairwise(slopes)
    ]


# --- unfolding ------------------------------------------------------------------------------


def _is_unfolded(case: CaseResult) -> tuple[Verdict, float, str]:
    """Whether an actuator's roots are as far out as its crests by 20 kPa."""
    row = case.row("unfolding_kpa", pressure_kpa=None)
    against = f"against {HIGHEST_KPA:g} kPa"
    if is_known(row):
        doubt = row.uncertainty if math.isfinite(row.uncertainty) else 0.0
        return below((row.value, doubt), HIGHEST_KPA), HIGHEST_KPA - row.value, f"{measured_text(row)} {against}"
    if limit_kpa(row) >= HIGHEST_KPA:
        return FAILS, -HIGHEST_KPA, f"not up to {limit_kpa(row):g} {against}"
    return UNDECIDED, math.nan, MISSING


UNFOLDED: Final = of_each(_is_unfolded)
