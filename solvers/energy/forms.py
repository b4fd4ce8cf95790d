"""Weak forms of the split displacement-pressure formulation.

Potential (docs/decisions.md says why this form):

    Pi(u, p) = int [ W(I1, I2) + p (J - 1) - p^2 / (2 kappa) ] dX  +  int_stiff psi dX
             -  P g(u)          (see solvers.energy.loads)   (+ the bond energy, see solvers.bodies.bond)

with isochoric invariants I1, I2. ``1/kappa = 0`` is allowed. In a body of several materials W and kappa are a part's
own, and p, the mean stress, jumps between parts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import ufl

from analytical.laws.stiff import StiffSolid
from solvers.discrete.kinematics import Kinematics, cofactor
from solvers.energy.laws import CompiledLaw
from solvers.energy.materials import Part


@dataclass(frozen=True)
class Invariants:
    """Kinematic quantities at a state: F, C, cof F, J, F^-T and the isochoric invariants."""

    f: Any
    c: Any
    cof: Any
    j: Any
    f_inv_t: Any
    i1_full: Any
    i1: Any
    i2: Any


def invariants(gradient: Any) -> Invariants:
    """Kinematic quantities for a displacement gradient."""
    f = ufl.Identity(3) + gradient
    cof = cofactor(f)
    j = sum(f[0, k] * cof[0, k] for k in range(3))
    c = f.T * f
    i1_full = ufl.tr(c)
    i2_full = 0.5 * (i1_full * i1_full - ufl.inner(c, c))
    # J^(-2/3) would be complex for J < 0; states with J <= 0 are refused before they are used.
    scale = abs(j) ** (-2.0 / 3.0)
    return Invariants(f, c, cof, j, cof / j, i1_full, scale * i1_full, scale * scale * i2_full)


def soft_stress(k: Invariants, p: Any, law: CompiledLaw) -> Any:
    """First Piola-Kirchhoff stress ``P = W1 dI1/dF + W2 dI2/dF + p cof F``, MPa."""
    w = law.derivatives(k.i1, k.i2)
    stress = w[1, 0] * _d_i1(k) + p * k.cof
    return stress + w[0, 1] * _d_i2(k) if law.uses_second_invariant else stress


def _scale(k: Invariants) -> Any:
    return abs(k.j) ** (-2.0 / 3.0)


def _d_i1(k: Invariants) -> Any:
    return _scale(k) * 2.0 * k.f - (2.0 / 3.0) * k.i1 * k.f_inv_t


def _d_i2(k: Invariants) -> Any:
    return _scale(k) ** 2 * 2.0 * (k.i1_full * k.f - k.f * k.c) - (4.0 / 3.0) * k.i2 * k.f_inv_t


def soft_stress_increment(k: Invariants, p: Any, law: CompiledLaw, h: Any, dp: Any) -> Any:
    """Derivative of `soft_stress` in the direction (grad du, dp) = (h, dp), MPa."""
    w = law.derivatives(k.i1, k.i2)
    s1 = _scale(k)
    a1 = _d_i1(k)
    g = k.f_inv_t
    s = ufl.inner(g, h)  # dJ / J
    turn = g * h.T * g  # -d(F^-T)
    d1 = ufl.inner(a1, h)
    da1 = s1 * 2.0 * h - (4.0 / 3.0) * s1 * s * k.f - (2.0 / 3.0) * d1 * g + (2.0 / 3.0) * k.i1 * turn
    out = w[2, 0] * d1 * a1 + w[1, 0] * da1 + (dp + p * s) * k.cof - p * k.j * turn
    if not law.uses_second_invariant:
        return out
    a2 = _d_i2(k)
    d2 = ufl.inner(a2, h)
    b = k.i1_full * k.f - k.f * k.c
    db = 2.0 * ufl.inner(k.f, h) * k.f + k.i1_full * h - h * k.c - k.f * (h.T * k.f + k.f.T * h)
    da2 = s1**2 * 2.0 * db - (8.0 / 3.0) * s1**2 * s * b - (4.0 / 3.0) * d2 * g + (4.0 / 3.0) * k.i2 * turn
    return out + w[1, 1] * (d2 * a1 + d1 * a2) + w[0, 2] * d2 * a2 + w[0, 1] * da2


@dataclass(frozen=True)
class Forms:
    """Compiled-ready UFL forms of a problem; names say what each assembles to."""

    internal_force: Any
    tangent: Any
    energy: Any


def build_forms(
    space: Any, state: Any, kin: Kinematics, parts: Sequence[Part], stiff: StiffSolid | None, stiff_measure: Any
) -> Forms:
    """Forms of the potential in this module's heading, without the load and the bodies.

    Parameters
    ----------
    space, state
        Mixed space of u and one pressure or more, and the state in it.
    kin, parts
        Kinematics of the mesh and its soft materials.
    stiff, stiff_measure
        Compressible solid on this measure: neo-Hooke ``mu/2 (I1 - 3 - 2 ln J) + lambda/2 (J - 1)^2``.

    Returns
    -------
    Forms
    """
    u, *pressures = ufl.split(state)
    v, *tests = ufl.TestFunctions(space)
    du, *trials = ufl.TrialFunctions(space)
    k = invariants(kin.gradient(u))
    grad_v, grad_du = kin.gradient(v), kin.gradient(du)
    m = kin.measure

    forms = [
        _of_part(part, k, (pressures[part.field], tests[part.field], trials[part.field]), grad_v, grad_du, m)
        for part in parts
    ]
    internal, tangent, energy = (sum(terms[1:], terms[0]) for terms in zip(*forms, strict=True))

    if stiff is not None:
        mu, lam = stiff.mu_mpa, stiff.lame_lambda_mpa
        stored = (0.5 * mu * (k.i1_full - 3.0 - 2.0 * ufl.ln(k.j)) + 0.5 * lam * (k.j - 1.0) ** 2) * m
        dxs = stiff_measure
        stress = mu * (k.f - k.f_inv_t) + lam * (k.j - 1.0) * k.cof
        internal += ufl.inner(stress, grad_v) * m * dxs
        tangent += ufl.inner(stiff_stress_increment(k, stiff, grad_du), grad_v) * m * dxs
        energy += stored * dxs
    return Forms(internal, tangent, energy)


def _of_part(
    part: Part, k: Invariants, pressure: tuple[Any, Any, Any], grad_v: Any, grad_du: Any, m: Any
) -> tuple[Any, Any, Any]:
    """Internal force, tangent and energy of a part; ``pressure`` is p with its test and trial functions."""
    (p, q, dp), law, inverse_kappa, dx = pressure, part.law, part.inverse_kappa, part.measure
    internal = (ufl.inner(soft_stress(k, p, law), grad_v) + q * (k.j - 1.0 - inverse_kappa * p)) * m * dx
    tangent = (
        (
            ufl.inner(soft_stress_increment(k, p, law, grad_du, dp), grad_v)
            + q * (ufl.inner(k.cof, grad_du) - inverse_kappa * dp)
        )
        * m
        * dx
    )
    w = law.derivatives(k.i1, k.i2)[0, 0]
    # p (J - 1) - p^2/(2 kappa) at stationary p is the volumetric energy; zero when incompressible.
    return internal, tangent, (w + 0.5 * inverse_kappa * p * p) * m * dx


def stiff_stress_increment(k: Invariants, stiff: StiffSolid, h: Any) -> Any:
    """Derivative of the stress of a compressible solid (see `build_forms`) in the direction grad du = h, MPa."""
    mu, lam = stiff.mu_mpa, stiff.lame_lambda_mpa
    turn = k.f_inv_t * h.T * k.f_inv_t
    s = ufl.inner(k.cof, h)
    return mu * (h + turn) + lam * ((s + (k.j - 1.0) * s / k.j) * k.cof - (k.j - 1.0) * k.j * turn)
