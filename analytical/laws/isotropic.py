"""Isotropic incompressible stored energies W(l1, l2, l3) of the principal stretches, in closed form.

Stretches are dimensionless, stresses, moduli and energy densities are in MPa. The energies are meant for l1*l2*l3 = 1:
only differences of principal Cauchy stresses are defined, and the hydrostatic part belongs to whoever solves a boundary
value problem.

Initial shear moduli: neo-Hooke mu, Yeoh 2 C1, Guccione b C / 2, Ogden mu ("2mu/alpha^2") or mu alpha / 2 ("mu/alpha").
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, Protocol, get_args

import numpy as np
from numpy.typing import ArrayLike

from analytical.arrays import FloatArray
from analytical.laws.errors import MaterialError, require_finite, require_positive
from analytical.laws.of_invariants import ArrudaBoyce, Gent, MooneyRivlin

OgdenConvention = Literal["2mu/alpha^2", "mu/alpha"]
OGDEN_CONVENTIONS: Final[tuple[OgdenConvention, ...]] = get_args(OgdenConvention)

# Terms of a polynomial law; a fit of more has no digits left in it.
MOST_TERMS: Final = 8


class IsotropicLaw(Protocol):
    """What the exact solutions need of a law: any isotropic incompressible W(l1, l2, l3).

    The laws below satisfy it, and so does `numerical.EnergyLaw` for any other energy.
    """

    @property
    def initial_shear_modulus_mpa(self) -> float:
        """Initial shear modulus, MPa."""
        ...

    def energy(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Strain energy density at the principal stretches, MPa (mJ/mm3); arrays broadcast."""
        ...

    def stress_difference(self, la: ArrayLike, lb: ArrayLike, lc: ArrayLike) -> FloatArray:
        """Cauchy sigma_a - sigma_b = la dW/dla - lb dW/dlb, MPa; arrays broadcast."""
        ...

    def log_hessian_mpa(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Second derivatives of W with respect to the log stretches, MPa, shape (..., 3, 3)."""
        ...


@dataclass(frozen=True)
class NeoHooke:
    """Neo-Hooke, W = mu/2 (I1 - 3).

    Parameters
    ----------
    mu_mpa
        Initial shear modulus, MPa.
    """

    mu_mpa: float

    def __post_init__(self) -> None:
        require_positive("neo-Hooke mu_mpa", self.mu_mpa, "give the initial shear modulus in MPa")

    @property
    def initial_shear_modulus_mpa(self) -> float:
        """Initial shear modulus, MPa: mu."""
        return self.mu_mpa

    def energy(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Strain energy density at the principal stretches, MPa (mJ/mm3); arrays broadcast."""
        i1 = np.asarray(l1) ** 2 + np.asarray(l2) ** 2 + np.asarray(l3) ** 2
        return np.asarray(0.5 * self.mu_mpa * (i1 - 3.0))

    def stress_difference(self, la: ArrayLike, lb: ArrayLike, lc: ArrayLike) -> FloatArray:
        """Cauchy sigma_a - sigma_b = la dW/dla - lb dW/dlb, MPa; arrays broadcast (lc plays no part here)."""
        la, lb, _ = np.broadcast_arrays(la, lb, lc)
        return np.asarray(self.mu_mpa * (la**2 - lb**2))

    def log_hessian_mpa(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Second derivatives of W with respect to the log stretches, MPa, shape (..., 3, 3)."""
        return hessian_of_i1_law((l1, l2, l3), 0.5 * self.mu_mpa, 0.0)


@dataclass(frozen=True)
class Yeoh:
    """Yeoh, W = sum_i C_i (I1 - 3)^i, of three terms as a rule (eq. (2), DOI 10.3390/biomimetics9030160).

    Parameters
    ----------
    c_mpa
        Coefficients C_1, C_2, C_3, …, MPa. The first must be positive; the others may be negative, in which
        case `check_stability` decides over the stretches that will be used.
    """

    c_mpa: tuple[float, ...]

    def __post_init__(self) -> None:
        if not 1 <= len(self.c_mpa) <= MOST_TERMS:
            raise MaterialError(f"Yeoh c_mpa has {len(self.c_mpa)} coefficients: give one to {MOST_TERMS}, in MPa")
        for number, value in enumerate(self.c_mpa, start=1):
            require_finite(f"Yeoh c_mpa C{number}", value)
        require_positive("Yeoh c_mpa C1", self.c_mpa[0], "it is half the initial shear modulus, in MPa")

    @property
    def initial_shear_modulus_mpa(self) -> float:
        """Initial shear modulus, MPa: 2 C1."""
        return 2.0 * self.c_mpa[0]

    def energy(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Strain energy density at the principal stretches, MPa (mJ/mm3); arrays broadcast."""
        x = np.asarray(l1) ** 2 + np.asarray(l2) ** 2 + np.asarray(l3) ** 2 - 3.0
        return np.asarray(sum(c * x**i for i, c in enumerate(self.c_mpa, start=1)))

    def stress_difference(self, la: ArrayLike, lb: ArrayLike, lc: ArrayLike) -> FloatArray:
        """Cauchy sigma_a - sigma_b = 2 dW/dI1 (la^2 - lb^2), MPa (eqs. (7), (8)); arrays broadcast."""
        a2, b2, c2 = np.asarray(la) ** 2, np.asarray(lb) ** 2, np.asarray(lc) ** 2
        return np.asarray(2.0 * self._w1(a2 + b2 + c2 - 3.0) * (a2 - b2))

    def log_hessian_mpa(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Second derivatives of W with respect to the log stretches, MPa, shape (..., 3, 3)."""
        x = np.asarray(l1) ** 2 + np.asarray(l2) ** 2 + np.asarray(l3) ** 2 - 3.0
        w11 = sum(
            (i * (i - 1) * c * x ** (i - 2) for i, c in enumerate(self.c_mpa, start=1) if i > 1),
            start=np.zeros_like(x),
        )
        return hessian_of_i1_law((l1, l2, l3), self._w1(x), w11)

    def _w1(self, x: FloatArray) -> FloatArray:
        """dW/dI1 at x = I1 - 3, MPa (eq. (8))."""
        return np.asarray(sum(i * c * x ** (i - 1) for i, c in enumerate(self.c_mpa, start=1)))


@dataclass(frozen=True)
class Ogden:
    """One-term Ogden, W = k (l1^alpha + l2^alpha + l3^alpha - 3), k = `prefactor_mpa`.

    Two conventions are in use, and the paper uses both; the same numbers then mean two materials, so the
    convention has no default.

    Parameters
    ----------
    mu_mpa
        Material parameter mu, MPa.
    alpha
        Exponent, not zero.
    convention
        "2mu/alpha^2": k = 2 mu / alpha^2, mu is the initial shear modulus (eq. (3) of the paper; Abaqus).
        "mu/alpha": k = mu / alpha, initial shear modulus mu alpha / 2 (eq. (20) of the paper; ANSYS).
    """

    mu_mpa: float
    alpha: float
    convention: OgdenConvention

    def __post_init__(self) -> None:
        require_finite("Ogden mu_mpa", self.mu_mpa)
        require_finite("Ogden alpha", self.alpha)
        if self.convention not in OGDEN_CONVENTIONS:
            allowed = " or ".join(f'"{name}"' for name in OGDEN_CONVENTIONS)
            raise MaterialError(f"Ogden convention = {self.convention!r} is unknown: say {allowed}")
        if self.alpha == 0.0:
            raise MaterialError("Ogden alpha = 0 leaves no energy: give the fitted exponent")
        if self.initial_shear_modulus_mpa <= 0.0:
            product = "mu_mpa" if self.convention == "2mu/alpha^2" else "mu_mpa * alpha"
            raise MaterialError(
                f"Ogden mu_mpa = {self.mu_mpa:g}, alpha = {self.alpha:g} give an initial shear modulus of "
                f'{self.initial_shear_modulus_mpa:g} MPa: in "{self.convention}" {product} must be positive'
            )

    @property
    def prefactor_mpa(self) -> float:
        """Factor k of W = k (sum l^alpha - 3), MPa."""
        return 2.0 * self.mu_mpa / self.alpha**2 if self.convention == "2mu/alpha^2" else self.mu_mpa / self.alpha

    @property
    def initial_shear_modulus_mpa(self) -> float:
        """Initial shear modulus, MPa: k alpha^2 / 2, that is mu or mu alpha / 2 by convention."""
        return 0.5 * self.prefactor_mpa * self.alpha**2

    def energy(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Strain energy density at the principal stretches, MPa (mJ/mm3); arrays broadcast."""
        powers = np.asarray(l1) ** self.alpha + np.asarray(l2) ** self.alpha + np.asarray(l3) ** self.alpha
        return np.asarray(self.prefactor_mpa * (powers - 3.0))

    def stress_difference(self, la: ArrayLike, lb: ArrayLike, lc: ArrayLike) -> FloatArray:
        """Cauchy sigma_a - sigma_b = k alpha (la^alpha - lb^alpha), MPa; arrays broadcast (lc unused)."""
        la, lb, _ = np.broadcast_arrays(la, lb, lc)
        return np.asarray(self.prefactor_mpa * self.alpha * (la**self.alpha - lb**self.alpha))

    def log_hessian_mpa(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Second derivatives of W with respect to the log stretches, MPa, shape (..., 3, 3)."""
        stretches = np.stack(np.broadcast_arrays(l1, l2, l3), axis=-1)
        diagonal = np.asarray(self.prefactor_mpa * self.alpha**2 * stretches**self.alpha)
        return np.asarray(diagonal[..., :, None] * np.eye(3))


@dataclass(frozen=True)
class OgdenSeries:
    """Ogden with several terms, W = sum_i k_i (l1^alpha_i + l2^alpha_i + l3^alpha_i - 3), of any signs.

    Parameters
    ----------
    mu_mpa, alpha
        Parameters mu_i, MPa, and exponents, as many of each.
    convention
        What mu_i is: as of `Ogden`. Initial shear modulus: sum of mu_i ("2mu/alpha^2"), or half the sum of mu_i alpha_i
        ("mu/alpha"); it must be positive.
    """

    mu_mpa: tuple[float, ...]
    alpha: tuple[float, ...]
    convention: OgdenConvention

    def __post_init__(self) -> None:
        if not 1 <= len(self.mu_mpa) == len(self.alpha) <= MOST_TERMS:
            raise MaterialError(
                f"Ogden mu_mpa has {len(self.mu_mpa)} numbers, alpha {len(self.alpha)}: give as many of each, at most "
                f"{MOST_TERMS}"
            )
        for mu, alpha in zip(self.mu_mpa, self.alpha, strict=True):
            require_finite("Ogden mu_mpa", mu)
            require_finite("Ogden alpha", alpha)
            if alpha == 0.0:
                raise MaterialError("Ogden alpha = 0 leaves no energy: leave the term out")
        modulus = self.initial_shear_modulus_mpa
        require_positive(
            "initial shear modulus of Ogden's terms", modulus, "it is the sum of theirs, by the convention"
        )

    @property
    def prefactors_mpa(self) -> tuple[float, ...]:
        """Factors k_i, MPa."""
        pairs = zip(self.mu_mpa, self.alpha, strict=True)
        return tuple(2.0 * mu / a**2 if self.convention == "2mu/alpha^2" else mu / a for mu, a in pairs)

    @property
    def initial_shear_modulus_mpa(self) -> float:
        """Initial shear modulus, MPa: sum of k_i alpha_i^2 / 2."""
        return 0.5 * sum(k * a**2 for k, a in zip(self.prefactors_mpa, self.alpha, strict=True))

    def energy(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Strain energy density at the principal stretches, MPa (mJ/mm3); arrays broadcast."""
        terms = zip(self.prefactors_mpa, self.alpha, strict=True)
        return np.asarray(sum(k * (sum(np.asarray(s) ** a for s in (l1, l2, l3)) - 3.0) for k, a in terms))

    def stress_difference(self, la: ArrayLike, lb: ArrayLike, lc: ArrayLike) -> FloatArray:
        """Cauchy sigma_a - sigma_b = sum k_i alpha_i (la^alpha_i - lb^alpha_i), MPa; arrays broadcast (lc unused)."""
        la, lb, _ = np.broadcast_arrays(la, lb, lc)
        return np.asarray(sum(k * a * (la**a - lb**a) for k, a in zip(self.prefactors_mpa, self.alpha, strict=True)))

    def log_hessian_mpa(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Second derivatives of W with respect to the log stretches, MPa, shape (..., 3, 3)."""
        stretches = np.stack(np.broadcast_arrays(l1, l2, l3), axis=-1)
        diagonal = sum(k * a**2 * stretches**a for k, a in zip(self.prefactors_mpa, self.alpha, strict=True))
        return np.asarray(np.asarray(diagonal)[..., :, None] * np.eye(3))


@dataclass(frozen=True)
class Guccione:
    """Isotropic exponential law, W = C/2 (exp(b E:E) - 1) with the Green strain E.

    Guccione et al., J. Biomech. Eng. 113 (1991) 42, with b_f = b_t = b_fs = b; as in problem 2 of Land et al., Proc. R.
    Soc. A 471 (2015) 20150641.

    Parameters
    ----------
    c_mpa
        Stiffness C, MPa.
    b
        Exponent.
    """

    c_mpa: float
    b: float = 1.0

    def __post_init__(self) -> None:
        require_positive("Guccione c_mpa", self.c_mpa, "give the stiffness in MPa")
        require_positive("Guccione b", self.b, "give the exponent, such as 1")

    @property
    def initial_shear_modulus_mpa(self) -> float:
        """Initial shear modulus, MPa: b C / 2."""
        return 0.5 * self.b * self.c_mpa

    def energy(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Strain energy density at the principal stretches, MPa (mJ/mm3); arrays broadcast."""
        return np.asarray(0.5 * self.c_mpa * np.expm1(self._exponent(l1, l2, l3)))

    def stress_difference(self, la: ArrayLike, lb: ArrayLike, lc: ArrayLike) -> FloatArray:
        """Cauchy sigma_a - sigma_b = C b exp(b E:E) (ea la^2 - eb lb^2), ea = (la^2 - 1)/2, MPa; arrays broadcast."""
        a2, b2 = np.asarray(la) ** 2, np.asarray(lb) ** 2
        # at a stretch of 6 the exponential is beyond the largest number: infinite, as far as anybody goes there
        with np.errstate(over="ignore", invalid="ignore"):
            growth = np.exp(self._exponent(la, lb, lc))
            return np.asarray(0.5 * self.c_mpa * self.b * growth * ((a2 - 1.0) * a2 - (b2 - 1.0) * b2))

    def log_hessian_mpa(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """Second derivatives of W with respect to the log stretches, MPa, shape (..., 3, 3)."""
        squares = np.stack(np.broadcast_arrays(*(np.asarray(value) ** 2 for value in (l1, l2, l3))), axis=-1)
        slope = self.b * (squares - 1.0) * squares
        bend = 2.0 * self.b * squares * (2.0 * squares - 1.0)
        growth = 0.5 * self.c_mpa * np.exp(self._exponent(l1, l2, l3))[..., None, None]
        both = slope[..., :, None] * slope[..., None, :]
        return np.asarray(growth * (both + bend[..., :, None] * np.eye(3)))

    def _exponent(self, l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> FloatArray:
        """B E:E at the principal stretches."""
        strains = (0.5 * (np.asarray(value) ** 2 - 1.0) for value in (l1, l2, l3))
        return np.asarray(self.b * sum(strain**2 for strain in strains))


Law = NeoHooke | Yeoh | Ogden | OgdenSeries | Guccione | MooneyRivlin | Gent | ArrudaBoyce


def hessian_of_i1_law(
    stretches: tuple[ArrayLike, ArrayLike, ArrayLike], w1_mpa: ArrayLike, w11_mpa: ArrayLike
) -> FloatArray:
    """Log-stretch Hessian of W(I1), 4 W1 la^2 delta_ab + 4 W11 la^2 lb^2, shape (..., 3, 3), MPa."""
    squares = np.stack(np.broadcast_arrays(*(np.asarray(value) ** 2 for value in stretches)), axis=-1)
    w1, w11 = np.asarray(w1_mpa)[..., None, None], np.asarray(w11_mpa)[..., None, None]
    diagonal = w1 * squares[..., :, None] * np.eye(3)
    return np.asarray(4.0 * (diagonal + w11 * squares[..., :, None] * squares[..., None, :]))
