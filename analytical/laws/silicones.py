"""Constants of the two silicones, each with its origin. Moduli are in MPa.

Source of what is printed: Heung et al., Biomimetics 2024, 9, 160, DOI 10.3390/biomimetics9030160, section 3 ("Finite
Element Method (FEM) Modeling"), elongations at break section 2.
"""

from __future__ import annotations

from typing import Final

from analytical.laws.isotropic import Ogden, OgdenConvention, Yeoh

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
