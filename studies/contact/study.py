"""The contact study: exact problems, what contact changes of actuators, how far 1 mm ones go without touching.

python -m studies.contact.study --out results/contact
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import click
import numpy as np
from mpi4py import MPI

from studies.contact.exact import exact_rows
from studies.models.axisymmetric import run_axisymmetric
from studies.models.contact import CONTACT_FILE, MODELLED, SMOOTHING, STIFFNESS, read_reports
from studies.models.run_log import CONTACT
from studies.planning.levels import fineness
from studies.progress import Progress
from studies.report.labels import level_label
from studies.report.numbers import number_text
from studies.report.pages import write_page
from studies.report.tables import Column, Table, pivot, pressure_of, table_of
from studies.results import provenance
from studies.results.files import PathRow, load_state, read_summary
from studies.results.measures import find_places, largest_stretches
from studies.results.rows import REACHED, Row, row, write_rows
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene, Contact
from studies.scene.files import load_bellows

SCENES = provenance.ROOT / "scenes"
STOPPED = 3


@dataclass(frozen=True)
class Case:
    """A scene with contact on some meridians and without on the first.

    Attributes
    ----------
    file
        Below scenes/.
    pressures_kpa
        Asked instead of the scene's.
    levels
        Meridians with contact.
    """

    file: str
    pressures_kpa: tuple[float, ...]
    levels: tuple[int, ...]


TOUCHING = (
    Case("blocked-t2-ri5", (5.0, 10.0, 12.5, 15.0, 17.5), (1, 2)),
    Case("contact/blocked-t1-ri5", (2.0, 4.0, 5.0, 7.5, 10.0, 15.0), (1, 2)),
    Case("vacuum/vacuum-t2-ri5", (-0.5, -1.0, -2.0, -5.0, -10.0), (1, 2)),
)
# Pressurised far beyond what the paper's ANSYS reached: the gap to the rings, without end in sight.
OPEN = (
    Case("heung-t1-ri5", (10.0, 20.0, 30.0, 40.0, 60.0, 80.0), (1, 2)),
    Case("heung-t1-ri7", (10.0, 20.0, 30.0, 40.0, 60.0, 80.0), (1, 2)),
)


def solve_case(case: Case, model: Literal["auto", "off"], level: int, folder: Path, progress: Progress) -> Run:
    """The run of a case on a meridian, kept in ``folder``."""
    scene = load_bellows(SCENES / f"{case.file}.toml")
    load = scene.load.model_copy(update={"pressure_kpa": list(case.pressures_kpa)})
    scene = scene.model_copy(update={"load": load, "contact": Contact(model=model)})
    return run_axisymmetric(scene, level, run_folder(folder, scene, model, level), MPI.COMM_WORLD, progress)


def run_folder(folder: Path, scene: BellowsScene, model: str, level: int) -> Path:
    """Where the run of a scene is kept."""
    return folder / scene.name / f"{model}-r{level}"


def at(run: Run, pressure_kpa: float) -> PathRow | None:
    """The requested state of a run at a pressure; None if it was not reached."""
    for entry in run.path:
        if entry.status == "requested" and math.isclose(entry.pressure_kpa, pressure_kpa, rel_tol=1e-9):
            return entry
    return None


def case_rows(case: Case, folder: Path, progress: Progress) -> list[Row]:
    """Rows of a case: tip, tip force, unstable modes and gap, with contact and (level r1) without."""
    scene = load_bellows(SCENES / f"{case.file}.toml")
    rows = []
    runs: list[tuple[Literal["auto", "off"], int]] = [("auto", level) for level in case.levels]
    if case in TOUCHING:
        runs.append(("off", case.levels[0]))
    for model, level in runs:
        run = solve_case(case, model, level, folder, progress)
        name = "axisymmetric" if model == "auto" else "axisymmetric, no contact"
        reports = read_reports(run_folder(folder, scene, model, level) / CONTACT_FILE)
        for pressure in case.pressures_kpa:
            rows += _state_rows(scene, run, pressure, name, reports)
            if case in OPEN:
                stretch = _largest_stretch(scene, run, run_folder(folder, scene, model, level), pressure)
                rows.append(row(scene.name, "largest_stretch", "1", pressure, name, stretch, run.summary.level))
    return rows


def _largest_stretch(scene: BellowsScene, run: Run, folder: Path, pressure_kpa: float) -> float:
    """Largest principal stretch but for half a percent of the nodes, those at the seats' edges; NaN if not there."""
    saved = load_state(folder, run.summary.content_hash, 1e-3 * pressure_kpa)
    if saved is None:
        return math.nan
    places = find_places(scene, fineness(run.summary.level))
    return float(np.percentile(largest_stretches(places, saved[0].displacement_mm), 99.5))


def _state_rows(
    scene: BellowsScene, run: Run, pressure: float, model: str, reports: Sequence[dict[str, str]]
) -> list[Row]:
    found, level = at(run, pressure), run.summary.level
    stopped = f"stopped at {run.path[-1].pressure_kpa:.2f} kPa: {run.summary.reason}" if run.path else "stopped"

    def entry(quantity: str, unit: str, value: float) -> Row:
        return row(scene.name, quantity, unit, pressure, model, value, level, status=REACHED if found else stopped)

    if found is None:
        return [entry("tip_force_n" if scene.blocked else "tip_mm", "N" if scene.blocked else "mm", math.nan)]
    here = [r for r in reports if math.isclose(float(r["pressure_kpa"]), pressure, rel_tol=1e-5)]
    force = sum(float(r["force_n"]) for r in here)
    return [
        entry("tip_mm", "mm", found.tip_mm),
        entry("tip_force_n", "N", found.tip_force_n),
        entry("min_gap_mm", "mm", found.min_gap_mm),
        entry("unstable_modes", "1", found.unstable_modes),
        entry("contact_force_n", "N", force),
        entry("touching_places", "1", float(sum(int(r["places"]) for r in here))),
        entry("min_det_f", "1", found.min_det_f),
    ]


def notes_of(case: Case, folder: Path) -> list[str]:
    """What the runs of a case say of first touch and of their end."""
    scene = load_bellows(SCENES / f"{case.file}.toml")
    found = []
    for place in sorted((folder / scene.name).glob("*-r*")):
        summary = read_summary(place)
        said = [n for n in summary.plan if n.startswith((MODELLED, CONTACT))]
        said += [summary.reason] if summary.reason else []
        found += [f"{scene.name}, {place.name}: {text}" for text in said or ["nothing touches"]]
    return found


# --- report -------------------------------------------------------------------------------------------------


def exact_table(rows: Sequence[Row]) -> Table:
    """Problem, quantity, penalty, value, reference, error."""
    columns: dict[str, Callable[[Row], str]] = {
        "problem": lambda r: r.scene,
        "quantity": lambda r: r.quantity,
        "penalty, moduli per wall": lambda r: r.level[1:],
        "kPa": lambda r: f"{r.pressure_kpa:.2f}",
        "value": lambda r: number_text(r.value, ".6g"),
        "reference": lambda r: number_text(r.reference, ".6g"),
        "error, %": lambda r: number_text(r.error_percent, ".2g"),
        "reference is": lambda r: r.source,
    }
    return table_of(rows, columns, left=(0, 1, 7))


def state_table(rows: Sequence[Row], quantity: str) -> Table:
    """A line per pressure: the quantity by model and level, gap and contact force (or stretch) of the finest, modes."""
    runs = list(dict.fromkeys((r.model, r.level) for r in rows))
    model, finest = [run for run in runs if run[0] == "axisymmetric"][-1]

    def of_runs(header: str, quantity: str, form: str) -> list[Column]:
        without = {run: ", no contact" if "no" in run[0] else "" for run in runs}
        return [Column(f"{header}: {level_label(run[1])}{without[run]}", quantity, form, *run) for run in runs]

    largest = Column(f"contact force, N: {level_label(finest)}", "contact_force_n", ".3g", model, finest)
    if any(r.quantity == "largest_stretch" for r in rows):
        largest = Column(f"largest stretch: {level_label(finest)}", "largest_stretch", ".3g", model, finest)
    columns = [
        *of_runs("tip force, N" if quantity == "tip_force_n" else "tip, mm", quantity, ".5g"),
        Column(f"least gap, mm: {level_label(finest)}", "min_gap_mm", ".2g", model, finest),
        largest,
        *of_runs("unstable modes", "unstable_modes", ".4g"),
    ]
    return pivot(rows, {"kPa": pressure_of}, columns)


def write_study(out: Path, progress: Progress) -> tuple[Path, bool]:
    """Solve what is missing, write rows and report; its path, and whether all requested states were reached."""
    exact = exact_rows()
    by_case = {case: case_rows(case, out, progress) for case in (*TOUCHING, *OPEN)}
    rows = [*exact, *(r for found in by_case.values() for r in found)]
    write_rows(out / "rows.csv", rows)
    names = {case: load_bellows(SCENES / f"{case.file}.toml") for case in by_case}
    sections = [
        {
            "name": names[case].name,
            "title": names[case].title,
            "table": state_table(found, "tip_force_n" if names[case].blocked else "tip_mm"),
            "notes": notes_of(case, out),
        }
        for case, found in by_case.items()
    ]
    compared = [r for r in exact if not math.isnan(r.error_percent)]
    content = {
        "title": "Contact: exact problems, folds that touch, rings that nothing reaches",
        "exact": exact_table(exact),
        "worst": f"{max(abs(r.error_percent) for r in compared if r.level == f'k{STIFFNESS:g}'):.2g}",
        "sections": sections,
        "stiffness": f"{STIFFNESS:g}",
        "smoothing": f"{100.0 * SMOOTHING:g}",
        "facts": {"commit": provenance.commit(), "date": provenance.now(), "machine": provenance.machine()},
    }
    return write_page(out, "contact.md.j2", content), all(r.status == REACHED for r in rows)


@click.command()
@click.option("--out", required=True, type=click.Path(path_type=Path), help="Folder for runs, rows and report.")
def main(out: Path) -> None:
    """Contact against exact answers, its effect on actuators, and where there is none."""
    out.mkdir(parents=True, exist_ok=True)
    report, reached = write_study(out, Progress(MPI.COMM_WORLD))
    click.echo(f"report: {report}")
    if not reached:
        sys.exit(STOPPED)


if __name__ == "__main__":
    main()
