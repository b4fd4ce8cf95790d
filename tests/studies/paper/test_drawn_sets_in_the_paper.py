"""Drawn sets in the paper study: their scenes, the rows that are kept, quantiles, what is chosen alone, the picture."""

from __future__ import annotations

import dataclasses
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

from studies.paper import sets
from studies.paper.cases import DRAWN, REFERENCE_SCENES, case_text, cases
from studies.paper.drawing.sets import draw_sets
from studies.paper.results import CaseResult, PaperResults, _of_drawn
from studies.report.tables import Table
from studies.results.rows import row
from studies.scene.bellows import BellowsScene, dimensions_of, shape_of
from studies.scene.dimension_sets import SLOTS
from studies.scene.materials import law_of
from tests.studies.paper.paper_demo import case_of, make_case, make_results

TESTS_MM = (141.0, 76.0, 50.0, 48.0)


def of_set(label: str, tip_mm: float, stop_kpa: float = math.inf) -> list[CaseResult]:
    """The four of a set, each with a tip that is proportional to the pressure."""
    chosen = (case_of("sets", f"{label}-{slot}") for slot in SLOTS)
    levels = ("r1", "r2")
    return [make_case(case, lambda level, p: tip_mm * p / 20.0, stop_kpa, levels=levels) for case in chosen]


def core() -> list[CaseResult]:
    return [make_case(case_of("core", name), lambda level, p: 5.0 * p) for name in REFERENCE_SCENES]


def lines(table: Table) -> list[dict[str, str]]:
    return [dict(zip(table.header, cells, strict=True)) for cells in table.rows]


def corrected(*tips_mm: float) -> list[CaseResult]:
    return [case for k, tip in enumerate(tips_mm, 1) for case in of_set(f"corrected-{k:02d}", tip)]


def test_a_scene_is_the_actuator_of_its_set() -> None:
    found = {case.scene: case for case in cases("sets")}
    assert len(found) == 4 * len(DRAWN)
    for one in (DRAWN[0], DRAWN[-1], next(s for s in DRAWN if s.kind == "balanced")):
        for slot, actuator in zip(SLOTS, one.actuators, strict=True):
            scene = BellowsScene.model_validate(tomllib.loads(case_text(found[f"{one.name}-{slot}"])))
            assert dimensions_of(scene) == actuator.dimensions
            assert shape_of(scene) == one.shape(actuator)
            # the constants go through kPa in decimals
            here, there = (law.stress_difference(1.5, 1.0 / 1.5, 1.0) for law in (law_of(scene.material), actuator.law))
            assert here == pytest.approx(there, rel=1e-12)


def test_of_the_many_rows_those_that_are_shown_are_kept() -> None:
    case = case_of("sets", f"balanced-01-{SLOTS[0]}")
    made = make_case(case, levels=("r1", "r2"), measured={"wall_stretch": lambda p: 1.5})
    rows = [dataclasses.replace(r, level="r2") if r.quantity == "wall_stretch" else r for r in made.rows]
    kept = [(r.quantity, r.model, r.level, r.pressure_kpa) for r in _of_drawn(case, rows)]
    for p in (5.0, 10.0, 15.0, 20.0):
        assert ("tip_mm", "axisymmetric", "r2", p) in kept
        assert ("tip_mm", "closed_form_balanced", "", p) in kept
        assert (("wall_stretch", "axisymmetric", "r2", p) in kept) == (p == 20.0)
    assert not [r for r in kept if r[1] in ("closed_form", "closed_form_seat") or r[2] == "r1"]
    assert len(kept) == len(set(kept))


def test_a_set_counts_when_all_four_have_run() -> None:
    found = make_results(*of_set("corrected-01", 100.0), *of_set("balanced-01", 90.0)[:3])
    assert [four.label for four in found.drawn("corrected", "balanced")] == ["corrected-01"]
    assert found.drawn("balanced") == ()
    (four,) = found.drawn("corrected")
    assert [case.case.scene for case in four.cases] == [f"corrected-01-{slot}" for slot in SLOTS]


def test_quantiles_over_the_sets() -> None:
    found = lines(sets.spread(make_results(*core(), *corrected(100.0, 110.0, 120.0, 130.0, 140.0))))
    first = found[0]
    assert (first["actuator"], first["kPa"], first["sets"]) == ("t = 1 mm, R_i = 5 mm", "20", "5")
    # numpy's quantiles between five values that are 10 mm apart
    shown = [first[key] for key in ("least", "5 %", "25 %", "50 %", "75 %", "95 %", "largest", "reference")]
    assert shown == ["100.0", "102.0", "110.0", "120.0", "130.0", "138.0", "140.0", "100.0"]
    assert [line["kPa"] for line in found[:6]] == ["20"] * 3 + ["5"] * 3
    # every set's closed form is pinned to 121 mm within 5 %, its finite elements are 100 to 140 mm
    pinned = [float(found[1][key]) for key in ("least", "largest")]
    assert 115.0 <= pinned[0] <= pinned[1] <= 127.0
    gap = [float(found[2][key].replace("−", "-")) for key in ("least", "largest")]
    assert gap[0] < -10.0 and gap[1] > 15.0
    assert sets.spread(make_results(*core())).rows == ()


def test_what_is_chosen_alone() -> None:
    of_reference = [one for one in DRAWN if one.kind == "reference"]
    alone = [case for one in of_reference for case in of_set(one.name, 100.0 + 10.0 * one.fillet_mm)]
    found = lines(sets.chosen_alone(make_results(*core(), *corrected(90.0, 110.0), *alone)))
    line = found[0]
    assert line["rank correlation with the fillet"] == "+1.00"
    assert abs(float(line["rank correlation with the cap"].replace("−", "-"))) < 0.9
    values = np.array([100.0 + 10.0 * one.fillet_mm for one in of_reference])
    assert line["finite elements, mm"] == f"{values.min():.1f} to {values.max():.1f}"
    # the two other sets are 10 mm from their mean
    share = float(line["variance, % of that of all sets"])
    assert share == pytest.approx(100.0 * values.var() / 100.0, rel=0.05)  # two digits are shown
    assert sets.chosen_alone(make_results(*core(), *alone[:8])).rows == ()


def test_sentences_count_sets_from_the_test() -> None:
    stopped = of_set("balanced-02", 80.0, stop_kpa=12.0)
    results = make_results(*core(), *corrected(100.0, 60.0), *stopped)
    told = sets.sentences(results)
    assert "over 3 sets: t = 1 mm, R_i = 5 mm: −57.4 to −29.1 %" in told[0]
    # 60 mm is 57 % below 141 mm; 100 mm is 108 % above 48 mm
    assert "corrected-02, which is within 57 % of each" in told[1]
    assert "2 to 5 convolutions, 2 of 3 fewer than 5" in told[2]
    assert "Of 12 actuators 4 stopped before 20 kPa" in told[3] and "balanced-02-t2-ri5" in told[3]
    assert sets.sentences(make_results(*core())) == ()
    assert sets.swing_percent(results) == pytest.approx((-40.0, 0.0))
    assert math.isnan(sets.swing_percent(PaperResults(()))[0])


def test_axisymmetrically_unstable_sets_are_counted() -> None:
    cases_ = of_set("corrected-01", 100.0)
    rows = [r for r in cases_[0].rows if r.quantity != "unstable_modes"]
    one = row("x", "unstable_modes", "1", 20.0, "axisymmetric", 1.0, "r2")
    results = make_results(*core(), dataclasses.replace(cases_[0], rows=(*rows, one)), *cases_[1:])
    assert "; 1 are axisymmetrically unstable there" in sets.sentences(results)[3]


def test_picture(tmp_path: Path) -> None:
    assert draw_sets(tmp_path / "none.png", make_results(*core())) == "no drawn set has been run"
    assert draw_sets(tmp_path / "sets.png", make_results(*core(), *corrected(100.0, 110.0))) == ""
    assert (tmp_path / "sets.png").stat().st_size > 10_000
