"""Rows of the peer study: what each run came to and cost, then ratios of times."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from studies.peers.cases import OURS, Attempt
from studies.peers.fronts import Point, floored, lasting, ratio_at_equal_error, ratio_to_fastest
from studies.peers.measure import Measurement
from studies.results.rows import ON_QUARTERS, REACHED, TIME_RATIO, Row, row

# What our own must hold, percent.
ALLOWED_PERCENT: Final = 1.0
# The reference is known to this, percent, with room: its mesh and the one before differ by 0.0044, quadrilaterals on r8
# with rigid rings and it by 0.0062, triangles on r8, still on their way there, and it by 0.016 (docs/decisions.md).
REFERENCE_PERCENT: Final = 0.02
_MODELS: Final = {3: "full3d", 2: "axisymmetric"}
Runs = Sequence[tuple[Attempt, Measurement]]


def comparison_rows(scene: str, pressure_kpa: float, reference_mm: float, source: str, measured: Runs) -> list[Row]:
    """Rows of all runs, then the ratios."""
    rows = []
    for attempt, m in measured:
        model = _MODELS[attempt.dimension] if attempt.code == OURS else f"peer_{attempt.code}"
        numbers = (
            ("tip_mm", "mm", m.tip_mm, reference_mm, source),
            ("wall_s", "s", m.wall_s, math.nan, ""),
            ("cpu_s", "s", m.cpu_s, math.nan, ""),
            ("peak_mb", "MB", m.peak_mb, math.nan, ""),
            ("unknowns", "1", float(m.unknowns), math.nan, ""),
            ("lines_to_write", "1", float(m.lines), math.nan, ""),
        )
        rows += [
            row(
                scene,
                quantity,
                unit,
                pressure_kpa,
                model,
                value,
                attempt.label,
                reference=reference,
                source=where,
                status=m.reason or REACHED,
            )
            for quantity, unit, value, reference, where in numbers
        ]
    reached = [(attempt, m) for attempt, m in measured if not math.isnan(m.tip_mm)]
    # two digits: the reference is known to no more, and alike meshes shall have equal errors
    errors = [float(f"{100.0 * abs(m.tip_mm / reference_mm - 1.0):.2g}") for _, m in reached]
    for kind, found in (("", errors), ("_by_lasting_error", lasting_errors(reached, errors))):
        points = [
            (attempt, Point(m.wall_s, error))
            for (attempt, m), error in zip(reached, found, strict=True)
            if not math.isnan(error)
        ]
        whole = [(attempt, point) for attempt, point in points if not attempt.quarter]
        rows += _ratio_rows(scene, pressure_kpa, 2, kind, whole)
        rows += _ratio_rows(scene, pressure_kpa, 3, kind, whole)
        rows += _ratio_rows(scene, pressure_kpa, 3, kind + ON_QUARTERS, points)
    return rows


def _ratio_rows(
    scene: str,
    pressure_kpa: float,
    dimension: int,
    kind: str,
    measured: Sequence[tuple[Attempt, Point]],
) -> list[Row]:
    """Our time over the peers': to the fastest of them, and at equal error."""
    points: dict[str, list[Point]] = {}
    for attempt, point in measured:
        if attempt.dimension == dimension:
            points.setdefault(attempt.code, []).append(point)
    every = {code: floored(of, REFERENCE_PERCENT) for code, of in points.items()}
    mine = every.pop(OURS, [])
    error, equal = ratio_at_equal_error(mine, every)
    model = _MODELS[dimension]
    ratios = (
        (f"{TIME_RATIO}{model}_to_fastest_peer{kind}", ratio_to_fastest(mine, every, ALLOWED_PERCENT), ""),
        (f"{TIME_RATIO}{model}_at_equal_error{kind}", equal, f"{error:.3g} %"),
    )
    return [
        row(scene, quantity, "1", pressure_kpa, model, ratio, level, status=_known(ratio))
        for quantity, ratio, level in ratios
    ]


def lasting_errors(measured: Runs, errors: Sequence[float]) -> list[float]:
    """Errors that finer meshes of the same code, cells and settings do not exceed; NaN where no finer one was run."""
    found = list(errors)
    for family in {attempt.family for attempt, _ in measured}:
        same = [k for k, (attempt, _) in enumerate(measured) if attempt.family == family]
        same.sort(key=lambda k: measured[k][1].unknowns)
        for k, error in zip(same, lasting([errors[k] for k in same]), strict=True):
            found[k] = error if measured[k][1].unknowns < measured[same[-1]][1].unknowns else math.nan
    return found


def _known(ratio: float) -> str:
    return "not measured: no run of ours or of a peer" if math.isnan(ratio) else REACHED
