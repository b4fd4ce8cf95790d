"""Run by test_sweep.py, also under mpirun: a sweep file into a folder."""

from __future__ import annotations

import sys
from pathlib import Path

from mpi4py import MPI

from studies.progress import Progress
from studies.sweep.farm import run_sweep

if __name__ == "__main__":
    outcome = run_sweep(Path(sys.argv[1]), Path(sys.argv[2]), MPI.COMM_WORLD, Progress(MPI.COMM_WORLD))
    if MPI.COMM_WORLD.rank == 0:
        print(outcome.scenes, outcome.ranks)
