"""Tables of the closed-form study, most of them its rows spread out; lengths in mm, pressures in kPa, forces in N."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Sequence
from typing import Final

from analytical.bellows.chains import closed_form
from analytical.bellows.chains_by_name import CHAINS, CUTS, PRESSURES_KPA, SHORT, SILICONES
from analytical.bellows.corrections import CORRECTIONS, Correction
from analytical.bellows.paper import PRINTED_PRESSURE_KPA, PaperActuator
from analytical.laws.isotropic import OGDEN_CONVENTIONS, OgdenConvention
from analytical.laws.silicones import dragon_skin_30
from studies.closed_form.effects import EFFECTS
from studies.closed_form.rows import CHANGE, CORRECTION, LOADED, OUTPUTS, SHARES, share_text
from studies.report.labels import TIP, model_label
from studies.report.numbers import MISSING, signed, typeset
from studies.report.tables import Column, Table, pivot, pressure_of, table_of
from studies.results.rows import Row

_PRINTED: Final = ("paper_closed_form", "paper_ansys", "paper_experiment")


def summary(rows: Sequence[Row], actuators: Iterable[PaperActuator]) -> Table:
    """Elongation (mm) at 20 kPa of the three chains beside the printed numbers, state and unfolding pressure (kPa)."""
    silicones = {actuator.name: SILICONES[actuator.silicone] for actuator in actuators}
    at_printed = [r for r in _of_chains(rows) if r.quantity != TIP or r.pressure_kpa == PRINTED_PRESSURE_KPA]
    columns = [
        *_tips(),
        Column("closed form from its printed number, %", TIP, lambda r: signed(r.error_percent), "closed_form"),
        Column("state", TIP, _state, "closed_form"),
        Column("unfolds fully at, kPa", "unfolding_pressure_kpa", ".1f", "closed_form"),
    ]
    lines = {"actuator": lambda r: f"[{r.scene}](#{r.scene})", "silicone": lambda r: silicones[r.scene]}
    return pivot(at_printed, lines, columns, left=(0, 1, len(columns)))


def chain_table(rows: Iterable[Row]) -> Table:
    """Elongation (mm) of an actuator by pressure (kPa): chains, the balanced one at each cut, the printed numbers."""
    cuts = [
        Column(f"balanced, cut at the {cut}", TIP, _length, "closed_form_balanced", cut)
        for cut in CUTS
        if cut != "mean"
    ]
    chains, printed = _tips()[: len(CHAINS)], _tips()[len(CHAINS) :]
    of_cuts = (r for r in rows if r.level in ("", *CUTS))
    return pivot(of_cuts, {"pressure, kPa": pressure_of}, [*chains, *cuts, *printed])


def output_table(rows: Iterable[Row]) -> Table:
    """Every output of the three chains for an actuator, a line per chain and pressure (kPa)."""
    columns = [Column(heading, name, _fixed(digits)) for name, _, heading, digits in OUTPUTS]
    lines = {"chain": lambda r: SHORT[r.model], "pressure, kPa": pressure_of}
    computed = (r for r in _of_chains(rows) if r.model in CHAINS)
    return pivot(computed, lines, [*columns, Column("state", TIP, _state)], left=(0, 2 + len(columns)))


def _of_chains(rows: Iterable[Row]) -> list[Row]:
    """Rows of the chains themselves and of the print: no other cut, no blocked tip, no share."""
    return [r for r in rows if r.level in ("", "mean")]


def _state(row: Row) -> str:
    """State of a chain at a row's pressure."""
    return row.status.removeprefix("reached").removeprefix(", ") or "folded"


def _tips() -> list[Column]:
    """Elongations of the chains, the balanced one's at its mean cut, and as printed."""
    chains = [
        Column(model_label(model), TIP, _length, model, "mean" if model == "closed_form_balanced" else "")
        for model in CHAINS
    ]
    return [*chains, *(Column(model_label(model), TIP, "g", model) for model in _PRINTED)]


def convention_table(actuators: Iterable[PaperActuator]) -> Table:
    """Elongation (mm) of the Dragon Skin 30 actuators in both Ogden conventions, by pressure (kPa)."""
    of_silicone = [actuator for actuator in actuators if actuator.silicone == "dragon-skin-30"]
    lines = itertools.product(of_silicone, OGDEN_CONVENTIONS, LOADED)
    header = ("actuator", "convention", "initial shear modulus, kPa", "chain", *(f"{p:g} kPa" for p in PRESSURES_KPA))
    return Table(
        (*header, "paper: closed form, 20 kPa"), tuple(_convention_line(*line) for line in lines), left=(0, 1, 3)
    )


def _convention_line(actuator: PaperActuator, convention: OgdenConvention, model: str) -> tuple[str, ...]:
    law = dragon_skin_30(convention)
    path = closed_form(actuator.dimensions, law, PRESSURES_KPA, CHAINS[model])
    return (
        actuator.name,
        convention,
        f"{1e3 * law.initial_shear_modulus_mpa:.2f}",
        model_label(model),
        *(typeset(tip, ".2f") for tip in path.elongation_mm.tolist()),
        f"{actuator.printed.closed_form_cm * 10.0:g}",
    )


def correction_table() -> Table:
    """Every departure from the print: where, what is wrong, what is done, why, from which chain on."""
    columns: dict[str, Callable[[Correction], str]] = {
        "correction": lambda c: c.name,
        "equation": lambda c: c.equation,
        "fault": lambda c: c.fault,
        "corrected to": lambda c: c.corrected_to,
        "evidence": lambda c: c.evidence,
        "from this chain on": lambda c: SHORT[c.chain],
        "effect on numbers": _effect_on_numbers,
    }
    return table_of(CORRECTIONS, columns, left=tuple(range(len(columns))))


def _effect_on_numbers(correction: Correction) -> str:
    if correction.without is None:
        return "the print cannot be evaluated"
    return "none, wording" if correction.without == correction.with_ else "see below"


def correction_effects(rows: Iterable[Row], actuators: Iterable[PaperActuator]) -> Table:
    """What every correction that changes numbers is worth in elongation (cm), by actuator and pressure (kPa)."""
    with_numbers = [c.name for c in CORRECTIONS if _effect_on_numbers(c) == "see below"]
    of_them = (r for r in rows if r.level in with_numbers)
    return pivot(of_them, {"effect, cm": lambda r: r.level}, _everywhere(CORRECTION, _effect, actuators), left=(0,))


def change_table(rows: Iterable[Row], actuators: Iterable[PaperActuator]) -> Table:
    """What each effect is worth (%), a line per effect, a column per actuator and pressure (kPa)."""
    titles = {effect.name: effect.title for effect in EFFECTS}
    columns = _everywhere(CHANGE, lambda r: change_text(r.value), actuators)
    return pivot(rows, {"change, %": lambda r: titles[r.level]}, columns, left=(0,))


def _everywhere(quantity: str, form: Callable[[Row], str], actuators: Iterable[PaperActuator]) -> list[Column]:
    """A column per actuator and pressure."""
    return [
        Column(f"{actuator.name}, {pressure:g} kPa", quantity, form, scene=actuator.name, pressure_kpa=pressure)
        for actuator in actuators
        for pressure in PRESSURES_KPA
    ]


def inverse_table(rows: Iterable[Row]) -> Table:
    """Pressure (kPa) at which the corrected and the balanced chain give shares of their elongation at 20 kPa."""

    def cell(row: Row) -> str:
        return f"{row.value:.2f} mm at {row.pressure_kpa:.3f} kPa"

    return pivot(rows, _LOADS, [Column(f"{share:.0%}", TIP, cell, level=share_text(share)) for share in SHARES], (0, 1))


def held_table(rows: Iterable[Row]) -> Table:
    """Tip force (N) blocked at zero elongation, beside the thrust alone, by pressure (kPa)."""
    columns = [
        Column("tip force, N", "tip_force_n", ".3f"),
        Column("thrust alone, N", "thrust_n", ".3f"),
        Column("λ_a", "wall_stretch", ".3f"),
    ]
    blocked = (r for r in rows if r.level == "blocked")
    return pivot(blocked, {**_LOADS, "pressure, kPa": pressure_of}, columns, (0, 1))


_LOADS: Final[dict[str, Callable[[Row], str]]] = {
    "actuator": lambda r: r.scene,
    "chain": lambda r: model_label(r.model),
}


def change_text(percent: float) -> str:
    """A change as text; without a sign where the digits shown are all zero."""
    if percent != percent:
        return MISSING
    return signed(percent) if abs(percent) >= 0.005 else "0"


def _effect(row: Row) -> str:
    # the digits shown decide what is nothing
    return typeset(row.value, "+.2f") if abs(row.value) >= 0.005 else "0"


def _length(row: Row) -> str:
    return typeset(row.value, ".2f", "no real a")


def _fixed(digits: int) -> Callable[[Row], str]:
    return lambda row: typeset(row.value, f".{digits}f")
