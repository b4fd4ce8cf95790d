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

from solvers import compat
from solvers.assembly.tangent import add_form
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from solvers.paths.warm_start import follow_guesses
from solvers.problem import Problem
from solvers.state import State
from studies.engine import Page, Setting, Solved, Study
from studies.first_rank import first
from studies.models.build import revolve_state, scene_problem
from studies.report.tables import table_of
from studies.results import provenance
from studies.results.rows import row
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_body, scene_meridian

REPETITIONS: Final = 5
# A number and its unit, by name.
Numbers = dict[str, tuple[float, str]]


@dataclass(frozen=True)
class Case:
    """A scene, cells round the body that is measured, and round the one that is solved to all pressures."""

    scene: BellowsScene
    around: int
    around_path: int

    @property
    def name(self) -> str:
        """The scene's."""
        return self.scene.name


def cases(options: Mapping[str, Any]) -> list[Case]:
    """The 2 mm actuator in hexahedra: about 150,000 unknowns, and half as many for the path."""
    return [Case(load_bellows(provenance.ROOT / "scenes" / "heung-t2-ri5.toml"), around=16, around_path=8)]


def solve(case: Case, at: Setting) -> Numbers:
    """All measurements; every rank calls."""
    return {**iteration_costs(case.scene, case.around, at.comm), **start_costs(case.scene, case.around_path, at.comm)}


def axisymmetric_states(scene: BellowsScene) -> list[State]:
    """States of the axisymmetric path on the coarsest level at the requested pressures; one rank solves."""
    problem = scene_problem(scene, scene_meridian(scene, 1), MPI.COMM_SELF)
    factor = Factor(problem)
    path = follow_path(problem, factor, scene.pressures_mpa, PathSettings())
    factor.close()
    return [item.state for item in path.states if item.asked]


def _body(scene: BellowsScene, around: int, comm: MPI.Comm) -> tuple[Problem, list[State]]:
    """A body, and its states revolved from the axisymmetric ones."""
    meridian = scene_meridian(scene, 1)
    body = scene_body(meridian, "full3d", around)
    states = first(comm, lambda: axisymmetric_states(scene))
    guesses = [revolve_state(state, meridian, body) for state in states]
    return scene_problem(scene, body if comm.rank == 0 else None, comm), guesses


def iteration_costs(scene: BellowsScene, around: int, comm: MPI.Comm) -> Numbers:
    """What each part of an iteration takes at the second requested pressure of a scene, and a whole one.

    That is, with a new factor each, one tangent assembly, factorisation, solve, residual with load, and look at all
    quadrature points; the stability count is taken as an iteration. Assembly runs on one core of each rank.
    """
    problem, guesses = _body(scene, around, comm)
    factor = Factor(problem)
    problem.set_state(guesses[1])
    solve_equilibrium(problem, factor, NewtonSettings(), HeldLoad(guesses[1].load_mpa))
    here = problem.get_state()
    before, counts, iterations = dict(problem.timer.seconds), factor.count, []
    for _ in range(REPETITIONS):
        start = time.perf_counter()
        problem.set_state(here)
        # never a factor twice: so many tangents, factorisations, solves as iterations, and once more for the count
        settings = NewtonSettings(reuse_below=0.0, reuse_for=0.0)
        solve_equilibrium(problem, factor, settings, HeldLoad(1.01 * here.load_mpa))
        iterations.append((time.perf_counter() - start, factor.count - counts))
        counts = factor.count
    elements = element_costs(problem, factor.matrix)
    factor.close()
    number = sum(count for _, count in iterations)
    spent = {name: (seconds - before.get(name, 0.0)) / number for name, seconds in problem.timer.seconds.items()}
    iteration = float(np.median([seconds / count for seconds, count in iterations]))
    return {
        "unknowns": (float(problem.index_map.size_global + problem.extra), "1"),
        "tangent": (spent["tangent"], "s"),
        "tangent_per_cell_and_core": (1e6 * spent["tangent"] * comm.size / problem.domain.cells, "us/cell"),
        **elements,
        "factorisation": (spent["factor"], "s"),
        "solve": (spent["solve"], "s"),
        "residual": (spent["residual"], "s"),
        "checks": (spent["checks"], "s"),
        "newton_iteration": (iteration, "s"),
        "newton_iteration_over_tangent_and_factorisation": (iteration / (spent["tangent"] + spent["factor"]), "1"),
    }


def element_costs(problem: Problem, matrix: Any) -> Numbers:
    """CPU time of the tangent's integrals by this project's assembly and by dolfinx' own, in alternation."""
    form, bcs, space = problem.tangent_form, problem.unknowns.supports.bcs, problem.space
    ways = {
        "integrals_of_tangent_per_cell_and_core": lambda: add_form(matrix, form, bcs, space),
        "the_same_by_dolfinx_per_cell_and_core": lambda: compat.add_by_dolfinx(matrix, form, bcs),
    }
    spent: dict[str, list[float]] = {name: [] for name in ways}
    for _ in range(REPETITIONS):
        for name, add in ways.items():
            matrix.zeroEntries()
            begin = time.process_time()
            add()
            matrix.assemble()
            spent[name].append(problem.comm.allreduce(time.process_time() - begin, op=MPI.SUM))
    out: Numbers = {name: (1e6 * min(times) / problem.domain.cells, "us/cell") for name, times in spent.items()}
    (here, _), (theirs, _) = out.values()
    return {**out, "cpu_ratio_of_integrals_to_dolfinx": (here / theirs, "1")}


def start_costs(scene: BellowsScene, around: int, comm: MPI.Comm) -> Numbers:
    """The path of the full body from the axisymmetric states, their own path included, and from zero."""
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
    return {
        "warm_start": (warm_s, "s"),
        "cold_start": (cold_s, "s"),
        "time_ratio_cold_to_warm": (cold_s / warm_s, "1"),
        "warm_factorisations": (float(warm_count), "1"),
        "cold_factorisations": (float(cold_count), "1"),
        "largest_difference": (float(np.abs(last[0] - last[1]).max()), "mm"),
    }


def page(solved: Sequence[Solved[Case, Numbers]], at: Setting) -> Page:
    """What each part took; the rows also in a file of these ranks and threads, to be compared with others."""
    ranks, threads = at.comm.size, provenance.blas_threads()
    rows = [
        row(done.case.name, quantity, unit, math.nan, "full3d", value, f"{ranks * threads} cores")
        for done in solved
        for quantity, (value, unit) in done.result.items()
    ]
    columns = {
        "what": lambda r: r.quantity.replace("_", " "),
        "value": lambda r: f"{r.value:.3g}" if r.value < 1000.0 else f"{r.value:.0f}",
        "unit": lambda r: r.unit.removeprefix("1"),
    }
    content = {
        "cases": [done.case for done in solved],
        "ranks": ranks,
        "threads": threads,
        "numbers": table_of(rows, columns, (0, 2)),
    }
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
