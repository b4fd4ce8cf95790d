"""An end that is held or pulled: its force against axial equilibrium, virtual work, and the stability count."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.meridian import meridian_mesh
from meshes.solid import FACETS
from meshes.sweep import revolve_hexahedra
from solvers.bodies.rigid import RigidBodies
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.forces import end_force
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import StepFailed
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from solvers.state import State

TIGHT = NewtonSettings(relative_tolerance=1e-11)
PRESSURE_MPA = 0.005


def bonded_to_plate(mesh, tag: int, number: int, height_mm: float, area_mm2: float, arm_mm: float, **plate):
    """The mesh with a surface bonded to a plate, and the plate."""
    at = mesh.facet_tags == tag
    mesh = dataclasses.replace(
        mesh,
        facet_tags=np.where(at, FACETS["bond"], mesh.facet_tags),
        facet_bodies=np.where(at, number, -1),
    )
    grade = np.ones(len(mesh.points))
    centre = np.array([height_mm])
    return mesh, RigidBodies(300.0, 300.0, grade, centre, arm_mm, plate=0, plate_area_mm2=area_mm2, **plate)


@pytest.fixture(scope="module")
def bellows(one_convolution, coarse, make_problem):
    """A bellows of one convolution on its meridian; its end is a cap held at its rim, or a plate."""

    def make(end: str, **plate) -> SimpleNamespace:
        shape = one_convolution if end == "cap" else dataclasses.replace(one_convolution, cap_mm=0.0)
        mesh, bodies = meridian_mesh(shape, coarse, cells="quadrilaterals"), None
        surfaces = {"cavity": FACETS["cavity"], "clamped": FACETS["clamped"], "held": ((FACETS["axis"], 0),)}
        if end == "cap":
            surfaces["blocked"] = FACETS["tip"]
        else:
            area = np.pi * shape.crest_radius_mm**2
            mesh = dataclasses.replace(mesh, facet_tags=np.where(mesh.facet_tags == FACETS["bond"], 0, mesh.facet_tags))
            mesh, bodies = bonded_to_plate(
                mesh, FACETS["tip"], 0, shape.cavity_length_mm, area, shape.seat_radius_mm, **plate
            )
            surfaces["bond"] = FACETS["bond"]
        problem = make_problem(mesh, DRAGON_SKIN_10, bodies=bodies, **surfaces)
        return SimpleNamespace(problem=problem, factor=Factor(problem), inlet_mm2=np.pi * shape.crest_radius_mm**2)

    return make


@pytest.fixture(scope="module")
def tube(strip, sides, make_problem):
    """A tube in hexahedra, its bottom clamped, its top bonded to a plate that is held."""
    inner, height = 5.0, 8.0
    mesh = revolve_hexahedra(strip(inner, 6.0, height, 1, 4, 0.0, True), 8)
    angle = np.pi / 4  # eight sectors of a parabola through three points of the circle
    part = 0.5 * np.sin(angle) + 4.0 / 3.0 * np.sin(0.5 * angle) * (1.0 - np.cos(0.5 * angle))
    area = 8 * inner**2 * part
    mesh, plate = bonded_to_plate(mesh, sides.top, 0, height, area, 6.0, plate_held=True)
    problem = make_problem(
        mesh, DRAGON_SKIN_10, bodies=plate, cavity=sides.cavity, clamped=sides.bottom, bond=FACETS["bond"]
    )
    return SimpleNamespace(problem=problem, factor=Factor(problem), inlet_mm2=area)


def blocked(bellows, tube, end: str) -> SimpleNamespace:
    return tube if end == "plate in 3D" else bellows(end, **({} if end == "cap" else {"plate_held": True}))


@pytest.mark.parametrize("end", ["cap", "plate", "plate in 3D"])
def test_force_at_a_blocked_end_balances_support_and_pressure(bellows, tube, end: str) -> None:
    case = blocked(bellows, tube, end)
    path = follow_path(case.problem, case.factor, [PRESSURE_MPA], PathSettings(newton=TIGHT))
    point = path.states[-1]
    thrust = PRESSURE_MPA * case.inlet_mm2  # of the pressure on all of the inside: that on the inlet
    # asked 1e-8; Newton's residual is 1e-11 of the load
    assert abs(point.reaction_n + thrust - point.end_force_n) < 1e-8 * thrust
    assert point.end_force_n > 0.1 * thrust  # it pushes outwards
    assert point.newton.excess_negatives == 0
    assert np.all(point.state.bodies_mm == 0.0)


def test_a_blocked_rim_keeps_its_height(bellows) -> None:
    case = bellows("cap")
    path = follow_path(case.problem, case.factor, [PRESSURE_MPA], PathSettings(newton=TIGHT))
    mesh = case.problem.domain
    rim = case.problem.unknowns.supports.blocked_axial
    assert len(rim) > 3 and mesh.axisymmetric
    assert np.all(case.problem.state.x.array[rim] == 0.0)
    assert path.reached


@pytest.mark.parametrize("end", ["cap", "plate", "plate in 3D"])
def test_force_at_a_held_end_is_the_slope_of_the_potential(bellows, tube, end: str) -> None:
    case = blocked(bellows, tube, end)
    problem = case.problem
    problem.set_state(problem.zero_state())
    axial = problem.unknowns.supports.blocked_axial

    def hold(at_mm: float) -> tuple[float, float]:
        """Potential energy - P V and force with the end held at an elongation."""
        if axial is None:
            state = problem.get_state()
            motion = np.zeros_like(state.bodies_mm)
            motion[0, 2 if motion.shape[1] == 6 else 0] = at_mm
            problem.set_state(dataclasses.replace(state, bodies_mm=motion))
        else:
            problem.state.x.array[axial] = at_mm
        solve_equilibrium(problem, case.factor, TIGHT, HeldLoad(PRESSURE_MPA))
        return problem.energy() - PRESSURE_MPA * problem.cavity_volume(), end_force(problem)

    hold(0.0)
    h = 0.02
    ends = [hold(z)[0] for z in (-2 * h, -h, h, 2 * h)]
    slope = (8.0 * (ends[2] - ends[1]) - (ends[3] - ends[0])) / (12.0 * h)
    # fourth order, h^4 of a length of millimetres: 1e-8; measured below 1e-7
    assert hold(0.0)[1] == pytest.approx(-slope, rel=1e-6)


def test_a_held_plate_is_a_unit_diagonal_and_adds_no_negative_pivot(tube, bellows) -> None:
    for case in (tube, bellows("plate", plate_held=True)):
        problem = case.problem
        problem.set_state(problem.zero_state())
        case.factor.refresh()
        assert case.factor.negatives == problem.expected_negatives
        matrix = problem.new_matrix()
        problem.assemble_tangent(matrix)
        last = matrix.getSize()[0] - problem.extra
        for k in range(problem.extra):
            columns, values = matrix.getRow(last + k)
            assert dict(zip(columns[values != 0.0], values[values != 0.0], strict=True)) == {last + k: 1.0}
        assert matrix.isSymmetric(1e-12)


def test_the_opposite_of_the_blocked_force_brings_a_free_plate_back(bellows) -> None:
    held = bellows("plate", plate_held=True)
    settings = PathSettings(newton=TIGHT)
    low = 0.2 * PRESSURE_MPA  # the whole force would crush the bellows before the pressure comes
    force = follow_path(held.problem, held.factor, [low], settings).states[-1].end_force_n
    free = bellows("plate", plate_force_n=-force)
    path = follow_path(free.problem, free.factor, [low], settings)
    assert path.reached, path.reason
    assert path.states[-1].end_force_n == pytest.approx(force, rel=1e-15)
    # Newton's residual over the bellows' stiffness, 0.1 N/mm
    assert abs(path.states[-1].state.bodies_mm[0, 0]) < 1e-8


def test_a_pulled_plate_goes_out_without_pressure_as_far_as_its_work_says(bellows) -> None:
    case = bellows("plate", plate_force_n=0.1)
    path = follow_path(case.problem, case.factor, [PRESSURE_MPA], PathSettings(newton=TIGHT))
    reached = path.states[-1]
    thrust = PRESSURE_MPA * case.inlet_mm2
    assert reached.reaction_n + thrust + 0.1 == pytest.approx(0.0, abs=1e-8 * thrust)  # as above
    plain = bellows("plate")
    same = follow_path(plain.problem, plain.factor, [PRESSURE_MPA], PathSettings(newton=TIGHT)).states[-1]
    assert reached.state.bodies_mm[0, 0] > same.state.bodies_mm[0, 0]
    # from here: no pressure, the force alone
    problem = case.problem
    problem.set_state(problem.zero_state())
    rest = []
    for force in (0.025, 0.05, 0.075, 0.1):
        problem.bonded.dead_force_n = force
        solve_equilibrium(problem, case.factor, TIGHT, HeldLoad(0.0))
        rest.append((float(problem.body_values[0, 0]), problem.energy()))
    way, energy = np.array([(0.0, 0.0), *rest]).T
    # Boole's rule for the work of the force along the way, from four steps: measured within 1e-5
    weight = np.array([7.0, 32.0, 12.0, 32.0, 7.0]) * 0.025 * 2.0 / 45.0
    assert energy[-1] == pytest.approx(0.1 * way[-1] - weight @ way, rel=1e-4)


def test_a_force_that_crushes_is_refused_with_its_size(bellows) -> None:
    case = bellows("plate", plate_force_n=-50.0)
    with pytest.raises(StepFailed, match="no equilibrium under the dead force of -50 N before the pressure comes"):
        follow_path(case.problem, case.factor, [PRESSURE_MPA], PathSettings())


def test_states_of_a_held_plate_keep_their_motion(tube) -> None:
    problem = tube.problem
    motion = np.array([[0.0, 0.0, 0.3, 0.0, 0.0, 0.0]])
    zero = problem.zero_state()
    problem.set_state(State(zero.displacement_mm, zero.pressure_mpa, motion, 0.0))
    solve_equilibrium(problem, tube.factor, TIGHT, HeldLoad(0.0))
    assert np.array_equal(problem.body_values, motion)
    assert end_force(problem) < 0.0  # a stretched tube pulls inwards
