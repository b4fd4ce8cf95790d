"""Grid convergence index: exact on model errors, cautious in doubt."""

from __future__ import annotations

import math

import pytest

from studies.results.uncertainty import SAFETY, SAFETY_IN_DOUBT, convergence, from_two


@pytest.mark.parametrize("order", [1.5, 2.0, 2.7])
@pytest.mark.parametrize("sizes", [(1.0, 0.5, 0.25), (1 / 8, 1 / 12, 1 / 16)])
def test_recovers_limit_and_order_of_a_power_law(sizes, order):
    found = convergence(sizes, [10.0 + 3.0 * h**order for h in sizes], 2.0)
    assert found.order == pytest.approx(order, abs=1e-6)  # bisection in a smooth function
    assert found.limit == pytest.approx(10.0, abs=1e-6)
    assert found.safety == SAFETY
    assert found.uncertainty(10.0 + 3.0 * sizes[2] ** order) == pytest.approx(1.25 * 3.0 * sizes[2] ** order, abs=1e-5)


@pytest.mark.parametrize("values", [(1.0, 1.1, 1.5), (1.0, 2.0, 2.0001)])
def test_takes_the_larger_safety_factor_in_doubt(values):
    found = convergence((1.0, 0.5, 0.25), values, 2.0)
    assert found.order == 2.0
    assert found.safety == SAFETY_IN_DOUBT
    # nominal order 2, ratio 2: a third of the last change, three times
    assert found.uncertainty(values[2]) == pytest.approx(abs(values[2] - values[1]), rel=1e-12)


def test_values_that_are_not_monotone_are_uncertain_by_their_range():
    found = convergence((1.0, 0.5, 0.25), (1.0, 2.0, 1.999), 2.0)
    assert (found.order, found.safety) == (2.0, SAFETY_IN_DOUBT)
    assert found.uncertainty(1.999) == pytest.approx(1.0)  # not 0.001: the last two are near each other by accident
    assert math.isnan(found.uncertainty(math.nan))


def test_equal_values_have_no_uncertainty():
    assert convergence((1.0, 0.5, 0.25), (3.0, 3.0, 3.0), 2.0).uncertainty(3.0) == 0.0


def test_two_levels_use_the_nominal_order():
    found = from_two((1.0, 0.5), (1.0, 1.3), 2.0)
    assert found.limit == pytest.approx(1.4)
    assert found.uncertainty(1.3) == pytest.approx(0.3)
    assert math.isclose(found.safety, SAFETY_IN_DOUBT)
