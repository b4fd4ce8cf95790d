"""The surface of a mesh: integrals over a named part as weights of nodes, and a meridian's boundary as edges."""

from __future__ import annotations

import numpy as np

from meshes.cells import CellShape
from meshes.errors import MeshError
from meshes.solid import FACETS, FloatArray, IntArray, SolidMesh

# Gauss points in each direction: weights of quadratic functions on curved facets to below the mesh's own error.
_POINTS = 4


def surface_weights(mesh: SolidMesh, name: str) -> FloatArray:
    """Integral of each node's shape function over a surface, mm^2: ``weights @ values`` integrates nodal values.

    Parameters
    ----------
    mesh
        A body, or a meridian, whose surface is that of its body of revolution.
    name
        A surface of ``FACETS``.

    Returns
    -------
    ndarray
        Shape (nodes,), zero away from the surface.

    Raises
    ------
    MeshError
        If the mesh has no such surface.
    """
    wanted = {tuple(f) for f in mesh.facets[mesh.facet_tags == FACETS[name]].tolist()}
    if not wanted:
        raise MeshError(f"the mesh has no surface named {name}")
    weights = np.zeros(len(mesh.points))
    for corners in mesh.cell.facets:
        facets = np.sort(mesh.cells[:, list(corners)], axis=1)
        cells = mesh.cells[[tuple(f) in wanted for f in facets.tolist()]]
        if len(cells):
            np.add.at(weights, cells, _facet_integrals(mesh.points, cells, mesh.cell, corners))
    return weights


def _facet_integrals(points: FloatArray, cells: IntArray, cell: CellShape, corners: tuple[int, ...]) -> FloatArray:
    """Integrals of the cells' shape functions over one of their facets each, shape (cells, nodes of a cell)."""
    at, edges, weight = _facet_rule(cell, corners)
    values, grads = cell.shape(at)
    jacobian = np.einsum("cki,qkj->cqij", points[cells], grads)
    along = np.einsum("cqij,aj->cqai", jacobian, edges)
    if cell.dimension == 3:
        area = np.linalg.norm(np.cross(along[:, :, 0], along[:, :, 1]), axis=-1)
    else:
        radius = np.einsum("ck,qk->cq", points[cells, 0], values)
        area = 2.0 * np.pi * radius * np.linalg.norm(along[:, :, 0], axis=-1)
    return np.asarray(np.einsum("cq,q,qk->ck", area, weight, values))


def _facet_rule(cell: CellShape, corners: tuple[int, ...]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points (q, d) of a facet of the reference cell, two (one in 2D) of its edges (d - 1, d), weights (q,)."""
    place = cell.nodes[list(corners)]
    x, w = np.polynomial.legendre.leggauss(_POINTS)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    edges = place[1:3] - place[0] if cell.dimension == 3 else place[1:2] - place[0]
    if cell.dimension == 2:
        return place[0] + x[:, None] * edges[0], edges, w
    s, t = (a.ravel() for a in np.meshgrid(x, x, indexing="ij"))
    weight = np.outer(w, w).ravel()
    if len(corners) == 3:  # the square, collapsed
        t, weight = t * (1.0 - s), weight * (1.0 - s)
    return place[0] + s[:, None] * edges[0] + t[:, None] * edges[1], edges, weight


def boundary_edges(mesh: SolidMesh) -> IntArray:
    """All edges of a meridian that belong to one cell: corner, mid-edge node, corner, shape (k, 3)."""
    table = mesh.cell.facets
    ends = np.concatenate([mesh.cells[:, list(pair)] for pair in table])
    middle = np.concatenate([mesh.cells[:, mesh.cell.corners + k] for k in range(len(table))])
    _, first, count = np.unique(np.sort(ends, axis=1), axis=0, return_index=True, return_counts=True)
    alone = first[count == 1]
    return np.column_stack([ends[alone, 0], middle[alone], ends[alone, 1]])
