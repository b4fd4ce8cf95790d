"""Tables, rows and sentences of the closed-form study: chains, corrections, inverse and held tip.

Lengths are in mm, pressures in kPa, forces in N; the paper's own elongations in cm become mm.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from analytical.arrays import FloatArray
from analytical.bellows.chains import ClosedFormPath, closed_form, validity_warnings
from analytical.bellows.corrections import CORRECTIONS, Correction, effect_cm
from analytical.bellows.loads import held_tip, pressure_at_elongation_kpa
from analytical.bellows.paper import PRINTED_PRESSURE_KPA, PaperActuator, Silicone
from analytical.bellows.reading import BALANCED, CORRECTED, PRINTED_READING, Reading
from analytical.laws.isotropic import OGDEN_CONVENTIONS
from analytical.laws.silicones import (
    DRAGON_SKIN_10_ELONGATION_AT_BREAK_PERCENT,
    DRAGON_SKIN_30_ELONGATION_AT_BREAK_PERCENT,
    dragon_skin_30,
)
from studies.report.labels import TIP, model_label
from studies.report.numbers import MISSING, signed
from studies.report.tables import Table
from studies.results.rows import Row, difference_percent, row

PRESSURES_KPA: Final = (5.0, 10.0, 15.0, 20.0)
# By model: how its chain reads the equations.
CHAINS: Final[dict[str, Reading]] = {
    "closed_form_printed": PRINTED_READING,
    "closed_form": CORRECTED,
    "closed_form_balanced": BALANCED,
}
# The same chains in tables that have no room.
_SHORT: Final = {"closed_form_printed": "printed", "closed_form": "corrected", "closed_form_balanced": "balanced"}
# The balanced chain at its cuts; the first is the chain itself.
CUTS: Final[dict[str, Reading]] = {
    "mean": BALANCED,
    "crest": replace(BALANCED, cut="crest"),
    "root": replace(BALANCED, cut="root"),
}
# Elongations for which the pressure is asked, as shares of the elongation at 20 kPa.
SHARES: Final = (0.25, 0.50, 0.75)
STRETCH_AT_BREAK: Final[dict[Silicone, float]] = {
    "dragon-skin-10": 1.0 + 0.01 * DRAGON_SKIN_10_ELONGATION_AT_BREAK_PERCENT,
    "dragon-skin-30": 1.0 + 0.01 * DRAGON_SKIN_30_ELONGATION_AT_BREAK_PERCENT,
}
SILICONES: Final[dict[Silicone, str]] = {"dragon-skin-10": "Dragon Skin 10", "dragon-skin-30": "Dragon Skin 30"}
# Outputs of a chain: name and unit in the rows, heading, decimals.
_OUTPUTS: Final = (
    ("root_stretch", "1", "λ_y", 4),
    ("root_inner_stretch", "1", "λ_i", 4),
    ("wall_stretch", "1", "λ_a", 4),
    ("half_pitch_deformed_mm", "mm", "a, mm", 3),
    ("side_length_deformed_mm", "mm", "b, mm", 3),
    ("angle_deg", "deg", "θ, °", 2),
    ("elongation_mm", "mm", "elongation, mm", 2),
    ("extension_force_n", "N", "extension force, N", 3),
    ("resistive_force_n", "N", "resistive force, N", 3),
)


def path_of(
    actuator: PaperActuator, reading: Reading, pressures_kpa: Sequence[float] = PRESSURES_KPA
) -> ClosedFormPath:
    """A chain's answer for an actuator at pressures in kPa."""
    return closed_form(actuator.dimensions, actuator.law, np.asarray(pressures_kpa), reading)


def output(path: ClosedFormPath, name: str) -> FloatArray:
    """An output of a chain by the name of its rows; angles in degrees."""
    return np.rad2deg(path.angle_rad) if name == "angle_deg" else getattr(path, name)


def printed_mm(actuator: PaperActuator) -> dict[str, float]:
    """Printed elongations at 20 kPa by model, mm."""
    known = actuator.printed
    return {
        "paper_closed_form": 10.0 * known.closed_form_cm,
        "paper_ansys": 10.0 * known.ansys_cm,
        "paper_experiment": 10.0 * known.experiment_cm,
    }


# --- chains ---------------------------------------------------------------------------------


def chain_rows(actuator: PaperActuator) -> list[Row]:
    """Elongation of every chain and cut beside the printed one, the chains' other outputs, unfolding pressures."""
    rows = []
    printed, source = printed_mm(actuator), actuator.printed.source
    readings = [(model, "", reading) for model, reading in CHAINS.items() if model != "closed_form_balanced"]
    readings += [("closed_form_balanced", cut, reading) for cut, reading in CUTS.items()]
    for model, level, reading in readings:
        path = path_of(actuator, reading)
        for k, pressure in enumerate(PRESSURES_KPA):
            compared = pressure == PRINTED_PRESSURE_KPA
            rows.append(
                row(
                    actuator.name,
                    TIP,
                    "mm",
                    pressure,
                    model,
                    float(path.elongation_mm[k]),
                    level,
                    reference=printed["paper_closed_form"] if compared else math.nan,
                    source=source if compared else "",
                    status=_status(path, k),
                )
            )
            rows += [
                row(actuator.name, name, unit, pressure, model, float(output(path, name)[k]), level)
                for name, unit, _, _ in _OUTPUTS
                if name != "elongation_mm"
            ]
        unfolding = float(path.unfolding_pressure_kpa[0])
        rows.append(row(actuator.name, "unfolding_pressure_kpa", "kPa", math.nan, model, unfolding, level))
    rows += [
        row(actuator.name, TIP, "mm", PRINTED_PRESSURE_KPA, model, value, source=source)
        for model, value in printed.items()
    ]
    return rows


def _status(path: ClosedFormPath, k: int) -> str:
    state = str(path.state[k])
    return "reached" if state == "folded" else f"reached, {state}"


def summary(actuators: Sequence[PaperActuator]) -> Table:
    """Elongation (mm) at 20 kPa of the three chains beside the printed numbers, state and unfolding pressure (kPa)."""
    lines = []
    for actuator in actuators:
        paths = {model: path_of(actuator, reading, [PRINTED_PRESSURE_KPA]) for model, reading in CHAINS.items()}
        printed = printed_mm(actuator)
        values = {model: float(path.elongation_mm[0]) for model, path in paths.items()}
        corrected = paths["closed_form"]
        difference = difference_percent(values["closed_form"], printed["paper_closed_form"])
        lines.append(
            (
                f"[{actuator.name}](#{actuator.name})",
                SILICONES[actuator.silicone],
                *(_length(value) for value in values.values()),
                *(f"{value:g}" for value in printed.values()),
                signed(difference),
                str(corrected.state[0]),
                f"{corrected.unfolding_pressure_kpa[0]:.1f}",
            )
        )
    header = ("actuator", "silicone", *map(model_label, CHAINS), *map(model_label, printed_mm(actuators[0])))
    header += ("closed form from its printed number, %", "state", "unfolds fully at, kPa")
    return Table(header, tuple(lines), left=(0, 1, len(header) - 2))


def chain_table(actuator: PaperActuator) -> Table:
    """Elongation (mm) by pressure (kPa): the chains, the balanced one at each cut, the printed numbers."""
    paths = {model_label(model): path_of(actuator, reading) for model, reading in CHAINS.items()}
    paths |= {f"balanced, cut at the {cut}": path_of(actuator, r) for cut, r in CUTS.items() if cut != "mean"}
    printed = printed_mm(actuator)
    lines = []
    for k, pressure in enumerate(PRESSURES_KPA):
        values = (_length(float(path.elongation_mm[k])) for path in paths.values())
        known = (f"{v:g}" if pressure == PRINTED_PRESSURE_KPA else MISSING for v in printed.values())
        lines.append((f"{pressure:g}", *values, *known))
    return Table(("pressure, kPa", *paths, *map(model_label, printed)), tuple(lines), left=())


def output_table(actuator: PaperActuator) -> Table:
    """Every output of the three chains, a line per chain and pressure (kPa)."""
    lines = []
    for model, reading in CHAINS.items():
        path = path_of(actuator, reading)
        for k, pressure in enumerate(PRESSURES_KPA):
            values = (_fixed(float(output(path, name)[k]), digits) for name, _, _, digits in _OUTPUTS)
            lines.append((_SHORT[model], f"{pressure:g}", *values, str(path.state[k])))
    header = ("chain", "pressure, kPa", *(heading for _, _, heading, _ in _OUTPUTS), "state")
    return Table(header, tuple(lines), left=(0, len(header) - 1))


def unfolding(actuator: PaperActuator) -> str:
    """Unfolding pressures of the chains, a sentence."""
    printed, corrected = (
        float(path_of(actuator, CHAINS[model]).unfolding_pressure_kpa[0])
        for model in ("closed_form_printed", "closed_form")
    )
    return (
        f"The root reaches the crest at {corrected:.1f} kPa in the corrected and the balanced chain, at {printed:.1f} "
        "kPa in the printed one."
    )


def warnings(actuator: PaperActuator) -> list[str]:
    """What to know before quoting a chain's numbers, a sentence per chain and warning."""
    found: dict[tuple[str, str], list[str]] = {}
    for model, reading in CHAINS.items():
        path = path_of(actuator, reading)
        for pressure, texts in zip(
            PRESSURES_KPA, validity_warnings(path, STRETCH_AT_BREAK[actuator.silicone]), strict=True
        ):
            for text in texts:
                found.setdefault((model, text), []).append(f"{pressure:g}")
    return [f"{model_label(model)}, {', '.join(at)} kPa: {text}." for (model, text), at in found.items()]


def resting_on_saturation(actuators: Sequence[PaperActuator]) -> str:
    """Which of the corrected and balanced chains' numbers rest on the rule that holds the root at full unfolding."""
    resting = []
    for actuator in actuators:
        states = path_of(actuator, CORRECTED).state
        held = [f"{p:g}" for p, state in zip(PRESSURES_KPA, states, strict=True) if state == "fully unfolded"]
        if held:
            resting.append(f"{actuator.name} at {_listed(held)} kPa")
    if not resting:
        return "None of the numbers rests on the rule that the root is held at full unfolding."
    at_printed = [
        f"{a.printed.closed_form_cm:g} cm"
        for a in actuators
        if path_of(a, CORRECTED, [PRINTED_PRESSURE_KPA]).state[0] == "fully unfolded"
    ]
    return (
        f"The numbers of {_listed(resting)} rest on the rule that the root is held at full unfolding, and so does what "
        f"the dimensions owe to the printed {_listed(at_printed)}."
    )


def convention_table(actuators: Sequence[PaperActuator]) -> Table:
    """Elongation (mm) of the Dragon Skin 30 actuators in both Ogden conventions, by pressure (kPa)."""
    lines = []
    for actuator in actuators:
        if actuator.silicone != "dragon-skin-30":
            continue
        for convention in OGDEN_CONVENTIONS:
            law = dragon_skin_30(convention)
            for model in ("closed_form", "closed_form_balanced"):
                path = closed_form(actuator.dimensions, law, PRESSURES_KPA, CHAINS[model])
                lines.append(
                    (
                        actuator.name,
                        convention,
                        f"{1e3 * law.initial_shear_modulus_mpa:.2f}",
                        model_label(model),
                        *(_length(value) for value in path.elongation_mm.tolist()),
                        f"{actuator.printed.closed_form_cm * 10.0:g}",
                    )
                )
    header = ("actuator", "convention", "initial shear modulus, kPa", "chain", *(f"{p:g} kPa" for p in PRESSURES_KPA))
    return Table((*header, "paper: closed form, 20 kPa"), tuple(lines), left=(0, 1, 3))


# --- corrections ----------------------------------------------------------------------------


def correction_table() -> Table:
    """Every departure from the print: where, what is wrong, what is done, why, from which chain on."""
    lines = (
        (
            m.name,
            m.equation,
            m.fault,
            m.corrected_to,
            m.evidence,
            _SHORT[m.chain],
            "see below" if _counts(m) else _why_no_effect(m),
        )
        for m in CORRECTIONS
    )
    header = ("correction", "equation", "fault", "corrected to", "evidence", "from this chain on", "effect on numbers")
    return Table(header, tuple(lines), left=tuple(range(len(header))))


def effect_table(actuators: Sequence[PaperActuator]) -> Table:
    """What every correction that changes numbers is worth in elongation (cm), by actuator and pressure (kPa)."""
    lines = []
    for correction in CORRECTIONS:
        if _counts(correction):
            effects = (effect_cm(correction, a.dimensions, a.law, PRESSURES_KPA).tolist() for a in actuators)
            lines.append((correction.name, *(_effect(value) for of_actuator in effects for value in of_actuator)))
    return Table(("effect, cm", *actuator_columns(actuators)), tuple(lines))


def actuator_columns(actuators: Sequence[PaperActuator]) -> tuple[str, ...]:
    """Headings of columns by actuator and pressure (kPa)."""
    return tuple(f"{actuator.name}, {pressure:g} kPa" for actuator in actuators for pressure in PRESSURES_KPA)


def _counts(correction: Correction) -> bool:
    return correction.without is not None and correction.without != correction.with_


def _why_no_effect(correction: Correction) -> str:
    return "the print cannot be evaluated" if correction.without is None else "none, wording"


def _effect(value_cm: float) -> str:
    # the digits shown decide what is nothing
    return _minus(f"{value_cm:+.2f}") if abs(value_cm) >= 0.005 else "0"


def correction_rows(actuator: PaperActuator) -> list[Row]:
    """Effects of all corrections on an actuator, cm."""
    return [
        row(actuator.name, "correction_effect_cm", "cm", pressure, correction.chain, value, correction.name)
        for correction in CORRECTIONS
        for pressure, value in zip(
            PRESSURES_KPA, effect_cm(correction, actuator.dimensions, actuator.law, PRESSURES_KPA).tolist(), strict=True
        )
    ]


# --- inverse and held tip -------------------------------------------------------------------

# The chains that have a unique pressure for an elongation and a balance to add a tip force to.
_LOADED: Final = ("closed_form", "closed_form_balanced")


def load_rows(actuator: PaperActuator) -> list[Row]:
    """Pressures for given elongations, forces at the blocked tip."""
    rows = []
    for model in _LOADED:
        reading = CHAINS[model]
        for share, elongation in zip(SHARES, _requested_mm(actuator, model), strict=True):
            pressure = pressure_at_elongation_kpa(actuator.dimensions, actuator.law, elongation, reading)
            rows.append(row(actuator.name, TIP, "mm", pressure, model, elongation, f"{share:.0%} of that at 20 kPa"))
        held = held_tip(actuator.dimensions, actuator.law, PRESSURES_KPA, reading=reading)
        for k, pressure in enumerate(PRESSURES_KPA):
            for name, unit, values in (
                ("tip_force_n", "N", held.tip_force_n),
                ("thrust_n", "N", held.extension_force_n),
                ("wall_stretch", "1", held.wall_stretch),
            ):
                rows.append(row(actuator.name, name, unit, pressure, model, float(values[k]), "blocked"))
    return rows


def inverse_table(actuators: Sequence[PaperActuator]) -> Table:
    """Pressure (kPa) at which the corrected and the balanced chain give shares of their elongation at 20 kPa."""
    lines = []
    for actuator in actuators:
        for model in _LOADED:
            asked = _requested_mm(actuator, model)
            found = (pressure_at_elongation_kpa(actuator.dimensions, actuator.law, u, CHAINS[model]) for u in asked)
            cells = (f"{u:.2f} mm at {p:.3f} kPa" for u, p in zip(asked, found, strict=True))
            lines.append((actuator.name, model_label(model), *cells))
    return Table(("actuator", "chain", *(f"{share:.0%}" for share in SHARES)), tuple(lines), left=(0, 1))


def _requested_mm(actuator: PaperActuator, model: str) -> list[float]:
    most = float(path_of(actuator, CHAINS[model], [PRINTED_PRESSURE_KPA]).elongation_mm[0])
    return [share * most for share in SHARES]


def held_table(actuators: Sequence[PaperActuator]) -> Table:
    """Tip force (N) blocked at zero elongation, beside the thrust alone, by pressure (kPa)."""
    lines = []
    for actuator in actuators:
        for model in _LOADED:
            held = held_tip(actuator.dimensions, actuator.law, PRESSURES_KPA, reading=CHAINS[model])
            cells = (
                f"{force:.3f} (thrust {thrust:.3f}, λ_a {stretch:.3f})"
                for force, thrust, stretch in zip(
                    held.tip_force_n, held.extension_force_n, held.wall_stretch, strict=True
                )
            )
            lines.append((actuator.name, model_label(model), *cells))
    return Table(("actuator", "chain", *(f"{p:g} kPa, N" for p in PRESSURES_KPA)), tuple(lines), left=(0, 1))


# --- text -----------------------------------------------------------------------------------


def _listed(texts: Iterable[str]) -> str:
    """Texts as a list in a sentence."""
    *first, last = texts
    return f"{', '.join(first)} and {last}" if first else last


def _length(value_mm: float) -> str:
    return _minus(f"{value_mm:.2f}") if math.isfinite(value_mm) else "no real a"


def _fixed(value: float, digits: int) -> str:
    return _minus(f"{value:.{digits}f}") if math.isfinite(value) else MISSING


def _minus(number: str) -> str:
    return number.replace("-", "\N{MINUS SIGN}")
