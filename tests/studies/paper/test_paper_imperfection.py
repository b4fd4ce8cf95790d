"""What is quoted of the imperfection study: its kept rows, and whether they still are of this actuator."""

from __future__ import annotations

from pathlib import Path

import pytest

from studies.paper.imperfection import ACTUATOR, CENTRED, OFF, PUBLISHED, SHARE, eccentric_core
from studies.paper.results import PaperResults
from studies.results.rows import Row, read_rows, row, write_rows
from tests.studies.paper.paper_demo import case_of, make_case, make_results


def published() -> list[Row]:
    found = []
    for pressure, off, bend in ((5.0, 28.0, -18.0), (20.0, 57.0, -20.0)):
        found.append(row(CENTRED, "tip_mm", "mm", pressure, "full3d", pressure + 25.0 if pressure < 10 else 60.0, "n8"))
        found.append(row(OFF, "tip_mm", "mm", pressure, "full3d", off, "n8"))
        found.append(row(OFF, "tip_bend_deg", "degree", pressure, "full3d", bend, "n8"))
    return found


def body(at_5: float) -> PaperResults:
    extra = tuple(row(ACTUATOR, "tip_mm", "mm", p, "full3d", v, "n8") for p, v in ((5.0, at_5), (20.0, 60.0)))
    return make_results(make_case(case_of("core", ACTUATOR), extra=extra))


@pytest.fixture
def file(tmp_path: Path) -> Path:
    write_rows(tmp_path / "rows.csv", published())
    return tmp_path / "rows.csv"


def test_bend_and_change_come_from_the_published_rows(file: Path) -> None:
    told, fits = eccentric_core(body(30.0), file)
    assert "A core 0.2 mm off the axis" in told
    assert "18.0° and −6.7 % at 5 kPa, 20.0° and −5.0 % at 20 kPa" in told
    assert "has the elongation of this report's body" in fits


def test_rows_of_another_actuator_are_told(file: Path) -> None:
    assert "Out of date: their centred core differs by −10 %" in eccentric_core(body(33.4), file)[1]
    assert "Out of date" in eccentric_core(body(30.001), file)[1]
    assert "cannot be told" in eccentric_core(PaperResults(()), file)[1]
    assert "not there" in eccentric_core(PaperResults(()), file.parent / "none.csv")[0]


def test_the_kept_rows_have_what_is_quoted() -> None:
    told, _ = eccentric_core(PaperResults(()), PUBLISHED)
    assert "–" not in told and "nan" not in told
    # the scene's name says by how many percent of the wall the core is off
    assert {entry.scene for entry in read_rows(PUBLISHED)} >= {CENTRED, OFF}
    assert OFF.endswith(f"e{100.0 * SHARE:02.0f}")
