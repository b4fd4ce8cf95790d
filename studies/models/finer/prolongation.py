"""States of a coarse mesh on a finer one, by the shape functions of the cells in which its nodes are found."""

from __future__ import annotations

import numpy as np

from meshes.cells import CellShape
from meshes.solid import FloatArray, SolidMesh
from solvers.state import State
from studies.models.finer.location import locate, place_in


class Prolongation:
    """From one mesh to another of the same body; their cells are of one kind and need not be nested.

    Parameters
    ----------
    coarse, fine
        The meshes.

    Raises
    ------
    MeshError
        If a node of the one lies far from the other.
    """

    def __init__(self, coarse: SolidMesh, fine: SolidMesh) -> None:
        self._coarse, self._fine = coarse, fine
        places = locate(coarse, fine.points)
        self._nodes, self._values = coarse.cells[places.cells], coarse.cell.shape(places.at)[0]
        corners = fine.corners
        self._corners, self._of_corners = corners, places.cells[corners]
        self._linear = linear_shape(coarse.cell, places.at[corners])
        middle = fine.cell.shape(fine.cell.nodes[: fine.cell.corners].mean(axis=0, keepdims=True))[0][0]
        self._parents = locate(coarse, np.einsum("k,cki->ci", middle, fine.points[fine.cells])).cells
        of_cells = fine.points[fine.cells[:, : fine.cell.corners]]
        at = place_in(coarse, of_cells.reshape(-1, fine.dimension), np.repeat(self._parents, fine.cell.corners))[0]
        self._linear_of_cells = linear_shape(coarse.cell, at).reshape(len(fine.cells), fine.cell.corners, -1)

    def __call__(self, state: State) -> State:
        """A state of the coarse mesh as a first guess on the fine one."""
        displacement = np.einsum("nk,nki->ni", self._values, state.displacement_mm[self._nodes])
        if state.pressure_mpa.ndim == 2:  # jumps between cells: a cell takes the values of the one its middle is in
            pressure = np.einsum("ckj,cj->ck", self._linear_of_cells, state.pressure_mpa[self._parents])
        else:
            at = self._coarse.cells[self._of_corners, : self._coarse.cell.corners]
            pressure = np.zeros(len(self._fine.points))
            pressure[self._corners] = np.einsum("nk,nk->n", self._linear, state.pressure_mpa[at])
        return State(displacement, pressure, state.bodies_mm, state.load_mpa)


def linear_shape(cell: CellShape, at: FloatArray) -> FloatArray:
    """Functions of the corners, linear along edges, at places (q, d) of a reference cell, shape (q, corners)."""
    if cell.name in ("triangle", "tetrahedron"):
        return np.column_stack([1.0 - at.sum(axis=1), at])
    ends = np.where(cell.nodes[None, : cell.corners] > 0.5, at[:, None], 1.0 - at[:, None])
    return np.asarray(ends.prod(axis=2))
