"""Iterative solves of the tangent, for bodies whose factors do not fit: GMRES, checked by the true residual.

With displacements and bodies u first and pressures p after them the tangent is

    K = [ A  B' ]      preconditioned by      P = [ A+  B' ]     S+ = -(1/mu + 1/kappa) M
        [ B  -C ]                                 [ 0   S+ ]

A+ is one V-cycle of smoothed aggregation (GAMG) whose near-null space are the rigid motions of the deformed body, the
rings' own unknowns included, and M the mass matrix of the pressures (Silvester and Wathen, SIAM J. Numer. Anal. 31
(1994) 1352, for Stokes flow of constant viscosity; here mu is the initial shear modulus). Pressure rows and columns are
scaled by mu, so that both fields' residuals are forces.

An iterative solve knows no inertia: states come without a count of unstable modes. Whether they are stable has to be
told from a coarser body that is factorised, or from the modes about the axisymmetric state.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import ufl
from mpi4py import MPI
from petsc4py import PETSc

from solvers import compat
from solvers.assembly.tangent import assemble
from solvers.bodies.rigid import EVERY_MOTION
from solvers.discrete.domain import FloatArray
from solvers.errors import Cause, SolverError, StepFailed
from solvers.linear.factor import Factor
from solvers.problem import Problem


@dataclass(frozen=True)
class IterativeSettings:
    """When a linear solve is done and when it is given up.

    Attributes
    ----------
    relative_tolerance
        Of the true residual in each field, relative to the larger of the two fields' right-hand sides.
    max_iterations
        Iterations before the step is given up.
    restart
        Vectors kept by GMRES: its memory.
    threshold
        Of GAMG: weaker couplings are dropped from the graph that is aggregated.
    """

    relative_tolerance: float = 1e-6
    max_iterations: int = 500
    restart: int = 60
    threshold: float = 0.005


class IterativeSolver(Factor):
    """GMRES on a problem's tangent, with the interface of a factorisation.

    Attributes
    ----------
    count
        Preconditioners made.
    iterations
        GMRES iterations of each solve.

    Raises
    ------
    SolverError
        If the problem is not a whole body in 3D with a load that has a potential.
    """

    problem: Problem

    def __init__(self, problem: Problem, settings: IterativeSettings | None = None) -> None:
        whole = problem.bonded is None or problem.bonded.motions == EVERY_MOTION
        if problem.unknowns.dimension != 3 or problem.element.displacement_degree != 2 or not whole:
            raise SolverError(
                "the iterative solver is for whole bodies in 3D with quadratic displacements: meridians and sectors "
                "are small enough to factorise"
            )
        super().__init__(problem)
        self.settings = settings or IterativeSettings()
        self.iterations: list[int] = []
        with problem.timer("pattern"):
            self._number()
            self._mass = self._pressure_mass()
            self._scale = self._scaling()

    @property
    def excess_negatives(self) -> None:
        """An iterative solve knows no inertia: None."""
        return None

    def close(self) -> None:
        """Free matrices and preconditioner."""
        self._drop_solver()
        for thing in (self.matrix, self._mass, self._scale):
            thing.destroy()

    # ---- numbering -------------------------------------------------------------------------------------

    def _number(self) -> None:
        """Index sets: displacements node by node and then bodies, in blocks of three; pressures, cell by cell."""
        problem = self.problem
        first, total = problem.index_map.local_range[0], problem.index_map.size_global
        nodes = problem.u_dofs
        self._nodes = np.flatnonzero((nodes[:, 0] >= 0) & (nodes[:, 0] < problem.owned))
        mine = nodes[self._nodes].ravel() + first
        last = problem.comm.rank == problem.comm.size - 1
        bodies = np.arange(total, total + problem.extra) if last else np.empty(0, dtype=np.int64)
        self._bodies = len(bodies) // 6
        pressures = problem.p_dofs
        if problem.element.pressure == "continuous":
            pressures = pressures[(pressures >= 0) & (pressures < problem.owned)]
        self._pressure_block = 1 if pressures.ndim == 1 else pressures.shape[1]
        self._first = first
        self._displacements = PETSc.IS().createGeneral(
            np.concatenate([mine, bodies]).astype(PETSc.IntType), comm=problem.comm
        )
        self._displacements.setBlockSize(3)
        self._pressures = PETSc.IS().createGeneral((pressures.ravel() + first).astype(PETSc.IntType), comm=problem.comm)

    def _pressure_mass(self) -> PETSc.Mat:
        """``-(1/mu + 1/kappa) M`` on the pressures, scaled as the tangent is."""
        problem = self.problem
        p, q = ufl.TrialFunctions(problem.space)[1], ufl.TestFunctions(problem.space)[1]
        weight, dx = problem.volume_measure
        form = compat.compile_form(-p * q * weight * dx)
        whole = problem.new_matrix()
        assemble(whole, form, [], problem.space)
        mass = whole.createSubMatrix(self._pressures, self._pressures)
        whole.destroy()
        mu = problem.shear_modulus_mpa
        mass.scale(mu**2 * (1.0 / mu + problem.inverse_kappa))
        mass.setBlockSize(self._pressure_block)
        return mass

    def _scaling(self) -> PETSc.Vec:
        """1 on displacements and bodies, mu on pressures."""
        scale = self.matrix.createVecRight()
        scale.set(1.0)
        scale.array[self._pressures.getIndices() - self._first] = self.problem.shear_modulus_mpa
        return scale

    def _rigid_motions(self, like: PETSc.Mat) -> PETSc.NullSpace:
        """The six rigid motions of the body as it is deformed, in the order of the displacement block."""
        problem = self.problem
        x = problem.domain.mesh.geometry.x[self._nodes] + problem.state.x.array[problem.u_dofs[self._nodes]]
        turns = [np.cross(axis, x) for axis in np.eye(3)]
        motions = [np.broadcast_to(axis, x.shape) for axis in np.eye(3)] + turns
        free = ~problem.constrained_owned[problem.u_dofs[self._nodes]]
        vectors = []
        for k, motion in enumerate(motions):
            vector = like.createVecRight()
            of_bodies = self._bodies_in(k) if self._bodies else np.empty(0)
            vector.array[:] = np.concatenate([(motion * free).ravel(), of_bodies])
            vectors.append(vector)
        for i, vector in enumerate(vectors):
            for other in vectors[:i]:
                vector.axpy(-vector.dot(other), other)
            vector.normalize()
        return PETSc.NullSpace().create(vectors=vectors, comm=problem.comm)

    def _bodies_in(self, k: int) -> FloatArray:
        """Body unknowns in rigid motion k: translations, then rotations about x, y, z."""
        bonded = self.problem.bonded
        assert bonded is not None
        out = np.zeros((bonded.count, 6))
        if k < 3:
            out[:, k] = 1.0
        else:
            axis = np.eye(3)[k - 3]
            centres = np.column_stack([np.zeros((bonded.count, 2)), bonded.centres_mm]) + bonded.values[:, :3]
            out[:, :3] = np.cross(axis, centres)
            # rotation increments are in the body's own frame
            out[:, 3:] = bonded.arm_mm * np.einsum("kij,i->kj", bonded.turns(), axis)
        out[bonded.is_held.reshape(out.shape)] = 0.0
        return out.ravel()

    # ---- solves ----------------------------------------------------------------------------------------

    def refresh(self) -> None:
        """Assemble the tangent at the current state and make its preconditioner.

        Raises
        ------
        StepFailed
            If PETSc fails to make it.
        """
        self.problem.assemble_tangent(self.matrix)
        with self.problem.timer("factor"):
            self.matrix.diagonalScale(self._scale, self._scale)
            self._drop_solver()
            try:
                self.solver = self._new_solver()
            except PETSc.Error as error:
                self._drop_solver()
                raise StepFailed(f"the preconditioner could not be made: {error}", Cause.LINEAR_SOLVER) from error
        self.count += 1

    def _new_solver(self) -> PETSc.KSP:
        options = PETSc.Options()
        solver = PETSc.KSP().create(self.problem.comm)
        prefix = "large_"
        solver.setOptionsPrefix(prefix)
        settings = self.settings
        chosen = {
            "fieldsplit_0_ksp_type": "preonly",
            "fieldsplit_0_pc_type": "gamg",
            "fieldsplit_0_pc_gamg_threshold": settings.threshold,
            "fieldsplit_0_pc_gamg_square_graph": 0,
            "fieldsplit_0_mg_levels_ksp_type": "chebyshev",
            "fieldsplit_0_mg_levels_ksp_max_it": 3,
            "fieldsplit_0_mg_levels_pc_type": "jacobi",
            "fieldsplit_1_ksp_type": "preonly",
            "fieldsplit_1_pc_type": "pbjacobi" if self._pressure_block > 1 else "jacobi",
        }
        for name, value in chosen.items():
            options[prefix + name] = value
        solver.setType(PETSc.KSP.Type.GMRES)
        solver.setPCSide(PETSc.PC.Side.RIGHT)  # so that the residual it watches is the true one
        solver.setGMRESRestart(settings.restart)
        solver.setTolerances(rtol=0.3 * settings.relative_tolerance, atol=0.0, max_it=settings.max_iterations)
        solver.setOperators(self.matrix)
        pc = solver.getPC()
        pc.setType(PETSc.PC.Type.FIELDSPLIT)
        pc.setFieldSplitIS(("0", self._displacements), ("1", self._pressures))
        pc.setFieldSplitType(PETSc.PC.CompositeType.SCHUR)
        pc.setFieldSplitSchurFactType(PETSc.PC.SchurFactType.UPPER)
        pc.setFieldSplitSchurPreType(PETSc.PC.SchurPreType.USER, self._mass)
        solver.setFromOptions()
        pc.setUp()
        of_displacements = pc.getFieldSplitSubKSP()[0]
        block = of_displacements.getOperators()[1]
        block.setNearNullSpace(self._rigid_motions(block))
        of_displacements.setUp()  # now: its levels read the options too
        for name in chosen:
            options.delValue(prefix + name)
        return solver

    def solve(self, on_dofs: FloatArray, on_bodies: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Solve with the current tangent.

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
            If the residual, computed anew, is not below the tolerance in both fields.
        """
        assert self.solver is not None
        problem, settings = self.problem, self.settings
        with problem.timer("solve"):
            right, left = self.matrix.createVecs()
            self._join(right, on_dofs, on_bodies)
            right.pointwiseMult(right, self._scale)
            self.solver.solve(right, left)
            self.iterations.append(self.solver.getIterationNumber())
            size = max(self._norms(right))
            residual = right.duplicate()
            self.matrix.mult(left, residual)
            residual.axpy(-1.0, right)
            error = max(self._norms(residual)) / size if size > 0.0 else 0.0
            left.pointwiseMult(left, self._scale)
            dofs, bodies, finite = self._split(left)
            for vector in (right, left, residual):
                vector.destroy()
        if not finite or not error <= settings.relative_tolerance:
            raise StepFailed(
                f"GMRES stopped after {self.iterations[-1]} iterations with a residual of {error:.1e} of the "
                f"right-hand side, not {settings.relative_tolerance:.0e}: allow more iterations, or use the direct "
                "solver",
                Cause.LINEAR_SOLVER,
            )
        return dofs, bodies

    def _norms(self, vector: PETSc.Vec) -> tuple[float, float]:
        """Norms on displacements with bodies, and on pressures."""
        values = vector.array_r
        on_p = self._pressures.getIndices() - self._first
        mine = np.array([values @ values, values[on_p] @ values[on_p]])
        whole, p = self.problem.comm.allreduce(mine, op=MPI.SUM)
        return float(np.sqrt(max(whole - p, 0.0))), float(np.sqrt(p))
