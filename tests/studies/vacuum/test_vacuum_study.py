"""The vacuum study: sound scenes, and the report of a small bellows."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from mpi4py import MPI

from studies.engine import run
from studies.results.rows import read_rows
from studies.scene.bellows import at_pressures
from studies.scene.load import load_bellows
from studies.vacuum.study import STUDY, cases


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
