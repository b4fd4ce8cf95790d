"""Run by test_full3d_on_a_quarter.py, under mpirun too: a scene in full 3D as a whole and on a quarter."""

from __future__ import annotations

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
    found = {}
    for symmetry in ("auto", "off"):
        mesh = scene.mesh.model_copy(update={"symmetry": symmetry})
        of = scene.model_copy(update={"mesh": mesh})
        run = run_full3d(of, "full3d", BodyLevel(8), out / "flat", out / symmetry, comm, progress, ())
        found[symmetry] = {
            "rows": [
                {name: getattr(row, name) for name in row.__dataclass_fields__ if name != "control"} for row in run.path
            ],
            "status": run.summary.status,
            "crossing": run.summary.crossing,
            "unknowns": [run.summary.dofs, run.summary.solved_dofs],
            "cells": run.summary.cells,
            "plan": run.summary.plan,
        }
    if comm.rank == 0:
        print(json.dumps(found))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
