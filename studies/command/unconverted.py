"""Commands of studies that are not on the engine yet."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import click
from mpi4py import MPI

from studies.command.common import OUT, STOPPED, cannot_write, check_writable, load_scenes, say
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


@click.command()
@OUT
@click.option("--core", is_flag=True, help="Leave out the variants, each of which is a question of its own.")
@click.option("--audit", is_flag=True, help="Also run finer meshes than the study's, to see whether its bands hold.")
def paper(out: Path, core: bool, audit: bool) -> None:
    """Run the paper study: four actuators by every model, variants, and the report about the paper's numbers.

    Also in the report: whatever of the rest is in the output folder already. The exit code is 3 if a run of the four
    actuators did not reach every requested pressure.
    """
    check_writable(out)
    try:
        code = _paper(out, core, audit)
    except OSError as error:
        code = cannot_write("paper study", error)
    sys.exit(code)


def _paper(out: Path, core: bool, audit: bool) -> int:
    """Run the paper study and write its report; returns the exit code."""
    from studies.paper import cases as paper_cases
    from studies.paper import study as paper_study

    comm, progress = MPI.COMM_WORLD, Progress(MPI.COMM_WORLD)
    chosen = [case for case in paper_cases.cases() if case.group == "core" or not core]
    faults = paper_study.run_cases(out, chosen, comm, progress)
    if audit:
        faults += paper_study.run_cases(out, paper_cases.audit_cases(), comm, progress)
    code = 0
    if comm.rank == 0:
        for fault in faults:
            click.echo(fault, err=True)
        results, report = paper_study.write_report(out)
        stopped = [case for case in results.of("core") if not case.result.reached]
        for case in stopped:
            click.echo(f"{case.case.name}: stopped early: {case.result.reason}", err=True)
        code = STOPPED if faults or stopped else 0
        click.echo(f"report: {report}")
    return int(comm.bcast(code))


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


COMMANDS = (
    paper,
    sweep_study_command,
    smoke,
    exact_command,
    verification_command,
)
