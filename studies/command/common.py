"""What the commands share: exit codes, options, loading scenes, messages."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

import click
from mpi4py import MPI

from analytical.bellows.dimensions import BellowsError
from meshes.errors import GeometryError, MeshError
from solvers.errors import SolverError
from studies.planning.levels import MODELS, Model
from studies.planning.planner import make_plan
from studies.scene.load import Scene, load_scene
from studies.scene.sections import SceneError

BAD_INPUT, STOPPED = 2, 3
# What may go wrong in a run; it is named, and what was reached is kept.
FAULTS = (GeometryError, MeshError, SolverError, BellowsError)

SCENE = click.argument("scene", type=click.Path(path_type=Path))
SCENES = click.argument("scenes", nargs=-1, required=True, type=click.Path(path_type=Path))
OUT = click.option(
    "--out", required=True, type=click.Path(path_type=Path), help="Folder for the results; made if missing."
)
MODEL = click.option(
    "--model",
    type=click.Choice(MODELS),
    help="Force this model; default: the cheapest whose error can be held within the scene's tolerance.",
)
JSON = click.option("--json", "as_json", is_flag=True, help="Print JSON, for programs.")


def examples(*lines: str) -> str:
    """Epilogue of a command's help."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in lines)


def say(text: str, err: bool = False) -> None:
    """Print on rank 0."""
    if MPI.COMM_WORLD.rank == 0:
        click.echo(text, err=err)


def refuse(text: str) -> NoReturn:
    """End with a message and the exit code of bad input."""
    say(text, err=True)
    sys.exit(BAD_INPUT)


def load_scenes(paths: tuple[Path, ...], model: Model | None = None) -> list[tuple[Scene, str]]:
    """All scenes and their files' texts, or exit with every fault found, also of the model; nothing is written."""
    scenes, faults = [], []
    for path in paths:
        try:
            scenes.append((load_scene(path), path.read_text(encoding="utf-8")))
            make_plan(scenes[-1][0], model)
        except SceneError as error:
            faults.append(str(error))
    names = [scene.name for scene, _ in scenes]
    faults += [f"name = {n!r}: two scenes have it; give each its own" for n in {n for n in names if names.count(n) > 1}]
    if faults:
        refuse("\n".join(faults))
    return scenes


def check_writable(folder: Path) -> None:
    """Exit if the output folder cannot be made or is a file."""
    parent = next(p for p in [folder, *folder.absolute().parents] if p.exists())
    if not parent.is_dir() or not os.access(parent, os.W_OK | os.X_OK):
        refuse(f"--out {folder}: {parent} is not a folder that can be written to")


def cannot_write(what: str, error: OSError) -> int:
    """Disk full, folder gone: only the rank that writes knows, so it ends the others; returns the exit code."""
    click.echo(f"{what}: cannot write the results: {error}", err=True)
    if MPI.COMM_WORLD.size > 1:
        MPI.COMM_WORLD.Abort(STOPPED)
    return STOPPED


def guarded(what: str, work: Callable[[], int]) -> int:
    """Exit code of some work; bad scenes are refused, a disk that cannot be written to is named."""
    try:
        return work()
    except SceneError as error:
        say(str(error), err=True)
        return BAD_INPUT
    except OSError as error:
        return cannot_write(what, error)
