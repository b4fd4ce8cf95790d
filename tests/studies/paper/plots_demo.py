"""Results of the paper study for tests of its plots: straight lines; and what is drawn on a figure."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import pytest
from matplotlib.figure import Figure

from studies.paper.cases import Case, Group, case_text, cases
from studies.paper.results import CaseResult, PaperResults
from studies.report.style import figure_file
from studies.results.rows import Row, row
from studies.results.run_files import PathRow, RunSummary
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene

# Elongation per kPa of the made-up models, mm.
SLOPES = {
    "closed_form_printed": 3.0,
    "closed_form": 3.2,
    "closed_form_balanced": 4.1,
    "closed_form_seat": 3.6,
    "axisymmetric": 5.0,
    "full3d": 5.1,
}
PRINTED = {"paper_closed_form": 66.0, "paper_ansys": 78.0, "paper_experiment": 76.0}


def summary(model: str, level: str, seconds: float, cause: str = "", crossing_kpa: float = math.nan) -> RunSummary:
    crossing = {"kind": cause, "pressure_kpa": crossing_kpa, "within_kpa": 0.5}
    return RunSummary(
        scene="made-up",
        model=model,
        level=level,
        status="stopped" if cause else "reached",
        reason=cause,
        content_hash="0",
        plan=(),
        dofs=1,
        cells=1,
        nodes=1,
        factorisations=1,
        newton_iterations=1,
        rejected_steps=0,
        silicone_g=19.0,
        ring_g=5.0,
        time_s={"total": seconds},
        peak_mb=1.0,
        versions={},
        blas="",
        ranks=1,
        threads=1,
        commit="",
        when="",
        cause=cause,
        crossing={} if math.isnan(crossing_kpa) else crossing,
    )


def state(pressure: float, tip: float, force: float, modes: float, status: str) -> PathRow:
    nan = math.nan
    return PathRow(pressure, "auto", tip, tip, force, nan, nan, nan, nan, nan, modes, "", 1, 1.0, status, nan)


def made_up(
    case: Case,
    stop_kpa: float = math.inf,
    bar_mm: float = 0.2,
    cause: str = "limit point",
    crossing_kpa: float = math.nan,
) -> CaseResult:
    """A case whose models are straight lines.

    Parameters
    ----------
    stop_kpa
        Where the axisymmetric path stops.
    bar_mm
        Uncertainty of axisymmetric rows.
    cause, crossing_kpa
        Why it stops, and from where on its states have an unstable mode.
    """
    scene = BellowsScene.model_validate(tomllib.loads(case_text(case)))
    asked = [p for p in scene.load.pressure_kpa if p <= stop_kpa]
    rows: list[Row] = []

    def add(quantity: str, unit: str, pressure: float, model: str, value: float, **more: str | float) -> None:
        rows.append(row(scene.name, quantity, unit, pressure, model, value, **more))  # type: ignore[arg-type]

    for p in scene.load.pressure_kpa:
        for model, slope in SLOPES.items():
            if model == "axisymmetric":
                add("tip_mm", "mm", p, model, 9.9 * p, level="r1")  # coarse: must not be drawn
                add("tip_mm", "mm", p, model, slope * p, level="r4", uncertainty=bar_mm)
            elif model != "full3d" or case.full3d:
                add("tip_mm", "mm", p, model, slope * p, uncertainty=0.2)
        add("tip_force_n", "N", p, "closed_form", 0.2 * p)
        add("extension_force_n", "N", p, "closed_form", 0.1 * p)
        if p <= stop_kpa:
            add("peak_stretch_away", "1", p, "axisymmetric", 1.0 + 0.2 * p, level="r4")
    for model, value in PRINTED.items():
        add("tip_mm", "mm", 20.0, model, value)
    slope = SLOPES["axisymmetric"]
    ends = [p for p in (stop_kpa - 1.0, stop_kpa) if asked[-1] < p < math.inf]
    modes = {p: float(p >= crossing_kpa) for p in (*asked, *ends)}
    path = [state(p, slope * p, 0.15 * p, modes[p], "requested" if p in asked else "step") for p in modes]
    why = cause if stop_kpa < math.inf else ""
    run = Run(summary("axisymmetric", "r4", 10.0, why, crossing_kpa), tuple(path))
    return CaseResult(case, Path("nowhere"), scene, (run,), rows=tuple(rows))


def results(*groups: Group, make: Callable[[Case], CaseResult] = made_up) -> PaperResults:
    return PaperResults(tuple(make(case) for case in cases(*groups)))


def missing_one(found: PaperResults, base: str) -> PaperResults:
    return PaperResults(tuple(case for case in found.cases if case.case.base != base))


def kept_figures(monkeypatch: pytest.MonkeyPatch, *modules: ModuleType) -> list[Figure]:
    """The figures that modules write from now on."""
    figures: list[Figure] = []

    @contextmanager
    def keep(path: Path, width_in: float, height_in: float) -> Iterator[Figure]:
        with figure_file(path, width_in, height_in) as figure:
            figures.append(figure)
            yield figure

    for module in modules:
        monkeypatch.setattr(module, "figure_file", keep)
    return figures


def legend(figure: Figure) -> list[str]:
    return [text.get_text() for found in figure.legends for text in found.get_texts()]


def ends(line) -> tuple[list[float], list[float]]:
    return list(line.get_xdata()), list(line.get_ydata())


def curves(axes) -> dict[str, tuple[list[float], list[float]]]:
    """What is drawn on axes by its label."""
    found = {box.get_label(): box.lines[0] for box in axes.containers}
    found |= {line.get_label(): line for line in axes.lines if not line.get_label().startswith("_")}
    return {label: ends(line) for label, line in found.items()}


def at(curve: tuple[list[float], list[float]], pressure: float) -> float:
    """A curve's value where it has a point."""
    return next(value for p, value in zip(*curve, strict=True) if math.isclose(p, pressure, abs_tol=1e-9))
