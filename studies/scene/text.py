"""Scene files as text with some keys changed, comments kept."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import tomlkit


def changed_text(text: str, name: str, changes: Mapping[str, Any]) -> str:
    """A scene file's text under another name, with keys that differ.

    Parameters
    ----------
    text
        The scene file it is made from.
    name
        Its new name.
    changes
        Values by keys with dots: ``"rings.model": "meshed"``. A whole table replaces the file's.

    Raises
    ------
    TypeError
        If a key leads through something that is no table.
    """
    document = tomlkit.parse(text)
    document["name"] = name
    for key, value in changes.items():
        *tables, last = key.split(".")
        table: Any = document
        for part in tables:
            if part not in table:
                table[part] = tomlkit.table()
            table = table[part]
        table[last] = value
    return tomlkit.dumps(document)
