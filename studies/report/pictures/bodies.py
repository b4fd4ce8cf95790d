"""Bodies and rings as surfaces for VTK, and the scene they are drawn in."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from studies.report.pictures.stills import RingBox, Still

if TYPE_CHECKING:
    import pyvista

_PIXELS_PER_MM = 11.0
_LEAST_WIDTH_PX, _LARGEST_WIDTH_PX = 1500, 3000
MARGIN_MM = 1.0
RING_REGION = 3
RING_COLOUR = "#b8b8b8"
# Points of neighbouring faces that are one.
_SAME_MM = 1e-5
_FAR_MM = 2000.0  # from the camera: parallel projection, so anywhere beyond the body

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

# A face is drawn as so many flat pieces along an edge: with 8 cells round a circle then has 32 sides.
_PIECES = 4


def _triangle(per_edge: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Values of a six-node face's functions at the corners of its flat pieces, and these as triangles."""
    at = [(i, j) for j in range(per_edge + 1) for i in range(per_edge + 1 - j)]
    number = {place: k for k, place in enumerate(at)}
    s, t = np.array(at, dtype=float).T / per_edge
    r = 1.0 - s - t
    corners, middles = [x * (2.0 * x - 1.0) for x in (r, s, t)], [4.0 * r * s, 4.0 * s * t, 4.0 * t * r]
    pieces = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in at if i + j < per_edge]
    pieces += [(number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in at if i + j < per_edge - 1]
    return np.stack([*corners, *middles], axis=1), np.array(pieces)


def _square(per_edge: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """The same of a nine-node face: corners, middles of its edges, centre."""
    x = np.linspace(-1.0, 1.0, per_edge + 1)
    low, middle, high = 0.5 * x * (x - 1.0), 1.0 - x**2, 0.5 * x * (x + 1.0)
    along = {-1: low, 0: middle, 1: high}
    nodes = ((-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0), (0, 0))
    values = np.stack([np.outer(along[t], along[s]).ravel() for s, t in nodes], axis=1)
    first = (np.arange(per_edge)[:, None] * (per_edge + 1) + np.arange(per_edge)).ravel()
    ends = first[:, None] + np.array([0, 1, per_edge + 2, per_edge + 1])
    return values, np.vstack([ends[:, [0, 1, 2]], ends[:, [0, 2, 3]]])


def flat_pieces(face_nodes: int, per_edge: int = _PIECES) -> tuple[NDArray[Any], NDArray[Any]]:
    """Functions of a face at the corners of its flat pieces, (corners, nodes), and the pieces as triangles."""
    return {6: _triangle, 9: _square}[face_nodes](per_edge)


def body_of(still: Still) -> pyvista.UnstructuredGrid:
    """The body as it stands in a state."""
    import pyvista

    body = pyvista.read(still.vtu)
    if not still.deformed:
        body["displacement_mm"] = np.zeros_like(body.points)
        body["stretch_max"] = np.ones(body.n_points)
    body.points = body.points + body["displacement_mm"]
    body["moved_mm"] = np.linalg.norm(body["displacement_mm"], axis=1)
    return body


def outer_faces(
    body: pyvista.UnstructuredGrid, cells: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Outer faces of some of the cells by their nodes, shape (faces, nodes), and the cell of each.

    VTK's own surface filter keeps most inner faces of ten-node tetrahedra, fifty times too many.
    """
    ((kind, nodes),) = body.cells_dict.items()
    of_cell = _FACES[kind]
    faces = nodes[cells][:, of_cell].reshape(-1, of_cell.shape[1])
    # three corners tell two faces apart, whatever their kind
    names = np.sort(np.sort(faces[:, : 4 if kind == 29 else 3], axis=1)[:, :3], axis=1)
    _, first, count = np.unique(names, axis=0, return_index=True, return_counts=True)
    outer = first[count == 1]
    return faces[outer].astype(np.int64), np.flatnonzero(cells)[outer // len(of_cell)]


def surface_of(
    body: pyvista.UnstructuredGrid, cells: NDArray[np.bool_], field: str = "stretch_max"
) -> pyvista.PolyData:
    """Outer faces of some of the cells, curved ones as flat pieces, with one of the fields."""
    import pyvista

    outer, _ = outer_faces(body, cells)
    values, pieces = flat_pieces(outer.shape[1])
    points = (values @ body.points[outer]).reshape(-1, 3)
    triangles = (pieces + len(values) * np.arange(len(outer))[:, None, None]).reshape(-1, 3)
    surface = pyvista.PolyData.from_regular_faces(points, triangles)
    surface[field] = (body[field][outer] @ values.T).ravel()
    return surface.clean(tolerance=_SAME_MM, absolute=True)


def ring_shell(ring: RingBox, angles: NDArray[Any]) -> tuple[NDArray[Any], pyvista.PolyData]:
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


def plotter_of(width_mm: float, height_mm: float) -> pyvista.Plotter:
    """An empty white scene with its lights, for an image of that size."""
    import pyvista

    pixels = min(max(_PIXELS_PER_MM, _LEAST_WIDTH_PX / width_mm), _LARGEST_WIDTH_PX / width_mm)
    window = [round(pixels * width_mm), round(pixels * height_mm)]
    plotter = pyvista.Plotter(off_screen=True, window_size=window, lighting="none")
    plotter.set_background("white")
    for position, intensity in (((2.0, 3.0, -1.5), 0.55), ((-1.0, 3.0, 2.0), 0.3)):
        plotter.add_light(pyvista.Light(position=position, light_type="scene light", intensity=intensity))
    return plotter


def take(
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
