"""Laws against their own energies, the stability check, the constants."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest

from analytical.laws.errors import MaterialError
from analytical.laws.isotropic import Law, NeoHooke, Ogden, OgdenSeries, Yeoh
from analytical.laws.of_invariants import ArrudaBoyce, Gent, MooneyRivlin
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from analytical.laws.stability import check_stability
from analytical.laws.stiff import PLA, POLYETHYLENE, StiffSolid

LAWS: tuple[Law, ...] = (
    NeoHooke(0.1),
    DRAGON_SKIN_10,
    Yeoh((0.036,)),
    Yeoh((0.036, -0.003, 0.0001)),
    dragon_skin_30("2mu/alpha^2"),
    dragon_skin_30("mu/alpha"),
    Ogden(-0.1, -3.0, "mu/alpha"),
    OgdenSeries((0.63, 0.0012, -0.01), (1.3, 5.0, -2.0), "mu/alpha"),
    OgdenSeries((0.05, -0.002), (2.0, 4.0), "2mu/alpha^2"),
    MooneyRivlin((0.08, 0.02)),
    MooneyRivlin((0.08, 0.02, 0.001)),
    MooneyRivlin((0.08, -0.01, 0.003, -0.0005, 0.0002)),
    Gent(0.1, 40.0),
    ArrudaBoyce(0.1, 3.0),
)
# Softens although its dW/dI1 = 36 - 6 x + 0.3 x^2 kPa, x = I1 - 3, has no root.
SOFTENING = Yeoh((0.036, -0.003, 0.0001))


def stretches(seed: int, count: int = 20) -> np.ndarray[Any, Any]:
    """Random incompressible stretches, shape (3, count)."""
    logs = np.random.default_rng(seed).uniform(-0.8, 0.8, (2, count))
    return np.asarray(np.exp(np.vstack([logs, -logs.sum(axis=0)])))


def log_gradient(law: Law, at: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """l_a dW/dl_a by complex step, shape (3, count), MPa: no subtraction, so exact to round-off."""
    step = 1e-30
    columns = []
    for a in range(3):
        moved = at.astype(complex)
        moved[a] *= np.exp(1j * step)
        columns.append(law.energy(*moved).imag / step)
    return np.array(columns)


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_stress_difference_is_energy_derivative(law: Law) -> None:
    at = stretches(1)
    gradient = log_gradient(law, at)
    scale = np.abs(gradient).max()
    for a, b, c in itertools.permutations(range(3)):
        difference = law.stress_difference(at[a], at[b], at[c])
        # two round-off-exact routes, differences of numbers of size `scale`
        assert np.abs(difference - (gradient[a] - gradient[b])).max() < 1e-13 * scale


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_log_hessian_is_derivative_of_gradient(law: Law) -> None:
    at = stretches(2)
    hessian = law.log_hessian_mpa(*at)
    assert hessian.shape == (20, 3, 3)
    step = 1e-5
    for b in range(3):
        up, down = at.copy(), at.copy()
        up[b] *= math.exp(step)
        down[b] *= math.exp(-step)
        column = (log_gradient(law, up) - log_gradient(law, down)) / (2.0 * step)
        # central difference: truncation alpha^2 step^2 / 6 about 1e-9, round-off 1e-16 / step about 1e-11
        assert np.abs(hessian[:, :, b].T - column).max() < 1e-8 * np.abs(hessian).max()


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_energy_is_symmetric_and_zero_at_rest(law: Law) -> None:
    at = stretches(3)
    energies = [law.energy(*at[list(order)]) for order in itertools.permutations(range(3))]
    # sums of the same terms in another order
    assert np.ptp(energies, axis=0).max() < 1e-14 * np.abs(energies).max()
    assert float(law.energy(1.0, 1.0, 1.0)) == 0.0
    assert float(law.stress_difference(1.2, 1.2, 1.0 / 1.44)) == 0.0


@pytest.mark.parametrize("law", LAWS, ids=str)
def test_initial_shear_modulus_is_the_slope_at_rest(law: Law) -> None:
    strain = 1e-4
    # pure shear: sigma_1 - sigma_3 = 4 mu ln(lambda) + O(strain^3), so O(1e-8 alpha^2) relative
    stress = float(law.stress_difference(math.exp(strain), math.exp(-strain), 1.0))
    assert stress / (4.0 * strain) == pytest.approx(law.initial_shear_modulus_mpa, rel=1e-6)


def test_arrays_broadcast() -> None:
    column, row = np.linspace(1.0, 2.0, 4)[:, None], np.linspace(0.5, 1.0, 3)
    for law in LAWS:
        assert law.energy(column, row, 1.0).shape == (4, 3)
        assert law.stress_difference(column, 1.0, row).shape == (4, 3)
        assert law.log_hessian_mpa(column, row, 1.0).shape == (4, 3, 3, 3)


def test_the_two_ogden_conventions() -> None:
    by_energy, by_ansys = dragon_skin_30("2mu/alpha^2"), dragon_skin_30("mu/alpha")
    assert by_energy.initial_shear_modulus_mpa == pytest.approx(0.075449, rel=1e-14)
    # the three-digit figure quoted for eq. (20)
    assert by_ansys.initial_shear_modulus_mpa == pytest.approx(0.220, abs=5e-4)
    assert by_ansys.prefactor_mpa / by_energy.prefactor_mpa == pytest.approx(5.836 / 2.0, rel=1e-14)
    # Nominal uniaxial stress at stretch 2: 0.737 and 2.150 MPa, three digits known; the maker says 0.593.
    for law, nominal in ((by_energy, 0.737), (by_ansys, 2.150)):
        cauchy = float(law.stress_difference(2.0, 2.0**-0.5, 2.0**-0.5))
        assert cauchy / 2.0 == pytest.approx(nominal, abs=1e-3)


@pytest.mark.parametrize(
    "law",
    [
        NeoHooke(0.1),
        DRAGON_SKIN_10,
        dragon_skin_30("2mu/alpha^2"),
        dragon_skin_30("mu/alpha"),
        Ogden(0.1, -3.0, "2mu/alpha^2"),
        Ogden(-0.1, -25.0, "mu/alpha"),
    ],
    ids=str,
)
# 11 is 1000 % elongation, 100 is beyond any elastomer: moduli 1e17 apart must not read as softening.
@pytest.mark.parametrize("stretch_max", [11.0, 100.0])
def test_sound_laws_are_stable(law: Law, stretch_max: float) -> None:
    check_stability(law, stretch_max)


def test_softening_yeoh_is_refused() -> None:
    x = np.linspace(0.0, 100.0, 1001)
    assert (36.0 - 6.0 * x + 0.3 * x**2).min() > 0.0
    with pytest.raises(MaterialError, match=r"softens in equibiaxial extension at stretch 1\.7"):
        check_stability(SOFTENING, 4.0)


def test_softening_yeoh_falls_where_the_check_says() -> None:
    # Independent of moduli: Cauchy stress on the equibiaxial path, whose softening is later than the first
    # loss of positive definiteness, and not there without it.
    stretch = np.linspace(1.0, 4.0, 2000)
    stress = SOFTENING.stress_difference(stretch, stretch**-2.0, stretch)
    falls = stretch[1:][np.diff(stress) < 0.0]
    assert falls.size > 0
    assert falls[0] > 1.7
    check_stability(SOFTENING, 1.7)


@pytest.mark.parametrize("stretch_max", [1.0, 0.5, math.nan, math.inf])
def test_stability_range_must_be_a_range(stretch_max: float) -> None:
    with pytest.raises(MaterialError, match="stretch_max"):
        check_stability(NeoHooke(0.1), stretch_max)


@pytest.mark.parametrize("bad", [0.0, -0.1, math.nan, math.inf])
def test_bad_moduli_are_refused(bad: float) -> None:
    with pytest.raises(MaterialError, match="mu_mpa"):
        NeoHooke(bad)
    with pytest.raises(MaterialError, match="C1"):
        Yeoh((bad, 0.1))
    with pytest.raises(MaterialError, match="mu_mpa"):
        Ogden(bad, 2.0, "2mu/alpha^2")
    with pytest.raises(MaterialError, match="young_mpa"):
        StiffSolid(bad, 0.3, 1.0)
    with pytest.raises(MaterialError, match="density_g_cm3"):
        StiffSolid(1000.0, 0.3, bad)


def test_other_bad_numbers_are_refused() -> None:
    with pytest.raises(MaterialError, match="coefficients"):
        Yeoh(())
    with pytest.raises(MaterialError, match="coefficients"):
        Yeoh((0.1,) * 9)
    with pytest.raises(MaterialError, match="C3"):
        Yeoh((0.1, 0.1, math.nan))
    with pytest.raises(MaterialError, match="alpha = 0"):
        Ogden(0.1, 0.0, "mu/alpha")
    with pytest.raises(MaterialError, match=r"mu_mpa \* alpha must be positive"):
        Ogden(0.1, -2.0, "mu/alpha")
    with pytest.raises(MaterialError, match="convention"):
        Ogden(0.1, 2.0, "abaqus")  # type: ignore[arg-type]
    for poisson in (0.5, -1.0, math.nan):
        with pytest.raises(MaterialError, match="poisson"):
            StiffSolid(1000.0, poisson, 1.0)


@pytest.mark.parametrize("solid", [PLA, POLYETHYLENE], ids=["pla", "polyethylene"])
def test_stiff_solid_moduli_agree(solid: StiffSolid) -> None:
    mu, kappa = solid.mu_mpa, solid.kappa_mpa
    assert 9.0 * kappa * mu / (3.0 * kappa + mu) == pytest.approx(solid.young_mpa, rel=1e-14)
    lame = solid.lame_lambda_mpa
    assert lame / (2.0 * (lame + mu)) == pytest.approx(solid.poisson, rel=1e-13)


def test_laws_of_the_invariants_tend_to_neo_hooke() -> None:
    at = stretches(5)
    for law in (MooneyRivlin((0.05, 0.0)), Gent(0.1, 1e9), ArrudaBoyce(0.1, 1e5)):
        # Gent and Arruda-Boyce differ by (I1 - 3)/limit, about 1e-8 and 1e-10
        assert law.energy(*at) == pytest.approx(NeoHooke(0.1).energy(*at), rel=1e-7)


def test_initial_moduli_of_laws_of_the_invariants() -> None:
    assert MooneyRivlin((0.08, 0.02, 0.3)).initial_shear_modulus_mpa == pytest.approx(0.2, rel=1e-14)
    assert Gent(0.1, 40.0).initial_shear_modulus_mpa == pytest.approx(0.1, rel=1e-14)
    limit = 3.0
    series = 3 / (5 * limit**2) + 99 / (175 * limit**4) + 513 / (875 * limit**6) + 42039 / (67375 * limit**8)
    assert ArrudaBoyce(0.1, limit).initial_shear_modulus_mpa == pytest.approx(0.1 * (1.0 + series), rel=1e-14)


def test_a_second_invariant_that_stiffens_under_compression() -> None:
    # of equal moduli Mooney-Rivlin is softer in uniaxial extension: 2 (C10 + C01/l) (l^2 - 1/l) of Cauchy stress
    law, stretch = MooneyRivlin((0.04, 0.01)), 2.0
    stress = float(law.stress_difference(stretch, stretch**-0.5, stretch**-0.5))
    assert stress == pytest.approx(2.0 * (0.04 + 0.01 / stretch) * (stretch**2 - 1.0 / stretch), rel=1e-13)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: MooneyRivlin((0.1,)), "has 1 constants: give C10, C01"),
        (lambda: MooneyRivlin((0.1, -0.2)), "C10 \\+ C01"),
        (lambda: OgdenSeries((0.1, 0.2), (2.0,), "mu/alpha"), "has 2 numbers, alpha 1"),
        (lambda: OgdenSeries((0.1, -0.2), (2.0, 4.0), "2mu/alpha^2"), "initial shear modulus"),
        (lambda: Gent(0.1, 0.0), "Gent limit"),
        (lambda: ArrudaBoyce(0.1, 1.0), "must be above 1"),
        (lambda: Yeoh((0.1,) * 9), "give one to 8"),
    ],
)
def test_constants_that_cannot_be_are_refused(make: Any, said: str) -> None:
    with pytest.raises(MaterialError, match=said):
        make()
