"""What the runs of one scene say of its meshes' errors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mpi4py import MPI

from studies.cost.error_model.cases import Trial, in_cells
from studies.models.runs import run_axisymmetric
from studies.planning.error_model import FLOOR_PERCENT, Cells, features
from studies.progress import Progress
from studies.results.compare import tip_at

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
