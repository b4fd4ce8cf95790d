"""Runs of simple bodies and users' meshes: one path per mesh, kept in a folder like any other run."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mpi4py import MPI

from analytical.laws.silicones import SILICONE_DENSITY_G_CM3
from meshes.quality import region_volumes_mm3
from meshes.solid import SolidMesh
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause, SolverError
from solvers.linear.factor import Factor
from solvers.output import write_vtu
from solvers.paths.path import follow_path
from solvers.paths.prescribed import follow_motion
from solvers.paths.records import Path as EquilibriumPath
from solvers.paths.records import PathMemory, PathPoint, PathSettings, PathState
from solvers.problem import Problem
from solvers.state import State
from studies.models.body_problem import Body, body_of, enclosed_mm3, measures, problem_of
from studies.models.run_log import Log, Run, begin, field_file, finish, finished_run, path_row, write_collection
from studies.planning.body_plan import ExactPlan
from studies.progress import Progress
from studies.results import provenance
from studies.results.files import PathRow, write_text_atomically
from studies.results.states import load_state, save_state
from studies.scene.bodies import ExactScene
from studies.scene.body_geometry import CylinderGeometry, MeshGeometry

MEASURED_FILE = "measured.json"
# A limit point is looked for until the cavity is this many times its unloaded volume: inner stretches of 2 (sphere) and
# 2.8 (tube), where the laws of the reference actuators have long stiffened.
LIMIT_VOLUME = 8.0
# A target no pressure reaches lets the path go on by volume.
BEYOND = 1e3


@dataclass(frozen=True)
class ExactRun:
    """A finished or stopped run, and what was measured at each requested load: quantity -> value, mm, by kPa."""

    run: Run
    measured: dict[float, dict[str, float]]


class _Found(Exception):
    """The loss of stability that a path was followed for has been found; the path ends here."""

    def __init__(self, memory: PathMemory) -> None:
        super().__init__()
        self.memory = memory


def exact_hash(scene: ExactScene, model: str, level: str) -> str:
    """Hash of everything that decides a run's numbers."""
    physics = scene.model_dump(mode="json", exclude={"name", "ask"})
    g = scene.geometry
    if isinstance(g, MeshGeometry):
        physics["geometry"]["file"] = hashlib.sha256(Path(g.file).read_bytes()).hexdigest()
    text = json.dumps([physics, model, level, "limit_kpa" in scene.quantities, provenance.code_hash()], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def run_exact(
    scene: ExactScene, plan: ExactPlan, level: str, folder: Path, comm: MPI.Comm, progress: Progress
) -> ExactRun:
    """The path of a scene on one mesh; a meridian is solved on rank 0 and known to all.

    Parameters
    ----------
    level
        One of the plan's.
    folder
        Where the run is kept; what is there of the same content is used, and an interrupted run goes on.

    Returns
    -------
    ExactRun

    Raises
    ------
    SolverError
        On every rank, if the run failed for another reason than its load.
    """
    done = comm.bcast(_finished(scene, plan.model, level, folder) if comm.rank == 0 else None)
    if done is not None:
        return done
    if plan.model != "axisymmetric":
        return _solve(scene, plan, level, folder, comm, progress)
    answer: ExactRun | Exception | None = None
    if comm.rank == 0:
        try:
            answer = _solve(scene, plan, level, folder, MPI.COMM_SELF, progress)
        except Exception as error:
            answer = error
    answer = comm.bcast(answer)
    if isinstance(answer, OSError | SolverError):
        raise answer
    if isinstance(answer, Exception):
        raise SolverError(f"axisymmetric run: {answer}") from answer
    assert answer is not None
    return answer


def read_exact(folder: Path, run: Run) -> ExactRun:
    """A run with what was measured in it.

    Raises
    ------
    OSError, ValueError
        If that is missing or damaged.
    """
    entries = json.loads((folder / MEASURED_FILE).read_text(encoding="utf-8"))
    return ExactRun(run, {entry.pop("pressure_kpa"): entry for entry in entries})


def _finished(scene: ExactScene, model: str, level: str, folder: Path) -> ExactRun | None:
    run = finished_run(folder, exact_hash(scene, model, level))
    if run is None:
        return None
    wanted = [row.pressure_kpa for row in run.path if row.status == "requested"] if scene.ask.fields else []
    if model != "axisymmetric" and not all(field_file(folder, 1e-3 * p).exists() for p in wanted):
        _write_fields(scene, model, level, folder, run)
    try:
        return read_exact(folder, run)
    except (OSError, ValueError, KeyError):
        return None


def _solve(
    scene: ExactScene, plan: ExactPlan, level: str, folder: Path, comm: MPI.Comm, progress: Progress
) -> ExactRun:
    loads = [1e-3 * p for p in scene.loads_kpa]
    content_hash = exact_hash(scene, plan.model, level)
    # a twist has no pressure to measure progress by
    job = begin(scene.name, plan.model, level, folder, content_hash, plan.skipped, progress, loads[-1] or 1.0)
    body = body_of(scene, plan.model, level)
    problem = problem_of(scene, body, comm)
    factor = Factor(problem)
    log = Log(job, comm, body.mesh, lambda item: _row(scene, body, item))

    def keep(item: PathState) -> None:
        row = log.state(item)
        if item.asked and comm.rank == 0:
            with problem.timer("output"):
                save_state(folder, content_hash, item.state, row)

    looking = "limit_kpa" in scene.quantities
    settings = PathSettings(control=scene.load.control)
    if looking:
        settings = dataclasses.replace(settings, control="volume", largest_volume=LIMIT_VOLUME)
    elif scene.geometry.kind in ("block", "cook"):  # a load that does no work before the cube gives way, or no volume
        settings = dataclasses.replace(settings, control="pressure")
    memory = log.memory if isinstance(log.memory, PathMemory) else None
    if memory is None and scene.geometry.kind == "block":
        memory = _small_tension(problem, factor, loads[-1], settings)

    def after(memory: PathMemory) -> None:
        log.step(memory, factor)
        if looking and memory.crossing is not None and memory.reached == len(loads):
            raise _Found(memory)

    targets = [*loads, BEYOND * loads[-1]] if looking else loads
    forces: dict[str, float] = {}
    try:
        if isinstance(scene.geometry, CylinderGeometry):
            path, forces = _twist(scene, scene.geometry, problem, factor, keep)
        else:
            path = follow_path(
                problem, factor, targets, settings, progress.iteration, on_state=keep, on_step=after, resume=memory
            )
    except _Found as found:
        path = EquilibriumPath((), True, "", found.memory.rejected, Cause.REACHED, found.memory.crossing)
    if looking and path.cause is Cause.TOO_LARGE and sum(row.status == "requested" for row in log.rows) == len(loads):
        path = dataclasses.replace(path, reached=True, reason="", cause=Cause.REACHED)
    run = finish(log, problem, factor, path, body.mesh, (_silicone_g(body), 0.0))
    answer: ExactRun | None = None
    if comm.rank == 0:
        measured = _measured(scene, body.mesh, folder, run)
        answer = ExactRun(run, {p: {**values, **forces} for p, values in measured.items()})
        entries = [{"pressure_kpa": p, **values} for p, values in answer.measured.items()]
        write_text_atomically(folder / MEASURED_FILE, json.dumps(entries, indent=1) + "\n")
        if scene.ask.fields and plan.model != "axisymmetric":
            _write_fields(scene, plan.model, level, folder, run)
    answer = comm.bcast(answer)
    assert answer is not None
    return answer


def _twist(
    scene: ExactScene, g: CylinderGeometry, problem: Problem, factor: Factor, keep: Callable[[PathState], None]
) -> tuple[EquilibriumPath, dict[str, float]]:
    """The path of a twisted cylinder, and torque and axial force at its end: derivatives of the energy by the plate."""
    bonded = problem.bonded
    assert bonded is not None and scene.load.twist_rad_per_mm is not None
    motion = np.zeros((1, bonded.modes))
    motion[0, 5] = scene.load.twist_rad_per_mm * g.length_mm * bonded.arm_mm
    path = follow_motion(problem, factor, motion, NewtonSettings(), keep)
    if not path.reached:
        return path, {}
    force = bonded.forces()
    return path, {"torque_nmm": float(force[5] * bonded.arm_mm), "axial_force_n": float(force[2])}


def _row(scene: ExactScene, body: Body, item: PathState) -> PathRow:
    row = path_row(item, math.nan, math.nan, body.parts)
    tip = measures(scene, body.mesh).get("tip_mm") if scene.geometry.kind == "mesh" else None
    return dataclasses.replace(
        row,
        tip_mm=math.nan if tip is None else tip(item.state),
        volume_mm3=enclosed_mm3(scene, row.volume_mm3),
        reaction_n=row.reaction_n if body.surfaces.clamped is not None else math.nan,
    )


def _silicone_g(body: Body) -> float:
    return body.parts * region_volumes_mm3(body.mesh)["elastomer"] * 1e-3 * SILICONE_DENSITY_G_CM3


def _small_tension(problem: Problem, factor: Factor, highest_mpa: float, settings: PathSettings) -> PathMemory:
    """The first state of a body that only its load keeps from turning: at no tension its rotations cost nothing.

    The guess is exact: no displacement, and a pressure as large as the tension.
    """
    step = settings.first_pressure_step * highest_mpa
    blank = problem.zero_state()
    problem.set_state(State(blank.displacement_mm, 0.0 * blank.pressure_mpa + step, blank.bodies_mm, step))
    report = solve_equilibrium(problem, factor, NewtonSettings(), HeldLoad(step))
    point = PathPoint(
        problem.get_state(), problem.cavity_volume(), report.compliance_mm3_per_mpa, report.excess_negatives
    )
    return PathMemory((point,), "pressure", step, 0, 0, 0.0, None)


def _measured(scene: ExactScene, mesh: SolidMesh, folder: Path, run: Run) -> dict[float, dict[str, float]]:
    """What is read off the kept states."""
    functions = measures(scene, mesh)
    out = {}
    for row in run.path:
        saved = (
            load_state(folder, run.summary.content_hash, 1e-3 * row.pressure_kpa) if row.status == "requested" else None
        )
        if saved is not None:
            out[row.pressure_kpa] = {name: function(saved[0]) for name, function in functions.items()}
            if scene.geometry.kind == "mesh":
                out[row.pressure_kpa]["volume_mm3"] = row.volume_mm3
    return out


def _write_fields(scene: ExactScene, model: str, level: str, folder: Path, run: Run) -> None:
    """Write the fields of the kept states for ParaView."""
    mesh = body_of(scene, model, level).mesh
    for pressure in (row.pressure_kpa for row in run.path if row.status == "requested"):
        saved = load_state(folder, run.summary.content_hash, 1e-3 * pressure)
        if saved is not None:
            write_vtu(field_file(folder, 1e-3 * pressure), mesh, saved[0])
    write_collection(folder, scene.loads_kpa)
