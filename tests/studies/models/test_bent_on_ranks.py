"""A body that bends, its rings turning, on one and two ranks; a body that one of the ranks cannot have."""

from __future__ import annotations

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = Path(__file__).with_name("bent_script.py")
FAILING = Path(__file__).with_name("failing_mesh_script.py")
SHORT = ROOT / "scenes" / "imperfection" / "short-core-10.toml"


def test_one_and_two_ranks_bend_alike(python, tmp_path: Path) -> None:
    text = SHORT.read_text(encoding="utf-8").replace("convolutions = 2", "convolutions = 1")
    scene = tmp_path / "mini.toml"
    scene.write_text(text, encoding="utf-8")
    one, two = (python.answer(ranks, SCRIPT, scene, tmp_path / f"out-{ranks}") for ranks in (1, 2))
    assert (one["ranks"], two["ranks"]) == (1, 2)
    assert one["status"] == two["status"] == "reached"
    assert one["modes"] == two["modes"] == [0.0, 0.0]
    # the stiff bond's forces cancel to about 1e-7 of the load at such pressures, so round-off decides on the last
    # iteration: 5 or 6 were counted on two ranks
    assert max(one["iterations"] + two["iterations"]) <= 10
    assert abs(one["bends"][-1]) > 0.5
    # Newton to 1e-8 of the load; twelve digits are written
    for name in ("tips", "bends", "volumes"):
        assert two[name] == pytest.approx(one[name], rel=1e-6), name


def test_meridian_that_one_rank_cannot_mesh_is_told_on_all(python, tmp_path: Path) -> None:
    assert python.answer(2, FAILING, SHORT, tmp_path / "out") == ["the ring could not be meshed"] * 2
