"""Rows of several stacks: what counts as the same, what is named as the largest difference, what a report shows."""

from __future__ import annotations

import dataclasses
import json
import math
from dataclasses import asdict

import pytest
from click.testing import CliRunner

from studies.command.study import command_of
from studies.results.rows import row, write_rows
from studies.stacks.figures import Figures
from studies.stacks.study import STUDY, compare

ROWS = [
    row("a", "tip_mm", "mm", 5.0, "axisymmetric", 50.0, "r2"),
    row("a", "gap_percent", "%", 5.0, "axisymmetric", 0.03, "r2"),
    row("a", "unstable_modes", "1", 5.0, "full3d", 0.0, "n8"),
    row("a", "work_s", "s", math.nan, "full3d", 12.0, "n8"),
    row("a", "tip_mm", "mm", 9.0, "full3d", math.nan, "n8", status="stopped at 7 kPa: memory"),
]


def changed(place: int, value: float, **others) -> list:
    rows = list(ROWS)
    rows[place] = dataclasses.replace(rows[place], value=value, **others)
    return rows


def test_the_same_rows_do_not_differ_and_times_are_not_compared() -> None:
    assert compare(ROWS, changed(3, 99.0)).value == 0.0
    assert compare(ROWS, ROWS).rows == 4


def test_differences_are_relative_and_those_of_percentages_are_of_the_whole() -> None:
    found = compare(ROWS, changed(0, 50.0 * (1.0 + 3e-9)))
    assert found.value == pytest.approx(3e-9, rel=1e-6)
    assert found.where == "a tip_mm 5 kPa axisymmetric r2"
    assert compare(ROWS, changed(1, 0.03 + 1e-6)).value == pytest.approx(1e-8, rel=1e-6)


def test_a_count_that_changes_or_a_row_that_one_stack_lacks_is_seen() -> None:
    assert compare(ROWS, changed(2, 1.0)).value == 1.0
    assert compare(ROWS, changed(4, 80.0, status="reached")).value == math.inf
    with pytest.raises(ValueError, match="rows of 4 and 3 things differ in a tip_mm 9 kPa full3d n8"):
        compare(ROWS, ROWS[:-1])


def test_the_report_says_whether_it_is_met(tmp_path) -> None:
    figures = Figures({"dolfinx": "0.5.2"}, "openblas", 30.0, 12.0, 400.0, 3.0, 1234.0, {"1": [0, 19], "2": [0, 19]})
    folders = [tmp_path / name for name in ("debian-12", "wheel")]
    for folder, rows in zip(folders, (ROWS, changed(0, 50.1)), strict=True):
        folder.mkdir()
        write_rows(folder / "rows.csv", rows)
        (folder / "figures.json").write_text(json.dumps(asdict(figures)), encoding="utf-8")
    for names, code, said in ((folders[:1], 0, "| met |"), (folders, 3, "| NOT MET |")):
        result = CliRunner().invoke(command_of(STUDY), [*map(str, names), "--out", str(tmp_path / "out")])
        assert result.exit_code == code, result.output
        text = (tmp_path / "out" / "report.md").read_text(encoding="utf-8")
        assert said in text and "compiled, s | 30 / 12" in text and "compiled, s | 400 |" in text
        assert (tmp_path / "out" / "report.html").exists()
    empty = tmp_path / "empty"
    empty.mkdir()
    result = CliRunner().invoke(command_of(STUDY), [str(empty), "--out", str(tmp_path / "none")])
    assert result.exit_code == 2 and "figures.json" in result.output and not (tmp_path / "none").exists()
