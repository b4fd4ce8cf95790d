"""Elongation over pressure: by every model, for the sets of dimensions, and in two readings of Ogden's law."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes

from analytical.bellows.paper import ALTERNATE_FAMILIES, REFERENCE_FAMILY, actuators
from studies.paper.cases import REFERENCE_SCENES, THICK
from studies.paper.plots.layout import (
    SCALE,
    TITLE,
    WIDTH_IN,
    add_entries,
    finish_panels,
    four_panels,
    from_zero,
    mark_end,
)
from studies.paper.plots.paths import (
    by_base,
    chain_curve,
    ending_of,
    finest_run,
    path_of,
    printed_curves,
    requested_kpa,
    series_of,
    silicone_of,
    tip_of,
)
from studies.paper.results import CaseResult, PaperResults
from studies.report.curves import Curve, draw_curves, set_pressure_axis
from studies.report.labels import TIP, model_label
from studies.report.style import BELOW, BLUE, DPI, GREEN, VERMILION, figure_file, style_of
from studies.scene.bellows import BellowsScene

_CHAINS: Final = ("closed_form_printed", "closed_form", "closed_form_balanced", "closed_form_seat")

_SETS: Final[tuple[dict[str, Any], ...]] = (
    {"color": BLUE, "linestyle": "-"},
    {"color": VERMILION, "linestyle": "--"},
    {"color": GREEN, "linestyle": "-."},
)


def draw_elongations(path: Path, results: PaperResults) -> str:
    """Draw elongation (mm) over pressure (kPa) by every model and as printed, a panel per reference actuator.

    A chain as printed is drawn up to where it folds back.
    """
    cases = by_base(results.of("core"))
    if not cases:
        return "no reference actuator has been run"
    with figure_file(path, WIDTH_IN, 7.6) as figure:
        panels = four_panels(figure, "elongation at the tip, mm")
        legend: dict[str, Any] = {}
        for axes, base in zip(panels, REFERENCE_SCENES, strict=True):
            if base in cases:
                tets = results.variant(base, "tets")
                add_entries(legend, draw_curves(axes, _elongation_curves(cases[base], tets), SCALE))
        finish_panels(panels, REFERENCE_SCENES, cases)
        bands = _draw_bands({panels[k]: cases[base] for k, base in enumerate(REFERENCE_SCENES) if base in cases})
        entries = list(legend.values())
        # beside what it belongs to
        place = next((k for k, entry in enumerate(entries) if entry.get_label() == model_label("axisymmetric")), 0)
        entries[place + 1 : place + 1] = bands
        look = {"fontsize": 8.5, "columnspacing": 1.2, "handlelength": 2.4}
        figure.legend(handles=entries, ncols=3, **look, **BELOW)
    return ""


def draw_dimensions_matter(path: Path, results: PaperResults) -> str:
    """Draw axisymmetric elongation (mm) over pressure (kPa) for the three sets of dimensions, a panel per actuator."""
    cases = by_base(results.of("core", "alternates"))
    if not cases:
        return "no set of dimensions has been run"
    families = (REFERENCE_FAMILY, *ALTERNATE_FAMILIES)
    slots = list(zip(*([a.name for a in actuators(family)] for family in families), strict=True))
    with figure_file(path, WIDTH_IN, 7.2) as figure:
        panels = four_panels(figure, "elongation at the tip, mm")
        printed: dict[str, Any] = {}
        for k, (axes, slot) in enumerate(zip(panels, slots, strict=True)):
            found = {name: cases[name] for name in slot if name in cases}
            lines = []
            for name, style in zip(slot, _SETS, strict=True):
                if name in found and (run := finest_run(found[name])):
                    what = f"{found[name].case.label}: {_sizes(found[name].result.scene)}"
                    lines += axes.plot(*path_of(run, tip_of), label=what, linewidth=1.6, **style)
                    mark_end(axes, run, tip_of, style["color"])
            rows = next((case.rows for case in found.values()), ())
            add_entries(printed, draw_curves(axes, printed_curves(rows), SCALE))
            wall, which = actuators()[k].printed.wall_mm, ("larger than 5", "= 5")[k % 2 == 0]
            axes.set_title(f"t = {wall:g} mm, $R_i$ {which} mm", fontsize=TITLE)
            if lines:
                axes.legend(handles=lines, fontsize=7.0, loc="upper left", frameon=False, handlelength=2.4)
                set_pressure_axis(axes, requested_kpa(found.values()))
        from_zero(panels, headroom=1.42)
        figure.legend(handles=list(printed.values()), ncols=3, **BELOW)
    return ""


def draw_conventions(path: Path, results: PaperResults) -> str:
    """Draw the 2 mm pair with Ogden's mu read in two ways: elongation (mm) over pressure (kPa)."""
    core = by_base(results.of("core"))
    other = by_base(results.of("convention"))
    if not other:
        return "no actuator has been run in the other convention"
    readings = ((core, r"2$\mu/\alpha^2$", BLUE), (other, r"$\mu/\alpha$", VERMILION))
    with figure_file(path, WIDTH_IN, 4.4) as figure:
        panels = list(figure.subplots(1, 2, sharey=True))
        legend: dict[str, Any] = {}
        for axes, base in zip(panels, THICK, strict=True):
            for cases, convention, colour in readings:
                if base not in cases:
                    continue
                if run := finest_run(cases[base]):
                    label = f"axisymmetric, {convention}"
                    add_entries(legend, axes.plot(*path_of(run, tip_of), color=colour, linewidth=1.6, label=label))
                    mark_end(axes, run, tip_of, colour)
                if chain := chain_curve(cases[base].rows, "closed_form"):
                    look: dict[str, Any] = {"color": colour, "linestyle": "--", "marker": "^", "markersize": 5.0}
                    label = f"closed form, {convention}"
                    add_entries(legend, axes.plot(chain.pressure_kpa, chain.tip_mm, label=label, linewidth=1.4, **look))
            if base in core:
                add_entries(legend, draw_curves(axes, printed_curves(core[base].rows), SCALE))
            axes.set_xlabel("cavity pressure, kPa")
        panels[0].set_ylabel("elongation at the tip, mm")
        finish_panels(panels, THICK, {**other, **core})
        figure.legend(handles=list(legend.values()), ncols=3, **BELOW)
    return ""


def _elongation_curves(case: CaseResult, tets: CaseResult | None) -> list[Curve]:
    """The chains, the axisymmetric path, full 3D in hexahedra and in tetrahedra, and the printed values."""
    curves = [chain for model in _CHAINS if (chain := chain_curve(case.rows, model))]
    if run := finest_run(case):
        pressures, tips = path_of(run, tip_of)
        stopped = f"axisymmetric: {ending_of(run)}" if run.summary.status != "reached" else ""
        end = (pressures[-1], tips[-1])
        curves.append(Curve("axisymmetric", "axisymmetric", pressures, tips, (), False, stopped, end))
    curves += _bodies(case, "full3d", "full 3D, hexahedra")
    if tets is not None:
        curves += _bodies(tets, "full3d_tets", "full 3D, the paper's tetrahedra")
    return [*curves, *printed_curves(case.rows)]


def _bodies(case: CaseResult, style: str, label: str) -> list[Curve]:
    rows = series_of(case.rows, TIP, "full3d")
    if not rows:
        return []
    pressures, tips, bars = zip(*((r.pressure_kpa, r.value, r.uncertainty) for r in rows), strict=True)
    return [Curve(style, label, pressures, tips, bars if np.isfinite(bars).any() else ())]


def _draw_bands(cases: Mapping[Axes, CaseResult]) -> list[Any]:
    """Draw the uncertainty of axisymmetric paths; one entry of a legend, which says if they are hidden by the lines."""
    largest_mm, largest_px, entry = 0.0, 0.0, []
    for axes, case in cases.items():
        run, rows = finest_run(case), series_of(case.rows, TIP, "axisymmetric")
        rows = [row for row in rows if math.isfinite(row.uncertainty)]
        if run is None or not rows:
            continue
        pressures, tips = (np.array(values) for values in path_of(run, tip_of))
        half = np.interp(pressures, [0.0, *(r.pressure_kpa for r in rows)], [0.0, *(r.uncertainty for r in rows)])
        colour = style_of("axisymmetric")["color"]
        entry = [axes.fill_between(pressures, tips - half, tips + half, color=colour, alpha=0.35, linewidth=0.0)]
        up = axes.transData.transform([(0.0, 0.0), (0.0, 2.0 * half.max())])[:, 1]
        largest_mm, largest_px = max(largest_mm, half.max()), max(largest_px, up[1] - up[0])
    for band in entry:
        line_px = 1.8 * SCALE * DPI / 72.0
        hidden = ", within its line" if largest_px < line_px else ""
        band.set_label(f"axisymmetric ± {largest_mm:.2g} mm or less{hidden}")
    return entry


def _sizes(scene: BellowsScene) -> str:
    g = scene.geometry
    shape = f"$R_i$ {g.root_radius_mm:g}, $R_p$ {g.crest_radius_mm:g}, $e$ {g.half_pitch_mm:g}, $n$ {g.convolutions}"
    return f"{shape}, DS {silicone_of(scene)[-2:]}"
