"""Up to which stretch a law has positive incremental moduli.

The criterion is Hill's (Drucker's, in the form finite element codes apply to hyperelastic fits): an increment of Cauchy
stress does positive work on every isochoric increment of logarithmic strain, d sigma : d ln l > 0. With J = 1 the
Cauchy and Kirchhoff stresses are the same and the pressure does no work on isochoric increments, so the condition is
that the Hessian of W in the log stretches, restricted to increments of zero sum, is positive definite. Both directions
of that plane are tested in every state, not only the one along a path.

Why this and not monotone nominal stress: nominal stress falls under dead load, and inflation pressure falls past a
limit point, for sound materials too (a neo-Hooke balloon does), because the loaded area or thickness changes. That is a
fact about the structure, for the solver to find. The logarithmic measure leaves area out. Neo-Hooke and the one-term
Ogden law pass at any stretch (moduli 2 mu l^2 and k alpha^2 l^alpha), so does Yeoh with non-negative coefficients.
Yeoh (36, -3, 0.1) kPa does not, although its dW/dI1 is positive everywhere: that sign would not have been enough.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Hashable, Mapping
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import BoolArray, FloatArray
from analytical.laws.errors import MaterialError
from analytical.laws.isotropic import IsotropicLaw

# Principal stretches of the three usual tests by the largest of them. Equibiaxial extension to l covers uniaxial
# compression to l^-2. For a law of I1 alone equibiaxial extension is the first to go of all states of the same I1.
MODES: Final[Mapping[str, Callable[[FloatArray], tuple[FloatArray, FloatArray, FloatArray]]]] = MappingProxyType(
    {
        "uniaxial": lambda s: (s, s**-0.5, s**-0.5),
        "equibiaxial": lambda s: (s, s, s**-2.0),
        "pure shear": lambda s: (s, np.ones_like(s), 1.0 / s),
    }
)
# Ten times what any elastomer stands.
LARGEST_STRETCH: Final = 100.0


def stable_stretches(law: IsotropicLaw) -> Mapping[str, float]:
    """Stretch at which a law softens in each of MODES; infinite where it does not up to LARGEST_STRETCH.

    Parameters
    ----------
    law
        A hyperelastic law that can be a key: frozen, as all here are.
    """
    assert isinstance(law, Hashable)
    return _stable_stretches(law)


@functools.lru_cache(maxsize=64)
def _stable_stretches(law: Any) -> Mapping[str, float]:
    # Steps of half a percent in stretch: far finer than a loss of stability in a cubic in I1.
    stretch = np.geomspace(1.0, LARGEST_STRETCH, 1001)
    found = {}
    for mode, stretches in MODES.items():
        with np.errstate(over="ignore", invalid="ignore"):
            unstable = np.flatnonzero(~is_stable(law, *stretches(stretch)))
        found[mode] = math.inf
        if unstable.size:
            first = int(unstable[0])
            low, high = float(stretch[max(first - 1, 0)]), float(stretch[first])
            for _ in range(40):
                middle = 0.5 * (low + high)
                stable = bool(is_stable(law, *stretches(np.array([middle])))[0])
                low, high = (middle, high) if stable else (low, middle)
            found[mode] = low
    return MappingProxyType(found)


def check_stability(law: IsotropicLaw, stretch_max: float) -> None:
    """Refuse a law that softens in uniaxial, equibiaxial or pure-shear extension up to `stretch_max`.

    Parameters
    ----------
    law
        A hyperelastic law.
    stretch_max
        Largest stretch of the range, above 1 and at most LARGEST_STRETCH.

    Raises
    ------
    MaterialError
        Naming the law and the mode that goes first, with its stretch.
    """
    if not 1.0 < stretch_max <= LARGEST_STRETCH:
        raise MaterialError(
            f"stretch_max = {stretch_max} must be a stretch above 1 and at most {LARGEST_STRETCH:g}, such as 4"
        )
    limits = stable_stretches(law)
    mode = min(limits, key=lambda name: limits[name])
    if limits[mode] < stretch_max:
        raise MaterialError(
            f"{law} softens in {mode} extension at stretch {limits[mode]:.3g}: refit it with "
            f"positive incremental moduli up to stretch {stretch_max:g}, or use it for smaller stretches only"
        )


def is_stable(law: IsotropicLaw, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> BoolArray:
    """Whether a law's Hessian in the log stretches is positive definite on increments of zero sum.

    The softest direction is the one eliminated: eliminating a stiff one would leave the small modulus to a difference
    of large numbers (moduli differ by 1e17 for Ogden at stretch 100).

    Parameters
    ----------
    law
        A hyperelastic law.
    l1, l2, l3
        Principal stretches with product 1, in any order, shape (n,).

    Returns
    -------
    ndarray
        Shape (n,); True where the moduli are beyond what numbers hold, as exponential laws' soon are.
    """
    hessian_mpa = law.log_hessian_mpa(l1, l2, l3)
    order = np.argsort(np.diagonal(hessian_mpa, axis1=-2, axis2=-1), axis=-1)
    rows = np.take_along_axis(hessian_mpa, order[:, :, None], axis=1)
    h = np.take_along_axis(rows, order[:, None, :], axis=2)
    size = np.abs(h).max(axis=(1, 2), keepdims=True)
    h = h / size  # so that squares of large moduli do not overflow
    m11 = h[:, 1, 1] - 2.0 * h[:, 0, 1] + h[:, 0, 0]
    m22 = h[:, 2, 2] - 2.0 * h[:, 0, 2] + h[:, 0, 0]
    m12 = h[:, 1, 2] - h[:, 0, 1] - h[:, 0, 2] + h[:, 0, 0]
    return np.asarray((m11 > 0.0) & (m22 > 0.0) & (m11 * m22 > m12**2) | ~np.isfinite(size[:, 0, 0]))


def principal_stretches(i1: ArrayLike, i2: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Principal stretches, largest first, of an isochoric state with invariants I1 and I2.

    Their squares solve ``x^3 - I1 x^2 + I2 x - 1 = 0``, by Vieta's cosines; digits of equal ones are lost to 1e-8.

    Parameters
    ----------
    i1, i2
        Traces of C and C^-1 for det C = 1, shape (n,).

    Returns
    -------
    tuple of ndarray
        Each of shape (n,).
    """
    one, two = np.asarray(i1, dtype=float), np.asarray(i2, dtype=float)
    spread = np.sqrt(np.maximum(one**2 - 3.0 * two, 0.0))
    cosine = np.divide(
        2.0 * one**3 - 9.0 * one * two + 27.0, 2.0 * spread**3, out=np.ones_like(one), where=spread > 0.0
    )
    angle = np.arccos(np.clip(cosine, -1.0, 1.0)) / 3.0
    x1 = (one + 2.0 * spread * np.cos(angle)) / 3.0
    x2 = (one + 2.0 * spread * np.cos(angle - 2.0 * math.pi / 3.0)) / 3.0
    return np.sqrt(x1), np.sqrt(x2), 1.0 / np.sqrt(x1 * x2)
