"""Bodies with exact answers and users' meshes through the command line: errors, crossings, files, reports, refusals."""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from studies.__main__ import main
from studies.models import run_log
from studies.models.body_problem import body_of
from studies.results.exact_answers import exact_bore_mm, exact_crossing_kpa
from studies.results.rows import COLUMNS, Row, read_rows
from studies.results.run_files import PATH_COLUMNS, read_path, read_summary
from studies.scene.bodies import BodyScene
from studies.scene.load import load_scene
from studies.scene.sections import SceneError

ROOT = Path(__file__).resolve().parents[3]
SCENES = ROOT / "scenes" / "exact"
YEOH = 'law = "yeoh"\nc_kpa = [36.0, 2.5, 0.23]'
OGDEN = 'law = "ogden"\nmu_kpa = 75.449\nalpha = 5.836\nconvention = "2mu/alpha^2"'


def run(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(a) for a in arguments])


@pytest.fixture
def scene(tmp_path):
    """Path of a shipped scene with texts replaced, (old, new) each."""

    def make(name: str, *changes: tuple[str, str]) -> Path:
        text = (SCENES / f"{name}.toml").read_text(encoding="utf-8")
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new)
        path = tmp_path / f"{name}.toml"
        path.write_text(text, encoding="utf-8")
        if name == "mesh":
            shutil.copy(SCENES / "octant.msh", tmp_path)
        return path

    return make


def solved(path: Path, out: Path, *options: str) -> list[Row]:
    result = run("solve", path, "--out", out, *options)
    assert result.exit_code == 0, result.output
    return read_rows(out / "rows.csv")


def shipped(name: str) -> BodyScene:
    found = load_scene(SCENES / f"{name}.toml")
    assert isinstance(found, BodyScene)
    return found


def finest(rows: list[Row], quantity: str) -> list[Row]:
    of = [r for r in rows if r.quantity == quantity]
    return [r for r in of if r.level == of[-1].level]


# --- solved --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", ["yeoh", "ogden"])
@pytest.mark.parametrize("model", ["sector", "full3d"])
@pytest.mark.parametrize("name", ["tube", "sphere"])
def test_tube_and_sphere_in_three_dimensions(scene, tmp_path, monkeypatch, name: str, model: str, law: str) -> None:
    # the coarser of the default meshes: seconds instead of tens, and the bar holds for it already
    monkeypatch.setattr("studies.planning.bodies.AROUND_LEVELS", {"hexahedra": ("n8",), "tetrahedra": ("n12",)})
    pressures = ("[10.0, 20.0, 30.0]", "[10.0, 25.0]")
    changes = [pressures]
    if (name, law) in (("tube", "ogden"), ("sphere", "yeoh")):
        changes.append((YEOH, OGDEN) if law == "ogden" else (OGDEN, YEOH))
    rows = solved(scene(name, *changes), tmp_path / "out", "--model", model)
    bores = finest(rows, "bore_mm")
    assert [r.pressure_kpa for r in bores] == [10.0, 25.0]
    for row in bores:
        # the bar of DESIGN.md; measured 0.019 % at most, in tetrahedra
        assert abs(row.error_percent) <= 0.1
        assert row.source.startswith("exact")
    assert all(r.value == 0.0 for r in finest(rows, "unstable_modes"))


def test_default_plan_gives_the_uncertainty_of_meridian_levels(scene, tmp_path) -> None:
    out = tmp_path / "out"
    rows = solved(scene("tube", ("kappa_over_mu = inf", "kappa_over_mu = 100.0")), out)
    assert [p.name for p in sorted(out.glob("*-r*"))] == ["axisymmetric-r1", "axisymmetric-r2"]
    assert (out / "rows.csv").read_text().splitlines()[0] == ",".join(COLUMNS)
    assert (out / "path.csv").read_text().splitlines()[0] == ",".join(PATH_COLUMNS)
    for row in finest(rows, "bore_mm"):
        assert "compressible" in row.source
        assert abs(row.value - row.reference) <= row.uncertainty <= 1e-3 * row.value
    assert all(math.isnan(state.tip_mm) for state in read_path(out))
    assert {"status", "reason", "plan", "dofs", "cells", "time_s"} <= set(
        json.loads((out / "summary.json").read_text())
    )
    # what is there is not repeated
    before = {p: p.stat().st_mtime_ns for p in out.glob("*-*/summary.json")}
    assert run("solve", tmp_path / "tube.toml", "--out", out).exit_code == 0
    assert before == {p: p.stat().st_mtime_ns for p in out.glob("*-*/summary.json")}


@pytest.mark.parametrize("model", ["axisymmetric", "sector"])
def test_capped_tube(scene, tmp_path, monkeypatch, model: str) -> None:
    monkeypatch.setattr("studies.planning.bodies.MERIDIAN_LEVELS", ("r1",))
    monkeypatch.setattr("studies.planning.bodies.AROUND_LEVELS", {"hexahedra": ("n8",)})
    path = scene("tube", ('ends = "plane-strain"', 'ends = "capped"'), ("20.0, 30.0]", "25.0]"))
    for row in finest(solved(path, tmp_path / "out", "--model", model), "bore_mm"):
        # the cap glides on a layer of finite stiffness; measured 0.003 %
        assert abs(row.error_percent) < 0.01


def test_bonded_tube_has_no_exact_answer(scene, tmp_path) -> None:
    path = scene("tube", ('ends = "plane-strain"', 'ends = "bonded"'), ("length_mm = 2.0", "length_mm = 8.0"))
    rows = solved(path, tmp_path / "out")
    free = exact_bore_mm(shipped("tube"), 20.0)[0]
    for row in finest(rows, "bore_mm"):
        assert math.isnan(row.reference)
        assert 0.0 < row.uncertainty < 0.02 * row.value
    assert [r for r in finest(rows, "bore_mm") if r.pressure_kpa == 20.0][0].value < free
    assert read_path(tmp_path / "out")[-1].reaction_n != 0.0


def test_limit_point_is_found_without_being_told_where(scene, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("studies.planning.bodies.MERIDIAN_LEVELS", ("r1", "r2"))
    (limit,) = finest(solved(scene("sphere-limit"), tmp_path / "out"), "limit_kpa")
    assert abs(limit.error_percent) <= 0.5  # the bar of DESIGN.md; measured 0.0001 %
    crossing = read_summary(tmp_path / "out").crossing
    assert (crossing["modes_before"], crossing["modes_after"]) == (0, 1)


def test_no_limit_point_is_reported_where_there_is_none(scene, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("studies.planning.bodies.MERIDIAN_LEVELS", ("r1",))
    path = scene("sphere", ('quantities = ["bore_mm"]', 'quantities = ["bore_mm", "limit_kpa"]'))
    (limit,) = finest(solved(path, tmp_path / "out"), "limit_kpa")
    assert math.isnan(limit.value)
    assert math.isnan(limit.reference)
    assert limit.status.startswith("none up to")


@pytest.mark.parametrize(("name", "load"), [("ring-2", "external"), ("ring-3", "external"), ("ring-3", "dead")])
def test_ring_buckles_where_it_should(scene, tmp_path, monkeypatch, name: str, load: str) -> None:
    monkeypatch.setattr("studies.planning.bodies.RING_LEVELS", ("r1",))
    rows = solved(scene(name, ('kind = "external" ', f'kind = "{load}" ')), tmp_path / "out")
    (crossing,) = finest(rows, "crossing_kpa")
    assert abs(crossing.error_percent) <= 1.0  # the bar of DESIGN.md; measured 0.55 and 0.19 %
    assert load in crossing.source or load == "external"
    assert [r.value for r in finest(rows, "unstable_modes")] == [0.0, 0.0, 1.0]
    # while it is round, also past its buckling; measured 1e-4 %
    assert all(abs(r.error_percent) < 0.01 for r in finest(rows, "bore_mm"))


THICK_RING = """
name = "thick"
geometry = {kind = "ring", inner_radius_mm = 3.09, outer_radius_mm = 6.18, waves = 3}
material = {law = "guccione", c_kpa = 11.9, b = 4.15}
load = {kind = "external", pressure_kpa = [17.0]}
ask = {quantities = ["crossing_kpa"]}
"""


def test_cells_of_a_plane_body_have_no_modes_along_its_axis(tmp_path, monkeypatch) -> None:
    # the round ring is stable to 34.96 kPa; with cells four times as thick as high it had eight unstable modes here
    monkeypatch.setattr("studies.planning.bodies.RING_LEVELS", ("r4",))
    path = tmp_path / "thick.toml"
    path.write_text(THICK_RING, encoding="utf-8")
    run("solve", path, "--out", tmp_path / "out")  # a single mesh is never certain: exit code 3
    rows = read_rows(tmp_path / "out" / "rows.csv")
    assert [r.value for r in finest(rows, "unstable_modes")] == [0.0]
    assert finest(rows, "crossing_kpa")[0].reference == pytest.approx(34.96, rel=1e-3)


def test_two_coarse_meshes_do_not_promise_where_a_thick_ring_buckles(tmp_path, monkeypatch) -> None:
    # r1 and r2 are 10 and 5 % below the exact 48950 kPa: order one, as the error of coarse meshes falls at first
    monkeypatch.setattr("studies.planning.bodies.RING_LEVELS", ("r1", "r2"))
    path = tmp_path / "thick.toml"
    law = 'law = "ogden", mu_kpa = 39600.0, alpha = 7.29, convention = "2mu/alpha^2"'
    text = THICK_RING.replace('law = "guccione", c_kpa = 11.9, b = 4.15', law).replace("3.09", "1.01")
    path.write_text(text.replace("6.18", "2.02").replace("17.0", "55000.0"), encoding="utf-8")
    run("solve", path, "--out", tmp_path / "out")
    rows = [r for r in read_rows(tmp_path / "out" / "rows.csv") if r.quantity == "crossing_kpa"]
    assert {"r1", "r2"} <= {row.level for row in rows}
    assert all(abs(row.value - row.reference) < row.uncertainty for row in rows)


def test_rivlins_cube_gives_way_at_twice_the_shear_modulus(scene, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("studies.planning.bodies.BLOCK_LEVELS", ("n2",))
    rows = solved(scene("cube"), tmp_path / "out")
    (crossing,) = finest(rows, "crossing_kpa")
    assert abs(crossing.error_percent) <= 0.1  # the bar of DESIGN.md; measured 0.0003 %, the interval's width
    (modes,) = finest(rows, "crossing_modes")
    assert modes.value >= 5.0


def test_users_mesh_gives_what_the_same_body_of_this_program_does(scene, tmp_path) -> None:
    out = tmp_path / "out"
    rows = solved(scene("mesh"), out)
    assert len(list((out / "full3d-m1" / "fields").glob("*.vtu"))) == 2
    sphere = shipped("sphere")
    for row in finest(rows, "volume_mm3"):
        bore = 5.0 + exact_bore_mm(sphere, row.pressure_kpa)[0]
        # cells of 1.7 mm on 5 mm: measured 0.04 %
        assert row.value == pytest.approx(math.pi / 6.0 * bore**3, rel=1e-3)


def test_users_mesh_whose_load_has_no_potential_is_solved_and_said_to_be_so(scene, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("studies.planning.bodies.USER_LEVELS", ("m1",))
    path = scene(
        "mesh", ('"displacement_max_mm"', '"tip_mm"'), ("10.0, 20.0", "2.0"), ("fields = true", "fields = false")
    )
    mesh = tmp_path / "octant.msh"
    # an edge of the cavity is free: the pressure on it is no gradient of a volume
    mesh.write_bytes(mesh.read_bytes().replace(b'"symmetry_x"', b'"clamped"').replace(b'"symmetry_y"', b'"tip"'))
    out = tmp_path / "out"
    result = run("solve", path, "--out", out)
    # one mesh alone does not know its error: the answer is kept, but no tolerance is held
    assert result.exit_code == 3, result.output
    assert "no second mesh confirms it" in " ".join(result.output.split())
    rows = read_rows(out / "rows.csv")
    assert any("not conservative" in note for note in read_summary(out).plan)
    assert not [r for r in rows if r.quantity == "unstable_modes"]
    (tip,) = finest(rows, "tip_mm")
    assert read_path(out)[-1].tip_mm == pytest.approx(tip.value, rel=1e-9)


def test_pressure_beyond_the_limit_point_exits_3_and_keeps_what_was_reached(scene, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("studies.planning.bodies.MERIDIAN_LEVELS", ("r1",))
    path = scene("sphere-limit", ("[10.0, 20.0]", "[20.0, 31.0]"), (', "limit_kpa"', ""))
    out = tmp_path / "out"
    assert run("solve", path, "--out", out).exit_code == 3
    low, high = finest(read_rows(out / "rows.csv"), "bore_mm")
    assert low.status == "reached"
    assert math.isnan(high.value)
    assert "limit point" in high.status
    assert math.isnan(high.reference)  # the exact sphere does not carry it either


def test_interrupted_run_goes_on_to_the_same_answer(scene, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("studies.planning.bodies.BLOCK_LEVELS", ("n2",))
    path, out = scene("cube"), tmp_path / "out"
    save = run_log.save_state

    def die_at_the_second(folder, content_hash, state, row):
        if row.pressure_kpa > 150.0:
            raise SystemExit("killed")
        save(folder, content_hash, state, row)

    with monkeypatch.context() as patch:
        patch.setattr(run_log, "save_state", die_at_the_second)
        assert run("solve", path, "--out", out).exit_code == 1
    assert (out / "full3d-n2" / "checkpoint.npz").exists()
    rows, whole = solved(path, out), solved(path, tmp_path / "whole")
    # the same steps, bit for bit; rows.csv has nine digits
    assert [r.value for r in rows] == [r.value for r in whole]
    assert (out / "full3d-n2" / "measured.json").read_bytes() == (
        tmp_path / "whole/full3d-n2/measured.json"
    ).read_bytes()


def test_batch_and_report(scene, tmp_path) -> None:
    out = tmp_path / "out"
    result = run("batch", scene("cube"), scene("mesh"), "--out", out)
    assert result.exit_code == 0, result.output
    assert run("report", out).exit_code == 0
    page = (out / "report.md").read_text(encoding="utf-8")
    assert "exact: Rivlin" in page
    assert "bifurcation at 144 kPa" in page
    assert "data:image/png" in (out / "report.html").read_text(encoding="utf-8")
    assert {r.scene for r in read_rows(out / "rows.csv")} == {"cube", "mesh"}
    # a single folder too, when the mesh is not where it was any more
    assert run("report", out / "mesh").exit_code == 0


# --- refused -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.toml")), ids=lambda p: p.stem)
def test_shipped_scenes_are_accepted_and_planned(path: Path) -> None:
    assert load_scene(path).name == path.stem
    result = run("plan", path)
    assert result.exit_code == 0
    assert "path from 0 through" in result.output


def test_exact_crossings_by_kind() -> None:
    follower, source = exact_crossing_kpa(shipped("ring-2"))
    assert follower == pytest.approx(0.43992, rel=1e-4)  # analytical.exact.ring, tested there
    assert "follower" in source
    assert math.isnan(exact_crossing_kpa(shipped("tube"))[0])


@pytest.mark.parametrize(
    ("name", "old", "new", "said"),
    [
        ("tube", 'kind = "tube"', 'kind = "tub"', "geometry.kind = 'tub': allowed: 'bellows', 'tube'"),
        ("tube", "inner_radius_mm", "iner_radius_mm", "geometry.iner_radius_mm = 5.0: unknown key; did you mean inner"),
        ("tube", "inner_radius_mm = 5.0", "inner_radius_mm = 8.0", "must be less than outer_radius_mm = 7"),
        ("tube", "inner_radius_mm = 5.0", "inner_radius_mm = 1e-300", "must be at least 7e-09"),
        ("tube", 'ends = "plane-strain"', 'ends = "open"', "geometry.ends = 'open': allowed"),
        ("tube", "[10.0, 20.0, 30.0]", "[20.0, 10.0]", "must ascend"),
        ("tube", "[10.0, 20.0, 30.0]", "[10.0, 10.00005]", "must ascend strictly, by more than 1e-05"),
        ("tube", 'quantities = ["bore_mm"]', 'quantities = ["crossing_kpa"]', "allowed for a tube: 'bore_mm'"),
        ("tube", "[10.0, 20.0, 30.0]", "[10000.0]", "check the units"),
        ("sphere", "inner_radius_mm = 5.0", "length_mm = 5.0", "geometry.length_mm = 5.0: unknown key"),
        ("ring-2", "waves = 2", "waves = 5", "geometry.waves = 5: allowed"),
        ("ring-2", 'kind = "external" ', 'kind = "cavity" ', "allowed for a ring: 'external', 'dead'"),
        ("cube", "tension_kpa", "pressure_kpa", "a block is loaded by load.tension_kpa"),
        ("mesh", "octant.msh", "other.msh", "other.msh: cannot be read"),
        ("mesh", "scale = 1.0", "scale = 0.001", "set scale = 1000"),
        ("mesh", '["volume_mm3", "displacement_max_mm"]', '["tip_mm"]', "no surface of the mesh is named 'tip'"),
    ],
)
def test_wrong_scenes_exit_2_and_write_nothing(scene, tmp_path, name: str, old: str, new: str, said: str) -> None:
    path, out = scene(name, (old, new)), tmp_path / "out"
    with pytest.raises(SceneError) as refusal:
        load_scene(path)
    assert said in str(refusal.value)
    assert run("solve", path, "--out", out).exit_code == 2
    assert not out.exists()


def test_a_mesh_that_nothing_holds_is_refused(scene, tmp_path) -> None:
    path = scene("mesh")
    mesh = tmp_path / "octant.msh"
    mesh.write_bytes(mesh.read_bytes().replace(b'"symmetry_x"', b'"outer"'))
    with pytest.raises(SceneError, match="nothing holds the body.*along x: symmetry_x"):
        load_scene(path)


def test_models_a_body_has_not_are_refused(scene) -> None:
    for name, model, said in (
        ("ring-2", "full3d", "a ring has sector"),
        ("tube", "closed_form", "exact answer stands"),
    ):
        result = run("plan", scene(name), "--model", model)
        assert result.exit_code == 2
        assert said in result.output


def test_a_bifurcation_is_no_limit_point(tmp_path) -> None:
    # the pressure in a stiffening tube has no maximum, p = int mu (l^a - l^-a) / (l (l^2 - 1)) dl rises on and on, but
    # a wave along it grows inside from 393 kPa on; a drawn scene was told that pressure as the limit point
    text = """name = "tube"
[geometry]
kind = "tube"
inner_radius_mm = 8.11
outer_radius_mm = 31.467
length_mm = 10.8
ends = "plane-strain"
[material]
law = "ogden"
mu_kpa = 52.1
alpha = 6.26
convention = "mu/alpha"
[load]
pressure_kpa = [70.64]
[ask]
quantities = ["limit_kpa"]
"""
    path = tmp_path / "tube.toml"
    path.write_text(text, encoding="utf-8")
    limit = finest(solved(path, tmp_path / "out"), "limit_kpa")[0]
    assert math.isnan(limit.value) and limit.status.startswith("none up to 3")
    assert limit.status.endswith("where a bifurcation (unstable modes 0 -> 1) ends the search")


def test_each_mesh_of_a_short_bonded_tube_has_more_cells_along_it(scene) -> None:
    # with two along r1 and r2 a drawn one was 3 % off, told 1.3
    tube = load_scene(scene("tube", ('"plane-strain"   ', '"bonded"   '), ("length_mm = 2.0", "length_mm = 0.6")))
    assert isinstance(tube, BodyScene)
    heights = [body_of(tube, "axisymmetric", level).mesh.points[:, 1] for level in ("r1", "r2", "r4")]
    assert [len(np.unique(z.round(9))) for z in heights] == [5, 9, 17]
