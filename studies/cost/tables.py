"""Tables of the cost study's page."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Final

from studies.cost.points import Point, per_factorisation
from studies.cost.rows import BATCH_WALL, COMPILE
from studies.report.labels import model_label
from studies.report.numbers import MISSING, count, short_time
from studies.report.tables import Table, table_of
from studies.results.rows import ON_QUARTERS, REACHED, TIME_RATIO, Row

Columns = Mapping[str, Callable[[Point], str]]


def error_text(p: Point) -> str:
    """Error, percent, and the one it is credited with where that is larger."""
    if math.isnan(p.error_percent):
        return MISSING
    credited = f" ({p.credited_percent:.2g})" if p.credited_percent > 1.05 * p.error_percent else ""
    return f"{p.error_percent:.2g}{credited}"


def _seconds(number: float) -> str:
    return short_time(number) if math.isfinite(number) else MISSING


def _memory(p: Point) -> str:
    return MISSING if math.isnan(p.cost.peak_mb) else f"{p.cost.peak_mb:.0f}"


def _size(number: float) -> str:
    return count(int(number)) if number > 0 else MISSING


def _run(p: Point) -> str:
    return f"{model_label(p.model)} {p.element} {p.mesh}"


_SIZE: Final[Columns] = {
    "unknowns": lambda p: _size(p.cost.unknowns),
    "factorisations": lambda p: _size(p.cost.factorisations),
}
FRONT: Final[Columns] = {
    "model": lambda p: model_label(p.group),
    "member of its front": lambda p: p.name if p.is_peer else p.level,
    "error, %": error_text,
    "wall, s": lambda p: short_time(p.cost.wall_s),
    "without start, s": lambda p: _seconds(p.cost.work_s),
    "memory, MB": _memory,
    "study-paper": lambda p: "yes" if p.default else "",
}
CELLS: Final[Columns] = {
    "model": lambda p: model_label(p.model),
    "cells, mesh, way, ranks x threads": lambda p: p.level,
    **_SIZE,
    "error, %": error_text,
    "wall, s": lambda p: short_time(p.cost.wall_s) + ("*" if p.cost.disturbed and not p.is_peer else ""),
    "without start, s": lambda p: _seconds(p.cost.work_s),
    "CPU, s": lambda p: _seconds(p.cost.cpu_s),
    "memory, MB": _memory,
}
GROWTH: Final[Columns] = {
    "body": lambda p: p.level,
    **_SIZE,
    "time without start, s": lambda p: short_time(p.cost.work_s),
    "per factorisation, s": lambda p: f"{per_factorisation(p):.2f}",
    "memory, MB": _memory,
    "kB per unknown": lambda p: f"{1000.0 * p.cost.peak_mb / p.cost.unknowns:.1f}",
}
_STRATEGIES: Final[Columns] = {
    "body": lambda p: p.scene,
    "run": _run,
    "way": lambda p: p.way,
    "factorisations": _SIZE["factorisations"],
    "time without start, s": lambda p: short_time(p.cost.work_s),
    "error, %": error_text,
}
_RANKS: Final[Mapping[str, Callable[[tuple[Point, Point]], str]]] = {
    "body": lambda pair: pair[0].scene,
    "run": lambda pair: pair[0].name.removesuffix(" 1x2"),
    "unknowns": lambda pair: _size(pair[0].cost.unknowns),
    "1 rank x 2 threads, s": lambda pair: short_time(pair[0].cost.work_s),
    "2 ranks x 1 thread, s": lambda pair: short_time(pair[1].cost.work_s),
    "ratio": lambda pair: f"{pair[0].cost.work_s / pair[1].cost.work_s:.2f}",
    "memory 1x2, MB": lambda pair: _memory(pair[0]),
    "memory 2x1, MB": lambda pair: _memory(pair[1]),
}


def strategies_table(own: Sequence[Point]) -> Table:
    """The same run by other ways of stepping."""
    groups: dict[tuple[str, ...], list[Point]] = {}
    for p in own:
        groups.setdefault((p.scene, p.model, p.element, p.mesh, p.ranks), []).append(p)
    return table_of([p for of in groups.values() if len(of) > 1 for p in of], _STRATEGIES, (0, 1, 2))


def ranks_table(own: Sequence[Point]) -> Table:
    """One rank with two threads beside two ranks with one, of everything that was measured both ways."""
    reached = {(p.scene, p.name): p for p in own if p.reached}
    others = [(p, reached.get((p.scene, p.name.removesuffix("1x2") + "2x1"))) for p in reached.values()]
    pairs = [(p, other) for p, other in others if p.ranks == "1x2" and other is not None]
    return table_of(pairs, _RANKS, (0, 1))


def batches(rows: Sequence[Row]) -> list[tuple[str, float, float]]:
    """Models whose batches were measured both ways, with wall seconds of farming and of splitting."""
    found: dict[str, dict[str, float]] = {}
    for r in rows:
        if r.quantity == BATCH_WALL and r.status == REACHED:
            found.setdefault(r.model, {})[r.level] = r.value
    both = {model: [of[level] for level in sorted(of)] for model, of in found.items() if len(of) == 2}
    return [(model_label(model), farmed, split) for model, (farmed, split) in both.items()]


def farming_table(rows: Sequence[Row]) -> Table:
    """Farming against splitting."""
    lines = [
        (model, short_time(farmed), short_time(split), f"{split / farmed:.2f}")
        for model, farmed, split in batches(rows)
    ]
    header = ("four actuators to 20 kPa", "farming: 1 rank per scene, s", "splitting: 2 ranks per scene, s", "ratio")
    return Table(header, tuple(lines))


def compilation_table(rows: Sequence[Row]) -> Table:
    """How much longer a run takes that compiles."""
    columns: Mapping[str, Callable[[Row], str]] = {
        "body": lambda r: r.scene,
        "run": lambda r: f"{model_label(r.model)} {r.level}",
        "longer by, s": lambda r: short_time(r.value),
    }
    return table_of([r for r in rows if r.quantity == COMPILE], columns, (0, 1))


def ratios_table(rows: Sequence[Row]) -> Table:
    """Our time over other programs', by two ways of comparing and by two kinds of error, each said in words."""
    ratios = {r.quantity: r for r in rows if r.quantity.startswith(TIME_RATIO) and math.isfinite(r.value)}
    lines = []
    for name, r in ratios.items():
        if name.endswith(ON_QUARTERS):
            continue
        on_quarters = ratios.get(name + ON_QUARTERS)
        error = "lasting" if r.quantity.endswith("by_lasting_error") else "as it is"
        equal = "at_equal_error" in r.quantity
        what = (
            f"at the smallest error that both reach, {r.level}" if equal else "ours to 1 %, theirs at their least error"
        )
        cut = f"{on_quarters.value:.2g}" if on_quarters else ""
        if on_quarters and on_quarters.level != r.level:
            cut += f" at {on_quarters.level}"
        lines.append((model_label(r.model), what, error, f"{r.value:.2g}", cut))
    columns = ("model", "compared", "error counts", "our time over theirs", "theirs on a quarter too")
    return Table(columns, tuple(lines), left=(0, 1, 2))


def like_with_like(found: Sequence[Point]) -> Table:
    """Our bodies of the peers' bellows by rings and start, each over another program's quickest of the whole body."""
    bodies = [p for p in found if p.is_peer and p.group == "peers, full 3D" and p.reached]
    peers = [p for p in bodies if "quarter" not in p.mesh]
    if not peers:
        return Table((), ())
    quickest = min(peers, key=lambda p: p.cost.wall_s)
    ours = [
        p
        for p in found
        if (p.scene, p.model, p.mesh) == (quickest.scene, "full3d", "n8")
        and p.element in ("hex", "tet")
        and p.reached
        and not p.is_peer
    ]
    columns: Columns = {
        "run": lambda p: p.name,
        "rings": lambda p: "meshed" if p.is_peer or p.element == "tet" else "rigid",
        "starts from": lambda p: "the axisymmetric state" if not p.is_peer and p.way == "warm" else "zero",
        "unknowns": lambda p: _size(p.cost.unknowns),
        "error, %": error_text,
        "wall, s": lambda p: short_time(p.cost.wall_s),
        f"over {quickest.name}": lambda p: f"{p.cost.wall_s / quickest.cost.wall_s:.2f}",
    }
    return table_of([*ours, quickest], columns, (0, 1, 2))
