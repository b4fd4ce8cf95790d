"""Scenes that ask for the iterative solver, and bodies whose factors do not fit."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from mpi4py import MPI

from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.linear.krylov import IterativeSolver
from solvers.problem import Problem
from studies.models import full3d
from studies.models.axisymmetric import run_axisymmetric
from studies.planning.levels import BodyLevel
from studies.progress import Progress
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows, load_scene
from studies.scene.sections import SceneError

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def small(tmp_path) -> BellowsScene:
    text = (ROOT / "scenes" / "smoke-t2-ri5.toml").read_text(encoding="utf-8")
    scene = load_bellows(_written(tmp_path / "small.toml", text))
    geometry = scene.geometry.model_copy(update={"convolutions": 1})
    return scene.model_copy(
        update={"geometry": geometry, "load": scene.load.model_copy(update={"pressure_kpa": [2.0]})}
    )


def _written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def test_where_factors_do_not_fit_the_body_is_solved_iteratively(small, tmp_path, monkeypatch) -> None:
    comm, progress = MPI.COMM_SELF, Progress(MPI.COMM_SELF)
    run_axisymmetric(small, 1, tmp_path / "flat", comm, progress)
    level = BodyLevel(6)

    def body(name: str) -> full3d.Run:
        return full3d.run_full3d(small, "full3d", level, tmp_path / "flat", tmp_path / name, comm, progress, ())

    whole, made = body("direct"), []

    class Kept(IterativeSolver):
        def __init__(self, problem: Problem) -> None:
            super().__init__(problem)
            made.append(self)

    monkeypatch.setattr(full3d, "Factor", _NoFactor)
    monkeypatch.setattr(full3d, "IterativeSolver", Kept)
    found = body("auto")
    assert found.summary.status == "reached"
    assert found.path[-1].tip_mm == pytest.approx(whole.path[-1].tip_mm, rel=1e-6)
    assert [row.unstable_modes for row in whole.path] == [0.0]
    assert math.isnan(found.path[-1].unstable_modes)
    assert any("solved iteratively from there" in note for note in found.summary.plan)
    assert full3d.NOT_COUNTED in found.summary.plan
    assert full3d.NOT_COUNTED not in whole.summary.plan
    # the factorisation that ran out of memory was one
    assert found.summary.factorisations == made[0].count + 1


class _NoFactor(Factor):
    """A factorisation that no memory holds."""

    def refresh(self) -> None:
        self.count += 1
        raise StepFailed("MUMPS failed with INFOG(1) = -13", Cause.OUT_OF_MEMORY)


def test_small_bodies_and_linear_elements_are_not_solved_iteratively(tmp_path) -> None:
    exact = (ROOT / "scenes" / "exact" / "tube.toml").read_text(encoding="utf-8")
    bellows = (ROOT / "scenes" / "smoke-t2-ri5.toml").read_text(encoding="utf-8")
    assert "[mesh]" not in bellows
    for text, said in (
        (exact.replace("[mesh]\n", '[mesh]\nsolver = "iterative"\n'), "small and factorised"),
        (bellows + '\n[mesh]\nsolver = "iterative"\nelement = "tet-p1"\n', "made for quadratic elements"),
    ):
        with pytest.raises(SceneError, match=said):
            load_scene(_written(tmp_path / "scene.toml", text))
