"""Constants of a law from material tests, by least squares in relative error.

With the measured nominal stresses P_i at stretches l_i and weights w_i

    minimise  S = sum_i w_i r_i^2,   r_i = P(l_i) / P_i - 1,
    with positive incremental moduli (`analytical.laws.stability`) up to a stated stretch in all three tests,

first without the condition, then, where the minimum breaks it, with it. Relative errors count a small stress as
much as a large one (Ogden, Saccomandi and Sgura 2004, doi 10.1007/s00466-004-0593-y, who show what absolute ones leave
at small stretches). Laws are compared by Akaike's criterion for small samples, AICc = n ln(S/n) + 2 k n / (n - k - 1).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.optimize import least_squares

from analytical.arrays import FloatArray
from analytical.exact.homogeneous import nominal_stress_mpa
from analytical.laws.errors import MaterialError
from analytical.laws.isotropic import Law
from analytical.laws.stability import MODES, stable_stretches
from analytical.tensile.families import FAMILIES, Family
from analytical.tensile.measured import MaterialTest, MeasuredError

# States at which the moduli are held positive, in each test; and how positive, as a share of the initial ones.
STATES, LEAST_MODULUS = 25, 1e-3
# Of Ogden's exponents, in size: below it terms are logarithms that differ by round-off, and scenes refuse them.
LEAST_ALPHA = 0.05
# Weights of what the moduli lack, one after another.
PENALTIES = (1.0, 10.0, 100.0, 1e3, 1e4)
# Relative error of constants that make no law.
_FAR: Final = 1e6


class FitError(ValueError):
    """No constants were found; the message says of which law and why."""


@dataclass(frozen=True)
class Fit:
    """A law fitted to tests.

    Attributes
    ----------
    family
        Its name among `FAMILIES`.
    law
        The law, MPa.
    names, constants, covariance
        Of the free constants: names, values and covariance, in kPa where a name ends so, shapes (k,) and (k, k). The
        covariance is S / (n - k) (J^T J)^-1: of the scatter that is left, not of one batch of silicone against another.
    rms, worst
        Of the relative errors, weighted, and the largest.
    aicc
        Akaike's criterion; differences count, the lowest is taken.
    points
        Number of points.
    data_to_stretch
        Largest principal stretch of the data, also of what was pushed.
    stable_to
        By test, the stretch at which the law softens; infinite where it does not.
    held
        True if the condition of positive moduli has decided.
    """

    family: str
    law: Law
    names: tuple[str, ...]
    constants: FloatArray
    covariance: FloatArray
    rms: float
    worst: float
    aicc: float
    points: int
    data_to_stretch: float
    stable_to: dict[str, float]
    held: bool

    @property
    def deviations(self) -> FloatArray:
        """Standard deviations of the constants, shape (k,)."""
        return np.sqrt(np.clip(np.diag(self.covariance), 0.0, None))


def largest_stretch(tests: Sequence[MaterialTest]) -> float:
    """Largest principal stretch of the data."""
    return max(float(np.max(MODES[test.mode](test.stretch))) for test in tests)


def relative_errors(law: Law, tests: Sequence[MaterialTest]) -> FloatArray:
    """P(l) / P - 1 at every loaded point, in the order of the tests."""
    return np.concatenate([nominal_stress_mpa(law, test.mode, test.stretch) / test.nominal_mpa - 1.0 for test in tests])


def fit_law(tests: Sequence[MaterialTest], family: str, stable_to: float | None = None) -> Fit:
    """Fit a law to tests.

    Parameters
    ----------
    tests
        One or several.
    family
        A name among `FAMILIES`.
    stable_to
        Stretch up to which incremental moduli must be positive; None for the data's largest.

    Raises
    ------
    MeasuredError
        For too few points for so many constants.
    FitError
        If no constants were found.
    """
    form, loaded = FAMILIES[family], [test.loaded for test in tests]
    points, count = sum(len(test.stretch) for test in loaded), len(form.names)
    if points <= count + 1:
        raise MeasuredError(f"{points} points for the {count} constants of {family}: give more, or take a simpler law")
    to = largest_stretch(loaded) if stable_to is None else stable_to
    weight = np.sqrt(np.concatenate([test.weight for test in loaded]))
    scale = _initial_modulus_mpa(loaded)

    def residual(x: FloatArray) -> FloatArray:
        try:
            with np.errstate(all="ignore"):
                found = weight * relative_errors(form.law(x, scale), loaded)
        except MaterialError:
            return np.full(points, _FAR)
        return np.clip(np.nan_to_num(found, nan=_FAR), -_FAR, _FAR)

    found = min((_free(form, residual, start) for start in form.starts), key=lambda x: float(residual(x) @ residual(x)))
    law = _law(form, found, scale, family)
    held = min(stable_stretches(law).values()) < to
    if held:
        found = _held(form, residual, found, scale, to)
        law = _law(form, found, scale, family)
        if min(stable_stretches(law).values()) < to:
            raise FitError(f"{family}: no constants with positive moduli up to stretch {to:.3g} were found")
    for name, value in zip(form.names, found, strict=True):
        if name.startswith("alpha") and abs(value) < LEAST_ALPHA:
            raise FitError(
                f"{family}: the best exponent is {value:.2g}, a term that is nearly a logarithm: take fewer terms"
            )
    r = residual(found)
    square = float(r @ r)
    units = np.where(form.moduli, 1e3 * scale, 1.0)
    return Fit(
        family=family,
        law=law,
        names=form.names,
        constants=found * units,
        covariance=_covariance(residual, found, square / (points - count)) * np.outer(units, units),
        rms=math.sqrt(square / float(weight @ weight)),
        worst=float(np.abs(relative_errors(law, loaded)).max()),
        aicc=points * math.log(max(square / points, 1e-300)) + 2.0 * count * points / (points - count - 1),
        points=points,
        data_to_stretch=largest_stretch(loaded),
        stable_to=dict(stable_stretches(law)),
        held=held,
    )


def best_fit(tests: Sequence[MaterialTest], families: Iterable[str], stable_to: float | None = None) -> list[Fit]:
    """Laws of some families that can be fitted to the tests, the best by AICc first.

    Raises
    ------
    FitError
        If none can.
    """
    fits, faults = [], []
    for family in families:
        try:
            fits.append(fit_law(tests, family, stable_to))
        except (FitError, MeasuredError) as error:
            faults.append(str(error))
    if not fits:
        raise FitError("; ".join(dict.fromkeys(faults)))
    return sorted(fits, key=lambda fit: fit.aicc)


def _initial_modulus_mpa(tests: Sequence[MaterialTest]) -> float:
    """A first guess of the initial shear modulus: that of the least strained points as if neo-Hookean."""
    guesses = []
    for test in tests:
        one, _, three = MODES[test.mode](test.stretch)
        modulus = test.nominal_mpa * test.stretch / (one**2 - three**2)
        guesses.append(float(np.median(modulus[np.argsort(np.abs(np.log(test.stretch)))][:5])))
    return float(np.median(guesses))


def _law(form: Family, constants: FloatArray, scale_mpa: float, family: str) -> Law:
    try:
        return form.law(constants, scale_mpa)
    except MaterialError as error:
        raise FitError(f"{family}: the best constants are no sound law: {error}") from None


def _free(form: Family, residual, start: Sequence[float] | FloatArray) -> FloatArray:  # type: ignore[no-untyped-def]
    """Least squares within the bounds alone."""
    found = least_squares(residual, start, "3-point", (form.lower, form.upper), x_scale="jac", max_nfev=400)
    return np.asarray(found.x)


def _held(form: Family, residual, start: FloatArray, scale_mpa: float, to: float) -> FloatArray:  # type: ignore[no-untyped-def]
    """Least squares with positive moduli up to a stretch."""
    stretch = np.geomspace(1.0, 1.001 * to, STATES)
    states = tuple(np.concatenate(part) for part in zip(*(of(stretch) for of in MODES.values()), strict=True))

    def lacking(x: FloatArray) -> FloatArray:
        """By how much moduli are too small, as shares of the initial one; zero where they are not."""
        try:
            law = form.law(x, scale_mpa)
            return np.maximum(0.0, LEAST_MODULUS - _least_moduli(law, states) / law.initial_shear_modulus_mpa)
        except MaterialError:
            return np.ones(states[0].size)

    # A penalty that grows until what is lacking is less than what is asked for; from rest, which is stable.
    tries = []
    for first in (np.asarray(form.starts[0]), start):
        x = first
        for penalty in PENALTIES:

            def with_penalty(x: FloatArray, penalty: float = penalty) -> FloatArray:
                return np.append(residual(x), penalty * lacking(x))

            x = _free(form, with_penalty, np.clip(x, form.lower, form.upper))
        if lacking(x).max() < 0.9 * LEAST_MODULUS:
            r = residual(x)
            tries.append((float(r @ r), x))
    return min(tries, key=lambda one: one[0])[1] if tries else start


def _least_moduli(law: Law, states: tuple[FloatArray, ...]) -> FloatArray:
    """Smaller eigenvalue of the moduli on increments of zero sum, relative to the larger at large stretches, MPa."""
    h = law.log_hessian_mpa(*states)
    first, second = np.array([1.0, -1.0, 0.0]) / math.sqrt(2.0), np.array([1.0, 1.0, -2.0]) / math.sqrt(6.0)
    a, c = (np.einsum("i,nij,j->n", v, h, v) for v in (first, second))
    b = np.einsum("i,nij,j->n", first, h, second)
    middle, half = 0.5 * (a + c), np.hypot(0.5 * (a - c), b)
    return np.asarray((middle - half) / np.maximum(1.0, (np.abs(middle) + half) / law.initial_shear_modulus_mpa / 4.0))


def _covariance(residual, x: FloatArray, variance: float) -> FloatArray:  # type: ignore[no-untyped-def]
    """Covariance of the constants for that variance of the residuals."""
    jacobian = _jacobian(residual, x)
    return np.asarray(variance * np.linalg.pinv(jacobian.T @ jacobian))


def _jacobian(residual, x: FloatArray) -> FloatArray:  # type: ignore[no-untyped-def]
    """Central differences, shape (n, k)."""
    steps = 1e-5 * np.maximum(np.abs(x), 1e-6)
    eye = np.eye(len(x))
    return np.column_stack(
        [(residual(x + h * e) - residual(x - h * e)) / (2.0 * h) for h, e in zip(steps, eye, strict=True)]
    )
