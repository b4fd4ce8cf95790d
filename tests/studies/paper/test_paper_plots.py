"""The paper study's plots show the rows and paths they are given: lines, markers, stops and what the legend says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from analytical.bellows.chains import closed_form_balanced
from studies.paper.cases import Case
from studies.paper.drawing import blocked, lines, panels, plots
from studies.paper.results import CaseResult, PaperResults
from studies.results.closed_form_rows import closed_form_values
from studies.results.measured_rows import model_values
from studies.results.rows import row
from studies.scene.bellows import dimensions_of
from studies.scene.materials import law_of
from tests.studies.paper.plots_demo import at, curves, ends, kept_figures, legend, made_up, missing_one, results

DRAW = [
    panels.draw_elongations,
    panels.draw_dimensions_matter,
    plots.draw_beyond,
    plots.draw_assumptions,
    blocked.draw_blocked,
    panels.draw_conventions,
]


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    return kept_figures(monkeypatch, blocked, panels, plots)


def measured(case: CaseResult) -> CaseResult:
    rows = []
    for p in case.pressures_kpa:
        for quantity in ("root_stretch_outer", "wall_stretch", "wall_hoop_stretch_middle"):
            rows.append(row(case.case.scene, quantity, "1", p, "axisymmetric", 1.0 + 0.1 * p, "r4"))
    return replace(case, rows=(*case.rows, *rows))


def entries(axes) -> list[str]:
    return [text.get_text() for text in axes.get_legend().get_texts()]


@pytest.mark.parametrize("draw", DRAW)
def test_nothing_to_draw(draw: Callable[[Path, PaperResults], str], tmp_path: Path) -> None:
    assert draw(tmp_path / "x.png", PaperResults(()))
    assert not (tmp_path / "x.png").exists()


def test_elongations(tmp_path: Path, drawn: list[Figure]) -> None:
    found = results("core", "zigzag", "tets", make=lambda case: made_up(case, bar_mm=0.2102))
    assert panels.draw_elongations(tmp_path / "x.png", found) == ""
    assert (tmp_path / "x.png").is_file()
    (figure,) = drawn
    shown = figure.axes
    assert [axes.get_title() for axes in shown][::3] == [
        "t = 1 mm, $R_i$ = 5 mm; inferred: Dragon Skin 10",
        "t = 2 mm; inferred: $R_i$ = 7 mm, Dragon Skin 30",
    ]
    first = curves(shown[0])
    line = first["axisymmetric, as moulded (± 0.22 mm at most)"]
    assert [at(line, p) for p in (0.0, 5.0, 20.0)] == pytest.approx([0.0, 25.0, 100.0])
    assert first["full 3D, hexahedra (± 0.2 mm at most)"][1] == pytest.approx([25.5, 51.0, 76.5, 102.0])
    assert first["full 3D, curved tetrahedra (± 0.2 mm at most)"][1] == pytest.approx([25.5, 51.0, 76.5, 102.0])
    assert first["paper: experiment (± 0.5 mm)"][1] == [76.0]
    assert sorted(legend(figure)) == sorted(first)
    assert figure.legends[0].get_title().get_text() == panels.ROWS_DIFFER
    for axes in shown:
        assert axes.get_xlim()[1] > 20.0 and axes.get_ylim()[0] == 0.0


def test_both_outlines_are_drawn_in_two_colours(tmp_path: Path, drawn: list[Figure]) -> None:
    assert panels.draw_elongations(tmp_path / "x.png", results("core", "zigzag")) == ""
    for axes in drawn[0].axes:
        boxes = {box.get_label(): box.lines[0] for box in axes.containers}
        moulded, zigzag = (
            next(line for label, line in boxes.items() if label.startswith(f"axisymmetric, {outline}"))
            for outline in ("as moulded", "zigzag")
        )
        assert moulded.get_color() != zigzag.get_color()
        assert max(zigzag.get_xdata()) == 20.0


def test_chains_are_drawn_densely_and_in_colours_of_their_own(tmp_path: Path, drawn: list[Figure]) -> None:
    found = results("core")
    panels.draw_elongations(tmp_path / "x.png", found)
    known = curves(drawn[0].axes[0])
    names = [
        "closed form as printed, to its fold-back",
        "closed form",
        "closed form, balanced",
        "closed form, free pitch",
    ]
    assert len({box.lines[0].get_color() for box in drawn[0].axes[0].containers if box.get_label() in names}) == 4
    scene = found.cases[0].scene
    for name in names[1:]:
        assert len(known[name][0]) > 400
    rows = {model: value for model, value, _ in closed_form_values(scene, 15.0)}
    assert at(known["closed form, balanced"], 15.0) == pytest.approx(rows["closed_form_balanced"], rel=1e-9)
    # full unfolding at 18.1 kPa: the balanced chain's slope drops there, and the printed one folds back at 19.3 kPa
    unfolding = float(closed_form_balanced(dimensions_of(scene), law_of(scene.material), 1.0).unfolding_pressure_kpa[0])
    pressures, tips = (np.array(part) for part in known["closed form, balanced"])
    slopes = np.diff(tips) / np.diff(pressures)
    drop = int(np.argmin(np.diff(slopes)))
    assert pressures[drop + 1] == pytest.approx(unfolding, abs=20.0 / 400)  # a point's distance
    assert max(known[names[0]][0]) < 20.0


def test_print_is_rounded_and_side_by_side(tmp_path: Path, drawn: list[Figure]) -> None:
    panels.draw_elongations(tmp_path / "x.png", results("core"))
    boxes = [box for box in drawn[0].axes[0].containers if box.get_label().startswith("paper")]
    places = [float(box.lines[0].get_xdata()[0]) for box in boxes]
    assert len(places) == 3 and min(np.diff(places)) > 0.4 and places[0] > 20.0
    for box in boxes:
        (low, high) = box.lines[2][0].get_segments()[0][:, 1]
        assert high - low == pytest.approx(2.0 * lines.PRINT_ROUNDING_MM)


def test_smooth_lines_pass_through_their_points_and_stay_between() -> None:
    points = [(0.0, 0.0), (1.2, 23.0), (2.8, 39.0), (5.0, 56.0), (20.0, 150.0)]
    pressures, tips = np.transpose(lines.smooth(points))
    for p, tip in points:
        nearest = int(np.argmin(np.abs(pressures - p)))
        assert (pressures[nearest], tips[nearest]) == pytest.approx((p, tip), abs=1e-9)
    assert (np.diff(pressures) > 0.0).all() and (np.diff(tips) > 0.0).all()
    corners = np.abs(np.diff(np.arctan2(np.diff(tips) / 150.0, np.diff(pressures) / 20.0)))
    assert corners.max() < 0.12  # rad; the polyline's largest corner is 0.56
    assert lines.smooth(points[:2]) == points[:2]


def test_smooth_lines_turn_back_where_a_path_does() -> None:
    points = [(0.0, 0.0), (4.0, 2.0), (5.0, 4.0), (4.0, 6.0), (4.5, 9.0)]
    pressures, tips = np.transpose(lines.smooth(points))
    assert pressures.max() == pytest.approx(5.0) and (np.diff(tips) > 0.0).all()


def test_elongations_without_some(tmp_path: Path, drawn: list[Figure]) -> None:
    found = missing_one(results("core"), "heung-t1-ri7")
    assert panels.draw_elongations(tmp_path / "x.png", found) == ""
    assert drawn[0].axes[1].get_title() == "heung-t1-ri7: not run"
    assert not any("tetrahedra" in label for label in legend(drawn[0]))


def test_a_path_that_stopped_is_marked(tmp_path: Path, drawn: list[Figure]) -> None:
    panels.draw_elongations(tmp_path / "x.png", results("core", make=lambda case: made_up(case, stop_kpa=17.0)))
    stop = "axisymmetric, as moulded: stops at 17.0 kPa (limit point)"
    assert curves(drawn[0].axes[0])[stop] == ([17.0], [85.0])


def test_dimensions_matter(tmp_path: Path, drawn: list[Figure]) -> None:
    assert panels.draw_dimensions_matter(tmp_path / "x.png", results("core", "alternates")) == ""
    (figure,) = drawn
    assert [len(entries(axes)) for axes in figure.axes] == [3, 3, 3, 3]
    assert entries(figure.axes[3])[2] == "alternate b: $R_i$ 7.5, $R_p$ 10.5, $e$ 6.5, $n$ 8, DS 10"
    printed = [f"{name} (± 0.5 mm)" for name in ("paper: closed form", "paper: ANSYS", "paper: experiment")]
    assert legend(figure) == [*printed, "axisymmetric (± 0.2 mm at most)", "closed form"]
    assert len([box for box in figure.axes[0].containers if box.lines[0].get_linestyle() == "--"]) == 3
    assert figure.axes[1].get_title() == "t = 1 mm, $R_i$ larger than 5 mm"


def test_dimensions_matter_with_one_set(tmp_path: Path, drawn: list[Figure]) -> None:
    assert panels.draw_dimensions_matter(tmp_path / "x.png", missing_one(results("core"), "heung-t2-ri5")) == ""
    assert [axes.get_legend() is None for axes in drawn[0].axes] == [False, False, True, False]


def test_beyond(tmp_path: Path, drawn: list[Figure]) -> None:
    def make(case: Case) -> CaseResult:
        return made_up(case, stop_kpa=24.0, crossing_kpa=23.0) if "t1" in case.base else made_up(case)

    assert plots.draw_beyond(tmp_path / "x.png", results("beyond", make=make)) == ""
    (figure,) = drawn
    top, bottom = figure.axes
    assert "t = 1 mm, $R_i$ = 5 mm: stops at 24.0 kPa (limit point at 23.0 ± 0.5 kPa)" in legend(figure)
    assert "t = 2 mm, $R_i$ = 7 mm: reaches 30 kPa" in legend(figure)
    crosses = [line for line in top.lines if line.get_marker() == "x"]
    assert [ends(line) for line in crosses] == [([24.0], [120.0])] * 2
    levels = [ends(line)[1][0] for line in bottom.lines if line.get_linestyle() == "--"]
    assert levels == pytest.approx([4.64])
    assert bottom.get_ylim()[0] < 1.0 and bottom.get_ylim()[1] < 6.0  # the first point whole, no empty half
    said = [text.get_text() for text in bottom.texts]
    assert "Dragon Skin 10 (t = 1 mm) breaks at a stretch of 11, above this axis" in said
    assert top.get_title(loc="left") == "axisymmetric model; unstable axisymmetric modes along the paths: 1 at most"
    assert top.get_xlim()[1] >= 30.0


def test_beyond_without_unstable_modes(tmp_path: Path, drawn: list[Figure]) -> None:
    plots.draw_beyond(tmp_path / "x.png", results("beyond"))
    assert "no unstable axisymmetric mode" in drawn[0].axes[0].get_title(loc="left")


def test_assumptions(tmp_path: Path, drawn: list[Figure]) -> None:
    found = results("core", make=lambda case: measured(made_up(case)))
    assert plots.draw_assumptions(tmp_path / "x.png", found) == ""
    upper = drawn[0].axes[:3]
    titles = [axes.get_title() for axes in upper]
    assert titles == ["root, outside: hoop", "side wall, half-way up: hoop", "side wall: along it"]
    for axes in drawn[0].axes:
        shown = [box.lines[0] for box in axes.containers]
        assert len(shown) == 6 and len({line.get_color() for line in shown}) == 2
    shown = [box.lines[0] for box in upper[0].containers]
    chain, line, dots = shown[:3]
    assert chain.get_linestyle() == "--" and ends(dots)[1] == pytest.approx([1.5, 2.0, 2.5, 3.0])
    assert at(ends(line), 10.0) == pytest.approx(2.0) and at(ends(line), 0.0) == 1.0
    assumed = model_values(found.cases[0].scene, 10.0)["root_stretch_outer"]
    assert at(ends(chain), 10.0) == pytest.approx(assumed)
    middle = upper[1].containers[0].lines[0]
    assert set(ends(middle)[1]) == {1.0}  # pure shear
    assert legend(drawn[0])[-2:] == ["axisymmetric", "closed form"]


def test_conventions(tmp_path: Path, drawn: list[Figure]) -> None:
    assert panels.draw_conventions(tmp_path / "x.png", results("core", "convention")) == ""
    assert len(drawn[0].axes) == 2
    assert list(curves(drawn[0].axes[0])) == [
        "paper: closed form (± 0.5 mm)",
        "paper: ANSYS (± 0.5 mm)",
        "paper: experiment (± 0.5 mm)",
        r"axisymmetric, 2$\mu/\alpha^2$",
        r"closed form, 2$\mu/\alpha^2$",
        r"axisymmetric, $\mu/\alpha$",
        r"closed form, $\mu/\alpha$",
    ]
    assert panels.draw_conventions(tmp_path / "y.png", results("convention")) == ""
