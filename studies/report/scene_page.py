"""The report of scenes that have been run, from their folders."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from meshes.bellows import FloatArray
from studies.models.session import SCENE_FILE, read_scene_folder
from studies.report.pictures.stills import RingBox
from studies.report.scene_report import SceneReport
from studies.report.scenes import write_report
from studies.results import provenance
from studies.results.closed_form_rows import validity_notes
from studies.results.files import PathRow, field_files, load_state
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.files import load_bellows


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


def render_scenes(folder: Path, title: str, introduction: str, scene_folders: Sequence[Path]) -> Path:
    """Write the report of scene folders into ``folder``; returns the path of report.html."""
    reports = []
    total = 0.0
    for scene_folder in scene_folders:
        result = read_scene_folder(load_bellows(scene_folder / SCENE_FILE), scene_folder)
        runs = result.runs
        total += sum(run.summary.time_s["total"] for run in runs)
        paths: dict[str, list[PathRow]] = {f"{run.summary.model} {run.summary.level}": list(run.path) for run in runs}
        fields: dict[float, Path] = {}
        rings: dict[float, tuple[RingBox, ...]] = {}
        if result.full3d:
            finest = scene_folder / f"full3d-{result.full3d[-1].summary.level}"
            fields = field_files(finest, result.scene.load.pressure_kpa)
            rings = ring_boxes(result.scene, finest, result.full3d[-1].summary.content_hash, list(fields))
        notes = validity_notes(result.scene)
        reports.append(
            SceneReport(
                name=result.scene.name,
                title=result.scene.title,
                scene_toml=(scene_folder / SCENE_FILE).read_text(encoding="utf-8"),
                pressures_kpa=tuple(result.scene.load.pressure_kpa),
                rows=result.rows,
                runs=tuple(run.summary for run in runs),
                paths=paths,
                fields=fields,
                rings=rings,
                notes=tuple(notes),
            )
        )
    facts = {
        "commit": provenance.commit(),
        "date": provenance.now(),
        "machine": provenance.machine(),
        "BLAS": provenance.blas(),
        **provenance.versions(),
    }
    return write_report(folder, title, introduction, reports, facts, total)
