"""A scene asks for arc length: the same answers as by volume, and the column of path.csv says how."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from studies.__main__ import main
from studies.results.run_files import read_path

ROOT = Path(__file__).resolve().parents[3]


def test_sphere_by_arc_length_and_by_volume(tmp_path: Path) -> None:
    text = (ROOT / "scenes" / "exact" / "sphere.toml").read_text(encoding="utf-8")
    assert 'control = "auto"' in text
    paths = {}
    for control in ("arc", "volume"):
        scene = tmp_path / f"{control}.toml"
        scene.write_text(text.replace('control = "auto"', f'control = "{control}"'), encoding="utf-8")
        out = tmp_path / control
        done = CliRunner().invoke(main, ["solve", str(scene), "--out", str(out), "--model", "axisymmetric"])
        assert done.exit_code == 0, done.output
        paths[control] = read_path(out / "axisymmetric-r1")  # finer meshes start from its states
    asked = {c: [row for row in rows if row.status == "requested"] for c, rows in paths.items()}
    assert [r.pressure_kpa for r in asked["arc"]] == [r.pressure_kpa for r in asked["volume"]]
    for a, b in zip(asked["arc"], asked["volume"], strict=True):
        # two solutions of the same equations, Newton to 1e-8 of the load
        assert a.volume_mm3 == pytest.approx(b.volume_mm3, rel=1e-7)
    assert "arc" in {row.control for row in paths["arc"]}
    assert "arc" not in {row.control for row in paths["volume"]}
