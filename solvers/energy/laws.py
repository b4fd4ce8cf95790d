"""Stored energies as UFL functions of the isochoric invariants, with derivatives written out.

A law is ``W(I1, I2)`` with ``I1 = J^(-2/3) tr C`` and ``I2 = J^(-4/3) (tr^2 C - tr C^2)/2``. Its numbers are UFL
constants: new values need no compilation. Derivatives by the chain rule compile in seconds where automatic
differentiation of the Ogden form takes about a minute.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, singledispatch
from typing import Any

import numpy as np
import ufl

from analytical.laws.isotropic import Guccione, Law, NeoHooke, Ogden, OgdenSeries, Yeoh
from analytical.laws.of_invariants import ArrudaBoyce, Gent, MooneyRivlin
from solvers.energy.ogden import FIT_RANGE, power_trace, trace_derivatives
from solvers.errors import SolverError

Derivatives = dict[tuple[int, int], Any]
MakeConstant = Callable[[Any], Any]


@dataclass(frozen=True)
class CompiledLaw:
    """A law in UFL, its numbers constants of a mesh.

    Attributes
    ----------
    derivatives
        Function of (I1, I2) giving W and its derivatives, keyed by orders (a, b), a + b <= 2. It is cached, as stress,
        its increment and the energy ask for the same ones and UFL is slow.
    uses_second_invariant
        False if W depends on I1 alone, so that forms can leave I2 out.
    invariant_limits
        Largest (I1, I2) for which the law's numbers hold.
    """

    derivatives: Callable[[Any, Any], Derivatives]
    uses_second_invariant: bool
    invariant_limits: tuple[float, float]


@singledispatch
def compile_law(law: Law, constant: MakeConstant) -> CompiledLaw:
    """Write a material law in UFL; a new law registers what does it (docs/architecture.md).

    Parameters
    ----------
    law
        Neo-Hooke ``W = mu/2 (I1 - 3)``; Yeoh ``W = sum C_i (I1 - 3)^i``, initial shear modulus 2 C1; Ogden
        ``W = prefactor (sum lambda_i^alpha - 3)`` with prefactor 2 mu/alpha^2 (initial shear modulus mu) or
        mu/alpha (initial shear modulus mu alpha/2) by its named convention; Guccione, isotropic,
        ``W = C/2 (exp(b E:E) - 1)``, initial shear modulus b C/2; Mooney-Rivlin, Gent, Arruda-Boyce
        (`analytical.laws.of_invariants`). MPa.
    constant
        Makes a UFL constant of a number or some.

    Returns
    -------
    CompiledLaw

    Raises
    ------
    SolverError
        For a law this solver does not know.
    """
    raise SolverError(f"no finite-element form for the law {type(law).__name__}: register one with compile_law")


def is_written_here(law: Law) -> bool:
    """True of a law of this project that this file writes, so that its source is known."""
    return (
        type(law).__module__.startswith("analytical.laws.") and compile_law.dispatch(type(law)).__module__ == __name__
    )


@compile_law.register
def _(law: NeoHooke, constant: MakeConstant) -> CompiledLaw:
    return _polynomial((0.5 * law.mu_mpa,), constant)


@compile_law.register
def _(law: Yeoh, constant: MakeConstant) -> CompiledLaw:
    return _polynomial(tuple(law.c_mpa), constant)


@compile_law.register
def _(law: ArrudaBoyce, constant: MakeConstant) -> CompiledLaw:
    return _polynomial(law.c_mpa, constant)


@compile_law.register
def _(law: Gent, constant: MakeConstant) -> CompiledLaw:
    """``W = -mu J/2 ln(1 - (I1 - 3)/J)``."""
    mu, limit = constant(law.mu_mpa), constant(law.limit)

    @cache
    def derivatives(i1: Any, i2: Any) -> Derivatives:
        left = 1.0 - (i1 - 3.0) / limit
        w1 = 0.5 * mu / left
        none = {(0, 1): 0.0, (1, 1): 0.0, (0, 2): 0.0}
        return {(0, 0): -0.5 * mu * limit * ufl.ln(left), (1, 0): w1, (2, 0): w1 / (limit * left), **none}

    return CompiledLaw(derivatives, False, (3.0 + law.limit, np.inf))


@compile_law.register
def _(law: MooneyRivlin, constant: MakeConstant) -> CompiledLaw:
    """``W = C10 x + C01 y + C11 x y + C20 x^2 + C02 y^2``, x = I1 - 3, y = I2 - 3; one compilation for any of them."""
    c10, c01, c11, c20, c02 = constant(law.constants_mpa)

    @cache
    def derivatives(i1: Any, i2: Any) -> Derivatives:
        x, y = i1 - 3.0, i2 - 3.0
        return {
            (0, 0): (c10 + c11 * y + c20 * x) * x + (c01 + c02 * y) * y,
            (1, 0): c10 + c11 * y + 2.0 * c20 * x,
            (0, 1): c01 + c11 * x + 2.0 * c02 * y,
            (2, 0): 2.0 * c20,
            (1, 1): c11,
            (0, 2): 2.0 * c02,
        }

    return CompiledLaw(derivatives, True, (np.inf, np.inf))


def _polynomial(coefficients: tuple[float, ...], constant: MakeConstant) -> CompiledLaw:
    c = constant(coefficients)

    @cache
    def derivatives(i1: Any, i2: Any) -> Derivatives:
        x = i1 - 3.0
        w = w1 = w11 = 0.0
        for k in range(len(coefficients), 0, -1):
            w = (w + c[k - 1]) * x
            w1 = w1 * x + k * c[k - 1]
            if k > 1:
                w11 = w11 * x + k * (k - 1) * c[k - 1]
        return {(0, 0): w, (1, 0): w1, (0, 1): 0.0, (2, 0): w11, (1, 1): 0.0, (0, 2): 0.0}

    return CompiledLaw(derivatives, False, (np.inf, np.inf))


@compile_law.register
def _(law: Ogden, constant: MakeConstant) -> CompiledLaw:
    return CompiledLaw(_power(law.alpha, law.prefactor_mpa, constant), True, _POWER_LIMITS)


@compile_law.register
def _(law: OgdenSeries, constant: MakeConstant) -> CompiledLaw:
    terms = [_power(alpha, k, constant) for alpha, k in zip(law.alpha, law.prefactors_mpa, strict=True)]

    @cache
    def derivatives(i1: Any, i2: Any) -> Derivatives:
        every = [term(i1, i2) for term in terms]
        return {key: sum((of[key] for of in every[1:]), every[0][key]) for key in every[0]}

    return CompiledLaw(derivatives, True, _POWER_LIMITS)


# I1 >= each x_i and I2 >= each 1/x_i, so these limits keep all x_i in the fit's range, which is one of x_i also where
# it is 1/x_i that is raised to a power (alpha < 0).
_POWER_LIMITS = (FIT_RANGE[1], 1.0 / FIT_RANGE[0])


def _power(alpha: float, prefactor_mpa: float, constant: MakeConstant) -> Callable[[Any, Any], Derivatives]:
    """``k (sum lambda_i^alpha - 3)`` and its derivatives."""
    shape = power_trace(alpha)
    prefactor, rest = constant(prefactor_mpa), constant(shape.constant)
    poles, weights = constant(shape.poles or (0.0,)), constant(shape.weights or (0.0,))

    @cache
    def derivatives(i1: Any, i2: Any) -> Derivatives:
        d = trace_derivatives(i1, i2, shape, rest, poles, weights)
        return {k: prefactor * ((v - 3.0) if k == (0, 0) else v) for k, v in d.items()}

    return derivatives


@compile_law.register
def _(law: Guccione, constant: MakeConstant) -> CompiledLaw:
    """``W = C/2 (exp(Q) - 1)``, ``Q = b E:E = b/4 (I1^2 - 2 I2 - 2 I1 + 3)``, of the isochoric part of the strain."""
    c, b = constant(law.c_mpa), constant(law.b)

    @cache
    def derivatives(i1: Any, i2: Any) -> Derivatives:
        growth = 0.5 * c * ufl.exp(0.25 * b * (i1 * i1 - 2.0 * i2 - 2.0 * i1 + 3.0))
        by_1, by_2 = 0.5 * b * (i1 - 1.0), -0.5 * b
        return {
            (0, 0): growth - 0.5 * c,
            (1, 0): growth * by_1,
            (0, 1): growth * by_2,
            (2, 0): growth * (by_1 * by_1 + 0.5 * b),
            (1, 1): growth * by_1 * by_2,
            (0, 2): growth * by_2 * by_2,
        }

    return CompiledLaw(derivatives, True, (np.inf, np.inf))
