"""The iterative solver: the direct one's answers on one and two ranks, named failures, no count of modes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.meridian import Resolution, meridian_mesh
from meshes.revolve import revolve
from meshes.solid import FACETS
from solvers.bodies.rigid import RigidBodies
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause, SolverError, StepFailed
from solvers.linear.factor import Factor
from solvers.linear.krylov import IterativeSettings, IterativeSolver
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings

SCRIPT = Path(__file__).with_name("iterative_ranks_script.py")


def test_newton_with_it_goes_where_newton_with_factors_goes(one_convolution, make_problem) -> None:
    # tetrahedra of a wall's thickness: a fifth of the unknowns of the other tests' body, and a hundred iterations still
    meridian = meridian_mesh(one_convolution, Resolution(through=1, cell_mm=2.0, arc_rad=1.2, cap_cells=1))
    body = revolve(meridian, 8)
    rings = RigidBodies(
        5.0, 2.0, np.ones(len(body.points)), one_convolution.crest_positions_mm, one_convolution.seat_radius_mm
    )
    surfaces = {"cavity": FACETS["cavity"], "clamped": FACETS["clamped"], "bond": FACETS["bond"]}
    problem = make_problem(body, DRAGON_SKIN_10, bodies=rings, **surfaces)
    factor, solver = Factor(problem), IterativeSolver(problem)
    found = []
    for linear in (factor, solver):
        problem.set_state(problem.zero_state())
        report = solve_equilibrium(problem, linear, NewtonSettings(), HeldLoad(0.0005))
        found.append((problem.get_state(), report))
    (direct, of_direct), (iterative, of_iterative) = found
    largest = np.abs(direct.displacement_mm).max()
    assert largest > 0.1
    # Newton to 1e-8 of the load, which the softest modes magnify
    assert np.abs(iterative.displacement_mm - direct.displacement_mm).max() < 1e-5 * largest
    assert np.abs(iterative.bodies_mm - direct.bodies_mm).max() < 1e-5 * largest
    assert of_iterative.compliance_mm3_per_mpa == pytest.approx(of_direct.compliance_mm3_per_mpa, rel=1e-4)
    assert of_direct.excess_negatives == 0
    assert of_iterative.excess_negatives is None
    assert of_iterative.excess_at_volume is None
    assert max(solver.iterations) < 250
    solver.close()


def test_rigid_motions_cost_no_force_at_rest(bellows_problem) -> None:
    problem = bellows_problem(3).problem
    problem.set_state(problem.zero_state())
    solver = IterativeSolver(problem)
    solver.refresh()
    assert solver.solver is not None
    block = solver.solver.getPC().getFieldSplitSubKSP()[0].getOperators()[1]
    vectors = solver._rigid_motions(block).getVecs()
    assert len(vectors) == 6
    z = problem.domain.mesh.geometry.x[solver._nodes, 2]
    # rows of cells that touch the clamped end see a motion that is zero there
    far = np.concatenate([np.repeat(z > z.min() + 4.0, 3), np.ones(problem.extra, dtype=bool)])
    assert far.mean() > 0.5
    size = block.norm()
    for vector in vectors:
        force = block.createVecLeft()
        block.mult(vector, force)
        assert np.abs(force.array[far]).max() < 1e-12 * size
    # a motion that is none costs some: rings left behind
    vector = vectors[2].copy()
    vector.array[-problem.extra :] = 0.0
    block.mult(vector, force)
    assert np.abs(force.array[far]).max() > 1e-6 * size
    solver.close()


def test_too_few_iterations_are_a_failed_step_with_numbers_and_end_a_path(bellows_problem) -> None:
    problem = bellows_problem(3).problem
    solver = IterativeSolver(problem, IterativeSettings(max_iterations=3))
    problem.set_state(problem.zero_state())
    solver.refresh()
    load = problem.load.force() * ~problem.constrained_owned
    with pytest.raises(
        StepFailed, match="GMRES stopped after 3 iterations with a residual of .* allow more"
    ) as failure:
        solver.solve(load, np.zeros(problem.extra))
    assert failure.value.cause is Cause.LINEAR_SOLVER
    path = follow_path(problem, solver, [0.005], PathSettings(smallest_step=0.1))
    assert not path.reached
    assert path.cause is Cause.LINEAR_SOLVER
    assert "GMRES stopped after 3 iterations" in path.reason
    assert not path.states
    solver.close()


def test_meridians_are_refused(bellows_problem) -> None:
    with pytest.raises(SolverError, match="for whole bodies in 3D"):
        IterativeSolver(bellows_problem(2).problem)


def test_one_and_two_ranks_agree_with_the_factor(python) -> None:
    answers = [python.answer(ranks, SCRIPT) for ranks in (1, 2)]
    for answer in answers:
        assert answer["difference"] < 1e-5  # to 1e-6 of the force
    one, two = answers
    assert (one["ranks"], two["ranks"]) == (1, 2)
    assert two["compliance"] == pytest.approx(one["compliance"], rel=1e-5)
