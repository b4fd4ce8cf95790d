"""Contact in runs of scenes: from first touch, not before; restarts; and bellows under vacuum."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

import studies.models.contact
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.forces import reaction
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.linear.factor import Factor
from studies.models.axisymmetric import run_axisymmetric
from studies.models.build import Tip, scene_problem
from studies.models.contact import CONTACT_FILE, LIMIT, MODELLED, read_reports, scene_contact
from studies.models.run_log import CONTACT, Log
from studies.progress import Progress
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene, Contact
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_meridian

WALL_MM = 2.0


@pytest.fixture(scope="module")
def smoke(root: Path) -> BellowsScene:
    return load_bellows(root / "scenes" / "smoke-t2-ri5.toml")


def changed(scene: BellowsScene, pressures_kpa: list[float], model: str = "auto", **load: object) -> BellowsScene:
    new = scene.load.model_copy(update={"pressure_kpa": pressures_kpa, **load})
    return scene.model_copy(update={"load": new, "contact": Contact.model_validate({"model": model})})


def solved(scene: BellowsScene, folder: Path) -> Run:
    return run_axisymmetric(scene, 1, folder, MPI.COMM_WORLD, Progress(MPI.COMM_WORLD))


@pytest.fixture(scope="module")
def blocked(smoke: BellowsScene, tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, Path]:
    """The actuator with its tip held: its folds swell sideways and touch."""
    folder = tmp_path_factory.mktemp("blocked")
    return solved(changed(smoke, [9.0, 14.0], tip="blocked"), folder), folder


def test_contact_comes_with_the_first_touch_and_holds(blocked: tuple[Run, Path], smoke: BellowsScene) -> None:
    run, folder = blocked
    assert run.summary.status == "reached", run.summary.reason
    (note,) = [n for n in run.summary.plan if n.startswith(MODELLED)]
    assert "touch first between" in note
    low, high = run.path[0], run.path[-1]
    assert low.status == high.status == "requested"
    assert low.min_gap_mm > 0.1
    assert -LIMIT * WALL_MM < high.min_gap_mm < 0.01 * WALL_MM
    assert high.unstable_modes == 0.0
    reports = {r["what"]: r for r in read_reports(folder / CONTACT_FILE) if r["pressure_kpa"] == "14"}
    assert float(reports["folds outside"]["force_n"]) > 0.1
    assert not any(float(reports[name]["force_n"]) for name in reports if name != "folds outside")
    # contact is between parts of the actuator: what holds its two ends still balances the pressure
    area = np.pi * smoke.geometry.crest_radius_mm**2
    for entry in (low, high):
        assert entry.reaction_n + 1e-3 * entry.pressure_kpa * area == pytest.approx(entry.tip_force_n, rel=1e-6)


def test_without_contact_folds_go_into_each_other(
    blocked: tuple[Run, Path], smoke: BellowsScene, tmp_path: Path
) -> None:
    run = solved(changed(smoke, [9.0, 14.0], "off", tip="blocked"), tmp_path)
    assert run.path[0].tip_force_n == pytest.approx(blocked[0].path[0].tip_force_n, rel=1e-9)
    assert any(n.startswith(CONTACT) for n in run.summary.plan)
    deepest = min(entry.min_gap_mm for entry in run.path)
    assert deepest < -LIMIT * WALL_MM
    assert not (tmp_path / CONTACT_FILE).exists()


def test_a_run_that_was_interrupted_in_contact_goes_on_as_if_not(
    blocked: tuple[Run, Path], smoke: BellowsScene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    step = Log.step

    def stop_in_contact(log: Log, *rest: object) -> None:
        step(log, *rest)  # type: ignore[arg-type]
        if any(n.startswith(MODELLED) for n in log.notes):
            raise RuntimeError("pulled the plug")

    scene = changed(smoke, [9.0, 14.0], tip="blocked")
    with monkeypatch.context() as patch, pytest.raises(Exception, match="pulled the plug"):
        patch.setattr(Log, "step", stop_in_contact)
        solved(scene, tmp_path)
    again = solved(scene, tmp_path)
    # as text: what was not determined is NaN, which is not equal to itself
    whole = [str(dataclasses.replace(entry, wall_s=0.0)) for entry in blocked[0].path]
    assert [str(dataclasses.replace(entry, wall_s=0.0)) for entry in again.path] == whole


def test_an_open_scene_makes_no_contact(smoke: BellowsScene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(studies.models.contact, "scene_contact", None)  # would raise if called
    run = solved(changed(smoke, [2.0]), tmp_path)
    assert run.summary.status == "reached"
    assert not any(n.startswith((MODELLED, CONTACT)) for n in run.summary.plan)


def test_vacuum_contracts_until_folds_touch_and_on(smoke: BellowsScene, tmp_path: Path) -> None:
    run = solved(changed(smoke, [-0.5, -2.0]), tmp_path)
    assert run.summary.status == "reached", run.summary.reason
    asked = [entry for entry in run.path if entry.status == "requested"]
    assert [entry.pressure_kpa for entry in asked] == pytest.approx([-0.5, -2.0])
    assert any(n.startswith(MODELLED) for n in run.summary.plan)
    tips, volumes = ([getattr(entry, name) for entry in run.path] for name in ("tip_mm", "volume_mm3"))
    assert (np.diff([0.0, *tips]) < 0.0).all() and (np.diff(volumes) < 0.0).all()
    assert min(volumes) > 0.0
    # folds that lie on each other are stiffer than those on their way
    slopes = np.diff([0.0, *tips]) / np.diff([0.0, *(entry.pressure_kpa for entry in run.path)])
    assert slopes[-1] < 0.5 * slopes[0]
    assert min(entry.min_gap_mm for entry in run.path) > -LIMIT * WALL_MM


@pytest.mark.parametrize("tip", ["cap", "rigid"])
def test_vacuum_is_negative_pressure(smoke: BellowsScene, tip: str) -> None:
    """The same state, forces and count of modes whether solved as a vacuum or as a pressure below zero."""
    scene = smoke.model_copy(update={"geometry": smoke.geometry.model_copy(update={"tip": tip})})
    found = []
    for load_kpa, solved_mpa in ((5.0, -4e-4), (-5.0, 4e-4)):
        of = changed(scene, [load_kpa])
        mesh = scene_meridian(of, 1)
        problem = scene_problem(of, mesh, MPI.COMM_SELF)
        assert problem.conservative
        problem.set_state(problem.zero_state())
        report = solve_equilibrium(problem, Factor(problem), NewtonSettings(), HeldLoad(solved_mpa))
        volume = of.load.sense * problem.cavity_volume()
        tip_mm = Tip(of, mesh).mean_mm(problem.get_state())
        found.append((tip_mm, volume, problem.energy(), reaction(problem), report.compliance_mm3_per_mpa))
        assert report.excess_negatives == 0
    assert found[0][0] < -0.5
    np.testing.assert_allclose(found[0], found[1], rtol=1e-7)


@pytest.mark.parametrize(
    ("name", "section", "change"),
    [
        ("heung-t1-ri5", "mesh", {"element": "auto"}),
        ("heung-t2-ri7", "mesh", {"element": "auto"}),
        ("smoke-t2-ri5", "mesh", {"element": "tet"}),
        ("smoke-t2-ri5", "rings", {"model": "none"}),
        ("smoke-t2-ri5", "geometry", {"tip": "rigid"}),
    ],
)
def test_nothing_touches_in_the_unloaded_state(root: Path, name: str, section: str, change: dict[str, str]) -> None:
    scene = load_bellows(root / "scenes" / f"{name}.toml")
    scene = scene.model_copy(update={section: getattr(scene, section).model_copy(update=change)})
    mesh = scene_meridian(scene, 1)
    problem = scene_problem(scene, mesh, MPI.COMM_SELF)
    contact = scene_contact(scene, mesh, problem)
    contact.check()
    assert not any(report.places for report in contact.report())
    assert not contact.force().any() and contact.energy() == 0.0
