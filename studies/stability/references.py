"""What cells of the bellows are compared with: the bellows itself on three meshes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from mpi4py import MPI

from analytical.laws.errors import MaterialError
from meshes.errors import GeometryError, MeshError
from solvers.errors import SolverError
from studies.results.runs import MERIDIAN_ORDERS
from studies.results.uncertainty import convergence
from studies.scene.sections import SceneError
from studies.stability.bodies import pose_bellows
from studies.stability.cells import Bellows, Cell
from studies.stability.paths import ends

LEVELS = (1, 2, 3)
REFUSALS = (SceneError, GeometryError, MeshError, MaterialError, SolverError)


@dataclass(frozen=True)
class Series:
    """A bellows at all loads of one sign (negative: a vacuum) that cells ask of it, kPa."""

    body: Bellows
    loads_kpa: tuple[float, ...]


@dataclass(frozen=True)
class Reference:
    """A bellows on several meshes.

    Attributes
    ----------
    tip_mm, uncertainty_mm
        By load, kPa: on the finest mesh that reached it, and its uncertainty; loads that two meshes reached.
    unstable
        By load: axisymmetric unstable modes of that state at held pressure; -1 if not counted.
    reached_kpa
        Highest load that any mesh reached.
    """

    tip_mm: dict[float, float]
    uncertainty_mm: dict[float, float]
    unstable: dict[float, int]
    reached_kpa: float


def series_of(cells: Iterable[Cell]) -> list[Series]:
    """What is to be run on several meshes for cells."""
    loads: dict[tuple[Bellows, bool], set[float]] = {}
    for cell in cells:
        if isinstance(cell.body, Bellows):
            loads.setdefault((cell.body.ideal, cell.load_kpa < 0.0), set()).add(cell.load_kpa)
    return [Series(body, tuple(sorted(found))) for (body, _), found in loads.items()]


def series_for(cell: Cell, every: Iterable[Series]) -> Series | None:
    """The one that a cell is compared with; None if it is not a bellows."""
    if not isinstance(cell.body, Bellows):
        return None
    body = cell.body.ideal
    return next(one for one in every if one.body == body and cell.load_kpa in one.loads_kpa)


def solve_reference(series: Series) -> Reference:
    """The bellows on three meshes, on this process alone; a bellows that is refused has no values."""
    sign = -1.0 if series.loads_kpa[0] < 0.0 else 1.0
    loads = sorted(abs(p) for p in series.loads_kpa)
    tips: dict[float, dict[int, float]] = {p: {} for p in loads}
    unstable: dict[float, int] = {}
    highest = 0.0
    for level in LEVELS:
        fine = replace(series.body, level=level)
        try:
            posed = pose_bellows(fine, loads[-1], MPI.COMM_SELF)
        except REFUSALS:
            return Reference({}, {}, {}, loads[-1])
        for load, end in zip(loads, ends(Cell("", "", "", fine, sign * loads[-1]), posed, loads), strict=True):
            highest = max(highest, end.reached_kpa)
            if not end.reason:
                tips[load][level], unstable[load] = end.value_mm, end.unstable
    several = {load: found for load, found in tips.items() if len(found) > 1}
    finest = {load: found[max(found)] for load, found in several.items()}
    return Reference(finest, {load: _uncertainty_mm(found) for load, found in several.items()}, unstable, highest)


def _uncertainty_mm(found: dict[int, float]) -> float:
    """Of the finest of two or three levels."""
    sizes, values = [1.0 / level for level in found], list(found.values())
    return convergence(sizes, values, MERIDIAN_ORDERS).uncertainty(values[-1])
