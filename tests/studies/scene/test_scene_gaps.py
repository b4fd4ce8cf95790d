"""Gaps of a scene's states: the same on the meridian and on the body, and negative once a ring is in the wall."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from meshes.solid import SolidMesh
from solvers.state import State
from studies.models.gaps import GapMeter
from studies.models.run_log import CONTACT, ending
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_body, scene_meridian


@pytest.fixture(scope="module")
def scene(root: Path) -> BellowsScene:
    return load_bellows(root / "scenes" / "smoke-t2-ri5.toml")


def at_rest(mesh: SolidMesh, modes: int) -> State:
    return State(np.zeros(mesh.points.shape), np.zeros(1), np.zeros((3, modes)), 0.0)


def test_same_gap_on_the_meridian_and_round_the_body(scene: BellowsScene) -> None:
    meridian = scene_meridian(scene, 1)
    flat = GapMeter(scene, meridian).measure(at_rest(meridian, 1))
    body = scene_body(meridian, "full3d", 6)
    whole = GapMeter(scene, meridian, body).measure(at_rest(body, 6))
    assert flat.between == whole.between
    # the nodes of every plane of the body are those of the meridian, turned: round-off
    assert whole.gap.gap_mm == pytest.approx(flat.gap.gap_mm, rel=1e-12)
    assert flat.between == "folds" and flat.gap.gap_mm == pytest.approx(1.0, rel=1e-9)  # the upright sides of a groove


def test_a_ring_pushed_into_the_wall_is_seen(scene: BellowsScene) -> None:
    meridian = scene_meridian(scene, 1)
    state = at_rest(meridian, 1)
    # the rings stay, the middle fold's outside rises to the radius of the rings
    state.displacement_mm[np.abs(meridian.points[:, 1] - 8.0) < 3.5, 0] += 1.0
    moved = at_rest(meridian, 1)
    moved.displacement_mm[:] = state.displacement_mm
    moved.bodies_mm[0, 0] = 3.0
    touch = GapMeter(scene, meridian).measure(moved)
    assert touch.between == "wall and ring"
    assert touch.gap.gap_mm < 0.0


def test_a_ring_that_turns_goes_into_the_wall_on_one_side(scene: BellowsScene) -> None:
    meridian = scene_meridian(scene, 1)
    body = scene_body(meridian, "full3d", 6)
    meter = GapMeter(scene, meridian, body)
    state = at_rest(body, 6)
    # the outside of the bend 0.7 to 1.3 mm beside the middle ring's seat rises to 1 mm above it
    radius = np.hypot(body.points[:, 0], body.points[:, 1])
    beside = (np.abs(np.abs(body.points[:, 2] - 13.0) - 3.0) < 0.3) & (radius > 11.8)
    state.displacement_mm[beside, :2] = body.points[beside, :2] * (13.5 / radius[beside] - 1.0)[:, None]
    level = meter.measure(state)
    assert level.between == "wall and ring" and level.gap.gap_mm > 0.0
    state.bodies_mm[1, 4] = 1.2  # mm at the arm: about 5 degrees
    assert meter.measure(state).gap.gap_mm < level.gap.gap_mm - 0.3


def test_a_path_that_ends_after_first_touch_says_so() -> None:
    touch = f"{CONTACT} beyond 10 kPa: folds touch first between 10 and 12 kPa, at r = 9.00, z = 8.00 mm"
    assert ending("steps became too small", ["warning: x", touch]) == f"steps became too small; {touch}"
    assert ending("steps became too small", ["warning: x"]) == "steps became too small"
    assert ending("", [touch]) == ""  # the path did not end early
