"""Run by test_restart.py, also under mpirun: a small bellows in 3D through two pressures, whole or in two parts.

``whole FILE``: both pressures; ``stop FILE``: checkpoint after the first, then an end without warning; ``go FILE``: on
from the checkpoint. Prints one JSON line.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import numpy as np
from mpi4py import MPI
from ranks_script import SETTINGS, SHAPE, solver  # type: ignore[import-not-found]

from meshes.meridian import Resolution, meridian_mesh
from meshes.revolve import revolve, revolve_vector
from solvers.paths.checkpoint import read_checkpoint, write_checkpoint
from solvers.paths.path import follow_path
from solvers.paths.states import GuessMemory
from solvers.paths.warm_start import follow_guesses
from solvers.state import State


def main() -> None:
    comm = MPI.COMM_WORLD
    mode, file = sys.argv[1], Path(sys.argv[2])
    meridian = meridian_mesh(SHAPE, Resolution(through=2, cell_mm=1.5, arc_rad=0.8, cap_cells=2))
    body = revolve(meridian, 8)
    guesses = []
    flat_problem, flat_factor = solver(MPI.COMM_SELF, meridian)
    for point in follow_path(flat_problem, flat_factor, [0.005, 0.010], SETTINGS).states:
        if point.asked:
            flat = point.state
            motions = np.zeros((2, 6))
            motions[:, 2] = flat.bodies_mm[:, 0]
            u = revolve_vector(flat.displacement_mm, body)
            guesses.append(State(u, flat.pressure_mpa[body.meridian_node], motions, flat.load_mpa))
    problem, factor = solver(comm, body if comm.rank == 0 else None)

    def end_after_the_first(memory: GuessMemory) -> None:
        if comm.rank == 0:
            write_checkpoint(file, "two pressures", memory, {"iterations": []})
        comm.barrier()
        if mode == "stop":
            os._exit(0)

    resume = None
    if mode == "go":
        found = comm.bcast(read_checkpoint(file, "two pressures") if comm.rank == 0 else None)
        assert found is not None
        resume = found[0]
        assert isinstance(resume, GuessMemory)
    path = follow_guesses(problem, factor, guesses, SETTINGS, on_step=end_after_the_first, resume=resume)
    if comm.rank == 0:
        last = path.states[-1]
        print(
            json.dumps(
                {
                    "ranks": comm.size,
                    "solved": len(path.states),
                    "displacement": np.abs(last.state.displacement_mm).max(axis=0).tolist(),
                    "pressure": [last.state.pressure_mpa.min(), last.state.pressure_mpa.max()],
                    "bodies": last.state.bodies_mm[:, 2].tolist(),
                    "volume_energy_reaction": [last.volume_mm3, last.energy_mj, last.reaction_n],
                    "counts": [last.newton.iterations, last.newton.factorisations, last.newton.excess_negatives],
                }
            )
        )


if __name__ == "__main__":
    main()
