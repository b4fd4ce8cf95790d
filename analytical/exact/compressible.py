"""Thick-walled tube and sphere of finite bulk modulus under pressure, any isotropic law.

Energy per undeformed volume: W(J^(-1/3) l_i) + kappa/2 (J - 1)^2, which is what split displacement-pressure
elements have once their pressure p = kappa (J - 1) is eliminated. There is no closed form; the radial problem is
solved by Galerkin's method with a basis so good that the answer is at round-off.

Tube (d = 2, axial stretch lz prescribed) and sphere (d = 3, lz = 1) are one problem in the unknown Q(R):

    Q = lz r^d,    J = dQ / d(R^d),    l_theta = (Q / (lz R^d))^(1/d)

With Q = Q(A) + R^d - A^d + g the volume change J - 1 = g' / (d R^d), where ' = d/d(ln R), is not a difference of
nearly equal numbers, so nothing is lost as kappa / mu grows. g' = sum_n c_n P_n, Legendre polynomials in ln R, in
which the solution is analytic; the condition of the tangent does not depend on kappa. The potential, in units of
2 pi / d (tube, per undeformed length) or 4 pi / d (sphere), is

    d int (W + kappa/2 (J - 1)^2) R^d d(ln R) - P Q(A)

It is made stationary in c_n at a prescribed inner radius; P is then the derivative in Q(A). The volumetric term is
finite at J = 0: a wall pressed from outside to about half its volume can be crushed, and is not followed there.

`pressure` means inside minus outside; the outer surface is free. Units: mm, N, MPa.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.exact.search import STRETCH_RANGE, first_solution
from analytical.exact.sphere import Sphere
from analytical.exact.tube import Tube
from analytical.laws.isotropic import IsotropicLaw

# Legendre polynomials in ln R, and Gauss points: two for each polynomial, as for a product of two.
_BASIS: Final = 48
_POINTS, _WEIGHTS = legendre.leggauss(2 * _BASIS)

# Newton converges quadratically: after a change of the stresses this small, relative to the largest, the next
# would be round-off. From no volume change it takes two to seven iterations for kappa / mu of 10 and more.
_NEWTON_TOLERANCE: Final = 1e-8
_NEWTON_LIMIT: Final = 40

# The last coefficients must be this small beside the stresses, or the wall is not resolved.
_RESOLUTION: Final = 1e-11
_LAST: Final = 3


class CompressibleError(ValueError):
    """A body or state that cannot be solved; the message names value and remedy."""


@dataclass(frozen=True)
class State:
    """Equilibrium of a compressible tube or sphere.

    Attributes
    ----------
    body, law, kappa_mpa
        What was solved; kappa is the bulk modulus, MPa.
    inner_mm
        Deformed inner radius a, mm.
    pressure_mpa
        Pressure P (inside minus outside), MPa.
    coefficients
        Legendre coefficients c_n of d R^d (J - 1) in ln R, mm^d, shape (48,).
    """

    body: Tube | Sphere
    law: IsotropicLaw
    kappa_mpa: float
    inner_mm: float
    pressure_mpa: float
    coefficients: FloatArray


def state_at_inner_radius(body: Tube | Sphere, law: IsotropicLaw, kappa_mpa: float, inner_mm: float) -> State:
    """Equilibrium with the deformed inner radius held at a.

    Parameters
    ----------
    body
        Tube (at its axial stretch) or sphere.
    law
        Isochoric part W of the energy.
    kappa_mpa
        Bulk modulus, MPa, finite.
    inner_mm
        Deformed inner radius a, mm.

    Raises
    ------
    CompressibleError
        For a bulk modulus or radius out of range, or a state that is not found or not resolved.
    """
    if not 0.0 < kappa_mpa < math.inf:
        raise CompressibleError(
            f"bulk modulus {kappa_mpa:g} MPa must be positive and finite: without volume change take "
            "analytical.exact.tube or analytical.exact.sphere"
        )
    if not 0.0 < inner_mm < math.inf:
        raise CompressibleError(f"deformed inner radius = {inner_mm:g} mm must be positive")
    wall = _wall(body, _POINTS)
    c = np.zeros(_BASIS)
    for _ in range(_NEWTON_LIMIT):
        stress_mpa, residual, tangent = _equations(body, law, kappa_mpa, inner_mm, wall, c)
        step = np.linalg.solve(tangent, -residual)
        c = _shortened(c, step, wall)
        if np.abs(kappa_mpa * (wall.by_volume @ step)).max() <= _NEWTON_TOLERANCE * stress_mpa:
            break
    else:
        raise CompressibleError(
            f"no equilibrium found at inner radius {inner_mm:g} mm of {body} with kappa = {kappa_mpa:g} MPa, {law}: "
            "ask for a radius nearer to rest"
        )
    unresolved = np.abs(kappa_mpa * (wall.by_volume[:, -_LAST:] @ c[-_LAST:])).max()
    if unresolved > _RESOLUTION * stress_mpa:
        raise CompressibleError(
            f"{_BASIS} polynomials leave {unresolved:g} MPa of {stress_mpa:g} MPa unresolved at inner radius "
            f"{inner_mm:g} mm of {body}: ask for a thinner wall or a radius nearer to rest"
        )
    kin = _kinematics(body, inner_mm, wall, c)
    hoop, _ = _log_stresses(body, law, kin.stretches)
    # the derivative of the potential in Q(A): by ln l_theta alone, as J does not change
    pressure = float(np.sum(_WEIGHTS * wall.half * wall.volume * hoop / kin.q))
    return State(body, law, kappa_mpa, inner_mm, pressure, c)


def state_at_pressure(body: Tube | Sphere, law: IsotropicLaw, kappa_mpa: float, pressure_mpa: float) -> State:
    """Equilibrium at the pressure `pressure_mpa`: the first met on inflation (or collapse) from no pressure.

    Parameters
    ----------
    body
        Tube (at its axial stretch) or sphere.
    law
        Isochoric part W of the energy.
    kappa_mpa
        Bulk modulus, MPa, finite.
    pressure_mpa
        Pressure P (inside minus outside), MPa.

    Raises
    ------
    CompressibleError
        If no inner stretch between 0.02 and 50 carries the pressure, or a state on the way is not resolved.
    """
    if not math.isfinite(pressure_mpa):
        raise CompressibleError(f"pressure = {pressure_mpa} MPa is not a finite number")
    # where the incompressible wall has no pressure; the search starts downwards if this one has more than requested
    start = body.inner_radius_mm / math.sqrt(_axial_stretch(body))
    bounds = (STRETCH_RANGE[0] * body.inner_radius_mm, STRETCH_RANGE[1] * body.inner_radius_mm)
    inner_mm, furthest = first_solution(
        lambda a: state_at_inner_radius(body, law, kappa_mpa, a).pressure_mpa, start, bounds, pressure_mpa
    )
    if inner_mm is None:
        raise CompressibleError(
            f"pressure {pressure_mpa:g} MPa is beyond what {law} carries in {body} (furthest met: {furthest:g} MPa): "
            "prescribe the inner radius instead"
        )
    return state_at_inner_radius(body, law, kappa_mpa, inner_mm)


def deformed_radius_mm(state: State, radius_mm: ArrayLike) -> FloatArray:
    """Deformed radius r of the particles at undeformed radius R, mm; shape of `radius_mm`."""
    kin = _at(state, radius_mm)
    return (kin.q / _axial_stretch(state.body)) ** (1.0 / _dimension(state.body))


def radial_displacement_mm(state: State, radius_mm: ArrayLike) -> FloatArray:
    """Radial displacement u = r - R at undeformed radius R, mm; shape of `radius_mm`."""
    return np.asarray(deformed_radius_mm(state, radius_mm) - np.asarray(radius_mm, dtype=float))


def volume_change(state: State, radius_mm: ArrayLike) -> FloatArray:
    """Relative change of volume J - 1 at undeformed radius R; shape of `radius_mm`."""
    return _at(state, radius_mm).volume_change


def hydrostatic_pressure_mpa(state: State, radius_mm: ArrayLike) -> FloatArray:
    """Hydrostatic pressure -tr(sigma)/3 = -kappa (J - 1) at undeformed radius R, MPa; shape of `radius_mm`.

    Minus the pressure multiplier of a mixed element with the potential W + p (J - 1) - p^2 / (2 kappa).
    """
    return -state.kappa_mpa * volume_change(state, radius_mm)


def cauchy_stress_mpa(state: State, radius_mm: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Cauchy stresses (sigma_r, sigma_theta, sigma_z or sigma_phi) at undeformed radius R.

    Parameters
    ----------
    radius_mm
        Undeformed radii R in [A, B], mm, any shape.

    Returns
    -------
    tuple of FloatArray
        Three arrays of the shape of `radius_mm`, MPa.
    """
    kin = _at(state, radius_mm)
    mean = state.kappa_mpa * kin.volume_change
    r, t, z = kin.stretches
    j, difference = 1.0 + kin.volume_change, state.law.stress_difference
    return (
        np.asarray(mean + (difference(r, t, z) + difference(r, z, t)) / (3.0 * j)),
        np.asarray(mean + (difference(t, r, z) + difference(t, z, r)) / (3.0 * j)),
        np.asarray(mean + (difference(z, r, t) + difference(z, t, r)) / (3.0 * j)),
    )


@dataclass(frozen=True)
class _Wall:
    """Basis at undeformed radii R, shape (...): R^d, half the length of the wall in ln R, g and J by c (..., 48)."""

    volume: FloatArray
    half: float
    value: FloatArray
    by_volume: FloatArray


@dataclass(frozen=True)
class _Kinematics:
    """Q, J - 1 and the isochoric stretches (r, theta, z or phi), each of shape (...)."""

    q: FloatArray
    volume_change: FloatArray
    stretches: tuple[FloatArray, FloatArray, FloatArray]


def _dimension(body: Tube | Sphere) -> int:
    return 2 if isinstance(body, Tube) else 3


def _axial_stretch(body: Tube | Sphere) -> float:
    return body.axial_stretch if isinstance(body, Tube) else 1.0


def _wall(body: Tube | Sphere, at: ArrayLike) -> _Wall:
    """Basis at ln R running from -1 (R = A) to 1 (R = B)."""
    x = np.asarray(at, dtype=float)
    d = _dimension(body)
    half = 0.5 * math.log(body.outer_radius_mm / body.inner_radius_mm)
    volume = (body.inner_radius_mm * np.exp(half * (1.0 + x))) ** d
    p = legendre.legvander(x, _BASIS).reshape(*x.shape, _BASIS + 1)  # legvander makes an axis of a single number
    # int_-1^x P_n = (P_(n+1) - P_(n-1)) / (2n + 1), and 1 + x = P_0 + P_1 for n = 0
    value = np.concatenate(
        [p[..., :1] + p[..., 1:2], (p[..., 2:] - p[..., :-2]) / (2 * np.arange(1, _BASIS) + 1)], axis=-1
    )
    return _Wall(volume, half, half * value, p[..., :-1] / (d * volume[..., None]))


def _kinematics(body: Tube | Sphere, inner_mm: float, wall: _Wall, c: FloatArray) -> _Kinematics:
    d, axial = _dimension(body), _axial_stretch(body)
    q = axial * inner_mm**d + (wall.volume - body.inner_radius_mm**d) + wall.value @ c
    change = wall.by_volume @ c
    hoop = (q / (axial * wall.volume)) ** (1.0 / d)
    third = hoop if isinstance(body, Sphere) else np.full_like(hoop, axial)
    scale = np.cbrt(1.0 + change)
    return _Kinematics(q, change, ((1.0 + change) / (hoop * third * scale), hoop / scale, third / scale))


def _at(state: State, radius_mm: ArrayLike) -> _Kinematics:
    radius = np.asarray(radius_mm, dtype=float)
    inner, outer = state.body.inner_radius_mm, state.body.outer_radius_mm
    x = 2.0 * np.log(radius / inner) / math.log(outer / inner) - 1.0
    return _kinematics(state.body, state.inner_mm, _wall(state.body, x), state.coefficients)


def _log_stresses(
    body: Tube | Sphere, law: IsotropicLaw, stretches: tuple[FloatArray, FloatArray, FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Derivatives of W in ln l_theta (at fixed J) and in ln J (at fixed l_theta), MPa."""
    r, t, z = stretches
    # d - 1 directions in the surface share l_theta, and each takes its growth from l_r
    hoop = (_dimension(body) - 1) * law.stress_difference(t, r, z)
    return hoop, (law.stress_difference(r, t, z) + law.stress_difference(r, z, t)) / 3.0


def _log_tangent(
    body: Tube | Sphere, law: IsotropicLaw, stretches: tuple[FloatArray, FloatArray, FloatArray]
) -> FloatArray:
    """Second derivatives of W in (ln l_theta, ln J), MPa, shape (..., 2, 2)."""
    # ln of the isochoric stretches by (ln l_theta, ln J)
    hoop = (-1.0, 1.0, 0.0) if isinstance(body, Tube) else (-2.0, 1.0, 1.0)
    chain = np.array([hoop, (2.0 / 3.0, -1.0 / 3.0, -1.0 / 3.0)])
    return np.asarray(chain @ law.log_hessian_mpa(*stretches) @ chain.T)


def _equations(
    body: Tube | Sphere, law: IsotropicLaw, kappa_mpa: float, inner_mm: float, wall: _Wall, c: FloatArray
) -> tuple[float, FloatArray, FloatArray]:
    """Largest stress (MPa), and first (48,) and second (48, 48) derivatives of the potential in c_n."""
    d = _dimension(body)
    kin = _kinematics(body, inner_mm, wall, c)
    j = 1.0 + kin.volume_change
    hoop, radial = _log_stresses(body, law, kin.stretches)
    hessian = _log_tangent(body, law, kin.stretches)
    mean = kappa_mpa * kin.volume_change
    weight = _WEIGHTS * wall.half * d * wall.volume
    by_hoop = wall.value / (d * kin.q[:, None])
    residual = by_hoop.T @ (weight * hoop) + wall.by_volume.T @ (weight * (radial / j + mean))
    # d2 ln l_theta = -d (d ln l_theta)^2, as Q is linear in c; d2 ln J = -(dJ / J)^2
    mixed = (by_hoop.T * (weight * hessian[:, 0, 1] / j)) @ wall.by_volume
    tangent = (
        (by_hoop.T * (weight * (hessian[:, 0, 0] - d * hoop))) @ by_hoop
        + mixed
        + mixed.T
        + (wall.by_volume.T * (weight * ((hessian[:, 1, 1] - radial) / j**2 + kappa_mpa))) @ wall.by_volume
    )
    largest = max(law.initial_shear_modulus_mpa, *(float(np.abs(s).max()) for s in (hoop, radial, mean)))
    return largest, residual, tangent


def _shortened(c: FloatArray, step: FloatArray, wall: _Wall) -> FloatArray:
    """Coefficients c + step, the step halved until no volume is turned inside out."""
    while (wall.by_volume @ (c + step)).min() <= -1.0:
        step = 0.5 * step
    return c + step
