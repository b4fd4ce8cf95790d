"""Run under mpirun by test_full3d_on_a_quarter.py: a scene in full 3D; prints the rows of its path.

Arguments: the scene, and the folder for its runs.
"""

from __future__ import annotations

import dataclasses
import json
import sys
from pathlib import Path

from mpi4py import MPI

from studies.models.axisymmetric import run_axisymmetric
from studies.models.full3d import run_full3d
from studies.planning.levels import BodyLevel
from studies.progress import Progress
from studies.scene.load import load_bellows


def main(file: Path, out: Path) -> None:
    comm = MPI.COMM_WORLD
    scene, progress = load_bellows(file), Progress(comm)
    run_axisymmetric(scene, 1, out / "flat", comm, progress)
    run = run_full3d(scene, "full3d", BodyLevel(8), out / "flat", out / "body", comm, progress, ())
    if comm.rank == 0:
        print(json.dumps([dataclasses.asdict(row) for row in run.path]))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
