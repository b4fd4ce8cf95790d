"""The surfaces of a solid, each in a panel of its own with its number and name, before the rest of the solid."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from meshes.by_gmsh.cad import Surface
from studies.report.style import GREY, VERMILION, figure_file

# Panels in a row and at most; beyond them the largest surfaces are drawn.
_ACROSS, _MOST = 4, 24
_PANEL_IN = 2.4
# So many triangles of a surface, and of all others in the background, tell its shape.
_SHOWN, _BEHIND = 20000, 4000


def draw_surfaces(path: Path, title: str, surfaces: Sequence[Surface], names: Mapping[int, str]) -> None:
    """Draw them, without a graphics driver.

    Parameters
    ----------
    path
        The picture to write.
    title
        Stands above all.
    names
        Names by number, as far as given.
    """
    shown = sorted(sorted(surfaces, key=lambda s: -s.area_mm2)[:_MOST], key=lambda s: s.number)
    rows = math.ceil(len(shown) / _ACROSS)
    every = np.vstack([s.triangles for s in surfaces])
    low, high = every.reshape(-1, 3).min(axis=0), every.reshape(-1, 3).max(axis=0)
    with figure_file(path, _ACROSS * _PANEL_IN, rows * _PANEL_IN + 0.4) as figure:
        figure.set_layout_engine("none")  # which knows no axes in space
        height = _PANEL_IN / (rows * _PANEL_IN + 0.4)
        left_out = f", the {len(shown)} largest of {len(surfaces)}" if len(shown) < len(surfaces) else ""
        figure.suptitle(f"{title}: surfaces{left_out}")
        for k, surface in enumerate(shown):
            row, column = divmod(k, _ACROSS)
            place = ((column + 0.02) / _ACROSS, (rows - 1 - row + 0.04) * height, 0.92 / _ACROSS, 0.86 * height)
            axes: Any = figure.add_axes(place, projection="3d")
            behind = Poly3DCollection(_some(every, _BEHIND), facecolor=GREY, alpha=0.06, linewidth=0.0)
            front = Poly3DCollection(_some(surface.triangles, _SHOWN), facecolor=VERMILION, alpha=0.75, linewidth=0.0)
            axes.add_collection3d(behind)
            axes.add_collection3d(front)
            for axis, a, b in zip("xyz", low, high, strict=True):
                getattr(axes, f"set_{axis}lim")(a, b)
                getattr(axes, f"set_{axis}ticks")([])
                getattr(axes, f"set_{axis}label")(f"{axis} {a:.3g} to {b:.3g}", fontsize=6, labelpad=-12)
            axes.set_box_aspect(np.maximum(high - low, 0.05 * (high - low).max()))
            axes.set_title(" ".join(filter(None, [str(surface.number), names.get(surface.number)])), fontsize=10)


def _some(triangles: Any, most: int) -> Any:
    """At most so many of the triangles, evenly taken."""
    return triangles[:: math.ceil(len(triangles) / most)]
