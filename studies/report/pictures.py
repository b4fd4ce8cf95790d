"""Pictures of the body, undeformed and deformed, from its VTU files.

Drawn in a child process: a graphics driver that is missing or ends the process must not take the report
with it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pyvista
    from matplotlib.axes import Axes

_SECONDS = 300.0
_PIXELS_PER_MM = 11.0
_LARGEST_WIDTH_PX = 3000
_MARGIN_MM = 1.0
_COLOURS = "YlOrRd"  # light to dark, safe for the colour-blind; pale where nothing stretches
_RING_REGION = 3
_RING_COLOUR = "#b8b8b8"
_RIGID_COLOUR, _RIGID_EDGE = "#d8d8d8", "#303030"
# The view from outside: camera turned so far towards the tip and above the table, degrees.
_VIEW_DEG = (16.0, 24.0)
_FAR_MM = 2000.0  # from the camera: parallel projection, so anywhere beyond the body
_BANDS, _BAND_COLOURS = 9, "YlGnBu"
_RULER_HEIGHT_MM, _RULER_GAP_MM = 6.5, 3.0
_RULER_COLOUR, _RULER_END_CM = "#f6eed4", 0.25
_ROUND = np.radians(np.arange(0.0, 361.0, 2.0))
_SECTION_OFFSET = 1e-6  # of the body's size: beside the mesh's own faces, where a slice is well defined

# By VTK's number of a quadratic cell: its faces, corners first, and a face as flat triangles.
_FACES = {
    24: np.array([[0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [2, 0, 3, 6, 7, 9], [0, 2, 1, 6, 5, 4]]),
    29: np.array(
        [
            [0, 4, 7, 3, 16, 15, 19, 11, 20],
            [1, 2, 6, 5, 9, 18, 13, 17, 21],
            [0, 1, 5, 4, 8, 17, 12, 16, 22],
            [3, 7, 6, 2, 19, 14, 18, 10, 23],
            [0, 3, 2, 1, 11, 10, 9, 8, 24],
            [4, 5, 6, 7, 12, 13, 14, 15, 25],
        ]
    ),
}
_FLAT = {
    24: np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]]),
    29: np.array([[k, 4 + k, 8] for k in range(4)] + [[4 + k, (k + 1) % 4, 8] for k in range(4)]),
}


@dataclass(frozen=True)
class RingBox:
    """A rigid ring that is not in the VTU: a rectangle turned about the axis.

    Attributes
    ----------
    centre_mm
        Where its middle stands along the axis in the state drawn, mm.
    inner_radius_mm, width_mm, height_mm
        Radius of its seat, extent along the axis, and extent outwards from the seat, mm.
    """

    centre_mm: float
    inner_radius_mm: float
    width_mm: float
    height_mm: float


@dataclass(frozen=True)
class Still:
    """One state to draw.

    Attributes
    ----------
    label
        Text beside it.
    vtu
        The body: point fields ``displacement_mm`` and ``stretch_max``, cell field ``region``.
    deformed
        False: in its reference position, where every stretch is 1.
    rings
        Rigid rings to draw with it.
    """

    label: str
    vtu: Path
    deformed: bool = True
    rings: tuple[RingBox, ...] = ()


def draw_states(path: Path, stills: Sequence[Still]) -> str:
    """Draw the states below each other to one scale in mm, coloured by the largest principal stretch.

    Each is a half section: outside above the axis, the front lower quarter taken away below it.

    Parameters
    ----------
    path
        The PNG to write.
    stills
        The states, from top to bottom.

    Returns
    -------
    str
        Empty, or why there is no picture.
    """
    return _in_child(path, stills, "sections")


def draw_side_by_side(path: Path, stills: Sequence[Still]) -> str:
    """Draw the states from outside, below each other to one scale, as they would lie on a table beside a ruler in cm.

    Coloured by the total displacement in bands of mm, as ANSYS does. The view is oblique, see `_VIEW_DEG`; the ruler
    lies in it along the axis, so what it says holds for places on the axis.

    Parameters
    ----------
    path
        The PNG to write.
    stills
        The states, from top to bottom.

    Returns
    -------
    str
        Empty, or why there is no picture.
    """
    return _in_child(path, stills, "outside")


def _in_child(path: Path, stills: Sequence[Still], view: str) -> str:
    """Draw a view of the states in a child process; empty, or why there is no picture."""
    missing = [str(still.vtu) for still in stills if not still.vtu.is_file()]
    if missing:
        return f"no such file: {', '.join(missing)}"
    jobs = [
        [still.label, str(still.vtu.resolve()), still.deformed, [astuple(ring) for ring in still.rings]]
        for still in stills
    ]
    # -c, not -m: finds the package also where the parent found it through sys.path alone.
    code = f"import sys; sys.path[:] = {sys.path!r}; from studies.report.pictures import _draw_here; _draw_here()"
    try:
        child = subprocess.run(
            [sys.executable, "-c", code],
            input=json.dumps({"path": str(path.resolve()), "view": view, "stills": jobs}),
            capture_output=True,
            text=True,
            timeout=_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"drawing failed: {error}"
    if child.returncode == 0:
        return ""
    said = child.stderr.strip().splitlines()
    return f"drawing failed (exit code {child.returncode}): {said[-1] if said else 'no message'}"


def _draw_here() -> None:
    """Draw what standard input asks for; the child's side of `_in_child`."""
    job = json.load(sys.stdin)
    stills = [
        Still(label, Path(vtu), deformed, tuple(RingBox(*ring) for ring in rings))
        for label, vtu, deformed, rings in job["stills"]
    ]
    os.environ.setdefault("PYVISTA_OFF_SCREEN", "true")
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")
    {"sections": _draw_sections, "outside": _draw_outside}[job["view"]](Path(job["path"]), stills)


def _draw_sections(path: Path, stills: Sequence[Still]) -> None:
    bodies = [_body(still) for still in stills]
    boxes = [*(body.bounds for body in bodies), *(_bounds(ring) for still in stills for ring in still.rings)]
    bounds = np.array(boxes).reshape(-1, 3, 2)
    lowest, highest = bounds[:, :, 0].min(axis=0) - _MARGIN_MM, bounds[:, :, 1].max(axis=0) + _MARGIN_MM
    largest = max(float(body["stretch_max"].max()) for body in bodies)
    images = [_image(body, still.rings, lowest, highest, largest) for body, still in zip(bodies, stills, strict=True)]
    _compose(path, [still.label for still in stills], images, lowest, highest, largest)


def _body(still: Still) -> pyvista.UnstructuredGrid:
    """The body as it stands in a state."""
    import pyvista

    body = pyvista.read(still.vtu)
    if not still.deformed:
        body["displacement_mm"] = np.zeros_like(body.points)
        body["stretch_max"] = np.ones(body.n_points)
    body.points = body.points + body["displacement_mm"]
    body["moved_mm"] = np.linalg.norm(body["displacement_mm"], axis=1)
    return body


def _surface(body: pyvista.UnstructuredGrid, cells: NDArray[np.bool_], field: str = "stretch_max") -> pyvista.PolyData:
    """Outer faces of some of the cells as flat triangles, four or eight to a curved face, with one of the fields.

    VTK's own surface filter keeps most inner faces of ten-node tetrahedra, fifty times too many.
    """
    import pyvista

    ((kind, nodes),) = body.cells_dict.items()
    faces = nodes[cells][:, _FACES[kind]].reshape(-1, _FACES[kind].shape[1])
    # three corners tell two faces apart, whatever their kind
    names = np.sort(np.sort(faces[:, : 4 if kind == 29 else 3], axis=1)[:, :3], axis=1)
    _, first, count = np.unique(names, axis=0, return_index=True, return_counts=True)
    outer = faces[first[count == 1]]
    used, triangles = np.unique(outer[:, _FLAT[kind]].reshape(-1, 3), return_inverse=True)
    surface = pyvista.PolyData.from_regular_faces(body.points[used], triangles.reshape(-1, 3))
    surface[field] = body[field][used]
    return surface


def _bounds(ring: RingBox) -> tuple[float, ...]:
    outer, half = ring.inner_radius_mm + ring.height_mm, 0.5 * ring.width_mm
    return (-outer, outer, -outer, outer, ring.centre_mm - half, ring.centre_mm + half)


def _ring_shell(ring: RingBox, angles: NDArray[Any]) -> tuple[NDArray[Any], pyvista.PolyData]:
    """Corners of a ring's section at angles, shape (angles, 4, 3), and the surface they sweep."""
    import pyvista

    inner, outer, half = ring.inner_radius_mm, ring.inner_radius_mm + ring.height_mm, 0.5 * ring.width_mm
    radii = np.array([inner, outer, outer, inner])
    axial = np.broadcast_to(ring.centre_mm + half * np.array([-1.0, -1.0, 1.0, 1.0]), (angles.size, 4))
    corners = np.stack([np.outer(np.cos(angles), radii), np.outer(np.sin(angles), radii), axial], axis=2)
    first = 4 * np.arange(angles.size - 1)[:, None] + np.arange(4)
    after = 4 * np.arange(angles.size - 1)[:, None] + (np.arange(4) + 1) % 4
    sides = np.stack([first, after, after + 4, first + 4], axis=2).reshape(-1, 4)
    shell = pyvista.PolyData.from_regular_faces(corners.reshape(-1, 3), sides)
    return corners, shell.compute_normals(split_vertices=True, feature_angle=40.0)


def _add_ring(plotter: pyvista.Plotter, ring: RingBox) -> None:
    """Draw a ring as the body is drawn: without its front lower quarter, the cut and the outline dark-edged."""
    import pyvista

    # From the cut at -180 degrees (-x) through the back (-y) and the top (x) to the front (y).
    corners, shell = _ring_shell(ring, np.radians(np.arange(-180.0, 91.0, 2.0)))
    plotter.add_mesh(shell, color=_RIGID_COLOUR, smooth_shading=True, ambient=0.35, diffuse=1.0)
    cut = pyvista.PolyData.from_regular_faces(corners[0], np.arange(4)[None])
    plotter.add_mesh(cut, color=_RIGID_COLOUR, lighting=False)
    outer, half = ring.inner_radius_mm + ring.height_mm, 0.5 * ring.width_mm
    left, right = ring.centre_mm - half, ring.centre_mm + half
    seen = np.array([[0.0, 0.0, left], [outer, 0.0, left], [outer, 0.0, right], [0.0, 0.0, right]])
    seen[:, 1] = 2.0 * outer  # in front of the ring, whose outline it is
    for outline in (seen, corners[0]):
        edges = pyvista.lines_from_points(outline, close=True)
        plotter.add_mesh(edges, color=_RIGID_EDGE, line_width=2.0, lighting=False)


def _image(
    body: pyvista.UnstructuredGrid,
    rings: Sequence[RingBox],
    lowest: NDArray[Any],
    highest: NDArray[Any],
    largest: float,
) -> NDArray[np.uint8]:
    """Half section of a body seen along -y, z to the right and x upwards, its box filling the image."""
    size = highest - lowest
    plotter = _plotter(size[2], size[0])
    look = {"scalars": "stretch_max", "clim": (1.0, largest), "cmap": _COLOURS, "show_scalar_bar": False}
    cut = _SECTION_OFFSET * float(size.max())
    is_ring = body["region"] == _RING_REGION
    section = body.slice("y", origin=(0.0, cut, 0.0)).clip("x", origin=(0.0, 0.0, 0.0))
    for of_ring, colour in ((False, look), (True, {"color": _RING_COLOUR})):
        if not (is_ring == of_ring).any():
            continue
        surface = _surface(body, is_ring == of_ring)
        above = surface.clip("x", invert=False, origin=(0.0, 0.0, 0.0))
        behind = surface.clip("x", origin=(0.0, 0.0, 0.0)).clip("y", origin=(0.0, cut, 0.0))
        for part, brightness in ((above, 1.0), (behind, 0.85)):
            if part.n_cells:
                part = part.compute_normals(split_vertices=True, feature_angle=40.0)
                plotter.add_mesh(part, smooth_shading=True, ambient=0.35 * brightness, diffuse=brightness, **colour)
        wanted = (section["region"] == _RING_REGION) == of_ring
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
    return _take(plotter, middle, np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0]), size[0])


def _plotter(width_mm: float, height_mm: float) -> pyvista.Plotter:
    """An empty white scene with its lights, for an image of that size."""
    import pyvista

    pixels = min(_PIXELS_PER_MM, _LARGEST_WIDTH_PX / width_mm)
    window = [round(pixels * width_mm), round(pixels * height_mm)]
    plotter = pyvista.Plotter(off_screen=True, window_size=window, lighting="none")
    plotter.set_background("white")
    for position, intensity in (((2.0, 3.0, -1.5), 0.55), ((-1.0, 3.0, 2.0), 0.3)):
        plotter.add_light(pyvista.Light(position=position, light_type="scene light", intensity=intensity))
    return plotter


def _take(
    plotter: pyvista.Plotter, middle: NDArray[Any], towards: NDArray[Any], upwards: NDArray[Any], height_mm: float
) -> NDArray[np.uint8]:
    """The image in parallel projection, from the unit vectors to the camera and upwards in it; closes the scene."""
    plotter.camera.focal_point = middle
    plotter.camera.position = middle + _FAR_MM * towards
    plotter.camera.up = upwards
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = 0.5 * height_mm
    plotter.reset_camera_clipping_range()
    plotter.enable_anti_aliasing("ssaa")
    image = plotter.screenshot(return_img=True)
    plotter.close()
    return np.asarray(image)


def _compose(
    path: Path,
    labels: Sequence[str],
    images: Sequence[NDArray[np.uint8]],
    lowest: NDArray[Any],
    highest: NDArray[Any],
    largest: float,
) -> None:
    """Put the images below each other on axes in mm, with one colour bar."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    width_in = 9.6
    row_in = 0.82 * width_in * (highest[0] - lowest[0]) / (highest[2] - lowest[2]) + 0.12
    figure = Figure(figsize=(width_in, 1.1 + row_in * len(images)), layout="constrained")
    FigureCanvasAgg(figure)
    rows = figure.subplots(len(images), 1, sharex=True, squeeze=False)[:, 0]
    for axes, image, label in zip(rows, images, labels, strict=True):
        axes.imshow(image, extent=(lowest[2], highest[2], lowest[0], highest[0]), interpolation="antialiased")
        axes.axhline(0.0, color="black", linewidth=0.6, dashes=(14, 3, 3, 3))
        axes.set_ylabel(label, rotation=0, ha="right", va="center", fontsize=10)
        axes.set_yticks([])
        axes.spines[:].set_visible(False)
        axes.tick_params(axis="x", length=3 if axes is rows[-1] else 0)
    rows[-1].spines["bottom"].set_visible(True)
    rows[-1].set_xlabel("position along the axis, mm")
    scale = ScalarMappable(Normalize(1.0, largest), _COLOURS)
    figure.colorbar(scale, ax=rows, location="top", aspect=60, fraction=0.03, pad=0.02).set_label(
        "largest principal stretch"
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=160)


# --- the view from outside ------------------------------------------------------------------


def _draw_outside(path: Path, stills: Sequence[Still]) -> None:
    bodies = [_body(still) for still in stills]
    towards, plane = _view()
    rings = [_ring_shell(ring, _ROUND)[0].reshape(-1, 3) for still in stills for ring in still.rings]
    seen = np.vstack([*(body.points for body in bodies), *rings]) @ plane.T
    lowest, highest = seen.min(axis=0) - _MARGIN_MM, seen.max(axis=0) + _MARGIN_MM
    longest = max(float(body.points[:, 2].max()) for body in bodies)
    largest = max(float(body["moved_mm"].max()) for body in bodies)
    images = []
    for body, still in zip(bodies, stills, strict=True):
        plotter = _plotter(*(highest - lowest))
        _add_outside(plotter, body, still.rings, largest)
        images.append(_take(plotter, 0.5 * (lowest + highest) @ plane, towards, plane[1], highest[1] - lowest[1]))
    extent = (lowest[0], highest[0], lowest[1], highest[1])
    _compose_outside(path, [still.label for still in stills], images, extent, largest, longest, plane[0, 2])


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
    plotter: pyvista.Plotter, body: pyvista.UnstructuredGrid, rings: Sequence[RingBox], largest: float
) -> None:
    """Add the outer surface of a body in bands of displacement, and its rings in grey."""
    import pyvista

    bands = {"scalars": "moved_mm", "clim": (0.0, largest), "cmap": _BAND_COLOURS, "n_colors": _BANDS}
    look: dict[str, Any] = {"smooth_shading": True, "ambient": 0.55, "diffuse": 0.8, "show_scalar_bar": False}
    is_ring = body["region"] == _RING_REGION
    for of_ring, colour in ((False, bands), (True, {"color": _RING_COLOUR})):
        if (is_ring == of_ring).any():
            surface = _surface(body, is_ring == of_ring, "moved_mm")
            surface = surface.compute_normals(split_vertices=True, feature_angle=40.0)
            plotter.add_mesh(surface, **colour, **look)
    for ring in rings:
        corners, shell = _ring_shell(ring, _ROUND)
        plotter.add_mesh(shell, color=_RIGID_COLOUR, **look)
        for edge in range(4):
            circle = pyvista.lines_from_points(corners[:, edge])
            plotter.add_mesh(circle, color=_RIGID_EDGE, line_width=1.5, lighting=False)


def _compose_outside(
    path: Path,
    labels: Sequence[str],
    images: Sequence[NDArray[np.uint8]],
    extent_mm: tuple[float, float, float, float],
    largest: float,
    longest_mm: float,
    shortening: float,
) -> None:
    """Put the images below each other, each above a ruler along the axis, and one colour bar in bands.

    A length on the axis is ``shortening`` times as long in the image.
    """
    from matplotlib import colormaps
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import BoundaryNorm
    from matplotlib.figure import Figure

    left, right, low, high = extent_mm
    length_cm, cm = int(np.ceil(0.1 * longest_mm)), 10.0 * shortening
    right = max(right, (length_cm + _RULER_END_CM) * cm + _MARGIN_MM)
    width_in = 9.6
    row_in = width_in * (high - low + _RULER_GAP_MM + _RULER_HEIGHT_MM) / (right - left) + 0.3
    figure = Figure(figsize=(width_in, 0.8 + row_in * len(images)), layout="constrained")
    FigureCanvasAgg(figure)
    rows = figure.subplots(len(images), 1, squeeze=False)[:, 0]
    for axes, image, label in zip(rows, images, labels, strict=True):
        axes.imshow(image, extent=extent_mm, interpolation="antialiased")
        _draw_ruler(axes, low - _RULER_GAP_MM, length_cm, cm)
        axes.set_xlim(left, right)
        axes.set_ylim(low - _RULER_GAP_MM - _RULER_HEIGHT_MM, high)
        axes.set_title(label, loc="left", fontsize=10)
        axes.axis("off")
    bounds = np.linspace(0.0, largest, _BANDS + 1)
    scale = ScalarMappable(BoundaryNorm(bounds, _BANDS), colormaps[_BAND_COLOURS].resampled(_BANDS))
    bar = figure.colorbar(scale, ax=rows, location="top", aspect=60, fraction=0.03, pad=0.02, ticks=bounds)
    bar.ax.set_xticklabels([f"{bound:.1f}" for bound in bounds])
    bar.set_label("total displacement, mm")
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=160)


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
