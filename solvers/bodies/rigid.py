"""Rigid bodies bonded to the solid: which there are, and how their unknowns add up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from solvers.discrete.domain import FloatArray


@dataclass(frozen=True)
class RigidBodies:
    """Rigid bodies bonded to the solid on the facets tagged as bonded.

    Attributes
    ----------
    normal_mpa_per_mm, tangential_mpa_per_mm
        Stiffness of the layer per area.
    grade
        Factor on both at each caller's node, shape (nodes,).
    centres_mm
        Axial position of each body's centre on the axis, shape (bodies,).
    arm_mm
        Length that turns rotations into displacements, so that all unknowns are in mm.
    axial_only
        True where symmetry leaves a body of a three-dimensional mesh only its axial motion, as in a sector.
    plate
        Number of the body that closes the cavity by a plane through its centre, normal to the axis; None for none.
    plate_area_mm2
        Area of that plane.
    plate_held
        True if the plate keeps the motion its state has: that of the unloaded state, nothing, on a path.
    plate_force_n
        Dead axial force on a plate that is not held, in the direction of the axis.
    plate_closes
        False for a plate on which the cavity does not end: then it closes nothing.
    held
        Motions of each body that symmetry holds, shape (bodies, motions); None for none.
    """

    normal_mpa_per_mm: float
    tangential_mpa_per_mm: float
    grade: FloatArray
    centres_mm: FloatArray
    arm_mm: float
    axial_only: bool = False
    plate: int | None = None
    plate_area_mm2: float = 0.0
    plate_held: bool = False
    plate_force_n: float = 0.0
    plate_closes: bool = True
    held: NDArray[np.bool_] | None = None

    def held_motions(self, axisymmetric: bool) -> NDArray[np.bool_]:
        """Which motions are held, shape (bodies, motions): one axial motion on a meridian and in a sector, else six."""
        held = np.zeros((len(self.centres_mm), 1 if axisymmetric or self.axial_only else 6), dtype=bool)
        if self.held is not None:
            held |= self.held
        if self.plate is not None and self.plate_held:
            held[self.plate] = True
        return held


def moved(values: FloatArray, change: FloatArray, arm_mm: float) -> FloatArray:
    """Body unknowns after an increment: translations add, rotations multiply from the right."""
    out = values + change
    if values.shape[1] == 6:
        for k in range(len(values)):
            turn = Rotation.from_rotvec(values[k, 3:] / arm_mm) * Rotation.from_rotvec(change[k, 3:] / arm_mm)
            out[k, 3:] = turn.as_rotvec() * arm_mm
    return out
