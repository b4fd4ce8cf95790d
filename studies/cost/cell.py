"""Measures one cell of the cost study: ``mpirun -n R python -m studies.cost.cell '{"body": …}' --out FOLDER``.

The last line on standard output is the measurement as JSON; `studies.cost.measure` adds what only it can see.
"""

from __future__ import annotations

import json
import math
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import click
from mpi4py import MPI

from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings, PathState
from studies.cost.cases import Cell, cell_scene
from studies.cost.measure import Measurement
from studies.models.axisymmetric import run_axisymmetric
from studies.models.body import run_simple_body
from studies.models.build import Tip, masses_g, scene_problem
from studies.models.closed_form import run_closed_form
from studies.models.full3d import run_full3d
from studies.models.gaps import GapMeter
from studies.models.run_log import Log, begin, path_row
from studies.planning.levels import BodyLevel, body_level, fineness
from studies.progress import Progress
from studies.results import provenance
from studies.results.runs import Run, run_hash, tip_at
from studies.scene.bellows import BellowsScene
from studies.scene.meshes import SECTORS, scene_body, scene_meridian


@dataclass(frozen=True)
class Answer:
    """Runs of a cell, the last being the answer, and its value at the highest requested pressure, mm."""

    runs: tuple[Run, ...]
    value: float
    pressure_kpa: float


def solve(cell: Cell, folder: Path, comm: MPI.Comm) -> Answer:
    """Solve a cell; every rank calls.

    Raises
    ------
    SolverError
        If a run failed for another reason than its load.
    """
    scene, progress = cell_scene(cell), Progress(comm)
    place = folder / f"{cell.model}-{cell.level}"
    if not isinstance(scene, BellowsScene):
        run = run_simple_body(scene, cell.model, cell.level, place, comm, progress)
        last = scene.loads_kpa[-1]
        return Answer((run,), run.measured_at(last, "bore_mm"), last)
    if cell.model == "closed_form":
        runs: tuple[Run, ...] = (run_closed_form(scene, place, comm),)
    elif cell.model == "axisymmetric":
        runs = (run_axisymmetric(scene, fineness(cell.level), place, comm, progress),)
    elif cell.strategy == "cold":
        runs = (cold_body(scene, cell, body_level(cell.level), place, comm, progress),)
    else:
        level = body_level(cell.level)
        base = folder / f"axisymmetric-r{level.meridian}"
        first = run_axisymmetric(scene, level.meridian, base, comm, progress)
        assert cell.model == "sector" or cell.model == "full3d"
        runs = (first, run_full3d(scene, cell.model, level, base, place, comm, progress, ()))
    last = scene.load.pressure_kpa[-1]
    return Answer(runs, tip_at(runs[-1], last), last)


def cold_body(
    scene: BellowsScene, cell: Cell, level: BodyLevel, folder: Path, comm: MPI.Comm, progress: Progress
) -> Run:
    """A body's own path from zero, without an axisymmetric state to start from; every rank calls."""
    key = run_hash(scene, f"{cell.model}-cold", level.name)
    job = begin(scene, cell.model, level.name, folder, progress, content_hash=key)
    meridian = scene_meridian(scene, level.meridian)
    body = scene_body(meridian, cell.model, level.around)
    meshed = time.perf_counter() - job.begin
    problem = scene_problem(scene, body if comm.rank == 0 else None, comm)
    problem.timer.seconds["mesh"] = meshed
    tip, parts, gaps = Tip(scene, body), SECTORS[cell.model], GapMeter(scene, meridian, body)
    log = Log(job, problem, Factor(problem), body, lambda item: path_row(item, tip, parts), gaps)

    def take(item: PathState) -> None:
        log.state(item)

    settings = PathSettings(control=scene.load.control)
    path = follow_path(
        problem, log.factor, scene.pressures_mpa, settings, progress.iteration, on_state=take, on_step=log.step
    )
    return log.finish(path, meridian, masses_g(scene, meridian))


def measure(cell: Cell, folder: Path, comm: MPI.Comm) -> Measurement:
    """Solve a cell and say what it took since the call; every rank calls."""
    start, cpu = time.perf_counter(), time.process_time()
    answer = solve(cell, folder, comm)
    work = float(comm.allreduce(time.perf_counter() - start, op=MPI.MAX))
    spent = float(comm.allreduce(time.process_time() - cpu, op=MPI.SUM))
    *before, last = (run.summary for run in answer.runs)
    split = {name: seconds for name, seconds in last.time_s.items() if name != "total"}
    if before:
        split["axisymmetric start"] = sum(summary.time_s["total"] for summary in before)
    return Measurement(
        value=answer.value,
        pressure_kpa=answer.pressure_kpa,
        wall_s=work,
        work_s=work,
        cpu_s=spent,
        peak_mb=max(summary.peak_mb for summary in (*before, last)),
        unknowns=last.dofs,
        factorisations=last.factorisations,
        compile_s=math.nan,
        split_s=split,
        status="reached" if last.status == "reached" else f"stopped: {last.reason}",
    )


@click.command()
@click.argument("cell")
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Empty folder for the runs.")
def main(cell: str, out: Path) -> None:
    """Measure CELL, given as JSON."""
    comm = MPI.COMM_WORLD
    wanted = Cell(**json.loads(cell))
    threads = provenance.blas_threads()
    if (comm.size, threads) != (wanted.ranks, wanted.threads):
        raise click.UsageError(f"{comm.size} ranks x {threads} BLAS threads: the cell has {wanted.setting}")
    found = measure(wanted, out, comm)
    if comm.rank == 0:
        click.echo("\n" + json.dumps(asdict(found)))


if __name__ == "__main__":
    main()
