"""The isotropic exponential law against the law made from its energy alone, and where it softens."""

from __future__ import annotations

import numpy as np
import pytest

from analytical.laws.errors import MaterialError
from analytical.laws.isotropic import Guccione
from analytical.laws.numerical import EnergyLaw
from analytical.laws.stability import check_stability

LAW = Guccione(0.01, 1.7)


def by_energy(l1, l2, l3):
    """W = C/2 (exp(b E:E) - 1)."""
    return 0.005 * (np.exp(1.7 / 4.0 * ((l1**2 - 1.0) ** 2 + (l2**2 - 1.0) ** 2 + (l3**2 - 1.0) ** 2)) - 1.0)


@pytest.mark.parametrize("stretches", [(1.3, 0.9, 1.0 / 1.17), (1.5, 1.5, 1.0 / 2.25), (1.0, 1.0, 1.0)])
def test_stress_and_hessian_are_those_of_the_energy(stretches: tuple[float, float, float]) -> None:
    other = EnergyLaw(by_energy)
    # complex step; differences of order 8, accurate to 1e-13 of the largest modulus
    assert LAW.stress_difference(*stretches) == pytest.approx(other.stress_difference(*stretches), rel=1e-13, abs=1e-17)
    found, expected = LAW.log_hessian_mpa(*stretches), other.log_hessian_mpa(*stretches)
    assert np.abs(found - expected).max() < 1e-10 * np.abs(expected).max()
    assert LAW.energy(*stretches) == pytest.approx(by_energy(*stretches), rel=1e-13, abs=1e-18)
    assert LAW.initial_shear_modulus_mpa == pytest.approx(other.initial_shear_modulus_mpa, rel=1e-10)


def test_it_softens_in_uniaxial_extension_beyond_a_stretch_of_two() -> None:
    check_stability(Guccione(0.01), 1.99)
    with pytest.raises(MaterialError, match="softens in uniaxial extension at stretch 2"):
        check_stability(Guccione(0.01), 2.05)


@pytest.mark.parametrize(("c", "b", "named"), [(0.0, 1.0, "c_mpa"), (0.01, -1.0, "Guccione b"), (np.nan, 1.0, "c_mpa")])
def test_wrong_numbers_are_refused(c: float, b: float, named: str) -> None:
    with pytest.raises(MaterialError, match=named):
        Guccione(c, b)
