"""The tutorial's way to the same equations: automatic differentiation of the plain potential, traction-form load."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_vector
from mpi4py import MPI

from analytical.laws.isotropic import Law, NeoHooke
from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.solid import FACETS
from solvers.assembly.surfaces import SOFT, Surfaces
from solvers.discrete.domain import create_domain
from solvers.discrete.elements import QUADRATURE_DEGREE
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from solvers.problem import Problem

CASES: dict[str, tuple[Law, tuple[float, ...], float]] = {
    "yeoh": (DRAGON_SKIN_10, DRAGON_SKIN_10.c_mpa, 0.020),
    "neo-hooke": (NeoHooke(0.075449), (0.5 * 0.075449,), 0.004),  # below its limit point
}


@pytest.mark.parametrize("name", CASES)
def test_equilibrium_satisfies_independently_written_equations(coarse_meridian, name: str) -> None:
    law, coefficients, pressure = CASES[name]
    mesh = dataclasses.replace(coarse_meridian, regions=np.full_like(coarse_meridian.regions, SOFT))
    domain = create_domain(MPI.COMM_SELF, mesh)
    surfaces = Surfaces(FACETS["cavity"], FACETS["clamped"], held=((FACETS["axis"], 0),))
    problem = Problem(domain, law, 0.0, surfaces)
    path = follow_path(problem, Factor(problem), [pressure], PathSettings())
    assert path.reached

    u, p = ufl.split(problem.state)
    v, _ = ufl.TestFunctions(problem.space)
    r = ufl.SpatialCoordinate(domain.mesh)[0]
    f = ufl.Identity(2) + ufl.grad(u)
    hoop = 1.0 + u[0] / r
    j = ufl.det(f) * hoop
    x = (ufl.inner(f, f) + hoop**2) * j ** (-2.0 / 3.0) - 3.0
    stored = sum(c * x ** (k + 1) for k, c in enumerate(coefficients)) + p * (j - 1.0)
    degree = QUADRATURE_DEGREE["triangle"]  # the same rule: what is compared is the equations, not their integration
    internal = ufl.derivative(stored * 2.0 * ufl.pi * r * ufl.dx(degree=degree), problem.state)
    push = j * ufl.inv(f).T * ufl.FacetNormal(domain.mesh)
    load = pressure * ufl.inner(push, v) * 2.0 * ufl.pi * r * domain.ds(degree=degree)(FACETS["cavity"])
    free = ~problem.constrained_owned
    residual = assemble_vector(fem.form(internal + load)).array[free]
    scale = np.linalg.norm(assemble_vector(fem.form(load)).array[free])
    # Newton stops at 1e-8 of the load; ten times that for the other weighting of the volume equations
    assert np.linalg.norm(residual) <= 1e-7 * scale
