"""Whether the answer holds the scene's tolerance, by how much it misses it, and which mesh comes next while it does.

A tolerance is a share of the value's size. Where a quantity passes zero on the way no mesh could hold a share of it, so
the size counted is at least a hundredth (`SMALL`) of the largest of that quantity over the requested loads.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import cast

from studies.planning.bodies import models_of
from studies.planning.error_model import predicted_error_percent, predicted_unknowns, rounds_of
from studies.planning.levels import (
    BODY_MERIDIANS,
    FINER_MERIDIANS,
    LIMIT,
    MERIDIANS,
    MOST_UNKNOWNS,
    BodyLevel,
    Model,
    body_level,
    fineness,
)
from studies.planning.plan import Plan
from studies.results.rows import NOT_MET, REACHED, Row
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene
from studies.scene.bodies import BodyScene
from studies.scene.body_geometry import MeshGeometry
from studies.scene.elements import locks
from studies.scene.load import Scene

SMALL = 0.01


@dataclass(frozen=True)
class Shortfall:
    """A value that does not hold the scene's tolerance.

    Attributes
    ----------
    row
        The value, its status as it was found.
    reached_percent, asked_percent
        Its uncertainty in percent of what the tolerance is of, infinite if no other mesh tells it; and the tolerance.
    """

    row: Row
    reached_percent: float
    asked_percent: float

    @property
    def status(self) -> str:
        """For the row: how far it is from the tolerance, and what was said of it besides."""
        besides = self.row.status.removeprefix(REACHED).strip(", ")
        said = f"{NOT_MET}: {_certain(self.reached_percent)}, {self.asked_percent:g} % asked"
        return f"{said}; {besides}" if besides else said


def asked_of(scene: Scene, rows: Sequence[Row], model: str, level: str) -> tuple[Row, ...]:
    """Rows that the tolerance is asked of, as far as reached: requested quantities on a mesh, or, later, its limit.

    Of a bellows one quantity is to be found, the other one of its tip is given: a force, or no displacement where it is
    blocked.
    """
    wanted = scene.quantities if isinstance(scene, BodyScene) else (scene.main_quantity,)
    of_model = [row for row in rows if row.model == model and row.quantity in wanted]
    best = {(row.quantity, row.pressure_kpa): row for row in of_model if row.level in (level, LIMIT)}
    return tuple(row for row in best.values() if math.isfinite(row.value) or _missing(row, of_model))


def shortfalls(scene: Scene, rows: Sequence[Row], model: str, level: str) -> tuple[Shortfall, ...]:
    """Requested values of a mesh that do not hold the scene's tolerance, as far as anybody knows.

    A user's mesh that is too large to be halved holds none; other bodies have one mesh only where a caller wants it so.
    """
    alone = len({row.level for row in rows if row.model == model}) < 2
    if alone and isinstance(scene, BodyScene) and not isinstance(scene.geometry, MeshGeometry):
        return ()
    asked = asked_of(scene, rows, model, level)
    percents = [(row, _percent(row, [r for r in asked if r.quantity == row.quantity])) for row in asked]
    tolerance = scene.ask.tolerance_percent
    return tuple(Shortfall(row, percent, tolerance) for row, percent in percents if not percent <= tolerance)


def worst_percent(asked: Sequence[Row]) -> float:
    """The largest uncertainty in percent of what a tolerance is of, of the rows of `asked_of`; NaN without any."""
    return max((_percent(row, [r for r in asked if r.quantity == row.quantity]) for row in asked), default=math.nan)


def marked(rows: Sequence[Row], missed: Sequence[Shortfall]) -> tuple[Row, ...]:
    """The rows, those that miss the tolerance with their status."""
    status = {id(shortfall.row): shortfall.status for shortfall in missed}
    return tuple(replace(row, status=status[id(row)]) if id(row) in status else row for row in rows)


def sentence(scene: Scene, missed: Sequence[Shortfall], judged: int) -> str:
    """What misses the tolerance by most, by how much, and what to do; empty if nothing does.

    Parameters
    ----------
    judged
        Number of values that the tolerance was asked of.
    """
    if not missed:
        return ""
    worst = max(missed, key=lambda s: s.reached_percent)
    row = worst.row
    at = "" if math.isnan(row.pressure_kpa) else f" at {row.pressure_kpa:g} kPa"
    others = f"; {len(missed)} of {judged} values miss it" if judged > 1 else ""
    return (
        f"tolerance {worst.asked_percent:g} % not met: {row.quantity}{at}: {_certain(worst.reached_percent)} on "
        f"{row.model} {row.level}{others}. {_remedy(scene, worst)}"
    )


def _percent(row: Row, alike: Sequence[Row]) -> float:
    """Uncertainty in percent of a value's size, beside those of its mesh and quantity; infinite if it is not known."""
    if math.isnan(row.value):
        return math.inf
    largest = max((abs(other.value) for other in alike if math.isfinite(other.value)), default=math.nan)
    size = max(abs(row.value), SMALL * largest)
    if row.uncertainty == 0.0:
        return 0.0
    return 100.0 * row.uncertainty / size if size > 0.0 and math.isfinite(row.uncertainty) else math.inf


def _missing(row: Row, of_model: Sequence[Row]) -> bool:
    """True if a whole path has not what another mesh's has, such as a limit point."""
    stopped = row.status.startswith("stopped")
    others = (other.value for other in of_model if other.quantity == row.quantity)
    return math.isnan(row.pressure_kpa) and not stopped and any(map(math.isfinite, others))


def _certain(percent: float) -> str:
    """An uncertainty in words, rounded up: who asks for no more than is said gets it."""
    return f"± {1.005 * percent:.3g} % reached" if math.isfinite(percent) else "no second mesh confirms it"


def _remedy(scene: Scene, worst: Shortfall) -> str:
    model = cast(Model, worst.row.model)
    closer = ""
    if model in ("sector", "full3d"):
        flat = "axisymmetric" in models_of(scene) if isinstance(scene, BodyScene) else not scene.geometry.eccentricity
        closer = "ask for --model axisymmetric, which is exact for this scene and finer, or " if flat else ""
    if not math.isfinite(worst.reached_percent):
        if locks(scene.mesh):
            return (
                "Linear displacements lock: their meshes may agree on a value that is wrong by more. To do: set "
                'mesh.element = "auto"'
            )
        if isinstance(scene, BodyScene) and isinstance(scene.geometry, MeshGeometry):
            closer += "give a coarser mesh, small enough to be solved with its edges halved too, or "
        return f"To do: {closer}leave out the loads that other meshes do not reach"
    enough = 1.005 * worst.reached_percent
    last = f"set ask.tolerance_percent to {enough:.3g} or more" if enough <= 100.0 else "ask for smaller loads"
    return f"Meshes are refined up to {MOST_UNKNOWNS[model]:,} unknowns; to do: {closer}{last}"


# --- finer meshes -------------------------------------------------------------------------------------------


def until_good_enough(
    plan: Plan,
    solve: Callable[[str, Run | None], Run],
    good_enough: Callable[[Sequence[Run]], bool],
    model: Model,
) -> list[Run]:
    """Runs of a plan's levels and, while they are not good enough, of those that are left to the results.

    Parameters
    ----------
    solve
        Solves a level, which may start from the run on the one before.
    model
        That of the runs.
    """
    runs: list[Run] = []

    def add(level: str) -> None:
        runs.append(solve(level, runs[-1] if runs else None))

    for level in plan.certain:
        add(level)
    for level in plan.perhaps:
        if good_enough(runs):
            return runs
        add(level)
    for level in plan.finer:
        if good_enough(runs) or not may_follow(runs, level, model):
            break
        add(level)
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


def first_body(scene: BellowsScene, model: Model, wanted: BodyLevel, axisymmetric: Sequence[Run]) -> BodyLevel:
    """The wanted body; if that is too large, of those with fewer cells the one of the least expected error."""
    if _small_enough(scene, model, wanted, axisymmetric):
        return wanted
    fewer = [
        BodyLevel(n, meridian)
        for meridian in BODY_MERIDIANS
        for n in rounds_of(scene, model)
        if n <= wanted.around and meridian <= wanted.meridian
    ]
    small = [body for body in fewer if _small_enough(scene, model, body, axisymmetric)]
    return min(small, key=lambda body: predicted_error_percent(scene, model, body.name), default=fewer[0])


def finer_body(
    scene: BellowsScene, rows: Sequence[Row], axisymmetric: Sequence[Run], body: Run, missed: Sequence[Shortfall]
) -> str | BodyLevel | None:
    """What makes a body hold the tolerance, or come nearer: a meridian to solve, a finer body, or None.

    The uncertainty is the meridian's part, which its axisymmetric run has too, and that of the cells round; the larger
    is made smaller, if it can. A meridian's error costs less to know better, by a finer axisymmetric run, than to make
    smaller; that of the limit is the same for every body.
    """
    if not missed or body.summary.status != "reached":
        return None
    level, model = body_level(body.summary.level), cast(Model, body.summary.model)
    worst = max(missed, key=lambda short: short.reached_percent).row
    at_limit = worst.level == LIMIT
    flat_level = LIMIT if at_limit else f"r{level.meridian}"
    of = (worst.quantity, "axisymmetric", flat_level, worst.pressure_kpa)
    flat = next((r.uncertainty for r in rows if (r.quantity, r.model, r.level, r.pressure_kpa) == of), math.nan)
    if not math.isfinite(worst.uncertainty):
        return None
    known = [fineness(run.summary.level) for run in axisymmetric]
    following = 2 * known[-1]
    along: list[str | BodyLevel] = []
    if (at_limit or known[-1] < 4 * level.meridian) and following in (*MERIDIANS, *FINER_MERIDIANS):
        small = len(axisymmetric) < 2 or may_follow(axisymmetric, f"r{following}", "axisymmetric")
        along += [f"r{following}"] if small else []
    if not at_limit and 2 * level.meridian in known:
        along += [BodyLevel(level.around, 2 * level.meridian)]
    more = [BodyLevel(n, level.meridian) for n in rounds_of(scene, model) if n > level.around][:1]
    ways = [*more, *along] if worst.uncertainty > 2.0 * flat else [*along, *more]
    return next((way for way in ways if isinstance(way, str) or _small_enough(scene, model, way, axisymmetric)), None)


def _small_enough(scene: BellowsScene, model: Model, body: BodyLevel, axisymmetric: Sequence[Run]) -> bool:
    """True if a body has no more than the most unknowns, as predicted and as its meridian has more or fewer of them."""
    run = axisymmetric[0].summary
    share = run.dofs / predicted_unknowns(scene, "axisymmetric", run.level)
    return share * predicted_unknowns(scene, model, body.name) <= MOST_UNKNOWNS[model]
