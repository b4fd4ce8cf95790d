"""The fuzz study: inputs drawn from a seed, each given to the command line; none may be wrong, crash or hang."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

import click

from studies.engine import Bar, Page, Setting, Solved, Study
from studies.fuzz.draws import KINDS, Draw, draws
from studies.fuzz.judge import VERDICTS, Outcome
from studies.fuzz.run import LIMIT_BYTES, LIMIT_S, Job, run_in_children
from studies.report.numbers import duration
from studies.report.tables import Table
from studies.results import provenance
from studies.results.kept import content_key
from studies.results.rows import REACHED, Row, row

Ended = Solved[Draw, Outcome]
FAILED: Final = ("wrong", "crash", "time out")
# What decides outcomes: all of the program but its studies, and how they are judged.
FOLDERS: Final = ("analytical", "meshes", "solvers")
ROOMS: Final = ("command", "fuzz", "models", "planning", "results", "scene")


@functools.cache
def code_key() -> str:
    """Key of the code that decides outcomes."""
    places = [*FOLDERS, *(f"studies/{room}" for room in ROOMS)]
    return content_key(sources=sorted(path for place in places for path in (provenance.ROOT / place).rglob("*.py")))


def job_of(draw: Draw, out: Path) -> Job:
    """A draw with the place of its outcome."""
    return Job(draw, (out / "outcomes" / f"{draw.name}.json").absolute(), content_key(draw, code_key()))


def prepare(cases: Sequence[Draw], at: Setting) -> list[str]:
    """Run what has no outcome yet: each rank its share, in children of its own."""
    mine = [job_of(draw, at.out) for draw in cases[at.comm.rank :: at.comm.size]]
    run_in_children(mine, at.out.absolute() / f"order-{at.comm.rank}.pickle", partial(_tell, at))
    at.comm.barrier()
    return []


def _tell(at: Setting, job: Job, outcome: Outcome) -> None:
    """Progress; what failed is written as files that can be run again."""
    at.progress.end(f"{job.draw.name} ({job.draw.kind}): {outcome.verdict}")
    if outcome.verdict in FAILED:
        folder = at.out / "failed" / job.draw.name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "input.toml").write_bytes(job.draw.text)
        if job.draw.mesh:
            (folder / "body.msh").write_bytes(job.draw.mesh)


def solve(draw: Draw, at: Setting) -> Outcome:
    """A draw's outcome, as `prepare` has kept it."""
    outcome = job_of(draw, at.out).outcome
    assert outcome is not None
    return outcome


# ---- what is shown -----------------------------------------------------------------------------------------


def of(ended: Sequence[Ended], verdict: str) -> list[Ended]:
    """Those that ended so."""
    return [one for one in ended if one.result.verdict == verdict]


def split_table(ended: Sequence[Ended]) -> Table:
    """Verdicts of each kind and of all, the largest error of a right answer, and what they took."""
    lines = []
    for name in (*KINDS, "all"):
        mine = [one for one in ended if name in (one.case.kind, "all")]
        counts = [str(len(of(mine, verdict))) for verdict in VERDICTS]
        seconds = sum(one.result.seconds for one in mine)
        lines.append((name, str(len(mine)), *counts, f"{seconds / max(len(mine), 1):.1f}"))
    return Table(("drawn of", "draws", *VERDICTS, "s each"), tuple(lines), left=(0,))


def confirmed_table(ended: Sequence[Ended]) -> Table:
    """What right answers were confirmed by, and the largest difference from it."""
    lines = []
    for by in dict.fromkeys(one.result.reason for one in of(ended, "right")):
        mine = [one for one in of(ended, "right") if one.result.reason == by]
        errors = [one.result.error_percent for one in mine if math.isfinite(one.result.error_percent)]
        lines.append((by, str(len(mine)), f"{max(errors):.2g}" if errors else "–"))
    return Table(("confirmed by", "answers", "largest difference, %"), tuple(lines), left=(0,))


def failures_table(ended: Sequence[Ended]) -> Table:
    """What is wrong, broke or took too long, a line each."""
    failed = [one for verdict in FAILED for one in of(ended, verdict)]
    lines = tuple((one.case.name, one.case.kind, one.result.verdict, one.result.reason) for one in failed)
    return Table(("draw", "drawn of", "verdict", "reason"), lines, left=(0, 1, 2, 3))


def row_of(one: Ended) -> Row:
    """A draw as a row: the difference from what confirms it, and its verdict as the status."""
    outcome = one.result
    status = REACHED if outcome.verdict == "right" else f"{outcome.verdict}: {outcome.reason}"
    model = one.case.model or one.case.command
    return row(
        f"fuzz-{one.case.kind}", "difference", "%", math.nan, model, outcome.error_percent, one.case.name, status=status
    )


def bars_of(ended: Sequence[Ended]) -> list[Bar]:
    """What is demanded: nothing wrong, nothing that breaks or hangs, and every class and kind drawn."""
    counts = {verdict: len(of(ended, verdict)) for verdict in VERDICTS}
    missing = [name for name in KINDS if not any(one.case.kind == name for one in ended)]
    return [
        *(
            Bar(f"no draw ends as: {verdict}", f"{counts[verdict]} of {len(ended)}", not counts[verdict])
            for verdict in FAILED
        ),
        Bar("every kind is drawn", ", ".join(missing) or "yes", not missing, decides=len(ended) >= 200),
        Bar(
            "right answers, refusals and stops",
            ", ".join(f"{counts[v]} {v}" for v in VERDICTS[:3]),
            all(counts[v] for v in VERDICTS[:3]),
            decides=len(ended) >= 200,
        ),
    ]


def page(solved: Sequence[Ended], at: Setting) -> Page:
    """The split over the classes, what confirms answers, and everything that failed."""
    content = {
        "seed": at.options["seed"],
        "number": len(solved),
        "split": split_table(solved),
        "confirmed": confirmed_table(solved),
        "failures": failures_table(solved),
        "seconds": duration(sum(one.result.seconds for one in solved)),
        "limit": f"{LIMIT_S:g} s",
        "memory": f"{LIMIT_BYTES / 2**30:g} GB",
    }
    counts = ", ".join(f"{len(of(solved, verdict))} {verdict}" for verdict in VERDICTS)
    return Page(
        [row_of(one) for one in solved], content, bars=bars_of(solved), headlines=[f"{len(solved)} draws: {counts}"]
    )


def cases(options: Mapping[str, Any]) -> list[Draw]:
    """The inputs of a seed."""
    return draws(options["draws"], options["seed"])


STUDY: Final = Study(
    name="fuzz",
    title="Generated inputs",
    question="What becomes of inputs nobody has thought of: drawn scenes, damaged files and meshes?",
    template="fuzz/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="first",
    prepare=prepare,
    options=(
        click.Option(
            ["--seed"], type=click.IntRange(0), default=1, show_default=True, help="Another seed, other inputs."
        ),
        click.Option(["--draws"], type=click.IntRange(1), default=1000, show_default=True, help="How many inputs."),
    ),
)
