"""What dolfinx 0.5 (Debian 12) calls otherwise: elements are UFL's own, options of the compiler are parameters."""

from __future__ import annotations

import functools
import importlib.machinery
import importlib.util
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import ffcx
import numpy as np
import ufl
from dolfinx import cpp, fem, jit, la
from dolfinx import mesh as dmesh
from ffcx import element_interface
from mpi4py import MPI
from numpy.typing import NDArray

JIT_KEYWORD = "jit_params"
# See `solvers.compat.known_forms`.
TAKES_PARTS = True
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
    """Function space of a UFL element, which on one process is looked up among compiled ones once."""
    if mesh.comm.size > 1:
        return fem.FunctionSpace(mesh, element)
    functions, dofmap, ffi = _compiled_element(element)
    of_functions = cpp.fem.FiniteElement(ffi.cast("uintptr_t", ffi.addressof(functions)))
    pointer = ffi.cast("uintptr_t", ffi.addressof(dofmap))
    of_dofs = cpp.fem.create_dofmap(mesh.comm, pointer, mesh.topology, of_functions)
    return fem.FunctionSpace(mesh, element, cpp.fem.FunctionSpace(mesh._mesh, of_functions, of_dofs))


@functools.cache
def _compiled_element(element: Any) -> tuple[Any, Any, Any]:
    """FFCx's structures of a UFL element's functions and dofs, and the ``ffi`` that knows their types."""
    (functions, dofmap), module, _ = jit.ffcx_jit(MPI.COMM_SELF, element)
    return functions, dofmap, module.ffi


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


# ---- forms of known parts: see `solvers.compat.known_forms` ------------------------------------------------


def parts_of(
    form: Any, options: dict[str, Any], place: Callable[[Any], tuple[int, str]], tags: Mapping[str, Any]
) -> dict[str, Any]:
    """The module of a UFL form that has been compiled, and the places of what it is made of."""
    _, module, _ = jit.ffcx_jit(form.ufl_domain().ufl_cargo().comm, form, jit_params=options)
    (data,) = form.subdomain_data().values()
    used = [kind for kind, value in data.items() if value is not None]
    assert all(data[kind] is tags[kind] for kind in used), "a form has other tags than the problem"
    return {
        "module": module.__name__,
        "spaces": [place(argument.ufl_function_space()) for argument in form.arguments()],
        "functions": [place(function) for function in form.coefficients()],
        "constants": [place(constant) for constant in form.constants()],
        "tags": used,
    }


def compiler_settings(options: dict[str, Any]) -> str:
    """All options of the compilers, the user's own files of them included."""
    settings = {key: value for key, value in jit_settings(options).items() if key != "cache_dir"}
    return repr((settings, ffcx.get_parameters({})))


def module_of(name: str, options: dict[str, Any]) -> Any:
    """A module of compiled forms in the cache; None if it is not there, or cannot be loaded."""
    file = Path(jit_settings(options)["cache_dir"]) / f"{name}{importlib.machinery.EXTENSION_SUFFIXES[0]}"
    if not file.with_name(f"{name}.c.cached").exists():
        return None
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec is not None and spec.loader is not None
    try:
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    except (ImportError, OSError):
        return None
    return module


def form_of_parts(module: Any, parts: Mapping[str, list[Any]], tags: Mapping[str, Any], mesh: dmesh.Mesh) -> Any:
    """The form of a module, made as `dolfinx.fem.form` does; every rank calls."""
    (form,) = (getattr(module.lib, key) for key in dir(module.lib) if key.startswith("form_"))
    functions = [
        parts["functions"][form.original_coefficient_position[i]]._cpp_object for i in range(form.num_coefficients)
    ]
    kinds = ("cell", "exterior_facet", "interior_facet", "vertex")
    markers = {getattr(fem.IntegralType, kind): tags.get(kind) for kind in kinds}
    spaces, constants = ([part._cpp_object for part in parts[kind]] for kind in ("spaces", "constants"))
    return _Form(form, spaces, functions, constants, markers, mesh._mesh, module.ffi, (None, None))


class _Form(fem.forms.FormMetaClass, cpp.fem.Form_float64):  # type: ignore[misc]
    """What `dolfinx.fem.form` makes in double precision."""
