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

with the stress increment dP of `solvers.energy.forms`, and with the second variation of the volume on which the load
works

    d2g = -1/2 pi int [ v . C(F, h') N + v' . C(F, h) N + x . C(h, h') N ] r ds,   d cof F = C(F, h),

v the transverse parts (a, 0, b), x = (r + u_r, 0, 0). The unknown in place of b is s = a + b: then what a field that is
smooth on the axis must do there is a plain zero: c = s = 0 (m = 1), all three zero (m > 1). At m = 0 it is s = b, and
a = b = 0 on the axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl

from analytical.laws.stiff import StiffSolid
from solvers.assembly.surfaces import SOFT, STIFF
from solvers.discrete.domain import FloatArray
from solvers.discrete.kinematics import Kinematics
from solvers.energy.forms import invariants, soft_stress_increment, stiff_stress_increment
from solvers.energy.laws import CompiledLaw, MakeConstant


@dataclass(frozen=True)
class Wave:
    """What distinguishes the harmonics, as UFL constants: all of them share one compilation.

    Attributes
    ----------
    m
        Wave number.
    blend
        k in ``s = k a + b``: 1, or 0 at m = 0.
    weight
        Integral over the angle: pi, or 2 pi at m = 0.
    """

    m: Any
    blend: Any
    weight: Any

    def set(self, waves: int) -> None:
        """Go over to a harmonic."""
        self.m.value, self.blend.value = float(waves), float(waves > 0)
        self.weight.value = math.pi if waves else 2.0 * math.pi

    def amplitudes(self, w: Any) -> Any:
        """Amplitudes (a, c, b) along (r, z, theta) from the unknowns (a, c, s)."""
        return ufl.as_vector([w[0], w[1], w[2] - self.blend * w[0]])

    def gradient(self, w: Any, r: Any) -> Any:
        """Amplitudes of the displacement gradient of the unknowns (a, c, s), 3 x 3; r is the reference radius, mm."""
        a, c, s, m, k = w[0], w[1], w[2], self.m, self.blend
        b = s - k * a
        return ufl.as_matrix(
            [
                [a.dx(0), a.dx(1), -((m - k) * a + s) / r],
                [c.dx(0), c.dx(1), -m * c / r],
                [b.dx(0), b.dx(1), (m * s + (1.0 - m * k) * a) / r],
            ]
        )

    def values(self, unknowns: FloatArray) -> FloatArray:
        """As `amplitudes`, of numbers (n, 3)."""
        a, c, s = unknowns.T
        return np.column_stack([a, c, s - float(self.blend.value) * a])


def new_wave(constant: MakeConstant) -> Wave:
    """Constants, set to m = 0; ``constant`` makes them."""
    wave = Wave(*(constant(0.0) for _ in range(3)))
    wave.set(0)
    return wave


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
    measures: dict[int, Any],
    wave: Wave,
) -> Any:
    """Second variation of the stored energy in a harmonic, see this module's heading.

    Parameters
    ----------
    space
        Mixed space of (a, c, s) and q.
    state
        The axisymmetric state (u, p).
    kin, law, inverse_kappa, stiff
        As in `solvers.energy.forms`, of the meridian.
    measures
        Of the SOFT and the STIFF cells.
    wave
        The harmonic.
    """
    u, p = ufl.split(state)
    test, q = ufl.TestFunctions(space)
    trial, dq = ufl.TrialFunctions(space)
    r = kin.position[0]
    k = invariants(kin.gradient(u))
    h, g = wave.gradient(trial, r), wave.gradient(test, r)
    stress = soft_stress_increment(k, p, law, h, dq)
    form = (ufl.inner(stress, g) + q * (ufl.inner(k.cof, h) - inverse_kappa * dq)) * wave.weight * r * measures[SOFT]
    if stiff is not None:
        form += ufl.inner(stiff_stress_increment(k, stiff, h), g) * wave.weight * r * measures[STIFF]
    return form


def harmonic_load(space: Any, state: Any, kin: Kinematics, measure: Any, wave: Wave) -> Any:
    """Second variation of the volume on which a pressure does work, mm^3, see this module's heading.

    Parameters
    ----------
    measure
        Facet measure of the loaded surface.
    space, state, kin, wave
        As in `harmonic_tangent`.
    """
    u, _ = ufl.split(state)
    w, dw = ufl.TestFunctions(space)[0], ufl.TrialFunctions(space)[0]
    r = kin.position[0]
    f = ufl.Identity(3) + kin.gradient(u)
    h, g = wave.gradient(dw, r), wave.gradient(w, r)

    def across(unknowns: Any) -> Any:
        a = wave.amplitudes(unknowns)
        return ufl.as_vector([a[0], 0.0, a[2]])

    density = (
        ufl.inner(across(w), mixed_cofactor(f, h) * kin.normal)
        + ufl.inner(across(dw), mixed_cofactor(f, g) * kin.normal)
        + ufl.inner(kin.transverse_position(u), mixed_cofactor(h, g) * kin.normal)
    )
    return -0.5 * density * wave.weight * r * measure
