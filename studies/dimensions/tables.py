"""Tables of the study of the unprinted dimensions; lengths in mm, elongations in mm, masses in g."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Final, TypeVar

import numpy as np

from analytical.arrays import BoolArray
from analytical.bellows.chains_by_name import CHAINS, path_of, printed_mm
from analytical.bellows.fit.masses import mass_allowed, rings_g, silicone_g
from analytical.bellows.fit.members import ORDERS, SILICONES, TEXT_ORDER, Members, wall_stretch
from analytical.bellows.paper import PRINTED_PRESSURE_KPA, PaperActuator
from analytical.bellows.reading import CORRECTED
from studies.dimensions.fit import ACTUATORS, SET_NAMES, ChainFit, Fit, PickedSet, RuleOnGrid, each
from studies.dimensions.predictions import Prediction, rest_length_mm, unfolding_kpa
from studies.dimensions.rows import extremes
from studies.dimensions.scenes import FITTINGS, buildable
from studies.report.numbers import MISSING, signed, typeset
from studies.report.tables import Table, table_of

T = TypeVar("T")
# A set, of one member.
_MEMBER: Final[Mapping[str, Callable[[Members], str]]] = {
    "Dragon Skin": lambda m: silicones_text(m.silicone[0]),
    "R_p, mm": lambda m: f"{m.crest_radius_mm[0]:.4g}",
    "larger R_i, mm": lambda m: f"{m.larger_root_radius_mm[0]:.4g}",
    "e, mm": lambda m: f"{m.half_pitch_mm[0]:.4g}",
    "n": lambda m: f"{m.convolutions[0]}",
    "worst error, %": lambda m: f"{100.0 * m.worst_error[0]:.2f}",
}
_LENGTHS: Final = dict(list(_MEMBER.items())[1:])


def _of_part(
    member: Callable[[T], Members], columns: Mapping[str, Callable[[Members], str]]
) -> dict[str, Callable[[T], str]]:
    """Columns of a member, which may be none, for records that have one."""

    def column(text: Callable[[Members], str]) -> Callable[[T], str]:
        return lambda record: text(member(record)) if len(member(record)) else MISSING

    return {header: column(text) for header, text in columns.items()}


def silicones_text(silicone: Sequence[int]) -> str:
    """Silicones of the four actuators in short."""
    return ", ".join(SILICONES[s].removeprefix("dragon-skin-") for s in silicone)


def sets(found: Fit) -> Table:
    """The picked sets, a line each."""

    def unfolded(of_set: PickedSet) -> str:
        at_kpa = unfolding_kpa(of_set.member)[0]
        names = [a.name for a, kpa in zip(of_set.actuators, at_kpa, strict=True) if kpa <= PRINTED_PRESSURE_KPA]
        return ", ".join(names) or "none"

    columns: dict[str, Callable[[PickedSet], str]] = {
        "set": lambda s: s.name,
        **_of_part(lambda s: s.member, _MEMBER),
        "largest wall stretch": lambda s: f"{wall_stretch(s.member).max():.2f}",
        "length at rest, mm": lambda s: f"{rest_length_mm(s.member)[0, 0]:g}",
        "mean silicone, g": lambda s: f"{s.meshed_g[:, 0].mean():.1f}",
        "with rings, g": lambda s: f"{s.meshed_g.mean(axis=0).sum():.1f}",
        "unfolded at 20 kPa": unfolded,
    }
    return table_of(found.sets, columns, left=(0, 1, len(columns) - 1))


Picked = tuple[PickedSet, PaperActuator]


def picked(found: Fit) -> list[Picked]:
    """The twelve actuators, each with its set."""
    return [(of_set, actuator) for of_set in found.sets for actuator in of_set.actuators]


_NAMES: Final[Mapping[str, Callable[[Picked], str]]] = {
    "set": lambda p: p[0].name,
    "actuator": lambda p: p[1].name,
}


def fitted(found: Fit) -> Table:
    """The twelve actuators: fitted number, other chains, what the paper has from ANSYS and experiment, mm at 20 kPa."""
    columns: dict[str, Callable[[Picked], str]] = {
        **_NAMES,
        "Dragon Skin": lambda p: p[1].silicone.replace("dragon-skin-", ""),
        "paper: closed form": lambda p: f"{printed_mm(p[1])['paper_closed_form']:g}",
        "corrected chain": lambda p: _tip(p[1], "closed_form"),
        "error, %": lambda p: signed(100.0 * _error(p[1])),
        "printed chain": lambda p: _tip(p[1], "closed_form_printed"),
        "balanced chain": lambda p: _tip(p[1], "closed_form_balanced"),
        "paper: ANSYS": lambda p: f"{printed_mm(p[1])['paper_ansys']:g}",
        "paper: experiment": lambda p: f"{printed_mm(p[1])['paper_experiment']:g}",
    }
    return table_of(picked(found), columns, left=(0, 1))


def _tip(actuator: PaperActuator, model: str) -> str:
    """Elongation at 20 kPa by a chain."""
    path = path_of(actuator, CHAINS[model], [PRINTED_PRESSURE_KPA])
    state = " (folded back)" if path.state[0] == "past the model" else ""
    return f"{typeset(float(path.elongation_mm[0]), '.1f', 'no real value')}{state}"


def _error(actuator: PaperActuator) -> float:
    """Of the corrected chain from the printed closed form, relative."""
    tip_mm = float(path_of(actuator, CORRECTED, [PRINTED_PRESSURE_KPA]).elongation_mm[0])
    return tip_mm / printed_mm(actuator)["paper_closed_form"] - 1.0


def saturation(found: Fit) -> Table:
    """Which numbers at 20 kPa rest on the root being held at full unfolding, and what they were without."""

    def unfolds_kpa(actuator: PaperActuator) -> float:
        return float(path_of(actuator, CORRECTED).unfolding_pressure_kpa[0])

    def without_mm(actuator: PaperActuator) -> str:
        if unfolds_kpa(actuator) > PRINTED_PRESSURE_KPA:
            return MISSING
        free = path_of(actuator, replace(CORRECTED, folds_back=True), [PRINTED_PRESSURE_KPA])
        return typeset(float(free.elongation_mm[0]), ".1f", "no real value")

    shares = 100.0 * np.mean(unfolding_kpa(found.members) <= PRINTED_PRESSURE_KPA, axis=0)
    lines = []
    for j, what in enumerate(ACTUATORS):
        of_sets = [of_set.actuators[j] for of_set in found.sets]
        cells = (cell for a in of_sets for cell in (f"{unfolds_kpa(a):.1f}", without_mm(a)))
        lines.append((what, f"{printed_mm(of_sets[0])['paper_closed_form']:g}", *cells, f"{shares[j]:.1f}"))
    header = [f"{name}: {text}" for name in SET_NAMES for text in ("unfolds at, kPa", "without the rule, mm")]
    return Table(("actuator", "printed, mm", *header, "of all that fit, %"), tuple(lines))


def masses(found: Fit) -> Table:
    """Masses of the picked sets: the estimate that the criterion uses, the meshed outline, the rings."""
    lines = []
    for of_set in found.sets:
        estimate = silicone_g(of_set.member, FITTINGS)[0]
        grams = np.column_stack([estimate, of_set.meshed_g, of_set.meshed_g.sum(axis=1)])
        names = [*(actuator.name for actuator in of_set.actuators), "mean of the four"]
        for name, line in zip(names, [*grams, grams.mean(axis=0)], strict=True):
            lines.append((of_set.name, name, *(f"{g:.1f}" for g in line)))
    header = ("set", "actuator", "silicone, estimate", "silicone, outline", "rings", "outline and rings")
    return Table(header, tuple(lines), left=(0, 1))


def what_fits(found: Fit) -> Table:
    """What fits, by silicones: how many, after which filter, and the best continuous set."""
    every, drawn = found.fitting, found.picks.drawn
    counts = ("fit", "mass allowed", "also with rings", "on the 0.5 mm grid", "of these buildable")
    best_of = ("n that fit", *(f"best: {text}" for text in _LENGTHS), "its silicone (estimate), g", "with rings, g")
    lines = []
    for silicone in np.unique(every.silicone, axis=0):
        best = found.refined.take(of_silicone(found.refined, silicone))
        silicone_mass, ring_mass = (of(best, FITTINGS)[0].mean() for of in (silicone_g, rings_g))
        lines.append(
            (
                silicones_text(silicone),
                *_counts(found, of_silicone(every, silicone), of_silicone(drawn, silicone)),
                f"{best.convolutions.min()} to {best.convolutions.max()}",
                *(text(best) for text in _LENGTHS.values()),
                f"{silicone_mass:.1f}",
                f"{silicone_mass + ring_mass:.1f}",
            )
        )
    total = _counts(found, np.full(len(every), True), np.full(len(drawn), True))
    lines.append(("all", *total, *[""] * len(best_of)))
    return Table(("Dragon Skin", *counts, *best_of), tuple(lines))


def of_silicone(members: Members, silicone: Sequence[int]) -> BoolArray:
    """Which members have this choice of silicones, (m,)."""
    return np.asarray(np.all(members.silicone == silicone, axis=1))


def _counts(found: Fit, fitting: BoolArray, drawn: BoolArray) -> tuple[str, ...]:
    allowed = fitting & found.allowed
    counts = (fitting, allowed, allowed & found.allowed_with_rings, drawn, drawn & found.picks.admissible)
    return tuple(f"{np.count_nonzero(count)}" for count in counts)


def candidates(found: Fit) -> Table:
    """Sets on the drawing's grid with one silicone per wall thickness, by wall stretch."""
    members = found.picks.drawn.take(found.picks.drawn.one_silicone_per_wall)
    stretch = np.round(wall_stretch(members).max(axis=1), 9)
    families = dict(zip(SET_NAMES, found.picks.families, strict=True))

    def estimate(member: Members) -> str:
        mass_g = silicone_g(member, FITTINGS)
        return f"{mass_g.mean():.1f}{'' if mass_allowed(mass_g)[0] else ' (outside)'}"

    def picked_as(member: Members) -> str:
        return next((name for name, f in families.items() if member.family(0, f.label) == f), "")

    columns: dict[str, Callable[[Members], str]] = {
        **_MEMBER,
        "largest wall stretch": lambda m: f"{wall_stretch(m).max():.3f}",
        "silicone (estimate), g": estimate,
        "with rings, g": lambda m: f"{silicone_g(m, FITTINGS).mean() + rings_g(m, FITTINGS).mean():.1f}",
        "buildable": lambda m: "yes" if buildable(m)[0] else "no",
        "picked as": picked_as,
    }
    by_stretch = members.take(np.lexsort((members.worst_error, stretch)))
    return table_of(each(by_stretch), columns, left=(0, len(columns) - 2, len(columns) - 1))


def rules(found: Fit) -> Table:
    """What the rule picks on finer grids."""
    columns: dict[str, Callable[[RuleOnGrid], str]] = {
        "step, mm": lambda r: f"{r.step_mm:g}",
        "filter": lambda r: r.shapes,
        "candidates": lambda r: f"{r.candidates}",
        **_of_part(lambda r: r.pick, {**_LENGTHS, "largest wall stretch": lambda m: f"{wall_stretch(m).max():.3f}"}),
    }
    return table_of(found.rules, columns, left=(1,))


def chains(found: Fit) -> Table:
    """The same search and rule with other chains; the corrected chain first."""

    def in_order(fit: ChainFit) -> Members:
        return fit.members.take(fit.members.order == TEXT_ORDER)

    def others(fit: ChainFit) -> str:
        return "; ".join(str(ORDERS[k]) for k in np.unique(fit.members.order) if k != TEXT_ORDER) or "none"

    columns: dict[str, Callable[[ChainFit], str]] = {
        "chain": lambda f: f.label,
        "sets that fit": lambda f: f"{len(f.members)}",
        "in the order of the text": lambda f: f"{len(in_order(f))}",
        "of these one silicone per wall": lambda f: f"{np.count_nonzero(in_order(f).one_silicone_per_wall)}",
        "other orders that fit": others,
        "best in the order of the text": lambda f: _in_one_cell(f.best, "none fits"),
        "the same rule picks": lambda f: _in_one_cell(f.pick, "nothing"),
    }
    return table_of(found.chains, columns, left=(0, 4, 5, 6))


def _in_one_cell(member: Members, none: str) -> str:
    if not len(member):
        return none
    silicones, crest, root, pitch, n, error = (text(member) for text in _MEMBER.values())
    return f"({silicones}) R_p = {crest}, R_i = {root}, e = {pitch}, n = {n}: {error} %"


def spread(found: Fit, predicted: Sequence[Prediction]) -> Table:
    """Predictions that were not fitted: the picked sets, and the range over all that fit."""
    with_rings = found.members_allowed_with_rings
    lines = []
    for prediction in predicted:
        q = prediction.quantity
        for j in range(len(ACTUATORS) if q.per_actuator else 1):
            values = prediction.members[:, j]
            low, high = extremes(values)
            lines.append(
                (
                    f"{q.label}{'' if q.unit == '1' else f', {q.unit}'}" if j == 0 else "",
                    ACTUATORS[j] if q.per_actuator else "all four",
                    *(_three(value) for value in prediction.picks[:, j]),
                    f"{_three(low)} to {_three(high)}",
                    factor(high / low),
                    " to ".join(_three(value) for value in extremes(values[with_rings])),
                )
            )
    ranges = ("all that fit", "largest over smallest", "mass allowed with rings too")
    return Table(("quantity", "actuator", *SET_NAMES, *ranges), tuple(lines), left=(0, 1))


def factor(value: float) -> str:
    """A factor in short."""
    return f"{value:.1f}" if value < 9.95 else f"{value:.0f}"


def _three(value: float) -> str:
    """Three digits, without an exponent."""
    return f"{value:.0f}" if abs(value) >= 99.95 else f"{value:#.3g}"
