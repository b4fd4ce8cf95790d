"""Runs read back from disk, what is read off them at a load, and what several meshes say of its error."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from studies.planning.levels import fineness
from studies.results import provenance
from studies.results.rows import AFTER_SNAP, REACHED, Row, row
from studies.results.run_files import PathRow, RunSummary, read_path, read_summary, write_text_atomically
from studies.results.uncertainty import (
    EDGE_ORDER,
    SAFETY_IN_DOUBT,
    UNKNOWN,
    Convergence,
    Orders,
    convergence,
    share_left,
)
from studies.scene.bellows import TipQuantity, on_meridian
from studies.scene.bodies import BodyScene
from studies.scene.body_geometry import MeshGeometry
from studies.scene.load import Scene

MEASURED_FILE = "measured.json"
# By so much what a mesh tells of its own error is multiplied, and it is never believed to less than so many percent:
# errors of either sign cancel at some pressure, and what is left there is not told (make study-dual).
OWN_SAFETY, OWN_LEAST_PERCENT = 2.0, 0.1
# Orders to expect of what is read off a meridian: quadratic elements give 3 for the smooth part; the edges of the seats
# and the clamped end are singular.
MERIDIAN_ORDERS = Orders(3.0, EDGE_ORDER)


@dataclass(frozen=True)
class Run:
    """A finished or stopped run, read back from disk.

    Attributes
    ----------
    summary, path
        Its summary.json and path.csv.
    measured
        What was measured in the states of a simple body: quantity -> value, by requested load in kPa.
    """

    summary: RunSummary
    path: tuple[PathRow, ...]
    measured: Mapping[float, Mapping[str, float]] = field(default_factory=dict)

    @property
    def requested(self) -> tuple[PathRow, ...]:
        """Its states at requested loads."""
        return tuple(row for row in self.path if row.status == "requested")

    def at(self, load_kpa: float) -> PathRow | None:
        """Its state at a requested load; None if it was not reached."""
        return next((r for r in self.requested if math.isclose(r.pressure_kpa, load_kpa, rel_tol=1e-9)), None)

    def measured_at(self, load_kpa: float, quantity: str) -> float:
        """What was measured at a requested load; NaN if it was not reached or not measured."""
        found = (v for p, v in self.measured.items() if math.isclose(p, load_kpa, rel_tol=1e-9))
        return next(found, {}).get(quantity, math.nan)


def read_run(folder: Path) -> Run:
    """The run in a folder.

    Raises
    ------
    OSError, ValueError, KeyError, TypeError
        If it is missing or damaged.
    """
    file, measured = folder / MEASURED_FILE, {}
    if file.exists():
        entries = json.loads(file.read_text(encoding="utf-8"))
        measured = {entry.pop("pressure_kpa"): entry for entry in entries}
    return Run(read_summary(folder), tuple(read_path(folder)), measured)


def write_measured(folder: Path, measured: Mapping[float, Mapping[str, float]]) -> None:
    """Write what was measured beside the path."""
    entries = [{"pressure_kpa": load, **values} for load, values in measured.items()]
    write_text_atomically(folder / MEASURED_FILE, json.dumps(entries, indent=1) + "\n")


def run_hash(scene: Scene, model: str, level: str) -> str:
    """Hash of everything that decides a run's numbers; the axisymmetric model knows less of a scene than bodies do."""
    if isinstance(scene, BodyScene):
        physics = scene.model_dump(mode="json", exclude={"name", "ask"})
        physics["looking for a limit point"] = "limit_kpa" in scene.quantities
        if isinstance(scene.geometry, MeshGeometry):
            content = Path(scene.geometry.file).read_bytes()
            physics["geometry"]["file"] = hashlib.sha256(content).hexdigest()
    else:
        known = on_meridian(scene) if model == "axisymmetric" else scene
        physics = known.model_dump(mode="json", exclude={"name", "ask", "compare"})
    text = json.dumps([physics, model, level, provenance.code_hash()], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def finished_run(folder: Path, content_hash: str) -> Run | None:
    """The run in a folder if it is there, whole and of this content."""
    try:
        run = read_run(folder)
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return run if run.summary.content_hash == content_hash else None


def of_model(runs: Sequence[Run], model: str) -> tuple[Run, ...]:
    """Those of a model, in their order."""
    return tuple(run for run in runs if run.summary.model == model)


def followed(runs: Sequence[Run]) -> tuple[Run, ...]:
    """The finest run whose path was followed, with states between the requested loads; without one the finest; or none.

    Finer runs start from its states at the requested loads.
    """
    between = [run for run in runs if any(row.status == "step" for row in run.path)]
    return tuple((between or list(runs))[-1:])


def value_status(run: Run, load_kpa: float, value: float, digits: str = ".2f") -> str:
    """``reached``, and beyond which limit point; or where and why the run stopped, or had no state, before."""
    if math.isnan(value):
        passed = any(abs(row.pressure_kpa) > abs(load_kpa) for row in run.requested)
        return f"no state at {load_kpa:.6g} kPa: {run.summary.reason}" if passed else stopped_text(run, digits)
    state = run.at(load_kpa)
    beyond = math.nan if state is None else state.limit_kpa
    return REACHED if math.isnan(beyond) else f"{REACHED}, {AFTER_SNAP} at {beyond:.4g} kPa"


def farthest_kpa(path: Sequence[PathRow]) -> float:
    """Load of a path's last state; beyond a limit point the limit's, as the pressure has fallen since."""
    if not path:
        return 0.0
    return path[-1].pressure_kpa if math.isnan(path[-1].limit_kpa) else path[-1].limit_kpa


def stopped_text(run: Run, digits: str = ".2f") -> str:
    """Where and why a run stopped, as a status: beyond a limit point, at that."""
    last = farthest_kpa(run.path)
    return f"stopped at {last:{digits}} kPa: {run.summary.reason}"


def state_rows(scene: str, run: Run, load_kpa: float, units: Mapping[str, str]) -> list[Row]:
    """Rows of columns of path.csv at a requested load, as far as they were computed; ``units`` by column."""
    entry = run.at(load_kpa)
    if entry is None:
        return []
    model, level = run.summary.model, run.summary.level
    values = {name: float(getattr(entry, name)) for name in units}
    return [
        row(scene, name, units[name], load_kpa, model, value, level)
        for name, value in values.items()
        if not math.isnan(value)
    ]


def tip_at(run: Run | None, pressure_kpa: float, quantity: TipQuantity = "tip_mm") -> float:
    """Elongation, mm, or force, N, at the tip of a run at a requested pressure; NaN if it was not reached."""
    entry = None if run is None else run.at(pressure_kpa)
    if entry is None:
        return math.nan
    return entry.tip_mm if quantity == "tip_mm" else entry.tip_force_n


def run_convergence(
    runs: Sequence[Run], values: Sequence[float], orders: Orders, left_by_edge: float | None = None
) -> Convergence:
    """Convergence of a quantity, one value per run, over the finest levels (three, or two) where it is not NaN.

    ``left_by_edge`` is that of `studies.results.uncertainty.convergence`.
    """
    found = [(1.0 / fineness(run.summary.level), value) for run, value in zip(runs, values, strict=True)]
    found = sorted((f for f in found if not math.isnan(f[1])), reverse=True)[-3:]
    return convergence([h for h, _ in found], [v for _, v in found], orders, left_by_edge)


def tip_convergence(
    runs: Sequence[Run], pressure_kpa: float, orders: Orders, quantity: TipQuantity = "tip_mm"
) -> Convergence:
    """Convergence of the tip over the finest levels (three, or two) that reached a pressure; of one as it tells itself.

    Meshes may agree by accident where their tips cross on the way. So at a pressure the uncertainty is at least what
    the largest relative change from the first mesh to the last, over all pressures that both reached, tells of an edge:
    of two meshes all of that change, of three the share of it that would be left.

    States of which one is unstable and another is not (a crease at an edge, seen by the finest mesh alone) lead to no
    limit: the uncertainty is three times their range at least.
    """
    tips = [tip_at(run, pressure_kpa, quantity) for run in runs]
    reached = [run for run, tip in zip(runs, tips, strict=True) if not math.isnan(tip)][-3:]
    counts = {state.unstable_modes for run in reached if (state := run.at(pressure_kpa)) is not None}
    if len({count for count in counts if math.isfinite(count)}) > 1:
        values = [tip_at(run, pressure_kpa, quantity) for run in reached]
        found = run_convergence(runs, tips, orders)
        return replace(found, least=SAFETY_IN_DOUBT * (max(values) - min(values)), of_limit=math.nan)
    if len(reached) == 1 and quantity == "tip_mm":
        return _of_one(reached[0], pressure_kpa)
    if len(reached) < 2 or (len(reached) == 3 and orders.edge is None):
        return run_convergence(runs, tips, orders)
    change = abs(tip_at(reached[-1], pressure_kpa, quantity)) * _largest_change(reached[0], reached[-1], quantity)
    if len(reached) == 2 or orders.edge is None:
        return replace(run_convergence(runs, tips, orders), least=change)
    sizes = [1.0 / fineness(run.summary.level) for run in reached[::2]]
    return run_convergence(runs, tips, orders, change * share_left(sizes, orders.edge))


def _largest_change(first: Run, last: Run, quantity: TipQuantity) -> float:
    """Largest relative change of the tip from one run to another, over all pressures that both reached."""
    changes = []
    for entry in first.path:
        one, other = (tip_at(run, entry.pressure_kpa, quantity) for run in (first, last))
        if other and not math.isnan(one - other):
            changes.append(abs((one - other) / other))
    return max(changes, default=0.0)


def own_errors_percent(run: Run) -> list[float]:
    """Sizes of the errors that a run tells of its own tips, percent; NaN where it tells none, or of no displacement."""
    return [100.0 * abs(row.tip_error_mm / row.tip_mm) if row.tip_mm else math.nan for row in run.requested]


def _of_one(run: Run, pressure_kpa: float) -> Convergence:
    """What a run's own mesh tells of the tip's error, unknown if any requested pressure is without.

    The estimate is within a factor of `OWN_SAFETY` of the error but where it passes zero on the way: it counts as no
    less than the largest, in parts of the tip's displacement. Added to the tip it leaves less by once itself.
    """
    errors, entry = own_errors_percent(run), run.at(pressure_kpa)
    if entry is None or any(map(math.isnan, errors)):
        return UNKNOWN
    least, of_limit = (
        0.01 * max(times * max(errors), OWN_LEAST_PERCENT) * abs(entry.tip_mm)
        for times in (OWN_SAFETY, OWN_SAFETY - 1.0)
    )
    return Convergence(entry.tip_mm + entry.tip_error_mm, OWN_SAFETY, least=least, of_limit=of_limit)
