"""Plots with a panel per actuator: elongation by every model, conventions, sets of dimensions; panels for others.

Every function that draws returns why there is no picture, or an empty text. Cases that are missing are left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytical.bellows.chains_by_name import SILICONES
from studies.paper.cases import HIGHEST_KPA, REFERENCE, REFERENCE_SCENES, SETS, THICK
from studies.paper.drawing.lines import (
    UNNAMED,
    at_most,
    body_curves,
    chain_curves,
    ending_of,
    from_rest,
    path_curves,
    printed_curves,
    series,
    smooth,
)
from studies.paper.results import CaseResult, PaperResults
from studies.report.curves import Curve, draw_curves, set_pressure_axis
from studies.report.labels import TIP, model_label
from studies.report.style import BELOW, BLUE, GREEN, GREY, VERMILION, WINE, entry, figure_file, style_of
from studies.results.runs import Run, followed, tip_at
from studies.scene.bellows import BellowsScene

WIDTH_IN: Final = 8.2
# Lines and markers in a panel of several, relative to a plot of its own.
SCALE: Final = 0.78
TITLE, SMALL = 10.0, 8.0  # points
# The pressure axis ends beyond the printed numbers, which stand beside their pressure, kPa.
LAST_KPA: Final = 22.0
ROWS_DIFFER: Final = "The vertical scale of the upper panels is not that of the lower ones."
# Ends the names of scenes on the outline of the paper's figure 2.
ZIGZAG: Final = "-zigzag"
ELONGATION: Final = "elongation at the tip, mm"
# The chain as printed is below the others, wide, so that it is seen where the corrected one hides it.
_CHAINS: Final[dict[str, dict[str, Any]]] = {
    "closed_form_printed": {"linestyle": "-", "linewidth": 4.0, "alpha": 0.6},
    "closed_form": {},
    "closed_form_balanced": {},
    "closed_form_seat": {},
}
_SETS: Final[tuple[dict[str, Any], ...]] = ({"color": BLUE}, {"color": VERMILION}, {"color": GREEN})


# --- a panel per actuator -------------------------------------------------------------------


def draw_elongations(path: Path, results: PaperResults) -> str:
    """Draw elongation (mm) over pressure (kPa) by every model and as printed, a panel per reference actuator.

    A chain as printed is drawn up to where it folds back.
    """
    cases, curves = by_base(results.of("core")), elongation_curves(results)
    if not cases:
        return "no reference actuator has been run"
    with figure_file(path, WIDTH_IN, 8.4) as figure:
        axes, entries = draw_actuators(figure, ELONGATION, REFERENCE_SCENES, cases, curves)
        for base, panel in axes.items():
            draw_band(panel, cases[base])
        legend_below(figure, entries, columns=2, title=ROWS_DIFFER, fontsize=8.5)
    return ""


def elongation_curves(results: PaperResults) -> Callable[[str], list[Curve]]:
    """What makes the curves of elongation over pressure, by every model and as printed, of an actuator."""
    cases = by_base(results.of("core"))
    zigzags = {case.case.scene.removesuffix(ZIGZAG): case for case in results.of("zigzag")}
    tets = {base: results.variant(base, "tets") for base in cases}
    moulded = _with_doubt("axisymmetric, as moulded", cases.values(), "axisymmetric")
    zigzag = _with_doubt("axisymmetric, zigzag", zigzags.values(), "axisymmetric")
    hexahedra = _with_doubt("full 3D, hexahedra", [*cases.values(), *zigzags.values()], "full3d")
    tetrahedra = _with_doubt("full 3D, curved tetrahedra", tets.values(), "full3d")

    def curves(base: str) -> list[Curve]:
        case, other = cases[base], zigzags.get(base)
        return [
            *(found for model, look in _CHAINS.items() for found in chain_curves(case, model, _label(model), **look)),
            *(path_curves(other, zigzag, {"color": WINE}, _stops("axisymmetric, zigzag")) if other else ()),
            *path_curves(case, moulded, {}, _stops("axisymmetric, as moulded")),
            *(body_curves(other, hexahedra, _half("left", WINE)) if other else ()),
            *body_curves(case, hexahedra, _half("left")),
            *body_curves(tets[base], tetrahedra, _half("right")),
            *printed_curves(case),
        ]

    return curves


def _with_doubt(label: str, cases: Iterable[CaseResult], model: str) -> str:
    """A label with the largest uncertainty of a model's elongations."""
    return label + at_most(row for case in cases for row in series(case.rows, TIP, model))


def _label(model: str) -> str:
    """A chain's label; that as printed is drawn no further than it means something."""
    return model_label(model) + (", to its fold-back" if model == "closed_form_printed" else "")


def _stops(label: str) -> Callable[[Run], str]:
    return lambda run: f"{label}: {ending_of(run)}"


def _half(side: str, colour: str = VERMILION) -> dict[str, Any]:
    """Half a square, so that of two answers that agree each is seen."""
    square = {"markerfacecoloralt": "none", "markersize": 7.0, "markeredgecolor": colour}
    return {"fillstyle": side, "color": colour, **square}


def draw_band(axes: Axes, case: CaseResult) -> None:
    """Draw what the meshes lead to, with its uncertainty, behind the line of the axisymmetric path."""
    rows = [row for row in series(case.rows, TIP, "axisymmetric") if math.isfinite(row.uncertainty)]
    if not rows or not case.axisymmetric:
        return
    (run,) = followed(case.axisymmetric)
    points = smooth(from_rest((state.pressure_kpa, state.tip_mm) for state in run.path))
    pressures, tips = np.transpose(points)
    known = [0.0, *(r.pressure_kpa for r in rows)]
    half = np.interp(pressures, known, [0.0, *(r.uncertainty for r in rows)])
    middle = tips + np.interp(pressures, known, [0.0, *(r.value - tip_at(run, r.pressure_kpa) for r in rows)])
    colour = style_of("axisymmetric")["color"]
    axes.fill_between(pressures, middle - half, middle + half, color=colour, alpha=0.35, linewidth=0.0)


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
                found += chain_curves(cases[base], "closed_form", f"closed form, {convention}", color=colour)
        # first, for they fill the legend's first column
        return [*(printed_curves(core[base]) if base in core else ()), *found]

    with figure_file(path, WIDTH_IN, 4.4) as figure:
        _, entries = draw_actuators(figure, ELONGATION, THICK, {**other, **core}, curves)
        legend_below(figure, entries)
    return ""


def draw_dimensions_matter(path: Path, results: PaperResults) -> str:
    """Draw axisymmetric elongation (mm) over pressure (kPa) for the three sets of dimensions, a panel per actuator."""
    if not results.of("core", "alternates"):
        return "no set of dimensions has been run"
    with figure_file(path, WIDTH_IN, 7.2) as figure:
        below: list[Any] = []
        for axes, *slot in zip(panels(figure, ELONGATION, 4), *SETS.values(), strict=True):
            cases = [results.named(actuator.name) for actuator in slot]
            found = [case for case in cases if case.runs]
            curves = []
            for case, look in zip(cases, _SETS, strict=True):
                if case.runs:
                    curves += path_curves(case, f"{case.case.label}: {_sizes(case.scene)}", look)
                    draw_curves(axes, chain_curves(case, "closed_form", UNNAMED, **look, linewidth=1.0), SCALE)
            lines = draw_curves(axes, curves, SCALE)
            below += draw_curves(axes, printed_curves(found[0]), SCALE) if found else []
            which = "larger than 5" if slot[0].printed.has_larger_root else "= 5"
            axes.set_title(f"t = {slot[0].printed.wall_mm:g} mm, $R_i$ {which} mm", fontsize=TITLE)
            if lines:
                axes.legend(handles=lines, fontsize=6.5, loc="lower right", frameon=False, handlelength=1.6)
                set_pressure_axis(axes, requested_kpa(found))
                axes.set_xlim(right=LAST_KPA)
        from_zero(figure.axes)
        every = results.of("core", "alternates")
        known = {_with_doubt("axisymmetric", every, "axisymmetric"): "-", "closed form": "--"}
        look = {"color": GREY, "linewidth": 1.4}
        below += [entry(label, linestyle=dash, **look) for label, dash in known.items()]
        legend_below(figure, below, title=ROWS_DIFFER)
    return ""


def _sizes(scene: BellowsScene) -> str:
    g = scene.geometry
    shape = f"$R_i$ {g.root_radius_mm:g}, $R_p$ {g.crest_radius_mm:g}, $e$ {g.half_pitch_mm:g}, $n$ {g.convolutions}"
    return f"{shape}, DS {silicone_of(scene)[-2:]}"


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
        axes.set_title(title_of(base), fontsize=TITLE)
        pressures = cases[base].scene.load.pressure_kpa
        set_pressure_axis(axes, pressures)
        if max(pressures) == HIGHEST_KPA:
            axes.set_xlim(right=LAST_KPA)
        found[base] = axes
    from_zero(figure.axes)
    return found, entries


def from_zero(panels: Sequence[Axes]) -> None:
    """Vertical axes from zero, or from below where there are negative values."""
    for axes in panels:
        rows = axes.get_shared_y_axes().get_siblings(axes)
        drawn = [value for one in rows for line in one.lines for value in np.atleast_1d(line.get_ydata())]
        low, high = axes.get_ylim()
        axes.set_ylim(low if min(drawn, default=0.0) < 0.0 else 0.0, high)


def legend_below(figure: Figure, entries: Iterable[Any], columns: int = 3, **look: Any) -> None:
    """A legend below all panels, each label once."""
    once: dict[str, Any] = {}
    for of_curve in entries:
        once.setdefault(of_curve.get_label(), of_curve)
    figure.legend(handles=list(once.values()), ncols=columns, **BELOW, **look)


def title_of(base: str) -> str:
    """A reference actuator: what the paper prints of it, and what is inferred."""
    actuator = next(actuator for actuator in REFERENCE if actuator.name == base)
    wall, root = f"t = {actuator.printed.wall_mm:g} mm", f"$R_i$ = {actuator.dimensions.root_radius_mm:g} mm"
    silicone = SILICONES[actuator.silicone]
    if actuator.printed.has_larger_root:
        return f"{wall}; inferred: {root}, {silicone}"
    return f"{wall}, {root}; inferred: {silicone}"


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
