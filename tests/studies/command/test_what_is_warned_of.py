"""What the commands say of laws that soften, of what looks like another unit, and of stretches beyond a law's data."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from click.testing import CliRunner

from analytical.exact import sphere, tube
from analytical.laws.isotropic import Yeoh
from studies.__main__ import main
from studies.results.rows import read_rows
from studies.results.run_files import read_path, read_summary

ROOT = Path(__file__).resolve().parents[3]
FREE_FIT = "c_kpa = [22.2115, 2.6603, -0.0735]"
LAW = "law: stable up to stretch 4.49 (uniaxial), 3.19 (equibiaxial), 4.41 (pure shear)"


def invoke(*arguments: object):
    return CliRunner().invoke(main, [str(a) for a in arguments])


@pytest.fixture
def scene(tmp_path):
    """Path of the Yeoh sphere, or tube, with texts replaced."""

    def make(*pairs: tuple[str, str], body: str = "sphere-yeoh") -> Path:
        text = (ROOT / "scenes" / "exact" / f"{body}.toml").read_text(encoding="utf-8")
        for old, new in pairs:
            assert old in text, old
            text = text.replace(old, new)
        path = tmp_path / "body.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return make


def test_a_law_that_softens_runs_to_where_it_does_and_no_further(scene, tmp_path) -> None:
    path = scene(("c_kpa = [36.0, 2.5, 0.23]", FREE_FIT), ("[10.0, 20.0, 30.0]", "[5.0, 20.0, 25.0, 40.0]"))
    assert LAW in invoke("plan", path).output
    out = tmp_path / "out"
    done = invoke("solve", path, "--out", out)
    assert done.exit_code == 3, done.output
    assert LAW in done.stderr and "stopped early: the law is no longer stable at stretch 3.1" in done.stderr
    rows = [r for r in read_rows(out / "rows.csv") if r.quantity == "bore_mm"]
    law = Yeoh((0.0222115, 0.0026603, -0.0000735))
    body = sphere.Sphere(5.0, 7.0)
    for row in rows:
        if row.pressure_kpa < 30.0:
            exact = sphere.inner_radius_at_pressure_mm(body, law, 1e-3 * row.pressure_kpa) - 5.0
            assert row.value == pytest.approx(exact, rel=1e-3) and row.reference == pytest.approx(exact, rel=1e-8)
        else:
            assert math.isnan(row.value) and math.isnan(row.reference)
            assert row.status.startswith("stopped at") and "the law is no longer stable at stretch 3.1" in row.status
    # 3.194 is where it softens in equibiaxial extension, which is that of the bore
    assert max(r.largest_stretch for r in read_path(out)) < 3.195
    assert read_summary(out).cause == "law no longer stable"


def test_a_law_that_is_unstable_at_once_is_refused(scene, tmp_path) -> None:
    for constants in ("[-1.0, 2.5]", "[0.0, 2.5]"):
        done = invoke("solve", scene(("[36.0, 2.5, 0.23]", constants)), "--out", tmp_path / "out")
        assert done.exit_code == 2 and "C1" in done.stderr
        assert not (tmp_path / "out").exists()
    text = (
        'law = "yeoh"\nc_kpa = [36.0, 2.5, 0.23]',
        'law = "ogden"\nconvention = "mu/alpha"\nmu_kpa = {}\nalpha = {}',
    )
    for mu, alpha in ((40.0, -3.0), (-40.0, 3.0), (40.0, 0.0), (40.0, 0.001)):
        done = invoke("plan", scene((text[0], text[1].format(mu, alpha))))
        assert done.exit_code == 2 and "alpha" in done.stderr
    # two signs that make one positive modulus are a law
    assert invoke("plan", scene((text[0], text[1].format(-40.0, -3.0)))).exit_code == 0


def test_units_that_look_mixed_up_are_told_by_plan_and_solve(scene, tmp_path) -> None:
    path = scene(("[10.0, 20.0, 30.0]", "[0.01, 0.02]"))
    said = "warning: load.pressure_kpa reaches 0.02: 0.00028 of the initial shear modulus, 72 kPa"
    assert said in invoke("plan", path).output
    done = invoke("solve", path, "--out", tmp_path / "out")
    assert done.exit_code == 0 and said in done.stderr
    assert any(note.startswith(said) for note in read_summary(tmp_path / "out").plan)
    again = json.loads(invoke("solve", path, "--out", tmp_path / "out", "--json").stdout)
    assert any(note.startswith(said) for note in again["warnings"])


def test_largest_stretch_is_a_column_and_warned_of_beyond_what_is_known(scene, tmp_path) -> None:
    path = scene(
        ("inner_radius_mm = 5.0", "inner_radius_mm = 6.5"),
        ("outer_radius_mm = 7.0", "outer_radius_mm = 6.8"),
        ("[10.0, 20.0, 30.0]", "[5.0, 60.0]"),
        body="tube",
    )
    out = tmp_path / "out"
    done = invoke("solve", path, "--out", out)
    assert done.exit_code == 0, done.stderr
    assert "largest stretch" in done.stdout
    law = Yeoh((0.036, 0.0025, 0.00023))
    found = {r.pressure_kpa: r for r in read_rows(out / "rows.csv") if r.quantity == "largest_stretch"}
    for pressure, row in found.items():
        exact = tube.inner_radius_at_pressure_mm(tube.Tube(6.5, 6.8), law, 1e-3 * pressure) / 6.5
        # points of the quadrature are within the wall, whose stretch is a few percent less outside
        assert exact * (1.0 - 0.02) < row.value < exact * (1.0 + 1e-4)
    assert found[60.0].value > 4.0
    warning = (
        f"warning: the largest stretch is {found[60.0].value:.3g} at 60 kPa: up to which stretch the law's data go"
    )
    assert warning in done.stderr
    assert any(note.startswith(warning) for note in read_summary(out).plan)
    (low, high) = json.loads(invoke("solve", path, "--out", out, "--json").stdout)["largest_stretch"]
    assert (low["pressure_kpa"], high["pressure_kpa"]) == (5.0, 60.0)
    assert high["value"] == pytest.approx(found[60.0].value, rel=1e-8)
    told = path.read_text().replace("[load]", "data_to_stretch = 3.0\n[load]")
    path.write_text(told, encoding="utf-8")
    assert (
        "beyond the law's data, which go to 3 (material.data_to_stretch)" in invoke("solve", path, "--out", out).stderr
    )
