"""Runs of one scene: an axisymmetric path on one mesh, a full 3D body at the asked pressures.

A run is kept in a folder of its own. Its states are written as they converge; a run that was interrupted goes
on after its last state, and a finished one with the same content hash is not repeated.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import os
import time
import zipfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from mpi4py import MPI

from analytical.bellows import closed_form
from analytical.materials import SILICONE_DENSITY_G_CM3
from meshes.meridian import default_resolution, meridian_mesh
from meshes.quality import mesh_quality, region_volumes_mm3
from meshes.revolve import revolve, revolve_vector
from meshes.solid import FACETS, REGIONS, SolidMesh
from solvers.domain import create_domain
from solvers.errors import SolverError
from solvers.linear import Factor
from solvers.output import write_vtu
from solvers.path import Path as EquilibriumPath
from solvers.path import PathSettings, PathState, follow_guesses, follow_path
from solvers.problem import SOFT, STIFF, Problem, State, Surfaces
from solvers.rigid import RigidBodies
from studies import provenance
from studies.progress import Progress
from studies.results import (
    FIELDS_FOLDER,
    PathRow,
    RunSummary,
    read_path,
    read_summary,
    write_path,
    write_summary,
    write_text_atomically,
)
from studies.scene import (
    Scene,
    bond_grade,
    bond_stiffness,
    dimensions_of,
    inverse_kappa,
    law_of,
    ring_material,
    ring_shape,
    shape_of,
)

STATES_FOLDER = "states"


@dataclass(frozen=True)
class Run:
    """A finished or stopped run, read back from disk."""

    summary: RunSummary
    path: tuple[PathRow, ...]


def run_hash(scene: Scene, rung: str, level: str) -> str:
    """Hash of everything that decides a run's numbers."""
    physics = scene.model_dump(mode="json", exclude={"name", "ask"})
    text = json.dumps([physics, rung, level, provenance.code_hash()], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def finished_run(folder: Path, content_hash: str) -> Run | None:
    """The run in a folder if it is there, whole and of this content."""
    try:
        summary = read_summary(folder)
        if summary.content_hash != content_hash:
            return None
        return Run(summary, tuple(read_path(folder)))
    except (OSError, ValueError, KeyError, TypeError):
        return None


# ---- states on disk ----------------------------------------------------------------------------------------


def _state_file(folder: Path, pressure_mpa: float) -> Path:
    return folder / STATES_FOLDER / f"p{1e3 * pressure_mpa:09.4f}.npz"


def save_state(folder: Path, content_hash: str, state: State, row: PathRow) -> None:
    """Write a state and its row of figures atomically."""
    path = _state_file(folder, state.load_mpa)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(path.name + ".part")
    with temporary.open("wb") as stream:
        np.savez(stream, **asdict(state), row=json.dumps(asdict(row)), content_hash=content_hash)
        stream.flush()
        os.fsync(stream.fileno())
    temporary.replace(path)


def load_state(folder: Path, content_hash: str, pressure_mpa: float) -> tuple[State, PathRow] | None:
    """A saved state, or None if it is missing, damaged or of another content."""
    try:
        with np.load(_state_file(folder, pressure_mpa), allow_pickle=False) as data:
            if str(data["content_hash"]) != content_hash:
                return None
            state = State(data["displacement_mm"], data["pressure_mpa"], data["bodies_mm"], float(data["load_mpa"]))
            return state, PathRow(**json.loads(str(data["row"])))
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile):
        return None


# ---- building ----------------------------------------------------------------------------------------------


def scene_meridian(scene: Scene, refinement: int) -> SolidMesh:
    """The meridian mesh of a scene at a refinement."""
    shape = shape_of(scene)
    ring = ring_shape(scene) if scene.rings.model == "meshed" else None
    return meridian_mesh(shape, default_resolution(shape, refinement), ring)


def scene_problem(scene: Scene, mesh: SolidMesh | None, comm: MPI.Comm) -> Problem:
    """The boundary value problem of a scene on a mesh that rank 0 holds; every rank calls."""
    material_numbers = None
    if mesh is not None:
        numbers = np.where(mesh.regions == REGIONS["ring"], STIFF, SOFT)
        material_numbers = dataclasses.replace(mesh, regions=numbers)
    domain = create_domain(comm, material_numbers)
    stiff = ring_material(scene) if scene.rings.model == "meshed" else None
    bodies = None
    if scene.rings.model == "rigid":
        shape = shape_of(scene)
        axial = comm.bcast(None if mesh is None else mesh.points[:, -1])
        normal, tangential = bond_stiffness(scene)
        bodies = RigidBodies(
            normal, tangential, bond_grade(scene, axial), shape.crest_positions_mm, shape.seat_radius_mm
        )
    surfaces = Surfaces(
        cavity=FACETS["cavity"],
        clamped=FACETS["clamped"],
        bond=FACETS["bond"] if bodies is not None else None,
        held=((FACETS["axis"], 0),) if domain.axisymmetric else (),
    )
    law = law_of(scene.material)
    return Problem(domain, law, inverse_kappa(scene.material), surfaces, stiff, bodies)


def revolve_state(scene: Scene, state: State, body: SolidMesh) -> State:
    """An axisymmetric state as a first guess on the revolved mesh."""
    bodies = np.zeros((0, 0))
    if scene.rings.model == "rigid":
        bodies = np.zeros((len(state.bodies_mm), 6))
        bodies[:, 2] = state.bodies_mm[:, 0]
    return State(
        revolve_vector(state.displacement_mm, body),
        state.pressure_mpa[body.meridian_node],
        bodies,
        state.load_mpa,
    )


class _Tip:
    """Mean axial displacement of the distal rim, weighted by the rim's undeformed length or area."""

    def __init__(self, mesh: SolidMesh) -> None:
        facets = mesh.facets[mesh.facet_tags == FACETS["tip"]]
        ends = mesh.points[facets]
        if mesh.dimension == 2:
            # area of the cone between two radii
            weight = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) * (ends[:, 0, 0] + ends[:, 1, 0])
        else:
            weight = np.linalg.norm(np.cross(ends[:, 1] - ends[:, 0], ends[:, 2] - ends[:, 0]), axis=1)
        self._facets, self._weight = facets, weight / weight.sum()
        self._centre = mesh.tip_centre_node

    def mean_mm(self, state: State) -> float:
        """Mean over the rim."""
        return float(self._weight @ state.displacement_mm[self._facets, -1].mean(axis=1))

    def centre_mm(self, state: State) -> float:
        """At the axis."""
        return float(state.displacement_mm[self._centre, -1])


def _path_row(tip: _Tip, item: PathState) -> PathRow:
    return PathRow(
        pressure_kpa=1e3 * item.state.load_mpa,
        control=item.control,
        tip_mm=tip.mean_mm(item.state),
        tip_centre_mm=tip.centre_mm(item.state),
        tip_force_n=0.0,
        volume_mm3=item.volume_mm3,
        energy_mj=item.energy_mj,
        reaction_n=item.reaction_n,
        min_det_f=item.newton.min_det_f,
        min_gap_mm=math.nan,
        unstable_modes=float(item.newton.excess_negatives),
        unstable_by_m="",
        newton_iterations=item.newton.iterations,
        wall_s=item.wall_s,
        status="asked" if item.asked else "step",
    )


def _masses_g(scene: Scene, meridian: SolidMesh) -> tuple[float, float]:
    """Mass of silicone and rings, g; rings that are not meshed count with their section."""
    volumes = region_volumes_mm3(meridian)
    silicone = (volumes["elastomer"] + volumes["cap"]) * 1e-3 * SILICONE_DENSITY_G_CM3
    ring_mm3 = volumes["ring"]
    if scene.rings.model == "rigid":
        r, rings = shape_of(scene).seat_radius_mm, scene.rings
        section = ((r + rings.height_mm) ** 2 - r**2) * math.pi * rings.seat_mm
        # a quarter circle of radius q replaces a square at each of the two outer edges
        q, outer = rings.edge_radius_mm, r + rings.height_mm
        lost = 2.0 * (1.0 - math.pi / 4.0) * q**2 * 2.0 * math.pi * (outer - 0.2234 * q)
        ring_mm3 = (section - lost) * (scene.geometry.convolutions + 1)
    return silicone, ring_mm3 * 1e-3 * ring_material(scene).density_g_cm3


# ---- running -----------------------------------------------------------------------------------------------


def run_closed_form(scene: Scene, folder: Path, comm: MPI.Comm) -> Run:
    """The closed form at the asked pressures, written like any other run; it costs nothing, so it is not kept.

    Raises
    ------
    analytical.bellows.BellowsError
        If it has no answer for the scene.
    """
    begin = time.perf_counter()
    answer = closed_form(dimensions_of(scene), law_of(scene.material), np.array(scene.load.pressure_kpa))
    silicone, rings = _masses_g(scene, scene_meridian(scene, 1))
    unknown = math.nan
    rows = tuple(
        PathRow(p, "pressure", tip, tip, 0.0, unknown, unknown, unknown, unknown, unknown, unknown, "", 0, 0.0, "asked")
        for p, tip in zip(scene.load.pressure_kpa, map(float, answer.elongation_mm), strict=True)
    )
    summary = RunSummary(
        scene=scene.name,
        rung="closed_form",
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
        versions=provenance.versions(),
        blas=provenance.blas(),
        ranks=comm.size,
        threads=provenance.blas_threads(),
        commit=provenance.commit(),
        when=provenance.now(),
    )
    if comm.rank == 0:
        write_path(folder, rows)
        write_summary(folder, summary)
    return Run(summary, rows)


def run_axisymmetric(scene: Scene, refinement: int, folder: Path, comm: MPI.Comm, progress: Progress) -> Run:
    """The axisymmetric path of a scene on one mesh, solved on rank 0 and known to all.

    Parameters
    ----------
    refinement
        Meridian level: 1, 2, 4.
    folder
        Where the run is kept; what is there of the same content is used.

    Returns
    -------
    Run

    Raises
    ------
    SolverError
        On every rank, if rank 0 failed.
    """
    level = f"r{refinement}"
    content_hash = run_hash(scene, "axisymmetric", level)
    answer: Run | Exception | None = None
    if comm.rank == 0:
        try:
            answer = finished_run(folder, content_hash)
            if answer is None or not _has_states(folder, content_hash, answer):
                answer = _solve_axisymmetric(scene, refinement, level, folder, content_hash, progress)
        except Exception as error:
            answer = error
    answer = comm.bcast(answer)
    if isinstance(answer, Exception):
        raise (answer if isinstance(answer, SolverError) else SolverError(f"axisymmetric run: {answer}")) from answer
    assert isinstance(answer, Run)
    return answer


def _has_states(folder: Path, content_hash: str, run: Run) -> bool:
    asked = [row.pressure_kpa for row in run.path if row.status == "asked"]
    return all(load_state(folder, content_hash, 1e-3 * p) is not None for p in asked)


def _solve_axisymmetric(
    scene: Scene, refinement: int, level: str, folder: Path, content_hash: str, progress: Progress
) -> Run:
    begin = time.perf_counter()
    provenance.reset_peak_memory()
    progress.begin(f"{scene.name} axisymmetric {level}", scene.pressures_mpa[-1])
    mesh = scene_meridian(scene, refinement)
    meshed = time.perf_counter() - begin
    problem = scene_problem(scene, mesh, MPI.COMM_SELF)
    factor = Factor(problem)
    tip = _Tip(mesh)
    rows: list[PathRow] = []

    def keep(item: PathState) -> None:
        rows.append(_path_row(tip, item))
        progress.state(item.state.load_mpa)
        if item.asked:
            with problem.timer("output"):
                save_state(folder, content_hash, item.state, rows[-1])

    path = follow_path(problem, factor, scene.pressures_mpa, PathSettings(), progress.iteration, keep)
    return _finish(
        scene, "axisymmetric", level, folder, content_hash, problem, factor, path, rows, mesh, mesh, begin, meshed,
        progress, (),
    )  # fmt: skip


def run_full3d(
    scene: Scene,
    around: int,
    meridian_run: Path,
    folder: Path,
    comm: MPI.Comm,
    progress: Progress,
    plan: Sequence[str],
) -> Run:
    """The full body at the asked pressures, each from the revolved axisymmetric state; all ranks take part.

    Parameters
    ----------
    around
        Cells round the circumference.
    meridian_run
        Folder of the axisymmetric run on level r1, whose states are the first guesses.
    folder
        Where the run is kept; an interrupted run there goes on after its last state.

    Returns
    -------
    Run
    """
    level = f"n{around}"
    content_hash = run_hash(scene, "full3d", level)
    meridian_hash = run_hash(scene, "axisymmetric", "r1")
    done = comm.bcast(finished_run(folder, content_hash) if comm.rank == 0 else None)
    if done is not None:
        return done
    begin = time.perf_counter()
    provenance.reset_peak_memory()
    progress.begin(f"{scene.name} full 3D {level}", scene.pressures_mpa[-1])

    # Every rank makes the mesh: it takes a second, and all need it to read and to write states.
    meridian = comm.bcast(scene_meridian(scene, 1) if comm.rank == 0 else None)
    body = revolve(meridian, around)
    guesses: list[State] = []
    found: list[tuple[State, PathRow]] = []
    for pressure in scene.pressures_mpa:
        saved = comm.bcast(load_state(meridian_run, meridian_hash, pressure) if comm.rank == 0 else None)
        if saved is None:
            break
        guesses.append(revolve_state(scene, saved[0], body))
        kept = comm.bcast(load_state(folder, content_hash, pressure) if comm.rank == 0 else None)
        if kept is not None and len(found) == len(guesses) - 1:
            found.append(kept)
    meshed = time.perf_counter() - begin
    problem = scene_problem(scene, body if comm.rank == 0 else None, comm)
    factor = Factor(problem)
    tip = _Tip(body)
    rows = [row for _, row in found]

    def keep(item: PathState) -> None:
        rows.append(_path_row(tip, item))
        progress.state(item.state.load_mpa)
        if item.asked and comm.rank == 0:
            with problem.timer("output"):
                save_state(folder, content_hash, item.state, rows[-1])
                if scene.ask.fields:
                    write_vtu(_field_file(folder, item.state.load_mpa), body, item.state)

    start = (found[-1][0], guesses[len(found) - 1]) if found else None
    path = follow_guesses(problem, factor, guesses[len(found) :], PathSettings(), progress.iteration, keep, start)
    if path.reached and len(guesses) < len(scene.pressures_mpa):
        path = dataclasses.replace(path, reached=False, reason="the axisymmetric path stopped here")
    return _finish(
        scene, "full3d", level, folder, content_hash, problem, factor, path, rows, body, meridian, begin, meshed,
        progress, plan,
    )  # fmt: skip


def _field_file(folder: Path, pressure_mpa: float) -> Path:
    return folder / FIELDS_FOLDER / f"p{1e3 * pressure_mpa:06.3f}.vtu"


def field_files(folder: Path, pressures_kpa: Sequence[float]) -> dict[float, Path]:
    """The field files a run has written, by pressure in kPa."""
    files = {p: _field_file(folder, 1e-3 * p) for p in pressures_kpa}
    return {p: f for p, f in files.items() if f.exists()}


def _write_collection(folder: Path, pressures_kpa: Sequence[float]) -> None:
    """A ParaView collection over the pressures."""
    entries = "".join(
        f'<DataSet timestep="{p:g}" file="{f.relative_to(folder)}"/>'
        for p, f in field_files(folder, pressures_kpa).items()
    )
    text = f'<?xml version="1.0"?><VTKFile type="Collection" version="0.1"><Collection>{entries}</Collection></VTKFile>'
    write_text_atomically(folder / "fields.pvd", text)


def _finish(  # noqa: PLR0913
    scene: Scene,
    rung: str,
    level: str,
    folder: Path,
    content_hash: str,
    problem: Problem,
    factor: Factor,
    path: EquilibriumPath,
    rows: list[PathRow],
    mesh: SolidMesh,
    meridian: SolidMesh,
    begin: float,
    meshed: float,
    progress: Progress,
    plan: Sequence[str],
) -> Run:
    """Write a run's path and summary on rank 0; the same Run on every rank."""
    comm = problem.comm
    peak = provenance.peak_memory_mb(comm)
    factor.close()
    seconds = {k: float(v) for k, v in problem.timer.seconds.items()}
    summary = None
    if comm.rank == 0:
        quality = mesh_quality(meridian)
        notes = list(plan)
        if quality.boundary_only_cells:
            notes.append(f"warning: {quality.boundary_only_cells} meridian cells have all corners on the boundary")
        silicone, rings = _masses_g(scene, meridian)
        summary = RunSummary(
            scene=scene.name,
            rung=rung,
            level=level,
            status="reached" if path.reached else "stopped",
            reason=path.reason,
            content_hash=content_hash,
            plan=tuple(notes),
            dofs=problem.index_map.size_global + problem.extra,
            cells=len(mesh.cells),
            nodes=len(mesh.points),
            factorisations=factor.count,
            newton_iterations=sum(row.newton_iterations for row in rows),
            rejected_steps=path.rejected,
            silicone_g=silicone,
            ring_g=rings,
            time_s={"mesh": meshed, **seconds, "total": time.perf_counter() - begin},
            peak_mb=peak,
            versions=provenance.versions(),
            blas=provenance.blas(),
            ranks=comm.size,
            threads=provenance.blas_threads(),
            commit=provenance.commit(),
            when=provenance.now(),
        )
        write_path(folder, rows)
        if scene.ask.fields and rung == "full3d":
            _write_collection(folder, scene.load.pressure_kpa)
        write_summary(folder, summary)
    summary = comm.bcast(summary)
    assert summary is not None
    last = rows[-1].pressure_kpa if rows else 0.0
    how = "reached" if path.reached else f"stopped at {last:.2f} kPa: {path.reason}"
    progress.end(
        f"{scene.name} {rung} {level}: {how}; {summary.dofs} unknowns, {factor.count} factorisations, "
        f"{summary.time_s['total']:.1f} s"
    )
    return Run(summary, tuple(rows))
