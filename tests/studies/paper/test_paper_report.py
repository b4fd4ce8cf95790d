"""The paper study's report: its tables have the rows' numbers, and what is missing is a dash, never an exception."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from studies.engine import REACHED, Bar, render
from studies.paper import acceptance, audit, bonds, errors, public_constants, sets, study, summary, times, variants
from studies.paper.cases import REFERENCE_SCENES
from studies.paper.results import CaseResult, PaperResults, no_row
from studies.paper.statements.claims import claims
from studies.report.numbers import MISSING, measured_text
from studies.report.tables import Table
from studies.results.rows import read_rows, row
from tests.studies.paper.paper_demo import case_of, make_case, make_results, scene_of, usual_tip, whole

FIRST, CALLED = REFERENCE_SCENES[0], "t = 1 mm, R_i = 5 mm"
TABLES: tuple[Callable[[PaperResults], Table], ...] = (
    errors.answers,
    errors.centres,
    errors.closed_form_errors,
    errors.model_errors,
    errors.zigzag_models,
    errors.printed_errors,
    errors.assumptions,
    errors.unfoldings,
    audit.coverage,
    audit.misses,
    variants.dimension_swing,
    sets.spread,
    sets.chosen_alone,
    variants.conventions,
    variants.silicones,
    variants.silicone_effects,
    public_constants.elongations,
    variants.rings,
    variants.blocked,
    variants.beyond,
    variants.stretches,
    bonds.bonds,
    times.split,
    times.work,
    times.by_model,
)


def lines(table: Table) -> list[dict[str, str]]:
    return [dict(zip(table.header, cells, strict=True)) for cells in table.rows]


@pytest.fixture(scope="module")
def results() -> PaperResults:
    return whole()


@pytest.mark.parametrize("make", TABLES)
def test_no_table_needs_all_cases(make: Callable[[PaperResults], Table], results: PaperResults) -> None:
    for found in (PaperResults(()), PaperResults(results.cases[::3])):
        table = make(found)
        assert all(len(cells) == len(table.header) for cells in table.rows)


def test_answers_are_finite_elements_beside_the_closed_form(results: PaperResults) -> None:
    first = lines(errors.answers(results))[0]
    assert first["actuator"] == "t = 1 mm, R_i = 5 mm"
    # n8 is made from r1, 150 (1 + 0.004); less what that is above the meridians' limit, which is of order 2; the closed
    # form's 116.63 has no uncertainty
    assert first["closed form, mm"] == "116.63"
    for outline in (errors.MOULDED, errors.ZIGZAG):
        assert first[f"finite elements {outline}, mm"] == "150.00 ± 0.19"
        assert first[f"closed form less those {outline}, %"] == "−22.2"
    empty = lines(errors.answers(PaperResults(())))[0]
    assert set(empty.values()) == {"t = 1 mm, R_i = 5 mm", MISSING}


def test_the_middle_stands_beside_the_rim(results: PaperResults) -> None:
    (first, *_) = lines(errors.centres(results))
    # the middle is 2 mm ahead at 20 kPa in these made-up runs; over 0.79 mm of uncertainty
    assert (first["rim, mm"], first["middle, mm"]) == ("150.60 ± 0.79", "152.60")
    assert first["middle less rim, mm (%)"] == "+2.00 (+1.3 %)"
    assert first["over the uncertainty"] == "3"
    sentence = summary.in_short(results)["middle"]
    assert "2.0 to 2.0 mm further" in sentence and ", 3 to" in sentence


def test_errors_have_sign_uncertainty_and_percent(results: PaperResults) -> None:
    found = {line["model"]: line for line in lines(errors.printed_errors(results)) if line["actuator"] == CALLED}

    def gaps(model: str) -> list[str]:
        return [found[model][f"less {of}, mm (%)"] for of in ("ANSYS", "test")]

    # the limit is right, as the error is of one order; in doubt a third of the change from r1 to r4, (0.6 - 0.0375) / 3
    assert found["axisymmetric"]["elongation, mm"] == "150.00 ± 0.19"
    # 0.5 mm of the print and 0.19 mm of the meshes, rounded up
    assert gaps("axisymmetric") == ["+35.0 ± 0.7 (+30.4 %)", "+9.0 ± 0.7 (+6.4 %)"]
    assert gaps("paper: ANSYS") == [MISSING, "−26.0 ± 1.0 (−18.4 %)"]
    assert "folded back" in found["closed form as printed"]["elongation, mm"]
    assert gaps("closed form as printed") == [MISSING, MISSING]
    printed = [found[f"paper: {what}"]["elongation, mm"] for what in ("closed form", "ANSYS", "experiment")]
    assert printed == ["121", "115", "141"]
    counts = [found[model]["unstable modes"] for model in ("axisymmetric", "full 3D, tetrahedra", "paper: ANSYS")]
    assert counts == ["0", "0", MISSING]
    at_20 = lines(errors.closed_form_errors(results))[3]
    assert (at_20["pressure, kPa"], at_20["finite elements"]) == ("20", "full 3D")
    assert at_20["closed form, mm (%)"].startswith("−33.37 ± 0.19 (−22.2 %)")  # 116.63 less 150.00
    assert at_20["closed form as printed, mm (%)"] == "folded back"


def test_assumptions_stand_beside_the_models() -> None:
    extra = (row(FIRST, "root_stretch_outer", "1", 20.0, "closed_form", 1.5),)
    case = make_case(case_of("core", FIRST), measured={"root_stretch_outer": lambda p: 2.0}, extra=extra)
    (line,) = lines(errors.assumptions(make_results(case)))
    assert list(line.values())[2:] == ["2.00", "1.50", "−25.0"]
    # 0.001 of 2; exact but for rounding
    assert errors.assumptions_percent(make_results(case)) == pytest.approx(0.05, rel=1e-12)
    assert math.isnan(errors.assumptions_percent(PaperResults(())))


def test_mechanism_is_read_off_the_lowest_pressure() -> None:
    case = make_case(case_of("core", FIRST), measured={"wall_stretch": lambda p: 1.0 - 0.004 * p})
    sentence = summary.in_short(make_results(case))["mechanism"]
    # 150 (0.8 / 4 + 0.2 / 2) = 45 mm at 5 kPa
    assert "45 to 45 mm longer" in sentence and "0.98 to 0.98" in sentence
    assert "not been measured" in summary.in_short(PaperResults(()))["mechanism"]


def test_every_number_that_is_shown_is_counted(results: PaperResults) -> None:
    count = len(acceptance.bars(results))
    assert f"Of {count} numbers" in summary.in_short(results)["must_show"]


def test_numbers_have_the_decimals_of_their_uncertainty() -> None:
    def text(value: float, uncertainty: float, status: str = "reached") -> str:
        return measured_text(row("x", "q", "1", 20.0, "axisymmetric", value, "r4", uncertainty, status=status))

    assert text(24.379, 0.0064) == "24.3790 ± 0.0064"
    assert text(3.2, 2.4) == "3.2 ± 2.4"
    assert text(2.0, math.nan) == "2"
    assert text(math.nan, math.nan, "stopped at 3 kPa: why") == "stopped at 3 kPa"
    assert measured_text(no_row()) == MISSING


def test_bars_count_uncertainties_that_hold(results: PaperResults) -> None:
    found = {bar.wanted: bar for bar in acceptance.bars(results)}
    full = found[f"{FIRST}: uncertainty of full 3D at 20 kPa: at most 1 %"]
    # of the limit of r1, r2, r4: in doubt a third of the change from r1 to r4, 0.1875 mm of 150, rounded up; nothing
    # round the axis
    assert full == Bar(full.wanted, "0.13 %", True, decides=False)
    assert found[f"{FIRST}: axisymmetric from full 3D at 20 kPa: at most 0.5 %"].met
    # Four reference actuators and eight alternates have r8, at four pressures each.
    meridians = f"{audit.MERIDIANS}: level 4 by level 2, level 4, level 8: at least 95 %"
    assert found[meridians].found == "100.0 % (48 of 48)"
    solid = f"{audit.BODIES}: 8 cells round by level 2, level 4, level 8: at least 95 %"
    assert found[solid].found == "100.0 % (16 of 16)"
    finer = f"{audit.FINER_BODIES}: 8 cells round by 12 cells round, level 3: at least 95 %"
    assert found[finer].found == "100.0 % (4 of 4)"
    assert {bar.verdict for bar in acceptance.bars(PaperResults(()))} == {"not run"}


def test_only_pressures_that_are_not_reached_decide_the_exit_code(results: PaperResults) -> None:
    assert [bar.wanted for bar in acceptance.bars(results) if bar.decides] == [
        f"{name}: every requested pressure is reached" for name in REFERENCE_SCENES
    ]
    stopped = make_results(make_case(case_of("core", FIRST), stop_kpa=12.0))
    (missed,) = [bar for bar in acceptance.bars(stopped) if bar.missed]
    assert missed.found == "axisymmetric, level 4: no convergence | <at all>"


def test_the_limit_of_an_audit_has_an_order_that_theory_allows() -> None:
    sizes = (1 / 2, 1 / 4, 1 / 8)
    for order, taken in ((0.6, 1.0), (2.0, 2.0), (4.0, 3.0)):
        values = [1.0 - 2.0 ** (-order * k) for k in range(3)]
        last = values[2] - values[1]
        assert audit.limit(sizes, values)[0] == pytest.approx(values[2] + last / (2.0**taken - 1.0))
    # not monotone: both parts, 1 - h + h^3 on 1/2, 1/4, 1/8 of a scale on which it turns
    turning = [1.0 - h + 3.0 * h**3 for h in sizes]
    assert turning[0] > turning[1] < turning[2]
    value, how = audit.limit(sizes, turning)
    assert value == pytest.approx(1.0) and how == ", not monotone"


def test_an_uncertainty_that_does_not_hold_is_told() -> None:
    tip = usual_tip(scene_of("core", FIRST))
    case = make_case(case_of("core", FIRST), tip=lambda level, p: tip(level, p) + (1.0 if level == "r4" else 0.0))
    results = make_results(case)
    missed = lines(audit.misses(results))
    assert [line["pressure, kPa"] for line in missed] == ["5", "10", "15", "20"]
    assert {line["mesh"] for line in missed} == {"axisymmetric, level 2"}
    assert all("level 1, level 2, level 4, not monotone" in line["has to hold"] for line in missed)
    assert all(float(line["distance over ±"]) > 1.0 for line in missed)
    assert "not met" in [bar.verdict for bar in acceptance.bars(results)]
    (line,) = lines(audit.coverage(results))  # not monotone, so nothing is as observed
    assert (line["hold"], line["what"]) == ("0 of 4", f"{audit.MERIDIANS}: level 2 by level 1, level 2, level 4")
    assert line["worst miss, distance over ±"] == f"{max(float(m['distance over ±']) for m in missed):.2g}"


def test_range_over_the_sets_needs_all_of_them(results: PaperResults) -> None:
    line = lines(variants.dimension_swing(results))[3]
    assert (line["range, mm"], line["range, % of the reference"], line["paper: experiment, mm"]) == ("0.0", "0", "141")
    few = PaperResults(tuple(case for case in results.cases if case.case.group == "core"))
    assert lines(variants.dimension_swing(few))[3]["range, mm"] == MISSING


def bond(suffix: str, change: float, levels: tuple[str, ...] = ("r1", "r2", "r4")) -> CaseResult:
    case = case_of("bond", f"{FIRST}-{suffix}")
    tip = usual_tip(scene_of("bond", case.scene))
    slip = {"peak_slip_mm": lambda p: 0.5}
    return make_case(case, tip=lambda level, p: (1.0 + change) * tip(level, p), measured=slip, levels=levels)


def test_bonded_is_what_changes_the_tip_by_one_percent_at_most() -> None:
    rigid = bond("bond-rigid", 0.0)
    found = make_results(bond("bond-5-2-graded", 0.034), bond("bond-5-2", 0.009), rigid, bond("bond-seat-2", -0.02))
    found = make_results(*found.cases, bond("bond-meshed-pla", 0.0))
    graded, uniform = bonds.verdicts(found)  # another crest or a meshed ring is no softer bond
    assert (
        "model change from 5 kPa on: the tip changes by at most 3.4 %" in graded
        and "0.5000 ± 0.0010 mm at 30 kPa" in graded
    )
    assert "bonded: the tip changes by at most 0.9 %" in uniform
    (line, *_) = lines(bonds.bonds(found))
    assert (line["mesh"], line["reached, kPa"], line["from the rigid bond, %"]) == ("level 4", "30", "+3.4")
    two = make_results(bond("bond-5-2-graded", 0.0), bond("bond-rigid", 0.0, ("r1", "r2")))
    assert all("cannot tell" in sentence for sentence in bonds.verdicts(two))
    assert bonds.verdicts(make_results(bond("bond-5-2", 0.0))) == (
        f"{CALLED}, Sil-Poxy, 5 / 2 MPa/mm: cannot tell: not run",
    )
    assert bonds.verdicts(PaperResults(())) == ()


def test_convention_is_told_only_beyond_uncertainty_and_print() -> None:
    def mm(value: float, uncertainty: float = 0.1):
        return row("x", "tip_mm", "mm", 20.0, "axisymmetric", value, "r4", uncertainty)

    assert variants.nearer(mm(74.0), mm(40.0), mm(33.0)) == "μ/α"
    assert variants.nearer(mm(35.0), mm(40.0), mm(33.0)) == "2μ/α²"
    assert variants.nearer(mm(32.0), mm(34.1), mm(33.0)) == "cannot tell"
    assert variants.nearer(no_row(), mm(34.1), mm(33.0)) == MISSING


def test_what_stopped_is_shown_with_its_reason() -> None:
    case = make_case(case_of("beyond", f"{FIRST}-to-30"), stop_kpa=22.5)
    results = make_results(case)
    line = lines(variants.beyond(results))[0]
    assert (line["reached, kPa"], line["end"]) == ("22.5", "no convergence | <at all>")
    (sentence,) = summary.stops(results)
    assert "axisymmetric, level 1 at 22.5 kPa" in sentence and "no convergence" in sentence


def test_report_renders_all_and_nothing(tmp_path: Path, results: PaperResults, monkeypatch: pytest.MonkeyPatch) -> None:
    pictures = {name: "not asked for" for name in ("elongations", "states-demo", "figure4b")}
    monkeypatch.setattr(study, "draw_all", lambda folder, found: pictures)
    for name, found in (("all", results), ("some", PaperResults(results.cases[:3])), ("none", PaperResults(()))):
        monkeypatch.setattr(study, "read_results", lambda folder, cases, found=found: found)
        folder = tmp_path / name
        assert render(study.STUDY, folder) == REACHED
        text = (folder / "report.md").read_text(encoding="utf-8")
        assert "inferred" in text and "not asked for" in text
        assert "<table>" in (folder / "report.html").read_text(encoding="utf-8")
        assert len(read_rows(folder / "rows.csv")) == len(found.rows)
        for claim in claims(found):
            assert claim.verdict in text
        after = text.splitlines()
        assert all(not before for before, line in zip(after, after[1:], strict=False) if line.startswith("#"))
        body = [line for line in text.splitlines() if line.startswith("|")]
        assert body and not any("nan" in line.lower().split() for line in body)
