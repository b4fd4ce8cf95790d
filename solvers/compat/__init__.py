"""Everything that depends on the version of dolfinx is in this folder: 0.5 (Debian 12), 0.9 (Debian 13), 0.11 (wheel).

What they share is here, what they call otherwise in a file each; which of the two holds is asked of dolfinx itself.
"""

from __future__ import annotations

import logging
from typing import Any

import basix
import dolfinx
import numpy as np
import scipy.sparse
import ufl
from dolfinx import cpp, fem, la
from dolfinx import mesh as dmesh
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

if hasattr(fem, "functionspace"):
    from solvers.compat import dolfinx_09 as stack
else:
    from solvers.compat import dolfinx_05 as stack  # type: ignore[no-redef]

# -O2 alone leaves the 81 gradient products per quadrature point scalar; -march=native lets the compiler
# vectorise them. No -ffast-math: NaN must stay visible to the checks.
JIT = {
    "cffi_extra_compile_args": ["-O3", "-march=native", "-fno-math-errno"],
    "cffi_libraries": ["m"],
    "timeout": 600,
}


# Kind of a quadratic cell by dimension and number of nodes.
CELL_NAMES = {(2, 6): "triangle", (2, 9): "quadrilateral", (3, 10): "tetrahedron", (3, 27): "hexahedron"}

element, mixed_element, sub_elements = stack.element, stack.mixed_element, stack.sub_elements
evaluate, newton_problem = stack.evaluate, stack.newton_problem


# ---- meshes --------------------------------------------------------------------------------------------


def make_mesh(comm: MPI.Comm, cells: NDArray[np.int64], points: NDArray[np.float64]) -> dmesh.Mesh:
    """Create a mesh of curved quadratic cells; every rank passes its share of cells and points."""
    return stack.create_mesh(comm, cells, points, CELL_NAMES[points.shape[1], cells.shape[1]])


def cell_name(cell: Any) -> str:
    """Kind of a UFL cell."""
    return str(_value(cell.cellname))


def corners(cell: Any) -> int:
    """Number of corners of a UFL cell."""
    return int(_value(cell.num_vertices))


def dimension(cell: Any) -> int:
    """Dimension of a UFL cell."""
    return int(_value(cell.topological_dimension))


def _value(attribute: Any) -> Any:
    """What a method gives that UFL has made a property of in 2025."""
    return attribute() if callable(attribute) else attribute


def _basix_cell(name: str) -> Any:
    return getattr(basix.CellType, name)


def _unwrap(thing: Any) -> Any:
    """The C++ object, which later versions wrap."""
    return getattr(thing, "_cpp_object", thing)


def geometry_dofs(mesh: dmesh.Mesh) -> NDArray[np.int32]:
    """Geometry nodes of the owned cells, shape (cells, nodes per cell)."""
    geometry = mesh.geometry
    # 0.11 has a dofmap for each kind of cell
    dofmap = geometry.dofmaps[0] if hasattr(geometry, "dofmaps") else geometry.dofmap
    return stack.table(dofmap)[: mesh.topology.index_map(mesh.topology.dim).size_local]


def boundary_facets(mesh: dmesh.Mesh) -> NDArray[np.int32]:
    """Owned facets with one cell."""
    mesh.topology.create_connectivity(mesh.topology.dim - 1, mesh.topology.dim)
    return np.asarray(dmesh.exterior_facet_indices(mesh.topology), dtype=np.int32)


def facet_corner_nodes(mesh: dmesh.Mesh, facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """Geometry nodes at the corners of facets, shape (facets, corners)."""
    mesh.topology.create_connectivity(mesh.topology.dim - 1, 0)
    cpp_mesh = mesh._cpp_object if hasattr(mesh, "_cpp_object") else mesh._mesh
    nodes = cpp.mesh.entities_to_geometry(cpp_mesh, mesh.topology.dim - 1, facets, False)
    count = {"hexahedron": 4}.get(cell_name(mesh.ufl_cell()), mesh.topology.dim)
    # later versions give the nodes on edges too, after the corners
    return np.asarray(nodes, dtype=np.int32).reshape(len(facets), -1 if len(facets) else count)[:, :count]


def input_cells(mesh: dmesh.Mesh) -> NDArray[np.int64]:
    """Number of each local cell in the order in which cells were given."""
    cells = mesh.topology.index_map(mesh.topology.dim)
    return np.asarray(mesh.topology.original_cell_index[: cells.size_local + cells.num_ghosts], dtype=np.int64)


# ---- reference cells -----------------------------------------------------------------------------------


def corner_positions(name: str) -> NDArray[np.float64]:
    """Corners of the reference cell, shape (corners, d)."""
    return np.asarray(basix.geometry(_basix_cell(name)))


def node_positions(name: str) -> NDArray[np.float64]:
    """Quadratic nodes of the reference cell, shape (nodes, d)."""
    return np.asarray(_lagrange(name, 2).points)


def lagrange_at_nodes(name: str, degree: int) -> NDArray[np.float64]:
    """Lagrange functions of a degree and their gradients at the quadratic nodes, shape (1 + d, nodes, functions)."""
    return np.asarray(_lagrange(name, degree).tabulate(1, node_positions(name)))[..., 0]


def _lagrange(name: str, degree: int) -> Any:
    return basix.create_element(basix.ElementFamily.P, _basix_cell(name), degree, basix.LagrangeVariant.gll_warped)


def quadrature_points(name: str, degree: int) -> NDArray[np.float64]:
    """Points of the cell quadrature of a degree, shape (points, d)."""
    return basix.make_quadrature(_basix_cell(name), degree)[0]


def basis_at(element: Any, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values of a scalar UFL element's basis functions at reference points, shape (points, functions)."""
    return np.asarray(stack.tabulate(element, points))[0]


# ---- spaces --------------------------------------------------------------------------------------------


def function_space(mesh: dmesh.Mesh, element: Any, shape: tuple[int, ...] = ()) -> Any:
    """Function space of a UFL element, or of values of a shape in the element (family, degree)."""
    if isinstance(element, tuple):
        element = stack.element(element[0], mesh.ufl_cell(), element[1], shape)
    return stack.function_space(mesh, element)


def cell_dofs(space: Any) -> NDArray[np.int32]:
    """Dofs of the owned cells of a scalar (sub)space in the numbering of its parent."""
    mesh = space.mesh
    return stack.table(space.dofmap)[: mesh.topology.index_map(mesh.topology.dim).size_local]


def cell_pattern(space: Any) -> scipy.sparse.csr_matrix:
    """Which dofs share a cell: rows are the owned dofs, columns all dofs in global numbering; ones where they do."""
    comm, index_map = space.mesh.comm, space.dofmap.index_map
    owned, ghosts, total = index_map.size_local, index_map.num_ghosts, index_map.size_global
    dofs = cell_dofs(space)
    starts = np.arange(len(dofs) + 1, dtype=np.int64) * dofs.shape[1]
    at = scipy.sparse.csr_matrix(
        (np.ones(dofs.size, np.int16), dofs.ravel(), starts), shape=(len(dofs), owned + ghosts)
    )
    local = (at.T @ at).tocsr()
    if comm.size == 1:
        return local
    names = index_map.local_to_global(np.arange(owned + ghosts, dtype=np.int32)).astype(PETSc.IntType)
    pattern = scipy.sparse.csr_matrix((local.data, names[local.indices], local.indptr), shape=(owned + ghosts, total))
    # what other ranks' cells couple at a dof is its owner's too
    firsts = np.array(comm.allgather(index_map.local_range[0]))
    beyond = pattern[owned:].tocoo()
    rows = names[owned:][beyond.row]
    owner = np.searchsorted(firsts, rows, side="right") - 1
    parts = [(rows[owner == rank], beyond.col[owner == rank]) for rank in range(comm.size)]
    row, column = (np.concatenate(part) for part in zip(*comm.alltoall(parts), strict=True))
    here = (row - index_map.local_range[0], column)
    return pattern[:owned] + scipy.sparse.csr_matrix((np.ones(len(row), np.int16), here), shape=(owned, total))


def sum_on_owners(vector: Any) -> None:
    """Add up what the ranks have at each dof on its owner; ghosts are not updated."""
    vector.scatter_reverse(stack.ADD)


# ---- forms ---------------------------------------------------------------------------------------------


def align_counters() -> None:
    """Let the numbers of UFL's constants and coefficients all have the same count of digits.

    UFL orders operands by text, so a form whose constants straddle 9 and 10 would get another signature, and another
    compilation, than the same form made later in the process.
    """
    for kind in (ufl.constant.Constant, ufl.Coefficient):
        stack.align_counter(kind, 1000)


# cffi's build of a form says what it runs, at level INFO of the root logger.
logging.getLogger().addFilter(lambda record: record.levelno > logging.INFO)


def compile_form(form: Any) -> Any:
    """Compile a UFL form with this project's compiler options."""
    return fem.form(form, **{stack.JIT_KEYWORD: JIT})


def compile_expression(expression: Any, points: NDArray[np.float64]) -> fem.Expression:
    """Compile a UFL expression at reference points with this project's compiler options."""
    return fem.Expression(expression, points, **{stack.JIT_KEYWORD: JIT})


def packed(form: Any) -> tuple[Any, Any, Any]:
    """C++ form, its constants and coefficients."""
    form = _unwrap(form)
    return form, cpp.fem.pack_constants(form), cpp.fem.pack_coefficients(form)


def hold(dofs: NDArray[Any], space: Any) -> Any:
    """Dirichlet condition of zero on dofs of a (sub)space.

    dolfinx tries its own space first, and what it catches then has the numbers of all dofs in its message.
    """
    return fem.dirichletbc(PETSc.ScalarType(0), dofs.astype(np.int32), _unwrap(space))


def held_dofs(bcs: list[Any], space: Any) -> NDArray[np.bool_]:
    """Which local dofs Dirichlet conditions hold, shape (local,)."""
    index_map = space.dofmap.index_map
    out = np.zeros(index_map.size_local + index_map.num_ghosts, dtype=bool)
    for bc in bcs:
        out[_unwrap(bc).dof_indices()[0]] = True
    return out


def insert_diagonal(matrix: PETSc.Mat, bcs: list[Any], space: Any) -> None:
    """Set the diagonal to one on owned dofs that Dirichlet conditions hold, in a matrix in flush state."""
    cpp.fem.petsc.insert_diagonal(matrix, space._cpp_object, [_unwrap(bc) for bc in bcs], 1.0)


def add_by_dolfinx(matrix: PETSc.Mat, form: Any, bcs: list[Any]) -> None:
    """Add a bilinear form as dolfinx does, by which `solvers.assembly.places` is judged."""
    cpp.fem.petsc.assemble_matrix(matrix, *packed(form), [_unwrap(bc) for bc in bcs])


def assemble_array(form: Any, index_map: Any) -> NDArray[np.float64]:
    """Assemble a linear form on the owned dofs; contributions of other ranks are added."""
    vector = la.vector(index_map, 1)
    vector.array[:] = 0.0
    cpp.fem.assemble_vector(vector.array, *packed(form))
    sum_on_owners(vector)
    return np.array(vector.array[: index_map.size_local])


def assemble_scalar(form: Any, comm: MPI.Comm) -> float:
    """Integral over all ranks."""
    return float(comm.allreduce(cpp.fem.assemble_scalar(*packed(form)), op=MPI.SUM))


def dolfinx_version() -> str:
    """Version of dolfinx."""
    return str(dolfinx.__version__)
