"""The page of the cost study: a section per body, growth, and what there is to say of its rows."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from studies.cost import tables
from studies.cost.cases import BODIES
from studies.cost.error_model.checks import checks_table
from studies.cost.plots import draw_front, draw_growth
from studies.cost.points import Point, floor_percent, front, growing, growth_of, off_front, points
from studies.report.bar_charts import draw_times
from studies.report.numbers import count, short_time
from studies.report.tables import table_of
from studies.results.rows import Row

# A setting this much slower than the best as exact still counts as on the front: times repeat to about this.
NOISE: Final = 1.1
# What a front member's time is drawn for, in as many colours as there are; checks and output count as other.
_SPLIT_ORDER: Final = ("axisymmetric start", "mesh", "compile", "pattern", "residual", "tangent", "factor", "solve")


def content(rows: Sequence[Row], out: Path) -> Mapping[str, Any]:
    """What the page shows of the study's rows; draws its pictures."""
    found = points(rows)
    own = [p for p in found if not p.is_peer]
    grown = growing(own)
    laws = growth_of(grown)
    bodies = [name for name in BODIES.values() if any(p.scene == name for p in found)]
    if laws:
        draw_growth(out / "pictures" / "growth.png", grown, laws)
    return {
        "own": own,
        "disturbed": [p for p in own if p.cost.disturbed],
        "defaults": default_sentences(own),
        "laws": laws,
        "grown": grown,
        "batches": tables.batches(rows),
        "ratios": tables.ratios_table(rows),
        "alike": tables.like_with_like(found),
        "sections": [_section(name, found, rows, out) for name in bodies],
        "growth": table_of(grown, tables.GROWTH, (0,)),
        "strategies": tables.strategies_table(own),
        "ranks": tables.ranks_table(own),
        "farming": tables.farming_table(rows),
        "model": checks_table(rows),
        "compilation": tables.compilation_table(rows),
        "count": lambda number: count(int(number)),
        "short_time": short_time,
    }


def _section(name: str, found: Sequence[Point], rows: Sequence[Row], out: Path) -> dict[str, Any]:
    """All of one body."""
    of = [p for p in found if p.scene == name]
    own = [p for p in of if not p.is_peer]
    pictures = {kind: f"pictures/{kind}-{name}.png" for kind in ("front", "peers", "times")}
    members = [p for group in dict.fromkeys(p.group for p in of) for p in front([q for q in of if q.group == group])]
    draw_front(out / pictures["front"], own)
    if len(own) < len(of):
        draw_front(out / pictures["peers"], of, whole=True)
    else:
        pictures["peers"] = ""
    timed = [p for p in members if p.cost.split_s]
    if timed:
        draw_times(out / pictures["times"], [p.name for p in timed], split(timed))
    else:
        pictures["times"] = ""
    source = next((r for r in rows if r.scene == name and r.source), None)
    spread = 100.0 * source.uncertainty / abs(source.reference) if source else math.nan
    return {
        "name": name,
        "pictures": pictures,
        "reference": f"{source.reference:.6g} mm ({source.source}, ± {spread:.2g} %)" if source else "",
        "floor": f"{floor_percent(name):g}",
        "fronts": table_of(members, tables.FRONT, (0, 1)),
        "cells": table_of(of, tables.CELLS, (0, 1)),
        "failed": [f"{p.name}: {p.cost.status}" for p in of if not p.reached],
    }


def split(of: Sequence[Point]) -> dict[str, list[float]]:
    """Wall seconds by activity of each point; ``start`` is the process's start and imports, ``other`` the rest."""
    names = [name for name in _SPLIT_ORDER if any(name in p.cost.split_s for p in of)]
    found = {name: [p.cost.split_s.get(name, 0.0) for p in of] for name in names}
    found["start, imports"] = [p.cost.wall_s - p.cost.work_s for p in of]
    found["other"] = [max(0.0, p.cost.work_s - sum(p.cost.split_s.get(name, 0.0) for name in names)) for p in of]
    return found


def default_sentences(own: Sequence[Point]) -> list[str]:
    """Where the settings of study-paper stand: on the front of their model, or by how much not."""
    lines = []
    for p in own:
        if not p.default or math.isnan(p.error_percent):
            continue
        ratio, best = off_front(p, [q for q in own if (q.scene, q.model) == (p.scene, p.model)])
        off = f"off the front by {ratio:.2f} in time: {best.level} is as exact in {short_time(best.time_s)} s"
        note = " (disturbed measurement)" if p.cost.disturbed or best.cost.disturbed else ""
        lines.append(
            f"study-paper's {p.name} on {p.scene} ({tables.error_text(p)} % in {short_time(p.time_s)} s): "
            f"{'on the front' if ratio <= NOISE else off}{note}"
        )
    return lines
