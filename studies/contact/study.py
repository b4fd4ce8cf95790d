"""The contact study: exact problems, what contact changes of actuators, how far 1 mm ones go without touching."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from studies.contact.exact import PROBLEMS, ExactProblem
from studies.engine import Page, Setting, Solved, Study
from studies.models.axisymmetric import run_axisymmetric
from studies.models.contact import SMOOTHING, STIFFNESS
from studies.models.run_rows import requested_rows, run_notes, stops
from studies.planning.levels import fineness
from studies.report.labels import level_label, quantity_label
from studies.report.numbers import number_text
from studies.report.tables import Column, Table, pivot, pressure_of, table_of
from studies.results import provenance
from studies.results.measures import find_places, largest_stretches
from studies.results.rows import Row, row
from studies.results.run_files import load_state
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene, Contact, at_pressures
from studies.scene.load import load_bellows

SCENES: Final = provenance.ROOT / "scenes"
# Actuators by their files, and pressures in kPa instead of theirs.
ACTUATORS: Final[Mapping[str, tuple[float, ...]]] = {
    "blocked-t2-ri5": (5.0, 10.0, 12.5, 15.0, 17.5),
    "contact/blocked-t1-ri5": (2.0, 4.0, 5.0, 7.5, 10.0, 15.0),
    "vacuum/vacuum-t2-ri5": (-0.5, -1.0, -2.0, -5.0, -10.0),
    "heung-t1-ri5": (10.0, 20.0, 30.0, 40.0, 60.0, 80.0),
    "heung-t1-ri7": (10.0, 20.0, 30.0, 40.0, 60.0, 80.0),
}
# Pressurised far beyond what the paper's ANSYS reached: the gap to the rings, without end in sight.
OPEN: Final = ("heung-t1-ri5", "heung-t1-ri7")
WITH, WITHOUT = "axisymmetric", "axisymmetric, no contact"
QUANTITIES: Final = ("min_gap_mm", "unstable_modes", "contact_force_n", "touching_places", "min_det_f")


@dataclass(frozen=True)
class Found:
    """Rows of a case, and how its runs went."""

    rows: Sequence[Row]
    notes: Sequence[str] = ()


def cases(options: Mapping[str, Any]) -> list[ExactProblem | BellowsScene]:
    """Problems, then actuators."""
    actuators = [at_pressures(load_bellows(SCENES / f"{file}.toml"), kpa) for file, kpa in ACTUATORS.items()]
    return [*PROBLEMS, *actuators]


def solve(case: ExactProblem | BellowsScene, at: Setting) -> Found:
    """Rows of a problem, or of an actuator on two meridians, and without contact on the coarser if it touches."""
    if isinstance(case, ExactProblem):
        return Found(case.rows())
    rows, notes = [], []
    for model, refinement in [(WITH, 1), (WITH, 2), *([] if case.name in OPEN else [(WITHOUT, 1)])]:
        contact = Contact(model="auto" if model == WITH else "off")
        folder = at.out / case.name / f"{contact.model}-r{refinement}"
        scene = case.model_copy(update={"contact": contact})
        run = run_axisymmetric(scene, refinement, folder, at.comm, at.progress)
        rows += actuator_rows(scene, run, folder, model)
        notes += [f"{run_label(model, run.summary.level)}: {note}" for note in run_notes(run)]
    return Found(rows, notes)


def actuator_rows(scene: BellowsScene, run: Run, folder: Path, model: str) -> list[Row]:
    """Rows of a run that is kept in a folder: its states, and how far an actuator that does not touch is stretched."""
    tip = ("tip_force_n", "tip_mm") if scene.blocked else ("tip_mm", "tip_force_n")
    rows = requested_rows(run, folder, scene.load.pressure_kpa, (*tip, *QUANTITIES), model)
    for pressure in scene.load.pressure_kpa if scene.name in OPEN else ():
        stretch = largest_stretch(scene, run, folder, pressure)
        rows.append(row(scene.name, "largest_stretch", "1", pressure, model, stretch, run.summary.level))
    return rows


def largest_stretch(scene: BellowsScene, run: Run, folder: Path, pressure_kpa: float) -> float:
    """Largest principal stretch farther than half a millimetre from the seats' edges; NaN if it is not there."""
    saved = load_state(folder, run.summary.content_hash, 1e-3 * pressure_kpa)
    if saved is None:
        return math.nan
    places = find_places(scene, fineness(run.summary.level))
    return float(largest_stretches(places, saved[0].displacement_mm)[~places.near_edge].max())


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
    """A line per pressure: the quantity and unstable modes of all runs; of the finest gap, force and stretch."""
    runs = list(dict.fromkeys((r.model, r.level) for r in rows))
    finest = [run for run in runs if run[0] == WITH][-1:]
    shown = {
        quantity: (".5g", runs),
        "min_gap_mm": (".2g", finest),
        "contact_force_n": (".3g", finest),
        "largest_stretch": (".3g", finest),
        "unstable_modes": (".4g", runs),
    }
    columns = [
        Column(f"{quantity_label(name)}: {run_label(*run)}", name, form, *run)
        for name, (form, of_runs) in shown.items()
        for run in of_runs
    ]
    return pivot(rows, {"kPa": pressure_of}, [c for c in columns if any(c.shows(r) for r in rows)])


def run_label(model: str, level: str) -> str:
    """A meridian, and whether it is one without contact."""
    return level_label(level) + (", no contact" if model == WITHOUT else "")


def page(solved: Sequence[Solved[ExactProblem | BellowsScene, Found]], at: Setting) -> Page:
    """A table of all problems, and a section per actuator."""
    exact = [r for done in solved if isinstance(done.case, ExactProblem) for r in done.result.rows]
    errors = [abs(r.error_percent) for r in exact if r.level == f"k{STIFFNESS:g}" and not math.isnan(r.error_percent)]
    sections = [
        {
            "name": scene.name,
            "title": scene.title,
            "table": state_table(done.result.rows, scene.main_quantity),
            "notes": done.result.notes,
        }
        for done in solved
        if isinstance(scene := done.case, BellowsScene)
    ]
    content = {
        "exact": exact_table(exact),
        "worst": f"{max(errors, default=math.nan):.2g}",
        "sections": sections,
        "stiffness": f"{STIFFNESS:g}",
        "smoothing": f"{100.0 * SMOOTHING:g}",
    }
    rows = [r for done in solved for r in done.result.rows]
    return Page(rows, content, stops(rows))


STUDY: Final = Study(
    name="contact",
    title="Contact: exact problems, folds that touch, rings that nothing reaches",
    question="How exact is contact of folds, rings and wall, and what does it change of actuators?",
    template="contact/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
)
