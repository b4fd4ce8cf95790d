"""The kept reports of docs: from one code, from clean trees, with their rows and pictures beside them."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[1] / "docs"
REPORTS = sorted(DOCS.glob("*/report.md"))
CODE = "code that decides the numbers"
# Of run times, which need a machine for themselves for hours: of another code if need be, which they name.
TIMED = {"cost", "error-model", "large", "peers", "stacks"}


def fact(report: Path, name: str) -> str:
    """A value of the table of a report's provenance."""
    found = re.search(rf"^\| {re.escape(name)} \| (.+) \|$", report.read_text(encoding="utf-8"), re.MULTILINE)
    assert found, f"{report}: no {name}"
    return found[1]


def test_all_reports_of_values_are_of_one_code_and_all_of_a_clean_tree() -> None:
    assert len(REPORTS) > 10
    codes = {report.parent.name: fact(report, CODE) for report in REPORTS if report.parent.name not in TIMED}
    assert len(set(codes.values())) == 1, codes
    dirty = [report.parent.name for report in REPORTS if not re.fullmatch("[0-9a-f]{12}", fact(report, "commit"))]
    assert dirty == []


@pytest.mark.parametrize("report", REPORTS, ids=lambda path: path.parent.name)
def test_what_a_report_links_is_beside_it(report: Path) -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", report.read_text(encoding="utf-8"))
    assert [link for link in links if not (report.parent / link).exists()] == []


@pytest.mark.parametrize("report", REPORTS, ids=lambda path: path.parent.name)
def test_rows_are_whole(report: Path) -> None:
    with (report.parent / "rows.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows
    assert {row["status"] for row in rows} != {""}
    assert all(row["scene"] and row["quantity"] and row["model"] for row in rows)
