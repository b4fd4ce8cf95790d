"""The report of the study of large bodies: tables, plot, where the solvers cross, and what more ranks would give."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from studies.large.cell import LargeCell
from studies.report.numbers import MISSING
from studies.report.pages import write_page
from studies.report.panels import Panel, Series, draw_panels
from studies.report.style import BLUE, INSIDE, VERMILION
from studies.report.tables import Table, facts_table
from studies.results import provenance

TITLE: Final = "Large bodies: direct and iterative linear algebra"
COLOURS: Final = {"direct": BLUE, "iterative": VERMILION}
RANKS: Final = (1, 2, 8, 64)
# Seconds on one rank with two BLAS threads and on two ranks, `make benchmark-solver NP=1` and `NP=2`, which
# docs/decisions.md records: what is known of the direct solver where a run of this study has not measured it.
# Flops of the factorisation grow with this power of the unknowns: 4.3e10 on 133,617 and 1.8e11 with twice as many cells
# round (docs/decisions.md). Small bodies do not show it yet: their time is in smaller parts.
FLOPS_EXPONENT: Final = math.log(1.8e11 / 4.3e10) / math.log(2.0)
BENCHMARK_UNKNOWNS: Final = 154_805
BENCHMARK: Final = {"tangent": (1.67, 0.99), "set-up": (1.86, 1.47)}


def render_large(folder: Path, cells: Sequence[LargeCell], untried: Sequence[str], ranks: int) -> Path:
    """Write the report of measured points; returns the path of report.html."""
    done = [c for c in cells if not c.failure]
    mine = [c for c in done if c.ranks == ranks]
    picture = Path("pictures", "large.png")
    draw(folder / picture, mine)
    stamps = {
        "commit": provenance.commit(),
        "date": provenance.now(),
        "machine": provenance.machine(),
        **provenance.versions(),
    }
    fits = {
        (m, n): power_law([c for c in mine if c.method == m], n)
        for m in COLOURS
        for n in ("iteration_cpu_s", "peak_mb")
    }
    content = {
        "title": TITLE,
        "points": points_table(cells),
        "picture": str(picture),
        "untried": list(untried),
        "crossings": [
            crossing_text("CPU time", fits["direct", "iteration_cpu_s"], fits["iterative", "iteration_cpu_s"]),
            crossing_text(
                f"CPU time, if the direct one grows from its largest point as its flops do, N^{FLOPS_EXPONENT:.1f}",
                flops_bound(mine),
                fits["iterative", "iteration_cpu_s"],
            ),
            crossing_text("memory", fits["direct", "peak_mb"], fits["iterative", "peak_mb"]),
        ],
        "fits": fits_table(fits),
        "ranks": ranks,
        "scaling": scaling_table(done),
        "provenance": facts_table(stamps),
    }
    return write_page(folder, "large.md.j2", content)


def points_table(cells: Sequence[LargeCell]) -> Table:
    """A line per point."""
    lines: list[tuple[str, ...]] = []
    for c in sorted(cells, key=lambda c: (c.unknowns, c.method, c.ranks)):
        if c.failure:
            lines.append((f"{c.unknowns}", c.method, str(c.ranks), *(MISSING,) * 5, str(c.iterations), c.failure))
            continue
        numbers = (c.setup_cpu_s, c.solve_cpu_s, c.iteration_cpu_s, c.iteration_s)
        note = "" if c.modes < 0 else f"unstable modes: {c.modes}"
        lines.append(
            (f"{c.unknowns}", c.method, str(c.ranks), *(f"{value:.2f}" for value in numbers), f"{c.peak_mb:.0f}",
             str(c.iterations) if c.iterations else MISSING, note)
        )  # fmt: skip
    times = ("set-up, CPU s", "solve, CPU s", "both, CPU s", "both, wall s")
    header = ("unknowns", "solver", "ranks", *times, "memory, MB", "iterations", "note")
    return Table(header, tuple(lines), left=(1, 9))


def power_law(cells: Sequence[LargeCell], name: str) -> tuple[float, float] | None:
    """Intercept and exponent of ``ln y = a + b ln N``, least squares; None from fewer than two sizes."""
    if len({c.unknowns for c in cells}) < 2:
        return None
    x, y = (np.log([float(getattr(c, n)) for c in cells]) for n in ("unknowns", name))
    slope, start = np.polyfit(x, y, 1)
    return float(start), float(slope)


def crossing(direct: tuple[float, float] | None, iterative: tuple[float, float] | None) -> float:
    """Unknowns at which two power laws meet; NaN if they do not for growing size."""
    if direct is None or iterative is None or direct[1] <= iterative[1]:
        return math.nan
    return math.exp((iterative[0] - direct[0]) / (direct[1] - iterative[1]))


def flops_bound(cells: Sequence[LargeCell]) -> tuple[float, float] | None:
    """The largest direct point's CPU time, growing as the flops do; None without a direct point."""
    direct = [c for c in cells if c.method == "direct"]
    if not direct:
        return None
    largest = max(direct, key=lambda c: c.unknowns)
    return math.log(largest.iteration_cpu_s) - FLOPS_EXPONENT * math.log(largest.unknowns), FLOPS_EXPONENT


def crossing_text(what: str, direct: tuple[float, float] | None, iterative: tuple[float, float] | None) -> str:
    """Where the solvers cross, in words."""
    at = crossing(direct, iterative)
    if math.isnan(at):
        return f"{what}: the fits do not cross"
    return f"{what}: the fits cross at about {float(f'{at:.1g}'):,.0f} unknowns"


def fits_table(fits: dict[tuple[str, str], tuple[float, float] | None]) -> Table:
    """Exponents of the power laws through the measured points."""
    names = {"iteration_cpu_s": "set-up and solve, CPU s", "peak_mb": "memory, MB"}
    lines = []
    for (method, name), fit in fits.items():
        if fit is not None:
            lines.append((method, names[name], f"{fit[1]:.2f}"))
    return Table(("solver", "quantity", "exponent"), tuple(lines), left=(0, 1))


def amdahl(one_s: float, two_s: float, ranks: int) -> float:
    """Seconds on so many ranks if what two did not halve is serial: ``t1 (s + (1 - s)/n)``, ``s = 2 t2/t1 - 1``."""
    serial = min(max(2.0 * two_s / one_s - 1.0, 0.0), 1.0)
    return one_s * (serial + (1.0 - serial) / ranks)


def scaling_table(cells: Sequence[LargeCell]) -> Table:
    """The bodies that were measured on one rank and on two: their parts, and the estimate for more."""
    lines: list[tuple[str, ...]] = []
    for part, (one_s, two_s) in BENCHMARK.items():
        estimates = (amdahl(one_s, two_s, ranks) for ranks in RANKS[2:])
        numbers = (f"{value:.2f}" for value in (one_s, two_s, *estimates))
        lines.append((f"{BENCHMARK_UNKNOWNS}", "direct (make benchmark-solver)", part, *numbers))
    for method in COLOURS:
        mine = {(c.unknowns, c.ranks): c for c in cells if c.method == method}
        for unknowns in sorted({n for n, ranks in mine if ranks == 1 and (n, 2) in mine}):
            one, two = mine[unknowns, 1], mine[unknowns, 2]
            for name, label in (("tangent_s", "tangent"), ("setup_s", "set-up"), ("solve_s", "solve")):
                a, b = float(getattr(one, name)), float(getattr(two, name))
                times = [a, b, *(amdahl(a, b, ranks) for ranks in RANKS[2:])]
                lines.append((f"{unknowns}", method, label, *(f"{value:.2f}" for value in times)))
    header = ("unknowns", "solver", "part", *(f"{n} {'rank' if n == 1 else 'ranks'}, s" for n in RANKS))
    return Table(header, tuple(lines), left=(1, 2))


def draw(path: Path, cells: Sequence[LargeCell]) -> None:
    """Time and memory over unknowns, both logarithmic."""
    quantities = {"iteration_cpu_s": "set-up and one solve, CPU s", "peak_mb": "peak memory, MB"}
    panels: list[Panel] = []
    for name, label in quantities.items():
        series = []
        for method, colour in COLOURS.items():
            mine = sorted((c for c in cells if c.method == method), key=lambda c: c.unknowns)
            values = [float(getattr(c, name)) for c in mine]
            text = "" if panels else method  # one legend says it for both
            series.append(Series([c.unknowns for c in mine], values, {"color": colour, "marker": "o"}, text))
        panels.append(Panel(series, "unknowns", label, logarithmic="xy"))
    draw_panels(path, [panels], (8.6, 4.0), INSIDE)
