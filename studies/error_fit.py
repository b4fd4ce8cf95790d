"""Fits the error model of `studies.error_model` and checks it on scenes it has not seen.

``mpirun -n 2 python -m studies.error_fit --out results/error-model`` solves 24 made-up bellows of one convolution on
three or four meridians each (shared out over the ranks; what is there is used), prints the constants that
`studies.error_model` holds, and writes ``rows.csv`` with predicted and achieved errors of ``scenes/tolerance``.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import click
import numpy as np
from mpi4py import MPI

from meshes.bellows import check_shape
from meshes.errors import GeometryError, MeshError
from solvers.errors import SolverError
from studies import error_model, provenance
from studies.build import scene_meridian
from studies.compare import tip_at
from studies.error_model import LEVELS, Cells, Fit, checked_error_percent, features, predicted_error_percent
from studies.progress import Progress
from studies.results import write_text_atomically
from studies.rows import Row, row, write_rows
from studies.run_log import Run
from studies.runs import run_axisymmetric
from studies.scene import Scene, load_scene, shape_of

TOLERANCE_SCENES = provenance.ROOT / "scenes" / "tolerance"
TRAINING, SEED = 24, 20241
# Of these as many with three convolutions too, to see that the error does not depend on their number.
LONGER, LONGER_SUFFIX = 4, "-n3"
# Finest meridian: what the others are compared with, extrapolated with the nominal order 2.
FINEST = 8
YEOH = {"law": "yeoh", "c_kpa": [36.0, 2.5, 0.23]}
OGDEN = {"law": "ogden", "mu_kpa": 75.449, "alpha": 5.836, "convention": "2mu/alpha^2"}
# Weight that keeps the slopes of features which the training set hardly tells apart small.
RIDGE = 0.5


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
        As `error_model.features`, of each asked pressure.
    tips_mm
        By level, one per asked pressure; NaN where it was not reached.
    seconds, unknowns
        By level.
    """

    scene: str
    cells: Cells
    features: tuple[tuple[float, ...], ...]
    tips_mm: dict[int, tuple[float, ...]]
    seconds: dict[int, float]
    unknowns: dict[int, int]

    def limits_mm(self) -> tuple[float, ...]:
        """The converged tips, from the two finest meridians."""
        fine, half = self.tips_mm[max(self.tips_mm)], self.tips_mm[max(self.tips_mm) // 2]
        return tuple(f + (f - h) / 3.0 for f, h in zip(fine, half, strict=True))

    def errors_percent(self, level: int, limits_mm: Sequence[float]) -> tuple[float, ...]:
        """Error of a level at each asked pressure, percent of the converged tips."""
        return tuple(100.0 * abs(v - x) / abs(x) for v, x in zip(self.tips_mm[level], limits_mm, strict=True))


def training_scenes() -> list[Scene]:
    """Made-up bellows: walls 0.5 to 2 mm, roots 4 to 10 mm, both silicones, seats, fillets, pitches and pressures."""
    random = np.random.default_rng(SEED)
    scenes: list[Scene] = []
    while len(scenes) < TRAINING:
        wall, root, depth, seat, fillet, pitch, load = random.uniform(
            [0.5, 4.0, 4.0, 2.0, 0.3, 4.5, 0.6], [2.0, 10.0, 6.0, 4.0, 1.0, 6.0, 2.4]
        ).round(2)
        crest = round(root + depth, 2)
        material = OGDEN if len(scenes) % 2 else YEOH
        # the load in parts of what a wall of this thickness carries, within 2 to 20 kPa
        top = round(min(max(load * 72.0 * wall / crest, 2.0), 20.0), 2)
        scene = _scene(f"train-{len(scenes):02d}", wall, root, crest, seat, fillet, pitch, material, [0.5 * top, top])
        try:
            check_shape(shape_of(scene))
            scene_meridian(scene, 1)
        except (GeometryError, MeshError):
            continue
        scenes.append(scene)
    return scenes


def longer_scenes(scenes: Sequence[Scene]) -> list[Scene]:
    """Some of the scenes with three convolutions."""
    found = []
    for scene in scenes[:LONGER]:
        geometry = scene.geometry.model_copy(update={"convolutions": 3})
        found.append(scene.model_copy(update={"name": f"{scene.name}{LONGER_SUFFIX}", "geometry": geometry}))
    return found


def _scene(
    name: str,
    wall: float,
    root: float,
    crest: float,
    seat: float,
    fillet: float,
    pitch: float,
    material: dict[str, object],
    pressures_kpa: list[float],
) -> Scene:
    geometry = {
        "kind": "bellows",
        "root_radius_mm": root,
        "crest_radius_mm": crest,
        "wall_mm": wall,
        "half_pitch_mm": pitch,
        "convolutions": 1,
        "fillet_mm": fillet,
    }
    return Scene.model_validate(
        {
            "name": name,
            "geometry": geometry,
            "rings": {"model": "rigid", "seat_mm": seat},
            "material": material,
            "load": {"pressure_kpa": pressures_kpa},
        }
    )


def in_cells(scene: Scene, cells: Cells) -> Scene:
    """The scene in these cells, with rigid rings."""
    rings = scene.rings.model_copy(update={"model": "rigid"})
    mesh = scene.mesh.model_copy(update={"element": cells})
    return scene.model_copy(update={"rings": rings, "mesh": mesh})


def sample(scene: Scene, cells: Cells, levels: Sequence[int], folder: Path, progress: Progress) -> Sample:
    """Run a scene on meridian levels; what is there of the same content is used."""
    of = in_cells(scene, cells)
    runs: dict[int, Run] = {}
    for level in levels:
        place = folder / scene.name / f"{cells}-r{level}"
        try:
            runs[level] = run_axisymmetric(of, level, place, MPI.COMM_SELF, progress)
        except SolverError as error:
            progress.warn(f"{scene.name} {cells} r{level}: {error}")
    asked = scene.load.pressure_kpa
    return Sample(
        scene=scene.name,
        cells=cells,
        features=tuple(features(of, p) for p in asked),
        tips_mm={level: tuple(tip_at(run, p) for p in asked) for level, run in runs.items()},
        seconds={level: run.summary.time_s["total"] for level, run in runs.items()},
        unknowns={level: run.summary.dofs for level, run in runs.items()},
    )


def all_samples(scenes: Sequence[Scene], folder: Path, comm: MPI.Comm) -> list[Sample]:
    """Samples of scenes in both cells, the quadrilaterals to the finest level; on rank 0, others get none."""
    cells: tuple[Cells, ...] = ("hex", "tet")
    jobs = [(scene, of) for of in cells for scene in scenes]
    progress = Progress(comm)
    mine = []
    for scene, of in jobs[comm.rank :: comm.size]:
        finest = of == "hex" and not scene.name.endswith(LONGER_SUFFIX)
        mine.append(sample(scene, of, (*LEVELS, FINEST) if finest else LEVELS, folder, progress))
    found = comm.gather(mine)
    return [s for of_rank in found for s in of_rank] if found else []


def limits_of(samples: Sequence[Sample]) -> dict[str, tuple[float, ...]]:
    """Converged tips by scene, from the quadrilaterals."""
    return {s.scene: s.limits_mm() for s in samples if s.cells == "hex"}


def fit(samples: Sequence[Sample], limits: dict[str, tuple[float, ...]], cells: Cells) -> Fit:
    """Least squares for the logarithm of the error: a constant per level and one slope per feature.

    Beside it the ratio of a level's error to the difference from the level before: the median, which turns two levels
    on a scene into an estimate.
    """
    rows, values, ratios = [], [], {level: [] for level in LEVELS}
    for s in samples:
        if s.cells != cells:
            continue
        for level in LEVELS:
            errors = s.errors_percent(level, limits[s.scene])
            for k, (of_pressure, error) in enumerate(zip(s.features, errors, strict=True)):
                if math.isnan(error):
                    continue
                rows.append([*(float(level == other) for other in LEVELS), *of_pressure])
                values.append(math.log(max(error, error_model.FLOOR_PERCENT)))
                if level > 1:
                    change = 100.0 * abs(s.tips_mm[level][k] / s.tips_mm[level // 2][k] - 1.0)
                    ratios[level].append(error / max(change, error_model.FLOOR_PERCENT))
    a, b = np.array(rows), np.array(values)
    centre = a[:, len(LEVELS) :].mean(axis=0)
    a[:, len(LEVELS) :] -= centre
    penalty = np.diag([0.0] * len(LEVELS) + [RIDGE] * len(centre))
    found = np.linalg.solve(a.T @ a + penalty, a.T @ b)
    spread = float(np.std(a @ found - b))
    return Fit(
        constants=tuple(round(float(x), 3) for x in found[: len(LEVELS)]),
        slopes=tuple(round(float(x), 3) for x in found[len(LEVELS) :]),
        centre=tuple(round(float(x), 3) for x in centre),
        spread=round(spread, 3),
        ratios=tuple(round(float(np.median(ratios[level])), 3) for level in LEVELS[1:]),
    )


def check_rows(scenes: Sequence[Scene], samples: Sequence[Sample], limits: dict[str, tuple[float, ...]]) -> list[Row]:
    """Predicted, checked (from two levels of the scene itself) and achieved errors, the largest over the pressures."""
    by_name = {scene.name: scene for scene in scenes}
    rows = []
    for s in samples:
        scene = in_cells(by_name[s.scene], s.cells)
        for level in LEVELS:
            name, rung = f"{s.cells}-r{level}", "axisymmetric"
            achieved = max(s.errors_percent(level, limits[s.scene]))
            predicted = predicted_error_percent(scene, rung, f"r{level}")
            last = math.nan
            if level > 1:
                last = checked_error_percent(scene, level, s.tips_mm[level // 2], s.tips_mm[level])
            source = f"hex r{FINEST}, extrapolated"
            for quantity, value in (
                ("achieved_error_percent", achieved),
                ("predicted_error_percent", predicted),
                ("checked_error_percent", last),
            ):
                rows.append(row(s.scene, quantity, "%", math.nan, rung, value, name, source=source))
            rows.append(row(s.scene, "seconds", "s", math.nan, rung, s.seconds[level], name))
            rows.append(row(s.scene, "unknowns", "1", math.nan, rung, float(s.unknowns[level]), name))
    return rows


@click.command()
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Folder for runs, samples and rows.")
def main(out: Path) -> None:
    """Fit the error model anew and check it on the scenes of scenes/tolerance."""
    comm = MPI.COMM_WORLD
    training = training_scenes()
    checks = [load_scene(path) for path in sorted(TOLERANCE_SCENES.glob("*.toml"))]
    samples = all_samples([*training, *longer_scenes(training), *checks], out / "runs", comm)
    if comm.rank != 0:
        return
    write_text_atomically(out / "samples.json", json.dumps([asdict(s) for s in samples], indent=1) + "\n")
    limits = limits_of(samples)
    trained = [s for s in samples if s.scene.startswith("train-") and not s.scene.endswith(LONGER_SUFFIX)]
    for cells in ("hex", "tet"):
        click.echo(f'"{cells}": {fit(trained, limits, cells)}')
    names = {scene.name for scene in checks}
    write_rows(out / "rows.csv", check_rows(checks, [s for s in samples if s.scene in names], limits))
    click.echo(f"rows: {out / 'rows.csv'}")


if __name__ == "__main__":
    main()
