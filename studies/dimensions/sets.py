"""Sets to compute with: members of a fit with dimensions that the fit does not see, drawn over all that may be.

What is inferred and what is chosen are unknown alike, so both are drawn: a Latin hypercube over the place in the list
of members and over every chosen dimension. A set that cannot be built, or that weighs too much or too little, is drawn
again: deep folds and long pitches leave more room for fillets and seats, and so are drawn more often.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import click
import numpy as np

from analytical.arrays import FloatArray
from analytical.bellows.fit.masses import Fittings, mass_allowed, silicone_g
from analytical.bellows.fit.members import TEXT_ORDER, Members, members_of
from analytical.bellows.paper import REFERENCE_FAMILY
from meshes.bellows import check_shape
from meshes.errors import GeometryError
from studies.dimensions.scenes import RING_HEIGHT_MM
from studies.engine import Bar
from studies.report.tables import Table
from studies.results import provenance
from studies.results.run_files import write_text_atomically
from studies.scene.dimension_sets import SETS_FILE, DimensionSet, read_sets, sets_csv

# How many of each kind: two of three from the chain that the reference is from, and enough of the reference itself for
# a rank correlation: of 16, one of 0.5 is there by chance once in twenty times.
WANTED: Final[Mapping[str, int]] = {"corrected": 40, "balanced": 20, "reference": 16}
SEED: Final = 160
# What is chosen, from where to where, mm. Ours, for the paper prints none of them.
CHOSEN: Final[Mapping[str, tuple[float, float]]] = {
    "fillet_mm": (0.1, 1.0),
    "seat_mm": (0.5, 4.0),
    "collar_mm": (1.5, 6.0),
    "cap_mm": (2.5, 10.0),
}
WHY: Final[Mapping[str, str]] = {
    "fillet_mm": "from nearly sharp, as figure 2 draws it, to the thinner wall",
    "seat_mm": "from nearly none, as figure 2 draws it, to that of the reference scenes",
    "collar_mm": "half to twice that of the reference scenes",
    "cap_mm": "half to twice that of the reference scenes",
}


@dataclass(frozen=True)
class Drawn:
    """Sets of a kind.

    Attributes
    ----------
    kind
        The fit they are members of.
    sets
        Those that can be built and may weigh what they do.
    members
        How many of the fit can be built with the least fillet and seat.
    unbuildable, too_heavy_or_light
        How many were drawn and refused.
    """

    kind: str
    sets: tuple[DimensionSet, ...]
    members: int
    unbuildable: int
    too_heavy_or_light: int


def draw_sets(corrected: Members, balanced: Members) -> tuple[Drawn, ...]:
    """Draw all sets, from the members of two chains' fits and from the reference."""
    rng = np.random.default_rng(SEED)
    fits = {"corrected": corrected, "balanced": balanced, "reference": members_of((REFERENCE_FAMILY,))}
    return tuple(_draw(kind, _with_room(fits[kind]), count, rng) for kind, count in WANTED.items())


def latin_hypercube(count: int, axes: int, rng: np.random.Generator) -> FloatArray:
    """Points in the unit cube, one in each of as many slices of every axis; shape (count, axes).

    Not scipy's: its argument for a generator has another name in every second version.
    """
    slices = rng.permuted(np.tile(np.arange(count), (axes, 1)), axis=1).T
    return (slices + rng.random((count, axes))) / count


def _with_room(members: Members) -> Members:
    """Those in the order of the text that can be built with the least of all that is chosen."""
    in_order = members.take(members.order == TEXT_ORDER)
    least = np.zeros(1 + len(CHOSEN))
    built = [_is_built(_set_at("", "", in_order.take(np.array([i])), least)[0]) for i in range(len(in_order))]
    return in_order.take(np.array(built, dtype=bool))


def _draw(kind: str, members: Members, count: int, rng: np.random.Generator) -> Drawn:
    """Sets of a kind; as many points are drawn again as were refused, until all are there."""
    sets: list[DimensionSet] = []
    unbuildable = wrong_mass = 0
    while len(sets) < count:
        for point in latin_hypercube(count - len(sets), 1 + len(CHOSEN), rng):
            one, member = _set_at(f"{kind}-{len(sets) + 1:02d}", kind, members, point)
            if not _is_built(one):
                unbuildable += 1
            elif not mass_allowed(silicone_g(member, fittings_of(one)))[0]:
                wrong_mass += 1
            else:
                sets.append(one)
    return Drawn(kind, tuple(sets), len(members), unbuildable, wrong_mass)


def _set_at(name: str, kind: str, members: Members, point: FloatArray) -> tuple[DimensionSet, Members]:
    """The set at a point of the unit cube, chosen dimensions in whole hundredths of a millimetre; and its member."""
    member = members.take(np.array([int(point[0] * len(members))]))
    family = member.family(0)
    ranges = zip(CHOSEN.items(), point[1:], strict=True)
    chosen: dict[str, Any] = {key: round(low + float(share) * (high - low), 2) for (key, (low, high)), share in ranges}
    one = DimensionSet(
        name,
        kind,
        *family.silicones,
        family.crest_radius_mm,
        family.larger_root_radius_mm,
        family.half_pitch_mm,
        family.convolutions,
        **chosen,
    )
    return one, member


def _is_built(one: DimensionSet) -> bool:
    """Whether all four actuators have an outline."""
    try:
        for actuator in one.actuators:
            check_shape(one.shape(actuator))
    except GeometryError:
        return False
    return True


def fittings_of(one: DimensionSet) -> Fittings:
    """What a set's folded wall needs to be an actuator."""
    return Fittings(one.cap_mm, one.collar_mm, one.seat_mm, RING_HEIGHT_MM)


# --- what is kept and shown -----------------------------------------------------------------


def keep_sets(drawn: tuple[Drawn, ...], folder: Path, into_scenes: bool) -> None:
    """Write the sets into a study's folder, and into scenes/ if that is requested."""
    text = sets_csv(one for kind in drawn for one in kind.sets)
    write_text_atomically(folder / SETS_FILE, text)
    if into_scenes:
        path = provenance.ROOT / "scenes" / SETS_FILE
        write_text_atomically(path, text)
        click.echo(f"sets: {path}")


def sets_recorded(drawn: tuple[Drawn, ...]) -> Bar:
    """Whether scenes/sets.csv has the sets that are drawn."""
    path = provenance.ROOT / "scenes" / SETS_FILE
    same = path.exists() and read_sets(path) == tuple(one for kind in drawn for one in kind.sets)
    found = "the same" if same else "others: write them with --write-scenes, or find out why"
    return Bar(f"The sets that are drawn are those of scenes/{SETS_FILE}", found, same)


def chosen_table(drawn: tuple[Drawn, ...]) -> Table:
    """What is chosen, from where to where, and why; how far the sets fill it."""
    every = [one for kind in drawn for one in kind.sets]
    lines = []
    for key, (low, high) in CHOSEN.items():
        values = [getattr(one, key) for one in every]
        name = key.removesuffix("_mm")
        lines.append((f"{name}, mm", f"{low:g} to {high:g}", f"{min(values):g} to {max(values):g}", WHY[key]))
    return Table(("chosen", "range", "in the sets", "why"), tuple(lines), left=(0, 3))


def drawn_table(drawn: tuple[Drawn, ...]) -> Table:
    """How many sets of each kind, from how many members, and how many were refused."""
    lines = (
        (kind.kind, f"{kind.members}", f"{len(kind.sets)}", f"{kind.unbuildable}", f"{kind.too_heavy_or_light}")
        for kind in drawn
    )
    header = ("from the fit of", "members that can be built", "sets", "refused: cannot be built", "refused: mass")
    return Table(header, tuple(lines))
