"""Tables of the paper study about the four actuators: answers, errors, assumptions. Lengths are in mm."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from analytical.bellows.paper import PaperActuator
from studies.paper.cases import HIGHEST_KPA, PRESSURES_KPA, REFERENCE, REFERENCE_SCENES
from studies.paper.results import CaseResult, PaperResults, is_known, means_something, modes, no_row
from studies.paper.setup.sizes import called
from studies.report.labels import model_label
from studies.report.numbers import (
    MISSING,
    difference_text,
    measured_text,
    number_text,
    signed,
    typeset,
    up,
    value_text,
)
from studies.report.tables import Table, table_of
from studies.results.rows import FOLDED_BACK, REACHED, Row, difference_percent

CHAINS: Final = (
    "closed_form",
    "closed_form_printed",
    "closed_form_balanced",
    "closed_form_seat",
    "closed_form_outline",
)
PRINTED: Final = ("paper_closed_form", "paper_ansys", "paper_experiment")
# The two outlines of the same R_i, R_p, t, e and n that are meshed.
Outline = Literal["as moulded", "near the zigzag"]
MOULDED: Final = "as moulded"
ZIGZAG: Final = "near the zigzag"
# Half of the last digit of a printed length.
PRINT_MM: Final = 0.5
# Full 3D with the paper's elements, which are a case of their own.
TETRAHEDRA: Final = "tetrahedra"
SOLVED: Final = ("axisymmetric", "full3d", TETRAHEDRA)

# Measured quantities and what each says of the model's assumption.
ASSUMPTIONS: Final = {
    "root_stretch_outer": "λ_y, hoop stretch of the root, outside",
    "root_stretch_inner": "hoop stretch of the root, inside",
    "wall_stretch": "λ_a, stretch of the side wall along its length",
    "wall_hoop_stretch_middle": "hoop stretch half-way up the side wall (model: pure shear)",
    "ring_hoop_stretch": "hoop stretch under the ring (model: rigid)",
    "root_bulge_mm": "outward displacement of the root, mm",
}


@dataclass(frozen=True)
class Answers:
    """Elongations of one of the paper's actuators at a pressure (kPa) by every model."""

    actuator: PaperActuator
    case: CaseResult
    tetrahedra: CaseResult
    pressure_kpa: float

    def modes(self, model: str) -> str:
        """Unstable modes of a model's finest run; a dash where none are counted."""
        runs = {
            "axisymmetric": self.case.axisymmetric,
            "full3d": self.case.full3d,
            TETRAHEDRA: self.tetrahedra.full3d,
        }
        return modes(runs.get(model, ()), self.pressure_kpa)

    def of(self, model: str) -> Row:
        """Elongation by a model."""
        case, model = (self.tetrahedra, "full3d") if model == TETRAHEDRA else (self.case, model)
        return case.tip(model, self.pressure_kpa)

    def best(self) -> Row:
        """The best finite-element answer."""
        return self.case.best_tip(self.pressure_kpa)

    def centre(self) -> Row:
        """Elongation at the middle of the closed end by the same run."""
        return self.case.row("tip_centre_mm", self.best().model, self.pressure_kpa)

    def rim(self) -> Row:
        """Elongation on the mesh that `centre` is of."""
        return self.case.tip(self.best().model, self.pressure_kpa, self.centre().level)

    def bulge_mm(self) -> float:
        """By how much the middle of the closed end goes further than its rim, mm; NaN where not known."""
        return self.centre().value - self.rim().value


def at_pressures(
    results: PaperResults, pressures_kpa: Sequence[float] = PRESSURES_KPA, outline: Outline = MOULDED
) -> Iterator[Answers]:
    """Answers of every actuator of an outline at every pressure; tetrahedra are of those as moulded."""
    for actuator in REFERENCE:
        case = results.named(actuator.name) if outline == MOULDED else results.near_zigzag(actuator.name)
        tetrahedra = results.variant(actuator.name, "tets")
        for pressure in pressures_kpa:
            yield Answers(actuator, case, tetrahedra, pressure)


def label_of(model: str) -> str:
    """What the tables call a model."""
    return "full 3D, tetrahedra" if model == TETRAHEDRA else model_label(model)


def _value(model: str) -> Callable[[Answers], str]:
    return lambda a: value_text(a.of(model))


def _less(model: str, reference: str) -> Callable[[Answers], str]:
    return lambda a: difference(a.of(model), a.of(reference))


def difference(row: Row, reference: Row) -> str:
    """Signed difference, mm, with the sum of what uncertainties the two have, and in percent of the second."""
    gap, doubt = row.value - reference.value, [u for u in (_doubt(row), _doubt(reference)) if math.isfinite(u)]
    if not math.isfinite(gap) or reference.value == 0.0:
        return MISSING
    digits = 1 if row.model in PRINTED or reference.model in PRINTED else 2
    text = typeset(gap, f"+.{digits}f") + (f" ± {up(sum(doubt), digits)}" if doubt else "")
    return f"{text} ({signed(difference_percent(row.value, reference.value))} %)"


def _doubt(row: Row) -> float:
    """Uncertainty of a row, mm; of a printed number half its last digit; NaN where there is none."""
    return PRINT_MM if row.model in PRINTED else row.uncertainty


def _error(model: str) -> Callable[[Answers], str]:
    """Difference from the best answer, and in which unusual state the closed form is."""

    def text(answers: Answers) -> str:
        row = answers.of(model)
        state = row.status.removeprefix(REACHED).strip(", ") if is_known(row) else ""
        folded = row.status == FOLDED_BACK
        return state if folded else ", ".join(filter(None, (difference(row, answers.best()), state)))

    return text


def answers(results: PaperResults) -> Table:
    """Elongation at 20 kPa of each actuator by the closed form and by the best finite elements of both outlines."""
    lines = []
    for moulded in at_pressures(results, (HIGHEST_KPA,)):
        near = results.near_zigzag(moulded.actuator.name).best_tip()
        known = moulded.of("closed_form")
        lines.append(
            (
                called(moulded.actuator),
                value_text(known),
                value_text(moulded.best()),
                _percent(known, moulded.best()),
                value_text(near),
                _percent(known, near),
            )
        )
    columns = ((f"finite elements {o}, mm", f"closed form less those {o}, %") for o in (MOULDED, ZIGZAG))
    header = ("actuator", "closed form, mm", *(text for pair in columns for text in pair))
    return Table(header, tuple(lines), left=(0,))


def _percent(row: Row, reference: Row) -> str:
    known = is_known(row) and is_known(reference)
    return signed(difference_percent(row.value, reference.value)) if known else MISSING


def centres(results: PaperResults) -> Table:
    """Elongation at 20 kPa at the middle of the closed end beside that of its rim, mm, best finite-element answer."""
    columns: dict[str, Callable[[Answers], str]] = {
        "actuator": lambda a: called(a.actuator),
        "rim, mm": lambda a: value_text(a.rim()),
        "middle, mm": lambda a: number_text(a.centre().value, ".2f"),
        "middle less rim, mm (%)": lambda a: difference_text(a.centre(), a.rim()),
        "over the uncertainty": lambda a: number_text(a.bulge_mm() / a.rim().uncertainty, ".0f"),
        "paper: test, mm": _value("paper_experiment"),
    }
    return table_of(at_pressures(results, (HIGHEST_KPA,)), columns, left=(0,))


def closed_form_errors(results: PaperResults, outline: Outline = MOULDED) -> Table:
    """Each chain less the best finite-element answer of an outline, mm (% of it), by actuator and pressure (kPa)."""
    columns: dict[str, Callable[[Answers], str]] = {
        "actuator": lambda a: called(a.actuator),
        "pressure, kPa": lambda a: f"{a.pressure_kpa:g}",
        "finite elements": lambda a: model_label(a.best().model),
        "elongation, mm": lambda a: value_text(a.best()),
        **{f"{model_label(model)}, mm (%)": _error(model) for model in CHAINS},
    }
    return table_of(at_pressures(results, outline=outline), columns, left=(0, 2))


def model_errors(results: PaperResults) -> Table:
    """The finite-element answers against each other: axisymmetric and tetrahedra less hexahedra, mm (%)."""
    columns: dict[str, Callable[[Answers], str]] = {
        "actuator": lambda a: called(a.actuator),
        "pressure, kPa": lambda a: f"{a.pressure_kpa:g}",
        **{f"{label_of(model)}, mm": _value(model) for model in SOLVED},
        **{f"{model} less full 3D, mm (%)": _less(model, "full3d") for model in ("axisymmetric", TETRAHEDRA)},
    }
    return table_of(at_pressures(results), columns, left=(0,))


def zigzag_models(results: PaperResults) -> Table:
    """Axisymmetric and full 3D answers near the zigzag, mm, and the first less the second."""
    columns: dict[str, Callable[[Answers], str]] = {
        "actuator": lambda a: called(a.actuator),
        "pressure, kPa": lambda a: f"{a.pressure_kpa:g}",
        **{f"{label_of(model)}, mm": _value(model) for model in ("axisymmetric", "full3d")},
        "axisymmetric less full 3D, mm (%)": _less("axisymmetric", "full3d"),
        "unstable modes: axisymmetric / full 3D": lambda a: f"{a.modes('axisymmetric')} / {a.modes('full3d')}",
    }
    return table_of(at_pressures(results, outline=ZIGZAG), columns, left=(0,))


def printed_errors(results: PaperResults) -> Table:
    """Elongation at 20 kPa by every model and by the paper, less its ANSYS and its test, mm (%), and unstable modes."""
    lines = []
    for a in at_pressures(results, (HIGHEST_KPA,)):
        printed = [a.of("paper_ansys"), a.of("paper_experiment")]
        for model in (*CHAINS, *SOLVED, *PRINTED):
            row = a.of(model)
            others = [of if row.model != of.model and means_something(row) else no_row() for of in printed]
            gaps = (difference(row, of) for of in others)
            lines.append((called(a.actuator), label_of(model), value_text(row), *gaps, a.modes(model)))
    header = ("actuator", "model", "elongation, mm", "less ANSYS, mm (%)", "less test, mm (%)", "unstable modes")
    return Table(header, tuple(lines), left=(0, 1))


def assumptions(results: PaperResults) -> Table:
    """What the closed form assumes at 20 kPa beside what is measured in the axisymmetric states, three digits."""
    lines = []
    for actuator in REFERENCE:
        case = results.named(actuator.name)
        for quantity, label in ASSUMPTIONS.items():
            found, model = case.row(quantity), case.row(quantity, "closed_form")
            if found.status != MISSING:
                lines.append((called(actuator), label, *_beside(found, model)))
    header = ("actuator", f"at {HIGHEST_KPA:g} kPa", "finite elements", "closed form", "closed form is off by, %")
    return Table(header, tuple(lines), left=(0, 1))


def _beside(found: Row, model: Row) -> tuple[str, str, str]:
    """A measured number, the closed form's, and by how many percent of the measured one that is off."""
    known = is_known(found) and is_known(model) and found.value != 0.0
    off = signed(difference_percent(model.value, found.value)) if known else MISSING
    return number_text(found.value, "#.3g"), number_text(model.value, "#.3g"), off


def assumptions_percent(results: PaperResults) -> float:
    """Largest uncertainty of the measured numbers in `assumptions`, percent; NaN if there are none."""
    rows = [results.named(name).row(quantity) for name in REFERENCE_SCENES for quantity in ASSUMPTIONS]
    found = [100.0 * row.uncertainty / abs(row.value) for row in rows if is_known(row) and row.value]
    return max(filter(math.isfinite, found), default=math.nan)


def unfoldings(results: PaperResults) -> Table:
    """Pressure (kPa) at which the roots are unfolded: finite elements beside the closed form."""
    lines = []
    for actuator in REFERENCE:
        found, model = (results.unfolding(actuator.name, of) for of in ("axisymmetric", "closed_form"))
        lines.append((called(actuator), measured_text(found), measured_text(model), difference_text(model, found)))
    header = ("actuator", "axisymmetric, kPa", "closed form, kPa", "closed form less axisymmetric, kPa (%)")
    return Table(header, tuple(lines))
