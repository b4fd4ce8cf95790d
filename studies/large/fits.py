"""Power laws through measured points, where they cross, and what more ranks would give."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from studies.large.measure import Measured

# Flops of the factorisation grow with this power of the unknowns: 4.3e10 on 133,617 and 1.8e11 with twice as many cells
# round (docs/decisions.md). Small bodies do not show it yet: their time is in smaller parts.
FLOPS_EXPONENT: Final = math.log(1.8e11 / 4.3e10) / math.log(2.0)


@dataclass(frozen=True)
class PowerLaw:
    """``ln y = start + exponent ln N`` of the unknowns N."""

    start: float
    exponent: float

    def at(self, unknowns: float) -> float:
        """Its value for so many unknowns."""
        return math.exp(self.start + self.exponent * math.log(unknowns))


def power_law(points: Sequence[Measured], name: str) -> PowerLaw | None:
    """Least squares of the logarithms of an attribute; None from fewer than two sizes."""
    if len({p.unknowns for p in points}) < 2:
        return None
    x, y = (np.log([float(getattr(p, n)) for p in points]) for n in ("unknowns", name))
    slope, start = np.polyfit(x, y, 1)
    return PowerLaw(float(start), float(slope))


def flops_bound(points: Sequence[Measured]) -> PowerLaw | None:
    """The largest direct point's CPU time, growing as the flops do; None without a direct point."""
    direct = [p for p in points if p.method == "direct"]
    if not direct:
        return None
    largest = max(direct, key=lambda p: p.unknowns)
    start = math.log(largest.iteration_cpu_s) - FLOPS_EXPONENT * math.log(largest.unknowns)
    return PowerLaw(start, FLOPS_EXPONENT)


def crossing(direct: PowerLaw | None, iterative: PowerLaw | None) -> float:
    """Unknowns at which two power laws meet; NaN if they do not for growing size."""
    if direct is None or iterative is None or direct.exponent <= iterative.exponent:
        return math.nan
    return math.exp((iterative.start - direct.start) / (direct.exponent - iterative.exponent))


def amdahl(one_s: float, two_s: float, ranks: int) -> float:
    """Seconds on so many ranks if what two did not halve is serial: ``t1 (s + (1 - s)/n)``, ``s = 2 t2/t1 - 1``."""
    serial = min(max(2.0 * two_s / one_s - 1.0, 0.0), 1.0)
    return one_s * (serial + (1.0 - serial) / ranks)
