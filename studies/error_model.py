"""What a mesh will leave of error at the tip, and what it will cost, before anything is solved.

The tip's error is a constant per level and a power of each of a few features of the scene, fitted to axisymmetric runs
of made-up bellows; ``python -m studies.error_fit`` repeats the fit and checks it on ten scenes it has not seen. Two
levels solved on the scene itself then replace the guess: `checked_error_percent`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from studies.scene import Scene, in_hexahedra, law_of

Cells = Literal["hex", "tet"]
# Meridian levels the model knows.
LEVELS = (1, 2, 4)
# No error is told apart from less than this, percent: steps, layers and extrapolation leave as much.
FLOOR_PERCENT = 1e-3


@dataclass(frozen=True)
class Fit:
    """Constants of one kind of cells.

    Attributes
    ----------
    constants
        Logarithm of the error in percent at the centre of the features, by level.
    slopes, centre
        Power of each feature, and the mean of the features' logarithms.
    spread
        Standard deviation of the logarithm over the training set.
    ratios
        Error of a level over the difference from the level before, from the second level on: medians.
    """

    constants: tuple[float, ...]
    slopes: tuple[float, ...]
    centre: tuple[float, ...]
    spread: float
    ratios: tuple[float, ...]


FITS: dict[Cells, Fit] = {
    "hex": Fit((0.0,) * 3, (0.0,) * 5, (0.0,) * 5, 1.0, (0.3, 0.3)),
    "tet": Fit((0.0,) * 3, (0.0,) * 5, (0.0,) * 5, 1.0, (0.3, 0.3)),
}


def features(scene: Scene, pressure_kpa: float) -> tuple[float, ...]:
    """Logarithms of what the error depends on.

    Wall over root radius; fillet over wall; depth of the fold over wall; pressure over the shear modulus times wall
    over crest radius; thickness of the coarsest level's cells, mm (1 mm at most, so that it jumps with the wall).
    """
    g = scene.geometry
    mu_kpa = 1e3 * law_of(scene.material).initial_shear_modulus_mpa
    layers = max(1, math.ceil(g.wall_mm - 1e-9)) if in_hexahedra(scene) else max(2, math.ceil(1.5 * g.wall_mm - 1e-9))
    return (
        math.log(g.wall_mm / g.root_radius_mm),
        math.log(g.fillet_mm / g.wall_mm),
        math.log((g.crest_radius_mm - g.root_radius_mm) / g.wall_mm),
        math.log(pressure_kpa * g.crest_radius_mm / (mu_kpa * g.wall_mm)),
        math.log(layers),
    )


def checked_error_percent(scene: Scene, level: int, coarse_mm: Sequence[float], fine_mm: Sequence[float]) -> float:
    raise NotImplementedError


def predicted_error_percent(scene: Scene, rung: str, level: str) -> float:
    return math.nan
