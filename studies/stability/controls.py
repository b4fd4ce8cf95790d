"""Controls that must fail: the same solver with the energy left whole, or with elements of too many pressures.

Nothing of this is a choice of the solver; it is here to show what its choices are worth.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import ufl
from dolfinx import fem

from analytical.laws.isotropic import Law
from solvers import compat
from solvers.assembly.surfaces import Surfaces
from solvers.discrete.domain import Domain
from solvers.discrete.elements import QUADRATURE_DEGREE, Element
from solvers.discrete.kinematics import kinematics
from solvers.energy.forms import invariants
from solvers.energy.loads import load_forms, load_tangent
from solvers.problem import Problem
from studies.stability.cells import Flaw


@dataclass(frozen=True)
class TooManyPressures(Element):
    """A pair that `solvers.discrete.elements.Element` refuses."""

    def spaces(self, cell: Any, fields: int = 1) -> Any:
        """The mixed UFL element without a check."""
        degree = self.displacement_degree
        displacement = compat.element("Lagrange", cell, degree, (compat.dimension(cell),))
        return compat.mixed_element([displacement, *[compat.element("Lagrange", cell, degree)] * fields])


# On triangles P1/P1, on quadrilaterals Q1/Q1.
EQUAL_ORDER = TooManyPressures("equal order", 1, "continuous")


class RawEnergyProblem(Problem):
    """A problem with the energy ``W(F) + p (J - 1) - p^2 / (2 kappa)``: the law sees F itself, not J^(-1/3) F."""

    def __init__(
        self, domain: Domain, law: Law, inverse_kappa: float, surfaces: Surfaces, element: Element | None = None
    ) -> None:
        super().__init__(domain, law, inverse_kappa, surfaces, element=element)
        degree = QUADRATURE_DEGREE[domain.cell_name]
        kin = kinematics(domain.mesh, domain.axisymmetric)
        u, p = ufl.split(self.state)
        k = invariants(kin.gradient(u))
        second = 0.5 * (k.i1_full * k.i1_full - ufl.inner(k.c, k.c))
        w = self.law.derivatives(k.i1_full, second)[0, 0]
        softness = fem.Constant(domain.mesh, float(inverse_kappa))
        energy = (w + p * (k.j - 1.0) - 0.5 * softness * p * p) * kin.measure * ufl.dx(degree=degree)
        kind, loaded = surfaces.load
        load = load_forms(kind, self.space, self.state, kin, domain.ds(degree=degree)(loaded))
        force = ufl.derivative(energy, self.state, ufl.TestFunction(self.space))
        stiffness = ufl.derivative(force, self.state, ufl.TrialFunction(self.space))
        tangent = load_tangent(stiffness, load, kind, self.conservative, self.space, self.state, self.pressure)
        self._internal, self._tangent = compat.compile_form(force), compat.compile_form(tangent)
        self._energy = compat.compile_form(energy)


def problem_with(
    flaw: Flaw, domain: Domain, law: Law, inverse_kappa: float, surfaces: Surfaces, element: Element | None = None
) -> Problem:
    """A problem, or with a flaw that of a control."""
    if flaw == "raw energy":
        return RawEnergyProblem(domain, law, inverse_kappa, surfaces, element)
    return Problem(domain, law, inverse_kappa, surfaces, element=EQUAL_ORDER if flaw else element)
