"""Discretisation error of a state as what a richer pair of spaces on the same mesh changes.

With degrees two higher (`solvers.discrete.elements.ENRICHED`) a smooth error is gone but for a few percent, and three
quarters of that of a singular edge, where displacements go as r^(1/2): it falls as h/p^2. So the difference of a
quantity in the richer equilibrium is its error, with a sign and somewhat too small. Newton starts from the state and
from what the state before it on the path lacked. Cells of degree 4 on r1 have as many unknowns as the usual ones on r2,
and a few factorisations at a requested load take the place of a path. The shape of the cells stays as it is.

Linearised at the state the difference is the dual-weighted residual (`solvers.estimate.dual`). That is enough where the
error of the state is small; at the seats of thin walls under much pressure it is not.
"""

from __future__ import annotations

import numpy as np

from solvers.discrete.sums import Joint
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import SolverError, StepFailed
from solvers.linear.factor import Factor
from solvers.problem import Problem
from solvers.state import State

# An error is asked for in two or three digits: by this tolerance it has five.
ROUGH = NewtonSettings(relative_tolerance=1e-5, counted=False)


class Enriched:
    """Equilibria in the richer space next to given ones.

    Parameters
    ----------
    problem
        The boundary value problem of the states on their mesh, with the richer element.

    Attributes
    ----------
    factor
        Its factorisation.
    """

    def __init__(self, problem: Problem) -> None:
        if problem.element.displacement_degree <= 2:
            raise SolverError(f"{problem.element.name} is no richer than the states: take one of ENRICHED")
        self.problem, self.factor = problem, Factor(problem)
        self._correction: Joint | None = None

    def equilibrium(self, state: State) -> State:
        """The equilibrium under the load of a state that is next to it, with values at the same nodes.

        Parameters
        ----------
        state
            An equilibrium of the usual element; those of a path in their order.

        Raises
        ------
        StepFailed
            If Newton's method does not find it.
        """
        failure = None
        for start in [None] if self._correction is None else [self._correction, None]:
            set_richer(self.problem, state, start)
            try:
                solve_equilibrium(self.problem, self.factor, ROUGH, HeldLoad(state.load_mpa))
            except StepFailed as error:
                failure = error
                continue
            found, richer = unknowns_of(self.problem), self.problem.get_state()
            set_richer(self.problem, state)
            before = unknowns_of(self.problem)
            self._correction = found[0] - before[0], found[1] - before[1]
            set_richer(self.problem, state, self._correction)
            return richer
        self._correction = None
        assert failure is not None
        raise failure


def unknowns_of(problem: Problem) -> Joint:
    """Current values on the owned dofs, and those of the bodies, shape (extra,)."""
    return problem.state.x.array[: problem.owned].copy(), problem.body_values.ravel().copy()


def set_richer(problem: Problem, state: State, correction: Joint | None = None) -> None:
    """Make a state of the usual element, with a correction of the unknowns, the current one of a richer problem."""
    problem.set_state(state)
    if correction is None:
        return
    problem.state.x.array[: problem.owned] += correction[0]
    problem.state.x.scatter_forward()
    if problem.bonded is not None:
        problem.bonded.values[:] += correction[1].reshape(problem.body_values.shape)
        problem.bonded.update(np.zeros(0))
