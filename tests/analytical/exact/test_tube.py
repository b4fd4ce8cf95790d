"""The exact tube: two routes to pressure and force, equilibrium, inversion."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from analytical.exact.tube import (
    Tube,
    TubeError,
    axial_force_n,
    cauchy_stress_mpa,
    deformed_radius_mm,
    hydrostatic_pressure_mpa,
    inner_radius_at_outer_mm,
    inner_radius_at_pressure_mm,
    pressure_at_inner_radius_mpa,
    radial_displacement_mm,
    stored_energy_n,
)
from analytical.laws.isotropic import Law, NeoHooke
from analytical.laws.silicones import DRAGON_SKIN_10
from tests.analytical.cases import THREE_LAWS, derivative

TUBES = (Tube(10.0, 11.5), Tube(5.0, 7.0, 1.3), Tube(1.0, 8.0, 0.8))
# inner stretches a/A: collapsed, at rest in plane strain, inflated
INNER_STRETCHES = (0.7, 1.0, 1.4, 2.5)

every_state = pytest.mark.parametrize(
    ("law", "tube", "inner_stretch"),
    [(law, tube, stretch) for law in THREE_LAWS for tube in TUBES for stretch in INNER_STRETCHES],
)


def scale_mpa(tube: Tube, law: Law, inner_mm: float) -> float:
    """Size of the stress differences that add up to the pressure; near P = 0 they cancel."""
    radial, hoop, axial = cauchy_stress_mpa(tube, law, inner_mm, tube.inner_radius_mm)
    return max(law.initial_shear_modulus_mpa, *(abs(float(stress)) for stress in (radial, hoop, axial)))


@every_state
def test_pressure_by_stress_and_by_energy(law: Law, tube: Tube, inner_stretch: float) -> None:
    inner_mm = inner_stretch * tube.inner_radius_mm
    by_stress = pressure_at_inner_radius_mpa(tube, law, inner_mm)
    # dE = P d(pi a^2 lz) at fixed lz
    by_energy = derivative(lambda a: stored_energy_n(tube, law, a), inner_mm) / (
        2.0 * math.pi * inner_mm * tube.axial_stretch
    )
    # the agreement asked for; the energy of the thick tube is 60 times the work of its bore
    assert by_energy == pytest.approx(by_stress, abs=1e-10 * scale_mpa(tube, law, inner_mm), rel=1e-10)


@every_state
def test_axial_force_by_stress_by_energy_and_by_parts(law: Law, tube: Tube, inner_stretch: float) -> None:
    inner_mm = inner_stretch * tube.inner_radius_mm

    def energy(axial_stretch: float) -> float:
        return stored_energy_n(Tube(tube.inner_radius_mm, tube.outer_radius_mm, axial_stretch), law, inner_mm)

    force = axial_force_n(tube, law, inner_mm)
    outer_mm = float(deformed_radius_mm(tube, inner_mm, tube.outer_radius_mm))
    size = scale_mpa(tube, law, inner_mm) * math.pi * outer_mm**2
    # dE = N d(lz) at fixed a
    assert derivative(energy, tube.axial_stretch) == pytest.approx(force, abs=1e-10 * size)

    def axial_stress_times_2_pi_r(radius: float) -> float:
        # 2 pi r dr = 2 pi R dR / lz
        return float(cauchy_stress_mpa(tube, law, inner_mm, radius)[2]) * 2.0 * math.pi * radius / tube.axial_stretch

    direct = quad(axial_stress_times_2_pi_r, tube.inner_radius_mm, tube.outer_radius_mm, epsrel=1e-11)[0]
    assert direct == pytest.approx(force, abs=1e-10 * size)


@pytest.mark.parametrize("inner_stretch", [0.1, 0.5, 1.0, 2.0, 10.0])
@pytest.mark.parametrize("ratio", [1.1, 2.0, 20.0])
def test_neo_hooke_in_closed_form(inner_stretch: float, ratio: float) -> None:
    mu, inner, outer = 0.1, 3.0, 3.0 * ratio
    a = inner_stretch * inner
    c = a**2 - inner**2
    b = math.sqrt(outer**2 + c)
    exact = mu * (math.log(outer / inner) - math.log(b / a) + 0.5 * c * (1.0 / a**2 - 1.0 / b**2))
    pressure = pressure_at_inner_radius_mpa(Tube(inner, outer), NeoHooke(mu), a)
    # round-off of the terms, the largest of which is c / a^2
    assert pressure == pytest.approx(exact, abs=1e-13 * mu * (1.0 + abs(c) / a**2), rel=1e-13)


@every_state
def test_stresses_are_in_equilibrium(law: Law, tube: Tube, inner_stretch: float) -> None:
    inner_mm = inner_stretch * tube.inner_radius_mm
    ends = cauchy_stress_mpa(tube, law, inner_mm, [tube.inner_radius_mm, tube.outer_radius_mm])
    size = scale_mpa(tube, law, inner_mm)
    pressure = pressure_at_inner_radius_mpa(tube, law, inner_mm)
    # the same quadrature: round-off only
    assert ends[0] == pytest.approx([-pressure, 0.0], abs=1e-13 * size)
    middle = 0.5 * (tube.inner_radius_mm + tube.outer_radius_mm)
    h = 1e-4 * middle
    near = cauchy_stress_mpa(tube, law, inner_mm, [middle - h, middle, middle + h])
    radii = deformed_radius_mm(tube, inner_mm, [middle - h, middle, middle + h])
    slope = (near[0][2] - near[0][0]) / (radii[2] - radii[0])
    # eq. (5); central difference, truncation about (h / R)^2 times a few, relative to stress over radius
    assert slope == pytest.approx((near[1][1] - near[0][1]) / radii[1], abs=1e-6 * size / radii[1])


def test_hydrostatic_pressure_is_minus_the_mean_stress() -> None:
    radii = np.linspace(5.0, 7.0, 5)
    stresses = cauchy_stress_mpa(TUBES[1], DRAGON_SKIN_10, 7.0, radii)
    pressure = hydrostatic_pressure_mpa(TUBES[1], DRAGON_SKIN_10, 7.0, radii)
    assert pressure.shape == (5,)
    # the definition, in another order of summation
    assert pressure == pytest.approx(-np.mean(stresses, axis=0), abs=1e-15)


@every_state
def test_wall_area_is_kept(law: Law, tube: Tube, inner_stretch: float) -> None:
    inner_mm = inner_stretch * tube.inner_radius_mm
    radii = np.array([tube.inner_radius_mm, tube.outer_radius_mm])
    deformed = radii + radial_displacement_mm(tube, inner_mm, radii)
    # round-off
    assert tube.axial_stretch * (deformed[1] ** 2 - deformed[0] ** 2) == pytest.approx(
        radii[1] ** 2 - radii[0] ** 2, rel=1e-13
    )
    assert inner_radius_at_outer_mm(tube, float(deformed[1])) == pytest.approx(inner_mm, rel=1e-12)


@every_state
def test_radius_from_pressure_inverts(law: Law, tube: Tube, inner_stretch: float) -> None:
    inner_mm = inner_stretch * tube.inner_radius_mm
    pressure = pressure_at_inner_radius_mpa(tube, law, inner_mm)
    found = inner_radius_at_pressure_mm(tube, law, pressure)
    # round-off of the pressure over its slope; near the neo-Hookean plateau the slope is small
    assert found == pytest.approx(inner_mm, rel=1e-11)


def test_no_pressure_means_free_contraction() -> None:
    tube = Tube(5.0, 7.0, 1.44)
    inner_mm = inner_radius_at_pressure_mm(tube, NeoHooke(0.1), 0.0)
    assert inner_mm == pytest.approx(5.0 / 1.2, rel=1e-15)
    # 1e-16 MPa: round-off of stresses of 0.1 MPa
    assert pressure_at_inner_radius_mpa(tube, NeoHooke(0.1), inner_mm) == pytest.approx(0.0, abs=1e-15)


def test_pressure_beyond_the_plateau_is_refused() -> None:
    # neo-Hooke in plane strain tends to mu ln(B/A) from below
    tube, law = Tube(10.0, 15.0), NeoHooke(0.1)
    plateau = 0.1 * math.log(1.5)
    assert inner_radius_at_pressure_mm(tube, law, 0.99 * plateau) > 20.0
    with pytest.raises(TubeError, match="beyond what NeoHooke"):
        inner_radius_at_pressure_mm(tube, law, 1.01 * plateau)


def test_bad_input_is_refused() -> None:
    with pytest.raises(TubeError, match="radii"):
        Tube(5.0, 5.0)
    with pytest.raises(TubeError, match="radii"):
        Tube(math.nan, 5.0)
    with pytest.raises(TubeError, match="axial_stretch"):
        Tube(4.0, 5.0, 0.0)
    tube = Tube(4.0, 5.0)
    with pytest.raises(TubeError, match="inner radius"):
        pressure_at_inner_radius_mpa(tube, NeoHooke(0.1), -1.0)
    with pytest.raises(TubeError, match="no bore"):
        inner_radius_at_outer_mm(tube, 3.0)
    with pytest.raises(TubeError, match="finite"):
        inner_radius_at_pressure_mm(tube, NeoHooke(0.1), math.nan)
