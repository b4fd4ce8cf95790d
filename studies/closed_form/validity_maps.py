"""Where the closed form stops being valid: what chains and assumptions are worth, over designs and pressures.

Every worth is a percentage of the corrected chain's elongation. The maps hold what the four actuators share (R_p, e, n)
and vary R_i and t; lengths are in mm, pressures in kPa.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytical.arrays import FloatArray
from analytical.bellows import paper
from analytical.bellows.chains import ClosedFormPath, closed_form
from analytical.bellows.dimensions import BellowsDesigns
from analytical.bellows.paper import PaperActuator, Silicone
from analytical.bellows.reading import BALANCED, PRINTED_READING, Reading
from analytical.bellows.validity import cap_bulge_mm, with_free_root, with_other_wall
from analytical.laws.isotropic import Law
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from studies.closed_form.plots import MapPanel
from studies.closed_form.tables import PRESSURES_KPA, SILICONES, actuator_columns, path_of
from studies.report.numbers import MISSING, signed
from studies.report.tables import Table
from studies.results.rows import Row, row

# Our choice of the range: the four actuators lie well inside, walls of one fold never touch (t < e).
WALL_OVER_ROOT: Final = np.linspace(0.1, 0.5, 41)
CREST_OVER_ROOT: Final = np.linspace(1.2, 2.6, 57)
MAP_PRESSURES_KPA: Final = (10.0, 20.0)
# Ratio R_p / R_i of the maps over pressure: that of the two actuators with R_i = 5 mm.
SECTION: Final = paper.REFERENCE_FAMILY.crest_radius_mm / paper.PRINTED_ROOT_RADIUS_MM
# Pressures of the sections and of the sentences: to a quarter of a kPa, up to where the report's plots end.
SWEEP_KPA: Final = np.arange(0.25, 25.01, 0.25)
# The cap of the scenes (docs: our choice, not printed), mm.
CAP_MM: Final = 5.0
# Differences beyond this are said in words.
LIMIT_PERCENT: Final = 10.0
LAWS: Final[dict[Silicone, Law]] = {"dragon-skin-10": DRAGON_SKIN_10, "dragon-skin-30": dragon_skin_30("2mu/alpha^2")}


@dataclass(frozen=True)
class Effect:
    """Something else than the corrected chain, and what it is compared as.

    Attributes
    ----------
    name
        Short name, also of its picture.
    title
        Heading.
    words
        What is put in place of what.
    other_mm
        Elongation with it, mm, from the corrected chain's path; shape of the path.
    """

    name: str
    title: str
    words: str
    other_mm: Callable[[ClosedFormPath], FloatArray]

    def percent(self, path: ClosedFormPath) -> FloatArray:
        """Change in percent of the corrected chain's elongation, shape of the path; NaN where there is no state."""
        elongation = path.elongation_mm
        return np.asarray(100.0 * (self.other_mm(path) - elongation) / elongation)


def _by_reading(reading: Reading) -> Callable[[ClosedFormPath], FloatArray]:
    def other(path: ClosedFormPath) -> FloatArray:
        pressures = path.pressure_kpa.reshape(-1, path.pressure_kpa.shape[-1])[0]
        return closed_form(path.dimensions, path.law, pressures, reading).elongation_mm

    return other


def _with_bulge(path: ClosedFormPath) -> FloatArray:
    radius = np.asarray(path.dimensions.crest_radius_mm, dtype=float)[..., None]
    return np.asarray(path.elongation_mm + cap_bulge_mm(radius, CAP_MM, path.law, path.pressure_kpa))


EFFECTS: Final[tuple[Effect, ...]] = (
    Effect(
        name="printed",
        title="Chain as printed",
        words="The printed chain instead of the corrected one: the misprints, all together.",
        other_mm=_by_reading(PRINTED_READING),
    ),
    Effect(
        name="balanced",
        title="Balanced chain",
        words="The balanced chain (mean cut) instead of the corrected one: the statics of the side wall.",
        other_mm=_by_reading(BALANCED),
    ),
    Effect(
        name="free-root",
        title="Root free of axial force",
        words="The root as a tube whose axial stretch is such that its wall carries no axial force, instead of plane "
        "strain.",
        other_mm=lambda path: with_free_root(path).elongation_mm,
    ),
    Effect(
        name="uniaxial-wall",
        title="Side wall in uniaxial tension",
        words="The side wall free in the hoop direction instead of pure shear (hoop stretch 1), under the same stress.",
        other_mm=lambda path: with_other_wall(path, "uniaxial").elongation_mm,
    ),
    Effect(
        name="hoop-stretched-wall",
        title="Side wall with the root's hoop stretch",
        words="The side wall with the hoop stretch that root and crest impose half way between them, instead of 1.",
        other_mm=lambda path: with_other_wall(path, "stretched by the root").elongation_mm,
    ),
    Effect(
        name="cap-bulge",
        title="Cap that bulges",
        words=f"The middle of a silicone cap of {CAP_MM:g} mm with radius R<sub>p</sub> instead of a rigid tip: linear "
        "theory of a clamped circular plate, incompressible, with D = μh³/3 and shear factor 5/6: "
        "w = PR⁴/(64D) + PR²/(4·(5/6)·μh). The rim of the cap does not take part.",
        other_mm=_with_bulge,
    ),
    Effect(
        name="no-saturation",
        title="Root not held at full unfolding",
        words="The root goes on widening past the crest and the bellows folds back, instead of being held there.",
        other_mm=_by_reading(Reading(folds_back=True)),
    ),
)


@dataclass(frozen=True, eq=False)
class SiliconeMaps:
    """The corrected chain over the designs, for one silicone.

    Attributes
    ----------
    silicone, law
        Of which.
    plane
        Path over t / R_i, then R_p / R_i, at `MAP_PRESSURES_KPA`; shape (41, 57, 2).
    section
        Path over t / R_i at R_p / R_i = `SECTION`, then `SWEEP_KPA`; shape (41, 100).
    """

    silicone: Silicone
    law: Law
    plane: ClosedFormPath
    section: ClosedFormPath


def silicone_maps(silicone: Silicone) -> SiliconeMaps:
    """The corrected chain over the designs for a silicone; Dragon Skin 30 as in eq. (3)."""
    law = LAWS[silicone]
    plane = closed_form(_designs(WALL_OVER_ROOT[:, None], CREST_OVER_ROOT), law, MAP_PRESSURES_KPA)
    section = closed_form(_designs(WALL_OVER_ROOT, np.asarray(SECTION)), law, SWEEP_KPA)
    return SiliconeMaps(silicone, law, plane, section)


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


# --- panels of the maps ---------------------------------------------------------------------


def panels(effect: Effect, maps: Sequence[SiliconeMaps], actuators: Sequence[PaperActuator]) -> list[list[MapPanel]]:
    """Rows of panels, one per silicone: the map at each pressure, then the section over the pressure."""
    return [
        [
            *(_plane_panel(effect, one, k, actuators) for k in range(len(MAP_PRESSURES_KPA))),
            _section(effect, one, actuators),
        ]
        for one in maps
    ]


def _plane_panel(effect: Effect, one: SiliconeMaps, k: int, actuators: Sequence[PaperActuator]) -> MapPanel:
    pressure, modulus_kpa = MAP_PRESSURES_KPA[k], 1e3 * one.law.initial_shear_modulus_mpa
    return MapPanel(
        title=f"{SILICONES[one.silicone]}, {pressure:g} kPa = {pressure / modulus_kpa:.3f} μ",
        x_label="$t / R_i$",
        y_label="$R_p / R_i$",
        x=WALL_OVER_ROOT,
        y=CREST_OVER_ROOT,
        percent=effect.percent(one.plane)[..., k].T,
        unfolded=(pressure - one.plane.unfolding_pressure_kpa[..., 0]).T,
        points={
            _short_name(actuator): (
                actuator.dimensions.wall_mm / actuator.dimensions.root_radius_mm,
                actuator.dimensions.crest_radius_mm / actuator.dimensions.root_radius_mm,
            )
            for actuator in actuators
            if actuator.silicone == one.silicone
        },
        lines={},
    )


def _section(effect: Effect, one: SiliconeMaps, actuators: Sequence[PaperActuator]) -> MapPanel:
    modulus_kpa = 1e3 * one.law.initial_shear_modulus_mpa
    return MapPanel(
        title=f"{SILICONES[one.silicone]}, $R_p / R_i$ = {SECTION:g}",
        x_label="$t / R_i$",
        y_label="pressure / μ",
        x=WALL_OVER_ROOT,
        y=SWEEP_KPA / modulus_kpa,
        percent=effect.percent(one.section).T,
        unfolded=(SWEEP_KPA - one.section.unfolding_pressure_kpa).T,
        points={},
        lines={
            _short_name(actuator): actuator.dimensions.wall_mm / actuator.dimensions.root_radius_mm
            for actuator in actuators
            if actuator.silicone == one.silicone
            and np.isclose(actuator.dimensions.crest_radius_mm / actuator.dimensions.root_radius_mm, SECTION)
        },
        right_axis=(modulus_kpa, "pressure, kPa"),
    )


def _short_name(actuator: PaperActuator) -> str:
    return actuator.name.removeprefix("heung-")


# --- tables, rows, words --------------------------------------------------------------------


def effect_table(actuators: Sequence[PaperActuator]) -> Table:
    """What each effect is worth (%), a line per effect, a column per actuator and pressure (kPa)."""
    paths = [path_of(actuator, Reading()) for actuator in actuators]
    lines = []
    for effect in EFFECTS:
        values = (value for path in paths for value in effect.percent(path).tolist())
        lines.append((effect.title, *(_change(value) for value in values)))
    return Table(("change, %", *actuator_columns(actuators)), tuple(lines))


def overall(actuators: Sequence[PaperActuator]) -> str:
    """How far the statics and the single assumptions change the four actuators, a sentence."""
    paths = [path_of(actuator, Reading()) for actuator in actuators]
    found = {effect.name: np.concatenate([effect.percent(path) for path in paths]) for effect in EFFECTS}
    assumed = np.concatenate([found[name] for name in ("free-root", "uniaxial-wall", "hoop-stretched-wall")])
    return (
        f"On the four actuators at {PRESSURES_KPA[0]:g} to {PRESSURES_KPA[-1]:g} kPa the statics of the side wall "
        f"(balanced chain) change the elongation by {_range(found['balanced'])}, the assumptions on root and wall, one "
        f"at a time, by {_range(assumed)}; a cap's middle is ahead of its rim by {_range(found['cap-bulge'])} of it."
    )


def rows(actuator: PaperActuator) -> list[Row]:
    """What each effect is worth for an actuator, %."""
    path = path_of(actuator, Reading())
    return [
        row(actuator.name, "change_percent", "%", pressure, "closed_form", value, effect.name)
        for effect in EFFECTS
        for pressure, value in zip(PRESSURES_KPA, effect.percent(path).tolist(), strict=True)
    ]


def sentences(effect: Effect, actuators: Sequence[PaperActuator], maps: Sequence[SiliconeMaps]) -> list[str]:
    """Where an effect is worth more than 10 %: by actuator over the pressure, and over the maps."""
    found = []
    for actuator in actuators:
        values = effect.percent(path_of(actuator, Reading(), tuple(SWEEP_KPA)))
        found.append(f"{actuator.name}: {intervals(SWEEP_KPA, _is_large(values))}")
    span = f"{SWEEP_KPA[0]:g} to {SWEEP_KPA[-1]:g} kPa"
    texts = [f"More than {LIMIT_PERCENT:g} %, of {span}: {'; '.join(found)}."]
    for one in maps:
        values = effect.percent(one.plane)
        parts = []
        for k, pressure in enumerate(MAP_PRESSURES_KPA):
            share = 100.0 * float(np.mean(_is_large(values[..., k])))
            parts.append(f"on {_share(share)} of the map at {pressure:g} kPa ({_range(values[..., k])})")
        texts.append(f"{SILICONES[one.silicone]}: more than {LIMIT_PERCENT:g} % {' and '.join(parts)}.")
    return texts


def _is_large(percent: FloatArray) -> NDArray[np.bool_]:
    """More than the limit; where there is no such state at all that counts too."""
    return ~(np.abs(percent) <= LIMIT_PERCENT)


def _range(percent: FloatArray) -> str:
    text = f"{_change(float(np.nanmin(percent)))} to {_change(float(np.nanmax(percent)))} %"
    missing = float(np.mean(np.isnan(percent)))
    return text if missing == 0.0 else f"{text}, no such state on {_share(100.0 * missing)}"


def _change(percent: float) -> str:
    """A change as text; without a sign where the digits shown are all zero."""
    if np.isnan(percent):
        return MISSING
    return signed(percent) if abs(percent) >= 0.005 else "0"


def _share(percent: float) -> str:
    return f"{percent:.0f} %" if percent >= 1.0 or percent == 0.0 else "less than 1 %"


def intervals(pressures_kpa: FloatArray, inside: NDArray[np.bool_]) -> str:
    """Pressures at which something holds, as text: ``up to 3 kPa and from 9.5 kPa``."""
    if not np.any(inside):
        return "nowhere"
    if np.all(inside):
        return "everywhere"
    edges = np.diff(np.concatenate([[False], inside, [False]]).astype(int))
    parts = []
    for first, last in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1, strict=True):
        low, high = pressures_kpa[first], pressures_kpa[last]
        if first == 0:
            parts.append(f"up to {high:g} kPa")
        elif last == len(inside) - 1:
            parts.append(f"from {low:g} kPa")
        else:
            parts.append(f"{low:g} to {high:g} kPa")
    return " and ".join(parts)
