"""Loss of stability is found without being told where: limit point, buckling, and many modes at once."""

from __future__ import annotations

import dataclasses
import itertools
import math
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.polynomial import chebyshev, legendre
from scipy.optimize import brentq, minimize_scalar

from analytical.laws.isotropic import NeoHooke, Yeoh
from meshes.cells import TETRAHEDRON_EDGES
from meshes.revolve import revolve
from meshes.solid import SolidMesh
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathMemory, PathPoint, PathSettings
from solvers.state import State

MU = 0.1

# ---- limit point of a sphere ---------------------------------------------------------------------------

INNER, OUTER = 5.0, 6.5


def sphere_pressure(inner_stretch: float) -> float:
    """Closed form for neo-Hooke: mu/2 [4/l + 1/l^4] between the outer and the inner stretch."""
    outer_stretch = (1.0 + (INNER / OUTER) ** 3 * (inner_stretch**3 - 1.0)) ** (1.0 / 3.0)
    a, b = inner_stretch, outer_stretch
    return 0.5 * MU * ((4.0 / b + b**-4) - (4.0 / a + a**-4))


LIMIT = minimize_scalar(lambda l: -sphere_pressure(l), bounds=(1.1, 3.0), method="bounded")


@pytest.fixture(scope="module")
def make_sphere(strip, sides, make_problem):
    """Meridian of the upper half: a strip bent round, its bottom the equator and its top the axis."""
    flat = strip(INNER, OUTER, 1.0, 2, 8)
    radius, angle = flat.points[:, 0], 0.5 * np.pi * flat.points[:, 1]
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    points[np.abs(points) < 1e-12] = 0.0
    mesh = dataclasses.replace(flat, points=points)

    def make(law) -> SimpleNamespace:
        problem = make_problem(mesh, law, cavity=sides.cavity, held=((sides.bottom, 1), (sides.top, 0)))
        return SimpleNamespace(problem=problem, factor=Factor(problem))

    return make


@pytest.fixture(scope="module")
def sphere(make_sphere) -> SimpleNamespace:
    return make_sphere(NeoHooke(MU))


@pytest.mark.parametrize("control", ["auto", "volume"])
def test_limit_point_of_a_sphere_is_found_by_volume(sphere, control) -> None:
    settings = PathSettings(control=control, largest_volume=15.0)
    path = follow_path(sphere.problem, sphere.factor, [1.2 * -LIMIT.fun], settings)
    assert not path.reached
    assert path.cause is Cause.LIMIT_POINT
    crossing = path.crossing
    assert crossing is not None and crossing.kind is Cause.LIMIT_POINT
    assert (crossing.modes_before, crossing.modes_after) == (0, 1)
    # asked 0.5 %; the pressure of the mesh is right to 1e-4 and stationary here
    assert crossing.pressure_mpa == pytest.approx(-LIMIT.fun, rel=1e-4)
    rest = sphere.problem.volume_unit_mm3
    # the maximum is flat: 1e-3 of the interval in volume, and what 1e-4 of pressure does to it
    assert (crossing.volume_mm3 / rest) ** (1.0 / 3.0) == pytest.approx(LIMIT.x, rel=1e-2)
    assert f"limit point at {1e3 * crossing.pressure_mpa:.6g} kPa" in path.reason
    # at a limit point the mode is the way the path goes: a uniform swelling
    assert crossing.mode is not None
    u, x = crossing.mode.displacement_mm, sphere.problem.domain.mesh.geometry.x
    assert np.abs(u).max() == pytest.approx(1.0)
    inner = np.abs(np.linalg.norm(x[:, :2], axis=1) - INNER) < 1e-6
    nodes = sphere.problem.domain.input_node[inner]
    assert np.ptp(np.linalg.norm(u[nodes], axis=1)) < 1e-2


def test_pressure_control_stops_below_the_limit_and_names_it(sphere) -> None:
    path = follow_path(sphere.problem, sphere.factor, [1.2 * -LIMIT.fun], PathSettings(control="pressure"))
    assert not path.reached
    assert path.cause is Cause.LIMIT_POINT
    assert path.states[-1].state.load_mpa <= -LIMIT.fun * 1.0001  # discretisation
    assert all(s.newton.excess_negatives == 0 and s.control == "pressure" for s in path.states)
    named = float(path.reason.split("limit point near ")[1].split(" kPa")[0])
    # extrapolated from the slopes of the last two states; asked 0.5 %
    assert named == pytest.approx(-1e3 * LIMIT.fun, rel=5e-3)
    assert 'control = "auto"' in path.reason


def test_auto_leaves_pressure_control_before_the_limit_point_and_passes_it(sphere) -> None:
    settings = PathSettings(start_control="pressure", largest_volume=15.0)
    path = follow_path(sphere.problem, sphere.factor, [1.2 * -LIMIT.fun], settings)
    controls = [s.control for s in path.states]
    assert controls[0] == "pressure" and controls[-1] == "volume"
    assert path.crossing is not None
    assert path.crossing.pressure_mpa == pytest.approx(-LIMIT.fun, rel=1e-4)  # as above
    assert path.states[-1].newton.excess_negatives == 1


def test_snap_through_is_never_jumped_over(make_sphere) -> None:
    # stiffens after its limit point: 36 kPa has a state on the far branch only, at 14 times the volume
    snap = make_sphere(Yeoh((0.5 * MU, 0.0, 2e-4)))
    path = follow_path(snap.problem, snap.factor, [0.020, 0.036], PathSettings(control="pressure"))
    assert path.cause is Cause.LIMIT_POINT
    assert max(s.volume_mm3 for s in path.states) < 5.0 * snap.problem.volume_unit_mm3
    named = float(path.reason.split("limit point near ")[1].split(" kPa")[0])
    for start in ("pressure", "volume"):
        path = follow_path(snap.problem, snap.factor, [0.020, 0.036], PathSettings(start_control=start))
        assert path.reached
        assert path.crossing is not None and path.crossing.kind is Cause.LIMIT_POINT
        assert named == pytest.approx(1e3 * path.crossing.pressure_mpa, rel=5e-3)  # extrapolated, as above
        counts = [s.newton.excess_negatives for s in path.states]
        assert 1 in counts and counts[0] == counts[-1] == 0


# ---- buckling of a ring --------------------------------------------------------------------------------


def ring_buckling_pressure(a: float, b: float, n: int, degree: int = 14) -> float:
    """Follower pressure on the outside of an incompressible neo-Hookean ring in plane strain at which mode n appears.

    Rayleigh and Ritz in the deformed ring, r^2 = R^2 - c: isochoric perturbations from a stream function
    ``psi(r) sin(n t)``, ``u_r = n psi / r cos(n t)``, ``u_t = -psi' sin(n t)``, psi a polynomial. Second variation

        int [ mu tr(h B h') - q tr(h h) ] dA  +  P d2A(outside),   h = grad u, q the pressure in the solid,

    with ``B = diag(R^2/r^2, r^2/R^2)``, and ``d2A = oint (u_r^2 + u_t^2 + u_r u_t' - u_t u_r') dt`` per unit.
    """
    x, w = legendre.leggauss(40)

    def lowest(c: float) -> tuple[float, float]:
        inner, outer = np.sqrt(a * a - c), np.sqrt(b * b - c)
        r = 0.5 * (outer + inner) + 0.5 * (outer - inner) * x
        weight = 0.5 * (outer - inner) * w

        def big(s):
            return s * s + c

        def gradient_of_radial_stress(s):  # d sigma_r / dr = mu (B_t - B_r) / r
            return MU * (s * s / big(s) - big(s) / (s * s)) / s

        def radial_stress(s):  # from the free inside
            t = 0.5 * (s + inner) + 0.5 * (s - inner) * x
            return 0.5 * (s - inner) * w @ gradient_of_radial_stress(t)

        pressure = -radial_stress(outer)
        b_r, b_t = big(r) / r**2, r**2 / big(r)
        q = np.array([radial_stress(s) for s in r]) - MU * b_r  # sigma = mu B + q I
        at = (2.0 * r - outer - inner) / (outer - inner)
        scale = 2.0 / (outer - inner)
        basis = np.eye(degree + 1)
        psi, d1, d2 = (
            np.array([chebyshev.chebval(at, chebyshev.chebder(row, k) if k else row) for row in basis]) * scale**k
            for k in range(3)
        )
        # h in cos (rr, tt) and sin (rt, tr); the integrals over t give pi each
        h_rr = n * (d1 / r - psi / r**2)
        h_tt = -h_rr
        h_tr = -d2
        h_rt = -(n * n) * psi / r**2 + d1 / r

        def form(f, g, factor):
            return np.einsum("iq,jq,q->ij", f, g, factor * weight * r)

        k = form(h_rr, h_rr, MU * b_r) + form(h_rt, h_rt, MU * b_t) + form(h_tr, h_tr, MU * b_r)
        k += form(h_tt, h_tt, MU * b_t)
        k -= form(h_rr, h_rr, q) + form(h_tt, h_tt, q) + form(h_rt, h_tr, q) + form(h_tr, h_rt, q)
        edge = np.ones(degree + 1)  # Chebyshev polynomials at the outer radius
        edge1 = scale * np.arange(degree + 1.0) ** 2
        u_r, u_t = n * edge / outer, -edge1
        k += pressure * (
            np.outer(u_r, u_r) + np.outer(u_t, u_t) + n * 0.5 * (np.outer(u_r, u_t) + np.outer(u_t, u_r)) * 2.0
        )
        return float(np.linalg.eigvalsh(k)[0]), float(pressure)

    c = brentq(lambda c: lowest(c)[0], 1e-3, 0.2 * a * a)
    return lowest(c)[1]


def test_check_value_of_the_ring_tends_to_the_thin_ring() -> None:
    # thin rings: (n^2 - 1) E' t^3 / (12 R^3) with E' = 4 mu; terms of t / R are left out
    for thickness in (0.2, 0.1):
        a, b = 10.0 - 0.5 * thickness, 10.0 + 0.5 * thickness
        thin = 3.0 * 4.0 * MU * thickness**3 / (12.0 * 10.0**3)
        assert ring_buckling_pressure(a, b, 2) == pytest.approx(thin, rel=2.0 * thickness / 10.0)


@pytest.mark.parametrize("control", ["auto", "pressure"])
def test_buckling_of_a_quarter_ring_under_outside_pressure_is_found(
    strip, quarter, sides, make_problem, control
) -> None:
    inner, outer = 10.0, 12.0
    exact = ring_buckling_pressure(inner, outer, 2)
    mesh: SolidMesh = quarter(revolve(strip(inner, outer, 1.0, 2, 1), 48))
    level = ((sides.bottom, 2), (sides.top, 2), (sides.x_plane, 0), (sides.y_plane, 1))
    problem = make_problem(mesh, NeoHooke(MU), external=sides.outer, held=level)
    assert problem.conservative
    factor = Factor(problem)
    path = follow_path(problem, factor, [2.0 * exact], PathSettings(control=control))
    crossing = path.crossing
    assert crossing is not None and crossing.kind is Cause.BIFURCATION
    assert (crossing.modes_before, crossing.modes_after) == (0, 1)
    assert crossing.within_mpa < 1e-5 * exact
    # asked 1 %; measured -0.46 % with 32 cells round and -0.20 % with 48
    assert crossing.pressure_mpa == pytest.approx(exact, rel=3e-3)
    # the mode is u_r = cos 2t on the outside, but for the discretisation of a quarter wave in twelve cells
    assert crossing.mode is not None
    u, x = crossing.mode.displacement_mm, mesh.points
    rim = np.abs(np.hypot(x[:, 0], x[:, 1]) - outer) < 1e-6
    angle = np.arctan2(x[rim, 1], x[rim, 0])
    radial = u[rim, 0] * np.cos(angle) + u[rim, 1] * np.sin(angle)
    amplitude = radial @ np.cos(2.0 * angle) / (np.cos(2.0 * angle) @ np.cos(2.0 * angle))
    assert np.abs(radial - amplitude * np.cos(2.0 * angle)).max() < 0.02 * abs(amplitude)


def test_dead_pressure_on_the_ring_would_buckle_it_later(strip, quarter, sides, make_problem) -> None:
    mesh: SolidMesh = quarter(revolve(strip(10.0, 12.0, 1.0, 2, 1), 32))
    level = ((sides.bottom, 2), (sides.top, 2), (sides.x_plane, 0), (sides.y_plane, 1))
    problem = make_problem(mesh, NeoHooke(MU), dead=sides.outer, held=level)
    factor = Factor(problem)
    follower = ring_buckling_pressure(10.0, 12.0, 2)
    low, high = 1.0 * follower, 1.3 * follower
    for pressure in np.linspace(0.2, 1.0, 5) * follower:
        report = solve_equilibrium(problem, factor, NewtonSettings(), HeldLoad(-pressure))
    assert report.excess_negatives == 0
    for _ in range(8):
        middle = 0.5 * (low + high)
        report = solve_equilibrium(problem, factor, NewtonSettings(), HeldLoad(-middle))
        low, high = (middle, high) if report.excess_negatives == 0 else (low, middle)
    # the control: 4/3 for thin rings, 12 % at 10/12 mm by earlier calculations; measured 11.2 %, of which this mesh
    # takes 0.5 off
    assert 1.10 < high / follower < 1.14


# ---- Rivlin's cube -------------------------------------------------------------------------------------


def cube_mesh(count: int, boundary_of) -> SolidMesh:
    """Cube of 1 mm, six quadratic tetrahedra in each of count^3 boxes; all its faces have the tag 1."""
    line = np.arange(2 * count + 1)
    grid = np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1).reshape(-1, 3)
    size = len(line)
    corners = []
    for order in itertools.permutations(range(3)):  # Kuhn: the ways from one corner of a box to the opposite one
        way = np.zeros((4, 3), dtype=np.int64)
        for k, axis in enumerate(order):
            way[k + 1] = way[k]
            way[k + 1, axis] += 2
        corners.append(way)
    boxes = 2 * np.stack(np.meshgrid(*[np.arange(count)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    at = np.concatenate([boxes[:, None, :] + way[None] for way in corners])
    middles = np.stack([(at[:, i] + at[:, j]) // 2 for i, j in TETRAHEDRON_EDGES], axis=1)
    cells = np.concatenate([at, middles], axis=1) @ np.array([size * size, size, 1])
    facets = boundary_of(cells, 3)
    tags = np.ones(len(facets), dtype=np.int64)
    points = grid / (2.0 * count)
    return SolidMesh(points, cells, np.ones(len(cells), dtype=np.int64), facets, tags, -tags, 0)


def test_rivlins_cube_loses_many_modes_at_once_at_twice_its_shear_modulus(boundary_of, make_problem) -> None:
    mesh = cube_mesh(2, boundary_of)
    # one node held: the load is in equilibrium, so this costs nothing; the tension itself holds the rotations
    problem = make_problem(mesh, NeoHooke(MU), dead=1, pinned=((0, 0), (0, 1), (0, 2)))
    assert problem.conservative
    factor = Factor(problem)
    # unloaded it is free to turn, so the path starts under tension: no displacement, p = T, stable
    under = State(np.zeros((len(mesh.points), 3)), np.full(len(mesh.points), 0.5 * MU), np.zeros((0, 0)), 0.5 * MU)
    start = PathPoint(under, 0.0, math.nan, 0)
    memory = PathMemory((start,), "pressure", 0.3 * MU, 0, 0, 0.0, None)
    path = follow_path(problem, factor, [1.3 * MU, 2.5 * MU], PathSettings(), resume=memory)
    assert path.reached and path.rejected == 0
    crossing = path.crossing
    assert crossing is not None
    assert crossing.kind is Cause.BIFURCATION
    # homogeneous: exact on this mesh but for the tolerance of the bisection, 1e-5; asked 1e-3
    assert crossing.pressure_mpa == pytest.approx(2.0 * MU, rel=1e-5)
    assert crossing.modes_before == 0
    # gradients of harmonic polynomials: 5 of degree two and 7 of degree three are quadratic displacements; asked 5
    assert crossing.modes_after == 12
    assert crossing.mode is not None
    u, x = crossing.mode.displacement_mm, mesh.points - mesh.points[0]
    # one of them, so its linear part is symmetric and has no trace
    terms = np.stack([x[:, i] for i in range(3)] + [x[:, i] * x[:, j] for i in range(3) for j in range(i + 1)], axis=1)
    fit, *_ = np.linalg.lstsq(terms, u, rcond=None)
    # inverse iteration ends when the stiffness, of second order in the mode, stands to 1e-6
    assert np.abs(terms @ fit - u).max() < 1e-3
    slope = fit[:3]
    assert np.abs(slope - slope.T).max() < 5e-3
    assert abs(np.trace(slope)) < 5e-3


def test_volume_control_says_that_the_cube_has_no_volume_to_control(boundary_of, make_problem) -> None:
    mesh = cube_mesh(1, boundary_of)
    problem = make_problem(mesh, NeoHooke(MU), dead=1, pinned=((0, 0), (0, 1), (0, 2)))
    under = State(np.zeros((len(mesh.points), 3)), np.full(len(mesh.points), 0.5 * MU), np.zeros((0, 0)), 0.5 * MU)
    start = PathPoint(under, 0.0, math.nan, 0)
    memory = PathMemory((start,), "volume", 0.1, 0, 0, 0.0, None)
    path = follow_path(problem, Factor(problem), [MU], PathSettings(control="volume"), resume=memory)
    assert path.cause is Cause.NO_RESPONSE
    assert 'use control = "pressure"' in path.reason
    path = follow_path(problem, Factor(problem), [MU], PathSettings(), resume=memory)
    assert path.reached and path.rejected == 1
    assert [s.control for s in path.states] == ["pressure"] * len(path.states)
