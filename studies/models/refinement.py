"""Which mesh comes next while the scene's tolerance is not met."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import cast

from studies.planning.error_model import FINER_ROUNDS, ROUNDS, cells_of, predicted_unknowns
from studies.planning.levels import FINER_MERIDIANS, MERIDIANS, MOST_UNKNOWNS, BodyLevel, Model, body_level, fineness
from studies.planning.plan import Plan
from studies.results.rows import Row
from studies.results.runs import Run
from studies.results.tolerance import Shortfall
from studies.scene.bellows import BellowsScene


def until_good_enough(
    plan: Plan, solve: Callable[[Sequence[str]], list[Run]], good_enough: Callable[[Sequence[Run]], bool], model: Model
) -> list[Run]:
    """Runs of a plan's levels and, while they are not good enough, of those that are left to the results.

    Parameters
    ----------
    model
        That of the runs.
    """
    runs = solve(plan.certain)
    for level in plan.perhaps:
        if good_enough(runs):
            return runs
        runs += solve((level,))
    for level in plan.finer:
        if good_enough(runs) or not may_follow(runs, level, model):
            break
        runs += solve((level,))
    return runs


def may_follow(runs: Sequence[Run], level: str, model: Model) -> bool:
    """True if a finer mesh is worth its cost: the last one reached its loads, and the next is not too large."""
    if len(runs) < 2 or runs[-1].summary.status != "reached":
        return False
    return _unknowns(runs, level) <= MOST_UNKNOWNS[model]


def _unknowns(runs: Sequence[Run], level: str) -> float:
    """Unknowns of a finer mesh, as they grew from the last but one to the last."""
    (coarse, fine), (few, many) = zip(*((fineness(r.summary.level), r.summary.dofs) for r in runs[-2:]), strict=True)
    power = math.log(many / few) / math.log(fine / coarse)
    return float(many * (fineness(level) / fine) ** power)


def finer_body(
    scene: BellowsScene, rows: Sequence[Row], axisymmetric: Sequence[Run], body: Run, missed: Sequence[Shortfall]
) -> str | BodyLevel | None:
    """What makes a body hold the tolerance, or come nearer: a meridian to solve, a finer body, or None.

    The uncertainty is the meridian's part, which its axisymmetric run has too, and that of the cells round; the larger
    is made smaller. A meridian's error costs less to know better, by a finer axisymmetric run, than to make smaller.
    """
    if not missed or body.summary.status != "reached":
        return None
    level, model = body_level(body.summary.level), cast(Model, body.summary.model)
    worst = max(missed, key=lambda short: short.reached_percent).row
    of = (worst.quantity, "axisymmetric", f"r{level.meridian}", worst.pressure_kpa)
    flat = next((r.uncertainty for r in rows if (r.quantity, r.model, r.level, r.pressure_kpa) == of), math.nan)
    if not math.isfinite(worst.uncertainty):
        return None
    if worst.uncertainty > 2.0 * flat:
        kind = cells_of(scene)
        rounds = [n for n in (*ROUNDS[kind], *FINER_ROUNDS[kind]) if model == "full3d" or n % 4 == 0]
        around = next((n for n in rounds if n > level.around), None)
        return None if around is None else _if_small(scene, body, model, BodyLevel(around, level.meridian))
    known = [fineness(run.summary.level) for run in axisymmetric]
    following = 2 * known[-1]
    if known[-1] < 4 * level.meridian and following in (*MERIDIANS, *FINER_MERIDIANS):
        if may_follow(axisymmetric, f"r{following}", "axisymmetric"):
            return f"r{following}"
    finer = BodyLevel(level.around, 2 * level.meridian)
    return _if_small(scene, body, model, finer) if finer.meridian in known else None


def _if_small(scene: BellowsScene, body: Run, model: Model, wanted: BodyLevel) -> BodyLevel | None:
    """A finer body if it has no more than the most unknowns, as the error model says they grow."""
    growth = predicted_unknowns(scene, model, wanted.name) / predicted_unknowns(scene, model, body.summary.level)
    return wanted if growth * body.summary.dofs <= MOST_UNKNOWNS[model] else None
