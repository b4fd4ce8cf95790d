"""Plots with a panel per actuator: elongation by every model, conventions, sets of dimensions, the blocked tip.

Every function that draws returns why there is no picture, or an empty text. Cases that are missing are left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import takewhile
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytical.bellows.chains_by_name import SILICONES
from studies.paper.cases import REFERENCE_SCENES, SETS, THICK
from studies.paper.errors import PRINTED
from studies.paper.results import CaseResult, PaperResults
from studies.report.curves import Curve, draw_curves, set_pressure_axis
from studies.report.labels import TIP, TIP_FORCE, model_label
from studies.report.style import BELOW, BLUE, DPI, GREEN, GREY, VERMILION, figure_file, style_of
from studies.results.rows import FOLDED_BACK, REACHED, Row
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene

WIDTH_IN: Final = 8.2
# Lines and markers in a panel of several, relative to a plot of its own.
SCALE: Final = 0.78
TITLE, SMALL = 10.0, 8.0  # points
# A curve that no legend names.
UNNAMED: Final = "_"
_ELONGATION: Final = "elongation at the tip, mm"
_CHAINS: Final = ("closed_form_printed", "closed_form", "closed_form_balanced", "closed_form_seat")
_SETS: Final[tuple[dict[str, Any], ...]] = (
    {"color": BLUE, "linestyle": "-"},
    {"color": VERMILION, "linestyle": "--"},
    {"color": GREEN, "linestyle": "-."},
)


# --- a panel per actuator -------------------------------------------------------------------


def draw_elongations(path: Path, results: PaperResults) -> str:
    """Draw elongation (mm) over pressure (kPa) by every model and as printed, a panel per reference actuator.

    A chain as printed is drawn up to where it folds back.
    """
    cases = by_base(results.of("core"))
    if not cases:
        return "no reference actuator has been run"

    def curves(base: str) -> list[Curve]:
        case, tets = cases[base], results.variant(base, "tets")
        return [
            *(found for model in _CHAINS for found in chain_curves(case, model)),
            *path_curves(case, "axisymmetric", {}, lambda run: f"axisymmetric: {ending_of(run)}"),
            *body_curves(case, "full3d", "full 3D, hexahedra"),
            *body_curves(tets, "full3d_tets", "full 3D, the paper's tetrahedra"),
            *printed_curves(case),
        ]

    with figure_file(path, WIDTH_IN, 7.6) as figure:
        axes, entries = draw_actuators(figure, _ELONGATION, REFERENCE_SCENES, cases, curves)
        labels = [found.get_label() for found in entries]
        beside = labels.index("axisymmetric") + 1 if "axisymmetric" in labels else 0
        entries[beside:beside] = _draw_bands({axes[base]: case for base, case in cases.items()})
        legend_below(figure, entries, fontsize=8.5, columnspacing=1.2, handlelength=2.4)
    return ""


def _draw_bands(cases: Mapping[Axes, CaseResult]) -> list[Any]:
    """Draw the uncertainty of axisymmetric paths; one entry of a legend, which says if they are hidden by the lines."""
    largest_mm, largest_px, bands = 0.0, 0.0, []
    for axes, case in cases.items():
        rows = [row for row in series(case.rows, TIP, "axisymmetric") if math.isfinite(row.uncertainty)]
        if not rows or not case.axisymmetric:
            continue
        points = from_rest((state.pressure_kpa, state.tip_mm) for state in case.axisymmetric[-1].path)
        pressures, tips = np.transpose(points)
        half = np.interp(pressures, [0.0, *(r.pressure_kpa for r in rows)], [0.0, *(r.uncertainty for r in rows)])
        colour = style_of("axisymmetric")["color"]
        bands = [axes.fill_between(pressures, tips - half, tips + half, color=colour, alpha=0.35, linewidth=0.0)]
        up = axes.transData.transform([(0.0, 0.0), (0.0, 2.0 * half.max())])[:, 1]
        largest_mm, largest_px = max(largest_mm, half.max()), max(largest_px, up[1] - up[0])
    hidden = ", within its line" if largest_px < 1.8 * SCALE * DPI / 72.0 else ""
    for band in bands:
        band.set_label(f"axisymmetric ± {largest_mm:.2g} mm or less{hidden}")
    return bands


def draw_conventions(path: Path, results: PaperResults) -> str:
    """Draw the 2 mm pair with Ogden's mu read in two ways: elongation (mm) over pressure (kPa)."""
    core, other = by_base(results.of("core")), by_base(results.of("convention"))
    if not other:
        return "no actuator has been run in the other convention"
    readings = ((core, r"2$\mu/\alpha^2$", BLUE), (other, r"$\mu/\alpha$", VERMILION))

    def curves(base: str) -> list[Curve]:
        found = []
        for cases, convention, colour in readings:
            if base in cases:
                found += path_curves(cases[base], f"axisymmetric, {convention}", {"color": colour})
                label = f"closed form, {convention}"
                found += chain_curves(cases[base], "closed_form", label=label, color=colour, markersize=5.0)
        return [*found, *(printed_curves(core[base]) if base in core else ())]

    with figure_file(path, WIDTH_IN, 4.4) as figure:
        _, entries = draw_actuators(figure, _ELONGATION, THICK, {**other, **core}, curves)
        legend_below(figure, entries)
    return ""


def draw_blocked(path: Path, results: PaperResults) -> str:
    """Draw the force (N) of the blocked tip over pressure (kPa), a panel per reference actuator."""
    cases = by_base(results.of("blocked"))
    if not cases:
        return "no actuator with a blocked tip has been run"
    alone: dict[str, Any] = {"color": GREY, "linestyle": ":", "marker": "none"}

    def curves(base: str) -> list[Curve]:
        return [
            *chain_curves(cases[base], "closed_form", TIP_FORCE),
            *chain_curves(cases[base], "closed_form", "extension_force_n", "thrust of the pressure alone", **alone),
            *(found for run in cases[base].axisymmetric[-1:] for found in _blocked_curves(run)),
        ]

    with figure_file(path, WIDTH_IN, 7.0) as figure:
        axes, entries = draw_actuators(figure, "force at the blocked tip, N", REFERENCE_SCENES, cases, curves)
        for base, panel in axes.items():
            for run in cases[base].axisymmetric[-1:]:
                if run.summary.status != REACHED:  # where rising curves leave room
                    look: dict[str, Any] = {
                        "fontsize": SMALL,
                        "ha": "right",
                        "color": style_of("axisymmetric")["color"],
                    }
                    panel.text(0.98, 0.03, ending_of(run), transform=panel.transAxes, **look)
        legend_below(figure, entries, columns=2)
    return ""


def _blocked_curves(run: Run) -> list[Curve]:
    """Force of a path, dashed where it has unstable modes, and dots at the requested pressures."""
    points = from_rest((state.pressure_kpa, state.tip_force_n) for state in run.path)
    first = next((k for k, state in enumerate(run.path) if state.unstable_modes > 0.0), len(run.path))
    stable, past = points[: first + 1], points[first + 1 :]
    if past:
        # the crossing was looked for between the states of the path
        turn = run.summary.crossing.get("pressure_kpa", stable[-1][0])
        pressures, forces = zip(stable[-1], past[0], strict=True)
        at = (turn, float(np.interp(turn, pressures, forces)))
        stable, past = [*stable, at], [at, *past]
    stopped = "" if run.summary.status == REACHED else UNNAMED
    label = model_label("axisymmetric")
    parts = {label: (stable, "-"), f"{label}, past the loss of stability": (past, "--")}
    drawn = [
        curve("axisymmetric", name, part, {"linestyle": dash}, stopped if part[-1] == points[-1] else "")
        for name, (part, dash) in parts.items()
        if len(part) > 1
    ]
    return [*drawn, requested_curve(run, "tip_force_n", {})]


def draw_dimensions_matter(path: Path, results: PaperResults) -> str:
    """Draw axisymmetric elongation (mm) over pressure (kPa) for the three sets of dimensions, a panel per actuator."""
    if not results.of("core", "alternates"):
        return "no set of dimensions has been run"
    with figure_file(path, WIDTH_IN, 7.2) as figure:
        printed: list[Any] = []
        for axes, *slot in zip(panels(figure, _ELONGATION, 4), *SETS.values(), strict=True):
            cases = [results.named(actuator.name) for actuator in slot]
            found = [case for case in cases if case.runs]
            curves = []
            for case, look in zip(cases, _SETS, strict=True):
                if case.runs:
                    curves += path_curves(case, f"{case.case.label}: {_sizes(case.scene)}", look)
            lines = draw_curves(axes, curves, SCALE)
            printed += draw_curves(axes, printed_curves(found[0]), SCALE) if found else []
            which = "larger than 5" if slot[0].printed.has_larger_root else "= 5"
            axes.set_title(f"t = {slot[0].printed.wall_mm:g} mm, $R_i$ {which} mm", fontsize=TITLE)
            if lines:
                axes.legend(handles=lines, fontsize=7.0, loc="upper left", frameon=False, handlelength=2.4)
                set_pressure_axis(axes, requested_kpa(found))
        from_zero(figure.axes, headroom=1.42)
        legend_below(figure, printed)
    return ""


def _sizes(scene: BellowsScene) -> str:
    g = scene.geometry
    shape = f"$R_i$ {g.root_radius_mm:g}, $R_p$ {g.crest_radius_mm:g}, $e$ {g.half_pitch_mm:g}, $n$ {g.convolutions}"
    return f"{shape}, DS {silicone_of(scene)[-2:]}"


# --- curves ---------------------------------------------------------------------------------


def path_curves(
    case: CaseResult, label: str, look: Mapping[str, Any], stopped: Callable[[Run], str] = lambda run: UNNAMED
) -> list[Curve]:
    """Elongation along the finest axisymmetric path, if it was run, from rest on; with a cross where it stopped."""
    found = []
    for run in case.axisymmetric[-1:]:
        points = from_rest((state.pressure_kpa, state.tip_mm) for state in run.path)
        why = "" if run.summary.status == REACHED else stopped(run)
        found.append(curve("axisymmetric", label, points, look, why))
    return found


def requested_curve(run: Run, quantity: str, look: Mapping[str, Any]) -> Curve:
    """Dots at the requested states of a path."""
    points = [(state.pressure_kpa, getattr(state, quantity)) for state in run.path if state.status == "requested"]
    return curve("axisymmetric", UNNAMED, points, {"linestyle": "none", **look}, markers=True)


def chain_curves(case: CaseResult, model: str, quantity: str = TIP, label: str = "", **look: Any) -> list[Curve]:
    """A chain's curve from rest, up to where it folds back; none if it has no other point."""
    kept = list(takewhile(lambda row: row.status != FOLDED_BACK, series(case.rows, quantity, model)))
    points = from_rest((row.pressure_kpa, row.value) for row in kept)
    fold = ", to its fold-back" if model == "closed_form_printed" else ""
    return [curve(model, label or model_label(model) + fold, points, look, markers=True)] if kept else []


def body_curves(case: CaseResult, style: str, label: str) -> list[Curve]:
    """The finest full 3D answers with their uncertainties."""
    rows = series(case.rows, TIP, "full3d")
    if not rows:
        return []
    pressures, tips, doubts = zip(*((r.pressure_kpa, r.value, r.uncertainty) for r in rows), strict=True)
    return [Curve(style, label, pressures, tips, doubts if np.isfinite(doubts).any() else ())]


def printed_curves(case: CaseResult) -> list[Curve]:
    """What the paper prints."""
    found = {model: series(case.rows, TIP, model) for model in PRINTED}
    return [Curve(model, model_label(model), (r[-1].pressure_kpa,), (r[-1].value,)) for model, r in found.items() if r]


def curve(
    model: str,
    label: str,
    points: Sequence[tuple[float, float]],
    look: Mapping[str, Any],
    stopped: str = "",
    markers: bool = False,
) -> Curve:
    """A curve through points (kPa, mm or N) that may end in a cross."""
    pressures, values = zip(*points, strict=True) if points else ((), ())
    end = points[-1] if points else (0.0, 0.0)
    return Curve(model, label, pressures, values, (), markers, stopped, end, look)


def series(rows: Iterable[Row], quantity: str, model: str) -> list[Row]:
    """Rows of a quantity and model that were reached, one per pressure, ascending; of the finest level, the last."""
    found = {row.pressure_kpa: row for row in rows if row.quantity == quantity and row.model == model}
    return [found[pressure] for pressure in sorted(found) if math.isfinite(found[pressure].value)]


def from_rest(points: Iterable[tuple[float, float]], at_rest: float = 0.0) -> list[tuple[float, float]]:
    """Points (kPa and a value) with that at rest before them, if it is not there."""
    found = list(points)
    return found if found and found[0][0] == 0.0 else [(0.0, at_rest), *found]


def ending_of(run: Run) -> str:
    """Where a path ended, the kind of reason if it did not reach what was asked, and where it lost its stability."""
    last = run.path[-1].pressure_kpa if run.path else 0.0
    crossing = run.summary.crossing
    where = ""
    if crossing:
        digits = 1 if crossing["within_kpa"] >= 0.1 else 2
        where = f" at {crossing['pressure_kpa']:.{digits}f} ± {crossing['within_kpa']:.{digits}f} kPa"
    if run.summary.status == REACHED:
        return f"reaches {last:g} kPa" + (f" ({crossing['kind']}{where})" if crossing else "")
    return f"stops at {last:.1f} kPa ({run.summary.cause or 'no cause given'}{where})"


# --- panels ---------------------------------------------------------------------------------


def panels(figure: Figure, label: str, number: int) -> list[Axes]:
    """Panels, two in a row whose vertical axis is shared."""
    grid = figure.subplots(number // 2, 2, sharex=True, sharey="row", squeeze=False)
    for axes in grid[:, 0]:
        axes.set_ylabel(label)
    for axes in grid[-1]:
        axes.set_xlabel("cavity pressure, kPa")
    return list(grid.ravel())


def draw_actuators(
    figure: Figure,
    label: str,
    bases: Sequence[str],
    cases: Mapping[str, CaseResult],
    curves: Callable[[str], Sequence[Curve]],
) -> tuple[dict[str, Axes], list[Any]]:
    """Draw a panel per actuator.

    Returns
    -------
    dict, list
        Panels of the actuators that have been run; entries of a legend of all.
    """
    found: dict[str, Axes] = {}
    entries: list[Any] = []
    for axes, base in zip(panels(figure, label, len(bases)), bases, strict=True):
        if base not in cases:
            axes.set_title(f"{base}: not run", fontsize=TITLE)
            continue
        entries += draw_curves(axes, curves(base), SCALE)
        scene = cases[base].scene
        axes.set_title(f"{name_of(scene)}, {silicone_of(scene)}", fontsize=TITLE)
        set_pressure_axis(axes, scene.load.pressure_kpa)
        found[base] = axes
    from_zero(figure.axes)
    return found, entries


def from_zero(panels: Sequence[Axes], headroom: float = 1.0) -> None:
    """Vertical axes from zero, or from below where there are negative values; with room above for a legend."""
    for axes in panels:
        rows = axes.get_shared_y_axes().get_siblings(axes)
        drawn = [value for one in rows for line in one.lines for value in np.atleast_1d(line.get_ydata())]
        low, high = axes.get_ylim()
        axes.set_ylim(low if min(drawn, default=0.0) < 0.0 else 0.0, high)
    for axes in {min(a.get_shared_y_axes().get_siblings(a), key=id) for a in panels}:
        axes.set_ylim(top=headroom * axes.get_ylim()[1])


def legend_below(figure: Figure, entries: Iterable[Any], columns: int = 3, **look: Any) -> None:
    """A legend below all panels, each label once."""
    once: dict[str, Any] = {}
    for entry in entries:
        once.setdefault(entry.get_label(), entry)
    figure.legend(handles=list(once.values()), ncols=columns, **BELOW, **look)


def name_of(scene: BellowsScene) -> str:
    """An actuator by what the paper prints of it."""
    return f"t = {scene.geometry.wall_mm:g} mm, $R_i$ = {scene.geometry.root_radius_mm:g} mm"


def silicone_of(scene: BellowsScene) -> str:
    """The paper's silicone that a scene's law stands for."""
    return SILICONES["dragon-skin-10" if scene.material.law == "yeoh" else "dragon-skin-30"]


def by_base(cases: Iterable[CaseResult]) -> dict[str, CaseResult]:
    """Cases by what they are made from."""
    return {case.case.base: case for case in cases}


def requested_kpa(cases: Iterable[CaseResult]) -> list[float]:
    """All requested pressures, kPa."""
    return sorted({pressure for case in cases for pressure in case.pressures_kpa})
