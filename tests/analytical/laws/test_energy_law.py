"""A law from its energy alone against the laws that know their derivatives, and as a law of its own."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

from analytical.exact.tube import Tube, pressure_at_inner_radius_mpa
from analytical.laws.errors import MaterialError
from analytical.laws.isotropic import IsotropicLaw, NeoHooke, Ogden, Yeoh
from analytical.laws.numerical import EnergyLaw
from analytical.laws.silicones import dragon_skin_30
from analytical.laws.stability import check_stability
from tests.analytical.cases import LAWS, every_law

MU, J_LIMIT = 0.1, 20.0


def gent(l1: ArrayLike, l2: ArrayLike, l3: ArrayLike) -> Any:
    """Gent, Rubber Chem. Technol. 69 (1996) 59: a law that the package does not have, MPa."""
    x = np.asarray(l1) ** 2 + np.asarray(l2) ** 2 + np.asarray(l3) ** 2 - 3.0
    return -0.5 * MU * J_LIMIT * np.log(1.0 - x / J_LIMIT)


def stretches(count: int = 40) -> np.ndarray[Any, Any]:
    """Random incompressible stretches 0.45 to 5, shape (3, count)."""
    logs = np.random.default_rng(7).uniform(-0.8, 0.8, (2, count))
    return np.asarray(np.exp(np.vstack([logs, -logs.sum(axis=0)])))


@every_law
def test_gives_what_the_law_gives(law: IsotropicLaw) -> None:
    bare, at = EnergyLaw(law.energy), stretches()
    assert np.array_equal(bare.energy(*at), law.energy(*at))
    stress, hessian = law.stress_difference(*at), law.log_hessian_mpa(*at)
    # Round-off of the complex step: a few units in the last place of the largest stress.
    assert np.abs(bare.stress_difference(*at) - stress).max() < 1e-14 * np.abs(stress).max()
    # Central difference: round-off 1e-16 / 5e-3, each state against its own size.
    error = np.abs(bare.log_hessian_mpa(*at) - hessian).max(axis=(1, 2))
    assert (error / np.abs(hessian).max(axis=(1, 2))).max() < 1e-12
    assert bare.initial_shear_modulus_mpa == pytest.approx(law.initial_shear_modulus_mpa, rel=1e-12)


@every_law
def test_energy_takes_complex_stretches(law: IsotropicLaw) -> None:
    at = stretches()
    # Conjugate in, conjugate out: what an energy that is real on the real axis and analytic does. Round-off.
    up, down = law.energy(*(at * (1.0 + 0.1j))), law.energy(*(at * (1.0 - 0.1j)))
    assert np.abs(up - np.conj(down)).max() <= 1e-14 * np.abs(up).max()
    assert np.abs(up.imag).max() > 0.0


def test_hessian_of_a_large_exponent() -> None:
    law, at = Ogden(0.1, 25.0, "2mu/alpha^2"), stretches()
    exact = law.log_hessian_mpa(*at)
    error = np.abs(EnergyLaw(law.energy).log_hessian_mpa(*at) - exact).max(axis=(1, 2))
    # Truncation (alpha h)^8 / 630 = 1e-10 of the modulus that belongs to the exponent.
    assert (error / np.abs(exact).max(axis=(1, 2))).max() < 2e-10


def test_gent() -> None:
    law, at = EnergyLaw(gent), stretches()
    x = (at**2).sum(axis=0) - 3.0
    assert x.max() < J_LIMIT
    assert law.initial_shear_modulus_mpa == pytest.approx(MU, rel=1e-12)
    exact = MU / (1.0 - x / J_LIMIT) * (at[0] ** 2 - at[1] ** 2)
    # Round-off, against the largest.
    assert np.abs(law.stress_difference(*at) - exact).max() < 1e-13 * np.abs(exact).max()
    # It stiffens: stable up to near its limit, x = J_LIMIT at an equibiaxial stretch of 3.39.
    check_stability(law, 3.3)
    tube = Tube(10.0, 12.0)
    stiff, soft = (pressure_at_inner_radius_mpa(tube, each, 20.0) for each in (law, NeoHooke(MU)))
    assert stiff > soft > 0.0


@pytest.mark.parametrize("law", [*LAWS, EnergyLaw(gent)], ids=[*map(str, LAWS), "gent"])
def test_permutations_change_nothing_but_order(law: IsotropicLaw) -> None:
    at = stretches()
    hessian = law.log_hessian_mpa(*at)
    size = np.abs(hessian).max(axis=(1, 2), keepdims=True)
    for order in itertools.permutations(range(3)):
        permuted = law.log_hessian_mpa(*at[list(order)])
        # Round-off of closed forms, and of differences over 5e-3.
        assert (np.abs(permuted - hessian[:, order][:, :, order]) / size).max() < 1e-12
        a, b, c = order
        forward = law.stress_difference(at[a], at[b], at[c])
        # Round-off.
        assert np.abs(forward + law.stress_difference(at[b], at[a], at[c])).max() <= 1e-14 * size.max()


def test_stability_check_reads_it() -> None:
    softening = Yeoh((0.036, -0.003, 0.0001))
    with pytest.raises(MaterialError, match=r"softens in equibiaxial extension at stretch 1\.7"):
        check_stability(EnergyLaw(softening.energy), 4.0)
    # 1000 % elongation
    check_stability(EnergyLaw(dragon_skin_30("mu/alpha").energy), 11.0)


def test_broadcasts_and_is_zero_where_stretches_agree() -> None:
    law = EnergyLaw(gent)
    column, row = np.linspace(1.0, 2.0, 4)[:, None], np.linspace(0.5, 1.0, 3)
    assert law.energy(column, row, 1.0).shape == (4, 3)
    assert law.stress_difference(column, 1.0, row).shape == (4, 3)
    assert law.log_hessian_mpa(column, row, 1.0).shape == (4, 3, 3, 3)
    assert float(law.stress_difference(1.2, 1.2, 1.0 / 1.44)) == 0.0


def test_bad_energies_are_refused() -> None:
    with pytest.raises(MaterialError, match="not symmetric"):
        EnergyLaw(lambda l1, l2, l3: np.asarray(l1) ** 2 + 2.0 * np.asarray(l2) ** 2 + np.asarray(l3) ** 2)
    with pytest.raises(MaterialError, match="not symmetric"):
        EnergyLaw(lambda l1, l2, l3: math.nan)
    with pytest.raises(MaterialError, match="imaginary part"):
        EnergyLaw(lambda l1, l2, l3: np.abs(l1) ** 2 + np.abs(l2) ** 2 + np.abs(l3) ** 2)
    with pytest.raises(MaterialError, match="must grow from rest"):
        EnergyLaw(lambda l1, l2, l3: -gent(l1, l2, l3))
