"""Tables and sentences of the study of the unprinted dimensions; lengths in mm, elongations in mm, masses in g."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from analytical.arrays import BoolArray
from analytical.bellows.chains import closed_form
from analytical.bellows.fit.masses import MASS_WITHIN, rings_g, silicone_g
from analytical.bellows.fit.members import ORDERS, SILICONES, TEXT_ORDER, Members, wall_stretch
from analytical.bellows.fit.refine import refine
from analytical.bellows.paper import PRINTED_MASS_G, PRINTED_PRESSURE_KPA, InferredFamily, PaperActuator
from analytical.bellows.reading import CORRECTED
from studies.closed_form.tables import CHAINS
from studies.dimensions.fit import (
    ACTUATORS,
    DimensionStudy,
    Prediction,
    RuleOnGrid,
    extremes,
    rest_length_mm,
    unfolding_kpa,
)
from studies.report.numbers import MISSING, signed
from studies.report.tables import Table

SET_NAMES = ("reference", "alternate a", "alternate b")


def sets(study: DimensionStudy) -> Table:
    """The picked sets, a line each."""
    stretch = wall_stretch(study.picks.sets).max(axis=1)
    length = rest_length_mm(study.picks.sets, study.fittings)[:, 0]
    mean_g = study.meshed_g.mean(axis=1)
    lines = []
    unfolded_at = unfolding_kpa(study.picks.sets)
    for k, (name, of_set) in enumerate(zip(SET_NAMES, study.actuators, strict=True)):
        unfolded = [a.name for a, kpa in zip(of_set, unfolded_at[k], strict=True) if kpa <= PRINTED_PRESSURE_KPA]
        lines.append(
            (
                name,
                *_member_cells(study.picks.sets, k),
                f"{stretch[k]:.2f}",
                f"{length[k]:g}",
                f"{mean_g[k, 0]:.1f}",
                f"{mean_g[k].sum():.1f}",
                ", ".join(unfolded) or "none",
            )
        )
    header = ("largest wall stretch", "length at rest, mm", "mean silicone, g", "with rings, g", "unfolded at 20 kPa")
    return Table(("set", *_MEMBER_HEADER, *header), tuple(lines), left=(0, 1, 5 + len(header) + 2))


def fitted(study: DimensionStudy) -> Table:
    """The twelve actuators: fitted number, other chains, what the paper has from ANSYS and experiment, mm at 20 kPa."""
    lines = []
    for name, of_set in zip(SET_NAMES, study.actuators, strict=True):
        for actuator in of_set:
            printed = actuator.printed
            tips = {model: _tip(actuator, model) for model in CHAINS}
            error = 100.0 * (tips["closed_form"][0] / (10.0 * printed.closed_form_cm) - 1.0)
            lines.append(
                (
                    name,
                    actuator.name,
                    actuator.silicone.replace("dragon-skin-", ""),
                    f"{10.0 * printed.closed_form_cm:g}",
                    f"{tips['closed_form'][0]:.1f}",
                    signed(error),
                    _with_state(*tips["closed_form_printed"]),
                    _with_state(*tips["closed_form_balanced"]),
                    f"{10.0 * printed.ansys_cm:g}",
                    f"{10.0 * printed.experiment_cm:g}",
                )
            )
    header = (
        "set",
        "actuator",
        "Dragon Skin",
        "paper: closed form",
        "corrected chain",
        "error, %",
        "printed chain",
        "balanced chain",
        "paper: ANSYS",
        "paper: experiment",
    )
    return Table(header, tuple(lines), left=(0, 1))


def saturation(study: DimensionStudy) -> Table:
    """Which numbers at 20 kPa rest on the root being held at full unfolding, and what they were without."""
    without = replace(CORRECTED, folds_back=True)
    lines = []
    kpa = unfolding_kpa(study.picks.sets)
    shares = np.mean(unfolding_kpa(study.members) <= PRINTED_PRESSURE_KPA, axis=0)
    for j, what in enumerate(ACTUATORS):
        cells: list[str] = []
        for k, of_set in enumerate(study.actuators):
            actuator = of_set[j]
            rests = kpa[k, j] <= PRINTED_PRESSURE_KPA
            free = closed_form(actuator.dimensions, actuator.law, PRINTED_PRESSURE_KPA, without).elongation_mm[0]
            cells += [f"{kpa[k, j]:.1f}", _mm(float(free)) if rests else MISSING]
        printed_mm = 10.0 * study.actuators[0][j].printed.closed_form_cm
        lines.append((what, f"{printed_mm:g}", *cells, f"{100.0 * shares[j]:.1f}"))
    header = [f"{name}: {text}" for name in SET_NAMES for text in ("unfolds at, kPa", "without the rule, mm")]
    return Table(("actuator", "printed, mm", *header, "of all that fit, %"), tuple(lines))


def found(study: DimensionStudy) -> Table:
    """What fits, by silicones: how many, after which filter, and the best continuous set."""
    lines = []
    every = study.fitting
    for silicone in np.unique(every.silicone, axis=0):
        mask = np.all(every.silicone == silicone, axis=1)
        drawn = np.all(study.picks.drawn.silicone == silicone, axis=1)
        best = study.refined.take(np.all(study.refined.silicone == silicone, axis=1))
        silicone_mass, ring_mass = (of(best, study.fittings)[0].mean() for of in (silicone_g, rings_g))
        lines.append(
            (
                _silicones(every, int(np.flatnonzero(mask)[0])),
                *_counts(study, mask, drawn),
                f"{best.convolutions.min()} to {best.convolutions.max()}",
                *_member_cells(best, 0)[1:],
                f"{silicone_mass:.1f}",
                f"{silicone_mass + ring_mass:.1f}",
            )
        )
    everything, all_drawn = np.full(len(every), True), np.full(len(study.picks.drawn), True)
    total = ("all", *_counts(study, everything, all_drawn))
    header = (
        "Dragon Skin",
        "fit",
        "mass allowed",
        "also with rings",
        "on the 0.5 mm grid",
        "of these buildable",
        "n that fit",
        *(f"best: {text}" for text in _MEMBER_HEADER[1:]),
        "its silicone (estimate), g",
        "with rings, g",
    )
    lines.append((*total, *[""] * (len(header) - len(total))))
    return Table(header, tuple(lines))


def candidates(study: DimensionStudy) -> Table:
    """Sets on the drawing's grid with one silicone per wall thickness, by wall stretch."""
    mask = study.picks.drawn.one_silicone_per_wall
    members = study.picks.drawn.take(mask)
    stretch = wall_stretch(members).max(axis=1)
    mean_silicone, mean_rings = (of(members, study.fittings).mean(axis=1) for of in (silicone_g, rings_g))
    lines = []
    for i in np.lexsort((members.worst_error, np.round(stretch, 9))):
        allowed, built = study.picks.allowed[mask][i], study.picks.buildable[mask][i]
        chosen = next((n for n, f in zip(SET_NAMES, study.picks.families, strict=True) if _is(members, int(i), f)), "")
        lines.append(
            (
                *_member_cells(members, int(i)),
                f"{stretch[i]:.3f}",
                f"{mean_silicone[i]:.1f}{'' if allowed else ' (outside)'}",
                f"{mean_silicone[i] + mean_rings[i]:.1f}",
                "yes" if built else "no",
                chosen,
            )
        )
    header = ("largest wall stretch", "silicone (estimate), g", "with rings, g", "buildable", "picked as")
    return Table((*_MEMBER_HEADER, *header), tuple(lines), left=(0, len(_MEMBER_HEADER) + 3, len(_MEMBER_HEADER) + 4))


def rules(study: DimensionStudy) -> Table:
    """What the rule picks on finer grids."""
    lines = []
    for rule in study.rules:
        for what, index in (("any shape", rule.any_shape), ("buildable", rule.buildable)):
            cells = _rule_cells(rule, index)
            lines.append((f"{rule.step_mm:g}", what, f"{len(rule.candidates)}", *cells))
    header = ("step, mm", "filter", "candidates", *_MEMBER_HEADER[1:], "largest wall stretch")
    return Table(header, tuple(lines), left=(1,))


def spread(study: DimensionStudy, predicted: tuple[Prediction, ...]) -> Table:
    """Predictions that were not fitted: the picked sets, and the range over all that fit."""
    with_rings = study.members_allowed_with_rings
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
                    _factor(high / low),
                    " to ".join(_three(value) for value in extremes(values[with_rings])),
                )
            )
    header = (
        "quantity",
        "actuator",
        *SET_NAMES,
        "all that fit",
        "largest over smallest",
        "mass allowed with rings too",
    )
    return Table(header, tuple(lines), left=(0, 1))


def chains(study: DimensionStudy) -> Table:
    """The same search and rule with other chains; the corrected chain first."""
    lines = [_chain_cells("corrected chain", study.fitting, study.refined, study.picks.sets.take(np.array([0])))]
    for fit in study.chains:
        text_order = fit.members.take(fit.members.order == TEXT_ORDER)
        best = refine(text_order.take(np.argsort(text_order.worst_error)[:1]), fit.chain)
        pick = None if fit.pick is None else fit.drawn.take(np.array([fit.pick]))
        lines.append(_chain_cells(fit.chain.label, fit.members, best, pick))
    header = (
        "chain",
        "sets that fit",
        "in the order of the text",
        "of these one silicone per wall",
        "other orders that fit",
        "best in the order of the text",
        "the same rule picks",
    )
    return Table(header, tuple(lines), left=(0, 4, 5, 6))


def masses(study: DimensionStudy) -> Table:
    """Masses of the picked sets: the estimate that the criterion uses, the meshed outline, the rings."""
    estimate = silicone_g(study.picks.sets, study.fittings)
    lines = []
    for k, (name, of_set) in enumerate(zip(SET_NAMES, study.actuators, strict=True)):
        for j, actuator in enumerate(of_set):
            meshed, rings = study.meshed_g[k, j]
            lines.append((name, actuator.name, *(f"{g:.1f}" for g in (estimate[k, j], meshed, rings, meshed + rings))))
        meshed, rings = study.meshed_g[k].mean(axis=0)
        means = (estimate[k].mean(), meshed, rings, meshed + rings)
        lines.append((name, "mean of the four", *(f"{g:.1f}" for g in means)))
    header = ("set", "actuator", "silicone, estimate", "silicone, outline", "rings", "outline and rings")
    return Table(header, tuple(lines), left=(0, 1))


# --- sentences ------------------------------------------------------------------------------


def mass_window() -> str:
    """The allowed masses."""
    low, high = _window_g()
    return f"{low:.1f} to {high:.1f} g"


def _window_g() -> tuple[float, float]:
    return PRINTED_MASS_G * (1.0 - MASS_WITHIN), PRINTED_MASS_G * (1.0 + MASS_WITHIN)


def verdict(study: DimensionStudy) -> str:
    """Whether the rule gives what analytical/bellows/paper.py records."""
    if study.picks.as_recorded:
        return "The three sets are the ones that `analytical/bellows/paper.py` records."
    return (
        "**The rule picks other sets than `analytical/bellows/paper.py` records**: "
        + "; ".join(f"{name}: {family}" for name, family in zip(SET_NAMES, study.picks.families, strict=True))
        + ". Edit `REFERENCE_FAMILY` and `ALTERNATE_FAMILIES` there, or find out why."
    )


def runners_up(study: DimensionStudy) -> str:
    """By how much the reference wins."""
    admissible = study.picks.drawn.take(
        study.picks.allowed & study.picks.buildable & study.picks.drawn.one_silicone_per_wall
    )
    stretch = np.sort(wall_stretch(admissible).max(axis=1))
    if len(stretch) < 2:
        return "No other set is left to choose from."
    return (
        f"{len(stretch)} of them may weigh what they do and can be built; the next after the reference has a wall "
        f"stretch of {stretch[1]:.3f} against {stretch[0]:.3f}."
    )


def finer_grids(study: DimensionStudy) -> str:
    """What the rule would win without a drawing's grid."""
    first, *finer = study.rules
    if first.buildable is None:
        return "Nothing on the drawing's grid can be built."
    reference = first.candidates.take(np.array([first.buildable]))
    parts = []
    for rule in finer:
        if rule.buildable is None:
            parts.append(f"steps of {rule.step_mm:g} mm give nothing that can be built")
            continue
        pick = rule.candidates.take(np.array([rule.buildable]))
        gain = 100.0 * (1.0 - wall_stretch(pick).max() / wall_stretch(reference).max())
        # the same number on both grids up to a step's round-off
        parts.append(
            f"steps of {rule.step_mm:g} mm give the same set"
            if abs(gain) < 1e-6
            else f"steps of {rule.step_mm:g} mm a wall stretch smaller by {gain:.1f} %, for an error of "
            f"{100.0 * pick.worst_error[0]:.2f} %"
        )
    return f"Of what can be built, {'; '.join(parts)}."


def orders(study: DimensionStudy) -> str:
    """In which reading orders, and with how many choices of silicone, anything fits."""
    used = np.unique(study.fitting.order)
    choices = len(SILICONES) ** len(ACTUATORS)
    without = choices - len(np.unique(study.fitting.silicone, axis=0))
    if list(used) != [TEXT_ORDER]:
        return f"Sets fit in these orders: {'; '.join(str(ORDERS[k]) for k in used)}."
    return (
        "**Every set that fits reads the pairs as the text does**: R_i = 5 mm has the larger number of each pair "
        "(a larger root elongates less, says the text), which reverses the 2 mm pair. The other three orders, and "
        f"{without} of the {choices} choices of silicone, do not fit at all."
    )


def differences(predicted: tuple[Prediction, ...]) -> str:
    """By what factor the sets differ in what was not fitted, the worst actuator of each quantity."""
    factors = [(p.members.max(axis=0) / p.members.min(axis=0)).max() for p in predicted]
    texts = (f"{_factor(factor)} ({p.quantity.label})" for p, factor in zip(predicted, factors, strict=True))
    return (
        "Largest over smallest prediction among the sets that all meet the four numbers, for the actuator where it is "
        f"most: {', '.join(texts)}."
    )


def single_masses(study: DimensionStudy) -> str:
    """Which single actuators are outside the window that their mean is asked to be in."""
    low, high = _window_g()
    parts = []
    for name, of_set, masses_g in zip(SET_NAMES, study.actuators, study.meshed_g, strict=True):
        for what, mass in (("alone", masses_g[:, 0]), ("with rings", masses_g.sum(axis=1))):
            outside = [a.name for a, g in zip(of_set, mass, strict=True) if not low <= g <= high]
            if outside:
                parts.append(f"{name}, silicone {what}: {', '.join(outside)}")
    return f"Single actuators outside {mass_window()}: {'; '.join(parts) or 'none'}."


# --- cells ----------------------------------------------------------------------------------

_MEMBER_HEADER = ("Dragon Skin", "R_p, mm", "larger R_i, mm", "e, mm", "n", "worst error, %")


def _member_cells(members: Members, index: int) -> tuple[str, ...]:
    return (
        _silicones(members, index),
        f"{members.crest_radius_mm[index]:.4g}",
        f"{members.larger_root_radius_mm[index]:.4g}",
        f"{members.half_pitch_mm[index]:.4g}",
        f"{members.convolutions[index]}",
        f"{100.0 * members.worst_error[index]:.2f}",
    )


def _silicones(members: Members, index: int) -> str:
    return ", ".join(SILICONES[s].removeprefix("dragon-skin-") for s in members.silicone[index])


def _counts(study: DimensionStudy, mask: BoolArray, drawn: BoolArray) -> tuple[str, ...]:
    built = drawn & study.picks.allowed & study.picks.buildable
    counts = (mask, mask & study.allowed, mask & study.allowed & study.allowed_with_rings, drawn, built)
    return tuple(f"{np.count_nonzero(count)}" for count in counts)


def _is(members: Members, index: int, family: InferredFamily) -> bool:
    return members.family(index, family.label) == family


def _rule_cells(rule: RuleOnGrid, index: int | None) -> tuple[str, ...]:
    if index is None:
        return (MISSING,) * len(_MEMBER_HEADER)
    stretch = wall_stretch(rule.candidates.take(np.array([index]))).max()
    return (*_member_cells(rule.candidates, index)[1:], f"{stretch:.3f}")


def _chain_cells(label: str, members: Members, best: Members, pick: Members | None) -> tuple[str, ...]:
    in_text_order = members.order == TEXT_ORDER
    others = [order for k, order in enumerate(ORDERS) if k != TEXT_ORDER and np.any(members.order == k)]
    return (
        label,
        f"{len(members)}",
        f"{np.count_nonzero(in_text_order)}",
        f"{np.count_nonzero(in_text_order & members.one_silicone_per_wall)}",
        "; ".join(map(str, others)) or "none",
        _sentence(best) if len(best) else "none fits",
        _sentence(pick) if pick is not None else "nothing",
    )


def _sentence(members: Members) -> str:
    """The first of members, in one cell."""
    silicones, crest, root, pitch, n, error = _member_cells(members, 0)
    return f"({silicones}) R_p = {crest}, R_i = {root}, e = {pitch}, n = {n}: {error} %"


def _tip(actuator: PaperActuator, model: str) -> tuple[float, str]:
    """Elongation at 20 kPa, mm, and state of an actuator by a chain."""
    path = closed_form(actuator.dimensions, actuator.law, PRINTED_PRESSURE_KPA, CHAINS[model])
    return float(path.elongation_mm[0]), str(path.state[0])


def _with_state(tip_mm: float, state: str) -> str:
    return f"{_mm(tip_mm)}{' (folded back)' if state == 'past the model' else ''}"


def _mm(value: float) -> str:
    return "no real value" if np.isnan(value) else f"{value:.1f}".replace("-", "\N{MINUS SIGN}")


def _factor(value: float) -> str:
    return f"{value:.1f}" if value < 9.95 else f"{value:.0f}"


def _three(value: float) -> str:
    """Three digits, without an exponent."""
    return f"{value:.0f}" if abs(value) >= 99.95 else f"{value:#.3g}"
