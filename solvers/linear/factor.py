"""Direct solves with MUMPS, checked, with the count of negative pivots where the tangent is symmetric."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Protocol

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from solvers.assembly.term import Term
from solvers.discrete.domain import FloatArray
from solvers.errors import Cause, StepFailed
from solvers.state import Timer

# MUMPS controls (users' guide 5.5). 13 = 1: no parallel root, whose negative pivots INFOG(12) would miss; 14: extra
# workspace in percent; 24 = 1: null pivots are detected rather than divided by. The ordering is left to MUMPS: it takes
# PORD, which needs half the flops of AMF on these bodies (docs/decisions.md).
ICNTL = {13: 1, 14: 40, 24: 1}
# CNTL(3): a pivot below this share of the scaled matrix is a null one. Those of bodies that float came out at 1e-15 to
# 1e-13, the smallest of a bellows at 1e-8 (docs/decisions.md).
NULL_PIVOT = 1e-13
# What is tried in turn when memory runs out; 22 = 1 keeps the factors on disk (MUMPS_OOC_TMPDIR says where).
LADDER: tuple[dict[int, int], ...] = ({}, {14: 100}, {14: 300}, {22: 1}, {14: 200, 22: 1})
OUT_OF_CORE = 3
# INFOG(1): workspace estimated too small; memory not to be had from the system or not within ICNTL(23).
TOO_LITTLE_WORKSPACE = (-8, -9, -14, -15, -20)
TOO_LITTLE_MEMORY = (-13, -19)

# PETSC_ERR_MEM.
PETSC_OUT_OF_MEMORY = 55


class Factored(Protocol):
    """What has a tangent to factor: a `solvers.problem.Problem`, or a harmonic about its state."""

    timer: Timer
    owned: int
    extra: int

    @property
    def terms(self) -> Sequence[Term]: ...  # noqa: D102
    @property
    def comm(self) -> Any: ...  # noqa: D102
    @property
    def conservative(self) -> bool: ...  # noqa: D102
    @property
    def expected_negatives(self) -> int: ...  # noqa: D102
    @property
    def massless(self) -> Any: ...  # noqa: D102
    def new_matrix(self) -> Any: ...  # noqa: D102
    def assemble_tangent(self, matrix: Any) -> None: ...  # noqa: D102


class Factor:
    """Factorisation of a problem's tangent, LDL' if it is symmetric, else LU; analysis is done once.

    Attributes
    ----------
    count
        Factorisations made.
    negatives
        Negative pivots of the last one, if the tangent is symmetric.
    rung
        How far up LADDER the factorisation had to go for want of memory.
    free_motions
        So many motions may cost nothing, null pivots, which get no share of a solution and are not counted.
    """

    def __init__(self, problem: Factored) -> None:
        self.problem = problem
        with problem.timer("pattern"):
            self.matrix = problem.new_matrix()
        self.count = 0
        self.negatives = 0
        self.rung = 0
        self.free_motions = 0
        self.solver: PETSc.KSP | None = None

    def _new_solver(self) -> PETSc.KSP:
        solver = PETSc.KSP().create(self.problem.comm)
        solver.setOperators(self.matrix)
        solver.setType(PETSc.KSP.Type.PREONLY)
        pc = solver.getPC()
        pc.setType(PETSc.PC.Type.CHOLESKY if self.problem.conservative else PETSc.PC.Type.LU)
        pc.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        pc.setFactorSetUpSolverType()
        factor = pc.getFactorMatrix()
        for control, value in {**ICNTL, **LADDER[self.rung]}.items():
            factor.setMumpsIcntl(control, value)
        factor.setMumpsCntl(3, NULL_PIVOT)
        return solver

    def _drop_solver(self) -> None:
        if self.solver is not None:
            self.solver.destroy()
            self.solver = None

    def close(self) -> None:
        """Free the matrix and its factors; PETSc would keep them until its objects are collected."""
        self._drop_solver()
        self.matrix.destroy()

    def _factorise(self) -> tuple[int, int]:
        """One attempt; MUMPS's INFOG(1) and INFOG(2).

        Raises
        ------
        StepFailed
            If PETSc itself fails, as where it has no memory for its own part.
        """
        try:
            if self.solver is None:
                self.solver = self._new_solver()
            self.solver.setOperators(self.matrix)
            self.solver.getPC().setUp()
        except PETSc.Error as error:
            cause = Cause.OUT_OF_MEMORY if error.ierr == PETSC_OUT_OF_MEMORY else Cause.LINEAR_SOLVER
            raise StepFailed(f"PETSc failed to factor the tangent: {error}", cause) from error
        factor = self.solver.getPC().getFactorMatrix()
        return factor.getMumpsInfog(1), factor.getMumpsInfog(2)

    def refresh(self) -> None:
        """Assemble and factor the tangent at the current state, on disk if the memory does not hold the factors.

        Raises
        ------
        StepFailed
            If MUMPS fails for another reason than memory, or all that can be done about memory is done, or the tangent
            is more singular than `free_motions`: neither its solutions nor its count of negative pivots would mean
            anything. The problem's state is as it was.
        """
        grown = [term.grow() for term in self.problem.terms]
        if any(grown):
            self.close()
            self.matrix = self.problem.new_matrix()
        self.problem.assemble_tangent(self.matrix)
        with self.problem.timer("factor"):
            status, detail = self._factorise()
            while status in TOO_LITTLE_WORKSPACE + TOO_LITTLE_MEMORY and self.rung + 1 < len(LADDER):
                # a larger workspace would not be had either where memory is short
                self.rung = max(self.rung + 1, OUT_OF_CORE if status in TOO_LITTLE_MEMORY else 0)
                self._drop_solver()
                status, detail = self._factorise()
        self.count += 1
        if status < 0:
            self._drop_solver()
            self.rung = 0
            if status in TOO_LITTLE_WORKSPACE + TOO_LITTLE_MEMORY:
                raise StepFailed(
                    f"MUMPS failed with INFOG(1) = {status}, INFOG(2) = {detail}: too little memory for "
                    f"{self.matrix.getSize()[0]} unknowns even with the factors on disk",
                    Cause.OUT_OF_MEMORY,
                )
            raise StepFailed(f"MUMPS failed with INFOG(1) = {status}, INFOG(2) = {detail}", Cause.LINEAR_SOLVER)
        assert self.solver is not None
        factor = self.solver.getPC().getFactorMatrix()
        self.negatives, free = factor.getMumpsInfog(12), factor.getMumpsInfog(28)
        if free > self.free_motions:
            raise StepFailed(f"the tangent is singular: motions that cost nothing: {free}", Cause.LINEAR_SOLVER)

    @property
    def excess_negatives(self) -> int | None:
        """Negative eigenvalues beyond one per pressure unknown: 0 means a stable state under pressure control.

        None if the load is not conservative: an unsymmetric tangent has no inertia.
        """
        if not self.problem.conservative:
            return None
        return int(self.negatives - self.problem.expected_negatives)

    def unstable_modes(self) -> int | None:
        """Unstable modes at held load of the state that was factored last; None if they cannot be counted.

        Every rank calls.
        """
        return self.excess_negatives

    def of_classes(self) -> Iterator[tuple[str, Factor]]:
        """Names and factors of the tangents whose modes together are those of the current state.

        Here it is one, without a name. Each is made when its turn comes, in place of the one before.
        """
        self.refresh()
        yield "", self

    def solve(self, on_dofs: FloatArray, on_bodies: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Solve with the current factor.

        Parameters
        ----------
        on_dofs
            Right-hand side on the owned dofs.
        on_bodies
            Right-hand side on the bodies, the same on every rank.

        Returns
        -------
        tuple of ndarray
            Solution on the owned dofs, and on the bodies (on every rank).

        Raises
        ------
        StepFailed
            If the solution is not finite.
        """
        assert self.solver is not None
        problem = self.problem
        with problem.timer("solve"):
            right, left = self.matrix.createVecs()
            self._join(right, on_dofs, on_bodies)
            self.solver.solve(right, left)
            dofs, bodies, finite = self._split(left)
            right.destroy()
            left.destroy()
        if self.solver.getConvergedReason() < 0 or not finite:
            raise StepFailed("the linear solve returned a value that is not finite", Cause.LINEAR_SOLVER)
        return dofs, bodies

    def _join(self, vector: PETSc.Vec, on_dofs: FloatArray, on_bodies: FloatArray) -> None:
        """Write values on the owned dofs, and on the bodies, which are the last rank's, into a vector."""
        problem = self.problem
        vector.array[: problem.owned] = on_dofs
        if problem.extra and problem.comm.rank == problem.comm.size - 1:
            vector.array[problem.owned :] = on_bodies

    def _split(self, vector: PETSc.Vec) -> tuple[FloatArray, FloatArray, bool]:
        """Values of a vector on the owned dofs, and on the bodies on every rank; True if they are finite on all."""
        problem = self.problem
        dofs, bodies = vector.array[: problem.owned].copy(), np.zeros(problem.extra)
        if problem.extra:
            bodies = problem.comm.bcast(vector.array[problem.owned :].copy(), root=problem.comm.size - 1)
        finite = int(np.isfinite(dofs).all() and np.isfinite(bodies).all())
        return dofs, bodies, bool(problem.comm.allreduce(finite, op=MPI.MIN))
