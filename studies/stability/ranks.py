"""Cells on other numbers of ranks and threads, in a child: ``python -m studies.stability.ranks FILE``."""

from __future__ import annotations

import pickle
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mpi4py import MPI

from solvers.files import write_atomically
from studies import launch
from studies.results.kept import keep, read_kept
from studies.stability.cells import Cell
from studies.stability.judge import CRASH, Outcome, crash
from studies.stability.references import Reference
from studies.stability.run import run_cell

# A child takes seconds; this long means it hangs.
LIMIT_S = 600.0


@dataclass(frozen=True)
class Job:
    """A cell, what it is compared with, and where its outcome is kept under which key."""

    cell: Cell
    reference: Reference | None
    alone_mm: float
    file: Path
    key: str

    @property
    def missing(self) -> bool:
        """True if there is no outcome, or one that was a crash."""
        found = read_kept(self.file, self.key, Outcome)
        return found is None or found.cause == CRASH


def run_in_child(jobs: Sequence[Job], ranks: int, threads: int, folder: Path) -> None:
    """Solve jobs in a child of so many ranks with so many threads each; all have an outcome then."""
    missing = [job for job in jobs if job.missing]
    if not missing:
        return
    order = folder / f"ranks-{ranks}-{threads}.pickle"
    write_atomically(order, pickle.dumps(missing))
    command = launch.on_ranks(ranks, "-m", __name__, str(order))
    try:
        ended = launch.run(command, launch.environment(threads), LIMIT_S)
        why = f"exit {ended.code} after {ended.wall_s:.0f} s: {ended.error[-300:]}"
    except OSError as error:  # no mpirun
        why = str(error)
    order.unlink()
    for job in missing:
        if job.missing:
            keep(job.file, job.key, crash(f"{ranks} ranks with {threads} threads: {why}"))


def _child(order: Path) -> None:
    """Solve the jobs of a file on all ranks of this process's world."""
    comm = MPI.COMM_WORLD
    jobs: list[Job] = comm.bcast(pickle.loads(order.read_bytes()) if comm.rank == 0 else None)
    for job in jobs:
        outcome = run_cell(job.cell, comm, job.reference, job.alone_mm)
        if comm.rank == 0:
            keep(job.file, job.key, outcome)


if __name__ == "__main__":
    _child(Path(sys.argv[1]))
