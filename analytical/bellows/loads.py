"""The closed form the other way round: pressure for an elongation, force at a held tip.

Source of the chain: Heung et al., Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160, section 3; the tip force is
its force balance F_resistive = F_pressure (eqs. (1), (22)) with what is missing to it.
Units: mm, N, MPa inside; pressures at the interface in kPa.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.bellows.chains import closed_form
from analytical.bellows.dimensions import BellowsDesigns, BellowsDimensions, BellowsError
from analytical.bellows.equations import Sizes
from analytical.bellows.reading import CORRECTED, Reading
from analytical.laws.isotropic import Law

# Silicone bursts long before; a search that gets here has no answer.
LARGEST_PRESSURE_KPA = 1e5


@dataclass(frozen=True)
class HeldTip:
    """Forces on a tip held at an elongation; arrays of the shape of the designs, then of the pressures.

    Attributes
    ----------
    pressure_kpa
        Pressures, kPa.
    elongation_mm
        Where the tip is held, mm.
    tip_force_n
        Force of the actuator on what holds it, N: positive pushes outwards.
    extension_force_n
        Thrust of the pressure, N: also the tip force of a wall that carries nothing.
    resistive_force_n
        Axial pull of the wall, N; negative where the wall is shorter than at rest and pushes.
    wall_stretch
        lambda_a. Below 1 a thin wall would rather buckle than push: the tip force then lies between
        ``extension_force_n`` and ``tip_force_n``.
    """

    pressure_kpa: FloatArray
    elongation_mm: float
    tip_force_n: FloatArray
    extension_force_n: FloatArray
    resistive_force_n: FloatArray
    wall_stretch: FloatArray


def pressure_at_elongation_kpa(
    dimensions: BellowsDimensions, law: Law, elongation_mm: float, reading: Reading = CORRECTED
) -> float:
    """Smallest pressure at which the chain gives an elongation, kPa.

    Parameters
    ----------
    dimensions, law, reading
        As in `chains.closed_form`; a reading that folds back has no unique answer and is refused.
    elongation_mm
        Wanted elongation, mm, not negative.

    Returns
    -------
    float
        To round-off of the elongation over its slope.

    Raises
    ------
    BellowsError
        If the elongation is negative, or not reached below the pressure at which the law gives out.
    """
    from scipy.optimize import brentq  # takes 0.1 s to import, which every scene would pay

    if not (math.isfinite(elongation_mm) and elongation_mm >= 0.0):
        raise BellowsError(f"elongation_mm = {elongation_mm} must be finite and not negative")
    if reading.folds_back:
        raise BellowsError(
            "a reading with folds_back has no unique pressure for an elongation: use the corrected chain"
        )
    if elongation_mm == 0.0:
        return 0.0

    def excess(pressure_kpa: float) -> float:
        return float(closed_form(dimensions, law, pressure_kpa, reading).elongation_mm[0]) - elongation_mm

    high = 1.0  # kPa; doubled until it is enough
    while excess(high) < 0.0:
        high *= 2.0
        if high > LARGEST_PRESSURE_KPA:
            raise BellowsError(f"elongation_mm = {elongation_mm:g} is not reached below {high:g} kPa: ask for less")
    return float(brentq(excess, 0.0, high, xtol=1e-14, rtol=4.0 * np.finfo(float).eps))


def held_tip(
    dimensions: BellowsDimensions | BellowsDesigns,
    law: Law,
    pressure_kpa: ArrayLike,
    elongation_mm: float = 0.0,
    reading: Reading = CORRECTED,
) -> HeldTip:
    """Force at a tip held at an elongation; 0 is the blocked tip.

    The chain's force balance with the tip force added: F_tip = F_pressure - F_resistive. It assumes that the root
    opens as it does when the tip is free (the pressure alone decides), that the side wall stays straight between
    root and crest and carries compression like tension, and that nothing touches or buckles sideways.

    Parameters
    ----------
    dimensions, law, pressure_kpa, reading
        As in `chains.closed_form`.
    elongation_mm
        Where the tip is held, mm; above -2 n e.

    Returns
    -------
    HeldTip

    Raises
    ------
    BellowsError
        As `chains.closed_form`, or if the actuator would have to be shorter than nothing.
    """
    size = Sizes.of(dimensions)
    half_pitch = size.half_pitch + elongation_mm / (2.0 * size.convolutions)
    if not np.all(half_pitch > 0.0):
        shortest_mm = float(np.min(2.0 * size.convolutions * size.half_pitch))
        raise BellowsError(f"elongation_mm = {elongation_mm} leaves no length: it must exceed {-shortest_mm:g}")
    free = closed_form(dimensions, law, pressure_kpa, reading)
    held = replace(free, wall_stretch=np.hypot(half_pitch, free.drop_mm) / size.side)
    return HeldTip(
        pressure_kpa=held.pressure_kpa,
        elongation_mm=elongation_mm,
        tip_force_n=held.extension_force_n - held.resistive_force_n,
        extension_force_n=held.extension_force_n,
        resistive_force_n=held.resistive_force_n,
        wall_stretch=held.wall_stretch,
    )
