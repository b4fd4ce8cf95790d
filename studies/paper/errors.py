"""Tables of the paper study about the four actuators: answers, errors, assumptions. Lengths are in mm."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from analytical.bellows.chains_by_name import SILICONES
from analytical.bellows.paper import PaperActuator
from studies.paper.cases import HIGHEST_KPA, PRESSURES_KPA, REFERENCE, REFERENCE_SCENES
from studies.paper.results import CaseResult, PaperResults, is_known, means_something, modes
from studies.report.labels import model_label
from studies.report.numbers import (
    MISSING,
    difference_text,
    measured_text,
    signed,
    typeset,
    value_text,
)
from studies.report.tables import Table, table_of
from studies.results.rows import REACHED, Row, difference_percent

CHAINS: Final = (
    "closed_form",
    "closed_form_printed",
    "closed_form_balanced",
    "closed_form_seat",
    "closed_form_outline",
)
PRINTED: Final = ("paper_closed_form", "paper_ansys", "paper_experiment")
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

    @property
    def modes(self) -> str:
        """Unstable modes: axisymmetric, full 3D, tetrahedra."""
        runs = (self.case.axisymmetric, self.case.full3d, self.tetrahedra.full3d)
        return " / ".join(modes(of_model, self.pressure_kpa) for of_model in runs)

    def of(self, model: str) -> Row:
        """Elongation by a model."""
        case, model = (self.tetrahedra, "full3d") if model == TETRAHEDRA else (self.case, model)
        return case.tip(model, self.pressure_kpa)

    def best(self) -> Row:
        """The best finite-element answer."""
        return self.case.best_tip(self.pressure_kpa)


def at_pressures(results: PaperResults, pressures_kpa: Sequence[float] = PRESSURES_KPA) -> Iterator[Answers]:
    """Answers of every actuator at every pressure."""
    for actuator in REFERENCE:
        case, tetrahedra = results.named(actuator.name), results.variant(actuator.name, "tets")
        for pressure in pressures_kpa:
            yield Answers(actuator, case, tetrahedra, pressure)


def label_of(model: str) -> str:
    """What the tables call a model."""
    return "full 3D, tetrahedra" if model == TETRAHEDRA else model_label(model)


def _value(model: str) -> Callable[[Answers], str]:
    return lambda a: value_text(a.of(model))


def _less(model: str, reference: str) -> Callable[[Answers], str]:
    return lambda a: difference_text(a.of(model), a.of(reference))


def _error(model: str) -> Callable[[Answers], str]:
    """Difference from the best answer, and in which unusual state the closed form is."""

    def text(answers: Answers) -> str:
        row = answers.of(model)
        state = row.status.removeprefix(REACHED).strip(", ") if is_known(row) else ""
        return ", ".join(filter(None, (difference_text(row, answers.best()), state)))

    return text


def answers(results: PaperResults) -> Table:
    """Elongation at 20 kPa of each actuator by every model and by the paper, and unstable modes."""
    columns: dict[str, Callable[[Answers], str]] = {
        "actuator": lambda a: a.actuator.name,
        "silicone, inferred": lambda a: SILICONES[a.actuator.silicone],
        **{label_of(model): _value(model) for model in (*CHAINS[:3], *SOLVED, *PRINTED)},
        "unstable modes: axisymmetric / full 3D / tetrahedra": lambda a: a.modes,
    }
    return table_of(at_pressures(results, (HIGHEST_KPA,)), columns, left=(0, 1))


def closed_form_errors(results: PaperResults) -> Table:
    """Each chain less the best finite-element answer, mm and percent of it, by actuator and pressure (kPa)."""
    columns: dict[str, Callable[[Answers], str]] = {
        "actuator": lambda a: a.actuator.name,
        "pressure, kPa": lambda a: f"{a.pressure_kpa:g}",
        "finite elements": lambda a: model_label(a.best().model),
        "elongation, mm": lambda a: value_text(a.best()),
        **{f"{model_label(model)}, mm (%)": _error(model) for model in CHAINS},
    }
    return table_of(at_pressures(results), columns, left=(0, 2))


def model_errors(results: PaperResults) -> Table:
    """The finite-element answers against each other: axisymmetric and tetrahedra less hexahedra, mm (%)."""
    columns: dict[str, Callable[[Answers], str]] = {
        "actuator": lambda a: a.actuator.name,
        "pressure, kPa": lambda a: f"{a.pressure_kpa:g}",
        **{f"{label_of(model)}, mm": _value(model) for model in (*SOLVED, "sector")},
        **{f"{model} less full 3D, mm (%)": _less(model, "full3d") for model in ("axisymmetric", TETRAHEDRA)},
    }
    return table_of(at_pressures(results), columns, left=(0,))


@dataclass(frozen=True)
class Compared:
    """A model's answer at 20 kPa beside what the paper prints."""

    actuator: str
    model: str
    row: Row
    ansys: Row
    test: Row

    def against(self, printed: Row) -> tuple[str, str, str]:
        """Signed difference, absolute difference, percentage; dashes of what is printed with itself."""
        if printed is self.row or not (is_known(self.row) and is_known(printed)):
            return MISSING, MISSING, MISSING
        gap = self.row.value - printed.value
        return typeset(gap, "+.1f"), f"{abs(gap):.1f}", signed(difference_percent(self.row.value, printed.value))


def compared(results: PaperResults) -> list[Compared]:
    """Every model's answers at 20 kPa, the paper's own models among them."""
    models = ("paper_closed_form", "paper_ansys", *CHAINS[:3], *SOLVED)
    return [
        Compared(a.actuator.name, model, a.of(model), a.of("paper_ansys"), a.of("paper_experiment"))
        for a in at_pressures(results, (HIGHEST_KPA,))
        for model in models
    ]


def printed_errors(results: PaperResults) -> Table:
    """Every model at 20 kPa less the paper's ANSYS and less its test: signed and absolute, mm, and percent."""
    lines = (
        (c.actuator, label_of(c.model), value_text(c.row), *c.against(c.ansys), *c.against(c.test))
        for c in compared(results)
    )
    header = tuple(f"{what} {other}" for other in ("ANSYS", "test") for what in ("less", "absolute, mm,", "%, of"))
    return Table(("actuator", "model", "elongation, mm", *header), tuple(lines), left=(0, 1))


def mean_errors(results: PaperResults) -> Table:
    """By model: mean absolute difference from ANSYS and test at 20 kPa (mm, %) over the actuators it is good for."""
    by_model: dict[str, list[Compared]] = {}
    for found in compared(results):
        of_model = by_model.setdefault(found.model, [])
        of_model += [found] if means_something(found.row) and is_known(found.ansys) else []
    lines = []
    for model, of_model in by_model.items():
        cells: list[str] = []
        for pairs in ([(c.row, c.ansys) for c in of_model], [(c.row, c.test) for c in of_model]):
            cells.append(_mean([abs(row.value - printed.value) for row, printed in pairs]))
            cells.append(_mean([abs(difference_percent(row.value, printed.value)) for row, printed in pairs]))
        lines.append((label_of(model), f"{len(of_model)}", *cells))
    header = ("model", "actuators", "from ANSYS, mm", "from ANSYS, %", "from the test, mm", "from the test, %")
    return Table(header, tuple(lines))


def _mean(values: Sequence[float]) -> str:
    return f"{sum(values) / len(values):.1f}" if values else MISSING


def assumptions(results: PaperResults) -> Table:
    """What the model assumes, measured in the axisymmetric states, beside the model's value, by pressure (kPa)."""
    lines = []
    for name in REFERENCE_SCENES:
        case = results.named(name)
        for quantity, label in ASSUMPTIONS.items():
            cells = [
                _beside(case.row(quantity, pressure_kpa=p), case.row(quantity, "closed_form", p)) for p in PRESSURES_KPA
            ]
            if any(cell != MISSING for cell in cells):
                lines.append((name, label, *cells))
    header = ("actuator", "what", *(f"{pressure:g} kPa" for pressure in PRESSURES_KPA))
    return Table(header, tuple(lines), left=(0, 1))


def _beside(found: Row, model: Row) -> str:
    """A measured number and the model's, which is off by so many percent of the measured one."""
    if not is_known(model) or found.status == MISSING:
        return measured_text(found)
    if not is_known(found) or found.value == 0.0:
        return f"{measured_text(found)}; model {model.value:.4g}"
    percent = difference_percent(model.value, found.value)
    return f"{measured_text(found)}; model {model.value:.4g} ({signed(percent)} %)"


def unfoldings(results: PaperResults) -> Table:
    """Pressure (kPa) at which the roots are unfolded: finite elements beside the closed form."""
    lines = []
    for name in REFERENCE_SCENES:
        found, model = (results.unfolding(name, of) for of in ("axisymmetric", "closed_form"))
        lines.append((name, measured_text(found), measured_text(model), difference_text(model, found)))
    header = ("actuator", "axisymmetric, kPa", "closed form, kPa", "closed form less axisymmetric, kPa (%)")
    return Table(header, tuple(lines))
