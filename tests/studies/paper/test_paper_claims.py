"""Each claim of the paper is judged from the rows: it holds, does not hold, or cannot be told."""

from __future__ import annotations

import math

import pytest

from studies.paper.cases import ALTERNATE_SCENES, REFERENCE_SCENES
from studies.paper.claims import (
    bends_first,
    claims,
    cost_rises,
    larger_root_bulges,
    larger_root_shortens,
    longest_at_highest,
    model_gap,
    none_beyond,
    rises_with_pressure,
    simulation_gap,
    straight_last,
    thicker_wall_shortens,
    thicker_wall_shortens_alike,
    unfolded_at_highest,
)
from studies.paper.results import CaseResult, PaperResults, no_row
from studies.paper.verdicts import above, all_of, below, over_sets, smaller
from studies.results.rows import Row, row
from tests.studies.paper.paper_demo import ALL, case_of, make_case, make_results, scene_of, usual_tip

HOLDS, FAILS, OPEN = "holds", "does not hold", "cannot tell"


def number(value: float, uncertainty: float = 0.1) -> Row:
    return row("demo", "tip_mm", "mm", 20.0, "axisymmetric", value, "r4", uncertainty)


def core(**more) -> list[CaseResult]:
    return [make_case(case_of("core", name), **more) for name in REFERENCE_SCENES]


def beyond(**more) -> list[CaseResult]:
    return [make_case(case_of("beyond", f"{name}-to-30"), **more) for name in REFERENCE_SCENES]


def scaled(name: str, factor: float, group: str = "core") -> CaseResult:
    tip = usual_tip(scene_of(group, name))
    return make_case(case_of(group, name), tip=lambda level, p: factor * tip(level, p))


@pytest.mark.parametrize(
    ("one", "other", "verdict"),
    [
        (number(1.0), number(2.0), HOLDS),
        (number(2.0), number(1.0), FAILS),
        (number(1.0), number(1.15), OPEN),
        (number(1.0, math.nan), number(2.0), OPEN),
        (number(math.nan), number(2.0), OPEN),
        (no_row(), number(2.0), OPEN),
    ],
)
def test_a_difference_within_the_uncertainties_decides_nothing(one: Row, other: Row, verdict: str) -> None:
    assert smaller(one, other) == verdict


def test_several_verdicts_make_one() -> None:
    assert all_of(["holds", "holds"]) == HOLDS
    assert all_of(["holds", "cannot tell", "does not hold"]) == FAILS
    assert all_of(["holds", "cannot tell"]) == OPEN
    assert all_of([]) == OPEN
    assert over_sets(["holds", "cannot tell"]) == HOLDS
    assert over_sets(["holds", "does not hold"]) == OPEN
    assert (above((12.0, 1.0), 10.0), above((8.0, 1.0), 10.0), above((10.5, 1.0), 10.0)) == (HOLDS, FAILS, OPEN)
    assert (below((8.0, 1.0), 10.0), below((12.0, 1.0), 10.0), below((math.nan, 1.0), 10.0)) == (HOLDS, FAILS, OPEN)


def test_no_results_leave_all_that_is_not_printed_open() -> None:
    found = claims(PaperResults(()))
    assert {claim.verdict for claim in found[:-2]} == {OPEN}
    assert [claim.verdict for claim in found[-2:]] == [HOLDS, HOLDS]


def test_larger_root_shortens() -> None:
    claim = larger_root_shortens(make_results(*core()))
    assert claim.verdict == HOLDS
    assert "heung-t1-ri7 100.0" in claim.finding and "alternate a: no numbers" in claim.finding
    turned = [case for case in core() if case.case.scene != "heung-t1-ri7"] + [scaled("heung-t1-ri7", 2.0)]
    claim = larger_root_shortens(make_results(*turned))
    assert claim.verdict == FAILS
    assert "the other way round: heung-t1-ri7 at 5 kPa" in claim.finding
    assert larger_root_shortens(make_results(*core()[:3])).verdict == OPEN


def test_sets_that_contradict_each_other_leave_a_claim_open() -> None:
    alternates = [make_case(case_of("alternates", name)) for name in ALTERNATE_SCENES]
    assert larger_root_shortens(make_results(*core(), *alternates)).verdict == HOLDS
    contrary = [scaled(name, 3.0 if "ri8" in name else 1.0, "alternates") for name in ALTERNATE_SCENES]
    claim = larger_root_shortens(make_results(*core(), *contrary))
    assert claim.verdict == OPEN
    assert "reference holds" in claim.finding and "alternate a does not hold" in claim.finding


def test_larger_root_bulges() -> None:
    def results(of_larger: float) -> PaperResults:
        def bulge(name: str) -> float:
            return of_larger if name.endswith("ri7") else 3.0

        return make_results(
            *(
                make_case(case_of("core", name), measured={"root_bulge_mm": lambda p, name=name: bulge(name)})  # type: ignore[misc]
                for name in REFERENCE_SCENES
            )
        )

    assert larger_root_bulges(results(4.0)).verdict == HOLDS
    assert larger_root_bulges(results(2.0)).verdict == FAILS
    assert larger_root_bulges(results(3.001)).verdict == OPEN


def test_thicker_wall_shortens() -> None:
    assert thicker_wall_shortens(make_results(*core())).verdict == HOLDS
    turned = [scaled(name, 3.0 if "t2" in name else 1.0) for name in REFERENCE_SCENES]
    assert thicker_wall_shortens(make_results(*turned)).verdict == FAILS
    assert thicker_wall_shortens(make_results(*core()[:2])).verdict == OPEN


def test_thicker_wall_is_judged_in_one_silicone_too() -> None:
    swaps = [make_case(case) for case in ALL.values() if case.group == "silicone"]
    claim = thicker_wall_shortens_alike(make_results(*core(), *swaps))
    assert claim.verdict == HOLDS
    assert "both in Dragon Skin 30" in claim.finding
    stiffer = [scaled(case.case.scene, 0.3, "silicone") for case in swaps]  # thin ones in 30 shorter than thick ones
    assert thicker_wall_shortens_alike(make_results(*core(), *stiffer)).verdict == FAILS
    assert thicker_wall_shortens_alike(make_results(*core(), *swaps[:1])).verdict == OPEN


def test_rising_elongation() -> None:
    assert rises_with_pressure(make_results(*core())).verdict == HOLDS
    falling = core(tip=lambda level, p: 100.0 - p)
    assert rises_with_pressure(make_results(*falling)).verdict == FAILS
    assert rises_with_pressure(make_results(*core(stop_kpa=12.0))).verdict == OPEN


def test_bend_at_first_and_straight_at_the_end() -> None:
    results = make_results(*core())
    assert bends_first(results).verdict == HOLDS
    assert straight_last(results).verdict == HOLDS
    bent = make_results(*core(tip=lambda level, p: 0.1 * p**2))
    assert straight_last(bent).verdict == FAILS
    straight = make_results(*core(tip=lambda level, p: p if p < 16.0 else 3.0 * p))
    assert bends_first(straight).verdict == FAILS
    stopped = make_results(*core(stop_kpa=12.0))
    assert (bends_first(stopped).verdict, straight_last(stopped).verdict) == (OPEN, OPEN)


def unfolding(value: float, status: str = "reached", uncertainty: float = 0.1) -> tuple[Row, ...]:
    found = row("demo", "unfolding_kpa", "kPa", math.nan, "axisymmetric", value, "r4", uncertainty, status=status)
    return (found, row("demo", "unfolding_kpa", "kPa", math.nan, "closed_form", 18.1))


@pytest.mark.parametrize(
    ("rows", "verdict"),
    [
        (unfolding(18.0), HOLDS),
        (unfolding(22.0), FAILS),
        (unfolding(19.95), OPEN),
        (unfolding(math.nan, "not reached up to 20 kPa"), FAILS),
        (unfolding(math.nan, "not reached up to 12.5 kPa"), OPEN),
        ((), OPEN),
    ],
)
def test_unfolding_by_20_kpa(rows: tuple[Row, ...], verdict: str) -> None:
    name = REFERENCE_SCENES[0]
    claim = unfolded_at_highest(make_results(make_case(case_of("core", name), extra=rows)), name)
    assert claim.verdict == verdict
    assert ("18.10 kPa" in claim.finding) == bool(rows)


def test_unfolding_is_looked_for_beyond_20_kpa() -> None:
    name = REFERENCE_SCENES[0]
    short = make_case(case_of("core", name), extra=unfolding(math.nan, "not reached up to 20 kPa"))
    further = make_case(case_of("beyond", f"{name}-to-30"), extra=unfolding(24.4))
    claim = unfolded_at_highest(make_results(short, further), name)
    assert claim.verdict == FAILS
    assert "24.40 ± 0.10 kPa" in claim.finding


def test_longest_at_20_kpa() -> None:
    assert longest_at_highest(make_results(*beyond())).verdict == FAILS
    bent = beyond(tip=lambda level, p: 100.0 - abs(p - 20.0))
    assert longest_at_highest(make_results(*bent)).verdict == HOLDS
    assert longest_at_highest(make_results(*beyond(stop_kpa=20.0))).verdict == OPEN


def test_cost_over_pressure() -> None:
    rising = make_results(*core(iterations=lambda p: int(p)))
    claim = cost_rises(rising, "axisymmetric")
    assert claim.verdict == HOLDS
    assert "20, 40, 60, 80 Newton iterations, 8.0, 8.0, 8.0, 8.0 s" in claim.finding
    assert cost_rises(rising, "full3d").verdict == OPEN
    assert cost_rises(make_results(*core()), "axisymmetric").verdict == FAILS
    mixed = make_results(*core(iterations=lambda p: {5.0: 4, 10.0: 9, 15.0: 5}.get(p, 7)))
    assert cost_rises(mixed, "axisymmetric").verdict == OPEN


def test_beyond_20_kpa() -> None:
    claim = none_beyond(make_results(*beyond()))
    assert claim.verdict == FAILS
    assert "heung-t1-ri5 to 30 kPa on level 1, level 2, level 4" in claim.finding
    stopped = none_beyond(make_results(*beyond(stop_kpa=20.0)))
    assert stopped.verdict == HOLDS
    assert "no convergence" in stopped.finding
    assert none_beyond(make_results(*beyond(stop_kpa=20.0)[:2])).verdict == OPEN


def test_printed_gaps_are_recomputed(monkeypatch: pytest.MonkeyPatch) -> None:
    results = make_results(*core())
    claim = simulation_gap(results)
    assert claim.verdict == HOLDS
    assert "-2.6, +0.2, -1.7, -2.5 cm" in claim.finding
    assert "+0.9, +2.4, +2.0, -0.3 cm" in claim.finding  # 15.0, 10.0, 7.0, 4.5 less the test
    assert model_gap(results).verdict == HOLDS
    monkeypatch.setattr("studies.paper.claims.SIMULATION_GAP_CM", 2.4)
    assert simulation_gap(results).verdict == FAILS
