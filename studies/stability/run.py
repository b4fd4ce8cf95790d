"""Run a cell of the stress test and judge it: here, or in a child on other numbers of ranks and threads.

``python -m studies.stability.run FILE``, under mpirun or not, is the child; FILE has its jobs.
"""

from __future__ import annotations

import dataclasses
import math
import pickle
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mpi4py import MPI

from solvers.atomic import write_atomically
from solvers.errors import StepFailed
from studies import mpi_children
from studies.results.kept import keep, read_kept
from studies.stability.bodies import pose
from studies.stability.cells import Cell
from studies.stability.judge import CRASH, Outcome, crash, judge
from studies.stability.paths import ends
from studies.stability.references import REFUSALS, Reference

# A child takes seconds; this long means it hangs.
LIMIT_S = 600.0


def run_cell(cell: Cell, comm: MPI.Comm, reference: Reference | None = None, alone_mm: float = math.nan) -> Outcome:
    """Solve a cell and judge it; every rank of ``comm`` calls, and nothing is raised.

    Parameters
    ----------
    reference
        Of a bellows.
    alone_mm
        The value on one rank and one thread, for a cell of more.
    """
    begin = time.perf_counter()
    try:
        (end,) = ends(cell, pose(cell, comm), [abs(cell.load_kpa)])
        outcome = judge(cell, end, reference, alone_mm)
    except StepFailed as error:  # a path has to end in one, not to break
        outcome = crash(f"{error.cause}: {error}")
    except REFUSALS as error:
        outcome = Outcome("refusal", cause=type(error).__name__, reason=" ".join(str(error).split()))
    except Exception as error:  # a crash without a name is what this study is looking for
        outcome = crash(f"{type(error).__name__}: {error}")
    return dataclasses.replace(outcome, seconds=time.perf_counter() - begin)


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
    command = mpi_children.on_ranks(ranks, "-m", __name__, str(order))
    try:
        ended = mpi_children.run(command, mpi_children.environment(threads), LIMIT_S)
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
