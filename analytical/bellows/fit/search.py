"""Every set of dimensions of a grid that fits."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from analytical.arrays import BoolArray, FloatArray
from analytical.bellows.chains import closed_form
from analytical.bellows.dimensions import BellowsDesigns
from analytical.bellows.fit.members import (
    CORRECTED_CHAIN,
    HAS_LARGER_ROOT,
    ORDERS,
    SILICONES,
    WALLS_MM,
    WITHIN,
    Chain,
    FitError,
    Members,
    within_model_mm,
)
from analytical.bellows.paper import PRINTED, PRINTED_PRESSURE_KPA, PRINTED_ROOT_RADIUS_MM
from analytical.bellows.reading import Reading
from analytical.laws.isotropic import Law


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


def search(grid: Grid, chain: Chain = CORRECTED_CHAIN, within: float = WITHIN) -> Members:
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
    every = Members.joined(found)
    group = np.array([*every.silicone.T, every.order])
    return every.take(np.lexsort((every.worst_error, *group[::-1])))


def _tip_of_one_cm(grid: Grid, actuator: int, law: Law, reading: Reading) -> FloatArray:
    """Elongation of one convolution at 20 kPa, cm: shape (crests, roots, pitches), the roots' axis 1 for R_i = 5."""
    wall_mm, pitch_mm = WALLS_MM[actuator], grid.half_pitch_mm
    if not HAS_LARGER_ROOT[actuator]:
        designs = BellowsDesigns(PRINTED_ROOT_RADIUS_MM, grid.crest_radius_mm[:, None], wall_mm, pitch_mm, 1)
        tip_mm = within_model_mm(closed_form(designs, law, PRINTED_PRESSURE_KPA, reading))
        return 0.1 * tip_mm[:, None, :]
    crest, root = np.nonzero(grid._folded)
    designs = BellowsDesigns(
        grid.larger_root_radius_mm[root][:, None], grid.crest_radius_mm[crest][:, None], wall_mm, pitch_mm, 1
    )
    tip_mm = np.full((grid.crest_radius_mm.size, grid.larger_root_radius_mm.size, pitch_mm.size), np.nan)
    tip_mm[crest, root] = within_model_mm(closed_form(designs, law, PRINTED_PRESSURE_KPA, reading))
    return 0.1 * tip_mm


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
