"""The study of large bodies: a point of each solver, kept points, fits, crossings, the estimate for more ranks."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest
from mpi4py import MPI

from studies.engine import run
from studies.large import tables
from studies.large.cases import Point, Size
from studies.large.fits import PowerLaw, amdahl, crossing, power_law
from studies.large.measure import Measured
from studies.large.study import STUDY
from studies.results.kept import keep
from studies.results.rows import read_rows


def measured(method: str, unknowns: int, seconds: float, memory: float, ranks: int = 2) -> Measured:
    iterations = 50 if method == "iterative" else 0
    modes = -1 if iterations else 0
    return Measured(method, ranks, unknowns, unknowns // 28, 0.1, seconds, 0.0, seconds, 0.0, iterations, memory, modes)


def run_sizes(out: Path, monkeypatch, *sizes: Size, minutes: float = 25.0) -> None:
    monkeypatch.setattr("studies.large.cases.SIZES", sizes)
    assert run(STUDY, out, MPI.COMM_WORLD, {"ranks": 1, "minutes": minutes, "limit": None}) == 0


def test_two_points_are_measured_kept_and_reported(tmp_path, monkeypatch) -> None:
    size = Size("smoke-t2-ri5", 6, 1)
    run_sizes(tmp_path, monkeypatch, size)
    files = sorted((tmp_path / "points").glob("*.json"))
    assert len(files) == 2
    before = [f.read_bytes() for f in files]
    run_sizes(tmp_path, monkeypatch, size)
    assert [f.read_bytes() for f in files] == before
    rows = {(r.quantity, r.level.split(", ")[1]): r.value for r in read_rows(tmp_path / "rows.csv")}
    assert rows["unknowns", "direct"] == rows["unknowns", "iterative"] > 1e4
    assert rows["iterations", "direct"] == 0.0 < rows["iterations", "iterative"] < 300.0
    assert (rows["modes", "direct"], rows["modes", "iterative"]) == (0.0, -1.0)
    assert "GMRES" in (tmp_path / "report.md").read_text(encoding="utf-8")
    assert (tmp_path / "pictures" / "large.png").exists()


def test_what_does_not_fit_or_has_no_time_left_is_said_and_not_tried(tmp_path, monkeypatch) -> None:
    def small_then_huge(point: Point, file: Path, key: str) -> str:
        size = point.size
        unknowns, memory = 10_000 * size.around * size.refinement**2, 1e3 * size.around**2
        keep(file, key, measured(point.method, unknowns, 1.0, memory))
        return ""

    monkeypatch.setattr("studies.large.study.measure_in_child", small_then_huge)
    sizes = [Size("a", around, 1) for around in (1, 2, 40)]
    run_sizes(tmp_path, monkeypatch, *sizes)
    statuses = [r.status for r in read_rows(tmp_path / "rows.csv") if r.quantity == "setup_s"]
    # 1000 MB n^2 at n = 40
    huge = "not tried: about 400000 unknowns would need about 1600 GB"
    assert statuses == ["reached"] * 4 + [huge] * 2
    assert f"- a-n40r1 direct, ranks: 1: {huge}" in (tmp_path / "report.md").read_text(encoding="utf-8")
    run_sizes(tmp_path / "late", monkeypatch, *sizes, minutes=-1.0)
    assert all("time is over" in r.status for r in read_rows(tmp_path / "late" / "rows.csv"))


def test_fits_cross_where_power_laws_do() -> None:
    sizes = (1e5, 2e5, 4e5)
    direct = [measured("direct", int(n), 1e-10 * n**2, 1e-2 * n) for n in sizes]
    iterative = [measured("iterative", int(n), 1e-4 * n, 1e-8 * n**2) for n in sizes]
    law = power_law(direct, "setup_s")
    assert law is not None
    assert law.exponent == pytest.approx(2.0)
    assert math.exp(law.start) == pytest.approx(1e-10, rel=1e-6)
    assert law.at(2e5) == pytest.approx(4.0)
    assert crossing(PowerLaw(math.log(1e-10), 2.0), PowerLaw(math.log(1e-4), 1.0)) == pytest.approx(1e6)
    assert math.isnan(crossing(PowerLaw(0.0, 1.0), PowerLaw(0.0, 2.0)))
    said = tables.crossings([*direct, *iterative])
    assert said[0] == "CPU time: the fits cross at about 1,000,000 unknowns"
    assert said[2] == "memory: the fits do not cross"
    failed = dataclasses.replace(direct[0], failure="MUMPS failed")
    assert tables.points_table([failed]).rows[0][-1] == "MUMPS failed"
    assert ("direct", "memory, MB", "1.00") in tables.fits_table([*direct, *iterative]).rows


def test_a_body_on_one_rank_and_on_two_is_estimated_on_more() -> None:
    points = [
        dataclasses.replace(measured("direct", 1000, seconds, 1.0, ranks), solve_s=0.1)
        for seconds, ranks in ((2.0, 1), (1.0, 2))
    ]
    lines = [line for line in tables.scaling_table(points).rows if line[0] == "1000"]
    assert [line[2] for line in lines] == ["tangent", "set-up", "solve"]
    assert lines[1][3:] == ("2.00", "1.00", "0.25", "0.03")


def test_amdahls_estimate() -> None:
    assert amdahl(2.0, 1.0, 64) == pytest.approx(2.0 / 64.0)
    assert amdahl(2.0, 2.0, 64) == pytest.approx(2.0)
    assert amdahl(1.0, 0.75, 2) == pytest.approx(0.75)
