"""Generated inputs: the same from a seed, judged so that what is wrong is found, and a short run of them."""

from __future__ import annotations

import dataclasses
import os
import pickle
import signal
import sys
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from mpi4py import MPI

from meshes.bodies import tube_meridian
from meshes.by_gmsh.user_mesh import read_user_mesh
from studies import mpi_children
from studies.engine import Setting, Solved, run
from studies.fuzz import judge
from studies.fuzz.draws import KINDS, Draw, draws
from studies.fuzz.judge import Ended, Outcome, judged, not_an_answer
from studies.fuzz.meshfiles import gmsh_file
from studies.fuzz.mutate import damaged
from studies.fuzz.run import Job, broken, command_line, run_draw, run_in_children
from studies.fuzz.study import STUDY, bars_of, page
from studies.progress import Progress
from studies.results.rows import read_rows, write_rows
from studies.stability.tables import generated

ROOT = Path(__file__).resolve().parents[3]
TUBE = (ROOT / "scenes" / "exact" / "tube.toml").read_bytes()
BONDED = TUBE.replace(b'ends = "plane-strain"', b'ends = "bonded"').replace(b"percent = 0.1", b"percent = 2.0")


def drawn(text: bytes, **more) -> Draw:
    return Draw("0-0001", "tube", "solve", text, **more)


# ---- what is drawn -----------------------------------------------------------------------------------------


def test_a_seed_gives_the_same_inputs_again_and_more_of_them_begin_alike() -> None:
    assert draws(6, 3) == draws(9, 3)[:6]
    assert {draw.text for draw in draws(6, 3)}.isdisjoint(draw.text for draw in draws(6, 4))
    assert sum(share for share, _ in KINDS.values()) == 100


def test_damage_changes_a_file_mostly_and_never_breaks_on_it() -> None:
    found: list[bytes] = []

    @settings(max_examples=60, database=None, deadline=None, derandomize=True)
    @given(damaged(TUBE))
    def collect(text: bytes) -> None:
        found.append(text)

    collect()
    assert sum(text != TUBE for text in found) > 0.8 * len(found)
    assert len(set(found)) > 0.5 * len(found)


def test_a_drawn_mesh_is_what_it_was_made_from(tmp_path: Path) -> None:
    mesh, file = tube_meridian(3.0, 4.0, 1.0, 2, 3), tmp_path / "body.msh"
    file.write_bytes(gmsh_file(mesh))
    back = read_user_mesh(file)
    assert back.points == pytest.approx(mesh.points, abs=1e-11)
    assert sorted(map(sorted, back.cells.tolist())) == sorted(map(sorted, mesh.cells.tolist()))
    assert sorted(back.facet_tags) == sorted(mesh.facet_tags)


# ---- how it is judged --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("ended", "verdict"),
    [
        (Ended(2, "", "a.toml: geometry.wall_mm = -1: must be greater than 0 mm", True), "refused"),
        (Ended(2, "", "a.toml: geometry.wall_mm = -1: must be greater than 0 mm", False), "wrong"),
        (Ended(2, "", "no", True), "wrong"),
        (Ended(2, "", "", True), "crash"),
        (Ended(3, "", "a: stopped early: limit point at 3.2 kPa: the pressure has a maximum"), "stopped"),
        (Ended(3, "", "a: float division by zero"), "crash"),
        (Ended(3, "", "a: stopped early: step size\nx.py:3: RuntimeWarning: overflow encountered in exp"), "crash"),
        (Ended(0, "kPa", "x.py:3: RuntimeWarning: invalid value encountered in divide"), "crash"),
        (Ended(1, "", "Traceback (most recent call last):\nKeyError: 3"), "crash"),
        (Ended(0, "kPa", ""), None),
    ],
)
def test_a_command_without_an_answer(ended: Ended, verdict: str | None) -> None:
    outcome = not_an_answer(ended)
    assert (None if outcome is None else outcome.verdict) == verdict


def test_a_right_answer_is_confirmed_by_the_exact_one_and_a_refusal_touches_nothing() -> None:
    outcome = run_draw(drawn(TUBE))
    assert (outcome.verdict, outcome.reason) == ("right", "exact")
    assert 0.0 < outcome.error_percent < 0.1
    refused = run_draw(drawn(TUBE.replace(b"outer_radius_mm = 7.0", b"outer_radius_mm = 4.0")))
    assert refused.verdict == "refused" and "geometry.inner_radius_mm = 5" in refused.reason


def test_an_answer_without_an_exact_one_is_confirmed_by_other_cells() -> None:
    outcome = run_draw(drawn(BONDED))
    assert (outcome.verdict, outcome.reason) == ("right", "second model")


@pytest.mark.parametrize("model", ["exact", "second model"])
def test_a_contradicted_answer_is_wrong(monkeypatch, model: str) -> None:
    def shifted(path: Path):
        first = path.parent.name == "first"
        return [dataclasses.replace(r, value=1.2 * r.value if first else r.value) for r in read_rows(path)]

    monkeypatch.setattr(judge, "read_rows", shifted)
    outcome = run_draw(drawn(TUBE if model == "exact" else BONDED))
    assert outcome.verdict == "wrong" and model in outcome.reason
    assert 14.0 < outcome.error_percent < 20.0  # 1/6, and what the cells differ by


def test_an_answer_that_nothing_confirms_is_wrong(tmp_path: Path) -> None:
    """A folder of one mesh, and second models that all refuse."""
    solved: list[str] = []

    def solve(text: bytes, name: str, command: str = "solve", model: str = ""):
        out = tmp_path / name
        (tmp_path / f"{name}.toml").write_bytes(BONDED)
        out.mkdir()
        solved.append(name)
        if name != "first":
            return Ended(2, "", "no"), out
        head = "scene,quantity,unit,pressure_kpa,model,level,value,uncertainty,reference,source,error_percent,status"
        lines = [f"tube,bore_mm,mm,{load},axisymmetric,r1,1.0,,,,,reached" for load in (10, 20, 30)]
        (out / "rows.csv").write_text("\n".join([head, *lines, ""]), encoding="utf-8")
        return Ended(0, "", ""), out

    outcome = judged(drawn(BONDED), solve)
    assert (outcome.verdict, solved) == ("wrong", ["first", "second", "second", "second"])
    assert "nothing confirms it" in outcome.reason


def test_the_command_line_is_heard_to_the_last_byte(capfd) -> None:
    ended = command_line("plan", str(ROOT / "scenes" / "exact" / "tube.toml"))
    assert ended.code == 0 and "answer: axisymmetric, bore_mm" in ended.out
    assert command_line("solve", "nowhere.toml", "--out", "x").code == 2
    print("and nothing else is swallowed")
    assert capfd.readouterr().out == "and nothing else is swallowed\n"


# ---- children ----------------------------------------------------------------------------------------------


class Fatal:
    """What ends the process that reads it."""

    def __reduce__(self):
        return os.abort, ()


def test_a_child_that_dies_costs_one_input_and_the_others_go_on(tmp_path: Path) -> None:
    bad = drawn(TUBE.replace(b"= 7.0", b"= -7.0"))
    fatal = dataclasses.replace(bad, text=Fatal())  # type: ignore[arg-type]
    jobs = [Job(draw, tmp_path / f"{k}.json", "key") for k, draw in enumerate((fatal, bad))]
    told: list[str] = []
    run_in_children(jobs, tmp_path / "order", lambda job, outcome: told.append(outcome.verdict))
    assert told == ["crash", "refused"]
    assert jobs[0].outcome is not None and "SIGABRT" in jobs[0].outcome.reason
    assert not (tmp_path / "order").exists()
    run_in_children(jobs, tmp_path / "order", lambda job, outcome: told.append("again"))
    assert len(told) == 2  # both are kept


@pytest.mark.parametrize(("limit", "ended_by"), [("LIMIT_S", signal.SIGPROF), ("LIMIT_CLOCK_S", signal.SIGALRM)])
def test_what_takes_too_long_ends_the_child_by_a_timer(tmp_path: Path, limit: str, ended_by: signal.Signals) -> None:
    order = tmp_path / "order"
    order.write_bytes(pickle.dumps([Job(drawn(TUBE), tmp_path / "0.json", "key")]))
    for_ever = "while True: pass" if limit == "LIMIT_S" else "import time; time.sleep(100)"
    code = (
        f"import sys, pathlib; from studies.fuzz import run; run.{limit} = 1.0; "
        f"run.run_draw = lambda draw: exec({for_ever!r}); run._child(pathlib.Path(sys.argv[1]))"
    )
    ended = mpi_children.run([sys.executable, "-c", code, str(order)], mpi_children.environment(), 90.0)
    assert ended.code == -ended_by
    assert broken(ended.code, ended.error).verdict == "time out"


# ---- the study ---------------------------------------------------------------------------------------------

# Bodies in 3D and second runs of large meshes are left to `make fuzz`.
QUICK = ("bellows", "tube", "sphere", "damaged scene", "damaged .msh", "mesh", "block", "damaged sweep")


def setting(out: Path) -> Setting:
    return Setting(out, MPI.COMM_SELF, Progress(MPI.COMM_SELF), {"seed": 1, "draws": 3})


def test_the_page_has_the_split_and_a_failure_makes_it_fail(tmp_path: Path) -> None:
    ended = [
        Solved(dataclasses.replace(drawn(TUBE), name=f"1-{k}"), outcome)
        for k, outcome in enumerate(
            (Outcome("right", "exact", 0.01), Outcome("refused", "x = 1"), Outcome("stopped", "y"))
        )
    ]
    assert not any(bar.missed for bar in bars_of(ended))
    rows = page(ended, setting(tmp_path)).rows
    assert [row.status.partition(":")[0] for row in rows] == ["reached", "refused", "stopped"]
    write_rows(tmp_path / "rows.csv", rows)
    counts = generated(tmp_path / "rows.csv")
    assert counts == "3 inputs: 1 right, 1 refused, 1 stopped, 0 wrong, 0 crash, 0 time out"
    assert generated(tmp_path / "none.csv") == ""
    for verdict in ("wrong", "crash", "time out"):
        failed = Solved(drawn(TUBE), Outcome(verdict, "why"))  # type: ignore[arg-type]
        assert [bar.wanted for bar in bars_of([*ended, failed]) if bar.missed] == [f"no draw ends as: {verdict}"]


def test_a_short_run_ends_well_and_is_not_repeated(tmp_path: Path) -> None:
    some = [draw for draw in draws(26, 1) if draw.kind in QUICK and not draw.model]
    assert len(some) >= 20
    study = dataclasses.replace(STUDY, cases=lambda options: some)
    begin = time.perf_counter()
    assert run(study, tmp_path, MPI.COMM_SELF, {"seed": 1, "draws": 26}) == 0, (tmp_path / "report.md").read_text()
    first = time.perf_counter() - begin
    verdicts = {row.status.partition(":")[0] for row in read_rows(tmp_path / "rows.csv")}
    assert verdicts == {"reached", "refused", "stopped"}
    begin = time.perf_counter()
    assert run(study, tmp_path, MPI.COMM_SELF, {"seed": 1, "draws": 26}) == 0
    assert time.perf_counter() - begin < 0.2 * first
