"""What a command takes before it computes anything: CPU seconds of new processes, the least of several.

CPU time, so that other work on the machine counts as little as it can; a process that has nothing to wait for takes as
long by the clock of an idle machine.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from solvers.errors import SolverError
from studies import mpi_children
from studies.engine import Bar, Page, Setting, Solved, Study
from studies.report.tables import table_of
from studies.results import provenance
from studies.results.rows import row

TIMES: Final = 5
LIMIT_S: Final = 300.0
SCENE: Final = str(provenance.ROOT / "scenes" / "smoke-t2-ri5.toml")


@dataclass(frozen=True)
class Start:
    """What a new Python does, and the most that it may take, CPU seconds; None is not judged."""

    name: str
    arguments: tuple[str, ...]
    most_s: float | None


STARTS: Final = (
    Start("python", ("-c", "pass"), None),
    Start("plan", ("-m", "studies", "plan", SCENE), 0.45),
    Start("imports of solve", ("-c", "import studies.__main__, studies.command.solve_output"), 0.6),
)


def cases(options: Mapping[str, Any]) -> Sequence[Start]:
    """All of them."""
    return STARTS


def solve(start: Start, at: Setting) -> float:
    """The least CPU time of `TIMES` processes, s.

    Raises
    ------
    SolverError
        If one fails.
    """
    taken = []
    for _ in range(TIMES):
        ended = mpi_children.run(mpi_children.on_ranks(1, *start.arguments), mpi_children.environment(), LIMIT_S)
        if ended.code:
            raise SolverError(f"exit code {ended.code}: {ended.last_line}")
        taken.append(ended.cpu_s)
    return min(taken)


def page(solved: Sequence[Solved[Start, float]], at: Setting) -> Page:
    """A line for each, and whether it is quick enough."""
    rows = [row(done.case.name, "cpu", "s", math.nan, "", done.result) for done in solved]
    bars = [
        Bar(
            f"{done.case.name}: {limit:g} s of CPU at most", f"{done.result:.2f} s", done.result <= limit, decides=False
        )
        for done in solved
        if (limit := done.case.most_s) is not None
    ]
    columns = {"what": lambda r: r.scene, "CPU, s": lambda r: f"{r.value:.2f}"}
    return Page(rows, {"times": TIMES, "numbers": table_of(rows, columns, (0,))}, bars=bars)


STUDY: Final = Study(
    name="benchmark-start",
    title="What a command takes before it computes",
    question="How long does a plan take, and how long until a solve has begun?",
    template="cost/start_benchmark.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    share="first",
)
