"""The twisted cylinder: torque and force by stress and by energy, kinematics by brute force, known results."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from analytical.exact.torsion import (
    TorsionError,
    TwistedCylinder,
    axial_force_n,
    cauchy_stress_mpa,
    free_axial_stretch,
    principal_stretches,
    stored_energy_n,
    torque_nmm,
)
from analytical.laws.isotropic import IsotropicLaw, NeoHooke, Ogden
from analytical.laws.numerical import EnergyLaw
from analytical.laws.silicones import DRAGON_SKIN_10
from tests.analytical.cases import LAWS, derivative, every_law

# surface shears psi A of 0.15, 1.5 and -6
STATES = tuple(TwistedCylinder(3.0, twist, stretch) for twist in (0.05, 0.5, -2.0) for stretch in (0.7, 1.0, 1.6))

every_state = pytest.mark.parametrize(("law", "state"), [(law, state) for law in LAWS for state in STATES])


def scale_mpa(state: TwistedCylinder, law: IsotropicLaw) -> float:
    """Largest stress difference in the cylinder, but no less than the shear modulus."""
    stretches = principal_stretches(state, np.linspace(0.0, state.radius_mm, 9))
    differences = [law.stress_difference(stretches[a], stretches[b], stretches[3 - a - b]) for a, b in ((1, 0), (1, 2))]
    return max(law.initial_shear_modulus_mpa, float(np.abs(differences).max()))


@every_state
def test_torque_by_stress_and_by_energy(law: IsotropicLaw, state: TwistedCylinder) -> None:
    by_energy = derivative(
        lambda twist: stored_energy_n(replace(state, twist_rad_per_mm=twist), law), state.twist_rad_per_mm
    )
    # The agreement asked for. At the smallest twist the energy of the axial stretch is 100 times that of the twist,
    # so the scale is that of the stresses.
    size = scale_mpa(state, law) * state.radius_mm**3
    assert by_energy == pytest.approx(torque_nmm(state, law), abs=1e-10 * size)


@every_state
def test_axial_force_by_stress_and_by_energy(law: IsotropicLaw, state: TwistedCylinder) -> None:
    by_energy = derivative(
        lambda stretch: stored_energy_n(replace(state, axial_stretch=stretch), law), state.axial_stretch
    )
    # the agreement asked for
    size = scale_mpa(state, law) * state.radius_mm**2
    assert by_energy == pytest.approx(axial_force_n(state, law), abs=1e-10 * size)


@every_state
def test_resultants_of_the_stresses(law: IsotropicLaw, state: TwistedCylinder) -> None:
    # The axial force without integration by parts, and the torque, from the stresses over the section.
    points, weights = np.polynomial.legendre.leggauss(60)
    radius = 0.5 * state.radius_mm * (1.0 + points)
    stress = cauchy_stress_mpa(state, law, radius)
    # r dr = R dR / lz
    area = math.pi * state.radius_mm * weights * radius / state.axial_stretch
    deformed = radius / math.sqrt(state.axial_stretch)
    size = scale_mpa(state, law) * state.radius_mm**3
    # Round-off, more where the inner quadrature divides small differences by a small radius.
    assert float(np.sum(area * stress.axial_mpa)) == pytest.approx(axial_force_n(state, law), abs=1e-12 * size)
    assert float(np.sum(area * deformed * stress.shear_mpa)) == pytest.approx(torque_nmm(state, law), abs=1e-12 * size)


@every_state
def test_stresses_are_those_of_the_spectral_form(law: IsotropicLaw, state: TwistedCylinder) -> None:
    for radius in (0.0, 1.0, 3.0):
        stretch = state.axial_stretch
        deformed = radius / math.sqrt(stretch)
        gradient = np.diag([stretch**-0.5, stretch**-0.5, stretch])
        gradient[1, 2] = deformed * state.twist_rad_per_mm
        vectors, values, _ = np.linalg.svd(gradient)
        mean = [
            (
                law.stress_difference(values[a], values[b], values[c])
                + law.stress_difference(values[a], values[c], values[b])
            )
            / 3.0
            for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        ]
        deviator = vectors @ np.diag(mean) @ vectors.T
        stress = cauchy_stress_mpa(state, law, radius)
        over_radial = deviator - deviator[0, 0] * np.eye(3)
        # Round-off; the directions are known to round-off over the difference of the stretches that it multiplies.
        size = 1e-13 * scale_mpa(state, law)
        assert float(stress.hoop_mpa - stress.radial_mpa) == pytest.approx(over_radial[1, 1], abs=size)
        assert float(stress.axial_mpa - stress.radial_mpa) == pytest.approx(over_radial[2, 2], abs=size)
        assert float(stress.shear_mpa) == pytest.approx(over_radial[1, 2], abs=size)
        stretches = np.sort([float(value) for value in principal_stretches(state, radius)])
        assert stretches == pytest.approx(np.sort(values), rel=1e-14)


@every_state
def test_stresses_are_in_equilibrium(law: IsotropicLaw, state: TwistedCylinder) -> None:
    at = 2.0
    stress = cauchy_stress_mpa(state, law, at)

    def radial(radius: float) -> float:
        return float(cauchy_stress_mpa(state, law, radius).radial_mpa)

    size = scale_mpa(state, law)
    # r d sigma_r / dr = R d sigma_r / dR; the agreement asked for, differences of order 8
    slope = at * derivative(radial, at)
    assert slope == pytest.approx(float(stress.hoop_mpa - stress.radial_mpa), abs=1e-10 * size)
    assert radial(state.radius_mm) == 0.0


@every_law
def test_smooth_at_the_axis(law: IsotropicLaw) -> None:
    state = TwistedCylinder(3.0, 0.5)
    radii = np.array([0.0, 1e-9, 1e-6])
    stress = cauchy_stress_mpa(state, law, radii)
    # Shear is mu psi R to first order; 1e-16 MPa is round-off of stresses of 0.1 MPa.
    shear = law.initial_shear_modulus_mpa * 0.5 * radii
    assert stress.shear_mpa == pytest.approx(shear, rel=1e-6, abs=1e-16)
    # Hoop and axial stress differ from the radial one in second order.
    for normal in (stress.hoop_mpa, stress.axial_mpa):
        assert normal == pytest.approx(stress.radial_mpa, abs=1e-12 * law.initial_shear_modulus_mpa + 1e-16)


def test_neo_hooke_in_closed_form() -> None:
    mu = 0.1
    for state in STATES:
        a, psi, stretch = state.radius_mm, state.twist_rad_per_mm, state.axial_stretch
        torque = math.pi * mu * psi * a**4 / (2.0 * stretch)
        force = math.pi * mu * (a**2 * (stretch - stretch**-2) - psi**2 * a**4 / (4.0 * stretch**2))
        # Rivlin 1949, here per undeformed length. Round-off.
        assert torque_nmm(state, NeoHooke(mu)) == pytest.approx(torque, rel=1e-13)
        size = mu * a**2 * (1.0 + (psi * a) ** 2)
        assert axial_force_n(state, NeoHooke(mu)) == pytest.approx(force, abs=1e-13 * size)
        # l_z^3 = 1 + (psi A)^2 / 4 without axial force
        free = free_axial_stretch(a, psi, NeoHooke(mu))
        assert free == pytest.approx((1.0 + 0.25 * (psi * a) ** 2) ** (1.0 / 3.0), rel=1e-13)


@every_law
def test_small_twist(law: IsotropicLaw) -> None:
    twists = 0.05 / 2.0 ** np.arange(3)
    a, mu = 2.0, law.initial_shear_modulus_mpa
    # Torsion of a linear rod, mu J psi with J = pi A^4 / 2; and Rivlin's second-order force, - pi psi^2 A^4 / 2 times
    # (c1 + 2 c2) of the Mooney law that agrees to third order: c1 + c2 = mu / 2, c1 - c2 = mu alpha / 4 for Ogden.
    # It vanishes at alpha = 6, so it is small for Dragon Skin 30. Yeoh laws are neo-Hooke, alpha = 2, to that order.
    alpha = law.alpha if isinstance(law, Ogden) else 2.0
    limits = (0.5 * math.pi * mu * a**4 * twists, -math.pi * mu * a**4 / 16.0 * (6.0 - alpha) * twists**2)
    for resultant, limit in zip((torque_nmm, axial_force_n), limits, strict=True):
        errors = np.abs(np.array([resultant(TwistedCylinder(a, twist), law) for twist in twists]) / limit - 1.0)
        if isinstance(law, NeoHooke):
            # Exact at any twist: round-off, of a force that is (psi A)^2 = 6e-4 of the stresses.
            assert errors.max() < 1e-12
        else:
            # Second order in psi A, the next power a few percent at 0.1.
            assert np.log2(errors[:-1] / errors[1:]) == pytest.approx([2.0, 2.0], abs=0.1)


@every_law
def test_sense_of_the_twist(law: IsotropicLaw) -> None:
    right, left = TwistedCylinder(3.0, 0.4, 1.2), TwistedCylinder(3.0, -0.4, 1.2)
    # mirror images: round-off at most
    assert torque_nmm(left, law) == pytest.approx(-torque_nmm(right, law), rel=1e-15)
    assert axial_force_n(left, law) == pytest.approx(axial_force_n(right, law), rel=1e-15)
    assert torque_nmm(right, law) > 0.0


@every_law
@pytest.mark.parametrize("twist", [0.05, 0.5, 1.5])
def test_free_cylinder(law: IsotropicLaw, twist: float) -> None:
    stretch = free_axial_stretch(3.0, twist, law)
    state = TwistedCylinder(3.0, twist, stretch)
    # Round-off of the force over its slope.
    assert axial_force_n(state, law) == pytest.approx(0.0, abs=1e-12 * scale_mpa(state, law) * 9.0)
    # Its energy is least among axial stretches: at 1 % either side it is more.
    energies = [stored_energy_n(replace(state, axial_stretch=stretch * ratio), law) for ratio in (0.99, 1.0, 1.01)]
    assert energies[1] < min(energies[0], energies[2])
    # Poynting: it grows longer, to second order for every alpha below 6 (test_small_twist).
    assert stretch > 1.0


def test_untwisted_is_uniaxial() -> None:
    law = DRAGON_SKIN_10
    state = TwistedCylinder(3.0, 0.0, 1.5)
    nominal = float(law.stress_difference(1.5, 1.5**-0.5, 1.5**-0.5)) / 1.5
    assert axial_force_n(state, law) == pytest.approx(nominal * math.pi * 9.0, rel=1e-14)  # round-off
    assert torque_nmm(state, law) == 0.0
    assert free_axial_stretch(3.0, 0.0, law) == 1.0


def test_energy_law_gives_the_same() -> None:
    bare = EnergyLaw(DRAGON_SKIN_10.energy)
    for state in STATES:
        # round-off of the complex step
        assert torque_nmm(state, bare) == pytest.approx(torque_nmm(state, DRAGON_SKIN_10), rel=1e-13)
        size = scale_mpa(state, bare) * 9.0
        assert axial_force_n(state, bare) == pytest.approx(axial_force_n(state, DRAGON_SKIN_10), abs=1e-13 * size)


def test_bad_input_is_refused() -> None:
    with pytest.raises(TorsionError, match="radius_mm"):
        TwistedCylinder(0.0, 0.1)
    with pytest.raises(TorsionError, match="twist"):
        TwistedCylinder(1.0, math.nan)
    with pytest.raises(TorsionError, match="axial_stretch"):
        TwistedCylinder(1.0, 0.1, -1.0)
    with pytest.raises(TorsionError, match="0 to 1 mm"):
        cauchy_stress_mpa(TwistedCylinder(1.0, 0.1), NeoHooke(0.1), [0.5, 1.1])
    # lz^3 = 1 + (psi A)^2 / 4: 63 at this twist
    with pytest.raises(TorsionError, match="prescribe the axial stretch"):
        free_axial_stretch(1.0, 1000.0, NeoHooke(0.1))
