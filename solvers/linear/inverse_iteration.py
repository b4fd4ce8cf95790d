"""The mode whose stiffness is closest to zero, by inverse iteration with a factor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from solvers.discrete.domain import FloatArray
from solvers.discrete.sums import dot
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor

ITERATIONS = 30
# The stiffness has settled when it changes by less than this share.
SETTLED = 1e-6


@dataclass(frozen=True)
class SoftMode:
    """A mode, of no particular size.

    Attributes
    ----------
    stiffness_n_per_mm
        Its stiffness.
    dofs, bodies
        On the owned dofs, its pressures included, shape (owned,), and on the bodies, shape (extra,).
    """

    stiffness_n_per_mm: float
    dofs: FloatArray
    bodies: FloatArray


def softest_mode(factor: Factor, start: FloatArray) -> SoftMode:
    """Inverse iteration ``x <- K^-1 D x`` with D = 1 on displacements and bodies, 0 on pressures.

    This is that of the stiffness condensed to displacements that keep the volume of the cells.

    Parameters
    ----------
    factor
        Of the tangent K.
    start
        First vector on the owned dofs, shape (owned,); what it has on those without mass does not matter.

    Returns
    -------
    SoftMode

    Raises
    ------
    StepFailed
        If a solve fails, or no stiffness comes out of it.
    """
    comm, massless = factor.problem.comm, factor.problem.massless
    dofs, bodies = start.copy(), np.zeros(factor.problem.extra)
    stiffness = np.inf
    for _ in range(ITERATIONS):
        dofs[massless] = 0.0
        size = np.sqrt(dot(comm, dofs, dofs) + bodies @ bodies)
        dofs, bodies = dofs / size, bodies / size
        new_dofs, new_bodies = factor.solve(dofs, bodies)
        response = dot(comm, dofs, new_dofs) + float(bodies @ new_bodies)
        if response == 0.0:
            raise StepFailed("the inverse iteration for the critical mode broke down", Cause.LINEAR_SOLVER)
        new = 1.0 / response
        dofs, bodies = new_dofs, new_bodies
        if abs(new - stiffness) <= SETTLED * abs(new):
            break
        stiffness = new
    return SoftMode(new, dofs, bodies)
