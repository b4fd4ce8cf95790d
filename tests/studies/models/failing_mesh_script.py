"""A body whose meridian rank 0 cannot mesh; the last line says, as JSON, what each rank was told."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from mpi4py import MPI

from meshes.errors import MeshError
from studies.models import full3d
from studies.planning.levels import BodyLevel
from studies.progress import Progress
from studies.scene.load import load_bellows


def main(scene_path: str, folder: str) -> None:
    def no_mesh(scene, refinement):
        raise MeshError("the ring could not be meshed")

    full3d.scene_meridian = no_mesh
    comm, out = MPI.COMM_WORLD, Path(folder)
    try:
        full3d.run_full3d(
            load_bellows(Path(scene_path)), "full3d", BodyLevel(8), out / "flat", out, comm, Progress(comm), ()
        )
        told = ""
    except MeshError as error:
        told = str(error)
    every = comm.gather(told)
    if every is not None:
        print(json.dumps(every))


main(*sys.argv[1:])
