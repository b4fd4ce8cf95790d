"""What runs say of their meshes' errors; fits of errors over what scenes are like, of seconds over unknowns."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from mpi4py import MPI

from meshes.solid import FloatArray
from studies.cost.error_model.cases import Trial, in_cells
from studies.cost.points import Point, points, power_law
from studies.models.axisymmetric import run_axisymmetric
from studies.planning.error_model import FLOOR_PERCENT, Cells, Fit, Seconds, features
from studies.planning.levels import MERIDIANS
from studies.progress import Progress
from studies.results.rows import Row
from studies.results.runs import tip_at

# Weight that keeps the slopes of features which the training set hardly tells apart small.
RIDGE: Final = 0.5
# Share of the ratios left out at each end.
TAIL: Final = 0.1
# Converged tips by scene, mm, one per requested pressure.
Limits = dict[str, tuple[float, ...]]


@dataclass(frozen=True)
class Sample:
    """What the runs of one scene say.

    Attributes
    ----------
    scene
        Its name.
    cells
        ``hex`` or ``tet``: quadrilaterals or triangles.
    features
        As `error_model.features`.
    tips_mm
        By level, one per requested pressure; NaN where it was not reached.
    seconds, unknowns
        By level.
    """

    scene: str
    cells: Cells
    features: tuple[float, ...]
    tips_mm: dict[int, tuple[float, ...]]
    seconds: dict[int, float]
    unknowns: dict[int, int]

    def limits_mm(self) -> tuple[float, ...]:
        """The converged tips, from the two finest meridians."""
        fine, half = self.tips_mm[max(self.tips_mm)], self.tips_mm[max(self.tips_mm) // 2]
        return tuple(f + (f - h) / 3.0 for f, h in zip(fine, half, strict=True))

    def error_percent(self, level: int, limits: Limits) -> float:
        """Largest error of a level over the requested pressures, percent of the converged tips."""
        pairs = zip(self.tips_mm[level], limits[self.scene], strict=True)
        return max(FLOOR_PERCENT, *(100.0 * abs(v - x) / abs(x) for v, x in pairs))

    def tips_beside_mm(self, level: int) -> tuple[float, ...]:
        """Tips of the level that one is compared with if nothing finer is known: the coarser, of the coarsest r2."""
        return self.tips_mm[level // 2 if level > 1 else 2]


def sample(trial: Trial, levels: Sequence[int], folder: Path, comm: MPI.Comm, progress: Progress) -> Sample:
    """Run a scene on meridian levels; what is there of the same content is used.

    Raises
    ------
    SolverError
        If a run failed for another reason than its load.
    """
    scene = in_cells(trial.scene, trial.cells)
    places = {level: folder / scene.name / f"{trial.cells}-r{level}" for level in levels}
    runs = {level: run_axisymmetric(scene, level, place, comm, progress) for level, place in places.items()}
    return Sample(
        scene=scene.name,
        cells=trial.cells,
        features=features(scene),
        tips_mm={level: tuple(tip_at(run, p) for p in scene.load.pressure_kpa) for level, run in runs.items()},
        seconds={level: run.summary.time_s["total"] for level, run in runs.items()},
        unknowns={level: run.summary.dofs for level, run in runs.items()},
    )


def limits_of(samples: Sequence[Sample]) -> Limits:
    """Converged tips by scene, from the quadrilaterals."""
    return {s.scene: s.limits_mm() for s in samples if s.cells == "hex"}


def log_error(s: Sample, level: int, limits: Limits) -> float:
    """Logarithm of the largest error over the pressures."""
    return math.log(s.error_percent(level, limits))


@dataclass(frozen=True)
class _Solution:
    """Logarithm of the error: constants by level, and slopes of the features from their means."""

    constants: FloatArray
    slopes: FloatArray
    centre: FloatArray

    def predict(self, s: Sample, level: int) -> float:
        """Logarithm of the error."""
        return float(self.constants[MERIDIANS.index(level)] + self.slopes @ (np.array(s.features) - self.centre))


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
        misses += [kept.predict(s, level) - log_error(s, level, limits) for s in left for level in MERIDIANS]
    solution = _solve(of, limits)
    ends = [np.quantile([_log_ratio(s, level, limits) for s in of], [TAIL, 1.0 - TAIL]) for level in MERIDIANS]
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
    levels = len(MERIDIANS)
    rows = [[*(float(level == other) for other in MERIDIANS), *s.features] for s in samples for level in MERIDIANS]
    a, b = np.array(rows), np.array([log_error(s, level, limits) for s in samples for level in MERIDIANS])
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
        if p.is_peer or p.cost.disturbed or p.scene == "tube" or not p.reached or p.way not in ("auto", "warm"):
            continue
        groups.setdefault((p.model, p.element), []).append(p)
    found = {}
    for key, of in groups.items():
        if len(of) >= 3:
            law = power_law([p.cost.unknowns for p in of], [p.cost.work_s for p in of])
            found[key] = Seconds(float(f"{law.factor:.3g}"), round(law.exponent, 3))
    return found
