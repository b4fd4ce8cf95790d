"""Homogeneous deformations of a material test: incompressible, any isotropic law.

The path of a test is one stretch l, along which the specimen is pulled; the third direction is free of stress:

    uniaxial     (l, l^-1/2, l^-1/2)   tensile strip; both transverse directions are free
    equibiaxial  (l, l, l^-2)          inflated membrane
    pure shear   (l, 1, 1/l)           wide strip between long clamps (planar extension)

With the pressure eliminated by the free direction the Cauchy stress along l is sigma_1 - sigma_3, and the
nominal stress (force per undeformed area) is that over l (Ogden, Non-Linear Elastic Deformations, 1984).
Per unit undeformed volume the nominal stress works on each direction that is pulled, so it is
also dW/dl along the path over the number of these directions: the second route.
Units: mm, N, MPa.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar

from analytical.arrays import FloatArray
from analytical.exact.search import STRETCH_RANGE, root
from analytical.laws.isotropic import IsotropicLaw

Mode = Literal["uniaxial", "equibiaxial", "pure shear"]
MODES: Final[tuple[Mode, ...]] = get_args(Mode)
Measure = Literal["nominal", "cauchy"]
MEASURES: Final[tuple[Measure, ...]] = get_args(Measure)

# The search for a stretch takes steps this small so that it meets the first maximum,
_SEARCH_RATIO = 1.02


class HomogeneousError(ValueError):
    """A test that cannot be done, or a stress it cannot reach; the message names value and remedy."""


@dataclass(frozen=True)
class StressCurves:
    """Stresses of the three tests over the same stretches.

    Parameters
    ----------
    stretch
        Stretch l, shape (n,).
    nominal_mpa, cauchy_mpa
        Nominal and Cauchy stress along l by test, shape (n,) each, MPa.
    """

    stretch: FloatArray
    nominal_mpa: dict[Mode, FloatArray]
    cauchy_mpa: dict[Mode, FloatArray]


def path_stretches(mode: Mode, stretch: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Principal stretches of a test at the stretch l; three arrays of the shape of `stretch`.

    Complex stretches are taken too, for derivatives by complex step.
    """
    at = np.asarray(stretch)
    if not np.all(np.isfinite(at) & (at.real > 0.0)):
        raise HomogeneousError(f"stretch = {at} must be positive and finite; 1 is undeformed")
    if mode == "uniaxial":
        return at, at**-0.5, at**-0.5
    if mode == "equibiaxial":
        return at, at, at**-2.0
    if mode == "pure shear":
        return at, np.ones_like(at), 1.0 / at
    raise HomogeneousError(f"mode = {mode!r} is unknown: say one of {', '.join(MODES)}")


def pulled_directions(mode: Mode) -> int:
    """Number of directions that are pulled to the stretch l and in which the nominal stress works."""
    return 2 if mode == "equibiaxial" else 1


def principal_stresses_mpa(
    law: IsotropicLaw, stretches: tuple[ArrayLike, ArrayLike, ArrayLike], free: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Principal Cauchy stresses at stretches of product 1 whose direction `free` carries none.

    Parameters
    ----------
    stretches
        Principal stretches; they broadcast.
    free
        Direction without stress, 0 to 2.

    Returns
    -------
    tuple of FloatArray
        Three arrays of the broadcast shape, MPa; that of `free` is zero.
    """
    if free not in (0, 1, 2):
        raise HomogeneousError(f"free = {free} is no direction: say 0, 1 or 2")
    s1, s2, s3 = (
        law.stress_difference(stretches[a], stretches[free], stretches[3 - a - free])
        if a != free
        else np.zeros(np.broadcast(*stretches).shape)
        for a in range(3)
    )
    return s1, s2, s3


def cauchy_stress_mpa(law: IsotropicLaw, mode: Mode, stretch: ArrayLike) -> FloatArray:
    """Cauchy stress along l (force per deformed area), MPa; shape of `stretch`."""
    along, across, free = path_stretches(mode, stretch)
    return law.stress_difference(along, free, across)


def nominal_stress_mpa(law: IsotropicLaw, mode: Mode, stretch: ArrayLike) -> FloatArray:
    """Nominal stress along l (force per undeformed area), MPa; shape of `stretch`."""
    return np.asarray(cauchy_stress_mpa(law, mode, stretch) / np.asarray(stretch))


def stored_energy_mpa(law: IsotropicLaw, mode: Mode, stretch: ArrayLike) -> FloatArray:
    """Stored energy per unit volume on the path, MPa (mJ/mm3); shape of `stretch`, which may be complex.

    Its derivative is the nominal stress times `pulled_directions`: the second route.
    """
    return law.energy(*path_stretches(mode, stretch))


def stress_curves(law: IsotropicLaw, stretch: ArrayLike) -> StressCurves:
    """Nominal and Cauchy stress of the three tests at the stretches l, shape (n,)."""
    at = np.atleast_1d(np.asarray(stretch, dtype=float))
    return StressCurves(
        stretch=at,
        nominal_mpa={mode: nominal_stress_mpa(law, mode, at) for mode in MODES},
        cauchy_mpa={mode: cauchy_stress_mpa(law, mode, at) for mode in MODES},
    )


def stretch_at_stress(law: IsotropicLaw, mode: Mode, stress_mpa: float, measure: Measure) -> float:
    """Stretch l at which the stress first reaches `stress_mpa`, pulled (or pushed) from the undeformed state.

    Parameters
    ----------
    stress_mpa
        Stress along l, MPa; negative in compression.
    measure
        "nominal" (per undeformed area) or "cauchy" (per deformed area); the two differ, so there is no default.

    Raises
    ------
    HomogeneousError
        Beyond the first maximum of the stress (it says how large that is), or beyond stretches 0.02 to 50.
    """
    if not math.isfinite(stress_mpa):
        raise HomogeneousError(f"stress = {stress_mpa} MPa is not a finite number")
    if measure not in MEASURES:
        raise HomogeneousError(f"measure = {measure!r} is unknown: say {' or '.join(MEASURES)}")
    if stress_mpa == 0.0:
        return 1.0
    sign = math.copysign(1.0, stress_mpa)
    of_stretch = nominal_stress_mpa if measure == "nominal" else cauchy_stress_mpa

    def excess(stretch: float) -> float:
        return sign * float(of_stretch(law, mode, stretch)) - abs(stress_mpa)

    ratio = _SEARCH_RATIO**sign
    before, near, far = 1.0, 1.0, ratio
    while STRETCH_RANGE[0] < far < STRETCH_RANGE[1]:
        if excess(far) >= 0.0:
            return root(excess, near, far)
        if excess(far) < excess(near):
            peak = _peak(excess, before, far)
            if excess(peak) >= 0.0:
                return root(excess, before, peak)
            raise HomogeneousError(
                f"{measure} {mode} stress {stress_mpa:g} MPa is beyond the first maximum of {law}, "
                f"{sign * (excess(peak) + abs(stress_mpa)):.6g} MPa at stretch {peak:.6g}: prescribe the stretch"
            )
        before, near, far = near, far, far * ratio
    raise HomogeneousError(
        f"{measure} {mode} stress {stress_mpa:g} MPa is not reached by {law} at stretches "
        f"{STRETCH_RANGE[0]:g} to {STRETCH_RANGE[1]:g}: ask for less"
    )


def _peak(function: Callable[[float], float], near: float, far: float) -> float:
    """Where the function is largest between the two; the position to 1e-8, so the value to round-off."""
    bounds = sorted((near, far))
    return float(minimize_scalar(lambda x: -function(x), bounds=bounds, method="bounded", options={"xatol": 1e-9}).x)
