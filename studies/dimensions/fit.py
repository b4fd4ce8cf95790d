"""What the study of the unprinted dimensions computes: the sets that fit, the picks, their predictions, rows.

Four printed numbers against about five unknowns: a set that fits is not validated by fitting.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from analytical.arrays import BoolArray, FloatArray
from analytical.bellows.chains import closed_form
from analytical.bellows.fit.masses import Fittings, mass_allowed, rings_g, silicone_g
from analytical.bellows.fit.members import (
    BALANCED_CHAIN,
    CORRECTED_CHAIN_BY_20,
    ORDERS,
    PRINTED_CHAIN,
    SILICONES,
    TEXT_ORDER,
    WITHIN,
    Chain,
    Members,
    per_actuator,
    tip_mm,
    wall_stretch,
)
from analytical.bellows.fit.picks import alternates, reference
from analytical.bellows.fit.refine import refine
from analytical.bellows.fit.search import Grid, search
from analytical.bellows.loads import held_tip
from analytical.bellows.paper import FAMILIES, PRINTED_PRESSURE_KPA, SOURCE, InferredFamily, PaperActuator, actuators
from studies.closed_form.tables import CHAINS, PRESSURES_KPA
from studies.dimensions.scenes import buildable, scene_of, standard_fittings
from studies.models.build import masses_g
from studies.results.files import write_text_atomically
from studies.results.rows import Row, row, write_rows
from studies.scene.meshes import scene_meridian

# Every set that fits is looked for on this grid. One-off trial: half the step finds eight times as many (9290 for
# 1149); the ranges of what they predict widen by 1 to 3 %, for the shallowest folds more (blocked tip: 45 to 55 N).
SEARCH_STEP_MM: Final = 0.25
# The sets to work with have dimensions that a designer would draw.
DRAWING_STEP_MM: Final = 0.5
# How far the rule would go without the drawing: as fine as a mould is printed.
MOULD_STEP_MM: Final = 0.1
# A choice whose best grid point is off by more than this is not refined: half a step is worth less.
REFINE_WITHIN: Final = 0.08

LABELS: Final = ("", "a", "b")
ACTUATORS: Final = ("t = 1 mm, R_i = 5", "t = 1 mm, larger R_i", "t = 2 mm, R_i = 5", "t = 2 mm, larger R_i")
_SHORT: Final = ("t1-ri5", "t1-larger-ri", "t2-ri5", "t2-larger-ri")

ROWS_FILE, MEMBERS_FILE = "rows.csv", "members.csv"


@dataclass(frozen=True)
class Quantity:
    """A number that was not fitted.

    Attributes
    ----------
    name, unit, label
        As in rows; for people.
    pressure_kpa
        Cavity pressure; NaN where there is none.
    model
        The model it comes from.
    measure
        From members, m of them, to numbers of shape (m, 4).
    per_actuator
        False where the four actuators of a set have the same.
    """

    name: str
    unit: str
    label: str
    pressure_kpa: float
    model: str
    measure: Callable[[Members], FloatArray]
    per_actuator: bool = True


@dataclass(frozen=True, eq=False)
class Prediction:
    """A quantity of all members, shape (m, 4), and of the picked sets, shape (3, 4)."""

    quantity: Quantity
    members: FloatArray
    picks: FloatArray


@dataclass(frozen=True, eq=False)
class ChainFit:
    """What the same fit and rule give with another chain.

    Attributes
    ----------
    chain
        The chain.
    members
        All that fit.
    pick
        Index of what the rule picks on the drawing's grid, in ``drawn``; None if nothing is admissible.
    drawn
        Admissible members on the drawing's grid: order of the text, mass, buildable.
    """

    chain: Chain
    members: Members
    drawn: Members
    pick: int | None


@dataclass(frozen=True, eq=False)
class RuleOnGrid:
    """What the rule picks on a grid, with and without the filter that a set can be built.

    Attributes
    ----------
    step_mm
        Of the grid.
    candidates
        Members with one silicone per wall thickness and allowed mass.
    any_shape, buildable
        Indices of the picks among them; None if there is none.
    """

    step_mm: float
    candidates: Members
    any_shape: int | None
    buildable: int | None


@dataclass(frozen=True, eq=False)
class Picks:
    """The three sets to work with, and what they were picked from.

    Attributes
    ----------
    drawn
        What fits on the drawing's grid.
    allowed, buildable
        Mass and outline of those, (m,).
    sets, families
        Reference and two alternates, as members and as families.
    """

    drawn: Members
    allowed: BoolArray
    buildable: BoolArray
    sets: Members
    families: tuple[InferredFamily, ...]

    @property
    def as_recorded(self) -> bool:
        """Whether the sets are the families that analytical/bellows/paper.py holds."""
        return self.families == FAMILIES


@dataclass(frozen=True, eq=False)
class DimensionStudy:
    """Everything the report says.

    Attributes
    ----------
    grid
        Where all sets that fit were looked for.
    fitting
        Those, before masses are asked for.
    allowed, allowed_with_rings
        Whether the silicone body's mean mass, and that with rings, is within the window; (m,).
    refined
        The best continuous dimensions of each silicones, order and n.
    picks
        The three sets.
    fittings
        What completes the wall to an actuator.
    meshed_g
        Silicone and rings of the picks' outlines, shape (3, 4, 2), g.
    rules, chains
        The rule on other grids; the fit with other chains.
    """

    grid: Grid
    fitting: Members
    allowed: BoolArray
    allowed_with_rings: BoolArray
    refined: Members
    picks: Picks
    fittings: Fittings
    meshed_g: FloatArray
    rules: tuple[RuleOnGrid, ...]
    chains: tuple[ChainFit, ...]

    @property
    def members(self) -> Members:
        """All that fit and may weigh what they do: the sets nothing printed tells apart."""
        return self.fitting.take(self.allowed)

    @property
    def members_allowed_with_rings(self) -> BoolArray:
        """Which of `members` are within the window with their rings too."""
        return np.asarray(self.allowed_with_rings[self.allowed])

    @property
    def actuators(self) -> tuple[tuple[PaperActuator, ...], ...]:
        """Four actuators of each picked set."""
        return tuple(actuators(family) for family in self.picks.families)


def pick_sets() -> Picks:
    """The reference and the alternates, by the rule of `bellows.fit.picks`, on a drawing's grid and buildable."""
    drawn = search(Grid.regular(DRAWING_STEP_MM))
    allowed, built = mass_allowed(silicone_g(drawn, standard_fittings())), buildable(drawn)
    admissible = drawn.take(allowed & built)
    chosen = reference(admissible)
    sets = admissible.take(np.array([chosen, *alternates(admissible, chosen)]))
    families = tuple(sets.family(i, label) for i, label in enumerate(LABELS))
    return Picks(drawn, allowed, built, sets, families)


def run_study() -> DimensionStudy:
    """Search, weigh, pick, refine, compare; seconds."""
    fittings, picks = standard_fittings(), pick_sets()
    grid = Grid.regular(SEARCH_STEP_MM)
    near = search(grid, within=REFINE_WITHIN)
    fitting = near.take(near.worst_error <= WITHIN)
    refined = refine(near)
    silicone, rings = silicone_g(fitting, fittings), rings_g(fitting, fittings)
    scenes = [[scene_of(actuator) for actuator in actuators(family)] for family in picks.families]
    mould = Grid.regular(
        MOULD_STEP_MM,
        # nothing beyond the reference's own R_p can have a smaller wall stretch
        crest_to_mm=picks.sets.crest_radius_mm[0],
        half_pitch_to_mm=10.0,
    )
    return DimensionStudy(
        grid=grid,
        fitting=fitting,
        allowed=mass_allowed(silicone),
        allowed_with_rings=mass_allowed(silicone + rings),
        refined=refined.take(refined.worst_error <= WITHIN),
        picks=picks,
        fittings=fittings,
        meshed_g=np.array([[masses_g(scene, scene_meridian(scene, 1)) for scene in of_set] for of_set in scenes]),
        rules=(
            _rule(DRAWING_STEP_MM, picks.drawn, fittings),
            _rule(SEARCH_STEP_MM, fitting, fittings),
            _rule(MOULD_STEP_MM, search(mould), fittings),
        ),
        chains=tuple(
            _chain_fit(chain, grid, fittings) for chain in (BALANCED_CHAIN, PRINTED_CHAIN, CORRECTED_CHAIN_BY_20)
        ),
    )


def _rule(step_mm: float, fitting: Members, fittings: Fittings) -> RuleOnGrid:
    candidates = fitting.take(fitting.one_silicone_per_wall & mass_allowed(silicone_g(fitting, fittings)))
    built = np.flatnonzero(buildable(candidates))
    return RuleOnGrid(
        step_mm=step_mm,
        candidates=candidates,
        any_shape=reference(candidates) if len(candidates) else None,
        buildable=int(built[reference(candidates.take(built))]) if len(built) else None,
    )


def _chain_fit(chain: Chain, grid: Grid, fittings: Fittings) -> ChainFit:
    drawn = search(Grid.regular(DRAWING_STEP_MM), chain)
    drawn = drawn.take((drawn.order == TEXT_ORDER) & mass_allowed(silicone_g(drawn, fittings)))
    drawn = drawn.take(buildable(drawn))
    return ChainFit(chain, search(grid, chain), drawn, reference(drawn, chain) if len(drawn) else None)


# --- what was not fitted --------------------------------------------------------------------


def quantities(fittings: Fittings) -> tuple[Quantity, ...]:
    """What is compared between the members, in the order of the report."""

    def tips(pressure_kpa: float) -> Callable[[Members], FloatArray]:
        return lambda members: tip_mm(members, pressure_kpa)

    full = PRINTED_PRESSURE_KPA
    return (
        *(
            Quantity("tip_mm", "mm", f"elongation at {p:g} kPa, corrected chain", p, "closed_form", tips(p))
            for p in PRESSURES_KPA[:-1]
        ),
        Quantity(
            "tip_mm",
            "mm",
            "elongation at 20 kPa, balanced chain",
            full,
            "closed_form_balanced",
            lambda members: tip_mm(members, full, BALANCED_CHAIN),
        ),
        Quantity(
            "unfolding_pressure_kpa", "kPa", "full unfolding, corrected chain", np.nan, "closed_form", unfolding_kpa
        ),
        Quantity("wall_stretch", "1", "wall stretch at 20 kPa, corrected chain", full, "closed_form", wall_stretch),
        Quantity("tip_force_n", "N", "force at the blocked tip, 20 kPa", full, "closed_form", _blocked_n),
        Quantity(
            "silicone_g",
            "g",
            "silicone body, estimate",
            np.nan,
            "estimate",
            lambda members: silicone_g(members, fittings),
        ),
        Quantity(
            "rest_length_mm",
            "mm",
            "length at rest",
            np.nan,
            "estimate",
            lambda members: rest_length_mm(members, fittings),
            per_actuator=False,
        ),
    )


def predictions(study: DimensionStudy) -> tuple[Prediction, ...]:
    """Every quantity of all members and of the picked sets."""
    members = study.members
    return tuple(Prediction(q, q.measure(members), q.measure(study.picks.sets)) for q in quantities(study.fittings))


def rest_length_mm(members: Members, fittings: Fittings) -> FloatArray:
    """Length at rest, 2 n e and two collars without the cap, shape (m, 4), mm."""
    length = 2.0 * members.convolutions * members.half_pitch_mm + 2.0 * fittings.collar_mm
    return np.repeat(length[:, None], len(ACTUATORS), axis=1)


def unfolding_kpa(members: Members) -> FloatArray:
    """Pressure at which the root reaches the crest, by the corrected chain, shape (m, 4), kPa."""
    return per_actuator(members, lambda d, law: closed_form(d, law, 0.0).unfolding_pressure_kpa[:, 0])


def _blocked_n(members: Members) -> FloatArray:
    return per_actuator(members, lambda d, law: held_tip(d, law, PRINTED_PRESSURE_KPA).tip_force_n[:, 0])


# --- rows and files -------------------------------------------------------------------------


def study_rows(study: DimensionStudy, predicted: tuple[Prediction, ...]) -> list[Row]:
    """Comparison rows: the picked sets at all pressures, and the range of every prediction over all members."""
    rows = []
    for k, of_set in enumerate(study.actuators):
        for j, actuator in enumerate(of_set):
            rows += _actuator_rows(actuator)
            for prediction in predicted:
                q = prediction.quantity
                if q.name != "tip_mm":
                    value = float(prediction.picks[k, j])
                    rows.append(row(actuator.name, q.name, q.unit, q.pressure_kpa, q.model, value))
            for name, mass in zip(("silicone_g", "ring_g"), study.meshed_g[k, j], strict=True):
                rows.append(row(actuator.name, name, "g", np.nan, "axisymmetric", float(mass), "r1"))
    for prediction in predicted:
        q = prediction.quantity
        for j, short in enumerate(_SHORT):
            for level, value in zip(("least", "greatest"), extremes(prediction.members[:, j]), strict=True):
                rows.append(row(f"all-that-fit-{short}", q.name, q.unit, q.pressure_kpa, q.model, value, level))
    return rows


def _actuator_rows(actuator: PaperActuator) -> list[Row]:
    """Tip of one actuator by the three chains, and what is printed."""
    rows = []
    name, printed = actuator.name, actuator.printed
    for model, reading in CHAINS.items():
        path = closed_form(actuator.dimensions, actuator.law, PRESSURES_KPA, reading)
        for p, tip, state in zip(PRESSURES_KPA, path.elongation_mm, path.state, strict=True):
            is_printed = p == PRINTED_PRESSURE_KPA
            rows.append(
                row(
                    name,
                    "tip_mm",
                    "mm",
                    p,
                    model,
                    float(tip),
                    reference=10.0 * printed.closed_form_cm if is_printed else np.nan,
                    source=f"{SOURCE}, closed form: fitted, no validation" if is_printed else "",
                    status="past the model" if state == "past the model" else "reached",
                )
            )
    for model, value_cm in (
        ("paper_closed_form", printed.closed_form_cm),
        ("paper_ansys", printed.ansys_cm),
        ("paper_experiment", printed.experiment_cm),
    ):
        rows.append(row(name, "tip_mm", "mm", PRINTED_PRESSURE_KPA, model, 10.0 * value_cm, source=SOURCE))
    return rows


def extremes(values: FloatArray) -> tuple[float, float]:
    """Smallest and largest."""
    return float(np.min(values)), float(np.max(values))


def write_data(study: DimensionStudy, predicted: tuple[Prediction, ...], folder: Path) -> None:
    """Write rows.csv, and members.csv with a line per set that fits."""
    folder.mkdir(parents=True, exist_ok=True)
    write_rows(folder / ROWS_FILE, study_rows(study, predicted))
    write_text_atomically(folder / MEMBERS_FILE, members_csv(study))


def members_csv(study: DimensionStudy) -> str:
    """All sets that fit as CSV; lengths in mm, masses as the mean of four actuators in g, errors in percent."""
    members = study.fitting
    silicone = silicone_g(members, study.fittings).mean(axis=1)
    rings = rings_g(members, study.fittings).mean(axis=1)
    stretch = wall_stretch(members).max(axis=1)
    length = rest_length_mm(members, study.fittings)[:, 0]
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(
        (
            *(f"silicone_{short}" for short in _SHORT),
            "reading_order",
            "crest_radius_mm",
            "larger_root_radius_mm",
            "half_pitch_mm",
            "convolutions",
            *(f"error_percent_{short}" for short in _SHORT),
            "worst_error_percent",
            "largest_wall_stretch",
            "rest_length_mm",
            "silicone_g",
            "rings_g",
            "mass_allowed",
            "mass_with_rings_allowed",
        )
    )
    for i in range(len(members)):
        writer.writerow(
            (
                *(SILICONES[s] for s in members.silicone[i]),
                ORDERS[members.order[i]],
                f"{members.crest_radius_mm[i]:g}",
                f"{members.larger_root_radius_mm[i]:g}",
                f"{members.half_pitch_mm[i]:g}",
                members.convolutions[i],
                *(f"{100.0 * error:.3f}" for error in members.error[i]),
                f"{100.0 * members.worst_error[i]:.3f}",
                f"{stretch[i]:.4f}",
                f"{length[i]:g}",
                f"{silicone[i]:.2f}",
                f"{rings[i]:.2f}",
                "yes" if study.allowed[i] else "no",
                "yes" if study.allowed_with_rings[i] else "no",
            )
        )
    return stream.getvalue()
