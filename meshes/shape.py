"""The dimensions of a bellows' outline."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class BellowsShape:
    """Dimensions of a bellows with a solid end cap or an open distal end, all in mm.

    Attributes
    ----------
    root_radius_mm, crest_radius_mm
        Cavity-side radii R_i at the roots and R_p at the crests.
    wall_mm
        Wall thickness t, measured normal to the wall.
    half_pitch_mm
        Axial distance e from a crest's middle to the next root's middle.
    convolutions
        Number n of roots; there are n + 1 crests, each with a ring seat.
    collar_mm
        Straight length beyond the middle of the first and the last crest.
    seat_mm
        Axial width of the cylindrical ring seat at each crest (r = R_p + t on the outside).
    fillet_mm
        Radius of every concave surface (cavity side at crests and cap, outside at roots).
    cap_mm
        Thickness of the end cap; 0 leaves the distal end open, its annulus flat at ``cavity_length_mm``.
    bends_mm
        Where the wall's middle line bends on its way from a crest to the next root: axial distances from the crest's
        middle and radii, before the bends are rounded; none for sides that are straight.
    """

    root_radius_mm: float
    crest_radius_mm: float
    wall_mm: float
    half_pitch_mm: float
    convolutions: int
    collar_mm: float
    seat_mm: float
    fillet_mm: float
    cap_mm: float
    bends_mm: tuple[tuple[float, float], ...] = ()

    @property
    def has_cap(self) -> bool:
        """False for an open distal end."""
        return self.cap_mm > 0.0

    @property
    def centreline_radius_mm(self) -> float:
        """Radius of the centreline's arcs: a concave surface of radius ``fillet_mm`` half a wall away."""
        return self.fillet_mm + 0.5 * self.wall_mm

    @property
    def crest_positions_mm(self) -> FloatArray:
        """Axial positions of the crests' middles, shape (n + 1,)."""
        return self.collar_mm + 2.0 * self.half_pitch_mm * np.arange(self.convolutions + 1)

    @property
    def cavity_length_mm(self) -> float:
        """Distance from the inlet plane z = 0 to the cap's cavity side."""
        return 2.0 * self.collar_mm + 2.0 * self.half_pitch_mm * self.convolutions

    @property
    def seat_radius_mm(self) -> float:
        """Outer radius of the ring seats."""
        return self.crest_radius_mm + self.wall_mm
