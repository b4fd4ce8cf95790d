"""Material laws and constants. Stretches are dimensionless, stresses, moduli and energy densities are in MPa.

The laws are incompressible: energies are meant for l1*l2*l3 = 1, only differences of principal Cauchy
stresses are defined, and the hydrostatic part belongs to whoever solves a boundary value problem.

Source of the paper's constants: Heung et al., Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160,
section 3 ("Finite Element Method (FEM) Modeling").
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal, Protocol, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
OgdenConvention = Literal["2mu/alpha^2", "mu/alpha"]
OGDEN_CONVENTIONS: Final[tuple[OgdenConvention, ...]] = get_args(OgdenConvention)


class MaterialError(ValueError):
    """A material that cannot be used; the message names the value and the remedy."""


def _require_finite(name: str, value: float) -> None:
    if not math.isfinite(value):
        raise MaterialError(f"{name} = {value} is not a finite number: give the measured value")


def _require_positive(name: str, value: float, remedy: str) -> None:
    _require_finite(name, value)
    if value <= 0.0:
        raise MaterialError(f"{name} = {value:g} must be positive: {remedy}")


def _hessian_of_i1_law(
    stretches: tuple[ArrayLike, ArrayLike, ArrayLike], w1_mpa: ArrayLike, w11_mpa: ArrayLike
) -> FloatArray:
    """Log-stretch Hessian of W(I1), 4 W1 la^2 delta_ab + 4 W11 la^2 lb^2, shape (..., 3, 3), MPa."""
    squares = np.stack(np.broadcast_arrays(*(np.asarray(value) ** 2 for value in stretches)), axis=-1)
    w1, w11 = np.asarray(w1_mpa)[..., None, None], np.asarray(w11_mpa)[..., None, None]
    diagonal = w1 * squares[..., :, None] * np.eye(3)
    return np.asarray(4.0 * (diagonal + w11 * squares[..., :, None] * squares[..., None, :]))


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
        _require_positive("neo-Hooke mu_mpa", self.mu_mpa, "give the initial shear modulus in MPa")

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
        return _hessian_of_i1_law((l1, l2, l3), 0.5 * self.mu_mpa, 0.0)


@dataclass(frozen=True)
class Yeoh:
    """Yeoh, W = sum_i C_i (I1 - 3)^i, one to three terms (eq. (2), DOI 10.3390/biomimetics9030160).

    Parameters
    ----------
    c_mpa
        Coefficients C_1, C_2, C_3, MPa. The first must be positive; the others may be negative, in which
        case `check_stability` decides over the stretches that will be used.
    """

    c_mpa: tuple[float, ...]

    def __post_init__(self) -> None:
        if not 1 <= len(self.c_mpa) <= 3:
            raise MaterialError(f"Yeoh c_mpa has {len(self.c_mpa)} coefficients: give one to three, in MPa")
        for number, value in enumerate(self.c_mpa, start=1):
            _require_finite(f"Yeoh c_mpa C{number}", value)
        _require_positive("Yeoh c_mpa C1", self.c_mpa[0], "it is half the initial shear modulus, in MPa")

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
        return _hessian_of_i1_law((l1, l2, l3), self._w1(x), w11)

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
        _require_finite("Ogden mu_mpa", self.mu_mpa)
        _require_finite("Ogden alpha", self.alpha)
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
        _require_positive("Guccione c_mpa", self.c_mpa, "give the stiffness in MPa")
        _require_positive("Guccione b", self.b, "give the exponent, such as 1")

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
        _require_positive(
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


Law = NeoHooke | Yeoh | Ogden | Guccione


class IsotropicLaw(Protocol):
    """What the exact solutions need of a law: any isotropic incompressible W(l1, l2, l3).

    The laws above satisfy it, and so does `EnergyLaw` for any other energy.
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
class StiffSolid:
    """Isotropic linear elastic material of the crest rings.

    Parameters
    ----------
    young_mpa
        Young's modulus, MPa.
    poisson
        Poisson's ratio, in (-1, 1/2).
    density_g_cm3
        Density, g/cm3.
    """

    young_mpa: float
    poisson: float
    density_g_cm3: float

    def __post_init__(self) -> None:
        _require_positive("young_mpa", self.young_mpa, "give Young's modulus in MPa (1 GPa = 1000 MPa)")
        _require_positive("density_g_cm3", self.density_g_cm3, "give the density in g/cm3")
        _require_finite("poisson", self.poisson)
        if not -1.0 < self.poisson < 0.5:
            raise MaterialError(
                f"poisson = {self.poisson:g} must lie in (-1, 1/2): an incompressible ring needs a law of "
                "its own, otherwise give a value such as 0.36"
            )

    @property
    def mu_mpa(self) -> float:
        """Shear modulus (second Lame constant), MPa."""
        return self.young_mpa / (2.0 * (1.0 + self.poisson))

    @property
    def kappa_mpa(self) -> float:
        """Bulk modulus, MPa."""
        return self.young_mpa / (3.0 * (1.0 - 2.0 * self.poisson))

    @property
    def lame_lambda_mpa(self) -> float:
        """First Lame constant, MPa."""
        return self.kappa_mpa - 2.0 * self.mu_mpa / 3.0


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


def _is_positive_on_isochoric(hessian_mpa: FloatArray) -> NDArray[np.bool_]:
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


def dragon_skin_30(convention: OgdenConvention) -> Ogden:
    """Dragon Skin 30 silicone, one-term Ogden: mu = 75.449 kPa, alpha = 5.836.

    The paper prints the two numbers once and puts them into both conventions: eq. (3) is "2mu/alpha^2"
    (initial shear modulus 75 kPa), eq. (20) is "mu/alpha" (220 kPa). The caller has to say which.
    """
    return Ogden(mu_mpa=0.075449, alpha=5.836, convention=convention)


# Printed in the paper: C1 = 36000, C2 = 2500, C3 = 230 Pa.
DRAGON_SKIN_10: Final = Yeoh(c_mpa=(0.036, 0.0025, 0.00023))

# Printed in the paper, section 2: 1000 % and 364 %.
DRAGON_SKIN_10_ELONGATION_AT_BREAK_PERCENT: Final = 1000.0
DRAGON_SKIN_30_ELONGATION_AT_BREAK_PERCENT: Final = 364.0

# Our choice, not printed in the paper: density of cured Dragon Skin.
SILICONE_DENSITY_G_CM3: Final = 1.07

# The paper says the rings are printed in PLA and gives no constants; these are our choice.
PLA: Final = StiffSolid(young_mpa=3500.0, poisson=0.36, density_g_cm3=1.24)

# Assumed: the paper's FEM takes polyethylene from the ANSYS library, whose values are quoted from memory.
POLYETHYLENE: Final = StiffSolid(young_mpa=1100.0, poisson=0.42, density_g_cm3=0.95)
