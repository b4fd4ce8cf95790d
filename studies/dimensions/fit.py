"""The sets of dimensions that fit, the three that are picked, and what other grids and chains would give.

Four printed numbers against about five unknowns: a set that fits is not validated by fitting.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytical.arrays import BoolArray, FloatArray
from analytical.bellows.fit.masses import mass_allowed, rings_g, silicone_g
from analytical.bellows.fit.members import (
    BALANCED_CHAIN,
    CORRECTED_CHAIN,
    CORRECTED_CHAIN_BY_20,
    PRINTED_CHAIN,
    TEXT_ORDER,
    WITHIN,
    Chain,
    Members,
)
from analytical.bellows.fit.picks import alternates, reference
from analytical.bellows.fit.refine import refine
from analytical.bellows.fit.search import Grid, search
from analytical.bellows.paper import FAMILIES, InferredFamily, PaperActuator, actuators
from studies.dimensions.cases import Steps
from studies.dimensions.scenes import FITTINGS, buildable, scene_of
from studies.dimensions.sets import Drawn, draw_sets
from studies.models.build import masses_g
from studies.scene.meshes import scene_meridian

# A choice whose best grid point is off by more than this is not refined: half a step is worth less.
REFINE_WITHIN: Final = 0.08

LABELS: Final = ("", "a", "b")
SET_NAMES: Final = ("reference", "alternate a", "alternate b")
ACTUATORS: Final = ("t = 1 mm, R_i = 5", "t = 1 mm, larger R_i", "t = 2 mm, R_i = 5", "t = 2 mm, larger R_i")


@dataclass(frozen=True, eq=False)
class ChainFit:
    """What a chain fits and the rule picks with it.

    Attributes
    ----------
    label
        Name of the chain.
    members
        All that fit.
    best, pick
        The best continuous set in the order of the text, and what the rule picks on the drawing's grid; one member each
        or none.
    """

    label: str
    members: Members
    best: Members
    pick: Members


@dataclass(frozen=True, eq=False)
class RuleOnGrid:
    """What the rule picks on a grid.

    Attributes
    ----------
    step_mm
        Of the grid.
    shapes
        Picked from ``any shape``, or from what is ``buildable``.
    candidates
        How many have one silicone per wall thickness and an allowed mass.
    pick
        One member or none.
    """

    step_mm: float
    shapes: str
    candidates: int
    pick: Members


@dataclass(frozen=True, eq=False)
class Picks:
    """The three sets to work with, and what they were picked from.

    Attributes
    ----------
    drawn
        What fits on the drawing's grid.
    admissible
        Which of those have an allowed mass and can be built, (m,).
    sets, families
        Reference and two alternates, as members and as families.
    """

    drawn: Members
    admissible: BoolArray
    sets: Members
    families: tuple[InferredFamily, ...]

    @property
    def as_recorded(self) -> bool:
        """Whether the sets are the families that analytical/bellows/paper.py holds."""
        return self.families == FAMILIES


@dataclass(frozen=True, eq=False)
class PickedSet:
    """One of the three sets.

    Attributes
    ----------
    name
        For people.
    member
        The set, as one member.
    actuators
        Its four.
    meshed_g
        Silicone and rings of their outlines, shape (4, 2), g.
    """

    name: str
    member: Members
    actuators: tuple[PaperActuator, ...]
    meshed_g: FloatArray


@dataclass(frozen=True, eq=False)
class Fit:
    """Everything that was found.

    Attributes
    ----------
    grid
        Where all sets that fit were looked for.
    fitting
        Those, before masses are requested.
    allowed, allowed_with_rings
        Whether the silicone body's mean mass, and that with rings, is within the window; (m,).
    refined
        The best continuous dimensions of each silicones, order and n.
    picks, sets
        What is picked from what; the three sets one by one.
    rules, chains
        The rule on the drawing's and finer grids; the fit with the corrected chain and with others.
    drawn
        Sets to compute with, by kind.
    """

    grid: Grid
    fitting: Members
    allowed: BoolArray
    allowed_with_rings: BoolArray
    refined: Members
    picks: Picks
    sets: tuple[PickedSet, ...]
    rules: tuple[RuleOnGrid, ...]
    chains: tuple[ChainFit, ...]
    drawn: tuple[Drawn, ...]

    @property
    def members(self) -> Members:
        """All that fit and may weigh what they do: the sets nothing printed tells apart."""
        return self.fitting.take(self.allowed)

    @property
    def members_allowed_with_rings(self) -> BoolArray:
        """Which of `members` are within the window with their rings too."""
        return np.asarray(self.allowed_with_rings[self.allowed])


def fit(steps: Steps) -> Fit:
    """Search, weigh, pick, refine, compare; seconds."""
    picks = pick_sets(steps.drawing_mm)
    grid = Grid.regular(steps.search_mm)
    near = search(grid, within=REFINE_WITHIN)
    fitting = near.take(near.worst_error <= WITHIN)
    refined = refine(near)
    refined = refined.take(refined.worst_error <= WITHIN)
    silicone = silicone_g(fitting, FITTINGS)
    # nothing beyond the reference's own R_p can have a smaller wall stretch
    mould = Grid.regular(steps.mould_mm, crest_to_mm=picks.sets.crest_radius_mm[0], half_pitch_to_mm=10.0)
    on_grids = ((steps.drawing_mm, picks.drawn), (steps.search_mm, fitting), (steps.mould_mm, search(mould)))
    corrected = ChainFit(CORRECTED_CHAIN.label, fitting, first(refined), first(picks.sets))
    balanced, *others = (
        _chain_fit(chain, grid, steps.drawing_mm) for chain in (BALANCED_CHAIN, PRINTED_CHAIN, CORRECTED_CHAIN_BY_20)
    )
    return Fit(
        grid=grid,
        fitting=fitting,
        allowed=mass_allowed(silicone),
        allowed_with_rings=mass_allowed(silicone + rings_g(fitting, FITTINGS)),
        refined=refined,
        picks=picks,
        sets=tuple(_picked_set(*of_set) for of_set in zip(SET_NAMES, each(picks.sets), picks.families, strict=True)),
        rules=tuple(rule for on_grid in on_grids for rule in _rules(*on_grid)),
        chains=(corrected, balanced, *others),
        drawn=draw_sets(fitting, balanced.members),
    )


def pick_sets(step_mm: float = Steps.drawing_mm) -> Picks:
    """The reference and the alternates, by the rule of `bellows.fit.picks`, on a drawing's grid and buildable."""
    drawn = search(Grid.regular(step_mm))
    admissible = mass_allowed(silicone_g(drawn, FITTINGS)) & buildable(drawn)
    candidates = drawn.take(admissible)
    chosen = reference(candidates)
    sets = candidates.take(np.array([chosen, *alternates(candidates, chosen)]))
    return Picks(drawn, admissible, sets, tuple(sets.family(i, label) for i, label in enumerate(LABELS)))


def each(members: Members) -> Iterator[Members]:
    """Members one by one."""
    return (members.take(np.array([i])) for i in range(len(members)))


def first(members: Members) -> Members:
    """The first of members; none of none."""
    return members.take(np.arange(min(1, len(members))))


def _picked(members: Members, chain: Chain = CORRECTED_CHAIN) -> Members:
    """What the rule picks; none of none."""
    return members.take(np.array([reference(members, chain)])) if len(members) else members


def _picked_set(name: str, member: Members, family: InferredFamily) -> PickedSet:
    four = actuators(family)
    scenes = [scene_of(actuator) for actuator in four]
    return PickedSet(name, member, four, np.array([masses_g(scene, scene_meridian(scene, 1)) for scene in scenes]))


def _rules(step_mm: float, fitting: Members) -> tuple[RuleOnGrid, RuleOnGrid]:
    """The rule on a grid, without and with the filter that a set can be built."""
    candidates = fitting.take(fitting.one_silicone_per_wall & mass_allowed(silicone_g(fitting, FITTINGS)))
    built = candidates.take(buildable(candidates))
    return (
        RuleOnGrid(step_mm, "any shape", len(candidates), _picked(candidates)),
        RuleOnGrid(step_mm, "buildable", len(candidates), _picked(built)),
    )


def _chain_fit(chain: Chain, grid: Grid, drawing_mm: float) -> ChainFit:
    members = search(grid, chain)
    in_order = members.take(members.order == TEXT_ORDER)
    best = refine(first(in_order.take(np.argsort(in_order.worst_error))), chain)
    drawn = search(Grid.regular(drawing_mm), chain)
    drawn = drawn.take((drawn.order == TEXT_ORDER) & mass_allowed(silicone_g(drawn, FITTINGS)))
    return ChainFit(chain.label, members, best, _picked(drawn.take(buildable(drawn)), chain))
