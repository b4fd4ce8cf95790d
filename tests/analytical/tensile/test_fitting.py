"""Laws fitted to material tests: constants that are known come back, the condition of positive moduli holds."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytical.exact.homogeneous import MODES, nominal_stress_mpa
from analytical.laws.isotropic import Law, NeoHooke, Ogden, OgdenSeries, Yeoh
from analytical.laws.of_invariants import ArrudaBoyce, Gent, MooneyRivlin
from analytical.laws.stability import stable_stretches
from analytical.tensile.families import FAMILIES
from analytical.tensile.fitting import FitError, best_fit, fit_law, relative_errors
from analytical.tensile.measured import MaterialTest, MeasuredError

KNOWN: dict[str, Law] = {
    "neo-hooke": NeoHooke(0.05),
    "mooney-rivlin-2": MooneyRivlin((0.02, 0.004)),
    "mooney-rivlin-3": MooneyRivlin((0.02, 0.004, 0.0003)),
    "mooney-rivlin-5": MooneyRivlin((0.02, 0.004, 0.0003, 0.0001, 0.0002)),
    "yeoh-2": Yeoh((0.017, 0.0004)),
    "yeoh-3": Yeoh((0.036, 0.0025, 0.00023)),
    "gent": Gent(0.08, 30.0),
    "arruda-boyce": ArrudaBoyce(0.06, 3.2),
    "ogden-1": Ogden(0.075, 5.836, "2mu/alpha^2"),
    "ogden-2": OgdenSeries((0.06, 0.002), (1.6, 7.0), "2mu/alpha^2"),
    "ogden-3": OgdenSeries((0.06, 0.002, 0.01), (1.3, 7.0, -2.0), "2mu/alpha^2"),
}


def measured(law, modes=tuple(MODES), largest=3.0, points=20, scatter=0.0):
    noise = np.random.default_rng(1)
    stretch = np.geomspace(1.05, largest, points)
    return [
        MaterialTest(
            mode, stretch, nominal_stress_mpa(law, mode, stretch) * (1 + scatter * noise.standard_normal(points))
        )
        for mode in modes
    ]


def test_every_family_has_a_law_that_is_known() -> None:
    assert set(KNOWN) == set(FAMILIES)


@pytest.mark.parametrize("family", FAMILIES)
def test_known_constants_come_back(family: str) -> None:
    tests = measured(KNOWN[family])
    fit = fit_law(tests, family)
    # the stress of the law, not its constants: two terms may change places
    assert np.abs(relative_errors(fit.law, tests)).max() < 1e-5
    assert fit.law.initial_shear_modulus_mpa == pytest.approx(KNOWN[family].initial_shear_modulus_mpa, rel=1e-3)
    assert not fit.held and fit.points == 60 and fit.data_to_stretch == pytest.approx(3.0)
    assert len(fit.names) == len(fit.constants)


def test_constants_are_in_kpa_and_numbers_are_not() -> None:
    fit = fit_law(measured(KNOWN["ogden-1"]), "ogden-1")
    assert fit.names == ("mu1_kpa", "alpha1")
    np.testing.assert_allclose(fit.constants, [75.0, 5.836], rtol=1e-6)


def test_the_covariance_is_that_of_linear_least_squares() -> None:
    tests = measured(KNOWN["neo-hooke"], scatter=0.02)
    fit = fit_law(tests, "neo-hooke")
    # P = mu f: with relative errors r = mu f / P - 1 the column is f / P, and var(mu) = S / (n - 1) / sum (f / P)^2
    column = np.concatenate([nominal_stress_mpa(NeoHooke(1e-3), t.mode, t.stretch) / t.nominal_mpa for t in tests])
    errors = relative_errors(fit.law, tests)
    variance = errors @ errors / (len(errors) - 1) / (column @ column)
    np.testing.assert_allclose(fit.deviations, [math.sqrt(variance)], rtol=1e-4)
    np.testing.assert_allclose(fit.constants, [column.sum() / (column @ column)], rtol=1e-6)


def test_weights_pull_the_law_to_a_test() -> None:
    soft, stiff = measured(NeoHooke(0.04), ("uniaxial",))[0], measured(NeoHooke(0.06), ("equibiaxial",))[0]
    moduli = [
        fit_law(
            [MaterialTest(soft.mode, soft.stretch, soft.nominal_mpa, np.full(20, weight)), stiff], "neo-hooke"
        ).constants[0]
        for weight in (1.0, 100.0)
    ]
    assert 40.0 < moduli[1] < moduli[0] < 60.0


def test_the_best_law_is_the_one_the_data_are_of() -> None:
    for family in ("neo-hooke", "yeoh-2", "gent", "ogden-1"):
        fits = best_fit(measured(KNOWN[family], scatter=0.01), FAMILIES)
        assert (
            fits[0].family == family or fits[0].aicc > fit_law(measured(KNOWN[family], scatter=0.01), family).aicc - 4.0
        )
    worst = best_fit(measured(KNOWN["gent"], scatter=0.01), FAMILIES)[-1]
    assert worst.aicc > fit_law(measured(KNOWN["gent"], scatter=0.01), "gent").aicc + 50.0


def test_a_free_fit_that_softens_is_held_to_positive_moduli() -> None:
    # a curve that stiffens and then goes straight on, as those of silicones do: the cubic in I1 bends over to follow it
    stretch = np.linspace(1.1, 6.0, 40)
    rising = nominal_stress_mpa(Ogden(0.17, 2.9, "2mu/alpha^2"), "uniaxial", stretch)
    test = MaterialTest("uniaxial", stretch, np.where(stretch < 3.0, rising, 0.9 + 0.55 * (stretch - 3.0)))
    free, held = fit_law([test], "yeoh-3", 1.05), fit_law([test], "yeoh-3", 8.0)
    assert not free.held and min(free.stable_to.values()) < 8.0
    assert held.held and min(stable_stretches(held.law).values()) >= 8.0
    assert free.rms < held.rms < 0.3


@pytest.mark.parametrize(
    ("mode", "stretch", "stress", "message"),
    [
        ("tension", [1.1, 1.2, 1.3], [1.0, 2.0, 3.0], "say one of uniaxial"),
        ("uniaxial", [1.1, 1.2], [1.0, 2.0], "give at least 3"),
        ("uniaxial", [1.1, 1.2, 1.3], [1.0, 2.0], "one for each"),
        ("uniaxial", [1.1, -1.2, 1.3], [1.0, 2.0, 3.0], "must be above 0"),
        ("uniaxial", [1.1, 1.2, 1.3], [1.0, math.nan, 3.0], "not a finite number"),
        ("uniaxial", [1.1, 1.2, 1.3], [-1.0, 2.0, 3.0], "zero the curve first"),
    ],
)
def test_data_that_say_nothing_are_refused(mode: str, stretch: list[float], stress: list[float], message: str) -> None:
    with pytest.raises(MeasuredError, match=message):
        MaterialTest(mode, np.array(stretch), np.array(stress))  # type: ignore[arg-type]


def test_too_few_points_for_the_constants_are_refused() -> None:
    with pytest.raises(MeasuredError, match="5 points for the 6 constants of ogden-3"):
        fit_law(measured(KNOWN["ogden-1"], ("uniaxial",), points=5), "ogden-3")
    with pytest.raises(FitError):
        best_fit(measured(KNOWN["ogden-1"], ("uniaxial",), points=5), ["ogden-3"])


def test_points_without_stress_are_left_out() -> None:
    (test,) = measured(KNOWN["yeoh-2"], ("uniaxial",))
    rest = MaterialTest("uniaxial", np.append(1.0, test.stretch), np.append(0.0, test.nominal_mpa))
    assert fit_law([rest], "yeoh-2").points == len(test.stretch)
