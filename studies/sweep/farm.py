"""Many scenes at once: shared out over MPI ranks by mpi4py.futures, resumable, one table out.

``mpirun -n N`` works on the cores of one machine and on several; one rank needs no MPI launcher. Every scene is solved
by one rank, in a folder of its own that keeps its finished runs: a sweep that is started again repeats nothing, one
that was killed goes on.
"""

from __future__ import annotations

import json
import math
import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from mpi4py import MPI
from mpi4py.futures import MPICommExecutor

from studies.engine import FAULTS
from studies.first_rank import first
from studies.models.session import run_plan
from studies.planning.planner import make_plan
from studies.progress import Progress
from studies.results import provenance
from studies.results.rows import NOT_MET, REACHED
from studies.results.run_files import write_text_atomically
from studies.results.runs import finished_run
from studies.scene.sweep import Variant, read_sweep
from studies.sweep.csv_table import FAILED, REFUSED, SweepRow, refused_rows, solved_rows, value_text, write_table

TABLE_FILE, OUTCOME_FILE, SCENES_FOLDER = "sweep.csv", "sweep.json", "scenes"
# Scenes that wait at another rank, so that it goes on while this one is in the middle of its own.
_AHEAD = 2
# The table of an unfinished sweep is written that often, s.
_WRITE_EVERY_S = 10.0


@dataclass(frozen=True)
class SweepOutcome:
    """How a sweep went.

    Attributes
    ----------
    scenes, refused, failed, stopped, not_met
        Number of scenes; of those that cannot be built, that failed, that stopped before their last pressure, and that
        do not hold the tolerance.
    ranks, wall_s
        Who took part, and how long it took this time.
    solved_s
        Wall time of all scenes' runs when they were solved, one rank each, s.
    """

    scenes: int
    refused: int
    failed: int
    stopped: int
    not_met: int
    ranks: int
    wall_s: float
    solved_s: float

    @property
    def reached(self) -> bool:
        """True if every scene that can be built reached every requested pressure, and its tolerance."""
        return self.failed == self.stopped == self.not_met == 0


@dataclass(frozen=True)
class _Answer:
    """A scene's rows, and the wall time of its runs when they were solved, s."""

    rows: tuple[SweepRow, ...]
    solved_s: float

    def has(self, status: str) -> bool:
        """True if the status of a row begins so."""
        return any(row.status.startswith(status) for row in self.rows)


def run_sweep(file: Path, out: Path, comm: MPI.Comm, progress: Progress) -> SweepOutcome:
    """Run a sweep and write its table; every rank calls.

    Parameters
    ----------
    file
        The sweep file (`studies.scene.sweep`).
    out
        Where ``sweep.csv``, ``sweep.json`` and the scenes' folders go; what is there of the same content is used.
    comm
        Who takes part, this rank's included.
    progress
        Is told of every scene that has ended.

    Returns
    -------
    SweepOutcome
        The same on every rank.

    Raises
    ------
    SceneError
        On every rank, with one line per fault of the sweep file; nothing has been run or written.
    """
    begin, written = time.perf_counter(), 0.0
    variants = first(comm, lambda: read_sweep(file))
    found: dict[str, _Answer] = {}
    for variant, answer in _answers(variants, out / SCENES_FOLDER, comm):
        found[variant.name] = answer
        worst = next((r.status for r in answer.rows if r.status != REACHED), REACHED)
        progress.end(f"{len(found)} of {len(variants)} scenes: {_described(variant.values)}: {worst}")
        if time.perf_counter() - written > _WRITE_EVERY_S:
            write_table(out / TABLE_FILE, _table(variants, found))
            written = time.perf_counter()

    def finish() -> SweepOutcome:
        write_table(out / TABLE_FILE, _table(variants, found))
        outcome = SweepOutcome(
            scenes=len(variants),
            refused=sum(answer.has(REFUSED) for answer in found.values()),
            failed=sum(answer.has(FAILED) for answer in found.values()),
            stopped=sum(answer.has("stopped") for answer in found.values()),
            not_met=sum(answer.has(NOT_MET) for answer in found.values()),
            ranks=comm.size,
            wall_s=time.perf_counter() - begin,
            solved_s=sum(answer.solved_s for answer in found.values()),
        )
        stamp = {"commit": provenance.commit(), "when": provenance.now(), "machine": provenance.machine()}
        write_text_atomically(out / OUTCOME_FILE, json.dumps(asdict(outcome) | stamp, indent=1) + "\n")
        return outcome

    return first(comm, finish)


def _described(values: Mapping[str, Any]) -> str:
    """A scene's swept keys for a terminal."""
    return ", ".join(f"{key.split('.')[-1]} = {value_text(value)}" for key, value in values.items())


def _table(variants: Sequence[Variant], found: Mapping[str, _Answer]) -> list[SweepRow]:
    """All rows in the order of the sweep file, whatever has been found of them."""
    missing = {v.name: (SweepRow(v.name, v.values, math.nan, status="not run yet"),) for v in variants}
    return [row for v in variants for row in (found[v.name].rows if v.name in found else missing[v.name])]


# --- sharing out ----------------------------------------------------------------------------


def _answers(variants: Sequence[Variant], folder: Path, comm: MPI.Comm) -> Iterator[tuple[Variant, _Answer]]:
    """Answers as they come, on rank 0; the other ranks solve until there is nothing left and yield nothing."""
    if comm.rank == 0:
        yield from ((v, _Answer(refused_rows(v), 0.0)) for v in variants if v.scene is None)
    waiting = deque(sorted((v for v in variants if v.scene is not None), key=_expected_cost, reverse=True))
    if comm.size == 1:
        yield from ((variant, _answer(variant, folder)) for variant in waiting)
        return
    assert isinstance(comm, MPI.Intracomm)
    with MPICommExecutor(comm, root=0) as pool:
        if pool is None:
            return
        # Solving here calls MPI beside the pool's own thread, which not every MPI allows.
        takes_part = MPI.Query_thread() == MPI.THREAD_MULTIPLE
        away: dict[Future[_Answer], Variant] = {}
        while waiting or away:
            while waiting and len(away) < _AHEAD * (comm.size - 1):
                variant = waiting.popleft()
                away[pool.submit(_answer, variant, folder)] = variant
            if waiting and takes_part:
                variant = waiting.popleft()
                yield variant, _answer(variant, folder)
            else:
                wait(away, return_when=FIRST_COMPLETED)
            for future in [future for future in away if future.done()]:
                yield away.pop(future), future.result()


def _expected_cost(variant: Variant) -> float:
    """Grows with a scene's cost: its cells are about as large as the wall is thick."""
    assert variant.scene is not None
    return variant.scene.geometry.convolutions / variant.scene.geometry.wall_mm


def _answer(variant: Variant, folder: Path) -> _Answer:
    """Solve a scene on this rank alone."""
    assert variant.scene is not None
    ask = variant.scene.ask.model_copy(update={"modes": False})  # nobody looks at them
    scene, place = variant.scene.model_copy(update={"ask": ask}), folder / variant.name
    try:
        result = run_plan(scene, variant.text, make_plan(scene), place, MPI.COMM_SELF, Progress(MPI.COMM_WORLD))
    except FAULTS as error:
        return _Answer(solved_rows(variant, scene, (), " ".join(str(error).split())), 0.0)
    # As the files have them, so that the table is the same to the last digit when nothing is left to solve.
    kept = [
        finished_run(place / f"axisymmetric-{run.summary.level}", run.summary.content_hash)
        for run in result.axisymmetric
    ]
    runs = [run for run in kept if run is not None]
    return _Answer(solved_rows(variant, scene, runs), sum(run.summary.time_s["total"] for run in runs))
