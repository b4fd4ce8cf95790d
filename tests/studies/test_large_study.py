"""The study of large bodies: a point of each solver, kept points, fits, crossings, the estimate for more ranks."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest
from click.testing import CliRunner

from studies.large import study as large_study
from studies.large.cell import LargeCell
from studies.large.report import amdahl, crossing, points_table, power_law, render_large
from studies.results.rows import read_rows


def cell(method: str, unknowns: int, seconds: float, memory: float, ranks: int = 2) -> LargeCell:
    iterations = 50 if method == "iterative" else 0
    modes = -1 if iterations else 0
    return LargeCell(
        method, ranks, unknowns, unknowns // 28, 0.1, seconds, 0.0, seconds, 0.0, iterations, memory, modes
    )


def test_two_points_are_measured_kept_and_reported(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(large_study, "SIZES", (large_study.Size("smoke-t2-ri5", 6, 1),))
    command = ["--out", str(tmp_path), "--ranks", "1"]
    done = CliRunner().invoke(large_study.main, command)
    assert done.exit_code == 0, done.output
    files = sorted((tmp_path / "points").glob("*.json"))
    assert len(files) == 2
    before = [f.read_bytes() for f in files]
    assert CliRunner().invoke(large_study.main, command).exit_code == 0
    assert [f.read_bytes() for f in files] == before
    rows = {(r.quantity, r.level.split(", ")[1]): r.value for r in read_rows(tmp_path / "rows.csv")}
    assert rows["unknowns", "direct"] == rows["unknowns", "iterative"] > 1e4
    assert rows["iterations", "direct"] == 0.0 < rows["iterations", "iterative"] < 300.0
    assert (rows["modes", "direct"], rows["modes", "iterative"]) == (0.0, -1.0)
    assert "GMRES" in (tmp_path / "report.md").read_text(encoding="utf-8")
    assert (tmp_path / "pictures" / "large.png").exists()


def test_what_does_not_fit_or_has_no_time_left_is_said_and_not_tried(tmp_path, monkeypatch) -> None:
    def small_then_huge(out: Path, size, method, ranks, seconds):
        return cell(method, 10_000 * size.around * size.refinement**2, 1.0, 1e3 * size.around**2), ""

    monkeypatch.setattr(large_study, "_measured", small_then_huge)
    sizes = [large_study.Size("a", around, 1) for around in (1, 2, 40)]
    points = large_study.run_points(tmp_path, sizes, 1, 1.0, None)
    assert [p.cell is None for p in points] == [False] * 4 + [True] * 2
    # 1000 MB n^2 at n = 40
    assert "400000 unknowns would need about 1600 GB" in points[-1].why
    assert all("time is over" in p.why for p in large_study.run_points(tmp_path, sizes, 1, -1.0, None))
    rows = large_study.rows_of(points)
    assert rows[-1].status == points[-1].why


def test_fits_cross_where_power_laws_do(tmp_path) -> None:
    sizes = (1e5, 2e5, 4e5)
    direct = [cell("direct", int(n), 1e-10 * n**2, 1e-2 * n) for n in sizes]
    iterative = [cell("iterative", int(n), 1e-4 * n, 1e-8 * n**2) for n in sizes]
    law = power_law(direct, "setup_s")
    assert law is not None
    start, slope = law
    assert slope == pytest.approx(2.0)
    assert math.exp(start) == pytest.approx(1e-10, rel=1e-6)
    assert crossing((math.log(1e-10), 2.0), (math.log(1e-4), 1.0)) == pytest.approx(1e6)
    assert math.isnan(crossing((0.0, 1.0), (0.0, 2.0)))
    page = (
        render_large(tmp_path, direct + iterative, ["a: not tried"], 2).with_suffix(".md").read_text(encoding="utf-8")
    )
    assert "CPU time: the fits cross at about 1,000,000 unknowns" in page
    assert "memory: the fits do not cross" in page
    failed = dataclasses.replace(direct[0], failure="MUMPS failed")
    assert points_table([failed]).rows[0][-1] == "MUMPS failed"


def test_amdahls_estimate() -> None:
    assert amdahl(2.0, 1.0, 64) == pytest.approx(2.0 / 64.0)
    assert amdahl(2.0, 2.0, 64) == pytest.approx(2.0)
    assert amdahl(1.0, 0.75, 2) == pytest.approx(0.75)
