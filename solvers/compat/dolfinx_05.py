"""What dolfinx 0.5 (Debian 12) calls otherwise: elements are UFL's own, options of the compiler are parameters."""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from dolfinx import cpp, fem, jit, la
from dolfinx import mesh as dmesh
from ffcx import element_interface
from mpi4py import MPI
from numpy.typing import NDArray

JIT_KEYWORD = "jit_params"
ADD = la.ScatterMode.add


def element(family: str, cell: Any, degree: int, shape: tuple[int, ...] = ()) -> Any:
    """UFL element on a UFL cell whose values have a shape."""
    if not shape:
        return ufl.FiniteElement(family, cell, degree)
    if len(shape) == 1:
        return ufl.VectorElement(family, cell, degree, dim=shape[0])
    return ufl.TensorElement(family, cell, degree, shape=shape)


def mixed_element(parts: list[Any]) -> Any:
    """UFL element of several fields."""
    return ufl.MixedElement(parts)


def sub_elements(element: Any) -> list[Any]:
    """Elements of a mixed one."""
    return list(element.sub_elements())


def tabulate(element: Any, points: NDArray[np.float64]) -> Any:
    """Values of a scalar element's functions, first axis of length 1."""
    return element_interface.create_element(element).tabulate(0, points)


def create_mesh(comm: MPI.Comm, cells: NDArray[np.int64], points: NDArray[np.float64], shape: str) -> dmesh.Mesh:
    """Mesh of quadratic cells without ghosts.

    The places of the coordinates' nodes are named here: FFCx would name them in the mesh when it compiles a first form
    for it, and later forms would have another signature, and be compiled anew, in a process that finds that one.
    """
    cell = ufl.Cell(shape, geometric_dimension=points.shape[1])
    domain = ufl.Mesh(ufl.VectorElement(ufl.FiniteElement("Lagrange", cell, 2, variant="equispaced")))
    return dmesh.create_mesh(comm, cells, points, domain, dmesh.GhostMode.none, cpp.mesh.create_cell_partitioner())


def function_space(mesh: dmesh.Mesh, element: Any) -> Any:
    """Function space of a UFL element."""
    return fem.FunctionSpace(mesh, element)


def table(dofmap: Any) -> NDArray[np.int32]:
    """Dofs of the local cells of a geometry's dofmap or a function space's, shape (cells, dofs)."""
    if hasattr(dofmap, "list"):
        return dofmap.list.array.reshape(-1, dofmap.dof_layout.num_dofs)
    return dofmap.array.reshape(dofmap.num_nodes, -1)


def align_counter(kind: Any, step: int) -> None:
    """Go on counting objects of a UFL class from the next multiple of a step."""
    kind._globalcount = max(100 * step, -(-kind._globalcount // step) * step)


def evaluate(expression: Any, mesh: dmesh.Mesh, cells: NDArray[np.int32]) -> NDArray[np.float64]:
    """Values of a compiled expression in local cells."""
    return expression.eval(cells)


def newton_problem(residual: Any, function: Any, bcs: list[Any]) -> Any:
    """The tutorials' nonlinear problem, for `dolfinx.nls.petsc.NewtonSolver`."""
    return fem.petsc.NonlinearProblem(residual, function, bcs)


def jit_settings(options: dict[str, Any]) -> dict[str, Any]:
    """Options of the compiler with the defaults and the user's own."""
    return jit.get_parameters(options)


def kernels(form: Any, inner: Any, kind: Any, place: int) -> list[tuple[int, Any]]:
    """Integrals of a type: what dolfinx knows each by, and FFCx' structure; ``place`` is the type's among FFCx'."""
    ufcx = form.ufcx_form
    count = ufcx.num_integrals(place)
    known = {ufcx.integral_ids(place)[i]: ufcx.integrals(place)[i] for i in range(count)}
    return [(key, known[key]) for key in inner.integral_ids(kind)] if count else []
