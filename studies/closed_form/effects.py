"""What is put in place of something in the corrected chain, to see what that is worth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytical.arrays import FloatArray
from analytical.bellows.chains import ClosedFormPath, closed_form
from analytical.bellows.reading import BALANCED, PRINTED_READING, Reading
from analytical.bellows.validity import cap_bulge_mm, with_free_root, with_other_wall

# The cap of the scenes (docs: our choice, not printed), mm.
CAP_MM: Final = 5.0


@dataclass(frozen=True)
class Effect:
    """Something else than the corrected chain, and what it is compared as.

    Attributes
    ----------
    name
        Short name, also of its picture.
    title
        Heading.
    words
        What is put in place of what.
    other_mm
        Elongation with it, mm, from the corrected chain's path; shape of the path.
    """

    name: str
    title: str
    words: str
    other_mm: Callable[[ClosedFormPath], FloatArray]

    def percent(self, path: ClosedFormPath) -> FloatArray:
        """Change in percent of the corrected chain's elongation, shape of the path; NaN where there is no state."""
        elongation = path.elongation_mm
        return np.asarray(100.0 * (self.other_mm(path) - elongation) / elongation)


def _by_reading(reading: Reading) -> Callable[[ClosedFormPath], FloatArray]:
    def other(path: ClosedFormPath) -> FloatArray:
        pressures = path.pressure_kpa.reshape(-1, path.pressure_kpa.shape[-1])[0]
        return closed_form(path.dimensions, path.law, pressures, reading).elongation_mm

    return other


def _with_bulge(path: ClosedFormPath) -> FloatArray:
    radius = np.asarray(path.dimensions.crest_radius_mm, dtype=float)[..., None]
    return np.asarray(path.elongation_mm + cap_bulge_mm(radius, CAP_MM, path.law, path.pressure_kpa))


EFFECTS: Final[tuple[Effect, ...]] = (
    Effect(
        name="printed",
        title="Chain as printed",
        words="The printed chain instead of the corrected one: the misprints, all together.",
        other_mm=_by_reading(PRINTED_READING),
    ),
    Effect(
        name="balanced",
        title="Balanced chain",
        words="The balanced chain (mean cut) instead of the corrected one: the statics of the side wall.",
        other_mm=_by_reading(BALANCED),
    ),
    Effect(
        name="free-root",
        title="Root free of axial force",
        words="The root as a tube whose axial stretch is such that its wall carries no axial force, instead of plane "
        "strain.",
        other_mm=lambda path: with_free_root(path).elongation_mm,
    ),
    Effect(
        name="uniaxial-wall",
        title="Side wall in uniaxial tension",
        words="The side wall free in the hoop direction instead of pure shear (hoop stretch 1), under the same stress.",
        other_mm=lambda path: with_other_wall(path, "uniaxial").elongation_mm,
    ),
    Effect(
        name="hoop-stretched-wall",
        title="Side wall with the root's hoop stretch",
        words="The side wall with the hoop stretch that root and crest impose half way between them, instead of 1.",
        other_mm=lambda path: with_other_wall(path, "stretched by the root").elongation_mm,
    ),
    Effect(
        name="cap-bulge",
        title="Cap that bulges",
        words=f"The middle of a silicone cap of {CAP_MM:g} mm with radius R<sub>p</sub> instead of a rigid tip: linear "
        "theory of a clamped circular plate, incompressible, with D = μh³/3 and shear factor 5/6: "
        "w = PR⁴/(64D) + PR²/(4·(5/6)·μh). The rim of the cap does not take part.",
        other_mm=_with_bulge,
    ),
    Effect(
        name="no-saturation",
        title="Root not held at full unfolding",
        words="The root goes on widening past the crest and the bellows folds back, instead of being held there.",
        other_mm=_by_reading(Reading(folds_back=True)),
    ),
)
