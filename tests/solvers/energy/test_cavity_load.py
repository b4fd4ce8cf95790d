"""The cavity: its volume, the load as potential and as traction, and the support's reaction."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

import numpy as np
import pytest

from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.bellows import cap_band, corner_band, wall_segments
from meshes.revolve import revolve
from meshes.shape import BellowsShape
from meshes.solid import FACETS, SolidMesh
from solvers.problem import Problem
from solvers.state import State


def worst_difference(problem: Problem) -> float:
    """Largest difference of potential and traction on random directions that respect the constraints."""
    rng = np.random.default_rng(17)
    potential, traction = problem.load.gradient(), problem.load.traction()
    directions = rng.standard_normal((5, problem.owned)) * ~problem.constrained_owned
    # relative to the sum of the absolute values that cancel in the scalar product
    return float(np.abs((directions @ (potential - traction)) / (np.abs(directions) @ np.abs(traction))).max())


def shake(problem: Problem, mesh: SolidMesh, seed: int) -> None:
    """A smooth large displacement and noise, with the problem's constraints imposed."""
    rng = np.random.default_rng(seed)
    x = mesh.points
    smooth = 0.3 * x @ rng.standard_normal((mesh.dimension, mesh.dimension)) / math.sqrt(mesh.dimension)
    u = smooth + 0.1 * rng.standard_normal(x.shape)
    problem.set_state(State(u, np.zeros(len(x)), np.zeros(problem.body_values.shape), 0.0))


def affine(problem: Problem, mesh: SolidMesh, f: np.ndarray) -> None:
    u = mesh.points @ (f - np.eye(mesh.dimension)).T
    problem.set_state(State(u, np.zeros(len(u)), np.zeros(problem.body_values.shape), 0.0))


@pytest.mark.parametrize("dimension", [2, 3])
def test_potential_is_the_traction_on_a_clamped_bellows(bellows_problem, dimension: int) -> None:
    case = bellows_problem(dimension)
    assert case.problem.conservative
    shake(case.problem, case.mesh, 3)
    # asked 1e-10; the degree of quadrature makes it an identity of polynomials: round-off
    assert worst_difference(case.problem) < 1e-13


@pytest.mark.parametrize("dimension", [2, 3])
def test_potential_is_the_traction_at_equilibrium(bellows_problem, inflated, inflated_solid, dimension: int) -> None:
    problem = bellows_problem(dimension).problem
    path = (inflated if dimension == 2 else inflated_solid)()
    problem.set_state(path.states[-1].state)
    assert worst_difference(problem) < 1e-13  # round-off


def test_potential_is_the_traction_between_symmetry_planes(strip, quarter, sides, make_problem) -> None:
    mesh = quarter(revolve(strip(5.0, 6.0, 2.0, 1, 1), 8))
    held = ((sides.bottom, 2), (sides.top, 2), (sides.x_plane, 0), (sides.y_plane, 1))
    problem = make_problem(mesh, DRAGON_SKIN_10, cavity=sides.cavity, held=held)
    shake(problem, mesh, 4)
    assert worst_difference(problem) < 1e-13  # round-off


def test_potential_is_not_the_traction_on_a_free_edged_patch(strip, sides, make_problem) -> None:
    # the top of the tube is open: nothing holds its edge in a plane, and no volume is enclosed
    mesh = revolve(strip(5.0, 6.0, 2.0, 1, 1), 8)
    problem = make_problem(mesh, DRAGON_SKIN_10, cavity=sides.cavity, clamped=sides.bottom)
    shake(problem, mesh, 5)
    # a term along the edge, of the size of the loads of the facets beside it: measured 0.5
    assert worst_difference(problem) > 1e-2
    assert not problem.conservative


def exact_cavity_volume(shape: BellowsShape) -> float:
    """pi int r^2 dz along the inner outline, by Gauss' rule on each smooth piece."""
    x, w = np.polynomial.legendre.leggauss(20)
    at, weights = 0.5 * (x + 1.0), 0.5 * w
    h = 1e-5
    total = 0.0
    bands: list[Callable] = [piece.band for piece in wall_segments(shape)]
    bands += [functools.partial(corner_band, shape), functools.partial(cap_band, shape)]
    for band in bands:
        inside = band(at)[0]
        slope = (band(at + h)[0][:, 1] - band(at - h)[0][:, 1]) / (2.0 * h)
        total += float(weights @ (math.pi * inside[:, 0] ** 2 * slope))
    return total


def test_cavity_volume_is_that_of_the_outline(bellows_problem, one_convolution: BellowsShape) -> None:
    exact = exact_cavity_volume(one_convolution)
    for dimension, tolerance in ((2, 2e-5), (3, 1.5e-3)):
        problem = bellows_problem(dimension).problem
        problem.set_state(problem.zero_state())
        # arcs of 30 to 45 degrees on the meridian and of 45 round it, as parabolas: measured 7e-6 and 8e-4
        assert problem.cavity_volume() == pytest.approx(exact, rel=tolerance)


def test_cavity_volume_of_a_stretched_bellows_on_a_meridian(coarse_meridian: SolidMesh, make_problem) -> None:
    problem = make_problem(coarse_meridian, DRAGON_SKIN_10, cavity=FACETS["cavity"])
    rest = problem.cavity_volume()
    affine(problem, coarse_meridian, np.diag([1.3, 2.2]))
    # polynomials, integrated exactly
    assert problem.cavity_volume() == pytest.approx(rest * 1.3**2 * 2.2, rel=1e-13)


def test_cavity_volume_of_a_stretched_and_sheared_bellows(coarse_solid: SolidMesh, make_problem) -> None:
    problem = make_problem(coarse_solid, DRAGON_SKIN_10, cavity=FACETS["cavity"])
    rest = problem.cavity_volume()
    # leaves the inlet plane level, as the formula needs
    f = np.array([[1.3, 0.2, 0.4], [-0.1, 0.9, 0.3], [0.0, 0.0, 1.8]])
    affine(problem, coarse_solid, f)
    assert problem.cavity_volume() == pytest.approx(rest * np.linalg.det(f), rel=1e-13)  # polynomials


def test_cavity_volume_of_a_widened_tube(strip, sides, make_problem) -> None:
    # r -> sqrt(r^2 + c) is not affine: the exact volume is that of the quadratic interpolant's end points
    mesh = strip(5.0, 6.0, 3.0, 1, 2)
    problem = make_problem(mesh, DRAGON_SKIN_10, cavity=sides.cavity)
    r = mesh.points[:, 0]
    u = np.column_stack([np.sqrt(r**2 + 20.0) - r, np.zeros(len(r))])
    problem.set_state(State(u, np.zeros(len(r)), np.zeros((0, 0)), 0.0))
    assert problem.cavity_volume() == pytest.approx(math.pi * 45.0 * 3.0, rel=1e-13)


@pytest.mark.parametrize("dimension", [2, 3])
def test_volume_gradient_is_the_derivative_of_the_volume(bellows_problem, dimension: int) -> None:
    case = bellows_problem(dimension)
    problem = case.problem
    shake(problem, case.mesh, 6)
    direction = np.random.default_rng(7).standard_normal(problem.owned)
    slope = problem.load.gradient() @ direction
    start = problem.state.x.array.copy()
    values = []
    for step in (-2.0, -1.0, 1.0, 2.0):
        problem.state.x.array[:] = start + step * 0.01 * direction
        values.append(problem.cavity_volume())
    difference = (8.0 * (values[2] - values[1]) - values[3] + values[0]) / 0.12
    # V is a cubic, for which five-point differences are exact but for round-off of V over h
    assert difference == pytest.approx(slope, rel=1e-9)


def test_reaction_is_the_pressure_on_the_inlet(inflated, one_convolution: BellowsShape) -> None:
    area = math.pi * one_convolution.crest_radius_mm**2
    for state in inflated().states:
        # the residual left by Newton, 1e-11 of the load
        assert state.reaction_n == pytest.approx(-state.state.load_mpa * area, rel=1e-9)


def test_reaction_in_3d_is_the_pressure_on_the_meshs_inlet(
    bellows_problem, inflated_solid, one_convolution: BellowsShape
) -> None:
    problem = bellows_problem(3).problem
    for point in inflated_solid().states:
        problem.set_state(point.state)
        lift = np.zeros(problem.owned)
        lift[problem.u_dofs[:, 2]] = 1.0
        area = problem.load.traction() @ lift
        # the closed surface less the inlet: the inlet's area, eight parabolas round: 8e-4 short
        assert area == pytest.approx(math.pi * one_convolution.crest_radius_mm**2, rel=1e-3)
        assert point.reaction_n == pytest.approx(-point.state.load_mpa * area, rel=1e-9)  # Newton's residual
