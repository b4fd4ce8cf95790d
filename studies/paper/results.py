"""What the paper study has found: its cases with their runs and rows, read from its folder."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from studies.models.session import SceneResult
from studies.paper.cases import Case, Group
from studies.results.rows import Row
from studies.scene.bellows import BellowsScene


@dataclass(frozen=True)
class CaseResult:
    """A case, its folder, its runs with their rows, and what was measured in its axisymmetric states."""

    case: Case
    folder: Path
    result: SceneResult[BellowsScene]
    measured: tuple[Row, ...]

    @property
    def rows(self) -> tuple[Row, ...]:
        """All rows of the case."""
        return (*self.result.rows, *self.measured)


@dataclass(frozen=True)
class PaperResults:
    """All cases that have been run, in the order of `paper_cases.cases`."""

    cases: tuple[CaseResult, ...]

    def of(self, *groups: Group) -> tuple[CaseResult, ...]:
        """Cases of some groups."""
        return tuple(c for c in self.cases if c.case.group in groups)

    def variant(self, base: str, group: Group, suffix: str = "") -> CaseResult | None:
        """The case of a group made from a scene, the one whose name ends so if there are several; None if missing."""
        found = (c for c in self.of(group) if c.case.base == base and c.case.name.endswith(suffix))
        return next(found, None)

    @property
    def rows(self) -> tuple[Row, ...]:
        """The rows of all cases."""
        return tuple(row for case in self.cases for row in case.rows)


def find(
    rows: Iterable[Row], quantity: str, model: str, pressure_kpa: float | None = None, level: str | None = None
) -> Row | None:
    """The last row of a quantity and a model (levels ascend, so the finest) at a pressure; None if there is none."""
    found = None
    for row in rows:
        if row.quantity == quantity and row.model == model and level in (None, row.level):
            if pressure_kpa is None or abs(row.pressure_kpa - pressure_kpa) < 1e-9:
                found = row
    return found
