"""The command line as other programs drive it: exit codes, files, restart, nothing written on bad input."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import pyvista
from click.testing import CliRunner

from studies.__main__ import main
from studies.models import run_log
from studies.results.rows import COLUMNS, read_rows
from studies.results.run_files import PATH_COLUMNS, read_path, read_summary

ROOT = Path(__file__).resolve().parents[3]
SCENE_PICTURES = ("elongation", "states", "times")


@pytest.fixture(scope="session")
def small_scene(tmp_path_factory):
    """One convolution, two pressures: seconds."""
    text = (ROOT / "scenes" / "smoke-t2-ri5.toml").read_text(encoding="utf-8")
    text = text.replace("convolutions = 2", "convolutions = 1").replace("smoke-t2-ri5", "small")
    path = tmp_path_factory.mktemp("scenes") / "small.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def solved(small_scene, tmp_path_factory):
    """The small scene solved in full 3D."""
    out = tmp_path_factory.mktemp("solved") / "out"
    result = CliRunner().invoke(main, ["solve", str(small_scene), "--out", str(out), "--model", "full3d"])
    assert result.exit_code == 0, result.output
    return out


def test_solve_writes_path_and_summary(solved):
    assert (solved / "path.csv").read_text().splitlines()[0] == ",".join(PATH_COLUMNS)
    path = read_path(solved)
    assert [row.pressure_kpa for row in path if row.status == "requested"] == pytest.approx([5.0, 10.0])
    summary = json.loads((solved / "summary.json").read_text())
    assert summary["status"] == "reached"
    assert {"reason", "plan", "dofs", "cells", "time_s", "versions", "blas", "ranks", "peak_mb"} <= set(summary)
    assert all(row.unstable_modes == 0 for row in path)


def test_rows_state_uncertainty_beside_every_fem_value(solved):
    rows = read_rows(solved / "rows.csv")
    assert (solved / "rows.csv").read_text().splitlines()[0] == ",".join(COLUMNS)
    for row in rows:
        if row.quantity == "tip_mm" and row.model in ("axisymmetric", "full3d"):
            assert row.uncertainty >= 0.0
    finest = {r.pressure_kpa: r for r in rows if r.model == "axisymmetric" and r.quantity == "tip_mm"}
    for row in rows:
        if row.model == "full3d" and row.quantity == "tip_mm":
            # 1 %: the bar of the comparison of the two models
            assert row.value == pytest.approx(finest[row.pressure_kpa].value, rel=0.01)


def test_fields_open_and_carry_the_stretch(solved):
    files = sorted((solved / "full3d-n8" / "fields").glob("*.vtu"))
    assert [f.name for f in files] == ["p05.000.vtu", "p10.000.vtu"]
    grid = pyvista.read(files[-1])
    assert grid.point_data["stretch_max"].max() > 1.1
    assert abs(grid.point_data["displacement_mm"]).max() > 1.0


def test_finished_work_is_not_repeated(small_scene, solved):
    before = {p: p.stat().st_mtime_ns for p in solved.glob("*-*/summary.json")}
    result = CliRunner().invoke(main, ["solve", str(small_scene), "--out", str(solved), "--model", "full3d"])
    assert result.exit_code == 0
    assert before == {p: p.stat().st_mtime_ns for p in solved.glob("*-*/summary.json")}


@pytest.fixture()
def interrupted(solved, tmp_path, monkeypatch, small_scene):
    """The 3D run of the small scene, killed while its second state was being written; folder, and how to go on."""
    copy = tmp_path / "interrupted"
    shutil.copytree(solved, copy)
    shutil.rmtree(copy / "full3d-n8")
    command = ["solve", str(small_scene), "--out", str(copy), "--model", "full3d"]
    save = run_log.save_state

    def die_at_ten(folder, content_hash, state, row):
        if row.pressure_kpa > 9.0:
            raise SystemExit("killed")
        save(folder, content_hash, state, row)

    with monkeypatch.context() as patch:
        patch.setattr(run_log, "save_state", die_at_ten)
        assert CliRunner().invoke(main, command).exit_code == 1
    run = copy / "full3d-n8"
    assert not (run / "summary.json").exists()
    return run, command


def same_rows(found, expected, tolerance):
    assert len(found) == len(expected)
    for a, b in zip(found, expected, strict=True):
        for name in PATH_COLUMNS:
            if name not in ("wall_s", "residual"):  # what Newton leaves of it is round-off
                x, y = getattr(a, name), getattr(b, name)
                assert x == y or x == pytest.approx(y, rel=tolerance, nan_ok=True), (name, x, y)


def test_interrupted_run_goes_on_with_the_same_steps(interrupted, solved):
    run, command = interrupted
    result = CliRunner().invoke(main, command)
    assert result.exit_code == 0, result.output
    # bit for bit the same steps; path.csv has twelve digits
    same_rows(read_path(run), read_path(solved / "full3d-n8"), 1e-11)
    again, whole = read_summary(run), read_summary(solved / "full3d-n8")
    assert again.factorisations == whole.factorisations
    assert again.plan == whole.plan
    assert not (run / "checkpoint.npz").exists()


@pytest.mark.parametrize("damage", ["truncated", "byte flipped"])
def test_damaged_checkpoint_is_recognised_and_not_used(interrupted, solved, damage):
    run, command = interrupted
    file = run / "checkpoint.npz"
    content = bytearray(file.read_bytes())
    if damage == "truncated":
        content = content[: len(content) // 2]
    else:
        content[len(content) // 2] ^= 1
    file.write_bytes(content)
    result = CliRunner().invoke(main, command)
    assert result.exit_code == 0, result.output
    assert any("checkpoint.npz: damaged, not used" in note for note in read_summary(run).plan)
    same_rows(read_path(run), read_path(solved / "full3d-n8"), 1e-11)


def test_default_plan_stops_refining_when_the_tolerance_is_met(small_scene, tmp_path):
    out = tmp_path / "out"
    result = CliRunner().invoke(main, ["solve", str(small_scene), "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert (out / "axisymmetric-r1").is_dir()
    assert not (out / "axisymmetric-r2").exists()  # the first mesh tells that its error is small enough
    assert read_summary(out).model == "axisymmetric"


def test_plan_says_what_is_skipped(small_scene):
    result = CliRunner().invoke(main, ["plan", str(small_scene)])
    assert result.exit_code == 0
    assert "rotationally symmetric" in result.output


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("wall_mm = 2.0", "wall_mm = 0.0", "geometry.wall_mm = 0.0"),
        ("fillet_mm = 0.5", "filet_mm = 0.5", "did you mean fillet_mm"),
        ('bond = "rigid"', 'bond = "glue"', "rings.bond = 'glue'"),
        ("seat_mm = 4.0", "seat_mm = 8.0", "collar_mm = 3"),
        ("alpha = 5.836", "alpha = inf", "material.alpha = inf"),
    ],
)
@pytest.mark.parametrize("command", ["solve", "batch"])
def test_bad_input_exits_2_and_writes_nothing(small_scene, tmp_path, command, old, new, said):
    text = small_scene.read_text()
    assert old in text
    bad = tmp_path / "bad.toml"
    bad.write_text(text.replace(old, new), encoding="utf-8")
    out = tmp_path / "out"
    result = CliRunner().invoke(main, [command, str(bad), "--out", str(out)])
    assert result.exit_code == 2
    assert said in result.output
    assert not out.exists()


def test_missing_scene_and_unwritable_output_exit_2(small_scene, tmp_path):
    result = CliRunner().invoke(main, ["solve", str(tmp_path / "none.toml"), "--out", str(tmp_path / "out")])
    assert result.exit_code == 2
    assert "none.toml" in result.output
    blocker = tmp_path / "file"
    blocker.write_text("x")
    result = CliRunner().invoke(main, ["solve", str(small_scene), "--out", str(blocker / "out")])
    assert result.exit_code == 2
    assert "file" in result.output


def test_closed_form_writes_the_same_files(small_scene, tmp_path):
    out = tmp_path / "out"
    result = CliRunner().invoke(main, ["solve", str(small_scene), "--out", str(out), "--model", "closed_form"])
    assert result.exit_code == 0, result.output
    assert [row.pressure_kpa for row in read_path(out)] == [5.0, 10.0]


def test_stopped_run_exits_3_and_keeps_its_states(small_scene, tmp_path, monkeypatch):
    """A pressure beyond what the wall holds: the reached part is kept, the rest is a row that says why."""
    monkeypatch.setattr("studies.planning.bellows.MERIDIANS", (1, 2))  # the third level would take half a minute
    text = small_scene.read_text().replace("[5.0, 10.0]", "[5.0, 700.0]")
    scene = tmp_path / "burst.toml"
    scene.write_text(text, encoding="utf-8")
    out = tmp_path / "out"
    result = CliRunner().invoke(main, ["solve", str(scene), "--out", str(out)])
    assert result.exit_code == 3
    last = [r for r in read_rows(out / "rows.csv") if r.model == "axisymmetric" and r.pressure_kpa == 700.0]
    assert last
    assert all(r.status.startswith("stopped at") and r.value != r.value for r in last)
    assert read_summary(out).status == "stopped"
    assert read_summary(out).reason


@pytest.mark.parametrize("control", ["volume", "pressure"])
def test_loss_of_stability_is_in_the_summary_with_its_mode(small_scene, tmp_path, monkeypatch, control):
    monkeypatch.setattr("studies.planning.bellows.MERIDIANS", (1,))
    text = (
        small_scene.read_text()
        .replace("[5.0, 10.0]", "[5.0, 60.0]")
        .replace('control = "auto"', f'control = "{control}"')
    )
    material = '[material]\nlaw = "neo-hooke"\nmu_kpa = 30.0\n'
    scene = tmp_path / "soft.toml"
    scene.write_text(re.sub(r"\[material\].*?(?=\[load\])", material + "\n", text, flags=re.S), encoding="utf-8")
    out = tmp_path / "out"
    result = CliRunner().invoke(main, ["solve", str(scene), "--out", str(out), "--model", "axisymmetric"])
    assert result.exit_code == 3, result.output
    summary = read_summary(out)
    assert summary.cause == "limit point"
    assert {row.control for row in read_path(out)[:3]} == {control}
    if control == "pressure":
        assert summary.crossing == {}
        assert "limit point near" in summary.reason
        assert not (out / "axisymmetric-r1" / "critical_mode.npz").exists()
        return
    assert summary.crossing["kind"] == "limit point"
    assert f"limit point at {summary.crossing['pressure_kpa']:.6g} kPa" in summary.reason
    with np.load(out / "axisymmetric-r1" / "critical_mode.npz") as mode:
        assert np.abs(mode["mode_mm"]).max() == pytest.approx(1.0)
        assert mode["mode_mm"].shape == mode["points_mm"].shape == mode["displacement_mm"].shape
        assert 1e3 * float(mode["load_mpa"]) == pytest.approx(summary.crossing["pressure_kpa"], rel=1e-4)
    grid = pyvista.read(out / "axisymmetric-r1" / "critical_mode.vtu")
    assert grid.point_data["mode_mm"].shape == (grid.n_points, 3)


def test_batch_shares_scenes_over_ranks(python, small_scene, tmp_path):
    second = tmp_path / "second.toml"
    second.write_text(small_scene.read_text().replace('name = "small"', 'name = "second"'), encoding="utf-8")
    out = tmp_path / "out"
    python.run(2, "-m", "studies", "batch", small_scene, second, "--out", out)
    small, other = read_path(out / "small"), read_path(out / "second")
    # the same problem solved by another process of the same build: equal to the last digits written
    assert [r.tip_mm for r in small] == pytest.approx([r.tip_mm for r in other], rel=1e-10)


def test_fields_asked_for_later_are_written_from_the_kept_states(small_scene, solved, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(solved, copy)
    shutil.rmtree(copy / "full3d-n8" / "fields")
    before = (copy / "full3d-n8" / "summary.json").read_bytes()
    result = CliRunner().invoke(main, ["solve", str(small_scene), "--out", str(copy), "--model", "full3d"])
    assert result.exit_code == 0
    assert len(list((copy / "full3d-n8" / "fields").glob("*.vtu"))) == 2
    assert (copy / "full3d-n8" / "summary.json").read_bytes() == before


def test_report_of_a_scene_is_made_from_its_folder(solved, tmp_path):
    copy = tmp_path / "copy"
    shutil.copytree(solved, copy)
    result = CliRunner().invoke(main, ["report", str(copy)])
    assert result.exit_code == 0, result.output
    assert [r.quantity for r in read_rows(copy / "rows.csv")] == [r.quantity for r in read_rows(solved / "rows.csv")]
    text = (copy / "report.md").read_text(encoding="utf-8")
    assert "### Elongation by pressure and model" in text
    assert "Grey: the rigid rings" in text
    assert {path.name for path in (copy / "pictures").iterdir()} == {f"small-{n}.png" for n in SCENE_PICTURES}


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_full_disk_is_an_error_with_the_path(tmp_path, monkeypatch):
    from studies.results.run_files import write_text_atomically

    def full(self, *_):
        return open("/dev/full", "wb", buffering=0)

    monkeypatch.setattr(Path, "open", full)
    with pytest.raises(OSError, match="summary.json"):
        write_text_atomically(tmp_path / "summary.json", "x" * 100)
