"""A user's mesh: a gmsh file with named surfaces, a body or a meridian, read and checked.

In 3D the cells are tetrahedra of ten nodes or hexahedra of 27 and physical surfaces carry the names; a meridian lies in
gmsh's x-y plane with x = r and y = z, its cells are triangles of six nodes or quadrilaterals of nine, and physical
curves carry the names. Cells of first order are taken where faces are flat. Names are those of ``SURFACES``.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from meshes.cells import FloatArray
from meshes.errors import MeshError
from meshes.solid import SolidMesh
from meshes.users.contents import read_contents
from meshes.users.kinds import cells_of, in_own_order
from meshes.users.orientation import oriented
from meshes.users.surfaces import (
    SURFACES,
    check_facets,
    check_planes,
    named_facets,
    on_the_axis,
    rigid_bodies,
    with_axis,
)
from meshes.users.volumes import named_volumes

__all__ = ["SURFACES", "read_user_mesh"]

# Longest edge of the bounding box, mm: a 50 mm actuator in metres is below, one in micrometres above.
SMALLEST_MM, LARGEST_MM = 0.5, 2000.0


def read_user_mesh(path: Path, scale: float = 1.0) -> SolidMesh:
    """Read a mesh.

    Parameters
    ----------
    path
        A gmsh file, .msh.
    scale
        Factor that makes its lengths mm: 1000 for a mesh in metres.

    Returns
    -------
    SolidMesh
        With the volumes that the file names. Edges of a meridian on r = 0 are ``axis`` whatever their name.

    Raises
    ------
    MeshError
        If it cannot be read, has cells of another kind or of several, is not one body, has unknown or missing names,
        flat cells (with gmsh's number of the cell), or a size that is not one of mm.
    """
    try:
        stamp = path.stat().st_mtime_ns
    except OSError as error:
        raise MeshError(f"{path}: cannot be read ({error.strerror}); give the path of a gmsh file") from None
    return _checked(path.resolve(), scale, stamp)


@lru_cache(maxsize=4)
def _checked(path: Path, scale: float, stamp: int) -> SolidMesh:
    """As `read_user_mesh`; a scene's mesh is asked for several times, and ``stamp`` tells when the file changed."""
    from meshes.users.one_body import (  # SciPy's graphs and trees, for users' meshes only
        check_flat_faces,
        check_one_body,
    )

    contents = read_contents(path)
    elements, cell = cells_of(contents)
    used, back = np.unique(elements.nodes, return_inverse=True)
    points = scale * contents.points[contents.places(used)]
    if cell.dimension == 2:
        points = on_the_axis(path, points)
    _check_size(path, points, scale)
    facets, tags, rigid = named_facets(contents, used, cell.dimension)
    regions, volumes = named_volumes(contents, elements)
    rows = back.reshape(elements.nodes.shape).astype(np.int64)
    points, cells, place = in_own_order(points, rows, elements.kind, cell)
    facets = np.sort(place[facets], axis=1)
    cells = oriented(path, points, cells, elements.numbers)
    found = check_one_body(path, points, cells, elements.numbers)
    if elements.kind.order == 1:
        check_flat_faces(path, points, found)
    check_facets(path, facets, tags, found)
    if cell.dimension == 2:
        facets, tags = with_axis(path, points, facets, tags, found)
    check_planes(path, points, facets, tags)
    tags, bodies = rigid_bodies(tags)
    return SolidMesh(
        points=points,
        cells=cells,
        regions=regions,
        facets=facets,
        facet_tags=tags,
        facet_bodies=bodies,
        tip_centre_node=int(np.lexsort((points[:, 0], -points[:, -1]))[0]),
        volumes=volumes,
        rigid=rigid,
    )


def _check_size(path: Path, points: FloatArray, scale: float) -> None:
    size = float(np.ptp(points, axis=0).max())
    if not SMALLEST_MM <= size <= LARGEST_MM:
        likely = "metres: set scale = 1000" if size < SMALLEST_MM else "micrometres: set scale = 0.001"
        raise MeshError(
            f"{path}: its bounding box is {size:g} mm long with scale = {scale:g}, outside {SMALLEST_MM:g} to "
            f"{LARGEST_MM:g} mm; if it was drawn in {likely}"
        )
