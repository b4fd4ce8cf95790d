"""Elements beside P2/P1: orders on the exact tube, counts of pressure unknowns, patch test, and one that locks."""

from __future__ import annotations

import numpy as np
import pytest
import ufl

from analytical.exact.tube import Tube, hydrostatic_pressure_mpa, pressure_at_inner_radius_mpa, radial_displacement_mm
from analytical.laws.isotropic import Law, NeoHooke
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from meshes.cells import CellKind
from meshes.meridian import Resolution, meridian_mesh
from meshes.revolve import revolve
from meshes.solid import FACETS, SolidMesh
from meshes.sweep import revolve_hexahedra
from solvers.discrete.elements import P1_P0, P2_P0, P2_P1, Q2_P1, Element
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import SolverError
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from solvers.problem import Problem
from solvers.state import State, pressure_at_corners

TUBE = Tube(4.0, 6.0)
LAWS: dict[str, Law] = {"yeoh": DRAGON_SKIN_10, "ogden": dragon_skin_30("2mu/alpha^2")}
BORE = {"yeoh": 8.0, "ogden": 6.4}  # mm, deformed
SETTINGS = NewtonSettings(relative_tolerance=1e-10, max_iterations=25)
every_law = pytest.mark.parametrize("name", LAWS)


def radius_of(x: np.ndarray) -> np.ndarray:
    return x[..., 0] if x.shape[-1] == 2 else np.hypot(x[..., 0], x[..., 1])


def displacement(name: str):
    def at(x: np.ndarray) -> np.ndarray:
        out = np.zeros_like(x)
        r = radius_of(x)
        plane = x.shape[-1] - 1
        out[..., :plane] = (radial_displacement_mm(TUBE, BORE[name], r) / r)[..., None] * x[..., :plane]
        return out

    return at


def pressure(name: str):
    return lambda x: -hydrostatic_pressure_mpa(TUBE, LAWS[name], BORE[name], radius_of(x))


def guess(mesh: SolidMesh, problem: Problem, name: str) -> State:
    p = pressure(name)(mesh.points)
    if len(problem.unknowns.pressure_shape) == 2:
        p = p[mesh.cells[:, : mesh.cell.corners]]
    load = pressure_at_inner_radius_mpa(TUBE, LAWS[name], BORE[name])
    return State(displacement(name)(mesh.points), p, np.zeros((0, 0)), load)


@pytest.fixture(scope="module")
def flat_tube(strip, sides, make_problem):
    def make(n: int, law: Law, element: Element, inverse_kappa: float = 0.0) -> tuple[SolidMesh, Problem]:
        mesh = strip(TUBE.inner_radius_mm, TUBE.outer_radius_mm, 2.0, n, n, 0.08, element is Q2_P1)
        held = ((sides.bottom, 1), (sides.top, 1))
        return mesh, make_problem(mesh, law, inverse_kappa, cavity=sides.cavity, held=held, element=element)

    return make


@pytest.fixture(scope="module")
def round_tube(strip, sides, make_problem):
    """A quarter in hexahedra between planes of symmetry, its cells curved inside too."""

    def make(n: int, law: Law, element: Element = Q2_P1) -> tuple[SolidMesh, Problem]:
        flat = strip(TUBE.inner_radius_mm, TUBE.outer_radius_mm, 1.0, n, max(1, n // 2), 0.08, True)
        mesh = revolve_hexahedra(flat, 2 * n, 0.5 * np.pi)
        held = ((sides.bottom, 2), (sides.top, 2), (FACETS["start"], 1), (FACETS["end"], 0))
        return mesh, make_problem(mesh, law, cavity=sides.cavity, held=held)

    return make


def orders(make, name: str, element: Element, levels, rms_errors) -> np.ndarray:
    """Orders of (u, p) in L2 between successive meshes, each half as coarse."""
    errors = []
    for n in levels:
        mesh, problem = make(n, LAWS[name], element)
        start = guess(mesh, problem, name)
        problem.set_state(start)
        report = solve_equilibrium(problem, Factor(problem), SETTINGS, HeldLoad(start.load_mpa))
        assert report.excess_negatives == 0
        errors.append(rms_errors(mesh, problem.get_state(), displacement(name), pressure(name)))
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


@every_law
def test_orders_of_quadrilaterals(flat_tube, rms_errors, name: str) -> None:
    found = orders(flat_tube, name, Q2_P1, (4, 8, 16), rms_errors)
    # theory: 3 and 2; asked 2.9 and 1.9; measured 3.28 to 3.41 and 1.93 to 1.98
    assert found[:, 0].min() >= 2.9, found
    assert found[:, 1].min() >= 1.9, found


@every_law
def test_orders_of_hexahedra(round_tube, rms_errors, name: str) -> None:
    found = orders(round_tube, name, Q2_P1, (2, 4, 8), rms_errors)
    # asked of the finer pair, as for tetrahedra: measured 3.1 and 1.93
    assert found[-1, 0] >= 2.9, found
    assert found[-1, 1] >= 1.9, found


def test_orders_of_a_constant_pressure(flat_tube, rms_errors) -> None:
    found = orders(flat_tube, "yeoh", P2_P0, (4, 8, 16), rms_errors)
    # theory: 2 and 1, the pressure limits both; measured 1.97 and 0.97 and more
    assert found[:, 0].min() >= 1.9, found
    assert found[:, 1].min() >= 0.9, found


def rms_jump(mesh: SolidMesh, values: np.ndarray) -> float:
    """Difference of the cells' pressures, (cells, corners), at a corner that they share: root mean square, MPa."""
    corners = mesh.cells[:, : mesh.cell.corners]
    low, high = np.full(len(mesh.points), np.inf), np.full(len(mesh.points), -np.inf)
    np.minimum.at(low, corners, values)
    np.maximum.at(high, corners, values)
    return float(np.sqrt(((high - low)[np.isfinite(low)] ** 2).mean()))


@pytest.mark.parametrize("element", [Q2_P1, P2_P0], ids=lambda e: e.name)
def test_pressures_of_neighbouring_cells_meet_as_the_mesh_is_refined(flat_tube, element: Element) -> None:
    jumps = []
    for n in (8, 16, 32):
        mesh, problem = flat_tube(n, LAWS["yeoh"], element)
        start = guess(mesh, problem, "yeoh")
        problem.set_state(start)
        solve_equilibrium(problem, Factor(problem), SETTINGS, HeldLoad(start.load_mpa))
        jumps.append(rms_jump(mesh, problem.get_state().pressure_mpa))
    # a checkerboard would stay; theory 2 for constants, 4 for linear pressures; asked 1.8 of the finer pair: constants,
    # whose jumps at the boundary are between fewer cells, give 1.76 and 1.87
    assert jumps[0] / jumps[1] > 1.6, jumps
    assert jumps[1] / jumps[2] > 1.8, jumps


@pytest.mark.parametrize(
    ("degree", "pressure", "cell"),
    [
        (1, "continuous", "triangle"),
        (1, "continuous", "hexahedron"),
        (1, "linear", "quadrilateral"),
        (2, "linear", "tetrahedron"),
    ],
)
def test_pairs_whose_pressures_oscillate_are_refused(degree: int, pressure, cell: str) -> None:
    with pytest.raises(SolverError, match=f"unstable on a {cell}: take one of P2/P1"):
        Element("trial", degree, pressure).spaces(ufl.Cell(cell))


@pytest.fixture(scope="module")
def elongation(one_convolution, make_problem):
    """Tip of a bellows of one convolution at 2 kPa, kappa / mu = 1e4, mm."""

    def solve(element: Element, refinement: int) -> float:
        cells: CellKind = "quadrilaterals" if element is Q2_P1 else "triangles"
        mesh = meridian_mesh(one_convolution, Resolution(2, 1.0, 0.8, 2, refinement), cells=cells)
        problem = make_problem(
            mesh,
            DRAGON_SKIN_10,
            1e-4 / DRAGON_SKIN_10.initial_shear_modulus_mpa,
            cavity=FACETS["cavity"],
            clamped=FACETS["clamped"],
            held=((FACETS["axis"], 0),),
            element=element,
        )
        path = follow_path(problem, Factor(problem), [0.002], PathSettings())
        assert path.reached, path.reason
        rim = np.unique(mesh.facets[mesh.facet_tags == FACETS["tip"]])
        return float(path.states[-1].state.displacement_mm[rim, 1].mean())

    return solve


def test_plain_displacements_lock_and_the_others_do_not(elongation) -> None:
    best = elongation(Q2_P1, 4)
    found = {e.name: np.array([elongation(e, 1), elongation(e, 2)]) / best for e in (Q2_P1, P2_P1, P2_P0, P1_P0)}
    # measured: 7e-4 and 2e-5 short, 3e-4 short and 6e-5 beyond, 1.6 and 0.4 % beyond
    assert found[Q2_P1.name] == pytest.approx(1.0, abs=1e-3)
    assert found[P2_P1.name] == pytest.approx(1.0, abs=1e-3)
    assert found[P2_P0.name] == pytest.approx([1.0, 1.0], abs=2e-2)
    assert found[P2_P0.name][1] == pytest.approx(1.0, abs=6e-3)
    # four times the cells, and still half the way: measured 0.50 and 0.52
    assert found[P1_P0.name].max() < 0.6, found


CELLS = [(Q2_P1, 2), (Q2_P1, 3), (P2_P0, 2), (P2_P0, 3), (P1_P0, 2)]
every_cell = pytest.mark.parametrize(("element", "dimension"), CELLS)


@pytest.fixture(scope="module")
def small(strip, sides, make_problem):
    """A ring of a few curved cells between planes, its bottom clamped: the pressure has a potential."""

    def make(element: Element, dimension: int) -> tuple[SolidMesh, Problem]:
        mesh = strip(5.0, 6.5, 2.0, 2, 1, 0.1, element is Q2_P1)
        if dimension == 3:
            mesh = revolve_hexahedra(mesh, 6) if element is Q2_P1 else revolve(mesh, 6)
        held = ((sides.top, dimension - 1),)
        surfaces = {"cavity": sides.cavity, "clamped": sides.bottom, "held": held}
        return mesh, make_problem(mesh, DRAGON_SKIN_10, element=element, **surfaces)

    return make


def disturb(problem: Problem, seed: int) -> None:
    """Noise with det F of about 0.5 to 1.6, under pressure."""
    x = problem.state.x.array
    x[:] = np.where(problem.owned_pressure, 0.05, 0.02) * np.random.default_rng(seed).standard_normal(len(x))
    x[problem.constrained_owned] = 0.0
    problem.pressure.value = 0.02


@every_cell
def test_one_negative_pivot_is_expected_per_pressure_unknown(small, element: Element, dimension: int) -> None:
    mesh, problem = small(element, dimension)
    per_cell = 1 if element.pressure == "constant" else dimension + 1
    assert problem.expected_negatives == per_cell * len(mesh.cells)
    if element is not P1_P0:  # more pressures than displacements: singular when incompressible
        factor = Factor(problem)
        factor.refresh()
        assert factor.negatives == problem.expected_negatives


@every_cell
def test_states_survive_the_way_out_and_back(small, element: Element, dimension: int) -> None:
    mesh, problem = small(element, dimension)
    disturb(problem, 1)
    before = problem.state.x.array.copy()
    state = problem.get_state()
    problem.set_state(state)
    # the corner values are fitted by polynomials of the space they come from: round-off
    assert problem.state.x.array == pytest.approx(before, abs=1e-13)
    with pytest.raises(SolverError, match="pressures of shape"):
        problem.set_state(State(state.displacement_mm, np.zeros(3), state.bodies_mm, 0.0))


def test_linear_displacements_are_given_at_every_node(small) -> None:
    mesh, problem = small(P1_P0, 2)
    u = mesh.points @ np.array([[0.1, 0.2], [0.0, -0.1]])
    u[np.isclose(mesh.points[:, 1], 0.0)] = 0.0
    u[np.isclose(mesh.points[:, 1], mesh.points[:, 1].max()), 1] = 0.0
    problem.set_state(State(u, np.zeros(problem.unknowns.pressure_shape), np.zeros((0, 0)), 0.0))
    found = problem.get_state().displacement_mm
    corners = mesh.cells[:, :3]
    assert found[corners] == pytest.approx(u[corners], abs=1e-15)
    middle = 0.5 * (u[corners[:, 1]] + u[corners[:, 2]])
    assert found[mesh.cells[:, 3]] == pytest.approx(middle, abs=1e-15)


@pytest.mark.parametrize(("element", "dimension"), CELLS[:-1])
def test_tangent_is_the_difference_of_residuals(small, element: Element, dimension: int) -> None:
    _, problem = small(element, dimension)
    disturb(problem, 2)
    matrix = problem.new_matrix()
    problem.assemble_tangent(matrix)
    way = 0.1 * np.random.default_rng(3).standard_normal(problem.owned)
    way[problem.constrained_owned] = 0.0
    vector, product = matrix.createVecs()
    vector.array[:] = way
    matrix.mult(vector, product)
    start = problem.state.x.array.copy()

    def residual(h: float) -> np.ndarray:
        problem.state.x.array[:] = start + h * way
        force = problem.internal_force()[0] - float(problem.pressure.value) * problem.load.gradient()
        force[problem.constrained_owned] = 0.0
        return force

    errors = []
    for h in (1e-3, 1e-4, 1e-5):
        difference = (residual(h) - residual(-h)) / (2.0 * h)
        errors.append(np.linalg.norm(product.array - difference) / np.linalg.norm(difference))
    # central differences: h^2; less of the last, near round-off
    assert errors[0] / errors[1] > 95.0
    assert errors[1] / errors[2] > 20.0
    assert errors[2] < 1e-8
    assert (matrix - matrix.copy().transpose()).norm() < 1e-14 * matrix.norm()  # round-off


def test_potential_is_the_traction_between_planes_of_symmetry(round_tube) -> None:
    mesh, problem = round_tube(2, DRAGON_SKIN_10)
    rng = np.random.default_rng(4)
    u = 0.3 * mesh.points @ rng.standard_normal((3, 3)) + 0.1 * rng.standard_normal(mesh.points.shape)
    problem.set_state(State(u, np.zeros(problem.unknowns.pressure_shape), np.zeros((0, 0)), 0.0))
    traction = problem.load.traction()
    way = rng.standard_normal((5, problem.owned)) * ~problem.constrained_owned
    gap = (way @ (problem.load.gradient() - traction)) / (np.abs(way) @ np.abs(traction))
    # Gauss' rule of degree 5 integrates both exactly: round-off
    assert np.abs(gap).max() < 1e-13


@pytest.mark.parametrize("dimension", [2, 3])
def test_homogeneous_state_is_reproduced(strip, sides, make_problem, dimension: int) -> None:
    mesh = strip(2.0, 3.5, 2.0, 2, 2, 0.1, True)
    if dimension == 3:
        mesh = revolve_hexahedra(mesh, 8)
    law = NeoHooke(0.1)
    problem = make_problem(mesh, law, cavity=sides.cavity)
    stretch = 1.7
    u = mesh.points * (np.append(np.full(dimension - 1, stretch**-0.5), stretch) - 1.0)
    # radial stress is zero: p = -mu lambda_r^2 (less its mean, which the split energy takes out)
    p = -law.mu_mpa * (stretch**-1.0 - (2.0 * stretch**-1.0 + stretch**2) / 3.0)
    problem.set_state(State(u, np.full(problem.unknowns.pressure_shape, p), np.zeros((0, 0)), 0.0))
    force, _ = problem.internal_force()
    ends = np.isclose(mesh.points[:, -1], 0.0) | np.isclose(mesh.points[:, -1], 2.0)
    free = problem.u_dofs[~ends[problem.domain.input_node]].ravel()
    # a state without radial stress: forces only on the ends, round-off of 0.1 MPa over some mm^2
    assert np.abs(force[free]).max() < 1e-13
    assert np.abs(force[problem.p_dofs.ravel()]).max() < 1e-13
    corners = pressure_at_corners(problem.get_state(), mesh.cells, mesh.cell.corners)
    assert corners[mesh.corners] == pytest.approx(p, rel=1e-12)
