"""Fields on the deformed body: principal stretch at nodes, VTU files for ParaView."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from solvers.domain import FloatArray, IntArray, MeshArrays
from solvers.files import write_atomically
from solvers.state import State

# Reference positions of the ten (six) nodes in basix order, and VTK's order of the same nodes.
_EDGES = {2: ((1, 2), (0, 2), (0, 1)), 3: ((2, 3), (1, 3), (1, 2), (0, 3), (0, 2), (0, 1))}
_VTK_ORDER = {2: [0, 1, 2, 5, 3, 4], 3: [0, 1, 2, 3, 9, 6, 8, 7, 5, 4]}
_VTK_TYPE = {2: 22, 3: 24}  # quadratic triangle, quadratic tetrahedron


def _gradients_at_nodes(dimension: int) -> FloatArray:
    """Reference gradients of the quadratic shape functions at the nodes, shape (nodes, functions, d)."""
    corners = np.vstack([np.zeros(dimension), np.eye(dimension)])
    edges = _EDGES[dimension]
    at = np.vstack([corners, [0.5 * (corners[i] + corners[j]) for i, j in edges]])
    bary = np.column_stack([1.0 - at.sum(axis=1), at])
    slope = np.vstack([-np.ones(dimension), np.eye(dimension)])
    parts = [(4.0 * bary[:, i] - 1.0)[:, None] * slope[i] for i in range(dimension + 1)]
    parts += [4.0 * (bary[:, i][:, None] * slope[j] + bary[:, j][:, None] * slope[i]) for i, j in edges]
    return np.stack(parts, axis=1)


def principal_stretches(mesh: MeshArrays, state: State) -> FloatArray:
    """Principal stretches at the nodes, ascending, averaged over the cells at each node.

    Parameters
    ----------
    mesh
        The body (three-dimensional) the state lives on.
    state
        Displacements in the mesh's node numbering, mm.

    Returns
    -------
    ndarray
        Shape (nodes, 3).
    """
    reference = _gradients_at_nodes(mesh.points.shape[1])
    sums = np.zeros((len(mesh.points), 3, 3))
    count = np.zeros(len(mesh.points))
    for first in range(0, len(mesh.cells), 20000):  # blocks keep the memory small
        cells = mesh.cells[first : first + 20000]
        jacobian = np.einsum("cki,qkj->cqij", mesh.points[cells], reference)
        slope = np.einsum("cki,qkj->cqij", state.displacement_mm[cells], reference)
        gradient = np.eye(3) + slope @ np.linalg.inv(jacobian)
        np.add.at(sums, cells, np.swapaxes(gradient, -1, -2) @ gradient)
        np.add.at(count, cells, 1.0)
    return np.sqrt(np.linalg.eigvalsh(sums / count[:, None, None]))


def pressure_on_all_nodes(cells: IntArray, dimension: int, corner_values: FloatArray) -> FloatArray:
    """Linear pressure field at all nodes, from its values at the corners."""
    values = corner_values.copy()
    for k, (i, j) in enumerate(_EDGES[dimension]):
        values[cells[:, dimension + 1 + k]] = 0.5 * (corner_values[cells[:, i]] + corner_values[cells[:, j]])
    return values


def vtk_grid(mesh: MeshArrays, state: State) -> Any:
    """The body as a pyvista grid in its reference position.

    Point fields: ``displacement_mm`` (warp by it to see the deformed body), ``stretch_max``,
    ``stretch_min``, ``pressure_kpa`` (the incompressibility pressure p); cell field ``region``.
    """
    import pyvista

    dimension = mesh.points.shape[1]
    order = _VTK_ORDER[dimension]
    grid = pyvista.UnstructuredGrid({_VTK_TYPE[dimension]: mesh.cells[:, order]}, mesh.points)
    stretches = principal_stretches(mesh, state)
    grid.point_data["displacement_mm"] = state.displacement_mm
    grid.point_data["stretch_max"] = stretches[:, 2]
    grid.point_data["stretch_min"] = stretches[:, 0]
    grid.point_data["pressure_kpa"] = 1e3 * pressure_on_all_nodes(mesh.cells, dimension, state.pressure_mpa)
    grid.cell_data["region"] = mesh.regions
    return grid


def write_mode(path: Path, mesh: MeshArrays, state: State, mode: State) -> None:
    """Write a critical mode: ``path.npz`` to draw it from, ``path.vtu`` for ParaView.

    Parameters
    ----------
    path
        File name without its ending.
    mesh
        The body or the meridian.
    state, mode
        The state at the crossing, and the mode in it, 1 mm at most.
    """
    import pyvista

    shapes = {"displacement_mm": state.displacement_mm, "mode_mm": mode.displacement_mm}
    buffer = io.BytesIO()
    np.savez(
        buffer,
        points_mm=mesh.points,
        cells=mesh.cells,
        regions=mesh.regions,
        bodies_mm=state.bodies_mm,
        mode_bodies_mm=mode.bodies_mm,
        load_mpa=state.load_mpa,
        **shapes,
    )
    write_atomically(path.with_suffix(".npz"), buffer.getvalue())
    dimension = mesh.points.shape[1]
    flat = {"points": mesh.points, **shapes}
    if dimension == 2:  # ParaView wants three components
        flat = {name: np.column_stack([value, np.zeros(len(value))]) for name, value in flat.items()}
    grid = pyvista.UnstructuredGrid({_VTK_TYPE[dimension]: mesh.cells[:, _VTK_ORDER[dimension]]}, flat.pop("points"))
    for name, value in flat.items():
        grid.point_data[name] = value
    grid.save(path.with_suffix(".vtu"))


def write_vtu(path: Path, mesh: MeshArrays, state: State) -> None:
    """Write a body and its fields as a VTU file; see `vtk_grid`."""
    path.parent.mkdir(parents=True, exist_ok=True)
    vtk_grid(mesh, state).save(path)
