"""Rows, tables and the plot of the study of large bodies."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Final

from studies.large.cases import METHODS, Point
from studies.large.fits import FLOPS_EXPONENT, PowerLaw, amdahl, crossing, flops_bound, power_law
from studies.large.measure import Measured
from studies.report.numbers import MISSING
from studies.report.panels import Panel, Series, draw_panels
from studies.report.style import BLUE, INSIDE, VERMILION
from studies.report.tables import Table, table_of
from studies.results.rows import REACHED, Row, row

COLOURS: Final = {"direct": BLUE, "iterative": VERMILION}
UNITS: Final = {"peak_mb": "MB"}
FITTED: Final = {"iteration_cpu_s": "set-up and solve, CPU s", "peak_mb": "memory, MB"}
PARTS: Final = {"tangent_s": "tangent", "setup_s": "set-up", "solve_s": "solve"}
RANKS: Final = (1, 2, 8, 64)
# Seconds on one rank with two BLAS threads and on two ranks, `make benchmark-solver NP=1` and `NP=2`, which
# docs/decisions.md records: what is known of the direct solver where a run of this study has not measured it.
BENCHMARK_UNKNOWNS: Final = 154_805
BENCHMARK: Final = {"tangent": (1.67, 0.99), "set-up": (1.86, 1.47)}


def rows_of(point: Point, found: Measured | str) -> list[Row]:
    """A row per number of a point, or one that says why there is none."""
    scene, level = (
        point.size.scene,
        f"n{point.size.around}r{point.size.refinement}, {point.method}, ranks: {point.ranks}",
    )
    if isinstance(found, str):
        return [row(scene, "setup_s", "s", math.nan, "full3d", math.nan, level, status=found)]
    status = f"failed: {found.failure}" if found.failure else REACHED
    numbers = {name: float(value) for name, value in asdict(found).items() if not isinstance(value, str)}
    return [
        row(scene, name, _unit(name), math.nan, "full3d", value, level, status=status)
        for name, value in numbers.items()
    ]


def _unit(name: str) -> str:
    return "s" if name.endswith("_s") else UNITS.get(name, "1")


def points_table(points: Sequence[Measured]) -> Table:
    """A line per point."""
    columns: dict[str, Callable[[Measured], str]] = {
        "unknowns": lambda p: f"{p.unknowns}",
        "solver": lambda p: p.method,
        "ranks": lambda p: f"{p.ranks}",
        "set-up, CPU s": lambda p: _measured(p, p.setup_cpu_s, ".2f"),
        "solve, CPU s": lambda p: _measured(p, p.solve_cpu_s, ".2f"),
        "both, CPU s": lambda p: _measured(p, p.iteration_cpu_s, ".2f"),
        "both, wall s": lambda p: _measured(p, p.iteration_s, ".2f"),
        "memory, MB": lambda p: _measured(p, p.peak_mb, ".0f"),
        "iterations": lambda p: f"{p.iterations}" if p.iterations or p.failure else MISSING,
        "note": lambda p: p.failure or ("" if p.modes < 0 else f"unstable modes: {p.modes}"),
    }
    return table_of(sorted(points, key=lambda p: (p.unknowns, p.method, p.ranks)), columns, left=(1, 9))


def _measured(point: Measured, value: float, form: str) -> str:
    return MISSING if point.failure else format(value, form)


def law_of(points: Sequence[Measured], method: str, name: str) -> PowerLaw | None:
    """The power law of a solver's time or memory."""
    return power_law([p for p in points if p.method == method], name)


def fits_table(points: Sequence[Measured]) -> Table:
    """Exponents of the power laws through the measured points."""
    laws = [(method, words, law_of(points, method, name)) for method in METHODS for name, words in FITTED.items()]
    lines = [(method, words, f"{law.exponent:.2f}") for method, words, law in laws if law is not None]
    return Table(("solver", "quantity", "exponent"), tuple(lines), left=(0, 1))


def crossings(points: Sequence[Measured]) -> list[str]:
    """Where the solvers cross, in words."""
    cpu, memory = ([law_of(points, method, name) for method in METHODS] for name in FITTED)
    bound = f"CPU time, if the direct one grows from its largest point as its flops do, N^{FLOPS_EXPONENT:.1f}"
    return [
        _crossing_text("CPU time", cpu[0], cpu[1]),
        _crossing_text(bound, flops_bound(points), cpu[1]),
        _crossing_text("memory", memory[0], memory[1]),
    ]


def _crossing_text(what: str, direct: PowerLaw | None, iterative: PowerLaw | None) -> str:
    at = crossing(direct, iterative)
    if math.isnan(at):
        return f"{what}: the fits do not cross"
    return f"{what}: the fits cross at about {float(f'{at:.1g}'):,.0f} unknowns"


def scaling_table(points: Sequence[Measured]) -> Table:
    """The bodies that were measured on one rank and on two: their parts, and the estimate for more."""
    lines = [
        _scaling_line(BENCHMARK_UNKNOWNS, "direct (make benchmark-solver)", part, *seconds)
        for part, seconds in BENCHMARK.items()
    ]
    for method in METHODS:
        one, two = ({p.unknowns: p for p in points if (p.method, p.ranks) == (method, n)} for n in RANKS[:2])
        for unknowns in sorted(set(one) & set(two)):
            lines += [
                _scaling_line(unknowns, method, part, getattr(one[unknowns], name), getattr(two[unknowns], name))
                for name, part in PARTS.items()
            ]
    header = ("unknowns", "solver", "part", *(f"{n} {'rank' if n == 1 else 'ranks'}, s" for n in RANKS))
    return Table(header, tuple(lines), left=(1, 2))


def _scaling_line(unknowns: int, solver: str, part: str, one_s: float, two_s: float) -> tuple[str, ...]:
    times = (one_s, two_s, *(amdahl(one_s, two_s, ranks) for ranks in RANKS[2:]))
    return (f"{unknowns}", solver, part, *(f"{value:.2f}" for value in times))


def draw(path: Path, points: Sequence[Measured]) -> None:
    """Time and memory over size, both logarithmic."""
    quantities = {"iteration_cpu_s": "set-up and one solve, CPU s", "peak_mb": "peak memory, MB"}
    panels: list[Panel] = []
    for name, label in quantities.items():
        series = []
        for method, colour in COLOURS.items():
            mine = sorted((p for p in points if p.method == method), key=lambda p: p.unknowns)
            values = [float(getattr(p, name)) for p in mine]
            text = "" if panels else method  # one legend says it for both
            series.append(Series([p.unknowns for p in mine], values, {"color": colour, "marker": "o"}, text))
        panels.append(Panel(series, "unknowns", label, logarithmic="xy"))
    draw_panels(path, [panels], (8.6, 4.0), INSIDE)
