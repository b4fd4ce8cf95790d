"""Bending of a block into a circular sector with free faces: incompressible, plane strain, any isotropic law.

A block of thickness H (X in [-H/2, H/2]), length L (Y) and prescribed axial stretch lz (Z) is bent to the angle
omega; with k = omega / L

    r^2 = 2 X / (k lz) + c,   theta = k Y,   z = lz Z,   l_theta = k r,   l_r = 1 / (lz k r)

(Rivlin, Proc. R. Soc. A 195 (1949) 463). The hoop stretch is linear in r. With
w(l_theta) = W(1 / (lz l_theta), l_theta, lz), radial equilibrium d sigma_r / dr = (sigma_theta - sigma_r) / r
integrates to sigma_r = w(l_theta) - w(inner), so both faces are free if w is the same on both. Since W does not
know its arguments apart, w(l) = w(1 / (lz l)): whatever the law, the inner and outer hoop stretches have the
product 1 / lz, and the deformation is known. With y = ln(lz l_theta^2),

    sinh y = k H at the outer face, -k H at the inner one, and e^y = sqrt(1 + (k H)^2) + 2 k X between

The resultant hoop force int sigma_theta dr = [r sigma_r] vanishes by itself.
Units: mm, N, MPa; forces, moments and energies are per undeformed width (Z).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.exact.search import root
from analytical.laws.isotropic import IsotropicLaw

# Gauss-Legendre points on [-1, 1]. In y = ln(lz l_theta^2) the integrands are sums of exponentials: 48 points are
# at round-off for y up to 5 (k H = 74) and exponents alpha up to about 20.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(48)


class FlexureError(ValueError):
    """A block that cannot be bent so; the message names value and remedy."""


@dataclass(frozen=True)
class BentBlock:
    """A block and the angle it is bent to.

    Parameters
    ----------
    thickness_mm, length_mm
        Undeformed thickness H (radial when bent) and length L (along the arc), mm.
    angle_rad
        Angle of the sector, in (0, 2 pi]; at 2 pi its ends meet.
    axial_stretch
        Prescribed axial stretch lz; 1 is plane strain.
    """

    thickness_mm: float
    length_mm: float
    angle_rad: float
    axial_stretch: float = 1.0

    def __post_init__(self) -> None:
        for name, value in (("thickness_mm", self.thickness_mm), ("length_mm", self.length_mm)):
            if not 0.0 < value < math.inf:
                raise FlexureError(f"{name} = {value:g} must be positive")
        if not 0.0 < self.angle_rad <= 2.0 * math.pi:
            raise FlexureError(
                f"angle_rad = {self.angle_rad:g} must lie in (0, 2 pi]: turn the block over for a negative one"
            )
        if not 0.0 < self.axial_stretch < math.inf:
            raise FlexureError(f"axial_stretch = {self.axial_stretch:g} must be positive; 1 is plane strain")

    @property
    def angle_per_length(self) -> float:
        """Angle per undeformed length k, rad/mm."""
        return self.angle_rad / self.length_mm


def hoop_stretch(block: BentBlock, x_mm: ArrayLike) -> FloatArray:
    """Hoop stretch l_theta at undeformed X in [-H/2, H/2] (negative inside); shape of `x_mm`."""
    at = np.asarray(x_mm, dtype=float)
    if not np.all(np.abs(at) <= 0.5 * block.thickness_mm):
        raise FlexureError(f"x_mm = {at} must lie within half the thickness, {0.5 * block.thickness_mm:g} mm")
    return np.asarray(np.sqrt(np.exp(_log_square(block, at)) / block.axial_stretch))


def radius_mm(block: BentBlock, x_mm: ArrayLike) -> FloatArray:
    """Deformed radius r = l_theta / k at undeformed X, mm; shape of `x_mm`."""
    return np.asarray(hoop_stretch(block, x_mm) / block.angle_per_length)


def cauchy_stress_mpa(
    block: BentBlock, law: IsotropicLaw, x_mm: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cauchy stresses (sigma_r, sigma_theta, sigma_z) at undeformed X, free faces, MPa; shape of `x_mm`."""
    hoop = hoop_stretch(block, x_mm)
    here = np.log(block.axial_stretch * hoop**2)
    # dr / r = dy / 2 from the inner face y = -asinh(k H)
    half = 0.5 * (here + _outer_log_square(block))[..., None]
    between = here[..., None] - half * (1.0 + _POINTS)
    radial = np.sum(0.5 * half * _WEIGHTS * _hoop_minus_radial_mpa(block, law, between), axis=-1)
    axial = law.stress_difference(block.axial_stretch, 1.0 / (block.axial_stretch * hoop), hoop)
    return np.asarray(radial), radial + _hoop_minus_radial_mpa(block, law, here), radial + axial


def moment_n(block: BentBlock, law: IsotropicLaw) -> float:
    """Bending moment per undeformed width, lz int sigma_theta r dr, N mm/mm = N.

    By parts and in y it is int_0^asinh(kH) (sigma_theta - sigma_r) sinh y dy / (2 k^2), without cancellation.
    """
    half = 0.5 * _outer_log_square(block)
    y = half * (1.0 + _POINTS)
    total = np.sum(half * _WEIGHTS * _hoop_minus_radial_mpa(block, law, y) * np.sinh(y))
    return float(total / (2.0 * block.angle_per_length**2))


def stored_energy_n(block: BentBlock, law: IsotropicLaw) -> float:
    """Stored energy of the block per undeformed width, L int W dX, mJ/mm = N.

    Its derivative with respect to the angle is the moment: the second route. W includes the energy of the axial
    stretch.
    """
    half = _outer_log_square(block)
    y = half * _POINTS
    stretch = block.axial_stretch
    energy = law.energy(np.exp(-0.5 * y) * stretch**-0.5, np.exp(0.5 * y) * stretch**-0.5, stretch)
    # dX = e^y dy / (2 k)
    total = np.sum(half * _WEIGHTS * np.exp(y) * energy) / (2.0 * block.angle_per_length)
    return float(block.length_mm * total)


def neutral_fibre_mm(block: BentBlock) -> float:
    """Undeformed X of the fibre as long as before bending (hoop stretch lz^-1/2), mm; inside the middle.

    There sigma_theta = sigma_r, and sigma_r is least. It is the same for all laws: (1 - sqrt(1 + (k H)^2)) / (2 k).
    """
    return -0.5 * block.thickness_mm * math.tanh(0.5 * _outer_log_square(block))


def unstressed_fibre_mm(block: BentBlock, law: IsotropicLaw) -> float:
    """Undeformed X of the fibre without hoop stress, mm; outside the neutral fibre, and it depends on the law."""

    def hoop_stress(x_mm: float) -> float:
        return float(cauchy_stress_mpa(block, law, x_mm)[1])

    # At the neutral fibre the hoop stress is the radial one, which is compressive; at the outer face it is tensile.
    begin, end = neutral_fibre_mm(block), 0.5 * block.thickness_mm
    return root(hoop_stress, begin, end, 1e-15 * block.thickness_mm)


def _outer_log_square(block: BentBlock) -> float:
    """The value of y = ln(lz l_theta^2) at the outer face, asinh(k H)."""
    return math.asinh(block.angle_per_length * block.thickness_mm)


def _log_square(block: BentBlock, x_mm: FloatArray) -> FloatArray:
    """The value of y = ln(lz l_theta^2) at undeformed X."""
    bend = block.angle_per_length * block.thickness_mm
    # sqrt(1 + (k H)^2) - 1 without cancellation
    excess = bend**2 / (1.0 + math.hypot(1.0, bend))
    return np.log1p(excess + 2.0 * block.angle_per_length * x_mm)


def _hoop_minus_radial_mpa(block: BentBlock, law: IsotropicLaw, y: FloatArray) -> FloatArray:
    root = block.axial_stretch**-0.5
    return law.stress_difference(np.exp(0.5 * y) * root, np.exp(-0.5 * y) * root, block.axial_stretch)
