"""The mesh as plain arrays, handed to the solver: quadratic triangles (meridian) or tetrahedra (3D)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Edges of the reference cells as pairs of local corners, in the order of basix' degree-2 Lagrange nodes
# (basix numbers an edge by the corners it does not touch, lexicographically).
TRIANGLE_EDGES = ((1, 2), (0, 2), (0, 1))
TETRAHEDRON_EDGES = ((2, 3), (1, 3), (1, 2), (0, 3), (0, 2), (0, 1))

REGIONS = {"elastomer": 1, "cap": 2, "ring": 3}
FACETS = {"cavity": 1, "clamped": 2, "tip": 3, "bond": 4, "outer": 5, "axis": 6}


@dataclass(frozen=True)
class SolidMesh:
    """A curved quadratic simplex mesh with named regions and surfaces.

    Attributes
    ----------
    points
        Node positions, shape (n, d), mm. d = 2 is a meridian with columns (r, z); d = 3 has (x, y, z)
        with z along the axis.
    cells
        Nodes of each cell, shape (m, 6) or (m, 10): corners, then mid-edge nodes in basix order.
    regions
        Region number of each cell (``REGIONS``), shape (m,).
    facets
        Corner nodes of the boundary facets, ascending, shape (k, d).
    facet_tags
        Surface number of each facet (``FACETS``), shape (k,).
    facet_bodies
        Number of the ring seat a facet belongs to, -1 elsewhere, shape (k,).
    tip_centre_node
        Node on the axis of the distal face.
    meridian_node, angle_rad
        For a revolved mesh: the meridian node and the angle each node came from, shape (n,); else empty.
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

    @property
    def dimension(self) -> int:
        """2 for a meridian, 3 for a body."""
        return int(self.points.shape[1])

    @property
    def corners(self) -> IntArray:
        """Nodes that are corners of cells, ascending."""
        return np.unique(self.cells[:, : self.dimension + 1])
