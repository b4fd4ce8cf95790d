"""A mesh given as arrays, distributed over the ranks, with its named regions and surfaces.

Fields cross the border of this package as arrays in the numbering of the caller's nodes, so that nothing
outside depends on dolfinx's numbering or on the number of ranks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import ufl
from dolfinx import mesh as dmesh
from mpi4py import MPI
from numpy.typing import NDArray

from solvers import compat
from solvers.errors import SolverError

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


class MeshArrays(Protocol):
    """What the solver reads of a mesh: quadratic cells of one kind with regions and tagged boundary facets.

    Nodes of a cell are in basix order: six of a triangle, nine of a quadrilateral, ten of a tetrahedron, 27 of a
    hexahedron. Facets are given by their corners, ascending.
    """

    @property
    def points(self) -> FloatArray: ...  # noqa: D102
    @property
    def cells(self) -> IntArray: ...  # noqa: D102
    @property
    def regions(self) -> IntArray: ...  # noqa: D102
    @property
    def facets(self) -> IntArray: ...  # noqa: D102
    @property
    def facet_tags(self) -> IntArray: ...  # noqa: D102
    @property
    def facet_bodies(self) -> IntArray: ...  # noqa: D102


@dataclass(frozen=True)
class Domain:
    """A distributed mesh.

    Attributes
    ----------
    comm
        Its communicator.
    mesh
        The dolfinx mesh.
    axisymmetric
        True for a meridian with coordinates (r, z); False for a body in (x, y, z).
    cell_tags, facet_tags
        dolfinx mesh tags with the caller's region and surface numbers.
    facet_bodies
        Number of the rigid body of each facet in ``facet_tags``, -1 for none.
    input_node
        Caller's node of each local geometry node.
    input_cell
        Caller's cell of each local cell.
    nodes, cells
        Numbers of the caller's nodes and cells.
    """

    comm: MPI.Comm
    mesh: dmesh.Mesh
    axisymmetric: bool
    cell_tags: Any
    facet_tags: Any
    facet_bodies: IntArray
    input_node: IntArray
    input_cell: IntArray
    nodes: int
    cells: int

    @property
    def cell_name(self) -> str:
        """Kind of the cells."""
        return compat.cell_name(self.mesh.ufl_cell())

    @property
    def corners(self) -> int:
        """Corners of a cell."""
        return compat.corners(self.mesh.ufl_cell())

    @property
    def dx(self) -> Any:
        """Cell measure by region."""
        return ufl.Measure("dx", domain=self.mesh, subdomain_data=self.cell_tags)

    @property
    def ds(self) -> Any:
        """Boundary measure by surface."""
        return ufl.Measure("ds", domain=self.mesh, subdomain_data=self.facet_tags)


def create_domain(comm: MPI.Comm, arrays: MeshArrays | None) -> Domain:
    """Distribute a mesh that rank 0 holds.

    Parameters
    ----------
    comm
        Communicator; every rank must call.
    arrays
        The mesh on rank 0; other ranks pass None.

    Returns
    -------
    Domain

    Raises
    ------
    SolverError
        If a tagged facet is not on the boundary of the mesh.
    """
    root = comm.rank == 0
    head = None
    if root:
        assert arrays is not None
        head = (arrays.points.shape[1], arrays.cells.shape[1], len(arrays.points), len(arrays.cells))
    gdim, per_cell, node_count, cell_count = comm.bcast(head)
    cells = arrays.cells if root and arrays is not None else np.empty((0, per_cell), dtype=np.int64)
    points = arrays.points if root and arrays is not None else np.empty((0, gdim))
    mesh = compat.make_mesh(comm, np.ascontiguousarray(cells), np.ascontiguousarray(points))

    tables = (arrays.regions, arrays.facets, arrays.facet_tags, arrays.facet_bodies) if root and arrays else None
    regions, facets, tags, bodies = comm.bcast(tables)
    original = compat.input_cells(mesh)
    every = np.arange(len(original), dtype=np.int32)
    cell_tags = dmesh.meshtags(mesh, gdim, every, regions[original].astype(np.int32))

    input_node = np.asarray(mesh.geometry.input_global_indices, dtype=np.int64)
    own = compat.boundary_facets(mesh)
    corners = compat.facet_corner_nodes(mesh, own)
    keys = _key(np.sort(input_node[corners], axis=1), node_count)
    wanted = _key(np.sort(facets, axis=1), node_count)
    order = np.argsort(wanted)
    place = np.minimum(np.searchsorted(wanted[order], keys), len(wanted) - 1)
    hit = wanted[order][place] == keys
    found = int(comm.allreduce(int(hit.sum()), op=MPI.SUM))
    if found != len(wanted):
        raise SolverError(f"{len(wanted) - found} of {len(wanted)} tagged facets are not on the mesh's boundary")
    which = order[place[hit]]
    tagged = own[hit]
    ascending = np.argsort(tagged)
    facet_tags = dmesh.meshtags(mesh, gdim - 1, tagged[ascending], tags[which][ascending].astype(np.int32))
    return Domain(
        comm,
        mesh,
        gdim == 2,
        cell_tags,
        facet_tags,
        bodies[which][ascending],
        input_node,
        original,
        node_count,
        cell_count,
    )


def _key(rows: IntArray, base: int) -> IntArray:
    """One integer per row of sorted node numbers; exact below 2**63 for up to two million nodes in 3D.

    Three corners name a facet of four too: two facets of a mesh never share three.
    """
    key = rows[:, 0].astype(np.int64)
    for column in range(1, min(rows.shape[1], 3)):
        key = key * base + rows[:, column]
    return key
