"""The paper study's plots show the rows and paths they are given: lines, markers, stops and what the legend says."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from studies.paper.cases import Case, Group, case_text, cases
from studies.paper.drawing import panels, plots
from studies.paper.results import CaseResult, PaperResults
from studies.report.style import figure_file
from studies.results.rows import FOLDED_BACK, REACHED, Row, row
from studies.results.run_files import PathRow, RunSummary
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene

DRAW = [
    panels.draw_elongations,
    panels.draw_dimensions_matter,
    plots.draw_beyond,
    plots.draw_assumptions,
    panels.draw_blocked,
    panels.draw_conventions,
    plots.draw_rings,
]
# Elongation per kPa of the made-up models, mm.
SLOPES = {
    "closed_form_printed": 3.0,
    "closed_form": 3.2,
    "closed_form_balanced": 4.1,
    "closed_form_seat": 3.6,
    "axisymmetric": 5.0,
    "full3d": 5.1,
}
PRINTED = {"paper_closed_form": 66.0, "paper_ansys": 78.0, "paper_experiment": 76.0}


def summary(model: str, level: str, seconds: float, cause: str = "", crossing_kpa: float = math.nan) -> RunSummary:
    crossing = {"kind": cause, "pressure_kpa": crossing_kpa, "within_kpa": 0.5}
    return RunSummary(
        scene="made-up",
        model=model,
        level=level,
        status="stopped" if cause else "reached",
        reason=cause,
        content_hash="0",
        plan=(),
        dofs=1,
        cells=1,
        nodes=1,
        factorisations=1,
        newton_iterations=1,
        rejected_steps=0,
        silicone_g=19.0,
        ring_g=5.0,
        time_s={"total": seconds},
        peak_mb=1.0,
        versions={},
        blas="",
        ranks=1,
        threads=1,
        commit="",
        when="",
        cause=cause,
        crossing={} if math.isnan(crossing_kpa) else crossing,
    )


def state(pressure: float, tip: float, force: float, modes: float, status: str) -> PathRow:
    nan = math.nan
    return PathRow(pressure, "auto", tip, tip, force, nan, nan, nan, nan, nan, modes, "", 1, 1.0, status, nan)


def made_up(
    case: Case,
    stop_kpa: float = math.inf,
    past_kpa: float = math.inf,
    bar_mm: float = 0.2,
    cause: str = "limit point",
    crossing_kpa: float = math.nan,
) -> CaseResult:
    """A case whose models are straight lines.

    Parameters
    ----------
    stop_kpa
        Where the axisymmetric path stops.
    past_kpa
        From where the printed chain folds back.
    bar_mm
        Uncertainty of axisymmetric rows.
    cause, crossing_kpa
        Why it stops, and from where on its states have an unstable mode.
    """
    scene = BellowsScene.model_validate(tomllib.loads(case_text(case)))
    asked = [p for p in scene.load.pressure_kpa if p <= stop_kpa]
    rows: list[Row] = []

    def add(quantity: str, unit: str, pressure: float, model: str, value: float, **more: str | float) -> None:
        rows.append(row(scene.name, quantity, unit, pressure, model, value, **more))  # type: ignore[arg-type]

    for p in scene.load.pressure_kpa:
        for model, slope in SLOPES.items():
            past = model == "closed_form_printed" and p >= past_kpa
            status = FOLDED_BACK if past else REACHED
            if model == "axisymmetric":
                add("tip_mm", "mm", p, model, 9.9 * p, level="r1")  # coarse: must not be drawn
                add("tip_mm", "mm", p, model, slope * p, level="r4", uncertainty=bar_mm)
            elif model != "full3d" or case.full3d:
                add("tip_mm", "mm", p, model, slope * p, status=status, uncertainty=0.2)
        add("tip_force_n", "N", p, "closed_form", 0.2 * p)
        add("extension_force_n", "N", p, "closed_form", 0.1 * p)
        if p <= stop_kpa:
            add("peak_stretch_away", "1", p, "axisymmetric", 1.0 + 0.2 * p, level="r4")
    for model, value in PRINTED.items():
        add("tip_mm", "mm", 20.0, model, value)
    slope = SLOPES["axisymmetric"]
    ends = [p for p in (stop_kpa - 1.0, stop_kpa) if asked[-1] < p < math.inf]
    modes = {p: float(p >= crossing_kpa) for p in (*asked, *ends)}
    path = [state(p, slope * p, 0.15 * p, modes[p], "requested" if p in asked else "step") for p in modes]
    why = cause if stop_kpa < math.inf else ""
    run = Run(summary("axisymmetric", "r4", 10.0, why, crossing_kpa), tuple(path))
    return CaseResult(case, Path("nowhere"), scene, (run,), rows=tuple(rows))


def measured(case: CaseResult) -> CaseResult:
    rows = []
    for p in case.pressures_kpa:
        for quantity in ("root_stretch_outer", "wall_stretch", "ring_hoop_stretch"):
            for model, slope in (("axisymmetric", 0.1), ("closed_form", 0.08)):
                if (quantity, model) != ("ring_hoop_stretch", "closed_form"):
                    rows.append(row(case.case.scene, quantity, "1", p, model, 1.0 + slope * p, "r4"))
    return replace(case, rows=(*case.rows, *rows))


def results(*groups: Group, make: Callable[[Case], CaseResult] = made_up) -> PaperResults:
    return PaperResults(tuple(make(case) for case in cases(*groups)))


def missing_one(found: PaperResults, base: str) -> PaperResults:
    return PaperResults(tuple(case for case in found.cases if case.case.base != base))


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """The figures that are written."""
    figures: list[Figure] = []

    @contextmanager
    def keep(path: Path, width_in: float, height_in: float) -> Iterator[Figure]:
        with figure_file(path, width_in, height_in) as figure:
            figures.append(figure)
            yield figure

    for module in (panels, plots):
        monkeypatch.setattr(module, "figure_file", keep)
    return figures


def legend(figure: Figure) -> list[str]:
    return [text.get_text() for found in figure.legends for text in found.get_texts()]


def ends(line) -> tuple[list[float], list[float]]:
    return list(line.get_xdata()), list(line.get_ydata())


def curves(axes) -> dict[str, tuple[list[float], list[float]]]:
    """What is drawn on axes by its label."""
    found = {box.get_label(): box.lines[0] for box in axes.containers}
    found |= {line.get_label(): line for line in axes.lines if not line.get_label().startswith("_")}
    return {label: ends(line) for label, line in found.items()}


def entries(axes) -> list[str]:
    return [text.get_text() for text in axes.get_legend().get_texts()]


@pytest.mark.parametrize("draw", DRAW)
def test_nothing_to_draw(draw: Callable[[Path, PaperResults], str], tmp_path: Path) -> None:
    assert draw(tmp_path / "x.png", PaperResults(()))
    assert not (tmp_path / "x.png").exists()


def test_elongations(tmp_path: Path, drawn: list[Figure]) -> None:
    def make(case: Case) -> CaseResult:
        return made_up(case, past_kpa=10.0 if case.base == "heung-t1-ri7" else math.inf)

    found = results("core", "tets", make=make)
    assert panels.draw_elongations(tmp_path / "x.png", found) == ""
    assert (tmp_path / "x.png").is_file()
    (figure,) = drawn
    shown = figure.axes
    assert [axes.get_title() for axes in shown][::3] == [
        "t = 1 mm, $R_i$ = 5 mm, Dragon Skin 10",
        "t = 2 mm, $R_i$ = 7 mm, Dragon Skin 30",
    ]
    first, second = curves(shown[0]), curves(shown[1])
    printed = "closed form as printed, to its fold-back"
    assert first[printed][0] == [0.0, 5.0, 10.0, 15.0, 20.0]
    assert second[printed] == ([0.0, 5.0], [0.0, 15.0])
    assert first["axisymmetric"][1] == [0.0, 25.0, 50.0, 75.0, 100.0]
    assert first["full 3D, hexahedra"][1] == pytest.approx([25.5, 51.0, 76.5, 102.0])
    assert first["full 3D, the paper's tetrahedra"][1] == pytest.approx([25.5, 51.0, 76.5, 102.0])
    assert first["paper: experiment"] == ([20.0], [76.0])
    assert legend(figure) == [*list(first)[:5], "axisymmetric ± 0.2 mm or less, within its line", *list(first)[5:]]
    for axes in shown:
        assert axes.get_xlim()[1] >= 20.0 and axes.get_ylim()[0] == 0.0


def test_a_wide_band_is_not_called_hidden(tmp_path: Path, drawn: list[Figure]) -> None:
    panels.draw_elongations(tmp_path / "x.png", results("core", make=lambda case: made_up(case, bar_mm=9.0)))
    assert "axisymmetric ± 9 mm or less" in legend(drawn[0])


def test_elongations_without_some(tmp_path: Path, drawn: list[Figure]) -> None:
    found = missing_one(results("core"), "heung-t1-ri7")
    assert panels.draw_elongations(tmp_path / "x.png", found) == ""
    assert drawn[0].axes[1].get_title() == "heung-t1-ri7: not run"
    assert not any("tetrahedra" in label for label in legend(drawn[0]))


def test_a_path_that_stopped_is_marked(tmp_path: Path, drawn: list[Figure]) -> None:
    panels.draw_elongations(tmp_path / "x.png", results("core", make=lambda case: made_up(case, stop_kpa=17.0)))
    assert curves(drawn[0].axes[0])["axisymmetric: stops at 17.0 kPa (limit point)"] == ([17.0], [85.0])


def test_dimensions_matter(tmp_path: Path, drawn: list[Figure]) -> None:
    assert panels.draw_dimensions_matter(tmp_path / "x.png", results("core", "alternates")) == ""
    (figure,) = drawn
    assert [len(entries(axes)) for axes in figure.axes] == [3, 3, 3, 3]
    assert entries(figure.axes[3])[2] == "alternate b: $R_i$ 7.5, $R_p$ 10.5, $e$ 6.5, $n$ 8, DS 10"
    assert legend(figure) == ["paper: closed form", "paper: ANSYS", "paper: experiment"]
    assert figure.axes[1].get_title() == "t = 1 mm, $R_i$ larger than 5 mm"


def test_dimensions_matter_with_one_set(tmp_path: Path, drawn: list[Figure]) -> None:
    assert panels.draw_dimensions_matter(tmp_path / "x.png", missing_one(results("core"), "heung-t2-ri5")) == ""
    assert [axes.get_legend() is None for axes in drawn[0].axes] == [False, False, True, False]


def test_beyond(tmp_path: Path, drawn: list[Figure]) -> None:
    def make(case: Case) -> CaseResult:
        return made_up(case, stop_kpa=24.0, crossing_kpa=23.0) if "t1" in case.base else made_up(case)

    assert plots.draw_beyond(tmp_path / "x.png", results("beyond", make=make)) == ""
    (figure,) = drawn
    top, middle, strip = figure.axes
    assert "t = 1 mm, $R_i$ = 5 mm: stops at 24.0 kPa (limit point at 23.0 ± 0.5 kPa)" in legend(figure)
    assert "t = 2 mm, $R_i$ = 7 mm: reaches 30 kPa" in legend(figure)
    crosses = [line for line in top.lines if line.get_marker() == "x"]
    assert [ends(line) for line in crosses] == [([24.0], [120.0])] * 2
    levels = {ends(line)[1][0] for line in middle.lines if line.get_linestyle() == "--"}
    assert sorted(levels) == pytest.approx([4.64, 11.0])
    assert "elongation at break of Dragon Skin 30 (t = 2 mm): 364 %" in [text.get_text() for text in middle.texts]
    unstable = [line for line in strip.lines if line.get_linewidth() == 6.0]
    assert {tuple(ends(line)[1]) for line in unstable} == {(0, 0), (1, 1)}
    assert [text.get_text() for text in strip.texts] == ["1", "1"]
    assert top.get_xlim()[1] >= 30.0


def test_assumptions(tmp_path: Path, drawn: list[Figure]) -> None:
    found = results("core", make=lambda case: measured(made_up(case)))
    assert plots.draw_assumptions(tmp_path / "x.png", found) == ""
    root, _, ring = drawn[0].axes
    dashed = [line for line in root.lines if line.get_linestyle() == "--"]
    dots = [line for line in root.lines if line.get_linestyle() == "None"]
    assert len(dashed) == len(dots) == 4
    assert ends(dashed[0])[1] == pytest.approx([1.0, 1.4, 1.8, 2.2, 2.6])
    assert ends(dots[0])[1] == pytest.approx([1.5, 2.0, 2.5, 3.0])
    assert not [line for line in ring.lines if line.get_linestyle() == "--"]
    assert legend(drawn[0])[-2:] == ["closed form", "axisymmetric"]


def test_blocked(tmp_path: Path, drawn: list[Figure]) -> None:
    found = results("blocked", make=lambda case: made_up(case, 12.0, cause="bifurcation", crossing_kpa=10.6))
    assert panels.draw_blocked(tmp_path / "x.png", found) == ""
    axes = drawn[0].axes[0]
    known = curves(axes)
    assert known["closed form"][1] == pytest.approx([0.0, 0.2, 0.5, 1.0, 1.5, 2.0])
    assert known["thrust of the pressure alone"][1] == pytest.approx([0.0, 0.1, 0.25, 0.5, 0.75, 1.0])
    assert [text.get_text() for text in axes.texts] == ["stops at 12.0 kPa (bifurcation at 10.6 ± 0.5 kPa)"]
    assert known["axisymmetric"][0] == [0.0, 1.0, 2.5, 5.0, 7.5, 10.0, 10.6]
    past = "axisymmetric, past the loss of stability"
    assert known[past][0] == [10.6, 11.0, 12.0]
    assert known[past][1] == pytest.approx([1.59, 1.65, 1.8])
    assert legend(drawn[0]) == ["closed form", "thrust of the pressure alone", "axisymmetric", past]
    assert drawn[0].axes[0].get_ylabel() == "force at the blocked tip, N"


def test_conventions(tmp_path: Path, drawn: list[Figure]) -> None:
    assert panels.draw_conventions(tmp_path / "x.png", results("core", "convention")) == ""
    assert len(drawn[0].axes) == 2
    assert list(curves(drawn[0].axes[0])) == [
        r"axisymmetric, 2$\mu/\alpha^2$",
        r"closed form, 2$\mu/\alpha^2$",
        r"axisymmetric, $\mu/\alpha$",
        r"closed form, $\mu/\alpha$",
        "paper: closed form",
        "paper: ANSYS",
        "paper: experiment",
    ]
    assert panels.draw_conventions(tmp_path / "y.png", results("convention")) == ""


def scaled(case: CaseResult, factor: float, seconds: float) -> CaseResult:
    (run,) = case.axisymmetric
    path = tuple(replace(entry, tip_mm=factor * entry.tip_mm) for entry in run.path)
    run = Run(replace(run.summary, time_s={"total": seconds}), path)
    return replace(case, axisymmetric=(run,))


def test_rings(tmp_path: Path, drawn: list[Figure]) -> None:
    known = {"rigid": (0.99, 4.0), "pla": (1.0, 9.0), "polyethylene": (1.002, 10.0)}

    def make(case: Case) -> CaseResult:
        return scaled(made_up(case), *known[case.scene.split("ring-")[1]])

    assert plots.draw_rings(tmp_path / "x.png", results("rings", make=make)) == ""
    (axes,) = drawn[0].axes
    assert axes.get_xscale() == "log"
    joined = [line for line in axes.lines if len(ends(line)[0]) == 3]
    assert len(joined) == 4
    assert ends(joined[0])[0] == [4.0, 9.0, 10.0]
    assert ends(joined[0])[1] == pytest.approx([-1.0, 0.0, 0.2])
    assert legend(drawn[0])[-3:] == ["rigid rings", "meshed PLA rings", "meshed polyethylene rings"]


def test_rings_without_pla(tmp_path: Path) -> None:
    found: Sequence[CaseResult] = [c for c in results("rings").cases if not c.case.scene.endswith("pla")]
    assert "PLA" in plots.draw_rings(tmp_path / "x.png", PaperResults(tuple(found)))
