"""Dimensions that the paper does not print, inferred from the closed-form elongations that it does.

Source of the numbers: Heung et al., Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160, section 4.

Four printed numbers (the closed-form column at 20 kPa; ANSYS and experiment are never used) stand against R_p, the
second R_i, e, n, which of two silicones each actuator has, and which number of a pair belongs to which R_i. That is
about five unknowns: many sets of dimensions fit, and that a set fits says nothing for the model. This module finds
all that fit on a grid (`search`), brings single ones to their best (`refine`) and holds the rule that picks three
to work with (`reference`, `alternates`).

The mended chain is linear in n and, for a given silicone, an actuator's elongation depends on (R_i, R_p, t, e)
only: four fields per grid are enough for every silicone, order and n.

Units: mm, N, MPa; pressures in kPa, elongations compared in cm as printed, masses in g.
"""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from analytical.bellows import BellowsDesigns, silicone_mass_g
from analytical.chain_equations import Reading
from analytical.chains import BALANCED, MENDED, PRINTED_READING, ClosedFormPath, closed_form
from analytical.materials import PLA, SILICONE_DENSITY_G_CM3, FloatArray, Law, dragon_skin_30
from analytical.paper import (
    LAWS,
    PRINTED,
    PRINTED_MASS_G,
    PRINTED_PRESSURE_KPA,
    PRINTED_ROOT_RADIUS_MM,
    InferredFamily,
    Silicone,
)

BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]

# The rule of the fit, chosen before it was run: a set fits if no printed closed-form number is off by more.
WITHIN: Final = 0.05
# The paper's "approximate weight" leaves this much room.
MASS_WITHIN: Final = 0.40

# A fold shallower than this is a tube; the continuous fit stops there.
LEAST_FOLD_MM: Final = 0.1
# Of difference quotients; the chain is solved to round-off, so 1e-10 of the error is left.
_STEP_MM: Final = 1e-6

SILICONES: Final[tuple[Silicone, ...]] = tuple(LAWS)
WALLS_MM: Final = np.array([row.wall_mm for row in PRINTED])
HAS_LARGER_ROOT: Final = np.array([row.has_larger_root for row in PRINTED])


class FitError(ValueError):
    """A grid that cannot be searched or members that leave nothing to pick; names value and remedy."""


@dataclass(frozen=True)
class Chain:
    """A chain of the closed form with the laws of the two silicones.

    Attributes
    ----------
    label
        For people.
    reading
        How it reads the equations.
    laws
        Law of each silicone.
    """

    label: str
    reading: Reading
    laws: Mapping[Silicone, Law]


# The one the dimensions are inferred with, and those it is compared with.
MENDED_CHAIN: Final = Chain("mended chain", MENDED, LAWS)
BALANCED_CHAIN: Final = Chain("balanced chain", BALANCED, LAWS)
PRINTED_CHAIN: Final = Chain("printed chain", PRINTED_READING, LAWS)
MENDED_CHAIN_BY_20: Final = Chain(
    "mended chain, Dragon Skin 30 as in eq. (20)", MENDED, {**LAWS, "dragon-skin-30": dragon_skin_30("mu/alpha")}
)


@dataclass(frozen=True)
class ReadingOrder:
    """Which number of each pair belongs to R_i = 5 mm.

    Attributes
    ----------
    thin_reversed, thick_reversed
        False: the first that the text names, of the 1 mm and of the 2 mm pair. True: the second.
    """

    thin_reversed: bool
    thick_reversed: bool

    @property
    def closed_form_cm(self) -> FloatArray:
        """Printed closed-form elongations in the order of `PRINTED` under this reading, shape (4,), cm."""
        thin_5, thin_larger, thick_5, thick_larger = (row.closed_form_cm for row in PRINTED)
        if self.thin_reversed:
            thin_5, thin_larger = thin_larger, thin_5
        if not self.thick_reversed:  # PRINTED has the 2 mm pair reversed
            thick_5, thick_larger = thick_larger, thick_5
        return np.array([thin_5, thin_larger, thick_5, thick_larger])

    def __str__(self) -> str:
        """Name for tables."""
        return ", ".join(
            f"{wall} mm {'reversed' if turned else 'as named'}"
            for wall, turned in ((1, self.thin_reversed), (2, self.thick_reversed))
        )


ORDERS: Final = tuple(ReadingOrder(*turned) for turned in itertools.product((False, True), repeat=2))
# The text says that a larger root radius elongates less: R_i = 5 has the larger number of each pair.
TEXT_ORDER: Final = ORDERS.index(ReadingOrder(False, True))


@dataclass(frozen=True, eq=False)
class Grid:
    """Dimensions to try: every combination of the four.

    Attributes
    ----------
    crest_radius_mm, larger_root_radius_mm, half_pitch_mm
        R_p, the second R_i and e, mm, one-dimensional. Combinations with R_i >= R_p are passed over.
    most_convolutions
        n from 1 to this.
    """

    crest_radius_mm: FloatArray
    larger_root_radius_mm: FloatArray
    half_pitch_mm: FloatArray
    most_convolutions: int

    @classmethod
    def regular(
        cls, step_mm: float, crest_to_mm: float = 25.0, half_pitch_to_mm: float = 20.0, most_convolutions: int = 60
    ) -> Grid:
        """A grid of one step in all lengths.

        It starts where the rule does: both R_p and the second R_i above 5 mm, e above the largest t. (e = t = 2 mm
        is left out too: rings of 4 mm on neighbouring crests would touch.) The upper ends are where nothing fits
        any more, except for e: with few convolutions there is no end, and 20 mm is a choice.
        """
        if not 0.0 < step_mm <= 5.0:
            raise FitError(f"step_mm = {step_mm:g} must be above 0 and at most 5: a grid as fine as a drawing, 0.5")

        def steps(above_mm: float, to_mm: float) -> FloatArray:
            count = round((to_mm - above_mm) / step_mm)
            # as a drawing writes them, without binary tails
            return np.round(above_mm + step_mm * np.arange(1, count + 1), 9)

        crest = steps(PRINTED_ROOT_RADIUS_MM, crest_to_mm)
        return cls(crest, crest[:-1], steps(float(WALLS_MM.max()), half_pitch_to_mm), most_convolutions)

    @property
    def combinations(self) -> int:
        """Sets of dimensions with R_i < R_p, times silicones and reading orders."""
        pairs = np.count_nonzero(self._folded)
        choices = len(SILICONES) ** len(PRINTED) * len(ORDERS)
        return int(pairs * self.half_pitch_mm.size * self.most_convolutions * choices)

    @property
    def _folded(self) -> BoolArray:
        """Whether R_i < R_p, shape (crests, roots); a step's round-off is not a fold."""
        return np.asarray(self.larger_root_radius_mm[None, :] < self.crest_radius_mm[:, None] - 1e-9)


@dataclass(frozen=True, eq=False)
class Members:
    """Sets of dimensions that fit, one per entry of every array, m of them.

    Attributes
    ----------
    silicone
        Index into `SILICONES` of each of the four actuators, shape (m, 4), in the order of `PRINTED`.
    order
        Index into `ORDERS`, shape (m,).
    crest_radius_mm, larger_root_radius_mm, half_pitch_mm
        R_p, the second R_i, e, mm, shape (m,).
    convolutions
        n, shape (m,).
    error
        Elongation at 20 kPa over the printed closed-form one, less 1, shape (m, 4).
    """

    silicone: IntArray
    order: IntArray
    crest_radius_mm: FloatArray
    larger_root_radius_mm: FloatArray
    half_pitch_mm: FloatArray
    convolutions: IntArray
    error: FloatArray

    def __len__(self) -> int:
        return len(self.order)

    def take(self, which: BoolArray | IntArray) -> Members:
        """The entries under a mask or at indices."""
        return Members(*(getattr(self, f.name)[which] for f in fields(self)))

    @property
    def worst_error(self) -> FloatArray:
        """Largest |error| of the four, shape (m,)."""
        return np.asarray(np.abs(self.error).max(axis=1))

    @property
    def root_radius_mm(self) -> FloatArray:
        """R_i of each actuator, mm, shape (m, 4)."""
        return np.where(HAS_LARGER_ROOT, self.larger_root_radius_mm[:, None], PRINTED_ROOT_RADIUS_MM)

    @property
    def one_silicone_per_wall(self) -> BoolArray:
        """Whether both actuators of a wall thickness have the same silicone, shape (m,)."""
        s = self.silicone
        return np.asarray((s[:, 0] == s[:, 1]) & (s[:, 2] == s[:, 3]))

    @property
    def designs(self) -> BellowsDesigns:
        """Dimensions of all actuators, shape (m, 4)."""
        return BellowsDesigns(
            root_radius_mm=self.root_radius_mm,
            crest_radius_mm=self.crest_radius_mm[:, None],
            wall_mm=WALLS_MM,
            half_pitch_mm=self.half_pitch_mm[:, None],
            convolutions=self.convolutions[:, None],
        )

    def family(self, index: int, label: str = "") -> InferredFamily:
        """An entry as dimensions to work with; its reading order must be that of `PRINTED`."""
        if self.order[index] != TEXT_ORDER:
            raise FitError(f"order = {ORDERS[self.order[index]]}: a family reads the pairs as {ORDERS[TEXT_ORDER]}")
        a, b, c, d = (SILICONES[s] for s in self.silicone[index])
        return InferredFamily(
            larger_root_radius_mm=float(self.larger_root_radius_mm[index]),
            crest_radius_mm=float(self.crest_radius_mm[index]),
            half_pitch_mm=float(self.half_pitch_mm[index]),
            convolutions=int(self.convolutions[index]),
            silicones=(a, b, c, d),
            label=label,
        )


def members_of(families: tuple[InferredFamily, ...], chain: Chain = MENDED_CHAIN) -> Members:
    """Families as members, whether they fit or not."""
    bare = Members(
        silicone=np.array([[SILICONES.index(s) for s in f.silicones] for f in families]),
        order=np.full(len(families), TEXT_ORDER),
        crest_radius_mm=np.array([f.crest_radius_mm for f in families]),
        larger_root_radius_mm=np.array([f.larger_root_radius_mm for f in families]),
        half_pitch_mm=np.array([f.half_pitch_mm for f in families]),
        convolutions=np.array([f.convolutions for f in families]),
        error=np.zeros((len(families), len(PRINTED))),
    )
    return replace(bare, error=_errors(bare, chain))


def per_actuator(
    members: Members,
    measure: Callable[[BellowsDesigns, Law], FloatArray],
    laws: Mapping[Silicone, Law] = LAWS,
) -> FloatArray:
    """Any number per actuator, for all members at once.

    Parameters
    ----------
    members
        m of them.
    measure
        Called once per silicone, with designs of shape (k,) and the silicone's law; returns shape (k,).
    laws
        Law of each silicone.

    Returns
    -------
    ndarray
        Shape (m, 4).
    """
    designs = members.designs
    size = {f.name: np.broadcast_to(getattr(designs, f.name), designs.shape) for f in fields(designs)}
    out = np.empty(designs.shape)
    for index, name in enumerate(SILICONES):
        mask = members.silicone == index
        if np.any(mask):
            out[mask] = measure(BellowsDesigns(**{key: value[mask] for key, value in size.items()}), laws[name])
    return out


def tip_mm(members: Members, pressure_kpa: float = PRINTED_PRESSURE_KPA, chain: Chain = MENDED_CHAIN) -> FloatArray:
    """Elongation of every actuator at a pressure, mm, shape (m, 4); NaN where it is past the chain's model."""
    return per_actuator(
        members, lambda d, law: _within_model_mm(closed_form(d, law, pressure_kpa, chain.reading)), chain.laws
    )


def wall_stretch(members: Members, chain: Chain = MENDED_CHAIN) -> FloatArray:
    """lambda_a of every actuator at 20 kPa, shape (m, 4)."""
    return per_actuator(
        members,
        lambda d, law: closed_form(d, law, PRINTED_PRESSURE_KPA, chain.reading).wall_stretch[:, 0],
        chain.laws,
    )


def search(grid: Grid, chain: Chain = MENDED_CHAIN, within: float = WITHIN) -> Members:
    """Every set of the grid whose four elongations at 20 kPa are within `within` of the printed closed form.

    Parameters
    ----------
    grid
        Dimensions to try, with all silicones of all actuators and all reading orders.
    chain
        Elongations past its model never fit.
    within
        Largest relative error of any of the four numbers.

    Returns
    -------
    Members
        Sorted by silicones, order and worst error.
    """
    tip_cm = [[_tip_of_one_cm(grid, k, chain.laws[s], chain.reading) for s in SILICONES] for k in range(len(PRINTED))]
    found: list[Members] = []
    for silicone in itertools.product(range(len(SILICONES)), repeat=len(PRINTED)):
        for order, targets in enumerate(o.closed_form_cm for o in ORDERS):
            ratio = np.stack(np.broadcast_arrays(*(tip_cm[k][s] / targets[k] for k, s in enumerate(silicone))))
            found.append(_fitting(grid, ratio, silicone, order, within))
    every = Members(*(np.concatenate([getattr(part, f.name) for part in found]) for f in fields(Members)))
    group = np.array([*every.silicone.T, every.order])
    return every.take(np.lexsort((every.worst_error, *group[::-1])))


def _tip_of_one_cm(grid: Grid, actuator: int, law: Law, reading: Reading) -> FloatArray:
    """Elongation of one convolution at 20 kPa, cm: shape (crests, roots, pitches), the roots' axis 1 for R_i = 5."""
    wall_mm, pitch_mm = WALLS_MM[actuator], grid.half_pitch_mm
    if not HAS_LARGER_ROOT[actuator]:
        designs = BellowsDesigns(PRINTED_ROOT_RADIUS_MM, grid.crest_radius_mm[:, None], wall_mm, pitch_mm, 1)
        tip_mm = _within_model_mm(closed_form(designs, law, PRINTED_PRESSURE_KPA, reading))
        return 0.1 * tip_mm[:, None, :]
    crest, root = np.nonzero(grid._folded)
    designs = BellowsDesigns(
        grid.larger_root_radius_mm[root][:, None], grid.crest_radius_mm[crest][:, None], wall_mm, pitch_mm, 1
    )
    tip_mm = np.full((grid.crest_radius_mm.size, grid.larger_root_radius_mm.size, pitch_mm.size), np.nan)
    tip_mm[crest, root] = _within_model_mm(closed_form(designs, law, PRINTED_PRESSURE_KPA, reading))
    return 0.1 * tip_mm


def _within_model_mm(path: ClosedFormPath) -> FloatArray:
    """Elongation at the path's one pressure, mm, shape of the designs; NaN where it is past the model."""
    return np.where(path.state == "past the model", np.nan, path.elongation_mm)[..., 0]


def _fitting(grid: Grid, ratio: FloatArray, silicone: tuple[int, ...], order: int, within: float) -> Members:
    """Members among the grid's sets; `ratio` is printed elongations per convolution, (4, crests, roots, pitches)."""
    low, high = ratio.min(axis=0), ratio.max(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        first = np.ceil((1.0 - within) / low)
        last = np.minimum(np.floor((1.0 + within) / high), grid.most_convolutions)
        at = np.nonzero((low > 0.0) & (last >= first))
    count = (last[at] - first[at] + 1.0).astype(int)
    crest, root, pitch = (np.repeat(index, count) for index in at)
    # first, first + 1, ... of each set
    step = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    convolutions = np.repeat(first[at], count).astype(int) + step
    return Members(
        silicone=np.tile(np.array(silicone, dtype=int), (count.sum(), 1)),
        order=np.full(count.sum(), order),
        crest_radius_mm=grid.crest_radius_mm[crest],
        larger_root_radius_mm=grid.larger_root_radius_mm[root],
        half_pitch_mm=grid.half_pitch_mm[pitch],
        convolutions=convolutions,
        error=ratio[:, crest, root, pitch].T * convolutions[:, None] - 1.0,
    )


def refine(members: Members, chain: Chain = MENDED_CHAIN) -> Members:
    """The best continuous R_p, second R_i and e for every silicones, order and n among the members.

    Minimises the worst of the four errors, as an upper bound on all of them (sequential quadratic programming),
    from the best member of each choice; kept only if it is better.

    Returns
    -------
    Members
        One per choice, best first; none of none.
    """
    if not len(members):
        return members
    choice = np.column_stack([members.silicone, members.order, members.convolutions])
    by_error = np.argsort(members.worst_error, kind="stable")
    _, first = np.unique(choice[by_error], axis=0, return_index=True)
    starts = members.take(by_error[first])
    parts = [_refined(starts.take(np.array([i])), chain) for i in range(len(starts))]
    every = Members(*(np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(Members)))
    return every.take(np.argsort(every.worst_error, kind="stable"))


def _refined(start: Members, chain: Chain) -> Members:
    """One member brought to its smallest worst error; the start where that fails."""

    def at(x: FloatArray) -> Members:
        """Members at points (k, 3): second R_i, depth of its fold, e."""
        many = start.take(np.zeros(len(x), dtype=int))
        root, depth, pitch = x.T
        moved = replace(many, crest_radius_mm=root + depth, larger_root_radius_mm=root, half_pitch_mm=pitch)
        return replace(moved, error=_errors(moved, chain))

    def bounds_less_errors(x: FloatArray) -> FloatArray:
        error = at(x[None, :3]).error[0]
        return np.concatenate([x[3] - error, x[3] + error])

    def slopes(x: FloatArray) -> FloatArray:
        error = at(x[:3] + _STEP_MM * np.vstack([np.zeros(3), np.eye(3)])).error
        slope = (error[1:] - error[0]).T / _STEP_MM
        return np.hstack([np.vstack([-slope, slope]), np.ones((2 * len(PRINTED), 1))])

    root, pitch = start.larger_root_radius_mm[0], start.half_pitch_mm[0]
    lengths = np.array([root, start.crest_radius_mm[0] - root, pitch])
    # SLSQP keeps to bounds at every step, so nothing is evaluated that is no bellows.
    least = (PRINTED_ROOT_RADIUS_MM, LEAST_FOLD_MM, WALLS_MM.max())
    bounds = [(max(value - 1.0, low), value + 1.0) for value, low in zip(lengths, least, strict=True)]
    with warnings.catch_warnings():
        # a step's round-off beyond a bound, which scipy clips
        warnings.filterwarnings("ignore", "Values in x were outside bounds", RuntimeWarning)
        answer = minimize(
            lambda x: x[3],
            [*lengths, start.worst_error[0]],
            jac=lambda x: np.array([0.0, 0.0, 0.0, 1.0]),
            method="SLSQP",
            bounds=[*bounds, (0.0, 1.0)],
            constraints={"type": "ineq", "fun": bounds_less_errors, "jac": slopes},
            options={"maxiter": 60, "ftol": 1e-8},
        )
    found = at(answer.x[None, :3])
    return found if found.worst_error[0] < start.worst_error[0] else start


def _errors(members: Members, chain: Chain) -> FloatArray:
    """Elongation at 20 kPa over the printed one, less 1, shape (m, 4)."""
    targets_mm = 10.0 * np.array([order.closed_form_cm for order in ORDERS])
    return np.asarray(tip_mm(members, PRINTED_PRESSURE_KPA, chain) / targets_mm[members.order] - 1.0)


# --- mass -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Fittings:
    """What has to be added to the folded wall to make an actuator; none of it is printed.

    Attributes
    ----------
    cap_mm
        Thickness of the solid end cap, mm.
    collar_mm
        Straight wall beyond the middle of the first and of the last crest, mm.
    seat_mm
        Axial width of the ring's cylindrical seat on each crest, mm.
    ring_height_mm
        Radial height of the rings, mm; they are as wide as the seats.
    """

    cap_mm: float
    collar_mm: float
    seat_mm: float
    ring_height_mm: float


def silicone_g(members: Members, fittings: Fittings) -> FloatArray:
    """Estimated mass of the silicone body with sharp corners: wall, seats, collars, cap; shape (m, 4), g.

    Conical walls over the free half pitch e - w/2, cylinders at the crests for n seats and two collars, a disc.
    Rounded corners are left out, so that every set has a mass, also one whose arcs would not fit.
    """
    d = members.designs
    free = replace(d, half_pitch_mm=np.asarray(d.half_pitch_mm) - 0.5 * fittings.seat_mm)
    inner, outer = _crest_radii_mm(members)
    straight_mm = members.convolutions[:, None] * fittings.seat_mm + 2.0 * fittings.collar_mm
    rest_mm3 = np.pi * ((outer**2 - inner**2) * straight_mm + outer**2 * fittings.cap_mm)
    return np.asarray(silicone_mass_g(free, SILICONE_DENSITY_G_CM3) + 1e-3 * SILICONE_DENSITY_G_CM3 * rest_mm3)


def rings_g(members: Members, fittings: Fittings) -> FloatArray:
    """Mass of the n + 1 PLA rings with sharp edges, shape (m, 4), g."""
    _, inner = _crest_radii_mm(members)
    section_mm2 = np.pi * ((inner + fittings.ring_height_mm) ** 2 - inner**2)
    volume_mm3 = (members.convolutions[:, None] + 1) * section_mm2 * fittings.seat_mm
    return np.asarray(1e-3 * PLA.density_g_cm3 * volume_mm3)


def _crest_radii_mm(members: Members) -> tuple[FloatArray, FloatArray]:
    """Cavity-side and outer radius of the crests, mm, shapes (m, 1) and (m, 4)."""
    inner = members.crest_radius_mm[:, None]
    return inner, inner + WALLS_MM


def mass_allowed(mass_g: FloatArray) -> BoolArray:
    """Whether the mean over the four actuators is within 40 % of the printed 19 g; (m, 4) to (m,).

    The mean, because the paper states one approximate weight for "the actuator" and has four actuators.
    """
    return np.asarray(np.abs(mass_g.mean(axis=1) / PRINTED_MASS_G - 1.0) <= MASS_WITHIN)


# --- the rule -------------------------------------------------------------------------------


def reference(members: Members, chain: Chain = MENDED_CHAIN) -> int:
    """Index of the reference: one silicone per wall thickness if any fits so, then the smallest wall stretch.

    The wall stretch is the largest lambda_a of the four at 20 kPa; of equal ones the smallest worst error.
    Members are those that are admissible otherwise: mass, buildable, dimensions as on a drawing.
    """
    if not len(members):
        raise FitError("no member to pick from: widen the grid or the allowed error")
    preferred = members.one_silicone_per_wall
    candidates = np.flatnonzero(preferred) if np.any(preferred) else np.arange(len(members))
    # Stretches of equal R_p differ by round-off only.
    stretch = np.round(wall_stretch(members, chain).max(axis=1)[candidates], 9)
    return int(candidates[np.lexsort((members.worst_error[candidates], stretch))[0]])


def alternates(members: Members, chosen: int) -> tuple[int, int]:
    """Indices of the alternates: other n with the same silicones, and other silicones; smallest worst error each."""
    same = np.all(members.silicone == members.silicone[chosen], axis=1)
    picks = []
    for mask, what in ((same & (members.convolutions != members.convolutions[chosen]), "n"), (~same, "silicones")):
        if not np.any(mask):
            raise FitError(f"no member with other {what} to pick as alternate: widen the grid or the allowed error")
        candidates = np.flatnonzero(mask)
        picks.append(int(candidates[np.argmin(members.worst_error[candidates])]))
    return picks[0], picks[1]
