"""A run on its way and when it is done: rows, checkpoints, first touch, summary; the same for every kind of scene."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from mpi4py import MPI

from meshes.quality import mesh_quality
from meshes.solid import SolidMesh
from solvers.linear.factor import Factor
from solvers.output import write_mode
from solvers.paths.checkpoint import CheckpointError, read_checkpoint, write_checkpoint
from solvers.paths.records import Crossing, GuessMemory, PathMemory, PathState
from solvers.paths.records import Path as EquilibriumPath
from solvers.problem import Problem
from studies.models.contact import ContactWatch
from studies.models.gaps import GapMeter, Touch
from studies.progress import Progress
from studies.results import provenance
from studies.results.files import (
    FIELDS_FOLDER,
    PathRow,
    RunSummary,
    read_path,
    read_summary,
    write_path,
    write_summary,
    write_text_atomically,
)


@dataclass(frozen=True)
class Run:
    """A finished or stopped run, read back from disk."""

    summary: RunSummary
    path: tuple[PathRow, ...]


def finished_run(folder: Path, content_hash: str) -> Run | None:
    """The run in a folder if it is there, whole and of this content."""
    try:
        summary = read_summary(folder)
        if summary.content_hash != content_hash:
            return None
        return Run(summary, tuple(read_path(folder)))
    except (OSError, ValueError, KeyError, TypeError):
        return None


CHECKPOINT_FILE, MODE_FILE = "checkpoint.npz", "critical_mode"


@dataclass(frozen=True)
class Job:
    """What identifies a run while it goes on."""

    scene: str
    model: str
    level: str
    folder: Path
    content_hash: str
    notes: tuple[str, ...]
    progress: Progress
    begin: float
    sense: float = 1.0  # -1: loads are a vacuum

    @property
    def label(self) -> str:
        """Scene, model and mesh."""
        return f"{self.scene} {self.model} {self.level}"


def begin(
    scene: str,
    model: str,
    level: str,
    folder: Path,
    content_hash: str,
    notes: Sequence[str],
    progress: Progress,
    highest_mpa: float,
    sense: float = 1.0,
) -> Job:
    """Start the clock, the memory's peak and the progress of a run whose highest requested pressure is given."""
    provenance.reset_peak_memory()
    job = Job(scene, model, level, folder, content_hash, tuple(notes), progress, time.perf_counter(), sense)
    progress.begin(job.label, highest_mpa)
    return job


# Begins the note on first touch.
CONTACT = "contact not modelled"


def ending(reason: str, notes: Sequence[str]) -> str:
    """Why a path ended; if something touched before, that too."""
    touch = next((note for note in notes if note.startswith(CONTACT)), None)
    return f"{reason}; {touch}" if reason and touch else reason


class Log:
    """Rows, counters and files of a run on its way; what an interrupted run left is read first. Every rank calls.

    Parameters
    ----------
    job, comm, mesh
        The run, who takes part, and on what.
    row_of
        A converged state as a row of path.csv.
    """

    def __init__(
        self,
        job: Job,
        comm: MPI.Comm,
        mesh: SolidMesh,
        row_of: Callable[[PathState], PathRow],
        gaps: GapMeter | ContactWatch | None = None,
    ) -> None:
        self.job, self.comm, self.mesh, self.row_of, self._gaps = job, comm, mesh, row_of, gaps
        self.rows: list[PathRow] = []
        self.notes = list(job.notes)
        self.factorisations, self.seconds = 0, 0.0
        self._has_mode = False
        found: tuple[PathMemory | GuessMemory, Any] | str | None = None
        if comm.rank == 0:
            try:
                found = read_checkpoint(self._file, job.content_hash)
            except CheckpointError as error:
                found = str(error)
        found = comm.bcast(found)
        self.memory: PathMemory | GuessMemory | None = None
        if isinstance(found, str):
            self.notes.append(f"warning: {found}; this run started anew")
            job.progress.warn(f"{job.label}: {found}; starting anew")
        elif found is not None:
            self.memory, kept = found
            self.rows = [PathRow(**row) for row in kept["rows"]]
            self.factorisations, self.seconds = kept["factorisations"], kept["seconds"]
            self.notes = list(kept["notes"])
            job.progress.warn(f"{job.label}: going on after {self.rows[-1].pressure_kpa:.6g} kPa, from its checkpoint")
        self._begin = time.perf_counter()

    @property
    def _file(self) -> Path:
        return self.job.folder / CHECKPOINT_FILE

    def state(self, item: PathState) -> PathRow:
        """Take in a converged state."""
        row = self.row_of(item)
        if self._gaps is not None:
            row = self._with_gap(row, self._gaps.measure(item.state))
        self.rows.append(dataclasses.replace(row, wall_s=self.seconds + row.wall_s))
        self.job.progress.state(item.state.load_mpa)
        return self.rows[-1]

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

    def step(self, memory: PathMemory | GuessMemory, factor: Factor) -> None:
        """Write the critical mode if it has just been found, and the checkpoint."""
        if self.comm.rank != 0:
            return
        with factor.problem.timer("output"):
            crossing = memory.crossing
            if crossing is not None and crossing.state is not None and crossing.mode is not None and not self._has_mode:
                write_mode(self.job.folder / MODE_FILE, self.mesh, crossing.state, crossing.mode)
                self._has_mode = True
            notes = {
                "rows": [asdict(row) for row in self.rows],
                "factorisations": self.factorisations + factor.count,
                "seconds": self.seconds + time.perf_counter() - self._begin,
                "notes": self.notes,
            }
            write_path(self.job.folder, self.rows)
            write_checkpoint(self._file, self.job.content_hash, memory, notes)

    def done(self) -> None:
        """The run is written: its checkpoint is not needed any more."""
        if self.comm.rank == 0:
            self._file.unlink(missing_ok=True)


def stamp(comm: MPI.Comm) -> dict[str, Any]:
    """Provenance fields of a summary."""
    return {
        "versions": provenance.versions(),
        "blas": provenance.blas(),
        "ranks": comm.size,
        "threads": provenance.blas_threads(),
        "commit": provenance.commit(),
        "when": provenance.now(),
    }


def path_row(item: PathState, tip_mm: float, tip_centre_mm: float, parts: int = 1, sense: float = 1.0) -> PathRow:
    """A row of path.csv; volume, energy and forces are those of the whole, of which a sector is one of ``parts``.

    With ``sense`` -1 the load is a vacuum, and what does work on it minus the volume.
    """
    unstable = item.newton.excess_negatives
    return PathRow(
        pressure_kpa=sense * 1e3 * item.state.load_mpa,
        control=item.control,
        tip_mm=tip_mm,
        tip_centre_mm=tip_centre_mm,
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
    )


def field_file(folder: Path, pressure_mpa: float) -> Path:
    """Where a run's fields at a load are."""
    return folder / FIELDS_FOLDER / f"p{1e3 * abs(pressure_mpa):06.3f}.vtu"


def field_files(folder: Path, pressures_kpa: Sequence[float]) -> dict[float, Path]:
    """The field files a run has written, by pressure in kPa."""
    files = {p: field_file(folder, 1e-3 * p) for p in pressures_kpa}
    return {p: f for p, f in files.items() if f.exists()}


def write_collection(folder: Path, pressures_kpa: Sequence[float]) -> None:
    """A ParaView collection over the pressures."""
    entries = "".join(
        f'<DataSet timestep="{p:g}" file="{f.relative_to(folder)}"/>'
        for p, f in field_files(folder, pressures_kpa).items()
    )
    text = f'<?xml version="1.0"?><VTKFile type="Collection" version="0.1"><Collection>{entries}</Collection></VTKFile>'
    write_text_atomically(folder / "fields.pvd", text)


def _facts(crossing: Crossing | None, sense: float) -> dict[str, Any]:
    """A crossing for the summary, its load as a pressure."""
    if crossing is None:
        return {}
    return {
        "kind": str(crossing.kind),
        "pressure_kpa": sense * 1e3 * crossing.pressure_mpa,
        "within_kpa": 1e3 * crossing.within_mpa,
        "volume_mm3": sense * crossing.volume_mm3,
        "modes_before": crossing.modes_before,
        "modes_after": crossing.modes_after,
    }


def finish(
    log: Log,
    problem: Problem,
    factor: Factor,
    path: EquilibriumPath,
    measured: SolidMesh,
    masses: tuple[float, float],
) -> Run:
    """Write a run's path and summary on rank 0; the same Run on every rank.

    Parameters
    ----------
    measured
        The mesh whose quality is reported: that of the meridian for a body made from one.
    masses
        Of silicone and rings, g.
    """
    job, rows, mesh = log.job, log.rows, log.mesh
    made = log.factorisations + factor.count
    comm = problem.comm
    peak = provenance.peak_memory_mb(comm)
    factor.close()
    seconds = {k: float(v) for k, v in problem.timer.seconds.items()}
    summary = None
    if comm.rank == 0:
        quality = mesh_quality(measured)
        notes = log.notes
        if quality.boundary_only_cells:
            notes.append(f"warning: {quality.boundary_only_cells} cells have all corners on the boundary: they lock")
        if not problem.conservative:
            notes.append("warning: the load is not conservative: unsymmetric tangent, unstable modes are not counted")
        silicone, rings = masses
        summary = RunSummary(
            scene=job.scene,
            model=job.model,
            level=job.level,
            status="reached" if path.reached else "stopped",
            reason=ending(("vacuum: " if path.reason and job.sense < 0.0 else "") + path.reason, notes),
            content_hash=job.content_hash,
            plan=tuple(notes),
            dofs=problem.index_map.size_global + problem.extra,
            cells=len(mesh.cells),
            nodes=len(mesh.points),
            factorisations=made,
            newton_iterations=sum(row.newton_iterations for row in rows),
            rejected_steps=path.rejected,
            silicone_g=silicone,
            ring_g=rings,
            time_s={**seconds, "total": log.seconds + time.perf_counter() - job.begin},
            peak_mb=peak,
            cause=str(path.cause),
            crossing=_facts(path.crossing, job.sense),
            **stamp(comm),
        )
        write_path(job.folder, rows)
        write_summary(job.folder, summary)
        log.done()
    summary = comm.bcast(summary)
    assert summary is not None
    last = rows[-1].pressure_kpa if rows else 0.0
    how = "reached" if path.reached else f"stopped at {last:.2f} kPa: {summary.reason}"
    job.progress.end(
        f"{job.label}: {how}; {summary.dofs} unknowns, {made} factorisations, {summary.time_s['total']:.1f} s"
    )
    return Run(summary, tuple(rows))
