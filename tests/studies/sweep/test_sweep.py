"""Sweeps: scenes from a file, refusals kept, nothing repeated, the same table on any number of ranks, the report."""

from __future__ import annotations

import dataclasses
import itertools
import math
import re
import shutil
import signal
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from mpi4py import MPI

from solvers.errors import SolverError
from studies.closed_form.tables import SILICONES
from studies.engine import Solved, render
from studies.models import axisymmetric
from studies.paper.cases import case_text, cases
from studies.progress import Progress
from studies.results.rows import read_rows
from studies.scene.sections import SceneError
from studies.scene.sweep import read_sweep
from studies.scene.text import changed_text
from studies.sweep import csv_table, farm
from studies.sweep.csv_table import CHAINS, SweepRow, read_table, write_table
from studies.sweep.designs import COUNT_KEY, OUTLINES, ROOT_KEY, WALL_KEY, Outline
from studies.sweep.farm import SweepOutcome, run_sweep
from studies.sweep.rules import Point, Rule, across, one_factor, two_factors
from studies.sweep.study import STUDY

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = Path(__file__).with_name("sweep_script.py")

# One convolution: half a second a scene. 9 mm has no room for its fold.
SMALL = """
base = "scenes/smoke-t2-ri5.toml"
[vary]
geometry.root_radius_mm = [5.0, 6.0, 9.0]
geometry.wall_mm = [1.0, 2.0]
geometry.convolutions = [1]
[ask]
pressure_kpa = [2.5, 5.0]
tolerance_percent = 5.0
"""
SOLVED, REFUSED = 4, 2


def write(folder: Path, text: str) -> Path:
    file = folder / "sweep.toml"
    file.write_text(text, encoding="utf-8")
    return file


def run(file: Path, out: Path) -> SweepOutcome:
    return run_sweep(file, out, MPI.COMM_SELF, Progress(MPI.COMM_SELF))


# --- the file -------------------------------------------------------------------------------


def test_every_value_with_every_other_or_one_after_the_other(tmp_path) -> None:
    values = 'base = "scenes/smoke-t2-ri5.toml"\ncombine = "{}"\n[vary]\ngeometry.wall_mm = [1.0, 1.5]\n'
    values += '"geometry.root_radius_mm" = [4.0, 5.0]\n'  # quoted or not, the key is the same
    found = {}
    for how in ("product", "zip"):
        variants = read_sweep(write(tmp_path, values.format(how)))
        scenes = [v.scene for v in variants if v.scene is not None]
        found[how] = [(s.geometry.wall_mm, s.geometry.root_radius_mm) for s in scenes]
        assert [tuple(v.values.values()) for v in variants] == found[how]
        assert len({v.name for v in variants}) == len(variants)
        assert all(v.scene is not None and v.scene.name == v.name for v in variants)
    assert found == {"product": [(1.0, 4.0), (1.0, 5.0), (1.5, 4.0), (1.5, 5.0)], "zip": [(1.0, 4.0), (1.5, 5.0)]}


def test_what_is_asked_is_asked_of_every_scene_and_the_rest_is_the_base(tmp_path) -> None:
    for variant in read_sweep(write(tmp_path, SMALL)):
        if variant.scene is not None:
            assert variant.scene.load.pressure_kpa == [2.5, 5.0]
            assert variant.scene.ask.tolerance_percent == 5.0
            assert not variant.scene.ask.fields
            assert variant.scene.geometry.crest_radius_mm == 10.5
            assert "# R_p" in variant.text  # comments stay


def test_tables_are_values_and_blocks_follow_each_other_with_a_scene_once(tmp_path) -> None:
    text = """
base = "scenes/smoke-t2-ri5.toml"
[[vary]]
material = [{ law = "neo-hooke", mu_kpa = 70.0 }, { law = "yeoh", c_kpa = [36.0, 2.5, 0.23] }]
[[vary]]
geometry.wall_mm = [1.0]
[[vary]]
geometry.wall_mm = [1.0, 1.5]
"""
    variants = read_sweep(write(tmp_path, text))
    laws = [v.scene.material.law for v in variants if v.scene is not None]
    assert laws == ["neo-hooke", "yeoh", "ogden", "ogden"]
    # a key that a block does not vary has the base's value there
    assert [v.values["geometry.wall_mm"] for v in variants] == [2.0, 2.0, 1.0, 1.5]


def test_names_stay_when_a_sweep_grows(tmp_path) -> None:
    few = [v.name for v in read_sweep(write(tmp_path, SMALL))]
    more = [v.name for v in read_sweep(write(tmp_path, SMALL.replace("[1.0, 2.0]", "[0.8, 1.0, 2.0]")))]
    assert set(few) < set(more)


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ('base = "nowhere.toml"\n[vary]\ngeometry.wall_mm = [1.0]', "nowhere.toml"),
        ('base = "scenes/smoke-t2-ri5.toml"\n[vary]\ngeometry.wal_mm = [1.0]', "did you mean wall_mm"),
        ('base = "scenes/smoke-t2-ri5.toml"\n[vary]\ngeometry.wall_mm.x = [1.0]', "no such key"),
        ('base = "scenes/smoke-t2-ri5.toml"\n[vary]\ngeometry.wall_mm = 1.0', "must be a list"),
        ('base = "scenes/smoke-t2-ri5.toml"\n[vary]\ngeometry.wall_mm = []', "must be a list"),
        ('base = "scenes/smoke-t2-ri5.toml"\n[vary]\nname = ["a"]', "not a key to vary"),
        ('base = "scenes/smoke-t2-ri5.toml"\n[vary]', "at least one key"),
        ('base = "scenes/smoke-t2-ri5.toml"', "vary: missing"),
        ('bass = "scenes/smoke-t2-ri5.toml"\n[vary]\ngeometry.wall_mm = [1.0]', "did you mean base"),
        (SMALL.replace("[vary]", 'combine = "zip"\n[vary]'), "same length"),
        (SMALL.replace("[ask]", "load.pressure_kpa = [[5.0]]\n[ask]"), "leave one of them out"),
        (SMALL.replace("[2.5, 5.0]", "[5.0, 2.5]"), "must ascend"),
    ],
)
def test_a_wrong_file_is_refused_with_its_reason_and_nothing_is_written(tmp_path, text, named) -> None:
    with pytest.raises(SceneError, match=named):
        run(write(tmp_path, text), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_scene_files_are_made_as_the_paper_study_makes_them() -> None:
    case = next(case for case in cases() if case.changes)
    base = (ROOT / "scenes" / f"{case.base}.toml").read_text(encoding="utf-8")
    assert changed_text(base, case.scene, case.changes) == case_text(case)


# --- running --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def done(tmp_path_factory) -> SimpleNamespace:
    """A small sweep, run on one rank."""
    folder = tmp_path_factory.mktemp("sweep")
    file, out = write(folder, SMALL), folder / "out"
    return SimpleNamespace(file=file, out=out, outcome=run(file, out))


@pytest.fixture
def solved(monkeypatch) -> list[str]:
    """Names of scenes that are really solved from here on."""
    names: list[str] = []
    real = axisymmetric._solve

    def count(scene, *rest):
        names.append(scene.name)
        return real(scene, *rest)

    monkeypatch.setattr(axisymmetric, "_solve", count)
    return names


def test_table_has_a_row_per_scene_and_pressure_and_keeps_refusals(done) -> None:
    rows = read_table(done.out / "sweep.csv")
    assert done.outcome.reached
    assert (done.outcome.scenes, done.outcome.refused) == (SOLVED + REFUSED, REFUSED)
    reached = [r for r in rows if r.status == "reached"]
    refused = [r for r in rows if r.status.startswith("refused: ")]
    assert (len(rows), len(reached), len(refused)) == (2 * SOLVED + REFUSED, 2 * SOLVED, REFUSED)
    assert all("two arcs need" in r.status and str(done.out) not in r.status for r in refused)
    assert [(r.values[ROOT_KEY], r.values[WALL_KEY]) for r in refused] == [(9.0, 1.0), (9.0, 2.0)]
    for r in reached:
        own = read_rows(done.out / "scenes" / r.scene / "rows.csv")
        tip = [x for x in own if (x.quantity, x.model, x.pressure_kpa) == ("tip_mm", "axisymmetric", r.pressure_kpa)][
            -1
        ]
        assert (r.axisymmetric, r.level) == (tip.value, tip.level)
        assert r.uncertainty == pytest.approx(tip.uncertainty, rel=1e-5)
        assert 0.0 < r.uncertainty < 0.05 * r.axisymmetric
        assert r.unstable_modes == 0.0
        for chain in CHAINS:
            value = next(x.value for x in own if (x.model, x.pressure_kpa) == (chain, r.pressure_kpa))
            assert getattr(r, chain) == value
            assert getattr(r, f"{chain}_percent") == pytest.approx(100.0 * (value / tip.value - 1.0), rel=1e-6)


def test_nothing_is_repeated_and_a_longer_sweep_solves_what_is_new(done, solved, tmp_path) -> None:
    out = tmp_path / "out"
    shutil.copytree(done.out, out)
    table = (out / "sweep.csv").read_bytes()
    assert run(done.file, out).solved_s == pytest.approx(done.outcome.solved_s)
    assert solved == []
    assert (out / "sweep.csv").read_bytes() == table
    more = run(write(tmp_path, SMALL.replace("[5.0, 6.0, 9.0]", "[5.0, 6.0, 6.5, 9.0]")), out)
    assert more.scenes == done.outcome.scenes + 2
    rows = read_table(out / "sweep.csv")
    assert set(solved) == {r.scene for r in rows if r.values[ROOT_KEY] == 6.5}
    assert [r for r in rows if r.values[ROOT_KEY] in (5.0, 6.0)] == read_table(done.out / "sweep.csv")[: 2 * SOLVED]


def test_scenes_that_fail_or_stop_are_rows_with_their_reasons(done, monkeypatch, tmp_path) -> None:
    run_plan, scene_rows = farm.run_plan, csv_table.bellows_rows

    def one_fails(scene, *rest):
        if (scene.geometry.root_radius_mm, scene.geometry.wall_mm) == (5.0, 1.0):
            raise SolverError("no memory\nleft")
        return run_plan(scene, *rest)

    def one_stops(scene, runs):
        rows = scene_rows(scene, runs)
        if (scene.geometry.root_radius_mm, scene.geometry.wall_mm) != (5.0, 2.0):
            return rows
        why: dict[str, Any] = {"value": math.nan, "uncertainty": math.nan, "status": "stopped at 3.00 kPa: limit point"}
        at_5 = [(r.model, r.pressure_kpa) == ("axisymmetric", 5.0) for r in rows]
        return [dataclasses.replace(r, **why) if hit else r for r, hit in zip(rows, at_5, strict=True)]

    monkeypatch.setattr(farm, "run_plan", one_fails)
    monkeypatch.setattr(csv_table, "bellows_rows", one_stops)
    out = tmp_path / "out"
    shutil.copytree(done.out, out)
    outcome = run(done.file, out)
    assert (outcome.failed, outcome.stopped, outcome.reached) == (1, 1, False)
    rows = read_table(out / "sweep.csv")
    failed, stopped = rows[:2], rows[2:4]
    assert [r.status for r in failed] == ["failed: no memory left"] * 2
    assert [r.status for r in stopped] == ["reached", "stopped at 3.00 kPa: limit point"]
    for r in (*failed, stopped[1]):
        assert r.closed_form > 0.0 and math.isnan(r.axisymmetric) and math.isnan(r.closed_form_percent)


def test_a_killed_sweep_goes_on(python, done, tmp_path) -> None:
    out = tmp_path / "out"
    process = python.start(1, SCRIPT, done.file, out)
    while len(list(out.glob("scenes/*/rows.csv"))) < 2 and process.poll() is None:
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    first = {path: path.stat().st_mtime_ns for path in out.glob("scenes/*/*/summary.json")}
    assert 2 <= len(first) < SOLVED  # killed in between
    python.run(1, SCRIPT, done.file, out)
    assert (out / "sweep.csv").read_bytes() == (done.out / "sweep.csv").read_bytes()
    assert {path: path.stat().st_mtime_ns for path in first} == first


@pytest.mark.parametrize("ranks", [2, 3])
def test_more_ranks_give_the_same_table(python, done, tmp_path, ranks) -> None:
    assert python.run(ranks, SCRIPT, done.file, tmp_path / "out") == f"{SOLVED + REFUSED} {ranks}\n"
    assert (tmp_path / "out" / "sweep.csv").read_bytes() == (done.out / "sweep.csv").read_bytes()


def test_a_wrong_file_ends_all_ranks(python, tmp_path) -> None:
    file = write(tmp_path, SMALL.replace("wall_mm", "wal_mm"))
    process = python.start(2, SCRIPT, file, tmp_path / "out")
    _, said = process.communicate(timeout=60)
    assert process.returncode != 0
    assert "did you mean wall_mm" in said
    assert not (tmp_path / "out").exists()


def test_table_survives_the_round_trip(tmp_path) -> None:
    values = {
        "material": {"law": "yeoh", "kappa_over_mu": math.inf},
        "mesh.element": "hex",
        WALL_KEY: 0.25,
        "a.b": None,
    }
    rows = [
        SweepRow("one", values, 5.0, "tip_mm", "mm", closed_form=1.5, level="r2", unstable_modes=0.0),
        SweepRow("two", values, 10.0, status="refused: a, b; c"),
    ]
    write_table(tmp_path / "sweep.csv", rows)
    assert repr(read_table(tmp_path / "sweep.csv")) == repr(rows)


# --- rules and report -----------------------------------------------------------------------


def points(factor, silicones=("a", "b")) -> list[Point]:
    """Made-up points whose finite elements are the free-pitch chain times a factor of the load."""
    return [
        Point(s, 8, load, {"closed_form": 1.0 + load, "closed_form_balanced": 7.0, "closed_form_seat": 2.0}, 2.0 * of)
        for s in silicones
        for load in (0.2, 0.4, 0.8, 1.6, 3.2)
        for of in [factor(load)]
    ]


def test_rules_find_the_factors_that_points_were_made_with() -> None:
    assert one_factor("closed_form_seat", points(lambda _: 1.35)) == Rule("closed_form_seat", 0.0, 1.35, 1.35)
    made = points(lambda load: 1.8 if load < 0.7 else 1.2)
    found = two_factors("closed_form_seat", made)
    assert (found.below, found.above) == (1.8, 1.2)
    assert 0.4 < found.split <= 0.8
    assert found.hits(made) == 1.0
    assert one_factor("closed_form_seat", made).hits(made) == 0.6
    assert across("closed_form_seat", made, split=True) == 1.0


def test_a_rule_of_one_silicone_is_tried_on_the_other() -> None:
    made = [*points(lambda _: 1.2, ("a",)), *points(lambda _: 1.7, ("b",))]
    assert across("closed_form_seat", made, split=False) == 0.0


@pytest.fixture(scope="module")
def report(tmp_path_factory) -> SimpleNamespace:
    """The report of a made-up sweep: finite elements are 1.25 times the free-pitch chain, one design is refused."""
    folder = tmp_path_factory.mktemp("report")
    laws = [{"law": "yeoh"}, {"law": "ogden"}]
    rows: list[SweepRow] = []
    grid = itertools.product(laws, (4.0, 5.0), (0.5, 1.0), (4, 8))
    for law, root, wall, n in grid:
        values = {"material": law, ROOT_KEY: root, WALL_KEY: wall, COUNT_KEY: n}
        if (root, wall) == (5.0, 1.0):
            rows.append(SweepRow(f"s{len(rows)}", values, math.nan, status="refused: geometry: no room"))
            continue
        for pressure in (5.0, 10.0):
            tip = 0.1 * n * pressure / wall
            chains: dict[str, Any] = {
                "closed_form": tip * (0.95 if wall == 0.5 else 0.6),
                "closed_form_balanced": 0.5 * tip,
            }
            chains["closed_form_seat"] = tip / 1.25
            percents: dict[str, Any] = {
                f"{name}_percent": 100.0 * (value / tip - 1.0) for name, value in chains.items()
            }
            known: dict[str, Any] = {
                "axisymmetric": tip,
                "uncertainty": 0.003 * tip,
                "level": "r2",
                "unstable_modes": 0.0,
            }
            known["unfolding_kpa"] = 7.5
            rows.append(SweepRow(f"s{len(rows)}", values, pressure, "tip_mm", "mm", **known, **chains, **percents))
    (folder / OUTLINES[0].name).mkdir()
    write_table(folder / OUTLINES[0].name / "sweep.csv", rows)
    assert render(STUDY, folder, [Solved(OUTLINES[0], SweepOutcome(16, 4, 0, 0, 0, 2, 12.0, 20.0))]) == 0
    return SimpleNamespace(folder=folder, text=" ".join((folder / "report.md").read_text(encoding="utf-8").split()))


def test_report_says_where_the_closed_form_misleads(report) -> None:
    # walls of 1 mm are 40 % off, those of 0.5 mm 5 %: one design of three, both silicones and pressures
    assert "more than 10 % off at 4 of 12 states (33 %" in report.text
    assert "| as moulded: fillets 0.5, seats 4 mm | 12 | −5.0 (−40.0 to −5.0) | 4 | 0 |" in report.text
    assert "within 10 % at 8 of 8 states with t = 0.5 mm." in report.text
    assert "at most 0.30 %" in report.text
    assert "multiply its elongation by 1.25" in report.text
    assert "at 100 % of the states it was found on and 100 % of those with other numbers" in report.text
    assert "| 5, 1 | geometry: no room |" in report.text
    for name in SILICONES.values():
        assert f"| {name} | fully unfolded | 3 |" in report.text


def test_rows_are_the_finite_elements_and_the_closed_forms_against_them(report) -> None:
    rows = read_rows(report.folder / "rows.csv")
    tips = [r for r in read_table(report.folder / OUTLINES[0].name / "sweep.csv") if r.status == "reached"]
    found = [r.value for r in rows if r.model == "axisymmetric" and r.status == "reached"]
    assert found == [r.axisymmetric for r in tips]
    for chain in CHAINS:
        found = [r.error_percent for r in rows if r.model == chain]
        assert found == pytest.approx([r.percent(chain) for r in tips], abs=1e-6)
    assert [r.status for r in rows if not r.value > 0.0] == ["refused: geometry: no room"] * 4


def test_report_has_its_pictures_and_a_page_of_one_file(report) -> None:
    pictures = {path.name for path in (report.folder / "pictures").iterdir()}
    names = ("elongation", "closed-form", "closed-form-balanced", "closed-form-seat")
    assert pictures == {f"moulded-{name}.png" for name in names}
    assert all(f"(pictures/{name})" in report.text for name in pictures)
    page = (report.folder / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == len(pictures)
    assert re.search(r"\bnan\b", report.text) is None


@pytest.mark.parametrize(("outline", "fillet_and_seat"), zip(OUTLINES, [(0.5, 4.0), (0.1, 0.5)], strict=True))
def test_the_studys_sweeps_are_what_the_report_is_about(outline: Outline, fillet_and_seat: tuple[float, float]) -> None:
    variants = read_sweep(outline.file)
    assert all({ROOT_KEY, WALL_KEY, COUNT_KEY, "material"} == set(v.values) for v in variants)
    scenes = [v.scene for v in variants if v.scene is not None]
    assert {s.geometry.root_radius_mm for s in scenes} == {4.0, 5.0, 6.0, 7.0, 8.0, 9.0}
    assert {(s.geometry.fillet_mm, s.rings.seat_mm) for s in scenes} == {fillet_and_seat}
    assert {s.geometry.crest_radius_mm for s in scenes} == {10.5}
    assert {s.geometry.half_pitch_mm for s in scenes} == {5.0}
    assert {s.geometry.convolutions for s in scenes} == {4, 8, 12}
    assert {s.material.law for s in scenes} == {"yeoh", "ogden"}
    assert {tuple(s.load.pressure_kpa) for s in scenes} == {(5.0, 10.0, 20.0)}
