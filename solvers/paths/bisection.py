"""Bisection on a path: from two states with different counts of unstable modes to two close ones."""

from __future__ import annotations

from collections.abc import Callable

from solvers.paths.states import PathPoint

BISECTIONS = 40


def narrow(
    before: PathPoint,
    after: PathPoint,
    part_way: Callable[[PathPoint, PathPoint], tuple[float, PathPoint] | None],
    tolerance: float,
    least_shrinking: float,
) -> tuple[PathPoint, PathPoint]:
    """The last state counted as ``before`` and the first one beyond, for the first change of the count.

    Parameters
    ----------
    before, after
        States with different ``unstable``.
    part_way
        The part of the way from one state to another, and the equilibrium there with its count; None if it fails, which
        ends the bisection.
    tolerance
        The pressures of the final two states differ by less than this share.
    least_shrinking
        The interval shrinks at least to this share, also where the pressure is flat.
    """
    low, high, width = before, after, 1.0
    for _ in range(BISECTIONS):
        near = abs(high.pressure_mpa - low.pressure_mpa) <= tolerance * abs(high.pressure_mpa)
        if near and width <= least_shrinking:
            break
        step = part_way(low, high)
        if step is None:
            break
        share, middle = step
        if middle.unstable == before.unstable:
            low, width = middle, width * (1.0 - share)
        else:
            high, width = middle, width * share
    return low, high
