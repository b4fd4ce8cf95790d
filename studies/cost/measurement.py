"""What one cell of the cost study cost."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final

# To be raised when something else is measured, so that what was measured before is not taken for it.
MEASURED_AS: Final = 1
# Share of its wall time in which other processes may compute without disturbing a measurement.
QUIET: Final = 0.1


@dataclass(frozen=True)
class Measurement:
    """What one cell cost, and its answer.

    Attributes
    ----------
    value, pressure_kpa
        The tip's (bellows) or the bore's (tube) displacement at the highest requested pressure, mm; NaN if not reached.
    wall_s, work_s
        From start to end of the process, and without start, imports and end.
    cpu_s
        User and system time of all ranks, start and imports included.
    peak_mb
        Peak resident memory of all ranks.
    compile_s
        How much longer the same run takes with an empty cache of compiled forms; NaN where that was not measured.
    split_s
        Wall seconds by activity; ``axisymmetric start`` is the whole of the run that a warm body starts from.
    status
        ``reached``, or why not.
    others_s
        CPU seconds that other processes, or other machines on the same host, took meanwhile; NaN if not known.
    """

    value: float
    pressure_kpa: float
    wall_s: float
    work_s: float
    cpu_s: float
    peak_mb: float
    unknowns: int
    factorisations: int
    compile_s: float
    split_s: dict[str, float] = field(hash=False)
    status: str
    others_s: float = math.nan

    @property
    def disturbed(self) -> bool:
        """True unless others are known to have left the machine to it."""
        return is_disturbed(self.others_s, self.wall_s)


def is_disturbed(others_s: float, wall_s: float) -> bool:
    """True unless others are known to have taken a small share of the wall time only."""
    return not others_s <= QUIET * wall_s
