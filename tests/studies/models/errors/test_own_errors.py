"""Runs that tell the error of their own mesh: what it is held against, where it is not asked, what is made of it."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest
from mpi4py import MPI

from solvers.errors import StepFailed
from solvers.estimate.enriched import Enriched
from studies.models.axisymmetric import run_axisymmetric
from studies.models.contact import MODELLED
from studies.models.errors.runs import with_errors
from studies.planning.planner import make_plan
from studies.progress import Progress
from studies.results import provenance
from studies.results.runs import MERIDIAN_ORDERS, Run, own_errors_percent, read_run, tip_convergence
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows

SCENE = load_bellows(provenance.ROOT / "scenes" / "smoke-t2-ri5.toml")


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Run]]:
    folder, show = tmp_path_factory.mktemp("runs"), Progress(MPI.COMM_SELF)
    return folder, [run_axisymmetric(SCENE, n, folder / f"r{n}", MPI.COMM_SELF, show) for n in (1, 2, 4)]


def test_a_run_tells_the_error_of_its_tips(runs: tuple[Path, list[Run]]) -> None:
    folder, (coarse, *finer) = runs
    told = with_errors(SCENE, folder / "r1", coarse)
    again = [row.tip_error_mm for row in read_run(folder / "r1").requested]
    assert again == pytest.approx([row.tip_error_mm for row in told.requested], rel=1e-9)
    for row in told.requested:
        limit = tip_convergence([coarse, *finer], row.pressure_kpa, MERIDIAN_ORDERS).limit
        assert 0.5 < row.tip_error_mm / (limit - row.tip_mm) < 1.0  # unresolved edges: too small
        own = tip_convergence([told], row.pressure_kpa, MERIDIAN_ORDERS)
        assert own.uncertainty(row.tip_mm) >= 2.0 * abs(row.tip_error_mm)
        assert own.uncertainty(row.tip_mm) > abs(limit - row.tip_mm)
    assert all(math.isnan(row.tip_error_mm) for row in told.path if row.status != "requested")


def test_what_is_told_is_kept(runs: tuple[Path, list[Run]], monkeypatch: pytest.MonkeyPatch) -> None:
    folder, (coarse, *_) = runs
    told = with_errors(SCENE, folder / "r1", coarse)
    monkeypatch.delattr(Enriched, "equilibrium")
    assert with_errors(SCENE, folder / "r1", told) is told


@pytest.mark.parametrize("change", [{"plan": (f"{MODELLED} beyond 3 kPa",)}, {"status": "stopped"}])
def test_contact_and_stopped_runs_tell_nothing(runs: tuple[Path, list[Run]], change: dict[str, object]) -> None:
    folder, (coarse, *_) = runs
    other = dataclasses.replace(coarse, summary=dataclasses.replace(coarse.summary, **change))  # type: ignore[arg-type]
    assert with_errors(SCENE, folder / "r1", other) is other


def test_without_a_richer_equilibrium_nothing_is_certain(
    runs: tuple[Path, list[Run]], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def fails(*_: object) -> None:
        raise StepFailed("no convergence")

    monkeypatch.setattr(Enriched, "equilibrium", fails)
    blank = run_axisymmetric(SCENE, 1, tmp_path, MPI.COMM_SELF, Progress(MPI.COMM_SELF))
    told = with_errors(SCENE, tmp_path, blank)
    assert math.isnan(tip_convergence([told], 10.0, MERIDIAN_ORDERS).uncertainty(told.path[-1].tip_mm))


def test_a_tip_that_does_not_move_has_no_relative_error(runs: tuple[Path, list[Run]]) -> None:
    coarse = runs[1][0]
    held = tuple(dataclasses.replace(row, tip_mm=0.0, tip_error_mm=0.0) for row in coarse.path)
    assert all(map(math.isnan, own_errors_percent(dataclasses.replace(coarse, path=held))))


def changed(**tables: dict[str, object]) -> BellowsScene:
    given = {table: getattr(SCENE, table).model_copy(update=values) for table, values in tables.items()}
    return SCENE.model_copy(update=given)


def test_only_scenes_of_kinds_that_were_compared_have_one_mesh() -> None:
    assert make_plan(SCENE).one_mesh and make_plan(SCENE).certain == ("r1",)
    others = [
        changed(load={"tip": "blocked"}),
        changed(load={"tip_force_n": 0.1}),
        changed(load={"pressure_kpa": [-1.0]}),
        changed(rings={"model": "meshed"}),
        changed(rings={"bond": "adhesive"}),
        changed(geometry={"tip": "rigid"}),
        changed(geometry={"crest_radius_mm": 8.0}),  # 1.5 walls deep
        changed(ask={"tolerance_percent": 0.01}),  # begins on r2
    ]
    for scene in others:
        assert not make_plan(scene).one_mesh
    assert make_plan(SCENE, "full3d").certain == ("r1",)
    assert make_plan(SCENE, "axisymmetric").certain == ("r1", "r2", "r4")
