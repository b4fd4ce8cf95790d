"""How numbers are written: signs, digits, uncertainties, times, and why there is none."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from studies.results.rows import NOT_MET, REACHED, Row, difference_percent, snap_of

MISSING, MINUS = "–", "\N{MINUS SIGN}"

# How the value of a quantity is written; the others with four digits. The # keeps zeros that end a number.
FORMATS: Mapping[str, str] = {"unstable_modes": ".0f", "min_det_f": "#.3g"}

_STOPPED = re.compile(r"(?:stopped|no state) at ([-+.\deE]+) kPa")


def is_printed(row: Row) -> bool:
    """True for a number that the paper prints."""
    return row.model.startswith("paper_")


def value_text(row: Row | None) -> str:
    """Tip, mm (or N, which is said), and its uncertainty; printed numbers with the digits they have."""
    if row is None:
        return MISSING
    if not math.isfinite(row.value):
        return short_status(row.status)
    if is_printed(row):
        return f"{row.value:g}"
    digits, unit = (3, " N") if row.unit == "N" else (2, "")
    text = f"{row.value:.{digits}f}"
    text = f"{text}{unit}" if math.isnan(row.uncertainty) else f"{text} ± {up(row.uncertainty, digits)}{unit}"
    state = short_status(row.status).removeprefix(REACHED).strip(", ")
    state = f"{state}, {snap_of(row)}" if state == NOT_MET and snap_of(row) else state
    return f"{text} ({state})" if state else text


def quantity_text(row: Row) -> str:
    """Any row's value, its uncertainty and what it is compared with; a dash where it was not determined."""
    if not math.isfinite(row.value):
        return MISSING if row.status == REACHED else short_status(row.status)
    text = format(row.value, FORMATS.get(row.quantity, ".4g"))
    if math.isfinite(row.uncertainty):
        text += f" ± {rounded_up(row.uncertainty, 2):.2g}"
    if math.isfinite(row.error_percent):
        text += f" ({signed(row.error_percent)} % from {row.reference:g})"
    return ", ".join(filter(None, [text, snap_of(row)]))


def short_status(status: str) -> str:
    """A status without its reason; the reason is listed below the table."""
    found = _STOPPED.match(status)
    return found[0] if found else NOT_MET if status.startswith(NOT_MET) else status


def number_text(value: float, form: str = ".4g", missing: str = MISSING) -> str:
    """A number written as for `format`; ``missing`` for NaN."""
    return missing if math.isnan(value) else format(value, form)


def typeset(value: float, form: str, missing: str = MISSING) -> str:
    """A number as `number_text` writes it, with a minus sign that is as long as a plus; no exponents."""
    return number_text(value, form, missing).replace("-", MINUS)


def signed(percent: float) -> str:
    """A percentage with its sign and as many decimals as it deserves."""
    return typeset(percent, "+.2f" if abs(percent) < 1.0 else "+.1f")


def measured_text(row: Row) -> str:
    """Any row's value with the decimals of its uncertainty; its status where there is none."""
    if not math.isfinite(row.value):
        return row.status.split(":")[0] if row.status != REACHED else MISSING
    if not row.uncertainty > 0.0:
        return f"{row.value:.4g}"
    decimals = min(max(1 - math.floor(math.log10(row.uncertainty)), 0), 4)
    return f"{row.value:.{decimals}f} ± {up(row.uncertainty, decimals)}"


def difference_text(row: Row, reference: Row, decimals: int = 2) -> str:
    """Signed difference of two rows in their unit, and in percent of the second; a dash where one has no number."""
    gap = row.value - reference.value
    if not math.isfinite(gap) or reference.value == 0.0:
        return MISSING
    return f"{typeset(gap, f'+.{decimals}f')} ({signed(difference_percent(row.value, reference.value))} %)"


def up(value: float, decimals: int) -> str:
    """An uncertainty rounded up, so that none reads as zero."""
    scale = 10.0**decimals
    return f"{math.ceil(value * scale - 1e-9) / scale:.{decimals}f}"


def rounded_up(value: float, digits: int) -> float:
    """The next number with so many significant digits that is not smaller."""
    if value == 0.0 or not math.isfinite(value):
        return value
    scale = 10.0 ** (digits - 1 - math.floor(math.log10(abs(value))))
    return math.ceil(value * scale - 1e-9) / scale


def count(number: int) -> str:
    """A whole number with its thousands set apart."""
    return f"{number:,}".replace(",", "\N{NARROW NO-BREAK SPACE}")


def short_time(seconds: float) -> str:
    """Seconds with as many decimals as they deserve."""
    return f"{seconds:.1f}" if seconds < 100.0 else f"{seconds:.0f}"


def duration(seconds: float) -> str:
    """A time as text, with the unit that suits it."""
    if seconds < 120.0:
        return f"{seconds:.1f} s"
    return f"{seconds / 60.0:.1f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"
