"""The tangent is the derivative of the residual, everywhere a Newton step may go."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from analytical.laws.isotropic import Law, NeoHooke
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from analytical.laws.stiff import PLA
from meshes.revolve import revolve
from meshes.solid import SolidMesh
from solvers.assembly.surfaces import SOFT, STIFF
from solvers.bodies.rigid import EVERY_MOTION, RigidBodies, moved
from solvers.problem import Problem
from solvers.state import State

ARM_MM = 6.5
STEPS = (1e-3, 1e-4, 1e-5)
OGDEN = dragon_skin_30("2mu/alpha^2")


@pytest.fixture(scope="module")
def ring(strip) -> SolidMesh:
    """72 curved tetrahedra, inner radius 5, outer 6.5, height 2 mm."""
    return revolve(strip(5.0, ARM_MM, 2.0, 2, 1, 0.1), 6)


@pytest.fixture(scope="module")
def body(ring: SolidMesh, sides, make_problem):
    """Problems on the ring, with its bottom clamped and its top held level unless told otherwise."""

    def build(law: Law, inverse_kappa=0.0, stiff=False, bond=False, clamp=True, level=True) -> Problem:
        upper = ring.points[ring.cells, 2].mean(axis=1) > 1.0
        grade = np.linspace(0.3, 1.0, len(ring.points))
        bodies = RigidBodies(0.5, 0.2, grade, np.array([0.7]), ARM_MM)
        return make_problem(
            ring,
            law,
            inverse_kappa,
            regions=np.where(upper, STIFF, SOFT) if stiff else None,
            stiff=PLA if stiff else None,
            bodies=bodies if bond else None,
            cavity=sides.cavity,
            clamped=sides.bottom if clamp else None,
            held=((sides.top, 2),) if clamp and level else (),
            bond=sides.outer if bond else None,
        )

    return build


def disturb(problem: Problem, seed: int) -> None:
    """A state with det F of about 0.6 to 1.5, bodies turned by about half a radian, under pressure."""
    rng = np.random.default_rng(seed)
    x = problem.state.x.array
    noise = rng.standard_normal(len(x))
    x[:] = np.where(problem.owned_pressure, 0.05, 0.02) * noise
    x[problem.constrained_owned] = 0.0
    if problem.bonded is not None:
        problem.bonded.values[:] = rng.uniform(-1.0, 1.0, problem.body_values.shape) * 0.5
        if problem.bonded.motions == EVERY_MOTION:
            problem.bonded.values[:, 3:] *= ARM_MM
        problem.bonded.update(np.zeros(0))
    problem.pressure.value = 0.02
    assert problem.deformation.extremes()[0] > 0.1


def direction(problem: Problem, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A random direction of 0.1 mm and 0.1 MPa that respects the constraints."""
    rng = np.random.default_rng(seed)
    dofs = 0.1 * rng.standard_normal(problem.owned)
    dofs[problem.constrained_owned] = 0.0
    return dofs, 0.1 * rng.standard_normal(problem.extra)


class Line:
    """States on a line through the current one, bodies turning on."""

    def __init__(self, problem: Problem, dofs: np.ndarray, bodies: np.ndarray) -> None:
        self.problem, self.dofs, self.bodies = problem, dofs, bodies
        self.start = problem.state.x.array.copy()
        self.start_bodies = problem.body_values.copy()

    def go(self, h: float) -> None:
        self.problem.state.x.array[:] = self.start + h * self.dofs
        if self.problem.bonded is not None:
            step = h * self.bodies.reshape(self.start_bodies.shape)
            bonded = self.problem.bonded
            bonded.values[:] = moved(self.start_bodies, step, ARM_MM, bonded.motions)
            bonded.update(np.zeros(0))

    def residual(self, h: float) -> np.ndarray:
        self.go(h)
        force, on_bodies = self.problem.internal_force()
        force = force - float(self.problem.pressure.value) * self.problem.load.force()
        force[self.problem.constrained_owned] = 0.0
        return np.concatenate([force, on_bodies])

    def differences(self, h: float) -> np.ndarray:
        change = (self.residual(h) - self.residual(-h)) / (2.0 * h)
        self.go(0.0)
        return change


def tangent(problem: Problem):
    matrix = problem.new_matrix()
    problem.assemble_tangent(matrix)
    return matrix


def times(matrix, dofs: np.ndarray, bodies: np.ndarray) -> np.ndarray:
    vector, product = matrix.createVecs()
    vector.array[:] = np.concatenate([dofs, bodies])
    matrix.mult(vector, product)
    return product.array.copy()


def dense(matrix) -> np.ndarray:
    indptr, indices, values = matrix.getValuesCSR()
    out = np.zeros(matrix.getSize())
    for row in range(len(out)):
        out[row, indices[indptr[row] : indptr[row + 1]]] = values[indptr[row] : indptr[row + 1]]
    return out


CASES: dict[str, dict[str, Any]] = {
    "yeoh": dict(law=DRAGON_SKIN_10),
    "ogden, 2mu/alpha^2": dict(law=OGDEN),
    "ogden, mu/alpha": dict(law=dragon_skin_30("mu/alpha")),
    "finite kappa": dict(law=DRAGON_SKIN_10, inverse_kappa=0.3),
    "meshed stiff region": dict(law=DRAGON_SKIN_10, stiff=True),
    "bonded body": dict(law=DRAGON_SKIN_10, bond=True),
    "open end: pressure without a potential": dict(law=DRAGON_SKIN_10, level=False),
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_tangent_is_the_difference_of_residuals(body, case: dict) -> None:
    problem = body(**case)
    disturb(problem, 1)
    matrix = tangent(problem)
    for seed in (2, 3):
        dofs, bodies = direction(problem, seed)
        found = times(matrix, dofs, bodies)
        line = Line(problem, dofs, bodies)
        along = np.concatenate([dofs, bodies])
        errors, curvature = [], []
        for h in STEPS:
            exact = line.differences(h)
            # Rows of bodies: rotations do not commute, so that away from equilibrium only the symmetric part
            # of their differences is the second derivative: they are compared by d.K.d, below and next test.
            gap = (found - exact)[: problem.owned]
            errors.append(np.linalg.norm(gap) / np.linalg.norm(found[: problem.owned]))
            curvature.append(abs(along @ exact / (along @ found) - 1.0))
        # central differences: h^2, so 100 times per step (80 for the last, near round-off), to below 1e-8
        assert errors[0] / errors[1] > 95.0
        assert errors[1] / errors[2] > 80.0
        assert errors[2] < 1e-8
        assert curvature[2] < 1e-8


def test_block_of_a_turned_body_is_the_second_derivative_of_the_bond_energy(body) -> None:
    problem = body(DRAGON_SKIN_10, bond=True)
    disturb(problem, 4)
    block = dense(tangent(problem))[problem.owned :, problem.owned :]
    still = np.zeros(problem.owned)
    scale = np.abs(block).max()
    for i in range(6):
        for j in range(i + 1):
            pair = np.zeros(6)
            pair[i] += 1.0
            pair[j] += 1.0
            exact = pair @ Line(problem, still, pair).differences(1e-3)[problem.owned :]
            # all e_i + e_j determine a symmetric block; rotations of h / 6.5 mm: truncation (h / arm)^2 / 6
            assert pair @ block @ pair == pytest.approx(exact, abs=1e-7 * scale)


@pytest.mark.parametrize("law", [DRAGON_SKIN_10, OGDEN], ids=["yeoh", "ogden"])
def test_tangent_on_a_meridian_is_the_difference_of_residuals(strip, sides, make_problem, law: Law) -> None:
    mesh = strip(2.0, 3.5, 2.0, 2, 2, 0.1)
    bodies = RigidBodies(0.5, 0.2, np.ones(len(mesh.points)), np.array([1.0]), ARM_MM)
    problem = make_problem(mesh, law, 0.1, bodies=bodies, cavity=sides.cavity, clamped=sides.bottom, bond=sides.outer)
    assert not problem.conservative  # the top is free
    disturb(problem, 5)
    matrix = tangent(problem)
    dofs, moves = direction(problem, 6)
    found = times(matrix, dofs, moves)
    line = Line(problem, dofs, moves)
    errors = [np.linalg.norm(found - line.differences(h)) / np.linalg.norm(found) for h in STEPS]
    # as above; a body on a meridian only moves along the axis, so its row counts too
    assert errors[0] / errors[1] > 95.0
    assert errors[1] / errors[2] > 80.0
    assert errors[2] < 1e-8


@pytest.mark.parametrize("name", ["yeoh", "ogden, mu/alpha", "meshed stiff region", "bonded body"])
def test_tangent_is_symmetric_with_the_follower_load_and_bodies(body, name: str) -> None:
    problem = body(**CASES[name])
    disturb(problem, 7)
    matrix = tangent(problem)
    # round-off of assembly
    assert (matrix - matrix.copy().transpose()).norm() < 1e-14 * matrix.norm()


def test_tangent_is_unsymmetric_where_the_load_has_no_potential(body) -> None:
    problem = body(DRAGON_SKIN_10, level=False)
    assert not problem.conservative
    disturb(problem, 7)
    matrix = tangent(problem)
    # the terms along the free edge at 0.02 MPa, measured 5e-3 of the whole tangent; round-off would be 1e-15
    assert (matrix - matrix.copy().transpose()).norm() > 1e-3 * matrix.norm()


@pytest.mark.parametrize("name", ["yeoh", "ogden, mu/alpha", "meshed stiff region", "bonded body"])
def test_residual_is_the_derivative_of_the_potential(body, name: str) -> None:
    problem = body(**CASES[name])
    disturb(problem, 8)
    # without pressure unknowns the potential is what energy() reports, less P V
    problem.state.x.array[problem.owned_pressure] = 0.0
    dofs, bodies = direction(problem, 9)
    dofs[problem.owned_pressure] = 0.0
    line = Line(problem, dofs, bodies)

    def potential(h: float) -> float:
        line.go(h)
        return problem.energy() - float(problem.pressure.value) * problem.cavity_volume()

    slope = line.residual(0.0) @ np.concatenate([dofs, bodies])
    h = 1e-3
    # five-point difference: h^4, and round-off of the energy over h
    difference = (8.0 * (potential(h) - potential(-h)) - potential(2 * h) + potential(-2 * h)) / (12.0 * h)
    assert difference == pytest.approx(slope, rel=1e-9)


def affine(problem: Problem, mesh: SolidMesh, f: np.ndarray, p: float = 0.0) -> State:
    pressure = np.zeros(len(mesh.points))
    pressure[mesh.corners] = p
    return State(mesh.points @ (f - np.eye(3)).T, pressure, problem.body_values.copy(), 0.0)


def rotation(seed: int) -> np.ndarray:
    q, r = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


@pytest.fixture(scope="module")
def free_ogden(body) -> SimpleNamespace:
    problem = body(OGDEN, clamp=False)
    return SimpleNamespace(problem=problem, matrix=problem.new_matrix())


@pytest.mark.parametrize("stretch", [1.0, 0.6, 1.8])
def test_ogden_tangent_is_smooth_through_equal_stretches(
    free_ogden: SimpleNamespace, ring: SolidMesh, stretch: float
) -> None:
    problem = free_ogden.problem
    turn, axes = rotation(10), rotation(11)
    dofs, none = direction(problem, 12)
    products = {}
    for d in (0.0, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2):
        l = np.array([stretch * (1.0 + d), stretch, stretch**-2 / (1.0 + d)])
        problem.set_state(affine(problem, ring, turn @ axes @ np.diag(l) @ axes.T, 0.01))
        problem.assemble_tangent(free_ogden.matrix)
        products[d] = times(free_ogden.matrix, dofs, none)
        exact = Line(problem, dofs, none).differences(1e-5)
        error = np.linalg.norm(products[d] - exact) / np.linalg.norm(exact)
        # central differences at h = 1e-5: the trigonometric eigenvalue form is 10 to 20 % off here
        assert error < 1e-8, d
    for d, product in products.items():
        jump = np.linalg.norm(product - products[0.0]) / np.linalg.norm(products[0.0])
        # proportional to d, measured 0.8 to 6.6, down to round-off
        assert jump < 10.0 * d + 1e-12, d


def test_ogden_tangent_at_rest_is_that_of_neo_hooke(free_ogden: SimpleNamespace, body, ring: SolidMesh) -> None:
    soft = body(NeoHooke(OGDEN.initial_shear_modulus_mpa), clamp=False)
    soft.set_state(soft.zero_state())
    free_ogden.problem.set_state(free_ogden.problem.zero_state())
    free_ogden.problem.assemble_tangent(free_ogden.matrix)
    difference = free_ogden.matrix - tangent(soft)
    # the rational form at 1, and its derivatives: measured 8e-10
    assert difference.norm() < 1e-8 * free_ogden.matrix.norm()


def test_no_force_at_rest(free_ogden: SimpleNamespace, body) -> None:
    for problem in (free_ogden.problem, body(DRAGON_SKIN_10, 0.2, stiff=True), body(DRAGON_SKIN_10, bond=True)):
        problem.set_state(dataclasses.replace(problem.zero_state()))
        force, on_bodies = problem.internal_force()
        # round-off of stresses of 0.1 MPa (0.5 GPa: PLA) over areas of some mm^2
        assert np.abs(force).max() < 1e-11
        assert np.abs(on_bodies).max(initial=0.0) < 1e-12
