"""Smallest distance between neighbouring folds and between the wall and rigid rings, at a state of a scene.

Measured in meridian planes: the one of an axisymmetric mesh, or all planes of nodes of a swept body. Of bodies, in
which contact is not modelled, a state beyond first touch is an answer without it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from meshes.gaps import NO_GAP, Gap, Outline, outlines, ring_section, smallest_gap, smallest_gap_to_ring
from meshes.solid import FloatArray, IntArray, SolidMesh
from solvers.state import State
from studies.scene.bellows import BellowsScene, shape_of

# Two walls that have gone into each other by more than this part of the wall are not seen as touching any more.
_DEPTH = 0.4
# Above the seat's radius by more than round-off of a position.
_RISEN_MM = 1e-6
# Places measured along an outline: finer meshes are measured at every second or fourth corner.
_MOST_SOURCES = 400


@dataclass(frozen=True)
class Touch:
    """A gap and what it is between: ``folds`` or ``wall and ring``."""

    gap: Gap
    between: str


class GapMeter:
    """Measures the gaps of states on one mesh of a scene.

    Parameters
    ----------
    scene
        A bellows.
    meridian
        The meridian mesh.
    body
        A body swept from it; None measures states of the meridian itself.
    """

    def __init__(self, scene: BellowsScene, meridian: SolidMesh, body: SolidMesh | None = None) -> None:
        self._shape, self._scene = shape_of(scene), scene
        self.modelled = False  # contact beyond first touch
        self._points = meridian.points if body is None else body.points
        flat = tuple(_thinned(outline) for outline in outlines(meridian))
        self._planes = [flat] if body is None else _planes(flat, body)
        self._rings = len(self._shape.crest_positions_mm) if scene.rings.model == "rigid" else 0

    def measure(self, state: State) -> Touch:
        """The smallest gap of a state."""
        x = self._points + state.displacement_mm
        rz = x if x.shape[1] == 2 else np.column_stack([np.hypot(x[:, 0], x[:, 1]), x[:, 2]])
        depth, reach = _DEPTH * self._shape.wall_mm, 2.0 * self._shape.half_pitch_mm
        smallest = Touch(NO_GAP, "folds")
        for plane in self._planes:
            for outline in plane:
                gap = smallest_gap(outline, rz, depth, reach)
                if gap.gap_mm < smallest.gap.gap_mm:
                    smallest = Touch(gap, "folds")
            for ring in range(self._rings):
                gap = self._to_ring(state, x, plane[1], ring)
                if gap.gap_mm < smallest.gap.gap_mm:
                    smallest = Touch(gap, "wall and ring")
        return smallest

    def _to_ring(self, state: State, x: FloatArray, outside: Outline, ring: int) -> Gap:
        """Gap of the ring to what of the wall beside it has risen above the seat, seen from the ring."""
        centre = float(self._shape.crest_positions_mm[ring])
        rings = self._scene.rings
        nodes = outside.nodes
        away = np.abs(self._points[nodes, -1] - centre) - 0.5 * rings.seat_mm
        # at its edge the seat touches the ring by construction
        beside = nodes[(away > rings.edge_radius_mm) & (away < 2.0 * self._shape.half_pitch_mm)]
        section = ring_section(self._shape.seat_radius_mm, 0.0, rings.seat_mm, rings.height_mm, rings.edge_radius_mm)
        motion = state.bodies_mm[ring]
        if x.shape[1] == 2:
            local = x[beside] - np.array([0.0, centre + motion[0]])
        else:
            move = motion if len(motion) == 6 else np.array([0.0, 0.0, motion[0], 0.0, 0.0, 0.0])
            turn = Rotation.from_rotvec(move[3:] / self._shape.seat_radius_mm)
            seen = turn.inv().apply(x[beside] - np.array([0.0, 0.0, centre]) - move[:3])
            local = np.column_stack([np.hypot(seen[:, 0], seen[:, 1]), seen[:, 2]])
        # below the seat's radius the wall passes under the ring's edge and can only come near its flank from above
        found = smallest_gap_to_ring(local[local[:, 0] > self._shape.seat_radius_mm + _RISEN_MM], section)
        return replace(
            found, at_mm=found.at_mm + np.array([0.0, centre + (motion[0] if len(motion) == 1 else motion[2])])
        )


def _thinned(outline: Outline) -> Outline:
    """An outline measured at no more places than are needed."""
    return replace(outline, sources=outline.sources[:: math.ceil(len(outline.sources) / _MOST_SOURCES)])


def _planes(flat: tuple[Outline, ...], body: SolidMesh) -> list[tuple[Outline, ...]]:
    """The outlines in every meridian plane in which the body has all their nodes, as far as the cap's core."""
    single = body.meridian_node if body.meridian_node.ndim == 1 else body.meridian_node[:, 0]
    exact = np.ones(len(single), dtype=bool)
    if len(body.meridian_weight):
        exact = body.meridian_weight.max(axis=1) == 1.0
    planes = []
    for angle in np.unique(
        np.round(body.angle_rad[exact & (body.points[:, 0] ** 2 + body.points[:, 1] ** 2 > 0.0)], 9)
    ):
        here = np.flatnonzero(exact & np.isclose(body.angle_rad, angle, atol=1e-8))
        number = np.full(int(single.max()) + 1, -1, dtype=np.int64)
        number[single[here]] = here
        cut = tuple(_cut(outline, number) for outline in flat)
        if all(len(outline.sources) > 0 for outline in cut):
            planes.append(cut)
    return planes


def _cut(outline: Outline, number: IntArray) -> Outline:
    """The part of an outline, from its start, whose nodes are in a plane."""
    known = np.where(outline.nodes < len(number), number[np.minimum(outline.nodes, len(number) - 1)], -1)
    missing = np.flatnonzero(known < 0)
    length = int(missing[0]) if len(missing) else len(known)
    length -= 1 - length % 2  # whole edges
    return replace(outline, nodes=known[:length], sources=outline.sources[outline.sources < length])
