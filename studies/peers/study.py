"""Other codes on the same problem in the same run: tip and error, wall time, memory and lines of each, beside ours.

Every script of `studies.peers` runs on meshes that this program makes, and this program on the same scene, with
compiled forms in dolfinx's cache. A code that is missing is skipped with a line.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import click
from mpi4py import MPI

from studies import mpi_children
from studies.engine import Page, Setting, Solved, Study
from studies.models.axisymmetric import run_axisymmetric
from studies.peers import environment
from studies.peers.cases import OURS, PEERS, Attempt, attempts, peer_scene
from studies.peers.measure import Measurement, kept_measurement, measure
from studies.peers.rows import Runs, comparison_rows
from studies.progress import Progress
from studies.report.numbers import number_text
from studies.report.tables import Table, table_of
from studies.results.rows import ON_QUARTERS, TIME_RATIO, Row
from studies.scene.bellows import BellowsScene

REFERENCE_LEVELS: Final = (8, 16)


def skipped(options: Mapping[str, Any]) -> dict[str, str]:
    """Codes that were chosen and are not here, and why."""
    codes = options["code"] or (*PEERS, OURS)
    return {code: why for code in codes if (why := environment.missing(code))}


def cases(options: Mapping[str, Any]) -> list[Attempt]:
    """Runs of the chosen codes and dimensions, of those codes that are here."""
    gone = skipped(options)
    for code, why in gone.items():
        click.echo(f"{code}: skipped: {why}")
    codes, dimensions = options["code"] or (*PEERS, OURS), options["dimension"] or ("2", "3")
    here = [a for a in attempts(options["levels"]) if a.code in codes and a.code not in gone]
    return [a for a in here if str(a.dimension) in dimensions]


def solve(attempt: Attempt, at: Setting) -> str:
    """Make a measurement if it is missing, or was stopped earlier than is now allowed; says why there is none."""
    limit: float = at.options["limit"]
    found = kept_measurement(attempt, at.out)
    if found is None or (found.timed_out and found.wall_s < limit):
        if why := reason_not_to(attempt, at):
            click.echo(why)
            return why if found is None else ""
        found = measure(attempt, at.out, limit)
    click.echo(f"{attempt.name}: {found.tip_mm:.4f} mm, {found.wall_s:.1f} s {found.reason}")
    return ""


def reason_not_to(attempt: Attempt, at: Setting) -> str:
    """Why a run is not made; empty if it is."""
    if time.monotonic() > at.options["budget"]:
        return f"{attempt.name}: not run, the time is over: go on with the same command"
    coarser = [a for a in attempts() if a.family == attempt.family and a.size < attempt.size]
    if any(found.timed_out for a in coarser if (found := kept_measurement(a, at.out)) is not None):
        return f"{attempt.name}: not run, a coarser mesh was stopped at the limit"
    return ""


def reference_tip(scene: BellowsScene, out: Path) -> tuple[float, float]:
    """The tip on the finest meridian of quadrilaterals, mm, and how much it differs from the one before, percent.

    Not of triangles: their steps to r4 and to r8, 0.004 and 0.007 %, grow: the last tells nothing of what is
    left (docs/decisions.md, "Cost and peers").
    """
    tips, blocks = [], scene.model_copy(update={"mesh": scene.mesh.model_copy(update={"element": "hex"})})
    for level in REFERENCE_LEVELS:
        run = run_axisymmetric(blocks, level, out / f"reference-r{level}", MPI.COMM_SELF, Progress(MPI.COMM_SELF))
        tips.append([state.tip_mm for state in run.path if state.status == "requested"][-1])
    return tips[-1], 100.0 * abs(tips[-1] / tips[-2] - 1.0)


def measured_table(measured: Runs, reference_mm: float) -> Table:
    """All runs, the quickest of each code first."""
    columns: Mapping[str, Callable[[tuple[Attempt, Measurement]], str]] = {
        "code": lambda run: run[0].code,
        "run": lambda run: run[0].label,
        "tip, mm": lambda run: f"{run[1].tip_mm:.4f}",
        "error, %": lambda run: f"{100.0 * (run[1].tip_mm / reference_mm - 1.0):.3f}",
        "wall, s": lambda run: f"{run[1].wall_s:.1f}",
        "CPU, s": lambda run: f"{run[1].cpu_s:.1f}",
        "memory, MB": lambda run: f"{run[1].peak_mb:.0f}",
        "unknowns": lambda run: str(run[1].unknowns),
        "lines": lambda run: str(run[1].lines),
        "stopped": lambda run: run[1].reason,
    }
    ordered = sorted(measured, key=lambda run: (run[0].dimension, run[0].code, run[1].wall_s))
    return table_of(ordered, columns, (0, 1, len(columns) - 1))


def ratios_table(rows: Sequence[Row]) -> Table:
    """Our times over the peers', and over those that their users can have on a quarter of the body."""
    ratios = {r.quantity: r for r in rows if r.quantity.startswith(TIME_RATIO)}

    def ratio(r: Row) -> str:
        at = f" at {r.level}" if r.level and math.isfinite(r.value) else ""
        return number_text(r.value, ".3g") + at

    columns: Mapping[str, Callable[[Row], str]] = {
        "ratio of wall times": lambda r: r.quantity.removeprefix(TIME_RATIO).replace("_", " "),
        "ours over theirs": ratio,
        "theirs on a quarter too": lambda r: ratio(cut) if (cut := ratios.get(r.quantity + ON_QUARTERS)) else "",
    }
    return table_of([r for name, r in ratios.items() if not name.endswith(ON_QUARTERS)], columns, (0,))


def page(solved: Sequence[Solved[Attempt, str]], at: Setting) -> Page:
    """All that has been measured, whatever was chosen now."""
    scene = peer_scene()
    reference, spread = reference_tip(scene, at.out)
    measured = [(a, found) for a in attempts() if (found := kept_measurement(a, at.out)) is not None]
    source = f"axisymmetric r{REFERENCE_LEVELS[-1]}, quadrilaterals, meshed rings"
    rows = comparison_rows(scene.name, scene.load.pressure_kpa[-1], reference, source, measured)
    content = {
        "reference": f"{reference:.5f} mm ({source}), {spread:.4f} % from the mesh before",
        "measured": measured_table(measured, reference),
        "ratios": ratios_table(rows),
        "absent": [
            *(f"{code}: skipped: {why}" for code, why in skipped(at.options).items()),
            *(done.result for done in solved if done.result),
        ],
    }
    return Page(rows, content)


STUDY: Final = Study(
    name="peers",
    title="The same bellows in other codes",
    question="What do other codes find, and take, for the same bellows on the same meshes in the same run?",
    template="peers/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="first",
    options=(
        click.Option(["--code"], multiple=True, type=click.Choice([*PEERS, OURS]), help="Only these; default all."),
        click.Option(["--dimension"], multiple=True, type=click.Choice(["2", "3"]), help="Only these."),
        click.Option(["--limit"], default=1200.0, show_default=True, help="Time limit of a run, s."),
        click.Option(["--levels"], default=3, show_default=True, help="Meshes of each kind, coarsest first."),
        click.Option(
            ["--budget"],
            default=math.inf,
            callback=mpi_children.until(1.0),
            help="Start no new run after so many seconds; what is kept is still shown.",
        ),
    ),
)
