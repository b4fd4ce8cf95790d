"""Where the entries of element matrices are in a sparse matrix, found once, and their sums, made there.

PETSc's own insertion looks every entry up in its row, which takes twice the time of the element matrices. Here FFCx'
kernel of each cell is called by a few lines of C (places.c), and its entries are added where they were found to be: an
element of displacements and pressures of degree two at most, whose functions are the same in every cell.

Cells with a dof of another rank are left to PETSc: their rows are stored elsewhere.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from solvers import compat
from solvers.compat.kernels import Integral, integrals
from solvers.compat.native import Values, library

SOURCE = Path(__file__).with_name("places.c")
# Name under which a matrix keeps its places.
_NAME = "places"


def places_in(matrix: PETSc.Mat, space: Any) -> Places:
    """Places of a space's cells in a matrix with all of them; found when first asked for."""
    places = matrix.getAttr(_NAME)
    if places is None:
        places = Places(matrix, space)
        matrix.setAttr(_NAME, places)
    return places


class Places:
    """Places of the cells of a space in an assembled matrix, whose pattern stays as it is.

    Parameters
    ----------
    matrix, space
        The matrix has places for all pairs of dofs that share a cell.
    """

    def __init__(self, matrix: PETSc.Mat, space: Any) -> None:
        module = library(SOURCE)
        self._lib, self._ffi = module.lib, module.ffi
        self._dofs = np.ascontiguousarray(compat.cell_dofs(space), dtype=np.int32)
        self._geometry = np.ascontiguousarray(compat.geometry_dofs(space.mesh), dtype=np.int32)
        self._mesh = space.mesh
        cells, size = self._dofs.shape
        self._is_mine = (self._dofs < space.dofmap.index_map.size_local).all(axis=1)
        starts, columns = matrix.getDiagonalBlock().getRowIJ()
        self._starts = np.asarray(starts, dtype=np.int64)
        self._places = np.zeros((cells, size, size), dtype=np.uint16)
        chosen = np.flatnonzero(self._is_mine).astype(np.int32)
        lost = self._lib.find_places(
            self._cells(),
            self._of("int32_t *", chosen),
            len(chosen),
            self._of("int64_t *", self._starts),
            self._of("int32_t *", np.asarray(columns, dtype=np.int32)),
            self._of("uint16_t *", self._places),
        )
        assert lost == 0, f"{lost} entries of element matrices have no place in the matrix"

    def add(self, matrix: PETSc.Mat, form: Any, held: NDArray[np.bool_]) -> None:
        """Add a compiled bilinear form to the matrix, assembled before; rows and columns of held dofs stay.

        Parameters
        ----------
        matrix, form
            The matrix in question, and a form on the space.
        held
            Which local dofs are, shape (local,).
        """
        parts, constants = integrals(form)
        cells = self._cells()
        cells.held = self._of("uint8_t *", held)
        with Values(matrix.getDiagonalBlock()) as values:
            for part in parts:
                chosen = np.flatnonzero(self._is_mine[part.cells]).astype(np.int32)
                self._lib.add_elements(
                    self._integral(part, constants),
                    cells,
                    self._of("int32_t *", chosen),
                    len(chosen),
                    self._of("int64_t *", self._starts),
                    self._of("uint16_t *", self._places),
                    values,
                )
        matrix.stateIncrease()
        for part in parts:
            chosen = np.flatnonzero(~self._is_mine[part.cells]).astype(np.int32)
            if len(chosen):
                dofs = self._dofs[part.cells[chosen]].astype(PETSc.IntType)
                matrices = np.empty((len(chosen), dofs.shape[1], dofs.shape[1]))
                self._lib.list_elements(
                    self._integral(part, constants),
                    cells,
                    self._of("int32_t *", chosen),
                    len(chosen),
                    self._of("double *", matrices),
                )
                matrix.setValuesLocalRCV(dofs, dofs, matrices, addv=PETSc.InsertMode.ADD_VALUES)

    # ---- for C: pointers into arrays that outlive the call -----------------------------------------------

    def _of(self, kind: str, array: Any) -> Any:
        return self._ffi.from_buffer(f"{kind[:-2]}[]", array)

    def _cells(self) -> Any:
        return self._ffi.new(
            "mesh *",
            {
                "nodes": self._geometry.shape[1],
                "size": self._dofs.shape[1],
                "points": self._of("double *", self._mesh.geometry.x),
                "geometry": self._of("int32_t *", self._geometry),
                "dofs": self._of("int32_t *", self._dofs),
            },
        )

    def _integral(self, part: Integral, constants: NDArray[np.float64]) -> Any:
        return self._ffi.new(
            "integral *",
            {
                "kernel": self._ffi.cast("uintptr_t", part.kernel),
                "cells": self._of("int32_t *", part.cells),
                "facets": self._of("int32_t *", part.facets),
                "coefficients": self._of("double *", part.coefficients),
                "width": part.coefficients.shape[1],
                "constants": self._of("double *", constants),
            },
        )
