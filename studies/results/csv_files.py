"""CSV files of frozen dataclasses, a line each: numbers with so many digits, NaN as an empty field."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any, TypeVar

from solvers.atomic import write_atomically

Record = TypeVar("Record")


def field_text(value: float | int | str, digits: int) -> str:
    """A value as a field."""
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.{digits}g}"
    return str(value)


def field_value(kind: Any, text: str) -> Any:
    """A field's value; ``kind`` is its annotation: ``float``, ``int`` or ``str``."""
    if kind == "float":
        return float(text) if text else math.nan
    return int(text) if kind == "int" else text


def write_lines(path: Path, header: Iterable[str], lines: Iterable[Iterable[str]]) -> None:
    """Write a CSV file, all of it or nothing."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(lines)
    write_atomically(path, stream.getvalue().encode("utf-8"))


def write_records(path: Path, kind: type[Any], records: Iterable[Any], digits: int) -> None:
    """Write dataclasses of a kind, a column per field."""
    names = [f.name for f in fields(kind)]
    write_lines(path, names, ([field_text(getattr(record, n), digits) for n in names] for record in records))


def read_lines(path: Path) -> list[dict[str, str]]:
    """The lines of a CSV file by column."""
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def read_records(path: Path, kind: type[Record], renamed: Mapping[str, str] | None = None) -> list[Record]:
    """Read what `write_records` has written; ``renamed`` has new names of columns by their old ones.

    Files from before there was a column may lack it, if its field has a default.
    """
    columns = fields(kind)  # type: ignore[arg-type]
    now, spare = renamed or {}, {f.name for f in columns if f.default is not MISSING}
    lines = [{now.get(name, name): text for name, text in line.items()} for line in read_lines(path)]
    return [
        kind(**{f.name: field_value(f.type, line[f.name]) for f in columns if f.name in line or f.name not in spare})
        for line in lines
    ]
