"""Measures of states that are known exactly, of their rows, and of one small run."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from analytical.bellows.chains import closed_form
from analytical.bellows.loads import held_tip
from meshes.bellows import wall_segments
from meshes.shape import BellowsShape
from solvers.state import State
from studies.models.axisymmetric import run_axisymmetric
from studies.progress import Progress
from studies.results.measured_rows import measured_rows, model_values, unfolding_pressure
from studies.results.measures import (
    NEAR_EDGE_MM,
    Places,
    cavity_volume,
    curve_length,
    find_places,
    largest_stretches,
    mean_along,
    measure,
    unfolding_share,
)
from studies.results.rows import Row
from studies.results.run_files import PathRow, save_state
from studies.scene.bellows import BellowsScene, Load, dimensions_of, shape_of
from studies.scene.load import load_bellows
from studies.scene.materials import law_of

RINGS = ("rigid", "meshed", "none")
# u_r = (a - 1) r, u_z = (b - 1) z + g r
A, B, G = 1.3, 1.1, 0.4


@pytest.fixture(scope="module")
def scene(root: Path) -> BellowsScene:
    """Quadrilaterals and rigid rings, R_i = 5, R_p = 10.5, t = 2 mm, two roots, 5 and 10 kPa."""
    return load_bellows(root / "scenes" / "smoke-t2-ri5.toml")


def with_rings(scene: BellowsScene, model: str) -> BellowsScene:
    """Meshed rings come with triangles."""
    return scene.model_copy(update={"rings": scene.rings.model_copy(update={"model": model})})


def state_of(displacement_mm: np.ndarray, rings_mm: np.ndarray | None = None, load_mpa: float = 0.0) -> State:
    rings = np.zeros(3) if rings_mm is None else rings_mm
    return State(displacement_mm, np.zeros(1), rings[:, None], load_mpa)


def affine(points: np.ndarray, a: float = A, b: float = B, g: float = G) -> np.ndarray:
    r, z = points.T
    return np.column_stack([(a - 1.0) * r, (b - 1.0) * z + g * r])


def side_stretches(shape: BellowsShape) -> list[float]:
    """Stretch of the mid-surface under the affine state from a seat's edge to a throat, up and down, by trapezia."""
    fraction = np.linspace(0.0, 1.0, 20001)
    lengths = np.zeros((2, 2))
    for piece in wall_segments(shape):
        if piece.kind in ("crest", "side", "root"):
            line = np.mean(piece.band(fraction), axis=0)
            inwards = int(piece.tangent_start_rad + piece.tangent_end_rad > 0.0)
            for k, x in enumerate((line + affine(line), line)):
                lengths[inwards, k] += np.linalg.norm(np.diff(x, axis=0), axis=1).sum()
    return list(lengths[:, 0] / lengths[:, 1])


@pytest.mark.parametrize("rings", RINGS)
def test_an_affine_state_is_measured_exactly(scene: BellowsScene, rings: str) -> None:
    scene = with_rings(scene, rings)
    shape, places = shape_of(scene), find_places(scene, 1)
    centres, slip = shape.crest_positions_mm, 0.01
    # the rings go with their seats' middles, but for a slip
    motions = (B - 1.0) * centres + G * shape.seat_radius_mm + slip
    found = dict(measure(scene, places, state_of(affine(places.points), motions)).values)
    largest = max(A, np.linalg.svd([[A, 0.0], [G, B]], compute_uv=False)[0])
    expected = {
        "root_stretch_outer": A,
        "root_stretch_inner": A,
        "root_bulge_mm": (A - 1.0) * (shape.root_radius_mm + shape.wall_mm),
        "wall_hoop_stretch_middle": A,
        "peak_stretch": largest,
    }
    if rings != "none":
        expected |= {"ring_hoop_stretch": A, "peak_stretch_away": largest}
    if rings == "rigid":
        edge = 0.5 * (B - 1.0) * shape.seat_mm + slip
        expected["peak_slip_mm"] = math.hypot((A - 1.0) * shape.seat_radius_mm, edge)
    wall, share, grown = (found.pop(key) for key in ("wall_stretch", "unfolding_share", "cavity_volume_ratio"))
    assert found == pytest.approx(expected, rel=1e-12)  # quadratic elements hold an affine state: round-off
    # parabolas through arcs of up to 45 degrees: measured 1e-5
    assert wall == pytest.approx(np.mean(side_stretches(shape)), rel=1e-4)
    long, deep = 5.0 - 0.5 * shape.seat_mm, 5.5
    ends = np.array([B * long + G * deep, B * long - G * deep])  # from a throat out to a crest, and back
    exact = (ends / side_stretches(shape) - long).sum() / (ends - long).sum()
    assert share == pytest.approx(exact, rel=1e-3)  # as above, and a difference of lengths ten times as large
    # a tilted inlet plane is a cone, which is not of the cavity
    rest = cavity_volume(places.points[places.cavity])
    assert grown == pytest.approx(A**2 * (B - G * math.pi * 10.5**3 / (3.0 * rest)), rel=1e-12)
    # also on the axis, and nowhere by way of cells of meshed rings
    stretch = largest_stretches(places, affine(places.points))
    assert stretch[np.unique(places.cells)] == pytest.approx(largest, rel=1e-12)


@pytest.mark.parametrize("rings", RINGS)
def test_a_uniform_swelling_stretches_every_wall_alike(scene: BellowsScene, rings: str) -> None:
    scene = with_rings(scene, rings)
    places = find_places(scene, 1)
    swollen = state_of(affine(places.points, 1.2, 1.2, 0.0))
    assert measure(scene, places, swollen).values["wall_stretch"] == pytest.approx(1.2, rel=1e-12)  # round-off


@pytest.mark.parametrize("rings", RINGS)
@pytest.mark.parametrize("refinement", [1, 2])
def test_places_are_where_they_are_said_to_be(scene: BellowsScene, rings: str, refinement: int) -> None:
    scene = with_rings(scene, rings)
    shape, places = shape_of(scene), find_places(scene, refinement)
    x, inner, t = places.points, shape.root_radius_mm, shape.wall_mm
    crest, throat = shape.crest_positions_mm, shape.crest_positions_mm[:-1] + shape.half_pitch_mm

    def at(radius: float, z: np.ndarray) -> Any:
        return pytest.approx(np.column_stack([np.full(len(z), radius), z]), abs=1e-9)  # round-off of positions in mm

    assert x[places.throats_inside] == at(inner, throat)
    assert x[places.throats_outside] == at(inner + t, throat)
    half = 0.5 * shape.seat_mm  # 0 without rings: the sides then start at the crests' middles
    middle = shape.crest_radius_mm + 0.5 * t
    starts, ends = x[places.sides[:, 0]], x[places.sides[:, -1]]
    n = shape.convolutions
    assert starts[:n] == at(middle, crest[:-1] + half) and starts[n:] == at(inner + 0.5 * t, throat)
    assert ends[:n] == at(inner + 0.5 * t, throat) and ends[n:] == at(middle, crest[1:] - half)
    # the middle of a side is half-way between its ends
    assert x[places.sides[:, places.sides.shape[1] // 2]] == pytest.approx(0.5 * (starts + ends), abs=1e-9)
    if rings == "none":
        assert places.seats_outside.shape == (0, 0) and not places.near_edge.any()
        return
    assert x[places.seats_outside[:, 0]] == at(shape.seat_radius_mm, crest - half)
    assert x[places.seats_outside[:, -1]] == at(shape.seat_radius_mm, crest + half)
    assert x[places.seats_middle[:, 0]] == at(middle, crest - half)
    corners = np.vstack([[shape.seat_radius_mm, z + s * half] for z in crest for s in (-1.0, 1.0)])
    near = np.linalg.norm(x[:, None] - corners, axis=-1).min(axis=1) < NEAR_EDGE_MM
    assert np.array_equal(places.near_edge, near)


def test_a_peak_is_found_and_named(scene: BellowsScene) -> None:
    places = find_places(scene, 4)  # cells of 1/3 mm: a node moved alone is felt less than 0.5 mm away

    def peaks(node: int) -> tuple[dict[str, float], dict[str, str]]:
        u = affine(places.points, 1.01, 1.01, 0.0)
        u[node, 1] += 0.05
        found = measure(scene, places, state_of(u))
        return {k: v for k, v in found.values.items() if k in found.peak_in}, dict(found.peak_in)

    value, place = peaks(int(places.throats_outside[0]))
    assert set(place.values()) == {"root, outside"}
    assert value["peak_stretch"] == value["peak_stretch_away"] > 1.1
    value, place = peaks(int(places.seats_outside[1, -1]))
    assert place["peak_stretch"] in ("seat, outside", "crest, outside")
    assert value["peak_stretch"] > value["peak_stretch_away"] + 0.1
    value, place = peaks(int(np.argmin(places.points[:, 0] - places.points[:, 1])))  # the cap's distal middle
    assert set(place.values()) == {"cap, outside"}


def test_what_rings_alone_do_is_not_measured(scene: BellowsScene) -> None:
    scene = with_rings(scene, "meshed")
    places = find_places(scene, 1)
    u = affine(places.points)
    still = measure(scene, places, state_of(u))
    ring_alone = np.setdiff1d(np.arange(len(u)), places.cells)
    assert len(ring_alone)
    u[ring_alone] += 7.0
    assert measure(scene, places, state_of(u)) == still
    assert "peak_slip_mm" not in still.values


def test_lengths_and_means_of_parabolas() -> None:
    s = np.linspace(0.0, 1.0, 5)  # two pieces
    assert mean_along(np.stack([s**2, 1.0 + s])) == pytest.approx([1.0 / 3.0, 1.5], rel=1e-14)  # exact: Simpson
    straight = np.column_stack([3.0 * s**2, 4.0 * s**2])  # nodes off the middle: still 5 long
    parabola = np.column_stack([s, s**2])
    exact = 0.5 * math.sqrt(5.0) + 0.25 * math.asinh(2.0)
    # Gauss of eight orders over two pieces: measured 1e-7
    assert curve_length(np.stack([straight, parabola])) == pytest.approx([5.0, exact], rel=1e-6)


def test_share_of_walls_that_keep_their_length() -> None:
    s = np.linspace(0.0, 1.0, 5)

    def wall(long: float, deep: float) -> np.ndarray:
        return np.stack(
            [np.column_stack([9.0 - deep * s, long * s]), np.column_stack([9.0 - deep * (1 - s), long * s])]
        )

    # 3, 4, 5: a wall of 5 mm turned without stretch; one along the axis stretched alone; turned and stretched by 1.2
    assert unfolding_share(wall(3.0, 4.0), wall(4.0, 3.0)) == pytest.approx(1.0, rel=1e-12)
    assert unfolding_share(wall(3.0, 0.0), wall(3.6, 0.0)) == pytest.approx(0.0, abs=1e-12)
    assert unfolding_share(wall(3.0, 4.0), wall(4.8, 3.6)) == pytest.approx(1.0 / 1.8, rel=1e-12)
    assert math.isnan(unfolding_share(wall(3.0, 4.0), wall(3.0, 4.0)))


def test_volume_of_a_frustum() -> None:
    line = np.array([[2.0, 0.0], [1.0, 3.0], [0.0, 3.0]])
    assert cavity_volume(line) == pytest.approx(math.pi * 7.0, rel=1e-14)  # pi h (R^2 + R r + r^2) / 3


def test_unfolding_is_interpolated_between_states() -> None:
    pressures = [5.0, 10.0, 15.0, 20.0]
    straight = [0.2 * p for p in pressures]
    assert unfolding_pressure(pressures, straight, 2.5) == pytest.approx(12.5, rel=1e-12)  # exact for a line
    square = [0.01 * p**2 for p in pressures]
    # PCHIP's slopes at the states are harmonic means, not a parabola's: measured 0.29 kPa in the first step, 0.08 after
    for exact in (3.0, 7.0, 12.0, 18.0):
        assert unfolding_pressure(pressures, square, 0.01 * exact**2) == pytest.approx(exact, abs=0.4)
    assert math.isnan(unfolding_pressure(pressures, square, 4.1))
    assert math.isnan(unfolding_pressure([], [], 4.1))
    # out and back: the first time
    assert 5.0 < unfolding_pressure([5.0, 10.0, 15.0], [1.0, 3.0, 1.0], 2.0) < 10.0


def test_the_model_says_what_it_knows(scene: BellowsScene) -> None:
    chain = closed_form(dimensions_of(scene), law_of(scene.material), 10.0)
    free = model_values(scene, 10.0)
    assert free["root_stretch_outer"] == chain.root_stretch[0]
    assert free["root_bulge_mm"] == pytest.approx((chain.root_stretch[0] - 1.0) * 7.0, rel=1e-14)
    assert free["wall_stretch"] == chain.wall_stretch[0]
    assert free["peak_stretch"] == max(chain.root_inner_stretch[0], chain.wall_stretch[0])
    assert free["unfolding_kpa"] == chain.unfolding_pressure_kpa[0]
    blocked = model_values(scene.model_copy(update={"load": Load(pressure_kpa=[10.0], tip="blocked")}), 10.0)
    held = held_tip(dimensions_of(scene), law_of(scene.material), 10.0)
    assert blocked["wall_stretch"] == held.wall_stretch[0] != free["wall_stretch"]
    assert blocked["root_stretch_outer"] == free["root_stretch_outer"]
    pulled = model_values(scene.model_copy(update={"load": Load(pressure_kpa=[10.0], tip_force_n=1.0)}), 10.0)
    assert "wall_stretch" not in pulled and "peak_stretch" not in pulled
    assert pulled["root_stretch_outer"] == free["root_stretch_outer"]


STEP = PathRow(1.0, "volume", 1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.9, math.nan, 0.0, "", 4, 1.0, "requested", 0.01)


def keep(folder: Path, level: str, states: list[State]) -> Any:
    """A run's states on disk; of the run itself only what names them."""
    for state in states:
        save_state(folder / f"axisymmetric-{level}", f"hash-{level}", state, STEP)
    return SimpleNamespace(summary=SimpleNamespace(level=level, content_hash=f"hash-{level}"))


def swollen(places: Places, growth: float, pressure_kpa: float) -> State:
    return state_of(affine(places.points, 1.0 + growth, 1.0, 0.0), load_mpa=1e-3 * pressure_kpa)


def only(rows: list[Row], **wanted: Any) -> list[Row]:
    return [r for r in rows if all(getattr(r, name) == value for name, value in wanted.items())]


def test_rows_of_levels_beside_the_model(scene: BellowsScene, tmp_path: Path) -> None:
    # growth g(p) + 0.01 h^2, h = 1, 1/2, 1/4; the finest level stopped before 10 kPa
    limit = {5.0: 0.2, 10.0: 0.9}
    runs = []
    for refinement in (1, 2, 4):
        places = find_places(scene, refinement)
        reached = [5.0] if refinement == 4 else [5.0, 10.0]
        error = 0.01 / refinement**2
        runs.append(keep(tmp_path, f"r{refinement}", [swollen(places, limit[p] + error, p) for p in reached]))
    rows = measured_rows(scene, runs, tmp_path)

    model, r1, _, r4 = only(rows, quantity="root_stretch_outer", pressure_kpa=5.0)
    assert [r.model for r in (model, r1, r4)] == ["closed_form", "axisymmetric", "axisymmetric"]
    assert (r1.level, r4.level, r4.unit, r4.scene) == ("r1", "r4", "1", "smoke-t2-ri5")
    # to round-off of differences of 1e-3: the distance to their limit, which is that of order 2, and what an edge would
    # leave of the whole change, a third of it
    off = 0.01 / 16
    doubt = 0.01 * 15 / 16 / 3.0
    assert [r1.uncertainty, r4.uncertainty] == pytest.approx([0.01 * 15 / 16 + off + doubt, off + doubt], rel=1e-9)
    assert (model.reference, model.source, r1.source) == (r4.value, "axisymmetric r4", "axisymmetric r4")
    assert model.error_percent == pytest.approx(100.0 * (model.value / r4.value - 1.0), rel=1e-12)
    assert math.isnan(r4.reference) and r4.source == ""
    peak = only(rows, quantity="peak_stretch", pressure_kpa=5.0, level="r4")[0]
    assert peak.source.split(",")[0] in ("root", "side", "crest", "seat", "collar", "cap")

    beyond = only(rows, quantity="root_stretch_outer", pressure_kpa=10.0)
    assert [(r.model, r.level, r.source) for r in beyond] == [
        ("closed_form", "", "axisymmetric r2"),
        ("axisymmetric", "r1", "axisymmetric r2"),
        ("axisymmetric", "r2", ""),
    ]
    # the roots' outside of 7 mm has 5.5 mm to go: a growth of 0.786
    unfolding = only(rows, quantity="unfolding_kpa")
    assert all(math.isnan(r.pressure_kpa) for r in unfolding)
    model, r1, r2, r4 = unfolding
    assert model.reference == r2.value and 5.0 < r1.value < r2.value < 10.0
    assert math.isnan(r4.value) and r4.status == "not reached up to 5 kPa"
    assert {r.status for r in rows} == {"reached", r4.status}


def test_states_of_other_content_are_not_measured(scene: BellowsScene, tmp_path: Path) -> None:
    run = keep(tmp_path, "r1", [swollen(find_places(scene, 1), 0.2, 5.0)])
    run.summary.content_hash = "another"
    rows = measured_rows(scene, [run], tmp_path)
    assert {r.quantity for r in rows} == {"unfolding_kpa"}
    assert rows[-1].status == "not reached up to 0 kPa"


def test_a_small_run_is_consistent(scene: BellowsScene, tmp_path: Path) -> None:
    asked = scene.model_copy(update={"load": Load(pressure_kpa=[2.5, 5.0])})
    run = run_axisymmetric(asked, 1, tmp_path / "axisymmetric-r1", MPI.COMM_SELF, Progress(MPI.COMM_SELF))
    rows = measured_rows(asked, [run], tmp_path)
    value = {r.quantity: r.value for r in rows if r.model == "axisymmetric"}
    # one and the same displacement, to round-off
    assert value["root_bulge_mm"] == pytest.approx((value["root_stretch_outer"] - 1.0) * 7.0, rel=1e-9)
    # an incompressible wall thins: the roots' inside stretches more, and neither is more than the peak
    assert 1.0 < value["root_stretch_outer"] < value["root_stretch_inner"] <= value["peak_stretch"]
    assert value["peak_stretch_away"] <= value["peak_stretch"]
    assert run.path[-1].bond_slip_rms_mm < value["peak_slip_mm"] < 0.1
    assert 1.0 < value["ring_hoop_stretch"] < value["wall_hoop_stretch_middle"] < value["root_stretch_outer"]
    # the run's own volumes are of curved cells, these of lines straight between their nodes: measured 5e-4
    low, high = (r.value for r in rows if r.quantity == "cavity_volume_ratio")
    assert high / low == pytest.approx(run.path[-1].volume_mm3 / run.requested[0].volume_mm3, rel=1e-3)
    assert 1.0 < low < high
    # 2 mm walls hardly stretch
    assert 0.8 < value["unfolding_share"] < 1.2
    assert all(math.isnan(r.uncertainty) for r in rows)  # one mesh says nothing of its error
