"""The closed-form study: chains, corrections, inverse, validity, material laws, exact solutions, in one report."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np

from analytical.bellows.chains import ClosedFormPath
from analytical.bellows.paper import PRINTED_PRESSURE_KPA, PaperActuator, actuators
from studies.closed_form import material_tables, validity_maps
from studies.closed_form import tables as closed_form_tables
from studies.closed_form.plots import draw_maps, draw_stress_curves
from studies.closed_form.tables import CHAINS, CUTS, PRESSURES_KPA, SILICONES, path_of, printed_mm
from studies.report.curves import Curve, draw_elongation
from studies.report.labels import model_label
from studies.report.numbers import duration
from studies.report.pages import write_page
from studies.report.tables import Table, facts_table
from studies.results import provenance
from studies.results.rows import Row, write_rows
from studies.verification import two_routes as exact_table

TITLE: Final = "Closed form of the bellows actuator: three chains, and where they stop being valid"
# The plots go past the printed range, 20 kPa, to show what follows.
_PLOT_KPA: Final = np.linspace(0.0, 25.0, 251)
# What the numbers and pictures of this study depend on.
_VERSIONS: Final = ("python", "numpy", "scipy", "matplotlib")


def write_study(folder: Path) -> Path:
    """Write report.md, report.html, rows.csv and pictures/ of the closed-form study.

    Parameters
    ----------
    folder
        Where to; made if missing.

    Returns
    -------
    Path
        report.html.
    """
    begin = time.perf_counter()
    folder.mkdir(parents=True, exist_ok=True)
    four = actuators()
    pairs = (four[:2], four[2:])
    maps = [validity_maps.silicone_maps(silicone) for silicone in SILICONES]
    routes = exact_table.all_routes()
    write_rows(folder / "rows.csv", _rows(four, routes))
    draw_stress_curves(folder / "pictures/stress.png", material_tables.STRETCHES, material_tables.curves_kpa())
    content = {
        "title": TITLE,
        "summary": closed_form_tables.summary(four),
        "resting": closed_form_tables.resting_on_saturation(four),
        "actuators": [_actuator(folder, actuator) for actuator in four],
        "conventions": closed_form_tables.convention_table(four),
        "corrections": closed_form_tables.correction_table(),
        "effects": [closed_form_tables.effect_table(pair) for pair in pairs],
        "inverse": closed_form_tables.inverse_table(four),
        "held": closed_form_tables.held_table(four),
        "held_sizes": validity_maps.held_sizes(),
        "overall": validity_maps.overall(four),
        "changes": [validity_maps.effect_table(pair) for pair in pairs],
        "maps": [_map(folder, effect, maps, four) for effect in validity_maps.EFFECTS],
        "constants": material_tables.constants_table(),
        "other_constants": material_tables.others_table(),
        "stability": material_tables.stability_table(),
        "routes": exact_table.table(routes),
        "routes_goal": exact_table.GOAL,
        "routes_apart": [one for one in routes if one.difference > exact_table.GOAL],
        "routes_largest": max(one.difference for one in routes),
        "provenance": _provenance(),
        "wall": duration(time.perf_counter() - begin),
    }
    return write_page(folder, "closed_form.md.j2", content)


def _rows(four: Sequence[PaperActuator], routes: list[exact_table.TwoRoutes]) -> list[Row]:
    """All numbers of the study."""
    by_actuator = (
        closed_form_tables.chain_rows,
        closed_form_tables.correction_rows,
        closed_form_tables.load_rows,
        validity_maps.rows,
    )
    found = [entry for actuator in four for part in by_actuator for entry in part(actuator)]
    return [*found, *material_tables.rows(), *exact_table.rows(routes)]


def _actuator(folder: Path, actuator: PaperActuator) -> dict[str, Any]:
    """What the template shows of an actuator; draws its picture on the way."""
    picture = f"pictures/{actuator.name}.png"
    draw_elongation(folder / picture, _curves(actuator), (*PRESSURES_KPA, float(_PLOT_KPA[-1])))
    d = actuator.dimensions
    return {
        "name": actuator.name,
        "title": (
            f"t = {d.wall_mm:g} mm, R_i = {d.root_radius_mm:g} mm, R_p = {d.crest_radius_mm:g} mm, "
            f"e = {d.half_pitch_mm:g} mm, n = {d.convolutions}, {SILICONES[actuator.silicone]}"
        ),
        "reading": actuator.printed.reading,
        "chains": closed_form_tables.chain_table(actuator),
        "picture": picture,
        "unfolding": closed_form_tables.unfolding(actuator),
        "outputs": closed_form_tables.output_table(actuator),
        "warnings": closed_form_tables.warnings(actuator),
    }


def _curves(actuator: PaperActuator) -> list[Curve]:
    """The chains' paths, the balanced chain's at its other cuts, and the printed points."""
    paths = {(model, model_label(model)): path_of(actuator, r, tuple(_PLOT_KPA)) for model, r in CHAINS.items()}
    paths |= {
        (f"cut_{cut}", f"balanced, cut at the {cut}"): path_of(actuator, reading, tuple(_PLOT_KPA))
        for cut, reading in CUTS.items()
        if cut != "mean"
    }
    curves = [_curve(model, label, path) for (model, label), path in paths.items()]
    for model, value in printed_mm(actuator).items():
        curves.append(Curve(model, model_label(model), (PRINTED_PRESSURE_KPA,), (value,)))
    return curves


def _curve(model: str, label: str, path: ClosedFormPath) -> Curve:
    """A path; a cross where the root reaches the crest, for the chains themselves."""
    real = np.isfinite(path.elongation_mm)
    pressures, tips = path.pressure_kpa[real], path.elongation_mm[real]
    unfolding = float(path.unfolding_pressure_kpa[0])
    marked = model in CHAINS and unfolding <= pressures[-1]
    return Curve(
        model=model,
        label=label,
        pressure_kpa=tuple(pressures),
        tip_mm=tuple(tips),
        markers=False,
        stopped=f"fully unfolded, {unfolding:.1f} kPa" if marked else "",
        stopped_at=(unfolding, float(np.interp(unfolding, pressures, tips))),
    )


def _map(
    folder: Path,
    effect: validity_maps.Effect,
    maps: Sequence[validity_maps.SiliconeMaps],
    four: Sequence[PaperActuator],
) -> dict[str, Any]:
    """What the template shows of an effect; draws its maps on the way."""
    picture = f"pictures/validity-{effect.name}.png"
    draw_maps(
        folder / picture,
        validity_maps.panels(effect, maps, four),
        f"{effect.title}: change of the elongation, % of that of the corrected chain",
    )
    return {
        "title": effect.title,
        "words": effect.words,
        "picture": picture,
        "sentences": validity_maps.sentences(effect, four, maps),
    }


def _provenance() -> Table:
    versions = {name: value for name, value in provenance.versions().items() if name in _VERSIONS}
    stamps = {"commit": provenance.commit(), "date": provenance.now(), "machine": provenance.machine(), **versions}
    return facts_table(stamps)
