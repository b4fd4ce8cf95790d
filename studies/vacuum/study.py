"""The vacuum study: each bellows of scenes/vacuum on two meridians, the finer the reference of the coarser."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import click
import numpy as np

from studies.engine import Page, Setting, Solved, Study
from studies.models.axisymmetric import run_axisymmetric
from studies.models.run_rows import path_rows, requested_rows, run_notes, stops
from studies.report.tables import Table
from studies.results import provenance
from studies.results.rows import Row
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene
from studies.scene.files import load_bellows
from studies.vacuum.plots import draw_contractions, draw_shapes

SCENES: Final = provenance.ROOT / "scenes" / "vacuum"
QUANTITIES: Final = ("tip_mm", "volume_mm3", "min_gap_mm", "contact_force_n", "unstable_modes", "min_det_f")


def cases(options: Mapping[str, Any]) -> list[BellowsScene]:
    """Scenes of the study, by name."""
    return [load_bellows(path) for path in sorted(SCENES.glob("*.toml"))]


def solve(scene: BellowsScene, at: Setting) -> list[Run]:
    """Runs of a scene, coarsest first."""
    levels = sorted(at.options["level"])
    return [run_axisymmetric(scene, n, folder_of(at.out, scene, f"r{n}"), at.comm, at.progress) for n in levels]


def folder_of(out: Path, scene: BellowsScene, level: str) -> Path:
    """Where a run is kept."""
    return out / scene.name / f"axisymmetric-{level}"


def scene_rows(out: Path, scene: BellowsScene, runs: Sequence[Run]) -> list[Row]:
    """Rows of a scene: its states at each requested pressure, work and loss of stability of each run."""
    rows: list[Row] = []
    for run in runs:
        folder = folder_of(out, scene, run.summary.level)
        finest = runs[-1] if run is not runs[-1] else None
        rows += requested_rows(run, folder, scene.load.pressure_kpa, QUANTITIES, "axisymmetric", finest)
        rows += path_rows(run, "axisymmetric")
    return rows


def contractions(rows: Sequence[Row]) -> Table:
    """A line per requested pressure."""
    value = {(r.level, r.pressure_kpa, r.quantity): f"{r.value:.5g}" for r in rows if r.value == r.value}
    levels = list(dict.fromkeys(r.level for r in rows))
    columns = [(level, "tip_mm") for level in levels]
    columns += [(levels[-1], name) for name in ("min_gap_mm", "contact_force_n", "min_det_f")]
    pressures = dict.fromkeys(r.pressure_kpa for r in rows if r.quantity == "tip_mm")
    lines = [(f"{p:g}", *(value.get((level, p, name), "") for level, name in columns)) for p in pressures]
    return Table(("kPa", *(f"{name}: {level}" for level, name in columns)), tuple(lines), ())


def page(solved: Sequence[Solved[BellowsScene, list[Run]]], at: Setting) -> Page:
    """A section per scene, with its shapes, and one picture of all contractions."""
    rows, sections, curves = [], [], {}
    for scene, runs in ((done.case, done.result) for done in solved):
        found, picture = scene_rows(at.out, scene, runs), f"pictures/{scene.name}.png"
        draw_shapes(at.out / picture, scene, runs[0], folder_of(at.out, scene, runs[0].summary.level))
        curves[scene.name] = np.array([(0.0, 0.0), *((entry.pressure_kpa, entry.tip_mm) for entry in runs[-1].path)])
        notes = [f"{run.summary.level}: {note}" for run in runs for note in run_notes(run)]
        sections.append(
            {"name": scene.name, "title": scene.title, "table": contractions(found), "notes": notes, "picture": picture}
        )
        rows += found
    draw_contractions(at.out / "pictures" / "contractions.png", curves)
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
