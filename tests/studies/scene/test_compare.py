"""Measured values in a scene: read from a file, solved for, kept beside the results, refused where they do not fit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from bellowsx import Scene, solve
from studies.report.scene_page import report_of
from studies.report.scenes import answer
from studies.results.runs import run_hash
from studies.scene.bellows import BellowsScene
from studies.scene.compare import pressures_with
from studies.scene.load import kept_scene, load_bellows
from studies.scene.sections import SceneError

SCENE = """
name = "mine"
geometry = {kind = "bellows", root_radius_mm = 5, outer_diameter_mm = 25, wall_mm = 2, pitch_mm = 10, convolutions = 1}
material = {law = "yeoh", c_kpa = [36.0, 2.5, 0.23]}
ask = {modes = false}
compare = {file = "test.csv"}
"""
FILE = "# one actuator, twice\npressure_kpa; tip_mm; by\n0; 0; A\n2; 2.0; A\n2; 2.2; B\n4; 3.9; A\n"


@pytest.fixture
def write(tmp_path: Path):
    def make(scene: str = SCENE, file: str = FILE) -> Path:
        (tmp_path / "test.csv").write_text(file, encoding="utf-8")
        (tmp_path / "mine.toml").write_text(scene, encoding="utf-8")
        return tmp_path / "mine.toml"

    return make


def test_what_was_measured_is_solved_for(write) -> None:
    scene = load_bellows(write())
    assert scene.load.pressure_kpa == [2.0, 4.0]
    assert scene.compare is not None and scene.compare.measured("tip_mm", 2.0) == [2.0, 2.2]
    asked = load_bellows(write(SCENE + "load = {pressure_kpa = [3, 4.00001]}\n"))
    assert asked.load.pressure_kpa == [2.0, 3.0, 4.00001]
    # it decides nothing of a run
    bare = asked.model_copy(update={"compare": None})
    assert run_hash(bare, "axisymmetric", "r1") == run_hash(asked, "axisymmetric", "r1")


def test_measured_values_stand_beside_the_models(write, tmp_path: Path) -> None:
    found = solve(Scene.read(write()), tmp_path / "out")
    rows = {row.pressure_kpa: row for row in found.rows if row.model == "measured"}
    assert rows[2.0].value == pytest.approx(2.1) and rows[2.0].uncertainty == pytest.approx(0.1)
    best = next(row for row in found.rows if (row.model, row.level) == ("axisymmetric", "extrapolated"))
    assert rows[2.0].error_percent == pytest.approx(100.0 * (2.1 / best.value - 1.0))
    # the folder stands alone
    (tmp_path / "test.csv").unlink()
    kept = kept_scene(tmp_path / "out" / "scene.toml")
    assert isinstance(kept, BellowsScene) and kept.compare is not None
    assert kept.compare.tip_mm == [0.0, 2.0, 2.2, 3.9]
    report = report_of(tmp_path / "out")
    assert "measured were 3.90 mm" in answer(report)
    assert "measured" not in answer(replace(report, rows=tuple(r for r in report.rows if r.model != "measured")))


@pytest.mark.parametrize(
    ("file", "said"),
    [
        ("", "its header is empty"),
        ("pressure_kpa,force\n1,2\n", "wanted are pressure_kpa and tip_mm or tip_force_n"),
        ("pressure_kpa,tip_mm\n", "at least one line"),
        ("pressure_kpa;tip_mm\n1;2,5\n", "'2,5' in the line '1, 2,5' is no number: decimals have a point"),
        ("pressure_kpa,tip_mm\n1\n", "'' in the line '1' is no number"),
        ("pressure_kpa,tip_mm\n1,nan\n", "'nan' in the line '1, nan' is no number"),
        ("pressure_kpa,tip_mm\n-1,2\n3,4\n", "load.pressure_kpa = [-1.0, 3.0]"),
        ("pressure_kpa,tip_force_n\n1,2\n", "compare: has no tip_mm, which is what this scene finds"),
    ],
)
def test_files_that_do_not_fit_are_refused(write, file: str, said: str) -> None:
    with pytest.raises(SceneError) as refusal:
        load_bellows(write(file=file))
    assert said in str(refusal.value).replace("compare.tip_mm.1", "compare.tip_mm.0")


def test_tables_that_do_not_fit_are_refused(write) -> None:
    for table, said in (
        ('{file = "none.csv"}', "none.csv"),
        ("{}", "give file, or pressure_kpa"),
        ("{pressure_kpa = [1, 2], tip_mm = [1]}", "tip_mm has 1 values, compare.pressure_kpa 2"),
        ("{pressure_kpa = [1, true], tip_mm = [1, 2]}", "load.pressure_kpa"),
    ):
        with pytest.raises(SceneError, match=said):
            load_bellows(write(SCENE.replace('{file = "test.csv"}', table)))


def test_requested_pressures_are_left_to_the_types() -> None:
    assert pressures_with([1.0, 2.0], "x") == "x"
    assert pressures_with([2.0, 1.0, 0.0], 3) == [1.0, 2.0, 3]
    assert pressures_with([-2.0, -1.0], None) == [-1.0, -2.0]
