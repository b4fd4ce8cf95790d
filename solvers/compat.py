"""Everything that depends on the version of dolfinx (0.5.2, Debian 12) is in this file."""

from __future__ import annotations

import logging
from typing import Any

import basix
import dolfinx
import numpy as np
import ufl
from dolfinx import cpp, fem, la
from dolfinx import mesh as dmesh
from ffcx import element_interface
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

# -O2 alone leaves the 81 gradient products per quadrature point scalar; -march=native lets the compiler
# vectorise them. No -ffast-math: NaN must stay visible to the checks.
JIT = {
    "cffi_extra_compile_args": ["-O3", "-march=native", "-fno-math-errno"],
    "cffi_libraries": ["m"],
    "timeout": 600,
}


# Kind of a quadratic cell by dimension and number of nodes.
CELL_NAMES = {(2, 6): "triangle", (2, 9): "quadrilateral", (3, 10): "tetrahedron", (3, 27): "hexahedron"}


def make_mesh(comm: MPI.Comm, cells: NDArray[np.int64], points: NDArray[np.float64]) -> dmesh.Mesh:
    """Create a mesh of curved quadratic cells; every rank passes its share of cells and points."""
    gdim = points.shape[1]
    shape = CELL_NAMES[gdim, cells.shape[1]]
    domain = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.Cell(shape, geometric_dimension=gdim), 2))
    partitioner = cpp.mesh.create_cell_partitioner()
    return dmesh.create_mesh(comm, cells, points, domain, dmesh.GhostMode.none, partitioner)


def align_counters() -> None:
    """Let the numbers of UFL's constants and coefficients all have the same count of digits.

    UFL orders operands by text, so a form whose constants straddle 9 and 10 would get another signature, and another
    compilation, than the same form made later in the process.
    """
    for kind in (ufl.constant.Constant, ufl.Coefficient):
        kind._globalcount = max(100_000, -(-kind._globalcount // 1000) * 1000)


def geometry_dofs(mesh: dmesh.Mesh) -> NDArray[np.int32]:
    """Geometry nodes of the owned cells, shape (cells, nodes per cell)."""
    count = mesh.topology.index_map(mesh.topology.dim).size_local
    table = mesh.geometry.dofmap.array.reshape(mesh.geometry.dofmap.num_nodes, -1)
    return table[:count]


def boundary_facets(mesh: dmesh.Mesh) -> NDArray[np.int32]:
    """Owned facets with one cell."""
    mesh.topology.create_connectivity(mesh.topology.dim - 1, mesh.topology.dim)
    return np.asarray(dmesh.exterior_facet_indices(mesh.topology), dtype=np.int32)


def facet_corner_nodes(mesh: dmesh.Mesh, facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """Geometry nodes at the corners of facets, shape (facets, corners)."""
    mesh.topology.create_connectivity(mesh.topology.dim - 1, 0)
    nodes = cpp.mesh.entities_to_geometry(mesh._mesh, mesh.topology.dim - 1, facets, False)
    corners = {"hexahedron": 4}.get(mesh.ufl_cell().cellname(), mesh.topology.dim)
    return np.asarray(nodes, dtype=np.int32).reshape(len(facets), corners)


def corner_positions(mesh: dmesh.Mesh) -> NDArray[np.float64]:
    """Corners of the reference cell, shape (corners, d)."""
    return np.asarray(basix.geometry(basix.cell.string_to_type(mesh.ufl_cell().cellname())))


def node_positions(mesh: dmesh.Mesh) -> NDArray[np.float64]:
    """Quadratic nodes of the reference cell, shape (nodes, d)."""
    cell = basix.cell.string_to_type(mesh.ufl_cell().cellname())
    return np.asarray(basix.create_element(basix.ElementFamily.P, cell, 2, basix.LagrangeVariant.gll_warped).points)


def quadrature_points(mesh: dmesh.Mesh, degree: int) -> NDArray[np.float64]:
    """Points of the cell quadrature of a degree, shape (points, d)."""
    return basix.make_quadrature(basix.cell.string_to_type(mesh.ufl_cell().cellname()), degree)[0]


def basis_at(element: Any, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values of a scalar UFL element's basis functions at reference points, shape (points, functions)."""
    return np.asarray(element_interface.create_element(element).tabulate(0, points))[0]


def input_cells(mesh: dmesh.Mesh) -> NDArray[np.int64]:
    """Number of each local cell in the order in which cells were given."""
    cells = mesh.topology.index_map(mesh.topology.dim)
    return np.asarray(mesh.topology.original_cell_index[: cells.size_local + cells.num_ghosts], dtype=np.int64)


# cffi's build of a form says what it runs, at level INFO of the root logger.
logging.getLogger().addFilter(lambda record: record.levelno > logging.INFO)


def compile_form(form: Any) -> Any:
    """Compile a UFL form with this project's compiler options."""
    return fem.form(form, jit_params=JIT)


def compile_expression(expression: Any, points: NDArray[np.float64]) -> fem.Expression:
    """Compile a UFL expression at reference points with this project's compiler options."""
    return fem.Expression(expression, points, jit_params=JIT)


def cell_dofs(space: Any) -> NDArray[np.int32]:
    """Dofs of the owned cells of a scalar (sub)space in the numbering of its parent."""
    mesh = space.mesh
    count = mesh.topology.index_map(mesh.topology.dim).size_local
    table = space.dofmap.list.array.reshape(-1, space.dofmap.dof_layout.num_dofs)
    return table[:count]


def assemble_into(matrix: PETSc.Mat, form: Any, bcs: list[Any], space: Any) -> None:
    """Add a bilinear form into a PETSc matrix, with unit diagonal on Dirichlet rows; leaves it in flush state."""
    constants = cpp.fem.pack_constants(form)
    coefficients = cpp.fem.pack_coefficients(form)
    cpp.fem.petsc.assemble_matrix(matrix, form, constants, coefficients, bcs)
    matrix.assemblyBegin(PETSc.Mat.AssemblyType.FLUSH)
    matrix.assemblyEnd(PETSc.Mat.AssemblyType.FLUSH)
    cpp.fem.petsc.insert_diagonal(matrix, space._cpp_object, bcs, 1.0)


def cell_pattern(space: Any) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
    """Pattern of a matrix that couples all dofs of each cell: row pointers of the owned rows and global columns."""
    maps = [space.dofmap._cpp_object] * 2
    pattern = cpp.fem.create_sparsity_pattern(space.mesh.topology, maps, {cpp.fem.IntegralType.cell})
    pattern.assemble()
    graph = pattern.graph
    columns = pattern.column_index_map()
    every = np.arange(columns.size_local + columns.num_ghosts, dtype=np.int32)
    rows = space.dofmap.index_map.size_local
    indptr = np.asarray(graph.offsets[: rows + 1])
    return indptr, columns.local_to_global(every)[np.asarray(graph.array[: indptr[-1]])]


def assemble_array(form: Any, index_map: Any) -> la.VectorMetaClass:
    """Assemble a linear form; contributions are summed on the owners, ghosts are not updated."""
    vector = la.vector(index_map, 1)
    vector.array[:] = 0.0
    cpp.fem.assemble_vector(vector.array, form, cpp.fem.pack_constants(form), cpp.fem.pack_coefficients(form))
    vector.scatter_reverse(la.ScatterMode.add)
    return vector


def assemble_scalar(form: Any, comm: MPI.Comm) -> float:
    """Integral over all ranks."""
    local = cpp.fem.assemble_scalar(form, cpp.fem.pack_constants(form), cpp.fem.pack_coefficients(form))
    return float(comm.allreduce(local, op=MPI.SUM))


def dolfinx_version() -> str:
    """Version of dolfinx."""
    return str(dolfinx.__version__)
