"""Contact against exact answers: a tube in a rigid bore, a tube in a tube, a sphere in a bowl; derivatives; guards."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from analytical.exact.sphere import Sphere
from analytical.exact.sphere import deformed_radius_mm as sphere_radius_mm
from analytical.exact.sphere import pressure_at_inner_radius_mpa as sphere_pressure_mpa
from analytical.exact.tube import Tube, inner_radius_at_outer_mm, pressure_at_inner_radius_mpa
from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.bodies import sphere_meridian
from meshes.gaps import outlines
from meshes.solid import FACETS
from meshes.surface import boundary_edges
from solvers.contact.contact import Contact
from solvers.contact.obstacles import Bore, Bowl, RoundedBox
from solvers.contact.pairs import Against, ContactSettings, Facing, Line, Stop
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause, SolverError, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings

LAW = DRAGON_SKIN_10
INNER, OUTER = Tube(5.0, 6.0), Tube(7.0, 8.5)
HOUSING_MM = 7.0
HEIGHT_MM = 2.0
SETTINGS = ContactSettings(stiffness_mpa_per_mm=20.0, smoothing_mm=1e-3, depth_mm=0.4, reach_mm=0.1, limit_mm=0.01)


def column(mesh, radius):
    """Nodes of a strip at one radius, upwards."""
    here = np.flatnonzero(np.isclose(mesh.points[:, 0], radius))
    return here[np.argsort(mesh.points[here, 1])]


def line_of(mesh, radius, side):
    nodes = column(mesh, radius)
    return Line(nodes, side, np.ones((len(nodes) - 1) // 2, dtype=bool))


@pytest.fixture
def tube_in_bore(strip, sides, make_problem):
    mesh = strip(INNER.inner_radius_mm, INNER.outer_radius_mm, HEIGHT_MM, 4, 4, quadrilaterals=True)
    held = ((sides.bottom, 1), (sides.top, 1))
    problem = make_problem(mesh, LAW, cavity=sides.cavity, held=held)
    line = line_of(mesh, INNER.outer_radius_mm, -1.0)

    def contact(settings=SETTINGS):
        pair = Against("housing", 0, Bore(HOUSING_MM), None, np.empty(0))
        return Contact(problem.unknowns, mesh.points, [line], [pair], settings, boundary_edges(mesh))

    return SimpleNamespace(mesh=mesh, problem=problem, contact=contact)


def joined(a, b):
    """Two meshes side by side; the second's cavity is an outer surface."""
    shift = len(a.points)
    tags = np.where(b.facet_tags == 1, 4, b.facet_tags)
    return dataclasses.replace(
        a,
        points=np.vstack([a.points, b.points]),
        cells=np.vstack([a.cells, b.cells + shift]),
        regions=np.append(a.regions, b.regions),
        facets=np.vstack([a.facets, b.facets + shift]),
        facet_tags=np.append(a.facet_tags, tags),
        facet_bodies=np.append(a.facet_bodies, b.facet_bodies),
    )


@pytest.fixture
def tube_in_tube(strip, sides, make_problem):
    """Two tubes with cells that do not match; nothing loads the outer one but the inner one."""
    a = strip(INNER.inner_radius_mm, INNER.outer_radius_mm, HEIGHT_MM, 4, 4, quadrilaterals=True)
    b = strip(OUTER.inner_radius_mm, OUTER.outer_radius_mm, HEIGHT_MM, 5, 3, quadrilaterals=True)
    mesh = joined(a, b)
    problem = make_problem(mesh, LAW, cavity=sides.cavity, held=((sides.bottom, 1), (sides.top, 1)))
    lines = [line_of(mesh, INNER.outer_radius_mm, -1.0), line_of(mesh, OUTER.inner_radius_mm, 1.0)]
    pairs = [Facing("tubes", 0, 1), Facing("tubes", 1, 0)]
    return SimpleNamespace(
        mesh=mesh,
        problem=problem,
        contact=Contact(problem.unknowns, mesh.points, lines, pairs, SETTINGS, boundary_edges(mesh)),
    )


def pressed(problem, path):
    """Reports and loads of a path's states that carry contact."""
    found = []
    for item in path.states:
        problem.set_state(item.state)
        (report,) = problem.contact.report()
        found.append((item, report))
    return found


# ---- exact answers -------------------------------------------------------------------------------------


def test_tube_in_a_rigid_bore_carries_what_the_exact_tube_leaves(tube_in_bore):
    problem = tube_in_bore.problem
    problem.contact = tube_in_bore.contact()
    alone = pressure_at_inner_radius_mpa(INNER, LAW, inner_radius_at_outer_mm(INNER, HOUSING_MM))
    path = follow_path(problem, Factor(problem), [0.5 * alone, 1.5 * alone, 3.0 * alone], PathSettings())
    assert path.reached, path.reason
    wall = 2.0 * np.pi * HOUSING_MM * HEIGHT_MM
    for item, report in pressed(problem, path):
        if not item.asked:
            continue
        exact = max(item.state.load_mpa - alone, 0.0) * wall
        assert report.force_n == pytest.approx(exact, rel=1e-3, abs=1e-12)
        assert report.gap_mm > -1e-2 * (INNER.outer_radius_mm - INNER.inner_radius_mm)
        assert item.newton.excess_negatives == 0


def test_penetration_falls_with_the_stiffness(tube_in_bore):
    problem = tube_in_bore.problem
    alone = pressure_at_inner_radius_mpa(INNER, LAW, inner_radius_at_outer_mm(INNER, HOUSING_MM))
    depths = []
    for stiffness in (5.0, 20.0, 80.0):
        settings = dataclasses.replace(SETTINGS, stiffness_mpa_per_mm=stiffness, smoothing_mm=1e-5)
        problem.contact = tube_in_bore.contact(settings)
        path = follow_path(problem, Factor(problem), [3.0 * alone], PathSettings())
        assert path.reached, path.reason
        depths.append(-pressed(problem, path)[-1][1].gap_mm)
    np.testing.assert_allclose(np.divide(depths[:-1], depths[1:]), 4.0, rtol=0.05)


def test_tube_in_tube_needs_the_pressures_of_both(tube_in_tube):
    problem = tube_in_tube.problem
    problem.contact = tube_in_tube.contact
    outer = 8.0  # where the two touch
    bore = inner_radius_at_outer_mm(INNER, outer)
    alone = pressure_at_inner_radius_mpa(INNER, LAW, bore)
    both = alone + pressure_at_inner_radius_mpa(OUTER, LAW, outer)
    path = follow_path(problem, Factor(problem), [both], PathSettings(first_step=0.05, largest_step=0.1))
    assert path.reached, path.reason
    last = path.states[-1]
    radius = INNER.inner_radius_mm + last.state.displacement_mm[column(tube_in_tube.mesh, INNER.inner_radius_mm), 0]
    np.testing.assert_allclose(radius, bore, rtol=2e-4)
    assert last.newton.excess_negatives == 0
    problem.set_state(last.state)
    (report,) = problem.contact.report()
    wall = 2.0 * np.pi * outer * HEIGHT_MM
    assert report.force_n == pytest.approx((both - alone) * wall, rel=2e-3)


def test_sphere_in_a_bowl_carries_what_the_exact_sphere_leaves(make_problem):
    sphere, bowl_mm, bore_mm = Sphere(5.0, 6.0), 7.0, 0.0
    mesh = sphere_meridian(5.0, 6.0, 8, 2, "quadrilaterals")
    held = ((FACETS["axis"], 0), (FACETS["bottom"], 1))
    problem = make_problem(mesh, LAW, cavity=FACETS["cavity"], held=held)
    nodes = np.flatnonzero(np.isclose(np.linalg.norm(mesh.points, axis=1), 6.0))
    nodes = nodes[np.argsort(mesh.points[nodes, 1])]
    line = Line(nodes, -1.0, np.ones(8, dtype=bool))
    pair = Against("bowl", 0, Bowl(bowl_mm), None, np.empty(0))
    problem.contact = Contact(problem.unknowns, mesh.points, [line], [pair], SETTINGS, boundary_edges(mesh))
    bore_mm = (bowl_mm**3 - 6.0**3 + 5.0**3) ** (1.0 / 3.0)
    assert sphere_radius_mm(sphere, bore_mm, 6.0) == pytest.approx(bowl_mm)
    alone = sphere_pressure_mpa(sphere, LAW, bore_mm)
    path = follow_path(problem, Factor(problem), [2.5 * alone], PathSettings())
    assert path.reached, path.reason
    item, report = pressed(problem, path)[-1]
    assert report.force_n == pytest.approx(1.5 * alone * 2.0 * np.pi * bowl_mm**2, rel=2e-3)
    assert item.newton.excess_negatives == 0


def test_pressure_work_is_stored_with_contact_too(tube_in_bore):
    problem = tube_in_bore.problem
    problem.contact = tube_in_bore.contact()
    alone = pressure_at_inner_radius_mpa(INNER, LAW, inner_radius_at_outer_mm(INNER, HOUSING_MM))
    asked = [0.98 * alone, 0.999 * alone, alone, *(alone * np.linspace(1.02, 2.0, 10))]  # the path has a kink there
    path = follow_path(problem, Factor(problem), asked, PathSettings(first_step=0.02, largest_step=0.02))
    assert path.reached, path.reason
    pressure = np.array([0.0] + [s.state.load_mpa for s in path.states])
    volume = np.array([np.pi * INNER.inner_radius_mm**2 * HEIGHT_MM] + [s.volume_mm3 for s in path.states])
    work = float(np.sum(0.5 * (pressure[1:] + pressure[:-1]) * np.diff(volume)))
    assert path.states[-1].energy_mj == pytest.approx(work, rel=2e-3)


def test_supports_carry_what_presses_on_them(strip, sides, make_problem):
    """A tube whose blocked rim grows into the rounded edge of a ring above it, and its clamped one into one below."""
    mesh = strip(INNER.inner_radius_mm, INNER.outer_radius_mm, HEIGHT_MM, 2, 8, quadrilaterals=True)
    problem = make_problem(mesh, LAW, cavity=sides.cavity, clamped=sides.bottom, blocked=sides.top)
    line = line_of(mesh, INNER.outer_radius_mm, -1.0)
    settings = dataclasses.replace(SETTINGS, limit_mm=0.1)

    def contact(shift_mm=0.0):
        above = RoundedBox(6.0, 8.0, 2.47 + shift_mm, 0.5, 0.4, 0.4)
        below = RoundedBox(6.02, 8.0, -0.15 + shift_mm, 0.5, 0.4, 0.4)
        pairs = [Against(name, 0, section, None, np.empty(0)) for name, section in (("above", above), ("below", below))]
        return Contact(problem.unknowns, mesh.points, [line], pairs, settings, boundary_edges(mesh))

    problem.contact = contact()
    path = follow_path(problem, Factor(problem), [0.05], PathSettings())
    assert path.reached, path.reason
    (item,) = [s for s in path.states if s.asked]
    problem.set_state(item.state)
    assert all(report.places for report in problem.contact.report())
    axial = problem.u_dofs[:, 1]
    # what the rings feel when they are moved along the axis, and the axial thrust of the pressure on the wall
    moved = [contact(sign * 1e-5).energy() for sign in (1.0, -1.0)]
    on_rings = -(moved[0] - moved[1]) / 2e-5
    thrust = item.state.load_mpa * problem.load.traction()[axial].sum()
    assert abs(problem.contact.force()[problem.unknowns.supports.blocked_axial].sum()) > 1e-2
    assert item.reaction_n + thrust == pytest.approx(item.end_force_n + on_rings, abs=1e-6)  # N; central difference


# ---- derivatives ---------------------------------------------------------------------------------------


def random_values(contact, size, seed=3):
    rng = np.random.default_rng(seed)
    return size * rng.standard_normal(contact._size) * contact._free


def set_values(problem, values):
    problem.state.x.array[: problem.owned] = values[: problem.owned]
    if problem.bonded is not None:
        problem.bonded.values[:] = values[problem.owned :].reshape(problem.bonded.values.shape)


def check_derivatives(problem, start):
    """Force and stiffness are the differences of energy and force along random directions."""
    contact = problem.contact
    set_values(problem, start)
    force, stiffness = contact.force(), contact._stiffness()
    assert np.abs(force).max() > 0.0
    assert abs(stiffness - stiffness.T).max() <= 1e-12 * abs(stiffness).max()
    for seed in (11, 12):
        way = random_values(contact, 1.0, seed)
        step = 1e-6
        ends = []
        for sign in (1.0, -1.0):
            set_values(problem, start + sign * step * way)
            ends.append((contact.energy(), contact.force()))
        slope = (ends[0][0] - ends[1][0]) / (2.0 * step)
        turn = (ends[0][1] - ends[1][1]) / (2.0 * step) * contact._free
        assert slope == pytest.approx(force @ way, rel=1e-6)
        np.testing.assert_allclose(turn, stiffness @ way, atol=2e-5 * np.abs(turn).max())


WIDE = ContactSettings(stiffness_mpa_per_mm=2.0, smoothing_mm=0.2, depth_mm=0.5, reach_mm=0.5, limit_mm=0.1)


def test_derivatives_between_two_lines(tube_in_tube):
    problem, old = tube_in_tube.problem, tube_in_tube.contact
    problem.contact = Contact(
        problem.unknowns, tube_in_tube.mesh.points, old.lines, old.pairs, WIDE, boundary_edges(tube_in_tube.mesh)
    )
    start = random_values(problem.contact, 0.01)
    inner = problem.u_dofs[np.argsort(problem.domain.input_node)][: 9 * 9, 0]
    start[inner] += 1.05 * problem.contact._free[inner]  # into the outer tube by 0.05
    check_derivatives(problem, start)


@pytest.mark.parametrize(
    "obstacle",
    [Bore(6.05), Bowl(6.5), RoundedBox(5.9, 8.0, 1.0, 0.7, 0.3, 0.5)],
    ids=lambda obstacle: type(obstacle).__name__,
)
def test_derivatives_against_rigid_sections(tube_in_bore, obstacle):
    problem = tube_in_bore.problem
    pair = Against("section", 0, obstacle, None, np.empty(0))
    nodes = column(tube_in_bore.mesh, INNER.outer_radius_mm)
    lines = [Line(nodes, -1.0, np.ones(4, dtype=bool))]
    problem.contact = Contact(
        problem.unknowns, tube_in_bore.mesh.points, lines, [pair], WIDE, boundary_edges(tube_in_bore.mesh)
    )
    check_derivatives(problem, random_values(problem.contact, 0.01))


def test_derivatives_with_moving_rings(bellows_problem):
    """Wall against rings that move, and rings against each other: forces on bodies and the wall balance."""
    case = bellows_problem(2)
    problem, mesh = case.problem, case.mesh
    (_, outside) = outlines(mesh)
    line = Line(outside.nodes, outside.side, np.ones((len(outside.nodes) - 1) // 2, dtype=bool))
    pairs: list[Against | Stop] = [
        Against("ring", 0, RoundedBox(11.0, 13.0, 13.0, 2.3, 0.2, 0.5), 1, np.empty(0)),
        Stop("rings", 0, 1, 0.3, 10.0),
    ]
    try:
        problem.contact = Contact(problem.unknowns, mesh.points, [line], pairs, WIDE, boundary_edges(mesh))
        start = random_values(problem.contact, 0.01)
        start[problem.owned + 1] -= 0.2  # the second ring towards the first
        check_derivatives(problem, start)
        force = problem.contact.force()
        axial = problem.u_dofs[:, 1]
        assert force[axial].sum() + force[problem.owned :].sum() == pytest.approx(0.0, abs=1e-12 * np.abs(force).max())
    finally:
        problem.contact = None


# ---- guards --------------------------------------------------------------------------------------------


def test_a_soft_penalty_is_refused_with_its_depth(tube_in_bore):
    problem = tube_in_bore.problem
    problem.contact = tube_in_bore.contact(dataclasses.replace(SETTINGS, stiffness_mpa_per_mm=0.1))
    alone = pressure_at_inner_radius_mpa(INNER, LAW, inner_radius_at_outer_mm(INNER, HOUSING_MM))
    path = follow_path(problem, Factor(problem), [3.0 * alone], PathSettings())
    assert not path.reached and path.cause is Cause.CONTACT
    assert "penetration" in path.reason
    assert path.states[-1].state.load_mpa < 3.0 * alone


def test_what_is_refused_where_contact_fades_out_is_reported_too(tube_in_bore):
    problem, mesh = tube_in_bore.problem, tube_in_bore.mesh
    line = line_of(mesh, INNER.outer_radius_mm, -1.0)
    # grade, depth that is accepted (that of the same pressure, five times as deep at most), depth of the state
    for grade, limit, depth in (
        (1.0, 0.01, 0.02),
        (0.25, 0.04, 0.02),
        (0.25, 0.04, 0.05),
        (1e-3, 0.05, 0.06),
        (0.0, 1, 0.06),
    ):
        pair = Against("housing", 0, Bore(HOUSING_MM), None, np.full((len(line.free), 5), grade))
        problem.contact = Contact(problem.unknowns, mesh.points, [line], [pair], SETTINGS, boundary_edges(mesh))
        values = np.zeros(problem.contact._size)
        values[problem.u_dofs[:, 0]] = HOUSING_MM - INNER.outer_radius_mm + depth
        set_values(problem, values)
        (report,) = problem.contact.report()
        assert report.gap_mm == (pytest.approx(-depth, abs=1e-9) if grade else np.inf)
        if depth > limit:
            with pytest.raises(StepFailed, match=rf"penetration of {depth} mm, more than {limit} mm"):
                problem.contact.check()
        else:
            problem.contact.check()


def test_a_line_beyond_another_is_seen_although_no_gap_is(tube_in_tube):
    problem = tube_in_tube.problem
    problem.contact = tube_in_tube.contact
    inner = problem.u_dofs[np.argsort(problem.domain.input_node)][: 9 * 9, 0]
    start = np.zeros(problem.contact._size)
    start[inner] = 2.0  # half into the outer tube's wall of 1.5 mm
    set_values(problem, start)
    assert not any(report.places for report in problem.contact.report())
    with pytest.raises(StepFailed, match="gone through another"):
        problem.contact.check()


def test_contact_in_3d_is_refused(bellows_problem):
    problem = bellows_problem(3).problem
    with pytest.raises(SolverError, match="on meridians"):
        Contact(problem.unknowns, np.zeros((1, 2)), [], [], SETTINGS, np.empty((0, 3), dtype=np.int64))


def test_the_unloaded_state_is_not_touched(tube_in_bore):
    problem = tube_in_bore.problem
    problem.contact = tube_in_bore.contact()
    problem.set_state(problem.zero_state())
    report = solve_equilibrium(problem, Factor(problem), NewtonSettings(), HeldLoad(0.0))
    assert report.iterations == 0
