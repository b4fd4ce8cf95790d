"""Large deformations of choice, and the body force and tractions under which each is an equilibrium.

The force is ``-Div P`` and the traction ``P N``, from the law's plain potential: complex steps in the principal
stretches give P, and differences of P its divergence. No form, and no derivative, of the solver is used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from analytical.laws.isotropic import Law

HEIGHT_MM = 1.0
COMPLEX_STEP = 1e-30
DIFFERENCE_MM = 0.01  # sixth order: 1e-11 of the stress, far below the discretisation error
Map = Callable[[np.ndarray], np.ndarray]


# ---- the chosen deformations -----------------------------------------------------------------------------


def _along(z: np.ndarray, strain: float) -> tuple[np.ndarray, np.ndarray]:
    """A stretch along the axis, t(z) and t'(z), that leaves both ends where they are."""
    turn = 2.0 * np.pi / HEIGHT_MM
    return z + strain * np.sin(turn * z) / turn, 1.0 + strain * np.cos(turn * z)


def isochoric_ring(x: np.ndarray) -> np.ndarray:
    """``(r^2, z) -> ((r^2 + a) / t', t)``: the determinant in (r^2, z) is 1; both end planes stay."""
    r, z = x[..., 0], x[..., 1]
    t, slope = _along(z, 0.15)
    return np.stack([r * np.sqrt((1.0 + 0.35 * np.sin(np.pi * z / HEIGHT_MM) / r**2) / slope), t], axis=-1)


def swollen_ring(x: np.ndarray) -> np.ndarray:
    """The same, and then wider by a share that grows with r and z."""
    r, z = np.moveaxis(isochoric_ring(x), -1, 0)
    return np.stack([r * (0.95 + 0.03 * r * z), z], axis=-1)


def isochoric_rod(x: np.ndarray) -> np.ndarray:
    """``(r^2, z) -> (r^2 / t', t)`` and then ``(w, z) -> (w + c w^2 / 2, z / (1 + c w))``: axis and bottom stay."""
    r, z = x[..., 0], x[..., 1]
    t, slope = _along(z, 0.15)
    w = r**2 / slope
    return np.stack([r * np.sqrt((1.0 + 0.2 * w) / slope), t / (1.0 + 0.4 * w)], axis=-1)


def isochoric_quarter(x: np.ndarray) -> np.ndarray:
    """``(x s, y / (s t'), t)`` with s of z: all four planes stay."""
    x, y, z = np.moveaxis(x, -1, 0)
    t, slope = _along(z, 0.02)
    s = 1.0 + 0.1 * np.sin(np.pi * z / HEIGHT_MM)
    return np.stack([x * s, y / (s * slope), t], axis=-1)


def swollen_quarter(x: np.ndarray) -> np.ndarray:
    """The same, and then wider in x by a share that grows with y, narrower in y with z."""
    x, y, z = np.moveaxis(isochoric_quarter(x), -1, 0)
    return np.stack([x * (1.0 + 0.04 * y), y * (1.0 - 0.06 * z), z], axis=-1)


@dataclass(frozen=True)
class Solution:
    """A map, its law and 1/kappa in 1/MPa, under a follower pressure; ``hoop`` and ``follows`` false are controls."""

    place: Map
    law: Law
    inverse_kappa: float
    hoop: bool = True
    follows: bool = True

    @property
    def load_mpa(self) -> float:
        return 0.1 * self.law.initial_shear_modulus_mpa

    def gradient(self, x: np.ndarray) -> np.ndarray:
        """F with components (x, y, z), or (r, z, theta); shape (..., 3, 3)."""
        d = x.shape[-1]
        f = np.zeros((*x.shape[:-1], 3, 3))
        for k in range(d):
            f[..., :d, k] = self.place(x + 1j * COMPLEX_STEP * np.eye(d)[k]).imag / COMPLEX_STEP
        if d == 2:
            r = x[..., 0]
            f[..., 2, 2] = np.divide(self.place(x)[..., 0], r, out=f[..., 0, 0].copy(), where=r > 0.0)
        return f

    def pressure(self, x: np.ndarray) -> np.ndarray:
        """``kappa (J - 1)``, or one of choice; under three times as much the bodies are unstable and lose an order."""
        if self.inverse_kappa > 0.0:
            return (np.linalg.det(self.gradient(x)) - 1.0) / self.inverse_kappa
        wave = np.cos(np.pi * x[..., -1] / HEIGHT_MM) * x[..., 0]
        return self.law.initial_shear_modulus_mpa * (0.1 * wave - 0.1)

    def stress(self, x: np.ndarray) -> np.ndarray:
        """First Piola-Kirchhoff stress of ``W(l_k J^(-1/3)) + p (J - 1) - p^2/(2 kappa)``, shape (..., 3, 3), MPa."""
        left, l, right = np.linalg.svd(self.gradient(x))
        slopes = []
        for k in range(3):
            stepped = l + 1j * COMPLEX_STEP * np.eye(3)[k]
            scaled = stepped * stepped.prod(axis=-1, keepdims=True) ** (-1.0 / 3.0)
            slopes.append(self.law.energy(*np.moveaxis(scaled, -1, 0)).imag / COMPLEX_STEP)
        principal = np.stack(slopes, axis=-1) + (self.pressure(x) * l.prod(axis=-1))[..., None] / l
        return left @ (principal[..., None] * right)

    def body_force(self, x: np.ndarray) -> np.ndarray:
        """``-Div P``, shape (..., d), N/mm^3."""
        d = x.shape[-1]
        out = np.zeros(x.shape)
        for k in range(d):
            for weight, steps in ((45.0, 1), (-9.0, 2), (1.0, 3)):
                away = steps * DIFFERENCE_MM * np.eye(d)[k]
                out -= weight / (60.0 * DIFFERENCE_MM) * (self.stress(x + away) - self.stress(x - away))[..., :d, k]
        if d == 2:
            p = self.stress(x)
            out -= p[..., :2, 0] / x[..., :1]
            if self.hoop:
                out[..., 0] += p[..., 2, 2] / x[..., 0]
        return out

    def traction(self, x: np.ndarray, area: np.ndarray, loaded: np.ndarray) -> np.ndarray:
        """Dead force on pieces ``area`` = N dA of the boundary, beside the pressure on the ``loaded`` ones, N."""
        normal = np.zeros((*area.shape[:-1], 3))
        normal[..., : area.shape[-1]] = area
        f = self.gradient(x)
        pushed = np.linalg.det(f)[..., None, None] * np.linalg.inv(f).swapaxes(-1, -2) if self.follows else np.eye(3)
        acting = self.stress(x) + np.where(loaded[..., None, None], self.load_mpa, 0.0) * pushed
        return np.einsum("...ij,...j->...i", acting, normal)[..., : x.shape[-1]]
