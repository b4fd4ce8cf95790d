"""Which values a tolerance is asked of, what it is a share of, and what is refined."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from studies.models.session import good_meridian
from studies.models.tolerance import finer_body, first_body, marked, may_follow, sentence, shortfalls
from studies.planning.bellows import plan_bellows
from studies.planning.levels import LIMIT, MOST_UNKNOWNS, BodyLevel
from studies.planning.planner import describe, make_plan
from studies.results import provenance
from studies.results.expectations import expectation_rows
from studies.results.rows import NOT_MET, Row, is_reached, row
from studies.scene.load import load_bellows, load_scene
from tests.studies.paper.paper_demo import make_run

SCENES = provenance.ROOT / "scenes"
BELLOWS = load_bellows(SCENES / "peers" / "bellows.toml")
SPHERE = load_scene(SCENES / "exact" / "sphere-limit.toml")


def rows_of(quantity: str, model: str, values: Mapping[str, Sequence[tuple[float, float]]]) -> list[Row]:
    """Rows by level: value and uncertainty at 1, 2, … kPa."""
    return [
        row("a", quantity, "mm", float(k), model, value, level, spread)
        for level, pairs in values.items()
        for k, (value, spread) in enumerate(pairs, 1)
    ]


def test_a_tolerance_is_a_share_of_each_value() -> None:
    rows = rows_of("tip_mm", "axisymmetric", {"r1": [(1.0, 0.5), (9.0, 5.0)], "r2": [(1.0, 0.02), (10.0, 0.02)]})
    (short,) = shortfalls(BELLOWS, rows, "axisymmetric", "r2")  # 1 %
    assert short.row is rows[2] and short.reached_percent == pytest.approx(2.0)
    found = marked(rows, (short,))
    assert [r.status.split(":")[0] for r in found] == ["reached", "reached", NOT_MET, "reached"]
    assert found[2].status == f"{NOT_MET}: ± 2.01 % reached, 1 % asked" and is_reached(found[2])
    said = sentence(BELLOWS, (short,), 2)
    assert "tip_mm at 1 kPa: ± 2.01 % reached on axisymmetric r2; 1 of 2 values miss it" in said


def test_near_zero_it_is_a_share_of_a_hundredth_of_the_largest() -> None:
    def missed(small: float, spread: float) -> bool:
        levels = {"r1": [(0.0, 1.0), (9.0, 5.0)], "r2": [(small, spread), (-10.0, 0.01)]}
        rows = rows_of("tip_mm", "axisymmetric", levels)
        return bool(shortfalls(BELLOWS, rows, "axisymmetric", "r2"))

    # of 10 mm a hundredth is 0.1 mm, of which 1 % is 0.001 mm
    assert not missed(1e-5, 0.0009) and not missed(0.0, 0.0009)
    assert missed(1e-5, 0.0011) and missed(0.0, 0.0011)
    assert missed(0.2, 0.0021)


def test_zero_that_all_meshes_find_is_certain() -> None:
    rows = rows_of("tip_mm", "axisymmetric", {"r1": [(0.0, 0.0)], "r2": [(0.0, 0.0)]})
    assert not shortfalls(BELLOWS, rows, "axisymmetric", "r2")
    rows = rows_of("tip_mm", "axisymmetric", {"r1": [(0.1, 0.1)], "r2": [(0.0, 0.1)]})
    assert math.isinf(shortfalls(BELLOWS, rows, "axisymmetric", "r2")[0].reached_percent)


def test_a_value_that_no_other_mesh_confirms_is_not_certain() -> None:
    rows = rows_of("tip_mm", "axisymmetric", {"r1": [(math.nan, math.nan)], "r2": [(1.0, math.nan)]})
    (short,) = shortfalls(BELLOWS, rows, "axisymmetric", "r2")
    assert "no second mesh confirms it" in short.status
    assert "leave out the loads that other meshes do not reach" in sentence(BELLOWS, (short,), 1)


def test_what_was_not_reached_is_no_shortfall_its_status_says_why() -> None:
    rows = rows_of("tip_mm", "axisymmetric", {"r1": [(1.0, 0.001)], "r2": [(math.nan, math.nan)]})
    assert not shortfalls(BELLOWS, rows, "axisymmetric", "r2")


@pytest.mark.parametrize("which", ["none on the finest", "on the finest alone"])
def test_meshes_that_do_not_agree_whether_there_is_a_limit_point_are_not_certain(which: str) -> None:
    found = row("a", "limit_kpa", "kPa", math.nan, "axisymmetric", 25.0, "r1", 1e-5)
    none = row("a", "limit_kpa", "kPa", math.nan, "axisymmetric", math.nan, "r2", status="none up to 30 kPa")
    rows = [found, none]
    if which != "none on the finest":
        rows = [replace(none, level="r1"), replace(found, level="r2", uncertainty=math.nan)]
    (short,) = shortfalls(SPHERE, rows, "axisymmetric", "r2")
    assert math.isinf(short.reached_percent) and short.row.quantity == "limit_kpa"
    both_none = [replace(none, level="r1"), none]
    assert not shortfalls(SPHERE, both_none, "axisymmetric", "r2")


def test_more_than_a_hundred_percent_cannot_be_asked_for() -> None:
    rows = rows_of("tip_mm", "axisymmetric", {"r1": [(1.0, 9.0)], "r2": [(2.0, 9.0)]})
    said = sentence(BELLOWS, shortfalls(BELLOWS, rows, "axisymmetric", "r2"), 1)
    assert "± 452 % reached" in said and "tolerance_percent to" not in said and "smaller loads" in said


# --- finer meshes -------------------------------------------------------------------------------------------


def made(model: str, level: str, dofs: int, status: str = "reached") -> Any:
    return SimpleNamespace(summary=SimpleNamespace(model=model, level=level, dofs=dofs, status=status))


def test_a_finer_mesh_follows_if_it_is_small_enough_and_the_last_one_reached_its_loads() -> None:
    most = MOST_UNKNOWNS["axisymmetric"]
    runs = [made("axisymmetric", "r2", most // 20), made("axisymmetric", "r4", most // 5)]
    assert may_follow(runs, "r8", "axisymmetric") and not may_follow(runs, "r16", "axisymmetric")
    assert not may_follow([runs[0], made("axisymmetric", "r4", most // 5, "stopped")], "r8", "axisymmetric")
    assert not may_follow(runs[:1], "r4", "axisymmetric")


@pytest.mark.parametrize(
    ("model", "level", "of_meridian", "total", "flat", "wanted"),
    [
        ("full3d", "n8", 0.01, 0.1, ("r1", "r2"), BodyLevel(12, 1)),  # the cells round leave more
        ("sector", "n8", 0.01, 0.1, ("r1", "r2"), BodyLevel(16, 1)),  # pairs of cells in a quarter of a cap
        ("full3d", "n8", 0.08, 0.1, ("r1", "r2"), "r4"),  # the meridian does: known better first
        ("full3d", "n8", 0.08, 0.1, ("r1", "r2", "r4"), BodyLevel(8, 2)),
        ("full3d", "n8r2", 0.08, 0.1, ("r1", "r2", "r4"), "r8"),
        ("full3d", "n32", 0.01, 0.1, ("r1", "r2"), "r4"),  # no more of them: what else can be done
        ("full3d", "n32r2", 0.01, 0.1, ("r2", "r4", "r8"), BodyLevel(32, 4)),
    ],
)
def test_the_larger_part_of_a_bodys_error_is_made_smaller(model, level, of_meridian, total, flat, wanted) -> None:
    body = made(model, level, 20_000)
    runs = [made("axisymmetric", name, 300 * int(name[1:]) ** 2) for name in flat]
    rows = rows_of("tip_mm", "axisymmetric", {name: [(10.0, of_meridian)] for name in flat})
    rows += rows_of("tip_mm", model, {level: [(10.0, total)]})
    scene = BELLOWS.model_copy(update={"ask": BELLOWS.ask.model_copy(update={"tolerance_percent": 0.1})})
    missed = shortfalls(scene, rows, model, level)
    assert len(missed) == 1
    assert finer_body(scene, rows, runs, body, missed) == wanted
    assert finer_body(scene, rows, runs, body, ()) is None
    assert finer_body(scene, rows, runs, made(model, level, 20_000, "stopped"), missed) is None
    if isinstance(wanted, BodyLevel):
        large = [made("axisymmetric", run.summary.level, 1000 * run.summary.dofs) for run in runs]
        assert not isinstance(finer_body(scene, rows, large, body, missed), BodyLevel)


@pytest.mark.parametrize(
    ("of_meridian", "flat", "wanted"),
    [
        (0.01, ("r1",), BodyLevel(12, 1)),
        (0.08, ("r1",), "r2"),  # one mesh that tells its own error
        (0.08, ("r1", "r2", "r4"), "r8"),  # a body on r2 would have the same limit
    ],
)
def test_a_limit_is_known_better_by_finer_meridians_only(of_meridian, flat, wanted) -> None:
    body = made("full3d", "n8", 20_000)
    runs = [made("axisymmetric", name, 300 * int(name[1:]) ** 2) for name in flat]
    rows = rows_of("tip_mm", "axisymmetric", {**{n: [(10.0, 0.2)] for n in flat}, LIMIT: [(10.0, of_meridian)]})
    rows += rows_of("tip_mm", "full3d", {"n8": [(10.0, 0.2)], LIMIT: [(10.0, 0.1)]})
    scene = BELLOWS.model_copy(update={"ask": BELLOWS.ask.model_copy(update={"tolerance_percent": 0.1})})
    missed = shortfalls(scene, rows, "full3d", "n8")
    assert [short.row.level for short in missed] == [LIMIT]
    assert finer_body(scene, rows, runs, body, missed) == wanted


def test_a_meridian_that_reached_nothing_shows_no_error() -> None:
    none = [make_run(BELLOWS, "axisymmetric", level, lambda _, p: p, stop_kpa=0.0) for level in ("r1", "r2")]
    for runs in (none[:1], none):
        assert good_meridian(BELLOWS, runs, (1, 2)) is None
    body = make_run(BELLOWS, "full3d", "n8", lambda _, p: p, stop_kpa=0.0)
    assert expectation_rows(BELLOWS, [none[0], body]) == []


def test_a_body_that_would_be_too_large_has_fewer_cells() -> None:
    small, large = ([made("axisymmetric", "r1", dofs)] for dofs in (300, 30_000))
    assert first_body(BELLOWS, "full3d", BodyLevel(16, 2), small) == BodyLevel(16, 2)
    found = first_body(BELLOWS, "full3d", BodyLevel(16, 2), large)
    assert found.around <= 16 and found.meridian <= 2 and found != BodyLevel(16, 2)


def test_meshes_that_are_said_are_asked_for_no_tolerance() -> None:
    assert plan_bellows(BELLOWS, "full3d", (8,)).fixed
    assert plan_bellows(BELLOWS, "axisymmetric", every_level=True).fixed
    for model in (None, "axisymmetric", "full3d"):
        plan = make_plan(BELLOWS, model)
        assert not plan.fixed and plan.finer
        assert not plan.as_fixed().finer and plan.as_fixed().levels == plan.levels


def test_the_plan_says_how_far_it_goes() -> None:
    for scene in (BELLOWS, SPHERE):
        text = describe(scene, make_plan(scene))
        assert "of up to 1,000,000 unknowns; if it is not met then, the exit code is 3" in text
    fixed = plan_bellows(BELLOWS, "full3d", (8,))
    assert "is not met" not in describe(BELLOWS, fixed)
