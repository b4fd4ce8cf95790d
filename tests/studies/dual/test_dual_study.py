"""The study of estimated errors: its cases, a page of one of them, and how what is right is counted."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from mpi4py import MPI

from solvers.estimate.dual import DualEstimate
from studies.dual import study
from studies.dual.cases import twenty
from studies.dual.study import STUDY, Estimate, cases, right
from studies.engine import run
from studies.results.rows import read_rows


def estimate(true: float, richer: float) -> Estimate:
    return Estimate(1.0, "tip_mm", 10.0, true, 0.0, richer, DualEstimate(richer, math.nan))


def test_twenty_scenes_of_both_laws_and_cells() -> None:
    every = twenty()
    assert len(every) == len({case.scene.name for case in every}) == 20
    assert {case.scene.material.law for case in every} == {"ogden", "yeoh", "guccione"}
    assert {case.scene.mesh.element for case in every} == {"auto", "tet"}
    assert {math.isinf(case.scene.material.kappa_over_mu) for case in every} == {True, False}
    assert [case.name for case in cases({"scene": "sphere"})] == [
        "exact sphere",
        "exact sphere-yeoh, kappa_over_mu 100.0",
    ]


def test_right_counts_factors_and_signs_apart() -> None:
    found = [estimate(1.0, 0.6), estimate(1.0, 0.4), estimate(-1.0, 1.0), estimate(-1.0, -2.1), estimate(1.0, math.nan)]
    assert right(found, "richer spaces") == (1, 3)
    assert right(found, "dual-weighted residual") == (0, 0)


def test_page_of_the_exact_sphere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "FINER", (2, 4))
    assert run(STUDY, tmp_path, MPI.COMM_WORLD, {"scene": "exact sphere-yeoh"}) == 0
    rows = [r for r in read_rows(tmp_path / "rows.csv") if r.model == "richer spaces"]
    assert len(rows) == 3 and all(0.5 < r.value / r.reference < 2.0 for r in rows)
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "| estimate within a factor of 2 in 1 of 1 | 1 | met |" in text
    assert (tmp_path / "pictures" / "errors.png").stat().st_size > 5000
