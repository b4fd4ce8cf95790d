"""One way to run a study: its cases are solved or taken from what is kept, their rows written, its page rendered.

A study is an object of data and three functions: which cases there are, how a case is solved, and what its page shows
(`Study`). Sharing cases out over ranks, going on after an interruption, progress, faults, rows.csv, report.md and
report.html, provenance, bars and the exit code are here, for all of them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Generic, Literal, Protocol, TypeVar

import click
from mpi4py import MPI

from analytical.bellows.dimensions import BellowsError
from meshes.errors import GeometryError, MeshError
from solvers.errors import SolverError
from studies.first_rank import first
from studies.progress import Progress
from studies.report.numbers import duration
from studies.report.pages import write_page
from studies.report.tables import Table
from studies.results import provenance
from studies.results.rows import Row, write_rows

REACHED, STOPPED = 0, 3
FAULTS = (GeometryError, MeshError, SolverError, BellowsError)
ROWS_FILE = "rows.csv"


class Named(Protocol):
    """Whatever has a name."""

    @property
    def name(self) -> str:
        """For messages, and mostly the folder of what is kept."""


CaseT = TypeVar("CaseT", bound=Named)
ResultT = TypeVar("ResultT")
Item = TypeVar("Item")
Done = TypeVar("Done")


@dataclass(frozen=True)
class Setting:
    """Where and with what a study runs.

    Attributes
    ----------
    out
        The study's folder.
    comm
        Ranks that solve a case; those of the whole study in `Study.prepare`.
    progress
        Shows what goes on.
    options
        Values of the study's own options, by name.
    """

    out: Path
    comm: MPI.Comm
    progress: Progress
    options: Mapping[str, Any]


@dataclass(frozen=True)
class Solved(Generic[CaseT, ResultT]):
    """A case and what came out."""

    case: CaseT
    result: ResultT


@dataclass(frozen=True)
class Bar:
    """What a study must show.

    Attributes
    ----------
    wanted, found
        In words.
    met
        Whether that is enough; None if nothing of it has been run.
    decides
        True if the exit code is 3 where it is not met; False only informs.
    """

    wanted: str
    found: str
    met: bool | None
    decides: bool = True

    @property
    def missed(self) -> bool:
        """True if the exit code has to be 3 for it."""
        return self.decides and self.met is False

    @property
    def verdict(self) -> str:
        """Whether it is met, in words."""
        if self.met is None:
            return "not run"
        return "met" if self.met else "NOT MET" if self.decides else "not met"


@dataclass(frozen=True)
class Page:
    """What a study shows.

    Attributes
    ----------
    rows
        All its numbers, for rows.csv.
    content
        What its template shows, by name.
    stopped
        What did not reach its loads and why, a sentence each; the exit code is then 3.
    bars
        What it must show; the exit code is 3 if one that decides it is not met.
    tables
        Other files of rows by name, such as crossings.csv.
    headlines
        What the terminal is told, a line each.
    """

    rows: Sequence[Row]
    content: Mapping[str, Any]
    stopped: Sequence[str] = ()
    bars: Sequence[Bar] = ()
    tables: Mapping[str, Sequence[Row]] = field(default_factory=dict)
    headlines: Sequence[str] = ()


@dataclass(frozen=True)
class Study(Generic[CaseT, ResultT]):
    """A study.

    Attributes
    ----------
    name
        What the command line calls it.
    title
        Heading of its page.
    question
        What it asks, a sentence: under the heading, and in the list of studies.
    template
        Its page below ``studies``, such as ``vacuum/page.md.j2``; it extends ``study.md.j2``.
    cases
        All cases for the values of its options; names are unique. Raises SceneError before anything is written.
    solve
        What comes out of a case, taken from what is kept below `Setting.out` where that is of the same content.
    page
        What is shown of the solved cases; called on rank 0, draws the pictures into ``pictures`` of `Setting.out`.
    share
        Who solves a case: ``each`` rank its own, ``all`` ranks together one after the other, or the ``first`` alone,
        where a case starts processes of its own.
    options
        The study's own options and arguments.
    prepare
        What all ranks do together before the cases; returns faults.
    """

    name: str
    title: str
    question: str
    template: str
    cases: Callable[[Mapping[str, Any]], Sequence[CaseT]]
    solve: Callable[[CaseT, Setting], ResultT]
    page: Callable[[Sequence[Solved[CaseT, ResultT]], Setting], Page]
    share: Literal["each", "all", "first"] = "each"
    options: tuple[click.Parameter, ...] = ()
    prepare: Callable[[Sequence[CaseT], Setting], Sequence[str]] | None = None


def run(study: Study[CaseT, ResultT], out: Path, comm: MPI.Comm, options: Mapping[str, Any]) -> int:
    """Solve what is missing of a study and write its rows and its page; every rank calls.

    Parameters
    ----------
    out
        Where to; made if missing.
    options
        Values of the study's options.

    Returns
    -------
    int
        Exit code: 0, or 3 if a case failed or stopped early or a bar is not met.

    Raises
    ------
    SceneError
        On every rank if a case cannot be had; nothing has been written.
    OSError
        If a file cannot be written.
    """
    begin = time.perf_counter()
    cases = study.cases(options)
    if comm.rank == 0:
        (out / "pictures").mkdir(parents=True, exist_ok=True)
    comm.barrier()
    setting = Setting(out, comm, Progress(comm), options)
    faults = list(study.prepare(cases, setting)) if study.prepare else []
    solved, more = solve_cases(study, cases, setting)
    code = first(comm, lambda: _write(study, solved, [*faults, *more], setting, begin))
    return code


def render(study: Study[CaseT, ResultT], out: Path, solved: Sequence[Solved[CaseT, ResultT]] = ()) -> int:
    """Write rows and page anew without solving; one rank calls.

    Parameters
    ----------
    solved
        What has been solved before; nothing for a study whose page reads its folder.

    Returns
    -------
    int
        Exit code, as of `run`.
    """
    (out / "pictures").mkdir(parents=True, exist_ok=True)
    setting = Setting(out, MPI.COMM_SELF, Progress(MPI.COMM_SELF), {})
    return _write(study, solved, (), setting, time.perf_counter())


def solve_cases(
    study: Study[CaseT, ResultT], cases: Sequence[CaseT], setting: Setting
) -> tuple[list[Solved[CaseT, ResultT]], list[str]]:
    """Solve all cases; what came out, in their order, on every rank, and which failed and why."""
    of_case = setting.comm if study.share == "all" else MPI.COMM_SELF
    inner = Setting(setting.out, of_case, setting.progress, setting.options)

    place = {case.name: k for k, case in enumerate(cases, 1)}

    def attempt(case: CaseT) -> Solved[CaseT, ResultT] | str:
        setting.progress.case(place[case.name], len(cases), case.name)
        try:
            return Solved(case, study.solve(case, inner))
        except FAULTS as error:
            return f"{case.name}: {error}"

    if study.share == "each":
        found = farm(cases, setting.comm, attempt)
    elif study.share == "all":
        found = [attempt(case) for case in cases]
    else:
        found = first(setting.comm, lambda: [attempt(case) for case in cases])
    return [f for f in found if isinstance(f, Solved)], [f for f in found if isinstance(f, str)]


def farm(items: Sequence[Item], comm: MPI.Comm, work: Callable[[Item], Done]) -> list[Done]:
    """Share items out over ranks, one rank each; what came out, in their order, on every rank."""
    if comm.size == 1:
        return [work(item) for item in items]
    mine = {k: work(items[k]) for k in range(comm.rank, len(items), comm.size)}
    every = {k: done for part in comm.allgather(mine) for k, done in part.items()}
    return [every[k] for k in range(len(items))]


def _write(
    study: Study[CaseT, ResultT],
    solved: Sequence[Solved[CaseT, ResultT]],
    faults: Sequence[str],
    setting: Setting,
    begin: float,
) -> int:
    """Rows, page, and what the terminal is told; returns the exit code."""
    page = study.page(solved, setting)
    stopped = [*faults, *page.stopped]
    missed = [bar for bar in page.bars if bar.missed]
    for name, rows in {ROWS_FILE: page.rows, **page.tables}.items():
        write_rows(setting.out / name, rows)
    facts: dict[str, Any] = {
        "title": study.title,
        "question": study.question,
        "stopped": stopped,
        "bars": bars_table(page.bars),
        "wall": duration(time.perf_counter() - begin),
        "provenance": stamp_table(setting.comm),
    }
    report = write_page(setting.out, study.template, {**facts, **page.content})
    for line in [*stopped, *(f"not met: {bar.wanted}: {bar.found}" for bar in missed)]:
        click.echo(line, err=True)
    click.echo("\n".join([*page.headlines, f"report: {report}"]))
    return STOPPED if stopped or missed else REACHED


def bars_table(bars: Sequence[Bar]) -> Table:
    """What a study must show, a line each."""
    lines = tuple((bar.wanted, bar.found, bar.verdict) for bar in bars)
    return Table(("what it must show", "found", "verdict"), lines, left=(0, 1, 2))


def stamp_table(comm: MPI.Comm) -> Table:
    """Commit, code, date, machine, BLAS, ranks and versions."""
    facts = {
        "commit": provenance.commit(),
        "code that decides the numbers": provenance.code_hash(),
        "date": provenance.now(),
        "machine": provenance.machine(),
        "BLAS": provenance.blas(),
        "ranks": str(comm.size),
        **provenance.versions(),
    }
    return Table(("what", "value"), tuple(facts.items()), left=(0, 1))
