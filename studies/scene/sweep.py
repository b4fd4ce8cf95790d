"""A sweep file: one scene, the keys that vary, and the scenes that follow.

A sweep is a TOML file::

    base = "scenes/heung-t1-ri5.toml"   # beside this file, or in the checkout
    combine = "product"                 # product: every value with every other | zip: the first values, the second, ...

    [vary]                              # dotted keys of the scene, a list of values each
    geometry.wall_mm = [1.0, 1.5]       # whole tables may be values too: material = [{ law = ... }, { law = ... }]

    [ask]                               # what is requested of every scene; default: as in the base
    pressure_kpa = [5.0, 10.0]
    tolerance_percent = 2.0

Several tables ``[[vary]]`` are swept one after the other; a combination that two of them name is one scene.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from studies.scene.bellows import BellowsScene
from studies.scene.load import bellows_from, load_bellows
from studies.scene.sections import SceneError, Section, read_toml, validated
from studies.scene.text import changed_text

CHECKOUT = Path(__file__).resolve().parents[2]
# Keys that are not the sweep's to vary: every scene gets a name of its own, and no fields are written.
_NOT_VARIED = ("name", "ask.fields")


class SweepAsk(Section):
    """What is requested of every scene; None leaves it as it is in the base."""

    pressure_kpa: list[float] | None = None
    tolerance_percent: float | None = None


class SweepFile(Section):
    """A sweep file's contents."""

    base: str
    combine: Literal["product", "zip"] = "product"
    vary: dict[str, Any] | list[dict[str, Any]]
    ask: SweepAsk = SweepAsk()


@dataclass(frozen=True)
class Variant:
    """One scene of a sweep.

    Attributes
    ----------
    name
        Of its scene and folder: the base's and a hash of what differs, so that it stays when the sweep grows.
    values
        The swept keys' values, in the order of the sweep file.
    text
        Its scene file.
    scene
        The scene, None if it is refused.
    refusal
        Why it is refused; empty if it is not.
    """

    name: str
    values: Mapping[str, Any]
    text: str
    scene: BellowsScene | None
    refusal: str


def read_sweep(file: Path) -> list[Variant]:
    """All scenes of a sweep, in the order of the file, those included that cannot be built.

    Raises
    ------
    SceneError
        With one line per fault of the sweep file, or the reasons if every scene is refused; nothing has been written.
    """
    sweep = validated(SweepFile, read_toml(file), file, _faults)
    base = _base_file(file, sweep.base)
    named, text = load_bellows(base).name, base.read_text(encoding="utf-8")
    requested: dict[str, Any] = {"ask.fields": False}
    if sweep.ask.pressure_kpa is not None:
        requested["load.pressure_kpa"] = sweep.ask.pressure_kpa
    if sweep.ask.tolerance_percent is not None:
        requested["ask.tolerance_percent"] = sweep.ask.tolerance_percent
    blocks = _blocks(sweep)
    keys = list(dict.fromkeys(key for block in blocks for key in block))
    found: dict[str, Variant] = {}
    for block in blocks:
        for values in _combinations(block, sweep.combine):
            changes = dict(zip(block, values, strict=True))
            name = f"{named[:60]}-{_digest(changes)}"
            found.setdefault(name, _variant(name, text, base.resolve().parent, {**changes, **requested}, keys))
    refusals = dict.fromkeys(variant.refusal for variant in found.values())
    if all(refusals):
        raise SceneError("\n".join(f"{file}: every scene is refused: {reason}" for reason in refusals))
    return list(found.values())


def _faults(sweep: SweepFile) -> list[str]:
    """What the types cannot see: lists, their lengths, keys that a sweep does not vary."""
    faults = []
    blocks = _blocks(sweep)
    if not all(blocks):
        faults.append("vary: must hold at least one key of the scene with a list of values")
    for block in blocks:
        for key, values in block.items():
            if not isinstance(values, list) or not values:
                faults.append(f"vary.{key} = {values!r}: must be a list of values, at least one")
        lengths = {key: len(values) for key, values in block.items() if isinstance(values, list)}
        if sweep.combine == "zip" and len(set(lengths.values())) > 1:
            told = ", ".join(f"{key}: {length}" for key, length in lengths.items())
            faults.append(f'combine = "zip": all lists must be of the same length ({told})')
        faults += [f"vary.{key}: not a key to vary" for key in block if key in _NOT_VARIED]
        given = {"load.pressure_kpa": sweep.ask.pressure_kpa, "ask.tolerance_percent": sweep.ask.tolerance_percent}
        faults += [
            f"vary.{key}: ask.{key.split('.')[1]} gives it to every scene: leave one of them out"
            for key in block
            if given.get(key) is not None
        ]
    return faults


def _blocks(sweep: SweepFile) -> list[dict[str, Any]]:
    """The tables of values, keys with dots: TOML reads a dotted key that is not quoted as nested tables."""
    tables = sweep.vary if isinstance(sweep.vary, list) else [sweep.vary]
    return [dict(_flat(table)) for table in tables] or [{}]


def _flat(table: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    found = []
    for key, value in table.items():
        found += _flat(value, f"{prefix}{key}.") if isinstance(value, dict) else [(f"{prefix}{key}", value)]
    return found


def _base_file(file: Path, base: str) -> Path:
    """The base scene: beside the sweep file, else in the checkout."""
    beside = file.parent / base
    return beside if beside.exists() else CHECKOUT / base


def _combinations(block: Mapping[str, list[Any]], combine: str) -> list[tuple[Any, ...]]:
    """Values of all keys, a tuple per scene."""
    lists = list(block.values())
    return list(itertools.product(*lists) if combine == "product" else zip(*lists, strict=True))


def _digest(changes: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(changes, sort_keys=True).encode()).hexdigest()[:10]


def _variant(name: str, base: str, place: Path, changes: Mapping[str, Any], keys: list[str]) -> Variant:
    """A scene with changes, or why it is refused."""
    try:
        text = changed_text(base, name, changes)
    except TypeError:
        # a key that leads through a number: no scene has it
        return Variant(name, {key: changes.get(key) for key in keys}, base, None, f"no such key among {list(changes)}")
    values = {key: _value(tomllib.loads(text), key) for key in keys}
    path = place / "scene.toml"  # which is not there: files beside the base are found from it
    try:
        return Variant(name, values, text, bellows_from(tomllib.loads(text), path), "")
    except SceneError as error:
        return Variant(name, values, text, None, str(error).replace(f"{path}: ", "").replace("\n", "; "))


def _value(data: Any, key: str) -> Any:
    """A scene's value of a key; None if it leaves it to the default."""
    for part in key.split("."):
        data = data.get(part) if isinstance(data, dict) else None
    return data
