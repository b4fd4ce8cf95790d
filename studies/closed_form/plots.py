"""Pictures of the closed-form study: chains over the pressure, maps of changes, stress of the silicones."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.text import Text

from analytical.arrays import FloatArray
from analytical.bellows.chains import ClosedFormPath
from analytical.bellows.chains_by_name import CHAINS, CUTS, PRESSURES_KPA, SILICONES, path_of, printed_mm
from analytical.bellows.paper import PRINTED_PRESSURE_KPA, PaperActuator
from studies.closed_form.effects import Effect
from studies.closed_form.maps import (
    CREST_OVER_ROOT,
    MAP_PRESSURES_KPA,
    SECTION,
    SWEEP_KPA,
    WALL_OVER_ROOT,
    SiliconeMaps,
    places,
)
from studies.report.curves import Curve, draw_elongation
from studies.report.labels import model_label
from studies.report.maps import (
    PERCENT_COLOURS,
    change_of_sign,
    colour_scale,
    mark_change_of_sign,
    percent_bands,
    percent_text,
)
from studies.report.panels import Panel, Series, draw_panels
from studies.report.style import ABOVE, BLUE, GREEN, HALO, VERMILION, figure_file

# Past the printed range, 20 kPa, to show what follows.
_PLOT_KPA: Final = tuple(np.linspace(0.0, 25.0, 251))
# Percent at which the colour changes.
_BOUNDS: Final = (-100.0, -50.0, -20.0, -10.0, -5.0, 5.0, 10.0, 20.0, 50.0, 100.0)
# Labels nearer than this would overlap, pixels.
_LABEL_ROOM: Final = 35.0
_NO_STATE: Final = "#bdbdbd"
_BESIDE: Final[dict[str, Any]] = {"textcoords": "offset points", "fontsize": 8, "path_effects": HALO}
_MATERIALS: Final[tuple[dict[str, Any], ...]] = (
    {"color": BLUE, "linestyle": "-", "linewidth": 1.8},
    {"color": GREEN, "linestyle": "--", "linewidth": 1.8},
    {"color": VERMILION, "linestyle": "-.", "linewidth": 1.8},
)


def draw_chains(path: Path, actuator: PaperActuator) -> None:
    """Draw an actuator's elongation by every chain, by the balanced one at its other cuts too, and as printed."""
    chains = [_curve(model, model_label(model), path_of(actuator, r, _PLOT_KPA)) for model, r in CHAINS.items()]
    cuts = [
        _curve(f"cut_{cut}", f"balanced, cut at the {cut}", path_of(actuator, reading, _PLOT_KPA))
        for cut, reading in CUTS.items()
        if cut != "mean"
    ]
    printed = [
        Curve(model, model_label(model), (PRINTED_PRESSURE_KPA,), (value,))
        for model, value in printed_mm(actuator).items()
    ]
    draw_elongation(path, [*chains, *cuts, *printed], (*PRESSURES_KPA, float(_PLOT_KPA[-1])))


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


def draw_maps(path: Path, effect: Effect, maps: Sequence[SiliconeMaps], actuators: Sequence[PaperActuator]) -> None:
    """Draw what an effect is worth: a row per silicone, the map at each pressure and the section over the pressure.

    Parameters
    ----------
    path
        The PNG to write.
    effect, maps
        Of what, over which designs.
    actuators
        Marked on the maps of their silicone.
    """
    width = len(MAP_PRESSURES_KPA) + 1
    with figure_file(path, 3.1 * width, 2.9 * len(maps) + 0.6) as figure:
        # room for the y labels, which the layout puts a little beyond the edge otherwise
        figure.set_layout_engine("constrained", w_pad=0.1)
        every = figure.subplots(len(maps), width, squeeze=False)
        for (*planes, section), one in zip(every, maps, strict=True):
            marks = places(one.silicone, actuators)
            _draw_planes(planes, effect, one, marks)
            lines = {name: wall for name, (wall, crest) in marks.items() if np.isclose(crest, SECTION)}
            drawn = _draw_section(section, effect, one, lines)
        label = f"{effect.title}: change of the elongation, % of that of the corrected chain"
        colour_scale(figure, drawn, every, label, _BOUNDS)
        figure.legend(handles=[change_of_sign("fully unfolded from here on")], loc="outside lower right", frameon=False)


def _draw_planes(
    planes: Sequence[Axes], effect: Effect, one: SiliconeMaps, marks: Mapping[str, tuple[float, float]]
) -> None:
    """Maps at each pressure, with dots for actuators."""
    percent = effect.percent(one.plane)
    for k, (axes, pressure) in enumerate(zip(planes, MAP_PRESSURES_KPA, strict=True)):
        unfolded = pressure - one.plane.unfolding_pressure_kpa[..., 0]
        _draw_change(axes, CREST_OVER_ROOT, percent[..., k], unfolded, marks.values())
        axes.set_title(f"{SILICONES[one.silicone]}, {pressure:g} kPa = {pressure / one.modulus_kpa:.3f} μ", fontsize=10)
        axes.set_ylabel("$R_p / R_i$")
        for label, place in marks.items():
            axes.plot(*place, marker="o", color="black", markeredgecolor="white", markersize=7, zorder=5)
            axes.annotate(label, place, xytext=(0, 7), ha="center", **_BESIDE)


def _draw_section(axes: Axes, effect: Effect, one: SiliconeMaps, lines: Mapping[str, float]) -> ScalarMappable:
    """The section over the pressure, with lines for actuators."""
    unfolded = SWEEP_KPA - one.section.unfolding_pressure_kpa
    drawn = _draw_change(axes, SWEEP_KPA / one.modulus_kpa, effect.percent(one.section), unfolded)
    axes.set_title(f"{SILICONES[one.silicone]}, $R_p / R_i$ = {SECTION:g}", fontsize=10)
    axes.set_ylabel("pressure / μ")
    for label, wall in lines.items():
        axes.axvline(wall, color="black", linewidth=1.2, linestyle=":")
        axes.annotate(
            label, (wall, 0.97), xycoords=("data", "axes fraction"), xytext=(3, 0), rotation=90, va="top", **_BESIDE
        )
    kpa = axes.secondary_yaxis("right", functions=(lambda y: one.modulus_kpa * y, lambda y: y / one.modulus_kpa))
    kpa.set_ylabel("pressure, kPa")
    return drawn


def _draw_change(
    axes: Axes, y: FloatArray, percent: FloatArray, unfolded: FloatArray, marks: Iterable[tuple[float, float]] = ()
) -> ScalarMappable:
    """A change over t / R_i and y, shape (walls, len(y)), and where the bellows is fully unfolded."""
    x, values = WALL_OVER_ROOT, np.ma.masked_invalid(percent.T)
    axes.set_facecolor(_NO_STATE)
    axes.set_xlabel("$t / R_i$")
    look: dict[str, Any] = {"cmap": PERCENT_COLOURS, "norm": percent_bands(_BOUNDS), "extend": "both"}
    drawn = axes.contourf(x, y, values, levels=_BOUNDS, **look)
    lines = axes.contour(x, y, values, levels=_BOUNDS, colors="black", linewidths=0.7)
    texts = axes.clabel(lines, inline=False, colors="black", fmt=percent_text, fontsize=7)
    _thin_out(axes, texts, marks)
    mark_change_of_sign(axes, x, y, unfolded.T)
    return drawn


def _thin_out(axes: Axes, texts: Sequence[Text], points: Iterable[tuple[float, float]]) -> None:
    """Hide contour labels too near to a marked point or to another label; halo round the others."""
    to_screen = axes.transData.transform
    taken = [to_screen(point) + (0.0, 0.5 * _LABEL_ROOM) for point in points]
    for text in texts:
        text.set_path_effects(HALO)
        place = to_screen(text.get_position())
        if any(np.hypot(*(place - other)) < _LABEL_ROOM for other in taken):
            text.set_visible(False)
        else:
            taken.append(place)


def draw_stress_curves(path: Path, stretch: FloatArray, nominal_kpa: Mapping[str, Mapping[str, FloatArray]]) -> None:
    """Draw nominal stress over stretch, a panel per test, on a logarithmic scale.

    Parameters
    ----------
    path
        The PNG to write.
    stretch
        Stretches, shape (n,).
    nominal_kpa
        By test, then by material: nominal stress, shape (n,), kPa.
    """
    panels: list[Panel] = []
    for test, materials in nominal_kpa.items():
        series = [Series(stretch, *of) for of in zip(materials.values(), _MATERIALS, materials, strict=True)]
        label = "" if panels else "nominal stress, kPa"
        panels.append(Panel(series, "stretch", label, test, logarithmic="y"))
    draw_panels(path, [panels], (9.3, 4.0), {**ABOVE, "ncols": 3}, sharey=True)
