"""The stress test: every cell is solved once, and none may be a wrong answer."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Final

import threadpoolctl
from mpi4py import MPI

from studies.engine import ROWS_FILE, Bar, Page, Setting, Solved, Study, farm
from studies.first_rank import first
from studies.report.numbers import duration
from studies.results import provenance
from studies.results.kept import content_key, kept
from studies.stability.cases import AXES, CONTROL, cases
from studies.stability.cells import Cell
from studies.stability.judge import PRESSURE_TOLERANCE_PERCENT, SAME_PERCENT, TOLERANCE_PERCENT, Outcome
from studies.stability.plots import draw_map
from studies.stability.references import Reference, Series, series_for, series_of, solve_reference
from studies.stability.run import Job, run_cell, run_in_child
from studies.stability.tables import (
    Ended,
    controls_table,
    counts_table,
    generated,
    of_axis,
    of_verdict,
    others_table,
    rows_of,
    square,
    unstable_lines,
)

# What is demanded of the study.
LEAST_CELLS, LEAST_VALUES, LEAST_RIGHT, LEAST_SHARE = 200, 5, 0.70, 0.80
# What decides outcomes beside the code that `provenance.code_hash` knows.
SOURCES: Final = [
    Path(__file__).with_name(f"{name}.py")
    for name in ("bodies", "controls", "exact", "judge", "meshes", "paths", "references", "run")
]


# --- what is kept -------------------------------------------------------------------------------------------


def key_of(thing: Cell | Series) -> str:
    """Key of the outcome of a cell, wherever it stands in maps, or of a reference."""
    placeless = replace(thing, axis="", row="", column="") if isinstance(thing, Cell) else thing
    return content_key(repr(placeless), provenance.code_hash(), sources=SOURCES)


def kept_reference(series: Series, out: Path) -> Reference:
    """A reference, from its file or by solving it on this process."""
    key = key_of(series)
    return kept(out / "references" / f"{key}.json", key, Reference, lambda: solve_reference(series))


def job_of(cell: Cell, every: Sequence[Series], out: Path, alone_mm: float = math.nan) -> Job:
    """A cell with its reference among all, and the place of its outcome."""
    series, key = series_for(cell, every), key_of(cell)
    reference = kept_reference(series, out) if series else None
    return Job(cell, reference, alone_mm, (out / "cells" / f"{key}.json").absolute(), key)


def solve(every: Sequence[Series], cell: Cell, at: Setting) -> Outcome:
    """A cell's outcome, from its file or by solving it on this process."""
    job = job_of(cell, every, at.out)

    def solved() -> Outcome:
        at.progress.begin(cell.name, 1e-3 * abs(cell.load_kpa))
        outcome = run_cell(cell, MPI.COMM_SELF, job.reference)
        at.progress.end(f"{cell.name}: {outcome.verdict}")
        return outcome

    with threadpoolctl.threadpool_limits(1):
        return kept(job.file, job.key, Outcome, solved)


def prepare(every: Sequence[Series], cells: Sequence[Cell], at: Setting) -> list[str]:
    """References, and the cells on other numbers of ranks and threads than one of each."""
    what = f"{len(every)} bellows on three meshes each"
    at.progress.begin(what, math.inf)
    with threadpoolctl.threadpool_limits(1):
        farm(every, at.comm, lambda series: kept_reference(series, at.out))
    at.progress.end(f"{what}: done")
    first(at.comm, lambda: _solve_shared(every, [c for c in cells if (c.ranks, c.threads) != (1, 1)], at))
    return []


def _solve_shared(every: Sequence[Series], shared: Sequence[Cell], at: Setting) -> None:
    """Solve cells of several ranks or threads in children, each beside the same on one rank and thread."""
    for ranks, threads in sorted({(cell.ranks, cell.threads) for cell in shared}):
        jobs = []
        for cell in shared:
            if (cell.ranks, cell.threads) == (ranks, threads):
                alone = solve(every, replace(cell, ranks=1, threads=1), at)
                jobs.append(job_of(cell, every, at.out, alone.value_mm))
        run_in_child(jobs, ranks, threads, at.out.absolute())


# --- what is shown ------------------------------------------------------------------------------------------


def bars_of(product: Sequence[Ended], pairs: Sequence[tuple[Ended, Ended]]) -> list[Bar]:
    """What is demanded of cells, and of controls beside their counterparts without a flaw."""
    count, wrong, right = len(product), len(of_verdict("wrong", product)), len(of_verdict("right", product))
    stops = of_verdict("stop", product)
    early = [one.result for one in stops if not one.result.share >= LEAST_SHARE]
    unnamed = [outcome for outcome in early if not (outcome.cause and outcome.reason)]
    maps = {axis.name: of_axis(axis, product) for axis in AXES}
    few = [name for name, of in maps.items() if of and len({one.case.column for one in of}) < LEAST_VALUES]
    failing = [a for a, b in pairs if a.result.verdict != "right" and b.result.verdict == "right"]
    return [
        Bar(f"at least {LEAST_CELLS} cells", f"{count}", count >= LEAST_CELLS),
        Bar(f"at least {LEAST_VALUES} values per axis", ", ".join(few) or "yes", not few),
        Bar("no wrong answer", f"{wrong} wrong", wrong == 0),
        Bar(
            f"at least {100 * LEAST_RIGHT:g} % right answers",
            f"{right} of {count} ({100 * right / max(count, 1):.1f} %)",
            right >= LEAST_RIGHT * count,
        ),
        Bar(
            f"stops at {100 * LEAST_SHARE:g} % or more of the load that is reachable, or their cause shown",
            f"{len(stops)} stops, {len(early)} earlier, {len(early) - len(unnamed)} of these with cause and reason",
            not unnamed,
        ),
        Bar(
            "controls fail where the solver is right",
            f"{len(failing)} of {len(pairs)}",
            len(failing) == len(pairs),
        ),
    ]


def page(solved: Sequence[Solved[Cell, Outcome]], at: Setting) -> Page:
    """A map per axis with what is not a right answer, and the controls."""
    product = [one for one in solved if one.case.axis != CONTROL]
    controls = [one for one in solved if one.case.axis == CONTROL]
    pairs = list(zip(controls[::2], controls[1::2], strict=True))
    axes = [axis for axis in AXES if of_axis(axis, product)]
    sections = []
    for axis in axes:
        of, picture = of_axis(axis, product), f"pictures/{axis.name}.png"
        draw_map(at.out / picture, axis, [square(one) for one in of])
        sections.append({"axis": axis, "picture": picture, "others": others_table(of), "unstable": unstable_lines(of)})
    content = {
        "counts": counts_table(axes, product),
        "sections": sections,
        "controls": controls_table(pairs),
        "tolerance": f"{TOLERANCE_PERCENT:g}",
        "pressure_tolerance": f"{PRESSURE_TOLERANCE_PERCENT:g}",
        "same": f"{SAME_PERCENT:g}",
        "seconds": duration(sum(one.result.seconds for one in solved)),
        "generated": generated(at.out.with_name("fuzz") / ROWS_FILE),
    }
    return Page([row for one in solved for row in rows_of(one)], content, bars=bars_of(product, pairs))


def stress_test(cells: Sequence[Cell]) -> Study[Cell, Outcome]:
    """The study of cells; each control is followed by its counterpart without a flaw."""
    every = series_of(cells)
    return Study(
        name="stability",
        title="Stress test: where the solver holds, refuses and stops",
        question="Where does the solver hold, refuse and stop, and is it ever wrong?",
        template="stability/page.md.j2",
        cases=lambda options: cells,
        solve=partial(solve, every),
        page=page,
        prepare=partial(prepare, every),
    )


STUDY: Final = stress_test(cases())
