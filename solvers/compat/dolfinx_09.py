"""What dolfinx 0.9 (Debian 13) and later, 0.11 (the wheel) included, call otherwise than 0.5."""

from __future__ import annotations

import itertools
from typing import Any

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem, jit, la
from dolfinx import mesh as dmesh
from mpi4py import MPI
from numpy.typing import NDArray

JIT_KEYWORD = "jit_options"
# See `solvers.compat.known_forms`.
TAKES_PARTS = False
ADD = la.InsertMode.add


def element(family: str, cell: Any, degree: int, shape: tuple[int, ...] = ()) -> Any:
    """UFL element on a UFL cell whose values have a shape."""
    name = cell.cellname() if callable(cell.cellname) else cell.cellname
    return basix.ufl.element(family, name, degree, shape=shape or None)


def mixed_element(parts: list[Any]) -> Any:
    """UFL element of several fields."""
    return basix.ufl.mixed_element(parts)


def sub_elements(element: Any) -> list[Any]:
    """Elements of a mixed one."""
    return list(element.sub_elements)


def tabulate(element: Any, points: NDArray[np.float64]) -> Any:
    """Values of a scalar element's functions, first axis of length 1."""
    return element.tabulate(0, points)


def create_mesh(comm: MPI.Comm, cells: NDArray[np.int64], points: NDArray[np.float64], shape: str) -> dmesh.Mesh:
    """Mesh of quadratic cells without ghosts, which is what it has if no partitioner is named."""
    domain = ufl.Mesh(basix.ufl.element("Lagrange", shape, 2, shape=(points.shape[1],)))
    return dmesh.create_mesh(comm, cells=cells, x=points, e=domain)


def function_space(mesh: dmesh.Mesh, element: Any) -> Any:
    """Function space of a UFL element."""
    return fem.functionspace(mesh, element)


def table(dofmap: Any) -> NDArray[np.int32]:
    """Dofs of the local cells of a geometry's dofmap or a function space's, shape (cells, dofs)."""
    return np.asarray(getattr(dofmap, "list", dofmap))


def align_counter(kind: Any, step: int) -> None:
    """Go on counting objects of a UFL class from the next multiple of a step."""
    reached = 0 if kind._counter is None else next(kind._counter)
    kind._counter = itertools.count(max(100 * step, -(-reached // step) * step))


def evaluate(expression: Any, mesh: dmesh.Mesh, cells: NDArray[np.int32]) -> NDArray[np.float64]:
    """Values of a compiled expression in local cells."""
    return expression.eval(mesh, cells)


def newton_problem(residual: Any, function: Any, bcs: list[Any]) -> Any:
    """The tutorials' nonlinear problem, for `dolfinx.nls.petsc.NewtonSolver`."""
    # 0.10 gave the name to another class, one that solves by SNES
    kind = getattr(fem.petsc, "NewtonSolverNonlinearProblem", None) or fem.petsc.NonlinearProblem
    return kind(residual, function, bcs)


def jit_settings(options: dict[str, Any]) -> dict[str, Any]:
    """Options of the compiler with the defaults and the user's own."""
    return jit.get_options(options)


def kernels(form: Any, inner: Any, kind: Any, place: int) -> list[tuple[int, Any]]:
    """Integrals of a type: what dolfinx knows each by, and FFCx' structure; ``place`` is the type's among FFCx'."""
    ufcx = form.ufcx_form
    every = range(ufcx.form_integral_offsets[place], ufcx.form_integral_offsets[place + 1])
    if not hasattr(inner, "integral_ids"):  # since 0.10 it counts them
        return [(i, ufcx.form_integrals[k]) for i, k in enumerate(every)]
    known = {ufcx.form_integral_ids[k]: ufcx.form_integrals[k] for k in every}
    return [(key, known[key]) for key in inner.integral_ids(kind)] if known else []
