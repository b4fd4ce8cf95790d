"""Maps of where the closed form stops being valid: over R_i and t at two pressures, and over the pressure.

What the four actuators share (R_p, e, n) is held; lengths are in mm, pressures in kPa.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytical.arrays import FloatArray
from analytical.bellows import paper
from analytical.bellows.chains import ClosedFormPath, closed_form
from analytical.bellows.dimensions import BellowsDesigns
from analytical.bellows.paper import LAWS, PaperActuator, Silicone

# Our choice of the range: the four actuators lie well inside, walls of one fold never touch (t < e).
WALL_OVER_ROOT: Final = np.linspace(0.1, 0.5, 41)
CREST_OVER_ROOT: Final = np.linspace(1.2, 2.6, 57)
MAP_PRESSURES_KPA: Final = (10.0, 20.0)
# Ratio R_p / R_i of the maps over pressure: that of the two actuators with R_i = 5 mm.
SECTION: Final = paper.REFERENCE_FAMILY.crest_radius_mm / paper.PRINTED_ROOT_RADIUS_MM
# Pressures of the sections and of the sentences: to a quarter of a kPa, up to where the report's plots end.
SWEEP_KPA: Final = np.arange(0.25, 25.01, 0.25)


@dataclass(frozen=True, eq=False)
class SiliconeMaps:
    """The corrected chain over the designs, for one silicone.

    Attributes
    ----------
    silicone
        Of which.
    plane
        Path over t / R_i, then R_p / R_i, at `MAP_PRESSURES_KPA`; shape (41, 57, 2).
    section
        Path over t / R_i at R_p / R_i = `SECTION`, then `SWEEP_KPA`; shape (41, 100).
    """

    silicone: Silicone
    plane: ClosedFormPath
    section: ClosedFormPath

    @property
    def modulus_kpa(self) -> float:
        """Initial shear modulus."""
        return 1e3 * self.plane.law.initial_shear_modulus_mpa


def silicone_maps(silicone: Silicone) -> SiliconeMaps:
    """The corrected chain over the designs for a silicone; Dragon Skin 30 as in eq. (3)."""
    law = LAWS[silicone]
    plane = closed_form(_designs(WALL_OVER_ROOT[:, None], CREST_OVER_ROOT), law, MAP_PRESSURES_KPA)
    section = closed_form(_designs(WALL_OVER_ROOT, np.asarray(SECTION)), law, SWEEP_KPA)
    return SiliconeMaps(silicone, plane, section)


def _designs(wall_over_root: FloatArray, crest_over_root: FloatArray) -> BellowsDesigns:
    """Designs with the family's R_p, e and n."""
    family = paper.REFERENCE_FAMILY
    root = family.crest_radius_mm / crest_over_root
    return BellowsDesigns(
        root, family.crest_radius_mm, wall_over_root * root, family.half_pitch_mm, family.convolutions
    )


def held_sizes() -> str:
    """What the maps hold, in words."""
    family = paper.REFERENCE_FAMILY
    return (
        f"R<sub>p</sub> = {family.crest_radius_mm:g} mm, e = {family.half_pitch_mm:g} mm, n = {family.convolutions}, "
        "as in the four actuators"
    )


def places(silicone: Silicone, actuators: Sequence[PaperActuator]) -> dict[str, tuple[float, float]]:
    """Where a silicone's actuators are on the map: t / R_i and R_p / R_i by short name."""
    sizes = {a.name.removeprefix("heung-"): a.dimensions for a in actuators if a.silicone == silicone}
    return {name: (d.wall_mm / d.root_radius_mm, d.crest_radius_mm / d.root_radius_mm) for name, d in sizes.items()}
