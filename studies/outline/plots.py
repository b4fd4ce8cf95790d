"""Waterfalls: from the closed form to the finite elements, cause by cause."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from studies.outline.split import CAUSES, Split
from studies.report.style import BELOW, BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, figure_file, grid

_COLOURS = dict(zip(CAUSES, (ORANGE, VERMILION, PURPLE, GREEN, SKY, BLUE), strict=True))


def draw_waterfalls(path: Path, splits: Sequence[Split]) -> None:
    """Draw an actuator's gap at each pressure: bars from the closed form's elongation to that of the finite elements.

    Parameters
    ----------
    path
        The PNG to write.
    splits
        Of one actuator, by pressure.
    """
    with figure_file(path, 9.2, 3.6) as figure:
        places = figure.subplots(1, len(splits), squeeze=False)[0]
        for axes, found in zip(places, splits, strict=True):
            height = found.closed_form_mm
            axes.bar(0, height, color="#bbbbbb", label="closed form")
            for place, (cause, value) in enumerate(reversed(list(found.causes_mm.items())), 1):
                axes.bar(place, value, bottom=height, color=_COLOURS[cause], label=CAUSES[cause])
                axes.plot([place - 1.4, place + 0.4], [height, height], color=BLACK, linewidth=0.6)
                height += value
            axes.bar(len(CAUSES) + 1, found.elements_mm, color="#555555", label="finite elements, as moulded")
            axes.set_title(f"{found.pressure_kpa:g} kPa{', held' if found.held else ''}", fontsize=10)
            axes.set_xticks([])
            grid(axes)
        places[0].set_ylabel("elongation, mm")
        handles, labels = places[0].get_legend_handles_labels()
        figure.legend(handles, labels, ncols=3, fontsize=8, **BELOW)
