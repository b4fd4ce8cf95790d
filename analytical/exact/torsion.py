"""Torsion and extension of a solid cylinder with a free lateral surface: incompressible, any isotropic law.

    r = R / sqrt(lz),  theta = Theta + psi Z,  z = lz Z

The twist psi is in radians per UNDEFORMED length (per deformed length it is psi / lz), so that torque and axial
force are the derivatives of the stored energy per undeformed length with respect to psi and lz. In the (theta, z)
plane the left Cauchy-Green tensor is (Rivlin, Phil. Trans. R. Soc. A 242 (1949) 173)

    B_tt = 1/lz + (r psi)^2,   B_tz = r psi lz,   B_zz = lz^2

The radial stretch is lz^-1/2; the other two, of product sqrt(lz), follow from the squares of their sum and
difference, 1/lz + (r psi)^2 + lz^2 +- 2 sqrt(lz), and their directions from the angle of (B_zz - B_tt, 2 B_tz):
no cubic, and nothing singular on the axis, where they coincide if lz = 1. Radial equilibrium gives

    sigma_r(r) = - int_r^{r(A)} (sigma_theta - sigma_r) / r dr
    M = 2 pi int sigma_tz r^2 dr,   N = pi int (2 (sigma_z - sigma_r) - (sigma_theta - sigma_r)) r dr

the last by parts. Units: mm, N, MPa; twist in rad/mm, torque in N mm.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.exact.search import STRETCH_RANGE, root
from analytical.laws.isotropic import IsotropicLaw

# Gauss-Legendre points on [-1, 1]. The integrands are analytic in r up to r psi = +-i (lz + lz^-1/2), so 48 points
# are at round-off up to surface shears r psi of about 10.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(48)

# The search for an axial stretch takes steps this small so that it meets the first of several solutions,
_SEARCH_RATIO = 1.02


class TorsionError(ValueError):
    """A cylinder that cannot exist, or a force it cannot carry; the message names value and remedy."""


@dataclass(frozen=True)
class TwistedCylinder:
    """A cylinder and its deformation.

    Parameters
    ----------
    radius_mm
        Undeformed radius A, mm.
    twist_rad_per_mm
        Twist psi per undeformed length, rad/mm; either sign.
    axial_stretch
        Axial stretch lz.
    """

    radius_mm: float
    twist_rad_per_mm: float
    axial_stretch: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.radius_mm < math.inf:
            raise TorsionError(f"radius_mm = {self.radius_mm:g} must be positive")
        if not math.isfinite(self.twist_rad_per_mm):
            raise TorsionError(f"twist_rad_per_mm = {self.twist_rad_per_mm} is not a finite number")
        if not 0.0 < self.axial_stretch < math.inf:
            raise TorsionError(f"axial_stretch = {self.axial_stretch:g} must be positive; 1 keeps the length")


@dataclass(frozen=True)
class TorsionStress:
    """Cauchy stresses, MPa, all of one shape; sigma_r_theta and sigma_rz are zero."""

    radial_mpa: FloatArray
    hoop_mpa: FloatArray
    axial_mpa: FloatArray
    shear_mpa: FloatArray


def principal_stretches(cylinder: TwistedCylinder, radius_mm: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Principal stretches (radial, largest in the theta-z plane, smallest there) at undeformed radius R."""
    at = np.asarray(radius_mm, dtype=float)
    stretch = cylinder.axial_stretch
    shear = at * cylinder.twist_rad_per_mm / math.sqrt(stretch)
    total = np.hypot(stretch + stretch**-0.5, shear)
    difference = np.hypot(stretch - stretch**-0.5, shear)
    largest = 0.5 * (total + difference)
    # From the product: the difference of the two roots would cancel at large shear.
    return np.full(at.shape, stretch**-0.5), largest, math.sqrt(stretch) / largest


def cauchy_stress_mpa(cylinder: TwistedCylinder, law: IsotropicLaw, radius_mm: ArrayLike) -> TorsionStress:
    """Cauchy stresses at undeformed radii R in [0, A] of any shape, free lateral surface."""
    at = np.asarray(radius_mm, dtype=float)
    if not np.all((at >= 0.0) & (at <= cylinder.radius_mm)):
        raise TorsionError(f"radius_mm = {at} must lie in 0 to {cylinder.radius_mm:g} mm")
    half = 0.5 * (cylinder.radius_mm - at[..., None])
    between = at[..., None] + half * (1.0 + _POINTS)
    # d ln r = d ln R
    radial = -np.sum(half * _WEIGHTS / between * _over_radial_mpa(cylinder, law, between)[0], axis=-1)
    hoop, axial, shear = _over_radial_mpa(cylinder, law, at)
    return TorsionStress(np.asarray(radial), radial + hoop, radial + axial, shear)


def torque_nmm(cylinder: TwistedCylinder, law: IsotropicLaw) -> float:
    """Torque M = 2 pi int sigma_theta_z r^2 dr that holds the twist, N mm."""
    radius, weight = _quadrature(cylinder)
    shear = _over_radial_mpa(cylinder, law, radius)[2]
    return float(2.0 * math.pi * np.sum(weight * radius**2 * shear) * cylinder.axial_stretch**-1.5)


def axial_force_n(cylinder: TwistedCylinder, law: IsotropicLaw) -> float:
    """Axial force N = 2 pi int sigma_z r dr that holds the axial stretch, N, positive in tension.

    At lz = 1 most laws need compression: left free, the cylinder grows longer (Poynting effect). To second order it
    is -pi mu psi^2 A^4 (6 - alpha) / 16 for Ogden laws, and as for alpha = 2 for laws of I1 alone.
    """
    radius, weight = _quadrature(cylinder)
    hoop, axial, _ = _over_radial_mpa(cylinder, law, radius)
    return float(math.pi * np.sum(weight * radius * (2.0 * axial - hoop)) / cylinder.axial_stretch)


def stored_energy_n(cylinder: TwistedCylinder, law: IsotropicLaw) -> float:
    """Stored energy per unit undeformed length, mJ/mm = N.

    Its derivative with respect to the twist (at fixed lz) is the torque, and with respect to lz (at fixed twist)
    the axial force: the second route to both.
    """
    radius, weight = _quadrature(cylinder)
    return float(2.0 * math.pi * np.sum(weight * radius * law.energy(*principal_stretches(cylinder, radius))))


def free_axial_stretch(radius_mm: float, twist_rad_per_mm: float, law: IsotropicLaw) -> float:
    """Axial stretch lz at which the twisted cylinder needs no axial force (twist per undeformed length).

    The first solution met from lz = 1.

    Raises
    ------
    TorsionError
        If there is none between 0.02 and 50.
    """

    def force(axial_stretch: float) -> float:
        return axial_force_n(TwistedCylinder(radius_mm, twist_rad_per_mm, axial_stretch), law)

    at_length = force(1.0)
    if at_length == 0.0:
        return 1.0
    ratio = _SEARCH_RATIO if at_length < 0.0 else 1.0 / _SEARCH_RATIO
    near, far = 1.0, ratio
    while STRETCH_RANGE[0] < far < STRETCH_RANGE[1]:
        if force(far) * at_length <= 0.0:
            return root(force, near, far)
        near, far = far, far * ratio
    raise TorsionError(
        f"twist {twist_rad_per_mm:g} rad/mm leaves {law} of radius {radius_mm:g} mm no axial stretch without force "
        f"between {STRETCH_RANGE[0]:g} and {STRETCH_RANGE[1]:g}: prescribe the axial stretch"
    )


def _quadrature(cylinder: TwistedCylinder) -> tuple[FloatArray, FloatArray]:
    """Points R and weights of dR over [0, A]; shape (48,)."""
    half = 0.5 * cylinder.radius_mm
    return half * (1.0 + _POINTS), half * _WEIGHTS


def _over_radial_mpa(
    cylinder: TwistedCylinder, law: IsotropicLaw, radius_mm: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Stresses sigma_theta - sigma_r, sigma_z - sigma_r and sigma_theta_z at undeformed radius R, MPa."""
    radial, largest, smallest = principal_stretches(cylinder, radius_mm)
    over = law.stress_difference(largest, radial, smallest)
    under = law.stress_difference(smallest, radial, largest)
    difference = law.stress_difference(largest, smallest, radial)
    stretch = cylinder.axial_stretch
    shear = radius_mm * cylinder.twist_rad_per_mm / math.sqrt(stretch)
    # Stress and B are coaxial. arctan2(0, 0) = 0 does on the axis: there the difference vanishes with the angle's
    # meaning.
    angle = np.arctan2(2.0 * shear * stretch, stretch**2 - 1.0 / stretch - shear**2)
    mean, half = 0.5 * (over + under), 0.5 * difference
    return mean - half * np.cos(angle), mean + half * np.cos(angle), half * np.sin(angle)
