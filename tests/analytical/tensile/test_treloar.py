"""Published fits to Treloar's data (1944) made again.

Two tables are in circulation: that of `scenes/materials/treloar-1944.csv`, and the one printed by Steinmann, Hossain
and Possart (2012, doi 10.1007/s00419-012-0610-z), both to two or three digits. The published constants were found in
other programs that quote the papers, each with its address. All are of absolute errors of the nominal stress.
"""

from __future__ import annotations

import numpy as np
import pytest

from analytical.exact.homogeneous import Mode, nominal_stress_mpa
from analytical.laws.isotropic import NeoHooke, OgdenSeries
from analytical.tensile.fitting import best_fit, fit_law
from analytical.tensile.measured import MaterialTest
from studies.scene.silicones.tensile import read_tests

KGF_PER_CM2 = 0.0980665  # MPa
# Steinmann, Hossain and Possart 2012, as in thermalCANN, data/Treloar, and simcoon, examples/hyperelasticity.
STEINMANN: dict[Mode, tuple[str, str]] = {
    "uniaxial": (
        "1.01 1.12 1.24 1.39 1.61 1.89 2.17 2.42 3.01 3.58 4.03 4.76 5.36 5.76 6.16 6.4 6.62 6.87 7.05 7.16 7.27 "
        "7.43 7.5 7.61",
        "0.03 0.14 0.23 0.32 0.41 0.5 0.58 0.67 0.85 1.04 1.21 1.58 1.94 2.29 2.67 3.02 3.39 3.75 4.12 4.47 4.85 "
        "5.21 5.57 6.3",
    ),
    "equibiaxial": (
        "1.04 1.08 1.12 1.14 1.2 1.31 1.42 1.69 1.94 2.49 3.03 3.43 3.75 4.03 4.26 4.44",
        "0.09 0.16 0.24 0.26 0.33 0.44 0.51 0.65 0.77 0.96 1.24 1.45 1.72 1.96 2.22 2.43",
    ),
}


def absolute(test: MaterialTest) -> MaterialTest:
    """A test whose squared errors count by what they are, not by what they are of."""
    test = test.loaded
    return MaterialTest(test.mode, test.stretch, test.nominal_mpa, test.nominal_mpa**2)


def steinmann(mode: Mode) -> MaterialTest:
    stretch, stress = (np.array(column.split(), dtype=float) for column in STEINMANN[mode])
    return absolute(MaterialTest(mode, stretch, stress))


@pytest.fixture
def treloar(root):
    return {test.mode: test for test in read_tests(root / "scenes/materials/treloar-1944.csv")}


def squares(law, test: MaterialTest) -> float:
    return float(((nominal_stress_mpa(law, test.mode, test.stretch) - test.nominal_mpa) ** 2).sum())


def test_the_table_is_treloar_s(treloar) -> None:
    assert {mode: len(test.stretch) for mode, test in treloar.items()} == {
        "uniaxial": 25,
        "equibiaxial": 17,
        "pure shear": 14,
    }


def test_treloar_s_modulus_and_what_he_says_it_misses(treloar) -> None:
    # "G has the value 4.0 kg./cm2", chosen on the sheet; at most 24 and 17 % below it in extension and shear, before
    # the final rise. Those two were figures, read off by others: 1.5 % of allowance.
    law = NeoHooke(4.0 * KGF_PER_CM2)
    for mode, said in (("uniaxial", 24.0), ("pure shear", 17.0)):
        test = treloar[mode].loaded
        below = 1.0 - test.nominal_mpa / nominal_stress_mpa(law, test.mode, test.stretch)
        assert 100.0 * below.max() == pytest.approx(said, abs=1.5)
    sheet = treloar["equibiaxial"]
    near = fit_law([absolute(sheet.where(sheet.stretch < 3.0))], "neo-hooke")  # "up to an extension ratio of 3.0"
    assert near.constants[0] == pytest.approx(1e3 * 4.0 * KGF_PER_CM2, rel=0.03)


def test_neo_hooke_of_calibration_hyperelasticity(treloar) -> None:
    # Chongran-Zhao/Calibration-Hyperelasticity, tests/baseline.json: C1 = 0.2853883, 1 kgf/cm2 taken as 0.0981 MPa
    fit = fit_law([absolute(treloar["uniaxial"])], "neo-hooke")
    assert 0.5e-3 * fit.constants[0] * 0.0981 / KGF_PER_CM2 == pytest.approx(0.2853883, rel=2e-5)


def test_neo_hooke_and_mooney_rivlin_of_steinmann() -> None:
    # as quoted by simcoon: neo-Hooke mu = 0.5673 in extension; C10, C01 = 0.1713, 0.0047 in equibiaxial extension
    assert fit_law([steinmann("uniaxial")], "neo-hooke").constants[0] == pytest.approx(567.3, rel=5e-4)
    mooney = fit_law([steinmann("equibiaxial")], "mooney-rivlin-2")
    np.testing.assert_allclose(mooney.constants, [171.3, 4.7], atol=0.06)  # four digits are printed


def test_three_terms_are_no_worse_than_ogden_s(treloar) -> None:
    # Ogden 1972: 6.3, 0.012, -0.1 kgf/cm2 with 1.3, 5, -2; the best constants are not unique, the sum of squares is
    tests = [absolute(test) for test in treloar.values()]
    moduli = tuple(KGF_PER_CM2 * mu for mu in (6.3, 0.012, -0.1))
    ogden = OgdenSeries(moduli, (1.3, 5.0, -2.0), "mu/alpha")
    fit = fit_law(tests, "ogden-3")
    assert sum(squares(fit.law, test) for test in tests) < 0.5 * sum(squares(ogden, test) for test in tests)
    assert 0.35 < fit.law.initial_shear_modulus_mpa < 0.45


def test_relative_errors_lead_to_ogden_s_exponents(treloar) -> None:
    best = best_fit(treloar.values(), ["ogden-3", "ogden-2", "yeoh-3", "mooney-rivlin-2", "neo-hooke"])[0]
    assert best.family == "ogden-3"
    np.testing.assert_allclose(sorted(best.constants[3:]), [-2.0, 1.3, 5.0], rtol=0.1)
