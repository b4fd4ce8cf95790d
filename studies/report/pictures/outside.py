"""Bodies from outside, lying beside a ruler, coloured by their displacement in bands."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from studies.report.pictures.bodies import (
    MARGIN_MM,
    RING_COLOUR,
    RING_REGION,
    body_of,
    plotter_of,
    ring_shell,
    surface_of,
    take,
)
from studies.report.pictures.stills import RingBox, Still
from studies.report.style import RIGID_COLOUR, RIGID_EDGE, VERMILION, figure_file

if TYPE_CHECKING:
    import pyvista

_DPI = 160
# The camera is turned so far towards the tip and above the table, degrees.
_VIEW_DEG = (16.0, 24.0)

# At most so many bands.
_BANDS, _BAND_COLOURS = 9, "YlGnBu"
_RULER_HEIGHT_MM, _RULER_GAP_MM = 6.5, 4.0
_RULER_COLOUR, _RULER_END_CM = "#f6eed4", 0.25
_ROUND = np.radians(np.arange(0.0, 361.0, 2.0))


def draw_outside(path: Path, stills: Sequence[Still]) -> None:
    """Draw states below each other, each above its ruler, with one scale of colours; needs a graphics driver."""
    bodies = [body_of(still) for still in stills]
    towards, plane = _view()
    rings = [ring_shell(ring, _ROUND)[0].reshape(-1, 3) for still in stills for ring in still.rings]
    seen = np.vstack([*(body.points for body in bodies), *rings]) @ plane.T
    lowest, highest = seen.min(axis=0) - MARGIN_MM, seen.max(axis=0) + MARGIN_MM
    bounds = nice_bounds(max(float(body["moved_mm"].max()) for body in bodies))
    images = []
    for body, still in zip(bodies, stills, strict=True):
        plotter = plotter_of(*(highest - lowest))
        _add_outside(plotter, body, still.rings, bounds)
        images.append(take(plotter, 0.5 * (lowest + highest) @ plane, towards, plane[1], highest[1] - lowest[1]))
    extent = (lowest[0], highest[0], lowest[1], highest[1])
    tips = [float(body.points[:, 2].max()) for body in bodies]
    _compose_outside(path, [still.label for still in stills], images, extent, bounds, tips, plane[0, 2])


def nice_bounds(largest: float) -> NDArray[Any]:
    """Bounds of the bands from 0 to the first round number beyond the largest displacement, mm."""
    bounds = MaxNLocator(_BANDS, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, max(largest, 1e-3))
    return bounds[: np.searchsorted(bounds, largest) + 1]


def _view() -> tuple[NDArray[Any], NDArray[Any]]:
    """Unit vector to the camera, and those to the right and upwards in the image as rows.

    x is up, y to the front; the camera is rolled so that the axis is level in the image.
    """
    turned, raised = np.radians(_VIEW_DEG)
    towards = np.array([np.sin(raised), np.cos(raised) * np.cos(turned), np.cos(raised) * np.sin(turned)])
    right = np.array([0.0, 0.0, 1.0]) - towards[2] * towards
    right /= np.linalg.norm(right)
    return towards, np.stack([right, np.cross(towards, right)])


def _add_outside(
    plotter: pyvista.Plotter, body: pyvista.UnstructuredGrid, rings: Sequence[RingBox], bounds: NDArray[Any]
) -> None:
    """Add the outer surface of a body in bands of displacement, and its rings in grey."""
    import pyvista

    colours = {"clim": (0.0, bounds[-1]), "cmap": _BAND_COLOURS, "n_colors": len(bounds) - 1}
    bands = {"scalars": "moved_mm", **colours}
    look: dict[str, Any] = {"smooth_shading": True, "ambient": 0.55, "diffuse": 0.8, "show_scalar_bar": False}
    is_ring = body["region"] == RING_REGION
    for of_ring, colour in ((False, bands), (True, {"color": RING_COLOUR})):
        if (is_ring == of_ring).any():
            surface = surface_of(body, is_ring == of_ring, "moved_mm")
            surface = surface.compute_normals(split_vertices=True, feature_angle=40.0)
            plotter.add_mesh(surface, **colour, **look)
    for ring in rings:
        corners, shell = ring_shell(ring, _ROUND)
        plotter.add_mesh(shell, color=RIGID_COLOUR, **look)
        for edge in range(4):
            circle = pyvista.lines_from_points(corners[:, edge])
            plotter.add_mesh(circle, color=RIGID_EDGE, line_width=1.5, lighting=False)


def _compose_outside(
    path: Path,
    labels: Sequence[str],
    images: Sequence[NDArray[np.uint8]],
    extent_mm: tuple[float, float, float, float],
    bounds: NDArray[Any],
    tips_mm: Sequence[float],
    shortening: float,
) -> None:
    """Put the images below each other, each above a ruler along the axis, and one colour bar in bands.

    A length on the axis is ``shortening`` times as long in the image; the axis leaves the bodies at ``tips_mm``.
    """
    left, right, low, high = extent_mm
    length_cm, cm = int(np.ceil(0.1 * max(tips_mm))), 10.0 * shortening
    left = min(left, -_RULER_END_CM * cm - MARGIN_MM)
    right = max(right, (length_cm + _RULER_END_CM) * cm + MARGIN_MM)
    width_in = 9.6
    row_in = width_in * (high - low + _RULER_GAP_MM + _RULER_HEIGHT_MM) / (right - left) + 0.3
    with figure_file(path, width_in, 0.8 + row_in * len(images), dpi=_DPI) as figure:
        rows = figure.subplots(len(images), 1, squeeze=False)[:, 0]
        for axes, image, label, tip in zip(rows, images, labels, tips_mm, strict=True):
            axes.imshow(image, extent=extent_mm, interpolation="antialiased")
            _draw_ruler(axes, low - _RULER_GAP_MM, length_cm, cm)
            axes.plot([0.1 * tip * cm] * 2, [0.0, low - _RULER_GAP_MM], color=VERMILION, linewidth=1.2)
            axes.plot(0.1 * tip * cm, 0.0, "o", color=VERMILION, markersize=3.5)
            place = (0.1 * tip * cm + 0.8, low - 0.9 * _RULER_GAP_MM)
            axes.annotate(f"{0.1 * tip:.1f} cm", place, color=VERMILION, fontsize=8.5)
            axes.set_xlim(left, right)
            axes.set_ylim(low - _RULER_GAP_MM - _RULER_HEIGHT_MM, high)
            axes.set_title(label, loc="left", fontsize=10)
            axes.axis("off")
        bands = len(bounds) - 1
        scale = ScalarMappable(BoundaryNorm(bounds, bands), colormaps[_BAND_COLOURS].resampled(bands))
        bar = figure.colorbar(scale, ax=rows, location="top", aspect=60, fraction=0.03, pad=0.02, ticks=bounds)
        bar.ax.set_xticklabels([f"{bound:g}" for bound in bounds])
        bar.set_label("total displacement, mm")


def _draw_ruler(axes: Axes, top: float, length_cm: int, unit: float) -> None:
    """Draw a ruler in cm from 0 on, its upper edge at a height; a centimetre is ``unit`` long."""
    low = top - _RULER_HEIGHT_MM
    ends = [-_RULER_END_CM * unit, (length_cm + _RULER_END_CM) * unit]
    axes.fill_between(ends, low, top, facecolor=_RULER_COLOUR, edgecolor="#6b6b6b")
    for mm in range(10 * length_cm + 1):
        depth, width = (2.8, 0.9) if mm % 10 == 0 else (2.0, 0.5) if mm % 5 == 0 else (1.2, 0.4)
        axes.plot([0.1 * mm * unit] * 2, [top, top - depth], color="black", linewidth=width)
    for cm in range(length_cm + 1):
        axes.text(cm * unit, low + 0.25 * _RULER_HEIGHT_MM, f"{cm}", ha="center", va="center", fontsize=7.5)
    axes.text(0.5 * unit, low + 0.25 * _RULER_HEIGHT_MM, "cm", ha="center", va="center", fontsize=7.5)
