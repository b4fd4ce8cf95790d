"""Other codes on the same problem: the meshes they get, FEBio's deck, ratios of times, and what is skipped."""

import json
import math
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from analytical.laws.stiff import PLA
from meshes.cells import cell_shape
from studies import mpi_children
from studies.engine import run
from studies.peers import environment
from studies.peers import measure as measuring
from studies.peers import study as peer_study
from studies.peers.cases import OURS, SCENE, attempts, peer_scene, script_of
from studies.peers.exchange import Level, peer_mesh, write_peer_mesh
from studies.peers.febio_deck import write_febio_deck
from studies.peers.fronts import Point, best, floored, front, lasting, ratio_at_equal_error, ratio_to_fastest, time_at
from studies.peers.measure import (
    Measurement,
    keep_measurement,
    lines_to_write,
    measure_ours,
    measure_peer,
    peer_command,
)
from studies.peers.rows import comparison_rows
from studies.planning.levels import LIMIT
from studies.results.rows import read_rows, row, write_rows


@pytest.fixture(scope="module")
def scene():
    return peer_scene()


def measure(points, cells):
    shape = cell_shape(points.shape[1], cells.shape[1])
    at, weights = shape.rule
    values, grads = shape.shape(at)
    jacobian = np.linalg.det(np.einsum("cki,qkd->cqid", points[cells], grads))
    assert jacobian.min() > 0.0
    if points.shape[1] == 2:  # swept round
        jacobian = jacobian * 2.0 * np.pi * np.einsum("ck,qk->cq", points[cells][:, :, 0], values)
    return (jacobian * weights).sum()


def test_all_codes_get_the_same_body(scene, tmp_path):
    volumes = {}
    for level in (Level("tri6", 2), Level("quad9", 2), Level("tet10", 1, 12), Level("hex27", 1, 12)):
        write_peer_mesh(scene, level, tmp_path / f"{level.name}.npz")
        data = np.load(tmp_path / f"{level.name}.npz")
        soft, stiff = (data["cells"][data["regions"] == k] for k in (1, 2))
        volumes[level.cells] = [measure(data["points"], cells) for cells in (soft, stiff)]
        assert data["tip_weights"].sum() == pytest.approx(1.0)
        assert np.allclose(data["points"][data["tip_nodes"], -1], data["points"][:, -1].max())
        assert np.allclose(data["points"][np.unique(data["clamped_facets"]), -1], 0.0)
        assert data["ring_mpa_nu"].tolist() == [PLA.young_mpa, PLA.poisson]
        assert data["pressure_mpa"] == pytest.approx(0.01)
        corners = np.unique(data["cells"][:, : cell_shape(data["points"].shape[1], data["cells"].shape[1]).corners])
        assert corners.tolist() == list(range(len(corners)))  # codes that number corners first keep these numbers
    soft = [v[0] for v in volumes.values()]
    assert soft == pytest.approx([soft[0]] * 4, rel=2e-3)
    # the blocks' outer edges are not rounded: 2 (1 - pi/4) r^2 of the section
    assert volumes["quad9"][1] == pytest.approx(volumes["tri6"][1] * 8.0 / (8.0 - 2.0 * 0.2146 * 0.25), rel=2e-3)


def test_a_quarter_ends_at_the_planes_that_hold_it(scene, tmp_path):
    kept = {}
    for level in (Level("hex27", 1, 8), Level("hex27", 1, 8, quarter=True)):
        write_peer_mesh(scene, level, tmp_path / f"{level.name}.npz")
        kept[level.quarter] = np.load(tmp_path / f"{level.name}.npz")
    whole, quarter = kept[False], kept[True]
    volume = {part: measure(data["points"], data["cells"]) for part, data in kept.items()}
    assert volume[True] == pytest.approx(volume[False] / 4.0, rel=1e-12)
    assert len(whole["plane_x_facets"]) == len(whole["plane_y_facets"]) == 0
    for axis, name in enumerate(("plane_x_facets", "plane_y_facets")):
        on_plane = np.abs(quarter["points"][:, axis]) < 1e-9
        assert set(np.flatnonzero(on_plane)) == set(quarter[name].ravel())
    assert quarter["tip_weights"].sum() == pytest.approx(1.0)


@pytest.mark.parametrize("cells", ["tet10", "hex27"])
def test_pressed_surface_encloses_the_cavity(scene, tmp_path, cells):
    write_peer_mesh(scene, Level(cells, 1, 12), tmp_path / "mesh.npz")
    data = np.load(tmp_path / "mesh.npz")
    facets, points = data["cavity_facets"], data["points"]
    shape = cell_shape(2, facets.shape[1])
    at, weights = shape.rule
    values, grads = shape.shape(at)
    tangents = np.einsum("cki,qkd->cqid", points[facets], grads)
    normal = np.cross(tangents[..., 0], tangents[..., 1])
    place = np.einsum("cki,qk->cqi", points[facets], values)
    volume = -((normal * place).sum(axis=-1) * weights).sum() / 3.0  # out of the silicone is into the cavity
    write_peer_mesh(scene, Level("tri6", 2), tmp_path / "meridian.npz")
    data = np.load(tmp_path / "meridian.npz")
    r, z = np.moveaxis(data["points"][data["cavity_facets"]], -1, 0)
    # Simpson over each parabola: out of the silicone is to the right of the edge, so the cavity is to its right
    start, end, middle = (np.pi * r[:, k] ** 2 for k in range(3))
    slopes = np.stack([4 * z[:, 2] - 3 * z[:, 0] - z[:, 1], 3 * z[:, 1] + z[:, 0] - 4 * z[:, 2], z[:, 1] - z[:, 0]])
    meridian = -(start * slopes[0] + end * slopes[1] + 4 * middle * slopes[2]).sum() / 6.0
    assert volume == pytest.approx(meridian, rel=3e-3)


def test_cells_of_a_ring_block_share_the_seat(scene):
    mesh = peer_mesh(scene, Level("quad9", 1))
    rings = mesh.cells[mesh.regions == 3]
    assert len(rings) % (scene.geometry.convolutions + 1) == 0
    shared = np.intersect1d(rings, mesh.cells[mesh.regions != 3])
    seats = mesh.points[shared]
    assert np.allclose(seats[:, 0], scene.geometry.crest_radius_mm + scene.geometry.wall_mm)
    assert np.ptp(seats[:, 1]) > 2 * scene.geometry.half_pitch_mm


def test_febio_deck_is_well_formed_and_whole(scene, tmp_path):
    write_peer_mesh(scene, Level("tet10", 1, 8), tmp_path / "mesh.npz")
    data = np.load(tmp_path / "mesh.npz")
    write_febio_deck(tmp_path / "mesh.npz", tmp_path / "deck.feb")
    root = ET.parse(tmp_path / "deck.feb").getroot()
    assert (root.tag, root.get("version")) == ("febio_spec", "4.0")
    assert len(root.findall("Mesh/Nodes/node")) == len(data["points"])
    elements = {e.get("name"): e.findall("elem") for e in root.findall("Mesh/Elements")}
    assert {k: len(v) for k, v in elements.items()} == {
        "silicone": (data["regions"] == 1).sum(),
        "ring": (data["regions"] == 2).sum(),
    }
    assert len(root.findall("Mesh/Surface/tri6")) == len(data["cavity_facets"])
    # each middle node lies between the corners FEBio takes it to belong to
    points = data["points"]
    for elem in elements["silicone"][::500]:
        n = [int(t) - 1 for t in (elem.text or "").split(",")]
        for middle, (a, b) in zip(n[4:], ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)), strict=True):
            chord = np.linalg.norm(points[n[a]] - points[n[b]])
            assert np.linalg.norm(points[middle] - 0.5 * (points[n[a]] + points[n[b]])) < 0.25 * chord
    assert (tmp_path / "deck.weights.txt").exists()
    write_peer_mesh(scene, Level("hex27", 1, 8), tmp_path / "hex.npz")
    with pytest.raises(ValueError, match="27 nodes"):
        write_febio_deck(tmp_path / "hex.npz", tmp_path / "deck.feb")


def test_best_is_the_fastest_of_the_smallest_error():
    points = floored([Point(100.0, 0.002), Point(50.0, -0.009), Point(10.0, 0.5)], 0.01)
    assert best(points) == Point(50.0, 0.01)
    assert best([]) is None


def test_time_at_an_error_is_read_off_the_front():
    points = [Point(1.0, 1.0), Point(10.0, 0.1), Point(30.0, 0.4), Point(100.0, 0.01)]
    assert front(points) == [Point(1.0, 1.0), Point(10.0, 0.1), Point(100.0, 0.01)]
    assert time_at(points, 0.1) == pytest.approx(10.0)
    assert time_at(points, math.sqrt(0.1)) == pytest.approx(math.sqrt(10.0))
    assert time_at(points, 5.0) == 1.0
    assert math.isnan(time_at(points, 0.001))


def test_an_error_that_a_finer_mesh_exceeds_does_not_last():
    assert lasting([0.002, -0.05, 0.01]) == [0.05, 0.05, 0.01]
    assert lasting([0.3, 0.2]) == [0.3, 0.2]
    assert lasting([]) == []


def made_up(name, tip_mm, unknowns, wall_s, reason=""):
    (attempt,) = (a for a in attempts() if a.name == name)
    return attempt, Measurement(tip_mm, unknowns, wall_s, 100.0, 33, reason, 5.0)


def test_accidents_of_coarse_meshes_are_told_apart_in_the_ratios():
    measured = [
        made_up("felupe hex27-n8r1 formulation=mean first=0.1", 100.01, 10, 20.0),
        made_up("felupe hex27-n12r1 formulation=mean first=0.1", 100.4, 20, 50.0),
        made_up("felupe hex27-n8r1 formulation=mixed first=0.2", 99.0, 10, 15.0),
        made_up("ours hex, rigid rings, tolerance 1 %, 1 rank", 99.6, 9, 4.0),
        made_up("ours hex, rigid rings, tolerance 0.1 %, 1 rank", 99.6, 12, 6.0),
    ]
    rows = comparison_rows("s", 10.0, 100.0, "reference", measured)
    found = {r.quantity: r for r in rows}
    assert found["time_ratio_full3d_to_fastest_peer"].value == pytest.approx(4.0 / 20.0)
    # what no finer mesh confirms does not count: felupe's single mesh, and the finest of each
    assert found["time_ratio_full3d_to_fastest_peer_by_lasting_error"].value == pytest.approx(4.0 / 20.0)
    assert found["time_ratio_full3d_at_equal_error"].level == "0.4 %"
    assert found["time_ratio_full3d_at_equal_error_by_lasting_error"].value == pytest.approx(4.0 / 20.0)
    # a quarter counts in ratios of its own
    measured.append(made_up("ngsolve hex27-n8r1-quarter first=0.25 predict=False", 100.01, 5, 8.0))
    values = {r.quantity: r.value for r in comparison_rows("s", 10.0, 100.0, "reference", measured)}
    assert values["time_ratio_full3d_to_fastest_peer"] == pytest.approx(4.0 / 20.0)
    assert values["time_ratio_full3d_to_fastest_peer_with_quarters"] == pytest.approx(4.0 / 8.0)


def test_ratios():
    ours = [Point(8.0, 0.2), Point(40.0, 0.02), Point(2.0, 3.0)]
    peers = {"a": [Point(20.0, 5.0), Point(200.0, 0.2)], "b": [Point(100.0, 1.0)]}
    assert ratio_to_fastest(ours, peers, 1.0) == pytest.approx(8.0 / 100.0)
    assert ratio_at_equal_error(ours, peers) == pytest.approx((0.2, 8.0 / 200.0))
    assert math.isnan(ratio_to_fastest([Point(1.0, 2.0)], peers, 1.0))
    assert math.isnan(ratio_to_fastest(ours, {}, 1.0))
    assert all(map(math.isnan, ratio_at_equal_error([], peers)))


def test_rows_hold_errors_times_and_ratios():
    measured = [
        made_up("ours hex, rigid rings, tolerance 1 %, 1 rank", 99.5, 1000, 8.0),
        made_up("calculix tet10-n8r1 first=0.25", 98.0, 900, 160.0),
        made_up("felupe hex27-n12r2 formulation=mean first=0.1", math.nan, 0, 1200.0, "stopped after 1200 s"),
    ]
    rows = comparison_rows("s", 10.0, 100.0, "reference", measured)
    found = {(r.model, r.quantity): r for r in rows}
    assert found["peer_calculix", "tip_mm"].error_percent == pytest.approx(-2.0)
    assert found["peer_felupe", "tip_mm"].status == "stopped after 1200 s"
    assert found["full3d", "lines_to_write"].value == 33
    assert found["full3d", "time_ratio_full3d_to_fastest_peer"].value == pytest.approx(0.05)
    assert found["full3d", "time_ratio_full3d_at_equal_error"].value == pytest.approx(0.05)
    assert found["axisymmetric", "time_ratio_axisymmetric_to_fastest_peer"].status.startswith("not measured")


def test_missing_peers_are_named(tmp_path, monkeypatch):
    assert "python -m studies.peers.environment" in environment.missing("ngsolve", tmp_path / "none")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert "calculix-ccx" in environment.missing("calculix")
    assert environment.missing("ours") == ""


def test_lines_are_those_a_user_writes(tmp_path):
    script = tmp_path / "a.py"
    script.write_text('"""Title.\n\nText.\n"""\n\n# why\nx = 1\n\n\ndef f():\n    """Say."""\n    return x\n')
    assert lines_to_write(script) == 3
    scene = tmp_path / "a.toml"
    scene.write_text("# title\n[a]\n\nb = 1  # unit\n")
    assert lines_to_write(scene) == 2


def test_options_reach_the_scripts(tmp_path):
    command, variables = peer_command("calculix", tmp_path / "m.npz", {"first": 0.1})
    assert json.loads(command[-1]) == {"first": 0.1} and variables["OMP_NUM_THREADS"] == "2"
    assert all(attempt.code == OURS or script_of(attempt.code).exists() for attempt in attempts())


def test_what_a_peer_says_is_read_and_why_another_says_nothing(tmp_path, monkeypatch):
    (attempt,) = (a for a in attempts() if a.name == "calculix tri6-r1 first=0.25")
    said = {"tip_mm": 9.0, "dofs": 70, "peak_mb": 50.0, "reason": "", "pressure_mpa": 0.01}

    def answer(code, out, error=""):
        monkeypatch.setattr(mpi_children, "run", lambda *_: mpi_children.Ended(code, out, error, 7.0, 5.0, 0.0))
        return measure_peer(attempt, tmp_path, 10.0)

    found = answer(0, f"noise\n{json.dumps(said)}\ndone\n")
    assert (found.tip_mm, found.unknowns, found.wall_s, found.cpu_s, found.reason) == (9.0, 70, 7.0, 5.0, "")
    stopped = answer(0, json.dumps(said | {"reason": "diverged", "pressure_mpa": 0.004}))
    assert math.isnan(stopped.tip_mm) and stopped.reason == "stopped at 4 kPa: diverged"
    assert answer(3, "", "first\nlast\n\n").reason == "exit 3: last"
    late = answer(-1, json.dumps(said))
    assert late.timed_out and late.reason == "stopped after 7 s" and math.isnan(late.tip_mm)


def test_ours_is_solved_twice_and_read_from_its_folder(monkeypatch):
    (attempt,) = (a for a in attempts() if a.label == "tet, meshed rings, tolerance 1 %, 2 ranks")
    seen = []

    def solve(command, variables, limit_s):
        scene, out = (Path(command[command.index(name) + 1]) for name in ("solve", "--out"))
        seen.append((out.name, 'element = "tet"' in scene.read_text(), variables["OMP_NUM_THREADS"]))
        out.mkdir()
        (out / "summary.json").write_text(json.dumps({"dofs": 70, "peak_mb": 50.0, "model": "axisymmetric"}))
        tips = (("r1", 8.9), (LIMIT, 9.0))  # the answer comes last
        rows = [row("peer", "tip_mm", "mm", 10.0, "axisymmetric", tip, level) for level, tip in tips]
        write_rows(out / "rows.csv", rows)
        return mpi_children.Ended(0, "", "", 7.0, 5.0, 0.0)

    monkeypatch.setattr(mpi_children, "run", solve)
    found = measure_ours(attempt, 10.0)
    assert seen == [("warm", True, "1"), ("timed", True, "1")]
    assert (found.tip_mm, found.unknowns, found.peak_mb, found.reason) == (9.0, 70, 50.0, "")
    assert found.lines == lines_to_write(SCENE)


def test_study_keeps_skips_and_leaves_out_what_is_finer_than_what_was_stopped(tmp_path, monkeypatch, capsys):
    made = []

    def measure(attempt, out, limit_s):
        made.append(attempt.name)
        late = attempt.code == "felupe" and "formulation=mean" in attempt.label
        wall, tip = (limit_s, math.nan) if late else (10.0, 9.0)
        reason = f"stopped after {limit_s:.0f} s" if late else ""
        found = Measurement(tip, 70, wall, 50.0, 33, reason, 5.0)
        keep_measurement(attempt, out, found)
        return found

    monkeypatch.setattr(environment, "missing", lambda code: "no ccx" if code == "calculix" else "")
    monkeypatch.setattr(peer_study, "measure", measure)
    monkeypatch.setattr(peer_study, "reference_tip", lambda *_: (9.1, 0.01))
    options = {"code": ("calculix", "felupe", "ours"), "dimension": ("2",), "levels": 3, "budget": math.inf}
    assert run(peer_study.STUDY, tmp_path, MPI.COMM_SELF, {**options, "limit": 600.0}) == 0
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "- calculix: skipped: no ccx" in text
    assert "- felupe quad9-r2 formulation=mean first=0.1: not run, a coarser mesh was stopped at the limit" in text
    assert len(made) == 5 + 1 + 3 * 2  # ours, the mean formulation's coarsest mesh, the mixed one's all
    rows = read_rows(tmp_path / "rows.csv")
    assert {r.model for r in rows} == {"axisymmetric", "peer_felupe", "full3d"}
    # what is there is kept; what was stopped is made again if it is allowed longer
    made.clear()
    assert run(peer_study.STUDY, tmp_path, MPI.COMM_SELF, {**options, "limit": 600.0}) == 0
    assert made == []
    assert run(peer_study.STUDY, tmp_path, MPI.COMM_SELF, {**options, "limit": 900.0}) == 0
    assert made == ["felupe quad9-r1 formulation=mean first=0.1"]
    over = {**options, "limit": 1200.0, "budget": -1.0}
    assert run(peer_study.STUDY, tmp_path, MPI.COMM_SELF, over) == 0
    assert len(made) == 1 and "the time is over" in capsys.readouterr().out


@pytest.mark.parametrize(("first", "made", "kept"), [(1.3, 3, 1.2), (7.0, 1, 7.0)])
def test_a_short_run_is_measured_three_times(tmp_path, monkeypatch, first: float, made: int, kept: float):
    walls = iter([first, 1.1, 1.2])
    monkeypatch.setattr(measuring, "measure_ours", lambda *_: Measurement(9.1, 10, next(walls), 1.0, 3, "", 1.0))
    (attempt,) = (a for a in attempts() if a.name == "ours hex, rigid rings, tolerance 1 %")
    assert measuring.measure(attempt, tmp_path, 10.0).wall_s == kept
    again = measuring.kept_measurement(attempt, tmp_path)
    assert again is not None and again.wall_s == kept
    assert len(list(walls)) == 3 - made
