"""The bent ring, against its limit for small moves, its energy, and what an inextensible line must keep."""

from __future__ import annotations

import numpy as np
import pytest

from analytical.exact.elastica import CRITICAL_LOAD, ElasticaError, bent_ring


def test_small_moves_rise_as_known() -> None:
    # 27/32 to second order in the mean move of the axes; the next order is d^2 of it
    for outward in (0.01, 0.02):
        ring = bent_ring(outward)
        mean = 0.5 * (ring.outward + ring.inward)
        assert (ring.load / CRITICAL_LOAD - 1.0) / mean**2 == pytest.approx(27.0 / 32.0, rel=5e-3)


def test_work_of_the_pressure_is_the_energy() -> None:
    # the second route: dU = -q dA, by central differences of second order
    for outward in (0.05, 0.15, 0.3):
        low, here, high = (bent_ring(outward + h) for h in (-1e-3, 0.0, 1e-3))
        assert -(high.energy - low.energy) / (high.area - low.area) == pytest.approx(here.load, rel=1e-4)


def test_small_bending_keeps_the_length() -> None:
    # what an axis moves out the other moves in, but for second order; the area falls by 3/2 pi d^2 (n = 2)
    ring = bent_ring(0.01)
    assert ring.inward == pytest.approx(ring.outward, rel=0.02)
    mean = 0.5 * (ring.outward + ring.inward)
    assert np.pi - ring.area == pytest.approx(1.5 * np.pi * mean**2, rel=1e-3)


def test_moves_out_of_range_are_refused() -> None:
    for outward in (0.0, -0.1, 0.4, float("nan")):
        with pytest.raises(ElasticaError, match="outward move"):
            bent_ring(outward)
