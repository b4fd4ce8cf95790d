"""Runs of one scene: an axisymmetric path on one mesh, a full 3D body or a sector of it at the requested pressures.

A run is kept in a folder of its own. After each converged step a checkpoint is written, all of it or nothing: a run
that was killed goes on after it with the steps it would have taken, on any number of ranks, and a finished one with the
same content hash is not repeated.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np
from mpi4py import MPI

from analytical.bellows.chains import closed_form
from analytical.bellows.loads import held_tip
from meshes.solid import SolidMesh
from solvers.errors import Cause, SolverError
from solvers.linear.factor import Factor
from solvers.linear.krylov import IterativeSolver
from solvers.output import write_vtu
from solvers.paths.path import follow_path
from solvers.paths.records import GuessMemory, PathMemory, PathSettings, PathState
from solvers.paths.records import Path as EquilibriumPath
from solvers.paths.warm_start import follow_guesses
from solvers.problem import Problem
from solvers.state import State
from studies.models.build import SECTORS, Tip, masses_g, revolve_state, scene_body, scene_meridian, scene_problem
from studies.models.contact import MODELLED, ContactWatch
from studies.models.gaps import GapMeter
from studies.models.modes import COUNTED_LEVELS, with_modes
from studies.models.run_log import (
    Job,
    Log,
    Run,
    begin,
    field_file,
    finish,
    finished_run,
    path_row,
    stamp,
    write_collection,
)
from studies.planning.levels import BodyLevel
from studies.progress import Progress
from studies.results import provenance
from studies.results.files import (
    PathRow,
    RunSummary,
    write_path,
    write_summary,
)
from studies.results.states import load_state, save_state
from studies.scene.bellows import Scene, core_shift_mm, dimensions_of, law_of, without_eccentricity

# Beside states that were solved iteratively.
NOT_COUNTED = (
    "unstable modes of this body: an iterative solve has no inertia; the axisymmetric run has those that keep the "
    "symmetry, a coarser body that is factorised the others"
)


def run_hash(scene: Scene, model: str, level: str) -> str:
    """Hash of everything that decides a run's numbers; the axisymmetric model knows a centred core only."""
    if model == "axisymmetric":
        scene = without_eccentricity(scene)
    physics = scene.model_dump(mode="json", exclude={"name", "ask"})
    text = json.dumps([physics, model, level, provenance.code_hash()], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def path_settings(scene: Scene) -> PathSettings:
    """Step control; a vacuum takes small steps, as it can take from a cavity no more than it holds."""
    if scene.load.sense < 0.0:
        return PathSettings(control=scene.load.control, first_step=0.02, largest_step=0.05)
    return PathSettings(control=scene.load.control)


def _begin(scene: Scene, model: str, level: str, folder: Path, notes: Sequence[str], progress: Progress) -> Job:
    content_hash = run_hash(scene, model, level)
    return begin(
        scene.name, model, level, folder, content_hash, notes, progress, scene.pressures_mpa[-1], scene.load.sense
    )


def run_closed_form(scene: Scene, folder: Path, comm: MPI.Comm) -> Run:
    """The closed form at the requested pressures, written like any other run; it costs nothing, so it is not kept.

    Raises
    ------
    analytical.bellows.dimensions.BellowsError
        If it has no answer for the scene.
    """
    begin = time.perf_counter()
    tips, forces = _closed_form_tip(scene)
    silicone, rings = masses_g(scene, scene_meridian(scene, 1))
    unknown = math.nan
    rows = tuple(
        PathRow(
            pressure_kpa=pressure,
            control="pressure",
            tip_mm=tip,
            tip_centre_mm=tip,
            tip_force_n=force,
            volume_mm3=unknown,
            energy_mj=unknown,
            reaction_n=unknown,
            min_det_f=unknown,
            min_gap_mm=unknown,
            unstable_modes=unknown,
            unstable_by_m="",
            newton_iterations=0,
            wall_s=0.0,
            status="requested",
            bond_slip_rms_mm=unknown,
        )
        for pressure, tip, force in zip(scene.load.pressure_kpa, tips, forces, strict=True)
    )
    summary = RunSummary(
        scene=scene.name,
        model="closed_form",
        level="",
        status="reached",
        reason="",
        content_hash=run_hash(scene, "closed_form", ""),
        plan=(),
        dofs=0,
        cells=0,
        nodes=0,
        factorisations=0,
        newton_iterations=0,
        rejected_steps=0,
        silicone_g=silicone,
        ring_g=rings,
        time_s={"total": time.perf_counter() - begin},
        peak_mb=provenance.peak_memory_mb(comm),
        **stamp(comm),
    )
    if comm.rank == 0:
        write_path(folder, rows)
        write_summary(folder, summary)
    return Run(summary, rows)


def _closed_form_tip(scene: Scene) -> tuple[list[float], list[float]]:
    """Elongations, mm, and forces of the actuator at its tip, N, at the requested pressures."""
    dimensions, law, pressures = dimensions_of(scene), law_of(scene.material), np.array(scene.load.pressure_kpa)
    if scene.blocked:
        return [0.0] * len(pressures), held_tip(dimensions, law, pressures).tip_force_n.ravel().tolist()
    return closed_form(dimensions, law, pressures).elongation_mm.tolist(), [0.0] * len(pressures)


def run_axisymmetric(
    scene: Scene, refinement: int, folder: Path, comm: MPI.Comm, progress: Progress, modes: bool = False
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

    Returns
    -------
    Run

    Raises
    ------
    SolverError
        On every rank, if rank 0 failed.
    """
    scene = without_eccentricity(scene)
    level = f"r{refinement}"
    content_hash = run_hash(scene, "axisymmetric", level)
    answer: Run | Exception | None = None
    if comm.rank == 0:
        try:
            answer = finished_run(folder, content_hash)
            if answer is None or not _has_states(folder, content_hash, answer):
                answer = _solve_axisymmetric(scene, refinement, folder, progress)
            if modes and refinement in COUNTED_LEVELS:
                answer = with_modes(scene, refinement, folder, answer)
        except Exception as error:
            answer = error
    answer = comm.bcast(answer)
    if isinstance(answer, Exception):
        raise (answer if isinstance(answer, SolverError) else SolverError(f"axisymmetric run: {answer}")) from answer
    assert isinstance(answer, Run)
    return answer


def _has_states(folder: Path, content_hash: str, run: Run) -> bool:
    asked = [row.pressure_kpa for row in run.path if row.status == "requested"]
    return all(load_state(folder, content_hash, 1e-3 * p) is not None for p in asked)


def _solve_axisymmetric(scene: Scene, refinement: int, folder: Path, progress: Progress) -> Run:
    job = _begin(scene, "axisymmetric", f"r{refinement}", folder, (), progress)
    mesh = scene_meridian(scene, refinement)
    meshed = time.perf_counter() - job.begin
    problem = scene_problem(scene, mesh, MPI.COMM_SELF)
    problem.timer.seconds["mesh"] = meshed
    factor = Factor(problem)
    tip = Tip(scene, mesh)
    watch = ContactWatch(scene, mesh, problem, folder)
    log = Log(
        job,
        problem.comm,
        mesh,
        lambda item: path_row(item, tip.mean_mm(item.state), tip.centre_mm(item.state), sense=scene.load.sense),
        watch,
    )
    if any(note.startswith(MODELLED) for note in log.notes):
        watch.switch_on()

    def keep(item: PathState) -> None:
        row = log.state(item)
        if item.asked:
            with problem.timer("output"):
                save_state(folder, job.content_hash, item.state, row)
                watch.write(item)

    path = follow_path(
        problem,
        factor,
        scene.pressures_mpa,
        path_settings(scene),
        progress.iteration,
        on_state=keep,
        on_step=lambda memory: log.step(memory, factor),
        resume=log.memory if isinstance(log.memory, PathMemory) else None,
        accept=lambda item: watch.accept(item, log.notes),
    )
    return _finish(scene, log, problem, factor, path, mesh)


def run_body(
    scene: Scene,
    model: Literal["sector", "full3d"],
    level: BodyLevel,
    meridian_run: Path,
    folder: Path,
    comm: MPI.Comm,
    progress: Progress,
    plan: Sequence[str],
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

    Returns
    -------
    Run
    """
    meridian_hash = run_hash(scene, "axisymmetric", f"r{level.meridian}")
    done = comm.bcast(finished_run(folder, run_hash(scene, model, level.name)) if comm.rank == 0 else None)
    if done is not None:
        if comm.rank == 0:
            _add_missing_fields(scene, level, folder, done)
        return done
    job = _begin(scene, model, level.name, folder, plan, progress)

    # Every rank makes the mesh: it takes a second, and all need it to read and to write states.
    meridian = comm.bcast(scene_meridian(scene, level.meridian) if comm.rank == 0 else None)
    body = scene_body(meridian, model, level.around, core_shift_mm(scene))
    guesses: list[State] = []
    for pressure in scene.pressures_mpa:
        saved = comm.bcast(load_state(meridian_run, meridian_hash, pressure) if comm.rank == 0 else None)
        if saved is None:
            break
        guesses.append(revolve_state(saved[0], meridian, body))
    meshed = time.perf_counter() - job.begin
    problem = scene_problem(scene, body if comm.rank == 0 else None, comm)
    problem.timer.seconds["mesh"] = meshed
    iterative = model == "full3d" and scene.mesh.solver == "iterative"
    factor = IterativeSolver(problem) if iterative else Factor(problem)
    tip, parts = Tip(scene, body), SECTORS[model]
    log = Log(
        job,
        comm,
        body,
        lambda item: path_row(item, tip.mean_mm(item.state), tip.centre_mm(item.state), parts, scene.load.sense),
        # gaps are measured in planes through the axis, which a body that bends leaves
        None if scene.geometry.eccentricity else GapMeter(scene, meridian, body),
    )

    def keep(item: PathState) -> None:
        row = log.state(item)
        if item.asked and comm.rank == 0:
            with problem.timer("output"):
                save_state(folder, job.content_hash, item.state, row)
                if scene.ask.fields:
                    write_vtu(field_file(folder, item.state.load_mpa), body, item.state)

    last = log.memory if isinstance(log.memory, GuessMemory) else None

    def after(memory: GuessMemory) -> None:
        nonlocal last
        last = memory
        log.step(memory, factor)

    def follow() -> EquilibriumPath:
        return follow_guesses(
            problem, factor, guesses, PathSettings(), progress.iteration, on_state=keep, on_step=after, resume=last
        )

    path = follow()
    if path.cause is Cause.OUT_OF_MEMORY and model == "full3d" and scene.mesh.solver == "auto":
        log.notes.append(f"{path.reason}: solved iteratively from there")
        factor.close()
        factor, iterative = IterativeSolver(problem), True
        path = follow()
    if iterative:
        log.notes.append(NOT_COUNTED)
    if path.reached and len(guesses) < len(scene.pressures_mpa):
        path = dataclasses.replace(path, reached=False, reason="the axisymmetric path stopped here")
    return _finish(scene, log, problem, factor, path, meridian)


def _add_missing_fields(scene: Scene, level: BodyLevel, folder: Path, run: Run) -> None:
    """Write the fields of a finished run that was made without them."""
    reached = [row.pressure_kpa for row in run.path if row.status == "requested"]
    missing = [p for p in reached if not field_file(folder, 1e-3 * p).exists()]
    if not scene.ask.fields or not missing:
        return
    meridian = scene_meridian(scene, level.meridian)
    body = scene_body(meridian, run.summary.model, level.around, core_shift_mm(scene))
    for pressure in missing:
        saved = load_state(folder, run.summary.content_hash, 1e-3 * pressure)
        if saved is not None:
            write_vtu(field_file(folder, 1e-3 * pressure), body, saved[0])
    write_collection(folder, scene.load.pressure_kpa)


def _finish(
    scene: Scene, log: Log, problem: Problem, factor: Factor, path: EquilibriumPath, meridian: SolidMesh
) -> Run:
    if log.comm.rank == 0 and scene.ask.fields and log.job.model in SECTORS:
        write_collection(log.job.folder, scene.load.pressure_kpa)
    return finish(log, problem, factor, path, meridian, masses_g(scene, meridian))
