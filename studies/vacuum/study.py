"""The vacuum study: each bellows of scenes/vacuum on two meridians, the finer the reference of the coarser."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import click

from studies.engine import Page, Setting, Solved, Study
from studies.models.axisymmetric import run_axisymmetric
from studies.models.run_rows import path_rows, requested_rows, run_notes, stops
from studies.report.labels import level_label
from studies.report.panels import Panel, Series, draw_panels
from studies.report.pictures.meridians import draw_shapes
from studies.report.style import CURVES, INSIDE
from studies.report.tables import Column, Table, per_level, pivot, pressure_of
from studies.results import provenance
from studies.results.rows import Row
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows

QUANTITIES: Final = ("tip_mm", "volume_mm3", "min_gap_mm", "contact_force_n", "unstable_modes", "min_det_f")


def cases(options: Mapping[str, Any]) -> list[BellowsScene]:
    """Scenes of the study, by name."""
    return [load_bellows(path) for path in sorted((provenance.ROOT / "scenes" / "vacuum").glob("*.toml"))]


def solve(scene: BellowsScene, at: Setting) -> list[Run]:
    """Runs of a scene, coarsest first."""
    levels = sorted(at.options["level"])
    return [run_axisymmetric(scene, n, folder_of(at.out, scene, f"r{n}"), at.comm, at.progress) for n in levels]


def folder_of(out: Path, scene: BellowsScene, level: str) -> Path:
    """Where a run is kept."""
    return out / scene.name / f"axisymmetric-{level}"


def rows_of(out: Path, scene: BellowsScene, runs: Sequence[Run]) -> list[Row]:
    """Rows of a scene: its states at each requested pressure, work and loss of stability of each run."""
    rows: list[Row] = []
    for run in runs:
        folder, finest = folder_of(out, scene, run.summary.level), runs[-1] if run is not runs[-1] else None
        rows += requested_rows(run, folder, scene.load.pressure_kpa, QUANTITIES, "axisymmetric", finest)
        rows += path_rows(run, "axisymmetric")
    return rows


def contractions(rows: Sequence[Row]) -> Table:
    """A line per requested pressure."""
    levels = list(dict.fromkeys(r.level for r in rows))
    columns = [
        *per_level("tip, mm", "tip_mm", ".5g", levels),
        Column("least gap, mm", "min_gap_mm", ".3g", level=levels[-1]),
        Column("contact force, N", "contact_force_n", ".3g", level=levels[-1]),
        *per_level("unstable modes", "unstable_modes", ".3g", levels),
        Column("least det F", "min_det_f", ".2g", level=levels[-1]),
    ]
    return pivot(rows, {"kPa": pressure_of}, columns)


def shortening(scene: BellowsScene, runs: Sequence[Run], look: Mapping[str, Any]) -> Series:
    """Shortening over vacuum on the finest meridian."""
    path, g = runs[-1].path, scene.geometry
    vacuum, shorter = [0.0, *(-e.pressure_kpa for e in path)], [0.0, *(-e.tip_mm for e in path)]
    label = f"t = {g.wall_mm:g}, $R_i$ = {g.root_radius_mm:g} mm, n = {g.convolutions}"
    return Series(vacuum, shorter, look, label)


def draw_contractions(path: Path, found: Sequence[tuple[BellowsScene, Sequence[Run]]]) -> None:
    """Draw shortening (mm) over vacuum (kPa), a panel for those that are evacuated as far."""
    by_range: dict[float, list[tuple[BellowsScene, Sequence[Run]]]] = {}
    for scene, runs in found:
        by_range.setdefault(max(map(abs, scene.loads_kpa)), []).append((scene, runs))
    panels = [
        Panel(
            [shortening(*of, look) for of, look in zip(alike, CURVES, strict=False)],
            "vacuum in the cavity, kPa",
            "shortening at the tip, mm",
            f"to {highest:g} kPa",
        )
        for highest, alike in sorted(by_range.items())
    ]
    draw_panels(path, [panels], (3.4 * len(panels), 3.6), {**INSIDE, "fontsize": 8.0, "loc": "lower right"})


def page(solved: Sequence[Solved[BellowsScene, list[Run]]], at: Setting) -> Page:
    """A section per scene, with its shapes, and one picture of all contractions."""
    rows, sections = [], []
    for scene, runs in ((done.case, done.result) for done in solved):
        found, picture = rows_of(at.out, scene, runs), f"pictures/{scene.name}.png"
        rows += found
        draw_shapes(at.out / picture, scene, runs[0], folder_of(at.out, scene, runs[0].summary.level))
        notes = [f"{level_label(run.summary.level)}: {note}" for run in runs for note in run_notes(run)]
        sections.append({"scene": scene, "table": contractions(found), "notes": notes, "picture": picture})
    draw_contractions(at.out / "pictures" / "contractions.png", [(done.case, done.result) for done in solved])
    return Page(rows, {"sections": sections}, stops(rows))


STUDY: Final = Study(
    name="vacuum",
    title="Bellows under vacuum",
    question="What do bellows contract to when their cavity is evacuated, with contact of their folds?",
    template="vacuum/page.md.j2",
    cases=cases,
    solve=solve,
    page=page,
    options=(
        click.Option(["--level"], multiple=True, type=int, default=(1, 2), show_default=True, help="Meridian levels."),
    ),
)
