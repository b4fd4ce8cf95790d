"""Results written before columns and keys were renamed are read as those of today."""

from __future__ import annotations

import json
from pathlib import Path

from studies.results.rows import read_rows, row, write_rows
from studies.results.run_files import PATH_FILE, SUMMARY_FILE, read_path, read_summary


def test_the_model_was_called_rung(tmp_path: Path) -> None:
    file = tmp_path / "rows.csv"
    write_rows(file, [row("small", "tip_mm", "mm", 5.0, "axisymmetric", 1.5, "r1")])
    file.write_text(file.read_text(encoding="utf-8").replace(",model,", ",rung,"), encoding="utf-8")
    assert [r.model for r in read_rows(file)] == ["axisymmetric"]


def test_requested_states_were_called_asked(root: Path, tmp_path: Path) -> None:
    kept = next((root / "tests").rglob("path_of_an_older_run.csv"))
    (tmp_path / PATH_FILE).write_bytes(kept.read_bytes())
    assert {r.status for r in read_path(tmp_path)} == {"step", "requested"}


def test_a_summary_had_the_key_rung(root: Path, tmp_path: Path) -> None:
    kept = json.loads(next((root / "tests").rglob("summary_of_an_older_run.json")).read_text(encoding="utf-8"))
    assert "rung" in kept
    (tmp_path / SUMMARY_FILE).write_text(json.dumps(kept), encoding="utf-8")
    assert read_summary(tmp_path).model == kept["rung"]
