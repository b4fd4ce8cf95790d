"""Mass of an actuator with a set of dimensions, against the printed one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from analytical.arrays import BoolArray, FloatArray
from analytical.bellows.dimensions import silicone_mass_g
from analytical.bellows.fit.members import WALLS_MM, Members
from analytical.bellows.paper import PRINTED_MASS_G
from analytical.laws.silicones import SILICONE_DENSITY_G_CM3
from analytical.laws.stiff import PLA

# The paper's "approximate weight" leaves this much room.
MASS_WITHIN: Final = 0.40


@dataclass(frozen=True)
class Fittings:
    """What has to be added to the folded wall to make an actuator; none of it is printed.

    Attributes
    ----------
    cap_mm
        Thickness of the solid end cap, mm.
    collar_mm
        Straight wall beyond the middle of the first and of the last crest, mm.
    seat_mm
        Axial width of the ring's cylindrical seat on each crest, mm.
    ring_height_mm
        Radial height of the rings, mm; they are as wide as the seats.
    """

    cap_mm: float
    collar_mm: float
    seat_mm: float
    ring_height_mm: float


def silicone_g(members: Members, fittings: Fittings) -> FloatArray:
    """Estimated mass of the silicone body with sharp corners: wall, seats, collars, cap; shape (m, 4), g.

    Conical walls over the free half pitch e - w/2, cylinders at the crests for n seats and two collars, a disc.
    Rounded corners are left out, so that every set has a mass, also one whose arcs would not fit.
    """
    d = members.designs
    free = replace(d, half_pitch_mm=np.asarray(d.half_pitch_mm) - 0.5 * fittings.seat_mm)
    inner, outer = _crest_radii_mm(members)
    straight_mm = members.convolutions[:, None] * fittings.seat_mm + 2.0 * fittings.collar_mm
    rest_mm3 = np.pi * ((outer**2 - inner**2) * straight_mm + outer**2 * fittings.cap_mm)
    return np.asarray(silicone_mass_g(free, SILICONE_DENSITY_G_CM3) + 1e-3 * SILICONE_DENSITY_G_CM3 * rest_mm3)


def rings_g(members: Members, fittings: Fittings) -> FloatArray:
    """Mass of the n + 1 PLA rings with sharp edges, shape (m, 4), g."""
    _, inner = _crest_radii_mm(members)
    section_mm2 = np.pi * ((inner + fittings.ring_height_mm) ** 2 - inner**2)
    volume_mm3 = (members.convolutions[:, None] + 1) * section_mm2 * fittings.seat_mm
    return np.asarray(1e-3 * PLA.density_g_cm3 * volume_mm3)


def _crest_radii_mm(members: Members) -> tuple[FloatArray, FloatArray]:
    """Cavity-side and outer radius of the crests, mm, shapes (m, 1) and (m, 4)."""
    inner = members.crest_radius_mm[:, None]
    return inner, inner + WALLS_MM


def mass_allowed(mass_g: FloatArray) -> BoolArray:
    """Whether the mean over the four actuators is within 40 % of the printed 19 g; (m, 4) to (m,).

    The mean, because the paper states one approximate weight for "the actuator" and has four actuators.
    """
    return np.asarray(np.abs(mass_g.mean(axis=1) / PRINTED_MASS_G - 1.0) <= MASS_WITHIN)
