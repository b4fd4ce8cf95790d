"""Numbers in pages, from the rows of the kept reports: `value`, `banded` and `percent` between double braces."""

from __future__ import annotations

import functools
import math
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined

from studies.report.numbers import up
from studies.results.provenance import ROOT
from studies.results.rows import Row, difference_percent, read_rows

DOCS = ROOT / "docs"
# Meshes that the paper study has for the audit of its uncertainties only: they answer nothing.
_FOR_AUDIT = ("r3", "r8", "n12r3", "n24r3")


class ValueMissing(KeyError):
    """A page asks for a number that no row has."""


@functools.cache
def rows_of(study: str, docs: Path = DOCS) -> tuple[Row, ...]:
    """The kept rows of a study."""
    return tuple(read_rows(docs / study / "rows.csv"))


def find(
    study: str, scene: str, quantity: str, model: str, pressure_kpa: float | None = None, level: str | None = None
) -> Row:
    """The last row that fits: of the finest mesh that is not for an audit only, or the extrapolated one.

    Raises
    ------
    ValueMissing
        If none does.
    """
    for row in reversed(rows_of(study)):
        here = math.isnan(row.pressure_kpa) if pressure_kpa is None else row.pressure_kpa == pressure_kpa
        wanted = row.level == level if level else not (study == "paper" and row.level in _FOR_AUDIT)
        if here and wanted and (row.scene, row.quantity, row.model) == (scene, quantity, model):
            return row
    asked = f"{quantity} of {scene}, {model}, at {pressure_kpa} kPa, level {level}"
    raise ValueMissing(f"docs/{study}/rows.csv: no {asked}")


def value(*where: Any, digits: int = 2, **further: Any) -> str:
    """A number of a row, which is said as to `find`."""
    return _typeset(find(*where, **further).value, digits)


def banded(*where: Any, digits: int = 2, **further: Any) -> str:
    """A number with its uncertainty, which is rounded up; said as to `find`."""
    row = find(*where, **further)
    doubt = "" if math.isnan(row.uncertainty) else f" ± {up(row.uncertainty, digits)}"
    return _typeset(row.value, digits) + doubt


def percent(
    study: str,
    scene: str,
    quantity: str,
    model: str,
    reference: str,
    pressure_kpa: float | None = None,
    digits: int = 1,
) -> str:
    """The difference of a model from another, in percent of the other."""
    one, other = (find(study, scene, quantity, name, pressure_kpa).value for name in (model, reference))
    return f"{difference_percent(one, other):+.{digits}f}".replace("-", "−")


def _typeset(number: float, digits: int) -> str:
    return f"{number:.{digits}f}".replace("-", "−")


def filled(text: str) -> str:
    """A page with its numbers filled in.

    Raises
    ------
    ValueMissing
        If a number is not there.
    """
    environment = Environment(undefined=StrictUndefined, keep_trailing_newline=True)
    environment.globals |= {"value": value, "banded": banded, "percent": percent}
    return environment.from_string(text).render()
