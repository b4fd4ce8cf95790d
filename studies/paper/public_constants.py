"""What the printed constants mean: stresses beside public tensile data, and actuators with the laws of those data."""

from __future__ import annotations

from typing import Final

import numpy as np

from analytical.bellows.chains_by_name import SILICONES
from analytical.bellows.paper import Silicone as SiliconeName
from analytical.exact.homogeneous import nominal_stress_mpa
from analytical.laws.isotropic import Law, Yeoh
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from studies.paper.cases import HIGHEST_KPA, PRESSURES_KPA, REFERENCE, THICK, THIN
from studies.paper.results import PaperResults, is_known
from studies.paper.setup.sizes import called
from studies.report.numbers import MISSING, value_text
from studies.report.tables import Table
from studies.results.provenance import ROOT
from studies.results.rows import Row
from studies.scene.materials import law_of
from studies.scene.silicones.presets import preset_material, presets
from studies.scene.silicones.tensile import read_tests

STRETCHES: Final = (1.25, 1.5, 2.0, 3.0, 4.0)
# Constants of a public toolbox: SorotokiCode, +preset/+material/Dragonskin10.m and Dragonskin30.m, MPa.
TOOLBOX: Final[dict[SiliconeName, Yeoh]] = {
    "dragon-skin-10": Yeoh((0.036, 0.00025, 0.000023)),
    "dragon-skin-30": Yeoh((0.1536, 0.0016)),
}
PRINTED: Final[dict[SiliconeName, dict[str, Law]]] = {
    "dragon-skin-10": {"printed, Yeoh 36, 2.5, 0.23 kPa": DRAGON_SKIN_10},
    "dragon-skin-30": {
        "printed, Ogden as 2μ/α²": dragon_skin_30("2mu/alpha^2"),
        "printed, Ogden as μ/α": dragon_skin_30("mu/alpha"),
    },
}


def stresses() -> Table:
    """Nominal uniaxial stress over stretch, kPa: measured, fitted, printed, and of a public toolbox."""
    lines = []
    for name, printed in PRINTED.items():
        one = presets()[name]
        (test,) = read_tests(ROOT / one.data)
        measured = [1e3 * float(np.interp(stretch, test.stretch, test.nominal_mpa)) for stretch in STRETCHES]
        lines.append((SILICONES[name], "public tensile test", *(f"{stress:.0f}" for stress in measured)))
        laws = {f"fitted to it (preset {name})": law_of(preset_material(one)), **printed}
        laws[f"a public toolbox, Yeoh {', '.join(f'{1e3 * c:g}' for c in TOOLBOX[name].c_mpa)} kPa"] = TOOLBOX[name]
        for label, law in laws.items():
            found = 1e3 * nominal_stress_mpa(law, "uniaxial", np.array(STRETCHES))
            lines.append((SILICONES[name], label, *(f"{stress:.0f}" for stress in found)))
    header = ("silicone", "constants", *(f"stretch {stretch:g}, kPa" for stretch in STRETCHES))
    return Table(header, tuple(lines), left=(0, 1))


def ratios() -> str:
    """How many times the public test's stress the printed constants make."""
    told = []
    for name, printed in PRINTED.items():
        (test,) = read_tests(ROOT / presets()[name].data)
        measured = np.interp(STRETCHES, test.stretch, test.nominal_mpa)
        for label, law in printed.items():
            times = nominal_stress_mpa(law, "uniaxial", np.array(STRETCHES)) / measured
            told.append(f"{SILICONES[name]}, {label}: {', '.join(f'{ratio:.2g}' for ratio in times)} times")
    at = ", ".join(f"{stretch:g}" for stretch in STRETCHES)
    return f"At stretches {at} the printed constants make of the public test's stress: {'; '.join(told)}."


def elongations(results: PaperResults) -> Table:
    """Axisymmetric elongation, mm, with the printed constants and with those of public data, by pressure."""
    lines = []
    for actuator in REFERENCE:
        own, public = results.named(actuator.name), results.variant(actuator.name, "public")
        for case, label in ((own, "printed"), (public, "public data")):
            values = (value_text(case.tip(pressure_kpa=pressure)) for pressure in PRESSURES_KPA)
            lines.append((called(actuator), label, *values, value_text(own.tip("paper_experiment"))))
    header = ("actuator", "constants", *(f"{pressure:g} kPa, mm" for pressure in PRESSURES_KPA))
    return Table((*header, f"paper: experiment, {HIGHEST_KPA:g} kPa, mm"), tuple(lines), left=(0, 1))


def in_words(results: PaperResults) -> str:
    """How far elongations at the highest pressure are from the paper's test, with either constants."""
    told = []
    for names, wall in ((THICK, 2), (THIN, 1)):
        printed = [_off(results.named(name).tip(), results.named(name).tip("paper_experiment")) for name in names]
        public = [
            _off(results.variant(name, "public").tip(), results.named(name).tip("paper_experiment")) for name in names
        ]
        told.append(
            f"{wall} mm walls at {HIGHEST_KPA:g} kPa against the paper's test: {_both(printed)} with the "
            f"printed constants, {_both(public)} with those of public data."
        )
    return " ".join(told)


def _both(told: list[str]) -> str:
    return f"both {told[0]}" if len(set(told)) == 1 else " and ".join(told)


def _off(row: Row, test: Row) -> str:
    """Relative difference, or that the row's pressure was not reached."""
    if not is_known(row):
        return "not reached"
    return MISSING if not is_known(test) else f"{100.0 * (row.value / test.value - 1.0):+.0f} %".replace("-", "−")
