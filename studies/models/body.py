"""A run of a simple body or a user's mesh: its path on one mesh, and what is measured in the states."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from mpi4py import MPI

from analytical.laws.silicones import SILICONE_DENSITY_G_CM3
from meshes.quality import region_volumes_mm3
from meshes.solid import SolidMesh
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause
from solvers.linear.factor import Factor
from solvers.paths.orders import follow_loads
from solvers.paths.prescribed import follow_motion
from solvers.paths.states import Path as EquilibriumPath
from solvers.paths.states import PathMemory, PathPoint, PathSettings, PathState
from solvers.state import State
from studies.first_rank import first
from studies.models.body_problem import Body, body_of, enclosed_mm3, measures, problem_of
from studies.models.finer.start import Coarser, follow_from
from studies.models.run_log import Log, begin, on_first_rank, path_row, without_fields, write_fields
from studies.progress import Progress
from studies.results.run_files import PathRow, load_state
from studies.results.runs import MEASURED_FILE, Run, finished_run, run_hash, write_measured
from studies.scene.bodies import LIMIT_VOLUME, BodyScene
from studies.scene.body_geometry import CylinderGeometry

# A target no pressure reaches lets the path go on by volume.
BEYOND = 1e3


class _Found(Exception):
    """The loss of stability that a path was followed for has been found, or is not there; the path ends here."""

    def __init__(self, memory: PathMemory) -> None:
        super().__init__()
        self.memory = memory


def run_simple_body(
    scene: BodyScene,
    model: str,
    level: str,
    folder: Path,
    comm: MPI.Comm,
    progress: Progress,
    skipped: Sequence[str] = (),
    coarser: Coarser | None = None,
) -> Run:
    """The path of a scene on one mesh; a meridian is solved on rank 0 and known to all.

    Parameters
    ----------
    model, level
        A model that the scene has, and a mesh of it.
    folder
        Where the run is kept; what is there of the same content is used, and an interrupted run goes on.
    skipped
        What the plan does not compute, for the summary.
    coarser
        The same on a coarser mesh, whose states are the first guesses; None to follow the path.

    Raises
    ------
    OSError, SolverError
        On every rank, if the run failed for another reason than its load.
    """

    def run(on: MPI.Comm) -> Run:
        done = first(on, lambda: _finished(scene, model, level, folder))
        return done or _solve(scene, model, level, folder, on, progress, skipped, coarser)

    return run(comm) if model != "axisymmetric" else on_first_rank(comm, lambda: run(MPI.COMM_SELF))


def _finished(scene: BodyScene, model: str, level: str, folder: Path) -> Run | None:
    """The run if it is there with what was measured; fields that were not wanted before are written now."""
    run = finished_run(folder, run_hash(scene, model, level))
    if run is None or not (folder / MEASURED_FILE).exists():
        return None
    if model != "axisymmetric" and scene.ask.fields and (missing := without_fields(folder, run)):
        write_fields(folder, run, body_of(scene, model, level).mesh, missing)
    return run


def _solve(
    scene: BodyScene,
    model: str,
    level: str,
    folder: Path,
    comm: MPI.Comm,
    progress: Progress,
    skipped: Sequence[str],
    coarser: Coarser | None,
) -> Run:
    job = begin(scene, model, level, folder, progress, skipped)
    body = body_of(scene, model, level)
    problem = problem_of(scene, body, comm)
    log = Log(job, problem, Factor(problem), body.mesh, lambda item: _row(scene, body, item))
    forces: dict[str, float] = {}
    if isinstance(scene.geometry, CylinderGeometry):
        path, forces = _twist(scene, scene.geometry, log)
    elif "limit_kpa" in scene.quantities:
        path = _to_limit(scene, log)
    else:
        path = follow_from(coarser, lambda: _coarse_mesh(scene, model, coarser), log, lambda: _load(scene, log))
    silicone = body.parts * region_volumes_mm3(body.mesh)["elastomer"] * 1e-3 * SILICONE_DENSITY_G_CM3
    run = log.finish(path, body.mesh, (silicone, 0.0))
    if comm.rank == 0:
        measured = {load: {**values, **forces} for load, values in _measured(scene, body.mesh, folder, run).items()}
        write_measured(folder, measured)
        run = dataclasses.replace(run, measured=measured)
        if scene.ask.fields and model != "axisymmetric":
            write_fields(folder, run, body.mesh, [row.pressure_kpa for row in run.requested])
    return comm.bcast(run)


def _coarse_mesh(scene: BodyScene, model: str, coarser: Coarser | None) -> SolidMesh:
    assert coarser is not None
    return body_of(scene, model, coarser.level).mesh


# --- paths --------------------------------------------------------------------------------------------------


def _load(scene: BodyScene, log: Log) -> EquilibriumPath:
    """The path through the requested loads."""
    loads = [1e-3 * p for p in scene.loads_kpa]
    settings = PathSettings(control=scene.load.control, largest_volume=scene.load.largest_volume)
    memory = log.memory
    if scene.geometry.kind in ("block", "cook"):  # a load that does no work before the cube gives way, or no volume
        settings = dataclasses.replace(settings, control="pressure")
    if memory is None and scene.geometry.kind == "block":
        memory = _small_tension(log, loads[-1], settings)
    return _follow(log, loads, settings, memory)


def _to_limit(scene: BodyScene, log: Log) -> EquilibriumPath:
    """The path through the requested loads, and on by volume until the limit point is found."""
    loads = [1e-3 * p for p in scene.loads_kpa]
    settings = PathSettings(control="volume", largest_volume=scene.load.largest_volume)
    try:
        return _follow(log, [*loads, BEYOND * loads[-1]], settings, log.memory, enough=len(loads))
    except _Found as found:
        return EquilibriumPath((), True, "", found.memory.rejected, Cause.REACHED, found.memory.crossing)


def _follow(
    log: Log, targets: Sequence[float], settings: PathSettings, memory: object, enough: int | None = None
) -> EquilibriumPath:
    """With ``enough`` targets reached it ends with `_Found` when stability is lost, or beyond where that is sought."""
    farthest_mm3 = LIMIT_VOLUME * log.problem.volume_unit_mm3

    def after(memory: PathMemory) -> None:
        log.step(memory)
        sought = memory.crossing is None and memory.history[-1].volume_mm3 <= farthest_mm3
        if memory.reached == enough and not sought:
            raise _Found(memory)

    return follow_loads(
        log.problem,
        log.factor,
        targets,
        settings,
        log.job.scene.load.order,
        log.notes.append,
        lambda _: False,  # contact is not modelled here
        log.job.progress.iteration,
        on_state=log.keep,
        on_step=after,
        resume=memory if isinstance(memory, PathMemory) else None,
    )


def _small_tension(log: Log, highest_mpa: float, settings: PathSettings) -> PathMemory:
    """The first state of a body that only its load keeps from turning: at no tension its rotations cost nothing.

    The guess is exact: no displacement, and a pressure as large as the tension.
    """
    problem, step = log.problem, settings.first_pressure_step * highest_mpa
    blank = problem.zero_state()
    problem.set_state(State(blank.displacement_mm, 0.0 * blank.pressure_mpa + step, blank.bodies_mm, step))
    report = solve_equilibrium(problem, log.factor, NewtonSettings(), HeldLoad(step))
    point = PathPoint(
        problem.get_state(), problem.cavity_volume(), report.compliance_mm3_per_mpa, report.excess_negatives
    )
    return PathMemory((point,), "pressure", step, 0, 0, 0.0, None)


def _twist(scene: BodyScene, g: CylinderGeometry, log: Log) -> tuple[EquilibriumPath, dict[str, float]]:
    """The path of a twisted cylinder, and torque and axial force at its end: derivatives of the energy by the plate."""
    bonded = log.problem.bonded
    assert bonded is not None and scene.load.twist_rad_per_mm is not None
    motion = np.zeros((1, len(bonded.motions)))
    motion[0, 5] = scene.load.twist_rad_per_mm * g.length_mm * bonded.arm_mm
    path = follow_motion(log.problem, log.factor, motion, NewtonSettings(), log.keep)
    if not path.reached:
        return path, {}
    force = bonded.forces()
    return path, {"torque_nmm": float(force[5] * bonded.arm_mm), "axial_force_n": float(force[2])}


# --- what is read off states --------------------------------------------------------------------------------


def _row(scene: BodyScene, body: Body, item: PathState) -> PathRow:
    row = path_row(item, None, body.parts)
    tip = measures(scene, body.mesh).get("tip_mm") if scene.geometry.kind == "mesh" else None
    return dataclasses.replace(
        row,
        tip_mm=math.nan if tip is None else tip(item.state),
        volume_mm3=enclosed_mm3(scene, row.volume_mm3),
        reaction_n=row.reaction_n if body.surfaces.clamped is not None else math.nan,
    )


def _measured(scene: BodyScene, mesh: SolidMesh, folder: Path, run: Run) -> dict[float, dict[str, float]]:
    """What is measured in the kept states, by load in kPa."""
    functions, out = measures(scene, mesh), {}
    for row in run.requested:
        saved = load_state(folder, run.summary.content_hash, 1e-3 * row.pressure_kpa)
        if saved is not None:
            out[row.pressure_kpa] = {name: function(saved[0]) for name, function in functions.items()}
            if scene.geometry.kind == "mesh":
                held = {"tip_force_n": scene.load.tip == "blocked", "reaction_n": not math.isnan(row.reaction_n)}
                out[row.pressure_kpa] |= {"volume_mm3": row.volume_mm3}
                out[row.pressure_kpa] |= {name: getattr(row, name) for name, is_held in held.items() if is_held}
    return out
