"""Sets of dimensions of the paper's four actuators that nothing printed tells apart, kept in scenes/sets.csv.

`studies.dimensions` draws and writes them; who computes with them reads them here.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Final

from analytical.bellows.paper import InferredFamily, PaperActuator, Silicone, actuators
from analytical.laws.isotropic import Ogden, Yeoh
from meshes.shape import BellowsShape

SETS_FILE: Final = "sets.csv"
# The paper's actuators in the order of its columns, whatever the larger R_i of a set is.
SLOTS: Final = ("t1-ri5", "t1-larger-ri", "t2-ri5", "t2-larger-ri")
# Kinds of sets by the chain of the closed form whose fit they are of; of the reference only what is chosen differs.
CHAIN_OF: Final[Mapping[str, str]] = {
    "corrected": "closed_form",
    "balanced": "closed_form_balanced",
    "reference": "closed_form",
}


@dataclass(frozen=True)
class DimensionSet:
    """Dimensions of all four actuators, mm.

    Attributes
    ----------
    name
        For folders and rows.
    kind
        The fit that it is a member of, a key of `CHAIN_OF`.
    silicone_1, silicone_2, silicone_3, silicone_4
        Of each actuator in the order of `SLOTS`, inferred.
    crest_radius_mm, larger_root_radius_mm, half_pitch_mm, convolutions
        R_p, the second R_i, e, n, inferred.
    fillet_mm, seat_mm, collar_mm, cap_mm
        Chosen: the paper prints none and no fit sees them.
    """

    name: str
    kind: str
    silicone_1: Silicone
    silicone_2: Silicone
    silicone_3: Silicone
    silicone_4: Silicone
    crest_radius_mm: float
    larger_root_radius_mm: float
    half_pitch_mm: float
    convolutions: int
    fillet_mm: float
    seat_mm: float
    collar_mm: float
    cap_mm: float

    @property
    def actuators(self) -> tuple[PaperActuator, ...]:
        """Its four actuators as the closed form sees them, in the order of `SLOTS`."""
        family = InferredFamily(
            self.larger_root_radius_mm,
            self.crest_radius_mm,
            self.half_pitch_mm,
            self.convolutions,
            (self.silicone_1, self.silicone_2, self.silicone_3, self.silicone_4),
        )
        return actuators(family)

    def shape(self, actuator: PaperActuator) -> BellowsShape:
        """Outline of one of its actuators."""
        d = actuator.dimensions
        return BellowsShape(
            d.root_radius_mm,
            d.crest_radius_mm,
            d.wall_mm,
            d.half_pitch_mm,
            d.convolutions,
            self.collar_mm,
            self.seat_mm,
            self.fillet_mm,
            self.cap_mm,
        )

    def changes(self, actuator: PaperActuator) -> dict[str, Any]:
        """Keys of a scene that make it one of this set, with dots."""
        d = actuator.dimensions
        return {
            "geometry.root_radius_mm": d.root_radius_mm,
            "geometry.crest_radius_mm": d.crest_radius_mm,
            "geometry.half_pitch_mm": d.half_pitch_mm,
            "geometry.convolutions": d.convolutions,
            "geometry.collar_mm": self.collar_mm,
            "geometry.fillet_mm": self.fillet_mm,
            "geometry.cap_mm": self.cap_mm,
            "rings.seat_mm": self.seat_mm,
            "material": _material(actuator),
        }


def _material(actuator: PaperActuator) -> dict[str, Any]:
    """The silicone of an actuator as a section of a scene; 1e-9: kPa as printed, without binary tails."""
    law = actuator.law
    if isinstance(law, Yeoh):
        return {"law": "yeoh", "c_kpa": [round(1e3 * c, 9) for c in law.c_mpa]}
    assert isinstance(law, Ogden)
    mu = round(1e3 * law.mu_mpa, 9)
    return {"law": "ogden", "mu_kpa": mu, "alpha": law.alpha, "convention": law.convention}


def sets_csv(sets: Iterable[DimensionSet]) -> str:
    """Sets as CSV, a line each."""
    names = [f.name for f in fields(DimensionSet)]
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(names)
    writer.writerows([getattr(one, name) for name in names] for one in sets)
    return stream.getvalue()


def read_sets(path: Path) -> tuple[DimensionSet, ...]:
    """Sets written by `sets_csv`."""
    kinds = {"float": float, "int": int}
    with path.open(newline="", encoding="utf-8") as stream:
        lines = list(csv.DictReader(stream))
    types = {f.name: kinds.get(str(f.type), str) for f in fields(DimensionSet)}
    return tuple(DimensionSet(**{name: types[name](text) for name, text in line.items()}) for line in lines)
