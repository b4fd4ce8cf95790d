"""Stiff solids of the crest rings: isotropic and linear elastic, with the constants of two plastics. Moduli in MPa."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from analytical.laws.errors import MaterialError, require_finite, require_positive


@dataclass(frozen=True)
class StiffSolid:
    """Isotropic linear elastic material of the crest rings.

    Parameters
    ----------
    young_mpa
        Young's modulus, MPa.
    poisson
        Poisson's ratio, in (-1, 1/2).
    density_g_cm3
        Density, g/cm3.
    """

    young_mpa: float
    poisson: float
    density_g_cm3: float

    def __post_init__(self) -> None:
        require_positive("young_mpa", self.young_mpa, "give Young's modulus in MPa (1 GPa = 1000 MPa)")
        require_positive("density_g_cm3", self.density_g_cm3, "give the density in g/cm3")
        require_finite("poisson", self.poisson)
        if not -1.0 < self.poisson < 0.5:
            raise MaterialError(
                f"poisson = {self.poisson:g} must lie in (-1, 1/2): an incompressible ring needs a law of "
                "its own, otherwise give a value such as 0.36"
            )

    @property
    def mu_mpa(self) -> float:
        """Shear modulus (second Lame constant), MPa."""
        return self.young_mpa / (2.0 * (1.0 + self.poisson))

    @property
    def kappa_mpa(self) -> float:
        """Bulk modulus, MPa."""
        return self.young_mpa / (3.0 * (1.0 - 2.0 * self.poisson))

    @property
    def lame_lambda_mpa(self) -> float:
        """First Lame constant, MPa."""
        return self.kappa_mpa - 2.0 * self.mu_mpa / 3.0


# The paper says the rings are printed in PLA and gives no constants; these are our choice. Shear modulus 1287 MPa.
PLA: Final = StiffSolid(young_mpa=3500.0, poisson=0.36, density_g_cm3=1.24)

# Assumed: the paper's FEM takes polyethylene from the ANSYS library, whose values are quoted from memory.
# Shear modulus 387 MPa.
POLYETHYLENE: Final = StiffSolid(young_mpa=1100.0, poisson=0.42, density_g_cm3=0.95)
