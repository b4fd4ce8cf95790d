"""Closed form of a bellows actuator with rigid crest rings: Heung et al. 2024, misprints mended.

Source: Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160, section 3, equations (1) to (23).

The chain, per pressure P:

1. Every root is a plane-strain tube from R_i to R_i + t (eqs. (4) to (17)). P gives its outer hoop stretch
   lambda_y, here from the exact tube in `analytical.tube`.
2. At lambda_y (R_i + t) = R_p + t the root has reached the crest: fully unfolded, lambda_y stays there.
3. The side wall, in pure shear along its length, carries (eqs. (18) to (22))
   sigma(lambda_a) = P R_p^2 / ((R_i + t)^2 - R_i^2).
4. Half pitch a = sqrt((lambda_a l)^2 - ((R_p + t) - lambda_y (R_i + t))^2);
   elongation 2 n (a - e), eq. (23).

`MENDS` lists every place where this departs from the print, with what each is worth on the four reference
actuators of `analytical.paper`. Modelling that is poor but not misprinted is kept, because this is the chain
that has to meet the printed closed-form numbers: eq. (22) has cos(theta) on both sides, so the geometry drops
out of the balance; it puts a Cauchy stress on an undeformed area (with sigma / lambda_a instead, the first
reference actuator goes from 11.7 to 16.3 cm); and it takes the thrust at the crest but the wall area at
the root. The wall's pull on the root is left out as well. Both 1 mm actuators are fully unfolded at 20 kPa,
so their numbers rest on step 2.

Equation (14) is a linearised square root. The mended chain uses the exact kinematics. They are told apart by:
the exact form unfolds the two 1 mm reference actuators at 18.09 and 8.44 kPa, the linearised one at 19.43
and 8.75; at 20 kPa the 1 mm elongations are the same (both unfolded) and the 2 mm ones differ by at most
0.07 cm. Against the printed column the worst of the four is 3.6 % exact, 4.0 % linearised.

Units: mm, N, MPa; pressures at the interface in kPa, as the names say.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from analytical.materials import FloatArray, Law
from analytical.tube import Tube, inner_radius_at_outer_mm, pressure_at_inner_radius_mpa

State = Literal["folded", "fully unfolded"]

# Root finding is to round-off; both roots are simple.
_RTOL = 4.0 * np.finfo(float).eps
_XTOL = 1e-14

# No elastomer stretches this far; a law that needs more has no stress to give.
_LARGEST_WALL_STRETCH = 1e3


class BellowsError(ValueError):
    """Bellows dimensions or a load the closed form cannot take; the message names value and remedy."""


@dataclass(frozen=True)
class BellowsDimensions:
    """Dimensions of the closed form (figure 2 of the paper).

    Parameters
    ----------
    root_radius_mm
        R_i, cavity-side radius at the root, mm.
    crest_radius_mm
        R_p, cavity-side radius at the crest, mm.
    wall_mm
        t, wall thickness, mm.
    half_pitch_mm
        e, axial distance from crest to root, mm.
    convolutions
        n, number of roots; 2 n half pitches.
    """

    root_radius_mm: float
    crest_radius_mm: float
    wall_mm: float
    half_pitch_mm: float
    convolutions: int

    def __post_init__(self) -> None:
        for name in ("root_radius_mm", "crest_radius_mm", "wall_mm", "half_pitch_mm"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise BellowsError(f"{name} = {value} must be a positive length in mm")
        if self.crest_radius_mm <= self.root_radius_mm:
            raise BellowsError(
                f"crest_radius_mm = {self.crest_radius_mm:g} must exceed root_radius_mm = "
                f"{self.root_radius_mm:g}: without a fold there is nothing to unfold"
            )
        if not float(self.convolutions).is_integer() or self.convolutions < 1:
            raise BellowsError(f"convolutions = {self.convolutions} must be a whole number of at least 1")

    @property
    def side_length_mm(self) -> float:
        """Side length l of the wall between root and crest, mm: l^2 = e^2 + (R_p - R_i)^2."""
        return math.hypot(self.half_pitch_mm, self.crest_radius_mm - self.root_radius_mm)

    @property
    def unfolded_root_stretch(self) -> float:
        """Outer hoop stretch of the root when it reaches the crest: (R_p + t) / (R_i + t)."""
        return (self.crest_radius_mm + self.wall_mm) / (self.root_radius_mm + self.wall_mm)


@dataclass(frozen=True)
class ClosedFormPath:
    """Answer of the closed form, one entry per pressure: arrays of shape (m,), `state` a tuple of length m.

    Attributes
    ----------
    pressure_kpa
        Pressures asked for, kPa.
    root_stretch
        lambda_y, hoop stretch of the root's outer surface.
    root_inner_stretch
        Hoop stretch of the root's inner surface (the largest of the root).
    wall_stretch
        lambda_a, stretch of the side wall along its length.
    wall_stress_mpa
        sigma, Cauchy stress of the side wall along its length, MPa.
    half_pitch_deformed_mm
        a, mm.
    side_length_deformed_mm
        b = lambda_a l, mm.
    angle_rad
        Angle theta between side wall and axis, cos(theta) = a / b, rad.
    elongation_mm
        2 n (a - e), mm.
    state
        "folded" or "fully unfolded".
    unfolding_pressure_kpa
        Pressure at which the root reaches the crest, kPa (one number).
    """

    pressure_kpa: FloatArray
    root_stretch: FloatArray
    root_inner_stretch: FloatArray
    wall_stretch: FloatArray
    wall_stress_mpa: FloatArray
    half_pitch_deformed_mm: FloatArray
    side_length_deformed_mm: FloatArray
    angle_rad: FloatArray
    elongation_mm: FloatArray
    state: tuple[State, ...]
    unfolding_pressure_kpa: float


@dataclass(frozen=True)
class Mend:
    """One departure of `closed_form` from the printed equations.

    Attributes
    ----------
    name
        Short name.
    equation
        Where in the paper.
    fault
        What is wrong there.
    mend
        What is done instead.
    effect_cm
        Change of the elongation at 20 kPa, cm, when this one item alone is put back as printed, for the four
        reference actuators in the order of `paper.PRINTED`; None where the print cannot be evaluated.
    """

    name: str
    equation: str
    fault: str
    mend: str
    effect_cm: tuple[float, float, float, float] | None


_NO_EFFECT: Final = (0.0, 0.0, 0.0, 0.0)

MENDS: Final[tuple[Mend, ...]] = (
    Mend(
        name="crest radius",
        equation="(1)",
        fault="the text calls R_p the internal area",
        mend="R_p is a radius, as in the equation itself and in figure 2",
        effect_cm=_NO_EFFECT,
    ),
    Mend(
        name="sign of the pressure",
        equation="(6), (11), (12), (16), (17)",
        fault=(
            "with the printed limits each of them makes an inflating pressure negative; the first "
            "integral in (6) starts at -r_o, a radius for a stress; sigma_r at the inner surface is -P"
        ),
        mend="P = int (sigma_theta - sigma_r) / r dr from r_i to r_o; in (6) d(sigma_r) from -P to 0",
        effect_cm=None,
    ),
    Mend(
        name="local radius",
        equation="(13)",
        fault="dr = R_i / (1 - lambda^2) d(lambda) uses the inner radius throughout the wall",
        mend="the local undeformed radius: dr / r = d(lambda) / (lambda (1 - lambda^2)); (11) already has it",
        effect_cm=_NO_EFFECT,
    ),
    Mend(
        name="Ogden derivative at the root",
        equation="(9), (10), (12), (17)",
        fault=(
            "the derivative by lambda_j of the mu/alpha form stands where dW/dI1 belongs, j is left open "
            "(initial shear modulus 151 kPa for any j); an Ogden energy is no function of I1"
        ),
        mend="sigma_theta - sigma_r of the law: k alpha (lambda^alpha - lambda^-alpha), k as in eq. (3)",
        # with j = theta; j = r gives +1.56, +0.11 and j = z gives -0.58, -0.35 for the 2 mm pair
        effect_cm=(0.0, 0.0, -0.85, -0.76),
    ),
    Mend(
        name="inner stretch",
        equation="(14)",
        fault="the square root is linearised",
        mend="lambda_i^2 = 1 + (1 + t/R_i)^2 (lambda_o^2 - 1)",
        effect_cm=(0.0, 0.0, -0.07, -0.03),
    ),
    Mend(
        name="steps of the root stretch",
        equation="text after (17)",
        fault="lambda_y is tabulated in steps of 0.1, how to read between them is not said",
        mend="the pressure is inverted to round-off",
        # read by linear interpolation in the pressure
        effect_cm=_NO_EFFECT,
    ),
    Mend(
        name="Ogden convention of the wall",
        equation="(20)",
        fault="the mu/alpha form, initial shear modulus 220 kPa, where the energy (3) has 75 kPa",
        mend="the same law as at the root, whose convention the caller names",
        effect_cm=(0.0, 0.0, -2.08, -1.27),
    ),
    Mend(
        name="wall offset",
        equation="(21), (22)",
        fault=(
            "R_p - lambda_y R_i - t subtracts t and stretches R_i by the outer stretch; at rest it does not "
            "give e with l^2 = e^2 + (R_p - R_i)^2"
        ),
        mend="a from (23); in (22) the same a stands on both sides and cancels",
        effect_cm=_NO_EFFECT,
    ),
    Mend(
        name="full unfolding",
        equation="(23)",
        fault="beyond lambda_y (R_i + t) = R_p + t the root outgrows the crest and the bellows folds back",
        mend="lambda_y stays there; the side wall goes on stretching",
        effect_cm=(-0.03, -7.57, 0.0, 0.0),
    ),
    Mend(
        name="elongation of the whole",
        equation="(23)",
        fault="the text calls it the displacement of each pitch, but the factor n is in it",
        mend="it is the displacement of the actuator",
        effect_cm=_NO_EFFECT,
    ),
)


def with_seat(dimensions: BellowsDimensions, seat_mm: float) -> BellowsDimensions:
    """Dimensions of the free wall when each crest has a cylindrical seat of width w.

    Half of the seat belongs to each half pitch and cannot unfold: the free half pitch is e - w/2, the side
    length follows from it, and the elongation is still 2 n (a - e) with the free a and e.

    Parameters
    ----------
    dimensions
        Nominal dimensions.
    seat_mm
        Seat width w, mm; 0 gives the nominal dimensions back.
    """
    if not 0.0 <= seat_mm < 2.0 * dimensions.half_pitch_mm:
        raise BellowsError(
            f"seat_mm = {seat_mm:g} must be at least 0 and below the pitch, "
            f"{2.0 * dimensions.half_pitch_mm:g} mm: the side wall needs axial room"
        )
    return replace(dimensions, half_pitch_mm=dimensions.half_pitch_mm - 0.5 * seat_mm)


def closed_form(dimensions: BellowsDimensions, law: Law, pressure_kpa: ArrayLike) -> ClosedFormPath:
    """Closed form of the paper with its misprints mended (see the module's docstring and `MENDS`).

    Parameters
    ----------
    dimensions
        Bellows dimensions.
    law
        Hyperelastic law of the silicone, stable over the stretches met (`materials.check_stability`).
    pressure_kpa
        Cavity pressures, kPa, not negative; a number or a one-dimensional array.

    Returns
    -------
    ClosedFormPath

    Raises
    ------
    BellowsError
        If a pressure is negative or not finite, or the law cannot carry the stress.
    """
    pressures_kpa = np.atleast_1d(np.asarray(pressure_kpa, dtype=float))
    if pressures_kpa.ndim != 1 or not np.all(np.isfinite(pressures_kpa)) or np.any(pressures_kpa < 0.0):
        raise BellowsError(f"pressure_kpa = {pressure_kpa!r} must be finite and not negative, in one dimension")
    pressures_mpa = 1e-3 * pressures_kpa
    d = dimensions
    root = Tube(d.root_radius_mm, d.root_radius_mm + d.wall_mm)
    unfolding_mpa = _root_pressure_mpa(root, law, d.unfolded_root_stretch)
    unfolded = pressures_mpa >= unfolding_mpa
    root_stretch = np.array([_root_stretch(d, root, law, p, unfolding_mpa) for p in pressures_mpa])
    wall_stress = pressures_mpa * d.crest_radius_mm**2 / (root.outer_radius_mm**2 - root.inner_radius_mm**2)
    wall_stretch = np.array([_wall_stretch(law, stress) for stress in wall_stress])
    outer = root.outer_radius_mm * root_stretch
    side = wall_stretch * d.side_length_mm
    # Exactly zero once unfolded, not the round-off of a difference.
    drop = np.where(unfolded, 0.0, d.crest_radius_mm + d.wall_mm - outer)
    half_pitch = np.sqrt(side**2 - drop**2)
    return ClosedFormPath(
        pressure_kpa=pressures_kpa,
        root_stretch=root_stretch,
        root_inner_stretch=np.array([inner_radius_at_outer_mm(root, r) for r in outer]) / root.inner_radius_mm,
        wall_stretch=wall_stretch,
        wall_stress_mpa=wall_stress,
        half_pitch_deformed_mm=half_pitch,
        side_length_deformed_mm=side,
        angle_rad=np.arctan2(drop, half_pitch),
        elongation_mm=2.0 * d.convolutions * (half_pitch - d.half_pitch_mm),
        state=tuple("fully unfolded" if is_unfolded else "folded" for is_unfolded in unfolded),
        unfolding_pressure_kpa=1e3 * unfolding_mpa,
    )


def _root_pressure_mpa(root: Tube, law: Law, outer_stretch: float) -> float:
    inner_mm = inner_radius_at_outer_mm(root, root.outer_radius_mm * outer_stretch)
    return pressure_at_inner_radius_mpa(root, law, inner_mm)


def _root_stretch(
    dimensions: BellowsDimensions, root: Tube, law: Law, pressure_mpa: float, unfolding_mpa: float
) -> float:
    """Outer hoop stretch lambda_y of the root, held at full unfolding."""
    # The pressure at rest is round-off of either sign; anything up to it is no pressure.
    if pressure_mpa <= max(0.0, _root_pressure_mpa(root, law, 1.0)):
        return 1.0
    if pressure_mpa >= unfolding_mpa:
        return dimensions.unfolded_root_stretch
    stretch = brentq(
        lambda trial: _root_pressure_mpa(root, law, trial) - pressure_mpa,
        1.0,
        dimensions.unfolded_root_stretch,
        xtol=_XTOL,
        rtol=_RTOL,
    )
    return float(stretch)


def _wall_stretch(law: Law, stress_mpa: float) -> float:
    """Stretch lambda_a of the side wall in pure shear at its Cauchy stress, MPa."""
    if stress_mpa == 0.0:
        return 1.0

    def excess(stretch: float) -> float:
        return float(law.stress_difference(stretch, 1.0 / stretch, 1.0)) - stress_mpa

    high = 1.5
    while excess(high) < 0.0:
        high *= 1.5
        if high > _LARGEST_WALL_STRETCH:
            raise BellowsError(f"{law} does not reach the wall stress {stress_mpa:g} MPa: lower the pressure")
    return float(brentq(excess, 1.0, high, xtol=_XTOL, rtol=_RTOL))
