"""The plot of blocked tips: force over pressure, told apart by whether the straight actuator is stable."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from matplotlib.axes import Axes

from analytical.bellows.loads import held_tip
from studies.paper.blocked import first_touch, sideways
from studies.paper.cases import REFERENCE_SCENES
from studies.paper.drawing.lines import (
    UNNAMED,
    Points,
    chain_curves,
    chain_pressures,
    curve,
    ending_of,
    from_rest,
    requested_curve,
    smooth,
)
from studies.paper.drawing.panels import ROWS_DIFFER, SMALL, WIDTH_IN, by_base, draw_actuators, legend_below
from studies.paper.results import CaseResult, PaperResults
from studies.report.curves import Curve
from studies.report.style import GREY, entry, figure_file, style_of
from studies.results.rows import REACHED
from studies.scene.bellows import dimensions_of
from studies.scene.materials import law_of

LABELS: Final = {
    "-": "axisymmetric, stable",
    "--": "axisymmetric, beyond its first sideways mode: guided actuators only",
    ":": "axisymmetric, sideways modes not counted",
}
_TOUCH: Final[dict[str, Any]] = {"marker": "o", "markerfacecolor": "none", "markersize": 11.0, "markeredgewidth": 1.6}


def draw_blocked(path: Path, results: PaperResults) -> str:
    """Draw the force (N) of the blocked tip over pressure (kPa), a panel per reference actuator."""
    cases = by_base(results.of("blocked"))
    if not cases:
        return "no actuator with a blocked tip has been run"

    def curves(base: str) -> list[Curve]:
        case = cases[base]
        return [*chain_curves(case, "closed_form"), _thrust(case), *_blocked_curves(case)]

    with figure_file(path, WIDTH_IN, 7.2) as figure:
        axes, entries = draw_actuators(figure, "force at the blocked tip, N", REFERENCE_SCENES, cases, curves)
        touching = [_mark(panel, cases[base]) for base, panel in axes.items()]
        if any(touching):
            look = {**_TOUCH, "color": style_of("axisymmetric")["color"], "linestyle": "none"}
            entries.append(entry("first state in contact", **look))
        legend_below(figure, entries, columns=2, title=ROWS_DIFFER)
    return ""


def _thrust(case: CaseResult) -> Curve:
    """Thrust of the pressure on the crest's area, by the closed form."""
    pressures = chain_pressures(case)
    forces = held_tip(dimensions_of(case.scene), law_of(case.scene.material), pressures).extension_force_n
    points = from_rest(zip(pressures.tolist(), forces.tolist(), strict=True))
    return curve("closed_form", "thrust of the pressure alone", points, {"color": GREY, "linestyle": ":"})


def _blocked_curves(case: CaseResult) -> list[Curve]:
    """Force of the finest path, dashed from the first sideways mode on, and dots at the requested pressures."""
    if not case.axisymmetric:
        return []
    run, bends = case.axisymmetric[-1], sideways(case)
    points = smooth(from_rest((state.pressure_kpa, state.tip_force_n) for state in run.path))
    parts: dict[str, Points] = {"-" if case.modes_counted else ":": points}
    if bends:
        at = bends.pressure_kpa
        turn = (at, bends.tip_force_n)
        parts = {
            "-": [*(p for p in points if p[0] < at), turn],
            "--": [turn, *(p for p in points if p[0] > at)],
        }
    stopped = "" if run.summary.status == REACHED else UNNAMED
    drawn = [
        curve("axisymmetric", LABELS[dash], part, {"linestyle": dash}, stopped if part[-1] == points[-1] else "")
        for dash, part in parts.items()
        if len(part) > 1
    ]
    return [*drawn, requested_curve(run, "tip_force_n", {})]


def _mark(panel: Axes, case: CaseResult) -> bool:
    """Say where a path bends sideways, touches and stops, and ring its first state in contact; True if there is one."""
    if not case.axisymmetric:
        return False
    run, bends, touch = case.axisymmetric[-1], sideways(case), first_touch(case)
    said = [f"bends sideways from {bends.pressure_kpa:.2g} kPa"] if bends else []
    colour = style_of("axisymmetric")["color"]
    if touch:
        said.append(f"first touch between {touch[0]:.3g} and {touch[1]:.3g} kPa")
        state = next(state for state in run.path if state.pressure_kpa == touch[1])
        panel.plot(state.pressure_kpa, state.tip_force_n, color=colour, zorder=5.0, **_TOUCH)
    if run.summary.status != REACHED:
        said.append(ending_of(run))
    look: dict[str, Any] = {"fontsize": SMALL, "ha": "right", "color": colour}
    panel.text(0.98, 0.03, "\n".join(said), transform=panel.transAxes, **look)  # where rising curves leave room
    return touch is not None
