"""Rules of thumb: how far a closed form times a factor meets the finite elements, and which factors do best."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytical.arrays import FloatArray
from studies.sweep.csv_table import Chain

LIMIT_PERCENT: Final = 10.0
# Factors and load numbers that a designer can remember.
_FACTORS: Final = np.arange(1.0, 2.001, 0.05)
_SPLITS: Final = np.arange(0.3, 3.001, 0.1)


@dataclass(frozen=True)
class Point:
    """A design at a pressure.

    Attributes
    ----------
    silicone
        Name of its material.
    convolutions
        n.
    load
        P R_p / (mu t): the pressure against what a tube of the crest's radius would need to widen.
    chains
        Elongation by each closed form, mm.
    axisymmetric
        Elongation by finite elements, mm.
    """

    silicone: str
    convolutions: int
    load: float
    chains: dict[Chain, float]
    axisymmetric: float


@dataclass(frozen=True)
class Rule:
    """A closed form times a factor, another one where the load number is below ``split``; 0 for one factor only."""

    chain: Chain
    split: float
    below: float
    above: float

    def percent(self, points: Sequence[Point]) -> FloatArray:
        """Difference from the finite elements, %."""
        load, chain, reference = _columns(points, self.chain)
        return np.asarray(100.0 * (np.where(load < self.split, self.below, self.above) * chain / reference - 1.0))

    def hits(self, points: Sequence[Point]) -> float:
        """Share of the points within the limit."""
        return float(np.mean(np.abs(self.percent(points)) <= LIMIT_PERCENT))


def one_factor(chain: Chain, points: Sequence[Point]) -> Rule:
    """The factor that meets most points; of equal ones that with the smallest worst difference."""
    return _best([Rule(chain, 0.0, factor, factor) for factor in _rounded(_FACTORS)], points)


def two_factors(chain: Chain, points: Sequence[Point]) -> Rule:
    """The split of the load number and the two factors that meet most points.

    The two sides of a split have nothing to do with each other, so each finds its own factor.
    """
    found = []
    for split in _rounded(_SPLITS):
        sides = [[p for p in points if p.load < split], [p for p in points if p.load >= split]]
        if all(sides):
            below, above = (one_factor(chain, side).above for side in sides)
            found.append(Rule(chain, split, below, above))
    return _best(found, points)


def _best(rules: Sequence[Rule], points: Sequence[Point]) -> Rule:
    return max(rules, key=lambda rule: (rule.hits(points), -float(np.max(np.abs(rule.percent(points))))))


def across(chain: Chain, points: Sequence[Point], split: bool) -> float:
    """Share of the points met by rules found on the other silicones' points only."""
    find = two_factors if split else one_factor
    met = []
    for silicone, own in itertools.groupby(sorted(points, key=lambda p: p.silicone), key=lambda p: p.silicone):
        rule = find(chain, [p for p in points if p.silicone != silicone])
        met.append(np.abs(rule.percent(list(own))) <= LIMIT_PERCENT)
    return float(np.mean(np.concatenate(met)))


def _columns(points: Sequence[Point], chain: Chain) -> tuple[FloatArray, FloatArray, FloatArray]:
    load, values, reference = np.array([(p.load, p.chains[chain], p.axisymmetric) for p in points]).T
    return load, values, reference


def _rounded(values: FloatArray) -> list[float]:
    return [float(v) for v in np.round(values, 2)]
