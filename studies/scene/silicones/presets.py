"""Silicones by name, and materials of scenes that name one or the file of a tensile test."""

from __future__ import annotations

import difflib
import functools
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomlkit
from pydantic import TypeAdapter

from analytical.laws.isotropic import Law
from studies.scene.materials import AnyMaterial, law_of
from studies.scene.sections import SceneError

PRESETS_FILE = Path(__file__).with_name("presets.toml")
# Keys of a material beside its law, which go with a preset or with data.
BESIDE = ("kappa_over_mu", "data_to_stretch")
_MATERIAL: TypeAdapter[AnyMaterial] = TypeAdapter(AnyMaterial)


@dataclass(frozen=True)
class Preset:
    """A silicone of the table.

    Attributes
    ----------
    name, title
        In scenes, and its maker's.
    material
        Keys of a scene's material: law, constants and ``data_to_stretch``.
    stretch_at_break
        One plus the elongation at break.
    source
        Where constants and the stretch at break are from.
    data
        File of the test that the law is fitted to, from the project's folder; empty for printed constants.
    others
        What other sources say, a sentence each.
    """

    name: str
    title: str
    material: Mapping[str, Any]
    stretch_at_break: float
    source: str
    data: str = ""
    others: Sequence[str] = ()


@functools.cache
def presets() -> dict[str, Preset]:
    """The table of `presets.toml`, in its order."""
    table = tomllib.loads(PRESETS_FILE.read_text(encoding="utf-8"))
    return {name: Preset(name=name, **row) for name, row in table.items()}


def preset(name: Any) -> Preset:
    """A silicone by name.

    Raises
    ------
    SceneError
        With what is near.
    """
    known = presets()
    if isinstance(name, str) and name in known:
        return known[name]
    near = difflib.get_close_matches(str(name).lower().replace(" ", "-"), known, n=1, cutoff=0.5)
    hint = f"did you mean {near[0]}? " if near else ""
    raise SceneError(f"material.preset = {name!r}: {hint}there are {', '.join(known)}")


def preset_material(one: Preset) -> AnyMaterial:
    """A silicone's material, as a scene has it."""
    return _MATERIAL.validate_python(dict(one.material))


def in_short(one: Preset) -> tuple[str, str, str]:
    """Initial shear modulus in kPa, to which stretch its data go, and at which it breaks."""
    of = preset_material(one)
    modulus, to = 1e3 * law_of(of).initial_shear_modulus_mpa, of.data_to_stretch
    return f"{modulus:.3g}", f"{to:.3g}" if to else "not told", f"{one.stretch_at_break:.3g}"


@functools.cache
def _laws() -> tuple[tuple[Law, Preset], ...]:
    return tuple((law_of(preset_material(one)), one) for one in presets().values())


def preset_of(law: Law) -> Preset | None:
    """The silicone of the table whose law this is."""
    return next((one for known, one in _laws() if known == law), None)


def with_material(data: Mapping[str, Any], place: Path) -> dict[str, Any]:
    """The contents of a scene's file with law and constants in place of presets and data; ``place`` is its folder.

    Raises
    ------
    SceneError
        For an unknown preset, data that cannot be read or fitted, or keys that say the same twice.
    """
    out = dict(data)
    if isinstance(data.get("material"), dict):
        out["material"] = _written_out(data["material"], place, "material")
    if isinstance(data.get("materials"), dict):
        out["materials"] = {
            name: _written_out(of, place, f"materials.{name}") if isinstance(of, dict) else of
            for name, of in data["materials"].items()
        }
    return out


def _written_out(material: Mapping[str, Any], place: Path, key: str) -> Mapping[str, Any]:
    given = [name for name in ("preset", "data") if name in material]
    if not given:
        return material
    allowed = (*given[:1], *BESIDE, *(("law",) if given == ["data"] else ()))
    if extra := [name for name in material if name not in allowed]:
        raise SceneError(
            f"{key}.{extra[0]} = {material[extra[0]]!r}: beside {key}.{given[0]} there may be "
            f"{', '.join(name for name in allowed if name != given[0])}: leave one of the two out"
        )
    beside = {name: material[name] for name in BESIDE if name in material}
    if given == ["preset"]:
        return {**preset(material["preset"]).material, **beside}
    from studies.scene.silicones.tensile import AUTO, fitted_material  # scipy, which every scene would pay

    file, law, largest = material["data"], material.get("law", AUTO), material.get("data_to_stretch")
    if not isinstance(file, str):
        raise SceneError(f"{key}.data = {file!r}: must be the name of a CSV file, found from where the scene is")
    if largest is not None and not (isinstance(largest, int | float) and largest > 1.0):
        raise SceneError(f"{key}.data_to_stretch = {largest!r}: must be a number above 1")
    if not isinstance(law, str):
        raise SceneError(f"{key}.law = {law!r}: must be a name")
    return {**fitted_material(place / file, law, largest, key), **beside}


def with_laws(text: str, materials: Mapping[str, AnyMaterial]) -> str:
    """A scene file's text with law and constants in place of presets and data, as it is kept beside results.

    Parameters
    ----------
    text
        The file's; without comments where a law is put in, for tables can be written in many ways.
    materials
        By their keys: "material", and "materials.NAME".
    """
    scene = tomllib.loads(text)
    changed = False
    for key, material in materials.items():
        *above, last = key.split(".", 1)
        holder = scene.get(above[0], {}) if above else scene
        if isinstance(holder.get(last), dict) and not holder[last].keys().isdisjoint(("preset", "data")):
            holder[last] = material.model_dump(exclude_unset=True)
            changed = True
    return tomlkit.dumps(scene) if changed else text
