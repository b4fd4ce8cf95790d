"""Material laws in scenes: their numbers in kPa, what is wrong with them, and the laws in MPa."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from analytical.laws.errors import MaterialError
from analytical.laws.isotropic import MOST_TERMS, Guccione, Law, NeoHooke, Ogden, OgdenSeries, Yeoh
from analytical.laws.of_invariants import ArrudaBoyce, Gent, MooneyRivlin
from studies.scene.sections import ONE, ONE_OR_SEVERAL, SEVERAL, Modulus, Section

Exponent = Annotated[float, Field(ge=-20.0, le=20.0, allow_inf_nan=False)]
SignedModulus = Annotated[float, Field(ge=-1e5, le=1e5, allow_inf_nan=False)]
SignedModuli = Annotated[list[SignedModulus], Field(min_length=1, max_length=MOST_TERMS)]
Exponents = Annotated[list[Exponent], Field(min_length=1, max_length=MOST_TERMS)]
# Below this size of the exponent the finite elements' form of the Ogden law has an error of stress above 1e-6.
LEAST_ALPHA = 0.05


class Material(Section):
    """What every law has beside its constants.

    ``data_to_stretch``: up to which stretch the data went that the law was fitted to; results beyond carry a warning.
    """

    also: ClassVar[Mapping[str, str]] = {
        "preset": "name of a silicone in place of law and constants: `bellowsx material list`",
        "data": "CSV of tensile tests that law and constants are fitted to: `bellowsx material fit`",
    }

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
    c_kpa: Annotated[list[float], Field(min_length=1, max_length=MOST_TERMS)] = Field(description="C_1, C_2, C_3, …")


class OgdenMaterial(Material):
    """One Ogden term or several; the convention says what mu is (initial shear modulus mu, or mu alpha / 2).

    In "mu/alpha" a negative alpha goes with a negative mu. Of several terms mu_kpa and alpha are lists, of any signs;
    what must be positive is the initial shear modulus, the sum of theirs.
    """

    law: Literal["ogden"]
    mu_kpa: Annotated[Annotated[SignedModulus, ONE] | Annotated[SignedModuli, SEVERAL], ONE_OR_SEVERAL] = Field(
        description="mu, or a list of as many as there are terms; what it is the convention says"
    )
    alpha: Annotated[Annotated[Exponent, ONE] | Annotated[Exponents, SEVERAL], ONE_OR_SEVERAL] = Field(
        description="exponent of the principal stretches, or a list"
    )
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


class MooneyRivlinMaterial(Material):
    """W = C10 x + C01 y + C11 x y + C20 x² + C02 y², x = I1 - 3, y = I2 - 3; initial shear modulus 2 (C10 + C01)."""

    law: Literal["mooney-rivlin"]
    c_kpa: Annotated[list[SignedModulus], Field(min_length=2, max_length=5)] = Field(
        description="C10, C01; or C10, C01, C11; or C10, C01, C11, C20, C02"
    )


class GentMaterial(Material):
    """W = -mu J/2 ln(1 - (I1 - 3)/J), J the limit; initial shear modulus mu."""

    law: Literal["gent"]
    mu_kpa: Modulus = Field(description="initial shear modulus")
    limit: Annotated[float, Field(gt=0.0, le=1e6)] = Field(
        description="J, largest I1 - 3, where chains are at their end"
    )


class ArrudaBoyceMaterial(Material):
    """Five terms of the eight-chain model; initial shear modulus mu (1 + 3/(5 L²) + …), L the stretch limit."""

    law: Literal["arruda-boyce"]
    mu_kpa: Modulus = Field(description="mu, a little less than the initial shear modulus")
    stretch_limit: Annotated[float, Field(gt=1.0, le=1e3)] = Field(
        description="L, stretch at which chains are at their end"
    )


# What silicones are cast of, and with the law of a published problem.
Elastomer = Annotated[
    YeohMaterial | OgdenMaterial | NeoHookeMaterial | MooneyRivlinMaterial | GentMaterial | ArrudaBoyceMaterial,
    Field(discriminator="law"),
]
AnyMaterial = (
    YeohMaterial
    | OgdenMaterial
    | NeoHookeMaterial
    | MooneyRivlinMaterial
    | GentMaterial
    | ArrudaBoyceMaterial
    | GuccioneMaterial
)

# Of the modulus: a sphere under 1e-11 of it came out 26 % off, under 1e-8 within 1e-5.
SMALLEST_LOAD = 1e-6


def describe_material(material: AnyMaterial) -> str:
    """The law, its numbers and the initial shear modulus."""
    mu = f"initial shear modulus {1e3 * law_of(material).initial_shear_modulus_mpa:.4g} kPa"
    if isinstance(material, YeohMaterial):
        return f"Yeoh C = {', '.join(f'{c:g}' for c in material.c_kpa)} kPa ({mu})"
    if isinstance(material, OgdenMaterial):
        numbers = [", ".join(f"{n:g}" for n in _listed(of)) for of in (material.mu_kpa, material.alpha)]
        return f"Ogden mu = {numbers[0]} kPa, alpha = {numbers[1]}, {material.convention} ({mu})"
    if isinstance(material, GuccioneMaterial):
        return f"Guccione C = {material.c_kpa:g} kPa, b = {material.b:g} ({mu})"
    if isinstance(material, MooneyRivlinMaterial):
        return f"Mooney-Rivlin C = {', '.join(f'{c:g}' for c in material.c_kpa)} kPa ({mu})"
    if isinstance(material, GentMaterial):
        return f"Gent J = {material.limit:g} ({mu})"
    if isinstance(material, ArrudaBoyceMaterial):
        return f"Arruda-Boyce mu = {material.mu_kpa:g} kPa, stretch limit {material.stretch_limit:g} ({mu})"
    return f"neo-Hooke ({mu})"


def _listed(numbers: float | list[float]) -> list[float]:
    return numbers if isinstance(numbers, list) else [numbers]


def law_of(material: AnyMaterial) -> Law:
    """The material law in MPa."""
    if isinstance(material, YeohMaterial):
        return Yeoh(tuple(1e-3 * c for c in material.c_kpa))
    if isinstance(material, OgdenMaterial):
        mus, alphas = tuple(1e-3 * mu for mu in _listed(material.mu_kpa)), tuple(_listed(material.alpha))
        if len(mus) == len(alphas) == 1:
            return Ogden(mus[0], alphas[0], material.convention)
        return OgdenSeries(mus, alphas, material.convention)
    if isinstance(material, GuccioneMaterial):
        return Guccione(1e-3 * material.c_kpa, material.b)
    if isinstance(material, MooneyRivlinMaterial):
        return MooneyRivlin(tuple(1e-3 * c for c in material.c_kpa))
    if isinstance(material, GentMaterial):
        return Gent(1e-3 * material.mu_kpa, material.limit)
    if isinstance(material, ArrudaBoyceMaterial):
        return ArrudaBoyce(1e-3 * material.mu_kpa, material.stretch_limit)
    return NeoHooke(1e-3 * material.mu_kpa)


def inverse_kappa(material: AnyMaterial) -> float:
    """1/kappa in 1/MPa; 0 when incompressible."""
    return 1.0 / (material.kappa_over_mu * law_of(material).initial_shear_modulus_mpa)


def material_faults(material: AnyMaterial, highest_kpa: float, key: str) -> list[str]:
    """What is wrong with a law, or with a highest load beside it that suggests another unit."""
    faults = []
    for alpha in _listed(material.alpha) if isinstance(material, OgdenMaterial) else ():
        if 0.0 < abs(alpha) < LEAST_ALPHA:
            faults.append(
                f"material.alpha = {alpha:g}: must be at least {LEAST_ALPHA:g} in size, or the law loses digits"
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
