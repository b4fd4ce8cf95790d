"""What a core off the axis does to one of the actuators: the kept rows of the imperfection study, and if they fit here.

A study does not know another, so its rows are read as published data. They are of this actuator only as long as its
centred core has the elongation that is found here on the same mesh.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from studies.paper.cases import CONTROL_BODY, PRESSURES_KPA
from studies.paper.results import PaperResults, find, is_known
from studies.paper.setup.sizes import CALLED, scene_of
from studies.report.numbers import number_text, signed, typeset
from studies.results import provenance
from studies.results.rows import Row, difference_percent, read_rows

PUBLISHED: Final = provenance.ROOT / "docs" / "imperfection" / "rows.csv"
ACTUATOR: Final = CONTROL_BODY
CENTRED, OFF = f"{ACTUATOR}-e00", f"{ACTUATOR}-e10"
# Share of the wall by which the core is off in `OFF`.
SHARE: Final = 0.10
# Two runs of one code on one mesh end their Newton iterations within 1e-6 of each other, a finer mesh or another scene
# is 1e-3 and more away.
SAME_PERCENT: Final = 1e-3


def eccentric_core(results: PaperResults, file: Path = PUBLISHED) -> tuple[str, str]:
    """Sentences: how far the actuator bends and shortens, and whether the published runs are of today's actuator."""
    if not file.is_file():
        return "The rows of the imperfection study are not there.", ""
    published = read_rows(file)
    first, last = (
        f"{number_text(abs(_of(published, OFF, 'tip_bend_deg', p).value), '.1f')}° and "
        f"{signed(_change_percent(published, p))} % at {p:g} kPa"
        for p in (PRESSURES_KPA[0], PRESSURES_KPA[-1])
    )
    off_mm = SHARE * scene_of(ACTUATOR).geometry.wall_mm
    return (
        f"A core {off_mm:g} mm off the axis bends the actuator with {CALLED[ACTUATOR]} and changes its elongation: "
        f"{first}, {last}.",
        _fits(results, published),
    )


def _of(rows: Sequence[Row], scene: str, quantity: str, pressure_kpa: float) -> Row:
    return find([row for row in rows if row.scene == scene], quantity, "full3d", pressure_kpa)


def _change_percent(rows: Sequence[Row], pressure_kpa: float) -> float:
    """Elongation with the core off the axis less that with a centred core, percent."""
    off, centred = (_of(rows, scene, "tip_mm", pressure_kpa) for scene in (OFF, CENTRED))
    return difference_percent(off.value, centred.value) if is_known(centred) else math.nan


def _fits(results: PaperResults, published: Sequence[Row]) -> str:
    """Whether the published centred core is the actuator of this report."""
    gaps = []
    for pressure in PRESSURES_KPA:
        theirs = _of(published, CENTRED, "tip_mm", pressure)
        ours = results.named(CONTROL_BODY).tip("full3d", pressure, theirs.level)
        if is_known(ours) and is_known(theirs):
            gaps.append(difference_percent(theirs.value, ours.value))
    if not gaps:
        return "Whether those runs are of today's actuator cannot be told: no body of their mesh has been run."
    worst = max(gaps, key=abs)
    if abs(worst) <= SAME_PERCENT:
        return "Their centred core has the elongation of this report's body on the same mesh."
    return (
        f"Out of date: their centred core differs by {typeset(worst, '+.2g')} % from this report's body on the same "
        "mesh; `bellowsx study imperfection` runs them again."
    )
