"""The stress test: verdicts of a few cells, the report about them, and a wrong answer that makes it fail."""

from __future__ import annotations

import dataclasses
import math

import pytest
from mpi4py import MPI

from analytical.exact.sphere import Sphere, limit_point
from analytical.laws.isotropic import NeoHooke
from analytical.laws.silicones import DRAGON_SKIN_10
from studies.engine import Solved, run
from studies.results.kept import read_kept
from studies.results.rows import read_rows
from studies.stability.cases import AXES, CONTROL, cases, controls, product
from studies.stability.cells import Bellows, Cell, Round
from studies.stability.exact import exact_answer
from studies.stability.judge import CRASH, Outcome
from studies.stability.run import Job, run_cell, run_in_child
from studies.stability.study import bars_of, job_of, key_of, stress_test

TUBE = Round("tube", along=1, through=2)
SPHERE = Round("sphere", along=4, through=2)
SOFTER = dataclasses.replace(TUBE, kappa_over_mu=100.0)


def outcome(cell: Cell) -> Outcome:
    return run_cell(cell, MPI.COMM_SELF)


def cell(body: Round | Bellows, load_kpa: float, **more) -> Cell:
    return Cell("kappa", "row", f"{load_kpa:g}", body, load_kpa, **more)


def test_there_are_enough_cells_and_values_and_each_has_its_place() -> None:
    every = product()
    assert len(every) >= 200
    assert {c.axis for c in every} == {axis.name for axis in AXES}
    assert len({(c.axis, c.row, c.column) for c in every}) == len(every)
    for axis in AXES:
        of = [c for c in every if c.axis == axis.name]
        assert len({c.column for c in of}) >= 5, axis
    assert all(
        a.flaw and dataclasses.replace(a, flaw="") == b for a, b in zip(controls()[::2], controls()[1::2], strict=True)
    )
    assert len({c.name for c in cases()}) == len(cases()) == len(every) + len(controls())


@pytest.mark.parametrize(
    ("body", "load_kpa"),
    [(TUBE, 20.0), (TUBE, -10.0), (SPHERE, 20.0), (SPHERE, -10.0), (SOFTER, 20.0)],
)
def test_right_answers(body: Round, load_kpa: float) -> None:
    found = outcome(cell(body, load_kpa))
    assert (found.verdict, found.share, found.reason) == ("right", 1.0, "")
    assert abs(found.error_percent) < 0.05
    assert found.pressure_error_percent < 5.0
    assert math.copysign(1.0, found.value_mm) == math.copysign(1.0, load_kpa)


def test_a_load_beyond_the_limit_point_is_a_stop_at_the_limit_point() -> None:
    body = dataclasses.replace(SPHERE, law=NeoHooke(0.05))
    limit = 1e3 * exact_answer(body, 0.1).reachable_mpa
    assert 20.0 < limit < 60.0
    found = outcome(cell(body, 100.0))
    assert (found.verdict, found.cause) == ("stop", "limit point")
    assert found.share == pytest.approx(1.0, abs=0.02)
    assert found.reason


def test_a_scene_or_a_mesh_that_cannot_be_is_refused_by_name() -> None:
    found = outcome(cell(Bellows((("geometry.wall_mm", -1.0),)), 5.0))
    assert (found.verdict, found.cause) == ("refusal", "SceneError")
    assert "geometry.wall_mm = -1.0" in found.reason
    folded = outcome(cell(dataclasses.replace(TUBE, along=3, through=3, noise=1.0, seed=1), 5.0))
    assert (folded.verdict, folded.cause) == ("refusal", "SolverError")
    assert "fold over" in folded.reason


def test_whatever_is_not_named_is_wrong(monkeypatch) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("nobody thought of it")

    monkeypatch.setattr("studies.stability.run.pose", broken)
    found = outcome(cell(TUBE, 5.0))
    assert (found.verdict, found.cause) == ("wrong", "crash")
    assert "nobody thought of it" in found.reason


@pytest.mark.parametrize(
    ("flaw", "body"),
    [
        ("raw energy", SOFTER),
        ("equal order", dataclasses.replace(TUBE, cells="triangles", along=4, through=4)),
    ],
)
def test_controls_fail_where_the_solver_is_right(flaw, body: Round) -> None:
    assert outcome(cell(body, 20.0)).verdict == "right"
    assert outcome(cell(body, 20.0, flaw=flaw)).verdict == "wrong"


def test_the_key_is_what_is_solved_and_not_where_it_is_drawn() -> None:
    one = cell(TUBE, 5.0)
    assert key_of(one) == key_of(dataclasses.replace(one, axis="noise", row="another", column="place"))
    others = (cell(TUBE, 5.1), cell(SPHERE, 5.0), dataclasses.replace(one, tolerance=1e-6))
    assert len({key_of(c) for c in (one, *others)}) == 4


def test_a_study_is_reported_and_done_once(tmp_path, monkeypatch) -> None:
    limited = dataclasses.replace(SPHERE, law=NeoHooke(0.05))
    some = [
        cell(TUBE, 10.0),
        cell(SPHERE, -10.0),
        cell(limited, 100.0),
        cell(Bellows((("geometry.wall_mm", -1.0),)), 5.0),
        Cell("ranks", "tube", "2 × 1", TUBE, 10.0, ranks=2),
    ]
    flawed = Cell(CONTROL, "tube", "κ/µ = 100", SOFTER, 20.0, flaw="raw energy")
    study = stress_test([*some, flawed, dataclasses.replace(flawed, flaw="")])
    assert run(study, tmp_path, MPI.COMM_SELF, {}) == 3  # too few cells
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "| at least 200 cells | 5 | NOT MET |" in text
    assert "| no wrong answer | 0 wrong | met |" in text
    assert "| controls fail where the solver is right | 1 of 1 | met |" in text
    assert "limit point" in text
    assert "geometry.wall_mm = -1.0" in text
    assert (tmp_path / "pictures" / "kappa.png").exists()
    rows = read_rows(tmp_path / "rows.csv")
    endings = [r.status.split(" ")[0].rstrip(":") for r in rows if r.quantity != "unstable_modes"]
    assert endings[:5] == ["reached", "reached", "stopped", "refused", "reached"]
    ranked = job_of(some[-1], [], tmp_path)
    found = read_kept(ranked.file, ranked.key, Outcome)
    assert found is not None and found.verdict == "right"
    assert found.value_mm == pytest.approx(outcome(cell(TUBE, 10.0)).value_mm, rel=1e-9)

    def again(*_: object) -> None:
        raise AssertionError("solved twice")

    monkeypatch.setattr("studies.stability.study.run_cell", again)
    monkeypatch.setattr("studies.mpi_children.run", again)
    assert run(study, tmp_path, MPI.COMM_SELF, {}) == 3
    assert read_rows(tmp_path / "rows.csv")[0].value == rows[0].value


def test_a_child_that_fails_is_a_crash_and_is_tried_again(tmp_path, monkeypatch) -> None:
    def no_mpirun(*_: object) -> None:
        raise FileNotFoundError("no such file: mpirun")

    job = Job(cell(TUBE, 10.0, ranks=2), None, math.nan, tmp_path / "cell.json", "key")
    monkeypatch.setattr("studies.mpi_children.run", no_mpirun)
    run_in_child([job], 2, 1, tmp_path)
    found = read_kept(job.file, job.key, Outcome)
    assert found is not None and job.missing
    assert (found.verdict, found.cause) == ("wrong", CRASH)
    assert found.reason == "2 ranks with 1 threads: no such file: mpirun"


def test_one_wrong_answer_makes_the_study_fail() -> None:
    right = [Solved(c, Outcome("right", share=1.0, error_percent=0.1)) for c in product()]
    assert all(bar.met for bar in bars_of(right, []))
    wrong = Solved(right[0].case, Outcome("wrong", cause="wrong answer", reason="3 % off"))
    assert [bar.wanted for bar in bars_of([wrong, *right[1:]], []) if not bar.met] == ["no wrong answer"]
    early = Solved(right[0].case, Outcome("stop", share=0.3))
    assert not all(bar.met for bar in bars_of([early, *right[1:]], []))
    named = Solved(right[0].case, Outcome("stop", share=0.3, cause="inverted cell", reason="at the seat"))
    assert all(bar.met for bar in bars_of([named, *right[1:]], []))


def test_exact_answers_know_how_far_a_body_can_be_loaded() -> None:
    body = Round("sphere", NeoHooke(0.05))
    beyond = exact_answer(body, 10.0)
    assert math.isnan(beyond.bore_mm)
    limit = limit_point(Sphere(5.0, 7.0), NeoHooke(0.05))
    assert limit is not None
    assert beyond.reachable_mpa == pytest.approx(limit.pressure_mpa, rel=1e-6)
    assert exact_answer(dataclasses.replace(body, law=DRAGON_SKIN_10), 0.02).reachable_mpa == 0.02
