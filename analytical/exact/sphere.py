"""Exact thick-walled sphere under pressure: incompressible, any isotropic law.

Reference radii R in [A, B]. Incompressibility gives r^3 = a^3 + R^3 - A^3, so one number, the deformed inner
radius a, fixes the whole deformation: l_theta = l_phi = l = r / R, l_r = 1 / l^2. Radial equilibrium gives

    P(a) = int_{r(A)}^{r(B)} 2 (sigma_theta - sigma_r) / r dr = int_{l(B)}^{l(A)} w'(l) / (l^3 - 1) dl

with w(l) = W(l^-2, l, l), w' = 2 (sigma_theta - sigma_r) / l (Ogden, Non-linear Elastic Deformations, 1984,
section 5.3.2). The first form is used for P, the second for its slope.

`pressure` means inside minus outside throughout. Stresses are given for a free outer surface; an outer
pressure adds itself, as a hydrostatic pressure, to all of them.
Units: mm, N, MPa.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.exact.search import STRETCH_RANGE, root
from analytical.laws.isotropic import IsotropicLaw

# Gauss-Legendre points on [-1, 1]. In the variable chosen in _quadrature the integrands are analytic in a
# strip of half-width pi/3, so 96 points are at round-off for B/A up to 50 and the stretches below.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(96)

# The search for a limit point starts here, where the slope of P is still that at rest and positive,
_SEARCH_START = 1.001
# and goes in this many steps of about 1 %, far finer than the features of a smooth law.
_SEARCH_STEPS = 1001


class SphereError(ValueError):
    """A sphere that cannot exist, or a pressure it cannot carry; the message names value and remedy."""


@dataclass(frozen=True)
class Sphere:
    """Undeformed sphere.

    Parameters
    ----------
    inner_radius_mm, outer_radius_mm
        Undeformed radii A < B, mm.
    """

    inner_radius_mm: float
    outer_radius_mm: float

    def __post_init__(self) -> None:
        if not 0.0 < self.inner_radius_mm < self.outer_radius_mm < math.inf:
            raise SphereError(
                f"radii {self.inner_radius_mm:g}, {self.outer_radius_mm:g} mm: need 0 < inner < outer < inf"
            )


@dataclass(frozen=True)
class LimitPoint:
    """First maximum of the pressure on inflation: deformed inner radius a, mm, and pressure, MPa."""

    inner_mm: float
    pressure_mpa: float


def deformed_radius_mm(sphere: Sphere, inner_mm: float, radius_mm: ArrayLike) -> FloatArray:
    """Deformed radius r of the particles at undeformed radius R, mm; shape of `radius_mm`."""
    _require_bore(inner_mm)
    radius, inner = np.asarray(radius_mm, dtype=float), sphere.inner_radius_mm
    # R^3 - A^3 as a product: next to a collapsed bore it is as small as a^3 and must not be a difference
    return np.asarray(np.cbrt(inner_mm**3 + (radius - inner) * (radius**2 + radius * inner + inner**2)))


def radial_displacement_mm(sphere: Sphere, inner_mm: float, radius_mm: ArrayLike) -> FloatArray:
    """Radial displacement u = r - R at undeformed radius R, mm; shape of `radius_mm`."""
    return np.asarray(deformed_radius_mm(sphere, inner_mm, radius_mm) - np.asarray(radius_mm, dtype=float))


def pressure_at_inner_radius_mpa(sphere: Sphere, law: IsotropicLaw, inner_mm: float) -> float:
    """Pressure P (inside minus outside) that holds the inner radius at a, MPa."""
    radius, deformed, weight = _quadrature(sphere, inner_mm, sphere.inner_radius_mm)
    return float(np.sum(weight * 2.0 * _hoop_minus_radial(law, deformed / radius)))


def inner_radius_at_pressure_mm(sphere: Sphere, law: IsotropicLaw, pressure_mpa: float) -> float:
    """Deformed inner radius a at the pressure `pressure_mpa` (inside minus outside), mm.

    On the branch that starts at rest: up to the limit point, if there is one.

    Raises
    ------
    SphereError
        If the pressure is beyond the limit point, or beyond inner stretches between 0.02 and 50.
    """
    if not math.isfinite(pressure_mpa):
        raise SphereError(f"pressure = {pressure_mpa} MPa is not a finite number")
    rest = sphere.inner_radius_mm
    # Up to round-off, which is what is left of the pressure at rest.
    if abs(pressure_mpa) <= abs(pressure_at_inner_radius_mpa(sphere, law, rest)):
        return rest
    if pressure_mpa < 0.0:
        end, what = STRETCH_RANGE[0] * rest, "collapse"
    else:
        limit = limit_point(sphere, law)
        end, what = (limit.inner_mm, "limit point") if limit else (STRETCH_RANGE[1] * rest, "inflation")
    largest = pressure_at_inner_radius_mpa(sphere, law, end)
    if abs(pressure_mpa) > abs(largest):
        raise SphereError(
            f"pressure {pressure_mpa:g} MPa is beyond the {what} of {law} in this sphere, {largest:g} MPa at inner "
            f"radius {end:g} mm: prescribe the inner radius instead"
        )
    return root(
        lambda a: pressure_at_inner_radius_mpa(sphere, law, a) - pressure_mpa, rest, end, 1e-14 * min(rest, end)
    )


def inner_radius_beyond_limit_mm(sphere: Sphere, law: IsotropicLaw, pressure_mpa: float) -> float:
    """Deformed inner radius a at a pressure above the limit point's, mm: to which a sphere under pressure snaps.

    The first one beyond the limit point at which the pressure has risen to `pressure_mpa` again.

    Raises
    ------
    SphereError
        If there is no limit point, the pressure is not above its, or no inner stretch up to 50 carries it.
    """
    limit = limit_point(sphere, law)
    if limit is None or not limit.pressure_mpa < pressure_mpa < math.inf:
        where = "there is none" if limit is None else f"it is {limit.pressure_mpa:g} MPa"
        raise SphereError(
            f"pressure {pressure_mpa:g} MPa is not above a limit point of {law} in this sphere ({where}): ask for the "
            "state that begins at rest"
        )
    stretches = np.geomspace(limit.inner_mm / sphere.inner_radius_mm, STRETCH_RANGE[1], _SEARCH_STEPS)
    pressures = [pressure_at_inner_radius_mpa(sphere, law, at * sphere.inner_radius_mm) for at in stretches[1:]]
    above = np.flatnonzero(np.array(pressures) >= pressure_mpa)
    if not above.size:
        raise SphereError(
            f"pressure {pressure_mpa:g} MPa: beyond its limit point {law} does not carry it in this sphere either, "
            f"up to an inner stretch of {STRETCH_RANGE[1]:g}: ask for less than {limit.pressure_mpa:g} MPa"
        )
    near, far = stretches[above[0]] * sphere.inner_radius_mm, stretches[above[0] + 1] * sphere.inner_radius_mm
    return root(lambda a: pressure_at_inner_radius_mpa(sphere, law, a) - pressure_mpa, near, far, 1e-14 * far)


def limit_point(sphere: Sphere, law: IsotropicLaw) -> LimitPoint | None:
    """First maximum of the pressure on inflation, or None if there is none up to an inner stretch of 50."""
    stretches = np.geomspace(_SEARCH_START, STRETCH_RANGE[1], _SEARCH_STEPS)
    falling = np.flatnonzero(_pressure_slope(sphere, law, stretches) < 0.0)
    if not falling.size:
        return None
    first = falling[0]
    # flat there: the stretch is known to 1e-8 from the pressure, which is what counts
    stretch = root(lambda at: _pressure_slope(sphere, law, at), stretches[first - 1], stretches[first], 2e-12)
    inner_mm = stretch * sphere.inner_radius_mm
    return LimitPoint(inner_mm, pressure_at_inner_radius_mpa(sphere, law, inner_mm))


def cauchy_stress_mpa(
    sphere: Sphere, law: IsotropicLaw, inner_mm: float, radius_mm: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Cauchy stresses (sigma_r, sigma_theta = sigma_phi) at undeformed radius R, free outer surface.

    Parameters
    ----------
    inner_mm
        Deformed inner radius a, mm.
    radius_mm
        Undeformed radii R in [A, B], mm, any shape.

    Returns
    -------
    tuple of FloatArray
        Two arrays of the shape of `radius_mm`, MPa.
    """
    at = np.asarray(radius_mm, dtype=float)
    radius, deformed, weight = _quadrature(sphere, inner_mm, at)
    radial = -np.sum(weight * 2.0 * _hoop_minus_radial(law, deformed / radius), axis=-1)
    hoop = radial + _hoop_minus_radial(law, deformed_radius_mm(sphere, inner_mm, at) / at)
    return np.asarray(radial), np.asarray(hoop)


def hydrostatic_pressure_mpa(sphere: Sphere, law: IsotropicLaw, inner_mm: float, radius_mm: ArrayLike) -> FloatArray:
    """Hydrostatic pressure -tr(sigma)/3 at undeformed radius R, MPa, positive in compression.

    Minus the pressure multiplier of a mixed element whose energy is split, W(J^(-1/3) F) + p (J - 1).
    """
    radial, hoop = cauchy_stress_mpa(sphere, law, inner_mm, radius_mm)
    return -(radial + 2.0 * hoop) / 3.0


def stored_energy_mj(sphere: Sphere, law: IsotropicLaw, inner_mm: float) -> float:
    """Stored energy, mJ = N mm. Its derivative with respect to 4/3 pi a^3 is the pressure: the second route."""
    radius, deformed, weight = _quadrature(sphere, inner_mm, sphere.inner_radius_mm)
    hoop = deformed / radius
    # 4 pi R^2 dR = 4 pi r^3 d(ln r)
    return float(4.0 * math.pi * np.sum(weight * deformed**3 * law.energy(hoop**-2.0, hoop, hoop)))


def _require_bore(inner_mm: float) -> None:
    if not 0.0 < inner_mm < math.inf:
        raise SphereError(f"deformed inner radius = {inner_mm:g} mm must be positive")


def _hoop_minus_radial(law: IsotropicLaw, hoop: ArrayLike) -> FloatArray:
    stretch = np.asarray(hoop)
    return law.stress_difference(stretch, stretch**-2.0, stretch)


def _pressure_slope(sphere: Sphere, law: IsotropicLaw, inner_stretch: ArrayLike) -> FloatArray:
    """A slope dP/d(a/A) over (a/A)^2, MPa, at inner stretches other than 1; it has the sign of the slope.

    From the second form of P in the heading, with l_b^2 dl_b = (A/B)^3 l_a^2 dl_a.
    """
    cubed = (sphere.inner_radius_mm / sphere.outer_radius_mm) ** 3
    inner = np.asarray(inner_stretch)
    outer = np.cbrt(1.0 + cubed * (inner**3 - 1.0))

    def density(stretch: FloatArray) -> FloatArray:
        return 2.0 * _hoop_minus_radial(law, stretch) / (stretch**3 * (stretch**3 - 1.0))

    # An exponential law is infinite before limit points are sought no further: no sign there, hence no limit point.
    with np.errstate(over="ignore", invalid="ignore"):
        return density(inner) - cubed * density(outer)


def _quadrature(
    sphere: Sphere, inner_mm: float, from_radius_mm: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points R, r and weights of d(ln r) from undeformed radius `from_radius_mm` to B; shape (..., 96)."""
    begin = np.asarray(from_radius_mm, dtype=float)[..., None]
    deformed_begin = deformed_radius_mm(sphere, inner_mm, begin)
    # R^3 - r^3 is the same for all particles. Negative (inflated): as a function of ln R, r vanishes only
    # pi/3 away from the real axis. Positive (collapsed): R does, as a function of ln r.
    if inner_mm >= sphere.inner_radius_mm:
        half = 0.5 * np.log(sphere.outer_radius_mm / begin)
        radius = begin * np.exp(half * (1.0 + _POINTS))
        deformed = deformed_radius_mm(sphere, inner_mm, radius)
        return radius, deformed, half * _WEIGHTS * (radius / deformed) ** 3
    deformed_outer = deformed_radius_mm(sphere, inner_mm, sphere.outer_radius_mm)
    half = 0.5 * np.log(deformed_outer / deformed_begin)
    deformed = deformed_begin * np.exp(half * (1.0 + _POINTS))
    radius = np.cbrt(sphere.inner_radius_mm**3 + deformed**3 - inner_mm**3)
    return radius, deformed, half * _WEIGHTS
