"""Tables and sentences of the modes study's page."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from solvers.stability.modes import WAVES
from studies.models.modes import COUNTED_LEVELS, FoundCrossing, counts_of
from studies.modes.full3d import BAND
from studies.modes.pictures import DRAWN_SHARE
from studies.modes.results import SceneModes
from studies.report.labels import level_label
from studies.report.numbers import MISSING, number_text, rounded_up, signed
from studies.report.tables import Column, Table, pivot, pressure_of, table_of
from studies.results.rows import Row, is_reached


def summary(results: Sequence[SceneModes], bodies: Sequence[Row], rings: Sequence[Row]) -> list[str]:
    """What was found of scenes, of whole bodies and of rings, a sentence each."""
    lines = []
    stable = [r for r in results if not r.stops and not any(any(counts_of(p)) for run in r.runs for p in run.path)]
    if stable:
        names = ", ".join(f"{r.name} (to {r.model.scene.loads_kpa[-1]:g} kPa)" for r in stable)
        lines.append(f"Stable in m = 0…6 at every requested pressure, on both meridians: {names}.")
    lines += [_first_loss(result) for result in results if result.crossings[-1]]
    if bodies:
        same, share = sum(r.value == r.reference for r in bodies), f"{100.0 * BAND:g} %"
        lines.append(f"Whole bodies in 3D count the same at {same} of {len(bodies)} states {share} beside a crossing.")
    if rings:
        worst = rounded_up(max(abs(r.error_percent) for r in rings if r.level == rings[-1].level), 2)
        lines.append(f"Rings buckle within {worst:g} % of the exact pressures on the finest of three meshes.")
    return lines


def _first_loss(result: SceneModes) -> str:
    """Where the finest run loses its first harmonic."""
    first, level = result.crossings[-1][0], result.runs[-1].summary.level
    spread = rounded_up(result.crossing_row(first.waves, level).uncertainty, 2)
    pushes = f", where its tip pushes with {first.tip_force_n:.3g} N" if abs(first.tip_force_n) > 0.0 else ""
    words = {0: "it keeps its symmetry, or twists", 1: "it bends sideways"}
    meaning = words.get(first.waves, f"it takes {first.waves} waves round")
    return f"{result.name}: m = {first.waves} is lost at {first.pressure_kpa:.4g} ± {spread:g} kPa{pushes}; {meaning}."


def caption(name: str, crossing: FoundCrossing) -> str:
    """What the picture of a scene's mode shows."""
    return (
        f"{name} at {crossing.pressure_kpa:.4g} kPa: straight, and with its critical mode m = {crossing.waves} "
        "added. A mode has no size of its own: it is drawn so that surfaces stay clear of each other, "
        f"{DRAWN_SHARE:g} of the body's radius at most. Half section; rings are not drawn."
    )


def crossings_table(results: Sequence[SceneModes]) -> Table:
    """A line per scene, harmonic and meridian."""
    lines = []
    for result in results:
        for run, found in zip(result.runs, result.crossings, strict=True):
            level = run.summary.level
            start = (result.name, level_label(level))
            if not found:
                none = [r.status for r in result.rows if r.quantity.startswith("crossing") and r.level == level]
                lines.append((*start, none[0], *[MISSING] * 6))
            for c in found:
                spread = rounded_up(result.crossing_row(c.waves, level).uncertainty, 2)
                lines.append(
                    (
                        *start,
                        str(c.waves),
                        f"{c.pressure_kpa:.4f}",
                        number_text(spread),
                        f"{c.volume_ratio:.4f}",
                        f"{c.before} → {c.after}",
                        number_text(c.tip_mm),
                        number_text(c.tip_force_n),
                    )
                )
    header = ("scene", "mesh", "m", "kPa", "±", "V/V₀", "modes", "elongation, mm", "force, N")
    return Table(header, tuple(lines), left=(0, 1, 2))


def counts_table(rows: Sequence[Row]) -> Table:
    """A line per scene and requested pressure, on the finest meridian."""
    level = f"r{COUNTED_LEVELS[-1]}"
    columns = [Column(f"m = {m}", f"unstable_m{m}", ".0f", level=level) for m in WAVES]
    return pivot(rows, {"scene": lambda r: r.scene, "kPa": pressure_of}, columns, left=(0,))


def bodies_table(rows: Sequence[Row]) -> Table:
    """Counts on whole bodies beside those of the harmonics."""
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


def rings_table(rows: Sequence[Row]) -> Table:
    """Buckling of rings beside the exact pressures."""
    columns: dict[str, Callable[[Row], str]] = {
        "load": lambda r: r.scene.removeprefix("ring-"),
        "waves": lambda r: r.quantity.split("_")[1].removeprefix("m"),
        "cells": lambda r: r.level.removeprefix("r"),
        "kPa": lambda r: f"{r.value:.6g}",
        "exact": lambda r: f"{r.reference:.6g}",
        "error, %": lambda r: signed(r.error_percent) if abs(r.error_percent) >= 0.01 else f"{r.error_percent:+.4f}",
    }
    return table_of(rows, columns, left=(0,))
