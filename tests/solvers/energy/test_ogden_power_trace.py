"""The rational form of tr C^(alpha/2) against power sums of principal stretches."""

from __future__ import annotations

import numpy as np
import pytest

from analytical.laws.stability import MODES
from solvers.energy.ogden import DERIVATIVES, FIT_RANGE, power_sum_coefficients, power_trace, trace_derivatives

# Measured worst relative errors of value and first derivatives, times about two. Dragon Skin 30 is the first; even
# exponents need no poles and are exact but for round-off.
TOLERANCES = {
    5.836: (1e-10, 3e-9),
    -3.7: (1e-10, 2e-9),
    1.3: (4e-10, 4e-8),
    2.0: (1e-13, 1e-13),
    12.0: (2e-13, 1e-13),
}
every_alpha = pytest.mark.parametrize("alpha", TOLERANCES)


def squares(count: int = 400, largest: float = 12.6) -> np.ndarray:
    """Squared principal stretches with product 1 and all within the fit's range, shape (count, 3)."""
    rng = np.random.default_rng(20240916)
    x = np.exp(2.0 * rng.uniform(-np.log(largest), np.log(largest), (20 * count, 3)))
    x[:, 2] = 1.0 / (x[:, 0] * x[:, 1])
    inside = (x.min(axis=1) > 1.0 / largest**2) & (x.max(axis=1) < largest**2)
    return x[inside][:count]


def by_form(alpha: float, i1, i2) -> dict:
    shape = power_trace(alpha)
    found = trace_derivatives(i1, i2, shape, shape.constant, shape.poles, shape.weights)
    return {order: np.asarray(value) + 0.0 * i1 for order, value in found.items()}  # constants become arrays


@every_alpha
def test_value_is_the_power_sum(alpha: float) -> None:
    x = squares()
    direct = (x ** (0.5 * alpha)).sum(axis=1)
    found = by_form(alpha, x.sum(axis=1), (1.0 / x).sum(axis=1))[0, 0]
    assert found == pytest.approx(direct, rel=TOLERANCES[alpha][0])


@every_alpha
def test_value_at_equal_and_nearly_equal_stretches(alpha: float) -> None:
    for d in (0.0, 1e-12, 1e-8, 1e-4):
        for l in (0.5, 1.0, 1.7, 2.9):
            x = np.array([l, l * (1.0 + d), 1.0 / (l * l * (1.0 + d))]) ** 2
            direct = (x ** (0.5 * alpha)).sum()
            assert by_form(alpha, x.sum(), (1.0 / x).sum())[0, 0] == pytest.approx(direct, rel=TOLERANCES[alpha][0])


@every_alpha
def test_first_derivatives_are_those_of_the_power_sum(alpha: float) -> None:
    x = squares()
    # x^3 - I1 x^2 + I2 x - 1 = 0 gives dx/dI1 = x^2 / prod(x - x_j), dx/dI2 = -x / prod(x - x_j)
    gaps = np.stack([np.prod([x[:, i] - x[:, j] for j in range(3) if j != i], axis=0) for i in range(3)], axis=1)
    apart = np.abs(gaps).min(axis=1) > 0.1  # the exact formula cancels where two are equal
    slope = 0.5 * alpha * x ** (0.5 * alpha - 1.0)
    direct = np.stack([(slope * x**2 / gaps).sum(axis=1), (-slope * x / gaps).sum(axis=1)])[:, apart]
    found = by_form(alpha, x.sum(axis=1), (1.0 / x).sum(axis=1))
    form = np.stack([found[1, 0], found[0, 1]])[:, apart]
    error = np.abs(form - direct) / np.abs(direct).sum(axis=0)
    assert error.max() < TOLERANCES[alpha][1]


@every_alpha
@pytest.mark.parametrize(
    ("lower", "higher", "along"),
    [
        ((0, 0), (1, 0), 0),
        ((0, 0), (0, 1), 1),
        ((1, 0), (2, 0), 0),
        ((1, 0), (1, 1), 1),
        ((0, 1), (1, 1), 0),
        ((0, 1), (0, 2), 1),
    ],
)
def test_derivatives_are_differences_of_lower_ones(alpha: float, lower, higher, along: int) -> None:
    x = squares(100, 3.3)
    i = np.stack([x.sum(axis=1), (1.0 / x).sum(axis=1)])
    h = 1e-3 * i[along]

    def at(shift: int) -> np.ndarray:
        moved = i.copy()
        moved[along] += shift * h
        return by_form(alpha, *moved)[lower]

    # five-point difference: truncation h^4 / 30 of a smooth function, and round-off of the value over h
    difference = (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * h)
    found = by_form(alpha, *i)[higher]
    scale = np.abs(found).max() + np.abs(at(0) / i[along]).max()
    assert difference == pytest.approx(found, rel=1e-8, abs=1e-10 * scale)


def test_power_sums_are_exact_polynomials() -> None:
    x = squares(50, 3.0)
    i1, i2 = x.sum(axis=1), (1.0 / x).sum(axis=1)
    for m in range(8):
        table = power_sum_coefficients(m)
        value = sum(table[i, j] * i1**i * i2**j for i, j in np.argwhere(table))
        # cancellation among terms up to I1^m
        assert value == pytest.approx((x**m).sum(axis=1), rel=1e-10)


@every_alpha
def test_poles_and_weights_are_positive(alpha: float) -> None:
    shape = power_trace(alpha)
    assert min(shape.poles, default=1.0) > 0.0
    assert min(shape.weights, default=1.0) > 0.0
    assert shape.constant > 0.0
    assert shape.inverse == (alpha < 0.0)
    assert FIT_RANGE[0] < 1.0 < FIT_RANGE[1]
    assert set(by_form(alpha, 3.5, 3.4)) == set(DERIVATIVES)


NEAR_EVEN, HARD = (2.0000001, 1.9999998), (4.961, 1.144, -1.037)


@pytest.mark.parametrize("alpha", [5.836, 3.206, 2.5, 19.5, -3.7, -20.0, 0.1, -0.1, *NEAR_EVEN, *HARD])
@pytest.mark.parametrize("mode", MODES)
def test_stress_to_what_silicones_reach(alpha: float, mode: str) -> None:
    x = np.stack(MODES[mode](np.geomspace(1.001, 8.0, 300)), axis=1) ** 2
    i1, i2 = x.sum(axis=1), (1.0 / x).sum(axis=1)
    assert i1.max() < FIT_RANGE[1] and i2.max() < 1.0 / FIT_RANGE[0]
    form = by_form(alpha, i1, i2)
    found = (form[1, 0] + x[:, 1] * form[0, 1]) * (x[:, 0] - x[:, 2])
    direct = 0.5 * alpha * (x[:, 0] ** (0.5 * alpha) - x[:, 2] ** (0.5 * alpha))
    assert found == pytest.approx(direct, rel=2e-8 if abs(alpha) >= 1.0 else 1e-7 / abs(alpha))


@pytest.mark.parametrize("first", [150.0, 1.0 / 150.0, 120.0, 1.0 / 120.0])
def test_negative_exponents_hold_on_the_same_states(first: float) -> None:
    """The fit is of 1/x there: squared inverse stretches of 150 are within it, and so are those of 1/150."""
    y = np.array([first, first**-0.5, first**-0.5])
    alpha, i1, i2 = -3.7, (1.0 / y).sum(), y.sum()
    found = by_form(alpha, i1, i2)
    assert found[0, 0] == pytest.approx((y ** (-0.5 * alpha)).sum(), rel=1e-10)
    h = 1e-3 * i2  # five-point difference of the power sum over I2, y from the cubic with the other invariant held

    def direct(second: float) -> float:
        roots = np.roots([1.0, -second, i1, -1.0])
        return float((roots.astype(complex) ** (-0.5 * alpha)).sum().real)

    slope = (8.0 * (direct(i2 + h) - direct(i2 - h)) - (direct(i2 + 2.0 * h) - direct(i2 - 2.0 * h))) / (12.0 * h)
    assert found[0, 1] == pytest.approx(slope, rel=1e-6)
