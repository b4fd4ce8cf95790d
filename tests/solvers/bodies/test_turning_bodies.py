"""What is bonded to a body turns with it in one increment, and Newton's method does not lose its way."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from solvers.bodies.turning import Turning

ARM = 8.0


@pytest.fixture
def bonded() -> tuple[Turning, np.ndarray, np.ndarray, np.ndarray]:
    """Five points bonded to the second of two bodies that has turned already: dofs, body unknowns, arms."""
    rng = np.random.default_rng(3)
    positions = rng.normal(0.0, 6.0, (5, 3)) + [0.0, 0.0, 20.0]
    dofs = rng.permutation(20)[:15].reshape(5, 3)
    turning = Turning([np.empty((0, 3), np.int64), dofs], [np.empty((0, 3)), positions], np.array([0.0, 20.0]), ARM)
    bodies = np.zeros((2, 6))
    bodies[1] = [0.3, -0.1, 2.0, 0.4, 1.2, -0.7]
    turned = Rotation.from_rotvec(bodies[1, 3:] / ARM).apply(positions - [0.0, 0.0, 20.0])
    values = np.zeros(20)
    values[dofs] = [0.0, 0.0, 20.0] + bodies[1, :3] + turned - positions
    return turning, dofs, bodies, values


def rigid(turning: Turning, bodies: np.ndarray, step: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Displacements of points that move with the second body."""
    turn = Rotation.from_rotvec(bodies[1, 3:] / ARM) * Rotation.from_rotvec(step[1, 3:] / ARM)
    centre = np.array([0.0, 0.0, 20.0])
    return centre + bodies[1, :3] + step[1, :3] + turn.apply(positions - centre) - positions


@pytest.mark.parametrize("marked_at", ["here", "before"])
def test_an_increment_leaves_no_slip(bonded, marked_at) -> None:
    turning, dofs, bodies, values = bonded
    positions = turning._positions[1]
    step = np.zeros((2, 6))
    step[1] = [0.1, 0.2, -0.1, 0.8, -1.5, 0.6]
    spin = step[1, 3:] / ARM
    old = bodies.copy()
    at = values.copy()
    if marked_at == "before":  # factored at the unloaded state, as when an older factor is used again
        old, at = np.zeros((2, 6)), np.zeros(20)
    turning.mark(at, old)
    frame = Rotation.from_rotvec(old[1, 3:] / ARM)
    arm = frame.inv().apply(positions + at[dofs] - [0.0, 0.0, 20.0] - old[1, :3])
    after = values.copy()
    after[dofs] += step[1, :3] + frame.apply(np.cross(spin, arm))  # what a linear bond without slip does
    exact = rigid(turning, bodies, step, positions)
    # without the rest: of the size of the square of the turn, or of the turn times the change since the factor
    assert np.abs(after[dofs] - exact).max() > 0.1
    turning.add_rest(after, values, bodies, step)
    assert np.abs(after[dofs] - exact).max() < 1e-13


def test_nothing_is_added_where_nothing_turns(bonded) -> None:
    turning, _, bodies, values = bonded
    turning.mark(values, bodies)
    step = np.zeros((2, 6))
    step[:, :3] = 1.0
    after = values.copy()
    turning.add_rest(after, values, bodies, step)
    assert np.array_equal(after, values)
