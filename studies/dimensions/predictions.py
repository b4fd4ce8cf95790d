"""What sets of dimensions predict where they were not fitted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytical.arrays import FloatArray
from analytical.bellows.chains import closed_form
from analytical.bellows.chains_by_name import PRESSURES_KPA
from analytical.bellows.fit.masses import silicone_g
from analytical.bellows.fit.members import (
    BALANCED_CHAIN,
    CORRECTED_CHAIN,
    WALLS_MM,
    Chain,
    Members,
    per_actuator,
    tip_mm,
    wall_stretch,
)
from analytical.bellows.loads import held_tip
from analytical.bellows.paper import PRINTED_PRESSURE_KPA
from studies.dimensions.fit import Fit
from studies.dimensions.scenes import FITTINGS


@dataclass(frozen=True)
class Quantity:
    """A number that was not fitted.

    Attributes
    ----------
    name, unit, label
        As in rows; for people.
    model
        The model it comes from.
    measure
        From members, m of them, to numbers of shape (m, 4).
    pressure_kpa
        Cavity pressure; NaN where there is none.
    """

    name: str
    unit: str
    label: str
    model: str
    measure: Callable[[Members], FloatArray]
    pressure_kpa: float = np.nan

    @property
    def per_actuator(self) -> bool:
        """False where the four actuators of a set have the same."""
        return self.name != "rest_length_mm"


@dataclass(frozen=True, eq=False)
class Prediction:
    """A quantity of all members, shape (m, 4), and of the picked sets, shape (3, 4)."""

    quantity: Quantity
    members: FloatArray
    picks: FloatArray


def predictions(found: Fit) -> list[Prediction]:
    """Every quantity of all members and of the picked sets."""
    return [Prediction(q, q.measure(found.members), q.measure(found.picks.sets)) for q in QUANTITIES]


def rest_length_mm(members: Members) -> FloatArray:
    """Length at rest, 2 n e and two collars without the cap, shape (m, 4), mm."""
    length = 2.0 * members.convolutions * members.half_pitch_mm + 2.0 * FITTINGS.collar_mm
    return np.repeat(length[:, None], len(WALLS_MM), axis=1)


def unfolding_kpa(members: Members) -> FloatArray:
    """Pressure at which the root reaches the crest, by the corrected chain, shape (m, 4), kPa."""
    return per_actuator(members, lambda d, law: closed_form(d, law, 0.0).unfolding_pressure_kpa[:, 0])


def blocked_n(members: Members) -> FloatArray:
    """Force at the blocked tip at 20 kPa, by the corrected chain, shape (m, 4), N."""
    return per_actuator(members, lambda d, law: held_tip(d, law, _FULL).tip_force_n[:, 0])


def _tip(kpa: float, model: str, chain: Chain) -> Quantity:
    label = f"elongation at {kpa:g} kPa, {chain.label}"
    return Quantity("tip_mm", "mm", label, model, lambda members: tip_mm(members, kpa, chain), kpa)


# What is compared between the members, in the order of the report.
_FULL: Final = PRINTED_PRESSURE_KPA
_UNFOLDING, _STRETCH = "full unfolding, corrected chain", "wall stretch at 20 kPa, corrected chain"
QUANTITIES: Final = (
    *(_tip(kpa, "closed_form", CORRECTED_CHAIN) for kpa in PRESSURES_KPA[:-1]),
    _tip(_FULL, "closed_form_balanced", BALANCED_CHAIN),
    Quantity("unfolding_pressure_kpa", "kPa", _UNFOLDING, "closed_form", unfolding_kpa),
    Quantity("wall_stretch", "1", _STRETCH, "closed_form", wall_stretch, _FULL),
    Quantity("tip_force_n", "N", "force at the blocked tip, 20 kPa", "closed_form", blocked_n, _FULL),
    Quantity("silicone_g", "g", "silicone body, estimate", "estimate", lambda members: silicone_g(members, FITTINGS)),
    Quantity("rest_length_mm", "mm", "length at rest", "estimate", rest_length_mm),
)
