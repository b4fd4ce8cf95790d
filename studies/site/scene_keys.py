"""The page of a scene's keys, from the models that read scenes: key, unit, default, what is allowed, meaning."""

from __future__ import annotations

import types
from collections.abc import Iterator
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from studies.scene.bellows import BellowsScene
from studies.scene.bodies import BodyScene
from studies.scene.sections import Section
from studies.site.markdown import cell, docstring, table

# Ends of key names and the unit that each stands for; longest first.
_UNITS = {
    "_mpa_per_mm": "MPa/mm",
    "_rad_per_mm": "rad/mm",
    "_percent": "%",
    "_mpa": "MPa",
    "_kpa": "kPa",
    "_mm3": "mm³",
    "_mm": "mm",
    "_mj": "mJ",
    "_s": "s",
    "_n": "N",
}
_HEADER = ("key", "unit", "default", "allowed", "meaning")


def scene_page() -> str:
    """Markdown of the page."""
    parts = [
        "# Keys of a scene",
        "A scene is a TOML file. Every key carries its unit; an unknown key, or a value that cannot be, is refused"
        " with what is allowed before anything is meshed. This page is made from the models that read the files"
        " (`studies/scene/`).",
        "![Half section of a bellows with the letters of its dimensions](../paper/pictures/outline.png)",
        "## A bellows",
        *_scene(BellowsScene, "bellows"),
        "## Other bodies",
        "Bodies with exact answers, and a mesh of your own (`geometry.kind`).",
        *_scene(BodyScene, "body"),
    ]
    return "\n\n".join(parts) + "\n"


def _scene(scene: type[Section], kind: str) -> Iterator[str]:
    """The sections of a scene in the order of its model, those that may be of several kinds one after another."""
    own = {name: field for name, field in scene.model_fields.items() if not _sections(field.annotation)}
    yield table(_HEADER, [_line(name, field) for name, field in own.items()])
    for name, field in scene.model_fields.items():
        for section in _sections(field.annotation):
            tag = "".join(f' `{key} = "{value}"`' for key, value in _tag(section).items())
            heading = f"[{name}.NAME]" if name == "materials" else f"[{name}]"
            yield f"### `{heading}`{tag} {{ #{_anchor(kind, name, section)} }}"
            yield docstring(section)
            if name != "materials":
                yield table(_HEADER, [*(_line(*pair) for pair in section.model_fields.items()), *_others(section)])
            else:
                break


def _anchor(kind: str, name: str, section: type[Section]) -> str:
    return "-".join((kind, name, *_tag(section).values()))


def _tag(section: type[Section]) -> dict[str, str]:
    """The key by whose value a section is told from its like, if it is."""
    for key in ("kind", "law"):
        values = get_args(section.model_fields[key].annotation) if key in section.model_fields else ()
        if len(values) == 1:
            return {key: values[0]}
    return {}


def _sections(annotation: Any) -> list[type[Section]]:
    """The sections that an annotation may hold."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return [annotation]
    if get_origin(annotation) in (Union, types.UnionType, Annotated, dict):
        return [section for member in get_args(annotation) for section in _sections(member)]
    return []


def _line(name: str, field: FieldInfo) -> list[str]:
    default = "required" if field.is_required() else _shown(field.default)
    if name in ("kind", "law") and len(get_args(field.annotation)) == 1:
        default = "required"
    return [f"`{name}`", unit_of(name), default, allowed(field), cell(field.description or "")]


def _others(section: type[Section]) -> Iterator[list[str]]:
    for name, meaning in section.also.items():
        unit = unit_of(name)
        yield [f"`{name}`", unit, "–", "> 0" if unit else "a name", cell(meaning)]


def unit_of(name: str) -> str:
    """The unit that a key's name ends in, or nothing."""
    return next((unit for end, unit in _UNITS.items() if name.endswith(end)), "")


def _shown(value: Any) -> str:
    if value is None or value is PydanticUndefined:
        return "–"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    if isinstance(value, str):
        return f'`"{value}"`'
    if isinstance(value, float):
        return f"`{value:g}`"
    return f"`{value}`".replace("'", '"')


def allowed(field: FieldInfo) -> str:
    """What a field may be: choices, or bounds."""
    choices, bounds, is_list = choices_of(field.annotation), list(field.metadata), _is_list(field.annotation)
    for inner in get_args(field.annotation):
        bounds += [entry for part in getattr(inner, "__metadata__", ()) for entry in getattr(part, "metadata", [part])]
        if get_origin(inner) is Annotated:
            choices = choices or choices_of(get_args(inner)[0])
            is_list = is_list or _is_list(get_args(inner)[0])
    if choices:
        return " or ".join(f'`"{choice}"`' for choice in choices)
    told = [
        f"{sign} {getattr(entry, name):g}" for entry in bounds for name, sign in _SIGNS.items() if hasattr(entry, name)
    ]
    if is_list:
        told = [f"list{', each' * bool(told)}", *told]
    return cell(" ".join(dict.fromkeys(told))) or _kind_of(field.annotation)


_SIGNS = {"gt": ">", "ge": "≥", "lt": "<", "le": "≤"}


def choices_of(annotation: Any) -> list[str]:
    """The texts that a key may be, if it may be one of several."""
    if get_origin(annotation) is Literal:
        return [str(value) for value in get_args(annotation)]
    if get_origin(annotation) in (Union, types.UnionType, list, Annotated):
        return [choice for member in get_args(annotation) for choice in choices_of(member)]
    return []


def _is_list(annotation: Any) -> bool:
    if get_origin(annotation) in (Union, types.UnionType):
        return any(_is_list(member) for member in get_args(annotation))
    return get_origin(annotation) is list


def _kind_of(annotation: Any) -> str:
    return {bool: "`true` or `false`", str: "text", float: "number", int: "whole number"}.get(annotation, "")
