"""What a run of another content has left in a folder is not taken for that of the run there now."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from mpi4py import MPI

from solvers.errors import SolverError
from studies.models.body import run_simple_body
from studies.models.contact import CONTACT_FILE
from studies.models.run_log import MODE_FILE, Log
from studies.models.session import SCENE_FILE, read_scene_folder, run_plan
from studies.planning.planner import make_plan
from studies.progress import Progress
from studies.results.run_files import PATH_FILE, SUMMARY_FILE, field_file
from studies.results.runs import MEASURED_FILE, Run, finished_run, run_hash
from studies.scene.bodies import BodyScene
from studies.scene.load import load_scene

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def sphere() -> BodyScene:
    scene = load_scene(ROOT / "scenes" / "exact" / "sphere.toml")
    assert isinstance(scene, BodyScene)
    return scene


def thicker(scene: BodyScene) -> BodyScene:
    return scene.model_copy(update={"geometry": scene.geometry.model_copy(update={"outer_radius_mm": 8.0})})


def run(scene: BodyScene, folder: Path) -> Run:
    return run_simple_body(scene, "axisymmetric", "r1", folder, MPI.COMM_SELF, Progress(MPI.COMM_SELF))


def test_a_run_that_was_stopped_is_not_the_finished_one_before_it(sphere, tmp_path: Path, monkeypatch) -> None:
    first, other = run(sphere, tmp_path), thicker(sphere)
    step = Log.step

    def stop(log: Log, memory) -> None:
        step(log, memory)
        raise RuntimeError("stopped")

    with monkeypatch.context() as patch:
        patch.setattr(Log, "step", stop)
        with pytest.raises(SolverError, match="stopped"):
            run(other, tmp_path)
    assert (tmp_path / PATH_FILE).exists()  # that of the other's first step
    assert finished_run(tmp_path, run_hash(sphere, "axisymmetric", "r1")) is None
    again = run(sphere, tmp_path)
    assert [row.volume_mm3 for row in again.path] == [row.volume_mm3 for row in first.path]


def test_a_run_anew_begins_with_an_empty_folder(sphere, tmp_path: Path) -> None:
    run(sphere, tmp_path)
    load_mpa = 1e-3 * sphere.loads_kpa[0]
    left = [tmp_path / CONTACT_FILE, field_file(tmp_path, load_mpa)]
    left += [tmp_path / f"{MODE_FILE}.{kind}" for kind in ("npz", "vtu")]
    field_file(tmp_path, load_mpa).parent.mkdir()
    for file in left:
        file.write_text("of the thinner one")
    run(sphere, tmp_path)  # there already: nothing is touched
    assert all(file.exists() for file in left)
    measured = (tmp_path / MEASURED_FILE).read_text()
    run(thicker(sphere), tmp_path)
    assert not any(file.exists() for file in left)
    assert (tmp_path / MEASURED_FILE).read_text() != measured


def test_results_of_another_scene_are_not_read_with_those_of_this_one(sphere, tmp_path: Path) -> None:
    left = tmp_path / "axisymmetric-r3"  # a level that the scene has none of
    run(sphere, left)
    other, comm, progress = thicker(sphere), MPI.COMM_SELF, Progress(MPI.COMM_SELF)
    made = run_plan(other, "# other", make_plan(other, "axisymmetric"), tmp_path, comm, progress)
    assert "r3" not in {found.summary.level for found in made.runs} and left.exists()
    found = read_scene_folder(other, tmp_path)
    assert [one.summary for one in found.runs] == [one.summary for one in made.runs]
    # the same again leaves what is there
    kept = {file: file.stat().st_mtime_ns for file in tmp_path.glob(f"*-*/{SUMMARY_FILE}")}
    run_plan(other, "# other", make_plan(other, "axisymmetric"), tmp_path, comm, progress)
    assert kept == {file: file.stat().st_mtime_ns for file in tmp_path.glob(f"*-*/{SUMMARY_FILE}")}


def test_scene_beside_results_is_the_old_or_the_new_one(sphere, tmp_path: Path, monkeypatch) -> None:
    (tmp_path / SCENE_FILE).write_text("old", encoding="utf-8")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left on device"):
        run_plan(sphere, "# new", make_plan(sphere, "axisymmetric"), tmp_path, MPI.COMM_SELF, Progress(MPI.COMM_SELF))
    assert (tmp_path / SCENE_FILE).read_text(encoding="utf-8") == "old"
