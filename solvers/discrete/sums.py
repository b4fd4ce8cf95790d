"""Sums over the ranks."""

from __future__ import annotations

from mpi4py import MPI

from solvers.discrete.domain import FloatArray

# Values on a rank's owned dofs, and on the bodies, which every rank has.
Joint = tuple[FloatArray, FloatArray]


def dot(comm: MPI.Comm, a: FloatArray, b: FloatArray) -> float:
    """Scalar product of vectors of which each rank holds a part."""
    return float(comm.allreduce(float(a @ b), op=MPI.SUM))


def joint_dot(comm: MPI.Comm, a: Joint, b: Joint) -> float:
    """The same of vectors with parts on bodies."""
    return dot(comm, a[0], b[0]) + float(a[1] @ b[1])
