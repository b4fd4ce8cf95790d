"""A factorisation that fails is a failed step with MUMPS's reason, not a crash and not a wrong answer."""

from __future__ import annotations

import pytest

from solvers import linear
from solvers.errors import StepFailed


@pytest.mark.parametrize("controls", [{14: 1, 23: 1}, {14: 40, 23: 1}], ids=["little workspace", "capped memory"])
def test_memory_that_runs_out_is_a_failed_step(bellows_problem, monkeypatch, controls: dict[int, int]) -> None:
    problem = bellows_problem(3).problem
    problem.set_state(problem.zero_state())
    # ICNTL(23) = 1: MUMPS may use 1 MB, which no retry with a larger share of it mends
    monkeypatch.setattr(linear, "ICNTL", {**linear.ICNTL, **controls})
    factor = linear.Factor(problem)
    with pytest.raises(StepFailed, match="MUMPS failed with INFOG"):
        factor.refresh()
    monkeypatch.undo()
    factor.close()
    healthy = linear.Factor(problem)
    healthy.refresh()
    assert healthy.excess_negatives == 0
