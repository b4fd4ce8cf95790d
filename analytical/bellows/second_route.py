"""An actuator's elongation from the paper's equations, solved one by one."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from analytical.bellows.dimensions import BellowsDimensions
from analytical.bellows.equations import TABLE_STEP
from analytical.bellows.reading import CORRECTED, Reading
from analytical.laws.isotropic import Law, Ogden


def elongation_by_equations_mm(
    dimensions: BellowsDimensions, law: Law, pressure_kpa: float, reading: Reading = CORRECTED
) -> float:
    """Elongation from the paper's equations by adaptive quadrature and bracketed root finding, mm.

    Independent of the chains' quadrature and root finders: eq. (16) is integrated over the stretch. Takes the
    readings of `CHAINS` only.
    """
    d, pressure = dimensions, 1e-3 * pressure_kpa
    root_outer, crest_outer = d.root_radius_mm + d.wall_mm, d.crest_radius_mm + d.wall_mm
    thick = (root_outer / d.root_radius_mm) ** 2

    def difference(s: float) -> float:
        if reading.root_derivative == "theta" and isinstance(law, Ogden):
            return 2.0 * law.mu_mpa * s ** (law.alpha - 1.0) * (s**2 - s**-2)  # eq. (9), j = theta, in eq. (7)
        return float(law.stress_difference(s, 1.0 / s, 1.0))

    def inner(outer: float) -> float:
        if reading.linear_inner_stretch:
            return outer + (thick - 1.0) * (outer**2 - 1.0) / (2.0 * outer)  # eq. (14)
        return math.sqrt(1.0 + thick * (outer**2 - 1.0))

    def root_pressure(outer: float) -> float:
        if outer == 1.0:
            return 0.0
        bounds = (outer, inner(outer))
        return float(quad(lambda s: difference(s) / (s * (s**2 - 1.0)), *bounds, epsabs=1e-15, epsrel=1e-13)[0])

    unfolded = crest_outer / root_outer
    if reading.tabulated_root:
        stretches, pressures = [1.0], [0.0]
        while pressures[-1] <= pressure:
            stretches.append(1.0 + TABLE_STEP * len(stretches))
            pressures.append(root_pressure(stretches[-1]))
        root = float(np.interp(pressure, pressures, stretches))
    elif root_pressure(unfolded) <= pressure:
        root = unfolded
    else:
        root = brentq(lambda s: root_pressure(s) - pressure, 1.0, unfolded, xtol=1e-15)
    drop = crest_outer - root * root_outer
    bore = d.root_radius_mm * inner(root)
    thrust_area, wall_area = d.crest_radius_mm**2, root_outer**2 - d.root_radius_mm**2
    if reading.cut == "mean":
        thrust_area = (d.crest_radius_mm**2 + d.crest_radius_mm * bore + bore**2) / 3.0
        wall_area = d.wall_mm * (d.root_radius_mm + crest_outer)
    length = d.side_length_mm

    def excess(s: float) -> float:
        if reading.wall_by_20 and isinstance(law, Ogden):
            return law.mu_mpa * (s**law.alpha - s**-law.alpha) * wall_area - pressure * thrust_area
        pull = float(law.stress_difference(s, 1.0 / s, 1.0)) * wall_area
        if reading.wall_on_deformed_area:
            pull /= s
        if reading.wall_along_axis:
            pull *= math.sqrt(max(0.0, 1.0 - (drop / (s * length)) ** 2))
        return pull - pressure * thrust_area

    wall = brentq(excess, 1.0, 100.0, xtol=1e-15)
    square = (wall * length) ** 2 - drop**2
    return 2.0 * d.convolutions * (math.sqrt(square) - d.half_pitch_mm) if square >= 0.0 else math.nan


def error_text(relative: float) -> str:
    """A relative error as text; round-off is not shown as zero."""
    least = float(np.finfo(float).eps)
    return f"{relative:.1e}" if relative >= least else f"below {least:.1e}"
