"""Cells that are all numbered the same way round, and none of them flat or folded over."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from meshes.cells import FloatArray, IntArray, cell_shape
from meshes.errors import MeshError
from meshes.quality import jacobians_with_nodes

# A cell is flat if its least Jacobian is below this part of its longest edge to the power of the dimension: a hundredth
# of what a sliver has that a solver would still take.
FLAT = 1e-6


def oriented(path: Path, points: FloatArray, cells: IntArray, numbers: IntArray) -> IntArray:
    """The cells, those numbered the other way round turned over; which way is the file's own affair.

    Raises
    ------
    MeshError
        If a cell is flat or folded over, named by gmsh's number of it.
    """
    cell = cell_shape(points.shape[1], cells.shape[1])
    signed = jacobians_with_nodes(points, cells)
    turned = signed.max(axis=1) < 0.0
    # exchanging the first two axes of the reference cell
    mirrored = cell.nodes[:, [1, 0, *range(2, cell.dimension)]]
    swap = np.abs(cell.nodes[None] - mirrored[:, None]).sum(axis=2).argmin(axis=1)
    cells = np.where(turned[:, None], cells[:, swap], cells)
    signed = np.where(turned[:, None], -signed, signed)
    corners = points[cells[:, : cell.corners]]
    longest = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=-1).max(axis=(1, 2))
    share = signed / np.maximum(longest, np.finfo(float).tiny)[:, None] ** cell.dimension
    worst = int(np.argmin(share.min(axis=1)))
    if share[worst].min() <= FLAT:
        where = ", ".join(f"{x:.4g}" for x in points[cells[worst]].mean(axis=0))
        how = "is flat" if share[worst].max() <= FLAT else "is folded over or has a flat corner"
        raise MeshError(
            f"{path}: cell {numbers[worst]} near ({where}) mm {how}: optimise the mesh (Mesh.HighOrderOptimize = 2, or "
            "gmsh -optimize_ho) or refine it there"
        )
    return cells
