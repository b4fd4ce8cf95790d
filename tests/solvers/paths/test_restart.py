"""Checkpoints: a path goes on after its last state with the same steps, on any number of ranks."""

from __future__ import annotations

import dataclasses
import json
import os
from pathlib import Path

import numpy as np
import pytest

from solvers.errors import Cause
from solvers.paths.checkpoint import CheckpointError, read_checkpoint, write_checkpoint
from solvers.paths.path import follow_path
from solvers.paths.states import Crossing, PathMemory, PathSettings

SCRIPT = Path(__file__).with_name("restart_script.py")
ASKED = [0.005, 0.010]


def test_restart_on_another_number_of_ranks(python, tmp_path: Path) -> None:
    file = tmp_path / "checkpoint.npz"
    whole = python.answer(1, SCRIPT, "whole", tmp_path / "unused.npz")
    python.run(1, SCRIPT, "stop", file)
    kept = file.read_bytes()
    for ranks in (1, 2):
        file.write_bytes(kept)
        found = python.answer(ranks, SCRIPT, "go", file)
        assert (found["ranks"], found["solved"], whole["solved"]) == (ranks, 1, 2)
        assert found["counts"] == whole["counts"]
        for name in ("displacement", "pressure", "bodies", "volume_energy_reaction"):
            # asked 1e-12 on the same number of ranks, 1e-9 on another: sums in another order, Newton to 1e-11
            assert found[name] == pytest.approx(whole[name], rel=1e-12 if ranks == 1 else 1e-9, abs=1e-12), name


@pytest.fixture(scope="module")
def memories(bellows_problem) -> list[PathMemory]:
    """What a path hands out after each of its steps."""
    case = bellows_problem(2)
    out: list[PathMemory] = []
    path = follow_path(case.problem, case.factor, ASKED, PathSettings(), on_step=out.append)
    assert path.reached and len(out) >= 4
    return out


def test_path_resumed_after_any_step_is_the_same_to_the_last_bit(bellows_problem, memories, tmp_path: Path) -> None:
    case = bellows_problem(2)
    whole = follow_path(case.problem, case.factor, ASKED, PathSettings())
    for memory in memories:
        write_checkpoint(tmp_path / "c.npz", "bellows", memory, {"a": [1, 2.5]})
        found = read_checkpoint(tmp_path / "c.npz", "bellows")
        assert found is not None
        resume, notes = found
        assert notes == {"a": [1, 2.5]}
        assert isinstance(resume, PathMemory)
        path = follow_path(case.problem, case.factor, ASKED, PathSettings(), resume=resume)
        assert path.reached
        assert path.rejected == whole.rejected
        after = [s for s in whole.states if s.volume_mm3 > memory.history[-1].volume_mm3]
        assert len(path.states) == len(after)
        for a, b in zip(path.states, after, strict=True):
            assert np.array_equal(a.state.displacement_mm, b.state.displacement_mm)
            assert np.array_equal(a.state.pressure_mpa, b.state.pressure_mpa)
            assert np.array_equal(a.state.bodies_mm, b.state.bodies_mm)
            assert a.newton == b.newton
            assert (a.control, a.asked, a.energy_mj) == (b.control, b.asked, b.energy_mj)


def test_crossing_is_kept_as_numbers(memories, tmp_path: Path) -> None:
    crossing = Crossing(Cause.BIFURCATION, 0.1, 1e-6, 3.0, 0, 2)
    write_checkpoint(tmp_path / "c.npz", "x", dataclasses.replace(memories[0], crossing=crossing), None)
    found = read_checkpoint(tmp_path / "c.npz", "x")
    assert found is not None and found[0].crossing == crossing


def test_missing_foreign_and_truncated_checkpoints(memories, tmp_path: Path) -> None:
    file = tmp_path / "c.npz"
    assert read_checkpoint(file, "x") is None
    write_checkpoint(file, "x", memories[-1], None)
    with pytest.raises(CheckpointError, match="belongs to another"):
        read_checkpoint(file, "y")
    content = file.read_bytes()
    for length in (0, 1, 100, len(content) // 2, len(content) - 1):
        file.write_bytes(content[:length])
        with pytest.raises(CheckpointError, match=r"c\.npz: damaged, not used"):
            read_checkpoint(file, "x")


def test_whole_file_of_another_format_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "c.npz"
    state = {"0.displacement_mm": np.zeros((1, 2)), "0.pressure_mpa": np.zeros(1), "0.bodies_mm": np.zeros((0, 0))}
    point = {"volume_mm3": 1.0, "compliance_mm3_per_mpa": 1.0, "unstable": 0}
    whole: dict[str, object] = {"label": "x", "reached": 0, "rejected": 0, "crossing": None, "notes": None}
    others: list[object] = [{}, [], whole, {**whole, "kind": "guesses", "points": [point], "share": 1.0}]
    for facts in others:
        np.savez(file, facts=json.dumps(facts), **state, **{"0.load_mpa": 0.0})
        with pytest.raises(CheckpointError, match=r"c\.npz: damaged, not used"):
            read_checkpoint(file, "x")


def test_failed_write_leaves_the_old_checkpoint(memories, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "c.npz"
    write_checkpoint(file, "x", memories[0], "old")

    def full(*_):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", full)
        with pytest.raises(OSError, match="No space left on device") as error:
            write_checkpoint(file, "x", memories[1], "new")
    assert str(error.value.filename) == str(file)
    found = read_checkpoint(file, "x")
    assert found is not None and found[1] == "old"
