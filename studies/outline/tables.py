"""Tables of the split, and the figures of its sentences."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Final

from analytical.bellows.chains import closed_form
from analytical.bellows.chains_by_name import PRESSURES_KPA
from analytical.bellows.dimensions import with_seat
from analytical.bellows.paper import PaperActuator, actuators
from analytical.bellows.reading import CORRECTED
from studies.outline.cases import MOULDED, RIGID_TIP, Outline
from studies.outline.kinematics import Fold, kinematics_mm, stretch_beside_hoop
from studies.outline.split import CAUSES, OF_OUTLINE, Found, Split
from studies.report.numbers import MISSING, number_text, typeset, up
from studies.report.tables import Table, table_of
from studies.results.rows import Row

# The chain with its root not held at full unfolding.
NOT_HELD: Final = replace(CORRECTED, folds_back=True)


def split_table(splits: Sequence[Split]) -> Table:
    """An actuator's gap: a line per cause, a column per pressure."""
    columns: list[tuple[str, Callable[[Split], str]]] = [
        ("closed form", lambda s: f"{s.closed_form_mm:.2f}{' (held)' if s.held else ''}"),
        *((f"{k} {CAUSES[name]}", partial(_cause_text, name)) for k, name in enumerate(splits[0].causes, 1)),
        ("left over", lambda s: typeset(s.left_over_mm, "+.3f", MISSING)),
        ("finite elements, as moulded", lambda s: _with_band(s.elements_mm, s.uncertainty_mm)),
        ("gap", lambda s: _with_band(s.gap_mm, s.uncertainty_mm, "+")),
    ]
    lines = tuple((text, *(cell(s) for s in splits)) for text, cell in columns)
    return Table(("mm", *(f"{s.pressure_kpa:g} kPa" for s in splits)), lines)


def _cause_text(name: str, found: Split) -> str:
    return _with_band(found.causes[name].value, found.causes[name].band, "+")


def _with_band(value: float, band: float, sign: str = "", decimals: int = 2) -> str:
    """A number and its band, rounded up."""
    if math.isnan(value) or math.isnan(band):
        return MISSING
    return f"{typeset(value, f'{sign}.{decimals}f', MISSING)} ± {up(band, decimals)}"


def both_ends_table(splits: Sequence[Split]) -> Table:
    """What each input of equation (23) changes alone: beside the closed form's others, beside the measured ones."""
    names = list(splits[0].both_ends_mm)
    columns: dict[str, Callable[[Split], str]] = {
        "actuator": lambda s: s.actuator.name,
        "kPa": lambda s: f"{s.pressure_kpa:g}",
        **{name: partial(_both_text, name) for name in names},
    }
    return table_of(splits, columns, left=(0,))


def _both_text(name: str, found: Split) -> str:
    return "; ".join(typeset(value, "+.2f", MISSING) for value in found.both_ends_mm[name])


def direct_table(splits: Sequence[Split]) -> Table:
    """The causes measured in the states of the outline as moulded."""
    columns: dict[str, Callable[[Split], str]] = {
        "actuator": lambda s: s.actuator.name,
        "kPa": lambda s: f"{s.pressure_kpa:g}",
        **{name: partial(_cause_text, name) for name in splits[0].causes},
        "left over": lambda s: typeset(s.left_over_mm, "+.3f", MISSING),
        "gap": lambda s: _with_band(s.gap_mm, s.uncertainty_mm, "+"),
    }
    return table_of(splits, columns, left=(0,))


def slack_mm(found: Found, actuator: PaperActuator, outline: Outline, pressure_kpa: float) -> tuple[float, float]:
    """What the walls of all folds would lengthen the actuator by if they were straight: at rest, and at a pressure."""
    d, free = actuator.dimensions, with_seat(actuator.dimensions, outline.seat_mm)
    rest = Fold(1.0, 1.0, found.value(outline, "fold_line_mm", pressure_kpa), free.half_pitch_mm)
    at = replace(rest, wall_stretch=found.value(outline, "wall_stretch", pressure_kpa))
    across, along = (found.value(outline, name, pressure_kpa) for name in ("fold_across_mm", "fold_along_mm"))
    left = kinematics_mm(d, at, across) - 2.0 * d.convolutions * (along - free.half_pitch_mm)
    return kinematics_mm(d, rest), left


def assumptions_table(rows: Sequence[Row]) -> Table:
    """What the closed form assumes of root and side wall, and what was measured in the outline near the zigzag."""
    lines = []
    for actuator in actuators():
        found = Found(rows, actuator)
        for pressure in PRESSURES_KPA:
            chain = closed_form(actuator.dimensions, actuator.law, pressure)
            hoop = found.value(RIGID_TIP, "wall_hoop_stretch_middle", pressure)
            beside = stretch_beside_hoop(actuator.law, float(chain.wall_stress_mpa[0]), hoop)
            root, wall, middle = (
                found.row(RIGID_TIP, name, pressure)
                for name in ("root_stretch_outer", "wall_stretch", "wall_hoop_stretch_middle")
            )
            slack = [slack_mm(found, actuator, outline, pressure) for outline in (RIGID_TIP, MOULDED)]
            lines.append(
                (
                    actuator.name,
                    f"{pressure:g}",
                    f"{float(chain.root_stretch[0]):.3f}; {_measured(root)}",
                    f"{float(chain.wall_stretch[0]):.3f}; {number_text(beside, '.3f')}; {_measured(wall)}",
                    f"1; {_measured(middle)}",
                    *("; ".join(typeset(value, ".2f", MISSING) for value in values) for values in slack),
                )
            )
    header = (
        "actuator",
        "kPa",
        "root's hoop stretch: closed form; measured",
        "side wall's stretch: closed form; at the measured hoop stretch; measured",
        "hoop stretch half-way along the side wall: closed form; measured",
        "slack near the zigzag, mm: at rest; now",
        "slack as moulded, mm: at rest; now",
    )
    return Table(header, tuple(lines))


def _measured(row: Row | None) -> str:
    return MISSING if row is None else _with_band(row.value, row.uncertainty, decimals=3)


def held_table(rows: Sequence[Row]) -> Table:
    """Where the closed form holds the root at full unfolding: with the rule, without it, and with the measured root."""
    lines = []
    for actuator in actuators():
        d, found = actuator.dimensions, Found(rows, actuator)
        for pressure in PRESSURES_KPA:
            held, free = (closed_form(d, actuator.law, pressure, reading) for reading in (CORRECTED, NOT_HELD))
            if held.state[0] != "fully unfolded":
                continue
            root = found.value(RIGID_TIP, "root_stretch_outer", pressure)
            fold = Fold(root, float(held.wall_stretch[0]), d.side_length_mm, d.half_pitch_mm)
            stretches = (float(held.root_stretch[0]), float(free.root_stretch[0]), root)
            tips = (float(held.elongation_mm[0]), float(free.elongation_mm[0]), kinematics_mm(d, fold))
            lines.append(
                (
                    actuator.name,
                    f"{pressure:g}",
                    *(number_text(value, ".3f") for value in stretches),
                    *(typeset(value, ".1f", MISSING) for value in tips),
                    typeset(tips[0] - tips[1], "+.1f", MISSING),
                    typeset(tips[2] - tips[0], "+.1f", MISSING),
                )
            )
    cases = ("held", "not held", "measured")
    header = (
        "actuator",
        "kPa",
        *(f"root's stretch, {case}" for case in cases),
        *(f"closed form, mm, root {case}" for case in cases),
        "the rule gives, mm",
        "measured less held, mm",
    )
    return Table(header, tuple(lines))


def sentence_figures(rows: Sequence[Row], splits: Sequence[Split]) -> dict[str, str]:
    """The figures of the page's sentences, as ranges over the actuators; ``thin`` ones have walls of 1 mm."""
    low, high = PRESSURES_KPA[0], PRESSURES_KPA[-1]
    found = {actuator.name: Found(rows, actuator) for actuator in actuators()}
    thin = [a for a in actuators() if a.dimensions.wall_mm < 2.0]
    first, last = ([s for s in splits if s.pressure_kpa == p] for p in (low, high))

    def measured(of: Sequence[PaperActuator], outline: Outline, pressure: float) -> str:
        return between([found[a.name].value(outline, "wall_stretch", pressure) for a in of], ".2f")

    def assumed(of: Sequence[PaperActuator], pressure: float) -> str:
        return between([float(closed_form(a.dimensions, a.law, pressure).wall_stretch[0]) for a in of], ".2f")

    slack = [slack_mm(found[a.name], a, MOULDED, low) for a in actuators()]
    apart = [0.5 * abs(measured_side - alone) for s in splits for alone, measured_side in s.both_ends_mm.values()]
    return {
        "slack": between([rest for rest, _ in slack], ".1f"),
        "gone": between([100.0 * (1.0 - now / rest) for rest, now in slack], ".0f"),
        "wall_low": measured(actuators(), MOULDED, low),
        "assumed_low": assumed(actuators(), low),
        "outline_low": between([100.0 * s.sum_mm(*OF_OUTLINE) / s.gap_mm for s in first], ".0f"),
        "outline_high": between([100.0 * s.sum_mm(*OF_OUTLINE) / s.gap_mm for s in last], ".0f"),
        "root_mm": between([s.sum_mm("root") for s in first], "+.1f"),
        "wall_mm": between([s.sum_mm("hoop", "wall") for s in first], "+.1f"),
        "near_mm": between([s.gap_mm - s.sum_mm(*OF_OUTLINE) for s in first], "+.1f"),
        "thin_wall": measured(thin, RIGID_TIP, high),
        "thin_assumed": assumed(thin, high),
        "thin_mm": between([s.sum_mm("hoop", "wall") for s in last if s.actuator in thin], "+.1f"),
        "thin_root_mm": between([s.sum_mm("root") for s in last if s.actuator in thin], "+.1f"),
        "apart": typeset(max(filter(math.isfinite, apart), default=math.nan), ".1f", MISSING),
    }


def between(values: Sequence[float], form: str) -> str:
    """Smallest and largest of values, in words."""
    if any(math.isnan(value) for value in values):
        return MISSING
    return f"{typeset(min(values), form, MISSING)} to {typeset(max(values), form, MISSING)}"
