"""The material laws in the closed-form study: constants, stress curves, limits of stability."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytical.arrays import FloatArray
from analytical.bellows import paper
from analytical.bellows.chains_by_name import STRETCH_AT_BREAK
from analytical.exact.homogeneous import MODES, Mode, nominal_stress_mpa, stress_curves
from analytical.laws.errors import MaterialError
from analytical.laws.isotropic import Ogden, Yeoh
from analytical.laws.silicones import DRAGON_SKIN_10, SILICONE_DENSITY_G_CM3, dragon_skin_30
from analytical.laws.stability import check_stability
from analytical.laws.stiff import PLA, POLYETHYLENE
from studies.report.tables import Table, table_of
from studies.results.rows import Row, row


@dataclass(frozen=True)
class Silicone:
    """A silicone's law, the largest stretch it is used to, and where its constants come from."""

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
    columns: dict[str, Callable[[Silicone], str]] = {
        "silicone": lambda s: s.label,
        "constants": lambda s: law_text(s.law),
        "initial shear modulus, kPa": lambda s: f"{1e3 * s.law.initial_shear_modulus_mpa:.2f}",
        "initial Young's modulus, kPa": lambda s: f"{3e3 * s.law.initial_shear_modulus_mpa:.1f}",
        # the 100 % modulus of data sheets
        "nominal stress at 100 % elongation, kPa": lambda s: f"{_stress_kpa(s, 'uniaxial', 2.0):.0f}",
        "elongation at break (printed), %": lambda s: f"{100.0 * (s.stretch_max - 1.0):g}",
        "source of the constants": lambda s: s.source,
    }
    return table_of(SILICONES, columns, left=(0, 1, 6))


def others_table() -> Table:
    """Constants of the rings and the silicone's density."""
    solids = (("PLA", PLA, "ours, not printed"), ("polyethylene", POLYETHYLENE, "assumed, not printed"))
    lines = [
        (name, f"{solid.young_mpa:g}", f"{solid.poisson:g}", f"{solid.mu_mpa:.0f}", f"{solid.density_g_cm3:g}", source)
        for name, solid, source in solids
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
    columns: dict[str, Callable[[Silicone], str]] = {
        "law": lambda s: s.label,
        "constants": lambda s: law_text(s.law),
        "tested up to stretch": lambda s: f"{s.stretch_max:g}",
        "result": _stability,
    }
    return table_of((*SILICONES, REFUSED), columns, left=(0, 1, 3))


def _stability(silicone: Silicone) -> str:
    try:
        check_stability(silicone.law, silicone.stretch_max)
    except MaterialError as refused:
        return f"refused: {refused}"
    return "stable in all three tests"


def curves_kpa() -> dict[str, dict[str, FloatArray]]:
    """Nominal stress (kPa) at `STRETCHES` by test, then by silicone."""
    curves = {s.label: stress_curves(s.law, STRETCHES) for s in SILICONES}
    return {mode: {label: 1e3 * found.nominal_mpa[mode] for label, found in curves.items()} for mode in MODES}


def material_rows() -> list[Row]:
    """Initial shear moduli and nominal stresses (kPa) of the silicones."""

    def entry(name: str, quantity: str, value: float, level: str = "", source: str = "") -> Row:
        return row(name, quantity, "kPa", np.nan, "material", value, level, source=source)

    rows = []
    for s in SILICONES:
        modulus = 1e3 * s.law.initial_shear_modulus_mpa
        rows.append(entry(s.label, "initial_shear_modulus_kpa", modulus, source=paper.SOURCE))
        rows += [
            entry(s.label, "nominal_stress_kpa", _stress_kpa(s, mode, stretch), f"{mode}, {stretch:g}")
            for mode in MODES
            for stretch in _ROW_STRETCHES
        ]
    return rows


def _stress_kpa(silicone: Silicone, mode: Mode, stretch: float) -> float:
    return 1e3 * float(nominal_stress_mpa(silicone.law, mode, stretch))
