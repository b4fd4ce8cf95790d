"""A flat circular sheet, held at its rim and inflated, as a membrane: incompressible, any isotropic law.

With l_1 along the meridian, l_2 = r/R round the axis, phi the meridian's slope, tensions T_i per deformed length

    T_i = h sigma_i / (l_1 l_2)                       sigma_3 = 0 through the thickness
    dr/dR = l_1 cos phi,  dz/dR = l_1 sin phi
    dT_1/dR = (T_2 - T_1) l_1 cos phi / r             along the meridian
    T_1 dphi/dR = l_1 (P - T_2 sin phi / r)           across it

(Adkins & Rivlin, Phil. Trans. R. Soc. A 244 (1952) 505, doi 10.1098/rsta.1952.0013; the sheet of Treloar, Trans. Inst.
Rubber Ind. 19 (1944) 201). At the pole l_1 = l_2 and dphi/dR = P l / (2 T). All lengths grow as 1/P, so one integration
from a pole's stretch out to l_2 = 1 gives the pressure of any radius, with the stored energy and the volume below the
sheet.
Units: mm, N, MPa.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.integrate import solve_ivp

from analytical.arrays import FloatArray
from analytical.exact.search import STRETCH_RANGE, first_solution
from analytical.laws.isotropic import IsotropicLaw

# Where the integration starts, of the pole's tension: half of it is the share of the radius of curvature there, and
# what is left out is of its square.
_POLE: Final = 1e-6
# Where it ends at the latest, of the same: no rim is met further out.
_FAR: Final = 1e3
# Tolerance of the integration: pressures by two routes then agree to 1e-11 (`studies/two_routes.py`).
_WITHIN: Final = 1e-12
# Least stretch at the pole that a pressure is looked for at.
_LEAST: Final = 1.0 + 1e-6


class SheetError(ValueError):
    """A sheet that cannot exist, or a state it cannot have; the message names value and remedy."""


@dataclass(frozen=True)
class FlatSheet:
    """Undeformed sheet.

    Parameters
    ----------
    radius_mm, thickness_mm
        Of the rim, and through the sheet, mm.
    """

    radius_mm: float
    thickness_mm: float

    def __post_init__(self) -> None:
        if not (0.0 < self.radius_mm < math.inf and 0.0 < self.thickness_mm < math.inf):
            raise SheetError(
                f"radius {self.radius_mm:g} mm, thickness {self.thickness_mm:g} mm: need both positive and finite"
            )


@dataclass(frozen=True)
class Inflated:
    """An equilibrium.

    Attributes
    ----------
    pressure_mpa, height_mm, pole_stretch
        Pressure, height of the pole over the rim, and both stretches there.
    rim_stretch, rim_slope
        Stretch along the meridian at the rim, and the meridian's slope there, rad.
    energy_mj, volume_mm3
        Stored energy, and volume between the sheet and its plane.
    """

    pressure_mpa: float
    height_mm: float
    pole_stretch: float
    rim_stretch: float
    rim_slope: float
    energy_mj: float
    volume_mm3: float


def inflated(sheet: FlatSheet, law: IsotropicLaw, pole_stretch: float) -> Inflated:
    """The equilibrium with a stretch at the pole.

    Raises
    ------
    SheetError
        If the stretch is not above 1 and within what elastomers reach, or the sheet has no such state.
    """
    if not 1.0 < pole_stretch < STRETCH_RANGE[1]:
        raise SheetError(f"stretch {pole_stretch:g} at the pole: need 1 < stretch < {STRETCH_RANGE[1]:g}")
    tension, _ = tensions(law, pole_stretch, pole_stretch)
    if not 0.0 < tension < math.inf:
        raise SheetError(f"stretch {pole_stretch:g} at the pole: the law's tension there is {tension:g}; take less")

    def over_rim(place: float, at: FloatArray) -> float:
        return float(at[1] - place)

    over_rim.terminal, over_rim.direction = True, -1  # type: ignore[attr-defined]
    # P = 1 and h = 1: lengths are of the size of the pole's tension
    start = _POLE * tension
    first = (pole_stretch, pole_stretch * start, 0.5 * pole_stretch * start / tension, 0.0, 0.0, 0.0)
    found = solve_ivp(
        lambda place, at: _rates(law, place, at),
        (start, _FAR * pole_stretch * tension),
        first,
        events=over_rim,
        method="DOP853",
        rtol=_WITHIN,
        atol=_WITHIN * np.array([1.0, tension, 1.0, tension, tension**3, tension**3]),
    )
    if not found.success or not len(found.t_events[0]):
        raise SheetError(f"stretch {pole_stretch:g} at the pole: no rim is met; take a smaller one")
    radius = float(found.t_events[0][0])
    along, _, slope, height, energy, volume = (float(value) for value in found.y_events[0][0])
    scale = sheet.radius_mm / radius
    return Inflated(
        pressure_mpa=sheet.thickness_mm / scale,
        height_mm=height * scale,
        pole_stretch=pole_stretch,
        rim_stretch=along,
        rim_slope=slope,
        energy_mj=2.0 * math.pi * sheet.thickness_mm * energy * scale**2,
        volume_mm3=math.pi * volume * scale**3,
    )


def at_pressure(sheet: FlatSheet, law: IsotropicLaw, pressure_mpa: float) -> Inflated:
    """The first equilibrium under a pressure on the way up from rest, beyond a maximum where the pressure rises again.

    Raises
    ------
    SheetError
        If the pressure is not met, with the largest that is, or asks for a stretch that the law does not have.
    """

    def pressure(stretch: float) -> float:
        return inflated(sheet, law, stretch).pressure_mpa

    least = pressure(_LEAST)
    if not pressure_mpa > least:
        raise SheetError(f"pressure {pressure_mpa:g} MPa: need more than {least:g}")
    stretch, furthest = first_solution(pressure, _LEAST, (1.0, STRETCH_RANGE[1]), pressure_mpa)
    if stretch is None:
        raise SheetError(
            f"pressure {pressure_mpa:g} MPa: the largest up to a stretch of {STRETCH_RANGE[1]:g} at the pole is "
            f"{furthest:.6g}; take a smaller one"
        )
    return inflated(sheet, law, stretch)


def tensions(law: IsotropicLaw, along: float, around: float) -> tuple[float, float]:
    """Tensions per deformed length along the meridian and round the axis, over the undeformed thickness, MPa."""
    through = 1.0 / (along * around)
    first = law.stress_difference(along, through, around)
    second = law.stress_difference(around, through, along)
    return float(first * through), float(second * through)


def _rates(law: IsotropicLaw, place: float, at: FloatArray) -> tuple[float, ...]:
    """Slopes by R of l_1, r, phi, z, and of energy over 2 pi and volume over pi, under a pressure of 1."""
    along, radius, slope = (float(value) for value in at[:3])
    around = radius / place
    through = 1.0 / (along * around)
    first, second = tensions(law, along, around)
    hessian = np.asarray(law.log_hessian_mpa(along, around, through))
    # by the logarithms of l_1 and of l_2, where l_3 = 1/(l_1 l_2)
    by_along = hessian[0, 0] - 2.0 * hessian[0, 2] + hessian[2, 2]
    by_around = hessian[0, 1] - hessian[1, 2] - hessian[0, 2] + hessian[2, 2]
    by_along, by_around = by_along * through - first, by_around * through - first
    outwards, upwards = along * math.cos(slope), along * math.sin(slope)
    tension_rate = (second - first) * outwards / radius
    around_rate = (outwards - around) / radius  # of its logarithm
    along_rate = along * (tension_rate - by_around * around_rate) / by_along
    bending = along * (1.0 - second * math.sin(slope) / radius) / first
    energy = float(law.energy(along, around, through)) * place
    return along_rate, outwards, bending, upwards, energy, upwards * radius**2
