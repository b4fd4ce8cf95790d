"""The coarsest meshes: an actuator's meridian, and the body made from it with a quarter taken away."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Rectangle

from analytical.arrays import FloatArray
from meshes.cells import HEXAHEDRON_NODES, IntArray, quadratic_weights
from meshes.solid import SolidMesh
from meshes.sweep import FULL_CIRCLE, revolve_hexahedra
from studies.paper.setup.sizes import scene_of
from studies.report.style import RIGID, figure_file
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.meshes import scene_meridian

COLOUR, EDGE = "#9ecae8", "#202020"
# Cells round the circle in the picture, and the part of it that is drawn; the axis lies to the right, seen from above.
AROUND, DRAWN = 8, 0.75
_TURN_DEG, _LIFT_DEG, _ROLL_DEG = -25.0, 20.0, 45.0
# Flat patches along each edge of a curved face.
_PATCHES: Final = 4


def draw_meshes(path: Path, name: str) -> str:
    """Draw the coarsest meridian of an actuator above the coarsest body."""
    scene = scene_of(name)
    meridian = scene_meridian(scene, 1)
    with figure_file(path, 10.0, 5.6) as figure:
        flat, solid = figure.subplots(2, 1, height_ratios=(1.0, 2.0))
        _draw_meridian(flat, scene, meridian)
        _draw_body(solid, revolve_hexahedra(meridian, round(DRAWN * AROUND), DRAWN * FULL_CIRCLE))
    return ""


def _draw_meridian(axes: Axes, scene: BellowsScene, mesh: SolidMesh) -> None:
    """Cells of a meridian of quadrilaterals with curved edges, and the rigid rings."""
    # corners and middles of the edges in turn
    round_the_cell = mesh.cells[:, [0, 4, 1, 6, 3, 7, 2, 5]]
    polygons = mesh.points[round_the_cell][:, :, ::-1]
    axes.add_collection(PolyCollection(list(polygons), facecolor=COLOUR, edgecolor=EDGE, linewidth=0.5))
    shape = shape_of(scene)
    for centre in shape.crest_positions_mm:
        corner = (float(centre) - 0.5 * shape.seat_mm, shape.seat_radius_mm)
        axes.add_patch(Rectangle(corner, shape.seat_mm, scene.rings.height_mm, **RIGID))
    top = shape.seat_radius_mm + scene.rings.height_mm
    axes.set(aspect="equal", xlim=(-1.0, float(mesh.points[:, 1].max()) + 1.0), ylim=(0.0, top + 0.5))
    axes.set_xlabel("z, mm")
    axes.set_ylabel("r, mm")


def _draw_body(axes: Axes, body: SolidMesh) -> None:
    """Outer faces of a body, the farthest first, shaded by their direction; edges of cells in black."""
    patches, edges = faces_of(body)
    right, up, towards = _view()
    normals = np.cross(patches[:, 2] - patches[:, 0], patches[:, 3] - patches[:, 1])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    facing = np.abs(normals / np.where(lengths > 0.0, lengths, 1.0) @ (towards + 0.6 * up)) / math.hypot(1.0, 0.6)
    shade = (0.55 + 0.45 * facing)[:, None]
    base = np.array([int(COLOUR[k : k + 2], 16) / 255.0 for k in (1, 3, 5)])
    colours = np.vstack([shade * base, np.full((len(edges), 3), 0.1)])
    # an edge is drawn after the patches beside it: a hair nearer to the eye
    depth = np.concatenate([patches.mean(axis=1) @ towards, edges.mean(axis=1) @ towards + 0.15])
    flat = [points @ np.column_stack([right, up]) for points in (*patches, *edges)]
    order = np.argsort(depth)
    widths = np.where(order < len(patches), 0.3, 0.5)
    shown = PolyCollection(
        [flat[k] for k in order], facecolors=colours[order], edgecolors=colours[order], linewidths=widths
    )
    axes.add_collection(shown)
    corners = np.vstack(flat)
    low, high = corners.min(axis=0) - 1.0, corners.max(axis=0) + 1.0
    axes.set(aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axes.set_axis_off()


def faces_of(body: SolidMesh) -> tuple[FloatArray, FloatArray]:
    """Outer faces of curved hexahedra as flat patches (m, 4, 3), and their edges as strokes (k, 2, 3), mm."""
    lattices: list[IntArray] = []
    for axis in range(3):
        along = [k for k in range(3) if k != axis]
        for side in (0, 2):
            local = np.flatnonzero(HEXAHEDRON_NODES[:, axis] == side)
            lattice = np.empty((3, 3), dtype=np.int64)
            lattice[tuple(HEXAHEDRON_NODES[local][:, along].T)] = local
            lattices.append(body.cells[:, lattice])
    faces = np.concatenate(lattices)  # (faces, 3, 3)
    corners = np.sort(faces[:, ::2, ::2].reshape(-1, 4), axis=1)
    _, first, number = np.unique(corners, axis=0, return_index=True, return_counts=True)
    weights = quadratic_weights(np.linspace(0.0, 1.0, _PATCHES + 1))
    points = np.einsum("ai,bj,fijx->fabx", weights, weights, body.points[faces[first[number == 1]]])
    around = [points[:, :-1, :-1], points[:, 1:, :-1], points[:, 1:, 1:], points[:, :-1, 1:]]
    patches = np.stack(around, axis=3).reshape(-1, 4, 3)
    sides = np.concatenate([points[:, 0], points[:, -1], points[:, :, 0], points[:, :, -1]])
    return patches, np.stack([sides[:, :-1], sides[:, 1:]], axis=2).reshape(-1, 2, 3)


def _view() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Unit vectors to the right, upwards and to the eye; the quarter that is not drawn lies in front."""
    roll, turn, lift = map(math.radians, (_ROLL_DEG, _TURN_DEG, _LIFT_DEG))
    # the missing quarter is between the angles of 270 and 360 degrees: its middle faces the eye before turning
    front = np.array([math.cos(-0.25 * math.pi), math.sin(-0.25 * math.pi), 0.0])
    axis = np.array([0.0, 0.0, 1.0])
    over = np.cross(front, axis)
    front, over = math.cos(roll) * front + math.sin(roll) * over, math.cos(roll) * over - math.sin(roll) * front
    towards = math.cos(lift) * (math.cos(turn) * front + math.sin(turn) * axis) + math.sin(lift) * over
    right = np.cross(over, towards)
    right /= np.linalg.norm(right)
    return right, np.cross(towards, right), towards
