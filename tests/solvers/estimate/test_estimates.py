"""Estimated errors: exact to leading order where the problem is linear, near to true ones of exact bodies where not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from analytical.exact.tube import Tube, pressure_at_inner_radius_mpa
from analytical.laws.silicones import DRAGON_SKIN_10
from solvers.discrete.elements import ENRICHED
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import SolverError
from solvers.estimate.dual import Goal, derivative, dual_estimates, goal_of
from solvers.estimate.enriched import ROUGH, Enriched
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from solvers.problem import Problem
from solvers.state import State

TUBE, HEIGHT_MM = Tube(4.0, 6.0), 1.0
every_kind = pytest.mark.parametrize("quadrilaterals", [True, False], ids=["quadrilaterals", "triangles"])
# Strains of 1e-6: what is not linear in them is below the tolerances of the tests.
LINEAR_MPA = 1e-7


@dataclass(frozen=True)
class Case:
    """A tube in usual and in richer spaces, and where its bore is."""

    usual: Problem
    richer: Problem
    bore_node: int
    outer_node: int

    def solve(self, load_mpa: float) -> State:
        factor = Factor(self.usual)
        path = follow_path(self.usual, factor, [load_mpa], PathSettings(newton=NewtonSettings(1e-12)))
        assert path.reached, path.reason
        return path.states[-1].state

    def bore_mm(self, state: State) -> float:
        return float(state.displacement_mm[self.bore_node, 0])

    def outer_mm(self, state: State) -> float:
        """Along the axis, outside, half-way up."""
        return float(state.displacement_mm[self.outer_node, 1])


@pytest.fixture
def tube(strip, make_problem, sides) -> Callable[..., Case]:
    def make(quadrilaterals: bool, through: int = 1, along: int = 1, bonded: bool = False, warp: float = 0.1) -> Case:
        mesh = strip(4.0, 6.0, HEIGHT_MM, through, along, warp, quadrilaterals)
        held = ((sides.bottom, 1), (sides.top, 1), *(((sides.bottom, 0),) if bonded else ()))
        element, degree = ENRICHED["quadrilateral" if quadrilaterals else "triangle"]
        usual = make_problem(mesh, DRAGON_SKIN_10, cavity=sides.cavity, held=held)
        richer = make_problem(
            mesh, DRAGON_SKIN_10, element=element, quadrature_degree=degree, cavity=sides.cavity, held=held
        )
        bore, outer = (int(np.argmin(np.linalg.norm(mesh.points - at, axis=1))) for at in ((4.0, 1.0), (6.0, 0.5)))
        return Case(usual, richer, bore, outer)

    return make


@every_kind
def test_a_state_is_the_same_in_richer_spaces(tube, quadrilaterals: bool) -> None:
    case = tube(quadrilaterals, 2, 2)
    state = case.solve(0.02)
    case.usual.set_state(state)
    case.richer.set_state(state)
    again = case.richer.get_state()
    np.testing.assert_allclose(again.displacement_mm, state.displacement_mm, atol=1e-13)
    np.testing.assert_allclose(again.pressure_mpa, state.pressure_mpa, atol=1e-13)
    # polynomials on the bore: integrated exactly by both
    assert case.richer.cavity_volume() == pytest.approx(case.usual.cavity_volume(), rel=1e-13)
    assert case.richer.conservative


@every_kind
def test_dual_weighted_residual_of_a_linear_problem_is_what_the_richer_space_changes(tube, quadrilaterals) -> None:
    case = tube(quadrilaterals, 1, 2, bonded=True)
    state = case.solve(LINEAR_MPA)
    enriched = Enriched(case.richer)
    goals = [goal_of(of, state) for of in (case.bore_mm, case.outer_mm)]
    duals = dual_estimates(case.richer, enriched.factor, state, goals)
    richer = enriched.equilibrium(state)
    for of, dual in zip((case.bore_mm, case.outer_mm), duals, strict=True):
        change = of(richer) - of(state)
        assert abs(change) > 1e-3 * abs(of(state))  # one cell through the wall leaves an error to be seen
        assert dual.first == pytest.approx(change, rel=1e-4)
        assert abs(dual.second) < 1e-4 * abs(change)


@every_kind
def test_the_dual_of_another_quantity_does_not_tell_the_error(tube, quadrilaterals: bool) -> None:
    case = tube(quadrilaterals, 1, 2, bonded=True)
    state = case.solve(LINEAR_MPA)
    enriched = Enriched(case.richer)
    other = dual_estimates(case.richer, enriched.factor, state, [goal_of(case.outer_mm, state)])[0]
    change = case.bore_mm(enriched.equilibrium(state)) - case.bore_mm(state)
    assert not 0.5 < other.error / change < 2.0


@every_kind
@pytest.mark.parametrize(("warp", "near"), [(0.0, 0.02), (0.1, 0.4)])
@pytest.mark.parametrize("stretch", [1.1, 1.3, 1.8])
def test_errors_of_the_exact_tube(tube, quadrilaterals: bool, stretch: float, warp: float, near: float) -> None:
    """What is left is the richer space's own error: little, more on two warped cells whose pressures lose an order."""
    case = tube(quadrilaterals, 2, 1, warp=warp)
    bore = stretch * TUBE.inner_radius_mm
    state = case.solve(float(pressure_at_inner_radius_mpa(TUBE, DRAGON_SKIN_10, bore)))
    true = bore - TUBE.inner_radius_mm - case.bore_mm(state)
    enriched = Enriched(case.richer)
    dual = dual_estimates(case.richer, enriched.factor, state, [goal_of(case.bore_mm, state)])[0]
    assert case.bore_mm(enriched.equilibrium(state)) - case.bore_mm(state) == pytest.approx(true, rel=near)
    assert dual.error == pytest.approx(true, rel=near)


def test_the_first_term_alone_is_not_enough(tube) -> None:
    """The square of the state's error is as large as the product with the dual's: at some load the sign is wrong."""
    case = tube(True, 2, 1, warp=0.0)
    state = case.solve(float(pressure_at_inner_radius_mpa(TUBE, DRAGON_SKIN_10, 1.2 * TUBE.inner_radius_mm)))
    true = 0.2 * TUBE.inner_radius_mm - case.bore_mm(state)
    dual = dual_estimates(case.richer, Factor(case.richer), state, [goal_of(case.bore_mm, state)])[0]
    assert dual.error == pytest.approx(true, rel=0.05)
    assert not 0.5 < dual.first / true < 2.0


def test_a_state_after_another_starts_with_what_that_lacked(tube) -> None:
    case = tube(True, 2, 1)
    loads = [float(pressure_at_inner_radius_mpa(TUBE, DRAGON_SKIN_10, 4.0 * stretch)) for stretch in (1.50, 1.52)]
    states = [case.solve(load) for load in loads]
    enriched = Enriched(case.richer)
    enriched.equilibrium(states[0])
    start = enriched.factor.count
    found = enriched.equilibrium(states[1])
    alone = Enriched(case.richer)
    same = alone.equilibrium(states[1])
    np.testing.assert_allclose(found.displacement_mm, same.displacement_mm, atol=1e-8)
    assert enriched.factor.count - start <= alone.factor.count


def test_goal_gives_a_quantity_and_its_derivative(tube) -> None:
    case = tube(True, 2, 1)
    state = case.solve(0.02)
    goal = goal_of(case.outer_mm, state)
    assert isinstance(goal, Goal)
    assert float(np.sum(goal.on_nodes * state.displacement_mm)) == pytest.approx(case.outer_mm(state), abs=1e-12)
    case.richer.set_state(state)
    by_dof, _ = derivative(case.richer, goal_of(case.bore_mm, state))
    assert by_dof @ case.richer.state.x.array[: case.richer.owned] == pytest.approx(case.bore_mm(state), rel=1e-12)


def test_usual_spaces_are_refused(tube) -> None:
    with pytest.raises(SolverError, match="no richer"):
        Enriched(tube(True).usual)


def test_equilibrium_of_the_richer_space_stays_where_it_is(tube) -> None:
    """Its own equilibrium satisfies the residual as far as it was driven to zero: nothing is left to be told."""
    case = tube(True, 2, 1)
    enriched = Enriched(case.richer)
    enriched.equilibrium(case.solve(0.02))
    report = solve_equilibrium(case.richer, enriched.factor, replace(ROUGH, counted=True), HeldLoad(0.02))
    assert report.iterations == 0 and report.excess_negatives == 0
