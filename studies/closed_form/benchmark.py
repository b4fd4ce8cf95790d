"""Speed of the closed form on one core, and its error against the equations solved one by one.

Nothing is tabulated for speed: every evaluation solves the equations, so there is no error of tabulation. (The chain as
printed interpolates in a table because the paper does.)
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import threadpoolctl
from scipy.integrate import quad
from scipy.optimize import brentq

from analytical.bellows.chains import closed_form
from analytical.bellows.dimensions import BellowsDesigns, BellowsDimensions
from analytical.bellows.equations import TABLE_STEP
from analytical.bellows.reading import CORRECTED, Reading
from analytical.laws.isotropic import Law, Ogden
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from studies.closed_form.tables import CHAINS
from studies.report.labels import model_label
from studies.report.tables import Table
from studies.results.rows import Row, row, write_rows

LAWS: Final[dict[str, Law]] = {"Dragon Skin 10": DRAGON_SKIN_10, "Dragon Skin 30": dragon_skin_30("2mu/alpha^2")}
DESIGNS: Final = 2000
PRESSURES_KPA: Final = np.linspace(1.0, 25.0, 16)
REPETITIONS: Final = 9
# Designs, each at one of the pressures, solved one by one for the error.
SAMPLE: Final = 300
GOAL_PER_SECOND: Final = 1e5
GOAL_ERROR: Final = 1e-8
SEED: Final = 20240160
# Ranges of the random designs, uniform; ours, round the four actuators.
ROOT_RADIUS_MM: Final = (3.0, 10.0)
WALL_OVER_ROOT: Final = (0.1, 0.5)
CREST_OVER_ROOT: Final = (1.2, 2.6)
HALF_PITCH_MM: Final = (3.0, 10.0)
CONVOLUTIONS: Final = (1, 20)


@dataclass(frozen=True)
class Measurement:
    """Speed and error of a chain with a law.

    Attributes
    ----------
    model, law
        Which.
    per_second
        Evaluations (one design at one pressure) per second, one value per repetition.
    unfolded
        Part of the evaluations at or past full unfolding, where held roots need no search.
    largest_error, median_error
        Relative error of the elongation over the sample.
    """

    model: str
    law: str
    per_second: tuple[float, ...]
    unfolded: float
    largest_error: float
    median_error: float


def run(folder: Path) -> Table:
    """Measure all chains with all laws; writes rows.csv into the folder and returns the table."""
    designs = random_designs(DESIGNS, SEED)
    found = [measure(model, name, designs) for model in CHAINS for name in LAWS]
    folder.mkdir(parents=True, exist_ok=True)
    write_rows(folder / "rows.csv", (entry for one in found for entry in _rows(one)))
    return table(found)


def random_designs(count: int, seed: int) -> BellowsDesigns:
    """Designs drawn uniformly from the ranges above; the same for the same seed."""
    draw = np.random.default_rng(seed)
    root = draw.uniform(*ROOT_RADIUS_MM, count)
    return BellowsDesigns(
        root_radius_mm=root,
        crest_radius_mm=root * draw.uniform(*CREST_OVER_ROOT, count),
        wall_mm=root * draw.uniform(*WALL_OVER_ROOT, count),
        half_pitch_mm=draw.uniform(*HALF_PITCH_MM, count),
        convolutions=draw.integers(CONVOLUTIONS[0], CONVOLUTIONS[1], count, endpoint=True),
    )


def measure(
    model: str, law_name: str, designs: BellowsDesigns, repetitions: int = REPETITIONS, sample: int = SAMPLE
) -> Measurement:
    """Time a chain over all designs and pressures, and compare a sample with the equations solved one by one."""
    law, reading = LAWS[law_name], CHAINS[model]
    per_second = []
    with threadpoolctl.threadpool_limits(limits=1):
        for _ in range(repetitions):
            begin = time.perf_counter()
            path = closed_form(designs, law, PRESSURES_KPA, reading)
            elongation = path.elongation_mm
            per_second.append(elongation.size / (time.perf_counter() - begin))
    errors = []
    for place in range(min(sample, designs.shape[0])):
        k = place % len(PRESSURES_KPA)
        one = BellowsDimensions(*(np.asarray(value)[place].item() for value in vars(designs).values()))
        exact = elongation_by_equations_mm(one, law, float(PRESSURES_KPA[k]), reading)
        found = float(elongation[place, k])
        # where the printed chain has no real half pitch, both must say so
        errors.append(0.0 if math.isnan(exact) and math.isnan(found) else abs(found - exact) / abs(exact))
    unfolded = float(np.mean(path.drop_mm <= 0.0))
    return Measurement(model, law_name, tuple(per_second), unfolded, float(np.max(errors)), float(np.median(errors)))


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


def table(found: Sequence[Measurement]) -> Table:
    """Speed and error of every chain and law."""
    lines = (
        (
            model_label(one.model),
            one.law,
            f"{max(one.per_second):.3g}",
            f"{min(one.per_second):.3g} to {max(one.per_second):.3g}",
            f"{100.0 * one.unfolded:.0f}",
            error_text(one.largest_error),
            error_text(one.median_error),
            "met" if max(one.per_second) >= GOAL_PER_SECOND and one.largest_error <= GOAL_ERROR else "missed",
        )
        for one in found
    )
    speed = ("evaluations per second", "range", "fully unfolded, %")
    goal = f"goal {GOAL_PER_SECOND:g}/s at {GOAL_ERROR:g}"
    header = ("chain", "silicone", *speed, "largest error", "median error", goal)
    return Table(header, tuple(lines), left=(0, 1, 7))


def setting() -> str:
    """What was measured, in words."""
    return (
        f"{DESIGNS} random designs (R_i {_span(ROOT_RADIUS_MM)} mm, t/R_i {_span(WALL_OVER_ROOT)}, R_p/R_i "
        f"{_span(CREST_OVER_ROOT)}, e {_span(HALF_PITCH_MM)} mm, n {_span(CONVOLUTIONS)}) at {len(PRESSURES_KPA)} "
        f"pressures, {PRESSURES_KPA[0]:g} to {PRESSURES_KPA[-1]:g} kPa; one core; best and range of {REPETITIONS} "
        f"repetitions. Error of the elongation against quadrature and bracketing on {SAMPLE} of the designs. Nothing "
        "is tabulated for speed."
    )


def error_text(relative: float) -> str:
    """A relative error as text; round-off is not shown as zero."""
    least = float(np.finfo(float).eps)
    return f"{relative:.1e}" if relative >= least else f"below {least:.1e}"


def _span(bounds: tuple[float, float]) -> str:
    return f"{bounds[0]:g} to {bounds[1]:g}"


def _rows(one: Measurement) -> list[Row]:
    size = f"{DESIGNS} designs x {len(PRESSURES_KPA)} pressures"
    values = (
        ("evaluations_per_second", "1/s", max(one.per_second), f"best of {len(one.per_second)}"),
        ("evaluations_per_second", "1/s", min(one.per_second), f"slowest of {len(one.per_second)}"),
        ("fully_unfolded_percent", "%", 100.0 * one.unfolded, ""),
        ("elongation_error_largest", "1", one.largest_error, ""),
        ("elongation_error_median", "1", one.median_error, ""),
    )
    return [
        row(one.law, quantity, unit, math.nan, one.model, value, level, source=size)
        for quantity, unit, value, level in values
    ]
