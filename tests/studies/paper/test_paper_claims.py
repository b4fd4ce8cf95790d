"""Each statement of the paper is judged from the rows, in the reference and in the drawn sets."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from studies.paper.cases import REFERENCE_SCENES
from studies.paper.results import CaseResult, Four, PaperResults, no_row
from studies.paper.statements import judges, mechanism
from studies.paper.statements.claims import (
    IN_SETS,
    Claim,
    about_their_program,
    claims,
    claims_table,
    longest_at_highest,
    thicker_wall_shortens_alike,
)
from studies.paper.statements.verdicts import Verdict, above, all_of, below, over_sets, smaller
from studies.results.rows import Row, row
from studies.scene.dimension_sets import SLOTS
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
    assert (above((12.0, 1.0), 10.0), above((8.0, 1.0), 10.0), above((10.5, 1.0), 10.0)) == (HOLDS, FAILS, OPEN)
    assert (below((8.0, 1.0), 10.0), below((12.0, 1.0), 10.0), below((math.nan, 1.0), 10.0)) == (HOLDS, FAILS, OPEN)


def test_nine_of_ten_sets_have_to_agree_with_the_reference() -> None:
    hold: list[Verdict] = ["holds"]
    fail: list[Verdict] = ["does not hold"]
    open_: list[Verdict] = ["cannot tell"]
    assert over_sets("holds", []) == HOLDS
    assert over_sets("holds", hold * 9 + fail) == HOLDS
    assert over_sets("holds", hold * 8 + fail * 2) == OPEN
    assert over_sets("does not hold", fail * 9 + open_) == FAILS
    assert over_sets("does not hold", hold * 10) == OPEN
    assert over_sets("cannot tell", open_ * 10) == OPEN


# --- of one set -----------------------------------------------------------------------------


def reference(*cases: CaseResult) -> Four:
    return make_results(*cases).reference


def measured(**quantities: float | Callable[[str], float]) -> Four:
    """The reference with numbers that do not depend on the pressure; of each actuator, or of all."""
    found = []
    for name in REFERENCE_SCENES:
        values = {key: value(name) if callable(value) else value for key, value in quantities.items()}
        of_all = {key: (lambda p, value=value: value) for key, value in values.items()}
        found.append(make_case(case_of("core", name), measured=of_all))  # type: ignore[arg-type]
    return reference(*found)


def test_larger_root_shortens() -> None:
    found = judges.LARGER_ROOT_SHORTENS(reference(*core()))
    assert found.verdict == HOLDS
    assert "(t = 1 mm, " in found.pair  # 150 is 1.5 times 100, 70 is 1.56 times 45: the 1 mm pair is nearer
    turned = [case for case in core() if case.case.scene != "heung-t1-ri7"] + [scaled("heung-t1-ri7", 2.0)]
    found = judges.LARGER_ROOT_SHORTENS(reference(*turned))
    assert found.verdict == FAILS
    assert "(t = 1 mm, " in found.pair
    assert judges.LARGER_ROOT_SHORTENS(reference(*core()[:3])).verdict == OPEN


@pytest.mark.parametrize(("of_larger", "verdict"), [(4.0, HOLDS), (2.0, FAILS), (3.001, OPEN)])
def test_larger_root_bulges(of_larger: float, verdict: str) -> None:
    four = measured(root_bulge_mm=lambda name: of_larger if name.endswith("ri7") else 3.0)
    assert judges.LARGER_ROOT_BULGES(four).verdict == verdict


def test_thicker_wall_shortens() -> None:
    assert judges.THICKER_WALL_SHORTENS(reference(*core())).verdict == HOLDS
    turned = [scaled(name, 3.0 if "t2" in name else 1.0) for name in REFERENCE_SCENES]
    assert judges.THICKER_WALL_SHORTENS(reference(*turned)).verdict == FAILS
    assert judges.THICKER_WALL_SHORTENS(reference(*core()[:2])).verdict == OPEN


def test_rising_elongation() -> None:
    assert judges.rises(reference(*core())).verdict == HOLDS
    falling = judges.rises(reference(*core(tip=lambda level, p: 100.0 - p)))
    assert falling.verdict == FAILS
    assert falling.pair.startswith("85.00 ± 0.00 against 80.00 ± 0.00 mm")  # of its steps the largest fall in percent
    assert judges.rises(reference(*core(stop_kpa=12.0))).verdict == OPEN


def test_a_curve_that_bends_at_first() -> None:
    assert judges.bends_first(reference(*core())).verdict == HOLDS
    straight = reference(*core(tip=lambda level, p: p if p < 16.0 else 3.0 * p))
    assert judges.bends_first(straight).verdict == FAILS
    assert judges.bends_first(reference(*core(stop_kpa=12.0))).verdict == OPEN


def unfolding(value: float, status: str = "reached", uncertainty: float = 0.1) -> tuple[Row, ...]:
    return (row("demo", "unfolding_kpa", "kPa", math.nan, "axisymmetric", value, "r4", uncertainty, status=status),)


@pytest.mark.parametrize(
    ("rows", "verdict", "pair"),
    [
        (unfolding(18.0), HOLDS, "18.00 ± 0.10 against 20 kPa"),
        (unfolding(22.0), FAILS, "22.00 ± 0.10 against 20 kPa"),
        (unfolding(19.95), OPEN, "19.95 ± 0.10 against 20 kPa"),
        (unfolding(math.nan, "not reached up to 20 kPa"), FAILS, "not up to 20 against 20 kPa"),
        (unfolding(math.nan, "not reached up to 12.5 kPa"), OPEN, "–"),
        ((), OPEN, "–"),
    ],
)
def test_unfolding_by_20_kpa(rows: tuple[Row, ...], verdict: str, pair: str) -> None:
    found = judges.UNFOLDED(reference(make_case(case_of("core", REFERENCE_SCENES[0]), extra=rows)))
    assert (found.parts[0], found.pairs[0]) == (verdict, pair)
    assert found.parts[1:] == (OPEN,) * 3


# --- how it elongates -----------------------------------------------------------------------


@pytest.mark.parametrize(("share", "verdict"), [(0.8, HOLDS), (1.1, HOLDS), (0.3, FAILS), (0.5005, OPEN)])
def test_elongation_by_unfolding(share: float, verdict: str) -> None:
    found = mechanism.UNFOLDS(measured(unfolding_share=share))
    assert (found.verdict, found.parts) == (verdict, (verdict,) * 4)


def test_bulging_is_what_is_beyond_the_crests() -> None:
    # the folds are 5.5 and 3.5 mm deep: a bulge of 4 mm is beyond the crests of the larger roots, by a seventh of 3.5
    found = mechanism.HARDLY_BULGES(measured(root_bulge_mm=4.0))
    assert found.parts == (HOLDS, FAILS, HOLDS, FAILS)
    assert found.pair == "roots +0.50 mm from the crests' radius against +0.35 mm (t = 1 mm, larger R_i)"
    assert mechanism.HARDLY_BULGES(measured(root_bulge_mm=3.6)).verdict == HOLDS
    assert mechanism.HARDLY_BULGES(reference()).verdict == OPEN


@pytest.mark.parametrize(("root", "verdict"), [(1.6, HOLDS), (1.4, FAILS), (1.501, OPEN)])
def test_most_deformation_at_the_root(root: float, verdict: str) -> None:
    assert mechanism.MOST_AT_THE_ROOT(measured(root_stretch_outer=root, wall_stretch=1.5)).verdict == verdict


@pytest.mark.parametrize(
    ("share", "bulge", "root", "support"),
    [
        (0.8, 2.0, 1.6, "unfolding"),
        (0.3, 9.0, 1.6, "bulging"),
        (0.8, 9.0, 1.6, "bulging"),  # most of it unfolds, and yet the roots are beyond the crests
        (0.3, 2.0, 1.6, "neither alone"),
        (0.3, 9.0, 1.2, "neither alone"),
        (0.5, 2.0, 1.6, "cannot tell"),
    ],
)
def test_which_of_two_sentences_a_state_supports(share: float, bulge: float, root: float, support: str) -> None:
    four = measured(unfolding_share=share, root_bulge_mm=bulge, root_stretch_outer=root, wall_stretch=1.5)
    assert mechanism.supports(four) == (support,) * 4


def test_table_of_the_contradiction() -> None:
    def of(label: str, share: float) -> list[CaseResult]:
        names = [f"{label}-{slot}" for slot in SLOTS]
        values = {"unfolding_share": lambda p: share, "root_bulge_mm": lambda p: 0.1}
        return [make_case(case_of("sets", name), measured=values) for name in names]

    found = make_results(*core(), *of("corrected-01", 0.9), *of("corrected-02", 0.2), *of("balanced-01", 0.8))
    table = mechanism.contradiction(found, found.drawn("corrected", "balanced"))
    assert {line[-1] for line in table.rows} == {"unfolding 2, neither alone 1"}
    assert {line[-2] for line in table.rows} == {"cannot tell"}  # the reference was not measured
    empty = mechanism.contradiction(PaperResults(()), ())
    assert {cell for line in empty.rows for cell in line[1:7]} == {"–"}


def test_a_tip_that_bulges() -> None:
    def four(more: float) -> Four:
        found = []
        for name in REFERENCE_SCENES:
            rim = usual_tip(scene_of("core", name))("r4", 20.0)
            extra = row(name, "tip_centre_mm", "mm", 20.0, "axisymmetric", (1.0 + more) * rim, "r4")
            found.append(make_case(case_of("core", name), extra=(extra,)))
        return reference(*found)

    assert mechanism.STAYS_FLAT(four(0.005)).verdict == HOLDS
    bulging = mechanism.STAYS_FLAT(four(0.05))
    assert bulging.verdict == FAILS and "in the middle against" in bulging.pair


def test_beside_a_tube_of_its_length_and_elongation() -> None:
    # cavities of 86 mm; the longest elongates by 150 mm and would have a stretch of 2.74, the shortest of 1.52
    less = measured(peak_stretch_away=1.5, cavity_volume_ratio=2.0)
    assert mechanism.STRAINS_LESS(less).verdict == HOLDS
    assert mechanism.STRAINS_LESS(less).pair == "largest stretch 1.50 against 1.52 of the tube (t = 2 mm, larger R_i)"
    assert mechanism.GROWS_LESS(less).parts == (HOLDS, HOLDS, FAILS, FAILS)


# --- over the sets --------------------------------------------------------------------------


def sets_of(count: int, contrary: int) -> list[CaseResult]:
    """Drawn sets, of which some elongate less with the smaller root."""
    found = []
    for k in range(1, count + 1):
        for slot in SLOTS:
            name = f"corrected-{k:02d}-{slot}"
            tip = usual_tip(scene_of("sets", name))
            factor = 4.0 if slot.endswith("larger-ri") and k <= contrary else 1.0
            found.append(make_case(case_of("sets", name), lambda level, p, tip=tip, f=factor: f * tip(level, p)))  # type: ignore[misc]
    return found


def claim_of(results: PaperResults, name: str) -> Claim:
    (found,) = (claim for claim in claims(results) if claim.name == name)
    return found


def test_a_statement_is_counted_over_the_sets() -> None:
    name = "the larger root elongates less"
    alone = claim_of(make_results(*core()), name)
    assert (alone.verdict, alone.sets) == (HOLDS, "–")
    most = claim_of(make_results(*core(), *sets_of(10, 1)), name)
    assert (most.verdict, most.sets) == (HOLDS, "9 of 10")
    split = claim_of(make_results(*core(), *sets_of(4, 2)), name)
    assert (split.verdict, split.sets) == (OPEN, "2 of 4")
    assert split.reference.startswith("holds: ")


def test_statements_about_each_actuator_have_details() -> None:
    extra = unfolding(18.0)
    own = [make_case(case_of("core", name), extra=extra if "t1" in name else ()) for name in REFERENCE_SCENES]
    others = [make_case(case_of("sets", f"balanced-01-{slot}"), extra=extra) for slot in SLOTS]
    found = claim_of(make_results(*own, *others), "unfolded at 20 kPa")
    assert found.sets == "1 of 1"
    assert found.details[0].startswith("t = 1 mm, R_i = 5 mm: holds: 18.00 ± 0.10 against 20 kPa; holds in 1 of 1 sets")
    assert found.details[3].startswith("t = 2 mm, larger R_i: cannot tell; ")


def test_no_results_leave_all_open() -> None:
    found = claims(PaperResults(()))
    assert {claim.verdict for claim in found} == {OPEN}
    assert len(found) == len(IN_SETS) + 2 == len({claim.name for claim in found})
    table = claims_table(found)
    assert all(len(line) == len(table.header) for line in table.rows)
    assert {line[4] for line in table.rows} == {OPEN}


# --- of the reference alone -----------------------------------------------------------------


def test_thicker_wall_is_judged_in_one_silicone_too() -> None:
    swaps = [make_case(case) for case in ALL.values() if case.group == "silicone"]
    claim = thicker_wall_shortens_alike(make_results(*core(), *swaps))
    assert claim.verdict == HOLDS and claim.sets == "reference only"
    assert "Dragon Skin" in claim.reference
    stiffer = [scaled(case.case.scene, 0.3, "silicone") for case in swaps]  # thin ones in 30 shorter than thick ones
    assert thicker_wall_shortens_alike(make_results(*core(), *stiffer)).verdict == FAILS
    assert thicker_wall_shortens_alike(make_results(*core(), *swaps[:1])).verdict == OPEN


def test_longest_at_20_kpa() -> None:
    claim = longest_at_highest(make_results(*beyond()))
    assert claim.verdict == FAILS
    assert "mm at 30 kPa" in claim.reference
    bent = beyond(tip=lambda level, p: 100.0 - abs(p - 20.0))
    assert longest_at_highest(make_results(*bent)).verdict == HOLDS
    assert longest_at_highest(make_results(*beyond(stop_kpa=20.0))).verdict == OPEN


# --- about their program --------------------------------------------------------------------


def test_statements_about_ansys_are_told_beside_what_happens_here() -> None:
    cost, further, simulation, model = about_their_program(make_results(*core(iterations=lambda p: int(p)), *beyond()))
    assert "axisymmetric 20, 40, 60, 80; full 3D not run" in cost
    assert "t = 1 mm, R_i = 5 mm to 30 kPa; t = 1 mm, R_i = 7 mm to 30 kPa" in further
    assert simulation.endswith("as its columns say (−2.6, +0.2, −1.7, −2.5 cm).")
    assert model.endswith("as its columns say (−2.0, −1.0, +0.3, −1.0 cm).")
    assert "not run" in about_their_program(PaperResults(()))[1]


def test_printed_gaps_are_recomputed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("studies.paper.statements.claims.SIMULATION_GAP_CM", 2.4)
    assert "its columns say otherwise" in about_their_program(PaperResults(()))[2]
