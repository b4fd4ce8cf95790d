"""Ratios of times from measurements of several codes: at the smallest error of each, and at equal error."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Point:
    """Wall time, s, and absolute error, percent, of a run."""

    wall_s: float
    error_percent: float


def floored(points: Iterable[Point], floor_percent: float) -> list[Point]:
    """Points whose errors below what the reference itself is known to count as that: a lucky zero is worth nothing."""
    return [Point(p.wall_s, max(abs(p.error_percent), floor_percent)) for p in points]


def lasting(errors_percent: Sequence[float]) -> list[float]:
    """Errors on meshes, coarsest first, as what a user may rely on: the largest absolute one on this or a finer mesh.

    A coarse mesh may be right by accident where the errors of meridian and circumference cancel; refining one of the
    two then shows what the other left.
    """
    found: list[float] = []
    for error in reversed(errors_percent):
        found.insert(0, max(abs(error), *found[:1], 0.0))
    return found


def best(points: Sequence[Point]) -> Point | None:
    """The point of smallest error, the fastest of those that share it to a hundredth; its time is T_peer."""
    least = min((p.error_percent for p in points), default=math.nan)
    return min((p for p in points if p.error_percent <= 1.01 * least), key=lambda p: p.wall_s, default=None)


def front(points: Sequence[Point]) -> list[Point]:
    """The points that no other beats in both time and error, fastest first."""
    kept: list[Point] = []
    for point in sorted(points, key=lambda p: (p.wall_s, p.error_percent)):
        if not kept or point.error_percent < kept[-1].error_percent:
            kept.append(point)
    return kept


def time_at(points: Sequence[Point], error_percent: float) -> float:
    """Time to an error: log time over log error between the front's points; NaN if none is that good.

    An error larger than all is had for the time of the fastest run.
    """
    line = front(points)
    if not line or error_percent < line[-1].error_percent * (1.0 - 1e-12):
        return math.nan
    if error_percent >= line[0].error_percent:
        return line[0].wall_s
    for coarse, fine in zip(line[:-1], line[1:], strict=True):
        if fine.error_percent <= error_percent <= coarse.error_percent:
            span = math.log(coarse.error_percent / fine.error_percent)
            share = math.log(coarse.error_percent / error_percent) / span
            return math.exp((1.0 - share) * math.log(coarse.wall_s) + share * math.log(fine.wall_s))
    return line[-1].wall_s


def ratio_to_fastest(ours: Sequence[Point], peers: Mapping[str, Sequence[Point]], allowed_percent: float) -> float:
    """Our time to an allowed error over the smallest T_peer; NaN if we have none or there are none."""
    mine = [p.wall_s for p in ours if p.error_percent <= allowed_percent]
    theirs = [point.wall_s for points in peers.values() if (point := best(points)) is not None]
    return min(mine) / min(theirs) if mine and theirs else math.nan


def ratio_at_equal_error(ours: Sequence[Point], peers: Mapping[str, Sequence[Point]]) -> tuple[float, float]:
    """Error, percent, and our time over the peers' at it: the smallest error that both we and some peer reach."""
    every = [p for points in peers.values() for p in points]
    if not ours or not every:
        return math.nan, math.nan
    error = max(min(p.error_percent for p in ours), min(p.error_percent for p in every))
    return error, time_at(ours, error) / time_at(every, error)
