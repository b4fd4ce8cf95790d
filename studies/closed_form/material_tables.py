"""Tables and rows of the material laws in the closed-form study: constants, stress curves, limits of stability."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from analytical.arrays import FloatArray
from analytical.bellows import paper
from analytical.exact.homogeneous import MODES, nominal_stress_mpa, stress_curves
from analytical.laws.errors import MaterialError
from analytical.laws.isotropic import Ogden, Yeoh
from analytical.laws.silicones import DRAGON_SKIN_10, SILICONE_DENSITY_G_CM3, dragon_skin_30
from analytical.laws.stability import check_stability
from analytical.laws.stiff import PLA, POLYETHYLENE
from studies.closed_form.tables import STRETCH_AT_BREAK
from studies.report.tables import Table
from studies.results.rows import Row, row


@dataclass(frozen=True)
class Silicone:
    """A silicone's law, the largest stretch asked of it, and where its constants come from."""

    label: str
    law: Yeoh | Ogden
    stretch_max: float
    source: str


_PRINTED: Final = "printed, section 3 of the paper"
SILICONES: Final = (
    Silicone("Dragon Skin 10", DRAGON_SKIN_10, STRETCH_AT_BREAK["dragon-skin-10"], _PRINTED),
    Silicone(
        "Dragon Skin 30, 2μ/α²",
        dragon_skin_30("2mu/alpha^2"),
        STRETCH_AT_BREAK["dragon-skin-30"],
        f"{_PRINTED}; convention of eq. (3), ours",
    ),
    Silicone(
        "Dragon Skin 30, μ/α",
        dragon_skin_30("mu/alpha"),
        STRETCH_AT_BREAK["dragon-skin-30"],
        f"{_PRINTED}; convention of eq. (20) and of ANSYS",
    ),
)
# Its dW/dI1 is positive everywhere, and it softens all the same: the example that is refused.
REFUSED: Final = Silicone("example", Yeoh(c_mpa=(0.036, -0.003, 0.0001)), 4.0, "made up")

# Stretches of the plot and, below, of the rows.
STRETCHES: Final = np.linspace(1.01, 4.0, 300)
_ROW_STRETCHES: Final = (1.5, 2.0, 3.0, 4.0)


def constants_table() -> Table:
    """Constants of the silicones with their source and what follows from them."""
    lines = tuple(
        (
            one.label,
            law_text(one.law),
            f"{1e3 * one.law.initial_shear_modulus_mpa:.2f}",
            f"{3e3 * one.law.initial_shear_modulus_mpa:.1f}",
            # the 100 % modulus of data sheets: nominal stress at twice the length
            f"{1e3 * float(nominal_stress_mpa(one.law, 'uniaxial', 2.0)):.0f}",
            f"{100.0 * (one.stretch_max - 1.0):g}",
            one.source,
        )
        for one in SILICONES
    )
    moduli = ("initial shear modulus, kPa", "initial Young's modulus, kPa", "nominal stress at 100 % elongation, kPa")
    header = ("silicone", "constants", *moduli, "elongation at break (printed), %", "source of the constants")
    return Table(header, lines, left=(0, 1, 6))


def others_table() -> Table:
    """Constants of the rings and the silicone's density."""
    rings = ((name, solid) for name, solid in (("PLA", PLA), ("polyethylene", POLYETHYLENE)))
    lines = [
        (name, f"{solid.young_mpa:g}", f"{solid.poisson:g}", f"{solid.mu_mpa:.0f}", f"{solid.density_g_cm3:g}", source)
        for (name, solid), source in zip(rings, ("ours, not printed", "assumed, not printed"), strict=True)
    ]
    lines.append(("silicone", "", "", "", f"{SILICONE_DENSITY_G_CM3:g}", "ours, not printed"))
    header = ("material", "Young's modulus, MPa", "Poisson's ratio", "shear modulus, MPa", "density, g/cm³", "source")
    return Table(header, tuple(lines), left=(0, 5))


def law_text(law: Yeoh | Ogden) -> str:
    """A law and its constants in kPa, in words."""
    if isinstance(law, Yeoh):
        names = (f"C{place} = {1e3 * value:g}" for place, value in enumerate(law.c_mpa, start=1))
        return f"Yeoh, {', '.join(names)} kPa"
    factor = {"2mu/alpha^2": "2μ/α²", "mu/alpha": "μ/α"}[law.convention]
    return f"Ogden, μ = {1e3 * law.mu_mpa:g} kPa, α = {law.alpha:g}, W = {factor} (Σλ^α - 3)"


def stability_table() -> Table:
    """Up to which stretch each law is stable in Hill's sense, and the example that is not."""
    lines = ((one.label, law_text(one.law), f"{one.stretch_max:g}", _stability(one)) for one in (*SILICONES, REFUSED))
    return Table(("law", "constants", "tested up to stretch", "result"), tuple(lines), left=(0, 1, 3))


def _stability(one: Silicone) -> str:
    try:
        check_stability(one.law, one.stretch_max)
    except MaterialError as refused:
        return f"refused: {refused}"
    return "stable in all three tests"


def curves_kpa() -> dict[str, dict[str, FloatArray]]:
    """Nominal stress (kPa) at `STRETCHES` by test, then by silicone."""
    curves = {one.label: stress_curves(one.law, STRETCHES) for one in SILICONES}
    return {mode: {label: 1e3 * found.nominal_mpa[mode] for label, found in curves.items()} for mode in MODES}


def rows() -> list[Row]:
    """Initial shear moduli and nominal stresses (kPa) of the silicones."""
    found = []
    for one in SILICONES:
        modulus = 1e3 * one.law.initial_shear_modulus_mpa
        found.append(
            row(one.label, "initial_shear_modulus_kpa", "kPa", np.nan, "material", modulus, source=paper.SOURCE)
        )
        for mode in MODES:
            for stretch in _ROW_STRETCHES:
                stress = 1e3 * float(nominal_stress_mpa(one.law, mode, stretch))
                found.append(
                    row(one.label, "nominal_stress_kpa", "kPa", np.nan, "material", stress, f"{mode}, {stretch:g}")
                )
    return found
