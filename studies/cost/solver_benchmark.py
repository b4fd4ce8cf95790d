"""What the solver's parts cost on a full body: tangent, factorisation, Newton iteration; warm against cold start.

Times are wall seconds of this machine in this run; ratios are what to carry over. Every rank takes part.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from mpi4py import MPI

from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.linear.factor import Factor
from solvers.paths.path import PathSettings, follow_guesses, follow_path
from solvers.problem import Problem
from solvers.state import State
from studies.engine import Page, Setting, Solved, Study, first
from studies.models.build import revolve_state, scene_body, scene_meridian, scene_problem
from studies.results import provenance
from studies.results.rows import row
from studies.scene.bellows import Scene, load_scene

REPETITIONS: Final = 5


@dataclass(frozen=True)
class Case:
    """A scene, cells round the body that is measured, and round the one that is solved to all pressures."""

    scene: Scene
    around: int
    around_path: int

    @property
    def name(self) -> str:
        """The scene's."""
        return self.scene.name


@dataclass(frozen=True)
class Costs:
    """Costs of one iteration on one body.

    Attributes
    ----------
    unknowns, cells
        Size.
    tangent_s, factor_s, solve_s, residual_s, checks_s
        One tangent assembly, factorisation, solve, residual with load, and look at all quadrature points.
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


def cases(options: Mapping[str, Any]) -> list[Case]:
    """The 2 mm actuator in hexahedra: about 150,000 unknowns, and half as many for the path."""
    return [Case(load_scene(provenance.ROOT / "scenes" / "heung-t2-ri5.toml"), around=16, around_path=8)]


def solve(case: Case, at: Setting) -> tuple[Costs, Starts]:
    """All measurements; every rank calls."""
    return measure_costs(case.scene, case.around, at.comm), measure_starts(case.scene, case.around_path, at.comm)


def axisymmetric_states(scene: Scene) -> list[State]:
    """States of the axisymmetric path on the coarsest level at the requested pressures; one rank solves."""
    problem = scene_problem(scene, scene_meridian(scene, 1), MPI.COMM_SELF)
    factor = Factor(problem)
    path = follow_path(problem, factor, scene.pressures_mpa, PathSettings())
    factor.close()
    return [item.state for item in path.states if item.asked]


def _body(scene: Scene, around: int, comm: MPI.Comm) -> tuple[Problem, list[State]]:
    """A body, and its states revolved from the axisymmetric ones."""
    meridian = scene_meridian(scene, 1)
    body = scene_body(meridian, "full3d", around)
    states = first(comm, lambda: axisymmetric_states(scene))
    guesses = [revolve_state(state, meridian, body) for state in states]
    return scene_problem(scene, body if comm.rank == 0 else None, comm), guesses


def measure_costs(scene: Scene, around: int, comm: MPI.Comm) -> Costs:
    """Costs of one iteration at the second requested pressure of a scene."""
    problem, guesses = _body(scene, around, comm)
    factor = Factor(problem)
    problem.set_state(guesses[1])
    solve_equilibrium(problem, factor, NewtonSettings(), pressure_mpa=guesses[1].load_mpa)
    here = problem.get_state()
    before, counts, iterations = dict(problem.timer.seconds), factor.count, []
    for _ in range(REPETITIONS):
        start = time.perf_counter()
        problem.set_state(here)
        # never a factor twice: so many tangents, factorisations, solves as iterations, and once more for the count
        settings = NewtonSettings(reuse_below=0.0)
        solve_equilibrium(problem, factor, settings, pressure_mpa=1.01 * here.load_mpa)
        iterations.append((time.perf_counter() - start, factor.count - counts))
        counts = factor.count
    spent = {name: seconds - before.get(name, 0.0) for name, seconds in problem.timer.seconds.items()}
    factorisations = sum(count for _, count in iterations)
    factor.close()
    return Costs(
        unknowns=problem.index_map.size_global + problem.extra,
        cells=problem.domain.cells,
        tangent_s=spent["tangent"] / factorisations,
        factor_s=spent["factor"] / factorisations,
        solve_s=spent["solve"] / factorisations,
        residual_s=spent["residual"] / factorisations,
        checks_s=spent["checks"] / factorisations,
        iteration_s=float(np.median([seconds / count for seconds, count in iterations])),
    )


def measure_starts(scene: Scene, around: int, comm: MPI.Comm) -> Starts:
    """The path of the full body from the axisymmetric states and from zero."""
    begin = time.perf_counter()
    problem, guesses = _body(scene, around, comm)
    factor = Factor(problem)
    warm = follow_guesses(problem, factor, guesses, PathSettings())
    warm_s, warm_count = time.perf_counter() - begin, factor.count
    begin = time.perf_counter()
    cold = follow_path(problem, factor, scene.pressures_mpa, PathSettings())
    cold_s, cold_count = time.perf_counter() - begin, factor.count - warm_count
    factor.close()
    last = [path.states[-1].state.displacement_mm for path in (warm, cold)]
    return Starts(warm_s, cold_s, warm_count, cold_count, float(np.abs(last[0] - last[1]).max()))


def page(solved: Sequence[Solved[Case, tuple[Costs, Starts]]], at: Setting) -> Page:
    """What each part took; the rows also in a file of these ranks and threads, to be compared with others."""
    ranks, threads = at.comm.size, provenance.blas_threads()
    rows = []
    for name, (costs, starts) in ((done.case.name, done.result) for done in solved):
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
        rows += [
            row(name, quantity, unit, math.nan, "full3d", value, f"{ranks * threads} cores")
            for quantity, (value, unit) in values.items()
        ]
    content = {"solved": solved, "ranks": ranks, "threads": threads}
    return Page(rows, content, tables={f"rows-{ranks}x{threads}.csv": rows})


STUDY: Final = Study(
    name="benchmark-solver",
    title="What the solver's parts cost on a full body",
    question="What do tangent, factorisation, Newton iteration, warm and cold start of a full body take here?",
    template="cost/solver_benchmark.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="all",
)
