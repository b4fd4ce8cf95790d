"""The report of the modes study, rendered from its rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

from studies.models.modes import counts_of
from studies.modes.full3d import BAND
from studies.report.labels import level_label
from studies.report.numbers import MISSING, number_text, rounded_up, signed
from studies.report.pages import write_page
from studies.report.tables import Table, facts_table, table_of
from studies.results import provenance
from studies.results.rows import Row, is_reached

if TYPE_CHECKING:
    from studies.modes.study import SceneModes

TITLE: Final = "Modes that break the symmetry: from which pressure on, and in which shape"
_WORDS: Final = {0: "it keeps its symmetry, or twists", 1: "it bends sideways"}


def write_report(folder: Path, results: Sequence[SceneModes], rows: Sequence[Row]) -> Path:
    """Write report.md and report.html into the study's folder; returns the latter."""
    bodies = [r for r in rows if r.model == "full3d"]
    rings = [r for r in rows if r.scene.startswith("ring-")]
    first = next((run for result in results for run in result.runs), None)
    stamps = {
        "commit": provenance.commit(),
        "date": provenance.now(),
        "machine": provenance.machine(),
        "BLAS": provenance.blas(),
        **provenance.versions(),
        "runs made": "" if first is None else first.summary.when,
    }
    content = {
        "title": TITLE,
        "summary": _summary(results, bodies, rings),
        "crossings": _crossings(results),
        "counts": _counts(results),
        "finest": "" if first is None else level_label(results[0].runs[-1].summary.level),
        "bodies": _bodies(bodies),
        "band": f"{100.0 * BAND:g}",
        "rings": _rings(rings),
        "pictures": [
            (f"{result.model.scene.name}, m = {m}", name, _caption(result, m))
            for result in results
            for m, name in result.pictures.items()
        ],
        "provenance": facts_table(stamps),
    }
    return write_page(folder, "modes.md.j2", content)


def _summary(results: Sequence[SceneModes], bodies: Sequence[Row], rings: Sequence[Row]) -> list[str]:
    lines = []
    stable = [r for r in results if r.reached and not any(any(counts_of(p)) for run in r.runs for p in run.path)]
    if stable:
        names = ", ".join(f"{r.model.scene.name} (to {r.model.scene.loads_kpa[-1]:g} kPa)" for r in stable)
        lines.append(f"Stable in m = 0…6 at every requested pressure, on both meridians: {names}.")
    for result in results:
        for found in result.crossings[-1][:1]:
            spread = next(
                r.uncertainty
                for r in result.rows
                if r.quantity == f"crossing_m{found.waves}_kpa" and r.level == result.runs[-1].summary.level
            )
            force = "" if math.isnan(found.tip_force_n) or not found.tip_force_n else _force(found.tip_force_n)
            lines.append(
                f"{result.model.scene.name}: m = {found.waves} is lost at {found.pressure_kpa:.4g} ± "
                f"{rounded_up(spread, 2):g} kPa{force}; {_meaning(found.waves)}."
            )
    if bodies:
        same, share = sum(r.value == r.reference for r in bodies), f"{100.0 * BAND:g} %"
        lines.append(f"Whole bodies in 3D count the same at {same} of {len(bodies)} states {share} beside a crossing.")
    if rings:
        worst = max(abs(r.error_percent) for r in rings if r.level == rings[-1].level)
        lines.append(
            f"Rings buckle within {rounded_up(worst, 2):g} % of the exact pressures on the finest of three meshes."
        )
    return lines


def _force(newton: float) -> str:
    return f", where its tip pushes with {newton:.3g} N"


def _meaning(waves: int) -> str:
    return _WORDS.get(waves, f"it takes {waves} waves round")


def _caption(result: SceneModes, waves: int) -> str:
    found = next(c for c in result.crossings[-1] if c.waves == waves)
    return (
        f"{result.model.scene.name} at {found.pressure_kpa:.4g} kPa: straight, and with its critical mode m = {waves} "
        "added (its size is nobody's: drawn as 0.4 of the body's radius). Half section; rings are not drawn."
    )


def _crossings(results: Sequence[SceneModes]) -> Table:
    """A line per scene, harmonic and meridian."""
    lines = []
    for result in results:
        name = result.model.scene.name
        here = {(r.quantity, r.level): r for r in result.rows}
        for run, found in zip(result.runs, result.crossings, strict=True):
            level = run.summary.level
            if not found:
                none = next(
                    (r.status for r in result.rows if r.quantity.startswith("crossing") and r.level == level), ""
                )
                lines.append((name, level_label(level), none or MISSING, *[MISSING] * 6))
            for c in found:
                at = here[f"crossing_m{c.waves}_kpa", level]
                lines.append(
                    (
                        name,
                        level_label(level),
                        str(c.waves),
                        f"{c.pressure_kpa:.4f}",
                        number_text(rounded_up(at.uncertainty, 2)),
                        f"{c.volume_ratio:.4f}",
                        f"{c.before} → {c.after}",
                        number_text(c.tip_mm),
                        number_text(c.tip_force_n),
                    )
                )
    header = ("scene", "mesh", "m", "kPa", "±", "V/V₀", "modes", "elongation, mm", "force, N")
    return Table(header, tuple(lines), left=(0, 1, 2))


def _counts(results: Sequence[SceneModes]) -> Table:
    """A line per scene and requested pressure, of the finest run."""
    lines = []
    for result in results:
        for entry in result.runs[-1].path:
            if entry.status == "requested":
                counts = counts_of(entry)
                shown = tuple(str(n) for n in counts) if counts else (MISSING,) * 7
                lines.append((result.model.scene.name, f"{entry.pressure_kpa:g}", *shown))
    return Table(("scene", "kPa", *(f"m = {m}" for m in range(7))), tuple(lines))


def _bodies(rows: Sequence[Row]) -> Table:
    columns: dict[str, Callable[[Row], str]] = {
        "scene": lambda r: r.scene,
        "mesh": lambda r: level_label(r.level),
        "kPa": lambda r: f"{r.pressure_kpa:.5g}",
        "modes in 3D": lambda r: number_text(r.value),
        "by harmonics": lambda r: number_text(r.reference),
        "": _verdict,
    }
    return table_of(rows, columns, left=(0, 1, 5))


def _verdict(entry: Row) -> str:
    if not is_reached(entry):
        return entry.status
    return "same" if entry.value == entry.reference else "differs"


def _rings(rows: Sequence[Row]) -> Table:
    columns: dict[str, Callable[[Row], str]] = {
        "load": lambda r: r.scene.removeprefix("ring-"),
        "waves": lambda r: r.quantity.split("_")[1].removeprefix("m"),
        "cells": lambda r: r.level.removeprefix("r"),
        "kPa": lambda r: f"{r.value:.6g}",
        "exact": lambda r: f"{r.reference:.6g}",
        "error, %": lambda r: signed(r.error_percent) if abs(r.error_percent) >= 0.01 else f"{r.error_percent:+.4f}",
    }
    return table_of(rows, columns, left=(0,))
