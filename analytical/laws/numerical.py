"""A law made of its energy alone: every derivative is taken numerically."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.laws.errors import MaterialError, require_positive

# Relative step of the complex-step derivatives: there is no subtraction, so it only has to be so small that
# its square (1e-60) vanishes beside 1.
_COMPLEX_STEP: Final = 1e-30

# Central difference of order 8 of the log gradient: weights of Fornberg, Math. Comp. 51 (1988) 699, table 1,
_DIFFERENCE_WEIGHTS: Final = (4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0)
# and its step. Truncation (alpha h)^8 / 630 for W ~ l^alpha is 1e-15 at alpha = 6 and 1e-10 at alpha = 25;
# round-off is 1e-16 / h = 2e-14.
_LOG_STEP: Final = 5e-3

# Isochoric, three distinct stretches: a law that is not symmetric shows here.
_SYMMETRY_PROBE: Final = (1.25, 0.9, 1.0 / (1.25 * 0.9))


@dataclass(frozen=True)
class EnergyLaw:
    """Any isotropic law, from its energy W(l1, l2, l3) alone; every derivative is taken numerically.

    First derivatives are by complex step, exact to round-off (Squire and Trapp, SIAM Review 40 (1998) 110);
    second ones are central differences of these, of order 8 (relative accuracy about 1e-13).

    Parameters
    ----------
    function
        W in MPa (mJ/mm3) of three arrays of principal stretches; broadcasts, symmetric in its arguments and
        analytic: it is also called with complex arrays, so no abs, float, maximum or real.

    Raises
    ------
    MaterialError
        If the energy is not symmetric, or has no positive shear modulus at rest.
    """

    function: Callable[[ArrayLike, ArrayLike, ArrayLike], ArrayLike]

    def __post_init__(self) -> None:
        energies = [float(self.energy(*order)) for order in itertools.permutations(_SYMMETRY_PROBE)]
        # 1e-12: round-off of a sum in another order, with room for a hundred terms.
        if not np.ptp(energies) <= 1e-12 * np.abs(energies).max():
            raise MaterialError(
                f"energy {self.function} is not symmetric: at permutations of stretches {_SYMMETRY_PROBE} it is "
                f"{min(energies):g} to {max(energies):g} MPa: an isotropic W treats the three alike"
            )
        require_positive(
            f"initial shear modulus of energy {self.function}",
            self.initial_shear_modulus_mpa,
            "W must grow from rest, and keep the imaginary part of complex stretches (no abs, float or real)",
        )

    @property
    def initial_shear_modulus_mpa(self) -> float:
        """Initial shear modulus, MPa: sigma_a - sigma_b = 2 mu (ln la - ln lb) at rest."""
        hessian = self.log_hessian_mpa(1.0, 1.0, 1.0)
        return float(0.5 * (hessian[0, 0] - hessian[0, 1]))

    def energy(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Strain energy density at the principal stretches, MPa (mJ/mm3); arrays broadcast."""
        return np.asarray(self.function(np.asarray(l1), np.asarray(l2), np.asarray(l3)))

    def stress_difference(self, la: ArrayLike, lb: ArrayLike, lc: ArrayLike) -> FloatArray:
        """Cauchy sigma_a - sigma_b = la dW/dla - lb dW/dlb, MPa, in one complex step; arrays broadcast."""
        turn = 1.0 + 1j * _COMPLEX_STEP
        return np.asarray(self.energy(np.asarray(la) * turn, np.asarray(lb) / turn, lc).imag / _COMPLEX_STEP)

    def log_hessian_mpa(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Second derivatives of W with respect to the log stretches, MPa, shape (..., 3, 3)."""
        at = np.stack(np.broadcast_arrays(l1, l2, l3), axis=-1)
        columns = []
        for direction in np.eye(3):
            steps = (np.exp(k * _LOG_STEP * direction) for k in range(1, 5))
            columns.append(
                sum(
                    weight * (self._log_gradient(at * step) - self._log_gradient(at / step))
                    for weight, step in zip(_DIFFERENCE_WEIGHTS, steps, strict=True)
                )
            )
        hessian = np.stack(columns, axis=-1) / _LOG_STEP
        return np.asarray(0.5 * (hessian + np.swapaxes(hessian, -1, -2)))

    def _log_gradient(self, at: FloatArray) -> FloatArray:
        """Derivatives la dW/dla at stretches of shape (..., 3) by complex step, same shape, MPa."""
        turns = 1.0 + 1j * _COMPLEX_STEP * np.eye(3)
        energies = [self.energy(*np.moveaxis(at * turn, -1, 0)) for turn in turns]
        return np.stack([energy.imag for energy in energies], axis=-1) / _COMPLEX_STEP
