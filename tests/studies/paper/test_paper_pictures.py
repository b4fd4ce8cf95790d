"""The paper study's picture of blocked tips, what is said of them, and the scale that pictures of states share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imsave

from studies.models.modes import FoundCrossing
from studies.paper.blocked import blocked_sentences, first_touch, sideways
from studies.paper.cases import REFERENCE_SCENES, Case, cases
from studies.paper.drawing import blocked, front, panels, pictures, plots
from studies.paper.results import CaseResult, PaperResults
from studies.report.pictures.stills import Still
from studies.results.closed_form_rows import closed_form_values
from studies.results.rows import row
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene
from tests.studies.paper.plots_demo import at, curves, ends, kept_figures, made_up, results


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    return kept_figures(monkeypatch, blocked, panels, plots)


def bent(case: Case, pressure_kpa: float = 0.47, touch_kpa: float = 5.0) -> CaseResult:
    """A blocked case that bends sideways, and whose folds touch from a pressure on."""
    found = made_up(case)
    (run,) = found.axisymmetric
    path = tuple(replace(s, min_gap_mm=0.0 if s.pressure_kpa >= touch_kpa else 0.5) for s in run.path)
    crossing = FoundCrossing(1, pressure_kpa, 1e-4, 1.0, 1.0, 0, 1, 0.0, 0.15 * pressure_kpa)
    later = FoundCrossing(0, 4.0, 1e-4, 1.0, 1.0, 0, 1, 0.0, 0.6)
    run = Run(run.summary, path)
    return replace(found, axisymmetric=(run,), modes_counted=True, crossings=(later, crossing))


def test_blocked_is_dashed_from_the_first_sideways_mode(tmp_path: Path, drawn: list[Figure]) -> None:
    assert blocked.draw_blocked(tmp_path / "x.png", results("blocked", make=bent)) == ""
    axes = drawn[0].axes[0]
    known = curves(axes)
    stable, beyond = known["axisymmetric, stable"], known[blocked.LABELS["--"]]
    assert stable[0][0] == 0.0 and stable[0][-1] == beyond[0][0] == 0.47
    assert beyond[0][-1] == 10.0 and stable[1][-1] == pytest.approx(0.15 * 0.47)
    dashes = {box.get_label(): box.lines[0].get_linestyle() for box in axes.containers}
    assert (dashes["axisymmetric, stable"], dashes[blocked.LABELS["--"]]) == ("-", "--")
    (said,) = [text.get_text() for text in axes.texts]
    assert said == "bends sideways from 0.47 kPa\nfirst touch between 2.5 and 5 kPa"
    rings = [line for line in axes.lines if line.get_markerfacecolor() == "none"]
    assert [ends(line) for line in rings] == [([5.0], [0.75])]
    assert axes.get_ylabel() == "force at the blocked tip, N"
    assert at(known["closed form"], 5.0) == pytest.approx(closed_form_values(bent_scene(), 5.0)[0][1])


def test_front_is_the_states_beside_the_curves(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    figures = kept_figures(monkeypatch, front)
    states = tmp_path / "states.png"
    imsave(states, np.zeros((4, 5)))
    assert front.draw_front(tmp_path / "x.png", results("core"), states) == ""
    left, right = figures[0].axes
    assert len(left.images) == 1 and not left.axison
    assert {"closed form", "paper: experiment (± 0.5 mm)"} <= set(curves(right))
    assert "no" in front.draw_front(tmp_path / "x.png", results("core"), tmp_path / "none.png")


def bent_scene() -> BellowsScene:
    return bent(cases("blocked")[0]).scene


def test_blocked_that_is_not_counted_is_not_drawn_as_stable(tmp_path: Path, drawn: list[Figure]) -> None:
    found = results("blocked", make=lambda case: made_up(case, 12.0, cause="bifurcation", crossing_kpa=10.6))
    assert blocked.draw_blocked(tmp_path / "x.png", found) == ""
    axes = drawn[0].axes[0]
    assert blocked.LABELS[":"] in curves(axes) and "axisymmetric, stable" not in curves(axes)
    assert [text.get_text() for text in axes.texts] == ["stops at 12.0 kPa (bifurcation at 10.6 ± 0.5 kPa)"]


def test_blocked_tips_in_words() -> None:
    case = bent(cases("blocked")[0])
    found = sideways(case)
    assert found is not None and found.pressure_kpa == 0.47
    assert first_touch(case) == (2.5, 5.0)
    assert first_touch(bent(cases("blocked")[0], touch_kpa=99.0)) is None
    said = blocked_sentences(PaperResults((case,)))
    assert "sideways (m = 1) from 0.47 kPa on (t = 1 mm, R_i = 5 mm)" in said[0]
    assert "between 2.5 and 5 kPa (t = 1 mm, R_i = 5 mm)" in said[1] and len(said) == 2
    assert (
        "0.50 mm (t = 1 mm, R_i = 5 mm)"
        in blocked_sentences(PaperResults((bent(cases("blocked")[0], touch_kpa=99.0),)))[-1]
    )
    assert blocked_sentences(PaperResults(())) == []


def test_states_share_a_scale_that_ends_where_meshes_agree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def make(case: Case) -> CaseResult:
        found = made_up(case)
        edge = row(found.scene.name, "peak_stretch", "1", 20.0, "axisymmetric", 99.0, "r4")
        chain = row(found.scene.name, "peak_stretch_away", "1", 20.0, "closed_form", 98.0)
        return replace(found, rows=(*found.rows, edge, chain))

    found = results("core", make=make)
    assert pictures.stretch_top(found) == pytest.approx(1.0 + 0.2 * 20.0)
    assert pictures.stretch_top(PaperResults(())) is None
    asked: list[tuple[str, float]] = []

    def draw(path: Path, stills: Sequence[Still], top: float) -> str:
        asked.append((path.stem, round(top, 9)))
        return "not drawn"

    monkeypatch.setattr(pictures, "draw_states", draw)
    monkeypatch.setattr(pictures, "draw_side_by_side", lambda path, stills: stills[0].label)
    monkeypatch.setattr(pictures, "_draw_roots", lambda path, found: "not drawn")
    monkeypatch.setattr(pictures, "_stills", lambda case, pressures=(): [Still("0 kPa", Path("gone.vtu"))])
    monkeypatch.setattr(pictures, "_PLOTS", {})
    shown = pictures.draw_all(tmp_path, found)
    assert sorted(asked) == [(f"states-{name}", 5.0) for name in sorted(REFERENCE_SCENES)]  # side by side
    assert shown["figure4b"] == "heung-t1-ri5, 0 kPa"
    assert "rings" not in shown
