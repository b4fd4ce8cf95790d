"""Waterfalls: from the closed form to the finite elements, cause by cause."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from studies.outline.split import CAUSES, OF_OUTLINE, Split
from studies.report.style import BELOW, BLACK, BLUE, GREEN, VERMILION, figure_file, grid

# Stretches of eq. (23); what else there is near the zigzag; what the outline as moulded adds.
_COLOURS: Final[Mapping[str, str]] = {
    **dict.fromkeys(("root", "hoop", "wall"), VERMILION),
    **dict.fromkeys(("pitch", "bends", "middle", "ends", "cap"), GREEN),
    **dict.fromkeys(OF_OUTLINE, BLUE),
}


def draw_waterfalls(path: Path, splits: Sequence[Split]) -> None:
    """Draw an actuator's gap at each pressure: bars from the closed form's elongation to that of the finite elements.

    Parameters
    ----------
    path
        The PNG to write.
    splits
        Of one actuator, by pressure.
    """
    whisker = {"color": BLACK, "linewidth": 0.8, "capsize": 2.5, "linestyle": "none"}
    with figure_file(path, 9.2, 7.0) as figure:
        for axes, found in zip(figure.subplots(2, 2).flat, splits, strict=True):
            height = found.closed_form_mm
            axes.bar(0, height, color="#bbbbbb", label="0  closed form")
            for place, (name, cause) in enumerate(found.causes.items(), 1):
                axes.bar(place, cause.value, bottom=height, color=_COLOURS[name], label=f"{place}  {CAUSES[name]}")
                axes.plot([place - 1.4, place + 0.4], [height, height], color=BLACK, linewidth=0.6)
                height += cause.value
                axes.errorbar(place, height, cause.band, **whisker)
            last = len(found.causes) + 1
            axes.bar(last, found.elements_mm, color="#555555", label=f"{last}  finite elements, as moulded")
            axes.errorbar(last, found.elements_mm, found.uncertainty_mm, **whisker)
            axes.set_title(f"{found.pressure_kpa:g} kPa{', held' if found.held else ''}", fontsize=10)
            axes.set_xticks(range(last + 1))
            axes.set_ylabel("elongation, mm")
            grid(axes)
        handles, labels = axes.get_legend_handles_labels()
        figure.legend(handles, labels, ncols=2, fontsize=8, **BELOW)
