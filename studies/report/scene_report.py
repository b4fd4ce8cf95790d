"""What the report of a scene is made of, and how its rows and paths are looked up."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path

from studies.planning.levels import ranking
from studies.report.labels import TIP, TIP_FORCE, ordered, run_label, split_key
from studies.report.pictures.stills import RingBox
from studies.results.rows import Row
from studies.results.run_files import PathRow, RunSummary


@dataclass(frozen=True)
class SceneReport:
    """What the report says of one scene.

    Attributes
    ----------
    name, title
        Name of the scene, and its heading.
    scene_toml
        Text of the scene file.
    pressures_kpa
        Asked pressures, kPa.
    rows
        The scene's comparison rows.
    runs
        Every run behind them.
    paths
        All converged states by ``"model level"``, for instance ``"full3d n24"``.
    fields
        By requested pressure (kPa) the .vtu of the finest full 3D run; may be empty.
    notes
        Sentences: what was skipped and why, warnings; those that the runs' plans say too are shown once.
    rings
        Rigid rings to draw, by pressure (kPa), 0.0 for unloaded; empty where there are none.
    counted
        What the cells of a mesh such as ``n8`` are counted along.
    stopped
        Why a run that was to reach every load did not; empty if all did.
    """

    name: str
    title: str
    scene_toml: str
    pressures_kpa: tuple[float, ...]
    rows: tuple[Row, ...]
    runs: tuple[RunSummary, ...]
    paths: dict[str, list[PathRow]]
    fields: dict[float, Path]
    notes: tuple[str, ...]
    rings: dict[float, tuple[RingBox, ...]] = field(default_factory=dict)
    counted: str = "round"
    stopped: str = ""


def quantity_of(scene: SceneReport) -> str:
    """What a scene is about: the force at its tip if it is blocked, else the elongation."""
    return TIP_FORCE if any(row.quantity == TIP_FORCE for row in scene.rows) else TIP


def unit_of(scene: SceneReport) -> str:
    """Unit of what a scene is about."""
    return "N" if quantity_of(scene) == TIP_FORCE else "mm"


def headlines(scene: SceneReport) -> list[Row]:
    """All rows of what a scene is about."""
    quantity = quantity_of(scene)
    return [row for row in scene.rows if row.quantity == quantity]


def headline(scene: SceneReport, model: str, pressure_kpa: float) -> Row | None:
    """Tip's row (mm, N) of a model's finest level at a pressure (kPa), reached or not; None if there is none."""
    found = [row for row in headlines(scene) if row.model == model]
    found = [row for row in found if math.isclose(row.pressure_kpa, pressure_kpa)]
    return max(found, key=lambda row: ranking(row.level), default=None)


def models_of(scene: SceneReport) -> list[str]:
    """Models that a scene has the tip of, in the order of `MODELS`."""
    return ordered(row.model for row in headlines(scene))


def finest_path(scene: SceneReport, model: str) -> list[PathRow]:
    """All converged states of a model's finest level; empty if it has none."""
    keys = [key for key in scene.paths if split_key(key)[0] == model]
    return scene.paths[max(keys, key=lambda key: ranking(split_key(key)[1]))] if keys else []


def followed_path(scene: SceneReport, model: str) -> list[PathRow]:
    """The same of the finest level whose path was followed, with states between; without one of the finest."""
    keys = [key for key in scene.paths if split_key(key)[0] == model]
    between = [key for key in keys if any(state.status == "step" for state in scene.paths[key])]
    return (
        scene.paths[max(between, key=lambda key: ranking(split_key(key)[1]))] if between else finest_path(scene, model)
    )


def label_of(scene: SceneReport, model: str, *levels: str) -> str:
    """What the report calls a model of a scene on one or more meshes."""
    return run_label(model, *levels, counted=scene.counted)


def anchor_of(scene: SceneReport) -> str:
    """Name of a scene as it stands in addresses."""
    return re.sub(r"[^a-z0-9]+", "-", scene.name.lower()).strip("-")
