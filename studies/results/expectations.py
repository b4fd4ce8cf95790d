"""What was expected of the answer's mesh, and what came out: error and time, as rows and as a sentence."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import cast

import numpy as np

from studies.planning.error_model import (
    cells_of,
    checked_error_percent,
    knows,
    predicted_error_percent,
    predicted_seconds,
)
from studies.planning.levels import MERIDIANS, Model, body_level, fineness
from studies.results.rows import Row, row
from studies.results.runs import Run, of_model, own_errors_percent, tip_at
from studies.scene.bellows import BellowsScene

PREDICTED_ERROR, CHECKED_ERROR = "predicted_error_percent", "checked_error_percent"
PREDICTED_WORK, WORK = "predicted_work_s", "work_s"


def expectation_rows(scene: BellowsScene, runs: Sequence[Run]) -> list[Row]:
    """Rows of the answer: its error predicted before and checked after solving, the work predicted and done.

    Parameters
    ----------
    runs
        Axisymmetric ones first, then bodies, coarsest first; the answer is the last.

    Returns
    -------
    list of Row
        Errors in percent of the tip, the largest over the requested pressures; work in s, without start and imports, of
        all runs together. None where the error model knows nothing of the scene or of the mesh, or nothing checks it.
    """
    axisymmetric = of_model(runs, "axisymmetric")
    bodies = [run for run in runs if run.summary.model != "axisymmetric"]
    if not knows(scene) or not axisymmetric or any(_meridian(run) not in MERIDIANS for run in runs):
        return []
    answer = runs[-1]
    model, level = _model(answer), answer.summary.level
    checked = _checked_percent(scene, axisymmetric, _meridian(answer))
    if math.isnan(checked) and len(axisymmetric) < 2:
        return []
    if bodies:
        checked += _around_percent(scene, answer, axisymmetric)
    found = {
        PREDICTED_ERROR: ("%", predicted_error_percent(scene, model, level)),
        CHECKED_ERROR: ("%", checked),
        PREDICTED_WORK: ("s", _work_s(scene, axisymmetric, bodies)),
        WORK: ("s", sum(run.summary.time_s["total"] for run in runs)),
    }
    return [row(scene.name, name, unit, math.nan, model, value, level) for name, (unit, value) in found.items()]


def sentence(rows: Sequence[Row]) -> str:
    """These rows for a terminal; empty if there are none."""
    found = {r.quantity: r.value for r in rows}
    if PREDICTED_ERROR not in found:
        return ""
    return (
        f"error predicted {found[PREDICTED_ERROR]:.2g} %, by the check {found[CHECKED_ERROR]:.2g} %; "
        f"work predicted {found[PREDICTED_WORK]:.2g} s, done {found[WORK]:.2g} s"
    )


def _model(run: Run) -> Model:
    return cast(Model, run.summary.model)


def _meridian(run: Run) -> int:
    level = run.summary.level
    return fineness(level) if run.summary.model == "axisymmetric" else body_level(level).meridian


def _tips(scene: BellowsScene, run: Run) -> list[float]:
    return [tip_at(run, pressure) for pressure in scene.load.pressure_kpa]


def _checked_percent(scene: BellowsScene, axisymmetric: Sequence[Run], meridian: int) -> float:
    """Error that a meridian leaves, as the level before shows it, or of the first level the one after, or itself."""
    if len(axisymmetric) < 2:
        return float(np.max(own_errors_percent(axisymmetric[0]) or [math.nan]))
    levels = [_meridian(run) for run in axisymmetric]
    at = levels.index(meridian)
    beside = axisymmetric[at - 1 if at else 1]
    return checked_error_percent(cells_of(scene), meridian, _tips(scene, axisymmetric[at]), _tips(scene, beside))


def _around_percent(scene: BellowsScene, body: Run, axisymmetric: Sequence[Run]) -> float:
    """Error that the cells round leave: the difference from the axisymmetric tip on the same meridian."""
    base = next(run for run in axisymmetric if _meridian(run) == _meridian(body))
    pairs = zip(_tips(scene, body), _tips(scene, base), strict=True)
    return max((100.0 * abs(v / b - 1.0) for v, b in pairs if b and math.isfinite(v - b)), default=math.nan)


def _work_s(scene: BellowsScene, axisymmetric: Sequence[Run], bodies: Sequence[Run]) -> float:
    """Predicted seconds of all runs; those of a body hold those of the meridian it starts from."""
    within = {_meridian(run) for run in bodies}
    total = sum(
        predicted_seconds(scene, "axisymmetric", run.summary.level)
        for run in axisymmetric
        if _meridian(run) not in within
    )
    return total + sum(predicted_seconds(scene, _model(run), run.summary.level) for run in bodies)
