"""The stress test: every cell solved once, shared out over the ranks, and the report about them.

Outcomes are files named by what is solved and by the code that solves it: a second study repeats nothing, and an
interrupted one goes on where it was.
"""

from __future__ import annotations

import pickle
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final, TypeVar

import threadpoolctl
from mpi4py import MPI

from solvers.files import write_atomically
from studies import launch
from studies.results import provenance
from studies.results.files import write_text_atomically
from studies.stability.cells import Bellows, Cell, cells, controls
from studies.stability.report import Result, write_report
from studies.stability.run import (
    Outcome,
    Reference,
    key_of,
    outcome_text,
    read_outcome,
    read_reference,
    reference_of,
    reference_text,
    run_cell,
)

CELLS_FOLDER: Final = "cells"
REFERENCES_FOLDER: Final = "references"
# A child that runs cells on other numbers of ranks or threads takes seconds; this long means it hangs.
CHILD_LIMIT_S: Final = 600.0

Kept = TypeVar("Kept")
Task = tuple[Bellows, tuple[float, ...]]


def write_study(folder: Path, comm: MPI.Comm, say: Callable[[str], None] = lambda text: None) -> tuple[Path, bool]:
    """Run what is missing and write the report; every rank calls.

    Parameters
    ----------
    folder
        Outcomes, report.html, report.md, rows.csv and pictures go there.
    comm
        The ranks that share the cells.
    say
        Called on rank 0 with a line of progress.

    Returns
    -------
    tuple
        Path of report.html, and True if no cell is a wrong answer and all the study's demands are met.
    """
    return run_study(folder, comm, cells(), controls(), say)


def run_study(
    folder: Path,
    comm: MPI.Comm,
    of_product: Sequence[Cell],
    pairs: Sequence[tuple[Cell, Cell]],
    say: Callable[[str], None] = lambda text: None,
) -> tuple[Path, bool]:
    """As `write_study`, of other cells and pairs of a control and its counterpart."""
    every = [*of_product, *(cell for pair in pairs for cell in pair)]
    quiet = say if comm.rank == 0 else (lambda text: None)
    with threadpoolctl.threadpool_limits(1):
        tasks = _references(every)
        quiet(f"{len(tasks)} bellows on three meshes each")
        for task in tasks[comm.rank :: comm.size]:
            _reference(folder, task)
        comm.barrier()
        alone = [cell for cell in every if (cell.ranks, cell.threads) == (1, 1)]
        for place, cell in enumerate(alone[comm.rank :: comm.size]):
            if place % 50 == 0:
                quiet(f"cell {place * comm.size + 1} of {len(every)}")
            _outcome(folder, cell, tasks)
        comm.barrier()
    answer: tuple[Path, bool] | Exception | None = None
    if comm.rank == 0:
        try:
            failed: dict[Cell, Outcome] = {}
            for setting in sorted({(c.ranks, c.threads) for c in every if c not in alone}):
                quiet(f"{setting[0]} ranks with {setting[1]} threads each")
                wanted = [c for c in every if (c.ranks, c.threads) == setting]
                failed |= _by_child(folder, wanted, tasks, *setting)

            def result(cell: Cell) -> Result:
                return Result(cell, failed.get(cell) or _outcome(folder, cell, tasks))

            results = [result(cell) for cell in of_product]
            compared = [(result(a), result(b)) for a, b in pairs]
            answer = write_report(folder, results, compared)
        except Exception as error:
            answer = error
    _wait(comm)
    answer = comm.bcast(answer)
    if isinstance(answer, Exception):
        raise answer
    assert answer is not None
    return answer


def _wait(comm: MPI.Comm) -> None:
    """A barrier that leaves the cores to rank 0's children."""
    request = comm.Ibarrier()
    while not request.Test():
        time.sleep(0.05)


def _references(every: Sequence[Cell]) -> list[Task]:
    """Bellows to be run on several meshes, each with all loads of one sign that its cells ask for."""
    loads: dict[tuple[Bellows, bool], set[float]] = {}
    for cell in every:
        if isinstance(cell.body, Bellows):
            loads.setdefault((cell.body.ideal, cell.load_kpa < 0.0), set()).add(cell.load_kpa)
    return [(body, tuple(sorted(found))) for (body, _), found in loads.items()]


def _kept(path: Path, read: Callable[[str], Kept]) -> Kept | None:
    try:
        return read(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _reference(folder: Path, task: Task) -> Reference:
    path = folder / REFERENCES_FOLDER / f"{key_of(task)}.json"
    found = _kept(path, read_reference)
    if found is None:
        found = reference_of(*task)
        write_text_atomically(path, reference_text(found))
    return found


def _file(folder: Path, cell: Cell) -> Path:
    return folder / CELLS_FOLDER / f"{key_of(cell)}.json"


def _outcome(folder: Path, cell: Cell, tasks: Sequence[Task]) -> Outcome:
    """A cell's outcome, from its file or by solving it on this process."""
    found = _kept(_file(folder, cell), read_outcome)
    if found is None:
        found = run_cell(cell, MPI.COMM_SELF, _reference_for(folder, cell, tasks))
        write_text_atomically(_file(folder, cell), outcome_text(found))
    return found


def _reference_for(folder: Path, cell: Cell, tasks: Sequence[Task]) -> Reference | None:
    if not isinstance(cell.body, Bellows):
        return None
    body = cell.body.ideal
    return next(_reference(folder, task) for task in tasks if task[0] == body and cell.load_kpa in task[1])


# --- other numbers of ranks and threads -----------------------------------------------------------------------


def _by_child(
    folder: Path, wanted: Sequence[Cell], tasks: Sequence[Task], ranks: int, threads: int
) -> dict[Cell, Outcome]:
    """Solve cells in a child of so many ranks with so many threads each; outcomes of those that it did not solve."""
    missing = [cell for cell in wanted if _kept(_file(folder, cell), read_outcome) is None]
    if not missing:
        return {}
    work = []
    for cell in missing:
        single = _outcome(folder, replace(cell, ranks=1, threads=1), tasks)
        work.append((cell, _reference_for(folder, cell, tasks), single.value_mm))
    order = folder / f"ranks-{ranks}-{threads}.pickle"
    write_atomically(order, pickle.dumps(work))
    command = launch.on_ranks(ranks, "-m", "studies.stability.study", str(folder), str(order))
    why = "no mpirun was found" if launch.launcher() is None else ""
    if not why:
        try:
            done = subprocess.run(
                command,
                cwd=provenance.ROOT,
                env=launch.environment(threads),
                capture_output=True,
                text=True,
                timeout=CHILD_LIMIT_S,
                check=False,
            )
            why = "" if done.returncode == 0 else f"exit {done.returncode}: {done.stderr[-300:]}"
        except subprocess.TimeoutExpired:
            why = f"not done after {CHILD_LIMIT_S:g} s"
    order.unlink()
    crash = Outcome("wrong", cause="crash", reason=f"{ranks} ranks with {threads} threads: {why}")
    return {cell: crash for cell in missing if _kept(_file(folder, cell), read_outcome) is None}


def _child(folder: Path, order: Path) -> None:
    """Solve the cells of a file on all ranks of this process's world."""
    comm = MPI.COMM_WORLD
    work: list[tuple[Cell, Reference | None, float]] = comm.bcast(
        pickle.loads(order.read_bytes()) if comm.rank == 0 else None
    )
    for cell, reference, alone_mm in work:
        outcome = run_cell(cell, comm, reference, alone_mm)
        if comm.rank == 0:
            write_text_atomically(_file(folder, cell), outcome_text(outcome))


if __name__ == "__main__":
    _child(Path(sys.argv[1]), Path(sys.argv[2]))
