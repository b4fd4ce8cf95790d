"""Rows of the peer study: what each run came to and cost, then ratios of times."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from studies.peers.cases import OURS
from studies.peers.fronts import Point, floored, lasting, ratio_at_equal_error, ratio_to_fastest
from studies.peers.measure import Measurement
from studies.results.rows import REACHED, Row, row

# What our own must hold, percent.
ALLOWED_PERCENT: Final = 1.0
# The reference is known to this, percent: what the finest triangles with meshed rings and the finest quadrilaterals
# with rigid ones differ by, with room (0.0125 at 10 kPa on r8).
REFERENCE_PERCENT: Final = 0.02
RATIO: Final = "time_ratio_"
_MODELS: Final = {3: "full3d", 2: "axisymmetric"}


def comparison_rows(
    scene: str, pressure_kpa: float, reference_mm: float, source: str, measured: Sequence[Measurement]
) -> list[Row]:
    """Rows of all measurements, then the ratios."""
    rows = [r for m in measured for r in measurement_rows(scene, pressure_kpa, reference_mm, source, m)]
    reached = [m for m in measured if not math.isnan(m.tip_mm)]
    errors = [100.0 * abs(m.tip_mm / reference_mm - 1.0) for m in reached]
    for dimension in _MODELS:
        for kind, found in (("", errors), ("_by_lasting_error", _lasting(reached, errors))):
            rows += _ratio_rows(scene, pressure_kpa, dimension, kind, reached, found)
    return rows


def measurement_rows(scene: str, pressure_kpa: float, reference_mm: float, source: str, m: Measurement) -> list[Row]:
    """Rows of one run."""
    model = _MODELS[m.dimension] if m.code == OURS else f"peer_{m.code}"
    status = m.reason or REACHED
    costs = {
        "wall_s": ("s", m.wall_s),
        "cpu_s": ("s", m.cpu_s),
        "peak_mb": ("MB", m.peak_mb),
        "unknowns": ("1", float(m.unknowns)),
        "lines_to_write": ("1", float(m.lines)),
    }
    return [
        row(
            scene,
            "tip_mm",
            "mm",
            pressure_kpa,
            model,
            m.tip_mm,
            m.label,
            reference=reference_mm,
            source=source,
            status=status,
        ),
        *(
            row(scene, cost, unit, pressure_kpa, model, value, m.label, status=status)
            for cost, (unit, value) in costs.items()
        ),
    ]


def _ratio_rows(
    scene: str,
    pressure_kpa: float,
    dimension: int,
    kind: str,
    reached: Sequence[Measurement],
    errors_percent: Sequence[float],
) -> list[Row]:
    """Our time over the peers': to the fastest of them, and at equal error."""
    points: dict[str, list[Point]] = {}
    for m, error in zip(reached, errors_percent, strict=True):
        if m.dimension == dimension:
            points.setdefault(m.code, []).append(Point(m.wall_s, error))
    every = {code: floored(of, REFERENCE_PERCENT) for code, of in points.items()}
    mine = every.pop(OURS, [])
    error, equal = ratio_at_equal_error(mine, every)
    model = _MODELS[dimension]
    ratios = (
        (f"{RATIO}{model}_to_fastest_peer{kind}", ratio_to_fastest(mine, every, ALLOWED_PERCENT), ""),
        (f"{RATIO}{model}_at_equal_error{kind}", equal, f"{error:.3g} %"),
    )
    return [
        row(scene, quantity, "1", pressure_kpa, model, ratio, level, status=_known(ratio))
        for quantity, ratio, level in ratios
    ]


def _lasting(measured: Sequence[Measurement], errors: Sequence[float]) -> list[float]:
    """Errors that finer meshes of the same code, cells and settings do not exceed."""
    found = list(errors)
    for family in {_family(m) for m in measured}:
        same = [k for k, m in enumerate(measured) if _family(m) == family]
        same.sort(key=lambda k: measured[k].unknowns)
        for k, error in zip(same, lasting([errors[k] for k in same]), strict=True):
            found[k] = error
    return found


def _family(m: Measurement) -> tuple[str, int, str]:
    """What is alike in runs that differ in their mesh only."""
    if m.code == OURS:
        return m.code, m.dimension, m.label.partition(",")[0]
    mesh, _, settings = m.label.partition(" ")
    return m.code, m.dimension, f"{mesh.partition('-')[0]} {settings}"


def _known(ratio: float) -> str:
    return "not measured: no run of ours or of a peer" if math.isnan(ratio) else REACHED
