"""A path that ends early says why, with numbers, the place and a remedy; the kind can be read by programs."""

from __future__ import annotations

import dataclasses
import math
import re

import numpy as np
import pytest

from analytical.laws.isotropic import Yeoh
from analytical.laws.stability import stable_stretches
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.diagnosis import failed_steps, limit_pressure
from solvers.paths.path import follow_path
from solvers.paths.prediction import peak
from solvers.paths.states import Crossing, PathPoint, PathSettings
from solvers.state import State

NOTHING = State(np.zeros((1, 2)), np.zeros(1), np.zeros((0, 0)), 0.0)


def point(pressure: float, slope: float, unstable: int = 0) -> PathPoint:
    return PathPoint(dataclasses.replace(NOTHING, load_mpa=pressure), 1.0, 1.0 / slope, unstable)


def test_inverted_cell_is_named_with_its_place(bellows_problem, inflated) -> None:
    case = bellows_problem(2)
    good = inflated().states[-1].state
    bad = good.displacement_mm.copy()
    cell = case.mesh.cells[len(case.mesh.cells) // 3]
    bad[cell[0]] += 3.0 * (case.mesh.points[cell[1]] - case.mesh.points[cell[0]])
    case.problem.set_state(dataclasses.replace(good, displacement_mm=bad))
    with pytest.raises(StepFailed) as failure:
        content = NewtonSettings(relative_tolerance=1e30)  # takes any finite residual for equilibrium
        solve_equilibrium(case.problem, case.factor, content, HeldLoad(0.005))
    assert failure.value.cause is Cause.INVERTED_CELL
    found = re.search(r"det F = (\S+) at r = (\S+), z = (\S+) mm, soft region", str(failure.value))
    assert found is not None
    assert float(found[1]) == pytest.approx(case.problem.deformation.extremes()[0], rel=1e-2)  # three digits
    around = case.mesh.points[case.mesh.cells[(case.mesh.cells == cell[0]).any(axis=1)].ravel()]
    at = np.array([float(found[2]), float(found[3])])
    assert (at >= around.min(axis=0) - 0.01).all() and (at <= around.max(axis=0) + 0.01).all()  # two decimals


def test_path_that_ends_at_an_inverted_cell_says_where(bellows_problem) -> None:
    case = bellows_problem(2)
    settings = PathSettings(control="volume", first_step=30.0, largest_step=30.0, smallest_step=20.0)
    path = follow_path(case.problem, case.factor, [0.010], settings)
    assert path.cause is Cause.INVERTED_CELL
    assert re.search(r"det F = \S+ at r = \S+, z = \S+ mm, soft region; last state at 0 kPa; look at", path.reason)


def test_path_that_leaves_the_laws_range_says_so(bellows_problem, monkeypatch) -> None:
    case = bellows_problem(2, "ogden")
    limits = case.problem.law.invariant_limits
    assert limits == (160.0, 6400.0)
    narrow = dataclasses.replace(case.problem.law, invariant_limits=(80.0, 200.0))
    with monkeypatch.context() as patch:
        patch.setattr(case.problem, "law", narrow)
        path = follow_path(case.problem, case.factor, [0.7], PathSettings(first_step=2.0, largest_step=4.0))
    assert path.cause is Cause.MATERIAL_RANGE
    assert "I2 = 2" in path.reason and "(<= 200)" in path.reason
    assert "another law" in path.reason


def test_path_that_grows_beyond_measure_says_how_far_it_came(bellows_problem) -> None:
    case = bellows_problem(2)
    path = follow_path(case.problem, case.factor, [0.005, 0.1], PathSettings(largest_volume=2.0))
    assert path.cause is Cause.TOO_LARGE
    assert [s.state.load_mpa for s in path.states if s.asked] == [0.005]
    highest = max(s.state.load_mpa for s in path.states)
    assert f"100 kPa is not reached; highest pressure {1e3 * highest:.6g} kPa" in path.reason


def test_limit_pressure_is_that_of_a_parabola() -> None:
    # P = 3 - (1 - V)^2: slopes 2 (1 - V), limit 3
    pressures, slopes = zip(*[(3.0 - (1.0 - v) ** 2, 2.0 * (1.0 - v)) for v in (0.5, 0.8)], strict=True)
    history = [point(p, s) for p, s in zip(pressures, slopes, strict=True)]
    assert limit_pressure(history) == pytest.approx(3.0, rel=1e-12)  # exact
    assert math.isnan(limit_pressure(history[:1]))
    assert math.isnan(limit_pressure([point(1.0, 0.5), point(2.0, 0.6)]))  # stiffening


def test_steps_that_fail_beyond_a_bifurcation_are_put_down_to_it() -> None:
    crossing = Crossing(Cause.BIFURCATION, 0.010, 1e-8, 5.0, 0, 2)
    history = [point(0.011, 1.0, 2), point(0.012, 0.9, 2)]
    cause, reason = failed_steps(StepFailed("no convergence"), history, crossing, "volume", 1.0)
    assert cause is Cause.BIFURCATION
    assert "bifurcation at 10 kPa" in reason and "0 -> 2 while dP/dV is not zero" in reason
    assert "last state at 12 kPa" in reason and "imperfection" in reason


def test_a_volume_that_does_not_respond_is_no_division_by_zero() -> None:
    still = PathPoint(dataclasses.replace(NOTHING, load_mpa=0.001), 1.0, 0.0, 0)
    assert still.slope_mpa_per_mm3 == math.inf
    for history in ([still], [still, point(0.002, 1.0)], [point(0.0005, 1.0), still]):
        found, reason = failed_steps(StepFailed("what happened"), history, None, "pressure", 1.0)
        assert found is Cause.STEP_SIZE and "limit point" not in reason


@pytest.mark.parametrize("cause", [Cause.INVERTED_CELL, Cause.MATERIAL_RANGE, Cause.LINEAR_SOLVER, Cause.STEP_SIZE])
def test_other_failures_keep_their_kind(cause: Cause) -> None:
    history = [point(0.001, 1.0), point(0.002, 1.0)]
    found, reason = failed_steps(StepFailed("what happened", cause), history, None, "volume", 1.0)
    assert found is cause
    assert "what happened; last state at 2 kPa; " in reason


def test_path_ends_where_its_law_is_no_longer_stable(strip, sides, make_problem) -> None:
    """A thick tube in plane strain of a fit that softens: pure shear everywhere, most at the bore."""
    law = Yeoh((0.0222115, 0.0026603, -0.0000735))
    limit = stable_stretches(law)["pure shear"]
    problem = make_problem(
        strip(5.0, 7.0, 1.0, 4, 1), law, cavity=sides.cavity, held=((sides.bottom, 1), (sides.top, 1))
    )
    path = follow_path(problem, Factor(problem), [0.005, 0.010, 0.060], PathSettings())
    assert path.cause is Cause.LAW_SOFTENS and not path.reached
    assert [s.state.load_mpa for s in path.states if s.asked] == [0.005, 0.010]
    named = re.search(r"no longer stable at stretch (\S+) at r = (\S+), z = \S+ mm, soft region; last", path.reason)
    assert named is not None
    assert 5.0 < float(named[2]) < 5.1  # the point nearest to the bore, which is the first to go
    # quadrature points lie a little outside the bore; the last steps are a thousandth of the volume and less
    assert float(named[1]) == pytest.approx(limit, rel=5e-3)
    stretches = [s.newton.largest_stretch for s in path.states]
    assert max(stretches) < float(named[1]) + 5e-4  # four digits
    assert stretches == sorted(stretches)


def test_largest_stretch_is_that_of_the_quadrature_points(strip, sides, make_problem) -> None:
    mesh = strip(5.0, 7.0, 1.0, 2, 1)
    problem = make_problem(mesh, Yeoh((0.036,)), cavity=sides.cavity, held=((sides.bottom, 1), (sides.top, 1)))
    r = mesh.points[:, 0]
    # u_r = r/2: hoop and radial stretch 1.5 everywhere, which is not isochoric
    moved = np.column_stack([0.5 * r, np.zeros(len(r))])
    problem.set_state(dataclasses.replace(problem.zero_state(), displacement_mm=moved))
    assert problem.deformation.largest_stretch() == pytest.approx(1.5, rel=1e-6)
    assert problem.deformation.softened() == ""


def test_peak_between_two_states_is_that_of_the_cubic() -> None:
    # P = 5 V - 2 V^2 - V^3: dP/dV vanishes at V = (sqrt(19) - 2) / 3
    def at(volume: float) -> PathPoint:
        pressure, slope = volume * (5.0 - 2.0 * volume - volume**2), 5.0 - 4.0 * volume - 3.0 * volume**2
        return PathPoint(dataclasses.replace(NOTHING, load_mpa=pressure), volume, 1.0 / slope, 0)

    top = (math.sqrt(19.0) - 2.0) / 3.0
    assert peak(at(0.5), at(2.0)) == pytest.approx(((top - 0.5) / 1.5, at(top).pressure_mpa), rel=1e-12)  # exact
    assert peak(at(2.0), at(0.5)) == pytest.approx(((2.0 - top) / 1.5, at(top).pressure_mpa), rel=1e-12)
    assert peak(at(0.1), at(0.5)) is None and peak(at(1.0), at(2.0)) is None
    unknown = dataclasses.replace(at(0.5), compliance_mm3_per_mpa=math.nan)
    assert peak(unknown, at(2.0)) is None
