"""Exact solutions by two routes each, computed when the table is made.

Forces come from integrated stresses and from the slope of the stored energy, or from another pair of methods that share
the material law only.

Units: mm, N, MPa.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from analytical.arrays import FloatArray
from analytical.bellows.chains_by_name import path_of
from analytical.bellows.paper import PRINTED_PRESSURE_KPA, actuators
from analytical.bellows.reading import CORRECTED
from analytical.bellows.second_route import elongation_by_equations_mm, error_text
from analytical.exact import compressible, cube, flat_sheet, flexure, homogeneous, ring, sphere, torsion, tube
from analytical.laws.isotropic import Law, OgdenSeries
from analytical.laws.of_invariants import ArrudaBoyce, Gent, MooneyRivlin
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from studies.report.tables import Table, table_of
from studies.results.rows import Row, row

# The paper's two, and one of every other law with a modulus like theirs.
LAWS: Final[dict[str, Law]] = {
    "Dragon Skin 10": DRAGON_SKIN_10,
    "Dragon Skin 30": dragon_skin_30("2mu/alpha^2"),
    "Mooney-Rivlin": MooneyRivlin((0.03, 0.005, 0.0004, 0.0003, 0.0001)),
    "Gent": Gent(0.07, 30.0),
    "Arruda-Boyce": ArrudaBoyce(0.07, 4.0),
    "Ogden, 3 terms": OgdenSeries((0.06, 0.002, 0.01), (1.3, 5.0, -2.0), "2mu/alpha^2"),
}
# Two routes that differ by more than this are not two routes to the same thing.
GOAL: Final = 1e-10
# A wall as thick as the 2 mm actuator's root.
_TUBE: Final = tube.Tube(5.0, 7.0)
_SPHERE: Final = sphere.Sphere(5.0, 7.0)
_SHEET: Final = flat_sheet.FlatSheet(50.0, 0.25)
_CYLINDER: Final = torsion.TwistedCylinder(10.0, 0.05, 1.2)
_BLOCK: Final = flexure.BentBlock(2.0, 10.0, 1.5)
_BULK_OVER_SHEAR: Final = 100.0
# Central difference of order 8 (Fornberg, Math. Comp. 51 (1988) 699, table 1); at steps of 1 % of the argument
# truncation and round-off are both about 1e-13 of a smooth energy's slope.
_WEIGHTS: Final = (4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0)
_STEP: Final = 1e-2
_COMPLEX_STEP: Final = 1e-30


@dataclass(frozen=True)
class TwoRoutes:
    """A quantity of a problem by two routes.

    Attributes
    ----------
    problem, law, quantity, unit
        What.
    first, second
        Values.
    routes
        How each was found.
    """

    problem: str
    law: str
    quantity: str
    unit: str
    first: float
    second: float
    routes: tuple[str, str]

    @property
    def difference(self) -> float:
        """Relative difference."""
        return abs(self.first - self.second) / abs(self.second)


def all_routes() -> list[TwoRoutes]:
    """Every problem with every law."""
    problems = (
        *(_homogeneous, _tube, _capped_tube, _sphere, _sheet, _torsion, _flexure, _cube, _ring, _compressible),
        _bellows,
    )
    return [found for problem in problems for name, law in LAWS.items() for found in problem(name, law)]


def table(found: list[TwoRoutes]) -> Table:
    """Both values of every quantity and how far they are apart."""
    columns = {
        "problem": lambda one: one.problem,
        "law": lambda one: one.law,
        "quantity": lambda one: f"{one.quantity}, {one.unit}",
        "route 1": lambda one: f"{one.first:.12g}",
        "route 2": lambda one: f"{one.second:.12g}",
        "relative difference": lambda one: error_text(one.difference),
        "routes": lambda one: " / ".join(one.routes),
    }
    return table_of(found, columns, left=(0, 1, 2, 6))


def rows(found: list[TwoRoutes]) -> list[Row]:
    """Rows of the table: the first route, with the second as its reference."""
    return [
        row(
            one.problem,
            one.quantity,
            one.unit,
            math.nan,
            "exact",
            one.first,
            one.law,
            reference=one.second,
            source=one.routes[1],
        )
        for one in found
    ]


def slope(function: Callable[[float], float], at: float) -> float:
    """Derivative by central differences of order 8."""
    h = _STEP * at
    return sum(w * (function(at + k * h) - function(at - k * h)) for k, w in enumerate(_WEIGHTS, start=1)) / h


# --- the problems ---------------------------------------------------------------------------

_BY_ENERGY: Final = ("stresses", "slope of the energy")


def _homogeneous(name: str, law: Law) -> Iterator[TwoRoutes]:
    stretch = 2.0
    for mode in homogeneous.MODES:
        by_stress = float(homogeneous.nominal_stress_mpa(law, mode, stretch))
        energy = homogeneous.stored_energy_mpa(law, mode, stretch + 1j * _COMPLEX_STEP)
        by_energy = float(energy.imag) / _COMPLEX_STEP / homogeneous.pulled_directions(mode)
        yield TwoRoutes(f"{mode}, stretch {stretch:g}", name, "nominal stress", "MPa", by_stress, by_energy, _BY_ENERGY)


def _tube(name: str, law: Law) -> Iterator[TwoRoutes]:
    held, inner = replace(_TUBE, axial_stretch=1.2), 7.5
    problem = f"tube {_TUBE.inner_radius_mm:g}/{_TUBE.outer_radius_mm:g} mm, a = {inner:g} mm, λz = 1.2"
    by_area = slope(lambda a: tube.stored_energy_n(held, law, a), inner) / (2.0 * math.pi * inner * 1.2)
    pressure = tube.pressure_at_inner_radius_mpa(held, law, inner)
    yield TwoRoutes(problem, name, "pressure", "MPa", pressure, by_area, _BY_ENERGY)
    by_length = slope(lambda lz: tube.stored_energy_n(replace(held, axial_stretch=lz), law, inner), 1.2)
    force = tube.axial_force_n(held, law, inner)
    yield TwoRoutes(problem, name, "axial force", "N", force, by_length, _BY_ENERGY)


def _capped_tube(name: str, law: Law) -> Iterator[TwoRoutes]:
    inner = 6.5
    state = tube.state_at_inner_radius(_TUBE, law, inner, "capped")
    lz = state.tube.axial_stretch
    # the bore's volume grows by pi a^2 per axial stretch
    work = slope(lambda at: tube.stored_energy_n(replace(_TUBE, axial_stretch=at), law, inner), lz)
    by_energy = work / (math.pi * inner**2)
    problem = f"capped tube {_TUBE.inner_radius_mm:g}/{_TUBE.outer_radius_mm:g} mm, a = {inner:g} mm"
    yield TwoRoutes(problem, name, "pressure", "MPa", state.pressure_mpa, by_energy, _BY_ENERGY)


def _sphere(name: str, law: Law) -> Iterator[TwoRoutes]:
    inner = 7.5
    pressure = sphere.pressure_at_inner_radius_mpa(_SPHERE, law, inner)
    by_energy = slope(lambda a: sphere.stored_energy_mj(_SPHERE, law, a), inner) / (4.0 * math.pi * inner**2)
    problem = f"sphere {_SPHERE.inner_radius_mm:g}/{_SPHERE.outer_radius_mm:g} mm, a = {inner:g} mm"
    yield TwoRoutes(problem, name, "pressure", "MPa", pressure, by_energy, _BY_ENERGY)


def _sheet(name: str, law: Law) -> Iterator[TwoRoutes]:
    stretch = 1.6
    state = flat_sheet.inflated(_SHEET, law, stretch)
    tension = _SHEET.thickness_mm * flat_sheet.tensions(law, state.rim_stretch, 1.0)[0]
    rim = _SHEET.thickness_mm * float(law.energy(state.rim_stretch, 1.0, 1.0 / state.rim_stretch))
    rim += tension * (math.cos(state.rim_slope) - state.rim_stretch)
    # all lengths grown alike: U is of their square, V of their third power, and the rim is pulled along
    by_energy = (2.0 * state.energy_mj - 2.0 * math.pi * _SHEET.radius_mm**2 * rim) / (3.0 * state.volume_mm3)
    problem = (
        f"flat sheet of {_SHEET.radius_mm:g} mm, {_SHEET.thickness_mm:g} mm thick, stretch {stretch:g} at the pole"
    )
    routes = ("equilibrium along and across the meridian", "energy and volume of the whole, by scaling")
    yield TwoRoutes(problem, name, "pressure", "MPa", state.pressure_mpa, by_energy, routes)


def _torsion(name: str, law: Law) -> Iterator[TwoRoutes]:
    c = _CYLINDER
    problem = f"cylinder of {c.radius_mm:g} mm, {c.twist_rad_per_mm:g} rad/mm, λz = {c.axial_stretch:g}"
    by_twist = slope(lambda at: torsion.stored_energy_n(replace(c, twist_rad_per_mm=at), law), c.twist_rad_per_mm)
    yield TwoRoutes(problem, name, "torque", "N mm", torsion.torque_nmm(c, law), by_twist, _BY_ENERGY)
    by_length = slope(lambda at: torsion.stored_energy_n(replace(c, axial_stretch=at), law), c.axial_stretch)
    yield TwoRoutes(problem, name, "axial force", "N", torsion.axial_force_n(c, law), by_length, _BY_ENERGY)


def _flexure(name: str, law: Law) -> Iterator[TwoRoutes]:
    b = _BLOCK
    by_angle = slope(lambda at: flexure.stored_energy_n(replace(b, angle_rad=at), law), b.angle_rad)
    problem = f"block {b.thickness_mm:g} x {b.length_mm:g} mm bent to {b.angle_rad:g} rad"
    yield TwoRoutes(problem, name, "moment per width", "N", flexure.moment_n(b, law), by_angle, _BY_ENERGY)


def _cube(name: str, law: Law) -> Iterator[TwoRoutes]:
    stretch = 1.5
    moved = stretch + 1j * _COMPLEX_STEP
    energy = law.energy(moved, moved, moved**-2.0)
    # 0 = d/dl (W(l, l, l^-2) - T (2 l + l^-2))
    by_energy = float(energy.imag) / _COMPLEX_STEP / (2.0 - 2.0 * stretch**-3.0)
    tension = float(cube.branch_tension_mpa(law, stretch))
    yield TwoRoutes(f"Rivlin's cube, plate of {stretch:g}", name, "tension", "MPa", tension, by_energy, _BY_ENERGY)


def _ring(name: str, law: Law) -> Iterator[TwoRoutes]:
    thin = tube.Tube(10.0, 11.0)
    for load in ring.LOADS:
        found = ring.first_buckling(thin, law, 2, load)

        def softest(inner_mm: float, load: ring.Load = load) -> float:
            return float(np.linalg.eigvalsh(ring.second_variation_mpa(thin, law, inner_mm, 2, load))[0])

        inner = brentq(softest, 0.99 * found.inner_mm, 1.001 * found.inner_mm, xtol=1e-15, rtol=1e-15)
        by_ritz = -tube.pressure_at_inner_radius_mpa(thin, law, inner)
        problem = f"ring {thin.inner_radius_mm:g}/{thin.outer_radius_mm:g} mm, two waves, {load} pressure"
        yield TwoRoutes(problem, name, "critical pressure", "MPa", found.pressure_mpa, by_ritz, ("shooting", "Ritz"))


def _compressible(name: str, law: Law) -> Iterator[TwoRoutes]:
    kappa = _BULK_OVER_SHEAR * law.initial_shear_modulus_mpa
    inner = 6.5
    for body, what in ((_TUBE, "tube"), (_SPHERE, "sphere")):
        state = compressible.state_at_inner_radius(body, law, kappa, inner)
        problem = (
            f"{what} {body.inner_radius_mm:g}/{body.outer_radius_mm:g} mm, κ = {_BULK_OVER_SHEAR:g} μ, a = {inner:g} mm"
        )
        by_shooting = _pressure_by_shooting(body, law, kappa, inner)
        routes = ("Galerkin", "shooting")
        yield TwoRoutes(problem, name, "pressure", "MPa", state.pressure_mpa, by_shooting, routes)


def _bellows(name: str, law: Law) -> Iterator[TwoRoutes]:
    for actuator in actuators():
        if actuator.law == law:
            chain = float(path_of(actuator, CORRECTED, [PRINTED_PRESSURE_KPA]).elongation_mm[0])
            one_by_one = elongation_by_equations_mm(actuator.dimensions, law, PRINTED_PRESSURE_KPA)
            problem = f"closed form, {actuator.name}, {PRINTED_PRESSURE_KPA:g} kPa"
            routes = ("Newton on Gauss points in ln R", "bracketing on quadrature in λ")
            yield TwoRoutes(problem, name, "elongation", "mm", chain, one_by_one, routes)


# --- the compressible wall as an initial value problem --------------------------------------


def _pressure_by_shooting(body: tube.Tube | sphere.Sphere, law: Law, kappa: float, inner_mm: float) -> float:
    """Pressure at an inner radius from r(R) integrated outwards, with r'(A) such that the outer surface is free.

    Radial equilibrium per undeformed volume, dS_R/dR + (d - 1) (S_R - S_T) / R = 0 with S = dU/dl for U = W + kappa/2
    (J - 1)^2, d = 2 (tube in plane strain) or 3 (sphere), solved for r''.
    """
    d = 2 if isinstance(body, tube.Tube) else 3

    def nominal(radial: complex, hoop: complex) -> tuple[complex, complex]:
        third = hoop if d == 3 else 1.0
        volume = radial * hoop * third
        r, t, z = (stretch * volume ** (-1.0 / 3.0) for stretch in (radial, hoop, third))
        mean = kappa * (volume - 1.0) * volume
        s_r = (law.stress_difference(r, t, z) + law.stress_difference(r, z, t)) / 3.0 + mean
        s_t = (law.stress_difference(t, r, z) + law.stress_difference(t, z, r)) / 3.0 + mean
        return complex(s_r) / radial, complex(s_t) / hoop

    def rate(radius: float, at: FloatArray) -> tuple[float, float]:
        deformed, radial = at
        hoop = deformed / radius
        s_r, s_t = nominal(radial, hoop)
        by_radial = nominal(radial + 1j * _COMPLEX_STEP, hoop)[0].imag / _COMPLEX_STEP
        by_hoop = nominal(radial, hoop + 1j * _COMPLEX_STEP)[0].imag / _COMPLEX_STEP
        growth = (d - 1) * (s_t - s_r).real / radius - by_hoop * (radial - hoop) / radius
        return float(radial), growth / by_radial

    def outer_stress(start: float) -> float:
        end = solve_ivp(
            rate,
            (body.inner_radius_mm, body.outer_radius_mm),
            (inner_mm, start),
            method="DOP853",
            rtol=1e-13,
            atol=1e-14,
        ).y[:, -1]
        return nominal(float(end[1]), float(end[0]) / body.outer_radius_mm)[0].real

    hoop = inner_mm / body.inner_radius_mm
    # the volume at the bore changes by far less than 10 %
    guess = hoop ** (1 - d)
    start = brentq(outer_stress, 0.95 * guess, 1.05 * guess, xtol=1e-15, rtol=1e-15)
    # Cauchy stress is force over deformed area
    return -nominal(start, hoop)[0].real / hoop ** (d - 1)
