"""Exact thick-walled tube under pressure: incompressible, any isotropic law.

Reference radii R in [A, B], axial stretch lz. Incompressibility gives r^2 = a^2 + (R^2 - A^2) / lz, so one
number, the deformed inner radius a, fixes the whole deformation: l_theta = r / R, l_r = R / (lz r). Radial
equilibrium, eq. (5) of Heung et al. 2024 (DOI 10.3390/biomimetics9030160), gives the pressure:

    P(a) = int_{r(A)}^{r(B)} (sigma_theta - sigma_r) / r dr

`pressure` means inside minus outside throughout. Stresses are given for a free outer surface; an outer
pressure adds itself, as a hydrostatic pressure, to all of them. Plane strain is lz = 1.

The axial stretch is prescribed, or follows from the ends (`state_at_pressure`, `state_at_inner_radius`):

    capped : the ends are closed, unheld, and the pressure pushes on them: N = P pi a^2
    free   : the pressure acts on the lateral wall only: N = 0

with N the axial force in the wall, `axial_force_n`.
Units: mm, N, MPa.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.exact.search import STRETCH_RANGE, first_solution
from analytical.laws.isotropic import IsotropicLaw

Ends = Literal["capped", "free"]
ENDS: Final[tuple[Ends, ...]] = get_args(Ends)

# Gauss-Legendre points on [-1, 1]. In the variable chosen in _quadrature the integrands are analytic in a
# strip of half-width pi/2, so 48 points are at round-off for walls up to B/A = 100.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(48)


class TubeError(ValueError):
    """A tube that cannot exist, or a pressure it cannot carry; the message names value and remedy."""


@dataclass(frozen=True)
class Tube:
    """Undeformed tube and its axial stretch.

    Parameters
    ----------
    inner_radius_mm, outer_radius_mm
        Undeformed radii A < B, mm.
    axial_stretch
        Prescribed axial stretch lz; 1 is plane strain.
    """

    inner_radius_mm: float
    outer_radius_mm: float
    axial_stretch: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.inner_radius_mm < self.outer_radius_mm < math.inf:
            raise TubeError(
                f"radii {self.inner_radius_mm:g}, {self.outer_radius_mm:g} mm: need 0 < inner < outer < inf"
            )
        if not 0.0 < self.axial_stretch < math.inf:
            raise TubeError(f"axial_stretch = {self.axial_stretch:g} must be positive; 1 is plane strain")


@dataclass(frozen=True)
class TubeState:
    """Equilibrium of a tube whose length was not prescribed.

    Attributes
    ----------
    tube
        The tube with the axial stretch that its ends leave it; what the functions for stresses take.
    inner_mm
        Deformed inner radius a, mm.
    pressure_mpa
        Pressure P (inside minus outside), MPa.
    """

    tube: Tube
    inner_mm: float
    pressure_mpa: float


def deformed_radius_mm(tube: Tube, inner_mm: float, radius_mm: ArrayLike) -> FloatArray:
    """Deformed radius r of the particles at undeformed radius R, mm; shape of `radius_mm`."""
    _require_bore(inner_mm)
    area = np.asarray(radius_mm, dtype=float) ** 2 - tube.inner_radius_mm**2
    return np.asarray(np.sqrt(inner_mm**2 + area / tube.axial_stretch))


def radial_displacement_mm(tube: Tube, inner_mm: float, radius_mm: ArrayLike) -> FloatArray:
    """Radial displacement u = r - R at undeformed radius R, mm; shape of `radius_mm`."""
    return np.asarray(deformed_radius_mm(tube, inner_mm, radius_mm) - np.asarray(radius_mm, dtype=float))


def inner_radius_at_outer_mm(tube: Tube, outer_mm: float) -> float:
    """Deformed inner radius a at which the outer radius is `outer_mm`, mm."""
    wall_area = (tube.outer_radius_mm**2 - tube.inner_radius_mm**2) / tube.axial_stretch
    if outer_mm**2 <= wall_area:
        raise TubeError(
            f"deformed outer radius {outer_mm:g} mm leaves no bore: the wall alone fills {math.sqrt(wall_area):g} mm"
        )
    return math.sqrt(outer_mm**2 - wall_area)


def pressure_at_inner_radius_mpa(tube: Tube, law: IsotropicLaw, inner_mm: float) -> float:
    """Pressure P (inside minus outside) that holds the inner radius at a, MPa."""
    radius, deformed, weight = _quadrature(tube, inner_mm, tube.inner_radius_mm)
    return float(np.sum(weight * _hoop_minus_radial(tube, law, radius, deformed)))


def inner_radius_at_pressure_mm(tube: Tube, law: IsotropicLaw, pressure_mpa: float) -> float:
    """Deformed inner radius a at the pressure `pressure_mpa` (inside minus outside), mm.

    The first solution met when the tube is inflated (or, for a negative pressure, collapsed) from the
    unpressurised state at its axial stretch.

    Raises
    ------
    TubeError
        If no inner stretch between 0.02 and 50 carries the pressure; some laws (neo-Hooke among them) have
        a largest pressure.
    """
    if not math.isfinite(pressure_mpa):
        raise TubeError(f"pressure = {pressure_mpa} MPa is not a finite number")
    # Radially free: with lr = lt = lz^-1/2 everywhere both stresses are equal and the pressure is zero.
    start = tube.inner_radius_mm / math.sqrt(tube.axial_stretch)
    # Up to round-off, which is what is left of the pressure there.
    if abs(pressure_mpa) <= abs(pressure_at_inner_radius_mpa(tube, law, start)):
        return start
    bounds = (STRETCH_RANGE[0] * tube.inner_radius_mm, STRETCH_RANGE[1] * tube.inner_radius_mm)
    root, furthest = first_solution(lambda a: pressure_at_inner_radius_mpa(tube, law, a), start, bounds, pressure_mpa)
    if root is None:
        raise _beyond(law, pressure_mpa, furthest)
    return root


def state_at_inner_radius(tube: Tube, law: IsotropicLaw, inner_mm: float, ends: Ends) -> TubeState:
    """Axial stretch and pressure that hold the inner radius at a, with the ends as given.

    Of several axial stretches it is the first met on the way from 1. A negative pressure is one from outside,
    which then acts on the end faces of the wall as well: with "free" ends N = 0 is the excess over it.

    Parameters
    ----------
    tube
        Undeformed tube; its axial stretch is left aside.
    inner_mm
        Deformed inner radius a, mm.
    ends
        "capped" (N = P pi a^2) or "free" (N = 0).

    Raises
    ------
    TubeError
        If no axial stretch between 0.02 and 50 balances the ends.
    """
    if ends not in ENDS:
        raise TubeError(f"ends = {ends!r} is unknown: say " + " or ".join(f'"{name}"' for name in ENDS))

    def excess_n(axial_stretch: float) -> float:
        at = replace(tube, axial_stretch=axial_stretch)
        thrust = math.pi * inner_mm**2 * pressure_at_inner_radius_mpa(at, law, inner_mm) if ends == "capped" else 0.0
        return axial_force_n(at, law, inner_mm) - thrust

    stretch, furthest = first_solution(excess_n, 1.0, STRETCH_RANGE, 0.0)
    if stretch is None:
        raise TubeError(
            f"no axial stretch from {STRETCH_RANGE[0]:g} to {STRETCH_RANGE[1]:g} balances {ends} ends of this tube at "
            f"inner radius {inner_mm:g} mm for {law} (nearest: {furthest:g} N): ask for a radius nearer to rest"
        )
    found = replace(tube, axial_stretch=stretch)
    return TubeState(found, inner_mm, pressure_at_inner_radius_mpa(found, law, inner_mm))


def state_at_pressure(tube: Tube, law: IsotropicLaw, pressure_mpa: float, ends: Ends) -> TubeState:
    """Inner radius and axial stretch at the pressure `pressure_mpa`, with the ends as given.

    The first solution met when the tube is inflated (or, for a negative pressure, collapsed) from rest.

    Parameters
    ----------
    tube
        Undeformed tube; its axial stretch is left aside.
    pressure_mpa
        Pressure P (inside minus outside), MPa.
    ends
        "capped" (N = P pi a^2) or "free" (N = 0).

    Raises
    ------
    TubeError
        If no inner stretch between 0.02 and 50 carries the pressure, naming the largest pressure met.
    """
    if not math.isfinite(pressure_mpa):
        raise TubeError(f"pressure = {pressure_mpa} MPa is not a finite number")
    rest = state_at_inner_radius(tube, law, tube.inner_radius_mm, ends)
    # up to round-off, as at a prescribed stretch
    if abs(pressure_mpa) <= abs(rest.pressure_mpa):
        return rest
    bounds = (STRETCH_RANGE[0] * tube.inner_radius_mm, STRETCH_RANGE[1] * tube.inner_radius_mm)
    root, furthest = first_solution(
        lambda a: state_at_inner_radius(tube, law, a, ends).pressure_mpa, rest.inner_mm, bounds, pressure_mpa
    )
    if root is None:
        raise _beyond(law, pressure_mpa, furthest)
    return state_at_inner_radius(tube, law, root, ends)


def cauchy_stress_mpa(
    tube: Tube, law: IsotropicLaw, inner_mm: float, radius_mm: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cauchy stresses (sigma_r, sigma_theta, sigma_z) at undeformed radius R, free outer surface.

    Parameters
    ----------
    inner_mm
        Deformed inner radius a, mm.
    radius_mm
        Undeformed radii R in [A, B], mm, any shape.

    Returns
    -------
    tuple of FloatArray
        Three arrays of the shape of `radius_mm`, MPa.
    """
    at = np.asarray(radius_mm, dtype=float)
    radius, deformed, weight = _quadrature(tube, inner_mm, at)
    radial = -np.sum(weight * _hoop_minus_radial(tube, law, radius, deformed), axis=-1)
    here = deformed_radius_mm(tube, inner_mm, at)
    hoop = radial + _hoop_minus_radial(tube, law, at, here)
    axial = radial + _axial_minus_radial(tube, law, at, here)
    return np.asarray(radial), np.asarray(hoop), np.asarray(axial)


def hydrostatic_pressure_mpa(tube: Tube, law: IsotropicLaw, inner_mm: float, radius_mm: ArrayLike) -> FloatArray:
    """Hydrostatic pressure -tr(sigma)/3 at undeformed radius R, MPa, positive in compression.

    Minus the pressure multiplier of a mixed element whose energy is split, W(J^(-1/3) F) + p (J - 1).
    """
    radial, hoop, axial = cauchy_stress_mpa(tube, law, inner_mm, radius_mm)
    return -(radial + hoop + axial) / 3.0


def axial_force_n(tube: Tube, law: IsotropicLaw, inner_mm: float) -> float:
    """Axial force 2 pi int sigma_z r dr carried by the wall, N, positive in tension (free outer surface).

    This is what the ends must apply if the pressure acts on the lateral wall only (plane strain between
    fixed ends). With end caps that the pressure pushes on, the grip holds this less pi a^2 P.
    """
    radius, deformed, weight = _quadrature(tube, inner_mm, tube.inner_radius_mm)
    hoop = _hoop_minus_radial(tube, law, radius, deformed)
    axial = _axial_minus_radial(tube, law, radius, deformed)
    # int sigma_r 2 r dr by parts, with sigma_r = -P inside and 0 outside, saves the inner quadrature.
    pressure = np.sum(weight * hoop)
    return float(math.pi * (pressure * inner_mm**2 + np.sum(weight * deformed**2 * (2.0 * axial - hoop))))


def stored_energy_n(tube: Tube, law: IsotropicLaw, inner_mm: float) -> float:
    """Stored energy per unit undeformed length, mJ/mm = N.

    Its derivative with respect to the enclosed area pi a^2 lz (at fixed lz) is the pressure, and with
    respect to lz (at fixed a) the axial force: the second route to both.
    """
    radius, deformed, weight = _quadrature(tube, inner_mm, tube.inner_radius_mm)
    hoop = deformed / radius
    energy = law.energy(1.0 / (hoop * tube.axial_stretch), hoop, tube.axial_stretch)
    # 2 pi R dR = 2 pi lz r^2 d(ln r)
    return float(2.0 * math.pi * tube.axial_stretch * np.sum(weight * deformed**2 * energy))


def _beyond(law: IsotropicLaw, pressure_mpa: float, furthest_mpa: float) -> TubeError:
    return TubeError(
        f"pressure {pressure_mpa:g} MPa is beyond what {law} carries in this tube (largest met: "
        f"{abs(furthest_mpa):g} MPa in size): prescribe the inner radius instead"
    )


def _require_bore(inner_mm: float) -> None:
    if not 0.0 < inner_mm < math.inf:
        raise TubeError(f"deformed inner radius = {inner_mm:g} mm must be positive")


def _hoop_minus_radial(tube: Tube, law: IsotropicLaw, radius_mm: ArrayLike, deformed_mm: ArrayLike) -> FloatArray:
    hoop = np.asarray(deformed_mm) / np.asarray(radius_mm)
    return law.stress_difference(hoop, 1.0 / (hoop * tube.axial_stretch), tube.axial_stretch)


def _axial_minus_radial(tube: Tube, law: IsotropicLaw, radius_mm: ArrayLike, deformed_mm: ArrayLike) -> FloatArray:
    hoop = np.asarray(deformed_mm) / np.asarray(radius_mm)
    return law.stress_difference(tube.axial_stretch, 1.0 / (hoop * tube.axial_stretch), hoop)


def _quadrature(tube: Tube, inner_mm: float, from_radius_mm: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points R, r and weights of d(ln r) from undeformed radius `from_radius_mm` to B; shape (..., 48)."""
    begin = np.asarray(from_radius_mm, dtype=float)[..., None]
    a, inner, stretch = inner_mm, tube.inner_radius_mm, tube.axial_stretch
    deformed_begin = deformed_radius_mm(tube, a, begin)
    # R^2 - lz r^2 is the same for all particles. Negative (inflated): as a function of ln R, r vanishes only
    # pi/2 away from the real axis. Positive (collapsed): R does, as a function of ln r.
    if stretch * a**2 >= inner**2:
        half = 0.5 * np.log(tube.outer_radius_mm / begin)
        radius = begin * np.exp(half * (1.0 + _POINTS))
        deformed = deformed_radius_mm(tube, a, radius)
        return radius, deformed, half * _WEIGHTS * radius**2 / (stretch * deformed**2)
    deformed_outer = deformed_radius_mm(tube, a, tube.outer_radius_mm)
    half = 0.5 * np.log(deformed_outer / deformed_begin)
    deformed = deformed_begin * np.exp(half * (1.0 + _POINTS))
    radius = np.sqrt(inner**2 + stretch * (deformed**2 - a**2))
    return radius, deformed, half * _WEIGHTS
