"""Dimensions of a bellows actuator with rigid crest rings, one or many at once.

Symbols and figure 2: Heung et al., Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160.
Units: mm.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import BoolArray, FloatArray


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
        BellowsDesigns(**vars(self))

    @property
    def side_length_mm(self) -> float:
        """Side length l of the wall between root and crest, mm: l^2 = e^2 + (R_p - R_i)^2."""
        return math.hypot(self.half_pitch_mm, self.crest_radius_mm - self.root_radius_mm)

    @property
    def unfolded_root_stretch(self) -> float:
        """Outer hoop stretch of the root when it reaches the crest: (R_p + t) / (R_i + t)."""
        return (self.crest_radius_mm + self.wall_mm) / (self.root_radius_mm + self.wall_mm)


@dataclass(frozen=True, eq=False)
class BellowsDesigns:
    """Dimensions of many bellows: the fields of `BellowsDimensions` as arrays that broadcast together.

    Attributes
    ----------
    root_radius_mm, crest_radius_mm, wall_mm, half_pitch_mm, convolutions
        As in `BellowsDimensions`; numbers or arrays.
    """

    root_radius_mm: ArrayLike
    crest_radius_mm: ArrayLike
    wall_mm: ArrayLike
    half_pitch_mm: ArrayLike
    convolutions: ArrayLike

    def __post_init__(self) -> None:
        for name in ("root_radius_mm", "crest_radius_mm", "wall_mm", "half_pitch_mm"):
            bad = _first(getattr(self, name), lambda x: ~(np.isfinite(x) & (x > 0.0)))
            if bad is not None:
                raise BellowsError(f"{name} = {bad} must be a positive length in mm")
        root, crest = np.broadcast_arrays(self.root_radius_mm, self.crest_radius_mm)
        if np.any(crest <= root):
            at = np.flatnonzero(np.ravel(crest <= root))[0]
            raise BellowsError(
                f"crest_radius_mm = {np.ravel(crest)[at]:g} must exceed root_radius_mm = "
                f"{np.ravel(root)[at]:g}: without a fold there is nothing to unfold"
            )
        bad = _first(self.convolutions, lambda x: ~(np.isfinite(x) & (x == np.round(x)) & (x >= 1.0)))
        if bad is not None:
            raise BellowsError(f"convolutions = {bad} must be a whole number of at least 1")

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the designs."""
        return np.broadcast_shapes(*(np.shape(value) for value in vars(self).values()))

    @property
    def side_length_mm(self) -> FloatArray:
        """Side length l, mm, as in `BellowsDimensions`."""
        fold = np.asarray(self.crest_radius_mm, dtype=float) - np.asarray(self.root_radius_mm, dtype=float)
        return np.asarray(np.hypot(self.half_pitch_mm, fold))

    @property
    def unfolded_root_stretch(self) -> FloatArray:
        """Outer hoop stretch of the root when it reaches the crest, as in `BellowsDimensions`."""
        wall = np.asarray(self.wall_mm, dtype=float)
        return np.asarray((self.crest_radius_mm + wall) / (self.root_radius_mm + wall))


def _first(values: ArrayLike, is_bad: Callable[[FloatArray], BoolArray]) -> float | None:
    """The first value for which the test holds, None if there is none."""
    flat = np.ravel(np.asarray(values, dtype=float))
    bad = flat[is_bad(flat)]
    return float(bad[0]) if bad.size else None


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


def silicone_mass_g(dimensions: BellowsDimensions | BellowsDesigns, density_g_cm3: float) -> FloatArray:
    """Mass of the folded wall alone (conical walls, no caps, collars, seats or rings), g.

    The wall of one half pitch is a cone frustum's shell of thickness t normal to its cavity side: by Pappus
    its volume is l t pi (R_i + R_p + t sin(phi)), where t/2 sin(phi) moves the middle surface outwards and
    sin(phi) = e / l.

    Returns
    -------
    ndarray
        Shape of the designs.
    """
    d = dimensions
    length, wall = np.asarray(d.side_length_mm), np.asarray(d.wall_mm, dtype=float)
    mean_diameter_mm = d.root_radius_mm + (d.crest_radius_mm + wall * d.half_pitch_mm / length)
    volume_mm3 = 2.0 * np.asarray(d.convolutions) * math.pi * length * wall * mean_diameter_mm
    return np.asarray(1e-3 * density_g_cm3 * volume_mm3)
