"""Single sets of dimensions brought to their smallest worst error."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Final

import numpy as np
from scipy.optimize import minimize

from analytical.arrays import FloatArray
from analytical.bellows.fit.members import CORRECTED_CHAIN, WALLS_MM, Chain, Members, errors_of
from analytical.bellows.paper import PRINTED, PRINTED_ROOT_RADIUS_MM

# A fold shallower than this is a tube; the continuous fit stops there.
LEAST_FOLD_MM: Final = 0.1
# Of difference quotients; the chain is solved to round-off, so 1e-10 of the error is left.
_STEP_MM: Final = 1e-6


def refine(members: Members, chain: Chain = CORRECTED_CHAIN) -> Members:
    """The best continuous R_p, second R_i and e for every silicones, order and n among the members.

    Minimises the worst of the four errors, as an upper bound on all of them (sequential quadratic programming),
    from the best member of each choice; kept only if it is better.

    Returns
    -------
    Members
        One per choice, best first; none of none.
    """
    if not len(members):
        return members
    choice = np.column_stack([members.silicone, members.order, members.convolutions])
    by_error = np.argsort(members.worst_error, kind="stable")
    _, first = np.unique(choice[by_error], axis=0, return_index=True)
    starts = members.take(by_error[first])
    every = Members.joined(_refined(starts.take(np.array([i])), chain) for i in range(len(starts)))
    return every.take(np.argsort(every.worst_error, kind="stable"))


def _refined(start: Members, chain: Chain) -> Members:
    """One member brought to its smallest worst error; the start where that fails."""

    def at(x: FloatArray) -> Members:
        """Members at points (k, 3): second R_i, depth of its fold, e."""
        many = start.take(np.zeros(len(x), dtype=int))
        root, depth, pitch = x.T
        moved = replace(many, crest_radius_mm=root + depth, larger_root_radius_mm=root, half_pitch_mm=pitch)
        return replace(moved, error=errors_of(moved, chain))

    def bounds_less_errors(x: FloatArray) -> FloatArray:
        error = at(x[None, :3]).error[0]
        return np.concatenate([x[3] - error, x[3] + error])

    def slopes(x: FloatArray) -> FloatArray:
        error = at(x[:3] + _STEP_MM * np.vstack([np.zeros(3), np.eye(3)])).error
        slope = (error[1:] - error[0]).T / _STEP_MM
        return np.hstack([np.vstack([-slope, slope]), np.ones((2 * len(PRINTED), 1))])

    root, pitch = start.larger_root_radius_mm[0], start.half_pitch_mm[0]
    lengths = np.array([root, start.crest_radius_mm[0] - root, pitch])
    # SLSQP keeps to bounds at every step, so nothing is evaluated that is no bellows.
    least = (PRINTED_ROOT_RADIUS_MM, LEAST_FOLD_MM, WALLS_MM.max())
    bounds = [(max(value - 1.0, low), value + 1.0) for value, low in zip(lengths, least, strict=True)]
    with warnings.catch_warnings():
        # a step's round-off beyond a bound, which scipy clips
        warnings.filterwarnings("ignore", "Values in x were outside bounds", RuntimeWarning)
        answer = minimize(
            lambda x: x[3],
            [*lengths, start.worst_error[0]],
            jac=lambda x: np.array([0.0, 0.0, 0.0, 1.0]),
            method="SLSQP",
            bounds=[*bounds, (0.0, 1.0)],
            constraints={"type": "ineq", "fun": bounds_less_errors, "jac": slopes},
            options={"maxiter": 60, "ftol": 1e-8},
        )
    found = at(answer.x[None, :3])
    return found if found.worst_error[0] < start.worst_error[0] else start
