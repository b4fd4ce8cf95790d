"""Speed of the closed form on one core, and its error against the equations solved one by one.

Nothing is tabulated for speed: every evaluation solves the equations, so there is no error of tabulation. (The chain as
printed interpolates in a table because the paper does.)
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import click
import numpy as np
import threadpoolctl

from analytical.bellows.chains import closed_form
from analytical.bellows.chains_by_name import CHAINS, SILICONES
from analytical.bellows.dimensions import BellowsDesigns, BellowsDimensions
from analytical.bellows.paper import LAWS, Silicone
from analytical.bellows.second_route import elongation_by_equations_mm, error_text
from studies.engine import Page, Setting, Solved, Study
from studies.report.labels import model_label
from studies.report.tables import as_text, table_of
from studies.results.rows import Row, row

DESIGNS: Final = 2000
PRESSURES_KPA: Final = np.linspace(1.0, 25.0, 16)
REPETITIONS: Final = 9
# Designs, each at one of the pressures, solved one by one for the error.
SAMPLE: Final = 300
GOAL_PER_SECOND: Final = 1e5
GOAL_ERROR: Final = 1e-8
SEED: Final = 20240160
CONVOLUTIONS: Final = (1, 20)
# Ranges of the random designs, uniform; ours, round the four actuators.
RANGES: Final[Mapping[str, tuple[float, float]]] = {
    "R_i": (3.0, 10.0),
    "t/R_i": (0.1, 0.5),
    "R_p/R_i": (1.2, 2.6),
    "e": (3.0, 10.0),
    "n": CONVOLUTIONS,
}


@dataclass(frozen=True)
class Case:
    """A chain with the law of a silicone."""

    model: str
    silicone: Silicone

    @property
    def name(self) -> str:
        """For messages."""
        return f"{self.model}, {self.silicone}"


@dataclass(frozen=True)
class Measurement:
    """Speed and error of a chain with a law.

    Attributes
    ----------
    per_second
        Evaluations (one design at one pressure) per second, one value per repetition.
    unfolded
        Part of the evaluations at or past full unfolding, where held roots need no search.
    largest_error, median_error
        Relative error of the elongation over the sample.
    """

    per_second: tuple[float, ...]
    unfolded: float
    largest_error: float
    median_error: float


Measured = Solved[Case, Measurement]


def cases(options: Mapping[str, Any]) -> list[Case]:
    """Every chain with every law."""
    return [Case(model, silicone) for model in CHAINS for silicone in LAWS]


def solve(case: Case, at: Setting) -> Measurement:
    """Speed and error of a case."""
    return measure(case, random_designs(DESIGNS, SEED))


def random_designs(count: int, seed: int) -> BellowsDesigns:
    """Designs drawn uniformly from the ranges above; the same for the same seed."""
    draw = np.random.default_rng(seed)
    root = draw.uniform(*RANGES["R_i"], count)
    return BellowsDesigns(
        root_radius_mm=root,
        crest_radius_mm=root * draw.uniform(*RANGES["R_p/R_i"], count),
        wall_mm=root * draw.uniform(*RANGES["t/R_i"], count),
        half_pitch_mm=draw.uniform(*RANGES["e"], count),
        convolutions=draw.integers(*CONVOLUTIONS, count, endpoint=True),
    )


def measure(case: Case, designs: BellowsDesigns, repetitions: int = REPETITIONS, sample: int = SAMPLE) -> Measurement:
    """Time a chain over all designs and pressures, and compare a sample with the equations solved one by one."""
    law, reading = LAWS[case.silicone], CHAINS[case.model]
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
    return Measurement(tuple(per_second), unfolded, float(np.max(errors)), float(np.median(errors)))


def page(solved: Sequence[Measured], at: Setting) -> Page:
    """Speed and error of every chain and law. Whether the goals are met depends on the machine, so it is no bar."""
    columns: dict[str, Callable[[Measured], str]] = {
        "chain": lambda s: model_label(s.case.model),
        "silicone": lambda s: SILICONES[s.case.silicone],
        "evaluations per second": lambda s: f"{max(s.result.per_second):.3g}",
        "range": lambda s: f"{min(s.result.per_second):.3g} to {max(s.result.per_second):.3g}",
        "fully unfolded, %": lambda s: f"{100.0 * s.result.unfolded:.0f}",
        "largest error": lambda s: error_text(s.result.largest_error),
        "median error": lambda s: error_text(s.result.median_error),
        f"goal {GOAL_PER_SECOND:g}/s at {GOAL_ERROR:g}": lambda s: "met" if meets_goals(s.result) else "missed",
    }
    speeds = table_of(solved, columns, left=(0, 1, 7))
    click.echo(as_text(speeds))
    content = {
        "designs": DESIGNS,
        "ranges": "; ".join(f"{name} {low:g} to {high:g}" for name, (low, high) in RANGES.items()),
        "pressures": PRESSURES_KPA,
        "repetitions": REPETITIONS,
        "sample": SAMPLE,
        "speeds": speeds,
    }
    return Page([entry for one in solved for entry in rows(one)], content)


def meets_goals(found: Measurement) -> bool:
    """Fast and exact enough."""
    return max(found.per_second) >= GOAL_PER_SECOND and found.largest_error <= GOAL_ERROR


def rows(one: Measured) -> list[Row]:
    """Rows of a case."""
    name, found, source = (
        SILICONES[one.case.silicone],
        one.result,
        f"{DESIGNS} designs x {len(PRESSURES_KPA)} pressures",
    )

    def entry(quantity: str, unit: str, value: float, level: str = "") -> Row:
        return row(name, quantity, unit, math.nan, one.case.model, value, level, source=source)

    return [
        entry("evaluations_per_second", "1/s", max(found.per_second), f"best of {len(found.per_second)}"),
        entry("evaluations_per_second", "1/s", min(found.per_second), f"slowest of {len(found.per_second)}"),
        entry("fully_unfolded_percent", "%", 100.0 * found.unfolded),
        entry("elongation_error_largest", "1", found.largest_error),
        entry("elongation_error_median", "1", found.median_error),
    ]


STUDY: Final = Study(
    name="benchmark-closed-form",
    title="Speed of the closed form",
    question="How many evaluations of the closed form does one core make in a second, and how exact are they?",
    template="closed_form/speed.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="first",
)
