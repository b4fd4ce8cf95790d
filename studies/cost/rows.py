"""Rows of the cost study, and what is read off them: fronts, exponents, ratios. Peers' rows go the same way."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from studies.cost.cells import QUIET, TUBE, Cell, Measurement, cell_scene, is_default
from studies.planning.levels import fineness, ranking
from studies.results.exact_answers import exact_bore_mm
from studies.results.rows import REACHED, Row, row
from studies.results.runs import MERIDIAN_ORDER
from studies.results.uncertainty import convergence
from studies.scene.bodies import BodyScene

VALUES = ("tip_mm", "bore_mm")
COSTS = {"wall_s": "s", "work_s": "s", "cpu_s": "s", "peak_mb": "MB", "unknowns": "1", "factorisations": "1"}
SPLIT, DEFAULT, FARMING, OTHERS = "split_s: ", "default_setting", "batch_wall_s", "others_cpu_s"
# Errors below this are not told apart, percent: bellows are known to 1e-4.
FLOOR_PERCENT = {"tube": 1e-6}
BELLOWS_FLOOR_PERCENT = 0.01


@dataclass(frozen=True)
class Reference:
    """What a body's values are compared with, mm; its own uncertainty in percent, and where it comes from."""

    value: float
    uncertainty_percent: float
    source: str


def reference_of(body: str, measured: Mapping[Cell, Measurement]) -> Reference:
    """The exact answer, or the limit of the three finest meridians of the cells that were refined most."""
    cells = [c for c in measured if c.body == body and c.model == "axisymmetric" and c.strategy == "auto"]
    some = next((c for c in measured if c.body == body), None)
    if some is None:
        return Reference(math.nan, math.nan, "")
    scene = cell_scene(some)
    if isinstance(scene, BodyScene):
        value, source = exact_bore_mm(scene, scene.loads_kpa[-1])
        return Reference(value, 0.0, source)
    finest = max((fineness(c.level) for c in cells), default=0)
    element = next((c.element for c in cells if fineness(c.level) == finest), "hex")
    alike = {fineness(c.level): measured[c].value for c in cells if c.element == element}
    levels = sorted(level for level, value in alike.items() if not math.isnan(value))[-3:]
    if len(levels) < 3:
        return Reference(math.nan, math.nan, "")
    values = [alike[level] for level in levels]
    found = convergence([1.0 / level for level in levels], values, MERIDIAN_ORDER)
    uncertainty = 100.0 * found.uncertainty(values[-1]) / abs(found.limit)
    names = ", ".join(f"r{level}" for level in levels)
    return Reference(found.limit, uncertainty, f"axisymmetric {element} {names}, extrapolated")


def measured_rows(measured: Mapping[Cell, Measurement]) -> list[Row]:
    """All rows of measured cells."""
    rows = []
    references = {body: reference_of(body, measured) for body in {c.body for c in measured}}
    for cell, found in measured.items():
        name, of = body_name(cell.body), references[cell.body]

        def add(
            quantity: str,
            unit: str,
            value: float,
            cell: Cell = cell,
            name: str = name,
            status: str = found.status,
            pressure: float = found.pressure_kpa,
        ) -> None:
            rows.append(row(name, quantity, unit, pressure, cell.model, value, cell.name, status=status))

        quantity = "bore_mm" if cell.body == TUBE else "tip_mm"
        spread = 0.01 * of.uncertainty_percent * abs(of.value)
        at = found.pressure_kpa
        rows.append(
            row(name, quantity, "mm", at, cell.model, found.value, cell.name, spread, of.value, of.source, found.status)
        )
        for cost, unit in COSTS.items():
            add(cost, unit, float(getattr(found, cost)))
        add(OTHERS, "s", found.others_s)
        for activity, seconds in found.split_s.items():
            add(SPLIT + activity, "s", seconds)
        if not math.isnan(found.compile_s):
            add("compile_s", "s", found.compile_s)
        if is_default(cell):
            add(DEFAULT, "1", 1.0)
    return rows


def farming_rows(scene: str, model: str, ranks_per_scene: int, found: Measurement) -> list[Row]:
    """Rows of a batch: how long, and CPU time."""
    level = f"{ranks_per_scene} rank{'s' if ranks_per_scene > 1 else ''} per scene"
    return [
        row(scene, quantity, "s", math.nan, model, value, level, status=found.status)
        for quantity, value in ((FARMING, found.wall_s), ("batch_cpu_s", found.cpu_s), (OTHERS, found.others_s))
    ]


def body_name(body: str) -> str:
    """Name of a body's scene."""
    return {"exact/tube": "tube", "peers/bellows": "peer-bellows"}.get(body, body)


@dataclass(frozen=True)
class Point:
    """One cell, or one run of a peer, as its rows tell it.

    Attributes
    ----------
    error_percent
        Size of the error at the highest requested pressure, percent; NaN if it was not reached.
    credited_percent
        The largest error of this and all finer meshes of the same model and cells: what is smaller is luck.
    split_s
        Wall seconds by activity.
    default
        True for the settings of `make study-paper`.
    others_s
        CPU seconds that other processes took meanwhile; NaN if not known.
    """

    scene: str
    model: str
    level: str
    error_percent: float
    credited_percent: float
    wall_s: float
    work_s: float
    cpu_s: float
    peak_mb: float
    unknowns: float
    factorisations: float
    status: str
    split_s: dict[str, float] = field(hash=False)
    default: bool
    others_s: float

    @property
    def name(self) -> str:
        """Model and level."""
        return f"{self.model} {self.level}".strip()

    @property
    def element(self) -> str:
        """Kind of cells; of a peer's, as its mesh is called."""
        return self.level.split("-")[0] if self.is_peer else self.level.split()[0]

    @property
    def mesh(self) -> str:
        """Name of the mesh, for instance ``n8r2``."""
        return self.level.split()[0].split("-")[-1] if self.is_peer else self.level.split()[1]

    @property
    def time_s(self) -> float:
        """Wall seconds without start and imports, which repeat better; of a peer, who does not tell them, with."""
        return self.wall_s if math.isnan(self.work_s) else self.work_s

    @property
    def disturbed(self) -> bool:
        """True unless others are known to have left the machine to it."""
        return not self.others_s <= QUIET * self.wall_s

    @property
    def is_peer(self) -> bool:
        """True for another program's run."""
        return self.model.startswith("peer_")


def points(rows: Iterable[Row]) -> list[Point]:
    """Points of all rows that tell a wall time; a peer's error is taken against the study's own reference."""
    groups: dict[tuple[str, str, str], list[Row]] = {}
    for entry in rows:
        groups.setdefault((entry.scene, entry.model, entry.level), []).append(entry)
    references = {r.scene: r.reference for of in groups.values() for r in of if _is_own_value(r)}
    found = []
    for (scene, model, level), of in groups.items():
        numbers = {r.quantity: r.value for r in of}
        if "wall_s" not in numbers:
            continue
        value = next((r for r in of if r.quantity in VALUES), None)
        reference = references.get(scene, math.nan)
        error = math.nan if value is None else 100.0 * abs(value.value - reference) / abs(reference)
        costs = {name: numbers.get(name, math.nan) for name in COSTS}
        found.append(
            Point(
                scene=scene,
                model=model,
                level=level,
                error_percent=error,
                credited_percent=error,
                status=REACHED if value is None else value.status,
                split_s={r.quantity.removeprefix(SPLIT): r.value for r in of if r.quantity.startswith(SPLIT)},
                default=DEFAULT in numbers,
                others_s=numbers.get(OTHERS, math.nan),
                **costs,
            )
        )
    return [replace(p, credited_percent=_credited(p, found)) for p in found]


def _credited(point: Point, of: Sequence[Point]) -> float:
    """Largest error of a point and of all meshes that are as fine in every direction."""
    if math.isnan(point.error_percent):
        return math.nan
    mine = ranking(point.mesh)
    alike = [p for p in of if (p.scene, p.model, p.element) == (point.scene, point.model, point.element)]
    finer = [p for p in alike if all(a >= b for a, b in zip(ranking(p.mesh), mine, strict=True))]
    return max(p.error_percent for p in finer if not math.isnan(p.error_percent))


def _is_own_value(entry: Row) -> bool:
    return entry.quantity in VALUES and not entry.model.startswith("peer_") and not math.isnan(entry.reference)


def floor_percent(scene: str) -> float:
    """Error below which a scene's points are not told apart, percent."""
    return FLOOR_PERCENT.get(scene, BELLOWS_FLOOR_PERCENT)


def told_apart(point: Point) -> float:
    """A point's credited error, percent, or the floor of its scene."""
    return max(point.credited_percent, floor_percent(point.scene))


def front(of: Sequence[Point]) -> list[Point]:
    """Those that no other beats in time and error, the quickest first."""
    kept: list[Point] = []
    known = [p for p in of if not math.isnan(p.error_percent) and not math.isnan(p.time_s)]
    for point in sorted(known, key=lambda p: (p.time_s, told_apart(p))):
        if not kept or told_apart(point) < told_apart(kept[-1]):
            kept.append(point)
    return kept


def off_front(point: Point, of: Sequence[Point]) -> tuple[float, Point]:
    """How many times longer a point takes than the quickest that is as exact, and which that is."""
    rivals = [p for p in of if not math.isnan(p.error_percent) and told_apart(p) <= told_apart(point)]
    best = min(rivals, key=lambda p: p.time_s)
    return point.time_s / best.time_s, best


@dataclass(frozen=True)
class Power:
    """``y = factor x^exponent``, and the largest ratio of a point to it or the reverse."""

    factor: float
    exponent: float
    worst: float

    def at(self, x: float) -> float:
        """Value at x."""
        return float(self.factor * x**self.exponent)

    def inverse(self, y: float) -> float:
        """Where it has a value."""
        return float((y / self.factor) ** (1.0 / self.exponent))


def power_law(x: Sequence[float], y: Sequence[float]) -> Power:
    """Least squares on logarithms."""
    exponent, constant = np.polyfit(np.log(x), np.log(y), 1)
    ratio = np.log(y) - constant - exponent * np.log(x)
    return Power(float(np.exp(constant)), float(exponent), float(np.exp(np.abs(ratio).max())))
