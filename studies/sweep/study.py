"""The sweep study: elongation over root radius, wall and number of convolutions, and where the closed form misleads."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from operator import attrgetter
from pathlib import Path
from typing import Any, Final

import numpy as np

from analytical.arrays import FloatArray
from analytical.bellows.chains_by_name import SILICONES
from studies.engine import Page, Setting, Solved, Study
from studies.report.labels import model_label
from studies.report.numbers import duration, signed, up
from studies.scene.bellows import dimensions_of
from studies.scene.load import load_bellows
from studies.sweep import tables, words
from studies.sweep.csv_table import CHAINS, SweepRow, comparison_rows, read_table
from studies.sweep.designs import (
    BASE,
    COUNT_KEY,
    MAP_COUNT,
    OUTLINES,
    ROOT_KEY,
    WALL_KEY,
    Outline,
    is_mapped,
    points,
    pressures,
    silicone_name,
)
from studies.sweep.farm import TABLE_FILE, SweepOutcome, run_sweep
from studies.sweep.plots import Kind, MapPanel, draw_design_maps
from studies.sweep.rules import LIMIT_PERCENT


def cases(options: Mapping[str, Any]) -> tuple[Outline, ...]:
    """The designs with both outlines."""
    return OUTLINES


def solve(outline: Outline, at: Setting) -> SweepOutcome:
    """All scenes of an outline, shared out over the ranks."""
    return run_sweep(outline.file, at.out / outline.name, at.comm, at.progress)


def page(solved: Sequence[Solved[Outline, SweepOutcome]], at: Setting) -> Page:
    """Maps, tables and rules of each outline from the tables of the sweeps."""
    tables_of = {done.case: read_table(at.out / done.case.name / TABLE_FILE) for done in solved}
    every = [row for rows in tables_of.values() for row in rows]
    dimensions = dimensions_of(load_bellows(BASE))
    content = {
        "sizes": f"R<sub>p</sub> = {dimensions.crest_radius_mm:g} mm, e = {dimensions.half_pitch_mm:g} mm",
        "roots": _swept(every, ROOT_KEY),
        "walls": _swept(every, WALL_KEY),
        "counts": _swept(every, COUNT_KEY),
        "pressures": ", ".join(f"{pressure:g}" for pressure in pressures(r for r in every if r.reached)),
        "map_count": MAP_COUNT,
        "limit": f"{LIMIT_PERCENT:g}",
        "outlines": [_of_outline(done, tables_of[done.case], at.out) for done in solved],
        "solved": duration(sum(done.result.solved_s for done in solved)),
    }
    return Page([line for row in every for line in comparison_rows(row)], content, words.unreached(every))


def _of_outline(done: Solved[Outline, SweepOutcome], rows: Sequence[SweepRow], folder: Path) -> dict[str, Any]:
    """What the page shows of an outline."""
    reached = [row for row in rows if row.reached]
    mapped = [row for row in reached if is_mapped(row)]
    known, others = points(mapped), points([row for row in reached if not is_mapped(row)])
    rules = tables.find_rules(known)
    uncertain = [100.0 * row.uncertainty / abs(row.axisymmetric) for row in reached]
    percents = [row.closed_form_percent for row in mapped]
    low, high = sum(p < -LIMIT_PERCENT for p in percents), sum(p > LIMIT_PERCENT for p in percents)
    return {
        "outline": done.case,
        "states": len(mapped),
        "low": low,
        "high": high,
        "share": f"{100.0 * (low + high) / len(mapped):.0f}",
        "median": signed(float(np.median(percents))),
        "range": f"{signed(min(percents))} to {signed(max(percents))}",
        "trusted": words.trusted(mapped),
        "shares": tables.shares(mapped),
        "by_state": tables.by_state(mapped),
        "rules": tables.rules(rules, known, others),
        "rule": words.rule_words(rules[-1], known, others),
        "maps": _draw_maps(folder, done.case.name, rows, mapped),
        "per_convolution": tables.per_convolution(reached),
        "convolution_words": words.of_convolutions(reached),
        "refusals": tables.refusals(rows),
        "uncertainty": up(max(uncertain), 2),
        "typical": f"{np.median(uncertain):.2f}",
        "levels": words.levels(reached),
        "unstable": sum(row.unstable_modes > 0.0 for row in reached),
        "outcome": done.result,
    }


def _swept(rows: Sequence[SweepRow], key: str) -> str:
    return ", ".join(f"{value:g}" for value in sorted({row.values[key] for row in rows}))


def _draw_maps(folder: Path, outline: str, rows: Sequence[SweepRow], mapped: Sequence[SweepRow]) -> dict[str, str]:
    """Draw the maps; their places by what they show."""
    roots = np.array(sorted({row.values[ROOT_KEY] for row in rows if is_mapped(row)}))
    walls = np.array(sorted({row.values[WALL_KEY] for row in rows if is_mapped(row)}))

    def grid(some: Sequence[SweepRow], value: Callable[[SweepRow], float]) -> FloatArray:
        found = np.full((len(walls), len(roots)), np.nan)
        for row in some:
            at = np.searchsorted(walls, row.values[WALL_KEY]), np.searchsorted(roots, row.values[ROOT_KEY])
            found[at] = value(row)
        return found

    def panel(silicone: str, pressure: float, value: Callable[[SweepRow], float]) -> MapPanel:
        some = [row for row in mapped if (silicone_name(row), row.pressure_kpa) == (silicone, pressure)]
        beyond = grid(some, lambda row: row.pressure_kpa - row.unfolding_kpa)
        return MapPanel(f"{silicone}, {pressure:g} kPa", roots, walls, grid(some, value), beyond)

    def draw(name: str, kind: Kind, value: Callable[[SweepRow], float], label: str) -> str:
        lines = [[panel(s, pressure, value) for pressure in pressures(mapped)] for s in SILICONES.values()]
        draw_design_maps(folder / "pictures" / f"{outline}-{name}.png", lines, kind, label)
        return f"pictures/{outline}-{name}.png"

    elongation = f"elongation at the tip by finite elements, n = {MAP_COUNT}, mm"
    found = {"elongation": draw("elongation", "elongation", attrgetter("axisymmetric"), elongation)}
    for chain in CHAINS:
        label = f"{model_label(chain)} less finite elements, %"
        found[chain] = draw(chain.replace("_", "-"), "percent", attrgetter(f"{chain}_percent"), label)
    return found


STUDY: Final = Study(
    name="sweep",
    title="Design space of the bellows actuator: elongation, and where the closed form misleads",
    question="How far do actuators of any root radius and wall elongate, and where does the closed form mislead?",
    template="sweep/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="all",
)
