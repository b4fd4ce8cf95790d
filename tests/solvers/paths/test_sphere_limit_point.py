"""A thick neo-Hookean sphere: it has a limit point, known exactly, and loses stability under pressure there."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from analytical.laws.isotropic import NeoHooke
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from meshes.solid import SolidMesh
from solvers.equilibrium.controls import HeldLoad, HeldVolume
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.branch import BranchSettings, follow_branch
from solvers.paths.crossing import critical_mode
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings

INNER, OUTER, MU = 5.0, 6.5, 0.1


def exact_pressure(inner_stretch: float) -> float:
    """Closed form for neo-Hooke: mu/2 [4/l + 1/l^4] between the outer and the inner stretch."""
    outer_stretch = (1.0 + (INNER / OUTER) ** 3 * (inner_stretch**3 - 1.0)) ** (1.0 / 3.0)
    a, b = inner_stretch, outer_stretch
    return 0.5 * MU * ((4.0 / b + b**-4) - (4.0 / a + a**-4))


@pytest.fixture(scope="module")
def sphere(strip) -> SolidMesh:
    """Meridian of the upper half: a strip bent round, its bottom the equator and its top the axis."""
    flat = strip(INNER, OUTER, 1.0, 2, 8)
    radius, angle = flat.points[:, 0], 0.5 * np.pi * flat.points[:, 1]
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    points[np.abs(points) < 1e-12] = 0.0
    return dataclasses.replace(flat, points=points)


@pytest.fixture(scope="module")
def half_sphere(sphere: SolidMesh, sides, make_problem):
    def make(law) -> SimpleNamespace:
        problem = make_problem(sphere, law, cavity=sides.cavity, held=((sides.bottom, 1), (sides.top, 0)))
        return SimpleNamespace(problem=problem, factor=Factor(problem))

    return make


def test_pressure_follows_the_closed_form_past_the_limit_point(half_sphere) -> None:
    case = half_sphere(NeoHooke(MU))
    problem = case.problem
    problem.set_state(problem.zero_state())
    rest = problem.cavity_volume()
    limit = minimize_scalar(lambda l: -exact_pressure(l), bounds=(1.1, 3.0), method="bounded").x
    stretches = np.linspace(1.0, 2.2, 25)[1:]
    for stretch in stretches:
        report = solve_equilibrium(problem, case.factor, NewtonSettings(), HeldVolume(rest * stretch**3))
        # eight curved cells from equator to pole, two through the wall: measured 2e-5 at most
        assert float(problem.pressure.value) == pytest.approx(exact_pressure(stretch), rel=1e-4)
        # stable under pressure control below the limit, one unstable mode above
        assert report.excess_negatives == (0 if stretch < limit else 1), stretch
    assert stretches[0] < limit < stretches[-1]


def test_pressure_beyond_the_limit_point_is_not_reached_and_said_so(half_sphere) -> None:
    case = half_sphere(NeoHooke(MU))
    limit = -minimize_scalar(lambda l: -exact_pressure(l), bounds=(1.1, 3.0), method="bounded").fun
    settings = PathSettings(first_step=0.02, largest_step=0.1, largest_volume=10.0)
    path = follow_path(case.problem, case.factor, [0.9 * limit, 1.02 * limit], settings)
    assert not path.reached
    assert path.reason
    assert [p.state.load_mpa for p in path.states if p.asked] == [0.9 * limit]
    # the steps of the volume went through the limit point, and no state is above it
    assert max(p.state.load_mpa for p in path.states) < limit * 1.0001  # discretisation, as above
    assert path.states[-1].newton.excess_negatives == 1


# By default a step of the volume goes over the peak; in the last the first one does.
STEPS = {
    "volume": PathSettings(largest_volume=6.0),
    "arc": PathSettings(largest_volume=6.0, control="arc"),
    "pressure first": PathSettings(largest_volume=6.0, start_control="pressure"),
    "one step": PathSettings(largest_volume=6.0, first_step=4.0, largest_step=4.0),
}


@pytest.mark.parametrize("settings", STEPS.values(), ids=STEPS.keys())
def test_pressures_just_below_the_limit_point_are_reached_where_they_are_stable(half_sphere, settings) -> None:
    case = half_sphere(NeoHooke(MU))
    find = PathSettings(largest_volume=6.0, crossing_tolerance=1e-12)
    limit = follow_path(case.problem, case.factor, [1.0], find).crossing
    assert limit is not None and limit.kind is Cause.LIMIT_POINT
    assert limit.pressure_mpa == pytest.approx(
        -minimize_scalar(lambda l: -exact_pressure(l), bounds=(1.1, 3.0), method="bounded").fun, rel=1e-4
    )
    shares = (0.97, 0.999, 1.0 - 1e-6)
    for asked in [[share] for share in shares] + [list(shares)]:
        path = follow_path(case.problem, case.factor, [share * limit.pressure_mpa for share in asked], settings)
        assert path.reached, path.reason
        found = [s for s in path.states if s.asked]
        assert [s.state.load_mpa / limit.pressure_mpa for s in found] == pytest.approx(asked, rel=1e-12)
        assert [s.newton.excess_negatives for s in found] == [0] * len(asked)
        assert all(s.volume_mm3 < limit.volume_mm3 for s in found)
    above = follow_path(case.problem, case.factor, [(1.0 + 1e-6) * limit.pressure_mpa], settings)
    assert above.cause is Cause.LIMIT_POINT and not any(s.asked for s in above.states)


def test_path_goes_on_without_a_critical_mode_that_cannot_be_computed(half_sphere, monkeypatch) -> None:
    case = half_sphere(NeoHooke(MU))
    settings = PathSettings(largest_volume=6.0)
    with_mode = follow_path(case.problem, case.factor, [1.0], settings)

    def no_memory(problem, factor):
        problem.set_state(problem.zero_state())
        raise StepFailed("MUMPS failed with INFOG(1) = -13", Cause.OUT_OF_MEMORY)

    monkeypatch.setattr("solvers.paths.crossing.critical_mode", no_memory)
    path = follow_path(case.problem, case.factor, [1.0], settings)
    assert path.crossing is not None and with_mode.crossing is not None and with_mode.crossing.mode is not None
    assert path.crossing.mode is None
    assert path.crossing.pressure_mpa == with_mode.crossing.pressure_mpa
    assert (path.cause, path.reason, len(path.states)) == (Cause.LIMIT_POINT, with_mode.reason, len(with_mode.states))
    with pytest.raises(StepFailed, match="no critical mode is known at 32.2"):
        follow_branch(case.problem, case.factor, path.crossing, 1.0, BranchSettings(0.1))


def test_inverse_iteration_that_breaks_down_is_a_failed_step(half_sphere, monkeypatch) -> None:
    case = half_sphere(NeoHooke(MU))
    case.problem.set_state(case.problem.zero_state())
    monkeypatch.setattr(case.factor, "solve", lambda on_dofs, on_bodies: (0.0 * on_dofs, 0.0 * on_bodies))
    with pytest.raises(StepFailed, match="broke down"):
        critical_mode(case.problem, case.factor)


def test_half_an_increment_is_taken_where_the_whole_has_no_residual(half_sphere, monkeypatch) -> None:
    case = half_sphere(NeoHooke(MU))
    problem = case.problem
    problem.set_state(problem.zero_state())
    internal_force, calls = problem.internal_force, []

    def not_a_number_once():
        calls.append(1)
        force, on_bodies = internal_force()
        return (np.nan * force if len(calls) == 2 else force), on_bodies

    monkeypatch.setattr(problem, "internal_force", not_a_number_once)
    report = solve_equilibrium(problem, case.factor, NewtonSettings(), HeldLoad(0.01))
    assert report.residual <= 1e-8 and len(calls) > 3


@pytest.mark.parametrize("law", [DRAGON_SKIN_10, dragon_skin_30("2mu/alpha^2")], ids=["yeoh", "ogden"])
def test_the_papers_silicones_have_no_limit_point_on_a_sphere(half_sphere, law) -> None:
    case = half_sphere(law)
    case.problem.set_state(case.problem.zero_state())
    rest = case.problem.cavity_volume()
    pressures = []
    for stretch in np.linspace(1.0, 2.2, 13)[1:]:
        report = solve_equilibrium(case.problem, case.factor, NewtonSettings(), HeldVolume(rest * stretch**3))
        pressures.append(float(case.problem.pressure.value))
        assert report.excess_negatives == 0
    assert (np.diff(pressures) > 0.0).all()
