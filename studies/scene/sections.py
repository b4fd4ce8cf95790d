"""What all scene files have in common: strict sections, numbers with units, faults told as lines."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, TypeVar, get_args, get_origin

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag, ValidationError

Length = Annotated[float, Field(gt=0.0, le=1000.0, allow_inf_nan=False)]
Stiffness = Annotated[float, Field(gt=0.0, le=1e4, allow_inf_nan=False)]
# Up to 10 GPa: rings of plastic and layers of fabric in a mesh of the user's.
Modulus = Annotated[float, Field(gt=0.0, le=1e7, allow_inf_nan=False)]
# Of a path, relative to the unloaded volume. The default: inner stretches of 10 (sphere) and 32 (tube), beyond what any
# silicone takes.
LargestVolume = Annotated[
    float, Field(gt=1.0, le=1e6, description="the path ends at so many times the unloaded volume of the cavity")
]
LARGEST_VOLUME = 1000.0


def _in_a_list(value: Any) -> Any:
    return [value] if isinstance(value, int | float) and not isinstance(value, bool) else value


# A key that holds a number or a list of them: faults are told of what is there, not of both.
ONE, SEVERAL = Tag("one"), Tag("several")
ONE_OR_SEVERAL = Discriminator(lambda value: "several" if isinstance(value, list) else "one")
# A list of loads may have one only, which needs no brackets.
ONE_OR_MORE = BeforeValidator(_in_a_list)
# Which of a force on the tip and the pressure comes first: as in `solvers.paths.orders`.
Order = Annotated[
    Literal["auto", "force-first", "together", "pressure-first"],
    Field(description="which of a force on the tip and the pressure comes first; auto: the force, if it can alone"),
]
Control = Annotated[
    Literal["auto", "pressure", "volume", "arc"], Field(description="what is held in a step of the path")
]
Tolerance = Annotated[
    float, Field(gt=0.0, le=100.0, description="largest discretisation uncertainty of what is wanted, % of the value")
]
Fields = Annotated[bool, Field(description="in 3D: write displacements, stretches and pressure for ParaView")]
NAME_PATTERN = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,79}$"
SceneName = Annotated[str, Field(pattern=NAME_PATTERN, description="name of the scene in rows, files and reports")]

# Results at two loads are told apart if the loads differ by more than this share: tables have six digits.
APART = 1e-5


class SceneError(ValueError):
    """A scene that cannot be run; one line per fault."""


class Section(BaseModel):
    """A table of a scene file: unknown keys are faults. ``also``: keys that it takes in place of its fields."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=False)
    also: ClassVar[Mapping[str, str]] = {}


Model = TypeVar("Model", bound=Section)


def is_ascending(loads: Sequence[float]) -> bool:
    """True if each of some loads is above the last by so much that their results are told apart."""
    return all(b > a and abs(b - a) > APART * abs(b) for a, b in zip(loads[:-1], loads[1:], strict=True))


def order_faults(order: str, tip_force_n: float) -> list[str]:
    """An order of a force and the pressure without a force."""
    if order == "auto" or tip_force_n:
        return []
    return [
        f'load.order = "{order}": there is no force beside the pressure: leave the key out, or set load.tip_force_n'
    ]


def read_toml(path: Path) -> dict[str, Any]:
    """The contents of a scene file.

    Raises
    ------
    SceneError
        If it cannot be read or is not TOML.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror}); give the path of a scene file") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise SceneError(f"{path}: not a TOML file: {error}") from None


def validated(
    model: type[Model], data: dict[str, Any], path: Path, faults: Callable[[Model], list[str]] | None = None
) -> Model:
    """A scene from the contents of its file.

    Parameters
    ----------
    model
        The scene's class.
    data, path
        Contents and where they are from, for messages.
    faults
        What the types cannot see, a line per fault; None to leave it at what they see.

    Raises
    ------
    SceneError
        With one line per fault.
    """
    try:
        scene = model.model_validate(data)
    except ValidationError as error:
        raise SceneError("\n".join(f"{path}: {line}" for line in explain(error, model))) from None
    found = [] if faults is None else faults(scene)
    if found:
        raise SceneError("\n".join(f"{path}: {line}" for line in found))
    return scene


def explain(error: ValidationError, model: type[Section]) -> list[str]:
    """Pydantic's findings about a scene as lines with key, value and what is allowed."""
    lines = []
    for fault in error.errors():
        where, section, annotation = _place(model, fault["loc"])
        key, value = ".".join(where), fault.get("input")
        kind, context = fault["type"], fault.get("ctx", {})
        if kind == "extra_forbidden" and where[-1] in section.also:
            lines.append(f"{key} = {value!r}: must be a finite number greater than 0")
        elif kind == "extra_forbidden":
            allowed = [*section.model_fields, *section.also]
            near = difflib.get_close_matches(where[-1], allowed, n=1, cutoff=0.5)
            hint = f"did you mean {near[0]}? " if near else ""
            lines.append(f"{key} = {value!r}: unknown key; {hint}allowed: {', '.join(allowed)}")
        elif kind == "missing":
            lines.append(f"{key}: missing, and has no default")
        elif kind in ("union_tag_not_found", "union_tag_invalid"):
            tag = str(context.get("discriminator", "")).strip("'")
            allowed_tags = ", ".join(repr(name) for name in _members(annotation))
            if kind == "union_tag_not_found":
                lines.append(f"{key}.{tag}: missing; allowed: {allowed_tags}")
            else:
                shown = value.get(tag) if isinstance(value, dict) else value
                lines.append(f"{key}.{tag} = {shown!r}: allowed: {allowed_tags}")
        elif kind == "literal_error":
            lines.append(f"{key} = {value!r}: allowed: {context.get('expected')}")
        else:
            text = fault["msg"].removeprefix("Value error, ").replace("Input should be", "must be")
            unit = next((u for u in ("mm", "kpa") if key.endswith("_" + u)), "").replace("kpa", "kPa")
            text = f"{text} {unit}".rstrip() if kind in ("greater_than", "less_than_equal") else text
            lines.append(text if kind == "value_error" and "=" in text else f"{key} = {value!r}: {text}")
    return lines


def _place(model: type[Section], location: tuple[Any, ...]) -> tuple[list[str], type[Section], Any]:
    """Keys of a fault without the tags pydantic puts between them, the section the last is in, and what it holds."""
    keys: list[str] = []
    section: type[Section] = model
    inner: Any = None
    for part in location:
        if part in (ONE.tag, SEVERAL.tag):
            continue
        members = _members(inner) if inner is not None else {}
        if str(part) in members:
            inner = members[str(part)]
            continue
        keys.append(str(part))
        if get_origin(inner) is dict:  # tables by a name of the user's
            held = get_args(inner)[1]
            inner = get_args(held)[0] if get_origin(held) is Annotated else held
            continue
        if isinstance(inner, type) and issubclass(inner, Section):
            section = inner
        inner = _annotation(section, str(part))
    return keys, section, inner


def _annotation(section: type[Section], key: str) -> Any:
    found = section.model_fields.get(key)
    return None if found is None else found.annotation


def _members(annotation: Any) -> dict[str, type[Section]]:
    """Sections that a key may hold, by their tags: the values of their ``kind`` or ``law``."""
    out: dict[str, type[Section]] = {}
    for member in get_args(annotation):
        if isinstance(member, type) and issubclass(member, Section):
            for name in ("kind", "law"):
                if name in member.model_fields:
                    out |= {str(tag): member for tag in get_args(member.model_fields[name].annotation)}
    return out
