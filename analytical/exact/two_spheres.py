"""Two thick spheres on one cavity: the equilibrium path, whose volume may turn back, exactly.

The spheres share a pressure, and their volumes add up at equal pressures:

    P_1(a_1) = P_2(a_2) = P,    V = V_1(a_1) + V_2(a_2)

(the problem of two balloons: Mueller and Strehlow, Rubber and Rubber Balloons, 2004). If both have a limit point, the
sphere with the lower one, here the small one, goes through it while the other turns round and shrinks. Where

    dV_1/dP + dV_2/dP = 0

the volume turns back, which happens if the other sphere is large: a held volume then jumps.
Units: mm, N, MPa.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy.optimize import brentq, minimize_scalar

from analytical.exact.sphere import LimitPoint, Sphere, SphereError, limit_point, pressure_at_inner_radius_mpa
from analytical.laws.isotropic import IsotropicLaw

# The volume is looked at up to this stretch of the small bore.
_LARGEST_STRETCH = 4.0
_STEPS = 400


@dataclass(frozen=True)
class PairState:
    """A state of the pair: stretch of the small bore, pressure in MPa, both cavities together as halves, mm^3."""

    stretch: float
    pressure_mpa: float
    volume_mm3: float


@dataclass(frozen=True)
class TwoSpheres:
    """The pair, undeformed: the small sphere has the lower limit point."""

    small: Sphere
    large: Sphere

    def at(self, law: IsotropicLaw, stretch: float) -> PairState:
        """The state at a stretch of the small bore, the large sphere on its rising branch.

        Raises
        ------
        SphereError
            If the large sphere does not carry the pressure on that branch, or has no limit point.
        """
        inner = stretch * self.small.inner_radius_mm
        pressure = pressure_at_inner_radius_mpa(self.small, law, inner)
        top = self._top(self.large, law)
        if pressure > top.pressure_mpa:
            raise SphereError(
                f"pressure {pressure:g} MPa is above the large sphere's limit point, {top.pressure_mpa:g} MPa: the "
                "small sphere has to have the lower one"
            )
        other = brentq(
            lambda a: pressure_at_inner_radius_mpa(self.large, law, a) - pressure,
            0.999 * self.large.inner_radius_mm,
            top.inner_mm,
        )
        return PairState(stretch, pressure, 2.0 / 3.0 * math.pi * (inner**3 + other**3))

    def limit(self, law: IsotropicLaw) -> PairState:
        """The limit point of the pressure, that of the small sphere."""
        return self.at(law, self._top(self.small, law).inner_mm / self.small.inner_radius_mm)

    def folds(self, law: IsotropicLaw) -> tuple[PairState, PairState]:
        """Where the volume turns back, and where it turns forward again.

        Raises
        ------
        SphereError
            If it does not turn back.
        """
        start = self.limit(law).stretch
        stretches = [start + (_LARGEST_STRETCH - start) * k / _STEPS for k in range(_STEPS + 1)]
        volumes = [self.at(law, s).volume_mm3 for s in stretches]
        falls = [k for k in range(_STEPS) if volumes[k + 1] < volumes[k]]
        if not falls:
            raise SphereError("the volume does not turn back: take a larger second sphere")
        found = []
        for sign, k in ((-1.0, falls[0]), (1.0, falls[-1] + 1)):
            low, high = stretches[max(k - 1, 0)], stretches[min(k + 1, _STEPS)]
            best = minimize_scalar(
                lambda s, sign=sign: sign * self.at(law, s).volume_mm3, bounds=(low, high), method="bounded",
                options={"xatol": 1e-9},
            )  # fmt: skip
            found.append(self.at(law, float(best.x)))
        return found[0], found[1]

    def _top(self, sphere: Sphere, law: IsotropicLaw) -> LimitPoint:
        top = limit_point(sphere, law)
        if top is None:
            raise SphereError(f"{law} has no limit point in {sphere}: the volume never turns back")
        return top
