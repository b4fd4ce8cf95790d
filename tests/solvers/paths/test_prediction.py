"""Predictions with the slopes of states: exact where the path is a polynomial, and the slopes those of the path."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.paths.arc import Scale
from solvers.paths.checkpoint import read_checkpoint, write_checkpoint
from solvers.paths.path import follow_path
from solvers.paths.prediction import extrapolate, half_way, predicted_pressure
from solvers.paths.states import PathMemory, PathPoint, PathSettings
from solvers.state import State, combine

SCALE = Scale(1.0, 1.0)
TIGHT = NewtonSettings(relative_tolerance=1e-11)


def point(volume: float, degree: int) -> PathPoint:
    """A state of a path whose displacements are V^degree, at the pressure V + V^2/9 to V^(degree - 1)."""
    power = np.array([float(degree), 1.0])
    pressure, slope = volume + volume ** (degree - 1) / 9.0, 1.0 + (degree - 1) * volume ** (degree - 2) / 9.0
    state = State((volume**power)[:, None], np.zeros(2), np.zeros((0, 0)), pressure)
    by_load = power * volume ** (power - 1.0) / slope
    return PathPoint(state, volume, 1.0 / slope, 0, State(by_load[:, None], np.zeros(2), np.zeros((0, 0)), 1.0))


@pytest.mark.parametrize(("count", "degree"), [(1, 1), (2, 3), (3, 5)])
def test_as_many_powers_as_values_and_slopes_are_exact(count: int, degree: int) -> None:
    history = [point(v, max(degree, 2)) for v in (1.0, 1.4, 1.9)[-count:]]
    ahead = point(2.6, max(degree, 2))
    found = extrapolate(history, "volume", 2.6, SCALE)
    place = 0 if degree > 1 else 1
    assert found.displacement_mm[place] == pytest.approx(ahead.state.displacement_mm[place], rel=1e-10)
    if degree > 1:
        assert found.load_mpa == pytest.approx(ahead.pressure_mpa, rel=1e-10)
        assert predicted_pressure(history, "volume", SCALE)(2.6) == pytest.approx(ahead.pressure_mpa, rel=1e-10)
    # one power more is too many
    more = [point(v, degree + 2) for v in (1.0, 1.4, 1.9)[-count:]]
    off = extrapolate(more, "volume", 2.6, SCALE).displacement_mm[0] / point(2.6, degree + 2).state.displacement_mm[0]
    assert abs(off - 1.0) > 1e-3


def test_without_the_last_slope_only_values_count() -> None:
    history = [point(v, 5) for v in (1.0, 1.4, 1.9)]
    blunt = [dataclasses.replace(p, rate=None) for p in history]
    mixed = [*history[:2], blunt[2]]
    plain, found = (extrapolate(h, "volume", 2.6, SCALE).displacement_mm for h in (blunt, mixed))
    assert np.array_equal(plain, found)
    # from rest on, whose slope is not known, the other two count
    rest = [blunt[0], *history[1:]]
    assert not np.array_equal(extrapolate(rest, "volume", 2.6, SCALE).displacement_mm, plain)


def test_half_way_between_states_that_do_not_ascend() -> None:
    low, high = point(2.0, 3), point(1.2, 3)
    assert half_way(low, high, "volume").displacement_mm == pytest.approx(point(1.6, 3).state.displacement_mm)
    known = half_way(low, dataclasses.replace(high, rate=None), "volume").displacement_mm
    assert known == pytest.approx(0.5 * (low.state.displacement_mm + high.state.displacement_mm))


def test_rate_is_the_derivative_by_the_load(bellows_problem) -> None:
    case = bellows_problem(2)
    problem, step = case.problem, 1e-5
    here = follow_path(problem, case.factor, [0.005], PathSettings(newton=TIGHT)).states[-1]
    ends = []
    for sign in (1.0, -1.0):
        problem.set_state(here.state)
        solve_equilibrium(problem, case.factor, TIGHT, HeldLoad(0.005 + sign * step))
        ends.append(problem.get_state())
    by_difference = combine(ends, [0.5 / step, -0.5 / step])
    rate = here.newton.rate
    assert rate is not None and by_difference.load_mpa == pytest.approx(rate.load_mpa)
    for name in ("displacement_mm", "pressure_mpa", "bodies_mm"):
        found, wanted = getattr(rate, name), getattr(by_difference, name)
        # a step of 0.2 % of the load: its square, times what the path bends
        assert np.abs(found - wanted).max() < 1e-4 * np.abs(wanted).max(), name


def test_slopes_are_kept_in_checkpoints_and_older_ones_have_none(tmp_path: Path) -> None:
    history = (point(1.0, 3), dataclasses.replace(point(1.4, 3), rate=None), point(1.9, 3))
    memory = PathMemory(history, "volume", 0.3, 0, 0, 1.0, None)
    write_checkpoint(tmp_path / "c.npz", "x", memory, None)
    found = read_checkpoint(tmp_path / "c.npz", "x")
    assert found is not None and isinstance(found[0], PathMemory)
    for one, other in zip(found[0].history, history, strict=True):
        assert (one.volume_mm3, one.rate is None) == (other.volume_mm3, other.rate is None)
        if one.rate is not None and other.rate is not None:
            assert np.array_equal(one.rate.displacement_mm, other.rate.displacement_mm)
    with np.load(tmp_path / "c.npz") as data:
        older = {name: data[name] for name in data.files if ".rate." not in name}
    np.savez(tmp_path / "older.npz", **older)
    found = read_checkpoint(tmp_path / "older.npz", "x")
    assert found is not None and isinstance(found[0], PathMemory)
    assert [p.rate for p in found[0].history] == [None] * 3
    assert math.isnan(found[0].limit_mpa)
