"""Ogden energies as smooth functions of invariants, through a rational form of the fractional power.

``tr C^(alpha/2)`` with principal values x_i is written ``sum_i x_i^m x_i^(-g)`` with integer m and g in [0, 1).
``x^(-g)`` is a Stieltjes function, so ``x^(-g) = c + sum_k w_k / (x + t_k)`` with positive c, w_k, t_k converges
geometrically in the number of poles, and symmetric sums over the eigenvalues are rational in the invariants:
no eigenvalues, no branch and no loss of smoothness where two stretches are equal. With det C = 1

    sum_i x_i^m / (x_i + t) = [p_{m-1} + t (I1 p_m - p_{m+1}) + t^2 p_m] / (1 + t I2 + t^2 I1 + t^3)

where p_m = tr C^m are polynomials in (I1, I2). For g > 1/2 the same is written with 1/x and 1 - g, which has a pole at
0 in place of the constant. For alpha < 0 all this is of C^-1, whose invariants are those of C exchanged.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipj, ellipk

FloatArray = NDArray[np.float64]

# Squared principal stretches on which the fit holds, for either sign of alpha; states beyond are refused. It holds what
# silicones reach, stretches of 8 in uniaxial, equibiaxial (8^-4 across) and pure-shear extension.
FIT_RANGE = (1.0 / 6400.0, 160.0)
# Relative error of stress differences up to those stretches: 2e-10 for Dragon Skin 30, below 2e-8 for |alpha| >= 1,
# about 6e-8 / |alpha| for less.
POLES = 20
PROJECTIONS = 14  # Gauss-Newton steps of the fit; 9 are enough for any exponent


@dataclass(frozen=True)
class PowerTrace:
    """``tr C^(alpha/2)`` for det C = 1 as a function of the first two invariants.

    Attributes
    ----------
    inverse
        True for alpha < 0: the roles of I1 and I2 are exchanged (they are those of C^-1).
    integer
        m in ``alpha/2 = m - g``.
    poles, weights
        t_k >= 0 and w_k > 0; empty for even alpha.
    constant
        c >= 0; 1 for even alpha.
    """

    inverse: bool
    integer: int
    poles: tuple[float, ...]
    weights: tuple[float, ...]
    constant: float


@functools.lru_cache(maxsize=16)
def power_trace(alpha: float, poles: int = POLES) -> PowerTrace:
    """Rational form of ``tr C^(alpha/2)`` for squared stretches within FIT_RANGE.

    Parameters
    ----------
    alpha
        Ogden's exponent, not zero.
    poles
        Number of poles.

    Returns
    -------
    PowerTrace
    """
    half = 0.5 * abs(alpha)
    m = math.ceil(half - 1e-12)
    g = m - half
    if abs(g) < 1e-12:
        return PowerTrace(alpha < 0, m, (), (), 1.0)
    low, high = FIT_RANGE if alpha > 0 else (1.0 / FIT_RANGE[1], 1.0 / FIT_RANGE[0])
    if g <= 0.5:
        t, w, c = _stieltjes_fit(g, low, high, poles)
        return PowerTrace(alpha < 0, m, tuple(t), tuple(w), c)
    # x^(-g) = y y^(g - 1) with y = 1/x, and y / (y + t) = (1/t) / (x + 1/t): a pole at 0 takes the constant's place
    t, w, c = _stieltjes_fit(1.0 - g, 1.0 / high, 1.0 / low, poles - 1)
    return PowerTrace(alpha < 0, m, (0.0, *(1.0 / t)), (c, *(w / t)), 0.0)


def _stieltjes_fit(g: float, low: float, high: float, poles: int) -> tuple[FloatArray, FloatArray, float]:
    """Poles, weights and constant of ``x^(-g)``, 0 < g <= 1/2, on a range that holds 1; exact at x = 1.

    Least squares of the relative error by variable projection in Kaufman's form (BIT 1975, doi 10.1007/BF01932995),
    from the poles that are best for g = 1/2 (Zolotarev's). Only differences of powers are used, so that no digits are
    lost as g goes to 0 and ``x^(-g)`` to a constant.
    """
    x = np.geomspace(low, high, 600)[:, None]
    power = x**g
    target = -np.expm1(g * np.log(x[:, 0]))
    squeeze = 1.0 - low / high
    sn, cn, _, _ = ellipj((2 * np.arange(poles) + 1) / (2 * poles) * ellipk(squeeze), squeeze)
    t = low * (sn / cn) ** 2
    for _ in range(PROJECTIONS):
        basis = (1.0 - x) / ((x + t) * (1.0 + t)) * power  # 1 / (x + t) - 1 / (1 + t), relative to x^(-g)
        size = np.linalg.norm(basis, axis=0)
        q, r = np.linalg.qr(basis / size)
        w = np.linalg.solve(r, q.T @ target) / size
        slope = -w * t * basis * (1.0 / (x + t) + 1.0 / (1.0 + t))  # by ln t
        slope -= q @ (q.T @ slope)
        scale = np.linalg.norm(slope, axis=0)
        step = np.linalg.lstsq(slope / scale, target - q @ (q.T @ target), rcond=1e-12)[0] / scale
        last, t = t, t * np.exp(step * min(1.0, 0.3 / np.abs(step).max()))
    constant = 1.0 - float(np.sum(w / (1.0 + last)))
    if not (w.min() > 0.0 and constant > 0.0):
        raise ArithmeticError(f"the rational form of x^(-{g:g}) has lost its positive weights")
    return last, w, constant


@functools.lru_cache(maxsize=16)
def power_sum_coefficients(m: int) -> FloatArray:
    """Coefficients a[i, j] of ``p_m = tr C^m = sum a_ij I1^i I2^j`` for det C = 1 (Newton's identities).

    Returns
    -------
    ndarray
        Shape (m + 1, m + 1) or larger.
    """
    size = max(m, 2) + 1
    p = [np.zeros((size, size)) for _ in range(max(m, 2) + 1)]
    p[0][0, 0] = 3.0
    p[1][1, 0] = 1.0
    p[2][2, 0], p[2][0, 1] = 1.0, -2.0
    for k in range(3, m + 1):
        p[k][1:, :] += p[k - 1][:-1, :]
        p[k][:, 1:] -= p[k - 2][:, :-1]
        p[k] += p[k - 3]
    return p[m]


def _polynomial(coefficients: FloatArray, first, second, d1: int, d2: int):  # type: ignore[no-untyped-def]
    """Evaluate a derivative of a polynomial in two variables with numpy or UFL operands."""
    total = 0.0
    for i, j in zip(*np.nonzero(coefficients), strict=True):
        if i < d1 or j < d2:
            continue
        factor = float(coefficients[i, j]) * math.perm(int(i), d1) * math.perm(int(j), d2)
        term = factor
        for _ in range(int(i) - d1):
            term = term * first
        for _ in range(int(j) - d2):
            term = term * second
        total = total + term
    return total


DERIVATIVES = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


def trace_derivatives(i1, i2, shape: PowerTrace, constant, poles, weights) -> dict[tuple[int, int], Any]:  # type: ignore[no-untyped-def]
    """Value and derivatives up to second order of the power trace with respect to (I1, I2).

    Parameters
    ----------
    i1, i2
        Invariants of C with det C = 1; numpy arrays or UFL scalars.
    shape
        Gives the integer power and whether the invariants are exchanged.
    constant, poles, weights
        The numbers of the rational form, as floats or as UFL constants (so that a new exponent with the same
        integer part needs no compilation).

    Returns
    -------
    dict
        Keys (a, b) for the a-th derivative in I1 and b-th in I2, a + b <= 2.
    """
    first, second = (i2, i1) if shape.inverse else (i1, i2)
    m = shape.integer
    low, mid, high = (power_sum_coefficients(k) for k in (m - 1, m, m + 1))
    sums = {d: constant * _polynomial(mid, first, second, *d) for d in DERIVATIVES}
    for k in range(len(shape.poles)):
        t = poles[k]
        n = {}
        for d in DERIVATIVES:
            # numerator p_{m-1} + t (I1 p_m - p_{m+1}) + t^2 p_m, differentiated by Leibniz' rule in I1
            product = first * _polynomial(mid, first, second, *d)
            if d[0] > 0:
                product = product + d[0] * _polynomial(mid, first, second, d[0] - 1, d[1])
            n[d] = (
                _polynomial(low, first, second, *d)
                + t * (product - _polynomial(high, first, second, *d))
                + t * t * _polynomial(mid, first, second, *d)
            )
        inv = 1.0 / (1.0 + t * second + t * t * first + t * t * t)
        d1, d2 = t * t, t
        f = n[0, 0] * inv
        f1 = (n[1, 0] - f * d1) * inv
        f2 = (n[0, 1] - f * d2) * inv
        terms = {
            (0, 0): f,
            (1, 0): f1,
            (0, 1): f2,
            (2, 0): (n[2, 0] - 2.0 * f1 * d1) * inv,
            (1, 1): (n[1, 1] - f1 * d2 - f2 * d1) * inv,
            (0, 2): (n[0, 2] - 2.0 * f2 * d2) * inv,
        }
        sums = {d: sums[d] + weights[k] * terms[d] for d in DERIVATIVES}
    if shape.inverse:
        return {(a, b): sums[b, a] for a, b in DERIVATIVES}
    return sums
