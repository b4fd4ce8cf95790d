"""The way of the wall's middle line from a seat's edge to the middle of the next root: straight pieces and arcs.

Angles are those of the line to the axis, positive where the radius shrinks; every arc has the centreline's radius
``rho``, so that the concave surface has that of the fillets.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from meshes.errors import GeometryError
from meshes.shape import BellowsShape


@dataclass(frozen=True)
class Piece:
    """A straight piece or an arc of the middle line.

    Attributes
    ----------
    kind
        ``crest`` and ``root`` for the arcs at both ends, ``side`` for all between.
    length_mm
        Its length.
    start_rad, end_rad
        Angle of the line to the axis at both ends.
    """

    kind: str
    length_mm: float
    start_rad: float
    end_rad: float


def half_fold(shape: BellowsShape) -> list[Piece]:
    """Pieces from the edge of a crest's seat to the middle of the next root.

    Raises
    ------
    GeometryError
        If the fold cannot be built, naming the violated inequality.
    """
    if shape.bends_mm:
        return _bent(shape)
    phi, rho = side_angle(shape), shape.centreline_radius_mm
    drop = shape.crest_radius_mm - shape.root_radius_mm
    side_length = (drop - 2.0 * rho * (1.0 - math.cos(phi))) / math.sin(phi)
    return [
        Piece("crest", rho * phi, 0.0, phi),
        Piece("side", side_length, phi, phi),
        Piece("root", rho * phi, phi, 0.0),
    ]


def _bent(shape: BellowsShape) -> list[Piece]:
    """The fold through bends: tangents to the arcs at crest and root, and an arc in every bend."""
    rho, half_wall = shape.centreline_radius_mm, 0.5 * shape.wall_mm
    for z, r in shape.bends_mm:
        if not (0.0 < z < shape.half_pitch_mm and half_wall < r):
            raise GeometryError(
                f"bends_mm = [{z:g}, {r:g}]: a bend lies between crest and root, 0 < z < half_pitch_mm = "
                f"{shape.half_pitch_mm:g}, and its radius exceeds half of wall_mm = {half_wall:g}"
            )
    first, last = shape.bends_mm[0], shape.bends_mm[-1]
    # both ends are alike, seen from the middle of their arcs
    crest = _tangent(first[0] - 0.5 * shape.seat_mm, first[1] - (shape.crest_radius_mm + half_wall - rho), rho, first)
    root = _tangent(shape.half_pitch_mm - last[0], shape.root_radius_mm + half_wall + rho - last[1], rho, last)
    lines = [crest, *(_line(a, b) for a, b in pairwise(shape.bends_mm)), root]
    turns = [after[0] - before[0] for before, after in pairwise(lines)]
    cut = [0.0, *(rho * math.tan(0.5 * abs(turn)) for turn in turns), 0.0]
    pieces = [Piece("crest", rho * abs(crest[0]), 0.0, crest[0])]
    for k, (angle, length) in enumerate(lines):
        straight = length - cut[k] - cut[k + 1]
        if straight < 0.0:
            which = f"{'to' if k == 0 else 'from'} {list(shape.bends_mm[max(0, k - 1)])}"
            raise GeometryError(
                f"bends_mm: the line {which} is {length:g} mm long, and rounding its ends takes "
                f"{cut[k] + cut[k + 1]:g} mm: take a smaller fillet_mm or a longer line"
            )
        pieces.append(Piece("side", straight, angle, angle))
        if k < len(turns):
            pieces.append(Piece("side", rho * abs(turns[k]), angle, lines[k + 1][0]))
    return [*pieces, Piece("root", rho * abs(root[0]), root[0], 0.0)]


def _line(start: tuple[float, float], end: tuple[float, float]) -> tuple[float, float]:
    """Angle and length of the straight line between two bends."""
    z, r = end[0] - start[0], end[1] - start[1]
    return math.atan2(-r, z), math.hypot(z, r)


def _tangent(along: float, across: float, rho: float, bend: tuple[float, float]) -> tuple[float, float]:
    """Angle and length of the tangent from an end's arc to a bend, seen from the middle of the arc.

    With (sin a, cos a) normal to a line of the angle a: ``along sin a + across cos a = rho``.
    """
    distance = math.hypot(along, across)
    if distance <= rho:
        raise GeometryError(
            f"bends_mm = {list(bend)}: lies within the arc of the crest or root beside it, of radius {rho:g} mm in the "
            "wall's middle: move it away, or take a smaller fillet_mm"
        )
    angle = math.atan2(along, across) - math.acos(rho / distance)
    if not 0.0 < angle < math.pi:
        raise GeometryError(
            f"bends_mm = {list(bend)}: lies beyond the crest or root beside it: the wall would have to turn back there"
        )
    return angle, math.sqrt(distance**2 - rho**2)


def side_angle(shape: BellowsShape) -> float:
    """Inclination of the straight side to the axis, so that flats, arcs and side fill half a pitch.

    Solves, with arcs of centreline radius rho on both ends and a side of length L,
    ``2 rho sin(phi) + L cos(phi) = e - w/2`` and ``2 rho (1 - cos(phi)) + L sin(phi) = R_p - R_i``.

    Returns
    -------
    float
        phi in radians, in (0, pi/2].

    Raises
    ------
    GeometryError
        If no angle up to 90 degrees fits, naming the violated inequality.
    """
    rho = shape.centreline_radius_mm
    room = shape.half_pitch_mm - 0.5 * shape.seat_mm
    drop = shape.crest_radius_mm - shape.root_radius_mm
    if room < 2.0 * rho - 1e-12:
        raise GeometryError(
            f"half_pitch_mm = {shape.half_pitch_mm:g} leaves {room:g} mm beside half a seat; two arcs need "
            f"half_pitch >= seat/2 + 2 fillet + wall = {0.5 * shape.seat_mm + 2.0 * rho:g} mm: lengthen the "
            "pitch, or take a narrower seat, a smaller fillet or a thinner wall"
        )
    if drop < 2.0 * rho - 1e-12:
        raise GeometryError(
            f"crest_radius_mm - root_radius_mm = {drop:g} mm is less than two arcs need, "
            f"2 fillet + wall = {2.0 * rho:g} mm: take deeper convolutions, a smaller fillet or a thinner wall"
        )

    def excess(phi: float) -> float:
        length = (drop - 2.0 * rho * (1.0 - math.cos(phi))) / math.sin(phi)
        return 2.0 * rho * math.sin(phi) + length * math.cos(phi) - room

    if excess(0.5 * math.pi) > -1e-12:
        return 0.5 * math.pi
    low, high = 1e-6, 0.5 * math.pi
    for _ in range(200):  # bisection to the last bit: the function falls from +inf to a negative value
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle) > 0.0 else (low, middle)
    return 0.5 * (low + high)
