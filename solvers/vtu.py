"""Fields on the deformed body: principal stretch at nodes, VTU files for ParaView."""

from __future__ import annotations

import errno
import io
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from solvers.atomic import taking_place_of, write_atomically
from solvers.compat import CELL_NAMES, lagrange_at_nodes
from solvers.discrete.domain import FloatArray, MeshArrays
from solvers.state import State, pressure_at_corners

# VTK's number of a quadratic cell and its order of the nodes, in basix' numbers.
_VTK = {
    "triangle": (22, [0, 1, 2, 5, 3, 4]),
    "tetrahedron": (24, [0, 1, 2, 3, 9, 6, 8, 7, 5, 4]),
    "quadrilateral": (28, [0, 1, 3, 2, 4, 6, 7, 5, 8]),
    "hexahedron": (
        29,
        [0, 1, 3, 2, 4, 5, 7, 6, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 15, 14, 22, 23, 21, 24, 20, 25, 26],
    ),
}


def _cell_name(mesh: MeshArrays) -> str:
    return CELL_NAMES[mesh.points.shape[1], mesh.cells.shape[1]]


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
    at_nodes = lagrange_at_nodes(_cell_name(mesh), 2)[1:]  # (directions, places, nodes)
    reference, places = at_nodes.transpose(2, 1, 0).reshape(at_nodes.shape[2], -1), at_nodes.shape[1]
    sums, count = np.zeros((3, 3, len(mesh.points))), np.bincount(mesh.cells.ravel(), minlength=len(mesh.points))

    def slopes(vectors: FloatArray) -> FloatArray:
        """Derivatives of nodal vectors (cells, nodes, 3) by the reference coordinates, (cells, places, 3, 3)."""
        found = np.swapaxes(vectors, 1, 2) @ reference
        return found.reshape(len(vectors), 3, places, 3).transpose(0, 2, 1, 3)

    for first in range(0, len(mesh.cells), 20000):  # blocks keep the memory small
        cells = mesh.cells[first : first + 20000]
        gradient = np.eye(3) + slopes(state.displacement_mm[cells]) @ _inverses(slopes(mesh.points[cells]))
        cauchy_green = np.swapaxes(gradient, -1, -2) @ gradient
        for i, j in ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)):  # the lower half is what is read below
            sums[i, j] += np.bincount(cells.ravel(), cauchy_green[..., i, j].ravel(), len(mesh.points))
    return np.sqrt(np.linalg.eigvalsh((sums / count).transpose(2, 0, 1)))


def _inverses(of: FloatArray) -> FloatArray:
    """Inverses of many matrices (…, 3, 3) by cross products of columns, ten times as quick as LAPACK's."""
    first, second, third = (of[..., i] for i in range(3))
    adjugate = np.stack([np.cross(second, third), np.cross(third, first), np.cross(first, second)], axis=-2)
    return adjugate / (first * adjugate[..., 0, :]).sum(-1)[..., None, None]


def pressure_at_nodes(mesh: MeshArrays, state: State) -> FloatArray:
    """Pressure at all nodes, linear between the corners and averaged there where it jumps, shape (nodes,), MPa."""
    linear = lagrange_at_nodes(_cell_name(mesh), 1)[0]
    corners = linear.shape[1]
    at_corners = pressure_at_corners(state, mesh.cells, corners)
    values = at_corners.copy()
    values[mesh.cells] = at_corners[mesh.cells[:, :corners]] @ linear.T
    return values


def vtk_grid(mesh: MeshArrays, state: State) -> Any:
    """The body as a pyvista grid in its reference position.

    Point fields: ``displacement_mm`` (warp by it to see the deformed body), ``stretch_max``,
    ``stretch_min``, ``pressure_kpa`` (the incompressibility pressure p); cell field ``region``.
    """
    import pyvista

    kind, order = _VTK[_cell_name(mesh)]
    grid = pyvista.UnstructuredGrid({kind: mesh.cells[:, order]}, mesh.points)
    stretches = principal_stretches(mesh, state)
    grid.point_data["displacement_mm"] = state.displacement_mm
    grid.point_data["stretch_max"] = stretches[:, 2]
    grid.point_data["stretch_min"] = stretches[:, 0]
    grid.point_data["pressure_kpa"] = 1e3 * pressure_at_nodes(mesh, state)
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
    _save(flat_grid(mesh, shapes), path.with_suffix(".vtu"))


def save_mesh(path: Path, mesh: MeshArrays) -> None:
    """Write a body's or a meridian's cells with their regions as a VTU file."""
    grid = flat_grid(mesh, {})
    grid.cell_data["region"] = mesh.regions
    _save(grid, path)


def flat_grid(mesh: MeshArrays, fields: Mapping[str, FloatArray]) -> Any:
    """A body or a meridian as a pyvista grid with vectors at its nodes; ParaView wants three components of all."""
    import pyvista

    def padded(vectors: FloatArray) -> FloatArray:
        missing = 3 - vectors.shape[1]
        return np.column_stack([vectors, np.zeros((len(vectors), missing))]) if missing else vectors

    kind, order = _VTK[_cell_name(mesh)]
    grid = pyvista.UnstructuredGrid({kind: mesh.cells[:, order]}, padded(mesh.points))
    for name, value in fields.items():
        grid.point_data[name] = padded(value)
    return grid


def write_vtu(path: Path, mesh: MeshArrays, state: State) -> None:
    """Write a body and its fields as a VTU file; see `vtk_grid`."""
    _save(vtk_grid(mesh, state), path)


def _save(grid: Any, path: Path) -> None:
    """Write a grid, all of it or nothing.

    Raises
    ------
    OSError
        Also where VTK does not say so: if the file does not end as it should.
    """
    with taking_place_of(path, ".vtu") as temporary:
        grid.save(temporary)
        with temporary.open("rb") as stream:
            stream.seek(-min(64, temporary.stat().st_size), os.SEEK_END)
            if not stream.read().rstrip().endswith(b"</VTKFile>"):
                raise OSError(errno.EIO, os.strerror(errno.EIO), str(path))
