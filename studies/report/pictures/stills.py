"""What a picture of a body shows: states, and rings that are not meshed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class RingBox:
    """A rigid ring that is not in the VTU: a rectangle turned about the axis.

    Attributes
    ----------
    centre_mm
        Where its middle stands along the axis in the state drawn, mm.
    inner_radius_mm, width_mm, height_mm
        Radius of its seat, extent along the axis, and extent outwards from the seat, mm.
    """

    centre_mm: float
    inner_radius_mm: float
    width_mm: float
    height_mm: float


@dataclass(frozen=True)
class Still:
    """One state to draw.

    Attributes
    ----------
    label
        Text beside it.
    vtu
        The body: point fields ``displacement_mm`` and ``stretch_max``, cell field ``region``.
    deformed
        False: in its reference position, where every stretch is 1.
    rings
        Rigid rings to draw with it.
    """

    label: str
    vtu: Path
    deformed: bool = True
    rings: tuple[RingBox, ...] = ()
