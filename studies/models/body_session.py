"""Doing the plan of a simple body or a user's mesh: its runs into a folder, and rows beside the exact answers."""

from __future__ import annotations

import math
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from mpi4py import MPI

from studies.models.body_run import LIMIT_VOLUME, ExactRun, run_exact
from studies.models.session import ROWS_FILE, SCENE_FILE
from studies.planning.body_plan import ExactPlan, make_exact_plan, models_of
from studies.planning.levels import fineness
from studies.progress import Progress
from studies.results.exact_answers import exact_crossing_kpa, known_value
from studies.results.files import PATH_FILE, SUMMARY_FILE
from studies.results.rows import Row, row, write_rows
from studies.results.uncertainty import UNKNOWN, Convergence, convergence, from_two
from studies.scene.bodies import BodyScene
from studies.scene.body_geometry import TubeGeometry

# Order to expect: quadratic displacements have an error of the third; where an end is held the wall has corners, and
# three levels of a bonded tube show an order of 1.3.
ORDER, CORNER_ORDER = 3.0, 1.0
UNITS = {"volume_mm3": "mm3", "torque_nmm": "N mm", "axial_force_n": "N"}
# What is read off whole paths, not at single loads; all in kPa.
OF_PATHS = ("limit_kpa", "crossing_kpa")


@dataclass(frozen=True)
class ExactResult:
    """All runs of a scene, coarsest first, and the rows."""

    scene: BodyScene
    runs: tuple[ExactRun, ...]
    rows: tuple[Row, ...]

    @property
    def reached(self) -> bool:
        """True if every run reached every requested load."""
        return all(run.run.summary.status == "reached" for run in self.runs)

    @property
    def reason(self) -> str:
        """Why the first that did not, did not."""
        return next((run.run.summary.reason for run in self.runs if run.run.summary.status != "reached"), "")

    @property
    def headlines(self) -> tuple[Row, ...]:
        """Rows for a terminal: what was asked."""
        return tuple(r for r in self.rows if r.quantity in self.scene.quantities)


def run_exact_plan(
    scene: BodyScene, scene_text: str, plan: ExactPlan, folder: Path, comm: MPI.Comm, progress: Progress
) -> ExactResult:
    """Run what a plan says; results of the same content that are already there are used.

    Returns
    -------
    ExactResult
        The same on every rank.
    """
    if comm.rank == 0:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / SCENE_FILE).write_text(scene_text, encoding="utf-8")
    runs: list[ExactRun] = []
    for level in plan.levels:
        if plan.stop_when_met and len(runs) == 2 and _within_tolerance(scene, runs):
            break
        runs.append(run_exact(scene, plan, level, folder / f"{plan.model}-{level}", comm, progress))
    result = ExactResult(scene, tuple(runs), tuple(exact_rows(scene, runs)))
    if comm.rank == 0:
        write_rows(folder / ROWS_FILE, result.rows)
        source = folder / f"{plan.model}-{runs[-1].run.summary.level}"
        for name in (PATH_FILE, SUMMARY_FILE):
            shutil.copyfile(source / name, folder / name)
    comm.barrier()
    return result


def run_all_models(scene: BodyScene, scene_text: str, folder: Path, comm: MPI.Comm, progress: Progress) -> ExactResult:
    """Run a scene with every model it has, all levels of each, into one folder.

    Returns
    -------
    ExactResult
        Its rows are those of all models.
    """
    results = []
    for model in models_of(scene):
        plan = make_exact_plan(scene, model)
        results.append(run_exact_plan(scene, scene_text, plan, folder, comm, progress))
    runs = tuple(run for result in results for run in result.runs)
    rows = tuple(r for result in results for r in result.rows)
    if comm.rank == 0:
        write_rows(folder / ROWS_FILE, rows)
    comm.barrier()
    return ExactResult(scene, runs, rows)


def _within_tolerance(scene: BodyScene, runs: Sequence[ExactRun]) -> bool:
    rows = [r for r in exact_rows(scene, runs) if r.quantity in scene.quantities]
    finest = [r for r in rows if r.level == runs[-1].run.summary.level and math.isfinite(r.value)]
    return all(r.uncertainty <= 0.01 * scene.ask.tolerance_percent * abs(r.value) for r in finest)


def exact_rows(scene: BodyScene, runs: Sequence[ExactRun]) -> list[Row]:
    """All rows of a scene; each value's uncertainty is the discretisation's, its reference the exact answer."""
    rows = [r for load in scene.loads_kpa for r in _rows_at(scene, runs, load)]
    for quantity in scene.quantities:
        if quantity in OF_PATHS:
            rows += _crossing_rows(scene, runs, quantity)
    return rows


def _rows_at(scene: BodyScene, runs: Sequence[ExactRun], load: float) -> list[Row]:
    """Rows at one load, kPa: what is measured, then the checks of the finest run."""
    rows = []
    measured = dict.fromkeys(name for run in runs for values in run.measured.values() for name in values)
    wanted = [q for q in scene.quantities if q not in OF_PATHS]
    for quantity in [*wanted, *(name for name in measured if name not in wanted)]:
        reference, source = known_value(scene, quantity, load)
        found = [_at(run, load, quantity) for run in runs]
        spread = _convergence(scene, runs, found)
        for run, value in zip(runs, found, strict=True):
            summary = run.run.summary
            rows.append(
                row(scene.name, quantity, UNITS.get(quantity, "mm"), load, summary.model, value,
                    summary.level, spread.uncertainty(value), reference, source, _status(run, value))
            )  # fmt: skip
    for entry in runs[-1].run.path:
        if entry.status == "requested" and math.isclose(entry.pressure_kpa, load, rel_tol=1e-9):
            summary = runs[-1].run.summary
            for name in ("unstable_modes", "min_det_f"):
                value = float(getattr(entry, name))
                if not math.isnan(value):
                    rows.append(row(scene.name, name, "1", load, summary.model, value, summary.level))
    return rows


def _crossing_rows(scene: BodyScene, runs: Sequence[ExactRun], quantity: str) -> list[Row]:
    """Where stability was lost, and how many modes became unstable there."""
    reference, source = exact_crossing_kpa(scene)
    crossings = [run.run.summary.crossing for run in runs]
    found = [float(c["pressure_kpa"]) if c else math.nan for c in crossings]
    spread = _convergence(scene, runs, found)
    rows = []
    for run, crossing, value in zip(runs, crossings, found, strict=True):
        summary = run.run.summary
        within = float(crossing["within_kpa"]) if crossing else math.nan
        status = "reached"
        if not crossing:
            top = f"{max((r.pressure_kpa for r in run.run.path), default=0.0):.6g} kPa"
            far = f" and {LIMIT_VOLUME:g} times the volume" if quantity == "limit_kpa" else ""
            none = f"none up to {top}{far}"
            status = none if summary.status == "reached" else f"stopped at {top}: {summary.reason}"
        of_levels = spread.uncertainty(value)
        total = within if math.isnan(of_levels) else of_levels + within
        rows.append(
            row(scene.name, quantity, "kPa", math.nan, summary.model, value, summary.level, total, reference, source,
                status)
        )  # fmt: skip
        if crossing:
            jump = float(crossing["modes_after"]) - float(crossing["modes_before"])
            rows.append(row(scene.name, "crossing_modes", "1", math.nan, summary.model, jump, summary.level))
    return rows


def _at(run: ExactRun, load: float, quantity: str) -> float:
    for pressure, values in run.measured.items():
        if math.isclose(pressure, load, rel_tol=1e-9):
            return values.get(quantity, math.nan)
    return math.nan


def _status(run: ExactRun, value: float) -> str:
    if not math.isnan(value):
        return "reached"
    last = run.run.path[-1].pressure_kpa if run.run.path else 0.0
    return f"stopped at {last:.6g} kPa: {run.run.summary.reason}"


def _convergence(scene: BodyScene, runs: Sequence[ExactRun], values: Sequence[float]) -> Convergence:
    """Convergence over the finest levels that have a value."""
    g = scene.geometry
    corners = g.kind in ("cook", "ventricle") or (isinstance(g, TubeGeometry) and g.ends == "bonded")
    order = CORNER_ORDER if corners else ORDER
    pairs = [(1.0 / fineness(run.run.summary.level), v) for run, v in zip(runs, values, strict=True)]
    known = [pair for pair in pairs if not math.isnan(pair[1])][-3:]
    sizes, found = [h for h, _ in known], [v for _, v in known]
    if len(known) == 3:
        return convergence(sizes, found, order)
    return from_two(sizes, found, order) if len(known) == 2 else UNKNOWN
