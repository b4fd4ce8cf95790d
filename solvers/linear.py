"""Symmetric indefinite direct solves with MUMPS, checked, with the count of negative pivots."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from solvers.domain import FloatArray
from solvers.errors import StepFailed
from solvers.problem import Problem

# MUMPS controls (users' guide 5.5). 13 = 1: no parallel root, whose negative pivots INFOG(12) would miss; 14: extra
# workspace in percent; 24 = 1: null pivots are detected rather than divided by. The ordering is left to MUMPS: it takes
# PORD, which needs half the flops of AMF on these bodies (docs/decisions.md).
ICNTL = {13: 1, 14: 40, 24: 1}
WORKSPACE_RETRIES = (100, 300)


class Factor:
    """LDL' factorisation of a problem's tangent, kept through all steps so that analysis is done once."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        with problem.timer("pattern"):
            self.matrix = problem.new_matrix()
        self.count = 0
        self.negatives = 0
        self.solver: PETSc.KSP | None = None

    def _new_solver(self, workspace: int) -> PETSc.KSP:
        solver = PETSc.KSP().create(self.problem.comm)
        solver.setOperators(self.matrix)
        solver.setType(PETSc.KSP.Type.PREONLY)
        pc = solver.getPC()
        pc.setType(PETSc.PC.Type.CHOLESKY)
        pc.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        pc.setFactorSetUpSolverType()
        factor = pc.getFactorMatrix()
        for control, value in {**ICNTL, 14: workspace}.items():
            factor.setMumpsIcntl(control, value)
        return solver

    def close(self) -> None:
        """Free the matrix and its factors; PETSc would keep them until its objects are collected."""
        if self.solver is not None:
            self.solver.destroy()
            self.solver = None
        self.matrix.destroy()

    def refresh(self) -> None:
        """Assemble and factor the tangent at the current state.

        Raises
        ------
        StepFailed
            If MUMPS fails for another reason than workspace, or the workspace retries run out.
        """
        self.problem.assemble_tangent(self.matrix)
        with self.problem.timer("factor"):
            for workspace in (ICNTL[14], *WORKSPACE_RETRIES):
                if self.solver is None:
                    self.solver = self._new_solver(workspace)
                self.solver.setOperators(self.matrix)
                self.solver.getPC().setUp()
                factor = self.solver.getPC().getFactorMatrix()
                status, detail = factor.getMumpsInfog(1), factor.getMumpsInfog(2)
                if status not in (-8, -9):
                    break
                self.solver.destroy()
                self.solver = None
        self.count += 1
        if status < 0:
            raise StepFailed(f"MUMPS failed with INFOG(1) = {status}, INFOG(2) = {detail}")
        self.negatives = factor.getMumpsInfog(12)

    @property
    def excess_negatives(self) -> int:
        """Negative eigenvalues beyond one per pressure unknown: 0 means a stable state under pressure control."""
        return int(self.negatives - self.problem.expected_negatives)

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
            right.array[: problem.owned] = on_dofs
            last = problem.comm.size - 1
            if problem.extra and problem.comm.rank == last:
                right.array[problem.owned :] = on_bodies
            self.solver.solve(right, left)
            dofs = left.array[: problem.owned].copy()
            bodies = np.zeros(problem.extra)
            if problem.extra:
                bodies = problem.comm.bcast(left.array[problem.owned :].copy(), root=last)
            finite = bool(np.isfinite(dofs).all() and np.isfinite(bodies).all())
            right.destroy()
            left.destroy()
        if self.solver.getConvergedReason() < 0 or not problem.comm.allreduce(int(finite), op=MPI.MIN):
            raise StepFailed("the linear solve returned a value that is not finite")
        return dofs, bodies
