"""What the closed form assumes beside what the states show."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from studies.paper.plots.layout import ACTUATORS, TITLE, WIDTH_IN
from studies.paper.plots.paths import by_base, from_rest, name_of, requested_kpa, series_of
from studies.paper.results import PaperResults
from studies.report.curves import set_pressure_axis
from studies.report.style import BELOW, BLACK, entry, figure_file, white_edged

_MEASURED: Final[dict[str, str]] = {
    "root_stretch_outer": "root: hoop stretch, outside",
    "wall_stretch": "side wall: stretch along it",
    "ring_hoop_stretch": "under the rings: hoop stretch",
}


def draw_assumptions(path: Path, results: PaperResults) -> str:
    """Draw stretches the closed form assumes beside those measured in axisymmetric states, over pressure (kPa)."""
    cases = by_base(results.of("core"))
    known = {base: case for base, case in cases.items() if any(row.quantity in _MEASURED for row in case.rows)}
    if not known:
        return "nothing has been measured in the states of the reference actuators"
    with figure_file(path, WIDTH_IN, 3.9) as figure:
        columns = figure.subplots(1, len(_MEASURED))
        for axes, (quantity, title) in zip(columns, _MEASURED.items(), strict=True):
            for base, case in known.items():
                style = ACTUATORS[base]
                chain = series_of(case.rows, quantity, "closed_form")
                if chain:
                    points = from_rest([(row.pressure_kpa, row.value) for row in chain], 1.0)
                    axes.plot(*zip(*points, strict=True), color=style["color"], linestyle="--", linewidth=1.5)
                found = series_of(case.rows, quantity, "axisymmetric")
                look = white_edged(**style, linestyle="none")
                axes.plot([r.pressure_kpa for r in found], [r.value for r in found], **look)
            axes.axhline(1.0, color=BLACK, linewidth=0.8, zorder=1.0)
            axes.set_title(title, fontsize=TITLE)
            axes.set_xlabel("cavity pressure, kPa")
            set_pressure_axis(axes, requested_kpa(known.values()))
        columns[0].set_ylabel("stretch")
        marker: dict[str, Any] = {"linestyle": "none"}
        entries = [
            entry(label=name_of(case.result.scene), **marker, **white_edged(**ACTUATORS[base]))
            for base, case in known.items()
        ]
        grey: dict[str, Any] = {"color": "#555555"}
        entries.append(entry(label="closed form", linestyle="--", linewidth=1.5, **grey))
        entries.append(entry(label="axisymmetric", **marker, **white_edged(marker="o", **grey)))
        figure.legend(handles=entries, ncols=3, **BELOW)
    return ""
