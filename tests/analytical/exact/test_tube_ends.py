"""The exact tube with capped or free ends: stationary energy, Lame's and the membrane's limits, limit pressure."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from analytical.exact.search import first_solution
from analytical.exact.tube import (
    ENDS,
    Ends,
    Tube,
    TubeError,
    TubeState,
    axial_force_n,
    cauchy_stress_mpa,
    deformed_radius_mm,
    state_at_inner_radius,
    state_at_pressure,
    stored_energy_n,
)
from analytical.laws.isotropic import Law, NeoHooke
from analytical.laws.silicones import DRAGON_SKIN_10
from tests.analytical.cases import THREE_LAWS, derivative, each_of_three_laws

TUBES = (Tube(10.0, 10.5), Tube(5.0, 7.0), Tube(1.0, 8.0))
# inner stretches a/A: collapsed, at rest, inflated
INNER_STRETCHES = (0.7, 1.0, 1.4, 2.5)

every_ends = pytest.mark.parametrize("ends", ENDS)
every_state = pytest.mark.parametrize(
    ("law", "tube", "inner_stretch"),
    [(law, tube, stretch) for law in THREE_LAWS for tube in TUBES for stretch in INNER_STRETCHES],
)


def scale_mpa(state: TubeState, law: Law) -> float:
    stresses = cauchy_stress_mpa(state.tube, law, state.inner_mm, state.tube.inner_radius_mm)
    return max(law.initial_shear_modulus_mpa, *(abs(float(stress)) for stress in stresses))


@every_state
@every_ends
def test_potential_energy_is_stationary(law: Law, tube: Tube, inner_stretch: float, ends: Ends) -> None:
    state = state_at_inner_radius(tube, law, inner_stretch * tube.inner_radius_mm, ends)
    a, stretch, pressure = state.inner_mm, state.tube.axial_stretch, state.pressure_mpa
    by_radius = derivative(lambda at: stored_energy_n(state.tube, law, at), a)
    by_stretch = derivative(lambda at: stored_energy_n(replace(tube, axial_stretch=at), law, a), stretch)
    wall_mm = float(deformed_radius_mm(state.tube, a, tube.outer_radius_mm))
    size = scale_mpa(state, law)
    # The work of the pressure on the bore, P 2 pi a lz da, and on the caps, P pi a^2 dlz: together P d(pi a^2 lz).
    # 1e-10: the agreement asked for, of stresses; the energy of the thick tube is 60 times the work of its bore
    assert by_radius == pytest.approx(2.0 * math.pi * a * stretch * pressure, abs=1e-10 * size * 2.0 * math.pi * a)
    caps = math.pi * a**2 * pressure if ends == "capped" else 0.0
    assert by_stretch == pytest.approx(caps, abs=1e-10 * size * math.pi * wall_mm**2)


@every_state
@every_ends
def test_axial_force_is_what_the_ends_carry(law: Law, tube: Tube, inner_stretch: float, ends: Ends) -> None:
    state = state_at_inner_radius(tube, law, inner_stretch * tube.inner_radius_mm, ends)
    thrust = math.pi * state.inner_mm**2 * state.pressure_mpa if ends == "capped" else 0.0
    wall_mm = float(deformed_radius_mm(state.tube, state.inner_mm, tube.outer_radius_mm))
    # round-off of the root times the stiffness
    assert axial_force_n(state.tube, law, state.inner_mm) == pytest.approx(
        thrust, abs=1e-13 * scale_mpa(state, law) * math.pi * wall_mm**2
    )


@each_of_three_laws
@pytest.mark.parametrize("inner_stretch", [0.7, 1.4])
@every_ends
def test_state_from_pressure_inverts(law: Law, inner_stretch: float, ends: Ends) -> None:
    tube = TUBES[1]
    state = state_at_inner_radius(tube, law, inner_stretch * tube.inner_radius_mm, ends)
    found = state_at_pressure(tube, law, state.pressure_mpa, ends)
    # round-off of the pressure over its slope
    assert found.inner_mm == pytest.approx(state.inner_mm, rel=1e-11)
    assert found.tube.axial_stretch == pytest.approx(state.tube.axial_stretch, rel=1e-11)


@every_ends
def test_rest_has_no_pressure_and_no_stretch(ends: Ends) -> None:
    # the axial stretch given with the tube plays no part
    state = state_at_pressure(Tube(5.0, 7.0, 1.3), DRAGON_SKIN_10, 0.0, ends)
    # round-off
    assert (state.inner_mm, state.tube.axial_stretch) == pytest.approx((5.0, 1.0), rel=1e-14)


@every_ends
def test_small_pressure_is_lames_tube(ends: Ends) -> None:
    tube, law = TUBES[1], DRAGON_SKIN_10
    mu, a2, b2 = law.initial_shear_modulus_mpa, tube.inner_radius_mm**2, tube.outer_radius_mm**2
    pressures = 1e-3 * mu * np.array([1.0, 0.5, 0.25])
    states = [state_at_pressure(tube, law, p, ends) for p in pressures]
    # Lame with nu = 1/2, E = 3 mu: sigma_r + sigma_theta = 2 k; the caps add sigma_z = k
    k = pressures * a2 / (b2 - a2)
    axial = np.zeros(3) if ends == "capped" else -k / (3.0 * mu)
    # u(A) / A = (sigma_theta - (sigma_r + sigma_z) / 2) / E with sigma_theta = k (1 + B^2/A^2), sigma_r = -P
    sigma_z = k if ends == "capped" else 0.0
    hoop = (k * (1.0 + b2 / a2) + 0.5 * pressures - 0.5 * sigma_z) / (3.0 * mu)
    gaps = np.array([[s.tube.axial_stretch - 1.0 for s in states], [s.inner_mm / 5.0 - 1.0 for s in states]])
    gaps -= np.array([axial, hoop])
    orders = np.log2(gaps[:, :-1] / gaps[:, 1:])
    # the next term of the expansion is quadratic, the one after about 1e-3 of it; measured 2.0003 to 2.0022
    assert orders == pytest.approx(2.0, abs=0.01)


@pytest.mark.parametrize("hoop", [0.7, 1.5, 3.0])
# Free ends leave sigma_z = 0 beside sigma_r = -P/2 on average, which is O(t); with caps the same -P/2 is in
# the thrust on the bore, smaller than that on the middle of the wall, and only O(t^2) remains.
@pytest.mark.parametrize(("ends", "order"), [("capped", 2.0), ("free", 1.0)])
def test_thin_wall_is_the_membrane(ends: Ends, order: float, hoop: float) -> None:
    law = DRAGON_SKIN_10

    def membrane_mpa(axial: float) -> float:
        """Axial stress less what the ends ask of it: half the hoop stress (caps) or none, with sigma_r = 0."""
        radial = 1.0 / (hoop * axial)
        hoop_mpa = law.stress_difference(hoop, radial, axial)
        return float(law.stress_difference(axial, radial, hoop) - (0.5 * hoop_mpa if ends == "capped" else 0.0))

    # the bracket holds one root for every law whose stresses grow with stretch
    exact = brentq(membrane_mpa, 0.3, 4.0, xtol=1e-15)
    if ends == "free":
        # uniaxial tension along the hoop
        assert exact == pytest.approx(hoop**-0.5, rel=1e-13)
    gaps = []
    for thickness in (0.004, 0.002, 0.001):
        tube = Tube(1.0 - 0.5 * thickness, 1.0 + 0.5 * thickness)

        def excess(inner: float, tube: Tube = tube) -> float:
            """Hoop stretch of the middle of the wall, less the one asked for."""
            state = state_at_inner_radius(tube, law, inner, ends)
            return float(deformed_radius_mm(state.tube, inner, 1.0)) - hoop

        inner = brentq(excess, 0.8 * hoop, 1.1 * hoop, xtol=1e-14)
        gaps.append(state_at_inner_radius(tube, law, inner, ends).tube.axial_stretch - exact)
    orders = np.log2(np.array(gaps[:-1]) / np.array(gaps[1:]))
    # the next order is t = 1e-3 smaller; measured within 0.003
    assert orders == pytest.approx(order, abs=0.01)


def test_pressure_is_followed_to_its_maximum_and_refused_beyond() -> None:
    tube, law = TUBES[1], NeoHooke(0.1)

    def pressure(inner: float) -> float:
        return state_at_inner_radius(tube, law, inner, "capped").pressure_mpa

    # a slope is zero where the central difference of order 8 is: at the maximum to 1e-13
    limit = brentq(lambda a: derivative(pressure, a), 6.0, 12.0, rtol=1e-12)
    largest = pressure(limit)
    with pytest.raises(TubeError, match="beyond what NeoHooke") as refused:
        state_at_pressure(tube, law, (1.0 + 1e-8) * largest, "capped")
    # the message gives six digits
    assert float(str(refused.value).split("largest met: ")[1].split()[0]) == pytest.approx(largest, rel=1e-5)
    # a square root ends the branch: 1e-8 below the largest pressure is 1e-4 short of its radius, and no more
    state = state_at_pressure(tube, law, (1.0 - 1e-8) * largest, "capped")
    assert (1.0 - 1e-3) * limit < state.inner_mm < limit


def test_first_solution_is_the_first_and_sees_a_maximum_between_two_steps() -> None:
    def hump(x: float) -> float:
        """Maximum 1/e at x = 1; rises again beyond its minimum, past every value."""
        return x * math.exp(-x) + (max(0.0, x - 6.0)) ** 2

    top = math.exp(-1.0)
    found, _ = first_solution(hump, 0.1, (0.01, 5.0), (1.0 - 1e-9) * top)
    # 1 - x = sqrt(2e-9) to leading order
    assert found is not None and 1.0 - found == pytest.approx(math.sqrt(2e-9), rel=1e-3)
    missed, furthest = first_solution(hump, 0.1, (0.01, 5.0), 1.01 * top)
    assert missed is None
    assert furthest == pytest.approx(top, rel=1e-14)  # flat there: round-off
    beyond, _ = first_solution(hump, 0.1, (0.01, 50.0), 2.0 * top)
    assert beyond is not None and beyond > 6.0
    down, _ = first_solution(hump, 0.5, (0.01, 50.0), hump(0.2))
    assert down == pytest.approx(0.2, rel=1e-13)  # round-off


def test_bad_input_is_refused() -> None:
    tube = TUBES[1]
    with pytest.raises(TubeError, match="ends = 'open' is unknown"):
        state_at_inner_radius(tube, NeoHooke(0.1), 6.0, "open")  # type: ignore[arg-type]
    with pytest.raises(TubeError, match="finite"):
        state_at_pressure(tube, NeoHooke(0.1), math.inf, "free")
    with pytest.raises(TubeError, match="inner radius"):
        state_at_inner_radius(tube, NeoHooke(0.1), 0.0, "free")
    # a capped membrane lengthens by 0.7 of its hoop stretch: here by more than 50
    with pytest.raises(TubeError, match="no axial stretch from 0.02 to 50 balances capped ends"):
        state_at_inner_radius(tube, NeoHooke(0.1), 500.0, "capped")
