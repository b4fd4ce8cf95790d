"""Measured values that a scene is compared with: a table in the scene, or a CSV file beside it."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import tomlkit
from pydantic import Field, model_validator

from studies.scene.sections import APART, SceneError, Section

PRESSURE = "pressure_kpa"
VALUES = ("tip_mm", "tip_force_n")
# What may part the columns of a file.
DELIMITERS = ",;\t"
Numbers = Annotated[list[Annotated[float, Field(allow_inf_nan=False)]], Field(min_length=1, max_length=500)]


class Compare(Section):
    """Measured elongations, or forces of a blocked tip, that models are compared with at the same pressures.

    In a ``file`` the columns have the names of the keys; other columns and lines that begin with # are passed over.
    Pressures that were measured are solved for, too; without ``load.pressure_kpa`` they are all that is.
    """

    file: str | None = Field(default=None, description="CSV with a header, found from where the scene is")
    pressure_kpa: Numbers | None = Field(
        default=None, description="pressures of the measured values, in place of a file"
    )
    tip_mm: Numbers | None = Field(default=None, description="measured elongations")
    tip_force_n: Numbers | None = Field(default=None, description="measured forces of a blocked tip")

    @model_validator(mode="after")
    def _one_value_each(self) -> Compare:
        given = [name for name in VALUES if getattr(self, name) is not None]
        if self.pressure_kpa is None or not given:
            raise ValueError("compare: give file, or pressure_kpa with tip_mm or tip_force_n")
        for name in given:
            if (count := len(getattr(self, name))) != len(self.pressure_kpa):
                raise ValueError(
                    f"compare.{name} has {count} values, compare.pressure_kpa {len(self.pressure_kpa)}: one for each"
                )
        return self

    def measured(self, quantity: str, pressure_kpa: float) -> list[float]:
        """Measured values of a quantity at a pressure, several if it was measured more than once."""
        values = getattr(self, quantity, None) or []
        return [v for p, v in zip(self.pressure_kpa or (), values, strict=False) if same(p, pressure_kpa)]


def same(one: float, other: float) -> bool:
    """True for pressures whose results are not told apart."""
    return math.isclose(one, other, rel_tol=APART)


def pressures_with(measured: Any, asked: Any) -> Any:
    """Requested pressures and the measured ones that are not among them, away from zero; for types to judge."""
    if asked is None:
        asked = []
    lists = (measured, asked if isinstance(asked, list) else [asked])
    if not all(isinstance(p, int | float) and not isinstance(p, bool) for some in lists for p in some):
        return asked
    found = list(lists[1])
    found += [p for k, p in enumerate(measured) if p and not any(same(p, other) for other in (*found, *measured[:k]))]
    return sorted(found, key=abs)


def read_file(path: Path) -> dict[str, list[float]]:
    """Columns of a file of measured values.

    Raises
    ------
    SceneError
        If it cannot be read, or a column or a number is missing.
    """
    where = f"compare.file = {str(path)!r}"
    header, lines = read_table(path, where)
    wanted = [name for name in (PRESSURE, *VALUES) if name in header]
    if PRESSURE not in wanted or len(wanted) < 2 or not lines:
        raise SceneError(
            f"{where}: its header is {', '.join(header) or 'empty'}; wanted are {PRESSURE} and "
            f"{' or '.join(VALUES)}, and at least one line of numbers"
        )
    return {name: [number_in(line, header.index(name), where) for line in lines] for name in wanted}


def read_table(path: Path, where: str) -> tuple[list[str], list[list[str]]]:
    """Header and lines of a user's CSV file, their cells stripped; without empty lines and those that begin with #.

    Parameters
    ----------
    path
        The file; commas, semicolons or tabs part its columns.
    where
        Key and value that name it, for messages.

    Raises
    ------
    SceneError
        If it cannot be read.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
        lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
        delimiter = max(DELIMITERS, key=lines[0].count) if lines else ","
        table = [[cell.strip() for cell in line] for line in csv.reader(lines, delimiter=delimiter)]
    except (OSError, ValueError, csv.Error) as error:
        raise SceneError(f"{where}: cannot be read ({error})") from None
    return (table[0], table[1:]) if table else ([], [])


def number_in(line: Sequence[str], place: int, where: str) -> float:
    """The finite number in a cell of a line.

    Raises
    ------
    SceneError
        If there is none.
    """
    text = line[place] if place < len(line) else ""
    try:
        found = float(text)
    except ValueError:
        found = math.nan
    if not math.isfinite(found):
        raise SceneError(f"{where}: {text!r} in the line {', '.join(line)!r} is no number: decimals have a point")
    return found


def with_measured(data: Mapping[str, Any], place: Path) -> dict[str, Any]:
    """The contents of a scene's file with those of the file of measured values.

    Raises
    ------
    SceneError
        From `read_file`.
    """
    compare = data.get("compare")
    if not isinstance(compare, dict) or not isinstance(compare.get("file"), str) or PRESSURE in compare:
        return dict(data)
    return {**data, "compare": {**compare, **read_file(place / compare["file"])}}


def self_contained(text: str, compare: Compare | None) -> str:
    """A scene file's text with the measured values in it, as it is kept beside results."""
    if compare is None or compare.file is None:
        return text
    document = tomlkit.parse(text)
    for name in (PRESSURE, *VALUES):
        if getattr(compare, name) is not None:
            document["compare"][name] = getattr(compare, name)  # type: ignore[index]
    return tomlkit.dumps(document)
