"""Full 3D solved on a quarter is full 3D: states, counts, crossings and files are those of the whole body."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI
from scipy.spatial import cKDTree

from solvers.errors import Cause, StepFailed
from solvers.stability.parity import ParityFactor
from studies.models import full3d
from studies.models.axisymmetric import run_axisymmetric
from studies.models.run_log import CHECKPOINT_FILE, Log
from studies.models.symmetry.mirrored import Proof
from studies.planning.levels import BodyLevel
from studies.planning.planner import describe, make_plan
from studies.progress import Progress
from studies.results.run_files import load_state
from studies.results.runs import Run, run_hash
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows
from studies.scene.meshes import AS_A_WHOLE, ON_A_PART, scene_body, scene_meridian, solved_part

SCRIPT = Path(__file__).with_name("quarter_script.py")
ROOT = SCRIPT.parents[4]
ONE = {"convolutions = 8 ": "convolutions = 1 "}
SCENES: dict[str, tuple[str, dict[str, str], list[float]]] = {
    "free": ("heung-t2-ri5.toml", ONE, [5.0, 20.0]),
    # stiff cells, and no rigid bodies
    "meshed": (
        "heung-t2-ri5.toml",
        {**ONE, 'model = "auto"  ': 'model = "meshed"', 'element = "auto"': 'element = "hex"'},
        [5.0, 20.0],
    ),
    # its core sits off the axis: half a body
    "core": ("imperfection/short-core-10.toml", {"convolutions = 2": "convolutions = 1"}, [2.0, 8.0]),
    # bends sideways at 1.05 kPa
    "blocked": ("modes/blocked-short.toml", {}, [1.0, 1.1]),
}
# bisection on the whole body takes most of a minute
ALL = ["free", "meshed", "core", pytest.param("blocked", marks=pytest.mark.slow)]


def scene_file(name: str, folder: Path) -> Path:
    source, changes, pressures = SCENES[name]
    text = (ROOT / "scenes" / source).read_text(encoding="utf-8")
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    lines = [f"pressure_kpa = {pressures}" if line.startswith("pressure_kpa") else line for line in text.splitlines()]
    out = folder / f"{name}.toml"
    out.write_text("\n".join(lines), encoding="utf-8")
    return out


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("quarter")


def run(scene: BellowsScene, folder: Path, name: str) -> Run:
    comm, progress = MPI.COMM_SELF, Progress(MPI.COMM_SELF)
    run_axisymmetric(scene, 1, folder / "flat", comm, progress)
    return full3d.run_full3d(scene, "full3d", BodyLevel(8), folder / "flat", folder / name, comm, progress, ())


def changed(scene: BellowsScene, section: str, **changes: Any) -> BellowsScene:
    return scene.model_copy(update={section: getattr(scene, section).model_copy(update=changes)})


@pytest.fixture(scope="module")
def solved(folder) -> dict[str, dict[str, Run]]:
    """Runs of each scene on a part and as a whole, as they are asked for."""

    class Solved(dict[str, dict[str, Run]]):
        def __missing__(self, name: str) -> dict[str, Run]:
            scene = load_bellows(scene_file(name, folder))
            ways = {how: changed(scene, "mesh", symmetry=how) for how in ("auto", "off")}
            self[name] = {how: run(of, folder / name, how) for how, of in ways.items()}
            return self[name]

    return Solved()


def assert_same(one: Sequence[dict[str, Any]], other: Sequence[dict[str, Any]]) -> None:
    """All figures of path.csv but times, iterations and residuals."""
    assert len(one) == len(other) == 2
    for a, b in zip(one, other, strict=True):
        for key in set(a) - {"wall_s", "newton_iterations", "residual", "whole_residual"}:
            if isinstance(a[key], float):
                # both are converged to 1e-8 of the load, quadratically: to much less in displacements; the slip of a
                # rigid bond is 1e-6 of them, and so are its last digits
                relative = 1e-6 if key == "bond_slip_rms_mm" else 1e-9
                assert a[key] == pytest.approx(b[key], rel=relative, nan_ok=True), key
            else:
                assert a[key] == b[key], key


def rows(of: Run) -> list[dict[str, Any]]:
    assert of.summary.status == "reached"
    return [dataclasses.asdict(row) for row in of.path]


@pytest.mark.parametrize("name", ALL)
def test_the_quarter_gives_the_whole_bodys_answer(solved, name: str) -> None:
    quarter, whole = solved[name]["auto"], solved[name]["off"]
    assert_same(rows(quarter), rows(whole))
    one, other = quarter.summary, whole.summary
    assert one.dofs == other.dofs == other.solved_dofs
    assert one.cells == other.cells
    # the same iterations, but for one that round-off decides on
    assert abs(one.newton_iterations - other.newton_iterations) <= 1
    parts = 2 if name == "core" else 4
    # nodes on the planes are the part's wholly
    assert 1.0 < parts * one.solved_dofs / one.dofs < 1.3


@pytest.mark.parametrize("name", ALL)
def test_each_state_is_proved_by_the_whole_bodys_residual(solved, name: str) -> None:
    quarter, whole = ([row.whole_residual for row in solved[name][how].path] for how in ("auto", "off"))
    assert all(0.0 < residual < 1e-8 for residual in quarter)
    assert all(math.isnan(residual) for residual in whole)


@pytest.mark.slow
def test_a_pair_that_bends_sideways_is_counted_and_located(solved) -> None:
    quarter, whole = solved["blocked"]["auto"], solved["blocked"]["off"]
    assert [row.unstable_modes for row in quarter.path] == [0.0, 2.0]
    one, other = dict(quarter.summary.crossing), whole.summary.crossing
    assert one.pop("parity_class") == "SA"
    assert set(one) == set(other)
    # the bisection ends early at a tangent that happens to be singular: how close it came is in the summary
    apart = abs(one["pressure_kpa"] - other["pressure_kpa"])
    within = [of["within_kpa"] for of in (one, other)]
    assert apart < sum(within) and max(within) < 1e-4 * one["pressure_kpa"]
    for key in set(one) - {"within_kpa"}:
        near = pytest.approx(other[key], rel=1e-4) if isinstance(other[key], float) else other[key]
        assert one[key] == near, key


@pytest.mark.slow
def test_the_critical_mode_is_one_of_the_whole_bodys_pair(solved, folder) -> None:
    assert solved["blocked"]["off"].summary.crossing["modes_after"] == 2
    ours, theirs = (np.load(folder / "blocked" / how / "critical_mode.npz") for how in ("auto", "off"))
    assert ours["points_mm"] == pytest.approx(theirs["points_mm"])
    points, mode = ours["points_mm"], ours["mode_mm"]
    assert np.abs(mode[:, 0]).max() == pytest.approx(1.0)
    # its partner is its image at 45 degrees; the inverse iteration of the whole body ends somewhere between them
    _, image = cKDTree(points).query(points[:, [1, 0, 2]])
    pair = np.stack([mode.ravel(), mode[image][:, [1, 0, 2]].ravel()], axis=1)
    share, *_ = np.linalg.lstsq(pair, theirs["mode_mm"].ravel(), rcond=None)
    left = theirs["mode_mm"].ravel() - pair @ share
    # iterated until the stiffness has settled to 1e-6, so to 1e-3 in the mode
    assert np.linalg.norm(left) < 1e-3 * np.linalg.norm(theirs["mode_mm"])
    bodies, rings = ours["mode_bodies_mm"], theirs["mode_bodies_mm"]
    assert bodies.shape == rings.shape
    assert np.abs(bodies[:, [1, 2, 3, 5]]).max() == 0.0  # along x, and about y
    assert np.abs(bodies[:, 0]).max() > 0.1


def test_states_and_fields_are_the_whole_bodys(solved, folder) -> None:
    quarter, whole = (
        load_state(folder / "free" / how, of.summary.content_hash, 0.02) for how, of in solved["free"].items()
    )
    scene = load_bellows(scene_file("free", folder))
    assert quarter is not None and whole is not None
    mesh = scene_body(scene_meridian(scene, 1), "full3d", 8)
    assert quarter[0].displacement_mm.shape == mesh.points.shape
    for name in ("displacement_mm", "pressure_mpa", "bodies_mm"):
        one, other = getattr(quarter[0], name), getattr(whole[0], name)
        assert np.abs(one - other).max() < 1e-9 * np.abs(other).max(), name
    for how in ("auto", "off"):
        written = (folder / "free" / how / "fields" / "p20.000.vtu").read_text(encoding="utf-8")
        assert f'NumberOfPoints="{len(mesh.points)}" NumberOfCells="{len(mesh.cells)}"' in written


def test_one_and_two_ranks_agree(python, solved, folder) -> None:
    two = python.answer(2, SCRIPT, scene_file("free", folder), folder / "free-2")
    assert_same(two, rows(solved["free"]["auto"]))
    assert all(row["whole_residual"] < 1e-8 for row in two)


# ---- where it does not hold ----------------------------------------------------------------------------


@pytest.fixture
def small(tmp_path) -> BellowsScene:
    scene = load_bellows(scene_file("free", tmp_path))
    geometry = scene.geometry.model_copy(update={"convolutions": 1})
    load = scene.load.model_copy(update={"pressure_kpa": [2.0, 4.0]})
    return scene.model_copy(update={"geometry": geometry, "load": load})


def test_where_symmetry_does_not_hold_the_whole_body_is_solved(small) -> None:
    assert solved_part(small, 8) == solved_part(small, 16) == ("sector", "")
    assert solved_part(changed(small, "geometry", eccentricity=0.1), 8) == ("half", "")
    for of, around, words in (
        (changed(small, "mesh", symmetry="off"), 8, 'symmetry = "off"'),
        (changed(small, "mesh", element="tet"), 8, "hexahedra"),
        (changed(small, "rings", model="meshed"), 8, "hexahedra"),
        (changed(small, "mesh", solver="iterative"), 8, "iterative"),
        (small, 12, "multiple of 8"),
        (changed(small, "geometry", tip="rigid"), 6, "multiple of 4"),
    ):
        part, why = solved_part(of, around)
        assert part == "full3d" and words in why
    assert solved_part(changed(small, "geometry", tip="rigid"), 12) == ("sector", "")


def test_a_state_that_is_not_proved_is_solved_as_a_whole(small, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(Proof, "residual", lambda self, state: 1e-3)
    found = run(small, tmp_path, "unproved")
    assert found.summary.status == "reached"
    assert found.summary.solved_dofs == found.summary.dofs
    assert any(note.startswith(AS_A_WHOLE) and "residual of 1.0e-03" in note for note in found.summary.plan)
    assert ON_A_PART["sector"] not in found.summary.plan
    assert [row.unstable_modes for row in found.requested] == [0.0, 0.0]


def test_where_the_quarters_factors_do_not_fit_the_whole_is_tried(small, tmp_path, monkeypatch) -> None:
    def fails(self) -> None:
        raise StepFailed("too little memory", Cause.OUT_OF_MEMORY)

    monkeypatch.setattr(ParityFactor, "refresh", fails)
    found = run(small, tmp_path, "memory")
    assert found.summary.status == "reached"
    assert any(note.startswith(AS_A_WHOLE) and "memory" in note for note in found.summary.plan)


def test_an_interrupted_run_goes_on_after_its_last_state(small, tmp_path, monkeypatch) -> None:
    whole = run(small, tmp_path, "whole")
    step = Log.step

    def killed(self, memory) -> None:
        step(self, memory)
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Log, "step", killed)
        with pytest.raises(KeyboardInterrupt):
            run(small, tmp_path, "killed")
    assert (tmp_path / "killed" / CHECKPOINT_FILE).exists()
    resumed = run(small, tmp_path, "killed")
    assert [row.tip_mm for row in resumed.path] == pytest.approx([row.tip_mm for row in whole.path], rel=1e-12)
    assert ON_A_PART["sector"] in resumed.summary.plan


# ---- the plan and the hash -----------------------------------------------------------------------------


def test_the_plan_says_which_part_is_solved_and_why(small) -> None:
    plan = make_plan(small, "full3d")
    assert ON_A_PART["sector"] in plan.skipped
    assert "full 3D on a quarter, hexahedra" in describe(small, plan)
    off = changed(small, "mesh", symmetry="off")
    plan = make_plan(off, "full3d")
    assert f'{AS_A_WHOLE}mesh.symmetry = "off"' in plan.skipped
    assert "on a quarter" not in describe(off, plan)


def test_bodies_on_a_quarter_have_multiples_of_eight_cells_round(small) -> None:
    close, off = (changed(small, "ask", tolerance_percent=t) for t in (0.1, 10.0))
    assert make_plan(close, "full3d").around_levels == (16,)
    assert make_plan(off, "full3d").around_levels == (8,)
    assert make_plan(changed(off, "mesh", symmetry="off"), "full3d").around_levels == (6,)


def test_axisymmetric_runs_do_not_depend_on_it(small) -> None:
    off = changed(small, "mesh", symmetry="off")
    assert run_hash(small, "axisymmetric", "r1") == run_hash(off, "axisymmetric", "r1")
    assert run_hash(small, "full3d", "n8") != run_hash(off, "full3d", "n8")
