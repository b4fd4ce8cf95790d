"""The verification table: every problem of this repository whose answer is exact, published or known by two routes.

Finite elements: all scenes of ``scenes/exact`` whose rows have a reference, by every model they have, with the observed
order of convergence. Formulas: the exact solutions themselves, by two routes each (`studies.verification.two_routes`).
"""

from __future__ import annotations

import math
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from mpi4py import MPI

from studies.models.session import ROWS_FILE, SCENE_FILE, SceneResult, run_all_models
from studies.planning.levels import fineness
from studies.progress import Progress
from studies.report.labels import counted_along
from studies.results.rows import Row, row, write_rows
from studies.scene.bodies import BodyScene
from studies.scene.files import load_scene
from studies.scene.sections import SceneError
from studies.verification import two_routes as exact_table

# Two errors tell an order of convergence only above what Newton and the locating of crossings leave, relative.
NOISE: Final = 1e-8
ORDER_SUFFIX: Final = "_order"


@dataclass(frozen=True)
class Line:
    """A line of the table: a quantity of a problem by one model, at the load with the largest error on its finest mesh.

    Attributes
    ----------
    finest
        The row of the finest mesh at that load.
    order
        Observed order of convergence there; NaN if it cannot be told.
    loads
        Loads that were compared.
    counted
        What the mesh's cells are counted along.
    """

    finest: Row
    order: float
    loads: int
    counted: str = "round"


@dataclass(frozen=True)
class Verification:
    """All rows, lines of the finite element problems, formulas by two routes, and what did not reach its loads."""

    rows: tuple[Row, ...]
    lines: tuple[Line, ...]
    formulas: tuple[exact_table.TwoRoutes, ...]
    stopped: tuple[str, ...]


def run_verification(
    scenes: Sequence[Path], out: Path, reuse: Path | None, comm: MPI.Comm, progress: Progress
) -> Verification:
    """Solve scenes with every model each has, and gather the table; every rank calls.

    Parameters
    ----------
    scenes
        Scene files; those of users' meshes have no reference and are left out.
    out
        Results are kept here, a folder for each scene; rows.csv is written.
    reuse
        A folder of the same form, such as that of ``make study-exact``, whose finished runs are taken over, or None.

    Returns
    -------
    Verification

    Raises
    ------
    SceneError
        If a scene is not one of a simple body.
    """
    results = []
    for path in scenes:
        scene = load_scene(path)
        if not isinstance(scene, BodyScene):
            raise SceneError(f"{path}: a bellows has no exact answer: give scenes such as those of scenes/exact")
        if scene.geometry.kind == "mesh":
            continue
        folder = out / scene.name
        if comm.rank == 0 and reuse is not None and not folder.exists() and (reuse / scene.name / SCENE_FILE).exists():
            shutil.copytree(reuse / scene.name, folder)
        comm.barrier()
        results.append(run_all_models(scene, path.read_text(encoding="utf-8"), folder, comm, progress))
    found = gather(results)
    if comm.rank == 0:
        write_rows(out / ROWS_FILE, found.rows)
    comm.barrier()
    return found


def gather(results: Sequence[SceneResult[BodyScene]]) -> Verification:
    """The table of finished scenes."""
    lines: list[Line] = []
    stopped = []
    for result in results:
        compared = [r for r in result.rows if math.isfinite(r.reference)]
        lines += lines_of(compared, counted_along(result.scene.geometry.kind))
        if not result.reached:
            stopped.append(f"{result.scene.name}: {result.reason}")
    formulas = exact_table.all_routes()
    orders = [_order_row(line) for line in lines if math.isfinite(line.order)]
    rows = [r for result in results for r in result.rows if math.isfinite(r.reference)]
    return Verification((*rows, *orders, *exact_table.rows(formulas)), tuple(lines), tuple(formulas), tuple(stopped))


def lines_of(compared: Sequence[Row], counted: str = "round") -> list[Line]:
    """Lines of the rows that have a reference; cells of their meshes are counted round the axis or along an edge."""
    lines = []
    for scene, quantity, model in dict.fromkeys((r.scene, r.quantity, r.model) for r in compared):
        mine = [r for r in compared if (r.scene, r.quantity, r.model) == (scene, quantity, model)]
        finest = max((r.level for r in mine), key=fineness)
        ends = [r for r in mine if r.level == finest]
        worst = max(ends, key=lambda r: abs(r.error_percent) if math.isfinite(r.error_percent) else math.inf)
        at_load = [r for r in mine if same_load(r, worst)]
        lines.append(Line(worst, observed_order(at_load), len(ends), counted))
    return lines


def observed_order(rows: Sequence[Row]) -> float:
    """Order of convergence from the errors of the two finest meshes, ``ln(e1/e2) / ln(h1/h2)``.

    Against a reference that is not exact the differences of the three finest meshes are used instead, as the
    reference's own error would stand in the way.

    Returns
    -------
    float
        NaN where there are too few meshes, where errors are at round-off or change their sign.
    """
    known = sorted((r for r in rows if math.isfinite(r.value)), key=lambda r: fineness(r.level))
    if len(known) < 2:
        return math.nan
    sizes = [1.0 / fineness(r.level) for r in known]
    if known[-1].source.startswith("exact"):
        coarse, fine = (0.01 * r.error_percent for r in known[-2:])
        if min(abs(coarse), abs(fine)) <= NOISE or coarse * fine < 0.0:
            return math.nan
        return math.log(coarse / fine) / math.log(sizes[-2] / sizes[-1])
    if len(known) < 3:
        return math.nan
    (h1, h2, h3), (f1, f2, f3) = sizes[-3:], [r.value for r in known[-3:]]
    if f2 == f3 or (f1 - f2) / (f2 - f3) <= 0.0:
        return math.nan
    low, high = 0.01, 10.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        if (h1**middle - h2**middle) / (h2**middle - h3**middle) < (f1 - f2) / (f2 - f3):
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def same_load(a: Row, b: Row) -> bool:
    """True if two rows are of one load; rows of whole paths have none."""
    if math.isnan(a.pressure_kpa) or math.isnan(b.pressure_kpa):
        return math.isnan(a.pressure_kpa) and math.isnan(b.pressure_kpa)
    return math.isclose(a.pressure_kpa, b.pressure_kpa, rel_tol=1e-9)


def _order_row(line: Line) -> Row:
    r = line.finest
    return row(r.scene, r.quantity + ORDER_SUFFIX, "1", r.pressure_kpa, r.model, line.order, r.level)
