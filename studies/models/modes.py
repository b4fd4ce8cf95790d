"""Counts of unstable modes by harmonic in a finished axisymmetric run, and where the first of each was lost.

The states kept at the requested loads are counted; where a harmonic's count changes between two of them the crossing is
found by bisection. ``path.csv`` gets the counts, ``modes.json`` the crossings, and a shape is kept beside it for each.
"""

from __future__ import annotations

import dataclasses
import io
import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from solvers.atomic import write_atomically
from solvers.equilibrium.forces import end_force
from solvers.errors import SolverError, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.orders import UNSTABLE
from solvers.paths.states import PathPoint
from solvers.problem import Problem
from solvers.stability.harmonics import Shape
from solvers.stability.modes import WAVES, ModeCounter, ModeCrossing, mode_crossings
from solvers.state import State
from studies.models.build import Tip, scene_problem
from studies.models.contact import MODELLED, may_touch
from studies.results.run_files import PathRow, load_state, write_path, write_summary, write_text_atomically
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene
from studies.scene.meshes import scene_meridian

MODES_FILE = "modes.json"
# Meridian refinements that are counted: crossings on r1 and r2 differ by 0.3 % at most, and a state on r4 takes four
# times as long as on r2 (docs/decisions.md).
COUNTED_LEVELS = (1, 2)
WARNING, NOT_COUNTED = f"{UNSTABLE} against m = ", "warning: modes by harmonic are not counted: "


@dataclass(frozen=True)
class FoundCrossing:
    """A change of a harmonic's count, as modes.json has it; the shape is in ``mode-m….npz``.

    ``tip_mm`` and ``tip_force_n`` are those of the axisymmetric state there; NaN where the body has no tip.
    """

    waves: int
    pressure_kpa: float
    within_kpa: float
    volume_mm3: float
    volume_ratio: float
    before: int
    after: int
    tip_mm: float
    tip_force_n: float


def counts_text(counts: Sequence[int]) -> str:
    """Counts of m = 0, 1, ... as ``path.csv`` has them."""
    return ";".join(str(n) for n in counts)


def counts_of(row: PathRow) -> tuple[int, ...]:
    """Counts of a row of path.csv; empty if they were not made."""
    return tuple(int(n) for n in row.unstable_by_m.split(";")) if row.unstable_by_m else ()


def shape_file(folder: Path, waves: int) -> Path:
    """Where the mode of a harmonic is."""
    return folder / f"mode-m{waves}.npz"


def read_crossings(folder: Path) -> list[FoundCrossing]:
    """The crossings of a counted run.

    Raises
    ------
    OSError, ValueError
        If they are missing or damaged.
    """
    entries = json.loads((folder / MODES_FILE).read_text(encoding="utf-8"))["crossings"]
    known: list[dict[str, Any]] = [{k: math.nan if v is None else v for k, v in entry.items()} for entry in entries]
    return [FoundCrossing(**entry) for entry in known]


def read_shape(folder: Path, waves: int) -> tuple[State, Shape]:
    """The state at a harmonic's crossing, and its critical mode."""
    with np.load(shape_file(folder, waves), allow_pickle=False) as data:
        state = State(data["displacement_mm"], data["pressure_mpa"], data["bodies_mm"], float(data["load_mpa"]))
        return state, Shape(waves, data["amplitude_mm"], data["mode_bodies_mm"])


def with_modes(scene: BellowsScene, refinement: int, folder: Path, run: Run, problem: Problem | None = None) -> Run:
    """An actuator's axisymmetric run with its counts; they are made if they are not there.

    Parameters
    ----------
    scene, refinement
        The scene and its meridian.
    folder
        Where the run is kept, its states among it.
    run
        The finished run.
    problem
        Its problem, if that is at hand; its state is changed.

    Returns
    -------
    Run
    """
    if is_counted(folder, run):
        return run
    mesh = scene_meridian(scene, refinement)
    tip = Tip(scene, mesh)
    # A dead force on the tip moves the state that pressure starts from.
    at_rest = scene.load.tip_force_n == 0.0
    touching: Callable[[PathRow], bool] | None = None
    if any(note.startswith(MODELLED) for note in run.summary.plan):
        touching = partial(may_touch, scene)  # the harmonics know nothing of contact

    def make() -> Problem:
        return problem or scene_problem(scene, mesh, MPI.COMM_SELF)

    return count_run(folder, run, make, tip.mean_mm, at_rest, touching)


def is_counted(folder: Path, run: Run) -> bool:
    """True if a run's counts are there and belong to it."""
    try:
        record = json.loads((folder / MODES_FILE).read_text(encoding="utf-8"))
        known, counted = record["content_hash"], record["counted_kpa"]
    except (OSError, ValueError, KeyError):
        return False
    rows = [row for row in run.requested if row.pressure_kpa in counted]
    return known == run.summary.content_hash and all(row.unstable_by_m for row in rows)


def count_run(
    folder: Path,
    run: Run,
    make_problem: Callable[[], Problem],
    tip_mm: Callable[[State], float] | None,
    at_rest: bool,
    touching: Callable[[PathRow], bool] | None = None,
) -> Run:
    """Count the modes of a run's kept states, and write what comes out beside them.

    Parameters
    ----------
    folder, run
        A finished axisymmetric run and where it is.
    make_problem
        Its problem.
    tip_mm
        Elongation of a state; None if there is no tip.
    at_rest
        True if the path starts from the unloaded state, which is stable.
    touching
        States in contact, which are not counted.

    Returns
    -------
    Run
        With counts. Where they cannot be made the run is as it was, but for a warning that says why.
    """
    start = time.perf_counter()
    try:
        open_rows = [row for row in run.requested if not (touching and touching(row))]
        counts, found, shapes = _count(folder, run, open_rows, make_problem(), tip_mm, at_rest)
    except (SolverError, StepFailed) as error:
        summary = dataclasses.replace(run.summary, plan=(*_other_notes(run), f"{NOT_COUNTED}{error}"))
        write_summary(folder, summary)
        return dataclasses.replace(run, summary=summary)
    rows = tuple(
        dataclasses.replace(row, unstable_by_m=counts_text(counts[row.pressure_kpa])) if row in open_rows else row
        for row in run.path
    )
    for waves, content in shapes.items():
        write_atomically(shape_file(folder, waves), content)
    notes = [*([] if at_rest else _notes_without_rest(counts)), *(_note(c) for c in found)]
    summary = dataclasses.replace(run.summary, plan=(*_other_notes(run), *notes))
    write_path(folder, rows)
    write_summary(folder, summary)
    entries = [{k: None if v != v else v for k, v in asdict(c).items()} for c in found]
    seconds = time.perf_counter() - start
    record: dict[str, Any] = {"content_hash": summary.content_hash, "waves": list(WAVES), "seconds": seconds}
    record |= {"counted_kpa": list(counts), "crossings": entries}
    write_text_atomically(folder / MODES_FILE, json.dumps(record, indent=1, allow_nan=False) + "\n")
    return dataclasses.replace(run, summary=summary, path=rows)


def _other_notes(run: Run) -> list[str]:
    """A summary's notes but for those of an earlier count."""
    return [note for note in run.summary.plan if not note.startswith((WARNING, NOT_COUNTED))]


def _note(crossing: FoundCrossing) -> str:
    """What a crossing means to the reader of a summary."""
    pressure = f"{crossing.pressure_kpa:.4g} kPa"
    where = f"from {pressure} on" if crossing.after > crossing.before else f"up to {pressure}"
    return f"{_against(crossing.waves)} {where}: {crossing.before} modes before, {crossing.after} after"


def _notes_without_rest(counts: Mapping[float, Sequence[int]]) -> list[str]:
    """What unstable modes mean where the first counted state has some already and no stable one before it."""
    notes = []
    for place, waves in enumerate(WAVES):
        of_it = {pressure: found[place] for pressure, found in counts.items() if found[place]}
        if of_it and next(iter(of_it)) == next(iter(counts)):
            states = ", ".join(f"{pressure:.4g} kPa ({count} modes)" for pressure, count in of_it.items())
            notes.append(f"{_against(waves)} at {states}, from the first state on that is counted")
    return notes


def _against(waves: int) -> str:
    what = {0: "in itself or by a twist", 1: "bends sideways"}.get(waves, f"takes {waves} waves round")
    return f"{WARNING}{waves} ({what})"


def _count(
    folder: Path,
    run: Run,
    rows: Sequence[PathRow],
    problem: Problem,
    tip_mm: Callable[[State], float] | None,
    at_rest: bool,
) -> tuple[dict[float, tuple[int, ...]], list[FoundCrossing], dict[int, bytes]]:
    """Counts by requested pressure (kPa), crossings, and the files of their shapes."""
    points, counts, by_pressure = [], [], {}
    if at_rest:
        problem.set_state(problem.zero_state())
        points.append(PathPoint(problem.get_state(), problem.cavity_volume(), math.nan, 0))
        counts.append((0,) * len(WAVES))
    counter = ModeCounter(problem)
    for row in rows:
        saved = load_state(folder, run.summary.content_hash, 1e-3 * row.pressure_kpa)
        if saved is None:
            raise SolverError(f"{folder}: the state at {row.pressure_kpa:g} kPa is missing or damaged: run it again")
        counts.append(counter.counts(saved[0]))
        if counts[-1][0] < row.unstable_modes:
            raise SolverError(
                f"at {row.pressure_kpa:g} kPa the axisymmetric tangent has {row.unstable_modes:g} unstable modes and "
                f"m = 0, which has them all and twists, only {counts[-1][0]}: refine the mesh"
            )
        points.append(PathPoint(saved[0], problem.cavity_volume(), math.nan, None))
        by_pressure[row.pressure_kpa] = counts[-1]
    factor = Factor(problem)
    found, shapes = [], {}
    for crossing in mode_crossings(counter, factor, points, counts):
        problem.set_state(crossing.state)
        found.append(_found(crossing, problem, tip_mm))
        if crossing.shape is not None:
            shapes[crossing.waves] = _shape_content(crossing.state, crossing.shape)
    counter.close()
    factor.close()
    return by_pressure, found, shapes


def _found(crossing: ModeCrossing, problem: Problem, tip_mm: Callable[[State], float] | None) -> FoundCrossing:
    """A crossing in figures; the problem holds its state. Of a vacuum, pressures are negative and volumes are not."""
    sense = -1.0 if problem.surfaces.suction is not None else 1.0
    return FoundCrossing(
        waves=crossing.waves,
        pressure_kpa=1e3 * sense * crossing.pressure_mpa,
        within_kpa=1e3 * crossing.within_mpa,
        volume_mm3=sense * crossing.volume_mm3,
        volume_ratio=sense * crossing.volume_mm3 / problem.volume_unit_mm3,
        before=crossing.before,
        after=crossing.after,
        tip_mm=math.nan if tip_mm is None else tip_mm(crossing.state),
        tip_force_n=math.nan if tip_mm is None else end_force(problem),
    )


def _shape_content(state: State, shape: Shape) -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, **asdict(state), amplitude_mm=shape.amplitude_mm, mode_bodies_mm=shape.bodies_mm)
    return buffer.getvalue()
