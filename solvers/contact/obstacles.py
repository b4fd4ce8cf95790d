"""Rigid sections in the meridian plane: signed distance of points, its direction and its curvature.

Each gives for points (r, z), shape (n, 2), mm, the gap (n,), positive outside, its gradient (n, 2) and its second
derivative (n, 2, 2). They stand still, or move axially with a rigid body of the problem.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from solvers.discrete.domain import FloatArray

Gaps = tuple[FloatArray, FloatArray, FloatArray]


class Obstacle(Protocol):
    """A rigid section."""

    def gaps(self, points: FloatArray) -> Gaps: ...  # noqa: D102


@dataclass(frozen=True)
class Bore:
    """The inside of a cylinder about the axis, radius in mm."""

    radius_mm: float

    def gaps(self, points: FloatArray) -> Gaps:
        """Distance to the cylinder from inside."""
        n = len(points)
        return self.radius_mm - points[:, 0], np.tile([-1.0, 0.0], (n, 1)), np.zeros((n, 2, 2))


@dataclass(frozen=True)
class Bowl:
    """The inside of a sphere about the origin, radius in mm."""

    radius_mm: float

    def gaps(self, points: FloatArray) -> Gaps:
        """Distance to the sphere from inside."""
        distance = np.linalg.norm(points, axis=1)
        out = points / distance[:, None]
        bend = (out[:, :, None] * out[:, None, :] - np.eye(2)) / distance[:, None, None]
        return self.radius_mm - distance, -out, bend


@dataclass(frozen=True)
class RoundedBox:
    """A rectangle ``low <= r <= high``, ``|z - centre| <= half_width`` with rounded edges, mm.

    Attributes
    ----------
    low_mm, high_mm, centre_mm, half_width_mm
        The rectangle.
    low_edge_mm, high_edge_mm
        Radii of the edges at ``low`` and ``high``.
    """

    low_mm: float
    high_mm: float
    centre_mm: float
    half_width_mm: float
    low_edge_mm: float
    high_edge_mm: float

    def gaps(self, points: FloatArray) -> Gaps:
        """Distance to the outline, negative inside."""
        middle = np.array([0.5 * (self.low_mm + self.high_mm), self.centre_mm])
        half = np.array([0.5 * (self.high_mm - self.low_mm), self.half_width_mm])
        p = points - middle
        sign = np.where(p < 0.0, -1.0, 1.0)
        edge = np.where(p[:, 0] < 0.0, self.low_edge_mm, self.high_edge_mm)
        q = np.abs(p) - half + edge[:, None]
        beyond = np.maximum(q, 0.0)
        distance = np.linalg.norm(beyond, axis=1)
        at_edge = (q > 0.0).all(axis=1)
        gap = distance + np.minimum(q.max(axis=1), 0.0) - edge
        flat = np.zeros_like(q)
        flat[np.arange(len(q)), q.argmax(axis=1)] = 1.0
        safe = np.where(at_edge, distance, 1.0)
        out = np.where(at_edge[:, None], beyond / safe[:, None], flat) * sign
        bend = (np.eye(2) - out[:, :, None] * out[:, None, :]) / safe[:, None, None]
        return gap, out, np.where(at_edge[:, None, None], bend, 0.0)
