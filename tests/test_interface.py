"""The Python interface: scenes from tables and files, answers as data frame and figure; the notebook runs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from bellowsx import Answer, Scene, solve
from studies.results.rows import COLUMNS
from studies.scene.body_geometry import SphereGeometry
from studies.scene.sections import SceneError

ROOT = Path(__file__).resolve().parents[1]
TABLES: dict[str, dict[str, Any]] = {
    "geometry": {"kind": "sphere", "inner_radius_mm": 5.0, "outer_radius_mm": 7.0},
    "material": {"law": "neo-hooke", "mu_kpa": 75.0},
    "load": {"pressure_kpa": 10.0},
}


@pytest.fixture(scope="module")
def answer(tmp_path_factory: pytest.TempPathFactory) -> Answer:
    return solve(Scene.of("ball", **TABLES), tmp_path_factory.mktemp("ball"))


def radius(scene: Scene) -> float:
    geometry = scene.checked.geometry
    assert isinstance(geometry, SphereGeometry)
    return geometry.outer_radius_mm


def test_a_scene_of_tables_is_that_of_its_text(tmp_path: Path) -> None:
    scene = Scene.of("ball", **TABLES)
    (tmp_path / "ball.toml").write_text(scene.text, encoding="utf-8")
    assert Scene.read(tmp_path / "ball.toml").checked == scene.checked
    other = scene.changed("big", {"geometry.outer_radius_mm": 8.0})
    assert [radius(of) for of in (scene, other)] == [7.0, 8.0]
    assert other.checked.name == "big"


def test_faults_are_told_as_on_the_command_line() -> None:
    with pytest.raises(SceneError, match="geometry.inner_radius_mm = 9"):
        Scene.of("ball", **TABLES).changed("wrong", {"geometry.inner_radius_mm": 9.0})
    with pytest.raises(SceneError, match="did you mean material"):
        Scene.of("ball", **{**TABLES, "materiel": {}})


def test_an_answer_is_a_data_frame(answer: Answer) -> None:
    assert answer.reached and answer.reason == ""
    frame = answer.frame()
    assert tuple(frame.columns) == COLUMNS
    bore = frame[frame.quantity == "bore_mm"].iloc[-1]
    assert abs(bore.error_percent) < 0.1  # beside the exact sphere; r1 and r2 are within 0.01 %
    assert "axisymmetric" in Scene.of("ball", **TABLES).plan()


def test_the_notebook_runs(tmp_path: Path) -> None:
    script = ROOT / "docs" / "notebooks" / "own_actuator.py"
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "wall 1.5 mm" in done.stdout
    assert (tmp_path / "results" / "notebook" / "mine.png").stat().st_size > 10_000
