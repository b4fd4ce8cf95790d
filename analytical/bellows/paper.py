"""What Heung et al. 2024 print about their four actuators, and the dimensions inferred from it.

Source: Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160, section 4. Elongations are in cm at 20 kPa,
as printed. The paper does not print R_p, e, l, n, the second R_i, the silicone of each actuator, nor which
2 mm number belongs to which R_i: everything in `InferredFamily` is inferred, none of it is measured. How the
families here were found, and how many others fit: `analytical.bellows.fit` and ``make study-dimensions``.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final, Literal

from analytical.bellows.dimensions import BellowsDimensions
from analytical.laws.isotropic import Law
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30

SOURCE: Final = "Heung et al., Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160"

PRINTED_MASS_G = 19.0  # "approximate weight", section 2; the text does not say whether the rings count
PRINTED_PRESSURE_KPA: Final = 20.0
PRINTED_ROOT_RADIUS_MM: Final = 5.0

Silicone = Literal["dragon-skin-10", "dragon-skin-30"]


@dataclass(frozen=True)
class PrintedElongation:
    """Printed elongations of one actuator at 20 kPa.

    Attributes
    ----------
    wall_mm
        Wall thickness, mm, printed.
    has_larger_root
        False: R_i = 5 mm. True: the other root radius, which is not printed.
    closed_form_cm, ansys_cm, experiment_cm
        Elongations, cm, printed.
    reading
        How the text leads to this row, and what of it is inferred.
    source
        Where it is printed.
    """

    wall_mm: float
    has_larger_root: bool
    closed_form_cm: float
    ansys_cm: float
    experiment_cm: float
    reading: str
    source: str = SOURCE


PRINTED: Final[tuple[PrintedElongation, ...]] = (
    PrintedElongation(
        wall_mm=1.0,
        has_larger_root=False,
        closed_form_cm=12.1,
        ansys_cm=11.5,
        experiment_cm=14.1,
        reading=(
            "first of the 1 mm pair; the text ties R_i = 5 mm to it through its differences, 2.6 cm between "
            "simulation and experiment and 2.0 cm between closed form and experiment"
        ),
    ),
    PrintedElongation(
        wall_mm=1.0,
        has_larger_root=True,
        closed_form_cm=6.6,
        ansys_cm=7.8,
        experiment_cm=7.6,
        reading="second of the 1 mm pair; its root radius is not printed",
    ),
    PrintedElongation(
        wall_mm=2.0,
        has_larger_root=False,
        closed_form_cm=5.3,
        ansys_cm=3.3,
        experiment_cm=5.0,
        reading=(
            "second of the 2 mm pair; inferred: the pair is read in reverse order, because the text says "
            "that a larger root radius elongates less"
        ),
    ),
    PrintedElongation(
        wall_mm=2.0,
        has_larger_root=True,
        closed_form_cm=3.8,
        ansys_cm=2.3,
        experiment_cm=4.8,
        reading="first of the 2 mm pair; inferred: read in reverse order, as its partner; R_i not printed",
    ),
)


@dataclass(frozen=True)
class InferredFamily:
    """Dimensions shared by the four actuators that meet the printed closed-form column; all inferred.

    Attributes
    ----------
    larger_root_radius_mm
        The second R_i, mm.
    crest_radius_mm
        R_p, mm.
    half_pitch_mm
        e, mm.
    convolutions
        n.
    silicones
        Silicone of each actuator, in the order of `PRINTED`. Dragon Skin 30 is meant as in eq. (3).
    label
        Goes into the names of the actuators; empty for the reference.
    """

    larger_root_radius_mm: float
    crest_radius_mm: float
    half_pitch_mm: float
    convolutions: int
    silicones: tuple[Silicone, Silicone, Silicone, Silicone]
    label: str = ""


# What the rule of `analytical.bellows.fit` picks from the families that meet the column within 5 %, as verified by
# ``make study-dimensions``. The scenes of scenes/heung-*.toml are written from here.
# One silicone per wall thickness and the smallest wall stretch at 20 kPa:
REFERENCE_FAMILY: Final = InferredFamily(
    larger_root_radius_mm=7.0,
    crest_radius_mm=10.5,
    half_pitch_mm=5.0,
    convolutions=8,
    silicones=("dragon-skin-10", "dragon-skin-10", "dragon-skin-30", "dragon-skin-30"),
)
ALTERNATE_FAMILIES: Final[tuple[InferredFamily, InferredFamily]] = (
    # The same silicones and another number of convolutions, smallest worst error:
    InferredFamily(
        larger_root_radius_mm=8.0,
        crest_radius_mm=14.0,
        half_pitch_mm=5.5,
        convolutions=4,
        silicones=("dragon-skin-10", "dragon-skin-10", "dragon-skin-30", "dragon-skin-30"),
        label="a",
    ),
    # Other silicones, smallest worst error:
    InferredFamily(
        larger_root_radius_mm=7.5,
        crest_radius_mm=10.5,
        half_pitch_mm=6.5,
        convolutions=8,
        silicones=("dragon-skin-10", "dragon-skin-10", "dragon-skin-30", "dragon-skin-10"),
        label="b",
    ),
)
FAMILIES: Final = (REFERENCE_FAMILY, *ALTERNATE_FAMILIES)

# Dragon Skin 30 as in eq. (3), initial shear modulus 75 kPa. In the other convention no set fits whose reading order
# agrees with the text.
LAWS: Final[Mapping[Silicone, Law]] = {
    "dragon-skin-10": DRAGON_SKIN_10,
    "dragon-skin-30": dragon_skin_30("2mu/alpha^2"),
}


@dataclass(frozen=True)
class PaperActuator:
    """One of the four actuators: inferred dimensions (mm) and silicone, printed elongations (cm)."""

    name: str
    dimensions: BellowsDimensions
    silicone: Silicone
    law: Law
    printed: PrintedElongation


def actuators(family: InferredFamily = REFERENCE_FAMILY) -> tuple[PaperActuator, ...]:
    """The four actuators of a family, in the order of `PRINTED`."""
    return tuple(_actuator(family, row, silicone) for row, silicone in zip(PRINTED, family.silicones, strict=True))


def printed(
    wall_mm: float,
    root_radius_mm: float,
    crest_radius_mm: float,
    half_pitch_mm: float,
    convolutions: int,
    families: Iterable[InferredFamily] = FAMILIES,
) -> PrintedElongation | None:
    """Printed elongations of the actuator with these dimensions (mm), None if it is of none of the families."""
    requested = (wall_mm, root_radius_mm, crest_radius_mm, half_pitch_mm, convolutions)
    for actuator in (actuator for family in families for actuator in actuators(family)):
        d = actuator.dimensions
        known = (d.wall_mm, d.root_radius_mm, d.crest_radius_mm, d.half_pitch_mm, d.convolutions)
        # 1e-9: the same number after a round trip through text or another unit.
        if all(math.isclose(one, other, rel_tol=1e-9) for one, other in zip(requested, known, strict=True)):
            return actuator.printed
    return None


def _actuator(family: InferredFamily, row: PrintedElongation, silicone: Silicone) -> PaperActuator:
    root_radius_mm = family.larger_root_radius_mm if row.has_larger_root else PRINTED_ROOT_RADIUS_MM
    return PaperActuator(
        name="-".join(filter(None, ("heung", family.label, f"t{row.wall_mm:g}", f"ri{root_radius_mm:g}"))),
        dimensions=BellowsDimensions(
            root_radius_mm=root_radius_mm,
            crest_radius_mm=family.crest_radius_mm,
            wall_mm=row.wall_mm,
            half_pitch_mm=family.half_pitch_mm,
            convolutions=family.convolutions,
        ),
        silicone=silicone,
        law=LAWS[silicone],
        printed=row,
    )
