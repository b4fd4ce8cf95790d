"""Dual-weighted residual estimate of the error of quantities, with a sign, from one factor of a richer tangent.

With R the residual of a richer pair of spaces at a state u_h, K its tangent there and j the derivative of a quantity,
z = K^-1 j solves the dual problem (K is symmetric) and

    J(u) - J(u_h) = -z.R(u_h) - z.R(u_h + e) + O(e^3),    e = -K^-1 R(u_h).

Galerkin's orthogonality makes the first term a product of the errors of u and z. The second is the square of u's own
error, weighted by all of z and not by its error: it falls with the same power of h and is as large on these bodies.
Becker and Rannacher (Acta Numerica 2001, doi 10.1017/S0962492901000010) take half of the dual residual for it, which
needs z at the solution. Both terms are with one factor: two solves and two residuals for all quantities together, one
more solve for each.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from dolfinx import fem

from solvers import compat
from solvers.discrete.domain import FloatArray
from solvers.discrete.sums import Joint, joint_dot
from solvers.estimate.enriched import set_richer
from solvers.linear.factor import Factor
from solvers.problem import Problem
from solvers.state import State


@dataclass(frozen=True)
class Goal:
    """A linear quantity: ``sum(on_nodes * displacement_mm) + sum(on_bodies * bodies_mm)`` of a state.

    Attributes
    ----------
    on_nodes
        Weights of displacements at the caller's nodes, shape (nodes, d).
    on_bodies
        Weights of the bodies' motions, shape (bodies, motions).
    """

    on_nodes: FloatArray
    on_bodies: FloatArray


@dataclass(frozen=True)
class DualEstimate:
    """Error of a quantity in its unit: what is to be added to it.

    Attributes
    ----------
    first, second
        The terms of this module's heading.
    """

    first: float
    second: float

    @property
    def error(self) -> float:
        """Both together."""
        return self.first + self.second


def dual_estimates(problem: Problem, factor: Factor, state: State, goals: Sequence[Goal]) -> list[DualEstimate]:
    """Errors of quantities of a state.

    Parameters
    ----------
    problem, factor
        The boundary value problem with a richer element, whose load is a potential, and its factorisation.
    state
        An equilibrium of the usual element on the same mesh.
    goals
        The quantities.

    Raises
    ------
    StepFailed
        If the tangent is singular.
    """
    assert problem.conservative  # else K would have to be transposed
    set_richer(problem, state)
    factor.refresh()
    duals = [factor.solve(*derivative(problem, goal)) for goal in goals]
    before = residual(problem)
    step = factor.solve(*before)
    set_richer(problem, state, (-step[0], -step[1]))
    after = residual(problem)
    comm = problem.comm
    return [DualEstimate(-joint_dot(comm, z, before), -joint_dot(comm, z, after)) for z in duals]


def derivative(problem: Problem, goal: Goal) -> Joint:
    """Derivative of a quantity by the unknowns, nothing on those that are held."""
    domain, unknowns = problem.domain, problem.unknowns
    nodes = domain.input_node[compat.geometry_dofs(domain.mesh)]
    # each node is read in one of its cells, on each rank that has one
    node, place = np.unique(nodes.ravel(), return_index=True)
    cell, local = np.divmod(place, nodes.shape[1])
    readers = np.zeros(domain.nodes)
    readers[node] = 1.0
    readers = domain.comm.allreduce(readers)
    by_dof = fem.Function(problem.space)
    weights = unknowns.at_nodes[local][:, :, None] * (goal.on_nodes[node] / readers[node, None])[:, None, :]
    np.add.at(by_dof.x.array, unknowns.cell_u_dofs()[cell], weights)
    compat.sum_on_owners(by_dof.x)
    on_dofs = by_dof.x.array[: problem.owned].copy()
    on_dofs[problem.constrained_owned] = 0.0
    return on_dofs, np.where(problem.held_bodies, 0.0, goal.on_bodies.ravel())


def residual(problem: Problem) -> Joint:
    """Internal force less the load at the current state, nothing on what is held."""
    force, on_bodies = problem.internal_force()
    force -= float(problem.pressure.value) * problem.unit_load()[0]
    force[problem.constrained_owned] = 0.0
    on_bodies[problem.held_bodies] = 0.0
    return force, on_bodies


def goal_of(quantity: Callable[[State], float], state: State) -> Goal:
    """A linear function of displacements and bodies as weights: its change with each unknown, one after another."""
    nodes, bodies = np.zeros_like(state.displacement_mm), np.zeros_like(state.bodies_mm)
    zero = State(nodes, state.pressure_mpa, bodies, state.load_mpa)
    start, weights = quantity(zero), []
    for values in (nodes, bodies):
        weight = np.zeros_like(values)
        for place in np.ndindex(values.shape):
            values[place] = 1.0
            weight[place] = quantity(zero) - start
            values[place] = 0.0
        weights.append(weight)
    return Goal(*weights)
