"""Jacobians, volumes and counts that tell whether a mesh is fit for use."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from meshes.solid import FACETS, REGIONS, TETRAHEDRON_EDGES, TRIANGLE_EDGES, FloatArray, IntArray, SolidMesh


def _simplex_rule(dimension: int, points_per_axis: int = 4) -> tuple[FloatArray, FloatArray]:
    """Collapsed Gauss rule on the reference simplex: points (q, d) and weights (q,), all weights positive."""
    x, w = np.polynomial.legendre.leggauss(points_per_axis)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    points, weights = [], []
    for combo in itertools.product(range(points_per_axis), repeat=dimension):
        position, left, weight = [], 1.0, 1.0
        for k in combo:
            position.append(x[k] * left)
            weight *= w[k] * left
            left *= 1.0 - x[k]
        points.append(position)
        weights.append(weight)
    return np.array(points), np.array(weights)


def _quadratic_shape(dimension: int, at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Quadratic shape functions (q, k) and their gradients (q, k, d) in basix order."""
    bary = np.column_stack([1.0 - at.sum(axis=1), at])
    grad = np.vstack([-np.ones(dimension), np.eye(dimension)])
    edges = TRIANGLE_EDGES if dimension == 2 else TETRAHEDRON_EDGES
    values = [bary[:, i] * (2.0 * bary[:, i] - 1.0) for i in range(dimension + 1)]
    grads = [(4.0 * bary[:, i] - 1.0)[:, None] * grad[i] for i in range(dimension + 1)]
    for i, j in edges:
        values.append(4.0 * bary[:, i] * bary[:, j])
        grads.append(4.0 * (bary[:, i][:, None] * grad[j] + bary[:, j][:, None] * grad[i]))
    return np.stack(values, axis=1), np.stack(grads, axis=1)


def jacobians(points: FloatArray, cells: IntArray) -> FloatArray:
    """Signed Jacobian determinants at quadrature points, shape (cells, q)."""
    dimension = points.shape[1]
    at, _ = _simplex_rule(dimension)
    _, grads = _quadratic_shape(dimension, at)
    out = np.empty((len(cells), len(at)))
    for first in range(0, len(cells), 20000):  # blocks keep the memory small
        block = cells[first : first + 20000]
        out[first : first + 20000] = np.linalg.det(np.einsum("cki,qkj->cqij", points[block], grads))
    return out


def region_volumes_mm3(mesh: SolidMesh) -> dict[str, float]:
    """Volume of each named region in mm^3; a meridian counts as its body of revolution."""
    at, weights = _simplex_rule(mesh.dimension)
    measure = np.abs(jacobians(mesh.points, mesh.cells)) * weights
    if mesh.dimension == 2:
        values, _ = _quadratic_shape(2, at)
        radius = np.einsum("ck,qk->cq", mesh.points[mesh.cells, 0], values)
        measure = measure * 2.0 * np.pi * radius
    per_cell = measure.sum(axis=1)
    return {name: float(per_cell[mesh.regions == number].sum()) for name, number in REGIONS.items()}


@dataclass(frozen=True)
class MeshQuality:
    """What the report says about a mesh.

    Attributes
    ----------
    cells, nodes
        Counts.
    min_jacobian_ratio
        Smallest over cells of (least Jacobian / greatest Jacobian) at quadrature points; 1 is affine.
    boundary_only_cells
        Cells all of whose corners lie on the boundary: they lock in the incompressible limit.
    """

    cells: int
    nodes: int
    min_jacobian_ratio: float
    boundary_only_cells: int


def mesh_quality(mesh: SolidMesh) -> MeshQuality:
    """Measure a mesh; see `MeshQuality`."""
    values = np.abs(jacobians(mesh.points, mesh.cells))
    boundary = np.zeros(len(mesh.points), dtype=bool)
    boundary[mesh.facets[mesh.facet_tags != FACETS["axis"]].ravel()] = True
    corners = mesh.cells[:, : mesh.dimension + 1]
    return MeshQuality(
        cells=len(mesh.cells),
        nodes=len(mesh.points),
        min_jacobian_ratio=float((values.min(axis=1) / values.max(axis=1)).min()),
        boundary_only_cells=int(boundary[corners].all(axis=1).sum()),
    )
