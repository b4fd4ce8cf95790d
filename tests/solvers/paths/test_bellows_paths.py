"""Paths of a bellows of one convolution: work and energy, steps large and small, refusals, stability."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

import solvers.paths.steps
from analytical.laws.silicones import dragon_skin_30
from solvers.equilibrium.controls import HeldLoad, HeldVolume
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from solvers.paths.warm_start import follow_guesses
from solvers.state import State

TIGHT = NewtonSettings(relative_tolerance=1e-11)
PATIENT = NewtonSettings(relative_tolerance=1e-11, max_iterations=40)


def assert_same_state(found: State, expected: State, tolerance: float) -> None:
    size = np.abs(expected.displacement_mm).max()
    assert np.abs(found.displacement_mm - expected.displacement_mm).max() < tolerance * size
    size = np.abs(expected.pressure_mpa).max()
    assert np.abs(found.pressure_mpa - expected.pressure_mpa).max() < 100.0 * tolerance * size
    size = np.abs(expected.bodies_mm).max()
    assert np.abs(found.bodies_mm - expected.bodies_mm).max() < tolerance * size


def at_pressure(inflated, pressure_mpa: float) -> State:
    return next(p.state for p in inflated().states if p.asked and p.state.load_mpa == pressure_mpa)


# ---- work, energy, steps -------------------------------------------------------------------------------


def test_work_of_the_pressure_is_the_stored_energy(bellows_problem, inflated) -> None:
    case = bellows_problem(2)
    problem = case.problem
    problem.set_state(problem.zero_state())
    volumes = np.linspace(problem.cavity_volume(), inflated().states[-1].volume_mm3, 33)
    pressures = [0.0]
    for volume in volumes[1:]:
        solve_equilibrium(problem, case.factor, TIGHT, HeldVolume(volume))
        pressures.append(float(problem.pressure.value))
    energy = problem.energy()
    errors = []
    for stride in (4, 2, 1):
        p, v = np.array(pressures[::stride]), volumes[::stride]
        work = float((0.5 * (p[1:] + p[:-1]) * np.diff(v)).sum())
        errors.append(abs(work / energy - 1.0))
    # the trapezoidal rule's error falls 4 times per halving; asked 3.5, measured 3.87 and 3.97
    assert errors[0] / errors[1] > 3.5, errors
    assert errors[1] / errors[2] > 3.5, errors
    assert errors[2] < 1e-4  # measured 2.1e-5 with 32 steps


def test_one_step_and_many_steps_reach_the_same_state(bellows_problem, inflated) -> None:
    case = bellows_problem(2)
    expected = at_pressure(inflated, 0.005)
    for steps in (1, 2, 5, 20):
        case.problem.set_state(case.problem.zero_state())
        for k in range(1, steps + 1):
            solve_equilibrium(case.problem, case.factor, PATIENT, HeldLoad(0.005 * k / steps))
        # asked 1e-8; Newton's residual is 1e-11 of the load
        assert_same_state(case.problem.get_state(), expected, 1e-8)


def test_overloading_and_unloading_come_back(bellows_problem, inflated) -> None:
    case = bellows_problem(2)
    case.problem.set_state(at_pressure(inflated, 0.010))
    for pressure in (0.0085, 0.007, 0.006, 0.005):
        solve_equilibrium(case.problem, case.factor, PATIENT, HeldLoad(pressure))
    assert_same_state(case.problem.get_state(), at_pressure(inflated, 0.005), 1e-8)  # as above
    for pressure in (0.004, 0.003, 0.002, 0.001, 0.0):
        report = solve_equilibrium(case.problem, case.factor, PATIENT, HeldLoad(pressure))
    # 1e-11 of a load of a thousandth of the shear modulus: 1e-9 mm would show any permanent set
    assert np.abs(case.problem.get_state().displacement_mm).max() < 1e-9
    assert case.problem.energy() < 1e-13  # round-off of 0.036 MPa (I1 - 3) over 1600 mm3
    assert report.excess_negatives == 0


def test_volume_and_pressure_control_meet(bellows_problem, inflated) -> None:
    case = bellows_problem(2)
    point = inflated().states[-1]
    case.problem.set_state(at_pressure(inflated, 0.005))
    for share in (0.25, 0.5, 0.75, 1.0):
        volume = inflated().states[-1].volume_mm3 * share + (1.0 - share) * case.problem.cavity_volume()
        solve_equilibrium(case.problem, case.factor, TIGHT, HeldVolume(volume))
    assert float(case.problem.pressure.value) == pytest.approx(0.010, rel=1e-9)  # Newton's residual
    assert_same_state(case.problem.get_state(), point.state, 1e-8)


def test_newton_tolerance_does_not_decide_the_answer(bellows_problem, inflated) -> None:
    case = bellows_problem(2)
    tips = []
    for tolerance in (1e-6, 1e-8, 1e-10):
        case.problem.set_state(at_pressure(inflated, 0.005))
        settings = NewtonSettings(relative_tolerance=tolerance)
        for pressure in (0.006, 0.007):
            solve_equilibrium(case.problem, case.factor, settings, HeldLoad(pressure))
        tips.append(case.problem.get_state().displacement_mm[case.mesh.tip_centre_node, 1])
    # FAILURE_MODES: the last two agree to 1e-6
    assert tips[1] == pytest.approx(tips[2], rel=1e-6)
    assert tips[0] == pytest.approx(tips[2], rel=1e-4)


def test_asked_pressures_are_hit_exactly_and_in_order(inflated) -> None:
    path = inflated()
    assert [p.state.load_mpa for p in path.states if p.asked] == [0.005, 0.010]
    volumes = [p.volume_mm3 for p in path.states]
    assert volumes == sorted(volumes)
    assert all(p.control == ("pressure" if p.asked else "volume") for p in path.states)


@pytest.mark.parametrize("asked", [[0.0001, 0.005], [0.0004]])
def test_small_asked_pressure_is_not_jumped_over(bellows_problem, asked: list[float]) -> None:
    case = bellows_problem(2)
    path = follow_path(case.problem, case.factor, asked, PathSettings(largest_volume=3.0))
    assert [p.state.load_mpa for p in path.states if p.asked] == asked
    assert path.reached


def test_warm_start_in_3d_agrees_with_the_axisymmetric_path(bellows_problem, inflated, inflated_solid) -> None:
    flat = [p for p in inflated().states if p.asked]
    for round_, point in zip(inflated_solid().states, flat, strict=True):
        # eight cells round: measured 0.2 % of volume, 0.3 % of energy, 0.6 % of the rings' way
        assert round_.volume_mm3 == pytest.approx(point.volume_mm3, rel=5e-3)
        assert round_.energy_mj == pytest.approx(point.energy_mj, rel=1e-2)
        # the mesh has mirror planes: nothing tilts, turns or drifts but for round-off through Newton
        bodies = round_.state.bodies_mm
        assert np.abs(bodies[:, [0, 1, 3, 4, 5]]).max() < 1e-6
        assert bodies[:, 2] == pytest.approx(point.state.bodies_mm[:, 0], rel=1e-2)


# ---- refusals ------------------------------------------------------------------------------------------


def test_a_solve_that_converges_with_its_last_factor_is_not_given_up(bellows_problem, inflated) -> None:
    problem, factor = bellows_problem(2).problem, bellows_problem(2).factor
    guess, pressure = at_pressure(inflated, 0.005), 0.006

    def solve(settings: NewtonSettings):
        problem.set_state(guess)
        return solve_equilibrium(problem, factor, settings, HeldLoad(pressure))

    patient = NewtonSettings(reuse_below=0.5)
    whole = solve(patient)
    state = problem.get_state()
    assert whole.factorisations < whole.iterations  # the last ones had no factor of their own
    short = dataclasses.replace(patient, max_iterations=whole.iterations - 1)
    assert solve(short).iterations == whole.iterations
    assert_same_state(problem.get_state(), state, 1e-12)
    with pytest.raises(StepFailed, match="no convergence"):
        solve(dataclasses.replace(short, max_iterations=1, reuse_below=0.0, reuse_for=0.0))


@pytest.mark.parametrize("field", ["displacement_mm", "pressure_mpa"])
def test_nan_stops_newton_in_its_first_iteration(bellows_problem, inflated, field: str) -> None:
    case = bellows_problem(2)
    good = at_pressure(inflated, 0.005)
    values = getattr(good, field).copy()
    values[case.mesh.corners[len(case.mesh.corners) // 2]] = math.nan
    case.problem.set_state(dataclasses.replace(good, **{field: values}))
    before = case.factor.count
    with pytest.raises(StepFailed, match="not finite in iteration 0"):
        solve_equilibrium(case.problem, case.factor, TIGHT, HeldLoad(0.005))
    assert case.factor.count == before


def test_path_recovers_from_a_step_that_went_to_nan(bellows_problem, inflated, monkeypatch: pytest.MonkeyPatch) -> None:
    case = bellows_problem(2)
    calls = []

    def spoil_the_fourth(problem, *rest, **options):
        calls.append(options)
        if len(calls) == 4:
            problem.state.x.array[:] = math.nan
            problem.pressure.value = math.nan
            problem.bonded.values[:] = math.nan
            problem.bonded.update(np.zeros(0))
        return solve_equilibrium(problem, *rest, **options)

    monkeypatch.setattr(solvers.paths.steps, "solve_equilibrium", spoil_the_fourth)
    path = follow_path(case.problem, case.factor, [0.005, 0.010], PathSettings(newton=TIGHT))
    assert path.reached
    assert path.rejected == 1
    # Newton's residual
    assert_same_state(path.states[-1].state, at_pressure(inflated, 0.010), 1e-8)


def test_path_that_gives_up_leaves_the_last_good_state(bellows_problem, monkeypatch: pytest.MonkeyPatch) -> None:
    case = bellows_problem(2)
    calls = []

    def fail_from_the_fourth(problem, *rest, **options):
        calls.append(options)
        if len(calls) >= 4:
            problem.state.x.array[:] = math.nan
        return solve_equilibrium(problem, *rest, **options)

    monkeypatch.setattr(solvers.paths.steps, "solve_equilibrium", fail_from_the_fourth)
    path = follow_path(case.problem, case.factor, [0.010], PathSettings(smallest_step=1e-2, newton=TIGHT))
    assert not path.reached
    assert path.cause is Cause.STEP_SIZE
    assert path.reason.startswith("step size: the residual is not finite")
    assert "last state at" in path.reason
    assert len(path.states) == 3
    found = case.problem.get_state()
    last = path.states[-1].state
    assert np.array_equal(found.displacement_mm, last.displacement_mm)
    assert np.array_equal(found.bodies_mm, last.bodies_mm)
    assert found.load_mpa == last.load_mpa


def test_step_to_ten_megapascals_is_refused_and_the_last_good_state_kept(bellows_problem, inflated) -> None:
    case = bellows_problem(2)
    good = at_pressure(inflated, 0.005)
    guesses = [good, dataclasses.replace(good, load_mpa=10.0)]
    path = follow_guesses(case.problem, case.factor, guesses, PathSettings(newton=TIGHT))
    assert not path.reached
    assert path.rejected > 0
    assert "no equilibrium found from the warm start" in path.reason
    assert all(p.newton.min_det_f > 0.0 for p in path.states)
    assert_same_state(path.states[0].state, good, 1e-8)  # Newton's residual
    assert path.states[-1].state.load_mpa < 1.0


def test_warm_start_that_gives_up_leaves_the_last_good_state(bellows_problem, inflated) -> None:
    case = bellows_problem(2)
    good = at_pressure(inflated, 0.005)
    bad = dataclasses.replace(good, displacement_mm=np.full_like(good.displacement_mm, math.nan))
    path = follow_guesses(case.problem, case.factor, [good, bad], PathSettings(newton=TIGHT))
    assert not path.reached
    assert len(path.states) == 1
    assert np.array_equal(case.problem.get_state().displacement_mm, path.states[0].state.displacement_mm)


@pytest.mark.parametrize("pressure_mpa", [0.1, 1.0, 10.0])
def test_whole_of_a_huge_load_at_once_is_refused(bellows_problem, pressure_mpa: float) -> None:
    case = bellows_problem(2)
    case.problem.set_state(case.problem.zero_state())
    with pytest.raises(StepFailed):
        solve_equilibrium(case.problem, case.factor, TIGHT, HeldLoad(pressure_mpa))


def test_huge_volume_steps_are_cut_until_they_work(bellows_problem, inflated) -> None:
    case = bellows_problem(2)
    settings = PathSettings(first_step=30.0, largest_step=30.0, newton=TIGHT)
    path = follow_path(case.problem, case.factor, [0.010], settings)
    assert path.rejected > 0
    assert all(p.newton.min_det_f > 0.0 for p in path.states)
    assert path.reached
    assert_same_state(path.states[-1].state, at_pressure(inflated, 0.010), 1e-8)  # Newton's residual


def test_state_with_an_inverted_cell_is_never_called_converged(bellows_problem, inflated) -> None:
    case = bellows_problem(2)
    good = at_pressure(inflated, 0.005)
    inverted = good.displacement_mm.copy()
    cell = case.mesh.cells[len(case.mesh.cells) // 3]
    inverted[cell[0]] += 3.0 * (case.mesh.points[cell[1]] - case.mesh.points[cell[0]])
    case.problem.set_state(dataclasses.replace(good, displacement_mm=inverted))
    assert case.problem.deformation.extremes()[0] < 0.0
    with pytest.raises(StepFailed, match="det F = -"):
        content = NewtonSettings(relative_tolerance=1e30)  # takes any finite residual for equilibrium
        solve_equilibrium(case.problem, case.factor, content, HeldLoad(0.005))


def test_ogden_is_not_used_beyond_the_range_of_its_fit(strip, sides, make_problem) -> None:
    mesh = strip(2.0, 3.0, 2.0, 2, 2)
    problem = make_problem(mesh, dragon_skin_30("2mu/alpha^2"), cavity=sides.cavity)
    u = mesh.points * [13.0**-0.5 - 1.0, 13.0 - 1.0]  # the fit ends at a stretch of 12.6
    problem.set_state(State(u, np.zeros(len(u)), np.zeros((0, 0)), 0.0))
    content = NewtonSettings(relative_tolerance=1e30)
    with pytest.raises(StepFailed, match=r"out of the material law's range: I1 = 169 \(<= 160\)"):
        solve_equilibrium(problem, Factor(problem), content, HeldLoad(0.001))


# ---- stability -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", ["yeoh", "ogden"])
def test_axisymmetric_bellows_is_stable_to_20_kpa(bellows_problem, law: str) -> None:
    case = bellows_problem(2, law)
    path = follow_path(case.problem, case.factor, [0.005, 0.010, 0.015, 0.020], PathSettings())
    assert path.reached, path.reason
    assert [p.newton.excess_negatives for p in path.states] == [0] * len(path.states)


def test_solid_bellows_is_stable(inflated_solid) -> None:
    assert [p.newton.excess_negatives for p in inflated_solid().states] == [0, 0]


@pytest.mark.parametrize("dimension", [2, 3])
def test_one_negative_pivot_is_expected_per_pressure_unknown(bellows_problem, dimension: int) -> None:
    case = bellows_problem(dimension)
    assert case.problem.expected_negatives == len(case.mesh.corners)
    case.problem.set_state(case.problem.zero_state())
    case.factor.refresh()
    assert case.factor.negatives == len(case.mesh.corners)
