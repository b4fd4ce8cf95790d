"""A flat circular sheet, held at its rim and inflated, as a membrane: incompressible, any isotropic law.

With l_1 along the meridian, l_2 = r/R round the axis, phi the meridian's slope, tensions T_i per deformed length

    T_i = h sigma_i / (l_1 l_2)                       sigma_3 = 0 through the thickness
    dr/dR = l_1 cos phi,  dz/dR = l_1 sin phi
    dT_1/dR = (T_2 - T_1) l_1 cos phi / r             along the meridian
    T_1 dphi/dR = l_1 (P - T_2 sin phi / r)           across it

(Adkins & Rivlin, Phil. Trans. R. Soc. A 244 (1952) 505, doi 10.1098/rsta.1952.0013; the sheet of Treloar, Trans. Inst.
Rubber Ind. 19 (1944) 201). At the pole l_1 = l_2 and dphi/dR = P l / (2 T). All lengths grow as 1/P, so one integration
from a pole's stretch out to l_2 = 1 gives the pressure of any radius.
Units: mm, N, MPa.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize_scalar

from analytical.arrays import FloatArray
from analytical.exact.search import STRETCH_RANGE, root
from analytical.laws.isotropic import IsotropicLaw

# Where the integration starts, of the radius of curvature at the pole: what is left out there is of its square, 1e-12.
_POLE: Final = 1e-6
_WITHIN: Final = {"rtol": 1e-11, "atol": 1e-12, "method": "DOP853"}


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
    """A state: pressure, MPa, height of the pole, mm, its stretch, tension and slope at the rim (N/mm, rad)."""

    pressure_mpa: float
    height_mm: float
    pole_stretch: float
    rim_tension_n_per_mm: float
    rim_slope: float


def inflated(sheet: FlatSheet, law: IsotropicLaw, pole_stretch: float) -> Inflated:
    """The equilibrium with a stretch at the pole.

    Raises
    ------
    SheetError
        If the stretch is not above 1 and within what elastomers reach, or the sheet has no such state.
    """
    if not 1.0 < pole_stretch < STRETCH_RANGE[1]:
        raise SheetError(f"stretch {pole_stretch:g} at the pole: need 1 < stretch < {STRETCH_RANGE[1]:g}")
    tension, _ = _tensions(law, pole_stretch, pole_stretch)
    if not tension > 0.0:
        raise SheetError(f"stretch {pole_stretch:g} at the pole: the law has no tension there; take a smaller one")

    def at_rim(place: float, at: FloatArray) -> float:
        return float(at[1] - place)

    at_rim.terminal, at_rim.direction = True, -1  # type: ignore[attr-defined]
    # in units of the sheet's thickness times MPa over the pressure: P = 1, h = 1
    start = _POLE * tension
    first = (pole_stretch, pole_stretch * start, 0.5 * pole_stretch * start / tension, 0.0)
    end = 1e3 * pole_stretch * tension
    found = solve_ivp(lambda place, at: _rates(law, place, at), (start, end), first, events=at_rim, **_WITHIN)
    if not found.success or not len(found.t_events[0]):
        raise SheetError(f"stretch {pole_stretch:g} at the pole: no rim is met; take a smaller one")
    (radius,), ((along, around, slope, height),) = found.t_events[0], found.y_events[0]
    scale = sheet.radius_mm / radius
    rim, _ = _tensions(law, float(along), float(around / radius))
    return Inflated(
        pressure_mpa=sheet.thickness_mm / scale,
        height_mm=float(height * scale),
        pole_stretch=pole_stretch,
        rim_tension_n_per_mm=rim * sheet.thickness_mm,
        rim_slope=float(slope),
    )


def at_pressure(sheet: FlatSheet, law: IsotropicLaw, pressure_mpa: float) -> Inflated:
    """The equilibrium under a pressure below the limit point, on the way up from rest.

    Raises
    ------
    SheetError
        If the pressure is not positive, or at or above the limit.
    """
    top = limit_point(sheet, law)
    if not 0.0 < pressure_mpa < top.pressure_mpa:
        raise SheetError(f"pressure {pressure_mpa:g} MPa: need 0 < pressure < {top.pressure_mpa:g}, the sheet's limit")

    def excess(stretch: float) -> float:
        return inflated(sheet, law, stretch).pressure_mpa - pressure_mpa

    return inflated(sheet, law, root(excess, 1.0 + 1e-6, top.pole_stretch, 1e-12))


def limit_point(sheet: FlatSheet, law: IsotropicLaw, most: float = 4.0) -> Inflated:
    """The maximum of the pressure below a stretch at the pole.

    Raises
    ------
    SheetError
        If the pressure still rises at that stretch.
    """
    found = minimize_scalar(
        lambda stretch: -inflated(sheet, law, stretch).pressure_mpa,
        bounds=(1.0 + 1e-3, most),
        method="bounded",
        options={"xatol": 1e-8},
    )
    if found.x > most - 1e-3:
        raise SheetError(f"no maximum of the pressure below a stretch of {most:g} at the pole: give a larger one")
    return inflated(sheet, law, float(found.x))


def _tensions(law: IsotropicLaw, along: float, around: float) -> tuple[float, float]:
    """Tensions per deformed length along the meridian and round the axis, of a sheet of thickness 1."""
    through = 1.0 / (along * around)
    first = law.stress_difference(along, through, around)
    second = law.stress_difference(around, through, along)
    return float(first * through), float(second * through)


def _rates(law: IsotropicLaw, place: float, at: FloatArray) -> tuple[float, float, float, float]:
    """Slopes by R of l_1, r, phi and z, under a pressure of 1."""
    along, radius, slope, _ = (float(value) for value in at)
    around = radius / place
    through = 1.0 / (along * around)
    first, second = _tensions(law, along, around)
    hessian = np.asarray(law.log_hessian_mpa(along, around, through))
    # by the logarithms of l_1 and of l_2, where l_3 = 1/(l_1 l_2)
    by_along = hessian[0, 0] - 2.0 * hessian[0, 2] + hessian[2, 2]
    by_around = hessian[0, 1] - hessian[1, 2] - hessian[0, 2] + hessian[2, 2]
    by_along, by_around = by_along * through - first, by_around * through - first
    outwards = along * math.cos(slope)
    tension_rate = (second - first) * outwards / radius
    around_rate = (outwards - around) / radius  # of its logarithm
    along_rate = along * (tension_rate - by_around * around_rate) / by_along
    bending = along * (1.0 - second * math.sin(slope) / radius) / first
    return along_rate, outwards, bending, along * math.sin(slope)
