"""Uniaxial, equibiaxial and pure-shear tests: stress by the law and by the energy of the path, inversion, limits."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from analytical.exact.homogeneous import (
    MEASURES,
    MODES,
    HomogeneousError,
    Measure,
    Mode,
    cauchy_stress_mpa,
    nominal_stress_mpa,
    path_stretches,
    principal_stresses_mpa,
    pulled_directions,
    stored_energy_mpa,
    stress_curves,
    stretch_at_stress,
)
from analytical.laws.isotropic import IsotropicLaw, NeoHooke, Ogden, Yeoh
from tests.analytical.cases import every_law

STRETCHES = np.geomspace(0.3, 5.0, 25)

every_mode = pytest.mark.parametrize("mode", MODES)


@every_law
@every_mode
def test_nominal_stress_by_law_and_by_energy(law: IsotropicLaw, mode: Mode) -> None:
    by_law = nominal_stress_mpa(law, mode, STRETCHES)
    step = 1e-30
    energy = stored_energy_mpa(law, mode, STRETCHES + 1j * step)
    by_energy = energy.imag / step / pulled_directions(mode)
    # Both to round-off, against the stresses whose difference the nominal stress is.
    hessian = law.log_hessian_mpa(*path_stretches(mode, STRETCHES))
    scale = np.abs(hessian).max(axis=(1, 2)) / STRETCHES
    assert (np.abs(by_energy - by_law) / scale).max() < 1e-14


@every_law
@every_mode
@pytest.mark.parametrize("end", [0.5, 3.0])
def test_work_is_stored(law: IsotropicLaw, mode: Mode, end: float) -> None:
    points, weights = leggauss(40)
    half = 0.5 * (end - 1.0)
    work = half * np.sum(weights * nominal_stress_mpa(law, mode, 1.0 + half * (1.0 + points)))
    # 40 points integrate l^-13 on [0.5, 1] and l^5 on [1, 3] to round-off.
    assert pulled_directions(mode) * work == pytest.approx(float(stored_energy_mpa(law, mode, end)), rel=1e-12)


@every_law
# Second order in the strain vanishes in pure shear, whose stress is odd in ln l.
@pytest.mark.parametrize(
    ("mode", "modulus", "order"), [("uniaxial", 3, 1), ("equibiaxial", 6, 1), ("pure shear", 4, 2)]
)
def test_small_strain_moduli(law: IsotropicLaw, mode: Mode, modulus: int, order: int) -> None:
    strains = 0.02 / 2.0 ** np.arange(3)
    ratio = cauchy_stress_mpa(law, mode, np.exp(strains)) / (modulus * law.initial_shear_modulus_mpa * strains)
    errors = np.abs(ratio - 1.0)
    # (alpha strain)^order, alpha below 6
    assert errors[-1] < 6.0 * 0.005
    observed = np.log2(errors[:-1] / errors[1:])
    # The next power of the strain bends the slope by a few percent.
    assert observed == pytest.approx([order, order], abs=0.1)


@every_law
def test_paths_are_isochoric_and_free_on_the_sides(law: IsotropicLaw) -> None:
    for mode in MODES:
        stretches = path_stretches(mode, STRETCHES)
        # round-off
        assert np.prod(stretches, axis=0) == pytest.approx(1.0, abs=1e-15)
        stresses = principal_stresses_mpa(law, stretches, 2)
        assert np.array_equal(stresses[2], np.zeros(25))
        assert np.array_equal(stresses[0], cauchy_stress_mpa(law, mode, STRETCHES))
    uniaxial = principal_stresses_mpa(law, path_stretches("uniaxial", STRETCHES), 2)
    assert np.array_equal(uniaxial[1], np.zeros(25))
    equibiaxial = principal_stresses_mpa(law, path_stretches("equibiaxial", STRETCHES), 2)
    assert np.array_equal(equibiaxial[0], equibiaxial[1])


@every_law
def test_principal_stresses_permute_with_the_stretches(law: IsotropicLaw) -> None:
    stretches = (1.7, 0.8, 1.0 / (1.7 * 0.8))
    reference = principal_stresses_mpa(law, stretches, 1)
    for order in itertools.permutations(range(3)):
        l1, l2, l3 = (stretches[a] for a in order)
        turned = np.array(principal_stresses_mpa(law, (l1, l2, l3), order.index(1)))
        # The same numbers, but for the order of sums; stresses of 0.1 MPa cancel.
        assert np.abs(turned - np.array(reference)[list(order)]).max() < 1e-15


@every_law
def test_equibiaxial_pull_is_uniaxial_push(law: IsotropicLaw) -> None:
    # Hydrostatic stress apart, (l, l, l^-2) is compression to l^-2. Round-off of the powers.
    pulled = cauchy_stress_mpa(law, "equibiaxial", STRETCHES)
    assert -cauchy_stress_mpa(law, "uniaxial", STRETCHES**-2.0) == pytest.approx(pulled, rel=1e-12, abs=1e-15)


def test_neo_hooke_in_closed_form() -> None:
    l, mu = STRETCHES, 0.1
    exact = {"uniaxial": mu * (l - l**-2), "equibiaxial": mu * (l - l**-5), "pure shear": mu * (l - l**-3)}
    curves = stress_curves(NeoHooke(mu), l)
    for mode in MODES:
        # round-off of terms up to l^-5 = 411
        assert curves.nominal_mpa[mode] == pytest.approx(exact[mode], rel=1e-13, abs=1e-15)
        assert curves.cauchy_mpa[mode] == pytest.approx(l * exact[mode], rel=1e-13, abs=1e-15)
    assert np.array_equal(curves.stretch, l)


@every_law
@every_mode
@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("stretch", [0.4, 0.99, 1.3, 3.0])
def test_stretch_from_stress_inverts(law: IsotropicLaw, mode: Mode, measure: Measure, stretch: float) -> None:
    of_stretch = nominal_stress_mpa if measure == "nominal" else cauchy_stress_mpa
    stress = float(of_stretch(law, mode, stretch))
    # Round-off of the stress over its slope, which is of the size of the modulus.
    assert stretch_at_stress(law, mode, stress, measure) == pytest.approx(stretch, rel=1e-13)


def test_no_stress_no_stretch() -> None:
    assert stretch_at_stress(NeoHooke(0.1), "uniaxial", 0.0, "nominal") == 1.0


def test_first_maximum_is_met_and_named() -> None:
    # Ogden with alpha = 1/2 has nominal stress k alpha (l^-1/2 - l^-5/4), largest at l = 2.5^(4/3).
    law = Ogden(0.1, 0.5, "mu/alpha")
    peak = 2.5 ** (4.0 / 3.0)
    largest = 0.1 * (peak**-0.5 - peak**-1.25)
    # The stress is flat there: what is 1e-9 below it is sqrt(1e-9) away.
    assert stretch_at_stress(law, "uniaxial", largest * (1.0 - 1e-9), "nominal") == pytest.approx(peak, rel=1e-3)
    assert stretch_at_stress(law, "uniaxial", largest * (1.0 - 1e-9), "nominal") < peak
    with pytest.raises(HomogeneousError, match=r"first maximum .* at stretch 3\.393"):
        stretch_at_stress(law, "uniaxial", largest * (1.0 + 1e-9), "nominal")
    # The Cauchy stress of the same law has none.
    assert stretch_at_stress(law, "uniaxial", 1.5 * largest * peak, "cauchy") > peak


def test_maximum_of_a_softening_law() -> None:
    law = Yeoh((0.036, -0.003, 0.0001))
    # On a grid far finer than the search.
    l = np.linspace(1.0, 3.0, 200_001)
    nominal = nominal_stress_mpa(law, "equibiaxial", l)
    top = int(np.argmax(np.diff(nominal) < 0.0))
    assert stretch_at_stress(law, "equibiaxial", 0.999 * nominal[top], "nominal") < l[top]
    with pytest.raises(HomogeneousError, match="first maximum"):
        stretch_at_stress(law, "equibiaxial", 1.001 * nominal[top], "nominal")


def test_bad_input_is_refused() -> None:
    law = NeoHooke(0.1)
    with pytest.raises(HomogeneousError, match="stretch"):
        cauchy_stress_mpa(law, "uniaxial", [1.0, 0.0])
    with pytest.raises(HomogeneousError, match="stretch"):
        nominal_stress_mpa(law, "uniaxial", math.nan)
    with pytest.raises(HomogeneousError, match="mode"):
        cauchy_stress_mpa(law, "simple shear", 1.1)  # type: ignore[arg-type]
    with pytest.raises(HomogeneousError, match="free"):
        principal_stresses_mpa(law, (1.0, 1.0, 1.0), 3)
    with pytest.raises(HomogeneousError, match="finite"):
        stretch_at_stress(law, "uniaxial", math.inf, "nominal")
    with pytest.raises(HomogeneousError, match="measure"):
        stretch_at_stress(law, "uniaxial", 0.1, "true")  # type: ignore[arg-type]
    with pytest.raises(HomogeneousError, match="not reached"):
        stretch_at_stress(law, "uniaxial", 10.0, "nominal")
