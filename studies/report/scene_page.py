"""What reports say of scenes that have been run, from their folders: the same whether runs were solved or kept."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from meshes.bellows import FloatArray
from studies.models.session import ROWS_FILE, SCENE_FILE, SceneResult, read_scene_folder
from studies.report.labels import counted_along
from studies.report.pictures.stills import RingBox
from studies.report.scene_report import SceneReport
from studies.results.closed_form_rows import validity_notes
from studies.results.rows import read_rows
from studies.results.run_files import field_files, load_state
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.load import Scene, kept_scene


def _read_result(folder: Path) -> SceneResult[Scene]:
    """The results of a scene as they are in its folder.

    Those of a bellows are compared anew; of a simple body the runs behind its rows, for runs of an earlier plan may be
    there too.
    """
    scene = kept_scene(folder / SCENE_FILE)
    found = read_scene_folder(scene, folder)
    if isinstance(scene, BellowsScene):
        return found
    rows = tuple(read_rows(folder / ROWS_FILE))
    shown = {(row.model, row.level) for row in rows}
    runs = tuple(run for run in found.runs if (run.summary.model, run.summary.level) in shown)
    return SceneResult(scene, runs, rows)


def report_of(folder: Path) -> SceneReport:
    """What reports say of a scene whose results are in a folder."""
    result = _read_result(folder)
    scene, finest = result.scene, result.full3d[-1].summary if result.full3d else None
    fields: dict[float, Path] = {}
    rings: dict[float, tuple[RingBox, ...]] = {}
    if isinstance(scene, BellowsScene) and finest is not None:
        place = folder / f"full3d-{finest.level}"
        fields = field_files(place, scene.load.pressure_kpa)
        rings = ring_boxes(scene, place, finest.content_hash, list(fields))
    return SceneReport(
        name=scene.name,
        title=scene.title,
        scene_toml=(folder / SCENE_FILE).read_text(encoding="utf-8"),
        pressures_kpa=tuple(scene.loads_kpa),
        rows=result.rows,
        runs=tuple(run.summary for run in result.runs),
        paths={f"{run.summary.model} {run.summary.level}": list(run.path) for run in result.runs},
        fields=fields,
        notes=tuple(validity_notes(scene)) if isinstance(scene, BellowsScene) else (),
        rings=rings,
        counted=counted_along(scene.geometry.kind),
        stopped=result.reason,
    )


def ring_boxes(
    scene: BellowsScene, run: Path, content_hash: str, pressures_kpa: Sequence[float]
) -> dict[float, tuple[RingBox, ...]]:
    """Where the rigid rings are at each pressure (kPa; 0 is unloaded), from the kept states."""
    if scene.rings.model != "rigid":
        return {}
    shape = shape_of(scene)

    def boxes(shift_mm: FloatArray) -> tuple[RingBox, ...]:
        centres = shape.crest_positions_mm + np.asarray(shift_mm)
        return tuple(
            RingBox(float(c), shape.seat_radius_mm, scene.rings.seat_mm, scene.rings.height_mm) for c in centres
        )

    out = {0.0: boxes(np.zeros(1))}
    for pressure in pressures_kpa:
        saved = load_state(run, content_hash, 1e-3 * pressure)
        if saved is not None:
            out[pressure] = boxes(saved[0].bodies_mm[: len(shape.crest_positions_mm), 2])
    return out
