"""Sections of bodies that have left the axis, in the plane y = 0, drawn from their states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.patches import Polygon
from scipy.spatial.transform import Rotation

from meshes.gaps import outlines
from meshes.solid import FloatArray, IntArray, SolidMesh
from solvers.state import State
from studies.report.style import BLUE, figure_file
from studies.scene.bellows import BellowsScene, shape_of

_WALL, _RING = "#b7d3e8", "#8c8c8c"
_MM_PER_INCH = 16.0


@dataclass(frozen=True, eq=False)
class Bent:
    """A state to draw: its text, scene, meridian, body and state."""

    label: str
    scene: BellowsScene
    meridian: SolidMesh
    body: SolidMesh
    state: State


def draw_bent(path: Path, states: Sequence[Bent]) -> None:
    """Draw states below each other to one scale, the axis to the right, x upwards."""
    shapes = [(section(b.meridian, b.body, b.state), ring_sections(b.scene, b.state)) for b in states]
    corners = np.vstack([part for (outer, _), rings in shapes for part in [outer, *rings]])
    low, high = corners.min(axis=0) - 1.0, corners.max(axis=0) + 1.0
    size = (high - low) / _MM_PER_INCH
    with figure_file(path, size[1] + 0.9, (size[0] + 0.35) * len(states) + 0.4) as figure:
        rows = figure.subplots(len(states), 1, sharex=True, squeeze=False)[:, 0]
        for axes, bent, ((outer, cavity), rings) in zip(rows, states, shapes, strict=True):
            axes.add_patch(Polygon(outer[:, ::-1], facecolor=_WALL, edgecolor=BLUE, linewidth=0.8))
            axes.add_patch(Polygon(cavity[:, ::-1], facecolor="white", edgecolor=BLUE, linewidth=0.8))
            for ring in rings:
                axes.add_patch(Polygon(ring[:, ::-1], facecolor=_RING, edgecolor="black", linewidth=0.6))
            axes.axhline(0.0, color="black", linewidth=0.6, dashes=(14, 3, 3, 3))
            axes.set(xlim=(low[1], high[1]), ylim=(low[0], high[0]), aspect="equal")
            axes.set_title(bent.label, fontsize=9, loc="left")
            axes.set_ylabel("x, mm")
        rows[-1].set_xlabel("position along the axis, mm")


def section(meridian: SolidMesh, body: SolidMesh, state: State) -> tuple[FloatArray, FloatArray]:
    """Outside and cavity in the plane y = 0 as closed polygons of (x, z), mm."""
    here = (body.points + state.displacement_mm)[:, [0, 2]]
    cavity, outside = (outline.nodes for outline in outlines(meridian))
    sides = [_numbers(meridian, body, angle) for angle in (0.0, np.pi)]
    closed = []
    for nodes in (outside, cavity):
        # from the clamped end to the axis on the one side, and back on the other
        line = nodes if meridian.points[nodes[0], 0] > meridian.points[nodes[-1], 0] else nodes[::-1]
        there, back = (here[number[line][number[line] >= 0]] for number in sides)
        closed.append(np.vstack([there, back[::-1]]))
    return closed[0], closed[1]


def _numbers(meridian: SolidMesh, body: SolidMesh, angle: float) -> IntArray:
    """Body node of each meridian node at an angle, -1 where there is none (within the cap's core)."""
    own = body.meridian_node if body.meridian_node.ndim == 1 else body.meridian_node[:, 0]
    exact = np.ones(len(own), dtype=bool)
    if len(body.meridian_weight):
        exact = body.meridian_weight[:, 0] == 1.0
    found = np.flatnonzero(exact & np.isclose(body.angle_rad, angle, atol=1e-9))
    number = np.full(len(meridian.points), -1, dtype=np.int64)
    number[own[found]] = found
    return number


def ring_sections(scene: BellowsScene, state: State) -> list[FloatArray]:
    """Rigid rings in the plane y = 0, two rectangles of (x, z) each, shape (4, 2), mm; none if there are no rings."""
    if scene.rings.model != "rigid":
        return []
    shape, rings = shape_of(scene), scene.rings
    seat, top, half = shape.seat_radius_mm, shape.seat_radius_mm + rings.height_mm, 0.5 * rings.seat_mm
    found = []
    for centre, motion in zip(shape.crest_positions_mm, state.bodies_mm, strict=False):
        turn = Rotation.from_rotvec(motion[3:] / seat)
        for side in (1.0, -1.0):
            corners = np.array([[seat, -half], [top, -half], [top, half], [seat, half]])
            at = turn.apply(np.column_stack([side * corners[:, 0], np.zeros(4), corners[:, 1]]))
            found.append((at + motion[:3] + [0.0, 0.0, centre])[:, [0, 2]])
    return found
