"""The exact thick tube in plane strain: observed orders of convergence, and the approach to incompressibility."""

from __future__ import annotations

import numpy as np
import pytest

from analytical.exact.tube import (
    Tube,
    axial_force_n,
    hydrostatic_pressure_mpa,
    pressure_at_inner_radius_mpa,
    radial_displacement_mm,
    stored_energy_n,
)
from analytical.laws.isotropic import Law
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from meshes.revolve import revolve
from meshes.solid import SolidMesh
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonReport, NewtonSettings, solve_equilibrium
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from solvers.problem import Problem
from solvers.state import State

TUBE = Tube(4.0, 6.0)
HEIGHT_MM = 1.0
LAWS: dict[str, Law] = {"yeoh": DRAGON_SKIN_10, "ogden": dragon_skin_30("2mu/alpha^2")}
# stretch at the bore
STRETCH = {"yeoh": 2.0, "ogden": 1.6}
SETTINGS = NewtonSettings(relative_tolerance=1e-10, max_iterations=25)
every_law = pytest.mark.parametrize("name", LAWS)


def radius_of(x: np.ndarray, dimension: int) -> np.ndarray:
    return x[..., 0] if dimension == 2 else np.hypot(x[..., 0], x[..., 1])


def exact_displacement(name: str, dimension: int):
    bore = STRETCH[name] * TUBE.inner_radius_mm

    def displacement(x: np.ndarray) -> np.ndarray:
        radius = radius_of(x, dimension)
        out = np.zeros_like(x)
        factor = radial_displacement_mm(TUBE, bore, radius) / radius
        for i in range(dimension - 1):
            out[..., i] = factor * x[..., i]
        return out

    return displacement


def exact_pressure(name: str, dimension: int):
    bore = STRETCH[name] * TUBE.inner_radius_mm
    return lambda x: -hydrostatic_pressure_mpa(TUBE, LAWS[name], bore, radius_of(x, dimension))


def exact_state(mesh: SolidMesh, name: str) -> State:
    u = exact_displacement(name, mesh.dimension)(mesh.points)
    p = np.zeros(len(mesh.points))
    p[mesh.corners] = exact_pressure(name, mesh.dimension)(mesh.points[mesh.corners])
    load = pressure_at_inner_radius_mpa(TUBE, LAWS[name], STRETCH[name] * TUBE.inner_radius_mm)
    return State(u, p, np.zeros((0, 0)), load)


@pytest.fixture(scope="module")
def flat_tube(strip, sides, make_problem):
    """Meridian of ``n`` by ``n`` curved quadrilaterals, each split in two; ends held in their planes."""

    def make(n: int, law: Law, inverse_kappa: float = 0.0) -> tuple[SolidMesh, Problem]:
        mesh = strip(TUBE.inner_radius_mm, TUBE.outer_radius_mm, 2.0, n, n, 0.08)
        held = ((sides.bottom, 1), (sides.top, 1))
        return mesh, make_problem(mesh, law, inverse_kappa, cavity=sides.cavity, held=held)

    return make


@pytest.fixture(scope="module")
def round_tube(strip, quarter, sides, make_problem):
    """A quarter of the tube between planes of symmetry, its cells curved inside too."""

    def make(n: int, law: Law) -> tuple[SolidMesh, Problem]:
        flat = strip(TUBE.inner_radius_mm, TUBE.outer_radius_mm, HEIGHT_MM, n, max(1, n // 2), 0.08)
        mesh = quarter(revolve(flat, 8 * n))
        held = ((sides.bottom, 2), (sides.top, 2), (sides.x_plane, 0), (sides.y_plane, 1))
        return mesh, make_problem(mesh, law, cavity=sides.cavity, held=held)

    return make


def solve_from_exact(mesh: SolidMesh, problem: Problem, name: str) -> NewtonReport:
    """Equilibrium of the discrete problem; the exact solution is only its first guess."""
    guess = exact_state(mesh, name)
    problem.set_state(guess)
    return solve_equilibrium(problem, Factor(problem), SETTINGS, HeldLoad(guess.load_mpa))


def observed_orders(make, name: str, levels, rms_errors) -> np.ndarray:
    """Orders of (u, p) in L2 between successive meshes, each half as coarse, shape (2, 2)."""
    errors = []
    for n in levels:
        mesh, problem = make(n, LAWS[name])
        report = solve_from_exact(mesh, problem, name)
        assert report.excess_negatives == 0
        d = mesh.dimension
        found = rms_errors(mesh, problem.get_state(), exact_displacement(name, d), exact_pressure(name, d))
        errors.append(found)
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


@every_law
def test_orders_of_the_axisymmetric_tube(flat_tube, rms_errors, name: str) -> None:
    orders = observed_orders(flat_tube, name, (4, 8, 16), rms_errors)
    # theory for P2/P1: 3 and 2; asked 2.9 and 1.9 of each pair; measured 3.18 to 3.32 and 1.99 to 2.01
    assert orders[:, 0].min() >= 2.9, orders
    assert orders[:, 1].min() >= 1.9, orders


@every_law
def test_orders_of_the_tube_in_3d(round_tube, rms_errors, name: str) -> None:
    orders = observed_orders(round_tube, name, (2, 4, 8), rms_errors)
    # Asked 2.9 and 1.9, of the finer pair: the coarsest mesh has only two cells through the wall and p is still
    # on its way (1.73 to 1.77). Measured 3.02 and 1.93 for Yeoh, 2.97 and 1.93 for Ogden.
    assert orders[-1, 0] >= 2.9, orders
    assert orders[-1, 1] >= 1.9, orders
    assert orders.min() >= 1.6, orders


@pytest.mark.slow
def test_orders_of_the_tube_in_3d_settle_on_finer_meshes(round_tube, rms_errors) -> None:
    orders = observed_orders(round_tube, "ogden", (4, 8, 16), rms_errors)
    # measured 2.97, 3.08 and 1.93, 2.01
    assert orders[:, 0].min() >= 2.9, orders
    assert orders[:, 1].min() >= 1.9, orders


@every_law
def test_energy_volume_and_end_force_converge_with_order_four(flat_tube, name: str) -> None:
    bore, height = STRETCH[name] * TUBE.inner_radius_mm, 2.0
    exact = np.array(
        [
            height * stored_energy_n(TUBE, LAWS[name], bore),
            height * np.pi * bore**2,
            axial_force_n(TUBE, LAWS[name], bore),
        ]
    )
    errors = []
    for n in (4, 8, 16):
        mesh, problem = flat_tube(n, LAWS[name])
        solve_from_exact(mesh, problem, name)
        force, _ = problem.internal_force()
        # the wall's mean axial force: its work in a uniform axial strain, over the height
        pull = force[problem.u_dofs[:, 1]] @ mesh.points[problem.domain.input_node, 1] / height
        errors.append(np.abs(np.array([problem.energy(), problem.cavity_volume(), pull]) / exact - 1.0))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    # integrals of a solution with errors h^2 in strain and pressure: h^4; measured 4.07 to 4.29
    assert orders.min() >= 3.5, orders
    assert errors[-1].max() < 1e-6  # measured 4e-7


@every_law
def test_path_from_rest_ends_at_the_exact_tube(flat_tube, name: str) -> None:
    mesh, problem = flat_tube(4, LAWS[name])
    solve_from_exact(mesh, problem, name)
    expected = problem.get_state()
    path = follow_path(problem, Factor(problem), [expected.load_mpa], PathSettings(newton=SETTINGS))
    assert path.reached
    # two solves of the same equations to 1e-10
    assert path.states[-1].state.displacement_mm == pytest.approx(expected.displacement_mm, abs=1e-7)
    assert [p.newton.excess_negatives for p in path.states] == [0] * len(path.states)


@every_law
def test_compressible_tube_tends_to_the_incompressible_one_like_one_over_kappa(flat_tube, name: str) -> None:
    law = LAWS[name]
    load = pressure_at_inner_radius_mpa(TUBE, law, 1.3 * TUBE.inner_radius_mm)
    bores, iterations = [], []
    for ratio in (1e2, 1e3, 1e4, 1e5, np.inf):
        mesh, problem = flat_tube(4, law, 1.0 / (ratio * law.initial_shear_modulus_mpa))
        problem.set_state(problem.zero_state())
        report = solve_equilibrium(problem, Factor(problem), SETTINGS, HeldLoad(load))
        iterations.append(report.iterations)
        inside = mesh.points[:, 0] == TUBE.inner_radius_mm
        bores.append(problem.get_state().displacement_mm[inside, 0].mean())
    gaps = np.array(bores[:-1]) - bores[-1]
    # 10 per decade; from kappa/mu = 100 to 1000 the next term shows: measured 9.96 and 9.98
    assert gaps[:-1] / gaps[1:] == pytest.approx(10.0, rel=0.01)
    assert abs(gaps[0]) < 0.05 * bores[-1]
    # no stiffening of the equations on the way
    assert max(iterations) - min(iterations) <= 1, iterations
