"""The sparse tangent: its pattern and assembly, and the border of rigid bodies' rows and columns.

Rows and columns of bodies come after those of all dofs, on the last rank, in one symmetric matrix with the solid's: one
factorisation serves both, and its inertia counts both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
import scipy.sparse
from numpy.typing import NDArray
from petsc4py import PETSc

from solvers import compat
from solvers.assembly.places import places_in
from solvers.assembly.supports import dofs_of_facets
from solvers.discrete.domain import Domain, FloatArray, IntArray


def new_matrix(space: Any, extra: int, symmetric: bool, patterns: Iterable[scipy.sparse.csr_matrix] = ()) -> PETSc.Mat:
    """Empty matrix on a space and ``extra`` unknowns of bodies.

    Parameters
    ----------
    space
        Its pattern is that of cells sharing dofs.
    extra
        Unknowns of bodies, on the last rank.
    symmetric
        True if what is going to be assembled is.
    patterns
        Further places in this rank's rows.
    """
    comm, index_map = space.mesh.comm, space.dofmap.index_map
    owned, total = index_map.size_local, index_map.size_global
    size = total + extra
    rows = owned + (extra if comm.rank == comm.size - 1 else 0)
    pattern = compat.cell_pattern(space)
    pattern.resize((rows, size))
    for more in patterns:
        pattern = pattern + more
    pattern.sort_indices()
    indptr, indices = (of.astype(PETSc.IntType, copy=False) for of in (pattern.indptr, pattern.indices))
    csr = (indptr, indices, np.zeros(pattern.nnz))
    matrix = PETSc.Mat().createAIJ(size=((rows, size), (rows, size)), csr=csr, comm=comm)
    local = np.arange(owned + index_map.num_ghosts, dtype=np.int32)
    names = np.concatenate([index_map.local_to_global(local), np.arange(total, size)])
    lgmap = PETSc.LGMap().create(names.astype(PETSc.IntType), comm=comm)
    matrix.setLGMap(lgmap, lgmap)
    matrix.setOption(PETSc.Mat.Option.SYMMETRIC, symmetric)
    # What goes in by PETSc is looked up in its row, and nine in ten entries of a facet's are zeros.
    matrix.setOption(PETSc.Mat.Option.IGNORE_ZERO_ENTRIES, True)
    return matrix


def assemble(
    matrix: PETSc.Mat, form: Any, bcs: list[Any], space: Any, additions: Iterable[Callable[[PETSc.Mat], None]] = ()
) -> None:
    """Assemble a compiled bilinear form, and what is added to it, into a matrix of `new_matrix`.

    Rows and columns of dofs that Dirichlet conditions hold are those of the identity.
    """
    matrix.zeroEntries()
    add_form(matrix, form, bcs, space)
    _flush(matrix)
    compat.insert_diagonal(matrix, bcs, space)
    for add_to in additions:
        _flush(matrix)
        add_to(matrix)
    matrix.assemble()


def add_form(matrix: PETSc.Mat, form: Any, bcs: list[Any], space: Any) -> None:
    """Add a compiled bilinear form to an assembled matrix of `new_matrix`, nothing on dofs that conditions hold."""
    places_in(matrix, space).add(matrix, form, compat.held_dofs(bcs, space))


def _flush(matrix: PETSc.Mat) -> None:
    """Values may be added after others were set, and the other way round, with this between."""
    matrix.assemblyBegin(PETSc.Mat.AssemblyType.FLUSH)
    matrix.assemblyEnd(PETSc.Mat.AssemblyType.FLUSH)


def bonded_dofs(domain: Domain, space: Any, components: int, bodies: int) -> list[IntArray]:
    """Owned displacement dofs on the bonded facets of each body, ascending."""
    owned, out = space.dofmap.index_map.size_local, []
    for body in range(bodies):
        facets = domain.facet_tags.indices[domain.facet_bodies == body]
        found = np.concatenate([dofs_of_facets(domain, space, facets, i) for i in range(components)])
        out.append(np.unique(found[found < owned]))
    return out


class Border:
    """Rows, columns and diagonal blocks of bodies.

    Parameters
    ----------
    space
        Of the dofs.
    dofs
        Owned dofs that each body is coupled to.
    motions
        Unknowns of a body.
    """

    def __init__(self, space: Any, dofs: Sequence[IntArray], motions: int) -> None:
        self._comm, self._index_map = space.mesh.comm, space.dofmap.index_map
        self._is_last = self._comm.rank == self._comm.size - 1
        self.dofs, self.motions = tuple(dofs), motions

    def pattern(self) -> scipy.sparse.csr_matrix:
        """Places in this rank's rows; every rank calls."""
        owned, total, first = self._index_map.size_local, self._index_map.size_global, self._index_map.local_range[0]
        extra = len(self.dofs) * self.motions
        dof = np.concatenate([np.repeat(d, self.motions) for d in self.dofs])
        body = np.concatenate([np.tile(self._unknowns(k) - total, len(d)) for k, d in enumerate(self.dofs)])
        rows, columns = [dof], [total + body]
        pairs = self._comm.gather((body, dof + first), root=self._comm.size - 1)
        if pairs is not None:
            own = np.arange(extra)
            rows += [owned + of_body for of_body, _ in pairs] + [owned + np.repeat(own, extra)]
            columns += [of_dof for _, of_dof in pairs] + [total + np.tile(own, extra)]
        row, column = np.concatenate(rows), np.concatenate(columns)
        shape = (owned + (extra if self._is_last else 0), total + extra)
        return scipy.sparse.csr_matrix((np.ones(len(row), np.int8), (row, column)), shape=shape)

    def add(self, matrix: PETSc.Mat, columns: FloatArray, blocks: FloatArray, held: NDArray[np.bool_]) -> None:
        """Add coupling and blocks to a matrix in flush state.

        A held motion is a unit diagonal alone: it stays where it is, and adds no negative pivot.

        Parameters
        ----------
        matrix
            See `new_matrix`; it has the places of `pattern`.
        columns
            Coupling of owned dofs and motions, all bodies added up, shape (owned, motions).
        blocks
            Of each body, shape (bodies, motions, motions).
        held
            Which motions are held, shape (bodies, motions).
        """
        add, first = PETSc.InsertMode.ADD_VALUES, self._index_map.local_range[0]
        for body, dofs in enumerate(self.dofs):
            free = (~held[body]).astype(float)
            here, there = (dofs + first).astype(PETSc.IntType), self._unknowns(body)
            values = columns[dofs] * free
            matrix.setValues(here, there, values, addv=add)
            matrix.setValues(there, here, np.ascontiguousarray(values.T), addv=add)
            if self._is_last:
                matrix.setValues(there, there, blocks[body] * np.outer(free, free) + np.diag(1.0 - free), addv=add)

    def _unknowns(self, body: int) -> NDArray[Any]:
        """Global numbers of a body's unknowns."""
        first = self._index_map.size_global + body * self.motions
        return np.arange(first, first + self.motions, dtype=PETSc.IntType)
