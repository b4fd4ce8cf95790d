"""The vacuum study: sound scenes, and the report of a small bellows."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from types import SimpleNamespace

import pytest
from mpi4py import MPI

from studies.engine import run
from studies.report.panels import Panel
from studies.results.rows import read_rows
from studies.scene.bellows import at_pressures
from studies.scene.load import load_bellows
from studies.vacuum import study
from studies.vacuum.study import STUDY, cases, draw_contractions


def test_vacuum_report_of_a_small_bellows(root: Path, tmp_path: Path) -> None:
    scene = at_pressures(load_bellows(root / "scenes" / "smoke-t2-ri5.toml"), [-0.5, -2.0])
    study = dataclasses.replace(STUDY, cases=lambda options: [scene])
    assert run(study, tmp_path, MPI.COMM_WORLD, {"level": (1,)}) == 0
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "| -2 |" in text and "contact modelled beyond" in text
    for picture in ("contractions", scene.name):
        assert (tmp_path / "pictures" / f"{picture}.png").stat().st_size > 5000
    tips = [r.value for r in read_rows(tmp_path / "rows.csv") if r.quantity == "tip_mm"]
    assert len(tips) == 2 and tips[1] < tips[0] < 0.0


def test_scenes_under_vacuum_are_sound() -> None:
    scenes = cases({})
    assert len(scenes) == 6
    assert all(scene.load.sense < 0.0 and scene.contact.model == "auto" for scene in scenes)


def test_contractions_have_a_linear_panel_per_range_and_plain_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[Panel] = []
    monkeypatch.setattr(study, "draw_panels", lambda path, rows, *rest: shown.extend(rows[0]))
    path = (SimpleNamespace(pressure_kpa=-0.5, tip_mm=-3.0),)
    runs = [SimpleNamespace(path=path)]
    draw_contractions(tmp_path / "x.png", [(scene, runs) for scene in cases({})])  # type: ignore[misc]
    assert [panel.title for panel in shown] == ["to 1 kPa", "to 2 kPa", "to 10 kPa"]
    assert not any(panel.logarithmic for panel in shown)
    assert [[series.label for series in panel.series] for panel in shown][1] == [
        "t = 1, $R_i$ = 5 mm, n = 8",
        "t = 1, $R_i$ = 7 mm, n = 8",
    ]
    assert list(shown[0].series[0].x) == [0.0, 0.5] and list(shown[0].series[0].y) == [0.0, 3.0]
