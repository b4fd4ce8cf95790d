"""The branch study: cases are kept, repeated when something changed; modes in the plane of symmetry."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from solvers.state import State
from studies.branches import study as branch_study
from studies.branches.findings import Findings
from studies.branches.squirm import SCENE, blocked_bellows, in_plane, mirrored
from studies.branches.study import STUDY, cases, solve
from studies.engine import Setting, run
from studies.progress import Progress
from studies.results.rows import read_rows
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_body, scene_meridian


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("branches")
    assert run(STUDY, folder, MPI.COMM_SELF, {"case": ("two-spheres", "cube")}) == 0
    return folder


def test_cases_are_within_half_a_percent_of_exact(kept: Path) -> None:
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


def test_cases_that_are_there_are_not_solved_again(kept: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def forbidden(_: MPI.Comm) -> Findings:
        raise AssertionError("solved again")

    (cube,) = cases({"case": ("cube",)})
    cube = dataclasses.replace(cube, solve=forbidden)
    at = Setting(kept, MPI.COMM_SELF, Progress(MPI.COMM_SELF), {})
    assert list(solve(cube, at).branches) == ["plates", "rods"]
    monkeypatch.setattr(branch_study.provenance, "code_hash", lambda: "another")
    with pytest.raises(AssertionError, match="solved again"):
        solve(cube, at)


def test_part_of_a_mode_in_the_plane_of_symmetry() -> None:
    body = scene_body(scene_meridian(load_bellows(SCENE), 1), "full3d", 6)
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


@pytest.mark.slow
def test_a_bellows_that_squirms_keeps_to_a_plane_although_it_may_turn() -> None:
    found = {fact.quantity: fact for fact in blocked_bellows(MPI.COMM_SELF).facts}
    # docs/branches/rows.csv: the branch carries a quarter less than the straight body
    assert found["modes_at_crossing"].value == 2.0
    assert found["force_bent_out_n"].value == pytest.approx(0.4896, rel=1e-3)
    assert found["across_mm"].value < 1e-6 * found["sideways_mm"].value
