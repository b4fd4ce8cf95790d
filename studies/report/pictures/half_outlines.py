"""Half a section of a bellows at rest, from its outline: wall, cap and rings; the axis is horizontal."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon, Rectangle

from meshes.bellows import cap_band, corner_band, wall_segments
from meshes.shape import BellowsShape
from studies.report.style import GREY


def draw_half_outline(axes: Axes, shape: BellowsShape, ring_height_mm: float, colour: str) -> None:
    """Fill the silicone's half section with a colour, and the rings' with grey; mm."""
    along = np.linspace(0.0, 1.0, 21)
    bands = [segment.band(along) for segment in wall_segments(shape)]
    ends = [corner_band(shape, along), cap_band(shape, along)] if shape.has_cap else []
    for inner, outer in [*bands, *ends]:
        points = np.vstack([inner, outer[::-1]])[:, ::-1]  # (r, z) to (z, r)
        axes.add_patch(Polygon(points, facecolor=colour, edgecolor="none", antialiased=False))
    for centre in shape.crest_positions_mm:
        corner = (centre - 0.5 * shape.seat_mm, shape.seat_radius_mm)
        axes.add_patch(Rectangle(corner, shape.seat_mm, ring_height_mm, facecolor=GREY, edgecolor="none"))
