"""The second route to the closed form: the paper's equations, integrated over the stretch."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from analytical.bellows.paper import PaperActuator
from analytical.laws.isotropic import Ogden
from analytical.laws.silicones import dragon_skin_30


def elongation_by_equations_cm(
    actuator: PaperActuator,
    pressure_mpa: float = 0.02,
    linearised: bool = False,
    ogden_derivative: bool = False,
    ogden_wall_by_20: bool = False,
    saturated: bool = True,
    table: bool = False,
    wall_stress_on_deformed_area: bool = False,
) -> float:
    """The paper's equations as they stand (pressure with its sign corrected), integrated over the stretch.

    Independent of the chains, but for the laws; each flag puts back one printed form, but the last, which is neither.
    """
    d, law = actuator.dimensions, actuator.law
    epsilon = d.wall_mm / d.root_radius_mm

    def root_difference(stretch: float) -> float:
        if ogden_derivative and isinstance(law, Ogden):  # eq. (9), j = theta, put into eq. (7)
            return 2.0 * (stretch**2 - stretch**-2) * law.mu_mpa * stretch ** (law.alpha - 1.0)
        return float(law.stress_difference(stretch, 1.0 / stretch, 1.0))

    def inner_stretch(outer: float) -> float:
        if linearised:  # eq. (14)
            return outer + (2.0 * epsilon + epsilon**2) * (outer**2 - 1.0) / (2.0 * outer)
        return math.sqrt(1.0 + (1.0 + epsilon) ** 2 * (outer**2 - 1.0))

    def root_pressure(outer: float) -> float:  # eqs. (16), (17)
        if outer == 1.0:
            return 0.0
        integral = quad(
            lambda s: root_difference(s) / (s * (s**2 - 1.0)),
            outer,
            inner_stretch(outer),
            epsabs=1e-14,
            epsrel=1e-12,
        )
        return float(integral[0])

    unfolded = (d.crest_radius_mm + d.wall_mm) / (d.root_radius_mm + d.wall_mm)
    if saturated and root_pressure(unfolded) <= pressure_mpa:
        root = unfolded
    elif table:
        tabulated = np.arange(1.0, 3.0, 0.1)
        root = float(np.interp(pressure_mpa, [root_pressure(s) for s in tabulated], tabulated))
    else:
        root = brentq(lambda s: root_pressure(s) - pressure_mpa, 1.0, 6.0, xtol=1e-14)
    wall_law = law
    if ogden_wall_by_20 and isinstance(law, Ogden):
        wall_law = dragon_skin_30("mu/alpha")
    stress = pressure_mpa * d.crest_radius_mm**2 / ((d.root_radius_mm + d.wall_mm) ** 2 - d.root_radius_mm**2)

    def wall_excess(stretch: float) -> float:
        area = 1.0 / stretch if wall_stress_on_deformed_area else 1.0
        return float(wall_law.stress_difference(stretch, 1.0 / stretch, 1.0)) * area - stress

    wall = brentq(wall_excess, 1.0, 10.0, xtol=1e-14)
    side = wall * math.hypot(d.half_pitch_mm, d.crest_radius_mm - d.root_radius_mm)
    drop = (d.crest_radius_mm + d.wall_mm) - root * (d.root_radius_mm + d.wall_mm)
    return 0.1 * 2.0 * d.convolutions * (math.sqrt(side**2 - drop**2) - d.half_pitch_mm)
