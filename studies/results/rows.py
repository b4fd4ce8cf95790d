"""Comparison rows: one row per number; every table, plot and verdict is rendered from them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, fields
from pathlib import Path

from studies.results.csv_files import read_records, write_records

REACHED = "reached"
# Of the printed closed form: the root has outgrown the crest, the number means nothing.
FOLDED_BACK = "reached, folded back"
# The load was reached, but the value is not as certain as was asked.
NOT_MET = "tolerance not met"
# How names of ratios of run times begin, ours over other programs', and how those end in which their runs on a quarter
# of the body count too.
TIME_RATIO = "time_ratio_"
ON_QUARTERS = "_with_quarters"
# Stands, with its pressure, in the status of a state beyond a limit point.
AFTER_SNAP = "after a snap"


@dataclass(frozen=True)
class Row:
    """One number and what it is compared with.

    Attributes
    ----------
    scene
        Name of the scene.
    quantity, unit
        For instance ``tip_mm`` and ``mm``.
    pressure_kpa
        Cavity pressure.
    model
        ``closed_form``, ``closed_form_printed``, ``closed_form_balanced``, ``closed_form_seat``,
        ``closed_form_outline``, ``axisymmetric``, ``sector``, ``full3d``, ``paper_…`` for printed values, ``material``
        for laws, ``exact`` for exact solutions, ``measured`` for the scene's own measured values.
    level
        Mesh or variant within the model, for instance ``r4`` or ``n24``, or ``extrapolated``: what its meshes lead to;
        empty if there is one only.
    value
        The number; NaN if it was not reached.
    uncertainty
        Discretisation uncertainty in the same unit; NaN where the model has none (closed form, print) or no mesh tells
        it. Of values that were measured more than once half their range.
    reference, source
        The value it is compared with and where that comes from; NaN and empty if it is compared with nothing.
    error_percent
        100 (value - reference) / |reference|; NaN without a reference.
    status
        ``reached`` (and, of a closed form, in which state if not folded, or beyond a limit point after which snap),
        ``stopped at … kPa: why``, ``no state at … kPa: why``, or ``tolerance not met: ± … % reached, … % asked``.
    """

    scene: str
    quantity: str
    unit: str
    pressure_kpa: float
    model: str
    level: str
    value: float
    uncertainty: float
    reference: float
    source: str
    error_percent: float
    status: str


def row(
    scene: str,
    quantity: str,
    unit: str,
    pressure_kpa: float,
    model: str,
    value: float,
    level: str = "",
    uncertainty: float = math.nan,
    reference: float = math.nan,
    source: str = "",
    status: str = REACHED,
) -> Row:
    """Make a row and fill in its error in percent."""
    error = difference_percent(value, reference) if reference else math.nan
    return Row(scene, quantity, unit, pressure_kpa, model, level, value, uncertainty, reference, source, error, status)


def difference_percent(value: float, reference: float) -> float:
    """Difference of a value from its reference, in percent of the reference's size."""
    return 100.0 * (value - reference) / abs(reference)


def is_reached(entry: Row) -> bool:
    """True unless a run stopped before the row's pressure, or a closed form has no answer there; however certain."""
    return entry.status.startswith((REACHED, NOT_MET))


def snap_of(entry: Row) -> str:
    """After which snap a state is; empty if after none."""
    _, found, pressure = entry.status.partition(AFTER_SNAP)
    return found + pressure


def misses_tolerance(entry: Row) -> bool:
    """True for a value that is not as certain as was asked."""
    return entry.status.startswith(NOT_MET)


COLUMNS = tuple(f.name for f in fields(Row))


def write_rows(path: Path, rows: Iterable[Row]) -> None:
    """Write rows as CSV; numbers with nine digits, NaN as an empty field."""
    write_records(path, Row, rows, 9)


def read_rows(path: Path) -> list[Row]:
    """Read rows written by `write_rows`."""
    return read_records(path, Row, {"rung": "model"})  # the column's name before 0.2
