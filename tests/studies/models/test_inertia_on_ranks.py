"""No negative pivot is lost on two ranks (MUMPS would not count those of a parallel root)."""

from __future__ import annotations

from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("inertia_script.py")
ROOT = SCRIPT.parents[3]


@pytest.mark.slow
def test_one_and_two_ranks_count_the_same_modes(python) -> None:
    one, two = (python.answer(ranks, SCRIPT) for ranks in (1, 2))
    assert (one["ranks"], two["ranks"]) == (1, 2)
    assert one["unknowns"] > 90_000
    assert one["modes"][0] == 0  # at rest all is stable
    assert one["modes"][1] > 10  # there are pivots to lose: measured 19 and 22
    assert two["modes"] == one["modes"]
