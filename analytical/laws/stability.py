"""Up to which stretch a law has positive incremental moduli."""

from __future__ import annotations

import math

import numpy as np

from analytical.arrays import BoolArray, FloatArray
from analytical.laws.errors import MaterialError
from analytical.laws.isotropic import IsotropicLaw


def check_stability(law: IsotropicLaw, stretch_max: float) -> None:
    """Refuse a law that softens in uniaxial, equibiaxial or pure-shear extension up to `stretch_max`.

    The criterion is Hill's (Drucker's, in the form finite element codes apply to hyperelastic fits): an
    increment of Cauchy stress does positive work on every isochoric increment of logarithmic strain,
    d sigma : d ln l > 0. With J = 1 the Cauchy and Kirchhoff stresses are the same and the pressure does no
    work on isochoric increments, so the condition is that the Hessian of W in the log stretches, restricted
    to increments of zero sum, is positive definite. Both directions of that plane are tested in every state,
    not only the one along the path.

    Why this and not monotone nominal stress: nominal stress falls under dead load, and inflation pressure
    falls past a limit point, for sound materials too (a neo-Hooke balloon does), because the loaded
    area or thickness changes. That is a fact about the structure, for the solver to find. The logarithmic
    measure leaves area out. Neo-Hooke and the one-term Ogden law pass at any stretch (moduli 2 mu l^2 and
    k alpha^2 l^alpha), so does Yeoh with non-negative coefficients; Yeoh (36, -3, 0.1) kPa does not, although
    its dW/dI1 is positive everywhere. So the sign of dW/dI1 would not have been enough.

    Parameters
    ----------
    law
        A hyperelastic law.
    stretch_max
        Largest stretch of the range, above 1; tested from 1 to this value in each of the three modes.
        Equibiaxial extension to l covers uniaxial compression to l^-2.

    Raises
    ------
    MaterialError
        Naming the law and the mode that goes first, with its stretch.
    """
    if not (math.isfinite(stretch_max) and stretch_max > 1.0):
        raise MaterialError(f"stretch_max = {stretch_max} must be a finite stretch above 1, such as 4")
    # Steps of 1 % in stretch or less up to 2e4: far finer than a loss of stability in a cubic in I1.
    stretch = np.geomspace(1.0, stretch_max, 1001)
    modes = {
        "uniaxial": (stretch, stretch**-0.5, stretch**-0.5),
        "equibiaxial": (stretch, stretch, stretch**-2.0),
        "pure shear": (stretch, np.ones_like(stretch), 1.0 / stretch),
    }
    first_unstable = {}
    for mode, stretches in modes.items():
        unstable = np.flatnonzero(~_is_positive_on_isochoric(law.log_hessian_mpa(*stretches)))
        if unstable.size:
            first_unstable[mode] = float(stretch[unstable[0]])
    if first_unstable:
        mode = min(first_unstable, key=lambda name: first_unstable[name])
        raise MaterialError(
            f"{law} softens in {mode} extension at stretch {first_unstable[mode]:.3g}: refit it with "
            f"positive incremental moduli up to stretch {stretch_max:g}, or ask only for smaller stretches"
        )


def _is_positive_on_isochoric(hessian_mpa: FloatArray) -> BoolArray:
    """Whether a Hessian in the log stretches is positive definite on increments of zero sum.

    Shape (n, 3, 3), MPa, to (n,). The softest direction is the one eliminated: eliminating a stiff one would
    leave the small modulus to a difference of large numbers (moduli differ by 1e17 for Ogden at stretch 100).
    """
    order = np.argsort(np.diagonal(hessian_mpa, axis1=-2, axis2=-1), axis=-1)
    rows = np.take_along_axis(hessian_mpa, order[:, :, None], axis=1)
    h = np.take_along_axis(rows, order[:, None, :], axis=2)
    m11 = h[:, 1, 1] - 2.0 * h[:, 0, 1] + h[:, 0, 0]
    m22 = h[:, 2, 2] - 2.0 * h[:, 0, 2] + h[:, 0, 0]
    m12 = h[:, 1, 2] - h[:, 0, 1] - h[:, 0, 2] + h[:, 0, 0]
    return np.asarray((m11 > 0.0) & (m22 > 0.0) & (m11 * m22 > m12**2))
