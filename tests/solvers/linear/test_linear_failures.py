"""A factorisation short of memory goes to disk, or is a failed step with MUMPS's reason: no crash, no wrong answer."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from petsc4py import PETSc

from analytical.laws.isotropic import NeoHooke
from solvers.errors import Cause, StepFailed
from solvers.linear import factor as linear
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings

OUT_OF_CORE = linear.LADDER.index({22: 1})


@pytest.mark.parametrize("controls", [{14: 1, 23: 1}, {14: 40, 23: 1}], ids=["little workspace", "capped memory"])
def test_memory_that_runs_out_is_a_failed_step(bellows_problem, monkeypatch, controls: dict[int, int]) -> None:
    problem = bellows_problem(3).problem
    problem.set_state(problem.zero_state())
    before = problem.state.x.array.copy()
    # ICNTL(23) = 1: MUMPS may use 1 MB, which neither a larger share of it nor the disk cures
    monkeypatch.setattr(linear, "ICNTL", {**linear.ICNTL, **controls})
    factor = linear.Factor(problem)
    with pytest.raises(StepFailed, match="MUMPS failed with INFOG.* even with the factors on disk") as failure:
        factor.refresh()
    assert failure.value.cause is Cause.OUT_OF_MEMORY
    assert np.array_equal(problem.state.x.array, before)
    monkeypatch.undo()
    # the same object works again once there is memory
    factor.refresh()
    assert (factor.excess_negatives, factor.rung) == (0, 0)
    factor.close()


def test_factors_go_to_disk_when_the_memory_does_not_hold_them(bellows_problem, monkeypatch) -> None:
    problem = bellows_problem(3).problem
    problem.set_state(problem.zero_state())
    whole = linear.Factor(problem)
    whole.refresh()
    assert whole.rung == 0 and whole.solver is not None
    numbers = whole.solver.getPC().getFactorMatrix()
    needed, on_disk = numbers.getMumpsInfog(21), numbers.getMumpsInfog(27)  # MB, in core and out of core
    assert on_disk < 0.7 * needed
    load = problem.load.force() * ~problem.constrained_owned
    expected, expected_bodies = whole.solve(load, np.zeros(problem.extra))
    whole.close()

    monkeypatch.setattr(linear, "ICNTL", {**linear.ICNTL, 23: (needed + on_disk) // 2})
    factor = linear.Factor(problem)
    for _ in range(2):  # the second goes to disk at once
        factor.refresh()
        assert factor.rung == OUT_OF_CORE
        found, found_bodies = factor.solve(load, np.zeros(problem.extra))
        # the same factors: round-off of another blocking
        assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()
        assert np.abs(found_bodies - expected_bodies).max() < 1e-9 * np.abs(expected).max()
        assert factor.excess_negatives == 0
    factor.close()


def test_too_little_workspace_is_enlarged_first(bellows_problem, monkeypatch) -> None:
    problem = bellows_problem(3).problem
    problem.set_state(problem.zero_state())
    factor = linear.Factor(problem)
    attempts = []
    factorise = factor._factorise

    def short_once() -> tuple[int, int]:
        attempts.append(linear.LADDER[factor.rung])
        status = factorise()
        return (-9, 100) if len(attempts) == 1 else status

    monkeypatch.setattr(factor, "_factorise", short_once)
    factor.refresh()
    assert attempts == [{}, {14: 100}]
    assert factor.excess_negatives == 0
    factor.close()


@pytest.mark.parametrize(("number", "cause"), [(55, Cause.OUT_OF_MEMORY), (76, Cause.LINEAR_SOLVER)])
def test_failure_of_petsc_itself_is_a_failed_step(bellows_problem, monkeypatch, number: int, cause: Cause) -> None:
    problem = bellows_problem(2).problem
    problem.set_state(problem.zero_state())
    factor = linear.Factor(problem)

    def fails():
        raise PETSc.Error(number)

    with monkeypatch.context() as patch:
        patch.setattr(factor, "_new_solver", fails)
        with pytest.raises(StepFailed, match="PETSc failed to factor the tangent") as failure:
            factor.refresh()
    assert failure.value.cause is cause
    factor.refresh()
    assert factor.excess_negatives == 0
    factor.close()


def test_load_on_what_cannot_move_is_named(strip, sides, make_problem) -> None:
    held = ((sides.bottom, 1), (sides.cavity, 0), (sides.cavity, 1))
    problem = make_problem(
        strip(5.0, 6.0, 2.0, 2, 2, quadrilaterals=True), NeoHooke(0.1), cavity=sides.cavity, held=held
    )
    path = follow_path(problem, linear.Factor(problem), [0.01], PathSettings())
    assert not path.reached and not path.states
    assert "acts on nothing that is free to move" in path.reason


def test_part_that_floats_is_a_failed_step(strip, sides, make_problem) -> None:
    """Two tubes that do not touch, of which only the inner one is loaded and held."""
    tubes = [strip(*radii, 2.0, 2, 4, quadrilaterals=True) for radii in ((5.0, 6.0), (7.0, 8.0))]
    inner, shift = tubes[0], len(tubes[0].points)
    both = dataclasses.replace(
        inner,
        points=np.vstack([tube.points for tube in tubes]),
        cells=np.vstack([inner.cells, tubes[1].cells + shift]),
        regions=np.append(inner.regions, tubes[1].regions),
    )
    held = ((sides.bottom, 1), (sides.top, 1))
    for mesh, singular in ((inner, False), (both, True)):
        problem = make_problem(mesh, NeoHooke(0.1), cavity=sides.cavity, held=held)
        assert problem.conservative
        factor = linear.Factor(problem)
        if not singular:
            factor.refresh()
            assert factor.excess_negatives == 0
            continue
        # without a look at its null pivots the count was 0 or 1, as round-off wanted it
        path = follow_path(problem, factor, [0.01], PathSettings())
        assert path.cause is Cause.LINEAR_SOLVER and not path.states
        assert "motions that cost nothing: 1" in path.reason and "every part of it" in path.reason
        # beyond where a symmetry is broken one is expected: it is not counted, and has no share of the solution
        factor.free_motions = 1
        path = follow_path(problem, factor, [0.01], PathSettings())
        assert path.reached and path.states[-1].newton.excess_negatives == 0
        assert np.abs(path.states[-1].state.displacement_mm[shift:]).max() < 1e-12


def test_path_without_memory_ends_with_its_last_state_and_says_so(bellows_problem, monkeypatch) -> None:
    case = bellows_problem(2)
    factor = linear.Factor(case.problem)
    factorise = factor._factorise

    def short_from_the_tenth() -> tuple[int, int]:
        return (-13, 1000) if factor.count >= 10 else factorise()

    monkeypatch.setattr(factor, "_factorise", short_from_the_tenth)
    path = follow_path(case.problem, factor, [0.005, 0.010], PathSettings())
    assert not path.reached
    assert path.cause is Cause.OUT_OF_MEMORY
    assert path.rejected == 1  # smaller steps need as much memory
    assert "INFOG(1) = -13" in path.reason and "MUMPS_OOC_TMPDIR" in path.reason
    assert len(path.states) > 1
    found, last = case.problem.get_state(), path.states[-1].state
    assert np.array_equal(found.displacement_mm, last.displacement_mm)
    assert found.load_mpa == last.load_mpa
    factor.close()
