"""Picture of the drawn sets: every set's elongations beside the printed numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes

from studies.paper.drawing.panels import SMALL, TITLE, WIDTH_IN, legend_below
from studies.paper.results import PaperResults
from studies.paper.sets import CHOSEN_ALONE, SHOWN_KPA, Measure, chain_mm, elements_mm, known
from studies.paper.statements.judges import SLOTS
from studies.report.style import BLUE, GREEN, GREY, VERMILION, edge_of, entry, figure_file, grid, style_of

# Columns of dots, those of the finite elements before those of the closed form.
_STRIPS: Final[tuple[tuple[Measure, str], ...]] = (
    (elements_mm, "corrected"),
    (elements_mm, "balanced"),
    (elements_mm, CHOSEN_ALONE),
    (chain_mm, "corrected"),
    (chain_mm, "balanced"),
)
# Kinds of sets: what the legend says, colour and marker.
_LOOKS: Final = {
    "corrected": ("corrected chain's fit", BLUE, "o"),
    "balanced": ("balanced chain's fit", GREEN, "s"),
    CHOSEN_ALONE: ("reference, chosen ones drawn", GREY, "^"),
}
_PRINTED: Final = {"paper_closed_form": "--", "paper_ansys": ":", "paper_experiment": "-"}


def draw_sets(path: Path, results: PaperResults) -> str:
    """Draw elongations (mm) of all drawn sets at 20 and at 5 kPa, a panel per actuator; why not, or an empty text."""
    if not results.drawn(*_LOOKS):
        return "no drawn set has been run"
    with figure_file(path, WIDTH_IN, 7.4) as figure:
        panels = figure.subplots(len(SHOWN_KPA), len(SLOTS))
        for row, pressure in zip(panels, SHOWN_KPA, strict=True):
            for slot, axes in enumerate(row):
                _draw_strips(axes, results, slot, pressure)
            row[0].set_ylabel(f"elongation at {pressure:g} kPa, mm")
        for axes, label in zip(panels[0], SLOTS, strict=True):
            axes.set_title(label.replace("R_i", "$R_i$"), fontsize=TITLE)
        entries = [entry(text, linestyle="none", marker=m, color=colour) for text, colour, m in _LOOKS.values()]
        entries.append(entry("reference scene", **_star()))
        entries += [
            entry(f"paper: {name}", color=style_of(model)["color"], linestyle=_PRINTED[model])
            for model, name in zip(_PRINTED, ("closed form", "ANSYS", "test"), strict=True)
        ]
        legend_below(figure, entries)
    return ""


def _draw_strips(axes: Axes, results: PaperResults, slot: int, pressure_kpa: float) -> None:
    """Draw a column of dots per kind of sets, spread by their order so that few hide one another."""
    for place, (measure, kind) in enumerate(_STRIPS):
        _, colour, marker = _LOOKS[kind]
        values = known([measure(four, slot, pressure_kpa) for four in results.drawn(kind)])
        aside = place + np.linspace(-0.3, 0.3, max(len(values), 2))[: len(values)]
        axes.plot(aside, values, linestyle="none", marker=marker, color=colour, markersize=3.2, alpha=0.8)
    for place, measure in ((0, elements_mm), (3, chain_mm)):
        axes.plot([place], [measure(results.reference, slot, pressure_kpa)], **_star())
    for model, dash in _PRINTED.items():
        value = results.reference.cases[slot].tip(model, pressure_kpa).value
        axes.axhline(value, color=style_of(model)["color"], linestyle=dash, linewidth=1.3, zorder=1.5)
    axes.axvline(2.5, color=GREY, linewidth=0.6)
    axes.set_xticks([1.0, 3.5], ["finite\nelements", "closed\nform"], fontsize=SMALL)
    axes.set_xlim(-0.6, 4.6)
    axes.set_ylim(0.0, 1.05 * axes.get_ylim()[1])
    grid(axes, axis="y")


def _star() -> dict[str, Any]:
    return {
        "marker": "*",
        "markersize": 11.0,
        "linestyle": "none",
        "color": VERMILION,
        "markeredgecolor": edge_of("axisymmetric"),
        "zorder": 4.0,
    }
