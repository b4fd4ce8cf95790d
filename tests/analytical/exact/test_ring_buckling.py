"""Buckling of rings: shooting against the second variation, moduli against the energy, thin and thick limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

import analytical.exact.ring
from analytical.exact.ring import (
    LOADS,
    Load,
    RingError,
    buckling_determinant,
    critical_pressure_mpa,
    first_buckling,
    incremental_moduli_mpa,
    second_variation_mpa,
    thin_ring_pressure_mpa,
    unstable_modes,
)
from analytical.exact.tube import Tube, pressure_at_inner_radius_mpa
from analytical.laws.isotropic import IsotropicLaw, NeoHooke, Ogden
from analytical.laws.numerical import EnergyLaw
from analytical.laws.silicones import DRAGON_SKIN_10
from tests.analytical.cases import SECOND_DIFFERENCE, every_law

TUBES = (Tube(10.0, 12.0), Tube(10.0, 10.2), Tube(5.0, 7.0, 1.2), Tube(1.0, 3.0, 0.8))

every_load = pytest.mark.parametrize("load", LOADS)


def pressure_by_ritz_mpa(tube: Tube, law: IsotropicLaw, waves: int, load: Load, near_mm: float) -> float:
    """Pressure at which the least eigenvalue of the second variation vanishes, sought around an inner radius."""
    rest = tube.inner_radius_mm / math.sqrt(tube.axial_stretch)
    # A tenth of the way to rest on either side.
    span = 0.1 * (rest - near_mm)

    def least(inner_mm: float) -> float:
        return float(np.linalg.eigvalsh(second_variation_mpa(tube, law, inner_mm, waves, load))[0])

    inner = brentq(least, near_mm - span, near_mm + span, xtol=1e-15 * rest, rtol=4.0 * np.finfo(float).eps)
    return -pressure_at_inner_radius_mpa(tube, law, inner)


@every_load
@pytest.mark.parametrize("waves", [2, 3, 7])
@pytest.mark.parametrize("tube", TUBES, ids=str)
@every_law
def test_pressure_by_shooting_and_by_second_variation(law: IsotropicLaw, tube: Tube, waves: int, load: Load) -> None:
    state = first_buckling(tube, law, waves, load)
    by_ritz = pressure_by_ritz_mpa(tube, law, waves, load, state.inner_mm)
    # The agreement asked for. The thinnest ring buckles at a strain of 1e-4: what 1e-16 of its radius is in pressure.
    assert by_ritz == pytest.approx(state.pressure_mpa, rel=1e-10)
    # Stable a little before, one unstable mode a little after (a percent of the way from rest).
    rest = tube.inner_radius_mm / math.sqrt(tube.axial_stretch)
    step = 0.01 * (rest - state.inner_mm)
    counts = [unstable_modes(tube, law, state.inner_mm + side * step, waves, load) for side in (1.0, -1.0)]
    assert counts == [0, 1]


@every_law
def test_moduli_are_second_derivatives_of_the_energy(law: IsotropicLaw) -> None:
    h = 0.02
    random = np.random.default_rng(3)
    # Unequal, equal and nearly equal in-plane stretches.
    for radial, hoop in ((1.4, 0.7), (0.8, 1.1), (1.1, 1.1), (1.0, 1.0 - 1e-9)):
        axial = 1.0 / (radial * hoop)
        difference = float(law.stress_difference(radial, hoop, axial))
        hydrostatic = 0.3 * law.initial_shear_modulus_mpa
        stress = np.diag([hydrostatic + difference, hydrostatic])
        moduli = incremental_moduli_mpa(law, radial, hoop, stress[0, 0], stress[1, 1])
        for _ in range(4):
            rr, rt, tr = random.uniform(-0.7, 0.7, 3)
            increment = np.array([[rr, rt], [tr, -rr]])
            stretched = [expm(k * h * increment) @ np.diag([radial, hoop]) for k in range(-4, 5)]
            values = np.linalg.svd(np.array(stretched), compute_uv=False)
            energy = law.energy(values[:, 0], values[:, 1], axial)
            curvature = sum(SECOND_DIFFERENCE[abs(k)] * energy[k + 4] for k in range(-4, 5)) / h**2
            # exp(eps L) F keeps the volume, and bends away from F + eps L F by eps^2 L^2 F / 2, on which sigma works.
            exact = curvature - np.trace(stress @ increment @ increment)
            vector = np.array([rr, rt, tr])
            # The agreement asked for: round-off of the energy 1e-16 / h^2 = 3e-13 with a few terms, truncation
            # (alpha h)^8 / 3150 = 1e-10 of one percent at alpha = 6.
            scale = np.abs(law.log_hessian_mpa(radial, hoop, axial)).max()
            assert vector @ moduli @ vector == pytest.approx(float(exact), abs=1e-10 * scale)


def test_follower_and_dead_at_ten_to_twelve() -> None:
    law, tube = NeoHooke(0.1), Tube(10.0, 12.0)
    follower, dead = (first_buckling(tube, law, 2, load) for load in LOADS)
    # Known: about 12 % between the two for this ring, not the third of thin ones; whichever pressure is compared.
    assert dead.pressure_mpa / follower.pressure_mpa == pytest.approx(1.12, abs=0.01)
    assert dead.nominal_pressure_mpa / follower.nominal_pressure_mpa == pytest.approx(1.12, abs=0.01)
    # Both routes agree on it, so it is kept to the digits they share.
    assert dead.pressure_mpa / follower.pressure_mpa == pytest.approx(1.12522727, abs=1e-8)
    # Force per undeformed area: circumferences b and B.
    assert dead.nominal_pressure_mpa == pytest.approx(dead.pressure_mpa * dead.outer_mm / 12.0, rel=1e-15)


@every_law
@pytest.mark.parametrize("waves", [2, 3])
@pytest.mark.parametrize(("load", "order"), [("follower", 2), ("dead", 1)])
def test_thin_ring_limit(law: IsotropicLaw, waves: int, load: Load, order: int) -> None:
    tubes = [Tube(10.0 * (1.0 - 0.5 * t), 10.0 * (1.0 + 0.5 * t)) for t in (0.04, 0.02, 0.01)]
    errors = np.array(
        [
            abs(critical_pressure_mpa(tube, law, waves, load) / thin_ring_pressure_mpa(tube, law, waves, load) - 1.0)
            for tube in tubes
        ]
    )
    # The least order that a ratio of lengths allows under dead pressure, where it matters that the force acts outside
    # the middle line; under follower pressure the first order is not there. The next power is a few percent.
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx([order, order], abs=0.1)
    # 1 and 20 times (t / R)^order at most
    assert errors[-1] < (20.0 * 1e-4 if order == 2 else 1e-2)


def test_dead_to_follower_ratio_of_thin_rings() -> None:
    law = NeoHooke(0.1)
    for waves, limit in ((2, 4.0 / 3.0), (3, 9.0 / 8.0)):
        ratios = []
        for thickness in (0.02, 0.01):
            tube = Tube(10.0 * (1.0 - 0.5 * thickness), 10.0 * (1.0 + 0.5 * thickness))
            ratios.append(
                critical_pressure_mpa(tube, law, waves, "dead") / critical_pressure_mpa(tube, law, waves, "follower")
            )
        # First order in the thickness: extrapolated, what is left is second order, 1e-4 with a factor of a few.
        assert 2.0 * ratios[1] - ratios[0] == pytest.approx(limit, abs=5e-4)


@every_load
def test_many_waves_are_wrinkles_of_the_inner_surface(load: Load) -> None:
    # Biot 1963: a neo-Hooke half-space in plane strain wrinkles at the stretch l with l^6 + l^4 + 3 l^2 = 1, whatever
    # happens at the far side.
    biot = math.sqrt(brentq(lambda x: x**3 + x**2 + 3.0 * x - 1.0, 0.0, 1.0, xtol=1e-15))
    assert biot == pytest.approx(0.5437, abs=5e-5)  # as printed
    gaps = np.array([first_buckling(Tube(1.0, 3.0), NeoHooke(0.1), n, load).inner_mm - biot for n in (30, 60, 120)])
    assert np.all(gaps > 0.0)
    # The surface is round: first order in the wavelength over the radius, to 1 from below at these n.
    orders = np.log2(gaps[:-1] / gaps[1:])
    assert orders[0] < orders[1] < 1.0
    assert orders[1] == pytest.approx(1.0, abs=0.15)


@every_law
@every_load
def test_stable_at_rest_and_inflated(law: IsotropicLaw, load: Load) -> None:
    for tube in TUBES:
        rest = tube.inner_radius_mm / math.sqrt(tube.axial_stretch)
        for ratio in (1.0, 1.1):
            assert [unstable_modes(tube, law, ratio * rest, waves, load) for waves in (2, 3, 7)] == [0, 0, 0]
            assert buckling_determinant(tube, law, ratio * rest, 2, load) > 0.0


def test_plane_strain_does_not_know_the_sign_of_the_exponent() -> None:
    # At lz = 1, l^alpha + l^-alpha is the same energy for both; the two routes' coefficients are not.
    tube = Tube(10.0, 13.0)
    for load in LOADS:
        pressures = [critical_pressure_mpa(tube, Ogden(0.1, alpha, "2mu/alpha^2"), 2, load) for alpha in (5.0, -5.0)]
        # round-off over the strain at buckling, 2 %
        assert pressures[0] == pytest.approx(pressures[1], rel=1e-12)


def test_scales() -> None:
    small = critical_pressure_mpa(Tube(1.0, 1.3), NeoHooke(0.1), 2, "follower")
    # Only the ratio of the radii and the modulus matter: round-off over the strain at buckling, 2 %.
    assert critical_pressure_mpa(Tube(20.0, 26.0), NeoHooke(0.7), 2, "follower") == pytest.approx(
        7.0 * small, rel=1e-12
    )


def test_energy_law_gives_the_same() -> None:
    bare, tube = EnergyLaw(DRAGON_SKIN_10.energy), Tube(10.0, 12.0)
    state = first_buckling(tube, bare, 2, "follower")
    # Differences in EnergyLaw (1e-13) over the strain at buckling (1e-2).
    assert state.pressure_mpa == pytest.approx(critical_pressure_mpa(tube, DRAGON_SKIN_10, 2, "follower"), rel=1e-10)
    assert pressure_by_ritz_mpa(tube, bare, 2, "follower", state.inner_mm) == pytest.approx(
        state.pressure_mpa, rel=1e-10
    )


def test_second_variation_is_symmetric() -> None:
    matrix = second_variation_mpa(TUBES[2], DRAGON_SKIN_10, 4.4, 3, "follower")
    assert matrix.shape == (32, 32)
    assert np.array_equal(matrix, matrix.T)


def test_what_does_not_buckle_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    tube, law = Tube(1.0, 3.0), NeoHooke(0.1)
    with pytest.raises(RingError, match="waves = 1"):
        first_buckling(tube, law, 1, "dead")
    with pytest.raises(RingError, match="load"):
        critical_pressure_mpa(tube, law, 2, "gas")  # type: ignore[arg-type]
    with pytest.raises(RingError, match="too thin"):
        first_buckling(Tube(10.0, 10.0001), law, 2, "follower")
    # It does at 0.67, so it is not found before 0.7.
    monkeypatch.setattr(analytical.exact.ring, "INNER_STRETCH_MIN", 0.7)
    with pytest.raises(RingError, match="does not buckle into 2 waves"):
        first_buckling(tube, law, 2, "follower")
