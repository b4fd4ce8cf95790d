"""Fits of the error model: errors over what scenes are like, seconds over unknowns."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from meshes.solid import FloatArray
from studies.cost.error_model.samples import Limits, Sample, log_error
from studies.cost.points import Point, points, power_law
from studies.planning.error_model import FLOOR_PERCENT, LEVELS, Cells, Fit, Seconds
from studies.results.rows import REACHED, Row

# Weight that keeps the slopes of features which the training set hardly tells apart small.
RIDGE: Final = 0.5
# Share of the ratios left out at each end.
TAIL: Final = 0.1


@dataclass(frozen=True)
class _Solution:
    """Logarithm of the error: constants by level, and slopes of the features from their means."""

    constants: FloatArray
    slopes: FloatArray
    centre: FloatArray

    def predict(self, s: Sample, level: int) -> float:
        """Logarithm of the error."""
        return float(self.constants[LEVELS.index(level)] + self.slopes @ (np.array(s.features) - self.centre))


def fit(samples: Sequence[Sample], limits: Limits, cells: Cells) -> Fit:
    """Least squares for the logarithm of the error: a constant per level and one slope per feature.

    The spread is that of scenes left out of the fit, each in turn with its longer sibling. Beside it the ratios that
    turn two levels of a scene into an estimate: of the logarithms, the middle between the largest and the smallest but
    a tenth.
    """
    of = [s for s in samples if s.cells == cells]
    misses: list[float] = []
    for out in {_family(s) for s in of}:
        kept = _solve([s for s in of if _family(s) != out], limits)
        left = [s for s in of if _family(s) == out]
        misses += [kept.predict(s, level) - log_error(s, level, limits) for s in left for level in LEVELS]
    solution = _solve(of, limits)
    ends = [np.quantile([_log_ratio(s, level, limits) for s in of], [TAIL, 1.0 - TAIL]) for level in LEVELS]
    return Fit(
        constants=_rounded(solution.constants),
        slopes=_rounded(solution.slopes),
        centre=_rounded(solution.centre),
        spread=round(float(np.sqrt(np.mean(np.square(misses)))), 3),
        ratios=_rounded([math.exp(0.5 * float(sum(pair))) for pair in ends]),
    )


def _family(s: Sample) -> str:
    """A made-up scene's name without its number of convolutions."""
    return s.scene.rsplit("-n", 1)[0]


def _log_ratio(s: Sample, level: int, limits: Limits) -> float:
    """Logarithm of the error over the change from the level beside."""
    changes = [100.0 * abs(v / o - 1.0) for v, o in zip(s.tips_mm[level], s.tips_beside_mm(level), strict=True)]
    return log_error(s, level, limits) - math.log(max(FLOOR_PERCENT, *changes))


def _solve(samples: Sequence[Sample], limits: Limits) -> _Solution:
    levels = len(LEVELS)
    rows = [[*(float(level == other) for other in LEVELS), *s.features] for s in samples for level in LEVELS]
    a, b = np.array(rows), np.array([log_error(s, level, limits) for s in samples for level in LEVELS])
    centre = a[:, levels:].mean(axis=0)
    a[:, levels:] -= centre
    penalty = np.diag([0.0] * levels + [RIDGE] * len(centre))
    found = np.linalg.solve(a.T @ a + penalty, a.T @ b)
    return _Solution(found[:levels], found[levels:], centre)


def _rounded(numbers: Sequence[float] | FloatArray) -> tuple[float, ...]:
    return tuple(round(float(x), 3) for x in numbers)


def time_laws(rows: Sequence[Row]) -> dict[tuple[str, str], Seconds]:
    """Seconds over unknowns of each model and element, from the undisturbed usual cells of the cost study."""
    groups: dict[tuple[str, str], list[Point]] = {}
    for p in points(rows):
        if p.is_peer or p.disturbed or p.scene == "tube" or p.status != REACHED or p.way not in ("auto", "warm"):
            continue
        groups.setdefault((p.model, p.element), []).append(p)
    found = {}
    for key, of in groups.items():
        if len(of) >= 3:
            law = power_law([p.unknowns for p in of], [p.work_s for p in of])
            found[key] = Seconds(float(f"{law.factor:.3g}"), round(law.exponent, 3))
    return found
