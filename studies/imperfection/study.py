"""The imperfection study: actuators whose moulding core sat off the axis, in full 3D: how far they bend."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any, Final

import click

from studies.engine import Page, Setting, Solved, Study
from studies.imperfection.bodies import SHARES, Actuator, Body, solve
from studies.imperfection.pictures import draw_bends, draw_shapes
from studies.planning.levels import BodyLevel
from studies.report.labels import level_label
from studies.report.numbers import duration
from studies.report.tables import Column, Table, pivot, pressure_of
from studies.results.rows import Row, row
from studies.results.runs import value_status
from studies.scene.bellows import core_shift_mm

ACTUATORS: Final = (
    Actuator(
        "short",
        "imperfection/short-core-10.toml",
        (1.25, 2.5, 5.0, 7.5, 10.0),
        (BodyLevel(8, 1), BodyLevel(12, 1), BodyLevel(8, 2)),
    ),
    Actuator("heung-t2-ri5", "heung-t2-ri5.toml", (5.0, 10.0, 15.0, 20.0), (BodyLevel(8, 1),)),
)
BENDS: Final = ("tip_bend_deg", "tip_sideways_mm")
UNITS: Final = {"tip_mm": "mm", "tip_bend_deg": "degree", "tip_sideways_mm": "mm", "unstable_modes": ""}


def cases(options: Mapping[str, Any]) -> Sequence[Actuator]:
    """The actuators, or the short one alone."""
    return ACTUATORS[:1] if options["short"] else ACTUATORS


def rows_of(actuator: Actuator, bodies: Sequence[Body]) -> list[Row]:
    """Rows of an actuator: each tip beside the centred one on the same mesh, each bend beside the one in proportion."""
    rows = []
    for pressure, body, name in product(actuator.pressures_kpa, bodies, UNITS):
        scene, level, value = body.scene.name, body.level.name, body.value(name, pressure)
        known, source = _reference(name, body, pressure, bodies)
        status = value_status(body.run, pressure, body.value("tip_mm", pressure))
        rows.append(row(scene, name, UNITS[name], pressure, "full3d", value, level, math.nan, known, source, status))
    return rows


def _reference(quantity: str, body: Body, pressure_kpa: float, bodies: Sequence[Body]) -> tuple[float, str]:
    centred, small, large = bodies[: len(SHARES)]
    if quantity == "tip_mm" and body.level == centred.level:
        return centred.value(quantity, pressure_kpa), "core centred, same mesh"
    if quantity in BENDS and body.level != centred.level:
        return large.value(quantity, pressure_kpa), large.level.name
    if quantity in BENDS and body is large:
        expected = small.value(quantity, pressure_kpa) * large.share / small.share
        return expected, f"in proportion to {100.0 * small.share:g} %"
    return math.nan, ""


def state_table(rows: Sequence[Row]) -> Table:
    """A line per pressure, core and mesh."""
    lines = {
        "kPa": pressure_of,
        "core off, % of t": lambda r: r.scene.rpartition("-e")[2].removeprefix("0"),
        "mesh": lambda r: level_label(r.level),
    }
    columns = [
        Column("tip, mm", "tip_mm", ".3f"),
        Column("change, %", "tip_mm", "+.3f", number="error_percent"),
        Column("bend, degree", "tip_bend_deg", ".3f"),
        Column("sideways, mm", "tip_sideways_mm", ".3f"),
        Column("unstable modes", "unstable_modes", ".0f"),
    ]
    return pivot(rows, lines, columns)


def summary(bodies: Sequence[Body]) -> str:
    """What the most eccentric core does at the highest pressure, and observed orders between 5 and 10 %."""
    centred, small, large = bodies[: len(SHARES)]
    reached = [p for p in large.poses if p in small.poses and p in centred.poses]
    if not reached:
        return "no pressure was reached by all."
    highest = max(reached)
    bends = [math.log2(large.value("tip_bend_deg", p) / small.value("tip_bend_deg", p)) for p in reached]
    changes = [math.log2(large.longer_mm(centred, p) / small.longer_mm(centred, p)) for p in reached]
    percent = 100.0 * large.longer_mm(centred, highest) / centred.value("tip_mm", highest)
    return (
        f"at {highest:g} kPa a core off by {100.0 * large.share:g} % of the wall ({core_shift_mm(large.scene):g} mm) "
        f"bends the tip by {abs(large.value('tip_bend_deg', highest)):.1f} degrees, moves it sideways by "
        f"{abs(large.value('tip_sideways_mm', highest)):.1f} mm and changes the elongation by {percent:+.2f} %. "
        f"From 5 to 10 % the bend grows with order {min(bends):.3f} to {max(bends):.3f} of the eccentricity, the "
        f"change of the elongation with order {min(changes):.2f} to {max(changes):.2f} (1 and 2 expected of a small "
        "one)."
    )


def page(solved: Sequence[Solved[Actuator, list[Body]]], at: Setting) -> Page:
    """A section and a picture of the shapes per actuator, and one picture of all bends."""
    rows, sections, pictures = [], [], []
    for actuator, bodies in ((done.case, done.result) for done in solved):
        found, name = rows_of(actuator, bodies), f"pictures/bent-{actuator.name}.png"
        rows += found
        pictures += [name] if draw_shapes(at.out / name, bodies) else []
        words = {"name": actuator.name, "title": bodies[0].scene.title, "summary": summary(bodies)}
        sections.append({**words, "table": state_table(found)})
    draw_bends(at.out / "pictures" / "bend.png", [(done.case, done.result) for done in solved])
    runs = [body.run.summary for done in solved for body in done.result]
    seconds = duration(sum(run.time_s["total"] for run in runs))
    stopped = [f"{run.scene}, {run.level}: {run.reason}" for run in runs if run.reason]
    return Page(rows, {"sections": sections, "pictures": pictures, "seconds": seconds}, stopped)


STUDY: Final = Study(
    name="imperfection",
    title="An eccentric core: how far the actuator bends and what it does to the elongation",
    question="How far does an actuator bend whose moulding core sat off the axis, and what does its elongation lose?",
    template="imperfection/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="all",
    options=(click.Option(["--short"], is_flag=True, help="Only the short actuator."),),
)
