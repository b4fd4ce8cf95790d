"""The mesh of the peers' problem as plain arrays in a file, the same for every code.

Rings are meshed as one more, stiff, region. Tetrahedra and triangles are those of this program's own runs; hexahedra
and quadrilaterals too, with the outer edges of the rings sharp: they carry nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from meshes.by_gmsh.ring import RingShape
from meshes.cells import HEXAHEDRON_NODES, QUADRILATERAL_NODES, TETRAHEDRON_EDGES, TRIANGLE_EDGES
from meshes.meridian import default_resolution, meridian_mesh
from meshes.quality import jacobians
from meshes.revolve import revolve
from meshes.solid import FACETS, REGIONS, FloatArray, IntArray, SolidMesh
from meshes.sweep import revolve_hexahedra
from studies.models.build import Tip
from studies.scene.bellows import BellowsScene, ring_material, ring_shape, shape_of
from studies.scene.materials import law_of

Cells = Literal["tri6", "quad9", "tet10", "hex27"]
# Region numbers in the file.
SOFT, STIFF = 1, 2


@dataclass(frozen=True)
class Level:
    """Cells, refinement of the meridian and, in 3D, cells round the whole body; there may be a quarter only."""

    cells: Cells
    meridian: int
    around: int = 0
    quarter: bool = False

    @property
    def name(self) -> str:
        """For instance ``tet10-n12r2``, ``hex27-n8r1-quarter``."""
        around = f"n{self.around}" if self.around else ""
        return f"{self.cells}-{around}r{self.meridian}" + "-quarter" * self.quarter


def peer_mesh(scene: BellowsScene, level: Level) -> SolidMesh:
    """The mesh of a scene with meshed rings.

    Raises
    ------
    GeometryError
        If the shape cannot be meshed so.
    """
    shape = shape_of(scene)
    if level.cells in ("tri6", "tet10"):
        resolution = default_resolution(shape, level.meridian, "triangles")
        meridian = meridian_mesh(shape, resolution, ring_shape(scene), "triangles")
        return meridian if level.cells == "tri6" else revolve(meridian, level.around)
    resolution = default_resolution(shape, level.meridian, "quadrilaterals")
    sharp = RingShape(scene.rings.height_mm, 0.0)
    meridian = meridian_mesh(shape, resolution, sharp, "quadrilaterals")
    if level.cells == "quad9":
        return meridian
    if level.quarter:
        return revolve_hexahedra(meridian, level.around // 4, 0.5 * math.pi)
    return revolve_hexahedra(meridian, level.around)


def local_faces(cells: Cells) -> IntArray:
    """Local nodes of each facet of a cell in basix order, corners first, then the others: shape (facets, nodes)."""
    if cells == "tri6":
        return np.array([[*edge, 3 + k] for k, edge in enumerate(TRIANGLE_EDGES)])
    if cells == "tet10":
        number = {frozenset(edge): 4 + k for k, edge in enumerate(TETRAHEDRON_EDGES)}
        corners = [[i for i in range(4) if i != out] for out in range(4)]
        pairs = [(1, 2), (0, 2), (0, 1)]  # as of a triangle in basix order
        return np.array([[*c, *(number[frozenset((c[i], c[j]))] for i, j in pairs)] for c in corners])
    lattice = QUADRILATERAL_NODES if cells == "quad9" else HEXAHEDRON_NODES
    sides = [(axis, end) for axis in range(lattice.shape[1]) for end in (0, 2)]
    return np.array([np.flatnonzero(lattice[:, axis] == end) for axis, end in sides])  # corners come first in basix


def facet_nodes(mesh: SolidMesh, cells: Cells, tag: int) -> tuple[IntArray, IntArray]:
    """All nodes of the facets of a surface, (k, nodes), and the cell each belongs to, (k,)."""
    faces, corners = local_faces(cells), mesh.facets.shape[1]
    every = mesh.cells[:, faces]  # (cells, facets, nodes)
    keys = np.sort(every[:, :, :corners].reshape(-1, corners), axis=1)
    wanted = np.sort(mesh.facets[mesh.facet_tags == tag], axis=1)
    _, back = np.unique(np.vstack([wanted, keys]), axis=0, return_inverse=True)
    back = back.ravel()
    hit = np.flatnonzero(np.isin(back[len(wanted) :], back[: len(wanted)]))
    return every.reshape(-1, faces.shape[1])[hit], hit // len(faces)


def write_peer_mesh(scene: BellowsScene, level: Level, path: Path) -> SolidMesh:
    """Write the mesh, its load and its materials as an .npz.

    Arrays: ``points`` (mm), ``cells`` (basix order, positive volumes), ``regions`` (1 silicone, 2 ring),
    ``cavity_facets``, ``clamped_facets``, ``axis_facets``, ``plane_x_facets``, ``plane_y_facets`` (of a quarter, where
    x = 0 and y = 0; all nodes of each, corners first; the cavity's turn so that their normal leaves the silicone),
    ``cavity_cells``, ``tip_nodes`` and ``tip_weights`` (of the mean axial
    displacement of the distal rim), ``yeoh_mpa``, ``ring_mpa_nu``, ``pressure_mpa``.
    """
    mesh = _corners_first(_turned(peer_mesh(scene, level)))
    cavity, owners = facet_nodes(mesh, level.cells, FACETS["cavity"])
    held = {"clamped": "clamped", "axis": "axis", "plane_x": "end", "plane_y": "start"}
    nodes, weights = tip_weights(scene, mesh)
    ring = ring_material(scene)
    law = law_of(scene.material)
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savez(
        path,
        points=mesh.points,
        cells=mesh.cells,
        regions=np.where(mesh.regions == REGIONS["ring"], STIFF, SOFT),
        cavity_facets=_outward(mesh, cavity, owners),
        cavity_cells=owners,
        **{f"{name}_facets": facet_nodes(mesh, level.cells, FACETS[tag])[0] for name, tag in held.items()},
        tip_nodes=nodes,
        tip_weights=weights,
        yeoh_mpa=np.array(getattr(law, "c_mpa")),  # noqa: B009 (the peers' law is Yeoh's)
        ring_mpa_nu=np.array([ring.young_mpa, ring.poisson]),
        pressure_mpa=scene.pressures_mpa[-1],
    )
    return mesh


def _turned(mesh: SolidMesh) -> SolidMesh:
    """Cells of positive measure: a negative one is renumbered as its mirror image."""
    nodes = mesh.cells.shape[1]
    if nodes in (6, 10):
        # of a triangle 1, 2 and the middles opposite to them; of a tetrahedron 2, 3 and the middles 12-13, 02-03
        change = [0, 2, 1, 3, 5, 4] if nodes == 6 else [0, 1, 3, 2, 4, 6, 5, 8, 7, 9]
    else:
        lattice = (QUADRILATERAL_NODES if nodes == 9 else HEXAHEDRON_NODES).tolist()
        change = [lattice.index([*head, 2 - last]) for *head, last in lattice]
    cells = mesh.cells.copy()
    negative = jacobians(mesh.points, cells).mean(axis=1) < 0.0
    cells[negative] = cells[negative][:, change]
    return replace(mesh, cells=cells)


def _corners_first(mesh: SolidMesh) -> SolidMesh:
    """The mesh with its corners numbered before all other nodes: some codes do that by themselves."""
    corners = mesh.corners
    old = np.concatenate([corners, np.setdiff1d(np.arange(len(mesh.points)), corners)])
    new = np.empty_like(old)
    new[old] = np.arange(len(old))
    return replace(
        mesh,
        points=mesh.points[old],
        cells=new[mesh.cells],
        facets=new[mesh.facets],
        tip_centre_node=int(new[mesh.tip_centre_node]),
    )


def _outward(mesh: SolidMesh, facets: IntArray, owners: IntArray) -> IntArray:
    """Facets turned so that their normal (of an edge, the one to its right) leaves the cell."""
    corners = mesh.points[facets[:, : mesh.dimension]]
    inside = mesh.points[mesh.cells[owners, : mesh.cell.corners]].mean(axis=1) - corners[:, 0]
    first = corners[:, 1] - corners[:, 0]
    if mesh.dimension == 2:
        wrong = first[:, 1] * inside[:, 0] - first[:, 0] * inside[:, 1] > 0.0
        change = [1, 0, 2]
    else:
        wrong = np.einsum("ki,ki->k", np.cross(first, corners[:, 2] - corners[:, 0]), inside) > 0.0
        change = [1, 0, 2, 4, 3, 5] if facets.shape[1] == 6 else [0, 2, 1, 3, 5, 4, 7, 6, 8]
    turned = facets.copy()
    turned[wrong] = facets[wrong][:, change]
    return turned


def tip_weights(scene: BellowsScene, mesh: SolidMesh) -> tuple[IntArray, FloatArray]:
    """Nodes and weights whose sum with the axial displacements is ``tip_mm`` as this program defines it."""
    tip = Tip(scene, mesh)
    facets, weight = tip._facets, tip._weight
    nodes, back = np.unique(facets, return_inverse=True)
    spread = np.repeat(weight / facets.shape[1], facets.shape[1])
    summed = np.bincount(back.ravel(), weights=spread)
    return np.asarray(nodes, dtype=np.int64), np.asarray(summed, dtype=np.float64)
