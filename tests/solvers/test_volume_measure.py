"""What volumes are measured by: the cavity where there is one, what the load sweeps where the surface is a sheet."""

from __future__ import annotations

import math

import pytest

from solvers.assembly.volumes import volume_measure

DISC_MM2, SPHERE_MM3 = math.pi * 100.0**2, math.pi / 6.0 * 100.0**3  # a sphere of half the radius has the same surface


@pytest.mark.parametrize("unloaded", [0.5e6, -0.5e6, 3.0e6, 0.06e6])
def test_a_cavity_is_its_own_measure_whichever_side_is_loaded(unloaded: float) -> None:
    assert volume_measure(unloaded, DISC_MM2) == (0.0, abs(unloaded))


@pytest.mark.parametrize("unloaded", [0.0, 1e-9, 2.0e4, -2.0e4, 1e9, -1e9])
def test_a_sheet_is_measured_by_the_sphere_of_its_area_and_counts_from_where_it_is(unloaded: float) -> None:
    start, unit = volume_measure(unloaded, DISC_MM2)
    assert start == unloaded
    assert unit == pytest.approx(SPHERE_MM3, rel=1e-12)
