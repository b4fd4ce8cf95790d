"""How a cell ended, held against what is known of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from studies.stability.cells import Cell, Round
from studies.stability.exact import exact_answer
from studies.stability.paths import End
from studies.stability.references import Reference

Verdict = Literal["right", "refusal", "stop", "wrong"]

# What an answer may be off, percent: the default tolerance of a scene, on the coarsest meshes that scenes get. The
# pressure in a wall is not asked of a scene; this much of its largest value tells a wrong one from a coarse one.
TOLERANCE_PERCENT = 1.0
PRESSURE_TOLERANCE_PERCENT = 10.0
# Ranks and threads may change a value by this, percent.
SAME_PERCENT = 1e-6
CRASH = "crash"


@dataclass(frozen=True)
class Outcome:
    """How a cell ended.

    Attributes
    ----------
    verdict
        ``right``: at the requested load and within the tolerance of what is known; ``refusal``: nothing solved, reason
        named; ``stop``: ended before the load, cause and reason named; ``wrong``: anything else, a crash included.
    share
        Highest load reached over what is known to be reachable (at most the requested load).
    value_mm, reference_mm, source
        Bore or tip, what it is compared with and where that is from; NaN and empty if there is none.
    error_percent
        Of the value.
    reached_kpa
        Highest load reached.
    cause, reason
        Of a refusal, a stop or a wrong answer.
    pressure_error_percent
        Root mean square error of the pressure in the wall over its largest value; NaN if it is not known.
    unstable
        Unstable modes in the last state; -1 if not counted.
    seconds
        Wall time.
    """

    verdict: Verdict
    share: float = math.nan
    value_mm: float = math.nan
    reference_mm: float = math.nan
    source: str = ""
    error_percent: float = math.nan
    reached_kpa: float = 0.0
    cause: str = ""
    reason: str = ""
    pressure_error_percent: float = math.nan
    unstable: int = -1
    seconds: float = 0.0


def crash(reason: str) -> Outcome:
    """The outcome of what broke."""
    return Outcome("wrong", cause=CRASH, reason=reason)


@dataclass(frozen=True)
class _Known:
    """What is known of a cell: its value and how far that may be missed, how far it can be loaded, unstable modes."""

    value_mm: float
    tolerance_percent: float
    reachable_kpa: float
    source: str
    unstable: int = -1


def judge(cell: Cell, end: End, reference: Reference | None, alone_mm: float) -> Outcome:
    """The verdict on the end of a cell's path.

    Parameters
    ----------
    reference
        Of a bellows.
    alone_mm
        The value on one rank and one thread, for a cell of more; else NaN.
    """
    known = _known(cell, reference)
    reachable = min(abs(cell.load_kpa), known.reachable_kpa)
    error = 100.0 * (end.value_mm - known.value_mm) / abs(known.value_mm)
    faults = _faults(end, error, known, alone_mm)
    wrong = "wrong answer" if faults else ""
    return Outcome(
        "stop" if end.reason else "wrong" if faults else "right",
        share=end.reached_kpa / reachable if reachable > 0.0 else math.nan,
        value_mm=end.value_mm,
        reference_mm=known.value_mm,
        source=known.source,
        error_percent=error,
        reached_kpa=end.reached_kpa,
        cause=end.cause if end.reason else wrong,
        reason=end.reason or "; ".join(faults),
        pressure_error_percent=end.pressure_error_percent,
        unstable=end.unstable,
    )


def _faults(end: End, error_percent: float, known: _Known, alone_mm: float) -> list[str]:
    """What is wrong with a value at the requested load."""
    faults = []
    if not abs(error_percent) <= known.tolerance_percent:
        off = math.isfinite(error_percent)
        faults.append(f"{error_percent:.3g} % off" if off else "reached a load that nothing else reaches")
    if end.pressure_error_percent > PRESSURE_TOLERANCE_PERCENT:
        faults.append(f"pressure in the wall {end.pressure_error_percent:.3g} % off")
    if end.unstable > known.unstable >= 0:
        faults.append(f"{end.unstable} unstable modes, {known.unstable} on finer meshes")
    change_percent = 100.0 * (end.value_mm / alone_mm - 1.0)
    if math.isfinite(alone_mm) and abs(change_percent) > SAME_PERCENT:
        faults.append(f"{change_percent:.3g} % from one rank and thread")
    return faults


def _known(cell: Cell, reference: Reference | None) -> _Known:
    if isinstance(cell.body, Round):
        answer = exact_answer(cell.body, 1e-3 * cell.load_kpa)
        return _Known(answer.bore_mm, TOLERANCE_PERCENT, 1e3 * abs(answer.reachable_mpa), f"exact {cell.body.kind}")
    load = abs(cell.load_kpa)
    if reference is None:
        return _Known(math.nan, TOLERANCE_PERCENT, load, "")
    tip = reference.tip_mm.get(load, math.nan)
    more = 100.0 * reference.uncertainty_mm.get(load, math.nan) / abs(tip)
    unstable = reference.unstable.get(load, -1)
    return _Known(tip, TOLERANCE_PERCENT + more, reference.reached_kpa, "converged on finer meshes", unstable)
