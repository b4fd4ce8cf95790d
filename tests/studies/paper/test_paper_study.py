"""Cases of the paper study: each content run once, nothing again, after a change only what depends on it."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner
from mpi4py import MPI

from studies.__main__ import main
from studies.engine import Setting
from studies.paper import study
from studies.paper.cases import PARTS, Case, case_text, cases
from studies.paper.results import read_results
from studies.progress import Progress
from studies.results.run_files import SUMMARY_FILE
from studies.scene.load import load_bellows

SMALL = "smoke-t2-ri5"
LOW = {"load.pressure_kpa": [2.0], "ask.fields": False}


def small(name: str, **changes: object) -> Case:
    keys = {key.replace("__", "."): value for key, value in changes.items()}
    return Case("core", name, SMALL, name, {**LOW, **keys}, levels=(1,))


def run(folder: Path, *chosen: Case) -> dict[str, float]:
    """Run cases; when the summary of each was written."""
    assert study.prepare(chosen, Setting(folder, MPI.COMM_SELF, Progress(MPI.COMM_SELF), {})) == []
    return {c.scene: (folder / c.name / "axisymmetric-r1" / SUMMARY_FILE).stat().st_mtime_ns for c in chosen}


def test_after_a_change_only_what_depends_on_it_is_run(tmp_path: Path) -> None:
    one, other = small("one"), small("other", geometry__wall_mm=1.9)
    first = run(tmp_path, one, other)
    assert run(tmp_path, one, other) == first
    again = run(tmp_path, one, small("other", geometry__wall_mm=1.8))
    assert again["one"] == first["one"]
    assert again["other"] > first["other"]
    found = read_results(tmp_path, (one, other))
    assert [len(case.axisymmetric) for case in found.cases] == [1, 1]
    # a run that was there before the scene changed is no result of it
    study.write_scenes(tmp_path, (other,))
    assert read_results(tmp_path, (other,)).cases[0].axisymmetric == ()


def test_equal_content_is_run_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done = []
    actual = study.run_axisymmetric

    def counted(scene, *args):
        done.append(scene.name)
        return actual(scene, *args)

    monkeypatch.setattr(study, "run_axisymmetric", counted)
    run(tmp_path, small("one"), small("same"))
    assert done == ["one"]
    for case in read_results(tmp_path, (small("one"), small("same"))).cases:
        (row,) = [r for r in case.rows if r.quantity == "tip_mm" and r.model == "axisymmetric"]
        assert row.scene == case.case.scene
        assert row.value > 0.0
        assert any(r.quantity == "root_stretch_outer" for r in case.rows)


def test_parts_make_up_the_study() -> None:
    assert study.cases({"part": tuple(PARTS)}) == cases()
    assert [case.group for case in study.cases({"part": ("core",)})] == [
        *["core"] * 4,
        *["zigzag"] * 4,
        "control",
    ]


@pytest.mark.parametrize("case", cases(), ids=lambda case: case.name)
def test_every_case_is_a_scene_that_is_accepted(tmp_path: Path, case: Case) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(case_text(case), encoding="utf-8")
    scene = load_bellows(path)
    assert scene.name == case.scene
    for key, value in case.changes.items():
        at = scene.model_dump()
        for part in key.split("."):
            at = at[part]
        if isinstance(value, dict):
            assert value.items() <= at.items()
        else:
            assert at == value


def test_a_folder_of_other_code_is_refused_with_nothing_overwritten(tmp_path: Path) -> None:
    case = next(c for c in cases("core") if c.scene == "heung-t1-ri5")
    study.write_scenes(tmp_path, [case])
    run = tmp_path / case.name / "axisymmetric-r1"
    run.mkdir(parents=True)
    older = Path(__file__).parents[1] / "results" / "older"
    for kept, name in (("summary_of_an_older_run.json", "summary.json"), ("path_of_an_older_run.csv", "path.csv")):
        (run / name).write_bytes((older / kept).read_bytes())
    (tmp_path / "report.md").write_text("of then", encoding="utf-8")
    done = CliRunner().invoke(main, ["report", str(tmp_path)])
    assert done.exit_code == 2 and "1 of 1 runs are of other scenes or other code" in done.output
    assert (tmp_path / "report.md").read_text(encoding="utf-8") == "of then"
