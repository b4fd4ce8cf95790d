"""Jacobians, volumes and counts that tell whether a mesh is fit for use."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshes.cells import cell_shape
from meshes.solid import FACETS, FIRST_VOLUME, REGIONS, FloatArray, IntArray, SolidMesh


def jacobians(points: FloatArray, cells: IntArray, at: FloatArray | None = None) -> FloatArray:
    """Signed Jacobian determinants at places of the reference cell, by default quadrature points, shape (cells, q)."""
    cell = cell_shape(points.shape[1], cells.shape[1])
    at = cell.rule[0] if at is None else at
    _, grads = cell.shape(at)
    out = np.empty((len(cells), len(at)))
    for first in range(0, len(cells), 20000):  # blocks keep the memory small
        block = cells[first : first + 20000]
        out[first : first + 20000] = np.linalg.det(np.einsum("cki,qkj->cqij", points[block], grads, optimize=True))
    return out


def jacobians_with_nodes(points: FloatArray, cells: IntArray) -> FloatArray:
    """Jacobians at quadrature points and at nodes, where they are least, shape (cells, q)."""
    cell = cell_shape(points.shape[1], cells.shape[1])
    return np.hstack([jacobians(points, cells), jacobians(points, cells, cell.nodes)])


def region_volumes_mm3(mesh: SolidMesh) -> dict[str, float]:
    """Volume of each region in mm^3; a meridian counts as its body of revolution, a user's volumes as elastomer."""
    at, weights = mesh.cell.rule
    measure = np.abs(jacobians(mesh.points, mesh.cells)) * weights
    if mesh.dimension == 2:
        values, _ = mesh.cell.shape(at)
        radius = np.einsum("ck,qk->cq", mesh.points[mesh.cells, 0], values)
        measure = measure * 2.0 * np.pi * radius
    per_cell = measure.sum(axis=1)
    regions = np.where(mesh.regions < FIRST_VOLUME, mesh.regions, REGIONS["elastomer"])
    return {name: float(per_cell[regions == number].sum()) for name, number in REGIONS.items()}


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
        Cells all of whose corners lie on the boundary: simplices that lock in the incompressible limit (always 0
        for quadrilaterals and hexahedra, whose inner nodes move freely).
    """

    cells: int
    nodes: int
    min_jacobian_ratio: float
    boundary_only_cells: int


def mesh_quality(mesh: SolidMesh) -> MeshQuality:
    """Measure a mesh; see `MeshQuality`."""
    values = np.abs(jacobians(mesh.points, mesh.cells))
    simplices = mesh.cell.corners == mesh.dimension + 1
    boundary = np.zeros(len(mesh.points), dtype=bool)
    inside = [FACETS[name] for name in ("axis", "symmetry_x", "symmetry_y", "symmetry_z")]
    boundary[mesh.facets[~np.isin(mesh.facet_tags, inside)].ravel()] = True
    corners = mesh.cells[:, : mesh.cell.corners]
    return MeshQuality(
        cells=len(mesh.cells),
        nodes=len(mesh.points),
        min_jacobian_ratio=float((values.min(axis=1) / values.max(axis=1)).min()),
        boundary_only_cells=int(boundary[corners].all(axis=1).sum()) if simplices else 0,
    )
