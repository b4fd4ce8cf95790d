"""Buckling of a thick tube or ring under external pressure: incompressible, any isotropic law.

The tube of `tube.py` under an outer pressure P stays round, r^2 = a^2 + (R^2 - A^2) / lz, until an increment

    u_r = U(r) cos(n theta),  u_theta = V(r) sin(n theta),  n >= 2 waves, in the plane at fixed lz

costs no energy (n = 0 and 1 contain the rigid rotation and translation). With L = grad u, tr L = 0, alpha =
(sigma_r - sigma_theta) / (l_r^2 - l_theta^2) and h the Hessian of W in the log stretches, the second variation of
the stored energy per deformed volume is L : D : L on (L_rr, L_r_theta, L_theta_r),

    D = [[h_rr + h_tt - 2 h_rt - sigma_r - sigma_t, 0, 0],
         [0, alpha l_t^2, alpha l_t^2 - sigma_t],
         [0, alpha l_t^2 - sigma_t, alpha l_r^2]]

(Biot, Mechanics of Incremental Deformations, 1965; Haughton and Ogden, J. Mech. Phys. Solids 27 (1979) 489). The
pressure on the outer surface is

    follower : it stays normal and P counts per deformed area (a gas); its potential is P times the enclosed area
    dead     : the traction that the round state has keeps its size and direction per undeformed area

Two routes find the states of neutral equilibrium and share only W:

    shooting : incremental equilibrium and tractions as a first-order system of four from the free inner surface
               to the loaded outer one, with the round state integrated along; `buckling_determinant`
    Ritz     : second variation of the total potential with a stream function in Legendre polynomials;
               `second_variation_mpa`, whose negative eigenvalues are unstable modes

Thin rings of mean radius R_m and thickness t buckle at (n^2 - 1) mu t^3 / (3 R_m^3) under follower and
n^2 mu t^3 / (3 R_m^3) under dead pressure (plane strain, E' = 4 mu, I = t^3 / 12).
Units: mm, N, MPa; pressures are outside minus inside, positive, unlike in `tube.py`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal, get_args

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.exact.search import root
from analytical.exact.tube import Tube, cauchy_stress_mpa, deformed_radius_mm, pressure_at_inner_radius_mpa
from analytical.laws.isotropic import IsotropicLaw

Load = Literal["follower", "dead"]
LOADS: Final[tuple[Load, ...]] = get_args(Load)

# The search goes down in inner radius in steps of this ratio: the second mode of a given n is much further away.
_SEARCH_RATIO = 1.01
# It starts at this part of the inner radius at rest; rings so thin that they buckle before (t / R_m below 1e-4)
# are lines, for the formula above.
_SEARCH_START = 1.0 - 1e-9
# It gives up at this part: free surfaces of elastomers wrinkle at hoop stretches of about 0.5 (Biot).
INNER_STRETCH_MIN: Final = 0.2

# Shooting: Gauss collocation of 8 stages, order 16, on 16 panels of equal ratio of radii. At B/A = 3, n = 20 the
# determinant's root moves by less than 1e-13 with 32 panels.
_STAGES, _PANELS = 8, 16

# Ritz: 32 polynomials, which leave the root 1e-10 off at n ln(b/a) = 66 (B/A = 3, n = 40) and at round-off for less
# than 30; 48 Gauss points integrate their products exactly against moduli of degree 33.
_TERMS = 32
_POINTS, _WEIGHTS = legendre.leggauss(48)


class RingError(ValueError):
    """A ring that does not buckle as requested; the message names value and remedy."""


@dataclass(frozen=True)
class RingBuckling:
    """A state of neutral equilibrium of the round tube.

    Parameters
    ----------
    waves
        Number n of waves round the ring.
    load
        "follower" or "dead".
    inner_mm, outer_mm
        Deformed radii a, b of the round state, mm.
    pressure_mpa
        Outer pressure per deformed area, MPa.
    nominal_pressure_mpa
        The same force per undeformed lateral area, P b lz / B, MPa: what a dead load is given as.
    """

    waves: int
    load: Load
    inner_mm: float
    outer_mm: float
    pressure_mpa: float
    nominal_pressure_mpa: float


def critical_pressure_mpa(tube: Tube, law: IsotropicLaw, waves: int, load: Load) -> float:
    """Outer pressure P, per deformed area, at which the round tube first buckles into n waves, MPa.

    See `first_buckling`. Its relative error is round-off (1e-16) over the hoop strain at buckling, which is
    (n^2 - 1) (t / R_m)^2 / 12 for thin rings.
    """
    return first_buckling(tube, law, waves, load).pressure_mpa


def first_buckling(tube: Tube, law: IsotropicLaw, waves: int, load: Load) -> RingBuckling:
    """First state of neutral equilibrium with n waves, met as the bore shrinks from rest (by shooting).

    Parameters
    ----------
    tube
        Undeformed tube and its axial stretch; 1 is plane strain.
    waves
        Number of waves n, 2 or more. The ring buckles into the n whose pressure is least: 2 if thin.
    load
        "follower" (gas, liquid) or "dead" (fixed forces); the two differ, so there is no default.

    Raises
    ------
    RingError
        If the tube does not buckle so before its inner radius is 0.2 of that at rest.
    """
    rest = tube.inner_radius_mm / math.sqrt(tube.axial_stretch)

    def determinant(inner_mm: float) -> float:
        return buckling_determinant(tube, law, inner_mm, waves, load)

    near, far = _SEARCH_START * rest, rest / _SEARCH_RATIO
    if determinant(near) <= 0.0:
        raise RingError(
            f"{tube} is not stable even at rest in {waves} waves for {law}: it is too thin (take the thin-ring "
            "formula) or the law has no positive moduli"
        )
    while far > INNER_STRETCH_MIN * rest:
        if determinant(far) <= 0.0:
            inner = root(determinant, far, near, 1e-15 * rest)
            outer = float(deformed_radius_mm(tube, inner, tube.outer_radius_mm))
            pressure = -pressure_at_inner_radius_mpa(tube, law, inner)
            nominal = pressure * outer * tube.axial_stretch / tube.outer_radius_mm
            return RingBuckling(waves, load, inner, outer, pressure, nominal)
        near, far = far, far / _SEARCH_RATIO
    raise RingError(
        f"{tube} of {law} does not buckle into {waves} waves under {load} pressure before its bore has shrunk to "
        f"{INNER_STRETCH_MIN:g} of its radius at rest: ask for other waves or a thinner wall"
    )


def thin_ring_pressure_mpa(tube: Tube, law: IsotropicLaw, waves: int, load: Load) -> float:
    """Limit of the critical pressure for thin rings in plane strain, MPa: mu t^3 / (3 R_m^3) times n^2 - 1 or n^2."""
    _require_case(waves, load)
    thickness = tube.outer_radius_mm - tube.inner_radius_mm
    mean = 0.5 * (tube.outer_radius_mm + tube.inner_radius_mm)
    factor = waves**2 - 1 if load == "follower" else waves**2
    return factor * law.initial_shear_modulus_mpa * (thickness / mean) ** 3 / 3.0


def buckling_determinant(tube: Tube, law: IsotropicLaw, inner_mm: float, waves: int, load: Load) -> float:
    """Shooting determinant of the round state with inner radius a: zero where n waves cost nothing, MPa^2.

    It is positive at rest. The two solutions that leave the inner surface free of traction are continued panel by
    panel as the stiffness Z, traction r t = Z (U, V), which keeps them independent for any n, times the
    determinant of (U, V), which keeps the product free of poles (a Riccati and a compound matrix method in one).
    """
    _require_case(waves, load)
    propagators, pressure = _propagators(tube, law, inner_mm, waves)
    stiffness, amplitude = np.zeros((2, 2)), 1.0
    for step in propagators:
        displacement = step[:2, :2] + step[:2, 2:] @ stiffness
        stiffness = (step[2:, :2] + step[2:, 2:] @ stiffness) @ np.linalg.inv(displacement)
        amplitude *= float(np.linalg.det(displacement))
    if load == "follower":
        # The traction increment of a pressure that stays normal is P L^T e_r, with (L_rr, L_r_theta) r =
        # -(U + n V, n U + V).
        stiffness = stiffness + pressure * np.array([[1.0, waves], [waves, 1.0]])
    return float(np.linalg.det(stiffness)) * amplitude


def second_variation_mpa(tube: Tube, law: IsotropicLaw, inner_mm: float, waves: int, load: Load) -> FloatArray:
    """Ritz matrix of the second variation of the total potential in n waves, shape (32, 32), MPa.

    Its negative eigenvalues count unstable modes (cosine ones; as many again turned by a quarter wave). The stream
    function r phi(ln r) sin(n theta) makes u_r = n phi, u_theta = -(phi' + phi) with phi' = d phi / d ln r, free
    of volume change; phi is a constant, a line and Legendre polynomials in phi''.
    """
    _require_case(waves, load)
    outer = float(deformed_radius_mm(tube, inner_mm, tube.outer_radius_mm))
    half = 0.5 * math.log(outer / inner_mm)
    deformed = math.sqrt(inner_mm * outer) * np.exp(half * _POINTS)
    radius = np.sqrt(tube.inner_radius_mm**2 + tube.axial_stretch * (deformed**2 - inner_mm**2))
    pressure = -pressure_at_inner_radius_mpa(tube, law, inner_mm)
    # tube.py leaves the outer surface free: the outer pressure adds itself.
    radial, hoop, _ = (stress - pressure for stress in cauchy_stress_mpa(tube, law, inner_mm, radius))
    hoop_stretch = deformed / radius
    radial_stretch = 1.0 / (hoop_stretch * tube.axial_stretch)
    moduli = half * _WEIGHTS[:, None, None] * incremental_moduli_mpa(law, radial_stretch, hoop_stretch, radial, hoop)
    phi, slope, bend = (half ** (_ORDERS - m)[:, None] * _POLYNOMIALS[m, :, :-1] for m in range(3))
    # r (L_rr, L_r_theta, L_theta_r), with r dr = r^2 d ln r
    gradient = np.stack([waves * slope, slope + (1.0 - waves**2) * phi, -(bend + slope)])
    matrix = np.einsum("iap,pij,jbp->ab", gradient, moduli, gradient, optimize=True)
    if load == "follower":
        # Second variation of P times the enclosed area, P times the integral of u x du.
        end, end_slope = (half ** (_ORDERS - m) * _POLYNOMIALS[m, :, -1] for m in range(2))
        mixed = np.outer(end, end_slope + 0.5 * end)
        matrix = matrix + pressure * (np.outer(end_slope, end_slope) + (1.0 - waves**2) * (mixed + mixed.T))
    return np.asarray(0.5 * (matrix + matrix.T))


def unstable_modes(tube: Tube, law: IsotropicLaw, inner_mm: float, waves: int, load: Load) -> int:
    """Number of unstable modes with n waves of the round state with inner radius a, each counted once (by Ritz)."""
    return int(np.count_nonzero(np.linalg.eigvalsh(second_variation_mpa(tube, law, inner_mm, waves, load)) < 0.0))


def incremental_moduli_mpa(
    law: IsotropicLaw, radial_stretch: ArrayLike, hoop_stretch: ArrayLike, radial_mpa: ArrayLike, hoop_mpa: ArrayLike
) -> FloatArray:
    """Moduli D of in-plane increments (L_rr, L_r_theta, L_theta_r) of a state, shape (..., 3, 3), MPa.

    alpha is a mean of second derivatives of W between the state and the one with equal in-plane stretches, smooth
    where they coincide.

    Parameters
    ----------
    radial_stretch, hoop_stretch
        In-plane stretches; the axial one is 1 over their product.
    radial_mpa, hoop_mpa
        Cauchy stresses of the state; their difference is the law's.
    """
    l_r, l_t = np.asarray(radial_stretch, dtype=float), np.asarray(hoop_stretch, dtype=float)
    s_r, s_t = np.asarray(radial_mpa, dtype=float), np.asarray(hoop_mpa, dtype=float)
    stretching = _stretching_hessian_mpa(law, l_r, l_t) - s_r - s_t
    # d (sigma_r - sigma_t) / d x = (h_rr + h_tt - 2 h_rt) / 2 at l_r, l_t = sqrt(l_r l_t) exp(+-x / 2), x = 0 to
    # ln(l_r / l_t), and l_r^2 - l_t^2 = 2 l_r l_t sinh x.
    contrast = np.log(l_r / l_t)
    turned = np.exp(0.25 * contrast[..., None] * (1.0 + _POINTS))
    middle = np.sqrt(l_r * l_t)[..., None]
    mean = 0.25 * np.sum(_WEIGHTS * _stretching_hessian_mpa(law, middle * turned, middle / turned), axis=-1)
    sinh = np.sinh(contrast)
    alpha = 0.5 * mean / (l_r * l_t) * np.divide(contrast, sinh, out=np.ones_like(sinh), where=sinh != 0.0)
    moduli = np.zeros((*alpha.shape, 3, 3))
    moduli[..., 0, 0] = stretching
    moduli[..., 1, 1] = alpha * l_t**2
    moduli[..., 2, 2] = alpha * l_r**2
    moduli[..., 1, 2] = moduli[..., 2, 1] = alpha * l_t**2 - s_t
    return moduli


def _require_case(waves: int, load: Load) -> None:
    if waves < 2:
        raise RingError(f"waves = {waves}: 0 and 1 contain the rigid motions, ask for 2 or more")
    if load not in LOADS:
        raise RingError(f"load = {load!r} is unknown: say " + " or ".join(f'"{name}"' for name in LOADS))


def _stretching_hessian_mpa(law: IsotropicLaw, radial_stretch: FloatArray, hoop_stretch: FloatArray) -> FloatArray:
    """Combination h_rr + h_tt - 2 h_rt of the Hessian of W in the log stretches, MPa."""
    h = law.log_hessian_mpa(radial_stretch, hoop_stretch, 1.0 / (radial_stretch * hoop_stretch))
    return np.asarray(h[..., 0, 0] + h[..., 1, 1] - 2.0 * h[..., 0, 1])


def _polynomials() -> tuple[FloatArray, FloatArray]:
    """Orders (32,) and values (3, 32, 49) of the Ritz polynomials and two derivatives at the points and at 1.

    The k-th is 1, x, or the second integral of a normalised Legendre polynomial: with half-width s of ln r they
    scale by s to the power of their order, and bending keeps a matrix of order one.
    """
    at = np.append(_POINTS, 1.0)
    values = np.zeros((3, _TERMS, at.size))
    for k in range(_TERMS):
        series = [1.0] if k == 0 else [0.0, 1.0]
        if k >= 2:
            series = legendre.legint(np.append(np.zeros(k - 2), math.sqrt(k - 1.5)), m=2)
        for m in range(3):
            values[m, k] = legendre.legval(at, legendre.legder(series, m))
    return np.minimum(np.arange(_TERMS), 2), values


_ORDERS, _POLYNOMIALS = _polynomials()


def _collocation() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauss collocation on [0, 1] (Hairer, Norsett and Wanner, Solving ODEs I, section II.7): c, A, b."""
    points, weights = legendre.leggauss(_STAGES)
    vander = legendre.legvander(points, _STAGES - 1)
    integrals = [legendre.legval(points, legendre.legint(unit, lbnd=-1.0)) for unit in np.eye(_STAGES)]
    return 0.5 * (1.0 + points), 0.5 * np.column_stack(integrals) @ np.linalg.inv(vander), 0.5 * weights


_NODES, _STAGE_WEIGHTS, _STEP_WEIGHTS = _collocation()


def _propagators(tube: Tube, law: IsotropicLaw, inner_mm: float, waves: int) -> tuple[FloatArray, float]:
    """Matrices (16, 4, 4) that carry (U, V, r t_r, r t_theta) across the panels from a to b; and the pressure P.

    t_r and t_theta are the increments of nominal traction on cylinders. With L_theta_r from the traction, what is
    left of D by elimination, and the incremental pressure eliminated between the two equations of equilibrium, the
    system in ln r is symplectic: [[E, F], [C, -E^T]] with C and F symmetric.
    """
    outer = float(deformed_radius_mm(tube, inner_mm, tube.outer_radius_mm))
    width = math.log(outer / inner_mm) / _PANELS
    deformed = inner_mm * np.exp(width * (np.arange(_PANELS)[:, None] + _NODES))
    offset = tube.inner_radius_mm**2 - tube.axial_stretch * inner_mm**2
    # (R / r)^2 / lz = l_r / l_theta
    ratio = 1.0 + offset / (tube.axial_stretch * deformed**2)
    radial_stretch = np.sqrt(ratio / tube.axial_stretch)
    hoop_stretch = radial_stretch / ratio
    difference = law.stress_difference(radial_stretch, hoop_stretch, tube.axial_stretch)
    # Radial equilibrium d sigma_r / d ln r = sigma_theta - sigma_r from the free inner surface.
    rises = -width * difference @ _STEP_WEIGHTS
    begins = np.concatenate([[0.0], np.cumsum(rises)])
    radial = begins[:-1, None] - width * difference @ _STAGE_WEIGHTS.T
    hoop = radial - difference

    curvature = _stretching_hessian_mpa(law, radial_stretch, hoop_stretch)
    gap = radial_stretch**2 - hoop_stretch**2
    # Where the stretches coincide: a quarter of the second derivative over the stretch squared.
    limit = 0.25 * curvature * tube.axial_stretch
    alpha = np.divide(difference, gap, out=limit, where=gap != 0.0)
    shear = alpha * radial_stretch**2
    coupling = (shear - radial) / shear
    tilting = alpha * hoop_stretch**2 - coupling**2 * shear
    stretching = curvature - radial - hoop

    n = float(waves)
    system = np.zeros((_PANELS, _STAGES, 4, 4))
    system[..., 0, :2] = -1.0, -n
    system[..., 1, 0] = n * coupling
    system[..., 1, 1] = coupling
    system[..., 1, 3] = 1.0 / shear
    system[..., 2, 0] = n**2 * tilting + stretching
    system[..., 3, 1] = n**2 * stretching + tilting
    system[..., 2, 1] = system[..., 3, 0] = n * (stretching + tilting)
    system[..., 2:, 2:] = -np.swapaxes(system[..., :2, :2], -1, -2)

    # Stage slopes K_i = M_i (y + width sum_j a_ij K_j), all panels at once.
    coupled = np.einsum("pikl,ij->pikjl", system, width * _STAGE_WEIGHTS).reshape(_PANELS, 4 * _STAGES, 4 * _STAGES)
    right = system.reshape(_PANELS, 4 * _STAGES, 4)
    slopes = np.linalg.solve(np.eye(4 * _STAGES) - coupled, right).reshape(_PANELS, _STAGES, 4, 4)
    steps = np.eye(4) + width * np.einsum("i,pikl->pkl", _STEP_WEIGHTS, slopes)
    return steps, -float(begins[-1])
