"""The whole body of a bellows in 3D, or a sector of it, at the requested pressures: each from an axisymmetric state."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from mpi4py import MPI

from meshes.solid import SolidMesh
from solvers.errors import Cause
from solvers.linear.factor import Factor
from solvers.linear.krylov import IterativeSolver
from solvers.paths.states import GuessMemory, PathSettings
from solvers.paths.states import Path as EquilibriumPath
from solvers.paths.warm_start import follow_guesses
from solvers.state import State
from studies.first_rank import first
from studies.models.build import Tip, masses_g, revolve_state, scene_problem
from studies.models.gaps import GapMeter
from studies.models.run_log import Log, begin, path_row, without_fields, write_fields
from studies.planning.levels import BodyLevel
from studies.progress import Progress
from studies.results.run_files import load_state
from studies.results.runs import Run, finished_run, run_hash
from studies.scene.bellows import BellowsScene, core_shift_mm
from studies.scene.meshes import SECTORS, scene_body, scene_meridian

SolidModel = Literal["sector", "full3d"]
# Beside states that were solved iteratively.
NOT_COUNTED = (
    "unstable modes of this body: an iterative solve has no inertia; the axisymmetric run has those that keep the "
    "symmetry, a coarser body that is factorised the others"
)


def run_full3d(
    scene: BellowsScene,
    model: SolidModel,
    level: BodyLevel,
    meridian_run: Path,
    folder: Path,
    comm: MPI.Comm,
    progress: Progress,
    skipped: Sequence[str],
) -> Run:
    """The body or a sector of it at the requested pressures, each from the revolved axisymmetric state; all ranks.

    Parameters
    ----------
    model
        The whole body, or the quarter between two planes of symmetry.
    level
        Cells round the circumference, of the whole, and the meridian it is made from.
    meridian_run
        Folder of the axisymmetric run on that meridian, whose states are the first guesses.
    folder
        Where the run is kept; an interrupted run there goes on after its last state.
    skipped
        What the plan does not compute, for the summary.
    """
    content_hash = run_hash(scene, model, level.name)
    done = first(comm, lambda: _finished(scene, model, level, folder, content_hash))
    if done is not None:
        return done
    job = begin(scene, model, level.name, folder, progress, skipped, content_hash)
    meridian, body = _meshes(scene, model, level, comm)
    guesses = _guesses(scene, level, meridian_run, meridian, body, comm)
    meshed = time.perf_counter() - job.begin
    problem = scene_problem(scene, body if comm.rank == 0 else None, comm)
    problem.timer.seconds["mesh"] = meshed
    tip, parts = Tip(scene, body), SECTORS[model]
    log = Log(
        job,
        problem,
        IterativeSolver(problem) if model == "full3d" and scene.mesh.solver == "iterative" else Factor(problem),
        body,
        lambda item: path_row(item, tip, parts, job.sense),
        # gaps are measured in planes through the axis, which a body that bends leaves
        None if scene.geometry.eccentricity else GapMeter(scene, meridian, body),
    )
    path = _follow(log, guesses)
    if path.cause is Cause.OUT_OF_MEMORY and model == "full3d" and scene.mesh.solver == "auto":
        log.notes.append(f"{path.reason}: solved iteratively from there")
        log.change_solver(IterativeSolver)
        path = _follow(log, guesses)
    if isinstance(log.factor, IterativeSolver):
        log.notes.append(NOT_COUNTED)
    if path.reached and len(guesses) < len(scene.pressures_mpa):
        why = "the axisymmetric path, whose states are the first guesses, has none at the others"
        path = dataclasses.replace(path, reached=False, reason=why)
    run = log.finish(path, meridian, masses_g(scene, meridian))
    if comm.rank == 0 and scene.ask.fields:
        write_fields(folder, run, body, [row.pressure_kpa for row in run.requested])
    return run


def _finished(scene: BellowsScene, model: str, level: BodyLevel, folder: Path, content_hash: str) -> Run | None:
    """The run if it is there; fields that were not wanted before are written now."""
    done = finished_run(folder, content_hash)
    if done is not None and scene.ask.fields and (missing := without_fields(folder, done)):
        write_fields(folder, done, _meshes(scene, model, level)[1], missing)
    return done


def _meshes(
    scene: BellowsScene, model: str, level: BodyLevel, comm: MPI.Comm = MPI.COMM_SELF
) -> tuple[SolidMesh, SolidMesh]:
    """The meridian and the body.

    Every rank makes the body: it takes a second, and all need it to read and to write states.

    Raises
    ------
    GeometryError, MeshError
        On every rank.
    """
    meridian = first(comm, lambda: scene_meridian(scene, level.meridian))
    return meridian, scene_body(meridian, model, level.around, core_shift_mm(scene))


def _guesses(
    scene: BellowsScene, level: BodyLevel, meridian_run: Path, meridian: SolidMesh, body: SolidMesh, comm: MPI.Comm
) -> list[State]:
    """Revolved axisymmetric states at the requested pressures, as far as they were reached."""
    meridian_hash = run_hash(scene, "axisymmetric", f"r{level.meridian}")
    guesses: list[State] = []
    for pressure in scene.pressures_mpa:
        saved = comm.bcast(load_state(meridian_run, meridian_hash, pressure) if comm.rank == 0 else None)
        if saved is not None:
            guesses.append(revolve_state(saved[0], meridian, body))
    return guesses


def _follow(log: Log, guesses: Sequence[State]) -> EquilibriumPath:
    return follow_guesses(
        log.problem,
        log.factor,
        guesses,
        PathSettings(),
        log.job.progress.iteration,
        on_state=log.keep,
        on_step=log.step,
        resume=log.memory if isinstance(log.memory, GuessMemory) else None,
    )
