"""The outline of a bellows: wall centreline of flats and arcs, collars, a solid end cap or an open end.

Axial coordinate z runs from the clamped proximal end (z = 0) to the distal face. Crest 0 is centred at
z = collar; crests and roots alternate every half pitch. The paper (doi 10.3390/biomimetics9030160) prints
only names of dimensions; which surface a radius belongs to is this project's choice and is stated below.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshes.errors import GeometryError
from meshes.fold import Piece, half_fold
from meshes.shape import BellowsShape

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Segment:
    """One smooth piece of the band between cavity side and outside.

    Attributes
    ----------
    kind
        ``collar``, ``seat``, ``crest``, ``side`` or ``root``.
    length_mm
        Length of its centreline.
    angle_rad
        Angle it turns through (0 for straight pieces).
    start
        (r, z) where its centreline starts, mm.
    wall_mm
        Wall thickness.
    tangent_start_rad, tangent_end_rad
        Angle of the centreline to the axis, positive where the radius shrinks.
    index
        Number of the crest or root it belongs to.
    """

    kind: str
    length_mm: float
    angle_rad: float
    start: tuple[float, float]
    wall_mm: float
    tangent_start_rad: float
    tangent_end_rad: float
    index: int

    def band(self, fraction: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Points on the cavity side and on the outside.

        Parameters
        ----------
        fraction
            Positions along the piece in [0, 1], shape (m,).

        Returns
        -------
        inner, outer
            Arrays of shape (m, 2), columns (r, z) in mm.
        """
        r0, z0 = self.start
        tangent = self.tangent_start_rad + fraction * (self.tangent_end_rad - self.tangent_start_rad)
        turn = self.tangent_end_rad - self.tangent_start_rad
        if turn == 0.0:
            r = r0 - fraction * self.length_mm * math.sin(self.tangent_start_rad)
            z = z0 + fraction * self.length_mm * math.cos(self.tangent_start_rad)
        else:
            radius = self.length_mm / turn
            r = r0 + radius * (np.cos(tangent) - math.cos(self.tangent_start_rad))
            z = z0 + radius * (np.sin(tangent) - math.sin(self.tangent_start_rad))
        centre = np.column_stack([r, z])
        normal = np.column_stack([np.cos(tangent), np.sin(tangent)])
        return centre - 0.5 * self.wall_mm * normal, centre + 0.5 * self.wall_mm * normal


def check_shape(shape: BellowsShape) -> None:
    """Refuse a shape that cannot be built.

    Raises
    ------
    GeometryError
        Naming the value and the violated inequality.
    """
    positive = ("root_radius_mm", "crest_radius_mm", "wall_mm", "half_pitch_mm", "collar_mm", "fillet_mm")
    for name in positive:
        value = getattr(shape, name)
        if not (math.isfinite(value) and value > 0.0):
            raise GeometryError(f"{name} = {value}: must be a finite length > 0 mm")
    for name, none in (("seat_mm", "no seats"), ("cap_mm", "an open end")):
        value = getattr(shape, name)
        if not (math.isfinite(value) and value >= 0.0):
            raise GeometryError(f"{name} = {value}: must be a finite length >= 0 mm (0: {none})")
    if shape.convolutions < 1:
        raise GeometryError(f"convolutions = {shape.convolutions}: must be at least 1")
    if shape.crest_radius_mm <= shape.root_radius_mm:
        raise GeometryError(
            f"crest_radius_mm = {shape.crest_radius_mm:g} must exceed root_radius_mm = {shape.root_radius_mm:g}"
        )
    if shape.collar_mm < 0.5 * shape.seat_mm + shape.fillet_mm:
        raise GeometryError(
            f"collar_mm = {shape.collar_mm:g} must be at least seat/2 + fillet = "
            f"{0.5 * shape.seat_mm + shape.fillet_mm:g} mm, so that the first and last seats fit"
        )
    if shape.fillet_mm >= shape.crest_radius_mm:
        raise GeometryError(
            f"fillet_mm = {shape.fillet_mm:g} must be less than crest_radius_mm = {shape.crest_radius_mm:g}"
        )
    half_fold(shape)


def wall_segments(shape: BellowsShape) -> list[Segment]:
    """The wall from the clamped end to the start of the cap's corner, or to the open end, piece by piece.

    Returns
    -------
    list of Segment
        In order of the centreline's arc length; neighbouring pieces share their end points and tangents.
    """
    t, half_seat = shape.wall_mm, 0.5 * shape.seat_mm
    down = half_fold(shape)
    up = [Piece(p.kind, p.length_mm, -p.end_rad, -p.start_rad) for p in reversed(down)]

    segments: list[Segment] = []
    position = (shape.crest_radius_mm + 0.5 * t, 0.0)

    def add(kind: str, length: float, angle_0: float, angle_1: float, index: int) -> None:
        nonlocal position
        if length <= 1e-9:
            return
        segment = Segment(kind, length, abs(angle_1 - angle_0), position, t, angle_0, angle_1, index)
        inner, outer = segment.band(np.array([1.0]))
        centre = 0.5 * (inner[0] + outer[0])
        position = (float(centre[0]), float(centre[1]))
        segments.append(segment)

    add("collar", shape.collar_mm - half_seat, 0.0, 0.0, 0)
    add("seat", half_seat, 0.0, 0.0, 0)
    for k in range(shape.convolutions):
        add("seat", half_seat, 0.0, 0.0, k)
        for piece in down:
            add(piece.kind, piece.length_mm, piece.start_rad, piece.end_rad, k)
        for piece in up:
            add(piece.kind, piece.length_mm, piece.start_rad, piece.end_rad, k + (piece.kind == "crest"))
        add("seat", half_seat, 0.0, 0.0, k + 1)
    add("seat", half_seat, 0.0, 0.0, shape.convolutions)
    corner = shape.fillet_mm if shape.has_cap else 0.0
    add("collar", shape.collar_mm - half_seat - corner, 0.0, 0.0, shape.convolutions)
    return segments


def corner_band(shape: BellowsShape, fraction: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The band from the wall's end round the cavity's filleted corner into the cap.

    The cavity side is a quarter circle of radius ``fillet_mm``; the outside runs up to the distal edge,
    reached at fraction 0.5, and then along the distal face.

    Returns
    -------
    inner, outer
        Arrays of shape (m, 2), columns (r, z) in mm.
    """
    f, t, crest = shape.fillet_mm, shape.wall_mm, shape.crest_radius_mm
    z_cap = shape.cavity_length_mm
    angle = 0.5 * math.pi * fraction
    inner = np.column_stack([crest - f + f * np.cos(angle), z_cap - f + f * np.sin(angle)])
    up = np.minimum(2.0 * fraction, 1.0)
    across = np.maximum(2.0 * fraction - 1.0, 0.0)
    outer = np.column_stack([crest + t - across * (t + f), z_cap - f + up * (f + shape.cap_mm)])
    return inner, outer


def cap_band(shape: BellowsShape, fraction: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The flat part of the cap from the corner (fraction 0) to the axis (fraction 1).

    Returns
    -------
    inner, outer
        Arrays of shape (m, 2), columns (r, z) in mm.
    """
    r = (shape.crest_radius_mm - shape.fillet_mm) * (1.0 - fraction)
    z_cap = shape.cavity_length_mm
    return (
        np.column_stack([r, np.full_like(r, z_cap)]),
        np.column_stack([r, np.full_like(r, z_cap + shape.cap_mm)]),
    )
