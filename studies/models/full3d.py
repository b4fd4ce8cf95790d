"""The whole body of a bellows in 3D, or a sector of it, at the requested pressures: each from an axisymmetric state.

A whole body that is images of a quarter or a half is solved on that: its states are mirrored, its unstable modes
counted by parity classes (`solvers.stability.parity`), and each requested state is proved by the residual of the whole
body in it.
"""

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
from solvers.paths.states import GuessMemory, PathSettings, PathState
from solvers.paths.states import Path as EquilibriumPath
from solvers.paths.warm_start import follow_guesses
from solvers.problem import Problem
from solvers.stability.parity import ParityFactor
from solvers.state import State
from studies.first_rank import first
from studies.models.build import PLANES, Tip, masses_g, part_of, revolve_state, scene_problem
from studies.models.gaps import GapMeter
from studies.models.run_log import Job, Log, begin, forget, path_row, without_fields, write_fields
from studies.models.symmetry.mirrored import Diagonal, Proof, mirror
from studies.planning.levels import BodyLevel
from studies.progress import Progress
from studies.results.run_files import PathRow, load_state
from studies.results.runs import Run, finished_run, run_hash
from studies.scene.bellows import BellowsScene, core_shift_mm
from studies.scene.meshes import (
    AS_A_WHOLE,
    ON_A_PART,
    SECTORS,
    Part,
    scene_body,
    scene_meridian,
    solved_part,
    symmetry_note,
)

SolidModel = Literal["sector", "full3d"]
# Beside states that were solved iteratively.
NOT_COUNTED = (
    "unstable modes of this body: an iterative solve has no inertia; the axisymmetric run has those that keep the "
    "symmetry, a coarser body that is factorised the others"
)


# A mirrored state is one of the whole body if its residual there is at most so many times that on the part, or this.
PROVED_TIMES, PROVED = 10.0, 1e-7


class NeedsWhole(Exception):
    """A part does not do; the text says why, and every rank raises it."""


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
    notes = tuple(dict.fromkeys([*skipped, symmetry_note(scene, level.around)] if model == "full3d" else skipped))
    job = begin(scene, model, level.name, folder, progress, notes, content_hash)
    work = (scene, model, level, meridian_run, comm)
    part = solved_part(scene, level.around)[0] if model == "full3d" else model
    if part != model:
        try:
            return _solve(job, *work, solved=part)
        except NeedsWhole as reason:
            first(comm, lambda: forget(folder))
            kept = tuple(note for note in notes if note != ON_A_PART[part])
            job = dataclasses.replace(job, notes=(*kept, f"{AS_A_WHOLE}{reason}"))
    return _solve(job, *work, solved=model)


def _solve(
    job: Job,
    scene: BellowsScene,
    model: SolidModel,
    level: BodyLevel,
    meridian_run: Path,
    comm: MPI.Comm,
    solved: Part,
) -> Run:
    """The run of a body whose equations are solved on it or on a part of it.

    Raises
    ------
    NeedsWhole
        If the part's states are none of the whole body, or the memory does not hold its factors.
    """
    folder = job.folder
    meridian, body = _meshes(scene, model, level, comm)
    part = body if solved == model else scene_body(meridian, solved, level.around, core_shift_mm(scene))
    guesses = _guesses(scene, level, meridian_run, meridian, part, comm)
    meshed = time.perf_counter() - job.begin
    problem = scene_problem(scene, part if comm.rank == 0 else None, comm)
    problem.timer.seconds["mesh"] = meshed
    tip, parts = Tip(scene, part), SECTORS[solved]
    proof = None
    if solved != model:
        proof = Proof(mirror(part, body, PLANES[solved]), scene_problem(scene, body if comm.rank == 0 else None, comm))

    def row_of(item: PathState) -> PathRow:
        row = path_row(item, tip, parts, job.sense)
        if proof is None or not item.asked:
            return row
        with problem.timer("proof"):
            return dataclasses.replace(row, whole_residual=_proved(proof, item))

    log = Log(
        job,
        problem,
        _factor(scene, problem, part, proof),
        body,
        row_of,
        # gaps are measured in planes through the axis, which a body that bends leaves
        None if scene.geometry.eccentricity else GapMeter(scene, meridian, part),
        proof,
    )
    try:
        path = _follow(log, guesses)
        if path.cause is Cause.OUT_OF_MEMORY and proof is not None:
            raise NeedsWhole(path.reason)
    except NeedsWhole:
        log.factor.close()
        raise
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


def _factor(scene: BellowsScene, problem: Problem, part: SolidMesh, proof: Proof | None) -> Factor:
    """What solves the equations, and counts."""
    if proof is not None:
        return ParityFactor(problem, proof.mirrored.planes, Diagonal(part).is_alike)
    whole = part_of(part) == "full3d"
    return IterativeSolver(problem) if whole and scene.mesh.solver == "iterative" else Factor(problem)


def _proved(proof: Proof, item: PathState) -> float:
    """Residual of the whole body in the mirrored state.

    Raises
    ------
    NeedsWhole
        If that is no equilibrium of it.
    """
    residual = proof.residual(item.state)
    if not residual <= max(PROVED, PROVED_TIMES * item.newton.residual):
        raise NeedsWhole(
            f"the mirrored state at {1e3 * item.state.load_mpa:g} kPa has a residual of {residual:.1e} on it"
        )
    return residual


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
