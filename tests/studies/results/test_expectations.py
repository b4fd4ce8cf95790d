"""What the plan expects of a mesh, what is solved because of it, and what came out."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from mpi4py import MPI

from studies.models import session
from studies.models.session import SceneResult, read_scene_folder, run_plan
from studies.planning.levels import MOST_UNKNOWNS
from studies.planning.planner import describe, make_plan
from studies.progress import Progress
from studies.results import provenance
from studies.results.expectations import CHECKED_ERROR, PREDICTED_ERROR, PREDICTED_WORK, WORK
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows

SCENE = provenance.ROOT / "scenes" / "peers" / "bellows.toml"


def short_bellows(tolerance_percent: float, blocked: bool = False) -> BellowsScene:
    """Two convolutions with rigid rings, unfolded little."""
    scene = load_bellows(SCENE)
    return scene.model_copy(
        update={
            "rings": scene.rings.model_copy(update={"model": "rigid"}),
            "load": scene.load.model_copy(update={"pressure_kpa": [4.0], "tip": "blocked" if blocked else "free"}),
            "ask": scene.ask.model_copy(update={"tolerance_percent": tolerance_percent, "fields": False}),
        }
    )


def solved(scene: BellowsScene, folder: Path) -> SceneResult:
    """The axisymmetric plan of a scene, done."""
    return run_plan(scene, SCENE.read_text(), make_plan(scene), folder, MPI.COMM_WORLD, Progress(MPI.COMM_WORLD))


@pytest.fixture(scope="module")
def loose(tmp_path_factory: pytest.TempPathFactory) -> SceneResult:
    return solved(short_bellows(2.0), tmp_path_factory.mktemp("loose"))


def test_a_loose_tolerance_solves_a_mesh_that_tells_its_own_error(loose: SceneResult) -> None:
    assert [run.summary.level for run in loose.axisymmetric] == ["r1"]
    row = next(r for r in loose.rows if (r.quantity, r.model) == ("tip_mm", "axisymmetric"))
    error = abs(loose.axisymmetric[0].path[-1].tip_error_mm)
    assert row.uncertainty == pytest.approx(2.0 * error) and 0.0 < row.uncertainty < 0.02 * row.value


def test_a_mesh_that_does_not_tell_its_error_is_checked_by_a_second(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(session, "with_errors", lambda scene, folder, run: run)  # as after contact
    checked = solved(short_bellows(2.0), tmp_path)
    assert [run.summary.level for run in checked.axisymmetric] == ["r1", "r2"] and not checked.missed


def test_error_and_work_are_told_before_and_after(loose: SceneResult) -> None:
    found = {r.quantity: r for r in loose.rows if r.quantity in (PREDICTED_ERROR, CHECKED_ERROR, PREDICTED_WORK, WORK)}
    assert {r.level for r in found.values()} == {"r1"} and len(found) == 4
    last = loose.axisymmetric[0].path[-1]
    assert found[CHECKED_ERROR].value == pytest.approx(100.0 * abs(last.tip_error_mm / last.tip_mm))
    assert found[WORK].value == pytest.approx(sum(run.summary.time_s["total"] for run in loose.axisymmetric))
    assert 0.01 <= found[PREDICTED_ERROR].value <= 2.0
    assert f"by the check {found[CHECKED_ERROR].value:.2g} %" in loose.remark


def test_a_tolerance_that_the_check_does_not_hold_solves_a_finer_mesh(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setitem(MOST_UNKNOWNS, "axisymmetric", 0)  # but none beyond the plan's
    tight = solved(short_bellows(0.01), tmp_path)
    assert tight.axisymmetric[-1].summary.level == "r4"
    assert math.isfinite(next(r.value for r in tight.rows if r.quantity == CHECKED_ERROR))


def test_a_mesh_that_the_prediction_rules_out_is_not_solved() -> None:
    assert make_plan(short_bellows(0.01)).levels == ("r2", "r4")
    assert make_plan(short_bellows(1.0)).levels == ("r1", "r2", "r4")
    assert make_plan(short_bellows(0.01), "axisymmetric").levels == ("r1", "r2", "r4")


def test_a_blocked_tip_is_not_what_the_model_knows() -> None:
    plan = make_plan(short_bellows(1.0, blocked=True))
    assert plan.choice is None and plan.levels == ("r1", "r2", "r4")


def test_a_folder_read_back_tells_the_same(tmp_path: Path) -> None:
    scene = short_bellows(2.0)
    text = SCENE.read_text()
    for old, new in (('model = "meshed"', 'model = "rigid"'), ("pressure_kpa = [10.0]", "pressure_kpa = [4.0]")):
        assert old in text
        text = text.replace(old, new)
    made = run_plan(scene, text, make_plan(scene), tmp_path, MPI.COMM_WORLD, Progress(MPI.COMM_WORLD))
    assert read_scene_folder(made.scene, tmp_path).remark == made.remark != ""


def test_a_plan_says_what_it_does_about_contact_and_vacuum() -> None:
    scene = short_bellows(1.0)
    text = describe(scene, make_plan(scene))
    assert "closed form at 4 kPa" in text and "contact: modelled from the first touch on" in text
    assert "contact: not modelled here" in describe(scene, make_plan(scene, "full3d"))
    evacuated = scene.model_copy(update={"load": scene.load.model_copy(update={"pressure_kpa": [-0.1]})})
    text = describe(evacuated, make_plan(evacuated))
    assert "closed form at" not in text and "closed form: it has no vacuum" in text
