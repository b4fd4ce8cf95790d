"""Pieces of Markdown that pages are made of."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Sequence

_LITERAL = re.compile(r"``(.+?)``", re.DOTALL)


def cell(text: str) -> str:
    """Text for a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")


def table(header: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """A table whose cells are Markdown already."""
    rows = [header, [":---"] * len(header), *lines]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def docstring(thing: object) -> str:
    """The docstring of a class or function, as Markdown."""
    return from_rst(inspect.getdoc(thing) or "")


def from_rst(text: str) -> str:
    """Text of a docstring with its literals in single backticks."""
    return _LITERAL.sub(r"`\1`", text)
