"""Commands of studies that are not on the engine yet."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import click
from mpi4py import MPI

from studies.command.common import OUT, STOPPED, check_writable, load_scenes, say
from studies.command.report import write_reports
from studies.command.solve import solve_scene
from studies.models.session import run_all_models
from studies.planning.bellows import SECTOR_LEVELS, plan_bellows
from studies.planning.error_model import ROUNDS, cells_of
from studies.progress import Progress
from studies.results import provenance
from studies.scene.bellows import BellowsScene
from studies.scene.bodies import BodyScene

SMOKE_SCENE = "smoke-t2-ri5"


@click.command("sweep-study")
@OUT
def sweep_study_command(out: Path) -> None:
    """Map the elongation over root radius, wall and convolutions; where the closed form misleads; the report."""
    from studies.sweep import study as sweep_study

    check_writable(out)
    outcome = sweep_study.write_sweep_study(out, MPI.COMM_WORLD)
    say(f"report: {out / 'report.html'}")
    sys.exit(0 if outcome.reached else STOPPED)


@click.command()
@OUT
def smoke(out: Path) -> None:
    """Solve two convolutions by every model and write the report: shows in a minute that all works."""
    ((scene, text),) = load_scenes((provenance.ROOT / "scenes" / f"{SMOKE_SCENE}.toml",))
    check_writable(out)
    assert isinstance(scene, BellowsScene)
    levels = ROUNDS[cells_of(scene)][:1]
    code = solve_scene(
        scene, text, plan_bellows(scene, "full3d", levels, SECTOR_LEVELS[:1]), out / scene.name, MPI.COMM_WORLD
    )
    if MPI.COMM_WORLD.rank == 0:
        write_reports(out)
    MPI.COMM_WORLD.barrier()
    sys.exit(code)


@click.command("exact")
@OUT
def exact_command(out: Path) -> None:
    """Solve scenes/exact with every model each body has, beside the exact answers; write the report."""
    scenes = load_scenes(tuple(sorted((provenance.ROOT / "scenes" / "exact").glob("*.toml"))))
    check_writable(out)
    results = [
        run_all_models(scene, text, out / scene.name, MPI.COMM_WORLD, Progress(MPI.COMM_WORLD))
        for scene, text in scenes
        if isinstance(scene, BodyScene)
    ]
    code = 0 if all(result.reached for result in results) else STOPPED
    if MPI.COMM_WORLD.rank == 0:
        write_reports(out)
    MPI.COMM_WORLD.barrier()
    sys.exit(code)


@click.command("verification")
@OUT
@click.option(
    "--reuse", type=click.Path(path_type=Path), help="Take over finished runs from this folder, such as results/exact."
)
def verification_command(out: Path, reuse: Path | None) -> None:
    """Make the table of every exact and published problem; the exit code is 3 if one did not reach its loads."""
    from studies.verification import study as verification
    from studies.verification.report import render_verification

    scenes = sorted((provenance.ROOT / "scenes" / "exact").glob("*.toml"))
    check_writable(out)
    begin = time.perf_counter()
    found = verification.run_verification(scenes, out, reuse, MPI.COMM_WORLD, Progress(MPI.COMM_WORLD))
    if MPI.COMM_WORLD.rank == 0:
        say(f"report: {render_verification(out, found, time.perf_counter() - begin)}")
    MPI.COMM_WORLD.barrier()
    sys.exit(STOPPED if found.stopped else 0)


@click.command("benchmark-solver")
@OUT
def benchmark_solver(out: Path) -> None:
    """Measure tangent, factorisation and Newton iteration of a full body, and its path from warm and from cold."""
    from studies.cost import solver_benchmark

    check_writable(out)
    ((checked, _),) = load_scenes((provenance.ROOT / "scenes" / "heung-t2-ri5.toml",))
    assert isinstance(checked, BellowsScene)
    say("\n".join(solver_benchmark.run(checked, out)))


COMMANDS = (
    sweep_study_command,
    smoke,
    exact_command,
    verification_command,
    benchmark_solver,
)
