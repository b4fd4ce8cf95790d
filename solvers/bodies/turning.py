"""What is bonded to a rigid body turns with it: the part of an increment that is not linear in the rotation.

An increment of Newton's method moves the bonded points of the solid by ``dU + R W R' a``, with a the arm from the
body's centre and W the skew increment of its rotation R, while the body turns by exp(W). The points would slip by the
rest,

    R (exp(W) - I - W) R' a,    of size |W|^2 |a| / 2,

and, if an older factor is used again, by what R and a have changed since. A bond as stiff as a rigid one answers with
forces far above the load: a ring that tilts by a tenth of a degree made the residual a thousand times the load, and
steps failed. So the rest is added to the points. Without rotations, as in all rotationally symmetric states, it is
nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from solvers.assembly.unknowns import Unknowns
from solvers.bodies.rigid import EVERY_MOTION, RigidBodies, as_six, turning
from solvers.discrete.domain import FloatArray, IntArray


class Turning:
    """The bonded points of each body.

    Parameters
    ----------
    dofs
        Owned displacement dofs of the bonded points of each body, shape (points, 3) each.
    positions_mm
        Their reference positions, shape (points, 3) each.
    centres_mm
        Axial position of each body's centre on the axis, shape (bodies,).
    arm_mm
        Length by which body unknowns carry rotations.
    motions
        Those that bodies have; unknowns of bodies have the shape (bodies, motions).
    """

    def __init__(
        self,
        dofs: Sequence[IntArray],
        positions_mm: Sequence[FloatArray],
        centres_mm: FloatArray,
        arm_mm: float,
        motions: Sequence[int] = EVERY_MOTION,
    ) -> None:
        self._motions = tuple(motions)
        self._dofs, self._positions, self._arm = list(dofs), list(positions_mm), arm_mm
        self._marked: list[tuple[Rotation, FloatArray]] = []
        self._centres = np.column_stack([np.zeros((len(centres_mm), 2)), centres_mm])

    def mark(self, values: FloatArray, bodies_mm: FloatArray) -> None:
        """Keep where the tangent was factored: it is with its arms that increments are linear.

        Parameters
        ----------
        values, bodies_mm
            Owned dofs, and unknowns of the bodies.
        """
        six = as_six(bodies_mm, self._motions)
        self._marked = [self._arms(values, six, body) for body in range(len(self._dofs))]

    def _arms(self, values: FloatArray, bodies_mm: FloatArray, body: int) -> tuple[Rotation, FloatArray]:
        """Rotation of a body, and arms of its bonded points in its frame, mm."""
        frame = Rotation.from_rotvec(bodies_mm[body, 3:] / self._arm)
        at = self._positions[body] + values[self._dofs[body]] - self._centres[body] - bodies_mm[body, :3]
        return frame, frame.inv().apply(at) if len(at) else at

    def add_rest(self, values: FloatArray, before: FloatArray, bodies_mm: FloatArray, step: FloatArray) -> None:
        """Add what is not linear in the rotations to displacements to which an increment has been added.

        Parameters
        ----------
        values
            Owned dofs after the increment, changed in place.
        before
            The same before it.
        bodies_mm, step
            Unknowns of the bodies before the increment, and their increment.
        """
        six, change = as_six(bodies_mm, self._motions), as_six(step, self._motions)
        for body, dofs in enumerate(self._dofs):
            turn = change[body, 3:] / self._arm
            if not turn.any() or not len(dofs):
                continue
            frame, arm = self._arms(before, six, body)
            old_frame, old_arm = self._marked[body]
            finite = frame.apply(Rotation.from_rotvec(turn).apply(arm) - arm)
            values[dofs] += finite - old_frame.apply(np.cross(turn, old_arm))


def turning_bodies(unknowns: Unknowns, bodies: RigidBodies, bonded: Sequence[IntArray]) -> Turning | None:
    """The bonded points of bodies, from the owned free dofs bonded to each; None if they cannot turn.

    A point in a plane of symmetry has a component that is held, which no rotation that keeps the plane moves.
    """
    motions = bodies.motions_on(unknowns.domain.axisymmetric)
    if not turning(motions):
        return None
    dofs, positions = [], []
    owned = (unknowns.u_dofs >= 0).all(axis=1) & (unknowns.u_dofs < unknowns.owned).all(axis=1)
    for of_body in bonded:  # a point is its owner's
        nodes = np.flatnonzero(owned & np.isin(unknowns.u_dofs, of_body).any(axis=1))
        dofs.append(unknowns.u_dofs[nodes])
        positions.append(np.asarray(unknowns.domain.mesh.geometry.x[nodes]))
    return Turning(dofs, positions, np.asarray(bodies.centres_mm), bodies.arm_mm, motions)
