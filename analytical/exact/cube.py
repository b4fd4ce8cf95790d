"""Rivlin's cube: a unit cube pulled by the same dead force on all six faces; incompressible, any isotropic law.

T is the nominal normal traction (force per undeformed area, fixed in size and direction) on every face. Per
unit undeformed volume the total potential is

    Phi(F) = W(F) - T tr F,    det F = 1

(Rivlin, Phil. Trans. R. Soc. A 240 (1948) 491 and Q. Appl. Math. 32 (1974) 265; Ball and Schaeffer, Math. Proc.
Camb. Phil. Soc. 94 (1983) 315). The undeformed cube is in equilibrium at every T. The other equilibria with
two equal stretches are (l, l, l^-2): plates (l > 1) and rods (l < 1), on which, with W_a = dW/dl_a,

    T(l) = (l W_1 - l^-2 W_3) / (l - l^-2),    T(1) = 2 mu

Neo-Hooke: T = mu (l + l^-2), least at l^3 = 2 where T = 3 mu / 2^(2/3) = 1.8899 mu. Below that the undeformed
cube is the only equilibrium, above T = 2 mu it is unstable.

Stability is decided by the second variation of Phi. Perturbed as exp(eps H) F with tr H = 0 the volume is kept
exactly, so no multiplier is needed: the 9 components of H less the trace are 8 modes. With h the Hessian of W
in the log stretches the off-diagonal pair H_ij, H_ji has the stiffnesses

    l_i  = l_j:  shear h_ii - h_ij - T l_i,   rotation T l_i
    l_i != l_j:  0 (turning the deformed shape in the cube costs nothing),   T (l_i^2 + l_j^2) / (l_i + l_j)

and the two stretching modes those of h_ab - T l_a delta_ab on increments of zero sum. At l = 1 five of the
eight are 2 mu - T: all traceless symmetric H go unstable together. T < 0 makes the three rotations unstable.
Equilibria with three distinct stretches, which some laws have (not neo-Hooke), are not sought; where they leave
a branch, its in-plane stiffness passes through zero.
Units: mm, N, MPa.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.exact.search import root
from analytical.laws.isotropic import IsotropicLaw

# Branches are searched over these stretches, beyond what elastomers bear,
_STRETCH_RANGE = (0.1, 10.0)
# in steps of 1 % or less; two equilibria closer than that are told apart only at the tangent point.
_SEARCH_POINTS = 512
# Where the branch crosses the undeformed cube, T(l) is known to 1e-16 / |l - 1|: closer than this they are one.
_CROSSING = 1e-6
# Tensions are equal if they differ by less than this part of 2 mu: above the round-off of a T(l) that is the same
# at every l, far below what a T(l) that varies does over one search step.
_EQUAL_TENSION = 1e-9
# A state is taken as an equilibrium if its tension is right to this part of 2 mu: round-off next to the crossing is
# 1e-10, and stiffnesses are no better known than their state.
_EQUILIBRIUM = 1e-8


class CubeError(ValueError):
    """A cube that cannot exist, or a point its branches do not have; the message names value and remedy."""


@dataclass(frozen=True)
class CubeState:
    """An equilibrium with stretches (l, l, l^-2).

    Parameters
    ----------
    tension_mpa
        Dead nominal traction T on every face, MPa.
    stretch
        The double stretch l: 1 is the undeformed cube, above 1 a plate, below 1 a rod.
    """

    tension_mpa: float
    stretch: float

    def __post_init__(self) -> None:
        if not math.isfinite(self.tension_mpa):
            raise CubeError(f"tension_mpa = {self.tension_mpa} is not a finite number")
        _stretches(self.stretch)

    @property
    def stretches(self) -> tuple[float, float, float]:
        """Principal stretches (l, l, l^-2)."""
        return self.stretch, self.stretch, self.stretch**-2


def trivial_limit_mpa(law: IsotropicLaw) -> float:
    """Tension above which the undeformed cube is unstable, MPa: h_11 - h_12 at rest, that is 2 mu."""
    hessian = law.log_hessian_mpa(1.0, 1.0, 1.0)
    return float(hessian[0, 0] - hessian[0, 1])


def branch_tension_mpa(law: IsotropicLaw, stretch: ArrayLike) -> FloatArray:
    """Tension T(l) at which (l, l, l^-2) is in equilibrium, MPa, T(1) = 2 mu; shape of `stretch`.

    Close to l = 1 it is a ratio of small differences: its relative error is round-off over the strain.
    """
    at = _stretches(stretch)
    difference = law.stress_difference(at, at**-2.0, at)
    gap = at - at**-2.0
    limit = np.full(at.shape, trivial_limit_mpa(law))
    return np.divide(difference, gap, out=limit, where=gap != 0.0)


def tangent_point(law: IsotropicLaw) -> CubeState:
    """Where the branch turns back: the least T next to T = 2 mu, from which plate and rod equilibria exist.

    It lies on the side to which T(l) falls from l = 1: plates for most laws (neo-Hooke l^3 = 2), rods for others
    (Ogden with alpha < 1).

    Raises
    ------
    CubeError
        If T(l) does not fall and turn back between l = 0.1 and 10 (Ogden with alpha = 1: T is the same for all l).
    """

    def slope(stretch: ArrayLike) -> FloatArray:
        return _axial_stiffness_mpa(law, stretch, branch_tension_mpa(law, stretch))

    for end in _STRETCH_RANGE[::-1]:
        # Without l = 1 itself, a double root.
        grid = np.geomspace(1.0, end, _SEARCH_POINTS // 2)[1:]
        slopes = slope(grid)
        turns = np.flatnonzero((slopes[:-1] < 0.0) & (slopes[1:] >= 0.0))
        if slopes[0] < -_EQUAL_TENSION * trivial_limit_mpa(law) and turns.size:
            stretch = root(slope, grid[turns[0]], grid[turns[0] + 1])
            return CubeState(float(branch_tension_mpa(law, stretch)), stretch)
    raise CubeError(
        f"the branch of {law} has no tangent point at stretches {_STRETCH_RANGE[0]:g} to {_STRETCH_RANGE[1]:g}: "
        "its tension does not fall from 2 mu and rise again; read branch_tension_mpa"
    )


def equilibria(law: IsotropicLaw, tension_mpa: float) -> tuple[CubeState, ...]:
    """All equilibria with two equal stretches at a tension, by increasing l between 0.1 and 10.

    The undeformed cube is always one of them.

    Raises
    ------
    CubeError
        If every stretch is in equilibrium (Ogden with alpha = 1 at T = 2 mu).
    """
    undeformed = CubeState(tension_mpa, 1.0)
    # An even count of points has none at l = 1.
    grid = np.geomspace(*_STRETCH_RANGE, _SEARCH_POINTS)
    with suppress(CubeError):  # a branch that does not turn back has no close pairs to miss
        grid = np.sort(np.append(grid, tangent_point(law).stretch))

    def excess(stretch: ArrayLike) -> FloatArray:
        return branch_tension_mpa(law, stretch) - tension_mpa

    values = excess(grid)
    if np.abs(values).max() < _EQUAL_TENSION * trivial_limit_mpa(law):
        raise CubeError(f"at T = {tension_mpa:g} MPa every (l, l, l^-2) of {law} is in equilibrium: ask for another T")
    crossings = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    roots = [root(excess, grid[k], grid[k + 1]) for k in crossings] + list(grid[values == 0.0])
    states = [undeformed, *(CubeState(tension_mpa, float(root)) for root in roots if abs(root - 1.0) > _CROSSING)]
    return tuple(sorted(states, key=lambda state: state.stretch))


def mode_stiffnesses_mpa(law: IsotropicLaw, state: CubeState) -> FloatArray:
    """Second variation of Phi in the 8 isochoric modes of an equilibrium, shape (8,), MPa.

    Per unit undeformed volume and unit Frobenius norm of H: one axial mode (1, 1, -2), the two stretching and
    shearing modes in the 12-plane (equal by isotropy), the two shears out of that plane, the rotation in it and
    the two rotations out of it. Negative is unstable, exact zeros are neutral.

    Raises
    ------
    CubeError
        If the state is not in equilibrium.
    """
    tension, (l1, _, l3) = state.tension_mpa, state.stretches
    needed = float(branch_tension_mpa(law, l1))
    if l1 != 1.0 and abs(needed - tension) > _EQUILIBRIUM * trivial_limit_mpa(law):
        raise CubeError(f"{state} is no equilibrium of {law}: it needs T = {needed:.9g} MPa (branch_tension_mpa)")
    hessian = law.log_hessian_mpa(*state.stretches)
    axial = float(_axial_stiffness_mpa(law, l1, tension))
    in_plane = float(hessian[0, 0] - hessian[0, 1]) - tension * l1
    out_of_plane = in_plane if l1 == l3 else 0.0
    tilt = tension * (l1**2 + l3**2) / (l1 + l3)
    return np.array([axial, in_plane, in_plane, out_of_plane, out_of_plane, tension * l1, tilt, tilt])


def unstable_modes(law: IsotropicLaw, state: CubeState) -> int:
    """Number of unstable modes of an equilibrium under dead tension, 0 to 8."""
    return int(np.count_nonzero(mode_stiffnesses_mpa(law, state) < 0.0))


def total_potential_mpa(law: IsotropicLaw, tension_mpa: float, deformation_gradient: ArrayLike) -> FloatArray:
    """Total potential Phi(F) = W - T tr F per unit undeformed volume, MPa; F of shape (..., 3, 3), det F = 1.

    Its second differences along exp(eps H) F are the mode stiffnesses: the second route.
    """
    gradient = np.asarray(deformation_gradient, dtype=float)
    stretches = np.moveaxis(np.linalg.svd(gradient, compute_uv=False), -1, 0)
    return np.asarray(law.energy(*stretches) - tension_mpa * np.trace(gradient, axis1=-2, axis2=-1))


def _stretches(stretch: ArrayLike) -> FloatArray:
    at = np.asarray(stretch, dtype=float)
    if not np.all(np.isfinite(at) & (at > 0.0)):
        raise CubeError(f"stretch = {at} must be positive and finite; 1 is the undeformed cube")
    return at


def _axial_stiffness_mpa(law: IsotropicLaw, stretch: ArrayLike, tension_mpa: ArrayLike) -> FloatArray:
    """Second variation along (1, 1, -2) / sqrt(6) at (l, l, l^-2), MPa; on the branch dT/dl times (l - l^-2) l / 3."""
    at = _stretches(stretch)
    h = law.log_hessian_mpa(at, at, at**-2.0)
    rise = h[..., 0, 0] + h[..., 0, 1] - 4.0 * h[..., 0, 2] + 2.0 * h[..., 2, 2]
    return np.asarray((rise - np.asarray(tension_mpa) * (at + 2.0 * at**-2.0)) / 3.0)
