"""One point of the study of large bodies, in a process of its own: a Newton iteration's linear algebra by one solver.

``python -m studies.large.measure SCENE AROUND REFINEMENT METHOD FILE KEY``, under mpirun or not; keeps FILE under KEY.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from mpi4py import MPI

from solvers.errors import SolverError
from solvers.linear.factor import Factor
from solvers.linear.krylov import IterativeSolver
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from studies.models.build import revolve_state, scene_problem
from studies.results import provenance
from studies.results.kept import keep
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_body, scene_meridian

Method = Literal["direct", "iterative"]


@dataclass(frozen=True)
class Measured:
    """What was measured of a point.

    Attributes
    ----------
    method
        ``direct`` (MUMPS LDL') or ``iterative`` (GMRES).
    ranks, unknowns, cells
        Size.
    tangent_s, setup_s, solve_s
        Wall seconds of assembling the tangent, of factorising it or making its preconditioner, of one solve.
    setup_cpu_s, solve_cpu_s
        The same two in CPU seconds of all ranks, which other work on the machine disturbs less.
    iterations
        Of GMRES; 0 for a factorisation.
    peak_mb
        Peak memory of all ranks together.
    modes
        Unstable modes counted; -1 where they are not.
    failure
        Why there is no time; empty if there is.
    """

    method: str
    ranks: int
    unknowns: int
    cells: int
    tangent_s: float
    setup_s: float
    solve_s: float
    setup_cpu_s: float
    solve_cpu_s: float
    iterations: int
    peak_mb: float
    modes: int
    failure: str = ""

    @property
    def iteration_s(self) -> float:
        """Wall seconds of the linear algebra of a Newton iteration."""
        return self.setup_s + self.solve_s

    @property
    def iteration_cpu_s(self) -> float:
        """The same in CPU seconds of all ranks."""
        return self.setup_cpu_s + self.solve_cpu_s


def measure(scene: BellowsScene, around: int, refinement: int, method: Method, comm: MPI.Comm) -> Measured:
    """Set up and solve for the load's direction at a scene's first pressure, on the revolved axisymmetric state.

    Returns
    -------
    Measured
        The same on every rank; with ``failure`` if the solver failed.
    """
    flat = None
    meridian = scene_meridian(scene, refinement)
    if comm.rank == 0:
        problem = scene_problem(scene, meridian, MPI.COMM_SELF)
        factor = Factor(problem)
        path = follow_path(problem, factor, scene.pressures_mpa[:1], PathSettings())
        factor.close()
        flat = path.states[-1].state
    flat = comm.bcast(flat)
    body = scene_body(meridian, "full3d", around)
    problem = scene_problem(scene, body if comm.rank == 0 else None, comm)
    problem.set_state(revolve_state(flat, meridian, body))
    load = problem.load.force() * ~problem.constrained_owned
    provenance.reset_peak_memory()
    linear = Factor(problem) if method == "direct" else IterativeSolver(problem)
    # assembled once more than needed, to know its share of the CPU time of the set-up
    begin = time.process_time()
    problem.assemble_tangent(linear.matrix)
    assembly = time.process_time() - begin
    before = dict(problem.timer.seconds)
    failure, cpu = "", [time.process_time()]
    try:
        linear.refresh()
        cpu.append(time.process_time())
        linear.solve(load, np.zeros(problem.extra))
    except SolverError as error:
        failure = str(error)
    cpu.append(time.process_time())
    tangent, setup, solve = (
        problem.timer.seconds[name] - before.get(name, 0.0) for name in ("tangent", "factor", "solve")
    )
    spent = comm.allreduce(np.array([cpu[1] - cpu[0] - assembly, cpu[-1] - cpu[1]]), op=MPI.SUM)
    modes = linear.excess_negatives if not failure else None
    return Measured(
        method=method,
        ranks=comm.size,
        unknowns=problem.index_map.size_global + problem.extra,
        cells=len(body.cells),
        tangent_s=tangent,
        setup_s=setup,
        solve_s=solve,
        setup_cpu_s=float(spent[0]),
        solve_cpu_s=float(spent[1]),
        iterations=linear.iterations[-1] if isinstance(linear, IterativeSolver) and linear.iterations else 0,
        peak_mb=provenance.peak_memory_mb(comm),
        modes=-1 if modes is None else modes,
        failure=failure,
    )


def main() -> None:
    """Measure the point that the arguments name."""
    scene, around, refinement, method, file, key = sys.argv[1:]
    chosen: Method = "iterative" if method == "iterative" else "direct"
    found = measure(load_bellows(Path(scene)), int(around), int(refinement), chosen, MPI.COMM_WORLD)
    if MPI.COMM_WORLD.rank == 0:
        keep(Path(file), key, found)


if __name__ == "__main__":
    main()
