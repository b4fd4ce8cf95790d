"""The paper's statements: those that runs decide with their verdicts, those about its program, those nobody can tell.

Since the dimensions are unknown, a statement about the actuators is judged in the reference and in every drawn set.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, Literal

from analytical.bellows.paper import PRINTED
from studies.paper.cases import HIGHEST_KPA, PRESSURES_KPA, REFERENCE_SCENES, THICK, THIN
from studies.paper.results import Four, PaperResults, is_known, last_kpa
from studies.paper.setup.sizes import CALLED
from studies.paper.statements import judges, mechanism
from studies.paper.statements.judges import SLOTS, Judge, Judgement, nearest
from studies.paper.statements.verdicts import FAILS, HOLDS, UNDECIDED, Verdict, all_of, over_sets, smaller
from studies.report.labels import model_label
from studies.report.numbers import MISSING, typeset, value_text
from studies.report.tables import Table
from studies.results.rows import difference_percent
from studies.results.runs import Run

# Kinds of drawn sets in which statements are judged; in the others the reference's inferred dimensions are the same.
JUDGED_IN: Final = ("corrected", "balanced")
# Printed: largest gaps of simulation and of model to the test, cm; every printed length is good to 0.05 cm.
SIMULATION_GAP_CM, MODEL_GAP_CM, PRINT_CM = 2.6, 2.0, 0.05

# What is judged in every set: in short, and the paper's statement in our words.
IN_SETS: Final[tuple[tuple[str, str, Judge], ...]] = (
    (
        "the larger root elongates less",
        "The larger root radius elongates less, at either wall thickness and at every pressure.",
        judges.LARGER_ROOT_SHORTENS,
    ),
    (
        "the larger root bulges more",
        "The larger root radius bulges more at the root, at the same pressure.",
        judges.LARGER_ROOT_BULGES,
    ),
    (
        "the thicker wall elongates less",
        "The thicker wall elongates less, at either root radius and every pressure (as built: silicones may differ).",
        judges.THICKER_WALL_SHORTENS,
    ),
    ("elongation rises with pressure", "The elongation rises with the pressure.", judges.rises),
    (
        "the curve bends at first",
        "Elongation over pressure is nonlinear at first and more nearly linear later.",
        judges.bends_first,
    ),
    (
        "unfolded at 20 kPa",
        f"At {HIGHEST_KPA:g} kPa the roots are fully unfolded, which is where the tests end.",
        judges.UNFOLDED,
    ),
    (
        "elongation is unfolding",
        f"Up to {HIGHEST_KPA:g} kPa the predominant deformation is unfolding: more than "
        f"{100.0 * mechanism.PREDOMINANT:g} % of the elongation, a limit of ours.",
        mechanism.UNFOLDS,
    ),
    (
        "negligible bulging",
        f"Up to {HIGHEST_KPA:g} kPa bulging is negligible: roots beyond the crests by less than "
        f"{100.0 * mechanism.NEGLIGIBLE:g} % of the folds' depth, a limit of ours.",
        mechanism.HARDLY_BULGES,
    ),
    (
        "most deformation at the root",
        "The primary deformation is in the bulging regions near the root, not in the extension: the root's hoop "
        "stretch is larger than the side wall's.",
        mechanism.MOST_AT_THE_ROOT,
    ),
    (
        "the tip stays flat",
        "The tip does not deform across its section: its middle and its rim go equally far, within "
        f"{100.0 * mechanism.FLAT:g} %, a limit of ours.",
        mechanism.STAYS_FLAT,
    ),
    (
        "less strain than a tube",
        "A bellows strains less than a fibre-reinforced tube: less than one of its length and elongation.",
        mechanism.STRAINS_LESS,
    ),
    ("less volume than a tube", "Its volume changes less than that of such a tube.", mechanism.GROWS_LESS),
)

# What is printed so that nothing here can decide it, and why.
CANNOT_TELL: Final = (
    "The output force was measured: none is printed.",
    "More than 20 kPa causes irregular bulging: neither a number nor a shape is printed.",
    "Stability during elongation depends on the dimensions: no measure of it is given.",
    "A bellows is faster and more durable than a tube: no model here has time or fatigue.",
)


@dataclass(frozen=True)
class Claim:
    """A statement of the paper and what the rows say of it.

    Attributes
    ----------
    name
        In short.
    text
        In our words.
    verdict
        Of the reference, if nearly all sets agree.
    sets
        In how many sets it holds.
    reference
        The reference's verdict and the two numbers that decide it.
    details
        By actuator, where it is about each.
    """

    name: str
    text: str
    verdict: Verdict
    sets: str
    reference: str
    details: tuple[str, ...] = ()


def claims(results: PaperResults) -> tuple[Claim, ...]:
    """All statements that runs decide, in the order of the report."""
    drawn = results.drawn(*JUDGED_IN)
    found = [_in_sets(name, text, judge, results.reference, drawn) for name, text, judge in IN_SETS]
    return (*found[:3], thicker_wall_shortens_alike(results), *found[3:6], longest_at_highest(results), *found[6:])


def _in_sets(name: str, text: str, judge: Judge, reference: Four, drawn: Sequence[Four]) -> Claim:
    own, others = judge(reference), [judge(four) for four in drawn]
    verdict = over_sets(own.verdict, [other.verdict for other in others])
    holding = f"{sum(other.verdict == HOLDS for other in others)} of {len(others)}" if others else MISSING
    return Claim(name, text, verdict, holding, _own(own), tuple(_details(own, others)))


def _own(own: Judgement) -> str:
    return own.verdict if own.pair == MISSING else f"{own.verdict}: {own.pair}"


def _details(own: Judgement, others: Sequence[Judgement]) -> list[str]:
    """Of each actuator: what the reference says, and how many sets."""
    found = []
    for k, (slot, verdict, pair) in enumerate(zip(SLOTS, own.parts, own.pairs, strict=False)):
        holding = sum(other.parts[k] == HOLDS for other in others)
        in_sets = f"; holds in {holding} of {len(others)} sets" if others else ""
        found.append(f"{slot}: {_own(Judgement(verdict, pair))}{in_sets}")
    return found


def claims_table(found: Sequence[Claim]) -> Table:
    """A line per statement."""
    lines = tuple((f"{k}", c.text, c.verdict, c.sets, c.reference) for k, c in enumerate(found, 1))
    return Table(("", "the paper says", "verdict", "sets", "reference"), lines, left=(1, 2, 4))


def in_words(found: Sequence[Claim]) -> str:
    """The statements by their verdicts, in short."""
    words: dict[Verdict, str] = {HOLDS: "hold", FAILS: "do not hold", UNDECIDED: "cannot be told"}
    parts = []
    for verdict, word in words.items():
        names = [claim.name for claim in found if claim.verdict == verdict]
        parts += [f"{word}: {', '.join(names)}"] if names else []
    return f"Of the paper's statements {'; '.join(parts)}."


# --- of the reference alone -----------------------------------------------------------------


def thicker_wall_shortens_alike(results: PaperResults) -> Claim:
    """Elongation of both wall thicknesses in one silicone, reference dimensions."""
    verdicts, near = [], []
    for thin, thick in zip(THIN, THICK, strict=True):
        pairs = {
            "Dragon Skin 10": (results.named(thin), results.variant(thick, "silicone")),
            "Dragon Skin 30": (results.variant(thin, "silicone"), results.named(thick)),
        }
        for silicone, cases in pairs.items():
            for pressure in PRESSURES_KPA:
                soft, stiff = (case.tip(pressure_kpa=pressure) for case in cases)
                verdicts.append(smaller(stiff, soft))
                margin = difference_percent(soft.value, stiff.value) if is_known(stiff) else math.nan
                where = f"{silicone}, {pressure:g} kPa"
                near.append((margin, f"{value_text(stiff)} against {value_text(soft)} mm ({where})"))
    text = "The thicker wall elongates less when both are of one silicone."
    own = Judgement(all_of(verdicts), nearest(near))
    return Claim("the thicker wall elongates less in one silicone", text, own.verdict, "reference only", _own(own))


def longest_at_highest(results: PaperResults) -> Claim:
    """Elongation at 20 kPa beside that at the highest pressure that the runs to 30 kPa reached."""
    verdicts: list[Verdict] = []
    near = []
    for slot, name in zip(SLOTS, REFERENCE_SCENES, strict=True):
        case = results.variant(name, "beyond")
        rows = [case.tip(pressure_kpa=p) for p in case.pressures_kpa if p > HIGHEST_KPA]
        known = [row for row in rows if is_known(row)]
        verdicts.append(smaller(known[-1], case.tip()) if known else UNDECIDED)
        if known:
            more = f"{value_text(known[-1])} mm at {known[-1].pressure_kpa:g} kPa"
            margin = -difference_percent(known[-1].value, case.tip().value)
            near.append((margin, f"{value_text(case.tip())} mm against {more} ({slot})"))
    text = f"At {HIGHEST_KPA:g} kPa the actuator is at its longest; more pressure does not lengthen it."
    own = Judgement(all_of(verdicts), nearest(near))
    return Claim("longest at 20 kPa", text, own.verdict, "reference only", _own(own))


# --- about their program --------------------------------------------------------------------


def about_their_program(results: PaperResults) -> tuple[str, ...]:
    """Statements about ANSYS, and subtractions of the paper's own numbers: what was done, beside what happens here."""
    return (
        f"The cost of a solution rises with the pressure. Here, Newton iterations per 5 kPa: "
        f"{cost(results, 'axisymmetric')}; {cost(results, 'full3d')}.",
        f"No solution converges above {HIGHEST_KPA:g} kPa. Here: {_beyond(results)}. Why ANSYS stopped is not known.",
        _gap("Simulation", SIMULATION_GAP_CM, [row.ansys_cm - row.experiment_cm for row in PRINTED]),
        _gap("Model", MODEL_GAP_CM, [row.closed_form_cm - row.experiment_cm for row in PRINTED]),
    )


def cost(results: PaperResults, model: Literal["axisymmetric", "full3d"]) -> str:
    """Newton iterations of every 5 kPa, the finest runs of the four actuators together."""
    runs = [run for case in results.of("core") for run in getattr(case, model)[-1:]]
    spent = [iterations(run) for run in runs if run.at(HIGHEST_KPA)]
    start = ", each from the axisymmetric state" if model == "full3d" else ""
    sums = ", ".join(f"{sum(of_runs)}" for of_runs in zip(*spent, strict=True))
    return f"{model_label(model)} {sums or 'not run'}{start if sums else ''}"


def iterations(run: Run) -> list[int]:
    """Newton iterations that a run spent between requested pressures, from rest on."""
    return [
        sum(s.newton_iterations for s in run.path if low < s.pressure_kpa <= high * (1.0 + 1e-9))
        for low, high in pairwise((0.0, *PRESSURES_KPA))
    ]


def _beyond(results: PaperResults) -> str:
    cases = [case for case in results.of("beyond") if case.axisymmetric]
    reached = (f"{CALLED[case.case.base]} to {min(map(last_kpa, case.axisymmetric)):.4g} kPa" for case in cases)
    return "; ".join(reached) or "not run"


def _gap(what: str, said_cm: float, gaps: Sequence[float]) -> str:
    """That the first gap (cm) of the printed columns is the largest and as said."""
    right = abs(abs(gaps[0]) - said_cm) < PRINT_CM and all(abs(gap) < abs(gaps[0]) for gap in gaps[1:])
    printed = ", ".join(typeset(gap, "+.1f") for gap in gaps)
    agrees = "as its columns say" if right else "its columns say otherwise"
    return f"{what} and test differ by {said_cm:g} cm at most, t = 1 mm and R_i = 5 mm: {agrees} ({printed} cm)."
