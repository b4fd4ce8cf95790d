"""The bent block: free faces by symmetry and by energy, moment by stress and by energy, resultants, known results."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from analytical.exact.flexure import (
    BentBlock,
    FlexureError,
    cauchy_stress_mpa,
    hoop_stretch,
    moment_n,
    neutral_fibre_mm,
    radius_mm,
    stored_energy_n,
    unstressed_fibre_mm,
)
from analytical.laws.isotropic import IsotropicLaw, NeoHooke
from analytical.laws.numerical import EnergyLaw
from analytical.laws.silicones import DRAGON_SKIN_10
from tests.analytical.cases import LAWS, derivative, every_law

# k H of 0.02, 0.5, 1.26 and 4.7: nearly straight to a thick ring
BLOCKS = (
    BentBlock(2.0, 10.0, 0.1),
    BentBlock(5.0, 10.0, 1.0, 1.3),
    BentBlock(2.0, 10.0, 2.0 * math.pi),
    BentBlock(15.0, 20.0, 2.0 * math.pi, 0.8),
)

every_state = pytest.mark.parametrize(("law", "block"), [(law, block) for law in LAWS for block in BLOCKS])


def largest_stress_mpa(block: BentBlock, law: IsotropicLaw) -> float:
    faces = np.array([-0.5, 0.5]) * block.thickness_mm
    return float(np.abs(cauchy_stress_mpa(block, law, faces)).max())


@every_state
def test_moment_by_stress_and_by_energy(law: IsotropicLaw, block: BentBlock) -> None:
    # Ends that meet may not overlap: the derivative is one from below for a full ring.
    bent = replace(block, angle_rad=0.9 * block.angle_rad)
    by_energy = derivative(lambda angle: stored_energy_n(replace(bent, angle_rad=angle), law), bent.angle_rad, 5e-3)
    # The agreement asked for. Nearly straight blocks with an axial stretch store most of W in that.
    moment = moment_n(bent, law)
    assert by_energy == pytest.approx(moment, rel=1e-10, abs=1e-13 * stored_energy_n(bent, law) / bent.angle_rad)


@every_state
def test_faces_are_free_by_energy(law: IsotropicLaw, block: BentBlock) -> None:
    # At given curvature the sector may still move in or out, c in r^2 = 2 X / (k lz) + c: the energy must not change
    # with c, which knows nothing of stress or symmetry.
    points, weights = np.polynomial.legendre.leggauss(200)
    x = 0.5 * block.thickness_mm * points
    squares = hoop_stretch(block, x) ** 2
    inner = float(hoop_stretch(block, -0.5 * block.thickness_mm)) ** 2

    def energy(shift: float) -> float:
        hoop = np.sqrt(squares + (shift - 1.0) * inner)
        density = law.energy(1.0 / (block.axial_stretch * hoop), hoop, block.axial_stretch)
        return float(0.5 * block.thickness_mm * np.sum(weights * density))

    # 200 points are at round-off for the thick ring, whose inner face is at a tenth of its length; the slope is
    # relative to what each face contributes.
    scale = block.thickness_mm * max(law.initial_shear_modulus_mpa, largest_stress_mpa(block, law))
    assert derivative(energy, 1.0, 5e-3) == pytest.approx(0.0, abs=1e-10 * scale)


@every_state
def test_resultants(law: IsotropicLaw, block: BentBlock) -> None:
    inner, outer = (float(radius_mm(block, sign * 0.5 * block.thickness_mm)) for sign in (-1.0, 1.0))
    points, weights = np.polynomial.legendre.leggauss(120)
    radii = 0.5 * (outer + inner) + 0.5 * (outer - inner) * points
    # r^2 is linear in X
    x = block.thickness_mm * ((radii**2 - inner**2) / (outer**2 - inner**2) - 0.5)
    weighted = 0.5 * (outer - inner) * weights * cauchy_stress_mpa(block, law, x)[1]
    stress = largest_stress_mpa(block, law)
    # No force, and the moment about the centre without integration by parts: the agreement asked for. The moment of a
    # thin sector is thickness over radius times what its halves contribute.
    assert float(np.sum(weighted)) == pytest.approx(0.0, abs=1e-10 * stress * (outer - inner))
    moment = block.axial_stretch * float(np.sum(weighted * radii))
    assert moment == pytest.approx(moment_n(block, law), abs=1e-10 * stress * outer * (outer - inner))


@every_state
def test_radial_stress_by_equilibrium_and_by_energy(law: IsotropicLaw, block: BentBlock) -> None:
    x = np.linspace(-0.5, 0.5, 11) * block.thickness_mm
    hoop = hoop_stretch(block, x)
    energy = law.energy(1.0 / (block.axial_stretch * hoop), hoop, block.axial_stretch)
    radial = cauchy_stress_mpa(block, law, x)[0]
    # sigma_r = w - w(inner); round-off of the larger of stress and energy
    scale = max(largest_stress_mpa(block, law), float(np.abs(energy).max()))
    assert radial == pytest.approx(energy - energy[0], abs=1e-12 * scale)
    assert radial[[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-12 * scale)


@every_state
def test_hoop_stretch_is_isochoric_and_linear_in_the_radius(law: IsotropicLaw, block: BentBlock) -> None:
    x = np.linspace(-0.5, 0.5, 11) * block.thickness_mm
    hoop, radius = hoop_stretch(block, x), radius_mm(block, x)
    # inner times outer is 1 / lz for every law: round-off, more where the inner face is a tenth as long
    assert hoop[0] * hoop[-1] == pytest.approx(1.0 / block.axial_stretch, rel=1e-13)
    assert hoop == pytest.approx(radius * block.angle_rad / block.length_mm, rel=1e-14)
    # each lamina keeps its volume: angle / 2 d(r^2) lz = L dX; round-off of squares of the radius
    area = 0.5 * block.angle_rad * np.diff(radius**2) * block.axial_stretch
    assert area == pytest.approx(block.length_mm * np.diff(x), rel=1e-11)


@every_state
def test_fibres(law: IsotropicLaw, block: BentBlock) -> None:
    neutral = neutral_fibre_mm(block)
    bend = block.angle_rad / block.length_mm * block.thickness_mm
    closed = (1.0 - math.sqrt(1.0 + bend**2)) * 0.5 * block.thickness_mm / bend
    # round-off of the root beside 1 at the smallest k H, 0.02
    assert neutral == pytest.approx(closed, rel=1e-11)
    assert float(hoop_stretch(block, neutral)) == pytest.approx(block.axial_stretch**-0.5, rel=1e-14)
    radial, hoop, _ = (float(stress) for stress in cauchy_stress_mpa(block, law, neutral))
    stress = largest_stress_mpa(block, law)
    # stretches that agree to round-off
    assert hoop == pytest.approx(radial, abs=1e-13 * stress)
    assert radial < 0.0
    unstressed = unstressed_fibre_mm(block, law)
    assert neutral < unstressed < 0.5 * block.thickness_mm
    assert float(cauchy_stress_mpa(block, law, unstressed)[1]) == pytest.approx(0.0, abs=1e-13 * stress)


def test_neo_hooke_in_closed_form() -> None:
    mu = 0.1
    for block in BLOCKS:
        k = block.angle_rad / block.length_mm
        bend = k * block.thickness_mm
        # sigma_theta - sigma_r = (2 mu / lz) sinh y under the integral for the moment
        exact = mu / (2.0 * block.axial_stretch * k**2) * (bend * math.hypot(1.0, bend) - math.asinh(bend))
        # The closed form cancels: round-off over (k H)^2, 0.02 at least.
        assert moment_n(block, NeoHooke(mu)) == pytest.approx(exact, rel=1e-12 + 1e-15 / bend**2)


@every_law
def test_thin_block_is_a_plate(law: IsotropicLaw) -> None:
    thickness = 0.4 / 2.0 ** np.arange(3)
    mu, k = law.initial_shear_modulus_mpa, 0.1
    moments = np.array([moment_n(BentBlock(h, 10.0, 10.0 * k), law) for h in thickness])
    # E' I k with E' = 4 mu in plane strain, I = H^3 / 12
    errors = np.abs(moments / (mu * k * thickness**3 / 3.0) - 1.0)
    # Second order in k H = 0.04 to 0.01: the moment is odd in the curvature. Next power: alpha^2 (k H)^2 = 5 %.
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx([2.0, 2.0], abs=0.05)


@every_law
def test_moment_rises_with_the_angle(law: IsotropicLaw) -> None:
    angles = np.linspace(0.05, 2.0 * math.pi, 30)
    moments = [moment_n(BentBlock(5.0, 10.0, angle), law) for angle in angles]
    assert np.all(np.diff(moments) > 0.0)


def test_energy_law_gives_the_same() -> None:
    bare = EnergyLaw(DRAGON_SKIN_10.energy)
    for block in BLOCKS:
        # round-off of the complex step
        assert moment_n(block, bare) == pytest.approx(moment_n(block, DRAGON_SKIN_10), rel=1e-13)


def test_bad_input_is_refused() -> None:
    with pytest.raises(FlexureError, match="thickness_mm"):
        BentBlock(0.0, 1.0, 1.0)
    with pytest.raises(FlexureError, match="length_mm"):
        BentBlock(1.0, math.inf, 1.0)
    for angle in (0.0, 7.0, math.nan):
        with pytest.raises(FlexureError, match="angle_rad"):
            BentBlock(1.0, 1.0, angle)
    with pytest.raises(FlexureError, match="axial_stretch"):
        BentBlock(1.0, 1.0, 1.0, 0.0)
    with pytest.raises(FlexureError, match="half the thickness"):
        hoop_stretch(BentBlock(1.0, 1.0, 1.0), 0.6)
