"""Material laws in scenes: their numbers in kPa, what is wrong with them, and the laws in MPa."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Literal

from pydantic import Field

from analytical.laws.errors import MaterialError
from analytical.laws.isotropic import Guccione, Law, NeoHooke, Ogden, Yeoh
from studies.scene.sections import Modulus, Section

SignedModulus = Annotated[float, Field(ge=-1e5, le=1e5, allow_inf_nan=False)]
# Below this size of the exponent the finite elements' form of the Ogden law has an error of stress above 1e-6.
LEAST_ALPHA = 0.05


class Material(Section):
    """What every law has beside its constants.

    ``data_to_stretch``: up to which stretch the data went that the law was fitted to; results beyond carry a warning.
    """

    kappa_over_mu: Annotated[float, Field(gt=10.0)] = Field(
        default=math.inf, description="bulk modulus over initial shear modulus; inf: incompressible"
    )
    data_to_stretch: Annotated[float, Field(gt=1.0, le=100.0)] | None = Field(
        default=None,
        description="largest stretch of the data that the law was fitted to; results beyond carry a warning",
    )


class YeohMaterial(Material):
    """W = sum C_i (I1 - 3)^i; initial shear modulus 2 C1."""

    law: Literal["yeoh"]
    c_kpa: Annotated[list[float], Field(min_length=1, max_length=3)] = Field(description="C_1, C_2, C_3")


class OgdenMaterial(Material):
    """One Ogden term; the convention says what mu is (initial shear modulus mu, or mu alpha / 2).

    In "mu/alpha" a negative alpha goes with a negative mu.
    """

    law: Literal["ogden"]
    mu_kpa: SignedModulus = Field(description="mu; what it is the convention says")
    alpha: Annotated[float, Field(ge=-20.0, le=20.0)] = Field(description="exponent of the principal stretches")
    convention: Literal["2mu/alpha^2", "mu/alpha"] = Field(
        description="factor before the powers: mu is the initial shear modulus, or that is mu alpha / 2"
    )


class NeoHookeMaterial(Material):
    """W = mu/2 (I1 - 3); initial shear modulus mu."""

    law: Literal["neo-hooke"]
    mu_kpa: Modulus = Field(description="initial shear modulus")


class GuccioneMaterial(Material):
    """W = C/2 (exp(b E:E) - 1), isotropic; initial shear modulus b C / 2."""

    law: Literal["guccione"]
    c_kpa: Modulus = Field(description="C")
    b: Annotated[float, Field(gt=0.0, le=100.0)] = Field(default=1.0, description="factor of the squared strain")


AnyMaterial = YeohMaterial | OgdenMaterial | NeoHookeMaterial | GuccioneMaterial

# Of the modulus: a sphere under 1e-11 of it came out 26 % off, under 1e-8 within 1e-5.
SMALLEST_LOAD = 1e-6


def describe_material(material: AnyMaterial) -> str:
    """The law, its numbers and the initial shear modulus."""
    mu = f"initial shear modulus {1e3 * law_of(material).initial_shear_modulus_mpa:.4g} kPa"
    if isinstance(material, YeohMaterial):
        return f"Yeoh C = {', '.join(f'{c:g}' for c in material.c_kpa)} kPa ({mu})"
    if isinstance(material, OgdenMaterial):
        return f"Ogden mu = {material.mu_kpa:g} kPa, alpha = {material.alpha:g}, {material.convention} ({mu})"
    if isinstance(material, GuccioneMaterial):
        return f"Guccione C = {material.c_kpa:g} kPa, b = {material.b:g} ({mu})"
    return f"neo-Hooke ({mu})"


def law_of(material: AnyMaterial) -> Law:
    """The material law in MPa."""
    if isinstance(material, YeohMaterial):
        return Yeoh(tuple(1e-3 * c for c in material.c_kpa))
    if isinstance(material, OgdenMaterial):
        return Ogden(1e-3 * material.mu_kpa, material.alpha, material.convention)
    if isinstance(material, GuccioneMaterial):
        return Guccione(1e-3 * material.c_kpa, material.b)
    return NeoHooke(1e-3 * material.mu_kpa)


def inverse_kappa(material: AnyMaterial) -> float:
    """1/kappa in 1/MPa; 0 when incompressible."""
    return 1.0 / (material.kappa_over_mu * law_of(material).initial_shear_modulus_mpa)


def material_faults(material: AnyMaterial, highest_kpa: float, key: str) -> list[str]:
    """What is wrong with a law, or with a highest load beside it that suggests another unit."""
    faults = []
    if isinstance(material, OgdenMaterial) and 0.0 < abs(material.alpha) < LEAST_ALPHA:
        faults.append(
            f"material.alpha = {material.alpha:g}: must be at least {LEAST_ALPHA:g} in size, or the law loses digits"
        )
    try:
        law = law_of(material)
        modulus = 1e3 * law.initial_shear_modulus_mpa
        if highest_kpa > 10.0 * modulus:
            faults.append(
                f"{key} reaches {highest_kpa:g}: more than 10 times the initial shear modulus, "
                f"{modulus:g} kPa; check the units (kPa)"
            )
    except MaterialError as error:
        faults.append(f"material: {error}")
    return faults


def small_load_faults(material: AnyMaterial, loads_kpa: Sequence[float], key: str) -> list[str]:
    """Loads that are lost in the solver's residuals, which are measured by the modulus where a load is small."""
    try:
        modulus = 1e3 * law_of(material).initial_shear_modulus_mpa
    except MaterialError:
        return []  # told by `material_faults`
    small = [load for load in loads_kpa if 0.0 < abs(load) < SMALLEST_LOAD * modulus]
    if not small:
        return []
    return [
        f"{key} = {small[0]:g}: less than a millionth of the initial shear modulus, {modulus:g} kPa: such answers are "
        "lost in the solver's residuals; check the units (kPa), or ask for more, to which they are in proportion"
    ]
