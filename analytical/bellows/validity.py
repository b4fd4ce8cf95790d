"""What the assumptions of the corrected closed form are worth: each one replaced, all else kept.

Source of the chain: Heung et al., Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160, section 3. Replaced are:

- Root: a plane-strain tube. Instead: free of axial force, the axial stretch lz such that the wall carries none.
- Side wall: pure shear, the hoop stretch stays 1. Instead: uniaxial tension (hoop direction free), or the hoop stretch
  that the root imposes half way between root and crest.
- Tip: rigid. Instead: the bulge of a clamped circular plate.
- Full unfolding: the root is held there. Instead: it goes on (`Reading(folds_back=True)` of the chain).

Each is worth what it changes in the elongation of the corrected chain, with the chain's own error in the rest. Stiffer
or softer is seen, how the true wall shares the load between these limits is not: that needs the finite elements.
Units: mm, N, MPa inside; pressures at the interface in kPa. Everything works on many designs at once.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.bellows.chains import ClosedFormPath
from analytical.bellows.dimensions import BellowsError
from analytical.laws.isotropic import Law

Wall = Literal["uniaxial", "stretched by the root"]

# Derivatives are exact to round-off by f(x + ih) = f(x) + ih f'(x) with h^2 below round-off.
_COMPLEX_STEP: Final = 1e-30
# Newton's method doubles its digits: an increment this small leaves its square, below round-off.
_LAST_INCREMENT: Final = 1e-9
# Six to nine steps are usual from the plane-strain tube.
_MAX_ITERATIONS: Final = 40
# Logarithms of the wall stretches among which the answer is sought; 60 halvings leave 1e-17 of them.
_LOG_STRETCHES: Final = (math.log(0.01), math.log(1e3))
_HALVINGS: Final = 60
# In ln R the integrands are analytic up to pi/2 from the real axis: round-off up to walls as thick as R_o = 3 R_i.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(16)
# Shear correction of a plate (Reissner 1945).
_SHEAR_CORRECTION: Final = 5.0 / 6.0


def with_free_root(path: ClosedFormPath) -> ClosedFormPath:
    """The path with roots free of axial force, held at full unfolding as in the corrected chain.

    The side wall's stretch depends on the pressure alone in that chain and stays.

    Parameters
    ----------
    path
        Of the corrected chain, for one bellows or many.

    Returns
    -------
    ClosedFormPath
        Same shapes. Its unfolding pressure is still that of the plane-strain root.
    """
    d = path.dimensions
    inner, wall, crest = (
        np.asarray(value, dtype=float)[..., None] for value in (d.root_radius_mm, d.wall_mm, d.crest_radius_mm)
    )
    free, _ = free_root_stretch(1.0 + wall / inner, path.law, 1e-3 * path.pressure_kpa, path.root_stretch)
    stretch = np.minimum(free, (crest + wall) / (inner + wall))
    drop = np.maximum((crest + wall) - stretch * (inner + wall), 0.0)
    return replace(path, root_stretch=stretch, drop_mm=drop)


def free_root_stretch(
    radius_ratio: ArrayLike, law: Law, pressure_mpa: ArrayLike, guess: ArrayLike = 1.0
) -> tuple[FloatArray, FloatArray]:
    """Outer hoop stretch and axial stretch of a tube under inner pressure whose wall carries no axial force.

    Parameters
    ----------
    radius_ratio
        R_o / R_i, undeformed.
    law
        Hyperelastic law.
    pressure_mpa
        Pressure, MPa; broadcasts with the radius ratio.
    guess
        Outer hoop stretch to start from: that of the plane-strain tube is near enough.

    Returns
    -------
    tuple of ndarray
        Hoop stretch of the outer surface and axial stretch.

    Raises
    ------
    BellowsError
        If no such state is found: the law has no answer at that pressure.
    """
    ratio, pressure, start = np.broadcast_arrays(
        *(np.asarray(v, dtype=float) for v in (radius_ratio, pressure_mpa, guess))
    )
    # ln of the outer hoop stretch, ln of the axial stretch
    x = np.stack([np.log(start), np.zeros(ratio.shape)])
    scale = law.initial_shear_modulus_mpa
    for _ in range(_MAX_ITERATIONS):
        columns = []
        for direction in np.eye(2):
            at = x + 1j * _COMPLEX_STEP * direction.reshape(2, *(1,) * ratio.ndim)
            columns.append(_free_tube(ratio, law, np.exp(at[0]), np.exp(at[1]), pressure) / scale)
        value = columns[0].real
        (a, c), (b, d) = (column.imag / _COMPLEX_STEP for column in columns)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.stack([d * value[0] - b * value[1], a * value[1] - c * value[0]]) / (a * d - b * c)
        # a step of more than a tenth in the logarithm leaves the region where the tangent means anything
        x = x - np.clip(step, -0.1, 0.1)
        if np.all(np.abs(step) <= _LAST_INCREMENT):
            hoop, axial = np.exp(x)
            return hoop, axial
    worst = float(np.max(pressure))
    raise BellowsError(f"no tube of {law} free of axial force found up to {1e3 * worst:g} kPa: lower the pressure")


def _free_tube(ratio: FloatArray, law: Law, hoop: FloatArray, axial: FloatArray, pressure: FloatArray) -> FloatArray:
    """Missing pressure (MPa) and axial force over pi R_i^2 (MPa) of a tube, shape (2, ...); complex stretches go.

    With r dr = R dR / lz: P = int (sigma_theta - sigma_r) R dR / (lz r^2), and the axial force of the wall is
    2 pi int sigma_z r dr, by parts as in `analytical.exact.tube`.
    """
    half = 0.5 * np.log(ratio)
    found, force = np.zeros((2, *ratio.shape), dtype=complex)
    for point, weight in zip(_POINTS, _WEIGHTS, strict=True):
        radius = np.exp(half * (1.0 + point))  # R over R_i
        square = (hoop * ratio) ** 2 - (ratio**2 - radius**2) / axial
        here = np.sqrt(square) / radius
        hoop_difference = law.stress_difference(here, 1.0 / (here * axial), axial)
        axial_difference = law.stress_difference(axial, 1.0 / (here * axial), here)
        ring = weight * half * radius**2 / axial
        found = found + ring * hoop_difference / square
        force = force + ring * (2.0 * axial_difference - hoop_difference)
    bore = (hoop * ratio) ** 2 - (ratio**2 - 1.0) / axial
    return np.stack([found - pressure, force + found * bore])


def with_other_wall(path: ClosedFormPath, wall: Wall) -> ClosedFormPath:
    """The path with the side wall under the same Cauchy stress in another state than pure shear.

    Parameters
    ----------
    path
        Of the corrected chain, for one bellows or many.
    wall
        "uniaxial": the hoop direction is free. "stretched by the root": the hoop stretch half way between root and
        crest, ((R_p + t) + lambda_y (R_i + t)) / ((R_p + t) + (R_i + t)), the crest being rigid.

    Returns
    -------
    ClosedFormPath
        Same shapes. Its ``wall_stress_mpa`` is still read as that of pure shear.
    """
    if wall not in get_args(Wall):
        raise BellowsError(f'wall = {wall!r} is unknown: say "uniaxial" or "stretched by the root"')
    law, load = path.law, path.wall_stress_mpa
    hoop = mid_wall_hoop_stretch(path)

    def stress(stretch: FloatArray) -> FloatArray:
        if wall == "uniaxial":
            return law.stress_difference(stretch, stretch**-0.5, stretch**-0.5)
        return law.stress_difference(stretch, 1.0 / (stretch * hoop), hoop)

    low, high = (np.full(load.shape, bound) for bound in _LOG_STRETCHES)
    if np.any(stress(np.exp(high)) < load):
        raise BellowsError(f"{law} does not reach the wall stress {float(load.max()):g} MPa: lower the pressure")
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        below = stress(np.exp(middle)) < load
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return replace(path, wall_stretch=np.exp(high))


def mid_wall_hoop_stretch(path: ClosedFormPath) -> FloatArray:
    """Hoop stretch that root and crest impose half way along a straight side wall; shape of the path."""
    d = path.dimensions
    wall = np.asarray(d.wall_mm, dtype=float)[..., None]
    root = np.asarray(d.root_radius_mm, dtype=float)[..., None] + wall
    crest = np.asarray(d.crest_radius_mm, dtype=float)[..., None] + wall
    return np.asarray((crest + path.root_stretch * root) / (crest + root))


def cap_bulge_mm(radius_mm: ArrayLike, thickness_mm: ArrayLike, law: Law, pressure_kpa: ArrayLike) -> FloatArray:
    """Deflection of the middle of a clamped circular plate under pressure, mm.

    Linear plate theory with shear (Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells, section 16; Mindlin's
    plate), incompressible: D = mu h^3 / 3 (E = 3 mu, nu = 1/2), w = P R^4 / (64 D) + P R^2 / (4 k mu h), k = 5/6.

    Parameters
    ----------
    radius_mm, thickness_mm
        R and h, mm.
    law
        Its initial shear modulus mu is used.
    pressure_kpa
        Pressure on the plate, kPa.

    Returns
    -------
    ndarray
        Broadcast shape, mm. Small deflections only: it says nothing where it is not small beside h.
    """
    radius, thickness = np.asarray(radius_mm, dtype=float), np.asarray(thickness_mm, dtype=float)
    load = 1e-3 * np.asarray(pressure_kpa, dtype=float) / law.initial_shear_modulus_mpa
    bending = load * 3.0 * radius**4 / (64.0 * thickness**3)
    shear = load * radius**2 / (4.0 * _SHEAR_CORRECTION * thickness)
    return np.asarray(bending + shear)
