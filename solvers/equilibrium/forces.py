"""Forces on what holds a body in equilibrium."""

from __future__ import annotations

from mpi4py import MPI

from solvers.discrete.domain import IntArray
from solvers.problem import Problem


def reaction(problem: Problem) -> float:
    """Axial force of the support on the clamped surface, N."""
    return _axial_force(problem, problem.unknowns.supports.clamped_axial)


def end_force(problem: Problem) -> float:
    """Axial force of the body on what acts at its end, N: on what holds a plate or a blocked surface.

    Positive along the axis. For a free plate the opposite of the dead force on it; 0 without any of these.
    """
    blocked, bonded = problem.unknowns.supports.blocked_axial, problem.bonded
    if blocked is not None:
        return -_axial_force(problem, blocked)
    if bonded is None or bonded.plate_axial is None:
        return 0.0
    if bonded.is_held[bonded.plate_axial]:
        return -float(problem.internal_force()[1][bonded.plate_axial])
    return 0.0 - bonded.dead_force_n


def _axial_force(problem: Problem, dofs: IntArray) -> float:
    """Force on held axial dofs, N.

    Uses the traction form of the load: the potential's derivative differs from it on a clamped edge.
    """
    force, _ = problem.internal_force()
    total = force - float(problem.pressure.value) * problem.load.traction()
    return float(problem.comm.allreduce(float(total[dofs].sum()), op=MPI.SUM))
