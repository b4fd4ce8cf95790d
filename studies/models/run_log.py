"""A run on its way and when it is done: rows, states, checkpoints, first touch, summary; the same for every model.

A run is kept in a folder of its own. After each converged step a checkpoint is written, all of it or nothing: a run
that was killed goes on after it with the steps it would have taken, on any number of ranks, and a finished one with the
same content hash is not repeated.
"""

from __future__ import annotations

import dataclasses
import math
import shutil
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from mpi4py import MPI

from meshes.quality import mesh_quality
from meshes.solid import SolidMesh
from solvers.errors import Cause, SolverError
from solvers.linear.factor import Factor
from solvers.paths.checkpoint import CheckpointError, read_checkpoint, write_checkpoint
from solvers.paths.orders import MISSED
from solvers.paths.states import GuessMemory, PathMemory, PathState
from solvers.paths.states import Path as EquilibriumPath
from solvers.problem import Problem
from solvers.vtu import write_mode, write_vtu
from studies.first_rank import first
from studies.models.build import Tip
from studies.models.contact import CONTACT_FILE, ContactWatch
from studies.models.gaps import GapMeter, Touch
from studies.models.symmetry.mirrored import Proof
from studies.planning.warnings import law_ranges, scene_warnings, stretch_warnings
from studies.progress import Progress
from studies.results import provenance
from studies.results.run_files import (
    COLLECTION_FILE,
    FIELDS_FOLDER,
    PATH_FILE,
    STATES_FOLDER,
    SUMMARY_FILE,
    PathRow,
    RunSummary,
    crossing_facts,
    field_file,
    load_state,
    save_state,
    write_collection,
    write_path,
    write_summary,
)
from studies.results.runs import MEASURED_FILE, Run, farthest_kpa, run_hash
from studies.scene.load import Scene

CHECKPOINT_FILE, MODE_FILE = "checkpoint.npz", "critical_mode"
# Begin the note on first touch, and what a user should hear of.
CONTACT, WARNING = "contact not modelled", "warning: "


@dataclass(frozen=True)
class Job:
    """What identifies a run while it goes on."""

    scene: Scene
    model: str
    level: str
    folder: Path
    content_hash: str
    notes: tuple[str, ...]
    progress: Progress
    begin: float

    @property
    def label(self) -> str:
        """Scene, model and mesh."""
        return f"{self.scene.name} {self.model} {self.level}"

    @property
    def sense(self) -> float:
        """-1 where loads are a vacuum."""
        return -1.0 if self.scene.loads_kpa[-1] < 0.0 else 1.0


def begin(
    scene: Scene,
    model: str,
    level: str,
    folder: Path,
    progress: Progress,
    notes: Sequence[str] = (),
    content_hash: str | None = None,
) -> Job:
    """Start the clock, the memory's peak and the progress of a run; its hash is that of `run_hash` unless given.

    Notes on the law's range and on what looks like another unit come before those given.
    """
    provenance.reset_peak_memory()
    known = content_hash or run_hash(scene, model, level)
    job = Job(scene, model, level, folder, known, (*scene_notes(scene), *notes), progress, time.perf_counter())
    # a twist has no pressure to measure progress by
    progress.begin(job.label, 1e-3 * abs(scene.loads_kpa[-1]) or 1.0)
    return job


def scene_notes(scene: Scene) -> tuple[str, ...]:
    """Notes on a scene that each of its runs keeps."""
    return (*law_ranges(scene), *(WARNING + text for text in scene_warnings(scene)))


def on_first_rank(comm: MPI.Comm, solve: Callable[[], Run]) -> Run:
    """An axisymmetric run that rank 0 makes alone, known to all.

    Raises
    ------
    OSError, SolverError
        On every rank, if rank 0 failed.
    """
    try:
        return first(comm, solve)
    except (OSError, SolverError):
        raise
    except Exception as error:
        raise SolverError(f"axisymmetric run: {error}") from error


def ending(reason: str, notes: Sequence[str]) -> str:
    """Why a path ended; if something touched before, that too."""
    touch = next((note for note in notes if note.startswith(CONTACT)), None)
    return f"{reason}; {touch}" if reason and touch else reason


def without_missed(path: EquilibriumPath, notes: Sequence[str]) -> EquilibriumPath:
    """The path, not reached if a note says so of a requested load (`solvers.paths.orders`)."""
    missed = [note for note in notes if note.startswith(MISSED)]
    if not missed:
        return path
    cause = Cause.STEP_SIZE if path.reached else path.cause
    return dataclasses.replace(
        path, reached=False, reason="; ".join([*missed, *filter(None, [path.reason])]), cause=cause
    )


def forget(folder: Path) -> None:
    """Remove what a run has left; its summary first, so that nothing is taken for its result."""
    names = (
        SUMMARY_FILE,
        PATH_FILE,
        MEASURED_FILE,
        CONTACT_FILE,
        COLLECTION_FILE,
        CHECKPOINT_FILE,
        *(f"{MODE_FILE}.{kind}" for kind in ("npz", "vtu")),
    )
    for name in names:
        (folder / name).unlink(missing_ok=True)
    for name in (STATES_FOLDER, FIELDS_FOLDER):
        shutil.rmtree(folder / name, ignore_errors=True)


class Log:
    """A run on its way: what an interrupted one left is read first, each state is kept. Every rank calls.

    Parameters
    ----------
    job, problem, factor, mesh
        The run, what is solved, and on what.
    row_of
        A converged state as a row of path.csv.
    gaps
        Measures the gaps of its states; None leaves them out.
    proof
        Of a body that is solved on a part of it, ``mesh`` being the whole's: what is kept is the whole's.
    """

    def __init__(
        self,
        job: Job,
        problem: Problem,
        factor: Factor,
        mesh: SolidMesh,
        row_of: Callable[[PathState], PathRow],
        gaps: GapMeter | ContactWatch | None = None,
        proof: Proof | None = None,
    ) -> None:
        self.proof, self.parts = proof, 1 if proof is None else proof.mirrored.parts
        self.job, self.problem, self.factor, self.mesh, self.row_of = job, problem, factor, mesh, row_of
        self.comm, self._gaps = problem.comm, gaps
        self.rows: list[PathRow] = []
        self.notes = list(job.notes)
        self.memory: PathMemory | GuessMemory | None = None
        self._factorisations, self._seconds = 0, 0.0
        self._has_mode = False
        self._read_checkpoint()
        self._begin = time.perf_counter()

    @property
    def _file(self) -> Path:
        return self.job.folder / CHECKPOINT_FILE

    def _read_checkpoint(self) -> None:
        """Go on where an interrupted run of the same content was, or start with nothing of another content there."""
        job = self.job
        found: tuple[PathMemory | GuessMemory, Any] | str | None = None
        if self.comm.rank == 0:
            try:
                found = read_checkpoint(self._file, job.content_hash)
            except CheckpointError as error:
                found = str(error)
            if not isinstance(found, tuple):
                forget(job.folder)
        found = self.comm.bcast(found)
        if isinstance(found, str):
            self.notes.append(f"{WARNING}{found}; this run started anew")
            job.progress.warn(f"{job.label}: {found}; starting anew")
        elif found is not None:
            self.memory, kept = found
            self.rows = [PathRow(**row) for row in kept["rows"]]
            self._factorisations, self._seconds = kept["factorisations"], kept["seconds"]
            self.notes = list(kept["notes"])
            job.progress.warn(f"{job.label}: going on after {self.rows[-1].pressure_kpa:.6g} kPa, from its checkpoint")

    def start_anew(self, notes: Sequence[str]) -> None:
        """Drop the states so far, which turned out not to be those wanted; only the work they took still counts."""
        if self.comm.rank == 0:
            forget(self.job.folder)
        self.rows, self.memory, self.notes = [], None, list(notes)

    def change_solver(self, make: Callable[[Problem], Factor]) -> None:
        """Go on with another solver; what the last one made counts, and its memory is freed first."""
        self._factorisations += self.factor.count
        self.factor.close()
        self.factor = make(self.problem)

    def state(self, item: PathState) -> PathRow:
        """Take in a converged state."""
        row = self.row_of(item)
        if self._gaps is not None:
            row = self._with_gap(row, self._gaps.measure(item.state))
        self.rows.append(dataclasses.replace(row, wall_s=self._seconds + row.wall_s))
        self.job.progress.state(item.state.load_mpa)
        return self.rows[-1]

    def keep(self, item: PathState) -> None:
        """Take in a converged state, and write it if it is a requested one."""
        row = self.state(item)
        if item.asked and self.comm.rank == 0:
            with self.problem.timer("output"):
                state = item.state if self.proof is None else self.proof.mirrored.state(item.state)
                save_state(self.job.folder, self.job.content_hash, state, row)
                if isinstance(self._gaps, ContactWatch):
                    self._gaps.write(item)

    def _with_gap(self, row: PathRow, touch: Touch) -> PathRow:
        """The row with its gap; the first touch is noted."""
        modelled = self._gaps is not None and self._gaps.modelled
        if touch.gap.gap_mm <= 0.0 and not modelled and not any(r.min_gap_mm <= 0.0 for r in self.rows):
            last = self.rows[-1].pressure_kpa if self.rows else 0.0
            r, z = touch.gap.at_mm
            self.notes.append(
                f"{CONTACT} beyond {last:.4g} kPa: {touch.between} touch first between {last:.4g} and "
                f"{row.pressure_kpa:.4g} kPa, at r = {r:.2f}, z = {z:.2f} mm"
            )
        return dataclasses.replace(row, min_gap_mm=touch.gap.gap_mm)

    def step(self, memory: PathMemory | GuessMemory) -> None:
        """Write the critical mode if it has just been found, and the checkpoint."""
        self.memory = memory
        if self.comm.rank != 0:
            return
        with self.problem.timer("output"):
            crossing = memory.crossing
            if crossing is not None and crossing.state is not None and crossing.mode is not None and not self._has_mode:
                pair = (crossing.state, crossing.mode)
                if self.proof is not None:
                    whole = self.proof.mirrored
                    pair = (whole.state(crossing.state), whole.of_class(crossing.mode, crossing.of_class))
                write_mode(self.job.folder / MODE_FILE, self.mesh, *pair)
                self._has_mode = True
            notes = {
                "rows": [asdict(row) for row in self.rows],
                "factorisations": self._factorisations + self.factor.count,
                "seconds": self._seconds + time.perf_counter() - self._begin,
                "notes": self.notes,
            }
            write_path(self.job.folder, self.rows)
            write_checkpoint(self._file, self.job.content_hash, memory, notes)

    def finish(self, path: EquilibriumPath, measured: SolidMesh, masses_g: tuple[float, float]) -> Run:
        """Write the run's path and summary on rank 0; the same Run on every rank.

        Parameters
        ----------
        measured
            The mesh whose quality is reported: that of the meridian for a body made from one.
        masses_g
            Of silicone and rings.
        """
        job, problem = self.job, self.problem
        path = without_missed(path, self.notes)
        made = self._factorisations + self.factor.count
        solved = problem.index_map.size_global + problem.extra
        peak = provenance.peak_memory_mb(self.comm)
        self.factor.close()
        summary = None
        if self.comm.rank == 0:
            self._add_warnings(measured)
            summary = RunSummary(
                scene=job.scene.name,
                model=job.model,
                level=job.level,
                status="reached" if path.reached else "stopped",
                reason=ending(("vacuum: " if path.reason and job.sense < 0.0 else "") + path.reason, self.notes),
                content_hash=job.content_hash,
                plan=tuple(self.notes),
                dofs=solved if self.proof is None else self.proof.unknowns,
                solved_dofs=solved,
                cells=len(self.mesh.cells),
                nodes=len(self.mesh.points),
                factorisations=made,
                newton_iterations=sum(row.newton_iterations for row in self.rows),
                rejected_steps=path.rejected,
                silicone_g=masses_g[0],
                ring_g=masses_g[1],
                time_s={
                    **{k: float(v) for k, v in problem.timer.seconds.items()},
                    "total": self._seconds + time.perf_counter() - job.begin,
                },
                peak_mb=peak,
                cause=str(path.cause),
                crossing=crossing_facts(path.crossing, job.sense, self.parts),
                **provenance.stamp(self.comm),
            )
            write_path(job.folder, self.rows)
            write_summary(job.folder, summary)
            self._file.unlink(missing_ok=True)
        summary = self.comm.bcast(summary)
        assert summary is not None
        how = "reached" if path.reached else f"stopped at {farthest_kpa(self.rows):.2f} kPa: {summary.reason}"
        job.progress.end(
            f"{job.label}: {how}; {summary.dofs} unknowns, {made} factorisations, {summary.time_s['total']:.1f} s"
        )
        return Run(summary, tuple(self.rows))

    def _add_warnings(self, measured: SolidMesh) -> None:
        stretches = [(row.pressure_kpa, row.largest_stretch) for row in self.rows if row.status == "requested"]
        self.notes += [WARNING + text for text in stretch_warnings(self.job.scene, stretches)]
        cells = mesh_quality(measured).boundary_only_cells
        if cells:
            self.notes.append(f"{WARNING}{cells} cells have all corners on the boundary: they lock")
        if not self.problem.conservative:
            self.notes.append(
                f"{WARNING}the load is not conservative: unsymmetric tangent, unstable modes are not counted"
            )


def path_row(item: PathState, tip: Tip | None, parts: int = 1, sense: float = 1.0) -> PathRow:
    """A row of path.csv; volume, energy and forces are those of the whole, of which a sector is one of ``parts``.

    With ``sense`` -1 the load is a vacuum, and what does work on it minus the volume.
    """
    unstable = item.newton.excess_negatives
    return PathRow(
        pressure_kpa=sense * 1e3 * item.state.load_mpa,
        control=item.control,
        tip_mm=math.nan if tip is None else tip.mean_mm(item.state),
        tip_centre_mm=math.nan if tip is None else tip.centre_mm(item.state),
        tip_force_n=parts * item.end_force_n,
        volume_mm3=sense * parts * item.volume_mm3,
        energy_mj=parts * item.energy_mj,
        reaction_n=parts * item.reaction_n,
        min_det_f=item.newton.min_det_f,
        min_gap_mm=math.nan,
        unstable_modes=math.nan if unstable is None else float(unstable),
        unstable_by_m="",
        newton_iterations=item.newton.iterations,
        wall_s=item.wall_s,
        status="requested" if item.asked else "step",
        bond_slip_rms_mm=item.bond_slip_mm,
        limit_kpa=sense * 1e3 * item.limit_mpa,
        largest_stretch=item.newton.largest_stretch,
        residual=item.newton.residual,
    )


def write_fields(folder: Path, run: Run, mesh: SolidMesh, loads_kpa: Iterable[float]) -> None:
    """Write the fields of kept states for ParaView, and the collection of all that are there."""
    for load in loads_kpa:
        saved = load_state(folder, run.summary.content_hash, 1e-3 * load)
        if saved is not None:
            write_vtu(field_file(folder, 1e-3 * load), mesh, saved[0])
    write_collection(folder, [row.pressure_kpa for row in run.requested])


def without_fields(folder: Path, run: Run) -> list[float]:
    """Requested loads that a run has reached but whose fields are not there, kPa."""
    reached = [row.pressure_kpa for row in run.requested]
    return [load for load in reached if not field_file(folder, 1e-3 * load).exists()]
