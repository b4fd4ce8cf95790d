"""What has been computed once and is kept: values on disk under a key of all that decides them."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from studies.results.run_files import write_text_atomically

Value = TypeVar("Value")


def content_key(*content: object, sources: Iterable[Path] = ()) -> str:
    """Key of what decides a value.

    Parameters
    ----------
    content
        Dataclasses, and whatever JSON can hold; `studies.results.provenance.code_hash` is to be among it where finite
        elements are solved.
    sources
        Files whose bytes decide too.

    Returns
    -------
    str
        24 hexadecimal digits.
    """
    text = json.dumps(content, sort_keys=True, default=_plain)
    digest = hashlib.sha256(text.encode())
    for path in sources:
        digest.update(path.read_bytes())
    return digest.hexdigest()[:24]


def _plain(thing: object) -> object:
    """What JSON makes of a dataclass, and of anything else its text."""
    return asdict(thing) if is_dataclass(thing) and not isinstance(thing, type) else str(thing)


def read_kept(file: Path, key: str, kind: type[Value]) -> Value | None:
    """The value of a file if it is there, whole and under this key.

    Parameters
    ----------
    file, key
        As given to `keep`.
    kind
        Its type, a dataclass of plain values (dataclasses of such, tuples, dictionaries).
    """
    try:
        kept: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        return TypeAdapter(kind).validate_python(kept["value"]) if kept["key"] == key else None
    except (OSError, ValueError, KeyError, TypeError, ValidationError):
        return None


def keep(file: Path, key: str, value: object) -> None:
    """Write a value under its key, whole or not at all; NaN and infinity stay what they are."""
    text = json.dumps({"key": key, "value": value}, default=_plain, indent=1)
    file.parent.mkdir(parents=True, exist_ok=True)
    write_text_atomically(file, text + "\n")


def kept(file: Path, key: str, kind: type[Value], make: Callable[[], Value]) -> Value:
    """The value that is kept under a key, made and kept if it is not there."""
    found = read_kept(file, key, kind)
    if found is None:
        found = make()
        keep(file, key, found)
    return found
