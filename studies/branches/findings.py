"""What a case of the branch study gives: states along paths and branches, and numbers beside what is known of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from solvers.paths.states import PathState
from studies.results.rows import Row, row


@dataclass(frozen=True)
class Point:
    """A state of a path or branch.

    Attributes
    ----------
    load_kpa
        Load factor.
    move
        How far it has gone, in the case's unit.
    exact_kpa
        The exact load at this move; NaN where nothing is known.
    volume_mm3, force_n
        Volume of the load, and force at the end; NaN where they say nothing.
    unstable, unstable_at_volume
        Unstable modes at held load and at held volume.
    control
        What was held in the solve.
    """

    load_kpa: float
    move: float
    exact_kpa: float
    volume_mm3: float
    force_n: float
    unstable: int
    unstable_at_volume: int
    control: str


@dataclass(frozen=True)
class Findings:
    """States by path or branch, numbers beside what is known of them, size and wall time of a case."""

    branches: Mapping[str, Sequence[Point]]
    facts: Sequence[Row]
    unknowns: int
    seconds: float = math.nan


def point(item: PathState, move: float, exact_mpa: float = math.nan, force_n: float = math.nan) -> Point:
    """A state whose unstable modes have been counted."""
    load, report = 1e3 * item.state.load_mpa, item.newton
    assert report.excess_negatives is not None and report.excess_at_volume is not None
    unstable = report.excess_negatives, report.excess_at_volume
    return Point(load, move, 1e3 * exact_mpa, item.volume_mm3, force_n, *unstable, item.control)


def fact(case: str, quantity: str, unit: str, value: float, reference: float = math.nan, source: str = "") -> Row:
    """A number of a whole case, and its reference if there is one."""
    return row(case, quantity, unit, math.nan, "fem", value, reference=reference, source=source)
