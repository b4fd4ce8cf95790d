"""Fields at a root are those of the state, where it is; and the view from outside is drawn."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from meshes.solid import REGIONS
from solvers.state import State
from studies.report.pictures import roots
from studies.report.pictures.child import draw_side_by_side
from studies.report.pictures.roots import RootPanel, draw_root_fields, root_panel
from studies.report.pictures.stills import RingBox, Still
from studies.report.style import figure_file
from studies.results.run_files import PathRow, save_state
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_meridian

STRETCH, WIDENING, PRESSURE_MPA = 1.5, 1.1, 0.03


@pytest.fixture(scope="module")
def smoke(root: Path) -> BellowsScene:
    """Two convolutions or so, coarse."""
    return load_bellows(root / "scenes" / "smoke-t2-ri5.toml")


def changed(scene: BellowsScene, **tables: dict[str, Any]) -> BellowsScene:
    data = scene.model_dump()
    for table, changes in tables.items():
        data[table] |= changes
    return BellowsScene.model_validate(data)


def kept(scene: BellowsScene, folder: Path) -> Any:
    """A run with one state: stretched along the axis and widened uniformly, under uniform mean stress."""
    mesh, shape = scene_meridian(scene, 1), shape_of(scene)
    moved = mesh.points * [WIDENING - 1.0, STRETCH - 1.0]
    pressure = np.zeros(len(mesh.points))
    pressure[mesh.corners] = PRESSURE_MPA
    state = State(moved, pressure, (STRETCH - 1.0) * shape.crest_positions_mm[:, None], 0.01)
    nan = math.nan
    row = PathRow(10.0, "", nan, nan, nan, nan, nan, nan, nan, nan, nan, "", 0, 0.0, "requested", nan)
    save_state(folder, "abc", state, row)
    return SimpleNamespace(summary=SimpleNamespace(level="r1", content_hash="abc"))


@pytest.mark.parametrize("element", ["hex", "tet"])
def test_the_panel_is_the_state_round_the_middle_root(smoke: BellowsScene, tmp_path: Path, element: str) -> None:
    scene = changed(smoke, mesh={"element": element})
    panel = root_panel(scene, kept(scene, tmp_path), tmp_path, 10.0)
    assert panel is not None
    shape = shape_of(scene)
    half = STRETCH * scene.geometry.half_pitch_mm
    assert panel.label == "t = 2 mm, $R_i$ = 5 mm"
    assert panel.stretch == pytest.approx(STRETCH)
    assert panel.mean_stress_kpa == pytest.approx(1e3 * PRESSURE_MPA)
    assert [panel.points_mm[:, 0].min(), panel.points_mm[:, 0].max()] == pytest.approx([-half, half], abs=0.5)
    assert panel.points_mm[:, 1].min() == pytest.approx(WIDENING * shape.root_radius_mm, rel=1e-3)
    assert [ring.centre_mm for ring in panel.rings] == pytest.approx([-half, half])
    assert panel.rings[0].inner_radius_mm == shape.seat_radius_mm
    inside, outside = panel.undeformed_mm
    assert np.abs(inside[:, 0]).max() == pytest.approx(scene.geometry.half_pitch_mm, abs=0.5)
    assert inside[:, 1].min() == pytest.approx(shape.root_radius_mm, rel=1e-3)
    assert outside[:, 1].max() == pytest.approx(shape.seat_radius_mm)


def test_hoop_stretch_counts(smoke: BellowsScene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(globals(), "WIDENING", 2.0)
    panel = root_panel(smoke, kept(smoke, tmp_path), tmp_path, 10.0)
    assert panel is not None and panel.stretch == pytest.approx(2.0)


def test_meshed_rings_are_neither_silicone_nor_rigid(smoke: BellowsScene, tmp_path: Path) -> None:
    scene = changed(smoke, rings={"model": "meshed"}, mesh={"element": "auto"})
    assert REGIONS["ring"] in scene_meridian(scene, 1).regions
    panel = root_panel(scene, kept(scene, tmp_path), tmp_path, 10.0, "meshed")
    assert panel is not None and panel.rings == () and panel.label == "meshed"
    assert panel.points_mm[:, 1].max() == pytest.approx(WIDENING * shape_of(scene).seat_radius_mm)


def test_no_state_no_panel(smoke: BellowsScene, tmp_path: Path) -> None:
    assert root_panel(smoke, kept(smoke, tmp_path), tmp_path, 20.0) is None
    assert draw_root_fields(tmp_path / "x.png", []) == "no state was kept"


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """The figures that are written."""
    figures: list[Figure] = []

    @contextmanager
    def keep(path: Path, width_in: float, height_in: float, dpi: int) -> Iterator[Figure]:
        with figure_file(path, width_in, height_in, dpi) as figure:
            figures.append(figure)
            yield figure

    monkeypatch.setattr(roots, "figure_file", keep)
    return figures


def panel(label: str, half_mm: float, stress_kpa: float) -> RootPanel:
    """A flat strip of four triangles between two rings."""
    x, r = np.meshgrid([-half_mm, 0.0, half_mm], [10.0, 11.0])
    points = np.column_stack([x.ravel(), r.ravel()])
    triangles = np.array([[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]])
    rings = (RingBox(-half_mm, 11.0, 4.0, 2.0), RingBox(half_mm, 11.0, 4.0, 2.0))
    outline = np.array([[-2.0, 8.0], [2.0, 8.0]])
    stretch = np.linspace(1.0, 3.0, 6) * half_mm / 9.0
    trusted = np.array([True] * 5 + [False])  # the last node has the largest stretch
    return RootPanel(label, points, triangles, stretch, np.full(6, stress_kpa), trusted, (outline,), rings)


def test_fields_are_drawn_to_one_scale(tmp_path: Path, drawn: list[Figure]) -> None:
    assert draw_root_fields(tmp_path / "x.png", [panel("thin", 9.0, 180.0), panel("thick", 5.0, -20.0)]) == ""
    (figure,) = drawn
    panels = figure.axes[:4]
    bars = [axes.child_axes[0] for axes in panels]
    assert [axes.get_title(loc="left") for axes in panels] == ["thin", "", "thick", ""]
    assert [axes.get_title(loc="right") for axes in panels[:2]] == [
        "largest principal stretch",
        "mean stress, kPa, tension positive; bands double",
    ]
    assert {axes.get_xlim() for axes in panels} == {(-9.6, 9.6)}
    assert {axes.get_aspect() for axes in panels} == {1.0}
    assert all("axial" in axes.get_xlabel() for axes in panels)
    # a scale of stretch for each row, which ends at the largest trusted value; one of stress
    assert bars[0].get_ylim() == pytest.approx((1.0, 2.6)) and bars[2].get_ylim() == pytest.approx((1.0, 2.6 * 5 / 9))
    assert bars[1].get_ylim() == bars[3].get_ylim() == (-50.0, 200.0)
    for axes, half in zip(panels, (9.0, 9.0, 5.0, 5.0), strict=True):
        boxes = [patch.get_bbox() for patch in axes.patches if isinstance(patch, Rectangle)]
        assert [(box.x0, box.x1) for box in boxes] == [(-half, 2.0 - half), (half - 2.0, half)]
        assert [(box.y0, box.y1) for box in boxes] == [(11.0, 13.0)] * 2
        undeformed, edge = (np.array(line.get_xydata()) for line in axes.lines)
        assert list(undeformed[:, 1]) == [8.0, 8.0]
        assert len(edge) == 7  # six nodes round the strip and back


# --- the view from outside ------------------------------------------------------------------


@pytest.mark.slow
def test_the_view_from_outside(tmp_path: Path, two_cells: Callable[[Path], None]) -> None:
    body = tmp_path / "body.vtu"
    two_cells(body)
    stills = [Still("0 kPa", body, False, (RingBox(5.0, 5.0, 4.0, 2.0),)), Still("10 kPa", body)]
    assert draw_side_by_side(tmp_path / "x.png", stills) == ""
    assert (tmp_path / "x.png").stat().st_size > 10_000
    assert "no such file" in draw_side_by_side(tmp_path / "y.png", [Still("0 kPa", tmp_path / "gone.vtu")])


def test_the_axis_is_level_in_the_view_from_outside() -> None:
    from studies.report.pictures.outside import _view

    towards, plane = _view()
    assert plane @ [0.0, 0.0, 1.0] == pytest.approx([math.hypot(*towards[:2]), 0.0])
    assert np.vstack([plane, towards]) @ np.vstack([plane, towards]).T == pytest.approx(np.eye(3))
    assert np.cross(*plane) == pytest.approx(towards)


@pytest.fixture
def two_cells() -> Callable[[Path], None]:
    """Writes two tetrahedra of ten nodes each, 20 mm long, with the fields of a run; one is of a ring."""
    pyvista = pytest.importorskip("pyvista")

    def write(path: Path) -> None:
        corners = np.array([[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [-2.0, 4.0, 0.0], [0.0, 0.0, 20.0]])
        pairs = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
        one = np.vstack([corners, [0.5 * (corners[i] + corners[j]) for i, j in pairs]])
        body = pyvista.UnstructuredGrid({24: np.arange(20).reshape(2, 10)}, np.vstack([one, one * [1.0, -1.0, 1.0]]))
        body["displacement_mm"] = 0.1 * body.points
        body["stretch_max"] = np.ones(20)
        body.cell_data["region"] = np.array([1, 3])
        body.save(path)

    return write
