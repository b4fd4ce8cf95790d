"""What the models of the rings cost, and what they change."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from matplotlib.ticker import FuncFormatter

from studies.paper.cases import REFERENCE_SCENES, RING_VARIANTS
from studies.paper.plots.layout import ACTUATORS, WIDTH_IN
from studies.paper.plots.paths import finest_run, name_of
from studies.paper.results import PaperResults
from studies.report.style import BLACK, entry, figure_file, grid, white_edged

_RING_MARKERS: Final = ("o", "s", "^")


def draw_rings(path: Path, results: PaperResults) -> str:
    """Draw what the rings' models cost (s) and what they change in the tip's elongation (% of meshed PLA's)."""
    found = {
        base: points for base in REFERENCE_SCENES if (points := _ring_points(results, base))
    }  # of four actuators; a variant without its meshed PLA has nothing to be compared with
    if not found:
        return "no actuator has been run with meshed PLA rings and others"
    with figure_file(path, WIDTH_IN, 4.4) as figure:
        axes = figure.add_subplot()
        axes.axhline(0.0, color=BLACK, linewidth=0.8, zorder=1.0)
        for base, points in found.items():
            colour = ACTUATORS[base]["color"]
            joined = sorted(points.values())
            axes.plot(*zip(*joined, strict=True), color=colour, linewidth=0.9, alpha=0.6)
            for label, (seconds, percent) in points.items():
                marker = _RING_MARKERS[[name for _, name, _ in RING_VARIANTS].index(label)]
                axes.plot(seconds, percent, linestyle="none", **white_edged(8.0, color=colour, marker=marker))
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(FuncFormatter(_seconds))
        axes.xaxis.set_minor_formatter(FuncFormatter(_seconds))
        axes.set_xlabel("wall time of the finest axisymmetric run, s")
        axes.set_ylabel("change of elongation against meshed PLA rings, %")
        axes.margins(0.12)
        grid(axes, which="both")
        named = {case.case.base: name_of(case.result.scene) for case in results.of("rings")}
        entries = [entry(label=named[base], linewidth=4.0, color=ACTUATORS[base]["color"]) for base in found]
        for (_, label, _), marker in zip(RING_VARIANTS, _RING_MARKERS, strict=True):
            look = white_edged(8.0, color="#555555", marker=marker)
            entries.append(entry(label=f"{label} rings", linestyle="none", **look))
        figure.legend(handles=entries, loc="outside right upper", frameon=False)
    return ""


def _ring_points(results: PaperResults, base: str) -> dict[str, tuple[float, float]]:
    """By variant: wall time (s) and change of the tip (%) against meshed PLA; empty if there is nothing to compare.

    On the finest mesh, at the highest pressure that all reached.
    """
    variants = {label: results.variant(base, "rings", suffix) for suffix, label, _ in RING_VARIANTS}
    runs = {label: run for label, case in variants.items() if case and (run := finest_run(case))}
    reference = RING_VARIANTS[1][1]
    if reference not in runs or len(runs) < 2:
        return {}
    tips = {
        label: {s.pressure_kpa: s.tip_mm for s in run.path if s.status == "requested"} for label, run in runs.items()
    }
    shared = set.intersection(*(set(tip) for tip in tips.values()))
    if not shared:
        return {}
    highest = max(shared)
    known = tips[reference][highest]
    return {
        label: (run.summary.time_s["total"], 100.0 * (tips[label][highest] - known) / abs(known))
        for label, run in runs.items()
    }


def _seconds(value: float, _: int) -> str:
    """Label of a logarithmic tick; none where labels would touch."""
    text = f"{value:g}"
    return "" if text[0] in "79" else text
