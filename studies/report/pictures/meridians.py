"""Meridians of an axisymmetric run, unloaded and in some of its states, below each other to one scale."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from meshes.gaps import outlines
from meshes.solid import FloatArray, SolidMesh
from studies.planning.levels import fineness
from studies.report.style import RIGID, figure_file
from studies.results.run_files import load_state
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.meshes import scene_meridian

# Shapes in a picture: the unloaded one and so many of the requested ones, first and last among them.
_SHAPES = 3


def draw_shapes(path: Path, scene: BellowsScene, run: Run, folder: Path) -> None:
    """Draw the meridian unloaded and in requested states of a run, below each other to one scale.

    Parameters
    ----------
    path
        The PNG to write.
    scene, run, folder
        The bellows, its axisymmetric run, and where its states are kept.
    """
    mesh, shape = scene_meridian(scene, fineness(run.summary.level)), shape_of(scene)
    shown = [("unloaded", mesh.points, np.zeros(len(shape.crest_positions_mm)))]
    states = [(p, load_state(folder, run.summary.content_hash, 1e-3 * p)) for p in scene.load.pressure_kpa]
    kept = [(pressure, saved[0]) for pressure, saved in states if saved is not None]
    for place in sorted({round(k) for k in np.linspace(0, len(kept) - 1, _SHAPES)}) if kept else ():
        pressure, state = kept[place]
        shifts = state.bodies_mm[:, 0] if len(state.bodies_mm) else shown[0][2]
        shown.append((f"{pressure:g} kPa", mesh.points + state.displacement_mm, shifts))
    length = float(mesh.points[:, 1].max())
    radius = shape.seat_radius_mm + scene.rings.height_mm
    columns = 1 if length > 4.0 * radius else 2  # short bodies side by side
    lines = -(-len(shown) // columns)
    height_in = (8.2 / columns * radius / length * 0.95 + 0.25) * lines + 0.6
    with figure_file(path, 8.2, height_in) as figure:
        grid = figure.subplots(lines, columns, sharex=True, sharey=True, squeeze=False)
        for axes, (label, points, shifts) in zip(grid.ravel(), shown, strict=False):
            _draw_shape(axes, mesh, points)
            if scene.rings.model == "rigid":
                for centre in shape.crest_positions_mm + shifts[: len(shape.crest_positions_mm)]:
                    corner = (float(centre) - 0.5 * scene.rings.seat_mm, shape.seat_radius_mm)
                    axes.add_patch(Rectangle(corner, scene.rings.seat_mm, scene.rings.height_mm, **RIGID))
            axes.set_title(label, loc="left", fontsize=9)
            axes.set_aspect("equal")
            axes.set_xlim(-1.0, length + 1.0)
            axes.set_ylim(0.0, radius + 0.5)
        for axes in grid[:, 0]:
            axes.set_ylabel("r, mm")
        for axes in grid[-1]:
            axes.set_xlabel("z, mm")


def _draw_shape(axes: Axes, mesh: SolidMesh, points: FloatArray) -> None:
    """The solid between its two surfaces, all cells filled, their outlines drawn."""
    corners = {3: [0, 1, 2], 4: [0, 1, 3, 2]}[mesh.cell.corners]
    for cell in points[mesh.cells[:, corners]]:
        axes.fill(cell[:, 1], cell[:, 0], facecolor="#f2c9a1", edgecolor="none", zorder=1.0)
    for outline in outlines(mesh):
        axes.plot(points[outline.nodes, 1], points[outline.nodes, 0], color="#303030", linewidth=0.8, zorder=2.0)
