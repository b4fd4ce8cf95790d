"""The boundary of a meridian mesh as edges of three nodes."""

from __future__ import annotations

import numpy as np

from meshes.cells import TRIANGLE_EDGES
from meshes.solid import IntArray, SolidMesh

# Edges of a quadrilateral as pairs of local corners, in the order of their mid-edge nodes (meshes.cells).
QUADRILATERAL_EDGES = ((0, 1), (0, 2), (1, 3), (2, 3))


def boundary_edges(mesh: SolidMesh) -> IntArray:
    """All edges of a meridian that belong to one cell: corner, mid-edge node, corner, shape (k, 3)."""
    table = TRIANGLE_EDGES if mesh.cell.name == "triangle" else QUADRILATERAL_EDGES
    ends = np.concatenate([mesh.cells[:, list(pair)] for pair in table])
    middle = np.concatenate([mesh.cells[:, mesh.cell.corners + k] for k in range(len(table))])
    _, first, count = np.unique(np.sort(ends, axis=1), axis=0, return_index=True, return_counts=True)
    alone = first[count == 1]
    return np.column_stack([ends[alone, 0], middle[alone], ends[alone, 1]])
