"""Counts by harmonic in runs: path.csv, modes.json, the modes study, revolved shapes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from mpi4py import MPI

from meshes.bodies import tube_meridian
from meshes.sweep import revolve_hexahedra
from solvers.stability.harmonics import Shape
from studies.__main__ import main
from studies.models import modes as modes_run
from studies.models.axisymmetric import run_axisymmetric
from studies.models.modes import WARNING, counts_of, read_crossings, read_shape
from studies.modes.full3d import on_full_circle
from studies.modes.pictures import DRAWN_SHARE, crosses_itself, drawn_size, revolved_mode
from studies.progress import Progress
from studies.results.rows import is_reached, read_rows
from studies.results.run_files import read_path, read_summary
from studies.scene.bellows import shape_of
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_meridian
from studies.sweep.farm import run_sweep

ROOT = Path(__file__).resolve().parents[3]

# A thin clamped tube of neo-Hookean material: it bends sideways, in one harmonic and soon.
TUBE = """
name = "{name}"
[geometry]
kind = "tube"
inner_radius_mm = 5.0
outer_radius_mm = 6.0
length_mm = {length}
ends = "bonded"
[material]
law = "yeoh"
c_kpa = [36.0, 2.5, 0.23]
[load]
pressure_kpa = [2.0, 12.0]
"""


@pytest.fixture(scope="module")
def blocked(tmp_path_factory):
    """The 1 mm actuator with half its convolutions, its tip held, to 1 kPa and 1.5 kPa: scene and folder."""
    folder = tmp_path_factory.mktemp("modes")
    text = (ROOT / "scenes" / "modes" / "blocked-short.toml").read_text(encoding="utf-8")
    path = folder / "blocked.toml"
    path.write_text(text.replace("[0.5, 1.0, 2.0]", "[1.0, 1.5]"), encoding="utf-8")
    return load_bellows(path), folder


def run(scene, folder: Path, modes: bool):
    return run_axisymmetric(scene, 1, folder, MPI.COMM_SELF, Progress(MPI.COMM_SELF), modes)


def test_counts_go_into_the_path_and_the_crossing_beside_it(blocked) -> None:
    scene, folder = blocked
    place = folder / "run"
    found = run(scene, place, True)
    rows = read_path(place)
    assert tuple(r.unstable_by_m for r in rows) == tuple(r.unstable_by_m for r in found.path)
    asked = {r.pressure_kpa: r.unstable_by_m for r in rows if r.status == "requested"}
    assert list(asked.values()) == ["0;0;0;0;0;0;0", "0;1;0;0;0;0;0"]
    assert all(r.unstable_by_m == "" for r in rows if r.status != "requested")
    # the axisymmetric model itself sees nothing
    assert all(r.unstable_modes == 0 for r in rows)
    (crossing,) = read_crossings(place)
    assert (crossing.waves, crossing.before, crossing.after) == (1, 0, 1)
    # 1.05378 kPa by full 3D on 8 cells round and the same meridian (docs/decisions.md, "Full 3D on a part of the body")
    assert crossing.pressure_kpa == pytest.approx(1.05378, rel=2e-3)
    assert crossing.within_kpa <= 0.5e-3 * crossing.pressure_kpa
    assert crossing.tip_mm == 0.0 and 0.2 < crossing.tip_force_n < 0.3
    summary = read_summary(place)
    assert summary == found.summary
    assert [note for note in summary.plan if note.startswith(WARNING)]
    state, shape = read_shape(place, 1)
    assert 1e3 * state.load_mpa == pytest.approx(crossing.pressure_kpa, rel=1e-3)
    assert np.abs(shape.amplitude_mm).max() == pytest.approx(1.0)
    # clamped below, the plate held: the middle goes sideways
    assert np.abs(shape.bodies_mm[-1]).max() == 0.0
    assert np.abs(shape.bodies_mm[2, 0]) == pytest.approx(np.abs(shape.bodies_mm[:, 0]).max())


def test_counts_are_made_for_a_run_that_has_none_and_only_once(blocked, monkeypatch) -> None:
    scene, folder = blocked
    place = folder / "later"
    without = run(scene, place, False)
    assert all(row.unstable_by_m == "" for row in without.path) and not (place / modes_run.MODES_FILE).exists()
    counted = run(scene, place, True)
    assert counts_of(counted.path[-1]) == (0, 1, 0, 0, 0, 0, 0)
    assert counted.summary.content_hash == without.summary.content_hash
    monkeypatch.setattr(modes_run, "count_run", lambda *_: pytest.fail("counted again"))
    assert run(scene, place, True).path == counted.path
    # a run kept without its counts still counts as finished
    assert run(scene, place, False).path == counted.path


def test_states_that_are_lost_are_told_and_the_run_stays(blocked) -> None:
    scene, folder = blocked
    place = folder / "lost"
    found = run(scene, place, False)
    for state in (place / "states").iterdir():
        state.unlink()
    again = modes_run.with_modes(scene, 1, place, found)
    assert again.path == found.path
    assert "missing or damaged" in again.summary.plan[-1]
    assert read_summary(place) == again.summary
    assert modes_run.with_modes(scene, 1, place, again).summary.plan == again.summary.plan


def test_nothing_is_counted_in_sweeps_or_where_it_is_not_asked(blocked, tmp_path) -> None:
    scene, folder = blocked
    text = (folder / "blocked.toml").read_text(encoding="utf-8")
    (tmp_path / "quiet.toml").write_text(f"{text}modes = false\n", encoding="utf-8")
    assert not load_bellows(tmp_path / "quiet.toml").ask.modes
    sweep = tmp_path / "sweep.toml"
    sweep.write_text(
        'base = "scenes/smoke-t2-ri5.toml"\n[vary]\ngeometry.convolutions = [1]\n'
        "[ask]\npressure_kpa = [2.5]\ntolerance_percent = 5.0\n",
        encoding="utf-8",
    )
    assert run_sweep(sweep, tmp_path / "out", MPI.COMM_SELF, Progress(MPI.COMM_SELF)).reached
    assert list((tmp_path / "out").rglob("path.csv")) and not list((tmp_path / "out").rglob(modes_run.MODES_FILE))


def test_solve_says_that_a_held_tip_bends_sideways(blocked) -> None:
    _, folder = blocked
    out = folder / "solved"
    result = CliRunner().invoke(main, ["solve", str(folder / "blocked.toml"), "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert "unstable against m = 1 (bends sideways) from 1.06" in result.output
    # the answer's meridian is the one that is counted
    rows = {row.pressure_kpa: row.unstable_by_m for row in read_path(out) if row.status == "requested"}
    assert rows == {1.0: "0;0;0;0;0;0;0", 1.5: "0;1;0;0;0;0;0"}
    assert not (out / "axisymmetric-r1" / modes_run.MODES_FILE).exists()


@pytest.mark.slow
def test_modes_study_writes_rows_and_draws_the_mode(tmp_path) -> None:
    scene = tmp_path / "tube.toml"
    scene.write_text(TUBE.format(name="tube", length=100.0), encoding="utf-8")
    result = CliRunner().invoke(main, ["study", "modes", str(scene), "--out", str(tmp_path / "out")])
    assert result.exit_code == 0, result.output
    rows = read_rows(tmp_path / "out" / "rows.csv")
    counts = {(r.quantity, r.pressure_kpa, r.level): r.value for r in rows if r.quantity.startswith("unstable")}
    assert counts["unstable_m1", 2.0, "r1"] == 0.0 and counts["unstable_m1", 12.0, "r2"] == 1.0
    crossings = [r for r in rows if r.quantity == "crossing_m1_kpa"]
    assert [r.level for r in crossings] == ["r1", "r2"] and all(is_reached(r) for r in crossings)
    assert all(2.0 < r.value < 12.0 and 0.0 < r.uncertainty < 0.05 * r.value for r in crossings)
    report = (tmp_path / "out" / "report.md").read_text(encoding="utf-8")
    assert "pictures/tube-m1.png" in report and (tmp_path / "out" / "pictures" / "tube-m1.png").stat().st_size > 10_000
    kept = json.loads((tmp_path / "out" / "tube" / "axisymmetric-r1" / "modes.json").read_text(encoding="utf-8"))
    assert kept["crossings"][0]["tip_mm"] is None  # a tube between two clamps has no tip


def test_modes_study_refuses_what_is_no_body_of_revolution(tmp_path) -> None:
    scene = ROOT / "scenes" / "exact" / "cube.toml"
    result = CliRunner().invoke(main, ["study", "modes", str(scene), "--out", str(tmp_path / "out")])
    assert result.exit_code == 2
    assert "block" in result.output and not (tmp_path / "out").exists()


def test_revolved_drift_is_a_translation_and_revolved_twist_a_turn() -> None:
    meridian = tube_meridian(2.0, 3.0, 1.0, 1, 1, "quadrilaterals")
    body = revolve_hexahedra(meridian, 8)
    n = len(meridian.points)
    drift = Shape(1, np.tile([1.0, 0.0, -1.0], (n, 1)), np.zeros((0, 2)))
    assert revolved_mode(drift, body) == pytest.approx(np.tile([1.0, 0.0, 0.0], (len(body.points), 1)), abs=1e-12)
    r = meridian.points[:, 0]
    twist = revolved_mode(Shape(0, np.column_stack([0 * r, 0 * r, r]), np.zeros((0, 2))), body)
    x, y, _ = body.points.T
    assert twist == pytest.approx(np.column_stack([-y, x, 0 * x]), abs=1e-12)


def test_a_mode_is_not_drawn_so_large_that_folds_pass_through_each_other() -> None:
    scene = load_bellows(ROOT / "scenes" / "smoke-t2-ri5.toml")
    meridian, g = scene_meridian(scene, 1), scene.geometry
    still, none = np.zeros_like(meridian.points), np.zeros(len(meridian.points))
    radius, z = meridian.points.T
    root = float(np.mean(shape_of(scene).crest_positions_mm[:2]))  # of the first convolution
    # side walls towards each other; neither the root's arc nor what is beyond the crests
    high = np.clip(radius - g.root_radius_mm - g.wall_mm - g.fillet_mm, 0.0, 1.0)
    closing = high * np.sign(root - z) * (np.abs(root - z) < g.half_pitch_mm)
    full = DRAWN_SHARE * radius.max()
    # they meet when each has gone half the width between them, which is a fillet; drawn is 0.8 of that, to a step
    half_width = g.fillet_mm
    found = drawn_size(Shape(2, np.column_stack([none, closing, none]), np.zeros((0, 2))), meridian, still)
    assert 0.7 * half_width < found < 0.9 * half_width
    drift = Shape(1, np.column_stack([none, none + 1.0, none]), np.zeros((0, 2)))
    assert drawn_size(drift, meridian, still) == pytest.approx(full)


def test_a_line_that_crosses_itself_is_known() -> None:
    zigzag = np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [3.0, 1.0]])
    assert not crosses_itself(zigzag)
    assert crosses_itself(np.vstack([zigzag, [[0.0, 0.4]]]))


def test_modes_of_harmonics_come_in_pairs_round_the_circle() -> None:
    assert on_full_circle((1, 2, 0, 3, 0, 0, 0)) == 1 + 2 * 5
    assert on_full_circle((0,) * 7) == 0


@pytest.mark.slow
def test_modes_are_the_same_on_two_ranks(python, tmp_path) -> None:
    scenes = []
    for name, length in (("short", 30.0), ("long", 100.0)):
        scenes.append(tmp_path / f"{name}.toml")
        scenes[-1].write_text(TUBE.format(name=name, length=length), encoding="utf-8")
    rows = []
    for ranks in (1, 2):
        out = tmp_path / f"on-{ranks}"
        python.run(ranks, "-m", "studies", "study", "modes", *scenes, "--out", out)
        rows.append((out / "rows.csv").read_bytes())
    assert rows[0] == rows[1]
    assert b"crossing_m1_kpa" in rows[0] and b"none up to 12 kPa" in rows[0]
