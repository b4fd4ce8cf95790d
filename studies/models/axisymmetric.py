"""The axisymmetric path of a bellows on one mesh."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

from mpi4py import MPI

from meshes.solid import SolidMesh
from solvers.linear.factor import Factor
from solvers.paths.orders import follow_loads
from solvers.paths.states import Path as EquilibriumPath
from solvers.paths.states import PathMemory, PathSettings, PathState
from solvers.problem import Problem
from studies.models.build import Tip, masses_g, scene_problem
from studies.models.contact import MODELLED, ContactWatch
from studies.models.finer.start import Coarser, follow_from
from studies.models.modes import COUNTED_LEVELS, with_modes
from studies.models.run_log import Log, begin, on_first_rank, path_row
from studies.planning.levels import fineness
from studies.progress import Progress
from studies.results.run_files import load_state
from studies.results.runs import Run, finished_run, run_hash
from studies.scene.bellows import BellowsScene, without_eccentricity
from studies.scene.meshes import scene_meridian


def run_axisymmetric(
    scene: BellowsScene,
    refinement: int,
    folder: Path,
    comm: MPI.Comm,
    progress: Progress,
    modes: bool = False,
    coarser: Coarser | None = None,
    problems: dict[int, Problem] | None = None,
) -> Run:
    """The axisymmetric path of a scene on one mesh, solved on rank 0 and known to all; of a core off the axis, centred.

    Parameters
    ----------
    refinement
        Meridian level: 1, 2, 4.
    folder
        Where the run is kept; what is there of the same content is used.
    modes
        True to count the unstable modes of m = 0…6 at the requested pressures, on the meridians that are counted.
    coarser
        The same on a coarser meridian, whose states are the first guesses; None to follow the path.
    problems
        By refinement those of the same scene that were solved before, on which modes can be counted; this one is added.

    Raises
    ------
    OSError, SolverError
        On every rank, if rank 0 failed.
    """
    scene = without_eccentricity(scene)
    kept = {} if problems is None else problems

    def run() -> Run:
        found = _finished(scene, refinement, folder) or _solve(scene, refinement, folder, progress, coarser, kept)
        if not modes or refinement not in COUNTED_LEVELS:
            return found
        return with_modes(scene, refinement, folder, found, kept.get(refinement))

    return on_first_rank(comm, run)


def _finished(scene: BellowsScene, refinement: int, folder: Path) -> Run | None:
    """The run if it is there with all its states, which bodies start from."""
    run = finished_run(folder, run_hash(scene, "axisymmetric", f"r{refinement}"))
    if run is None:
        return None
    states = [load_state(folder, run.summary.content_hash, 1e-3 * row.pressure_kpa) for row in run.requested]
    return None if None in states else run


def _solve(
    scene: BellowsScene,
    refinement: int,
    folder: Path,
    progress: Progress,
    coarser: Coarser | None,
    kept: dict[int, Problem],
) -> Run:
    job = begin(scene, "axisymmetric", f"r{refinement}", folder, progress)
    mesh = scene_meridian(scene, refinement)
    meshed = time.perf_counter() - job.begin
    problem = scene_problem(scene, mesh, MPI.COMM_SELF)
    problem.timer.seconds["mesh"] = meshed
    tip = Tip(scene, mesh)
    watch = ContactWatch(scene, mesh, problem, folder)
    log = Log(job, problem, Factor(problem), mesh, lambda item: path_row(item, tip, sense=job.sense), watch)
    if log.memory is None and coarser is not None:
        log.notes += coarser.contact_notes
    if any(note.startswith(MODELLED) for note in log.notes):
        watch.switch_on()

    def whole() -> EquilibriumPath:
        return follow_loads(
            problem,
            log.factor,
            scene.pressures_mpa,
            _settings(scene),
            scene.load.order,
            log.notes.append,
            watch.touches,
            progress.iteration,
            on_state=log.keep,
            on_step=log.step,
            resume=log.memory if isinstance(log.memory, PathMemory) else None,
            accept=lambda item: watch.accept(item, log.notes),
        )

    def touches(item: PathState) -> bool:
        return not watch.modelled and watch.touches(item)

    def coarse_mesh() -> SolidMesh:
        assert coarser is not None
        return scene_meridian(scene, fineness(coarser.level))

    path = follow_from(coarser, coarse_mesh, log, whole, touches)
    if refinement in COUNTED_LEVELS and not watch.modelled:
        kept[refinement] = problem
    return log.finish(path, mesh, masses_g(scene, mesh))


def _settings(scene: BellowsScene) -> PathSettings:
    """Step control; a vacuum takes small steps, as it can take from a cavity no more than it holds."""
    settings = PathSettings(control=scene.load.control, largest_volume=scene.load.largest_volume)
    return replace(settings, first_step=0.02, largest_step=0.05) if scene.load.sense < 0.0 else settings
