"""All numbers of an actuator in the closed-form study: chains, corrections, inverse and held tip, effects.

Lengths are in mm, pressures in kPa, forces in N; corrections are worth cm, as the paper prints elongations.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from analytical.arrays import FloatArray
from analytical.bellows.chains import ClosedFormPath
from analytical.bellows.chains_by_name import CHAINS, CUTS, PRESSURES_KPA, path_of, printed_mm
from analytical.bellows.corrections import CORRECTIONS, effect_cm
from analytical.bellows.loads import held_tip, pressure_at_elongation_kpa
from analytical.bellows.paper import PRINTED_PRESSURE_KPA, PaperActuator
from analytical.bellows.reading import CORRECTED
from studies.closed_form.effects import EFFECTS
from studies.report.labels import TIP
from studies.results.rows import Row, row

# Outputs of a chain: quantity of the rows, unit, heading, decimals.
OUTPUTS: Final = (
    ("root_stretch", "1", "λ_y", 4),
    ("root_inner_stretch", "1", "λ_i", 4),
    ("wall_stretch", "1", "λ_a", 4),
    ("half_pitch_deformed_mm", "mm", "a, mm", 3),
    ("side_length_deformed_mm", "mm", "b, mm", 3),
    ("angle_deg", "deg", "θ, °", 2),
    (TIP, "mm", "elongation, mm", 2),
    ("extension_force_n", "N", "extension force, N", 3),
    ("resistive_force_n", "N", "resistive force, N", 3),
)
CORRECTION, CHANGE = "correction_effect_cm", "change_percent"
# Elongations for which the pressure is requested, as shares of the elongation at 20 kPa.
SHARES: Final = (0.25, 0.50, 0.75)
# The chains that have a unique pressure for an elongation and a balance to add a tip force to.
LOADED: Final = ("closed_form", "closed_form_balanced")
BLOCKED: Final = "blocked"


def actuator_rows(actuator: PaperActuator) -> list[Row]:
    """All numbers of an actuator."""
    parts = (chain_rows, correction_rows, load_rows, effect_rows)
    return [entry for part in parts for entry in part(actuator)]


def chain_rows(actuator: PaperActuator) -> list[Row]:
    """Elongation of every chain and cut beside the printed one, the chains' other outputs, unfolding pressures."""
    rows = []
    for model, reading in CHAINS.items():
        cuts = CUTS if model == "closed_form_balanced" else {"": reading}
        for level, of_cut in cuts.items():
            rows += _path_rows(actuator, model, level, path_of(actuator, of_cut))
    rows += [
        row(actuator.name, TIP, "mm", PRINTED_PRESSURE_KPA, model, value, source=actuator.printed.source)
        for model, value in printed_mm(actuator).items()
    ]
    return rows


def _path_rows(actuator: PaperActuator, model: str, level: str, path: ClosedFormPath) -> list[Row]:
    """Elongation, compared at the printed pressure, and other outputs at each pressure; the unfolding pressure."""
    rows = []
    for k, pressure in enumerate(PRESSURES_KPA):
        compared = pressure == PRINTED_PRESSURE_KPA
        tip = row(
            actuator.name,
            TIP,
            "mm",
            pressure,
            model,
            float(path.elongation_mm[k]),
            level,
            reference=printed_mm(actuator)["paper_closed_form"] if compared else math.nan,
            source=actuator.printed.source if compared else "",
            status=_status(str(path.state[k])),
        )
        rows.append(tip)
    for name, unit, _, _ in OUTPUTS:
        if name != TIP:
            rows += _over_pressures(actuator, name, unit, model, output(path, name), level)
    unfolding = float(path.unfolding_pressure_kpa[0])
    return [*rows, row(actuator.name, "unfolding_pressure_kpa", "kPa", math.nan, model, unfolding, level)]


def _over_pressures(
    actuator: PaperActuator, quantity: str, unit: str, model: str, values: FloatArray, level: str
) -> list[Row]:
    """A row per pressure."""
    return [
        row(actuator.name, quantity, unit, pressure, model, float(value), level)
        for pressure, value in zip(PRESSURES_KPA, values, strict=True)
    ]


def output(path: ClosedFormPath, name: str) -> FloatArray:
    """An output of a chain by the name of its rows; angles in degrees."""
    return np.rad2deg(path.angle_rad) if name == "angle_deg" else getattr(path, name)


def _status(state: str) -> str:
    return "reached" if state == "folded" else f"reached, {state}"


def correction_rows(actuator: PaperActuator) -> list[Row]:
    """Effects of all corrections on an actuator, cm."""
    rows = []
    for c in CORRECTIONS:
        worth_cm = effect_cm(c, actuator.dimensions, actuator.law, PRESSURES_KPA)
        rows += _over_pressures(actuator, CORRECTION, "cm", c.chain, worth_cm, c.name)
    return rows


def load_rows(actuator: PaperActuator) -> list[Row]:
    """Pressures for given elongations, forces at the blocked tip."""
    rows = []
    for model in LOADED:
        reading = CHAINS[model]
        most = float(path_of(actuator, reading, [PRINTED_PRESSURE_KPA]).elongation_mm[0])
        for share in SHARES:
            elongation = share * most
            pressure = pressure_at_elongation_kpa(actuator.dimensions, actuator.law, elongation, reading)
            rows.append(row(actuator.name, TIP, "mm", pressure, model, elongation, share_text(share)))
        held = held_tip(actuator.dimensions, actuator.law, PRESSURES_KPA, reading=reading)
        rows += _over_pressures(actuator, "tip_force_n", "N", model, held.tip_force_n, BLOCKED)
        rows += _over_pressures(actuator, "thrust_n", "N", model, held.extension_force_n, BLOCKED)
        rows += _over_pressures(actuator, "wall_stretch", "1", model, held.wall_stretch, BLOCKED)
    return rows


def share_text(share: float) -> str:
    """Level of a row at a share of the elongation at 20 kPa."""
    return f"{share:.0%} of that at 20 kPa"


def effect_rows(actuator: PaperActuator) -> list[Row]:
    """What each effect is worth for an actuator, %."""
    path, rows = path_of(actuator, CORRECTED), []
    for effect in EFFECTS:
        rows += _over_pressures(actuator, CHANGE, "%", "closed_form", effect.percent(path), effect.name)
    return rows
