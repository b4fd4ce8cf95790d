"""How time and memory of bodies grow with their unknowns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from studies.cost.cases import ACTUATOR, BODIES
from studies.cost.points import Point, Power, power_law
from studies.results.rows import REACHED

# What it is asked how many unknowns it holds.
MEMORY_MB: Final = 24_000.0


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
    return sorted((p for p in of if p.status == REACHED and not p.disturbed), key=lambda p: p.unknowns)


def per_factorisation(p: Point) -> float:
    """Wall seconds of the body itself, without its axisymmetric start, per factorisation."""
    return (p.work_s - p.split_s.get("axisymmetric start", 0.0)) / p.factorisations


def growth_of(of: Sequence[Point]) -> Growth | None:
    """Laws of growing bodies; None with fewer than three."""
    if len(of) < 3:
        return None
    size = [p.unknowns for p in of]
    return Growth(
        time=power_law(size, [p.work_s for p in of]),
        iteration=power_law(size, [per_factorisation(p) for p in of]),
        memory=power_law(size, [p.peak_mb for p in of]),
    )
