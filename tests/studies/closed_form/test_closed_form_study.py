"""The closed-form study: its numbers against the equations solved one by one, its words against its numbers."""

from __future__ import annotations

import math
import re
import time
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from analytical.bellows.chains_by_name import CHAINS, CUTS, PRESSURES_KPA, SILICONES, path_of
from analytical.bellows.corrections import CORRECTIONS
from analytical.bellows.paper import actuators
from analytical.bellows.second_route import elongation_by_equations_mm
from studies import two_routes
from studies.closed_form import maps, materials, sentences, speed, tables
from studies.closed_form.effects import EFFECTS
from studies.closed_form.rows import actuator_rows, chain_rows
from studies.closed_form.study import STUDY
from studies.engine import run
from studies.report.tables import Table, as_text
from studies.results.rows import Row, read_rows

ACTUATORS = actuators()
every_actuator = pytest.mark.parametrize("actuator", ACTUATORS, ids=[actuator.name for actuator in ACTUATORS])
every_chain = pytest.mark.parametrize("model", CHAINS)


def lines(table: Table) -> list[dict[str, str]]:
    return [dict(zip(table.header, line, strict=True)) for line in table.rows]


def number(text: str) -> float:
    return float(text.replace("\N{MINUS SIGN}", "-"))


@pytest.fixture(scope="module")
def rows() -> list[Row]:
    return [entry for actuator in ACTUATORS for entry in actuator_rows(actuator)]


# --- chains, corrections, loads -------------------------------------------------------------


@every_actuator
@every_chain
def test_chain_table_is_what_the_equations_give_one_by_one(actuator, model) -> None:
    found = lines(tables.chain_table(actuator_rows(actuator)))
    heading = {"closed_form_printed": "closed form as printed", "closed_form": "closed form"}
    for line, pressure in zip(found, PRESSURES_KPA, strict=True):
        by_equations = elongation_by_equations_mm(actuator.dimensions, actuator.law, pressure, CHAINS[model])
        # two decimals are shown
        assert number(line[heading.get(model, "closed form, balanced")]) == pytest.approx(by_equations, abs=0.0051)
    assert [line["paper: experiment"] for line in found[:-1]] == ["–", "–", "–"]
    assert number(found[-1]["paper: closed form"]) == pytest.approx(10.0 * actuator.printed.closed_form_cm)


@every_actuator
def test_rows_hold_every_chain_and_output(actuator) -> None:
    rows = chain_rows(actuator)
    tips = [r for r in rows if r.quantity == "tip_mm" and not r.model.startswith("paper_")]
    assert len(tips) == (2 + len(CUTS)) * len(PRESSURES_KPA)
    compared = [r for r in tips if r.pressure_kpa == 20.0]
    assert all(r.reference == pytest.approx(10.0 * actuator.printed.closed_form_cm) for r in compared)
    forces = {(r.model, r.level, r.pressure_kpa): r.value for r in rows if r.quantity == "extension_force_n"}
    for r in rows:
        if r.quantity == "resistive_force_n":
            # equilibrium, to the round-off of the root finder
            assert r.value == pytest.approx(forces[r.model, r.level, r.pressure_kpa], rel=1e-12)


def test_states_and_what_rests_on_saturation() -> None:
    statuses = {
        (r.scene, r.model, r.pressure_kpa): r.status
        for actuator in ACTUATORS
        for r in chain_rows(actuator)
        if r.quantity == "tip_mm" and r.level in ("", "mean")
    }
    assert statuses["heung-t1-ri5", "closed_form", 20.0] == "reached, fully unfolded"
    assert statuses["heung-t1-ri7", "closed_form_printed", 10.0] == "reached, past the model"
    assert statuses["heung-t2-ri5", "closed_form_balanced", 20.0] == "reached"
    text = sentences.resting_on_saturation(ACTUATORS)
    assert "heung-t1-ri5 at 20 kPa and heung-t1-ri7 at 10, 15 and 20 kPa" in text
    assert "12.1 cm and 6.6 cm" in text and "t2" not in text
    assert "None" in sentences.resting_on_saturation(ACTUATORS[2:])
    assert sentences.warnings(ACTUATORS[2]) == []
    assert any("past the model" in text for text in sentences.warnings(ACTUATORS[1]))


def test_every_correction_is_told_and_those_with_numbers_have_their_effect(rows: list[Row]) -> None:
    told = lines(tables.correction_table())
    assert [line["correction"] for line in told] == [correction.name for correction in CORRECTIONS]
    effects = lines(tables.correction_effects(rows, ACTUATORS[:2]))
    with_numbers = [line["correction"] for line in told if line["effect on numbers"] == "see below"]
    assert [line["effect, cm"] for line in effects] == with_numbers
    (held,) = [line for line in effects if line["effect, cm"] == "full unfolding"]
    assert held["heung-t1-ri5, 5 kPa"] == "0"
    # 7.6 of 6.7 cm: without the rule the bellows would be shorter than at rest
    assert number(held["heung-t1-ri7, 20 kPa"]) > 6.7


def test_both_conventions_state_their_modulus() -> None:
    found = lines(tables.convention_table(ACTUATORS))
    moduli = {line["convention"]: line["initial shear modulus, kPa"] for line in found}
    # mu, and mu alpha / 2
    assert moduli == {"2mu/alpha^2": "75.45", "mu/alpha": f"{75.449 * 5.836 / 2.0:.2f}"}
    assert {line["actuator"] for line in found} == {"heung-t2-ri5", "heung-t2-ri7"}


def test_inverse_and_blocked_tip(rows: list[Row]) -> None:
    inverse = lines(tables.inverse_table(rows))
    assert len(inverse) == 2 * len(ACTUATORS)
    for line in inverse:
        asked = [re.fullmatch(r"([\d.]+) mm at ([\d.]+) kPa", line[share]) for share in ("25%", "50%", "75%")]
        pressures = [float(found[2]) for found in asked if found]
        assert len(pressures) == 3 and pressures == sorted(pressures) and pressures[-1] < 20.0
    held = lines(tables.held_table(rows))
    assert len(held) == len(inverse) * len(PRESSURES_KPA)
    for line in held:
        # the blocked wall is compressed and pushes along with the thrust
        assert float(line["tip force, N"]) > float(line["thrust alone, N"]) and float(line["λ_a"]) < 1.0


# --- validity -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("inside", "text"),
    [
        ([True] * 5, "everywhere"),
        ([False] * 5, "nowhere"),
        ([True, False, False, True, True], "up to 1 kPa and from 4 kPa"),
        ([False, True, True, False, False], "2 to 3 kPa"),
    ],
)
def test_intervals_in_words(inside, text) -> None:
    assert sentences.intervals(np.arange(1.0, 6.0), np.array(inside)) == text


def test_maps_have_the_actuators_own_numbers_at_their_places() -> None:
    for actuator in ACTUATORS:
        d = actuator.dimensions
        one = maps.silicone_maps(actuator.silicone)
        ratio, thickness = d.crest_radius_mm / d.root_radius_mm, d.wall_mm / d.root_radius_mm
        own = path_of(actuator, CHAINS["closed_form"], maps.MAP_PRESSURES_KPA)
        i = int(np.argmin(abs(maps.WALL_OVER_ROOT - thickness)))
        j = int(np.argmin(abs(maps.CREST_OVER_ROOT - ratio)))
        # R_p / R_i = 2.1 and 1.5 are on the grid; t / R_i to half of its step of 0.01, where the elongation changes by
        # less than 5 %
        assert maps.CREST_OVER_ROOT[j] == pytest.approx(ratio, rel=1e-12)
        assert one.plane.elongation_mm[i, j] == pytest.approx(own.elongation_mm, rel=0.05)


def test_effects_in_words_and_in_the_table_agree(rows: list[Row]) -> None:
    of_silicones = [maps.silicone_maps(silicone) for silicone in SILICONES]
    for effect, line in zip(EFFECTS, lines(tables.change_table(rows, ACTUATORS)), strict=True):
        assert line["change, %"] == effect.title
        first, *rest = sentences.where_large(effect, ACTUATORS, of_silicones)
        assert len(rest) == len(of_silicones)
        for actuator in ACTUATORS:
            (words,) = re.findall(rf"{actuator.name}: ([^;]+?)(?:;|\.$)", first)
            large = abs(number(line[f"{actuator.name}, 20 kPa"])) > sentences.LIMIT_PERCENT
            # none of the intervals ends between 20 kPa and the end of the sweep
            assert large == (words == "everywhere" or "from" in words)


def test_actuators_are_marked_on_the_maps_of_their_silicone() -> None:
    thin, thick = (maps.places(silicone, ACTUATORS) for silicone in SILICONES)
    assert list(thin) == ["t1-ri5", "t1-ri7"]
    assert thick == {"t2-ri5": pytest.approx((0.4, 2.1)), "t2-ri7": pytest.approx((2.0 / 7.0, 1.5))}


# --- material laws, exact solutions, benchmark ----------------------------------------------


def test_material_tables() -> None:
    constants = lines(materials.constants_table())
    assert [line["initial shear modulus, kPa"] for line in constants] == ["72.00", "75.45", "220.16"]
    # known figures of the 100 % modulus of both conventions
    assert [line["nominal stress at 100 % elongation, kPa"] for line in constants[1:]] == ["737", "2150"]
    *stable, refused = lines(materials.stability_table())
    assert {line["result"] for line in stable} == {"stable in all three tests"}
    assert "softens in equibiaxial extension at stretch 1.7" in refused["result"]
    assert all(stress.shape == (300,) for test in materials.curves_kpa().values() for stress in test.values())


def test_every_exact_solution_has_two_routes_that_agree() -> None:
    found = two_routes.all_routes()
    assert {one.law for one in found} == set(two_routes.LAWS)
    assert len(found) == len(two_routes.table(found).rows) == len(two_routes.rows(found))
    for one in found:
        assert one.difference <= two_routes.GOAL, one
        assert one.routes[0] != one.routes[1]


@every_chain
@pytest.mark.parametrize("silicone", SILICONES)
def test_benchmark_compares_with_the_equations(model, silicone) -> None:
    designs = speed.random_designs(40, seed=1)
    found = speed.measure(speed.Case(model, silicone), designs, repetitions=2, sample=20)
    assert len(found.per_second) == 2 and min(found.per_second) > 0.0
    # both routes at round-off; short elongations are differences of lengths ten times as long
    assert 0.0 <= found.median_error <= found.largest_error < 1e-11


def test_benchmark_designs_repeat_and_stay_in_range() -> None:
    one, other = (speed.random_designs(100, speed.SEED) for _ in range(2))
    assert np.array_equal(one.root_radius_mm, other.root_radius_mm)
    ratio = np.asarray(one.wall_mm) / np.asarray(one.root_radius_mm)
    assert ratio.min() >= speed.RANGES["t/R_i"][0] and ratio.max() <= speed.RANGES["t/R_i"][1]


def test_table_as_text_lines_up() -> None:
    text = as_text(Table(("name", "number"), (("a", "1"), ("longer", "12")), left=(0,)))
    assert text.splitlines() == ["name    number", "a            1", "longer      12"]


def test_benchmark_report_names_speed_and_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speed, "DESIGNS", 20)
    assert run(speed.STUDY, tmp_path, MPI.COMM_WORLD, {}) == 0
    found = read_rows(tmp_path / "rows.csv")
    assert {r.model for r in found} == set(CHAINS) and {r.scene for r in found} == set(SILICONES.values())
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "20 random designs" in text and text.count("| Dragon Skin 10 |") == len(CHAINS)


# --- the report -----------------------------------------------------------------------------


@pytest.mark.slow
def test_the_whole_study_is_written_in_less_than_a_minute(tmp_path: Path) -> None:
    begin = time.perf_counter()
    assert run(STUDY, tmp_path, MPI.COMM_WORLD, {}) == 0
    assert time.perf_counter() - begin < 60.0
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    addresses = re.findall(r"\]\(([^)#]+)\)", text)
    assert "rows.csv" in addresses and len(addresses) == 1 + 4 + len(EFFECTS) + 1
    assert all((tmp_path / address).is_file() for address in addresses)
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert all(source.startswith("data:image/png;base64,") for source in re.findall(r'src="([^"]{0,40})', html))
    assert html.count("<table>") == text.count("\n| ---:") + text.count("\n| :---")
    assert not re.search(r"&amp;lt;|&lt;su[bp]|nan\b|{{", html)
    anchors = re.findall(r"\]\(#([^)]+)\)", text)
    assert len(anchors) == 4 and all(f'<a id="{anchor}"></a>' in text for anchor in anchors)
    written = read_rows(tmp_path / "rows.csv")
    assert {r.scene for r in written} >= {actuator.name for actuator in ACTUATORS}
    missing = [r for r in written if math.isnan(r.value)]
    # only the correction whose print cannot be evaluated
    assert {(r.quantity, r.level) for r in missing} == {("correction_effect_cm", "sign of the pressure")}
