"""The report of the cost study, rendered from its rows and, if there are, those of the peer study."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from studies.cost.cells import ACTUATOR, BODIES
from studies.cost.plots import draw_front, draw_growth
from studies.cost.rows import (
    FARMING,
    Point,
    Power,
    body_name,
    floor_percent,
    front,
    off_front,
    points,
    power_law,
)
from studies.report.bars import draw_times
from studies.report.labels import model_label
from studies.report.numbers import MISSING, count, short_time
from studies.report.pages import write_page
from studies.report.tables import Table, facts_table
from studies.results import provenance
from studies.results.rows import Row, read_rows

TITLE: Final = "What an answer costs: time, memory and error of every model, element, mesh and way of stepping"
FARMED_SCENE: Final = "four actuators"
MEMORY_MB: Final = 24_000.0
# A setting this much slower than the best as exact still counts as on the front: times repeat to about this.
NOISE: Final = 1.1
PEER_RATIO: Final = "time_ratio_"
# Of the error model's rows, those that name the level a tolerance chose.
CHOSEN: Final = "chosen"
# What a front member's time is drawn for, in as many colours as there are; checks and output count as other.
_SPLIT_ORDER: Final = ("axisymmetric start", "mesh", "compile", "pattern", "residual", "tangent", "factor", "solve")


def write_cost_report(folder: Path) -> Path:
    """Write report.md, report.html and pictures from ``folder/rows.csv``; returns the path of report.html."""
    rows = read_rows(folder / "rows.csv")
    found = points(rows)
    pictures = folder / "pictures"
    sections = []
    for body in BODIES:
        name = body_name(body)
        of = [p for p in found if p.scene == name]
        if of:
            sections.append(_section(name, of, rows, pictures))
    content = {
        "title": TITLE,
        "verdicts": [
            *_quiet_sentences(found),
            *_default_sentences(found),
            *_growth_sentences(found),
            *_farming_sentences(rows),
            *_peer_sentences(rows),
        ],
        "sections": sections,
        "ranks": _ranks(found),
        "strategies": _strategies(found),
        "growth": _growth(found, pictures),
        "farming": _farming(rows),
        "compilation": _compilation(rows),
        "model": _model(rows),
        "provenance": _provenance(),
    }
    return write_page(folder, "cost.md.j2", content)


def by_model(found: Sequence[Point]) -> dict[str, list[Point]]:
    """Points of each model of this program; other programs' meridians and bodies as groups of their own."""
    groups: dict[str, list[Point]] = {}
    for p in found:
        groups.setdefault(_peer_group(p) if p.is_peer else p.model, []).append(p)
    return groups


def _peer_group(p: Point) -> str:
    """A peer's body has its cells round in the name of its mesh, for instance ``tet10-n8r1``."""
    return "peers, full 3D" if "-n" in p.level.split()[0] else "peers, axisymmetric"


def _section(name: str, of: Sequence[Point], rows: Sequence[Row], pictures: Path) -> dict[str, object]:
    own = [p for p in of if not p.is_peer]
    draw_front(pictures / f"front-{name}.png", own)
    if len(own) < len(of):
        draw_front(pictures / f"peers-{name}.png", of, whole=True)
    members = {model: front(group) for model, group in by_model(of).items()}
    on_front = [p for group in members.values() for p in group if p.split_s]
    split = _split(on_front)
    if split:
        draw_times(pictures / f"times-{name}.png", [p.name for p in on_front], split)
    source = next((r for r in rows if r.scene == name and r.source), None)
    spread = 100.0 * source.uncertainty / abs(source.reference) if source else math.nan
    return {
        "name": name,
        "picture": f"pictures/front-{name}.png",
        "peers": f"pictures/peers-{name}.png" if len(own) < len(of) else "",
        "times": f"pictures/times-{name}.png" if split else "",
        "reference": "" if source is None else f"{source.reference:.6g} mm ({source.source}, ± {spread:.2g} %)",
        "floor": f"{floor_percent(name):g}",
        "fronts": _fronts(members),
        "cells": _cells(of),
        "failed": [f"{p.name}: {p.status}" for p in of if p.status != "reached"],
    }


def _split(of: Sequence[Point]) -> dict[str, list[float]]:
    """Wall seconds by activity of each point; ``start`` is the process's start and imports, ``other`` the rest."""
    names = [name for name in _SPLIT_ORDER if any(name in p.split_s for p in of)]
    if not names:
        return {}
    split = {name: [p.split_s.get(name, 0.0) for p in of] for name in names}
    split["start, imports"] = [p.wall_s - p.work_s for p in of]
    split["other"] = [max(0.0, p.work_s - sum(p.split_s.get(name, 0.0) for name in names)) for p in of]
    return split


def _fronts(members: Mapping[str, Sequence[Point]]) -> Table:
    """The members of each model's front."""
    lines = []
    for model, of in members.items():
        for p in of:
            default = "yes" if p.default else ""
            name = p.name if p.is_peer else p.level
            work = MISSING if p.is_peer else short_time(p.work_s)
            lines.append((model_label(model), name, _error(p), short_time(p.wall_s), work, _memory(p), default))
    header = ("model", "member of its front", "error, %", "wall, s", "without start, s", "memory, MB", "study-paper")
    return Table(header, tuple(lines), (0, 1))


def _cells(of: Sequence[Point]) -> Table:
    lines = [
        (
            model_label(p.model),
            p.level,
            _size(p.unknowns),
            _size(p.factorisations),
            _error(p),
            short_time(p.wall_s) + ("*" if p.disturbed and not p.is_peer else ""),
            *(short_time(s) if math.isfinite(s) else MISSING for s in (p.work_s, p.cpu_s)),
            _memory(p),
        )
        for p in of
    ]
    header = ("model", "cells, mesh, way, ranks x threads", "unknowns", "factorisations", "error, %", "wall, s",
              "without start, s", "CPU, s", "memory, MB")  # fmt: skip
    return Table(header, tuple(lines), (0, 1))


def _error(p: Point) -> str:
    if math.isnan(p.error_percent):
        return MISSING
    credited = f" ({p.credited_percent:.2g})" if p.credited_percent > 1.05 * p.error_percent else ""
    return f"{p.error_percent:.2g}{credited}"


def _memory(p: Point) -> str:
    return MISSING if math.isnan(p.peak_mb) else f"{p.peak_mb:.0f}"


def _size(number: float) -> str:
    return count(int(number)) if number > 0 else MISSING


def _quiet_sentences(found: Sequence[Point]) -> list[str]:
    """How many measurements other processes disturbed."""
    own = [p for p in found if not p.is_peer]
    disturbed = [p for p in own if p.disturbed]
    if not disturbed:
        return [f"All {len(own)} measurements had the machine to themselves."]
    return [
        f"{len(disturbed)} of {len(own)} measurements were disturbed, or it is not known: other processes computed for "
        "more than a tenth of their wall time. They are marked *, too long, and measured again by the same command."
    ]


def _default_sentences(found: Sequence[Point]) -> list[str]:
    """Where the settings of study-paper stand: on the front of their model, or by how much not."""
    lines = []
    for p in found:
        if not p.default or math.isnan(p.error_percent):
            continue
        rivals = [q for q in found if q.scene == p.scene and q.model == p.model]
        ratio, best = off_front(p, rivals)
        off = f"off the front by {ratio:.2f} in time: {best.level} is as exact in {short_time(best.time_s)} s"
        on = "on the front" if ratio <= NOISE else off
        if p.disturbed or best.disturbed:
            on += " (disturbed measurement)"
        lines.append(f"study-paper's {p.name} on {p.scene} ({_error(p)} % in {short_time(p.time_s)} s): {on}")
    return lines


def growing(found: Sequence[Point]) -> list[Point]:
    """Undisturbed bodies of the actuator on two ranks, the smallest first."""
    of = [p for p in found if p.scene == body_name(ACTUATOR) and p.model == "full3d" and p.level.endswith("warm 2x1")]
    return sorted((p for p in of if p.status == "reached" and not p.disturbed), key=lambda p: p.unknowns)


def per_factorisation(p: Point) -> float:
    """Wall seconds of the body itself, without its axisymmetric start, per factorisation."""
    return (p.work_s - p.split_s.get("axisymmetric start", 0.0)) / p.factorisations


def growth_laws(found: Sequence[Point]) -> dict[str, Power]:
    """Time without start, time per factorisation and memory over unknowns; empty with fewer than three bodies."""
    of = growing(found)
    if len(of) < 3:
        return {}
    size = [p.unknowns for p in of]
    return {
        "time": power_law(size, [p.work_s for p in of]),
        "iteration": power_law(size, [per_factorisation(p) for p in of]),
        "memory": power_law(size, [p.peak_mb for p in of]),
    }


def _growth_sentences(found: Sequence[Point]) -> list[str]:
    laws, of = growth_laws(found), growing(found)
    if not laws:
        return []
    largest = of[-1]
    fits = laws["memory"].inverse(MEMORY_MB)
    return [
        f"Time grows with unknowns to the power {laws['time'].exponent:.2f}, time per factorisation to "
        f"{laws['iteration'].exponent:.2f}, memory to {laws['memory'].exponent:.2f} "
        f"({count(int(of[0].unknowns))} to {count(int(largest.unknowns))} unknowns, two ranks).",
        f"Largest body measured: {largest.level}, {count(int(largest.unknowns))} unknowns, "
        f"{largest.peak_mb / 1000:.1f} GB, {short_time(largest.wall_s)} s; by the fit 24 GB hold about "
        f"{count(int(fits / 1000) * 1000)} unknowns, "
        f"{laws['time'].at(fits) / 60.0:.0f} minutes.",
    ]


def _growth(found: Sequence[Point], pictures: Path) -> dict[str, object]:
    laws, of = growth_laws(found), growing(found)
    lines = tuple(
        (
            p.level,
            _size(p.unknowns),
            _size(p.factorisations),
            short_time(p.work_s),
            f"{per_factorisation(p):.2f}",
            _memory(p),
            f"{1000.0 * p.peak_mb / p.unknowns:.1f}",
        )
        for p in of
    )
    header = ("body", "unknowns", "factorisations", "time without start, s", "per factorisation, s", "memory, MB",
              "kB per unknown")  # fmt: skip
    if laws:
        curves = [
            ("time without start, s", [p.work_s for p in of], laws["time"]),
            ("time per factorisation, s", [per_factorisation(p) for p in of], laws["iteration"]),
            ("memory, MB", [p.peak_mb for p in of], laws["memory"]),
        ]
        draw_growth(pictures / "growth.png", [p.unknowns for p in of], curves)
    return {"table": Table(header, lines), "picture": "pictures/growth.png" if laws else ""}


def _ranks(found: Sequence[Point]) -> Table:
    """One rank with two threads beside two ranks with one, of everything that was measured both ways."""
    lines = []
    table = {(p.scene, p.name): p for p in found}
    for p in found:
        other = table.get((p.scene, p.name.removesuffix("1x2") + "2x1")) if p.level.endswith("1x2") else None
        if other is None or "reached" not in (p.status, other.status):
            continue
        lines.append(
            (
                p.scene,
                p.name.removesuffix(" 1x2"),
                _size(p.unknowns),
                short_time(p.work_s),
                short_time(other.work_s),
                f"{p.work_s / other.work_s:.2f}",
                _memory(p),
                _memory(other),
            )
        )
    header = ("body", "run", "unknowns", "1 rank x 2 threads, s", "2 ranks x 1 thread, s", "ratio", "memory 1x2, MB",
              "memory 2x1, MB")  # fmt: skip
    return Table(header, tuple(lines), (0, 1))


def _strategies(found: Sequence[Point]) -> Table:
    """The same run by other ways of stepping."""
    groups: dict[tuple[str, str, str, str, str], list[Point]] = {}
    for p in found:
        if p.is_peer:
            continue
        element, level, _, ranks = p.level.split()
        groups.setdefault((p.scene, p.model, element, level, ranks), []).append(p)
    lines = []
    for (scene, model, element, level, _), of in groups.items():
        if len(of) < 2:
            continue
        lines += [
            (
                scene,
                f"{model_label(model)} {element} {level}",
                p.level.split()[2],
                _size(p.factorisations),
                short_time(p.work_s),
                _error(p),
            )
            for p in of
        ]
    header = ("body", "run", "way", "factorisations", "time without start, s", "error, %")
    return Table(header, tuple(lines), (0, 1, 2))


def _batches(rows: Sequence[Row]) -> dict[str, dict[str, float]]:
    """Wall seconds of batches by model and ranks per scene."""
    found: dict[str, dict[str, float]] = {}
    for r in rows:
        if r.quantity == FARMING and r.status == "reached":
            found.setdefault(r.model, {})[r.level] = r.value
    return {model: of for model, of in found.items() if len(of) == 2}


def _farming_sentences(rows: Sequence[Row]) -> list[str]:
    return [
        f"Four actuators, {model_label(model)}: farming (a rank each, two side by side) takes {short_time(farmed)} s, "
        f"splitting (two ranks, one after the other) {short_time(split)} s: {split / farmed:.2f} times as long."
        for model, (farmed, split) in ((model, _both(of)) for model, of in _batches(rows).items())
    ]


def _both(of: Mapping[str, float]) -> tuple[float, float]:
    farmed, split = (of[level] for level in sorted(of))
    return farmed, split


def _farming(rows: Sequence[Row]) -> Table:
    lines = []
    for model, of in _batches(rows).items():
        farmed, split = _both(of)
        lines.append((model_label(model), short_time(farmed), short_time(split), f"{split / farmed:.2f}"))
    header = ("four actuators to 20 kPa", "farming: 1 rank per scene, s", "splitting: 2 ranks per scene, s", "ratio")
    return Table(header, tuple(lines))


def _compilation(rows: Sequence[Row]) -> Table:
    first = [r for r in rows if r.quantity == "compile_s"]
    lines = [(r.scene, f"{model_label(r.model)} {r.level}", short_time(r.value)) for r in first]
    return Table(("body", "run", "longer by, s"), tuple(lines), (0, 1))


def _peer_sentences(rows: Sequence[Row]) -> list[str]:
    """The peer study's own ratios."""
    ratios = [r for r in rows if r.quantity.startswith(PEER_RATIO) and math.isfinite(r.value)]
    return [f"{r.scene}: {r.quantity.replace('_', ' ')} {r.level}: {r.value:.2g}." for r in ratios]


def _model(rows: Sequence[Row]) -> Table:
    """Predicted, checked and achieved errors of the scenes on which the error model is checked, at the chosen level."""
    numbers = {(r.scene, r.level, r.quantity): r.value for r in rows}
    lines = []
    for r in rows:
        if r.quantity != CHOSEN:
            continue
        predicted, checked, achieved = (
            numbers[r.scene, r.level, f"{name}_error_percent"] for name in ("predicted", "checked", "achieved")
        )
        lines.append(
            (
                r.scene,
                f"{r.value:g}",
                r.level,
                *(f"{x:.2g}" for x in (predicted, checked, achieved)),
                *(f"{x / achieved:.2f}" for x in (predicted, checked)),
            )
        )
    header = ("scene", "tolerance, %", "chosen", "predicted, %", "checked, %", "achieved, %", "predicted / achieved",
              "checked / achieved")  # fmt: skip
    return Table(header, tuple(lines), (0, 2))


def _provenance() -> Table:
    facts = {
        "commit": provenance.commit(),
        "date": provenance.now(),
        "machine": provenance.machine(),
        "BLAS": provenance.blas(),
        **provenance.versions(),
    }
    return facts_table(facts)
