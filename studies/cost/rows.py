"""Rows of the cost study from what was measured."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from studies.cost.cases import BODIES, TUBE, Batch, Cell, cell_scene, is_default
from studies.cost.measure import Measurement
from studies.planning.levels import fineness
from studies.results.exact_answers import exact_bore_mm
from studies.results.rows import Row, row
from studies.results.runs import MERIDIAN_ORDERS
from studies.results.uncertainty import convergence
from studies.scene.bodies import BodyScene

COSTS: Final[Mapping[str, str]] = {
    "wall_s": "s",
    "work_s": "s",
    "cpu_s": "s",
    "peak_mb": "MB",
    "unknowns": "1",
    "factorisations": "1",
}
SPLIT, DEFAULT, OTHERS, COMPILE = "split_s: ", "default_setting", "others_cpu_s", "compile_s"
BATCH_WALL, BATCH_SCENE = "batch_wall_s", "four actuators"


@dataclass(frozen=True)
class Reference:
    """What a body's values are compared with, mm; its own uncertainty in percent, and where it comes from."""

    value: float = math.nan
    uncertainty_percent: float = math.nan
    source: str = ""


def reference_of(body: str, measured: Mapping[Cell, Measurement]) -> Reference:
    """The exact answer, or the limit of the three finest meridians of the cells that were refined most."""
    scene = cell_scene(next(cell for cell in measured if cell.body == body))
    if isinstance(scene, BodyScene):
        value, source = exact_bore_mm(scene, scene.loads_kpa[-1])
        return Reference(value, 0.0, source)
    cells = [c for c in measured if c.body == body and c.model == "axisymmetric" and c.strategy == "auto"]
    if not cells:
        return Reference()
    element = max(cells, key=lambda c: fineness(c.level)).element
    alike = {fineness(c.level): measured[c].value for c in cells if c.element == element}
    levels = sorted(level for level, value in alike.items() if not math.isnan(value))[-3:]
    if len(levels) < 3:
        return Reference()
    values = [alike[level] for level in levels]
    found = convergence([1.0 / level for level in levels], values, MERIDIAN_ORDERS)
    uncertainty = 100.0 * found.of_limit / abs(found.limit)
    names = ", ".join(f"r{level}" for level in levels)
    return Reference(found.limit, uncertainty, f"axisymmetric {element} {names}, extrapolated")


def measured_rows(measured: Mapping[Cell, Measurement]) -> list[Row]:
    """All rows of measured cells."""
    references = {body: reference_of(body, measured) for body in {c.body for c in measured}}
    return [r for cell, found in measured.items() for r in cell_rows(cell, found, references[cell.body])]


def cell_rows(cell: Cell, found: Measurement, of: Reference) -> list[Row]:
    """Rows of one cell: its value, and what it cost."""
    name, at = BODIES[cell.body], found.pressure_kpa
    value = row(
        name,
        "bore_mm" if cell.body == TUBE else "tip_mm",
        "mm",
        at,
        cell.model,
        found.value,
        cell.setting,
        uncertainty=0.01 * of.uncertainty_percent * abs(of.value),
        reference=of.value,
        source=of.source,
        status=found.status,
    )
    costs = [(cost, unit, getattr(found, cost)) for cost, unit in COSTS.items()]
    costs.append((OTHERS, "s", found.others_s))
    costs += [(SPLIT + activity, "s", seconds) for activity, seconds in found.split_s.items()]
    costs += [(COMPILE, "s", found.compile_s)] if not math.isnan(found.compile_s) else []
    costs += [(DEFAULT, "1", 1.0)] if is_default(cell) else []
    return [
        value,
        *(
            row(name, cost, unit, at, cell.model, number, cell.setting, status=found.status)
            for cost, unit, number in costs
        ),
    ]


def batch_rows(batch: Batch, found: Measurement) -> list[Row]:
    """Rows of a batch: how long, and CPU time."""
    level = f"{batch.ranks_per_scene} rank{'s' if batch.ranks_per_scene > 1 else ''} per scene"
    costs = {BATCH_WALL: found.wall_s, "batch_cpu_s": found.cpu_s, OTHERS: found.others_s}
    return [
        row(BATCH_SCENE, cost, "s", math.nan, batch.model, seconds, level, status=found.status)
        for cost, seconds in costs.items()
    ]
