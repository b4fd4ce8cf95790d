"""The mesh as plain arrays, handed to the solver: quadratic cells of a meridian or of a body."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from meshes.cells import TETRAHEDRON_EDGES, TRIANGLE_EDGES, CellShape, FloatArray, IntArray, cell_shape

__all__ = ["FACETS", "REGIONS", "TETRAHEDRON_EDGES", "TRIANGLE_EDGES", "FloatArray", "IntArray", "SolidMesh"]

REGIONS = {"elastomer": 1, "cap": 2, "ring": 3}
# Further regions of a user's mesh, all elastomer unless the scene says what else, count from here.
FIRST_VOLUME = 11
# ``start`` and ``end`` are the faces of a sector at angle 0 and at its full angle, ``bottom`` and ``top`` the planes in
# which a tube or half a sphere ends, ``symmetry_x`` a plane x = const in a user's mesh.
FACETS = {
    "cavity": 1,
    "clamped": 2,
    "tip": 3,
    "bond": 4,
    "outer": 5,
    "axis": 6,
    "start": 7,
    "end": 8,
    "bottom": 9,
    "top": 10,
    "symmetry_x": 11,
    "symmetry_y": 12,
    "symmetry_z": 13,
}


@dataclass(frozen=True)
class SolidMesh:
    """A curved quadratic mesh with named regions and surfaces, all cells of one kind.

    Attributes
    ----------
    points
        Node positions, shape (n, d), mm. d = 2 is a meridian with columns (r, z); d = 3 has (x, y, z)
        with z along the axis.
    cells
        Nodes of each cell in basix order, corners first: (m, 6) triangles, (m, 9) quadrilaterals,
        (m, 10) tetrahedra or (m, 27) hexahedra.
    regions
        Region number of each cell (``REGIONS``), shape (m,).
    facets
        Corner nodes of the boundary facets, ascending, shape (k, corners of a facet).
    facet_tags
        Surface number of each facet (``FACETS``), shape (k,).
    facet_bodies
        Number of the ring seat a facet belongs to, -1 elsewhere, shape (k,).
    tip_centre_node
        Node on the axis of the distal face; at the outer edge of an open end.
    meridian_node, angle_rad
        For a revolved mesh: the meridian node and the angle each node came from, shape (n,); else empty.
        Where a node lies between meridian nodes, ``meridian_node`` has shape (n, 3).
    meridian_weight
        Shape (n, 3): weights of these three; empty where ``meridian_node`` has one column.
    strip
        Of a meridian cut from a strip: coordinates (s, t) of its nodes there, see `meshes.strip.corners`, shape (n, 2);
        nodes of meshed rings, which come last, have none.
    volumes
        Of a user's mesh: each region number, with the names of the physical volumes that the region is in.
    rigid
        Of a user's mesh: names of the surfaces that move as rigid bodies, by their numbers in ``facet_bodies``.
    """

    points: FloatArray
    cells: IntArray
    regions: IntArray
    facets: IntArray
    facet_tags: IntArray
    facet_bodies: IntArray
    tip_centre_node: int
    meridian_node: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    angle_rad: FloatArray = field(default_factory=lambda: np.empty(0))
    meridian_weight: FloatArray = field(default_factory=lambda: np.empty(0))
    strip: FloatArray = field(default_factory=lambda: np.empty((0, 2)))
    volumes: tuple[tuple[int, tuple[str, ...]], ...] = ()
    rigid: tuple[str, ...] = ()

    @property
    def dimension(self) -> int:
        """2 for a meridian, 3 for a body."""
        return int(self.points.shape[1])

    @property
    def cell(self) -> CellShape:
        """The reference cell."""
        return cell_shape(self.dimension, self.cells.shape[1])

    @property
    def corners(self) -> IntArray:
        """Nodes that are corners of cells, ascending."""
        return np.unique(self.cells[:, : self.cell.corners])
