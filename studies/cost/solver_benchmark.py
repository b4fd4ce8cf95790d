"""What the solver's parts cost on a full body: tangent, factorisation, Newton iteration; warm against cold start.

Times are wall seconds of this machine in this run; ratios are what to carry over. Every rank takes part.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from mpi4py import MPI

from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.records import PathSettings
from solvers.paths.warm_start import follow_guesses
from solvers.problem import Problem
from solvers.state import State
from studies.models.build import revolve_state, scene_problem
from studies.results import provenance
from studies.results.rows import Row, row, write_rows
from studies.scene.bellows import BellowsScene
from studies.scene.meshes import scene_body, scene_meridian

# Of the 2 mm actuator in hexahedra: about 150,000 unknowns.
AROUND: Final = 16
# Cells round the circumference of the body that is solved to all pressures, warm and cold.
AROUND_PATH: Final = 8
REPETITIONS: Final = 5


@dataclass(frozen=True)
class Costs:
    """Costs of one iteration on one body.

    Attributes
    ----------
    unknowns, cells
        Size.
    tangent_s, factor_s, solve_s, residual_s, checks_s
        One tangent assembly, factorisation, solve, residual with load, and look at all quadrature points; medians.
    iteration_s
        One whole Newton iteration with a new factor, the stability count taken as one of them: median.
    """

    unknowns: int
    cells: int
    tangent_s: float
    factor_s: float
    solve_s: float
    residual_s: float
    checks_s: float
    iteration_s: float

    @property
    def iteration_over_parts(self) -> float:
        """Newton iteration over one tangent and one factorisation."""
        return self.iteration_s / (self.tangent_s + self.factor_s)

    def tangent_us_per_cell(self, ranks: int) -> float:
        """Microseconds of one core for a cell's share of the tangent; assembly runs on one core of each rank."""
        return 1e6 * self.tangent_s * ranks / self.cells


@dataclass(frozen=True)
class Starts:
    """The path to all requested pressures from warm and from cold.

    Attributes
    ----------
    warm_s, cold_s
        Seconds from the axisymmetric states (their own path included) and from the unloaded body.
    warm_factorisations, cold_factorisations
        Factorisations of the full body.
    difference_mm
        Largest difference of the displacements at the last pressure.
    """

    warm_s: float
    cold_s: float
    warm_factorisations: int
    cold_factorisations: int
    difference_mm: float


def axisymmetric_states(scene: BellowsScene) -> list[State]:
    """States of the axisymmetric path on the coarsest level at the requested pressures; rank 0 solves."""
    found: list[State] | None = None
    if MPI.COMM_WORLD.rank == 0:
        problem = scene_problem(scene, scene_meridian(scene, 1), MPI.COMM_SELF)
        factor = Factor(problem)
        path = follow_path(problem, factor, scene.pressures_mpa, PathSettings())
        factor.close()
        found = [item.state for item in path.states if item.asked]
    states: list[State] = MPI.COMM_WORLD.bcast(found)
    return states


def _body(scene: BellowsScene, around: int) -> tuple[Problem, list[State]]:
    comm = MPI.COMM_WORLD
    meridian = scene_meridian(scene, 1)
    body = scene_body(meridian, "full3d", around)
    guesses = [revolve_state(state, meridian, body) for state in axisymmetric_states(scene)]
    return scene_problem(scene, body if comm.rank == 0 else None, comm), guesses


def measure_costs(scene: BellowsScene, around: int = AROUND) -> Costs:
    """Costs of one iteration at the second requested pressure of a scene."""
    problem, guesses = _body(scene, around)
    factor = Factor(problem)
    solve_equilibrium_at(problem, factor, guesses[1])
    here = problem.get_state()

    def iteration() -> None:
        # never a factor twice: so many tangents, factorisations, solves as iterations, and once more for the count
        problem.set_state(here)
        pressure = 1.01 * here.load_mpa
        solve_equilibrium(problem, factor, NewtonSettings(reuse_below=0.0), HeldLoad(pressure))

    before = dict(problem.timer.seconds)
    counts = factor.count
    iterations = []
    for _ in range(REPETITIONS):
        start = time.perf_counter()
        iteration()
        iterations.append((time.perf_counter() - start, factor.count - counts))
        counts = factor.count
    spent = {name: problem.timer.seconds[name] - before.get(name, 0.0) for name in problem.timer.seconds}
    factorisations = sum(count for _, count in iterations)
    costs = Costs(
        unknowns=problem.index_map.size_global + problem.extra,
        cells=problem.domain.cells,
        tangent_s=spent["tangent"] / factorisations,
        factor_s=spent["factor"] / factorisations,
        solve_s=spent["solve"] / factorisations,
        residual_s=spent["residual"] / factorisations,
        checks_s=spent["checks"] / factorisations,
        iteration_s=float(np.median([seconds / count for seconds, count in iterations])),
    )
    factor.close()
    return costs


def solve_equilibrium_at(problem: Problem, factor: Factor, guess: State) -> None:
    """Equilibrium at a guess's pressure."""
    problem.set_state(guess)
    solve_equilibrium(problem, factor, NewtonSettings(), HeldLoad(guess.load_mpa))


def measure_starts(scene: BellowsScene, around: int = AROUND_PATH) -> Starts:
    """The path of the full body from the axisymmetric states and from zero."""
    begin = time.perf_counter()
    problem, guesses = _body(scene, around)
    factor = Factor(problem)
    warm = follow_guesses(problem, factor, guesses, PathSettings())
    warm_s, warm_count = time.perf_counter() - begin, factor.count
    begin = time.perf_counter()
    cold = follow_path(problem, factor, scene.pressures_mpa, PathSettings())
    cold_s, cold_count = time.perf_counter() - begin, factor.count - warm_count
    factor.close()
    last = [path.states[-1].state.displacement_mm for path in (warm, cold)]
    return Starts(warm_s, cold_s, warm_count, cold_count, float(np.abs(last[0] - last[1]).max()))


def run(scene: BellowsScene, folder: Path) -> list[str]:
    """Measure, write rows.csv on rank 0, and return the lines to print."""
    comm = MPI.COMM_WORLD
    threads = provenance.blas_threads()
    cores = comm.size * threads
    costs = measure_costs(scene)
    starts = measure_starts(scene)
    rows = _rows(scene, costs, starts, cores)
    if comm.rank == 0:
        folder.mkdir(parents=True, exist_ok=True)
        write_rows(folder / f"rows-{comm.size}x{threads}.csv", rows)
    return [
        f"{comm.size} rank(s) x {threads} BLAS thread(s), {provenance.blas()}",
        f"{scene.name}, hexahedra, {AROUND} cells round: {costs.unknowns} unknowns, {costs.cells} cells",
        f"  tangent {costs.tangent_s:.2f} s ({costs.tangent_us_per_cell(comm.size):.0f} us per cell and core), "
        f"factorisation {costs.factor_s:.2f} s, solve {costs.solve_s:.2f} s, residual {costs.residual_s:.2f} s, "
        f"checks {costs.checks_s:.2f} s",
        f"  Newton iteration {costs.iteration_s:.2f} s = {costs.iteration_over_parts:.2f} x (tangent + factorisation)",
        f"  {AROUND_PATH} cells round, {len(scene.pressures_mpa)} pressures: warm start {starts.warm_s:.1f} s, "
        f"{starts.warm_factorisations} factorisations; cold start {starts.cold_s:.1f} s, "
        f"{starts.cold_factorisations} factorisations; ratio {starts.cold_s / starts.warm_s:.1f}; "
        f"largest difference {starts.difference_mm:.1e} mm",
    ]


def _rows(scene: BellowsScene, costs: Costs, starts: Starts, cores: int) -> list[Row]:
    values = {
        "unknowns": (float(costs.unknowns), "1"),
        "tangent": (costs.tangent_s, "s"),
        "factorisation": (costs.factor_s, "s"),
        "solve": (costs.solve_s, "s"),
        "newton_iteration": (costs.iteration_s, "s"),
        "newton_iteration_over_tangent_and_factorisation": (costs.iteration_over_parts, "1"),
        "warm_start": (starts.warm_s, "s"),
        "cold_start": (starts.cold_s, "s"),
        "time_ratio_cold_to_warm": (starts.cold_s / starts.warm_s, "1"),
        "warm_factorisations": (float(starts.warm_factorisations), "1"),
        "cold_factorisations": (float(starts.cold_factorisations), "1"),
    }
    return [
        row(scene.name, quantity, unit, float("nan"), "full3d", value, level=f"{cores} cores")
        for quantity, (value, unit) in values.items()
    ]
