"""The inflated flat sheet: balance as a whole, small strains, scaling (energy and volume: `studies/two_routes.py`)."""

from __future__ import annotations

import math

import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from analytical.exact.flat_sheet import FlatSheet, SheetError, at_pressure, inflated, tensions
from analytical.laws.isotropic import NeoHooke
from analytical.laws.of_invariants import Gent, MooneyRivlin

SHEET = FlatSheet(50.0, 0.25)
LAWS = [NeoHooke(0.4), MooneyRivlin((0.1713, 0.0047, 0.0, 0.0, 0.0))]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("stretch", [1.001, 1.3, 2.5])
def test_the_rim_carries_the_pressure(law, stretch: float) -> None:
    state = inflated(SHEET, law, stretch)
    tension = SHEET.thickness_mm * tensions(law, state.rim_stretch, 1.0)[0]
    held = 2.0 * math.pi * SHEET.radius_mm * tension * math.sin(state.rim_slope)
    assert held == pytest.approx(math.pi * SHEET.radius_mm**2 * state.pressure_mpa, rel=1e-9)


def test_a_shallow_sheet_follows_hencky() -> None:
    mu = 0.4
    state = inflated(SHEET, NeoHooke(mu), 1.00001)
    load = state.pressure_mpa * SHEET.radius_mm / (3.0 * mu * SHEET.thickness_mm)
    # strains of 1e-5, and of the height's square, which is 1e-5 too
    assert state.height_mm / SHEET.radius_mm == pytest.approx(hencky_height(0.5) * load ** (1.0 / 3.0), rel=1e-4)


def hencky_height(nu: float) -> float:
    """Height over radius of a clamped film at q a = E t, by Föppl and Hencky's equations.

    r (r N')' + 2 r N' = -q^2 r^2 E t / (8 N^2), N w' = -q r / 2 (Hencky, Z. Math. Phys. 63 (1915) 311), with no
    displacement at the rim: (1 - nu) N + N' = 0. The film is that of small strains: no law, no large slope.
    """
    start = 1e-6

    def film(at_pole: float) -> tuple[float, float]:
        found = solve_ivp(
            lambda r, y: (y[1], -1.0 / (8.0 * y[0] ** 2) - 3.0 * y[1] / r, r / (2.0 * y[0])),
            (start, 1.0),
            (at_pole, -start / (32.0 * at_pole**2), 0.0),
            rtol=1e-10,
            atol=1e-12,
        )
        tension, slope, height = found.y[:, -1]
        return (1.0 - nu) * tension + slope, height

    return film(brentq(lambda at_pole: film(at_pole)[0], 0.3, 0.6))[1]


@pytest.mark.parametrize("law", LAWS)
def test_the_state_at_a_pressure_is_the_first(law) -> None:
    state = at_pressure(SHEET, law, 3.5e-3)
    assert state.pressure_mpa == pytest.approx(3.5e-3, rel=1e-9)
    below = [inflated(SHEET, law, 1.0 + share * (state.pole_stretch - 1.0)).pressure_mpa for share in (0.3, 0.9, 0.99)]
    assert below == sorted(below) and below[-1] < 3.5e-3


@pytest.mark.parametrize("mu", [4e-4, 40.0])
def test_lengths_and_moduli_scale(mu: float) -> None:
    one, other = inflated(SHEET, NeoHooke(0.4), 1.7), inflated(FlatSheet(5.0, 0.05), NeoHooke(mu), 1.7)
    assert other.pressure_mpa == pytest.approx(2.0 * mu / 0.4 * one.pressure_mpa, rel=1e-9)
    assert other.height_mm == pytest.approx(0.1 * one.height_mm, rel=1e-9)
    assert other.energy_mj == pytest.approx(2e-3 * mu / 0.4 * one.energy_mj, rel=1e-9)


def test_refusals() -> None:
    law = NeoHooke(0.4)
    for attempt, said in (
        (lambda: FlatSheet(50.0, 0.0), "thickness 0 mm"),
        (lambda: inflated(SHEET, law, 1.0), "need 1 < stretch"),
        (lambda: inflated(SHEET, Gent(0.07, 3.0), 2.0), "tension there is inf"),
        (lambda: at_pressure(SHEET, law, 0.0), "need more than"),
        (lambda: at_pressure(SHEET, law, 1.0), "at the pole is 0.00375835"),
    ):
        with pytest.raises(SheetError, match=said):
            attempt()
