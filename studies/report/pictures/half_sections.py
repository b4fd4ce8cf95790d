"""Half sections of bodies: outside above the axis, cut open below it, coloured by stretch."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
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
from studies.report.style import RIGID_COLOUR, RIGID_EDGE, figure_file

if TYPE_CHECKING:
    import pyvista

_DPI = 160
_COLOURS = "YlOrRd"  # light to dark, safe for the colour-blind; pale where nothing stretches
# Much ambient light: colours are to be read off the bar, also inside.
_LIGHT = {"ambient": 0.8, "diffuse": 0.28}
_CLIPPED = "; darkest: more than anywhere half a millimetre or more from the bond's edges"
_SECTION_OFFSET = 1e-6  # of the body's size: beside the mesh's own faces, where a slice is well defined


def draw_half_sections(path: Path, stills: Sequence[Still], stretch_top: float | None) -> None:
    """Draw states below each other to one scale in mm, with one scale of colours; needs a graphics driver.

    The colours end at ``stretch_top``, or at the largest stretch of all states.
    """
    bodies = [body_of(still) for still in stills]
    boxes = [*(body.bounds for body in bodies), *(_bounds(ring) for still in stills for ring in still.rings)]
    bounds = np.array(boxes).reshape(-1, 3, 2)
    lowest, highest = bounds[:, :, 0].min(axis=0) - MARGIN_MM, bounds[:, :, 1].max(axis=0) + MARGIN_MM
    largest = stretch_top or max(float(body["stretch_max"].max()) for body in bodies)
    images = [_image(body, still.rings, lowest, highest, largest) for body, still in zip(bodies, stills, strict=True)]
    _compose(path, [still.label for still in stills], images, (lowest, highest), largest, stretch_top is not None)


def _bounds(ring: RingBox) -> tuple[float, ...]:
    outer, half = ring.inner_radius_mm + ring.height_mm, 0.5 * ring.width_mm
    return (-outer, outer, -outer, outer, ring.centre_mm - half, ring.centre_mm + half)


def _add_ring(plotter: pyvista.Plotter, ring: RingBox) -> None:
    """Draw a ring as the body is drawn: without its front lower quarter, the cut and the outline dark-edged."""
    import pyvista

    # From the cut at -180 degrees (-x) through the back (-y) and the top (x) to the front (y).
    corners, shell = ring_shell(ring, np.radians(np.arange(-180.0, 91.0, 2.0)))
    plotter.add_mesh(shell, color=RIGID_COLOUR, smooth_shading=True, ambient=0.35, diffuse=1.0)
    cut = pyvista.PolyData.from_regular_faces(corners[0], np.arange(4)[None])
    plotter.add_mesh(cut, color=RIGID_COLOUR, lighting=False)
    outer, half = ring.inner_radius_mm + ring.height_mm, 0.5 * ring.width_mm
    left, right = ring.centre_mm - half, ring.centre_mm + half
    seen = np.array([[0.0, 0.0, left], [outer, 0.0, left], [outer, 0.0, right], [0.0, 0.0, right]])
    seen[:, 1] = 2.0 * outer  # in front of the ring, whose outline it is
    for outline in (seen, corners[0]):
        edges = pyvista.lines_from_points(outline, close=True)
        plotter.add_mesh(edges, color=RIGID_EDGE, line_width=2.0, lighting=False)


def _image(
    body: pyvista.UnstructuredGrid,
    rings: Sequence[RingBox],
    lowest: NDArray[Any],
    highest: NDArray[Any],
    largest: float,
) -> NDArray[np.uint8]:
    """Half section of a body seen along -y, z to the right and x upwards, its box filling the image."""
    size = highest - lowest
    plotter = plotter_of(size[2], size[0])
    look = {"scalars": "stretch_max", "clim": (1.0, largest), "cmap": _COLOURS, "show_scalar_bar": False}
    cut = _SECTION_OFFSET * float(size.max())
    is_ring = body["region"] == RING_REGION
    section = body.slice("y", origin=(0.0, cut, 0.0)).clip("x", origin=(0.0, 0.0, 0.0))
    for of_ring, colour in ((False, look), (True, {"color": RING_COLOUR})):
        if not (is_ring == of_ring).any():
            continue
        surface = surface_of(body, is_ring == of_ring)
        above = surface.clip("x", invert=False, origin=(0.0, 0.0, 0.0))
        behind = surface.clip("x", origin=(0.0, 0.0, 0.0)).clip("y", origin=(0.0, cut, 0.0))
        for part in (above, behind):
            if part.n_cells:
                part = part.compute_normals(split_vertices=True, feature_angle=40.0)
                plotter.add_mesh(part, smooth_shading=True, **_LIGHT, **colour)
        wanted = (section["region"] == RING_REGION) == of_ring
        if wanted.any():
            face = section.extract_cells(wanted).extract_surface(algorithm="dataset_surface").clean()
            plotter.add_mesh(face, lighting=False, **colour)
            outline = face.extract_feature_edges(
                boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
            )
            plotter.add_mesh(outline, color="black", line_width=2.0, lighting=False)
    for ring in rings:
        _add_ring(plotter, ring)
    middle = 0.5 * (lowest + highest)
    return take(plotter, middle, np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0]), size[0])


def _compose(
    path: Path,
    labels: Sequence[str],
    images: Sequence[NDArray[np.uint8]],
    box: tuple[NDArray[Any], NDArray[Any]],
    largest: float,
    clipped: bool,
) -> None:
    """Put the images below each other on axes in mm, each below its label, with one colour bar."""
    width_in = 9.6
    lowest, highest = box
    row_in = 0.96 * width_in * (highest[0] - lowest[0]) / (highest[2] - lowest[2]) + 0.3
    with figure_file(path, width_in, 1.1 + row_in * len(images), dpi=_DPI) as figure:
        rows = figure.subplots(len(images), 1, sharex=True, squeeze=False)[:, 0]
        for axes, image, label in zip(rows, images, labels, strict=True):
            axes.imshow(image, extent=(lowest[2], highest[2], lowest[0], highest[0]), interpolation="antialiased")
            axes.axhline(0.0, color="black", linewidth=0.6, dashes=(14, 3, 3, 3))
            axes.set_title(label, loc="left", fontsize=10)
            axes.set_yticks([])
            axes.spines[:].set_visible(False)
            axes.tick_params(axis="x", length=3 if axes is rows[-1] else 0)
        rows[-1].spines["bottom"].set_visible(True)
        rows[-1].set_xlabel("position along the axis, mm")
        scale = ScalarMappable(Normalize(1.0, largest), _COLOURS)
        bar = figure.colorbar(
            scale, ax=rows, location="top", aspect=60, fraction=0.03, pad=0.02, extend="max" if clipped else "neither"
        )
        bar.set_label(f"largest principal stretch{_CLIPPED if clipped else ''}")
