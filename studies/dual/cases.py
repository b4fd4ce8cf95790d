"""Twenty axisymmetric scenes: thin and thick walls, laws, cells, bodies with and without singular edges."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from studies.results import provenance
from studies.scene.load import Scene, load_scene

# Scene files, and by table and key what is changed in them.
SCENES: Final[tuple[tuple[str, Mapping[str, Mapping[str, Any]]], ...]] = (
    ("heung-t1-ri5", {}),
    ("heung-t1-ri7", {}),
    ("heung-t2-ri5", {}),
    ("heung-t2-ri7", {}),
    ("heung-a-t1-ri8", {}),
    ("heung-b-t2-ri7.5", {}),
    ("zigzag/heung-t2-ri5", {}),
    ("tolerance/paper-t0.5-ri7-ogden", {}),
    ("tolerance/tight-t1-ri10-ogden", {}),
    ("tolerance/wide-t2-ri4-yeoh", {}),
    ("smoke-t2-ri5", {"mesh": {"element": "tet"}}),
    ("smoke-t2-ri5", {"material": {"kappa_over_mu": 100.0}}),
    ("smoke-t2-ri5", {"geometry": {"wall_mm": 3.0, "half_pitch_mm": 6.0}}),
    ("exact/tube", {}),
    ("exact/tube-ogden", {"mesh": {"element": "tet"}}),
    ("exact/tube-capped", {}),
    ("exact/tube", {"geometry": {"ends": "bonded", "length_mm": 10.0}}),
    ("exact/sphere", {}),
    ("exact/sphere-yeoh", {"material": {"kappa_over_mu": 100.0}}),
    ("exact/ventricle", {}),
)


@dataclass(frozen=True)
class Case:
    """A scene and its name in the study."""

    name: str
    scene: Scene


def twenty() -> list[Case]:
    """The cases."""
    return [_case(name, changes) for name, changes in SCENES]


def _case(name: str, changes: Mapping[str, Mapping[str, Any]]) -> Case:
    scene = load_scene(provenance.ROOT / "scenes" / f"{name}.toml")
    tables = {table: getattr(scene, table).model_copy(update=values) for table, values in changes.items()}
    said = [f"{key} {value}" for values in changes.values() for key, value in values.items()]
    full = ", ".join([name.replace("/", " "), *said])
    return Case(full, scene.model_copy(update={**tables, "name": full.replace(", ", "-").replace(" ", "-")}))
