"""Sums over the ranks."""

from __future__ import annotations

from mpi4py import MPI

from solvers.discrete.domain import FloatArray


def dot(comm: MPI.Comm, a: FloatArray, b: FloatArray) -> float:
    """Scalar product of vectors of which each rank holds a part."""
    return float(comm.allreduce(float(a @ b), op=MPI.SUM))
