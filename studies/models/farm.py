"""Many scenes at once: shared out over MPI ranks by mpi4py.futures, resumable, one table out.

``mpirun -n N`` works on the cores of one machine and on several; one rank needs no MPI launcher. Every scene is solved
by one rank, in a folder of its own that keeps its finished runs: a sweep that is started again repeats nothing, one
that was killed goes on.
"""

from __future__ import annotations

import json
import math
import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from mpi4py import MPI
from mpi4py.futures import MPICommExecutor

from analytical.bellows.chains import closed_form
from analytical.bellows.dimensions import BellowsError
from meshes.errors import GeometryError, MeshError
from solvers.errors import SolverError
from studies.models.session import run_plan
from studies.planning.planner import make_plan
from studies.progress import Progress
from studies.results import provenance
from studies.results.bellows_rows import bellows_rows
from studies.results.files import write_text_atomically
from studies.results.records import field_text, field_value, read_lines, write_lines
from studies.results.rows import REACHED, Row, difference_percent
from studies.results.runs import Run, finished_run
from studies.scene.bellows import BellowsScene, dimensions_of
from studies.scene.materials import law_of
from studies.scene.sections import SceneError
from studies.scene.sweep import Variant, read_sweep

TABLE_FILE, OUTCOME_FILE, SCENES_FOLDER = "sweep.csv", "sweep.json", "scenes"
REFUSED, FAILED = "refused: ", "failed: "
# Scenes that wait at another rank, so that it goes on while this one is in the middle of its own.
_AHEAD = 2
# The table of an unfinished sweep is written that often, s.
_WRITE_EVERY_S = 10.0


@dataclass(frozen=True)
class SweepRow:
    """What is known of a scene at a pressure; NaN (an empty field) where there is no number.

    Attributes
    ----------
    scene
        Its name and the name of its folder.
    values
        The swept keys' values; None where the scene leaves a key to its default.
    pressure_kpa
        Cavity pressure; NaN for a refused scene, which has one row.
    quantity, unit
        ``tip_mm``, or ``tip_force_n`` of a blocked tip, and its unit.
    closed_form, closed_form_balanced, closed_form_seat
        The corrected chain, the balanced one, and the corrected one with the free half pitch.
    unfolding_kpa
        Pressure at which the closed form is fully unfolded.
    axisymmetric, uncertainty, level
        The axisymmetric answer on its finest mesh, its discretisation uncertainty in the same unit, and that mesh.
    unstable_modes
        Number of the axisymmetric model's unstable modes.
    closed_form_percent, closed_form_balanced_percent, closed_form_seat_percent
        Difference of each closed form from the axisymmetric answer, % of the latter.
    status
        ``reached``, ``stopped at … kPa: why``, ``failed: why``, ``refused: why`` or ``not run yet``.
    """

    scene: str
    values: Mapping[str, Any]
    pressure_kpa: float
    quantity: str = ""
    unit: str = ""
    closed_form: float = math.nan
    closed_form_balanced: float = math.nan
    closed_form_seat: float = math.nan
    unfolding_kpa: float = math.nan
    axisymmetric: float = math.nan
    uncertainty: float = math.nan
    level: str = ""
    unstable_modes: float = math.nan
    closed_form_percent: float = math.nan
    closed_form_balanced_percent: float = math.nan
    closed_form_seat_percent: float = math.nan
    status: str = REACHED


@dataclass(frozen=True)
class SweepOutcome:
    """How a sweep went.

    Attributes
    ----------
    scenes, refused, failed, stopped
        Number of scenes; of those that cannot be built, that failed, and that stopped before their last pressure.
    ranks, wall_s
        Who took part, and how long it took this time.
    solved_s
        Wall time of all scenes' runs when they were solved, one rank each, s.
    """

    scenes: int
    refused: int
    failed: int
    stopped: int
    ranks: int
    wall_s: float
    solved_s: float

    @property
    def reached(self) -> bool:
        """True if every scene that can be built reached every requested pressure."""
        return self.failed == self.stopped == 0


@dataclass(frozen=True)
class _Answer:
    """A scene's rows, and the wall time of its runs when they were solved, s."""

    rows: tuple[SweepRow, ...]
    solved_s: float


def run_sweep(file: Path, out: Path, comm: MPI.Comm, progress: Progress) -> SweepOutcome:
    """Run a sweep and write its table; every rank calls.

    Parameters
    ----------
    file
        The sweep file (`studies.scene.sweep`).
    out
        Where ``sweep.csv``, ``sweep.json`` and the scenes' folders go; what is there of the same content is used.
    comm
        Who takes part, this rank's included.
    progress
        Is told of every scene that has ended.

    Returns
    -------
    SweepOutcome
        The same on every rank.

    Raises
    ------
    SceneError
        On every rank, with one line per fault of the sweep file; nothing has been run or written.
    """
    begin = time.perf_counter()
    variants: list[Variant] | SceneError = []
    if comm.rank == 0:
        try:
            variants = read_sweep(file)
        except SceneError as error:
            variants = error
    variants = comm.bcast(variants)
    if isinstance(variants, SceneError):
        raise variants
    found: dict[str, _Answer] = {}
    written = 0.0
    for variant, answer in _answers(variants, out / SCENES_FOLDER, comm):
        found[variant.name] = answer
        worst = next((r.status for r in answer.rows if r.status != REACHED), REACHED)
        progress.end(f"{len(found)} of {len(variants)} scenes: {describe(variant.values)}: {worst}")
        if time.perf_counter() - written > _WRITE_EVERY_S:
            write_table(out / TABLE_FILE, _table(variants, found))
            written = time.perf_counter()
    outcome = None
    if comm.rank == 0:
        write_table(out / TABLE_FILE, _table(variants, found))
        statuses = [{row.status for row in answer.rows} for answer in found.values()]
        outcome = SweepOutcome(
            scenes=len(variants),
            refused=sum(any(s.startswith(REFUSED) for s in of_scene) for of_scene in statuses),
            failed=sum(any(s.startswith(FAILED) for s in of_scene) for of_scene in statuses),
            stopped=sum(any(s.startswith("stopped") for s in of_scene) for of_scene in statuses),
            ranks=comm.size,
            wall_s=time.perf_counter() - begin,
            solved_s=sum(answer.solved_s for answer in found.values()),
        )
        write_text_atomically(out / OUTCOME_FILE, json.dumps(asdict(outcome) | _stamp(), indent=1) + "\n")
    outcome = comm.bcast(outcome)
    assert outcome is not None
    return outcome


def describe(values: Mapping[str, Any]) -> str:
    """A scene's swept keys for a terminal."""
    return ", ".join(f"{key.split('.')[-1]} = {value_text(value)}" for key, value in values.items())


def _stamp() -> dict[str, Any]:
    return {"commit": provenance.commit(), "when": provenance.now(), "machine": provenance.machine()}


# --- sharing out ----------------------------------------------------------------------------


def _answers(variants: Sequence[Variant], folder: Path, comm: MPI.Comm) -> Iterator[tuple[Variant, _Answer]]:
    """Answers as they come, on rank 0; the other ranks solve until there is nothing left and yield nothing."""
    if comm.rank == 0:
        yield from ((v, _Answer(_refused_rows(v), 0.0)) for v in variants if v.scene is None)
    waiting = deque(sorted((v for v in variants if v.scene is not None), key=_expected_cost, reverse=True))
    if comm.size == 1:
        yield from ((variant, _answer(variant, folder)) for variant in waiting)
        return
    assert isinstance(comm, MPI.Intracomm)
    with MPICommExecutor(comm, root=0) as pool:
        if pool is None:
            return
        # Solving here calls MPI beside the pool's own thread, which not every MPI allows.
        takes_part = MPI.Query_thread() == MPI.THREAD_MULTIPLE
        away: dict[Future[_Answer], Variant] = {}
        while waiting or away:
            while waiting and len(away) < _AHEAD * (comm.size - 1):
                variant = waiting.popleft()
                away[pool.submit(_answer, variant, folder)] = variant
            if waiting and takes_part:
                variant = waiting.popleft()
                yield variant, _answer(variant, folder)
            else:
                wait(away, return_when=FIRST_COMPLETED)
            for future in [future for future in away if future.done()]:
                yield away.pop(future), future.result()


def _expected_cost(variant: Variant) -> float:
    """Grows with a scene's cost: its cells are about as large as the wall is thick."""
    assert variant.scene is not None
    return variant.scene.geometry.convolutions / variant.scene.geometry.wall_mm


def _answer(variant: Variant, folder: Path) -> _Answer:
    """Solve a scene on this rank alone."""
    assert variant.scene is not None
    ask = variant.scene.ask.model_copy(update={"modes": False})  # nobody looks at them
    scene = variant.scene.model_copy(update={"ask": ask})
    try:
        result = run_plan(
            scene, variant.text, make_plan(scene), folder / variant.name, MPI.COMM_SELF, Progress(MPI.COMM_WORLD)
        )
    except (GeometryError, MeshError, SolverError, BellowsError) as error:
        reason = FAILED + " ".join(str(error).split())
        return _Answer(_rows(variant, scene, bellows_rows(scene, ()), None, reason), 0.0)
    # As the files have them, so that the table is the same to the last digit when nothing is left to solve.
    kept = [
        finished_run(folder / variant.name / f"axisymmetric-{run.summary.level}", run.summary.content_hash)
        for run in result.axisymmetric
    ]
    runs = [run for run in kept if run is not None]
    seconds = sum(run.summary.time_s["total"] for run in runs)
    return _Answer(_rows(variant, scene, bellows_rows(scene, runs), runs[-1]), seconds)


# --- the table ------------------------------------------------------------------------------


def _refused_rows(variant: Variant) -> tuple[SweepRow, ...]:
    return (SweepRow(variant.name, variant.values, math.nan, status=REFUSED + variant.refusal),)


def _rows(
    variant: Variant, scene: BellowsScene, rows: Sequence[Row], answer: Run | None, status: str = ""
) -> tuple[SweepRow, ...]:
    """A scene's rows of the table, a row per requested pressure, from its comparison rows."""
    quantity = scene.main_quantity
    level = "" if answer is None else answer.summary.level
    found = []
    for pressure in scene.load.pressure_kpa:
        here = [r for r in rows if r.pressure_kpa == pressure]
        chains = {r.model: r.value for r in here if r.quantity == quantity and r.model.startswith("closed_form")}
        tip = next((r for r in here if (r.quantity, r.model, r.level) == (quantity, "axisymmetric", level)), None)
        modes = next((r.value for r in here if r.quantity == "unstable_modes"), math.nan)
        value = math.nan if tip is None else tip.value
        chosen = {
            name: chains.get(name, math.nan) for name in ("closed_form", "closed_form_balanced", "closed_form_seat")
        }
        found.append(
            SweepRow(
                scene=variant.name,
                values=variant.values,
                pressure_kpa=pressure,
                quantity=quantity,
                unit="N" if quantity == "tip_force_n" else "mm",
                unfolding_kpa=_unfolding_kpa(scene),
                axisymmetric=value,
                uncertainty=math.nan if tip is None else tip.uncertainty,
                level=level,
                unstable_modes=modes,
                status=status or ("" if tip is None else tip.status),
                **chosen,
                **{f"{name}_percent": difference_percent(number, value) for name, number in chosen.items()},
            )
        )
    return tuple(found)


def _unfolding_kpa(scene: BellowsScene) -> float:
    try:
        path = closed_form(dimensions_of(scene), law_of(scene.material), scene.load.pressure_kpa)
    except BellowsError:
        return math.nan
    return float(path.unfolding_pressure_kpa[0])


def _table(variants: Sequence[Variant], found: Mapping[str, _Answer]) -> list[SweepRow]:
    """All rows in the order of the sweep file, whatever has been found of them."""
    missing = {v.name: (SweepRow(v.name, v.values, math.nan, status="not run yet"),) for v in variants}
    return [row for v in variants for row in (found[v.name].rows if v.name in found else missing[v.name])]


_PLAIN = [f for f in fields(SweepRow) if f.name not in ("scene", "values")]


def write_table(path: Path, rows: Sequence[SweepRow]) -> None:
    """Write sweep.csv: the scene, the swept keys, then the fields of `SweepRow`; numbers with nine digits."""
    header = ["scene", *rows[0].values, *(f.name for f in _PLAIN)]
    lines = (
        [row.scene, *map(value_text, row.values.values()), *(field_text(getattr(row, f.name), 9) for f in _PLAIN)]
        for row in rows
    )
    write_lines(path, header, lines)


def read_table(path: Path) -> list[SweepRow]:
    """Read what `write_table` has written."""
    plain = {f.name: f.type for f in _PLAIN}
    found = []
    for entry in read_lines(path):
        values = {k: _value(v) for k, v in entry.items() if k not in plain and k != "scene"}
        known = {k: field_value(plain[k], v) for k, v in entry.items() if k in plain}
        found.append(SweepRow(entry["scene"], values, **known))
    return found


def value_text(value: Any) -> str:
    """A key's value as one field: text as it is, lists and tables as JSON, None empty."""
    if value is None or isinstance(value, str):
        return value or ""
    return f"{value:g}" if isinstance(value, float) else json.dumps(value)


def _value(text: str) -> Any:
    try:
        return json.loads(text) if text else None
    except ValueError:
        return text
