"""Arc length passes limit points of the pressure and of the volume: one sphere, and two on one cavity, both exact."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from analytical.exact.sphere import Sphere, limit_point, pressure_at_inner_radius_mpa
from analytical.exact.two_spheres import TwoSpheres
from analytical.laws.isotropic import NeoHooke, Yeoh
from meshes.bodies import sphere_meridian
from meshes.solid import FACETS
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.arc import FARTHEST, Scale, distance, refuse_far, refuse_jump, volume_turns_back
from solvers.paths.checkpoint import read_checkpoint, write_checkpoint
from solvers.paths.path import follow_path
from solvers.paths.states import PathMemory, PathPoint, PathSettings
from solvers.state import State

SCRIPT = Path(__file__).with_name("two_spheres.py")


def load() -> ModuleType:
    spec = importlib.util.spec_from_file_location("two_spheres", SCRIPT)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["two_spheres"] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


two = load()
EXACT = TwoSpheres(two.SMALL, two.LARGE)
LIMIT = EXACT.limit(two.LAW)
FINE = PathSettings(control="arc", largest_volume=4.0)


@pytest.fixture(scope="module")
def pair() -> SimpleNamespace:
    body = two.mesh()
    problem, factor = two.problem_of(MPI.COMM_SELF, body)
    return SimpleNamespace(mesh=body, problem=problem, factor=factor)


@pytest.fixture(scope="module")
def one(make_problem) -> Callable[[Any], SimpleNamespace]:
    sphere = Sphere(5.0, 6.5)
    mesh = sphere_meridian(5.0, 6.5, 6, 2, "quadrilaterals")
    held = ((FACETS["axis"], 0), (FACETS["bottom"], 1))

    def make(law) -> SimpleNamespace:
        problem = make_problem(mesh, law, cavity=FACETS["cavity"], held=held)
        return SimpleNamespace(sphere=sphere, law=law, problem=problem, factor=Factor(problem))

    return make


def bore_mm(case: SimpleNamespace, volume_mm3: float) -> float:
    """Radius of the bore, from the volume relative to the mesh's own."""
    return case.sphere.inner_radius_mm * (volume_mm3 / case.problem.volume_unit_mm3) ** (1.0 / 3.0)


def test_sphere_through_its_limit_point_and_down(one) -> None:
    case = one(NeoHooke(0.1))
    limit = limit_point(case.sphere, case.law)
    assert limit is not None
    settings = PathSettings(control="arc", largest_volume=30.0)
    path = follow_path(case.problem, case.factor, [0.8 * limit.pressure_mpa, 1.2 * limit.pressure_mpa], settings)
    assert path.cause is Cause.LIMIT_POINT
    assert {s.control for s in path.states[1:] if not s.asked} == {"arc"}
    # an asked pressure is met exactly on the way up
    assert [s.state.load_mpa for s in path.states if s.asked] == [0.8 * limit.pressure_mpa]
    for state in path.states:
        bore = bore_mm(case, state.volume_mm3)
        # asked 0.5 %; six quadrilaterals from equator to pole, two through the wall
        assert state.state.load_mpa == pytest.approx(
            pressure_at_inner_radius_mpa(case.sphere, case.law, bore), rel=2e-4
        )
        assert state.newton.excess_negatives == (bore > limit.inner_mm)
        assert state.newton.excess_at_volume == 0
    assert path.states[-1].state.load_mpa < 0.6 * limit.pressure_mpa
    crossing = path.crossing
    assert crossing is not None and crossing.kind is Cause.LIMIT_POINT
    assert crossing.pressure_mpa == pytest.approx(limit.pressure_mpa, rel=1e-4)
    assert bore_mm(case, crossing.volume_mm3) == pytest.approx(limit.inner_mm, rel=5e-3)


def test_asked_pressure_beyond_a_snap_is_reached(one) -> None:
    # stiffens after its limit point: 36 kPa has a state on the far branch only
    case = one(Yeoh((0.05, 0.0, 2e-4)))
    path = follow_path(case.problem, case.factor, [0.020, 0.036], PathSettings(control="arc"))
    assert path.reached
    assert [s.state.load_mpa for s in path.states if s.asked] == [0.020, 0.036]
    counts = [s.newton.excess_negatives for s in path.states]
    assert 1 in counts and counts[0] == counts[-1] == 0
    by_volume = follow_path(case.problem, case.factor, [0.020, 0.036], PathSettings(control="volume"))
    assert path.states[-1].volume_mm3 == pytest.approx(by_volume.states[-1].volume_mm3, rel=1e-7)


@pytest.mark.parametrize("asked", [0.02, 0.03])
@pytest.mark.parametrize("control", ["arc", "auto"])
def test_two_spheres_through_both_limit_points(pair, control, asked) -> None:
    back, forward = EXACT.folds(two.LAW)
    settings = PathSettings(control=control, largest_volume=4.0, largest_arc_step=0.1)
    path = follow_path(pair.problem, pair.factor, [asked, 0.05], settings)
    assert path.cause is Cause.LIMIT_POINT  # 50 kPa is beyond both
    bore = two.small_bore(pair.mesh)
    for state in path.states:
        moved = pair.mesh.points[bore] + state.state.displacement_mm[bore]
        at = EXACT.at(two.LAW, float(np.hypot(*moved.T).mean()) / 5.0)
        # asked 0.5 %; measured 1e-4
        assert state.state.load_mpa == pytest.approx(at.pressure_mpa, rel=5e-4)
        assert state.volume_mm3 == pytest.approx(at.volume_mm3, rel=5e-4)
        assert state.newton.excess_negatives == (at.stretch > LIMIT.stretch)
        # between its two limit points a held volume does not hold the spheres either
        if min(abs(at.stretch - f.stretch) for f in (back, forward)) > 0.02:
            assert state.newton.excess_at_volume == (back.stretch < at.stretch < forward.stretch)
    assert path.crossing is not None and path.crossing.kind is Cause.LIMIT_POINT
    assert path.crossing.pressure_mpa == pytest.approx(LIMIT.pressure_mpa, rel=1e-4)
    volumes = np.array([s.volume_mm3 for s in path.states])
    turn = int(np.flatnonzero(np.diff(volumes) < 0.0)[0])
    again = turn + int(np.flatnonzero(np.diff(volumes[turn:]) > 0.0)[0])
    # the states next to the limit points of the volume, where it is stationary; asked 0.5 %
    assert volumes[turn] == pytest.approx(back.volume_mm3, rel=2e-3)
    assert volumes[again] == pytest.approx(forward.volume_mm3, rel=5e-3)
    assert volumes[-1] > 4.0 * pair.problem.volume_unit_mm3
    controls = [s.control for s in path.states]
    if control == "auto":
        # taken where the volume turns back, not before
        assert "arc" not in controls[:turn]
        assert controls[-1] == "arc"


@pytest.mark.parametrize("asked", [0.02, 0.03])
def test_volume_control_alone_stops_where_the_volume_turns_back(pair, asked) -> None:
    back, _ = EXACT.folds(two.LAW)
    # from 30 kPa a step beyond the turn found a state with six unstable modes before jumps were refused
    path = follow_path(pair.problem, pair.factor, [asked, 0.05], PathSettings(control="volume", largest_volume=4.0))
    assert not path.reached
    assert path.cause is Cause.STEP_SIZE
    assert path.states[-1].volume_mm3 == pytest.approx(back.volume_mm3, rel=1e-3)
    assert max(s.volume_mm3 for s in path.states) < back.volume_mm3 * (1.0 + 1e-4)
    assert all(s.newton.excess_at_volume == 0 for s in path.states)


def test_restart_after_any_step_is_the_same_to_the_last_bit(pair, tmp_path: Path) -> None:
    memories: list[PathMemory] = []
    whole = follow_path(pair.problem, pair.factor, [0.03, 0.05], FINE, on_step=memories.append)
    assert len(memories) > 12
    for k in (0, 1, 6, len(memories) // 2, len(memories) - 2):
        write_checkpoint(tmp_path / "c.npz", "two", memories[k], None)
        found = read_checkpoint(tmp_path / "c.npz", "two")
        assert found is not None
        resume, _ = found
        assert isinstance(resume, PathMemory)
        path = follow_path(pair.problem, pair.factor, [0.03, 0.05], FINE, resume=resume)
        assert path.rejected == whole.rejected
        after = whole.states[len(whole.states) - len(path.states) :]
        assert len(path.states) >= 1 and path.states[0].control == after[0].control
        for a, b in zip(path.states, after, strict=True):
            assert np.array_equal(a.state.displacement_mm, b.state.displacement_mm)
            assert a.newton == b.newton


def test_one_and_two_ranks_go_the_same_way(python) -> None:
    first, second = (python.answer(ranks, SCRIPT) for ranks in (1, 2))
    assert (first["ranks"], second["ranks"]) == (1, 2)
    assert first["counts"] == second["counts"] and first["rejected"] == second["rejected"]
    # Newton to 1e-8 of the load, which the plane and the next steps carry on
    for name in ("pressures", "volumes"):
        assert second[name] == pytest.approx(first[name], rel=1e-6), name


def test_what_lies_far_from_where_it_was_expected_is_refused() -> None:
    def at(x: float, load: float) -> State:
        return State(np.full((4, 2), x), np.zeros(4), np.zeros((0, 1)), load)

    scale = Scale(2.0, 0.5)
    # four nodes that move by (2, 2): |u| = sqrt(8) mm; and 0.25 MPa
    assert distance(at(0.0, 0.0), at(2.0, 0.25), scale) == pytest.approx(np.sqrt(8.0 / 4.0 + 0.25))
    refuse_far(at(0.0, 0.0), at(0.0, 0.5 * 0.99 * FARTHEST), 1.0, scale)
    with pytest.raises(StepFailed, match="from where it was expected"):
        refuse_far(at(0.0, 0.0), at(0.0, 0.5 * 1.01 * FARTHEST), 1.0, scale)


def point(pressure: float, volume: float, compliance: float, unstable: int) -> PathPoint:
    state = State(np.zeros((1, 2)), np.zeros(1), np.zeros((0, 1)), pressure)
    return PathPoint(state, volume, compliance, unstable)


def test_jump_to_another_branch_is_told_from_a_bifurcation() -> None:
    here = point(0.0320, 2.5, 296.0, 0)
    # the numbers of the two spheres, at a held volume beyond where the volume turns back
    with pytest.raises(StepFailed, match="another branch: unstable modes at held volume 0 -> 6"):
        refuse_jump(here, point(0.0328, 2.59, 469.0, 6))
    # a bifurcation on the way: the same path, so the pressure changes as its slopes say
    refuse_jump(here, point(0.03225, 2.59, 450.0, 2))
    # the same count, whatever the pressure does; and the unloaded state, whose slope is not known
    refuse_jump(here, point(0.0328, 2.59, 469.0, 0))
    refuse_jump(point(0.0, 1.0, np.nan, 0), point(0.0328, 2.59, 469.0, 6))


def test_turning_volume_is_foreseen_from_its_compliance() -> None:
    # V = 1 - (P - 1)^2 in units of its top: dV/dP = -2 (P - 1)
    def at(p: float) -> PathPoint:
        return point(p, 1.0 - (p - 1.0) ** 2, -2.0 * (p - 1.0), 0)

    last = [at(0.7), at(0.9)]  # 0.01 of the volume are left
    assert volume_turns_back(last, 0.01)
    assert not volume_turns_back(last, 0.001)
    assert not volume_turns_back(last[1:], 0.01)
    assert not volume_turns_back([at(0.9), at(0.7)], 0.01)
