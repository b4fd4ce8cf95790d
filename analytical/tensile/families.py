"""Laws that can be fitted: their constants as a vector, where to start, and the law they make.

All moduli are in units of the data's own (`scale_mpa`), so that vectors are of order one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytical.arrays import BoolArray, FloatArray
from analytical.laws.isotropic import Law, NeoHooke, Ogden, OgdenSeries, Yeoh
from analytical.laws.of_invariants import ArrudaBoyce, Gent, MooneyRivlin


@dataclass(frozen=True)
class Family:
    """A law with its constants free.

    Attributes
    ----------
    names
        Of the constants, those in kPa ending in ``_kpa``.
    make
        The law by its constants, those of a modulus in MPa.
    starts
        First guesses, moduli as shares of the initial shear modulus.
    lower, upper
        Bounds in the same units.
    one_test
        True if one kind of test is enough: a law of I1, or of one power of the stretches, says the rest.
    """

    names: tuple[str, ...]
    make: Callable[[Sequence[float]], Law]
    starts: tuple[tuple[float, ...], ...]
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    one_test: bool = True

    @property
    def moduli(self) -> BoolArray:
        """True where a constant is a modulus, False where it is a number, shape (k,)."""
        return np.array([name.endswith("_kpa") for name in self.names])

    def law(self, constants: FloatArray, scale_mpa: float) -> Law:
        """The law of a vector in units of the data's modulus."""
        return self.make([float(c) for c in constants * np.where(self.moduli, scale_mpa, 1.0)])


_MOST: Final = 1e3


def _mooney(count: int) -> Family:
    names = ("c10_kpa", "c01_kpa", "c11_kpa", "c20_kpa", "c02_kpa")[:count]
    starts = tuple((c10, 0.5 - c10, *([0.0] * (count - 2))) for c10 in (0.4, 0.25, 0.55))
    return Family(names, lambda c: MooneyRivlin(tuple(c)), starts, (-_MOST,) * count, (_MOST,) * count, False)


def _yeoh(count: int) -> Family:
    names = tuple(f"c{k + 1}_kpa" for k in range(count))
    least = (1e-4, *([-_MOST] * (count - 1)))
    return Family(names, lambda c: Yeoh(tuple(c)), ((0.5, *([1e-3] * (count - 1))),), least, (_MOST,) * count)


def _ogden(alphas: Sequence[Sequence[float]]) -> Family:
    """Terms whose share of the modulus is positive, in the convention "2mu/alpha^2": stable at every stretch."""
    terms = len(alphas[0])
    names = (*(f"mu{k + 1}_kpa" for k in range(terms)), *(f"alpha{k + 1}" for k in range(terms)))

    def make(c: Sequence[float]) -> Law:
        if terms == 1:
            return Ogden(c[0], c[1], "2mu/alpha^2")
        return OgdenSeries(tuple(c[:terms]), tuple(c[terms:]), "2mu/alpha^2")

    shares = ([1.0], [0.9, 0.1], [0.8, 0.1, 0.1])[terms - 1]
    starts = tuple((*shares, *of) for of in alphas)
    signs = [of[k] for of in alphas for k in range(terms)]
    negative = min(signs) < 0.0
    low, high = (-20.0 if negative else 0.1), 20.0
    lower, upper = (1e-9,) * terms + (low,) * terms, (_MOST,) * terms + (high,) * terms
    return Family(names, make, starts, lower, upper, terms == 1)


FAMILIES: Final[dict[str, Family]] = {
    "neo-hooke": Family(("mu_kpa",), lambda c: NeoHooke(c[0]), ((1.0,),), (1e-4,), (_MOST,)),
    "mooney-rivlin-2": _mooney(2),
    "mooney-rivlin-3": _mooney(3),
    "mooney-rivlin-5": _mooney(5),
    "yeoh-2": _yeoh(2),
    "yeoh-3": _yeoh(3),
    "gent": Family(
        ("mu_kpa", "limit"), lambda c: Gent(c[0], c[1]), ((1.0, 50.0), (1.0, 500.0)), (1e-4, 0.5), (_MOST, 1e5)
    ),
    "arruda-boyce": Family(
        ("mu_kpa", "stretch_limit"),
        lambda c: ArrudaBoyce(c[0], c[1]),
        ((1.0, 3.0), (1.0, 8.0)),
        (1e-4, 1.01),
        (_MOST, 100.0),
    ),
    "ogden-1": _ogden([[1.5], [3.0], [6.0]]),
    "ogden-2": _ogden([[1.5, 5.0], [2.0, 8.0], [1.3, -2.0], [3.0, -3.0]]),
    "ogden-3": _ogden([[1.3, 5.0, -2.0], [1.5, 6.0, -1.0], [2.0, 4.0, 10.0]]),
}


def law_name(family: str) -> str:
    """What a family's law is called in scenes, without the number of its terms."""
    return family.rstrip("0123456789-")
