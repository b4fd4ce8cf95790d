"""The tip of an actuator in a state: its elongation, and where it stands when it does not stay on the axis."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from meshes.solid import FACETS, SolidMesh
from meshes.surface import surface_weights
from solvers.state import State
from studies.scene.bellows import BellowsScene


class Tip:
    """Mean axial displacement of the distal rim, weighted by its undeformed area, or the motion of a rigid plate."""

    def __init__(self, scene: BellowsScene, mesh: SolidMesh) -> None:
        self._plate = scene.geometry.tip == "rigid"
        facets = mesh.facets[mesh.facet_tags == FACETS["tip"]]
        ends = mesh.points[facets]
        if mesh.dimension == 2:
            # area of the cone between two radii
            weight = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) * (ends[:, 0, 0] + ends[:, 1, 0])
        else:
            # The triangles of any three corners; of a quadrilateral's, each of the two diagonals' pairs fills it once.
            weight = np.zeros(len(ends))
            for a, b, c in itertools.combinations(range(ends.shape[1]), 3):
                weight += np.linalg.norm(np.cross(ends[:, b] - ends[:, a], ends[:, c] - ends[:, a]), axis=1)
        self._facets, self._weight = facets, weight / weight.sum()
        self._centre = mesh.tip_centre_node

    def mean_mm(self, state: State) -> float:
        """Mean over the rim."""
        if self._plate:
            return float(state.bodies_mm[-1, 2 if state.bodies_mm.shape[1] == 6 else 0])
        return float(self._weight @ state.displacement_mm[self._facets, -1].mean(axis=1))

    def centre_mm(self, state: State) -> float:
        """At the axis."""
        if self._plate:
            return self.mean_mm(state)
        return float(state.displacement_mm[self._centre, -1])


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
