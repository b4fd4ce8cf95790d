"""Doing a plan: all runs of a scene into a folder, and reading a folder back."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Generic, TypeVar

from mpi4py import MPI

from solvers.atomic import write_atomically
from solvers.paths.orders import UNSTABLE
from solvers.problem import Problem
from studies.models.axisymmetric import run_axisymmetric
from studies.models.closed_form import run_closed_form
from studies.models.errors.runs import with_errors
from studies.models.finer.start import Coarser
from studies.models.full3d import SolidModel, run_full3d
from studies.models.modes import COUNTED_LEVELS
from studies.models.run_log import WARNING, on_first_rank, scene_notes
from studies.models.tolerance import Shortfall, asked_of, finer_body, first_body, marked, shortfalls, until_good_enough
from studies.models.tolerance import sentence as shortfall_sentence
from studies.planning.bodies import models_of
from studies.planning.error_model import MERIDIAN_SHARE
from studies.planning.levels import MODELS, BodyLevel, fineness, ranking
from studies.planning.plan import Plan
from studies.planning.planner import make_plan
from studies.planning.warnings import LAW, materials_of
from studies.progress import Progress
from studies.results.bellows_rows import bellows_rows
from studies.results.expectations import expectation_rows, sentence
from studies.results.rows import NOT_MET, Row, write_rows
from studies.results.run_files import PATH_FILE, SUMMARY_FILE, read_summary, write_summary, write_text_atomically
from studies.results.runs import MERIDIAN_ORDERS, Run, of_model, read_run, run_hash, tip_at, tip_convergence
from studies.scene.bellows import BellowsScene
from studies.scene.bodies import BodyScene
from studies.scene.compare import self_contained
from studies.scene.load import Scene
from studies.scene.silicones.presets import with_laws

# What solves simple bodies is imported with the first of them: with the exact solutions it takes a tenth of a second.

SCENE_FILE, ROWS_FILE = "scene.toml", "rows.csv"
SceneKind = TypeVar("SceneKind", bound=Scene)


@dataclass(frozen=True)
class SceneResult(Generic[SceneKind]):
    """All runs of a scene, those of each model coarsest first, the comparison rows, and which miss the tolerance."""

    scene: SceneKind
    runs: tuple[Run, ...]
    rows: tuple[Row, ...]
    missed: tuple[Shortfall, ...] = ()

    @property
    def axisymmetric(self) -> tuple[Run, ...]:
        """The axisymmetric runs."""
        return of_model(self.runs, "axisymmetric")

    @property
    def full3d(self) -> tuple[Run, ...]:
        """The runs of the whole body."""
        return of_model(self.runs, "full3d")

    @property
    def answer(self) -> Run | None:
        """The run whose result is the answer: the finest of the highest model."""
        return self.runs[-1] if self.runs else None

    @property
    def stopped(self) -> Run | None:
        """The first run that should have reached every requested load and did not: of a bellows only the answer."""
        wanted = self.runs if isinstance(self.scene, BodyScene) else self.runs[-1:]
        return next((run for run in wanted if run.summary.status != "reached"), None)

    @property
    def reached(self) -> bool:
        """True if every requested load was reached."""
        return self.stopped is None

    @property
    def reason(self) -> str:
        """Why not, or else by how much which value misses the tolerance and what to do; empty if all is well."""
        return self.shortfall if self.stopped is None else self.stopped.summary.reason

    @property
    def shortfall(self) -> str:
        """By how much which value misses the tolerance, and what to do; empty if none does or none was asked."""
        return shortfall_sentence(self.scene, self.missed, len(self.answers))

    @property
    def answers(self) -> tuple[Row, ...]:
        """Rows of the answer that the tolerance is asked of."""
        run = self.answer
        return () if run is None else asked_of(self.scene, self.rows, run.summary.model, run.summary.level)

    @property
    def headlines(self) -> tuple[Row, ...]:
        """Rows for a terminal: what was requested."""
        return tuple(r for r in self.rows if r.quantity in self.scene.quantities)

    @property
    def warnings(self) -> tuple[str, ...]:
        """The range of a law that softens, warnings of the answer, what states are unstable against."""
        own = scene_notes(self.scene) if self.answer is None else self.answer.summary.plan
        unstable = [n for run in self.axisymmetric for n in run.summary.plan if n.startswith(UNSTABLE)]
        told = [*(n for n in own if n.startswith((LAW, WARNING))), *unstable, *self._unstable_states()]
        return tuple(dict.fromkeys(told))

    def _unstable_states(self) -> list[str]:
        """Which of the answer's states are unstable by its own count, a sentence if any is."""
        found = [row for row in self.answer.requested if row.unstable_modes > 0] if self.answer else []
        if self.answer is None or not found:
            return []
        states = ", ".join(f"{row.pressure_kpa:.4g} kPa ({row.unstable_modes:g} modes)" for row in found)
        return [f"{UNSTABLE} by the count of {self.answer.summary.model}: {states}"]

    @property
    def remark(self) -> str:
        """What was expected of the answer, and what came out; empty where nothing was."""
        return sentence(self.rows)


def run_plan(
    scene: SceneKind, scene_text: str, plan: Plan, folder: Path, comm: MPI.Comm, progress: Progress
) -> SceneResult[SceneKind]:
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
        compare = None if isinstance(scene, BodyScene) else scene.compare
        text = with_laws(self_contained(scene_text, compare), materials_of(scene))
        write_text_atomically(folder / SCENE_FILE, text)
        _drop_others(scene, folder)
    comm.barrier()
    work = (plan, folder, comm, progress)
    runs = _body_runs(scene, *work) if isinstance(scene, BodyScene) else _bellows_runs(scene, *work)
    result = _result(scene, runs, judged=not plan.fixed)
    if comm.rank == 0:
        write_rows(folder / ROWS_FILE, result.rows)
        if result.answer is not None:
            summary = result.answer.summary
            of_answer = folder / f"{summary.model}-{summary.level}" / PATH_FILE
            write_atomically(folder / PATH_FILE, of_answer.read_bytes())
            if result.missed and result.reached:
                summary = replace(summary, status=NOT_MET, reason=result.reason)
            write_summary(folder, summary)
    comm.barrier()
    return result


def _drop_others(scene: Scene, folder: Path) -> None:
    """Take what is no run of this scene by this code out of its folder, where reports would find it beside those."""
    for file in folder.glob(f"*-*/{SUMMARY_FILE}"):
        try:
            summary = read_summary(file.parent)
        except (OSError, ValueError, KeyError, TypeError):
            summary = None
        if summary is None or summary.content_hash != run_hash(scene, summary.model, summary.level):
            file.unlink()


def run_all_models(
    scene: BodyScene, scene_text: str, folder: Path, comm: MPI.Comm, progress: Progress
) -> SceneResult[BodyScene]:
    """Run a simple body with every model it has, all levels of each, into one folder; see `run_plan`.

    The meshes are what is looked at, so no tolerance is asked of them.
    """
    plans = [make_plan(scene, model).as_fixed() for model in models_of(scene)]
    results = [run_plan(scene, scene_text, plan, folder, comm, progress) for plan in plans]
    runs = tuple(run for result in results for run in result.runs)
    rows = tuple(row for result in results for row in result.rows)
    if comm.rank == 0:
        write_rows(folder / ROWS_FILE, rows)
    comm.barrier()
    return SceneResult(scene, runs, rows)


def read_scene_folder(scene: SceneKind, folder: Path, current: bool = False) -> SceneResult[SceneKind]:
    """Read the results of a scene back.

    Parameters
    ----------
    scene, folder
        The scene, and where `run_plan` has put it.
    current
        True to leave out runs of another content: of a scene that has changed since, or of other code.

    Raises
    ------
    OSError, ValueError, KeyError
        If a run there is damaged.
    """
    found = [read_run(p.parent) for p in sorted(folder.glob(f"*-*/{SUMMARY_FILE}"))]
    if current:
        found = [r for r in found if r.summary.content_hash == run_hash(scene, r.summary.model, r.summary.level)]
    runs = [run for model in MODELS for run in sorted(of_model(found, model), key=lambda r: ranking(r.summary.level))]
    return _result(scene, runs, judged=_missed_before(folder))


def _missed_before(folder: Path) -> bool:
    """True if the folder's own summary says that the tolerance was asked and not met."""
    return (folder / SUMMARY_FILE).exists() and read_summary(folder).status == NOT_MET


def _result(scene: SceneKind, runs: Sequence[Run], judged: bool) -> SceneResult[SceneKind]:
    """Runs with their rows, those of the answer judged by the tolerance or not."""
    rows = tuple(_rows(scene, runs))
    missed = shortfalls(scene, rows, runs[-1].summary.model, runs[-1].summary.level) if judged and runs else ()
    return SceneResult(scene, tuple(runs), marked(rows, missed), missed)


def _rows(scene: Scene, runs: Sequence[Run]) -> list[Row]:
    if isinstance(scene, BellowsScene):
        return [*bellows_rows(scene, runs), *expectation_rows(scene, runs)]
    from studies.results.body_rows import body_rows

    models = dict.fromkeys(run.summary.model for run in runs)
    return [row for model in models for row in body_rows(scene, of_model(runs, model))]


# --- levels until they are good enough ----------------------------------------------------------------------


def _within_tolerance(scene: Scene, runs: Sequence[Run]) -> bool:
    """True if the finest run holds the scene's tolerance wherever it was asked; of a bellows, if it reached all."""
    finest = runs[-1].summary
    if not isinstance(scene, BodyScene) and finest.status != "reached":
        return False
    return not shortfalls(scene, _rows(scene, runs), finest.model, finest.level)


def _body_runs(scene: BodyScene, plan: Plan, folder: Path, comm: MPI.Comm, progress: Progress) -> list[Run]:
    from studies.models.body import run_simple_body

    def solve(level: str, before: Run | None) -> Run:
        place, coarser = folder / f"{plan.model}-{level}", _kept(before, folder)
        return run_simple_body(scene, plan.model, level, place, comm, progress, plan.skipped, coarser)

    return until_good_enough(plan, solve, lambda runs: _within_tolerance(scene, runs), plan.model)


def _bellows_runs(scene: BellowsScene, plan: Plan, folder: Path, comm: MPI.Comm, progress: Progress) -> list[Run]:
    def good_enough(runs: Sequence[Run]) -> bool:
        """For the tolerance, or for a 3D body's share of it."""
        if plan.model == "axisymmetric":
            return _within_tolerance(scene, runs)
        return good_meridian(scene, runs, plan.body_levels) is not None

    problems: dict[int, Problem] = {}

    def solve(level: str, before: Run | None) -> Run:
        run = _flat(scene, level, before, folder, comm, progress, problems)
        if plan.one_mesh and before is None:
            return on_first_rank(comm, lambda: with_errors(scene, folder / f"axisymmetric-{level}", run))
        return run

    flat = plan if plan.model == "axisymmetric" else plan.as_fixed()
    runs = until_good_enough(flat, solve, good_enough, "axisymmetric")
    if scene.ask.modes and plan.model != "full3d":  # the whole body's inertia counts them all
        runs = _counted(scene, runs, folder, comm, progress, problems)
    problems.clear()
    if plan.model == "closed_form":
        run_closed_form(scene, folder, comm)
    if not plan.around_levels:
        return runs
    bodies = _runs_in_3d(scene, plan, runs, folder, comm, progress)
    return _refined_in_3d(scene, plan, runs, bodies, folder, comm, progress)


def _flat(
    scene: BellowsScene,
    level: str,
    before: Run | None,
    folder: Path,
    comm: MPI.Comm,
    progress: Progress,
    problems: dict[int, Problem] | None = None,
) -> Run:
    """An axisymmetric run, from the states of the one on the level before."""
    place, coarser = folder / f"axisymmetric-{level}", _kept(before, folder)
    return run_axisymmetric(scene, fineness(level), place, comm, progress, coarser=coarser, problems=problems)


def _kept(run: Run | None, folder: Path) -> Coarser | None:
    """A run of this scene with where it is kept."""
    return None if run is None else Coarser(run, folder / f"{run.summary.model}-{run.summary.level}")


def _counted(
    scene: BellowsScene,
    runs: list[Run],
    folder: Path,
    comm: MPI.Comm,
    progress: Progress,
    problems: dict[int, Problem],
) -> list[Run]:
    """The runs, the finest of those whose modes are counted with its counts."""
    levels = [level for level in (fineness(run.summary.level) for run in runs) if level in COUNTED_LEVELS]
    if not levels:
        return runs
    name = f"r{levels[-1]}"
    place = folder / f"axisymmetric-{name}"
    run = run_axisymmetric(scene, levels[-1], place, comm, progress, modes=True, problems=problems)
    return [run if old.summary.level == name else old for old in runs]


# --- bodies made from a meridian ----------------------------------------------------------------------------


def _runs_in_3d(
    scene: BellowsScene, plan: Plan, axisymmetric: Sequence[Run], folder: Path, comm: MPI.Comm, progress: Progress
) -> list[Run]:
    """Bodies on the coarsest meridian that is good enough."""
    assert plan.model == "sector" or plan.model == "full3d"
    known = [fineness(run.summary.level) for run in axisymmetric]
    meridian = good_meridian(scene, axisymmetric, plan.body_levels) or max(set(known) & set(plan.body_levels))
    bodies = [BodyLevel(n, meridian) for n in plan.around_levels]
    if not plan.fixed:
        bodies = [first_body(scene, plan.model, body, axisymmetric) for body in bodies]
    return [_run_in_3d(scene, plan.model, body, plan, folder, comm, progress) for body in bodies]


def _run_in_3d(
    scene: BellowsScene,
    model: SolidModel,
    level: BodyLevel,
    plan: Plan,
    folder: Path,
    comm: MPI.Comm,
    progress: Progress,
) -> Run:
    base, place = folder / f"axisymmetric-r{level.meridian}", folder / f"{model}-{level.name}"
    return run_full3d(scene, model, level, base, place, comm, progress, plan.skipped)


def _refined_in_3d(
    scene: BellowsScene,
    plan: Plan,
    axisymmetric: list[Run],
    bodies: list[Run],
    folder: Path,
    comm: MPI.Comm,
    progress: Progress,
) -> list[Run]:
    """All runs, with finer ones as long as the body does not hold the tolerance and one is left."""
    assert plan.model == "sector" or plan.model == "full3d"
    while not plan.fixed:
        body, rows = bodies[-1], _rows(scene, [*axisymmetric, *bodies])
        missed = shortfalls(scene, rows, plan.model, body.summary.level)
        finer = finer_body(scene, rows, axisymmetric, body, missed)
        if finer is None:
            break
        if isinstance(finer, BodyLevel):
            bodies = [*bodies, _run_in_3d(scene, plan.model, finer, plan, folder, comm, progress)]
        else:
            axisymmetric = [*axisymmetric, _flat(scene, finer, axisymmetric[-1], folder, comm, progress)]
    return [*axisymmetric, *bodies]


def good_meridian(scene: BellowsScene, axisymmetric: Sequence[Run], levels: Sequence[int]) -> int | None:
    """The first meridian whose error, as the axisymmetric runs show it, is within its share of the tolerance, %.

    None if none is, or nothing shows it; only levels that have an axisymmetric run.
    """
    allowed, quantity = 0.01 * MERIDIAN_SHARE * scene.ask.tolerance_percent, scene.main_quantity
    for run in (r for r in axisymmetric if fineness(r.summary.level) in levels):
        errors = []
        for pressure in scene.load.pressure_kpa:
            value = tip_at(run, pressure, quantity)
            limit = tip_convergence(axisymmetric, pressure, MERIDIAN_ORDERS, quantity).limit
            if not math.isnan(value) and not (math.isnan(limit) and len(axisymmetric) > 1):
                errors.append(abs(value - limit) / abs(limit))
        if errors and all(error <= allowed for error in errors):
            return fineness(run.summary.level)
    return None
