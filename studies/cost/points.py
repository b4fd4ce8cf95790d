"""What is read off the cost study's rows: points of time and error, fronts, power laws. Peers' rows go the same way."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from studies.cost.cases import ACTUATOR, BODIES
from studies.cost.measure import Measurement
from studies.cost.rows import COMPILE, COSTS, DEFAULT, OTHERS, SPLIT
from studies.planning.levels import ranking
from studies.results.rows import REACHED, Row

VALUES: Final = ("tip_mm", "bore_mm")
# Errors below this are not told apart, percent: bellows are known to 1e-4.
FLOOR_PERCENT: Final[Mapping[str, float]] = {"tube": 1e-6}
BELLOWS_FLOOR_PERCENT: Final = 0.01
# Memory whose unknowns are estimated, MB.
MEMORY_MB: Final = 24_000.0


@dataclass(frozen=True)
class Point:
    """One cell, or one run of a peer, as its rows tell it.

    Attributes
    ----------
    error_percent
        Size of the error at the highest requested pressure, percent; NaN if it was not reached.
    credited_percent
        The largest error of this and all finer meshes of the same model and cells: what is smaller is luck.
    default
        True for the settings of `make study-paper`.
    cost
        What was measured; of a peer's run not all of it.
    """

    scene: str
    model: str
    level: str
    error_percent: float
    credited_percent: float
    default: bool
    cost: Measurement

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
        """Name of the mesh, for instance ``n8r2``, or ``n8r1-quarter`` of a peer."""
        return self.level.split()[0].split("-", 1)[-1] if self.is_peer else self.level.split()[1]

    @property
    def way(self) -> str:
        """How the requested pressures were come to; not of a peer."""
        return self.level.split()[2]

    @property
    def ranks(self) -> str:
        """Ranks and threads, for instance ``2x1``; not of a peer."""
        return self.level.split()[3]

    @property
    def group(self) -> str:
        """The model; other programs' meridians and bodies are groups of their own."""
        if not self.is_peer:
            return self.model
        return "peers, full 3D" if self.mesh.startswith("n") else "peers, axisymmetric"

    @property
    def time_s(self) -> float:
        """Wall seconds without start and imports, which repeat better; of a peer, who does not tell them, with."""
        return self.cost.wall_s if math.isnan(self.cost.work_s) else self.cost.work_s

    @property
    def told_apart_percent(self) -> float:
        """The credited error, or the floor of the scene, below which errors are not told apart."""
        return max(self.credited_percent, floor_percent(self.scene))

    @property
    def reached(self) -> bool:
        """True if there is an answer at the highest requested pressure."""
        return self.cost.status == REACHED

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
        value = next((r for r in of if r.quantity in VALUES), of[0])
        reference = references.get(scene, math.nan) if value.quantity in VALUES else math.nan
        error = 100.0 * abs(value.value - reference) / abs(reference)
        cost = Measurement(
            value=value.value,
            pressure_kpa=value.pressure_kpa,
            **{name: numbers.get(name, math.nan) for name in (*COSTS, COMPILE)},
            split_s={r.quantity.removeprefix(SPLIT): r.value for r in of if r.quantity.startswith(SPLIT)},
            status=value.status,
            others_s=numbers.get(OTHERS, math.nan),
        )
        found.append(Point(scene, model, level, error, error, DEFAULT in numbers, cost))
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


def front(of: Sequence[Point]) -> list[Point]:
    """Those that no other beats in time and error, the quickest first."""
    kept: list[Point] = []
    known = [p for p in of if not math.isnan(p.error_percent) and not math.isnan(p.time_s)]
    for point in sorted(known, key=lambda p: (p.time_s, p.told_apart_percent)):
        if not kept or point.told_apart_percent < kept[-1].told_apart_percent:
            kept.append(point)
    return kept


def off_front(point: Point, of: Sequence[Point]) -> tuple[float, Point]:
    """How many times longer a point takes than the quickest that is as exact, and which that is."""
    known = [p for p in of if not math.isnan(p.error_percent)]
    best = min((p for p in known if p.told_apart_percent <= point.told_apart_percent), key=lambda p: p.time_s)
    return point.time_s / best.time_s, best


@dataclass(frozen=True)
class Power:
    """``y = factor x^exponent``."""

    factor: float
    exponent: float

    def at(self, x: float) -> float:
        """Value at x."""
        return float(self.factor * x**self.exponent)

    def inverse(self, y: float) -> float:
        """Where it has a value."""
        return float((y / self.factor) ** (1.0 / self.exponent))


def power_law(x: Sequence[float], y: Sequence[float]) -> Power:
    """Least squares on logarithms."""
    exponent, constant = np.polyfit(np.log(x), np.log(y), 1)
    return Power(float(np.exp(constant)), float(exponent))


@dataclass(frozen=True)
class Growth:
    """Power laws over unknowns of time without start (s), of it per factorisation (s) and of memory (MB)."""

    time: Power
    iteration: Power
    memory: Power

    @property
    def held(self) -> float:
        """Unknowns that `MEMORY_MB` hold by the fit."""
        return self.memory.inverse(MEMORY_MB)


def growing(found: Sequence[Point]) -> list[Point]:
    """Undisturbed bodies of the actuator on two ranks, the smallest first."""
    of = [p for p in found if p.scene == BODIES[ACTUATOR] and p.model == "full3d" and p.level.endswith("warm 2x1")]
    return sorted((p for p in of if p.reached and not p.cost.disturbed), key=lambda p: p.cost.unknowns)


def per_factorisation(p: Point) -> float:
    """Wall seconds of the body itself, without its axisymmetric start, per factorisation."""
    return (p.cost.work_s - p.cost.split_s.get("axisymmetric start", 0.0)) / p.cost.factorisations


def growth_of(of: Sequence[Point]) -> Growth | None:
    """Laws of growing bodies; None with fewer than three."""
    if len(of) < 3:
        return None
    size = [p.cost.unknowns for p in of]
    return Growth(
        time=power_law(size, [p.cost.work_s for p in of]),
        iteration=power_law(size, [per_factorisation(p) for p in of]),
        memory=power_law(size, [p.cost.peak_mb for p in of]),
    )
