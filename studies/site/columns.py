"""The page of files and their columns, from the classes that write them."""

from __future__ import annotations

import inspect
import re
from dataclasses import fields
from typing import Any

from studies.results.rows import Row
from studies.results.run_files import PathRow, RunSummary
from studies.site.markdown import cell, docstring, from_rst, table
from studies.site.scene_keys import unit_of

_ENTRY = re.compile(r"^(\S.*)\n((?:    .*\n?|\n)+)", re.MULTILINE)


def columns_page() -> str:
    """Markdown of the page."""
    parts = [
        "# Files and columns",
        "What a run leaves in its folder. Tables are CSV with a header; an empty field is a number that was not"
        " computed.",
        "## `rows.csv`: comparison rows",
        "One number per line, with what it is compared with; the same columns in every study.",
        _attributes(Row),
        "## `path.csv`: states of a path",
        docstring(PathRow),
        table(("column", "unit"), [(f"`{f.name}`", unit_of(f.name)) for f in fields(PathRow)]),
        "## `summary.json`: a run in figures",
        _attributes(RunSummary),
    ]
    return "\n\n".join(parts) + "\n"


def _attributes(described: type[Any]) -> str:
    """The attributes of a class as its docstring has them."""
    _, _, text = (inspect.getdoc(described) or "").partition("Attributes\n----------\n")
    return table(("column", "meaning"), attributes(text))


def attributes(text: str) -> list[tuple[str, str]]:
    """Names and meanings of a numpy docstring's list of attributes."""
    found = _ENTRY.findall(text + "\n")
    return [(", ".join(f"`{name}`" for name in names.split(", ")), cell(from_rst(meaning))) for names, meaning in found]
