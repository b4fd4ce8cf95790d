"""Run under mpirun by test_inertia_on_ranks.py: unstable modes of the 2 mm actuator in 3D, more than 90,000 unknowns.

The unloaded shape under a pressure is no equilibrium, but its tangent has many negative pivots to lose.
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

from mpi4py import MPI

from solvers.linear.factor import Factor
from studies.models.build import scene_problem
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_body, scene_meridian

ROOT = Path(__file__).resolve().parents[3]


def main() -> None:
    comm = MPI.COMM_WORLD
    scene = load_bellows(ROOT / "scenes" / "heung-t2-ri5.toml")
    body = scene_body(scene_meridian(scene, 1), "full3d", 10)
    problem = scene_problem(scene, body if comm.rank == 0 else None, comm)
    factor = Factor(problem)
    found = []
    for pressure_mpa in (0.0, 0.01, 0.03):
        problem.set_state(dataclasses.replace(problem.zero_state(), load_mpa=pressure_mpa))
        factor.refresh()
        found.append(factor.excess_negatives)
    if comm.rank == 0:
        unknowns = problem.index_map.size_global + problem.extra
        print(json.dumps({"ranks": comm.size, "unknowns": unknowns, "modes": found}))


if __name__ == "__main__":
    main()
