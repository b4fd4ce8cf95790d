"""Doing a plan: all runs of a scene into a folder, and reading a folder back."""

from __future__ import annotations

import math
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from mpi4py import MPI

from meshes.errors import GeometryError, MeshError
from solvers.errors import SolverError
from studies.models.modes import COUNTED_LEVELS, WARNING
from studies.models.run_log import Run
from studies.models.runs import run_axisymmetric, run_body, run_closed_form, run_hash
from studies.planning.error_model import MERIDIAN_SHARE
from studies.planning.expectations import expectation_rows, sentence
from studies.planning.levels import BodyLevel, fineness, ranking
from studies.planning.plan import Plan
from studies.progress import Progress
from studies.results.compare import MERIDIAN_ORDER, main_quantity, scene_rows, tip_at, tip_convergence
from studies.results.files import PATH_FILE, SUMMARY_FILE, read_path, read_summary
from studies.results.rows import Row, write_rows
from studies.scene.bellows import BellowsScene
from studies.scene.files import load_bellows

SCENE_FILE, ROWS_FILE = "scene.toml", "rows.csv"


@dataclass(frozen=True)
class SceneResult:
    """All runs of a scene, coarsest first, and the comparison rows."""

    scene: BellowsScene
    axisymmetric: tuple[Run, ...]
    sector: tuple[Run, ...]
    full3d: tuple[Run, ...]
    rows: tuple[Row, ...]

    @property
    def answer(self) -> Run | None:
        """The run whose result is the answer: the finest of the highest model."""
        runs = self.full3d or self.sector or self.axisymmetric
        return runs[-1] if runs else None

    @property
    def reached(self) -> bool:
        """True if the answer reached every requested pressure."""
        return self.answer is None or self.answer.summary.status == "reached"

    @property
    def reason(self) -> str:
        """Why it did not."""
        return "" if self.answer is None else self.answer.summary.reason

    @property
    def headlines(self) -> tuple[Row, ...]:
        """Rows for a terminal: what was asked."""
        wanted = {main_quantity(self.scene), *self.scene.ask.quantities}
        return tuple(r for r in self.rows if r.quantity in wanted)

    @property
    def unstable(self) -> tuple[str, ...]:
        """Harmonics that the axisymmetric states lose, a sentence each."""
        return tuple(n for run in self.axisymmetric for n in run.summary.plan if n.startswith(WARNING))

    @property
    def remark(self) -> str:
        """What was expected of the answer, and what came out; empty where nothing was."""
        return sentence(self.rows)


def run_plan(
    scene: BellowsScene, scene_text: str, plan: Plan, folder: Path, comm: MPI.Comm, progress: Progress
) -> SceneResult:
    """Run what a plan says; results of the same content that are already there are used.

    Parameters
    ----------
    scene, scene_text
        The scene, and its file's text, which is kept beside the results.
    folder
        Where the results go, a folder per run.

    Returns
    -------
    SceneResult
        The same on every rank.
    """
    if comm.rank == 0:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / SCENE_FILE).write_text(scene_text, encoding="utf-8")
    certain = 2 if plan.stop_when_met else len(plan.meridian_levels)
    axisymmetric = _axisymmetric_runs(scene, plan.meridian_levels[:certain], folder, comm, progress)
    for level in plan.meridian_levels[certain:]:
        if _good_enough(scene, plan, axisymmetric):
            break
        axisymmetric += _axisymmetric_runs(scene, (level,), folder, comm, progress)
    if scene.ask.modes and plan.model != "full3d":  # the whole body's inertia counts them all
        axisymmetric = _counted(scene, axisymmetric, folder, comm, progress)
    solid: dict[str, list[Run]] = {"sector": [], "full3d": []}
    if plan.around_levels:

        def run(of: BellowsScene, model: Literal["sector", "full3d"], level: BodyLevel) -> Run:
            base = folder / f"axisymmetric-r{level.meridian}"
            return run_body(of, model, level, base, folder / f"{model}-{level.name}", comm, progress, plan.skipped)

        beside = scene.model_copy(update={"ask": scene.ask.model_copy(update={"fields": False})})
        solid["sector"] = [run(beside, "sector", BodyLevel(n, plan.body_levels[0])) for n in plan.sector_levels]
        meridian = good_meridian(scene, axisymmetric, plan.body_levels) or _finest(axisymmetric, plan.body_levels)
        assert plan.model == "sector" or plan.model == "full3d"
        solid[plan.model] += [run(scene, plan.model, BodyLevel(n, meridian)) for n in plan.around_levels]
    if plan.model == "closed_form":
        run_closed_form(scene, folder, comm)
    rows = scene_rows(scene, axisymmetric, **solid)
    rows += expectation_rows(scene, axisymmetric, [*solid["sector"], *solid["full3d"]])
    result = SceneResult(scene, tuple(axisymmetric), tuple(solid["sector"]), tuple(solid["full3d"]), tuple(rows))
    if comm.rank == 0:
        write_rows(folder / ROWS_FILE, rows)
        if result.answer is not None:
            source = folder / f"{result.answer.summary.model}-{result.answer.summary.level}"
            for name in (PATH_FILE, SUMMARY_FILE):
                shutil.copyfile(source / name, folder / name)
    comm.barrier()
    return result


def _axisymmetric_runs(
    scene: BellowsScene, levels: Sequence[int], folder: Path, comm: MPI.Comm, progress: Progress
) -> list[Run]:
    """Axisymmetric runs, each on one rank, shared out over all; known to every rank, in the order of the levels.

    Raises
    ------
    GeometryError, MeshError, SolverError
        On every rank, if a run failed.
    """
    mine: dict[int, Run] = {}
    fault: Exception | None = None
    for level in levels[comm.rank :: comm.size]:
        try:
            mine[level] = run_axisymmetric(scene, level, folder / f"axisymmetric-r{level}", MPI.COMM_SELF, progress)
        except (GeometryError, MeshError, SolverError) as error:
            fault = error
            break
    every = comm.allgather((mine, fault))
    for _, failed in every:
        if failed is not None:
            raise failed
    known = {level: run for of_rank, _ in every for level, run in of_rank.items()}
    return [known[level] for level in levels]


def _counted(scene: BellowsScene, runs: list[Run], folder: Path, comm: MPI.Comm, progress: Progress) -> list[Run]:
    """The runs, the finest of those whose modes are counted with its counts."""
    levels = [level for level in (fineness(run.summary.level) for run in runs) if level in COUNTED_LEVELS]
    if not levels:
        return runs
    name = f"r{levels[-1]}"
    run = run_axisymmetric(scene, levels[-1], folder / f"axisymmetric-{name}", comm, progress, modes=True)
    return [run if old.summary.level == name else old for old in runs]


def good_meridian(scene: BellowsScene, axisymmetric: Sequence[Run], levels: Sequence[int]) -> int | None:
    """The first meridian whose error, as the axisymmetric runs show it, is within its share of the tolerance, %.

    None if none is; only levels that have an axisymmetric run.
    """
    allowed = 0.01 * MERIDIAN_SHARE * scene.ask.tolerance_percent
    quantity = main_quantity(scene)
    for run in (r for r in axisymmetric if fineness(r.summary.level) in levels):
        errors = []
        for pressure in scene.load.pressure_kpa:
            value, limit = (
                tip_at(run, pressure, quantity),
                tip_convergence(axisymmetric, pressure, MERIDIAN_ORDER, quantity).limit,
            )
            errors.append(abs(value - limit) / abs(limit))
        if all(error <= allowed for error in errors if not math.isnan(error)):
            return fineness(run.summary.level)
    return None


def _finest(axisymmetric: Sequence[Run], levels: Sequence[int]) -> int:
    """The finest of some meridian levels that has a run."""
    return max(fineness(r.summary.level) for r in axisymmetric if fineness(r.summary.level) in levels)


def _good_enough(scene: BellowsScene, plan: Plan, runs: Sequence[Run]) -> bool:
    """True if no finer meridian is needed: for the tolerance, or for a body's share of it."""
    if plan.model == "axisymmetric":
        return _within_tolerance(scene, runs)
    return good_meridian(scene, runs, plan.body_levels) is not None


def _within_tolerance(scene: BellowsScene, runs: Sequence[Run]) -> bool:
    """True if the finest run's uncertainty from its two levels is within the scene's tolerance everywhere."""
    wanted = main_quantity(scene)
    rows = [r for r in scene_rows(scene, runs) if r.model == "axisymmetric" and r.quantity == wanted]
    finest = [r for r in rows if r.level == runs[-1].summary.level]
    return all(r.uncertainty <= 0.01 * scene.ask.tolerance_percent * abs(r.value) for r in finest)


def _read_run(folder: Path) -> Run:
    return Run(read_summary(folder), tuple(read_path(folder)))


def read_scene_folder(folder: Path, current: bool = False) -> SceneResult:
    """Read a scene's folder back.

    Parameters
    ----------
    folder
        Where `run_plan` has put it.
    current
        True to leave out runs of another content: of a scene that has changed since, or of other code.

    Raises
    ------
    FileNotFoundError
        If it holds no scene or no finished run.
    """
    scene = load_bellows(folder / SCENE_FILE)
    found = [_read_run(p.parent) for p in sorted(folder.glob(f"*-*/{SUMMARY_FILE}"))]
    if current:
        found = [r for r in found if r.summary.content_hash == run_hash(scene, r.summary.model, r.summary.level)]
    runs = sorted(found, key=lambda r: ranking(r.summary.level))
    axisymmetric = tuple(r for r in runs if r.summary.model == "axisymmetric")
    sector = tuple(r for r in runs if r.summary.model == "sector")
    full3d = tuple(r for r in runs if r.summary.model == "full3d")
    rows = scene_rows(scene, axisymmetric, sector, full3d)
    rows += expectation_rows(scene, axisymmetric, [*sector, *full3d])
    return SceneResult(scene, axisymmetric, sector, full3d, tuple(rows))
