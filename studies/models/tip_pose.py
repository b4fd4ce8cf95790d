"""Where the tip of an actuator stands when it does not stay on the axis."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from meshes.solid import SolidMesh
from meshes.surface import surface_weights
from solvers.state import State


@dataclass(frozen=True)
class TipPose:
    """The rim of the distal face in a state, as a whole.

    Attributes
    ----------
    sideways_mm, across_mm
        Mean displacement along x and along y.
    bend_deg, bend_across_deg
        Angles by which the rim's plane faces x and y instead of the axis.
    """

    sideways_mm: float
    across_mm: float
    bend_deg: float
    bend_across_deg: float


def tip_pose(mesh: SolidMesh, state: State) -> TipPose:
    """Measure the rim of a whole body, weighted by the undeformed area; its plane is that of least squares."""
    weights = surface_weights(mesh, "tip")
    share = weights / weights.sum()
    moved = share @ state.displacement_mm
    here = mesh.points + state.displacement_mm
    away = (here - share @ here) * np.sqrt(np.abs(share))[:, None]
    normal = np.linalg.svd(away, full_matrices=False)[2][-1]
    normal = normal * math.copysign(1.0, normal[2])
    angles = [math.degrees(math.atan2(normal[k], normal[2])) for k in (0, 1)]
    return TipPose(float(moved[0]), float(moved[1]), angles[0], angles[1])
