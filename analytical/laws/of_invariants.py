"""Isotropic incompressible stored energies W(I1, I2) of the invariants of C: Mooney-Rivlin, Gent, Arruda-Boyce.

Stretches are dimensionless, stresses, moduli and energy densities are in MPa; det C = 1. With a, b, c the squared
stretches

    I1 = a + b + c,  I2 = 1/a + 1/b + 1/c,  dI1/dln(l_a) = 2 a,  dI2/dln(l_a) = -2/a,

    sigma_a - sigma_b = 2 W1 (a - b) + 2 W2 (1/b - 1/a).

Initial shear moduli: 2 (W1 + W2) at rest, that is Mooney-Rivlin 2 (C10 + C01), Gent mu, Arruda-Boyce
mu (1 + 3/(5 L^2) + 99/(175 L^4) + 513/(875 L^6) + 42039/(67375 L^8)) with its stretch limit L.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.laws.errors import MaterialError, require_finite, require_positive

# W and its derivatives W1, W2, W11, W12, W22 by the invariants, MPa.
Derivatives = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]
# Numbers of constants of Mooney-Rivlin laws: C10, C01; C11; C20, C02.
MOONEY_RIVLIN_CONSTANTS: Final = (2, 3, 5)
# Factors of (I1^i - 3^i) / L^(2 i - 2) in the series of the inverse Langevin function, i = 1 to 5: Arruda and Boyce,
# J. Mech. Phys. Solids 41 (1993) 389, doi 10.1016/0022-5096(93)90013-6, equation (11).
ARRUDA_BOYCE_SERIES: Final = (1.0 / 2.0, 1.0 / 20.0, 11.0 / 1050.0, 19.0 / 7000.0, 519.0 / 673750.0)


class InvariantLaw(ABC):
    """What a law of the invariants is to those who ask by stretches; its class has `derivatives`."""

    @abstractmethod
    def derivatives(self, i1: FloatArray, i2: FloatArray) -> Derivatives:
        """W and its derivatives at invariants of one shape, MPa."""

    @property
    def initial_shear_modulus_mpa(self) -> float:
        """Initial shear modulus, MPa: 2 (W1 + W2) at rest."""
        _, w1, w2, *_ = self.derivatives(np.array(3.0), np.array(3.0))
        return float(2.0 * (w1 + w2))

    def energy(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Strain energy density at the principal stretches, MPa (mJ/mm3); arrays broadcast."""
        return self.derivatives(*_invariants(_squares(l1, l2, l3)))[0]

    def stress_difference(self, la: ArrayLike, lb: ArrayLike, lc: ArrayLike) -> FloatArray:
        """Cauchy sigma_a - sigma_b = 2 W1 (a - b) + 2 W2 (1/b - 1/a), MPa; arrays broadcast."""
        squares = _squares(la, lb, lc)
        _, w1, w2, *_ = self.derivatives(*_invariants(squares))
        a, b = squares[..., 0], squares[..., 1]
        return np.asarray(2.0 * w1 * (a - b) + 2.0 * w2 * (1.0 / b - 1.0 / a))

    def log_hessian_mpa(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Second derivatives of W with respect to the log stretches, MPa, shape (..., 3, 3)."""
        squares = _squares(l1, l2, l3)
        _, w1, w2, w11, w12, w22 = (w[..., None, None] for w in self.derivatives(*_invariants(squares)))
        one, two = squares[..., :, None], 1.0 / squares[..., :, None]  # dI1/dln l = 2 a, dI2/dln l = -2/a
        other_one, other_two = np.swapaxes(one, -1, -2), np.swapaxes(two, -1, -2)
        bend = (w1 * one + w2 * two) * np.eye(3)
        turn = w11 * one * other_one - w12 * (one * other_two + two * other_one) + w22 * two * other_two
        return np.asarray(4.0 * (bend + turn))


@dataclass(frozen=True)
class MooneyRivlin(InvariantLaw):
    """Mooney-Rivlin, W = C10 x + C01 y [+ C11 x y [+ C20 x^2 + C02 y^2]], x = I1 - 3, y = I2 - 3.

    Parameters
    ----------
    c_mpa
        C10, C01; C10, C01, C11; or C10, C01, C11, C20, C02, MPa. C10 + C01, half the initial shear modulus, must be
        positive.
    """

    c_mpa: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.c_mpa) not in MOONEY_RIVLIN_CONSTANTS:
            raise MaterialError(
                f"Mooney-Rivlin c_mpa has {len(self.c_mpa)} constants: give C10, C01, in MPa, with C11, or with C11, "
                "C20, C02"
            )
        for number, value in enumerate(self.c_mpa, start=1):
            require_finite(f"Mooney-Rivlin c_mpa, constant {number}", value)
        require_positive("Mooney-Rivlin C10 + C01", sum(self.c_mpa[:2]), "it is half the initial shear modulus, in MPa")

    @property
    def constants_mpa(self) -> tuple[float, float, float, float, float]:
        """C10, C01, C11, C20, C02, MPa; those that are not given are nought."""
        c10, c01, c11, c20, c02 = (*self.c_mpa, 0.0, 0.0, 0.0)[:5]
        return c10, c01, c11, c20, c02

    def derivatives(self, i1: FloatArray, i2: FloatArray) -> Derivatives:
        """W and its derivatives at invariants of one shape, MPa."""
        c10, c01, c11, c20, c02 = self.constants_mpa
        x, y = i1 - 3.0, i2 - 3.0
        one = np.ones_like(x)
        energy = (c10 + c11 * y + c20 * x) * x + (c01 + c02 * y) * y
        w1, w2 = c10 + c11 * y + 2.0 * c20 * x, c01 + c11 * x + 2.0 * c02 * y
        return energy, w1, w2, 2.0 * c20 * one, c11 * one, 2.0 * c02 * one


@dataclass(frozen=True)
class Gent(InvariantLaw):
    """Gent, W = -mu J/2 ln(1 - (I1 - 3)/J): chains are at their end at I1 = 3 + J (Rubber Chem. Technol. 69 (1996) 59).

    Parameters
    ----------
    mu_mpa
        Initial shear modulus, MPa.
    limit
        J, the largest I1 - 3.
    """

    mu_mpa: float
    limit: float

    def __post_init__(self) -> None:
        require_positive("Gent mu_mpa", self.mu_mpa, "give the initial shear modulus in MPa")
        require_positive("Gent limit", self.limit, "give the largest I1 - 3, such as 50")

    def derivatives(self, i1: FloatArray, i2: FloatArray) -> Derivatives:
        """W and its derivatives at invariants of one shape, MPa; infinite from I1 = 3 + J on."""
        x = i1 - 3.0
        with np.errstate(invalid="ignore", divide="ignore"):
            used = np.where(x.real < self.limit, x / self.limit, 1.0)
            energy = -0.5 * self.mu_mpa * self.limit * np.log1p(-used)
            left = 1.0 - used
            w1 = 0.5 * self.mu_mpa / left
            w11 = w1 / (self.limit * left)
        none = np.zeros_like(x)
        return energy, w1, none, w11, none, none


@dataclass(frozen=True)
class ArrudaBoyce(InvariantLaw):
    """Arruda-Boyce, W = mu sum_i a_i (I1^i - 3^i) / L^(2 i - 2), five terms of the eight-chain model's series.

    Parameters
    ----------
    mu_mpa
        mu, MPa; the initial shear modulus is somewhat larger, see the module's heading.
    stretch_limit
        L, the stretch at which chains are at their end, above 1.
    """

    mu_mpa: float
    stretch_limit: float

    def __post_init__(self) -> None:
        require_positive("Arruda-Boyce mu_mpa", self.mu_mpa, "give mu in MPa")
        require_finite("Arruda-Boyce stretch_limit", self.stretch_limit)
        if self.stretch_limit <= 1.0:
            raise MaterialError(
                f"Arruda-Boyce stretch_limit = {self.stretch_limit:g}: must be above 1, the locking stretch, such as 3"
            )

    @property
    def c_mpa(self) -> tuple[float, ...]:
        """Coefficients of (I1 - 3)^k, k = 1 to 5, MPa: the same law as a polynomial."""
        terms = range(1, len(ARRUDA_BOYCE_SERIES) + 1)
        factors = [
            self.mu_mpa * a / self.stretch_limit ** (2 * i - 2) for i, a in zip(terms, ARRUDA_BOYCE_SERIES, strict=True)
        ]
        return tuple(
            sum(factors[i - 1] * math.comb(i, k) * 3.0 ** (i - k) for i in range(k, len(factors) + 1)) for k in terms
        )

    def derivatives(self, i1: FloatArray, i2: FloatArray) -> Derivatives:
        """W and its derivatives at invariants of one shape, MPa."""
        x = i1 - 3.0
        energy = w1 = w11 = np.zeros_like(x)
        for k, c in reversed(list(enumerate(self.c_mpa, start=1))):
            energy, w1 = (energy + c) * x, w1 * x + k * c
            if k > 1:
                w11 = w11 * x + k * (k - 1) * c
        none = np.zeros_like(x)
        return energy, w1, none, w11, none, none


def _squares(l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
    """Squared stretches, shape (..., 3)."""
    return np.stack(np.broadcast_arrays(*(np.asarray(value) ** 2 for value in (l1, l2, l3))), axis=-1)


def _invariants(squares: FloatArray) -> tuple[FloatArray, FloatArray]:
    return squares.sum(axis=-1), (1.0 / squares).sum(axis=-1)
