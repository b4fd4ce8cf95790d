"""Child processes that are none of this process's MPI ranks: their environment, and how gmsh is run in one."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from meshes.errors import MeshError

# A ring's section takes well under a second, a solid with many curves a minute; this long means that gmsh hangs.
TIME_LIMIT_S = 300.0
_ROOT = Path(__file__).resolve().parents[2]

# Variables by which Open MPI, PRRTE, PMIx, and MPICH's Hydra tell a process that it is a rank.
_OF_A_RANK = ("OMPI_", "PMIX_", "PRTE_", "PMI_", "HYDI_", "HYDRA_", "MPI_LOCAL", "MPICH_")


def environment() -> dict[str, str]:
    """Environment without what makes this process a rank: a child of one must not believe that it is one too."""
    return {name: value for name, value in os.environ.items() if not name.startswith(_OF_A_RANK)}


def run_gmsh(module: str, failed: str, *arguments: str, text: str | None = None, seconds: float = TIME_LIMIT_S) -> str:
    """What a module prints that is run with gmsh in a child, which gmsh may abort.

    Parameters
    ----------
    module, arguments, text
        What is run, its arguments and its standard input.
    failed
        Begins the error, for instance ``gmsh cannot read it``.
    seconds
        Longer means that gmsh hangs.

    Raises
    ------
    MeshError
        If it fails or hangs; the message ends with the last that gmsh said.
    """
    command = [sys.executable, "-m", module, *arguments]
    try:
        done = subprocess.run(
            command,
            input=text,
            capture_output=True,
            text=True,
            timeout=seconds,
            env=environment(),
            cwd=_ROOT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise MeshError(f"{failed} within {seconds:g} s") from None
    if done.returncode != 0:
        lines = (done.stderr or done.stdout).split("\n")
        said = next((line.strip() for line in reversed(lines) if line.strip()), "silence").removeprefix("Exception: ")
        raise MeshError(f"{failed} (exit {done.returncode}): {said[:400]}")
    return done.stdout
