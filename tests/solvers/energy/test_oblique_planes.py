"""Displacement components along oblique planes of symmetry, and a dead pressure from outside."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from analytical.laws.isotropic import NeoHooke
from meshes.sweep import revolve_hexahedra
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import SolverError
from solvers.linear.factor import Factor
from solvers.state import State

TIGHT = NewtonSettings(relative_tolerance=1e-11)
START, END = 7, 8  # surface numbers of meshes.solid


@pytest.fixture(scope="module")
def sector(strip, sides, make_problem):
    """A sector of a ring in plane strain, its components along its planes of symmetry, under a load by name."""

    def make(angle_rad: float, **load: int) -> SimpleNamespace:
        mesh = revolve_hexahedra(strip(5.0, 6.0, 0.5, 1, 1, 0.0, True), 2, angle_rad)
        frame = np.eye(3)
        frame[:2, 1] = math.cos(angle_rad), math.sin(angle_rad)
        held = ((START, 1), (END, 0), (sides.bottom, 2), (sides.top, 2))
        problem = make_problem(mesh, NeoHooke(0.1), held=held, frame=frame, **load)
        return SimpleNamespace(mesh=mesh, problem=problem)

    return make


def solved(problem, pressure: float) -> State:
    solve_equilibrium(problem, Factor(problem), TIGHT, HeldLoad(pressure))
    return problem.get_state()


def test_sixty_degrees_are_held_in_their_planes_and_stay_round(sector, sides) -> None:
    case = sector(math.pi / 3, cavity=sides.cavity)
    assert case.problem.conservative  # the planes close the cavity
    state = solved(case.problem, 0.005)
    normal = np.array([-math.sin(math.pi / 3), math.cos(math.pi / 3), 0.0])
    on_end = np.abs(case.mesh.points @ normal) < 1e-9
    # held exactly, but for the products of the frame: round-off
    assert np.abs(state.displacement_mm[on_end] @ normal).max() < 1e-14
    radius = np.hypot(*case.mesh.points[:, :2].T)
    radial = np.sum(state.displacement_mm[:, :2] * case.mesh.points[:, :2], axis=1) / radius
    inside = np.isclose(radius, 5.0)
    assert radial[inside].min() > 0.1
    # quadratic cells of 30 degrees: measured 2e-4
    assert np.ptp(radial[inside]) < 1e-3 * radial[inside].max()


def test_frame_changes_nothing_that_is_there_without_it(sector, strip, sides, make_problem) -> None:
    mesh = revolve_hexahedra(strip(5.0, 6.0, 0.5, 1, 1, 0.0, True), 2, 0.5 * math.pi)
    held = ((START, 1), (END, 0), (sides.bottom, 2), (sides.top, 2))
    plain = make_problem(mesh, NeoHooke(0.1), cavity=sides.cavity, held=held)
    scales = np.diag([1.3, 0.8, 2.0])  # keeps what the three planes hold
    framed = make_problem(mesh, NeoHooke(0.1), cavity=sides.cavity, held=held, frame=scales)
    a, b = solved(plain, 0.005), solved(framed, 0.005)
    # the same state by another way: Newton's tolerance
    assert b.displacement_mm == pytest.approx(a.displacement_mm, abs=1e-9)
    assert framed.cavity_volume() == pytest.approx(plain.cavity_volume(), rel=1e-10)
    assert framed.energy() == pytest.approx(plain.energy(), rel=1e-9)
    framed.set_state(a)
    assert framed.get_state().displacement_mm == pytest.approx(a.displacement_mm, abs=1e-14)


def test_dead_pressure_is_a_following_one_times_the_growth_of_the_surface(sector, sides) -> None:
    dead = sector(0.5 * math.pi, dead_pressure=sides.outer)
    following = sector(0.5 * math.pi, external=sides.outer)
    pressure = 0.002
    state = solved(dead.problem, pressure)
    outer = np.isclose(np.hypot(*dead.mesh.points[:, :2].T), 6.0)
    moved = np.hypot(*(dead.mesh.points + state.displacement_mm)[outer, :2].T).mean()
    assert moved < 5.98
    # the same force on a smaller surface; while it is round both are one, up to the cells of 45 degrees
    same = solved(following.problem, pressure * 6.0 / moved)
    assert same.displacement_mm == pytest.approx(state.displacement_mm, abs=1e-3 * (6.0 - moved))
    # g = -int u . N dA
    assert dead.problem.cavity_volume() == pytest.approx((6.0 - moved) * 0.5 * math.pi * 6.0 * 0.5, rel=2e-3)


def test_a_load_of_two_kinds_is_refused(sector, sides) -> None:
    with pytest.raises(SolverError, match="set one of cavity, suction, external, dead, dead_pressure"):
        sector(0.5 * math.pi, dead_pressure=sides.outer, external=sides.outer)
