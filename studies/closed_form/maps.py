"""Maps of where the closed form stops being valid: over R_i and t at two pressures, and over the pressure.

What the four actuators share (R_p, e, n) is held; lengths are in mm, pressures in kPa.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytical.arrays import FloatArray
from analytical.bellows import paper
from analytical.bellows.chains import ClosedFormPath, closed_form
from analytical.bellows.dimensions import BellowsDesigns
from analytical.bellows.paper import LAWS, PaperActuator, Silicone
from studies.closed_form.chains import SILICONES
from studies.closed_form.effects import Effect
from studies.closed_form.plots import MapPanel

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


def panels(effect: Effect, maps: Sequence[SiliconeMaps], actuators: Sequence[PaperActuator]) -> list[list[MapPanel]]:
    """Rows of panels, one per silicone: the map at each pressure, then the section over the pressure."""
    found = []
    for one in maps:
        places = {a.name.removeprefix("heung-"): _place(a) for a in actuators if a.silicone == one.silicone}
        found.append([*_planes(effect, one, places), _section(effect, one, places)])
    return found


def _place(actuator: PaperActuator) -> tuple[float, float]:
    """Where an actuator is on the map: t / R_i and R_p / R_i."""
    d = actuator.dimensions
    return d.wall_mm / d.root_radius_mm, d.crest_radius_mm / d.root_radius_mm


def _planes(effect: Effect, one: SiliconeMaps, places: Mapping[str, tuple[float, float]]) -> list[MapPanel]:
    modulus_kpa, percent = 1e3 * one.plane.law.initial_shear_modulus_mpa, effect.percent(one.plane)
    return [
        MapPanel(
            title=f"{SILICONES[one.silicone]}, {pressure:g} kPa = {pressure / modulus_kpa:.3f} μ",
            x_label="$t / R_i$",
            y_label="$R_p / R_i$",
            x=WALL_OVER_ROOT,
            y=CREST_OVER_ROOT,
            percent=percent[..., k].T,
            unfolded=(pressure - one.plane.unfolding_pressure_kpa[..., 0]).T,
            points=places,
        )
        for k, pressure in enumerate(MAP_PRESSURES_KPA)
    ]


def _section(effect: Effect, one: SiliconeMaps, places: Mapping[str, tuple[float, float]]) -> MapPanel:
    modulus_kpa = 1e3 * one.section.law.initial_shear_modulus_mpa
    return MapPanel(
        title=f"{SILICONES[one.silicone]}, $R_p / R_i$ = {SECTION:g}",
        x_label="$t / R_i$",
        y_label="pressure / μ",
        x=WALL_OVER_ROOT,
        y=SWEEP_KPA / modulus_kpa,
        percent=effect.percent(one.section).T,
        unfolded=(SWEEP_KPA - one.section.unfolding_pressure_kpa).T,
        lines={name: wall for name, (wall, crest) in places.items() if np.isclose(crest, SECTION)},
        right_axis=(modulus_kpa, "pressure, kPa"),
    )
