"""One and two MPI ranks give the same answer and the same stability count."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

SCRIPT = Path(__file__).with_name("ranks_script.py")


@pytest.mark.parametrize("cells", ["tetrahedra", "hexahedra"])
def test_one_and_two_ranks_agree(python, cells: str) -> None:
    one, two = (python.answer(ranks, SCRIPT, cells) for ranks in (1, 2))
    assert (one["ranks"], two["ranks"]) == (1, 2)
    assert one["reached"] and two["reached"]
    for name in ("tip_mm", "volume_mm3", "energy_mj", "reaction_n", "body_mm", "min_det_f"):
        # Newton to 1e-11; sums in another order
        assert two[name] == pytest.approx(one[name], rel=1e-9), name
    # Newton to 1e-8 of the load; the pressure is stationary at the limit point. The volume is bisected to 1e-3 of a
    # step, between states foreseen from slopes near zero, which Newton's tolerance moves
    assert two["limit_mpa"] == pytest.approx(one["limit_mpa"], rel=1e-8)
    assert two["limit_mm3"] == pytest.approx(one["limit_mm3"], rel=1e-4)
    assert one["modes"] == [0, 1]
    assert one["end"] == two["end"] == "law no longer stable"
    for name in ("end_mpa", "largest_stretch"):
        assert two[name] == pytest.approx(one[name], rel=1e-6), name
    # the same random start in the caller's numbering; inverse iteration to 1e-6 of the stiffness, 1e-3 of the mode
    assert np.abs(np.array(two["mode_mm"]) - np.array(one["mode_mm"])).max() < 1e-3
    for name in ("iterations", "excess_negatives", "expected_negatives", "modes"):
        assert two[name] == one[name], name
    assert one["excess_negatives"] == 0
    for answer in (one, two):
        # gathered, scattered and assembled again: the order of sums only
        assert answer["volume_again_mm3"] == pytest.approx(answer["volume_mm3"], rel=1e-13)
