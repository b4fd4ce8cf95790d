"""Results of the paper study made up for tests: every number is a simple function of case, mesh and pressure."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping
from pathlib import Path

from studies.paper.cases import Case, case_text, cases
from studies.paper.results import CaseResult, PaperResults
from studies.results.bellows_rows import bellows_rows
from studies.results.rows import REACHED, Row, row
from studies.results.run_files import PathRow, RunSummary
from studies.results.runs import Run
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows

ALL = {(case.group, case.scene): case for case in cases()}
# Enough of each kind for every table; three have a rank correlation.
SOME_SETS = ("corrected-01", "balanced-01", "reference-01", "reference-02", "reference-03")
# Elongation at 20 kPa, mm, by wall and by whether the root is the larger one.
TIPS = {(1.0, False): 150.0, (1.0, True): 100.0, (2.0, False): 70.0, (2.0, True): 45.0}
# By how much the middle of the closed end goes further than its rim.
BULGE_MM_PER_KPA = 0.1
# Relative error of a mesh: second order in the meridian, nothing round the circumference.
ERRORS = {"r1": 0.004, "r2": 0.001, "r4": 0.00025, "r8": 0.0000625}


def case_of(group: str, name: str) -> Case:
    return next(case for (of, called), case in ALL.items() if (of, called) == (group, name))


Tip = Callable[[str, float], float]


@functools.cache
def scene_of(group: str, name: str) -> BellowsScene:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "scene.toml")
        file.write_text(case_text(case_of(group, name)), encoding="utf-8")
        return load_bellows(file)


def usual_tip(scene: BellowsScene) -> Tip:
    """Elongation, mm, by mesh and pressure: steep at first, then nearly straight."""
    larger = scene.geometry.root_radius_mm > 5.0
    at_20 = TIPS[scene.geometry.wall_mm, larger]

    def tip(level: str, pressure: float) -> float:
        error = ERRORS.get(level, ERRORS["r1"])
        return at_20 * (0.8 * pressure / 20.0 + 0.2 * math.sqrt(pressure / 20.0)) * (1.0 + error)

    return tip


def make_run(
    scene: BellowsScene,
    model: str,
    level: str,
    tip: Tip,
    stop_kpa: float = math.inf,
    iterations: Callable[[float], int] = lambda pressure: 4,
) -> Run:
    path = []
    for number, pressure in enumerate(p for p in scene.load.pressure_kpa if p <= stop_kpa):
        state = PathRow(
            pressure, "volume", tip(level, pressure), tip(level, pressure) + BULGE_MM_PER_KPA * pressure, 0.0,
            1.0, 1.0, 1.0, 0.9, 1.0, 0.0, "",
            iterations(pressure), 2.0 * (number + 1), "requested", 0.01,
        )  # fmt: skip
        force = 0.1 * pressure if scene.blocked else 0.0
        path.append(dataclasses.replace(state, tip_force_n=force))
    reached = stop_kpa >= max(scene.load.pressure_kpa)
    summary = RunSummary(
        scene=scene.name,
        model=model,
        level=level,
        status=REACHED if reached else "stopped",
        reason="" if reached else "no convergence | <at all>",
        content_hash="0",
        plan=("ring interiors: rigid rings are within the tolerance",),
        dofs=1000,
        cells=100,
        nodes=200,
        factorisations=10,
        newton_iterations=20,
        rejected_steps=0,
        silicone_g=18.6,
        ring_g=5.9,
        time_s={"mesh": 1.0, "factor": 2.5, "total": 4.0},
        peak_mb=321.0,
        versions={"dolfinx": "0.5.2"},
        blas="OpenBLAS",
        ranks=1,
        threads=1,
        commit="abc",
        when="2026-01-04",
    )
    return Run(summary, tuple(path))


def make_case(
    case: Case,
    tip: Tip | None = None,
    stop_kpa: float = math.inf,
    measured: Mapping[str, Callable[[float], float]] | None = None,
    iterations: Callable[[float], int] = lambda pressure: 4,
    levels: tuple[str, ...] = ("r1", "r2", "r4"),
    bodies: tuple[str, ...] = (),
    extra: tuple[Row, ...] = (),
) -> CaseResult:
    """A case with axisymmetric runs on some meshes and full 3D ones on others; measured by quantity of the pressure."""
    scene = scene_of(case.group, case.scene)
    tip = tip or usual_tip(scene)
    flat = [make_run(scene, "axisymmetric", level, tip, stop_kpa, iterations) for level in levels]
    solid = [make_run(scene, "full3d", level, tip, stop_kpa, iterations) for level in bodies]
    rows = bellows_rows(scene, [*flat, *solid])
    found = [
        row(scene.name, quantity, "1", p, "axisymmetric", value(p), "r4", 0.001)
        for quantity, value in (measured or {}).items()
        for p in scene.load.pressure_kpa
    ]
    return CaseResult(case, Path("nowhere"), scene, tuple(flat), tuple(solid), (*rows, *found, *extra))


def make_results(*cases_: CaseResult) -> PaperResults:
    return PaperResults(cases_)


def whole() -> PaperResults:
    """Every case of the study as the paper would have it; of the many drawn sets some."""
    found = []
    for case in ALL.values():
        if case.group == "sets" and case.label not in SOME_SETS:
            continue
        bodies = {
            "core": ("n8",),
            "zigzag": ("n8",),
            "tets": ("n12",),
            "control": ("n8",),
            "audit": ("n12r3",) if case.full3d else (),
        }.get(case.group, ())
        levels = {"audit": ("r8",), "control": ("r1",)}.get(case.group, ("r1", "r2", "r4"))
        found.append(make_case(case, bodies=bodies, levels=levels, measured={"root_stretch_outer": lambda p: 1.0 + p}))
    return PaperResults(tuple(found))
