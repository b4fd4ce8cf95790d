"""Contact against exact answers: a tube in a rigid bore, a tube in a tube, and the derivatives of the gap."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from analytical.materials import DRAGON_SKIN_10
from analytical.tube import Tube, inner_radius_at_outer_mm, pressure_at_inner_radius_mpa
from meshes.boundary import boundary_edges
from solvers.contact import Against, Contact, ContactSettings, Facing, Line
from solvers.linear import Factor
from solvers.newton import NewtonSettings, solve_equilibrium
from solvers.obstacles import Bore, Bowl, RoundedBox
from solvers.path import PathSettings, follow_path

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
        return Contact(problem, mesh.points, [line], [pair], settings, boundary_edges(mesh))

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
    return SimpleNamespace(mesh=mesh, problem=problem, contact=Contact(problem, mesh.points, lines, pairs, SETTINGS, boundary_edges(mesh)))


def test_tube_in_a_rigid_bore_carries_what_the_exact_tube_leaves(tube_in_bore):
    problem = tube_in_bore.problem
    problem.contact = tube_in_bore.contact()
    touching = inner_radius_at_outer_mm(INNER, HOUSING_MM)
    alone = pressure_at_inner_radius_mpa(INNER, LAW, touching)
    asked = [0.5 * alone, 1.5 * alone, 3.0 * alone]
    path = follow_path(problem, Factor(problem), asked, PathSettings())
    assert path.reached, path.reason
    area = 2.0 * np.pi * INNER.outer_radius_mm * HEIGHT_MM
    forces = []
    for item in path.states:
        if item.asked:
            problem.set_state(item.state)
            (report,) = problem.contact.report()
            forces.append(report.force_n)
            assert report.gap_mm > -0.01 * 1.0
            assert item.newton.excess_negatives == 0
    # the bore's pressure acts on the deformed area, the force is that on the undeformed one times t
    exact = [0.0] + [(p - alone) * area * HOUSING_MM / INNER.outer_radius_mm for p in asked[1:]]
    assert forces[0] == 0.0
    np.testing.assert_allclose(forces[1:], exact[1:], rtol=1e-2)


def test_tube_in_tube_needs_the_pressures_of_both(tube_in_tube):
    problem = tube_in_tube.problem
    problem.contact = tube_in_tube.contact
    outer = 8.0  # where the two touch
    bore = inner_radius_at_outer_mm(INNER, outer)
    exact = pressure_at_inner_radius_mpa(INNER, LAW, bore) + pressure_at_inner_radius_mpa(OUTER, LAW, outer)
    path = follow_path(problem, Factor(problem), [exact], PathSettings(first_step=0.05, largest_step=0.1))
    assert path.reached, path.reason
    last = path.states[-1]
    radius = INNER.inner_radius_mm + last.state.displacement_mm[column(tube_in_tube.mesh, INNER.inner_radius_mm), 0]
    np.testing.assert_allclose(radius, bore, rtol=1e-3)
    assert last.newton.excess_negatives == 0
