"""Fits the error model of `studies.planning.error_model` and checks it on scenes it has not seen.

``mpirun -n 2 python -m studies.cost.error_fit --out results/error-model`` solves 24 made-up bellows of one convolution
on three or four meridians each (shared out over the ranks; what is there is used), prints the constants that
`studies.planning.error_model` holds, and writes ``rows.csv`` with predicted and achieved errors of
``scenes/tolerance``.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import click
import numpy as np
from mpi4py import MPI

from meshes.bellows import check_shape
from meshes.errors import GeometryError, MeshError
from meshes.solid import FloatArray
from solvers.errors import SolverError
from studies.cost.report import CHOSEN
from studies.cost.rows import Point, points, power_law
from studies.models.axisymmetric import run_axisymmetric
from studies.planning.error_model import (
    FLOOR_PERCENT,
    LONGEST,
    Cells,
    Fit,
    Seconds,
    checked_error_percent,
    choose,
    features,
    predicted_error_percent,
    predicted_seconds,
)
from studies.planning.levels import MERIDIANS
from studies.progress import Progress
from studies.results import provenance
from studies.results.files import write_text_atomically
from studies.results.rows import REACHED, Row, read_rows, row, write_rows
from studies.results.runs import Run, tip_at
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.files import load_bellows
from studies.scene.meshes import scene_meridian

TOLERANCE_SCENES = provenance.ROOT / "scenes" / "tolerance"
TRAINING, SEED = 24, 20241
# Of these as many with `LONGEST` convolutions too: what both ends leave of error thins out with their number.
LONGER, PREFIX = 4, "train-"
# Finest meridian: what the others are compared with, extrapolated with the nominal order 2.
FINEST = 8
YEOH = {"law": "yeoh", "c_kpa": [36.0, 2.5, 0.23]}
OGDEN = {"law": "ogden", "mu_kpa": 75.449, "alpha": 5.836, "convention": "2mu/alpha^2"}
# Weight that keeps the slopes of features which the training set hardly tells apart small.
RIDGE = 0.5
# Share of the ratios left out at each end.
TAIL = 0.1
# What a prediction has to be within.
ALLOWED_FACTOR = 3.0


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

    def errors_percent(self, level: int, limits_mm: Sequence[float]) -> tuple[float, ...]:
        """Error of a level at each requested pressure, percent of the converged tips."""
        return tuple(100.0 * abs(v - x) / abs(x) for v, x in zip(self.tips_mm[level], limits_mm, strict=True))


def training_scenes() -> list[BellowsScene]:
    """Made-up bellows: walls 0.5 to 2 mm, roots 4 to 10 mm, both silicones, seats, fillets, pitches and pressures."""
    random = np.random.default_rng(SEED)
    scenes: list[BellowsScene] = []
    while len(scenes) < TRAINING:
        wall, root, depth, seat, fillet, pitch, load = random.uniform(
            [0.5, 4.0, 4.0, 2.0, 0.3, 4.5, 0.6], [2.0, 10.0, 6.0, 4.0, 1.0, 6.0, 2.4]
        ).round(2)
        crest = round(root + depth, 2)
        material = OGDEN if len(scenes) % 2 else YEOH
        # the load in parts of what a wall of this thickness carries, within 2 to 20 kPa
        top = round(min(max(load * 72.0 * wall / crest, 2.0), 20.0), 2)
        scene = _scene(f"{PREFIX}{len(scenes):02d}", wall, root, crest, seat, fillet, pitch, material, [0.5 * top, top])
        try:
            check_shape(shape_of(scene))
            scene_meridian(scene, 1)
        except (GeometryError, MeshError):
            continue
        scenes.append(scene)
    return scenes


def longer_scenes(scenes: Sequence[BellowsScene]) -> list[BellowsScene]:
    """Some of the scenes with as many convolutions as the model tells apart."""
    found = []
    for scene in scenes[:LONGER]:
        geometry = scene.geometry.model_copy(update={"convolutions": LONGEST})
        found.append(scene.model_copy(update={"name": f"{scene.name}-n{LONGEST}", "geometry": geometry}))
    return found


def _scene(
    name: str,
    wall: float,
    root: float,
    crest: float,
    seat: float,
    fillet: float,
    pitch: float,
    material: Mapping[str, object],
    pressures_kpa: list[float],
) -> BellowsScene:
    geometry = {
        "kind": "bellows",
        "root_radius_mm": root,
        "crest_radius_mm": crest,
        "wall_mm": wall,
        "half_pitch_mm": pitch,
        "convolutions": 1,
        "fillet_mm": fillet,
    }
    return BellowsScene.model_validate(
        {
            "name": name,
            "geometry": geometry,
            "rings": {"model": "rigid", "seat_mm": seat},
            "material": material,
            "load": {"pressure_kpa": pressures_kpa},
        }
    )


def in_cells(scene: BellowsScene, cells: Cells) -> BellowsScene:
    """The scene in these cells, with rigid rings."""
    rings = scene.rings.model_copy(update={"model": "rigid"})
    mesh = scene.mesh.model_copy(update={"element": cells})
    return scene.model_copy(update={"rings": rings, "mesh": mesh})


def sample(scene: BellowsScene, cells: Cells, levels: Sequence[int], folder: Path, progress: Progress) -> Sample:
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
        features=features(of),
        tips_mm={level: tuple(tip_at(run, p) for p in asked) for level, run in runs.items()},
        seconds={level: run.summary.time_s["total"] for level, run in runs.items()},
        unknowns={level: run.summary.dofs for level, run in runs.items()},
    )


def all_samples(scenes: Sequence[BellowsScene], folder: Path, comm: MPI.Comm) -> list[Sample]:
    """Samples of scenes in both cells, the quadrilaterals to the finest level; on rank 0, others get none."""
    cells: tuple[Cells, ...] = ("hex", "tet")
    jobs = [(scene, of) for of in cells for scene in scenes]
    progress = Progress(comm)
    mine = []
    for scene, of in jobs[comm.rank :: comm.size]:
        mine.append(sample(scene, of, (*MERIDIANS, FINEST) if of == "hex" else MERIDIANS, folder, progress))
    found = comm.gather(mine)
    return [s for of_rank in found for s in of_rank] if found else []


def limits_of(samples: Sequence[Sample]) -> dict[str, tuple[float, ...]]:
    """Converged tips by scene, from the quadrilaterals."""
    return {s.scene: s.limits_mm() for s in samples if s.cells == "hex"}


def fit(samples: Sequence[Sample], limits: dict[str, tuple[float, ...]], cells: Cells) -> Fit:
    """Least squares for the logarithm of the error: a constant per level and one slope per feature.

    The spread is that of scenes left out of the fit, each in turn with its longer sibling. Beside it the ratios that
    turn two levels of a scene into an estimate: of the logarithms, the middle between the largest and the smallest but
    a tenth.
    """
    of = [s for s in samples if s.cells == cells]
    ratios: dict[int, list[float]] = {level: [] for level in MERIDIANS}
    for s in of:
        for level in MERIDIANS:
            beside = level // 2 if level > 1 else 2
            changes = [100.0 * abs(v / o - 1.0) for v, o in zip(s.tips_mm[level], s.tips_mm[beside], strict=True)]
            ratios[level].append(_log_error(s, level, limits) - math.log(max(FLOOR_PERCENT, *changes)))
    misses: list[float] = []
    for out in {_family(s) for s in of}:
        kept = _solve([s for s in of if _family(s) != out], limits)
        for s in of:
            if _family(s) == out:
                misses += [_predict(kept, s, level) - _log_error(s, level, limits) for level in MERIDIANS]
    constants, slopes, centre = _solve(of, limits)
    ends = {level: np.quantile(found, [TAIL, 1.0 - TAIL]) for level, found in ratios.items()}
    return Fit(
        constants=_rounded(constants),
        slopes=_rounded(slopes),
        centre=_rounded(centre),
        spread=round(float(np.sqrt(np.mean(np.square(misses)))), 3),
        ratios=_rounded([math.exp(0.5 * float(sum(ends[level]))) for level in MERIDIANS]),
    )


def _family(s: Sample) -> str:
    """A made-up scene's name without its number of convolutions."""
    return s.scene.rsplit("-n", 1)[0]


def _log_error(s: Sample, level: int, limits: dict[str, tuple[float, ...]]) -> float:
    """Logarithm of the largest error over the pressures."""
    return math.log(max(FLOOR_PERCENT, *s.errors_percent(level, limits[s.scene])))


Solution = tuple[FloatArray, FloatArray, FloatArray]


def _solve(samples: Sequence[Sample], limits: dict[str, tuple[float, ...]]) -> Solution:
    """Constants by level, slopes, and the features' means."""
    levels = len(MERIDIANS)
    rows = [[*(float(level == other) for other in MERIDIANS), *s.features] for s in samples for level in MERIDIANS]
    a, b = np.array(rows), np.array([_log_error(s, level, limits) for s in samples for level in MERIDIANS])
    centre = a[:, levels:].mean(axis=0)
    a[:, levels:] -= centre
    penalty = np.diag([0.0] * levels + [RIDGE] * len(centre))
    found = np.linalg.solve(a.T @ a + penalty, a.T @ b)
    return found[:levels], found[levels:], centre


def _predict(solution: Solution, s: Sample, level: int) -> float:
    """Logarithm of the error."""
    constants, slopes, centre = solution
    return float(constants[MERIDIANS.index(level)] + slopes @ (np.array(s.features) - centre))


def _rounded(numbers: Sequence[float] | np.ndarray) -> tuple[float, ...]:
    return tuple(round(float(x), 3) for x in numbers)


def time_laws(rows: Sequence[Row]) -> dict[tuple[str, str], Seconds]:
    """Seconds over unknowns of each model and element, from the undisturbed usual cells of the cost study."""
    found: dict[tuple[str, str], Seconds] = {}
    groups: dict[tuple[str, str], list[Point]] = {}
    for p in points(rows):
        if p.is_peer or p.disturbed or p.scene == "tube" or p.status != REACHED:
            continue
        element, _, way, _ = p.level.split()
        if way in ("auto", "warm"):
            groups.setdefault((p.model, element), []).append(p)
    for key, of in groups.items():
        if len(of) >= 3:
            law = power_law([p.unknowns for p in of], [p.work_s for p in of])
            found[key] = Seconds(float(f"{law.factor:.3g}"), round(law.exponent, 3))
    return found


def check_rows(
    scenes: Sequence[BellowsScene], samples: Sequence[Sample], limits: dict[str, tuple[float, ...]]
) -> list[Row]:
    """Predicted, checked (from two levels of the scene itself) and achieved errors, the largest over the pressures.

    Times are predicted and achieved without start and imports; ``chosen`` marks the level that the scene's tolerance
    chooses.
    """
    by_name = {scene.name: scene for scene in scenes}
    rows = []
    for s in samples:
        scene = in_cells(by_name[s.scene], s.cells)
        choice = choose(scene, "axisymmetric")
        for level in MERIDIANS:
            name = f"{s.cells} r{level}"
            achieved = max(FLOOR_PERCENT, *s.errors_percent(level, limits[s.scene]))
            beside = s.tips_mm[level // 2 if level > 1 else 2]
            errors = {
                "achieved_error_percent": achieved,
                "predicted_error_percent": predicted_error_percent(scene, "axisymmetric", f"r{level}"),
                "checked_error_percent": checked_error_percent(s.cells, level, s.tips_mm[level], beside),
            }
            for quantity, value in errors.items():
                reference = math.nan if quantity.startswith("achieved") else achieved
                rows.append(row(s.scene, quantity, "%", math.nan, "axisymmetric", value, name, reference=reference,
                                source=f"hex r{FINEST}, extrapolated"))  # fmt: skip
            seconds = predicted_seconds(scene, "axisymmetric", f"r{level}")
            rows.append(row(s.scene, "predicted_s", "s", math.nan, "axisymmetric", seconds, name,
                            reference=s.seconds[level], source="this run"))  # fmt: skip
            if choice.level == f"r{level}":
                tolerance = scene.ask.tolerance_percent
                rows.append(row(s.scene, CHOSEN, "%", math.nan, "axisymmetric", tolerance, name))
    return rows


def factors(rows: Sequence[Row], quantity: str, cells: Cells) -> dict[tuple[str, str], float]:
    """Predicted over achieved, or the reverse where that is larger, by scene and level."""
    of = [r for r in rows if r.quantity == quantity and r.level.startswith(cells)]
    return {(r.scene, r.level): max(r.value / r.reference, r.reference / r.value) for r in of}


def summary(rows: Sequence[Row]) -> list[str]:
    """How well the check scenes were predicted, a line per kind of cells and prediction."""
    lines = []
    kinds: tuple[Cells, ...] = ("hex", "tet")
    chosen = {(r.scene, r.level) for r in rows if r.quantity == CHOSEN}
    for cells in kinds:
        for quantity in ("predicted_error_percent", "checked_error_percent", "predicted_s"):
            found = factors(rows, quantity, cells)
            of_chosen = [f for key, f in found.items() if key in chosen]
            within = sum(f <= ALLOWED_FACTOR for f in of_chosen)
            every = sum(f <= ALLOWED_FACTOR for f in found.values())
            lines.append(
                f"{cells} {quantity}: chosen level within a factor of {ALLOWED_FACTOR:g} on {within} of "
                f"{len(of_chosen)} scenes (worst {max(of_chosen, default=math.nan):.2f}); all levels {every} of "
                f"{len(found)} (worst {max(found.values(), default=math.nan):.2f})"
            )
    return lines


@click.command()
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Folder for runs, samples and rows.")
@click.option(
    "--cost", default="results/cost/rows.csv", type=click.Path(path_type=Path), help="Rows of the cost study."
)
def main(out: Path, cost: Path) -> None:
    """Fit the error model anew and check it on the scenes of scenes/tolerance."""
    comm = MPI.COMM_WORLD
    training = training_scenes()
    checks = [load_bellows(path) for path in sorted(TOLERANCE_SCENES.glob("*.toml"))]
    samples = all_samples([*training, *longer_scenes(training), *checks], out / "runs", comm)
    if comm.rank != 0:
        return
    write_text_atomically(out / "samples.json", json.dumps([asdict(s) for s in samples], indent=1) + "\n")
    limits = limits_of(samples)
    trained = [s for s in samples if s.scene.startswith(PREFIX)]
    kinds: tuple[Cells, ...] = ("hex", "tet")
    for cells in kinds:
        click.echo(f'FITS "{cells}": {fit(trained, limits, cells)}')
    for key, law in time_laws(read_rows(cost) if cost.exists() else []).items():
        click.echo(f"SECONDS {key}: {law}")
    names = {scene.name for scene in checks}
    rows = check_rows(checks, [s for s in samples if s.scene in names], limits)
    write_rows(out / "rows.csv", rows)
    click.echo("\n".join([*summary(rows), f"rows: {out / 'rows.csv'}"]))


if __name__ == "__main__":
    main()
