"""What is held while equilibrium is looked for: the load factor P, the volume of the load, or a plane of states.

Where P is free, with K the tangent, R the residual, f the force of a unit load and g = dV/dw (f = g if the load is
conservative), a = K^-1 R and b = K^-1 f give ``dP = (V* - V + g.a) / (g.b)`` and ``dw = -a + b dP`` from one
factorisation. At the converged state g.b = dV/dP is the compliance of the path. A plane
``c = n.(w - w*) + m (P - P*) = 0`` in the space of states is held in the same way: ``dP = (-c + n.a) / (n.b + m)``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Protocol

from solvers.discrete.domain import FloatArray
from solvers.discrete.sums import Joint, dot, joint_dot
from solvers.errors import Cause, StepFailed
from solvers.problem import Problem

# A product below this share of Cauchy and Schwarz's bound is round-off of the solves.
ROUND_OFF = 1e-10


class Control(Protocol):
    """A condition that makes equilibrium one state of its path."""

    @property
    def frees_load(self) -> bool:
        """True if the load factor is what it turns out to be."""
        ...

    def begin(self, problem: Problem) -> None:
        """Set what is held before the first residual."""
        ...

    def error(self, problem: Problem) -> float:
        """How far the current state is from the condition, as a share."""
        ...

    def load_change(self, problem: Problem, gradient: Joint, step: Joint, toward: Joint) -> float:
        """Change of a free load factor, MPa, after which an increment meets the condition.

        Parameters
        ----------
        problem
            At the last state.
        gradient
            dV/dw.
        step, toward
            Increment of the unknowns at the last load factor, and its growth with the factor.

        Raises
        ------
        StepFailed
            If the condition does not respond to the load factor.
        """
        ...


@dataclass(frozen=True)
class HeldLoad:
    """A load factor, MPa."""

    load_mpa: float
    frees_load: ClassVar[bool] = False

    def begin(self, problem: Problem) -> None:
        """Set it."""
        problem.pressure.value = self.load_mpa

    def error(self, problem: Problem) -> float:
        """None: it is met exactly."""
        return 0.0

    def load_change(self, problem: Problem, gradient: Joint, step: Joint, toward: Joint) -> float:
        """None."""
        return 0.0


@dataclass(frozen=True)
class HeldVolume:
    """A volume of the load, mm^3."""

    volume_mm3: float
    frees_load: ClassVar[bool] = True

    def begin(self, problem: Problem) -> None:
        """Nothing: the first guess need not have it."""

    def error(self, problem: Problem) -> float:
        """Missing volume by the volume."""
        missing = abs(self.volume_mm3 - problem.cavity_volume())
        return missing / max(abs(self.volume_mm3 - problem.volume_start_mm3), problem.volume_unit_mm3)

    def load_change(self, problem: Problem, gradient: Joint, step: Joint, toward: Joint) -> float:
        """See this module's heading."""
        missing = self.volume_mm3 - problem.cavity_volume()
        compliance = joint_dot(problem.comm, gradient, toward)
        if abs(compliance) <= ROUND_OFF * _norm(problem, gradient) * _norm(problem, toward):
            raise StepFailed("the volume does not respond to the load", Cause.NO_RESPONSE)
        return (missing - joint_dot(problem.comm, gradient, step)) / compliance


@dataclass(frozen=True, eq=False)
class HeldPlane:
    """A plane in the space of unknowns and load factor; see `solvers.paths.arc`.

    Attributes
    ----------
    normal
        Its part n on the owned dofs, shape (owned,), 1/mm; zero on constrained ones.
    by_load
        Its part m on the load factor, 1/MPa.
    through, load_mpa
        A point w*, P* of it.
    length
        Distance from the last state, by which the residual of the plane is measured.
    """

    normal: FloatArray
    by_load: float
    through: FloatArray
    load_mpa: float
    length: float
    frees_load: ClassVar[bool] = True

    def begin(self, problem: Problem) -> None:
        """Nothing: the first guess lies in it."""

    def error(self, problem: Problem) -> float:
        """Distance from it by that of the last state."""
        return abs(self._off(problem)) / self.length**2

    def load_change(self, problem: Problem, gradient: Joint, step: Joint, toward: Joint) -> float:
        """See this module's heading; refused if the way that the state goes with the load lies in the plane."""
        response = dot(problem.comm, self.normal, toward[0])
        bound = math.sqrt(dot(problem.comm, self.normal, self.normal)) * _norm(problem, toward) + abs(self.by_load)
        if abs(response + self.by_load) <= ROUND_OFF * bound:
            raise StepFailed("the path runs along the plane of the step")
        return (-self._off(problem) - dot(problem.comm, self.normal, step[0])) / (response + self.by_load)

    def _off(self, problem: Problem) -> float:
        """The left side of its equation at the current state."""
        away = problem.state.x.array[: problem.owned] - self.through
        return dot(problem.comm, self.normal, away) + self.by_load * (float(problem.pressure.value) - self.load_mpa)


def _norm(problem: Problem, a: Joint) -> float:
    return math.sqrt(joint_dot(problem.comm, a, a))
