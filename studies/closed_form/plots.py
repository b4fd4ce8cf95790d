"""Pictures of the closed-form study: chains over the pressure, maps of changes, stress of the silicones."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.text import Text

from analytical.arrays import FloatArray
from analytical.bellows.chains import ClosedFormPath
from analytical.bellows.paper import PRINTED_PRESSURE_KPA, PaperActuator
from studies.closed_form.chains import CHAINS, CUTS, PRESSURES_KPA, path_of, printed_mm
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


@dataclass(frozen=True, eq=False)
class MapPanel:
    """A map of a change in percent.

    Attributes
    ----------
    title, x_label, y_label
        Texts.
    x, y
        Coordinates, shapes (m,) and (k,).
    percent
        What is drawn, shape (k, m); NaN is grey.
    unfolded
        Positive where the bellows is fully unfolded, negative where it is folded; shape (k, m).
    points
        Places (x, y) to mark, by label.
    lines
        Values of x to mark, by label.
    right_axis
        Factor and label of a second y axis on the right; None for none.
    """

    title: str
    x_label: str
    y_label: str
    x: FloatArray
    y: FloatArray
    percent: FloatArray
    unfolded: FloatArray
    points: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    lines: Mapping[str, float] = field(default_factory=dict)
    right_axis: tuple[float, str] | None = None


def draw_maps(path: Path, panels: Sequence[Sequence[MapPanel]], label: str) -> None:
    """Draw rows of maps with contour lines and one scale of colours in percent.

    Parameters
    ----------
    path
        The PNG to write.
    panels
        Rows of equal length.
    label
        What the colours mean, with its unit.
    """
    width = len(panels[0])
    with figure_file(path, 3.1 * width, 2.9 * len(panels) + 0.6) as figure:
        # room for the y labels, which the layout puts a little beyond the edge otherwise
        figure.set_layout_engine("constrained", w_pad=0.1)
        places = figure.subplots(len(panels), width, squeeze=False)
        for axes, panel in zip(places.ravel(), itertools.chain(*panels), strict=True):
            drawn = _draw_map(axes, panel)
        colour_scale(figure, drawn, places, label, _BOUNDS)
        figure.legend(handles=[change_of_sign("fully unfolded from here on")], loc="outside lower right", frameon=False)


def _draw_map(axes: Axes, panel: MapPanel) -> ScalarMappable:
    axes.set_facecolor(_NO_STATE)
    percent, look = np.ma.masked_invalid(panel.percent), {"cmap": PERCENT_COLOURS, "norm": percent_bands(_BOUNDS)}
    drawn = axes.contourf(panel.x, panel.y, percent, levels=_BOUNDS, extend="both", **look)
    lines = axes.contour(panel.x, panel.y, percent, levels=_BOUNDS, colors="black", linewidths=0.7)
    texts = axes.clabel(lines, inline=False, colors="black", fmt=percent_text, fontsize=7)
    _thin_out(axes, texts, panel.points.values())
    mark_change_of_sign(axes, panel.x, panel.y, panel.unfolded)
    beside: dict[str, Any] = {"textcoords": "offset points", "fontsize": 8, "path_effects": HALO}
    upright: dict[str, Any] = {"xycoords": ("data", "axes fraction"), "rotation": 90, "va": "top"}
    for label, place in panel.points.items():
        axes.plot(*place, marker="o", color="black", markeredgecolor="white", markersize=7, zorder=5)
        axes.annotate(label, place, xytext=(0, 7), ha="center", **beside)
    for label, x in panel.lines.items():
        axes.axvline(x, color="black", linewidth=1.2, linestyle=":")
        axes.annotate(label, (x, 0.97), xytext=(3, 0), **upright, **beside)
    axes.set(xlabel=panel.x_label, ylabel=panel.y_label)
    axes.set_title(panel.title, fontsize=10)
    if panel.right_axis is not None:
        factor, text = panel.right_axis
        right = axes.secondary_yaxis("right", functions=(lambda y: factor * y, lambda y: y / factor))
        right.set_ylabel(text)
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
