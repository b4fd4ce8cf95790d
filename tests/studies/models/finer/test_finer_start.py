"""States of a coarse mesh on a finer one, nested or not, and runs that start from them."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from meshes.bodies import block, sphere_meridian, tube_meridian
from meshes.errors import MeshError
from meshes.solid import SolidMesh
from solvers.paths.states import GuessMemory
from solvers.state import State
from studies.models.axisymmetric import run_axisymmetric
from studies.models.body import run_simple_body
from studies.models.finer.location import locate, place_in
from studies.models.finer.prolongation import Prolongation, linear_shape
from studies.models.finer.start import NOT_STARTED, STARTED, Coarser
from studies.models.run_log import CHECKPOINT_FILE, Log
from studies.progress import Progress
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene
from studies.scene.bodies import BodyScene
from studies.scene.load import load_bellows, load_scene

ALONE = MPI.COMM_SELF
# The second mesh of a pair is not a refinement of the first.
PAIRS = {
    "triangles": [tube_meridian(5.0, 7.0, 6.0, n, m, "triangles") for n, m in ((4, 2), (7, 3))],
    "quadrilaterals": [tube_meridian(5.0, 7.0, 6.0, n, m, "quadrilaterals") for n, m in ((4, 2), (7, 3))],
    "hexahedra": [block((3.0, 4.0, 5.0), counts) for counts in ((2, 2, 3), (3, 2, 4))],
}


def state_on(mesh: SolidMesh, jumps: bool) -> State:
    """A quadratic displacement and a linear pressure, which the shape functions of straight cells have."""
    x, z = mesh.points[:, 0], mesh.points[:, -1]
    u = np.column_stack([0.1 * x * z + 0.02 * z**2 + k * x for k in range(mesh.dimension)])
    p = 0.3 + 0.05 * x - 0.02 * z
    at_corners = np.where(np.isin(np.arange(len(x)), mesh.corners), p, 0.0)
    return State(u, p[mesh.cells[:, : mesh.cell.corners]] if jumps else at_corners, np.array([[0.7]]), 0.01)


@pytest.mark.parametrize("jumps", [False, True])
@pytest.mark.parametrize("name", PAIRS)
def test_polynomials_of_the_element_are_carried_over_exactly(name: str, jumps: bool) -> None:
    coarse, fine = PAIRS[name]
    found, wanted = Prolongation(coarse, fine)(state_on(coarse, jumps)), state_on(fine, jumps)
    # places are found to 1e-10 of a cell
    assert np.abs(found.displacement_mm - wanted.displacement_mm).max() < 1e-9
    assert np.abs(found.pressure_mpa - wanted.pressure_mpa).max() < 1e-10
    assert (found.bodies_mm, found.load_mpa) == (wanted.bodies_mm, wanted.load_mpa)


def test_curved_boundary_of_another_mesh_is_reached_by_a_little_extrapolation() -> None:
    coarse, fine = (sphere_meridian(5.0, 6.5, n, 2, "quadrilaterals") for n in (3, 8))
    places = locate(coarse, fine.points)
    values = coarse.cell.shape(places.at)[0]
    again = np.einsum("nk,nki->ni", values, coarse.points[coarse.cells[places.cells]])
    assert np.abs(again - fine.points).max() < 1e-9
    beyond = np.maximum(-places.at, places.at - 1.0).max()
    # an arc of 30 degrees lies 1e-3 of its radius off the parabola through three of its points, a cell is 0.75 mm
    assert 1e-6 < beyond < 0.01


def test_point_in_a_cell_none_of_whose_nodes_is_close_is_found() -> None:
    """A row of cells forty times as long as the others: the nodes closest to its inside are its neighbours'."""
    mesh = tube_meridian(5.0, 7.0, 6.0, 6, 8, "quadrilaterals")
    r, z = mesh.points.T
    long = dataclasses.replace(mesh, points=np.column_stack([r, np.where(z > 5.0, 5.0 + 40.0 * (z - 5.0), z)]))
    point = np.array([[5.06, 9.0]])
    places = locate(long, point)
    values = long.cell.shape(places.at)[0]
    assert np.einsum("nk,nki->ni", values, long.points[long.cells[places.cells]]) == pytest.approx(point)
    assert places.at.min() >= -1e-9 and places.at.max() <= 1.0 + 1e-9


def test_points_elsewhere_are_refused() -> None:
    with pytest.raises(MeshError, match="no cell of the mesh is close to"):
        locate(PAIRS["triangles"][0], np.array([[6.0, 3.0], [9.0, 3.0]]))


def test_place_outside_of_a_given_cell_is_extrapolated() -> None:
    mesh = PAIRS["quadrilaterals"][0]
    at, settled = place_in(mesh, mesh.points[mesh.cells[1, 3]][None], np.array([0]))
    assert settled.all() and at.max() > 1.5
    assert linear_shape(mesh.cell, at).sum() == pytest.approx(1.0)


# ---- runs ----------------------------------------------------------------------------------------------------


def bellows_run(scene: BellowsScene, level: int, folder: Path, coarser: Coarser | None = None) -> Run:
    return run_axisymmetric(scene, level, folder / f"r{level}", ALONE, Progress(ALONE), coarser=coarser)


@pytest.fixture(scope="module")
def scene(root: Path) -> BellowsScene:
    return load_bellows(root / "scenes" / "smoke-t2-ri5.toml")


@pytest.fixture(scope="module")
def coarser(scene: BellowsScene, tmp_path_factory: pytest.TempPathFactory) -> Coarser:
    folder = tmp_path_factory.mktemp("finer")
    return Coarser(bellows_run(scene, 1, folder), folder / "r1")


def notes(run: Run) -> list[str]:
    return [note for note in run.summary.plan if note.startswith((STARTED, NOT_STARTED))]


def test_finer_run_is_that_of_its_own_path_for_half_the_factorisations(
    scene: BellowsScene, coarser: Coarser, tmp_path: Path
) -> None:
    whole = bellows_run(scene, 2, tmp_path / "whole")
    run = bellows_run(scene, 2, tmp_path / "from", coarser)
    assert run.summary.status == "reached" and len(notes(run)) == 1 and notes(run)[0].startswith(STARTED)
    assert [row.status for row in run.path] == ["requested"] * len(scene.load.pressure_kpa)
    for one, other in zip(run.requested, whole.requested, strict=True):
        # Newton to 1e-8 of the load
        assert one.tip_mm == pytest.approx(other.tip_mm, rel=1e-8)
        assert one.volume_mm3 == pytest.approx(other.volume_mm3, rel=1e-8)
        assert one.unstable_modes == other.unstable_modes == 0
    assert run.summary.factorisations <= 3 * len(run.requested)


def test_path_is_followed_whole_where_the_coarse_one_was_not_stable_or_not_reached(
    scene: BellowsScene, coarser: Coarser, tmp_path: Path
) -> None:
    run = coarser.run
    unstable = tuple(dataclasses.replace(row, unstable_modes=1.0) for row in run.path)
    snapped = tuple(dataclasses.replace(row, limit_kpa=4.0) for row in run.path)
    others = [
        dataclasses.replace(run, summary=dataclasses.replace(run.summary, status="stopped")),
        dataclasses.replace(run, summary=dataclasses.replace(run.summary, crossing={"kind": "bifurcation"})),
        dataclasses.replace(run, path=unstable),
        dataclasses.replace(run, path=snapped),
    ]
    assert coarser.states() is not None
    assert [Coarser(other, coarser.folder).states() for other in others] == [None] * 4
    assert Coarser(run, tmp_path).states() is None  # no states there
    found = bellows_run(scene, 2, tmp_path, Coarser(others[0], coarser.folder))
    assert notes(found) == [] and any(row.status == "step" for row in found.path)


@pytest.mark.parametrize("fault", ["a count", "Newton", "another mesh"])
def test_path_is_followed_whole_and_says_why_where_the_start_fails(
    fault: str, scene: BellowsScene, coarser: Coarser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from studies.models.finer import start

    actual = Coarser.states

    def other_states(self: Coarser) -> list[State] | None:
        states = actual(self)
        assert states is not None
        if fault == "Newton":  # turned inside out
            return [dataclasses.replace(s, displacement_mm=-40.0 * s.displacement_mm) for s in states]
        return states

    monkeypatch.setattr(Coarser, "states", other_states)
    if fault == "a count":
        follow = start.follow_guesses

        def with_a_mode(*arguments, on_state, **options):
            def one_more(item):
                on_state(dataclasses.replace(item, newton=dataclasses.replace(item.newton, excess_negatives=1)))

            return follow(*arguments, **{**options, "on_state": one_more})

        monkeypatch.setattr(start, "follow_guesses", with_a_mode)
    if fault == "another mesh":
        monkeypatch.setattr(start, "Prolongation", lambda coarse, fine: locate(coarse, 2.0 * fine.points))
    run = bellows_run(scene, 2, tmp_path, coarser)
    said = {"a count": "1 unstable modes at 5 kPa, none on r1", "Newton": "no equilibrium", "another mesh": "no cell"}
    assert run.summary.status == "reached" and len(notes(run)) == 1
    assert notes(run)[0].startswith(NOT_STARTED) and said[fault] in notes(run)[0]
    assert [row.status for row in run.path].count("requested") == 2 and len(run.path) > 2
    assert all(math.isfinite(row.tip_mm) for row in run.path)


def test_interrupted_run_goes_on_from_its_states_or_anew_without_the_coarser(
    scene: BellowsScene, coarser: Coarser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = bellows_run(scene, 2, tmp_path / "whole", coarser)

    def stopped(name: str) -> Path:
        with monkeypatch.context() as patch:
            step = Log.step

            def once(self: Log, memory: GuessMemory) -> None:
                step(self, memory)
                raise KeyboardInterrupt

            patch.setattr(Log, "step", once)
            with pytest.raises(KeyboardInterrupt):
                bellows_run(scene, 2, tmp_path / name, coarser)
        assert (tmp_path / name / "r2" / CHECKPOINT_FILE).exists()
        return tmp_path / name

    run = bellows_run(scene, 2, stopped("on"), coarser)
    assert [row.pressure_kpa for row in run.path] == [row.pressure_kpa for row in whole.path]
    assert [row.tip_mm for row in run.path] == pytest.approx([row.tip_mm for row in whole.path], rel=1e-9)
    assert run.summary.factorisations == whole.summary.factorisations and notes(run) == notes(whole)
    anew = bellows_run(scene, 2, stopped("anew"))
    loads = [row.pressure_kpa for row in anew.path]
    assert notes(anew) == [] and loads == sorted(set(loads)) and len(loads) > len(run.path)


@pytest.mark.parametrize("model", ["axisymmetric", "sector"])
def test_simple_bodies_start_so_too(model: str, root: Path, tmp_path: Path) -> None:
    scene = load_scene(root / "scenes" / "exact" / "tube.toml")
    assert isinstance(scene, BodyScene)
    levels = ("r1", "r2") if model == "axisymmetric" else ("n8", "n12")
    before = run_simple_body(scene, model, levels[0], tmp_path / "a", ALONE, Progress(ALONE))
    arguments = (scene, model, levels[1])
    whole = run_simple_body(*arguments, tmp_path / "whole", ALONE, Progress(ALONE))
    run = run_simple_body(*arguments, tmp_path / "b", ALONE, Progress(ALONE), coarser=Coarser(before, tmp_path / "a"))
    assert notes(run)[0].startswith(STARTED)
    for load in scene.loads_kpa:
        assert run.measured_at(load, "bore_mm") == pytest.approx(whole.measured_at(load, "bore_mm"), rel=1e-8)
    assert run.summary.factorisations <= 3 * len(scene.loads_kpa)
