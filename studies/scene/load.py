"""Scene files of all kinds, read and checked before anything runs: geometry.kind tells a bellows from a simple body."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from studies.scene.bellows import BellowsScene, bellows_faults
from studies.scene.bodies import KINDS, BodyScene, body_faults
from studies.scene.compare import with_measured
from studies.scene.sections import SceneError, read_toml, validated
from studies.scene.silicones.presets import with_material

Scene = BellowsScene | BodyScene


def load_scene(path: Path) -> Scene:
    """Read and check a scene.

    Raises
    ------
    SceneError
        With one line per fault; nothing has been meshed, solved or written.
    """
    return scene_from(read_toml(path), path)


def scene_from(data: dict[str, Any], path: Path) -> Scene:
    """Check a scene of which there are the contents of its file; ``path`` is for messages and for files beside it.

    Raises
    ------
    SceneError
        With one line per fault.
    """
    kind = _kind(data)
    if kind == "bellows" or kind is None:  # a missing kind is told as the missing key it is
        return validated(BellowsScene, _completed(data, path), path, bellows_faults)
    if kind not in KINDS:
        allowed = ", ".join(repr(name) for name in ("bellows", *KINDS))
        raise SceneError(f"{path}: geometry.kind = {kind!r}: allowed: {allowed}")
    return validated(BodyScene, _with_place(_with_material(data, path), path), path, body_faults)


def load_bellows(path: Path) -> BellowsScene:
    """Read and check a scene that must be one of a bellows.

    Raises
    ------
    SceneError
        As from `load_scene`.
    """
    return bellows_from(read_toml(path), path)


def bellows_from(data: dict[str, Any], path: Path) -> BellowsScene:
    """Check a bellows' scene of which there are the contents of its file; ``path`` as in `scene_from`.

    Raises
    ------
    SceneError
        As from `load_scene`.
    """
    return validated(BellowsScene, _completed(data, path), path, bellows_faults)


def kept_scene(path: Path) -> Scene:
    """A scene kept beside its results, which was checked then: a user's mesh need not be where it was.

    Raises
    ------
    SceneError
        If the file is missing or damaged.
    """
    data = read_toml(path)
    if _kind(data) in KINDS:
        return validated(BodyScene, data, path)
    return validated(BellowsScene, data, path)


def _completed(data: dict[str, Any], path: Path) -> dict[str, Any]:
    """With measured values and the material's law, which may be in other files."""
    try:
        return with_measured(_with_material(data, path), path.resolve().parent)
    except SceneError as error:
        raise SceneError(str(error) if str(error).startswith(f"{path}: ") else f"{path}: {error}") from None


def _with_material(data: dict[str, Any], path: Path) -> dict[str, Any]:
    try:
        return with_material(data, path.resolve().parent)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from None


def _kind(data: dict[str, Any]) -> Any:
    geometry = data.get("geometry")
    return geometry.get("kind") if isinstance(geometry, dict) else None


def _with_place(data: dict[str, Any], path: Path) -> dict[str, Any]:
    """The contents with the file of a user's mesh found from where the scene is."""
    geometry = data["geometry"]
    if not isinstance(geometry.get("file"), str):
        return data
    return {**data, "geometry": {**geometry, "file": str(path.resolve().parent / geometry["file"])}}
