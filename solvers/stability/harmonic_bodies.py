"""Rigid bodies bonded to the wall, in harmonics of the angle about an axisymmetric state.

A body follows m = 0 axially and by a spin, m = 1 laterally and by a tilt, and no other harmonic. Its slip
(`solvers.bodies.bond`) has the variations, with motions t and W, W y being the field of a rotation,

    e_v = v,  e_t = -t,  e_w = -W y,  e_vw = -W v,  e_ww = W W y,  e_tw = W t

and the second of the bond's energy is ``int T(e_i) . e_j + T(e) . e_ij``. The products of the first are those of the
harmonic, pi over the angle (2 pi at m = 0); e_ww and e_tw meet the state's traction T(e), which does not change with
the angle, so that their own averages are taken. With rotations linearised rings would seem to tilt at no cost.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl
from numpy.typing import NDArray

from solvers import compat
from solvers.bodies.bond import BondedBodies
from solvers.bodies.rigid import AXIAL, RigidBodies
from solvers.compat.known_forms import KnownForms
from solvers.discrete.domain import FloatArray
from solvers.discrete.kinematics import Kinematics
from solvers.stability.harmonic_forms import Wave

MOTIONS = 2  # of a rigid body in a harmonic: a translation, and a rotation times the arm


@dataclass(frozen=True)
class RigidMotion:
    """A rigid body's translation and rotation in a harmonic, as amplitudes along (r, z, theta).

    Attributes
    ----------
    shift
        t, the translation.
    turn
        W: the rotation's field is W y at y = (r, z, 0).
    turned_twice
        Integral of W W y over the angle by that of the harmonic's products.
    turned_shift
        The same of W t.
    """

    shift: FloatArray
    turn: FloatArray
    turned_twice: FloatArray
    turned_shift: FloatArray


# About the axis; along x and about y. e_y x (r, z) = z e_x - r cos t e_z, and e_x = (cos t, 0, -sin t).
RIGID_MOTIONS = (
    RigidMotion(
        np.array([0.0, 1.0, 0.0]),
        np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]),
        np.diag([-1.0, 0.0, 0.0]),
        np.zeros(3),
    ),
    RigidMotion(
        np.array([1.0, 0.0, -1.0]),
        np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]),
        np.diag([-1.0, -2.0, 0.0]),
        np.array([0.0, -2.0, 0.0]),
    ),
)


class HarmonicBond:
    """Forms and small dense blocks of the bonded bodies of an axisymmetric problem in a harmonic.

    Parameters
    ----------
    bonded, bodies
        The problem's bodies.
    space
        Mixed space of the harmonic's unknowns.
    kin
        Kinematics of the meridian.
    wave
        The harmonic.
    known
        Forms of the harmonics.
    """

    def __init__(
        self, bonded: BondedBodies, bodies: RigidBodies, space: Any, kin: Kinematics, wave: Wave, known: KnownForms
    ) -> None:
        self._bonded, self._bodies, self._space, self._wave = bonded, bodies, space, wave
        self._index_map = space.dofmap.index_map
        self._per_cell = known.part(compat.function_space(space.mesh, ("DG", 0)))
        self._cell_map = self._per_cell.dofmap.index_map
        self._scale = bonded.grade * wave.weight * kin.position[0]
        self._shifts = [known.constant(np.zeros(3)) for _ in range(2)]
        self._turns = [known.constant(np.zeros((3, 3))) for _ in range(2)]
        self._twice, self._mixed = known.constant(np.zeros((3, 3))), known.constant(np.zeros(3))
        self._column = known.compile("bond column", lambda: self._by_bodies["column"])
        self._block = known.compile("bond block", lambda: self._by_bodies["block"])

    @property
    def stiffness(self) -> Any:
        """What the bond adds to the tangent, in UFL."""
        v, dv = (self._wave.amplitudes(f(self._space)[0]) for f in (ufl.TestFunctions, ufl.TrialFunctions))
        return ufl.inner(self._bonded.traction(dv), v) * self._scale * self._bonded.measure

    @functools.cached_property
    def _by_bodies(self) -> dict[str, Any]:
        """Derivatives by motions of the bodies, in UFL: column with the dofs, block by cell."""
        of, scale = self._bonded, self._scale
        v, pick = self._wave.amplitudes(ufl.TestFunctions(self._space)[0]), ufl.TestFunction(self._per_cell)
        y, pull = of.arm + of.slip, of.traction(of.slip)
        e0, e1 = (-shift - turn * y for shift, turn in zip(self._shifts, self._turns, strict=True))
        second = ufl.inner(pull, self._twice * y + self._mixed)
        return {
            # W is skew: pull . (-W v) = (W pull) . v
            "column": (ufl.inner(of.traction(e0), v) + ufl.inner(self._turns[0] * pull, v)) * scale * of.measure,
            "block": (ufl.inner(of.traction(e0), e1) + second) * pick * scale * of.measure,
        }

    def held(self, waves: int) -> NDArray[np.bool_]:
        """Which motions of the bodies the harmonic does not have or a support holds, shape (bodies, 2)."""
        held = np.full((self._bonded.count, MOTIONS), waves > 1)
        if self._bodies.motions == AXIAL:
            held[:, 1] = True
            held[:, 0] |= waves == 1
        if self._bodies.plate is not None and self._bodies.plate_held:
            held[self._bodies.plate] = True
        return held

    def border(self, waves: int) -> tuple[FloatArray, FloatArray]:
        """Coupling of dofs and motions in a harmonic, all bodies added up, and the bodies' blocks.

        Returns
        -------
        tuple of ndarray
            Shapes (owned, 2) and (bodies, 2, 2); zero for harmonics that bodies do not follow.
        """
        owned, arm = self._index_map.size_local, self._bonded.arm_mm
        columns, blocks = np.zeros((owned, MOTIONS)), np.zeros((self._bonded.count, MOTIONS, MOTIONS))
        if waves >= len(RIGID_MOTIONS):
            return columns, blocks
        rigid = RIGID_MOTIONS[waves]
        for i in range(MOTIONS):
            self._aim(0, rigid, i)
            columns[:, i] = compat.assemble_array(self._column, self._index_map)
            for j in range(i + 1):
                self._aim(1, rigid, j)
                self._twice.value[:] = rigid.turned_twice / arm**2 if i + j == 2 else 0.0
                self._mixed.value[:] = rigid.turned_shift / arm if i + j == 1 else 0.0
                values = compat.assemble_array(self._block, self._cell_map)
                blocks[:, i, j] = blocks[:, j, i] = [values[cells].sum() for cells in self._bonded.cells]
        if self._bodies.plate is not None and waves == 1:
            # a plate that drifts and tilts encloses A/2 U . n more (solvers.bodies.plate)
            more = 0.5 * self._bodies.plate_area_mm2 / arm
            blocks[self._bodies.plate] -= self._bonded.load.inside_mpa() * more * np.array([[0.0, 1.0], [1.0, 0.0]])
        return columns, blocks

    def _aim(self, k: int, rigid: RigidMotion, motion: int) -> None:
        """Set direction k to a motion of the bodies."""
        self._shifts[k].value[:] = rigid.shift if motion == 0 else 0.0
        self._turns[k].value[:] = rigid.turn / self._bonded.arm_mm if motion == 1 else 0.0
