"""A rigid plate that closes the cavity: enclosed volume, its derivatives, and equilibrium with a plate that tilts."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.sweep import revolve_hexahedra
from solvers.bodies.rigid import EVERY_MOTION, RigidBodies, moved
from solvers.equilibrium.controls import HeldLoad, HeldVolume
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.linear.factor import Factor
from solvers.state import State

INNER_MM, OUTER_MM, HEIGHT_MM, ARM_MM = 5.0, 6.0, 8.0, 6.0
SHIFT, TURN = np.array([0.7, -0.5, 1.2]), np.array([0.2, 0.4, 0.1])


@pytest.fixture(scope="module")
def tube(strip, sides, make_problem):
    """A tube, bottom clamped, its top bonded to a plate; and the area within the inner rim as it is meshed."""
    mesh = revolve_hexahedra(strip(INNER_MM, OUTER_MM, HEIGHT_MM, 1, 4, 0.0, True), 8)
    top = mesh.facet_tags == sides.top
    mesh = dataclasses.replace(mesh, facet_bodies=np.where(top, 0, -1))
    # eight sectors of a parabola through three points of the circle
    angle = np.pi / 4
    part = 0.5 * np.sin(angle) + 4.0 / 3.0 * np.sin(0.5 * angle) * (1.0 - np.cos(0.5 * angle))
    area = 8 * INNER_MM**2 * part
    centre = np.array([HEIGHT_MM])
    plate = RigidBodies(300.0, 300.0, np.ones(len(mesh.points)), centre, ARM_MM, plate=0, plate_area_mm2=area)
    problem = make_problem(
        mesh, DRAGON_SKIN_10, bodies=plate, cavity=sides.cavity, clamped=sides.bottom, bond=sides.top
    )
    return mesh, problem, area


def towards_the_plate(x: np.ndarray) -> np.ndarray:
    """Displacement that grows along the tube from nothing to the plate's rigid motion."""
    turn = Rotation.from_rotvec(TURN).as_matrix() - np.eye(3)
    share = x[:, 2:] / HEIGHT_MM
    return share * ((x - [0.0, 0.0, HEIGHT_MM]) @ turn.T + SHIFT)


def volume_within(area: float) -> float:
    """Integral of det F over the cavity: a polynomial of low degree, so Gauss' rule; scaled to the meshed area."""
    x, w = np.polynomial.legendre.leggauss(8)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    angle = 2.0 * np.pi * np.arange(32) / 32
    turn = Rotation.from_rotvec(TURN).as_matrix() - np.eye(3)
    total = 0.0
    for s, ws in zip(x, w, strict=True):
        for t, wt in zip(x, w, strict=True):
            r, z = INNER_MM * s, HEIGHT_MM * t
            at = np.stack([r * np.cos(angle), r * np.sin(angle), np.full(32, z - HEIGHT_MM)], axis=1)
            f = np.eye(3) + t * turn + (at @ turn.T + SHIFT)[:, :, None] / HEIGHT_MM * np.array([0.0, 0.0, 1.0])
            total += float(np.linalg.det(f).mean() * 2.0 * np.pi * r * INNER_MM * ws * HEIGHT_MM * wt)
    return total * area / (np.pi * INNER_MM**2)


def test_volume_closed_by_a_plate_that_has_tilted_and_drifted(tube) -> None:
    mesh, problem, area = tube
    motion = np.concatenate([SHIFT, TURN * ARM_MM])[None]
    problem.set_state(State(towards_the_plate(mesh.points), np.zeros(problem.unknowns.pressure_shape), motion, 0.0))
    plate, _ = problem.bonded.plate_volume()
    assert plate > 10.0  # without it the volume would be 2 % off
    # det F is linear in x and y here, so only the area counts, not the shape of the circle: round-off
    assert problem.cavity_volume() == pytest.approx(volume_within(area), rel=1e-12)


def test_slope_and_curvature_of_the_plates_volume(tube) -> None:
    _, problem, _ = tube
    bonded = problem.bonded
    base = np.concatenate([SHIFT, TURN * ARM_MM])[None]

    def at(step: np.ndarray) -> tuple[float, np.ndarray]:
        bonded.values[:] = moved(base, step[None], ARM_MM)
        return bonded.plate_volume()

    h = 1e-5
    ends = [(at(h * e), at(-h * e)) for e in np.eye(6)]
    slope = np.array([(a[0] - b[0]) / (2.0 * h) for a, b in ends])
    change = np.array([(a[1] - b[1]) / (2.0 * h) for a, b in ends])
    bonded.values[:] = base
    _, found = bonded.plate_volume()
    curvature = bonded.plate_curvature(EVERY_MOTION)
    # central differences of values of 15 mm^3: truncation 1e-10, round-off 1e-10
    assert found == pytest.approx(slope, abs=1e-8)
    # rotations do not commute: the symmetric part of the change of slope is the second derivative
    assert curvature == pytest.approx(0.5 * (change + change.T), abs=1e-8)


def test_tangent_under_pressure_sees_the_plate(tube) -> None:
    _, problem, _ = tube
    rng = np.random.default_rng(5)
    x = problem.state.x.array
    x[:] = np.where(problem.owned_pressure, 0.05, 0.02) * rng.standard_normal(len(x))
    x[problem.constrained_owned] = 0.0
    base = np.concatenate([SHIFT, TURN * ARM_MM])[None]
    problem.bonded.values[:] = base
    problem.bonded.update(np.zeros(0))
    problem.pressure.value = 0.5  # so large that the plate's part shows beside the bond's
    matrix = problem.new_matrix()
    problem.assemble_tangent(matrix)
    start = x.copy()
    way = 0.1 * rng.standard_normal(problem.owned)
    way[problem.constrained_owned] = 0.0
    turn = 0.1 * rng.standard_normal(6)
    vector, product = matrix.createVecs()
    along = np.concatenate([way, turn])
    vector.array[:] = along
    matrix.mult(vector, product)

    def residual(h: float) -> np.ndarray:
        x[:] = start + h * way
        problem.bonded.values[:] = moved(base, h * turn[None], ARM_MM)
        problem.bonded.update(np.zeros(0))
        force, on_bodies = problem.internal_force()
        force = force - float(problem.pressure.value) * problem.load.gradient()
        force[problem.constrained_owned] = 0.0
        return np.concatenate([force, on_bodies])

    exact = (residual(1e-5) - residual(-1e-5)) / 2e-5
    # the rows of the solid, and the curvature along the way (see test_tangent on rotations); h^2
    gap = (product.array - exact)[: problem.owned]
    assert np.linalg.norm(gap) < 1e-8 * np.linalg.norm(exact)
    assert along @ exact == pytest.approx(along @ product.array, rel=1e-8)


def test_volume_and_load_answer_each_other_on_a_column_that_leans(strip, sides, make_problem) -> None:
    length = 30.0
    mesh = revolve_hexahedra(strip(INNER_MM, OUTER_MM, length, 1, 6, 0.0, True), 8)
    top = mesh.facet_tags == sides.top
    points = mesh.points.copy()
    points[:, 0] += (
        2.0 * np.sin(np.pi * points[:, 2] / length) ** 2
    )  # bulges to one side, so that its plate tilts and drifts
    mesh = dataclasses.replace(mesh, points=points, facet_bodies=np.where(top, 0, -1))
    centre, area = np.array([length]), np.pi * INNER_MM**2
    plate = RigidBodies(300.0, 300.0, np.ones(len(points)), centre, ARM_MM, plate=0, plate_area_mm2=area)
    problem = make_problem(
        mesh, DRAGON_SKIN_10, bodies=plate, cavity=sides.cavity, clamped=sides.bottom, bond=sides.top
    )
    factor, pressure = Factor(problem), 0.012
    settings = NewtonSettings(relative_tolerance=1e-11, reuse_below=0.0, reuse_for=0.0)
    report = solve_equilibrium(problem, factor, settings, HeldLoad(pressure))
    assert problem.bonded.plate_volume()[1][:2] @ [1.0, 0.0] > 1.0  # mm^2
    here, volume = problem.get_state(), problem.cavity_volume()

    errors: list[float] = []
    solve_equilibrium(problem, factor, settings, HeldVolume(1.02 * volume), lambda _, error: errors.append(error))
    # quadratic from 2 %; with what the load does on the plate left out of the border it falls by a factor of fifty
    assert errors[3] < 1e-9

    volumes = []
    for sign in (-1.0, 1.0):
        problem.set_state(here)
        solve_equilibrium(problem, factor, settings, HeldLoad((1.0 + 1e-4 * sign) * pressure))
        volumes.append(problem.cavity_volume())
    # central difference: 1e-8; without the plate's part 2e-4 off
    slope = (volumes[1] - volumes[0]) / (2e-4 * pressure)
    assert report.compliance_mm3_per_mpa == pytest.approx(slope, rel=1e-6)
