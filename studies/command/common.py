"""What the commands share: exit codes, options, loading scenes, messages."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

import click
from mpi4py import MPI

from studies.scene.sections import SceneError

BAD_INPUT, STOPPED = 2, 3


def say(text: str, err: bool = False) -> None:
    """Print on rank 0."""
    if MPI.COMM_WORLD.rank == 0:
        click.echo(text, err=err)


def refuse(text: str) -> None:
    """End with a message and the exit code of bad input."""
    say(text, err=True)
    sys.exit(BAD_INPUT)


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
