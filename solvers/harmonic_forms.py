"""Second variation of the potential about an axisymmetric state, in harmonics of the angle.

A perturbation of harmonic m with amplitudes on the meridian, components along (r, z, theta),

    du = (a cos m t, c cos m t, b sin m t),   dp = q cos m t,

has the displacement gradient (r the reference radius)

    [ a,r cos       a,z cos     -(m a + b)/r sin ]
    [ c,r cos       c,z cos     -m c/r sin       ]
    [ b,r sin       b,z sin      (a + m b)/r cos ]

An axisymmetric state has no component that mixes t with the rest, so cosines and sines do not couple and every
integral over the angle is pi (2 pi at m = 0, where b is a twist that stands for itself). Hence per harmonic

    K_m = pi int [ dP(h) : h' + q' cof F : h - q q' / kappa ] r dA  -  P d2g(h, h')  (+ bond and stiff parts)

with the stress increment dP of `solvers.forms`, and with the second variation of the volume on which the load works

    d2g = -1/2 pi int [ v . C(F, h') N + v' . C(F, h) N + x . C(h, h') N ] r ds,   d cof F = C(F, h),

v the transverse parts (a, 0, b), x = (r + u_r, 0, 0). The unknown in place of b is s = a + b: then what a field that is
smooth on the axis must do there is a plain zero: a = s = 0 (m = 0), c = s = 0 (m = 1), all three zero (m > 1).
"""

from __future__ import annotations

from typing import Any

import ufl

from analytical.materials import StiffSolid
from solvers.forms import invariants, soft_stress_increment, stiff_stress_increment
from solvers.kinematics import Kinematics
from solvers.laws import CompiledLaw


def amplitudes(w: Any) -> Any:
    """Amplitudes (a, c, b) along (r, z, theta) from the unknowns (a, c, s)."""
    return ufl.as_vector([w[0], w[1], w[2] - w[0]])


def harmonic_gradient(w: Any, m: Any, r: Any) -> Any:
    """Amplitudes of the displacement gradient of the unknowns (a, c, s), 3 x 3 in (r, z, theta).

    Parameters
    ----------
    w
        Unknowns (a, c, s), mm.
    m
        Wave number, a UFL constant.
    r
        Reference radius, mm.
    """
    a, c, s = w[0], w[1], w[2]
    b = s - a
    return ufl.as_matrix(
        [
            [a.dx(0), a.dx(1), -((m - 1.0) * a + s) / r],
            [c.dx(0), c.dx(1), -m * c / r],
            [b.dx(0), b.dx(1), (m * s - (m - 1.0) * a) / r],
        ]
    )


def mixed_cofactor(f: Any, h: Any) -> Any:
    """Bilinear and symmetric C with ``cof (F + h) = cof F + C(F, h) + C(h, h) / 2``."""
    rows = [[None] * 3 for _ in range(3)]
    for i in range(3):
        for j in range(3):
            a, b, c, d = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
            rows[i][j] = f[a, c] * h[b, d] - f[a, d] * h[b, c] + h[a, c] * f[b, d] - h[a, d] * f[b, c]
    return ufl.as_matrix(rows)


def harmonic_tangent(
    space: Any,
    state: Any,
    kin: Kinematics,
    law: CompiledLaw,
    inverse_kappa: Any,
    stiff: StiffSolid | None,
    measures: dict[str, Any],
    m: Any,
    weight: Any,
) -> Any:
    """Second variation of the stored energy in a harmonic, see this module's heading.

    Parameters
    ----------
    space
        Mixed space of (a, c, s) and q.
    state
        The axisymmetric state (u, p).
    kin, law, inverse_kappa, stiff, measures
        As in `solvers.forms.build_forms`, of the meridian.
    m
        Wave number.
    weight
        Integral over the angle: pi, or 2 pi at m = 0.
    """
    u, p = ufl.split(state)
    test, q = ufl.TestFunctions(space)
    trial, dq = ufl.TrialFunctions(space)
    r = kin.position[0]
    k = invariants(kin.gradient(u))
    h, g = harmonic_gradient(trial, m, r), harmonic_gradient(test, m, r)
    stress = soft_stress_increment(k, p, law, h, dq)
    form = (ufl.inner(stress, g) + q * (ufl.inner(k.cof, h) - inverse_kappa * dq)) * weight * r * measures["soft"]
    if stiff is not None:
        form += ufl.inner(stiff_stress_increment(k, stiff, h), g) * weight * r * measures["stiff"]
    return form


def harmonic_load(space: Any, state: Any, kin: Kinematics, measure: Any, m: Any, weight: Any) -> Any:
    """Second variation of the volume on which a pressure does work, mm^3, see this module's heading.

    Parameters
    ----------
    measure
        Facet measure of the loaded surface.
    space, state, kin, m, weight
        As in `harmonic_tangent`.
    """
    u, _ = ufl.split(state)
    w, dw = ufl.TestFunctions(space)[0], ufl.TrialFunctions(space)[0]
    r = kin.position[0]
    f = ufl.Identity(3) + kin.gradient(u)
    h, g = harmonic_gradient(dw, m, r), harmonic_gradient(w, m, r)

    def across(unknowns: Any) -> Any:
        a = amplitudes(unknowns)
        return ufl.as_vector([a[0], 0.0, a[2]])

    density = (
        ufl.inner(across(w), mixed_cofactor(f, h) * kin.normal)
        + ufl.inner(across(dw), mixed_cofactor(f, g) * kin.normal)
        + ufl.inner(kin.transverse_position(u), mixed_cofactor(h, g) * kin.normal)
    )
    return -0.5 * density * weight * r * measure
