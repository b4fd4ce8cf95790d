"""Up to which stretch laws are stable, in all states and in the three usual tests; principal stretches."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from analytical.laws.isotropic import Guccione, Law, NeoHooke, Ogden, Yeoh
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30, silicone_of
from analytical.laws.stability import MODES, is_stable, principal_stretches, stable_stretches

# A least-squares fit of tensile data of Dragon Skin 10, whose last term is negative.
FREE_FIT = Yeoh((0.0222115, 0.0026603, -0.0000735))


def states(count: int, largest: float) -> np.ndarray:
    """Principal stretches with product 1, descending, shape (count, 3)."""
    logs = np.random.default_rng(7).uniform(-math.log(largest), math.log(largest), (count, 2))
    found = np.exp(np.column_stack([logs, -logs.sum(axis=1)]))
    return -np.sort(-found, axis=1)


@pytest.mark.parametrize(
    "law", [FREE_FIT, Yeoh((0.036, -0.003, 0.0001)), DRAGON_SKIN_10, Yeoh((0.05, -0.001))], ids=str
)
def test_laws_of_the_first_invariant_have_a_criterion_in_closed_form(law: Yeoh) -> None:
    """Hill's for W(I1): 4 (W' D + W'' d d^T), D = diag(d), is positive where W' and W' + W'' (I1 - 9/I2) are."""
    stretch = states(4000, 5.0)
    i1, i2 = (stretch**2).sum(axis=1), (stretch**-2.0).sum(axis=1)
    x = i1 - 3.0
    first = sum(k * c * x ** (k - 1) for k, c in enumerate(law.c_mpa, start=1))
    second = sum(k * (k - 1) * c * x ** max(k - 2, 0) for k, c in enumerate(law.c_mpa, start=1))
    direct = (first > 0.0) & (first + second * (i1 - 9.0 / i2) > 0.0)
    assert (is_stable(law, *stretch.T) == direct).all()
    assert direct.any()
    assert direct.all() == all(math.isinf(limit) for limit in stable_stretches(law).values())


def test_range_of_a_fit_that_softens() -> None:
    c1, c2, c3 = FREE_FIT.c_mpa

    def margin(stretch: float, mode: str) -> float:
        squares = np.array(MODES[mode](np.array(stretch))) ** 2
        i1, i2 = squares.sum(), (1.0 / squares).sum()
        x = i1 - 3.0
        return c1 + 2.0 * c2 * x + 3.0 * c3 * x**2 + (2.0 * c2 + 6.0 * c3 * x) * (i1 - 9.0 / i2)

    limits = stable_stretches(FREE_FIT)
    for mode in MODES:
        assert limits[mode] == pytest.approx(brentq(margin, 2.0, 6.0, args=(mode,)), rel=1e-9)
    assert limits["equibiaxial"] == pytest.approx(3.194, abs=5e-4)  # the first to go


@pytest.mark.parametrize(
    "law",
    [
        NeoHooke(0.1),
        DRAGON_SKIN_10,
        Yeoh((0.036, -0.0001, 0.001)),
        dragon_skin_30("mu/alpha"),
        Ogden(0.04053, 3.206, "2mu/alpha^2"),
        Ogden(-0.1, -20.0, "mu/alpha"),
    ],
    ids=str,
)
def test_sound_laws_have_no_limit(law: Law) -> None:
    assert set(stable_stretches(law).values()) == {math.inf}
    assert is_stable(law, *states(500, 8.0).T).all()


def test_an_exponential_law_is_limited_in_uniaxial_extension_only() -> None:
    """Its moduli leave the range of numbers before stretch 100, which is no loss of stability."""
    limits = stable_stretches(Guccione(0.01))
    assert limits["uniaxial"] == pytest.approx(2.0, rel=1e-9)
    assert limits["equibiaxial"] == limits["pure shear"] == math.inf


def test_principal_stretches_of_invariants() -> None:
    stretch = states(3000, 8.0)
    found = np.column_stack(principal_stretches((stretch**2).sum(axis=1), (stretch**-2.0).sum(axis=1)))
    assert found[:, 0] == pytest.approx(stretch[:, 0], rel=1e-7)
    assert found == pytest.approx(stretch, rel=1e-4)  # nearly equal ones lose half the digits
    assert found.prod(axis=1) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("l", [1.0, 1.0 + 1e-9, 2.0, 8.0])
def test_principal_stretches_where_two_are_equal(l: float) -> None:
    for mode in ("uniaxial", "equibiaxial"):
        squares = np.array(MODES[mode](np.array([l]))) ** 2
        found = principal_stretches(squares.sum(axis=0), (1.0 / squares).sum(axis=0))
        assert float(found[0][0]) == pytest.approx(l, rel=1e-7)


def test_silicones_are_known_by_their_printed_constants() -> None:
    ten, thirty = silicone_of(DRAGON_SKIN_10), silicone_of(dragon_skin_30("mu/alpha"))
    assert ten is not None and (ten.name, ten.stretch_at_break) == ("Dragon Skin 10", 11.0)
    assert thirty is not None and thirty.stretch_at_break == pytest.approx(4.64)
    assert silicone_of(Yeoh((1e-3 * 36, 1e-3 * 2.5, 1e-3 * 0.23))) == ten  # as scenes give them
    for other in (FREE_FIT, NeoHooke(0.072), Yeoh((0.036, 0.0025)), Ogden(0.075449, 5.8, "mu/alpha")):
        assert silicone_of(other) is None
