"""How the paper's equations are read: one field per item, and the three readings in use.

Numbers of equations: Heung et al., Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

Cut = Literal["mixed", "mean", "crest", "root"]
RootDerivative = Literal["law", "theta", "r", "z"]


@dataclass(frozen=True)
class Reading:
    """How the equations are read. The defaults are the corrected chain.

    Attributes
    ----------
    root_derivative
        "law": sigma_theta - sigma_r of the law. "theta", "r", "z": what eq. (9) prints for Ogden, with that j.
    linear_inner_stretch
        Eq. (14) as printed, instead of the exact lambda_i^2 = 1 + (1 + t/R_i)^2 (lambda_o^2 - 1).
    tabulated_root
        lambda_y read by linear interpolation from a table in steps of 0.1.
    wall_by_20
        Eq. (20) for Ogden: mu (lambda^alpha - lambda^-alpha) whatever the law's convention.
    folds_back
        The root is not held at full unfolding.
    wall_on_deformed_area
        The wall's force is sigma A / lambda_a: the Cauchy stress on the deformed area.
    wall_along_axis
        The wall's axial force has the factor a / b.
    cut
        Where thrust and wall area are taken: "mixed" is the print.
    """

    root_derivative: RootDerivative = "law"
    linear_inner_stretch: bool = False
    tabulated_root: bool = False
    wall_by_20: bool = False
    folds_back: bool = False
    wall_on_deformed_area: bool = False
    wall_along_axis: bool = False
    cut: Cut = "mixed"


CORRECTED: Final = Reading()
PRINTED_READING: Final = Reading(
    root_derivative="theta", linear_inner_stretch=True, tabulated_root=True, wall_by_20=True, folds_back=True
)
BALANCED: Final = Reading(wall_on_deformed_area=True, wall_along_axis=True, cut="mean")
