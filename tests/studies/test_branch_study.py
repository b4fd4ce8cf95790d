"""The branch study: cases are kept, read back, repeated when something changed; modes in the plane of symmetry."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from solvers.state import State
from studies.branches import study as branch_study
from studies.branches.cases import SQUIRM_SCENE, in_plane, mirrored
from studies.branches.study import read_case, run_study, write_report
from studies.results.rows import read_rows
from studies.scene.files import load_bellows
from studies.scene.meshes import scene_body, scene_meridian


@pytest.fixture(scope="module")
def kept(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("branches")
    write_report(folder, run_study(folder, MPI.COMM_SELF, ["two-spheres", "cube"]))
    return folder


def test_cases_are_within_half_a_percent_of_exact(kept) -> None:
    rows = [r for r in read_rows(kept / "rows.csv") if r.quantity == "load_kpa"]
    assert {r.scene for r in rows} == {"two-spheres", "cube"}
    # measured 3e-3 % at most
    assert max(abs(r.error_percent) for r in rows) < 0.05
    facts = {r.quantity: r for r in read_rows(kept / "rows.csv") if r.quantity.startswith(("limit", "fold"))}
    assert set(facts) == {"limit_kpa", "limit_mm3", "fold_back_mm3", "fold_forward_mm3"}
    # asked 0.5 %
    assert max(abs(r.error_percent) for r in facts.values()) < 0.2
    report = (kept / "report.md").read_text(encoding="utf-8")
    assert "## Rivlin's cube" in report and "squirms\n\nTwo convolutions" not in report


def test_cases_that_are_there_are_not_solved_again(kept, monkeypatch) -> None:
    def forbidden(_):
        raise AssertionError("solved again")

    monkeypatch.setattr(branch_study, "CASES", {"cube": forbidden})
    ((result, stamp),) = run_study(kept, MPI.COMM_SELF, ["cube"])
    assert result.name == "cube" and stamp["ranks"] == "1"
    monkeypatch.setattr(branch_study.provenance, "code_hash", lambda: "another")
    with pytest.raises(AssertionError, match="solved again"):
        run_study(kept, MPI.COMM_SELF, ["cube"])


def test_damaged_and_missing_cases_are_none(kept, tmp_path) -> None:
    assert read_case(tmp_path, "cube") is None
    (tmp_path / "cases").mkdir()
    text = (kept / "cases" / "cube.json").read_text(encoding="utf-8")
    for damaged in (text[: len(text) // 2], json.dumps({"content_hash": branch_study.case_hash("cube")}), "[]"):
        (tmp_path / "cases" / "cube.json").write_text(damaged, encoding="utf-8")
        assert read_case(tmp_path, "cube") is None


def test_part_of_a_mode_in_the_plane_of_symmetry() -> None:
    body = scene_body(scene_meridian(load_bellows(SQUIRM_SCENE), 1), "full3d", 6)
    x, y, z = body.points.T
    # a shear along a direction at 30 degrees from x, and a ring that follows
    way = np.array([np.cos(np.pi / 6.0), np.sin(np.pi / 6.0), 0.0])
    bodies = np.array([[*way, -0.1 * way[1], 0.1 * way[0], 0.3]])
    mode = State(z[:, None] * way / z.max(), np.zeros(3), bodies, 0.001)
    twice = mirrored(body, mirrored(body, mode))
    assert np.allclose(twice.displacement_mm, mode.displacement_mm, atol=1e-12)
    assert np.allclose(twice.bodies_mm, mode.bodies_mm)
    flat = in_plane(body, mode)
    assert np.abs(flat.displacement_mm).max() == pytest.approx(1.0)
    assert np.abs(flat.displacement_mm[:, 1]).max() < 1e-12
    assert np.allclose(flat.displacement_mm[:, 0], z / z.max())
    # the ring moves along x, turns about y, and neither twists nor tilts the other way
    assert flat.bodies_mm[0] == pytest.approx([1.0, 0.0, 0.0, 0.0, 0.1, 0.0], abs=1e-12)
