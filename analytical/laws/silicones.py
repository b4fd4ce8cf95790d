"""Constants of the two silicones, each with its origin. Moduli are in MPa.

Source of what is printed: Heung et al., Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160, section 3 ("Finite
Element Method (FEM) Modeling"), elongations at break section 2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from analytical.laws.isotropic import OGDEN_CONVENTIONS, IsotropicLaw, Law, Ogden, OgdenConvention, Yeoh

# Printed: C1 = 36000, C2 = 2500, C3 = 230 Pa; initial shear modulus 2 C1 = 72 kPa.
DRAGON_SKIN_10: Final = Yeoh(c_mpa=(0.036, 0.0025, 0.00023))

# Printed: 1000 % and 364 %.
DRAGON_SKIN_10_ELONGATION_AT_BREAK_PERCENT: Final = 1000.0
DRAGON_SKIN_30_ELONGATION_AT_BREAK_PERCENT: Final = 364.0

# Our choice, not printed: density of cured Dragon Skin.
SILICONE_DENSITY_G_CM3: Final = 1.07


def dragon_skin_30(convention: OgdenConvention) -> Ogden:
    """Dragon Skin 30, one-term Ogden: mu = 75.449 kPa, alpha = 5.836.

    The paper prints the two numbers once and puts them into both conventions: eq. (3) is "2mu/alpha^2"
    (initial shear modulus 75 kPa), eq. (20) is "mu/alpha" (220 kPa). The caller has to say which.
    """
    return Ogden(mu_mpa=0.075449, alpha=5.836, convention=convention)


@dataclass(frozen=True)
class Silicone:
    """What is known of a silicone beside its law.

    The paper does not say to which stretches the data went that its laws were fitted to, so that is not here.

    Attributes
    ----------
    name
        Its maker's name.
    stretch_at_break
        One plus the elongation at break.
    source
        Where that is from.
    """

    name: str
    stretch_at_break: float
    source: str


_SOURCE: Final = "elongation at break {:g} %, Heung et al. 2024, section 2"
_KNOWN: Final[tuple[tuple[Law, str, float], ...]] = (
    (DRAGON_SKIN_10, "Dragon Skin 10", DRAGON_SKIN_10_ELONGATION_AT_BREAK_PERCENT),
    *(
        (dragon_skin_30(convention), "Dragon Skin 30", DRAGON_SKIN_30_ELONGATION_AT_BREAK_PERCENT)
        for convention in OGDEN_CONVENTIONS
    ),
)


def silicone_of(law: IsotropicLaw) -> Silicone | None:
    """The silicone whose printed constants a law has, to six digits; None if it is none of them."""
    for known, name, elongation in _KNOWN:
        if _alike(known, law):
            return Silicone(name, 1.0 + 0.01 * elongation, _SOURCE.format(elongation))
    return None


def _alike(known: Law, law: IsotropicLaw) -> bool:
    numbers: tuple[float, ...]
    given: tuple[float, ...]
    if isinstance(known, Yeoh) and isinstance(law, Yeoh):
        numbers, given = known.c_mpa, law.c_mpa
    elif isinstance(known, Ogden) and isinstance(law, Ogden) and known.convention == law.convention:
        numbers, given = (known.mu_mpa, known.alpha), (law.mu_mpa, law.alpha)
    else:
        return False
    return len(numbers) == len(given) and np.allclose(numbers, given, rtol=1e-6, atol=0.0)
