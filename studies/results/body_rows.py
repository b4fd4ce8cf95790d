"""Rows of a simple body or a user's mesh: each value with its uncertainty, beside the exact answer."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from solvers.errors import Cause
from studies.results.exact_answers import exact_crossing_kpa, known_value
from studies.results.rows import REACHED, Row, row
from studies.results.runs import Run, run_convergence, state_rows, value_status
from studies.results.uncertainty import EDGE_ORDER, UNKNOWN, Convergence, Orders
from studies.scene.bodies import LIMIT_VOLUME, BodyScene
from studies.scene.body_geometry import TubeGeometry
from studies.scene.elements import locks

# Orders to expect: quadratic displacements have an error of the third; where an end is held the wall has corners, and
# three levels of a bonded tube show an order of 1.3. A user's mesh may have corners anywhere.
SMOOTH, WITH_CORNERS, FIRST = Orders(3.0), Orders(3.0, EDGE_ORDER), Orders(1.0)
# By so much of the bore the layer under a tube's cap moves it at most, however fine the mesh (docs/decisions.md).
CAP_SHARE = 1e-5
UNITS = {"volume_mm3": "mm3", "torque_nmm": "N mm", "axial_force_n": "N", "tip_force_n": "N", "reaction_n": "N"}
CHECKS = {"unstable_modes": "1", "min_det_f": "1", "largest_stretch": "1"}
# What is read off whole paths, not at single loads; all in kPa.
OF_PATHS = ("limit_kpa", "crossing_kpa")


def body_rows(scene: BodyScene, runs: Sequence[Run]) -> list[Row]:
    """All rows of a scene's runs by one model, coarsest first.

    Each value's uncertainty is the discretisation's, its reference the exact answer.
    """
    rows = [r for load in scene.loads_kpa for r in _rows_at(scene, runs, load)]
    for quantity in scene.quantities:
        if quantity in OF_PATHS:
            rows += _crossing_rows(scene, runs, quantity)
    return rows


def _rows_at(scene: BodyScene, runs: Sequence[Run], load: float) -> list[Row]:
    """Rows at one load, kPa: what is measured, then the checks of the finest run."""
    rows = []
    measured = dict.fromkeys(name for run in runs for values in run.measured.values() for name in values)
    wanted = [q for q in scene.quantities if q not in OF_PATHS]
    for quantity in [*wanted, *(name for name in measured if name not in wanted)]:
        known = known_value(scene, quantity, load)
        unit = UNITS.get(quantity, "deg" if quantity.endswith("_deg") else "mm")
        found = [run.measured_at(load, quantity) for run in runs]
        spread = _convergence(scene, runs, found)
        for run, value in zip(runs, found, strict=True):
            at = (scene.name, quantity, unit, load, run.summary.model, value, run.summary.level)
            rows.append(row(*at, spread.uncertainty(value), *known, value_status(run, load, value, ".6g")))
    return rows + state_rows(scene.name, runs[-1], load, CHECKS)


def _crossing_rows(scene: BodyScene, runs: Sequence[Run], quantity: str) -> list[Row]:
    """Where stability was lost, of a limit point only if it was at one, and how many modes became unstable there."""
    known = exact_crossing_kpa(scene)
    crossings = [None if quantity == "limit_kpa" and _bifurcates(run) else run.summary.crossing for run in runs]
    found = [float(c["pressure_kpa"]) if c else math.nan for c in crossings]
    # coarse meshes of a thick wall come near the load of a mode with order one first: two of them cannot tell
    two = sum(map(math.isfinite, found)) < 3
    spread = _convergence(scene, runs, found, FIRST if two else None)
    # how far meshes went that lost nothing: stability that one of several loses may be the mesh's own
    beyond = max((_highest_kpa(run) for run, c in zip(runs, crossings, strict=True) if c is None), default=0.0)
    rows = []
    for run, crossing, value in zip(runs, crossings, found, strict=True):
        model, level = run.summary.model, run.summary.level
        within = float(crossing["within_kpa"]) if crossing else math.nan
        status = REACHED if crossing else _no_crossing(run, quantity)
        of_levels = spread.uncertainty(value)
        total = within if len(runs) == 1 and not locks(scene.mesh) else of_levels + within
        total = max(total, beyond - value) if beyond > value else total
        rows.append(row(scene.name, quantity, "kPa", math.nan, model, value, level, total, *known, status))
        if crossing:
            jump = float(crossing["modes_after"]) - float(crossing["modes_before"])
            rows.append(row(scene.name, "crossing_modes", "1", math.nan, model, jump, level))
    return rows


def _highest_kpa(run: Run) -> float:
    return max((state.pressure_kpa for state in run.path), default=0.0)


def _bifurcates(run: Run) -> bool:
    crossing = run.summary.crossing
    return bool(crossing) and crossing["kind"] == Cause.BIFURCATION


def _no_crossing(run: Run, quantity: str) -> str:
    """Up to where stability was not lost, or to where it was lost in another way."""
    if quantity == "limit_kpa" and _bifurcates(run):
        crossing = run.summary.crossing
        modes = f"unstable modes {crossing['modes_before']} -> {crossing['modes_after']}"
        return f"none up to {float(crossing['pressure_kpa']):.6g} kPa, where a bifurcation ({modes}) ends the search"
    top = f"{_highest_kpa(run):.6g} kPa"
    if run.summary.status != REACHED:
        return f"stopped at {top}: {run.summary.reason}"
    return f"none up to {top}" + (f" and {LIMIT_VOLUME:g} times the volume" if quantity == "limit_kpa" else "")


def _convergence(
    scene: BodyScene, runs: Sequence[Run], values: Sequence[float], orders: Orders | None = None
) -> Convergence:
    """Convergence over the finest levels that have a value, by the body's orders or others; unknown if they lock."""
    if locks(scene.mesh):
        return UNKNOWN
    g = scene.geometry
    ends = g.ends if isinstance(g, TubeGeometry) else ""
    corners = g.kind in ("cook", "ventricle", "mesh") or ends == "bonded"
    found = run_convergence(runs, values, orders or (WITH_CORNERS if corners else SMOOTH))
    if ends != "capped":
        return found
    return replace(found, doubt=found.doubt + CAP_SHARE * max(map(abs, filter(math.isfinite, values)), default=0.0))
