"""Tables as text cells, and how they are made of rows and other records."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from studies.report.labels import level_label
from studies.report.numbers import MISSING, number_text
from studies.results.rows import Row

T = TypeVar("T")


@dataclass(frozen=True)
class Table:
    """Cells of a table as text; columns in ``left`` are left-aligned, the others right."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    left: tuple[int, ...] = (0,)


@dataclass(frozen=True)
class Column:
    """A column of values taken from rows.

    Attributes
    ----------
    header
        What stands above it, with its unit.
    quantity
        Of the rows it shows.
    form
        How a value is written, as for `format`; or what writes a row's cell.
    model, level, scene, pressure_kpa
        Of the rows it shows; empty or None for any.
    number
        Which number of a row it shows: ``value``, ``reference``, ``error_percent`` or ``uncertainty``.
    """

    header: str
    quantity: str
    form: str | Callable[[Row], str] = ".4g"
    model: str = ""
    level: str = ""
    scene: str = ""
    pressure_kpa: float | None = None
    number: str = "value"

    def shows(self, row: Row) -> bool:
        """True for the rows of this column."""
        return (
            row.quantity == self.quantity
            and self.model in ("", row.model)
            and self.level in ("", row.level)
            and self.scene in ("", row.scene)
            and self.pressure_kpa in (None, row.pressure_kpa)
        )

    def text(self, row: Row | None, missing: str) -> str:
        """The cell of a row, or of none."""
        if row is None:
            return missing
        return self.form(row) if callable(self.form) else number_text(getattr(row, self.number), self.form, missing)


def per_level(header: str, quantity: str, form: str, levels: Iterable[str], model: str = "") -> list[Column]:
    """A column per mesh, which its header names."""
    return [Column(f"{header}: {level_label(level)}", quantity, form, model, level) for level in levels]


def pressure_of(row: Row) -> str:
    """Pressure of a row, kPa, for the lines of `pivot`."""
    return number_text(row.pressure_kpa, "g")


def pivot(
    rows: Iterable[Row],
    lines: Mapping[str, Callable[[Row], str]],
    columns: Sequence[Column],
    left: tuple[int, ...] = (),
    missing: str = MISSING,
) -> Table:
    """Spread rows over the lines and columns of a table.

    Parameters
    ----------
    rows
        Those that no column shows are left out.
    lines
        By header: what tells one line from another and begins it. Lines come in the order of their first rows.
    columns
        What follows. Where several rows fit a cell it shows the first.
    left
        Columns that are left-aligned.
    missing
        What stands where there is no row, or one without a value.
    """
    found: dict[tuple[str, ...], dict[Column, Row]] = {}
    for row in rows:
        shown = [column for column in columns if column.shows(row)]
        if shown:
            cells = found.setdefault(tuple(text(row) for text in lines.values()), {})
            for column in shown:
                cells.setdefault(column, row)
    body = ((*key, *(column.text(cells.get(column), missing) for column in columns)) for key, cells in found.items())
    return Table((*lines, *(column.header for column in columns)), tuple(body), left)


def table_of(records: Iterable[T], columns: Mapping[str, Callable[[T], str]], left: tuple[int, ...] = ()) -> Table:
    """A line per record; by header how its cell is written."""
    lines = (tuple(text(record) for text in columns.values()) for record in records)
    return Table(tuple(columns), tuple(lines), left)


def facts_table(facts: Mapping[str, str]) -> Table:
    """Facts by their names, such as what a study was made with."""
    return Table(("what", "value"), tuple((name, value or MISSING) for name, value in facts.items()), left=(0, 1))


def as_text(table: Table) -> str:
    """A table for a terminal, its columns lined up."""
    lines = [table.header, *table.rows]
    widths = [max(len(line[column]) for line in lines) for column in range(len(table.header))]
    return "\n".join(
        "  ".join(
            text.ljust(width) if column in table.left else text.rjust(width)
            for column, (text, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    )
