"""Tables of the paper study about the four actuators: answers, errors, assumptions. Lengths are in mm."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from analytical.bellows.paper import PaperActuator
from studies.closed_form.chains import SILICONES
from studies.paper.numbers import (
    PRESSURES_KPA,
    best,
    difference,
    finest,
    is_known,
    means_something,
    measured,
    modes,
    named,
    number,
    sets,
    signed_number,
    tip,
    unfolding,
)
from studies.paper.results import CaseResult, PaperResults
from studies.report.labels import model_label
from studies.report.numbers import MISSING, signed, value_text
from studies.report.tables import Table
from studies.results.rows import REACHED, Row, difference_percent

CHAINS: Final = ("closed_form", "closed_form_printed", "closed_form_balanced", "closed_form_seat")
PRINTED: Final = ("paper_closed_form", "paper_ansys", "paper_experiment")
TETS: Final = "full 3D, tetrahedra"

# Measured quantities and what each says of the model's assumption.
ASSUMPTIONS: Final = {
    "root_stretch_outer": "λ_y, hoop stretch of the root, outside",
    "root_stretch_inner": "hoop stretch of the root, inside",
    "wall_stretch": "λ_a, stretch of the side wall along its length",
    "wall_hoop_stretch_middle": "hoop stretch half-way up the side wall (model: pure shear)",
    "ring_hoop_stretch": "hoop stretch under the ring (model: rigid)",
    "root_bulge_mm": "outward displacement of the root, mm",
}


def _reference() -> tuple[PaperActuator, ...]:
    return sets()[0][1]


def answers(results: PaperResults) -> Table:
    """Elongation at 20 kPa of each actuator by every model and by the paper, and unstable modes."""
    lines = []
    for actuator in _reference():
        case, tets = named(results, actuator.name), results.variant(actuator.name, "tets")
        counts = [modes(finest(of.result.full3d) if of else None) for of in (case, tets)]
        counts.insert(0, modes(finest(case.result.axisymmetric) if case else None))
        lines.append(
            (
                actuator.name,
                SILICONES[actuator.silicone],
                *(value_text(tip(case, model)) for model in CHAINS[:3]),
                *(value_text(tip(of, model)) for of, model in _solved(case, tets)),
                *(value_text(tip(case, model)) for model in PRINTED),
                " / ".join(counts),
            )
        )
    header: tuple[str, ...] = (
        "actuator",
        "silicone, inferred",
        *map(model_label, CHAINS[:3]),
        "axisymmetric",
        "full 3D",
        TETS,
    )
    header += (*map(model_label, PRINTED), "unstable modes: axisymmetric / full 3D / tetrahedra")
    return Table(header, tuple(lines), left=(0, 1))


def _solved(case: CaseResult | None, tets: CaseResult | None) -> tuple[tuple[CaseResult | None, str], ...]:
    """Where each finite-element answer of an actuator is: its case and model."""
    return (case, "axisymmetric"), (case, "full3d"), (tets, "full3d")


def closed_form_errors(results: PaperResults) -> Table:
    """Each chain less the best finite-element answer, mm and percent of it, by actuator and pressure (kPa)."""
    lines = []
    for actuator in _reference():
        case = named(results, actuator.name)
        for pressure in PRESSURES_KPA:
            reference = best(case, pressure)
            model = model_label(reference.model) if reference else MISSING
            chains = (_error(tip(case, model, pressure), reference) for model in CHAINS)
            lines.append((actuator.name, f"{pressure:g}", model, value_text(reference), *chains))
    header: tuple[str, ...] = ("actuator", "pressure, kPa", "finite elements", "elongation, mm")
    header += tuple(f"{model_label(model)}, mm (%)" for model in CHAINS)
    return Table(header, tuple(lines), left=(0, 2))


def _error(row: Row | None, reference: Row | None) -> str:
    """Difference, and in which unusual state the closed form is."""
    text = difference(row, reference)
    state = row.status.removeprefix(REACHED).strip(", ") if row and is_known(row) else ""
    return f"{text}, {state}" if state else text


def model_errors(results: PaperResults) -> Table:
    """The finite-element answers against each other: axisymmetric and tetrahedra less hexahedra, mm (%)."""
    lines = []
    for actuator in _reference():
        case, tets = named(results, actuator.name), results.variant(actuator.name, "tets")
        for pressure in PRESSURES_KPA:
            solid = tip(case, "full3d", pressure)
            found = [tip(of, model, pressure) for of, model in _solved(case, tets)]
            sector = tip(case, "sector", pressure)
            lines.append(
                (
                    actuator.name,
                    f"{pressure:g}",
                    *(value_text(row) for row in found),
                    value_text(sector),
                    *(difference(row, solid) for row in (found[0], found[2])),
                )
            )
    header: tuple[str, ...] = ("actuator", "pressure, kPa", "axisymmetric, mm", "full 3D, mm", f"{TETS}, mm")
    header += ("sector, mm", *(f"{model} less full 3D, mm (%)" for model in ("axisymmetric", "tetrahedra")))
    return Table(header, tuple(lines))


def printed_errors(results: PaperResults) -> Table:
    """Every model at 20 kPa less the paper's ANSYS and less its test: signed and absolute, mm, and percent."""
    lines = []
    for actuator in _reference():
        for label, row, case in _models(results, actuator):
            lines.append(
                (
                    actuator.name,
                    label,
                    value_text(row),
                    *_apart(row, tip(case, "paper_ansys")),
                    *_apart(row, tip(case, "paper_experiment")),
                )
            )
    header: tuple[str, ...] = ("actuator", "model", "elongation, mm")
    header += tuple(f"{what} {other}" for other in ("ANSYS", "test") for what in ("less", "absolute, mm,", "%, of"))
    return Table(header, tuple(lines), left=(0, 1))


def _apart(row: Row | None, reference: Row | None) -> tuple[str, str, str]:
    """Signed difference, absolute difference, percentage."""
    if row is None or reference is None or row is reference or not is_known(row) or not is_known(reference):
        return MISSING, MISSING, MISSING
    gap = row.value - reference.value
    return signed_number(gap, 1), f"{abs(gap):.1f}", signed(difference_percent(row.value, reference.value))


def mean_errors(results: PaperResults) -> Table:
    """By model: mean absolute difference from ANSYS and test at 20 kPa (mm, %) over the actuators it is good for."""
    found: dict[str, list[tuple[Row, CaseResult]]] = {}
    for actuator in _reference():
        for label, row, case in _models(results, actuator):
            found.setdefault(label, [])
            if row is not None and case is not None and means_something(row):
                found[label].append((row, case))
    lines = []
    for label, rows in found.items():
        cells: list[str] = []
        for model in ("paper_ansys", "paper_experiment"):
            pairs = [(row, reference) for row, case in rows if (reference := tip(case, model))]
            gaps = [abs(row.value - reference.value) for row, reference in pairs]
            shares = [abs(difference_percent(row.value, reference.value)) for row, reference in pairs]
            cells += [_mean(gaps), _mean(shares)]
        lines.append((label, f"{len(rows)}", *cells))
    header = ("model", "actuators", "from ANSYS, mm", "from ANSYS, %", "from the test, mm", "from the test, %")
    return Table(header, tuple(lines))


def _mean(values: Sequence[float]) -> str:
    return f"{sum(values) / len(values):.1f}" if values else MISSING


def _models(results: PaperResults, actuator: PaperActuator) -> list[tuple[str, Row | None, CaseResult | None]]:
    """Every model's row at 20 kPa, the paper's own models among them, and the case that has the printed rows."""
    case, tets = named(results, actuator.name), results.variant(actuator.name, "tets")
    models = [
        (model_label(model), tip(case, model), case) for model in ("paper_closed_form", "paper_ansys", *CHAINS[:3])
    ]
    solved = zip(("axisymmetric", "full 3D", TETS), _solved(case, tets), strict=True)
    return models + [(label, tip(of, model), case) for label, (of, model) in solved]


def assumptions(results: PaperResults) -> Table:
    """What the model assumes, measured in the axisymmetric states, beside the model's value, by pressure (kPa)."""
    lines = []
    for actuator in _reference():
        case = named(results, actuator.name)
        for quantity, label in ASSUMPTIONS.items():
            cells = []
            for pressure in PRESSURES_KPA:
                found = measured(case, quantity, "axisymmetric", pressure)
                model = measured(case, quantity, "closed_form", pressure)
                cells.append(_beside(found, model))
            if any(cell != MISSING for cell in cells):
                lines.append((actuator.name, label, *cells))
    header = ("actuator", "what", *(f"{pressure:g} kPa" for pressure in PRESSURES_KPA))
    return Table(header, tuple(lines), left=(0, 1))


def _beside(found: Row | None, model: Row | None) -> str:
    """A measured number and the model's, which is off by so many percent of the measured one."""
    if model is None or found is None or not is_known(model):
        return number(found)
    if not is_known(found) or found.value == 0.0:
        return f"{number(found)}; model {model.value:.4g}"
    percent = difference_percent(model.value, found.value)
    return f"{number(found)}; model {model.value:.4g} ({signed(percent)} %)"


def unfoldings(results: PaperResults) -> Table:
    """Pressure (kPa) at which the roots are unfolded: finite elements beside the closed form."""
    lines = []
    for actuator in _reference():
        found = unfolding(results, actuator.name, "axisymmetric")
        model = unfolding(results, actuator.name, "closed_form")
        lines.append((actuator.name, number(found), number(model), difference(model, found)))
    header = ("actuator", "axisymmetric, kPa", "closed form, kPa", "closed form less axisymmetric, kPa (%)")
    return Table(header, tuple(lines))
