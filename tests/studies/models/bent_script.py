"""Run under mpirun by test_bent_on_ranks.py: a short actuator with its core off the axis; prints one JSON line.

Arguments: the scene, and the folder for its runs.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from mpi4py import MPI

from studies.engine import Setting
from studies.imperfection.bodies import Actuator, solve_body
from studies.planning.levels import BodyLevel
from studies.progress import Progress


def main() -> None:
    comm = MPI.COMM_WORLD
    at = Setting(Path(sys.argv[2]), comm, Progress(comm), {})
    found = solve_body(Actuator("short", sys.argv[1], (1.0, 2.0), (BodyLevel(6, 1),)), 0.10, BodyLevel(6, 1), at)
    if comm.rank == 0:
        print(
            json.dumps(
                {
                    "ranks": comm.size,
                    "status": found.run.summary.status,
                    "tips": [row.tip_mm for row in found.run.path],
                    "bends": [pose.bend_deg for pose in found.poses.values()],
                    "volumes": [row.volume_mm3 for row in found.run.path],
                    "iterations": [row.newton_iterations for row in found.run.path],
                    "modes": [row.unstable_modes for row in found.run.path],
                }
            )
        )


if __name__ == "__main__":
    main()
