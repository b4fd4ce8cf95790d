"""The engine of studies: order of cases, faults, stops, bars, exit codes, what is kept."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import pytest
from click.testing import CliRunner
from mpi4py import MPI

from solvers.errors import SolverError
from studies import progress
from studies.catalogue import STUDIES, load_study
from studies.command.study import command_of, study
from studies.engine import Bar, Page, Setting, Solved, Study, run
from studies.results.kept import content_key, keep, kept, read_kept
from studies.results.rows import read_rows, row
from studies.scene.sections import SceneError


@dataclass(frozen=True)
class Case:
    name: str
    value: float


def solve(case: Case, at: Setting) -> float:
    if math.isnan(case.value):
        raise SolverError("no such number")
    return case.value**2


def page(solved: Sequence[Solved[Case, float]], at: Setting) -> Page:
    (at.out / "pictures" / "contractions.png").write_bytes(b"drawn")
    rows = [row(s.case.name, "square", "1", math.nan, "closed_form", s.result) for s in solved]
    total = sum(s.result for s in solved)
    stopped = ["one: stopped"] if at.options.get("stop") else []
    return Page(
        rows,
        {"sections": []},
        stopped,
        [Bar("total of at least 5", f"{total:g}", total >= 5.0)],
        headlines=[f"total: {total:g}"],
    )


def study_of(*values: float, share: Literal["each", "all", "first"] = "each") -> Study[Case, float]:
    def cases(options: Mapping[str, Any]) -> list[Case]:
        return [Case(f"case-{k}", value) for k, value in enumerate(values)]

    # the template of the vacuum study shows whatever sections there are
    return Study("squares", "Squares", "How large?", "vacuum/page.md.j2", cases, solve, page, share)


@pytest.mark.parametrize("share", ["each", "all", "first"])
def test_rows_come_in_the_order_of_the_cases(
    share: Literal["each", "all", "first"], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert run(study_of(1.0, 2.0, 3.0, share=share), tmp_path, MPI.COMM_WORLD, {}) == 0
    assert [(r.scene, r.value) for r in read_rows(tmp_path / "rows.csv")] == [
        ("case-0", 1.0),
        ("case-1", 4.0),
        ("case-2", 9.0),
    ]
    assert capfd.readouterr().out.startswith("total: 14\nreport: ")
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "# Squares" in text and "| total of at least 5 | 14 | met |" in text and "Stopped early" not in text


def test_a_failed_case_is_named_and_the_others_go_on(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(study_of(3.0, math.nan), tmp_path, MPI.COMM_WORLD, {}) == 3
    assert "case-1: no such number" in capfd.readouterr().err
    assert "- case-1: no such number" in (tmp_path / "report.md").read_text(encoding="utf-8")
    assert len(read_rows(tmp_path / "rows.csv")) == 1


def test_a_stop_and_a_bar_that_is_not_met_give_exit_code_3(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert run(study_of(3.0), tmp_path, MPI.COMM_WORLD, {"stop": True}) == 3
    assert "one: stopped" in capfd.readouterr().err
    assert run(study_of(1.0), tmp_path, MPI.COMM_WORLD, {}) == 3
    assert "not met: total of at least 5: 1" in capfd.readouterr().err
    assert "| total of at least 5 | 1 | NOT MET |" in (tmp_path / "report.md").read_text(encoding="utf-8")


def test_bad_cases_are_refused_with_nothing_written(tmp_path: Path) -> None:
    def refuse(options: Mapping[str, Any]) -> list[Case]:
        raise SceneError("scene x: no wall")

    command = command_of(dataclasses.replace(study_of(1.0), cases=refuse))
    done = CliRunner().invoke(command, ["--out", str(tmp_path / "new")])
    assert done.exit_code == 2 and "scene x: no wall" in done.output
    assert not (tmp_path / "new").exists()


def test_output_that_cannot_be_written_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    done = CliRunner().invoke(command_of(study_of(1.0)), ["--out", str(tmp_path / "file" / "out")])
    assert done.exit_code == 2 and "is not a folder that can be written to" in done.output


def test_values_are_kept_under_what_decides_them(tmp_path: Path) -> None:
    file, case = tmp_path / "deep" / "case.json", Case("a", math.nan)
    keep(file, content_key(case, 1), case)
    found = read_kept(file, content_key(case, 1), Case)
    assert found is not None and found.name == "a" and math.isnan(found.value)
    assert read_kept(file, content_key(case, 2), Case) is None
    made: list[Case] = []

    def make() -> Case:
        made.append(Case("b", 2.0))
        return made[-1]

    assert [kept(file, content_key(3), Case, make) for _ in range(2)] == [Case("b", 2.0)] * 2
    assert len(made) == 1
    file.write_text(file.read_text(encoding="utf-8")[:-9], encoding="utf-8")
    assert read_kept(file, content_key(3), Case) is None


def test_keys_change_with_content_and_sources(tmp_path: Path) -> None:
    source = tmp_path / "a.py"
    source.write_text("1", encoding="utf-8")
    keys = {content_key(Case("a", 1.0)), content_key(Case("a", 2.0)), content_key(Case("a", 1.0), sources=[source])}
    source.write_text("2", encoding="utf-8")
    keys.add(content_key(Case("a", 1.0), sources=[source]))
    assert len(keys) == 4


@pytest.mark.parametrize("name", STUDIES)
def test_every_study_loads_and_asks_a_question(name: str, root: Path) -> None:
    found = load_study(name)
    assert found.name == name
    assert found.question.endswith("?")
    assert (root / "studies" / found.template).exists()
    assert CliRunner().invoke(study, [name, "--help"]).exit_code == 0


def test_the_list_has_every_study() -> None:
    listed = CliRunner().invoke(study, ["--list"]).output
    assert all(f"{name} " in listed and load_study(name).question in listed for name in STUDIES)


def test_a_log_has_the_cases_and_how_long_the_rest_may_take(monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    monkeypatch.setattr(progress, "LOG_EVERY_S", 0.0)
    shown = progress.Progress(MPI.COMM_SELF)
    for place in (1, 2, 3):
        shown.case(place, 3, f"c{place}")
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "case 1 of 3, c1"
    assert re.fullmatch(r"case 3 of 3, c3; \S+ s so far, about \S+ s left", lines[2])
    monkeypatch.setattr(progress, "LOG_EVERY_S", 60.0)
    shown.case(3, 3, "c3")
    assert capsys.readouterr().err == ""


def test_the_first_of_many_cases_foretell_nothing(monkeypatch: pytest.MonkeyPatch, capsys) -> None:
    monkeypatch.setattr(progress, "LOG_EVERY_S", 0.0)
    shown = progress.Progress(MPI.COMM_SELF)
    shown.tell("meridians: 12")
    for place in (1, 2, 30):
        shown.case(place, 100, f"c{place}")
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "meridians: 12"
    assert lines[2].endswith("so far") and lines[3].endswith("left")
