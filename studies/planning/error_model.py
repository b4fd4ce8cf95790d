"""What a mesh will leave of error at the tip, and what it will cost, before anything is solved.

The error that a meridian leaves is a constant per level and a power of each of a few features of the scene, fitted to
axisymmetric runs of made-up bellows; what the cells round the circumference leave is a power of their number. Times are
powers of the number of unknowns, from the cost study. ``make study-error-model`` makes such fits and checks them on ten
scenes that they have not seen; those here are of another reference, see `FITS`. Once two levels of the scene itself are
solved, `checked_error_percent` replaces the guess.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from meshes.meridian import meridian_mesh
from studies.planning.levels import BODY_MERIDIANS, MERIDIANS, BodyLevel, Model, body_level, fineness
from studies.scene.bellows import BellowsScene, in_hexahedra, shape_of
from studies.scene.materials import law_of
from studies.scene.meshes import SECTORS, cell_kind, quarters, scene_resolution, solved_part

Cells = Literal["hex", "tet"]
# The training set has no more convolutions than this.
LONGEST = 3
# Errors are not told apart below this, percent: so much do bonds, steps and the reference's extrapolation leave.
FLOOR_PERCENT = 0.01
# Of a body's tolerance, what the circumference may take and what the meridian may. The meridian's error is the larger
# part and costs more to bring down; the rest is left to the scatter of the prediction.
AROUND_SHARE, MERIDIAN_SHARE = 0.1, 0.5
# Numbers of cells round the circumference to choose from.
ROUNDS: dict[Cells, tuple[int, ...]] = {"hex": (6, 8, 12), "tet": (8, 12, 16)}
# More of them, for a tolerance that those do not hold.
FINER_ROUNDS: dict[Cells, tuple[int, ...]] = {"hex": (16, 24, 32), "tet": (24, 32)}
# The most to begin with on a quarter: they cost less there than 6 of a whole body.
MOST_ON_A_QUARTER = 16


@dataclass(frozen=True)
class Fit:
    """Constants of one kind of cells.

    Attributes
    ----------
    constants
        Logarithm of the error in percent at the centre of the features, by level.
    slopes, centre
        Power of each feature, and the mean of the features' logarithms over the training set.
    spread
        Root mean square of the logarithm's error on scenes that were left out of the fit.
    ratios
        Error of a level over its difference from the level before, of the first over that from the second, by level.
    """

    constants: tuple[float, ...]
    slopes: tuple[float, ...]
    centre: tuple[float, ...]
    spread: float
    ratios: tuple[float, ...]


@dataclass(frozen=True)
class Around:
    """Error in percent that so many cells round leave, and the power of their number by which it falls."""

    error_percent: float
    cells: int
    order: float

    def at(self, cells: int) -> float:
        """Error with another number of cells, percent."""
        return float(self.error_percent * (self.cells / cells) ** self.order)


@dataclass(frozen=True)
class Seconds:
    """Wall seconds of a run without start and imports: ``per_unknown * unknowns ** exponent``, those of the body."""

    per_unknown: float
    exponent: float

    def at(self, unknowns: float) -> float:
        """Seconds for a number of unknowns."""
        return float(self.per_unknown * unknowns**self.exponent)


@dataclass(frozen=True)
class Choice:
    """A mesh and what is expected of it.

    Attributes
    ----------
    level
        For instance ``r2``, or ``n8r2``.
    error_percent, seconds
        Predicted, before anything has been solved.
    within
        True if the predicted error is within the tolerance, of a body its meridian's within `MERIDIAN_SHARE` of it;
        False if even this, the finest, is not.
    """

    model: Model
    level: str
    error_percent: float
    seconds: float
    within: bool


# From make study-error-model, on its training set.
FITS: dict[Cells, Fit] = {
    "hex": Fit(
        constants=(-2.163, -3.598, -4.306),
        slopes=(-0.196, 0.093, -0.986, 0.293, -0.62, -0.322, -0.561),
        centre=(-1.892, -0.533, 1.568, 0.316, 0.446, 0.157, 0.5),
        spread=0.732,
        ratios=(1.346, 0.354, 0.578),
    ),
    "tet": Fit(
        constants=(-2.107, -3.001, -3.731),
        slopes=(-0.416, -0.272, -0.654, 0.83, -0.163, -0.229, -0.438),
        centre=(-1.892, -0.533, 1.568, 0.316, 0.78, 0.157, 0.5),
        spread=0.861,
        ratios=(1.638, 0.795, 0.843),
    ),
}
# The larger of two 1 and 2 mm walls at 20 kPa (docs/decisions.md) and of peer-bellows (cost study).
AROUND: dict[Cells, Around] = {"hex": Around(0.07, 8, 4.0), "tet": Around(0.2, 8, 3.4)}
# From make study-error-model, with the rows of make study-cost; of bodies on a quarter, unknowns of the whole.
SECONDS: dict[tuple[Model, Cells], Seconds] = {
    ("axisymmetric", "hex"): Seconds(0.00203, 0.665),
    ("axisymmetric", "tet"): Seconds(0.000675, 0.826),
    ("sector", "hex"): Seconds(0.000232, 0.891),
    ("full3d", "hex"): Seconds(0.000518, 0.781),
    ("full3d", "tet"): Seconds(5.89e-05, 1.03),
}
# How much longer full 3D in hexahedra takes on a half and as a whole than on a quarter (docs/decisions.md).
LONGER = {4: 1.0, 2: 2.0, 1: 3.6}


def cells_of(scene: BellowsScene) -> Cells:
    """``hex`` for quadrilaterals and hexahedra, ``tet`` for triangles and tetrahedra."""
    return "hex" if in_hexahedra(scene) else "tet"


def features(scene: BellowsScene) -> tuple[float, ...]:
    """Logarithms of what the meridian's error depends on.

    Wall over root radius; fillet over wall; depth of the fold over wall; highest pressure over shear modulus times wall
    over crest radius; number of cells through the wall on the coarsest level, which jumps with the wall; number of
    convolutions, which thin out what both ends leave of error, up to `LONGEST`; and 1 for Ogden's law, 0 for others.
    """
    g = scene.geometry
    mu_kpa = 1e3 * law_of(scene.material).initial_shear_modulus_mpa
    return (
        math.log(g.wall_mm / g.root_radius_mm),
        math.log(g.fillet_mm / g.wall_mm),
        math.log((g.crest_radius_mm - g.root_radius_mm) / g.wall_mm),
        math.log(scene.load.pressure_kpa[-1] * g.crest_radius_mm / (mu_kpa * g.wall_mm)),
        math.log(scene_resolution(scene, 1).through),
        math.log(min(g.convolutions, LONGEST)),
        float(scene.material.law == "ogden"),
    )


def meridian_error_percent(scene: BellowsScene, level: int) -> float:
    """Predicted error that a meridian leaves at the tip, percent: the largest over the requested pressures."""
    fit = FITS[cells_of(scene)]
    power = sum(s * (x - c) for s, x, c in zip(fit.slopes, features(scene), fit.centre, strict=True))
    return max(FLOOR_PERCENT, math.exp(fit.constants[MERIDIANS.index(level)] + power))


def predicted_error_percent(scene: BellowsScene, model: Model, level: str) -> float:
    """Predicted error of a run at the tip, percent: the largest over the requested pressures.

    Parameters
    ----------
    scene
        A bellows.
    model, level
        For instance ``axisymmetric`` and ``r2``, ``full3d`` and ``n8r2``; meridians of `MERIDIANS` only.
    """
    if model == "axisymmetric":
        return meridian_error_percent(scene, fineness(level))
    body = body_level(level)
    return meridian_error_percent(scene, body.meridian) + AROUND[cells_of(scene)].at(body.around)


def checked_error_percent(cells: Cells, level: int, value_mm: Sequence[float], other_mm: Sequence[float]) -> float:
    """Error of a level as another level of the same scene shows it, percent: the largest over the requested pressures.

    Parameters
    ----------
    level
        Meridian level of ``value_mm``.
    value_mm, other_mm
        Tips at the requested pressures on this level, and on the one before; of the first level, on the second. NaN
        where one was not reached.
    """
    ratio = FITS[cells].ratios[MERIDIANS.index(level)]
    pairs = [(v, o) for v, o in zip(value_mm, other_mm, strict=True) if math.isfinite(v) and math.isfinite(o) and v]
    return max([FLOOR_PERCENT, *(100.0 * ratio * abs((v - o) / v) for v, o in pairs)])


def predicted_unknowns(scene: BellowsScene, model: Model, level: str) -> float:
    """How many unknowns a run solves for, to some percent.

    Meshed rings and what meets on the axis are not counted apart; of a body solved on a quarter it is the quarter's.
    """
    body = None if model == "axisymmetric" else body_level(level)
    finer = fineness(level) if body is None else body.meridian
    mesh = meridian_mesh(shape_of(scene), scene_resolution(scene, 1), None, "quadrilaterals")
    cells, corners = len(mesh.cells), len(mesh.corners)
    sides = cells + corners - 1

    def points(parts: int) -> int:
        """Corners of cells with their sides cut into so many parts."""
        return corners + sides * (parts - 1) + cells * (parts - 1) ** 2

    layers = 1 if body is None else body.around // _parts(scene, model, body.around)
    displacements = (2 if body is None else 6 * layers) * points(2 * finer)
    if cell_kind(scene) == "quadrilaterals":
        return displacements + cells * finer**2 * layers * (3 if body is None else 4)
    return displacements + points(finer) * layers


def _parts(scene: BellowsScene, model: str, around: int = 0) -> int:
    """How many parts make the body of what is solved, with so many cells round or a number that allows it."""
    return SECTORS[model if model == "sector" else solved_part(scene, around or quarters(scene))[0]]


def predicted_seconds(scene: BellowsScene, model: Model, level: str) -> float:
    """Predicted wall seconds without start and imports, two cores; of a body with its axisymmetric start."""
    cells, unknowns = cells_of(scene), predicted_unknowns(scene, model, level)
    if (model, cells) != ("full3d", "hex"):
        return SECONDS[model, cells].at(unknowns)
    parts = _parts(scene, model, body_level(level).around)
    return LONGER[parts] * SECONDS[model, cells].at(parts * unknowns)


def knows(scene: BellowsScene) -> bool:
    """True if the model is about such a scene: the free tip of a centred bellows under pressure, without a force."""
    plain = not scene.blocked and not scene.load.tip_force_n
    return plain and scene.load.sense > 0.0 and not scene.geometry.eccentricity


def around_for(scene: BellowsScene, model: str) -> int:
    """The fewest to begin with that leave the circumference its share of the scene's tolerance, or the most."""
    cells = cells_of(scene)
    allowed = AROUND_SHARE * scene.ask.tolerance_percent
    most = MOST_ON_A_QUARTER if _parts(scene, model) == 4 else ROUNDS[cells][-1]
    few = [n for n in rounds_of(scene, model) if n <= most]
    return next((n for n in few if AROUND[cells].at(n) <= allowed), few[-1])


def rounds_of(scene: BellowsScene, model: str) -> list[int]:
    """Numbers of cells round that a body may have, fewest first: those of four quarters, if it is solved on a part."""
    kind = cells_of(scene)
    parts = quarters(scene) if _parts(scene, model) > 1 else 1
    return [n for n in (*ROUNDS[kind], *FINER_ROUNDS[kind]) if n % parts == 0]


def candidates(scene: BellowsScene, model: Model) -> list[str]:
    """Levels of a model that may be chosen, coarsest first."""
    if model == "axisymmetric":
        return [f"r{level}" for level in MERIDIANS]
    around = around_for(scene, model)
    return [BodyLevel(around, meridian).name for meridian in BODY_MERIDIANS]


def choose(scene: BellowsScene, model: Model) -> Choice:
    """The quickest level of a model whose predicted error is within the scene's tolerance, or the most exact.

    The prediction is the middle of a distribution: whoever uses the choice checks it with `checked_error_percent`.
    """
    found = []
    for level in candidates(scene, model):
        error = predicted_error_percent(scene, model, level)
        own = error if model == "axisymmetric" else meridian_error_percent(scene, body_level(level).meridian)
        allowed = scene.ask.tolerance_percent * (1.0 if model == "axisymmetric" else MERIDIAN_SHARE)
        found.append(Choice(model, level, error, predicted_seconds(scene, model, level), own <= allowed))
    within = [choice for choice in found if choice.within]
    return min(within, key=lambda c: c.seconds) if within else min(found, key=lambda c: c.error_percent)


def meridians_for(choice: Choice) -> tuple[int, int]:
    """Meridian levels to solve: the chosen one's, and the one that checks it."""
    return (1, 2) if own_meridian(choice) < MERIDIANS[-1] else (MERIDIANS[-2], MERIDIANS[-1])


def own_meridian(choice: Choice) -> int:
    """Meridian level of a choice, or that its body is made from."""
    return fineness(choice.level) if choice.model == "axisymmetric" else body_level(choice.level).meridian


def explain(scene: BellowsScene, choice: Choice, one_mesh: bool) -> list[str]:
    """Sentences for a terminal: what is expected of a choice, what is left out, and how long that would have taken.

    With ``one_mesh`` the coarsest meridian tells its own error.
    """
    tolerance = scene.ask.tolerance_percent
    held = "within" if choice.within else "the best there is for"
    spread = math.exp(FITS[cells_of(scene)].spread)
    lines = [
        f"expected of {choice.model} {choice.level}: error {choice.error_percent:.2g} % (two times of three within "
        f"a factor of {spread:.1f}), {held} a tolerance of {tolerance:g} %; about {_time(choice.seconds)}"
    ]
    solved = MERIDIANS[:1] if one_mesh else meridians_for(choice)
    checks = [m for m in solved if m != own_meridian(choice)]
    seconds = sum(predicted_seconds(scene, "axisymmetric", f"r{m}") for m in checks)
    beside = " and ".join(f"r{m}" for m in checks)
    check = f"axisymmetric {beside} of this scene (about {_time(seconds)})" if checks else "the mesh's own error"
    lines.append(f"checked afterwards by {check}; finer meshes follow only if the check fails")
    left: list[tuple[Model, str]] = [("axisymmetric", f"r{m}") for m in MERIDIANS if m not in solved]
    left += [(choice.model, level) for level in candidates(scene, choice.model) if choice.model != "axisymmetric"]
    left += [("full3d", choose(scene, "full3d").level)] if choice.model == "axisymmetric" else []
    for model, level in left:
        if (model, level) == (choice.model, choice.level):
            continue
        error, saved = predicted_error_percent(scene, model, level), predicted_seconds(scene, model, level)
        lines.append(f"skipped: {model} {level}, expected error {error:.2g} %; saves about {_time(saved)}")
    return lines


def _time(seconds: float) -> str:
    return f"{seconds:.1f} s" if seconds < 120.0 else f"{seconds / 60.0:.1f} min"
