"""``bellowsx plan``, ``solve`` and ``batch``: scenes by the models that their tolerance asks for."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click
from mpi4py import MPI

from studies.command.common import (
    BAD_INPUT,
    FAULTS,
    JSON,
    MODEL,
    OUT,
    SCENE,
    SCENES,
    STOPPED,
    check_writable,
    examples,
    guarded,
    load_scenes,
    say,
)
from studies.planning.levels import Model
from studies.planning.plan import Plan
from studies.planning.planner import describe, make_plan
from studies.scene.load import Scene

if TYPE_CHECKING:
    from studies.models.session import SceneResult

# What solves a scene is imported by the first that is solved: a plan needs no finite elements.


@click.command(epilog=examples("bellowsx plan scenes/heung-t2-ri5.toml", "bellowsx plan my.toml --model full3d"))
@SCENE
@MODEL
def plan(scene: Path, model: Model | None) -> None:
    """Print what would be solved for SCENE, what is skipped, and why."""
    ((checked, _),) = load_scenes((scene,), model)
    say(describe(checked, make_plan(checked, model)))


@click.command(
    epilog=examples(
        "bellowsx solve scenes/heung-t2-ri5.toml --out results/t2",
        "bellowsx solve my.toml --out results/my --model full3d",
        "mpirun -n 2 bellowsx solve my.toml --out results/my --model full3d",
    )
)
@SCENE
@OUT
@MODEL
@JSON
def solve(scene: Path, out: Path, model: Model | None, as_json: bool) -> None:
    """Solve SCENE; writes path.csv, summary.json and rows.csv into the output folder.

    Finished runs of the same content are not repeated, an interrupted one goes on. Exit codes: 0 all requested
    pressures reached within the tolerance; 2 bad input, nothing written; 3 stopped early or the tolerance is not met,
    what was reached is kept.
    """
    ((checked, text),) = load_scenes((scene,), model)
    check_writable(out)
    sys.exit(solve_scene(checked, text, make_plan(checked, model), out, MPI.COMM_WORLD, as_json))


@click.command(
    epilog=examples(
        "bellowsx batch scenes/heung-*.toml --out results/batch",
        "mpirun -n 2 bellowsx batch a.toml b.toml --out results/batch --ranks-per-scene 1",
    )
)
@SCENES
@OUT
@MODEL
@click.option("--ranks-per-scene", type=click.Choice(["1", "2"]), default="1", show_default=True)
def batch(scenes: tuple[Path, ...], out: Path, model: Model | None, ranks_per_scene: str) -> None:
    """Solve many SCENES, each into a folder of its name; run under mpirun to share them out.

    Finished scenes are not repeated, so an interrupted batch goes on where it was. The exit code is the worst.
    """
    checked = load_scenes(scenes, model)
    check_writable(out)
    world, size = MPI.COMM_WORLD, int(ranks_per_scene)
    if world.size % size:
        say(f"--ranks-per-scene {size}: does not divide the number of ranks, {world.size}", err=True)
        sys.exit(BAD_INPUT)
    mine = world.rank // size
    comm = world.Split(mine, world.rank)
    codes = [
        solve_scene(scene, text, make_plan(scene, model), out / scene.name, comm)
        for scene, text in checked[mine :: world.size // size]
    ]
    code = world.allreduce(max(codes, default=0), op=MPI.MAX)
    say(f"{len(checked)} scenes in {out}")
    sys.exit(code)


def solve_scene(scene: Scene, text: str, plan: Plan, out: Path, comm: MPI.Comm, as_json: bool = False) -> int:
    """Run a plan and print its answers; returns the exit code."""
    from studies.models.session import run_plan
    from studies.progress import Progress

    progress = Progress(comm)

    def work() -> int:
        try:
            result = run_plan(scene, text, plan, out, comm, progress)
        except FAULTS as error:
            progress.end("")
            if comm.rank == 0:
                click.echo(f"{scene.name}: {error}", err=True)
            return STOPPED
        if comm.rank == 0:
            _tell(result, as_json)
        return 0 if result.reached and not result.missed else STOPPED

    return guarded(scene.name, work)


def _tell(result: SceneResult[Scene], as_json: bool) -> None:
    """The answers on standard output; warnings and why a run stopped on the other."""
    from studies.command import solve_output

    if as_json:
        click.echo(solve_output.as_json(result))
    else:
        solve_output.show(result)
    for note in result.warnings:
        click.echo(f"{result.scene.name}: {note}", err=True)
    if not result.reached:
        click.echo(f"{result.scene.name}: stopped early: {result.reason}", err=True)
    if result.missed:
        click.echo(f"{result.scene.name}: {result.shortfall}", err=True)
