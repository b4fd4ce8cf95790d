"""Rigid bodies bonded to the solid: which there are, and how their unknowns add up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from solvers.discrete.domain import FloatArray

# Motions of a rigid body by number: translations along x, y and z, then rotations about them.
MOTIONS = 6
EVERY_MOTION = tuple(range(MOTIONS))
AXIAL = (2,)


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
    motions
        Of the six motions those that symmetry leaves the bodies of a three-dimensional mesh, ascending: in a sector
        the axial one. On a meridian it is that in any case.
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
        Which of these motions symmetry holds besides, of each body, shape (bodies, motions); None for none.
    """

    normal_mpa_per_mm: float
    tangential_mpa_per_mm: float
    grade: FloatArray
    centres_mm: FloatArray
    arm_mm: float
    motions: tuple[int, ...] = EVERY_MOTION
    plate: int | None = None
    plate_area_mm2: float = 0.0
    plate_held: bool = False
    plate_force_n: float = 0.0
    plate_closes: bool = True
    held: NDArray[np.bool_] | None = None

    def motions_on(self, axisymmetric: bool) -> tuple[int, ...]:
        """The motions that a body has on a meridian, or in three dimensions."""
        return AXIAL if axisymmetric else self.motions

    def held_motions(self, axisymmetric: bool) -> NDArray[np.bool_]:
        """Which of the bodies' motions are held, shape (bodies, motions)."""
        held = np.zeros((len(self.centres_mm), len(self.motions_on(axisymmetric))), dtype=bool)
        if self.held is not None:
            held |= self.held
        if self.plate is not None and self.plate_held:
            held[self.plate] = True
        return held


def as_six(values: FloatArray, motions: Sequence[int]) -> FloatArray:
    """Values of some motions, shape (bodies, motions), among zeros for the others, shape (bodies, 6)."""
    out = np.zeros((len(values), MOTIONS))
    out[:, list(motions)] = values
    return out


def turning(motions: Sequence[int]) -> bool:
    """True if a rotation is among the motions."""
    return any(motion >= 3 for motion in motions)


def moved(values: FloatArray, change: FloatArray, arm_mm: float, motions: Sequence[int] = EVERY_MOTION) -> FloatArray:
    """Body unknowns after an increment: translations add, rotations multiply from the right.

    Symmetry leaves a body all rotations or those about one axis, which stay so.
    """
    if not turning(motions):
        return values + change
    before, more = as_six(values, motions), as_six(change, motions)
    out = before + more
    for k in range(len(values)):
        turn = Rotation.from_rotvec(before[k, 3:] / arm_mm) * Rotation.from_rotvec(more[k, 3:] / arm_mm)
        out[k, 3:] = turn.as_rotvec() * arm_mm
    return out[:, list(motions)]
