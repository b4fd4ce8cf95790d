"""What the closed-form study says in words; pressures in kPa, changes in % of the corrected chain's elongation."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytical.arrays import FloatArray
from analytical.bellows.chains import validity_warnings
from analytical.bellows.chains_by_name import CHAINS, PRESSURES_KPA, SILICONES, STRETCH_AT_BREAK, path_of
from analytical.bellows.paper import PRINTED_PRESSURE_KPA, PaperActuator
from analytical.bellows.reading import CORRECTED, PRINTED_READING
from studies.closed_form.effects import Effect
from studies.closed_form.maps import MAP_PRESSURES_KPA, SWEEP_KPA, SiliconeMaps
from studies.closed_form.rows import CHANGE
from studies.closed_form.tables import change_text
from studies.report.labels import model_label
from studies.results.rows import Row

# Differences beyond this are said in words.
LIMIT_PERCENT: Final = 10.0


def unfolding(actuator: PaperActuator) -> str:
    """Unfolding pressures of the chains, a sentence."""
    printed, corrected = (
        float(path_of(actuator, reading).unfolding_pressure_kpa[0]) for reading in (PRINTED_READING, CORRECTED)
    )
    return (
        f"The root reaches the crest at {corrected:.1f} kPa in the corrected and the balanced chain, at {printed:.1f} "
        "kPa in the printed one."
    )


def warnings(actuator: PaperActuator) -> list[str]:
    """What to know before quoting a chain's numbers, a sentence per chain and warning."""
    found: dict[tuple[str, str], list[str]] = {}
    for model, reading in CHAINS.items():
        texts = validity_warnings(path_of(actuator, reading), STRETCH_AT_BREAK[actuator.silicone])
        for pressure, of_pressure in zip(PRESSURES_KPA, texts, strict=True):
            for text in of_pressure:
                found.setdefault((model, text), []).append(f"{pressure:g}")
    return [f"{model_label(model)}, {', '.join(at)} kPa: {text}." for (model, text), at in found.items()]


def resting_on_saturation(actuators: Sequence[PaperActuator]) -> str:
    """Which of the corrected and balanced chains' numbers rest on the rule that holds the root at full unfolding."""
    resting, at_printed = [], []
    for actuator in actuators:
        states = dict(zip(PRESSURES_KPA, path_of(actuator, CORRECTED).state, strict=True))
        held = [f"{pressure:g}" for pressure, state in states.items() if state == "fully unfolded"]
        if held:
            resting.append(f"{actuator.name} at {_listed(held)} kPa")
        if states[PRINTED_PRESSURE_KPA] == "fully unfolded":
            at_printed.append(f"{actuator.printed.closed_form_cm:g} cm")
    if not resting:
        return "None of the numbers rests on the rule that the root is held at full unfolding."
    return (
        f"The numbers of {_listed(resting)} rest on the rule that the root is held at full unfolding, and so does what "
        f"the dimensions owe to the printed {_listed(at_printed)}."
    )


def overall(rows: Iterable[Row]) -> str:
    """How far the statics and the single assumptions change the four actuators, a sentence."""
    changes = [r for r in rows if r.quantity == CHANGE]

    def span(*effects: str) -> str:
        return _range(np.array([r.value for r in changes if r.level in effects]))

    return (
        f"On the four actuators at {PRESSURES_KPA[0]:g} to {PRESSURES_KPA[-1]:g} kPa the statics of the side wall "
        f"(balanced chain) change the elongation by {span('balanced')}, the assumptions on root and wall, one at a "
        f"time, by {span('free-root', 'uniaxial-wall', 'hoop-stretched-wall')}; a cap's middle is ahead of its rim by "
        f"{span('cap-bulge')} of it."
    )


def where_large(effect: Effect, actuators: Sequence[PaperActuator], maps: Sequence[SiliconeMaps]) -> list[str]:
    """Where an effect is worth more than 10 %: by actuator over the pressure, and over the maps."""
    found = []
    for actuator in actuators:
        values = effect.percent(path_of(actuator, CORRECTED, tuple(SWEEP_KPA)))
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


def _is_large(percent: FloatArray) -> NDArray[np.bool_]:
    """More than the limit; where there is no such state at all that counts too."""
    return ~(np.abs(percent) <= LIMIT_PERCENT)


def _range(percent: FloatArray) -> str:
    text = f"{change_text(float(np.nanmin(percent)))} to {change_text(float(np.nanmax(percent)))} %"
    missing = float(np.mean(np.isnan(percent)))
    return text if missing == 0.0 else f"{text}, no such state on {_share(100.0 * missing)}"


def _share(percent: float) -> str:
    return f"{percent:.0f} %" if percent >= 1.0 or percent == 0.0 else "less than 1 %"


def _listed(texts: Iterable[str]) -> str:
    """Texts as a list in a sentence."""
    *first, last = texts
    return f"{', '.join(first)} and {last}" if first else last
