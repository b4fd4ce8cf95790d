"""What the rows of the study's sweep are of: silicone, root radius, wall, number of convolutions, pressure."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeVar

from analytical.bellows import paper
from analytical.bellows.chains_by_name import SILICONES
from studies.results import provenance
from studies.scene.bellows import dimensions_of
from studies.scene.load import load_bellows
from studies.sweep.csv_table import CHAINS, SweepRow
from studies.sweep.rules import LIMIT_PERCENT, Point

BASE: Final = provenance.ROOT / "scenes" / "heung-t1-ri5.toml"
ROOT_KEY, WALL_KEY, COUNT_KEY = "geometry.root_radius_mm", "geometry.wall_mm", "geometry.convolutions"
# Convolutions of the maps: the reference actuators'.
MAP_COUNT: Final = paper.REFERENCE_FAMILY.convolutions
_SILICONE_BY_LAW: Final[dict[str, paper.Silicone]] = {"yeoh": "dragon-skin-10", "ogden": "dragon-skin-30"}


@dataclass(frozen=True)
class Outline:
    """The designs with one outline.

    Attributes
    ----------
    name
        Of its folder and pictures.
    text
        For headings.
    file
        Its sweep.
    """

    name: str
    text: str
    file: Path


OUTLINES: Final = (
    Outline("moulded", "as moulded: fillets 0.5, seats 4 mm", provenance.ROOT / "sweeps" / "heung-map.toml"),
    Outline(
        "zigzag",
        "near the paper's zigzag: fillets 0.1, seats 0.5 mm",
        provenance.ROOT / "sweeps" / "heung-map-zigzag.toml",
    ),
)

Key = TypeVar("Key")
Design = tuple[float, float]


def silicone(row: SweepRow) -> paper.Silicone:
    """The silicone of a row."""
    return _SILICONE_BY_LAW[row.values["material"]["law"]]


def silicone_name(row: SweepRow) -> str:
    """Its name in print."""
    return SILICONES[silicone(row)]


def root_and_wall(row: SweepRow) -> Design:
    """Root radius and wall, mm."""
    return row.values[ROOT_KEY], row.values[WALL_KEY]


def convolutions(row: SweepRow) -> int:
    """Number of convolutions."""
    return int(row.values[COUNT_KEY])


def is_mapped(row: SweepRow) -> bool:
    """True for the number of convolutions that is drawn."""
    return convolutions(row) == MAP_COUNT


def folding(row: SweepRow) -> str:
    """What the closed form is at the row's pressure."""
    return "fully unfolded" if row.pressure_kpa >= row.unfolding_kpa else "folded"


def is_off(percent: float) -> bool:
    """True beyond the limit."""
    return abs(percent) > LIMIT_PERCENT


def pressures(rows: Iterable[SweepRow]) -> list[float]:
    """Pressures of rows, kPa."""
    return sorted({row.pressure_kpa for row in rows})


def grouped(rows: Iterable[SweepRow], key: Callable[[SweepRow], Key]) -> dict[Key, list[SweepRow]]:
    """Rows by what they have in common, in the order of their first ones."""
    found: dict[Key, list[SweepRow]] = {}
    for row in rows:
        found.setdefault(key(row), []).append(row)
    return found


def points(rows: Sequence[SweepRow]) -> list[Point]:
    """Rows as the rules of thumb take them."""
    crest = dimensions_of(load_bellows(BASE)).crest_radius_mm
    return [
        Point(
            silicone=silicone(row),
            convolutions=convolutions(row),
            load=1e-3
            * row.pressure_kpa
            * crest
            / (paper.LAWS[silicone(row)].initial_shear_modulus_mpa * row.values[WALL_KEY]),
            chains={chain: row.chain(chain) for chain in CHAINS},
            axisymmetric=row.axisymmetric,
        )
        for row in rows
    ]
