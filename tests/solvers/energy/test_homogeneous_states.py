"""Homogeneous deformation: energy and stress are those of the analytical law, and the patch test."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from analytical.laws.isotropic import Law, NeoHooke, OgdenSeries
from analytical.laws.of_invariants import ArrudaBoyce, Gent, MooneyRivlin
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from meshes.cells import TETRAHEDRON_EDGES
from meshes.quality import jacobians, region_volumes_mm3
from meshes.revolve import revolve
from meshes.solid import SolidMesh
from solvers.problem import Problem
from solvers.state import State

LAWS: dict[str, Law] = {
    "neo-hooke": NeoHooke(0.1),
    "yeoh": DRAGON_SKIN_10,
    "ogden, 2mu/alpha^2": dragon_skin_30("2mu/alpha^2"),
    "ogden, mu/alpha": dragon_skin_30("mu/alpha"),
    # Ogden's own three terms for Treloar's rubber (Proc. R. Soc. A 326 (1972) 565), 1 kgf/cm2 taken as 0.1 MPa
    "ogden, three terms": OgdenSeries((0.63, 0.0012, -0.01), (1.3, 5.0, -2.0), "mu/alpha"),
    "mooney-rivlin": MooneyRivlin((0.05, 0.02, 0.001, 0.0005, 0.0002)),
    "gent": Gent(0.1, 40.0),
    "arruda-boyce": ArrudaBoyce(0.1, 3.0),
}
every_law = pytest.mark.parametrize("name", LAWS)
# Yeoh is exact but for round-off; Ogden's rational form is asked for 1e-8.
TOLERANCE = {name: 1e-8 if name.startswith("ogden") else 1e-12 for name in LAWS}
STRETCHES = (
    (1.0, 1.0, 1.0),
    (1.8, 1.8, 1.0 / 3.24),
    (0.7, 0.7, 1.0 / 0.49),
    (2.0, 1.0, 0.5),
    (3.0, 0.9, 1.0 / 2.7),
)


def rotation(seed: int) -> np.ndarray:
    q, r = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


def kirchhoff(law: Law, stretches: np.ndarray, p: float) -> np.ndarray:
    """Principal Kirchhoff stresses of the split energy: law's deviator at the isochoric stretches, plus p J."""
    j = float(np.prod(stretches))
    l = stretches * j ** (-1.0 / 3.0)
    out = np.full(3, p * j)
    for a in range(3):
        for b in range(3):
            if a != b:
                out[a] += law.stress_difference(l[a], l[b], l[3 - a - b]) / 3.0
    return out


@pytest.fixture(scope="module")
def bent(strip) -> SolidMesh:
    """A ring of curved tetrahedra, all its nodes shaken by a fiftieth of a cell."""
    ring = revolve(strip(5.0, 6.5, 2.0, 3, 2, 0.1), 6)
    noise = 0.02 * np.random.default_rng(5).uniform(-1.0, 1.0, ring.points.shape)
    mesh = dataclasses.replace(ring, points=ring.points + noise)
    signed = jacobians(mesh.points, mesh.cells)
    assert np.abs(np.sign(signed).sum(axis=1)).min() == signed.shape[1]
    return mesh


@pytest.fixture(scope="module")
def free(bent: SolidMesh, sides, make_problem):
    """Problems without any constraint, one per law and 1/kappa."""
    made: dict[tuple[str, float], Problem] = {}

    def get(name: str, inverse_kappa: float = 0.0) -> Problem:
        key = (name, inverse_kappa)
        if key not in made:
            made[key] = make_problem(bent, LAWS[name], inverse_kappa, cavity=sides.cavity)
        return made[key]

    return get


def put(problem: Problem, mesh: SolidMesh, f: np.ndarray, p: float) -> None:
    pressure = np.zeros(len(mesh.points))
    pressure[mesh.corners] = p
    problem.set_state(State(mesh.points @ (f - np.eye(3)).T, pressure, problem.body_values.copy(), 0.0))


@every_law
def test_energy_is_that_of_the_law(free, bent: SolidMesh, name: str) -> None:
    problem = free(name)
    volume = region_volumes_mm3(bent)["elastomer"]
    for k, stretches in enumerate(STRETCHES):
        put(problem, bent, rotation(k) @ np.diag(stretches) @ rotation(k + 10), 0.02)
        exact = volume * float(LAWS[name].energy(*stretches))
        scale = volume * LAWS[name].initial_shear_modulus_mpa
        assert problem.energy() == pytest.approx(exact, rel=TOLERANCE[name], abs=TOLERANCE[name] * scale)


@every_law
@pytest.mark.parametrize("inverse_kappa", [0.0, 0.5])
def test_stress_is_that_of_the_law(free, bent: SolidMesh, name: str, inverse_kappa: float) -> None:
    law, problem = LAWS[name], free(name, inverse_kappa)
    volume = region_volumes_mm3(bent)["elastomer"]
    for k, stretches in enumerate(STRETCHES):
        j = 1.0 if inverse_kappa == 0.0 else 1.0 + 0.01 * (k + 1)
        principal = np.array(stretches) * j ** (1.0 / 3.0)
        p = 0.02 if inverse_kappa == 0.0 else (j - 1.0) / inverse_kappa
        left = rotation(k)
        f = left @ np.diag(principal) @ rotation(k + 10)
        put(problem, bent, f, p)
        force, _ = problem.internal_force()
        # the work of the nodal forces in v = B X is P : B times the volume
        found = np.zeros((3, 3))
        for i in range(3):
            component = np.zeros(problem.owned)
            for m in range(3):
                component[problem.u_dofs[:, i]] = bent.points[problem.domain.input_node, m]
                found[i, m] = force @ component / volume
        tau = kirchhoff(law, principal, p)
        exact = left @ np.diag(tau) @ left.T @ np.linalg.inv(f).T
        scale = np.abs(exact).max() + law.initial_shear_modulus_mpa
        assert found == pytest.approx(exact, abs=TOLERANCE[name] * scale)


@every_law
@pytest.mark.parametrize("inverse_kappa", [0.0, 0.5])
def test_patch_of_distorted_tetrahedra_is_in_equilibrium(
    free, bent: SolidMesh, boundary_of, name: str, inverse_kappa: float
) -> None:
    problem = free(name, inverse_kappa)
    surface = boundary_of(bent.cells, 3)
    rims = {tuple(edge) for face in surface for edge in (face[[0, 1]], face[[0, 2]], face[[1, 2]])}
    on_surface = np.zeros(len(bent.points), dtype=bool)
    on_surface[surface] = True
    for k, (a, b) in enumerate(TETRAHEDRON_EDGES):
        ends = np.sort(bent.cells[:, [a, b]], axis=1)
        on_surface[bent.cells[[tuple(e) in rims for e in ends], 4 + k]] = True
    inside = ~on_surface[problem.domain.input_node]
    assert inside.sum() > 50
    for k, stretches in enumerate(STRETCHES[1:]):
        j = 1.0 if inverse_kappa == 0.0 else 1.05
        p = -0.05 if inverse_kappa == 0.0 else (j - 1.0) / inverse_kappa
        f = rotation(k) @ np.diag(stretches) @ rotation(k + 10) * j ** (1.0 / 3.0)
        put(problem, bent, f, p)
        force, _ = problem.internal_force()
        size = np.abs(force).max()
        # asked 1e-11; round-off of sums over some 20 cells
        assert np.abs(force[problem.u_dofs[inside]]).max() < 2e-12 * size
        volume_rows = force[problem.owned_pressure]
        assert np.abs(volume_rows).max() < 1e-12


@pytest.mark.parametrize("name", ["yeoh", "ogden, 2mu/alpha^2"])
def test_patch_on_a_meridian(strip, sides, make_problem, name: str) -> None:
    mesh = strip(1.0, 3.0, 2.0, 4, 4, 0.1)
    problem = make_problem(mesh, LAWS[name], cavity=sides.cavity)
    axial = 1.6
    radial = axial**-0.5
    pressure = np.zeros(len(mesh.points))
    pressure[mesh.corners] = 0.03
    problem.set_state(State(mesh.points * ([radial - 1.0, axial - 1.0]), pressure, np.zeros((0, 0)), 0.0))
    r, z = mesh.points.T
    edge = (r < 1.0 + 1e-9) | (r > 3.0 - 1e-9) | (z < 1e-9) | (z > 2.0 - 1e-9)
    inside = ~edge[problem.domain.input_node]
    force, _ = problem.internal_force()
    # round-off, as above
    assert np.abs(force[problem.u_dofs[inside]]).max() < 1e-12 * np.abs(force).max()
    volume = np.pi * (9.0 - 1.0) * 2.0
    energy = volume * float(LAWS[name].energy(axial, radial, radial))
    assert problem.energy() == pytest.approx(energy, rel=TOLERANCE[name])
    # forces on the ends: v = z e_z on the whole body does the work P_zz times the volume
    stretch = np.zeros(problem.owned)
    stretch[problem.u_dofs[:, 1]] = z[problem.domain.input_node]
    tau = kirchhoff(LAWS[name], np.array([axial, radial, radial]), 0.03)
    assert force @ stretch / volume == pytest.approx(tau[0] / axial, rel=TOLERANCE[name])
