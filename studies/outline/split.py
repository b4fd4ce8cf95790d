"""The gap between finite elements and closed form, split into causes that sum to it.

Finite elements come first with the outline as moulded, then with one thing changed after another towards what the
closed form is given. What is left is split by its own kinematics, eq. (23) of DOI 10.3390/biomimetics9030160,
``u = 2 n (sqrt((lambda_a l)^2 - ((R_p + t) - lambda_y (R_i + t))^2) - e)``, fed with the stretches measured in the
states.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from analytical.bellows.chains import closed_form
from analytical.bellows.dimensions import BellowsDimensions
from analytical.bellows.paper import PaperActuator
from studies.outline.cases import FILLETS, MOULDED, RIGID_TIP, ZIGZAG
from studies.results.rows import Row

# In the order in which they are taken away.
CAUSES: Mapping[str, str] = {
    "fillets": "fillets of 0.5 instead of 0.1 mm",
    "seats": "seats of 4 instead of 0.5 mm",
    "cap": "silicone cap",
    "bends": "walls are not straight from root to crest",
    "wall": "the side wall stretches otherwise",
    "root": "the root opens otherwise",
}


@dataclass(frozen=True)
class Split:
    """The gap of an actuator at a pressure, mm.

    Attributes
    ----------
    closed_form_mm, elements_mm, uncertainty_mm
        Both elongations, and the band of the finite elements of the outline as moulded.
    causes_mm
        By name, see `CAUSES`; their sum is ``elements_mm - closed_form_mm``.
    held
        True if the closed form holds the root at full unfolding.
    """

    actuator: PaperActuator
    pressure_kpa: float
    closed_form_mm: float
    elements_mm: float
    uncertainty_mm: float
    causes_mm: Mapping[str, float]
    held: bool


def kinematics_mm(d: BellowsDimensions, root_stretch: float, wall_stretch: float) -> float:
    """Elongation that eq. (23) gives for stretches of root and side wall, mm; NaN if the wall cannot span the fold."""
    drop = d.crest_radius_mm + d.wall_mm - root_stretch * (d.root_radius_mm + d.wall_mm)
    square = (wall_stretch * d.side_length_mm) ** 2 - drop**2
    return 2.0 * d.convolutions * (math.sqrt(square) - d.half_pitch_mm) if square >= 0.0 else math.nan


def split(rows: Sequence[Row], actuator: PaperActuator, pressure_kpa: float) -> Split:
    """The gap of an actuator at a pressure; NaN where a state is missing."""
    d = actuator.dimensions
    chain = closed_form(d, actuator.law, pressure_kpa)
    cf, root, wall = float(chain.elongation_mm[0]), float(chain.root_stretch[0]), float(chain.wall_stretch[0])

    def of(outline: str, quantity: str = "tip_mm") -> Row | None:
        scene = f"{actuator.name}-{outline}"
        # levels ascend: the last is the finest
        found = [r for r in rows if (r.scene, r.quantity, r.model) == (scene, quantity, "axisymmetric")]
        return next((r for r in reversed(found) if math.isclose(r.pressure_kpa, pressure_kpa)), None)

    def value(outline: str, quantity: str = "tip_mm") -> float:
        found = of(outline, quantity)
        return math.nan if found is None else found.value

    steps = [value(outline.name) for outline in (MOULDED, FILLETS, ZIGZAG, RIGID_TIP)]
    root_found, wall_found = (value(RIGID_TIP.name, name) for name in ("root_stretch_outer", "wall_stretch"))
    steps += [kinematics_mm(d, root_found, wall_found), kinematics_mm(d, root_found, wall), cf]
    moulded = of(MOULDED.name)
    return Split(
        actuator,
        pressure_kpa,
        cf,
        steps[0],
        math.nan if moulded is None else moulded.uncertainty,
        {name: before - after for name, before, after in zip(CAUSES, steps, steps[1:], strict=False)},
        root >= d.unfolded_root_stretch * (1.0 - 1e-12),
    )
