"""A core off the axis as a scene: what is refused, what the plan answers, and the study in miniature."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from meshes.errors import GeometryError
from solvers.state import State
from studies.__main__ import main
from studies.engine import Setting, run
from studies.imperfection.bodies import Actuator, solve
from studies.imperfection.study import STUDY
from studies.models.build import tip_pose
from studies.planning.levels import BodyLevel
from studies.planning.planner import describe, make_plan
from studies.progress import Progress
from studies.results.rows import read_rows
from studies.results.runs import run_hash
from studies.scene.bellows import core_shift_mm, without_eccentricity
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_body, scene_meridian
from studies.scene.sections import SceneError

ROOT = Path(__file__).resolve().parents[3]
SHORT = ROOT / "scenes" / "imperfection" / "short-core-10.toml"


@pytest.fixture
def edited(tmp_path):
    """The short scene with some of its text replaced."""

    def make(*changes: tuple[str, str]) -> Path:
        text = SHORT.read_text(encoding="utf-8")
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "mini.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return make


def test_plan_answers_full_3d_and_says_why() -> None:
    scene = load_bellows(SHORT)
    plan = make_plan(scene)
    assert plan.model == "full3d" and plan.around_levels
    text = describe(scene, plan)
    assert "answer: full3d" in text and "core off the axis by 10 % of t" in text
    assert "the core sat off the axis" in text
    assert "rotationally symmetric, so the axisymmetric model is exact" not in text
    assert make_plan(without_eccentricity(scene)).model == "axisymmetric"


@pytest.mark.parametrize("model", ["axisymmetric", "sector", "closed_form"])
def test_symmetric_models_are_refused(model) -> None:
    with pytest.raises(SceneError, match=r"geometry\.eccentricity = 0\.1 is not rotationally symmetric"):
        make_plan(load_bellows(SHORT), model)
    done = CliRunner().invoke(main, ["plan", str(SHORT), "--model", model])
    assert done.exit_code == 2


@pytest.mark.parametrize(
    "changes, reason",
    [
        ((('tip = "cap"', 'tip = "rigid"'),), "a plate closes a round opening"),
        ((('model = "rigid"', 'model = "meshed"'),), "with meshed rings not modelled"),
        ((("eccentricity = 0.10 ", "eccentricity = 0.6 "),), "eccentricity"),
    ],
)
def test_what_is_not_modelled_is_refused(edited, changes, reason) -> None:
    with pytest.raises(SceneError, match=reason):
        load_bellows(edited(*changes))


def test_sector_of_a_shifted_core_is_refused() -> None:
    scene = load_bellows(SHORT)
    with pytest.raises(GeometryError, match="take full3d"):
        scene_body(scene_meridian(scene, 1), "sector", 8, core_shift_mm(scene))


def test_only_the_body_knows_of_the_shift(edited) -> None:
    scene = load_bellows(SHORT)
    other = load_bellows(edited(("eccentricity = 0.10 ", "eccentricity = 0.05 ")))
    assert run_hash(scene, "full3d", "n8") != run_hash(other, "full3d", "n8")
    assert run_hash(scene, "axisymmetric", "r1") == run_hash(other, "axisymmetric", "r1")
    assert run_hash(without_eccentricity(scene), "axisymmetric", "r1") == run_hash(scene, "axisymmetric", "r1")
    assert core_shift_mm(scene) == pytest.approx(0.1)


def test_pose_of_a_turned_and_shifted_tip() -> None:
    scene = load_bellows(SHORT)
    meridian = scene_meridian(scene, 1)
    body = scene_body(meridian, "full3d", 6)
    turn = Rotation.from_euler("y", 7.0, degrees=True)
    moved = turn.apply(body.points) + [1.5, -0.5, 3.0] - body.points
    pose = tip_pose(body, State(moved, np.zeros(1), np.zeros((0, 6)), 0.0))
    # the axis turned by 7 degrees about y faces x by as much
    assert pose.bend_deg == pytest.approx(7.0, abs=1e-9)
    assert pose.bend_across_deg == pytest.approx(0.0, abs=1e-9)
    assert pose.across_mm == pytest.approx(-0.5, abs=1e-9)
    top = float(body.points[:, 2].max())
    assert pose.sideways_mm == pytest.approx(1.5 + top * np.sin(np.radians(7.0)), rel=1e-9)


def test_bend_is_of_first_and_elongation_of_second_order(edited, tmp_path) -> None:
    file = edited(("convolutions = 2", "convolutions = 1"), ("cap_mm = 5.0", "cap_mm = 3.0"))
    actuator = Actuator("mini", str(file), (2.0,), (BodyLevel(6, 1),))
    study = dataclasses.replace(STUDY, cases=lambda options: [actuator])
    assert run(study, tmp_path, MPI.COMM_SELF, {}) == 0
    at = Setting(tmp_path, MPI.COMM_SELF, Progress(MPI.COMM_SELF), {})
    centred, small, large = found = solve(actuator, at)
    assert [f.run.summary.status for f in found] == ["reached"] * 3
    # centred: the bend is round-off; bodies that turn take no more iterations than a few
    assert abs(centred.poses[2.0].bend_deg) < 1e-8
    assert all(row.newton_iterations <= 10 for f in found for row in f.run.path)
    bends = [f.poses[2.0].bend_deg for f in (small, large)]
    assert abs(bends[0]) > 0.1 and bends[1] / bends[0] == pytest.approx(2.0, rel=0.02)
    changes = [f.value("tip_mm", 2.0) - centred.value("tip_mm", 2.0) for f in (small, large)]
    assert changes[1] / changes[0] == pytest.approx(4.0, rel=0.05)
    # the shift is along x: nothing goes along y
    assert abs(large.poses[2.0].across_mm) < 1e-6 * abs(large.poses[2.0].sideways_mm)
    assert all(f.run.path[-1].unstable_modes == 0 for f in found)

    assert "grows with order" in (tmp_path / "report.md").read_text(encoding="utf-8")
    assert (tmp_path / "pictures" / "bend.png").stat().st_size > 1000
    assert (tmp_path / "pictures" / "bent-mini.png").stat().st_size > 1000
    rows = read_rows(tmp_path / "rows.csv")
    assert {r.quantity for r in rows} == {"tip_mm", "tip_bend_deg", "tip_sideways_mm", "unstable_modes"}
    tip = next(r for r in rows if r.scene == "mini-e10" and r.quantity == "tip_mm")
    assert tip.reference == pytest.approx(centred.value("tip_mm", 2.0), rel=1e-8)

    again = solve(actuator, at)
    assert [f.run.summary.when for f in again] == [f.run.summary.when for f in found]
    assert [f.run.summary.time_s for f in again] == [f.run.summary.time_s for f in found]
