"""The gap between finite elements and closed form, split into causes, each found on its own.

Outlines are changed one thing at a time in finite elements, from the outline as moulded to the one nearest to what the
closed form is given. In the last of them every input of equation (23), see `studies.outline.kinematics`, is measured,
and what is longer there that the equation does not know. Where inputs act together a cause counts half of what it
changes beside the closed form's inputs and half of what it changes beside the measured ones: it has no place in an
order, and nothing is a remainder. So the causes need not sum to the gap; what is left over is shown.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from analytical.bellows.chains import closed_form
from analytical.bellows.chains_by_name import PRESSURES_KPA
from analytical.bellows.dimensions import with_seat
from analytical.bellows.paper import PaperActuator
from studies.outline.cases import FILLETS, MOULDED, RIGID_TIP, SAME_WALL, ZIGZAG, Outline
from studies.outline.kinematics import Fold, Steps, each_alone, kinematics_mm, stretch_beside_hoop
from studies.results.rows import Row
from studies.results.runs import MERIDIAN_ORDERS
from studies.results.uncertainty import convergence

CAUSES: Final[Mapping[str, str]] = {
    "root": "the root opens further than the plane-strain tube, or than where it is held",
    "hoop": "hoop stretch of the side wall, which thins and shortens it",
    "wall": "the side wall stretches otherwise: statics, bending",
    "pitch": "half pitch less half the seat of 0.5 mm",
    "bends": "bends: what the wall is longer than straight, less what is not straight yet",
    "middle": "depth of the fold between middle lines, not outsides",
    "ends": "seats, collars and tip lengthen",
    "cap": "silicone cap, not a rigid plate",
    "free_pitch": "half pitch less half the seat of 4 instead of 0.5 mm: a steeper wall",
    "ring": "rings 4 instead of 0.5 mm wide, on the same free wall",
    "fillets": "fillets of 0.5 instead of 0.1 mm",
}
# Outlines from the one as moulded to the one that is measured, and the causes between neighbours.
ONE_AT_A_TIME: Final = (MOULDED, FILLETS, SAME_WALL, ZIGZAG, RIGID_TIP)
_BETWEEN: Final = ("fillets", "ring", "free_pitch", "cap")
# What the outline as moulded adds to the one near the zigzag.
OF_OUTLINE: Final = ("free_pitch", "ring", "fillets")
LEVELS: Final = (1, 2)


@dataclass(frozen=True)
class Cause:
    """Part of a gap and its band, mm."""

    value: float
    band: float


@dataclass(frozen=True)
class Split:
    """The gap of an actuator at a pressure, mm.

    Attributes
    ----------
    closed_form_mm, elements_mm, uncertainty_mm
        Both elongations, and the band of the finite elements of the outline as moulded.
    causes
        By name, see `CAUSES`.
    both_ends_mm
        Of each input of eq. (23): what it changes beside the closed form's other inputs, and beside the measured ones.
    held
        True if the closed form holds the root at full unfolding.
    """

    actuator: PaperActuator
    pressure_kpa: float
    closed_form_mm: float
    elements_mm: float
    uncertainty_mm: float
    causes: Mapping[str, Cause]
    both_ends_mm: Mapping[str, tuple[float, float]]
    held: bool

    @property
    def gap_mm(self) -> float:
        """What is split."""
        return self.elements_mm - self.closed_form_mm

    @property
    def left_over_mm(self) -> float:
        """The gap less all causes."""
        return self.gap_mm - self.sum_mm(*self.causes)

    def sum_mm(self, *names: str) -> float:
        """Sum of causes."""
        return sum(self.causes[name].value for name in names)

    @property
    def sums_up(self) -> bool:
        """Whether the causes sum to the gap within the gap's band."""
        return abs(self.left_over_mm) <= self.uncertainty_mm


@dataclass(frozen=True)
class Part:
    """Causes on one mesh, mm, and both sides of those that act together."""

    causes_mm: Mapping[str, float]
    both_ends_mm: Mapping[str, tuple[float, float]]


class Found:
    """What finite elements found of an actuator's outlines."""

    def __init__(self, rows: Sequence[Row], actuator: PaperActuator) -> None:
        self._actuator = actuator
        self._rows = {(r.scene, r.quantity, r.pressure_kpa, r.level): r for r in rows if r.model == "axisymmetric"}

    def row(self, outline: Outline, quantity: str, pressure_kpa: float, level: int = LEVELS[-1]) -> Row | None:
        """A row; None if there is none."""
        return self._rows.get((f"{self._actuator.name}-{outline.name}", quantity, pressure_kpa, f"r{level}"))

    def value(self, outline: Outline, quantity: str, pressure_kpa: float, level: int = LEVELS[-1]) -> float:
        """Its value; NaN if there is none."""
        found = self.row(outline, quantity, pressure_kpa, level)
        return math.nan if found is None else found.value


def splits(rows: Sequence[Row], actuator: PaperActuator, outlines: Sequence[Outline] = ONE_AT_A_TIME) -> list[Split]:
    """The gap of an actuator at the paper's pressures; NaN where a state is missing.

    Parameters
    ----------
    outlines
        From the one as moulded to the one that is measured.
    """
    found = Found(rows, actuator)
    parts = [[_part(found, actuator, pressure, outlines, n) for n in LEVELS] for pressure in PRESSURES_KPA]
    names = [name for name in CAUSES if name in parts[0][0].causes_mm]
    causes = {name: _with_bands([[part.causes_mm[name] for part in at] for at in parts]) for name in names}
    chain = closed_form(actuator.dimensions, actuator.law, PRESSURES_KPA)
    out = []
    for k, pressure in enumerate(PRESSURES_KPA):
        moulded = found.row(MOULDED, "tip_mm", pressure)
        out.append(
            Split(
                actuator,
                pressure,
                float(chain.elongation_mm[k]),
                moulded.value if moulded else math.nan,
                moulded.uncertainty if moulded else math.nan,
                {name: causes[name][k] for name in names},
                parts[k][-1].both_ends_mm,
                bool(chain.state[k] == "fully unfolded"),
            )
        )
    return out


def _with_bands(by_pressure: Sequence[Sequence[float]]) -> list[Cause]:
    """A cause at ascending pressures, from its values on the meshes.

    A difference of runs on the same meshes shares most of their error, so its band is taken from the difference on each
    mesh, not from the bands of both. Meshes may agree by accident where they cross on the way: the band is not less
    than at a lower pressure.
    """
    sizes = [1.0 / n for n in LEVELS]
    bands = [convergence(sizes, values, MERIDIAN_ORDERS).uncertainty(values[-1]) for values in by_pressure]
    at_least = np.fmax.accumulate(bands)
    return [Cause(values[-1], float(band)) for values, band in zip(by_pressure, at_least, strict=True)]


def _part(found: Found, actuator: PaperActuator, pressure_kpa: float, outlines: Sequence[Outline], level: int) -> Part:
    """Causes on one mesh."""

    def of(quantity: str, outline: Outline = outlines[-1]) -> float:
        return found.value(outline, quantity, pressure_kpa, level)

    d, chain = actuator.dimensions, closed_form(actuator.dimensions, actuator.law, pressure_kpa)
    root, wall, line = of("root_stretch_outer"), of("wall_stretch"), of("fold_line_mm")
    beside_hoop = stretch_beside_hoop(actuator.law, float(chain.wall_stress_mpa[0]), of("wall_hoop_stretch_middle"))
    free = with_seat(d, outlines[-1].seat_mm)
    given = Fold(float(chain.root_stretch[0]), float(chain.wall_stretch[0]), d.side_length_mm, d.half_pitch_mm)
    factors: Sequence[Steps] = (
        [("root", {"root_stretch": root})],
        [("hoop", {"wall_stretch": beside_hoop}), ("wall", {"wall_stretch": wall})],
        [
            ("pitch", {"length_mm": free.side_length_mm, "half_pitch_mm": free.half_pitch_mm}),
            ("bends", {"length_mm": line}),
        ],
    )
    together = each_alone(d, given, factors)
    causes = {name: 0.5 * (low + high) for name, (low, high) in together.items()}
    straight = Fold(root, wall, line, free.half_pitch_mm)
    between_middles = kinematics_mm(d, straight, of("fold_across_mm"))
    causes["bends"] -= between_middles - 2.0 * d.convolutions * (of("fold_along_mm") - free.half_pitch_mm)
    causes["middle"] = between_middles - kinematics_mm(d, straight)
    causes["ends"] = of("seats_longer_mm") + of("collars_longer_mm")
    tips = [of("tip_mm", outline) for outline in outlines]
    causes |= {name: before - after for name, (before, after) in zip(_BETWEEN, pairwise(tips), strict=False)}
    return Part(causes, together)
