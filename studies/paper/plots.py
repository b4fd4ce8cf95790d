"""Plots of the paper study, drawn from its results and written as PNG.

Every function returns why there is no picture, or an empty text. Cases that are missing are left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from studies.closed_form.tables import SILICONES, STRETCH_AT_BREAK
from studies.models.run_log import Run
from studies.paper.cases import HIGHEST_KPA, REFERENCE, REFERENCE_SCENES, RING_VARIANTS, SETS, THICK
from studies.paper.errors import CHAINS
from studies.paper.panels import (
    SCALE,
    SMALL,
    TITLE,
    UNNAMED,
    body_curves,
    chain_curves,
    curve,
    draw_actuators,
    ending_of,
    force,
    from_rest,
    from_zero,
    legend_below,
    name_of,
    panels,
    path_curves,
    printed_curves,
    requested_curve,
    series,
    silicone_of,
    tip,
)
from studies.paper.results import CaseResult, PaperResults
from studies.paper.variants import REFERENCE_RING
from studies.report.curves import Curve, draw_curves, set_pressure_axis
from studies.report.labels import TIP, TIP_FORCE, model_label
from studies.report.style import (
    ABOVE,
    BLACK,
    BLUE,
    DPI,
    GREEN,
    ORANGE,
    SKY,
    VERMILION,
    entry,
    figure_file,
    grid,
    style_of,
    white_edged,
)
from studies.results.rows import REACHED
from studies.scene.bellows import Scene

_WIDTH_IN: Final = 8.2
_GREY: Final = "#555555"
# The four actuators where they share axes: one hue per wall, one marker each; the second of a pair is smaller and does
# not hide the first where both agree.
_ACTUATORS: Final[dict[str, dict[str, Any]]] = dict(
    zip(
        REFERENCE_SCENES,
        (
            {"color": BLUE, "marker": "o", "markersize": 8.0},
            {"color": SKY, "marker": "s", "markersize": 5.5},
            {"color": VERMILION, "marker": "^", "markersize": 9.0},
            {"color": ORANGE, "marker": "D", "markersize": 4.5},
        ),
        strict=True,
    )
)
_SETS: Final[tuple[dict[str, Any], ...]] = (
    {"color": BLUE, "linestyle": "-"},
    {"color": VERMILION, "linestyle": "--"},
    {"color": GREEN, "linestyle": "-."},
)
_MEASURED: Final[dict[str, str]] = {
    "root_stretch_outer": "root: hoop stretch, outside",
    "wall_stretch": "side wall: stretch along it",
    "ring_hoop_stretch": "under the rings: hoop stretch",
}
_RING_MARKERS: Final = ("o", "s", "^")


def _by_base(cases: Iterable[CaseResult]) -> dict[str, CaseResult]:
    return {case.case.base: case for case in cases}


def _requested_kpa(cases: Iterable[CaseResult]) -> list[float]:
    return sorted({pressure for case in cases for pressure in case.pressures_kpa})


# --- a panel per actuator -------------------------------------------------------------------


def draw_elongations(path: Path, results: PaperResults) -> str:
    """Draw elongation (mm) over pressure (kPa) by every model and as printed, a panel per reference actuator.

    A chain as printed is drawn up to where it folds back.
    """
    cases = _by_base(results.of("core"))
    if not cases:
        return "no reference actuator has been run"

    def curves(base: str) -> list[Curve]:
        case, tets = cases[base], results.variant(base, "tets")
        chains = (CHAINS[1], CHAINS[0], *CHAINS[2:])
        return [
            *(found for model in chains for found in chain_curves(case, model)),
            *path_curves(case, "axisymmetric", {}, lambda run: f"axisymmetric: {ending_of(run)}"),
            *body_curves(case, "full3d", "full 3D, hexahedra"),
            *body_curves(tets, "full3d_tets", "full 3D, the paper's tetrahedra"),
            *printed_curves(case),
        ]

    with figure_file(path, _WIDTH_IN, 7.6) as figure:
        axes, entries = draw_actuators(figure, "elongation at the tip, mm", REFERENCE_SCENES, cases, curves)
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
    core, other = _by_base(results.of("core")), _by_base(results.of("convention"))
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

    with figure_file(path, _WIDTH_IN, 4.4) as figure:
        label = "elongation at the tip, mm"
        _, entries = draw_actuators(figure, label, THICK, {**other, **core}, curves)
        legend_below(figure, entries)
    return ""


def draw_blocked(path: Path, results: PaperResults) -> str:
    """Draw the force (N) of the blocked tip over pressure (kPa), a panel per reference actuator."""
    cases = _by_base(results.of("blocked"))
    if not cases:
        return "no actuator with a blocked tip has been run"
    alone: dict[str, Any] = {"color": _GREY, "linestyle": ":", "marker": "none"}

    def curves(base: str) -> list[Curve]:
        return [
            *chain_curves(cases[base], "closed_form", TIP_FORCE),
            *chain_curves(cases[base], "closed_form", "extension_force_n", "thrust of the pressure alone", **alone),
            *(found for run in cases[base].axisymmetric[-1:] for found in _blocked_curves(run)),
        ]

    with figure_file(path, _WIDTH_IN, 7.0) as figure:
        axes, entries = draw_actuators(figure, "force at the blocked tip, N", REFERENCE_SCENES, cases, curves)
        for base, panel in axes.items():
            for run in cases[base].axisymmetric[-1:]:
                if run.summary.status != REACHED:  # where rising curves leave room
                    look: dict[str, Any] = {"fontsize": SMALL, "ha": "right", "color": style_of("axisymmetric")["color"]}
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
        at = (turn, float(np.interp(turn, *zip(stable[-1], past[0], strict=True))))
        stable, past = [*stable, at], [at, *past]
    stopped = "" if run.summary.status == REACHED else UNNAMED
    label = model_label("axisymmetric")
    parts = {label: (stable, "-"), f"{label}, past the loss of stability": (past, "--")}
    drawn = [
        curve("axisymmetric", name, part, {"linestyle": dash}, stopped if part[-1] == points[-1] else "")
        for name, (part, dash) in parts.items()
        if len(part) > 1
    ]
    return [*drawn, requested_curve(run, force, {"markersize": 6.0})]


def draw_dimensions_matter(path: Path, results: PaperResults) -> str:
    """Draw axisymmetric elongation (mm) over pressure (kPa) for the three sets of dimensions, a panel per actuator."""
    if not results.of("core", "alternates"):
        return "no set of dimensions has been run"
    with figure_file(path, _WIDTH_IN, 7.2) as figure:
        printed: list[Any] = []
        for axes, *slot in zip(panels(figure, "elongation at the tip, mm", 4), *SETS.values(), strict=True):
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
                set_pressure_axis(axes, _requested_kpa(found))
        from_zero(figure.axes, headroom=1.42)
        legend_below(figure, printed)
    return ""


def _sizes(scene: Scene) -> str:
    g = scene.geometry
    shape = f"$R_i$ {g.root_radius_mm:g}, $R_p$ {g.crest_radius_mm:g}, $e$ {g.half_pitch_mm:g}, $n$ {g.convolutions}"
    return f"{shape}, DS {silicone_of(scene)[-2:]}"


# --- all actuators on the same axes ---------------------------------------------------------


def draw_assumptions(path: Path, results: PaperResults) -> str:
    """Draw stretches the closed form assumes beside those measured in axisymmetric states, over pressure (kPa)."""
    cases = _by_base(results.of("core"))
    known = {base: case for base, case in cases.items() if any(row.quantity in _MEASURED for row in case.rows)}
    if not known:
        return "nothing has been measured in the states of the reference actuators"
    with figure_file(path, _WIDTH_IN, 3.9) as figure:
        columns = figure.subplots(1, len(_MEASURED))
        for axes, (quantity, title) in zip(columns, _MEASURED.items(), strict=True):
            for base, case in known.items():
                look = _ACTUATORS[base]
                chain, found = (
                    [(row.pressure_kpa, row.value) for row in series(case.rows, quantity, model)]
                    for model in ("closed_form", "axisymmetric")
                )
                dashed = {"color": look["color"], "linestyle": "--"}
                curves = [curve("closed_form", UNNAMED, from_rest(chain, 1.0), dashed)] if chain else []
                dots = curve("axisymmetric", UNNAMED, found, {"linestyle": "none", **look}, markers=True)
                draw_curves(axes, [*curves, dots], SCALE)
            axes.axhline(1.0, color=BLACK, linewidth=0.8, zorder=1.0)
            axes.set_title(title, fontsize=TITLE)
            axes.set_xlabel("cavity pressure, kPa")
            set_pressure_axis(axes, _requested_kpa(known.values()))
        columns[0].set_ylabel("stretch")
        legend_below(
            figure,
            [
                *(_actuator_entry(base, name_of(case.scene)) for base, case in known.items()),
                entry("closed form", color=_GREY, linestyle="--", linewidth=1.5),
                entry("axisymmetric", linestyle="none", **white_edged(marker="o", color=_GREY)),
            ],
        )
    return ""


def _actuator_entry(base: str, label: str) -> Any:
    return entry(label, linestyle="none", **white_edged(**_ACTUATORS[base]))


def draw_beyond(path: Path, results: PaperResults) -> str:
    """Draw how far each actuator goes beyond 20 kPa: elongation (mm), largest stretch and unstable modes over kPa."""
    cases = {base: case for base, case in _by_base(results.of("beyond")).items() if case.axisymmetric}
    if not cases:
        return "no actuator has been taken beyond 20 kPa"
    with figure_file(path, _WIDTH_IN, 8.6) as figure:
        top, middle, strip = figure.subplots(3, 1, sharex=True, height_ratios=(3.0, 2.6, 0.9))
        entries = []
        for base, case in cases.items():
            run, look = case.axisymmetric[-1], _ACTUATORS[base]
            line = path_curves(case, UNNAMED, {"color": look["color"]})
            draw_curves(top, [*line, requested_curve(run, tip, look)], SCALE)
            peaks = [(row.pressure_kpa, row.value) for row in series(case.rows, "peak_stretch_away", "axisymmetric")]
            middle.plot(*np.reshape(peaks, (-1, 2)).T, linewidth=1.6, **white_edged(**look))
            entries.append(_actuator_entry(base, f"{name_of(case.scene)}: {ending_of(run)}"))
        _draw_breaks(middle, [case.scene for case in cases.values()])
        runs = {name_of(case.scene): case.axisymmetric[-1] for case in cases.values()}
        _draw_modes(strip, runs)
        top.set_ylabel("elongation at the tip, mm")
        top.set_ylim(bottom=0.0)
        middle.set_ylabel("largest principal stretch")
        strip.set_xlabel("cavity pressure, kPa")
        for axes in (top, middle, strip):
            set_pressure_axis(axes, [p for p in _requested_kpa(cases.values()) if p % 5.0 == 0.0])
            axes.axvline(HIGHEST_KPA, color=BLACK, linewidth=1.0, linestyle=":", zorder=1.0)
        strip.grid(axis="y", visible=False)
        top.annotate(
            "the paper's ANSYS\ndid not converge beyond",
            (HIGHEST_KPA, 0.03),
            xycoords=("data", "axes fraction"),
            xytext=(4, 0),
            textcoords="offset points",
            fontsize=SMALL,
        )
        if any(run.summary.status != REACHED for run in runs.values()):
            cross: dict[str, Any] = {"marker": "x", "linestyle": "none", "markersize": 8.0, "markeredgewidth": 2.0}
            entries.append(entry("last state of a path that stopped", color=BLACK, **cross))
        figure.legend(handles=entries, ncols=2, fontsize=9.0, **ABOVE)
    return ""


def _draw_breaks(axes: Axes, scenes: Sequence[Scene]) -> None:
    """Draw the stretches at which the silicones break, and whose they are."""
    for silicone, stretch in STRETCH_AT_BREAK.items():
        axes.axhline(stretch, color=BLACK, linewidth=1.2, linestyle="--", zorder=2.0)
        name = SILICONES[silicone]
        walls = sorted({f"t = {scene.geometry.wall_mm:g} mm" for scene in scenes if silicone_of(scene) == name})
        whose = f" ({', '.join(walls)})" if walls else ""
        text = f"elongation at break of {name}{whose}: {100.0 * (stretch - 1.0):g} %"
        place: dict[str, Any] = {"xycoords": ("axes fraction", "data"), "textcoords": "offset points"}
        axes.annotate(text, (0.01, stretch), xytext=(0, -3), va="top", fontsize=SMALL, **place)
    axes.set_ylim(1.0, 1.06 * max(STRETCH_AT_BREAK.values()))


def _draw_modes(axes: Axes, runs: Mapping[str, Run]) -> None:
    """Draw a line per path: pale where it is stable, dark where it has unstable modes, their number beside a change."""
    beside: dict[str, Any] = {"textcoords": "offset points", "fontsize": SMALL, "va": "center", "ha": "right"}
    beside["bbox"] = {"facecolor": "white", "edgecolor": "none", "pad": 0.6}
    for place, run in enumerate(runs.values()):
        begin, before = 0.0, 0.0
        for state in run.path:
            if not math.isfinite(state.unstable_modes):
                continue
            colour, width = (VERMILION, 6.0) if state.unstable_modes else ("#bbbbbb", 3.0)
            ends = [begin, state.pressure_kpa]
            axes.plot(ends, [place, place], color=colour, linewidth=width, solid_capstyle="butt")
            if state.unstable_modes != before:
                axes.annotate(f"{state.unstable_modes:.0f}", (begin, place), (-3, 0), **beside)
            begin, before = state.pressure_kpa, state.unstable_modes
    axes.set_yticks(range(len(runs)), list(runs), fontsize=SMALL)
    axes.set_ylim(len(runs) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    some = any(state.unstable_modes > 0.0 for run in runs.values() for state in run.path)
    legend = "pale: none, dark: the number before it" if some else "none"
    axes.set_title(f"unstable modes along the path: {legend}", fontsize=9.0, loc="left")


def draw_rings(path: Path, results: PaperResults) -> str:
    """Draw what the rings' models cost (s) and what they change in the tip's elongation (% of meshed PLA's)."""
    found = {base: points for base in REFERENCE_SCENES if (points := _ring_points(results, base))}
    if not found:
        return "no actuator has been run with meshed PLA rings and others"
    names = {actuator.name: name_of(results.variant(actuator.name, "rings").scene) for actuator in REFERENCE}
    with figure_file(path, _WIDTH_IN, 4.4) as figure:
        axes = figure.add_subplot()
        axes.axhline(0.0, color=BLACK, linewidth=0.8, zorder=1.0)
        for base, points in found.items():
            colour = _ACTUATORS[base]["color"]
            axes.plot(*zip(*sorted(points.values()), strict=True), color=colour, linewidth=0.9, alpha=0.6)
            for suffix, point in points.items():
                axes.plot(*point, linestyle="none", **white_edged(8.0, color=colour, marker=_ring_marker(suffix)))
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(FuncFormatter(_seconds))
        axes.xaxis.set_minor_formatter(FuncFormatter(_seconds))
        axes.set_xlabel("wall time of the finest axisymmetric run, s")
        axes.set_ylabel("change of elongation against meshed PLA rings, %")
        axes.margins(0.12)
        grid(axes, which="both")
        entries = [entry(names[base], linewidth=4.0, color=_ACTUATORS[base]["color"]) for base in found]
        for suffix, label, _ in RING_VARIANTS:
            look = white_edged(8.0, color=_GREY, marker=_ring_marker(suffix))
            entries.append(entry(f"{label} rings", linestyle="none", **look))
        figure.legend(handles=entries, loc="outside right upper", frameon=False)
    return ""


def _ring_marker(suffix: str) -> str:
    return _RING_MARKERS[[variant for variant, _, _ in RING_VARIANTS].index(suffix)]


def _ring_points(results: PaperResults, base: str) -> dict[str, tuple[float, float]]:
    """By variant: wall time (s) and change of the tip (%) against meshed PLA; empty if there is nothing to compare.

    On the finest mesh, at the highest pressure that all reached.
    """
    variants = {suffix: results.variant(base, "rings", suffix).axisymmetric for suffix, _, _ in RING_VARIANTS}
    runs = {suffix: of_variant[-1] for suffix, of_variant in variants.items() if of_variant}
    tips = {
        suffix: {s.pressure_kpa: s.tip_mm for s in run.path if s.status == "requested"} for suffix, run in runs.items()
    }
    shared = set.intersection(*map(set, tips.values())) if tips else set()
    if REFERENCE_RING not in runs or len(runs) < 2 or not shared:
        return {}
    known = tips[REFERENCE_RING][max(shared)]
    return {
        suffix: (run.summary.time_s["total"], 100.0 * (tips[suffix][max(shared)] - known) / abs(known))
        for suffix, run in runs.items()
    }


def _seconds(value: float, _: int) -> str:
    """Label of a logarithmic tick; none where labels would touch."""
    text = f"{value:g}"
    return "" if text[0] in "79" else text
