"""Tables of the sweep study."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from analytical.bellows.chains_by_name import SILICONES
from studies.report.labels import model_label
from studies.report.numbers import MISSING, signed
from studies.report.tables import Table, table_of
from studies.sweep.csv_table import CHAINS, REFUSED, SweepRow
from studies.sweep.designs import (
    convolutions,
    folding,
    grouped,
    is_off,
    pressures,
    root_and_wall,
    silicone_name,
)
from studies.sweep.rules import LIMIT_PERCENT, Point, Rule, across, one_factor, two_factors


def shares(rows: Sequence[SweepRow]) -> Table:
    """How far the chains are off, by silicone and pressure."""
    groups = sorted(grouped(rows, lambda row: (silicone_name(row), row.pressure_kpa)).items())
    lines = [(name, f"{pressure:g}", *_chain_cells(some)) for (name, pressure), some in groups]
    return Table(("silicone", "kPa", "designs", *_chain_header()), tuple(lines))


def by_state(rows: Sequence[SweepRow]) -> Table:
    """The same by silicone and by what the closed form is in."""
    groups = sorted(grouped(rows, lambda row: (silicone_name(row), folding(row))).items())
    lines = [(*key, *_chain_cells(some)) for key, some in groups]
    return Table(("silicone", "closed form is", "states", *_chain_header()), tuple(lines), left=(0, 1))


def _chain_cells(rows: Sequence[SweepRow]) -> list[str]:
    """Number of rows, median and range of each chain's differences, and the share beyond the limit."""
    cells = [str(len(rows))]
    for chain in CHAINS:
        percents = [row.percent(chain) for row in rows]
        cells += [_spread(percents), f"{100.0 * np.mean([is_off(p) for p in percents]):.0f}"]
    return cells


def _chain_header() -> list[str]:
    names = [model_label(chain) for chain in CHAINS]
    return [text for name in names for text in (f"{name}: median (range), %", f"beyond {LIMIT_PERCENT:g} %")]


def _spread(percents: Sequence[float]) -> str:
    return f"{signed(float(np.median(percents)))} ({signed(min(percents))} to {signed(max(percents))})"


def find_rules(points: Sequence[Point]) -> list[Rule]:
    """Nothing done, each chain with its best factor, and the best two factors; the best of all last."""
    ones = [one_factor(chain, points) for chain in CHAINS]
    twos = sorted((two_factors(chain, points) for chain in CHAINS), key=lambda rule: rule.hits(points))
    return [Rule("closed_form", 0.0, 1.0, 1.0), *ones, *twos]


def rules(found: Sequence[Rule], points: Sequence[Point], others: Sequence[Point]) -> Table:
    """How many states each rule meets: those it was found on, of the other silicone, of other convolutions."""

    def elsewhere(rule: Rule) -> float:
        as_it_is = rule.above == 1.0 and not rule.split
        return rule.hits(points) if as_it_is else across(rule.chain, points, split=rule.split > 0.0)

    def span(rule: Rule) -> str:
        percents = rule.percent(points)
        return f"{signed(float(percents.min()))} to {signed(float(percents.max()))}"

    columns: dict[str, Callable[[Rule], str]] = {
        "rule": _formula,
        f"within {LIMIT_PERCENT:g} %, % of the states": lambda rule: f"{100.0 * rule.hits(points):.0f}",
        "found on the other silicone": lambda rule: f"{100.0 * elsewhere(rule):.0f}",
        "other numbers of convolutions": lambda rule: f"{100.0 * rule.hits(others):.0f}" if others else MISSING,
        "range, %": span,
    }
    return table_of(found, columns, left=(0,))


def _formula(rule: Rule) -> str:
    name = model_label(rule.chain)
    if rule.split:
        return f"{name} × {rule.above:g}; × {rule.below:g} while P R_p/(μ t) is below {rule.split:g}"
    return f"{name} × {rule.above:g}" if rule.above != 1.0 else f"{name} as it is"


def per_convolution(rows: Sequence[SweepRow]) -> Table:
    """Elongation per convolution at the highest pressure, mm; a line per design that has all numbers."""
    highest = max(pressures(rows))
    columns = [(name, n) for name in SILICONES.values() for n in sorted({convolutions(row) for row in rows})]
    lines = []
    for (root, wall), some in sorted(grouped(rows, root_and_wall).items()):
        mm = {(silicone_name(r), convolutions(r)): r.axisymmetric for r in some if r.pressure_kpa == highest}
        if len(mm) == len(columns):
            lines.append((f"{root:g}", f"{wall:g}", *(f"{mm[name, n] / n:.2f}" for name, n in columns)))
    return Table(("R_i, mm", "t, mm", *(f"{name}, n = {n}" for name, n in columns)), tuple(lines), left=())


def refusals(rows: Sequence[SweepRow]) -> Table:
    """Reasons, and the designs of each: roots and walls."""
    refused = grouped((row for row in rows if row.status.startswith(REFUSED)), lambda row: row.status)
    designs = {status.removeprefix(REFUSED): sorted(set(map(root_and_wall, some))) for status, some in refused.items()}
    lines = [
        ("; ".join(f"{root:g}, {wall:g}" for root, wall in of_reason), reason)
        for reason, of_reason in sorted(designs.items(), key=lambda item: item[1])
    ]
    return Table(("R_i, t in mm", "why"), tuple(lines), left=(0, 1))
