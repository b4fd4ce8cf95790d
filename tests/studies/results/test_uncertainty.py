"""Uncertainties from meshes: exact on model errors, cautious in doubt, true of what finer meshes say."""

from __future__ import annotations

import csv
import math
import statistics
from pathlib import Path

import pytest
from scipy.optimize import brentq

from studies.results.uncertainty import (
    EDGE_ORDER,
    SAFETY,
    SAFETY_IN_DOUBT,
    Orders,
    convergence,
    extrapolated,
    observed_order,
)

SMOOTH, EDGE = Orders(2.0), Orders(3.0, EDGE_ORDER)


@pytest.mark.parametrize("order", [1.5, 2.0, 2.7])
@pytest.mark.parametrize("sizes", [(1.0, 0.5, 0.25), (1 / 8, 1 / 12, 1 / 16)])
def test_recovers_limit_and_order_of_a_power_law(sizes, order):
    values = [10.0 + 3.0 * h**order for h in sizes]
    assert observed_order(sizes, values) == pytest.approx(order, abs=1e-6)  # bisection in a smooth function
    found = convergence(sizes, values, SMOOTH)
    assert found.limit == pytest.approx(10.0, abs=1e-6)
    assert found.safety == SAFETY
    assert found.uncertainty(10.0 + 3.0 * sizes[2] ** order) == pytest.approx(1.25 * 3.0 * sizes[2] ** order, abs=1e-5)


def test_an_order_that_is_too_high_is_not_believed():
    values = (1.0, 2.0, 2.0001)
    found = convergence((1.0, 0.5, 0.25), values, SMOOTH)
    assert found.safety == SAFETY_IN_DOUBT
    # nominal order 2, ratio 2: a third of the last change, three times
    assert found.uncertainty(values[2]) == pytest.approx(abs(values[2] - values[1]), rel=1e-12)


@pytest.mark.parametrize("order", [0.9, 0.6])
def test_an_order_that_is_too_low_is_believed(order):
    sizes = (1.0, 0.5, 0.25)
    values = [10.0 + 3.0 * h**order for h in sizes]
    found = convergence(sizes, values, SMOOTH)
    assert found.limit == pytest.approx(10.0, abs=1e-6)
    assert found.uncertainty(values[2]) == pytest.approx(SAFETY_IN_DOUBT * 3.0 * 0.25**order, rel=1e-6)


# The bore of a sphere of 1 and 1000 mm at 1000 kPa on r1, r2, r4 with equal cells through the wall; it is 0.444 mm.
TOO_COARSE = (0.00337366758, 0.00673822142, 0.0134417022)
UNSETTLED = {
    "doubles": TOO_COARSE,
    "diverges slowly": (1.0, 1.01, 1.025),
    "does not slow down": (1.0, 1.1, 1.2),
    "hardly slows down": (1.0, 1.1, 1.19),
    "alternates, ever further": (1.0, 1.1, 0.8),
    "alternates as far": (1.0, 1.1, 1.0),
    "waits, then jumps": (1.0, 1.0, 1.5),
    "jumps, then waits": (1.0, 1.5, 1.5),
}


@pytest.mark.parametrize("orders", [SMOOTH, EDGE, Orders(4.0)], ids=("smooth", "edge", "round"))
@pytest.mark.parametrize("values", UNSETTLED.values(), ids=UNSETTLED)
def test_meshes_that_do_not_settle_have_no_small_uncertainty(values, orders):
    last = abs(values[2] - values[1])
    found = convergence((1.0, 0.5, 0.25), values, orders).uncertainty(values[2])
    # never less than by how much the last two disagree, twice it unless the last change was the smaller one
    assert found >= (2.0 * last if last >= abs(values[1] - values[0]) else last)
    assert found >= 0.1 * (max(values) - min(values)) > 0.0


@pytest.mark.parametrize("orders", [SMOOTH, EDGE], ids=("smooth", "edge"))
def test_values_that_double_with_every_mesh_say_nothing(orders):
    assert convergence((1.0, 0.5, 0.25), TOO_COARSE, orders).uncertainty(TOO_COARSE[2]) > TOO_COARSE[2]


def test_differences_that_do_not_fall_are_uncertain_by_three_times_their_range():
    values = (1.0, 1.1, 0.9)
    found = convergence((1.0, 0.5, 0.25), values, SMOOTH)
    assert found.uncertainty(0.9) == pytest.approx(SAFETY_IN_DOUBT * 0.2)


def test_values_that_are_not_monotone_are_uncertain_by_their_range():
    found = convergence((1.0, 0.5, 0.25), (1.0, 2.0, 1.999), SMOOTH)
    assert observed_order((1.0, 0.5, 0.25), (1.0, 2.0, 1.999)) is None
    assert found.uncertainty(1.999) == pytest.approx(1.0)  # not 0.001: the last two are near each other by accident
    assert math.isnan(found.uncertainty(math.nan))


@pytest.mark.parametrize("orders", [SMOOTH, EDGE])
def test_equal_values_have_no_uncertainty(orders):
    # round-off of a system of three equations
    assert convergence((1.0, 0.5, 0.25), (3.0, 3.0, 3.0), orders).uncertainty(3.0) == pytest.approx(0.0, abs=1e-14)


def test_two_levels_of_a_smooth_body_use_the_expected_order():
    found = convergence((1.0, 0.5), (1.0, 1.3), SMOOTH)
    assert found.limit == pytest.approx(1.4)
    assert found.uncertainty(1.3) == pytest.approx(0.3)
    assert math.isclose(found.safety, SAFETY_IN_DOUBT)


def test_one_level_tells_nothing():
    assert math.isnan(convergence((1.0,), (1.0,), EDGE).uncertainty(1.0))


# --- with a singular edge -----------------------------------------------------------------------------------


def test_order_of_an_edge_follows_from_the_strength_of_its_singularity():
    def equation(strength, angle):
        return math.cos(strength * angle) - strength * math.sin(angle)

    seat, end = (brentq(equation, 0.3, 0.9, (angle,)) for angle in (math.pi, 0.5 * math.pi))
    assert 2.0 * seat == pytest.approx(EDGE_ORDER, abs=1e-9)
    assert 2.0 * end == pytest.approx(1.19, abs=0.005) and 2.0 * end > EDGE_ORDER


@pytest.mark.parametrize("sizes", [(1.0, 0.5, 0.25), (1.0, 0.5, 1 / 3)])
@pytest.mark.parametrize("smooth", [0.2, -0.2])  # with the edge's part, and against it
def test_both_parts_of_an_error_are_told_apart(sizes, smooth):
    values = [10.0 + 0.3 * h + smooth * h**3 for h in sizes]
    found = convergence(sizes, values, EDGE)
    # by the observed order, which lies between both, or is held at the lower one; the fit of both powers is exact
    assert abs(found.limit - 10.0) < 0.7 * abs(values[2] - 10.0)
    assert found.of_limit >= abs(found.limit - 10.0)
    # a mesh's distance from the limit, and the limit's doubt: once more that of the finest, or what an edge alone would
    # leave of the whole change
    errors = [abs(value - found.limit) for value in values]
    doubt = max(errors[2], abs(values[2] - values[0]) * sizes[2] / (sizes[0] - sizes[2]))
    assert [found.uncertainty(v) for v in values] == pytest.approx([e + doubt for e in errors], rel=1e-9)
    assert all(found.uncertainty(v) >= abs(v - 10.0) for v in values)
    # both powers where values are not monotone
    turning = [10.0 + 0.3 * h - 0.4 * h**3 for h in sizes]
    if observed_order(sizes, turning) is None:
        assert convergence(sizes, turning, EDGE).limit == pytest.approx(10.0, abs=1e-12)


def test_doubt_does_not_vanish_where_both_parts_cancel():
    # differences of 9 : 1 put the limit on the finest value; an edge alone would leave a third of the whole change
    found = convergence((1.0, 0.5, 0.25), (0.0, 0.9, 1.0), EDGE)
    assert found.limit == pytest.approx(1.0 + 0.1 / 7.0)  # order 3 at most
    assert found.uncertainty(found.limit) == found.of_limit == pytest.approx(1.0 / 3.0)
    # and where the first mesh agrees with the last, the smooth part a seventh of the last difference
    found = convergence((1.0, 0.5, 0.25), (1.0, 1.1, 1.0), EDGE)
    assert found.uncertainty(found.limit) >= 0.1 / 7.0


def test_two_meshes_hold_whatever_lies_between_both_orders():
    values = (1.0, 1.3)
    found = convergence((1.0, 0.5), values, EDGE)
    for order in (EDGE_ORDER, EDGE.smooth):
        assert abs(extrapolated((1.0, 0.5), values, order) - values[1]) < found.uncertainty(values[1])
    # midway between 0.3 and 0.3/7 away, and the 0.3 of the edge's order in doubt
    assert found.uncertainty(values[1]) == pytest.approx(0.5 * (0.3 + 0.3 / 7.0) + 0.3)


# Tips of the paper study's twelve actuators at four pressures, kPa, on r1, r2, r4, r8: of docs/paper/rows.csv.
TIPS = {
    (line["scene"], float(line["pressure_kpa"])): tuple(float(line[level]) for level in ("r1", "r2", "r4", "r8"))
    for line in csv.DictReader(Path(__file__).with_name("twelve_actuators.csv").open(encoding="utf-8"))
}


@pytest.mark.parametrize(("meshes", "widest"), [(3, 3.0), (2, 5.0)])
def test_uncertainties_hold_the_limit_of_finer_meshes_and_are_not_too_wide(meshes, widest):
    sizes, ratios = (1.0, 0.5, 0.25, 0.125), []
    for (scene, _), tips in TIPS.items():
        limit = convergence(sizes[1:], tips[1:], EDGE).limit
        found = convergence(sizes[:meshes], tips[:meshes], EDGE).uncertainty(tips[meshes - 1])
        if meshes == 2:  # the largest of the way, as in tip_convergence
            of_scene = [t for (name, _), t in TIPS.items() if name == scene]
            found = max(found, tips[1] * max(abs(t[0] / t[1] - 1.0) for t in of_scene))
        ratios.append(found / abs(tips[meshes - 1] - limit))
    assert len(ratios) == 48
    assert sum(ratio >= 1.0 for ratio in ratios) >= 0.95 * 48
    # Twice the error where coarser meshes tell the limit; two cannot tell the parts of it.
    assert statistics.median(ratios) < widest


def test_the_limit_of_three_meshes_is_nearer_than_the_finest_and_its_own_uncertainty_holds():
    sizes, by_limit, by_mesh = (1.0, 0.5, 0.25, 0.125), [], []
    for tips in TIPS.values():
        limit, found = convergence(sizes[1:], tips[1:], EDGE).limit, convergence(sizes[:3], tips[:3], EDGE)
        assert abs(found.limit - limit) <= found.of_limit < found.uncertainty(tips[2])
        by_limit.append(abs(found.limit / limit - 1.0))
        by_mesh.append(abs(tips[2] / limit - 1.0))
    # little more than half the error, of the median and the worst; two meshes, or smooth bodies, say nothing of it
    assert statistics.median(by_limit) < 0.55 * statistics.median(by_mesh) and max(by_limit) < 0.55 * max(by_mesh)
    assert math.isnan(convergence(sizes[:2], (1.0, 1.3), EDGE).of_limit)
    assert math.isnan(convergence(sizes[:3], (1.0, 1.3, 1.4), SMOOTH).of_limit)


@pytest.mark.parametrize(
    ("scene", "finest"),
    [
        ("heung-t1-ri5", 121.725805),
        ("heung-t1-ri7", 75.648755),
        ("heung-b-t1-ri7.5", 70.39182),
        ("heung-b-t2-ri7.5", 35.650714),
    ],
)
def test_limits_by_both_orders_are_those_that_still_finer_meshes_lead_to(scene, finest):
    # At 15 kPa, where r2, r4, r8 have orders of 0.37, 0.50, 0.62 and 0.29; tips of r16 are from one-off runs.
    sizes, tips = (1 / 2, 1 / 4, 1 / 8, 1 / 16), (*TIPS[scene, 15.0][1:], finest)
    limit = convergence(sizes[1:], tips[1:], EDGE).limit
    both = convergence(sizes[:3], tips[:3], EDGE).limit
    order = observed_order(sizes[:3], tips[:3])
    assert order is not None and order < 0.7
    as_observed = extrapolated(sizes[:3], tips[:3], order)
    error = abs(tips[1] - limit)
    # r2, r4, r8 told the error of r4 to a sixth of it (three of the four to a twentieth); the order that they show is
    # off by half of it and more
    assert abs(both - limit) < 0.16 * error and abs(as_observed - limit) > 0.5 * error
