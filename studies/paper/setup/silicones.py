"""Constants of the two silicones, and which reading of Ogden's constants fits the maker's data sheet."""

from __future__ import annotations

from typing import Final

from analytical.bellows.chains_by_name import SILICONES
from analytical.exact.homogeneous import nominal_stress_mpa
from analytical.laws.isotropic import Law, Ogden, OgdenConvention, Yeoh
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from studies.report.tables import Table

# Dragon Skin 30, stress at 100 % elongation: 86 psi in the maker's technical bulletin (Smooth-On, Dragon Skin Series).
MAKERS_MODULUS_KPA: Final = 593.0
# Where the paper has each reading of Ogden's constants.
CONVENTIONS: Final[dict[OgdenConvention, str]] = {
    "2mu/alpha^2": "2μ/α², eq. (3): used here",
    "mu/alpha": "μ/α, eq. (20) and ANSYS's own",
}


def at_double_length_kpa(law: Law) -> float:
    """Nominal stress of a strip pulled to twice its length, kPa: what makers call the 100 % modulus."""
    return 1e3 * float(nominal_stress_mpa(law, "uniaxial", 2.0))


def silicones() -> Table:
    """Law, constants, initial shear modulus and stress at twice the length of both silicones, kPa."""
    named: list[tuple[str, Law, str]] = [(SILICONES["dragon-skin-10"], DRAGON_SKIN_10, "–")]
    named += [(SILICONES["dragon-skin-30"], dragon_skin_30(of), where) for of, where in CONVENTIONS.items()]
    lines = []
    for name, law, convention in named:
        numbers = f"{1e3 * law.initial_shear_modulus_mpa:.4g}", f"{at_double_length_kpa(law):.0f}"
        lines.append((name, _constants(law), convention, *numbers))
    header = ("silicone", "law and constants (printed)", "convention", "initial shear modulus, kPa")
    return Table((*header, "stress at twice the length, kPa"), tuple(lines), left=(0, 1, 2))


def _constants(law: Law) -> str:
    if isinstance(law, Yeoh):
        return f"Yeoh, C = {', '.join(f'{1e3 * c:g}' for c in law.c_mpa)} kPa"
    assert isinstance(law, Ogden)
    return f"Ogden, one term, μ = {1e3 * law.mu_mpa:g} kPa, α = {law.alpha:g}"


def makers_modulus() -> str:
    """Which reading of Ogden's constants is nearer to the maker's number."""
    stress = {of: at_double_length_kpa(dragon_skin_30(of)) for of in CONVENTIONS}
    near, far = sorted(CONVENTIONS, key=lambda of: abs(stress[of] - MAKERS_MODULUS_KPA))
    ratios = {of: stress[of] / MAKERS_MODULUS_KPA for of in CONVENTIONS}
    labels = {of: where.partition(",")[0] for of, where in CONVENTIONS.items()}
    return (
        f"For Dragon Skin 30 the maker gives {MAKERS_MODULUS_KPA:g} kPa at twice the length (data sheet, Smooth-On). "
        f"Read as {labels[near]} the constants give {stress[near]:.0f} kPa, {ratios[near]:.2f} times as much; read as "
        f"{labels[far]} {stress[far]:.0f} kPa, {ratios[far]:.2f} times as much. The maker's number supports "
        f"{labels[near]}."
    )
