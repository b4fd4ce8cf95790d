"""Sentences of the sweep study."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np

from studies.report.labels import model_label
from studies.report.numbers import signed
from studies.results.rows import REACHED
from studies.sweep.csv_table import REFUSED, SweepRow
from studies.sweep.designs import MAP_COUNT, WALL_KEY, convolutions, grouped, is_off, root_and_wall, silicone
from studies.sweep.rules import LIMIT_PERCENT, Point, Rule


def trusted(rows: Sequence[SweepRow]) -> str:
    """Where the closed form is within the limit, by walls."""
    walls = Counter(row.values[WALL_KEY] for row in rows if not is_off(row.closed_form_percent))
    all_of = Counter(row.values[WALL_KEY] for row in rows)
    texts = (f"{number} of {all_of[wall]} states with t = {wall:g} mm" for wall, number in sorted(walls.items()))
    return " and ".join(texts) or "nowhere"


def rule_words(rule: Rule, points: Sequence[Point], others: Sequence[Point]) -> str:
    """A rule of two factors, and how far it holds."""
    elsewhere = f" and {100.0 * rule.hits(others):.0f} % of those with other numbers of convolutions" if others else ""
    percents = np.abs(rule.percent(points))
    return (
        f"Take the {model_label(rule.chain)}, and multiply its elongation by {rule.above:g}, or by {rule.below:g} "
        f"while P R<sub>p</sub>/(μ t) is below {rule.split:g} (μ is the initial shear modulus). That meets the finite "
        f"elements within {LIMIT_PERCENT:g} % at {100.0 * rule.hits(points):.0f} % of the states it was found on"
        f"{elsewhere}; nine in ten states are within {float(np.quantile(percents, 0.9)):.0f} %, the worst is "
        f"{float(percents.max()):.0f} % off."
    )


def of_convolutions(rows: Sequence[SweepRow]) -> str:
    """How far elongation per convolution and the closed form's error depend on the number."""
    alike = grouped(rows, lambda row: (silicone(row), root_and_wall(row), row.pressure_kpa)).values()
    designs = [{convolutions(row): row for row in some} for some in alike]
    texts = []
    for n in sorted({convolutions(row) for row in rows} - {MAP_COUNT}):
        pairs = [(some[n], some[MAP_COUNT]) for some in designs if n in some and MAP_COUNT in some]
        changes = [100.0 * (a.axisymmetric / n / (b.axisymmetric / MAP_COUNT) - 1.0) for a, b in pairs]
        apart = [abs(a.closed_form_percent - b.closed_form_percent) for a, b in pairs]
        texts.append(
            f"n = {n} instead of {MAP_COUNT} changes it by {signed(min(changes))} to {signed(max(changes))} % and the "
            f"closed form's difference by at most {max(apart):.1f} points"
        )
    return "; ".join(texts) + "."


def unreached(rows: Iterable[SweepRow]) -> list[str]:
    """Scenes that stopped or failed."""
    found = (row for row in rows if row.status != REACHED and not row.status.startswith(REFUSED))
    return [f"{row.scene} at {row.pressure_kpa:g} kPa: {row.status}" for row in found]


def levels(rows: Iterable[SweepRow]) -> str:
    """Finest meshes, or that states are extrapolated, and how many each gave."""
    return ", ".join(f"{level} ({number} states)" for level, number in sorted(Counter(r.level for r in rows).items()))
