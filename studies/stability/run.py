"""Run a cell of the stress test and judge how it ended."""

from __future__ import annotations

import dataclasses
import hashlib
import inspect
import json
import math
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

import numpy as np
import tomlkit
from mpi4py import MPI

from analytical.laws.errors import MaterialError
from analytical.laws.stiff import StiffSolid
from meshes.bodies import sphere_meridian, tube_meridian
from meshes.errors import GeometryError, MeshError
from meshes.meridian import default_resolution, meridian_mesh
from meshes.solid import FACETS, REGIONS, SolidMesh
from meshes.surface import surface_weights
from solvers.assembly.surfaces import SOFT, STIFF, Surfaces
from solvers.discrete.domain import create_domain
from solvers.discrete.elements import P2_P0
from solvers.equilibrium.controls import HeldLoad, HeldVolume
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import Cause, SolverError, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.records import PathSettings
from solvers.problem import Problem
from solvers.state import State, combine, pressure_at_corners
from studies.models.build import Tip, scene_meridian, scene_problem
from studies.results import provenance
from studies.results.compare import MERIDIAN_ORDER
from studies.results.uncertainty import convergence, from_two
from studies.scene.bellows import Scene, inverse_kappa, law_of, load_scene, shape_of
from studies.scene.sections import SceneError
from studies.stability import controls as stability_controls
from studies.stability import exact as stability_exact
from studies.stability import meshes as stability_meshes
from studies.stability.cells import SCENE, Bellows, Cell, Flaw, Round
from studies.stability.controls import problem_with
from studies.stability.exact import exact_answer
from studies.stability.meshes import shaken, zigzag

Measure = Callable[[State], float]
Verdict = Literal["right", "refusal", "stop", "wrong"]
REFUSALS = (SceneError, GeometryError, MeshError, MaterialError, SolverError)

# What an answer may be off, percent: the default tolerance of a scene, on the coarsest meshes that scenes get. The
# pressure in a wall is not asked of a scene; this much of its largest value tells a wrong one from a coarse one.
TOLERANCE_PERCENT = 1.0
PRESSURE_TOLERANCE_PERCENT = 10.0
# Ranks and threads may change a value by this, percent.
SAME_PERCENT = 1e-6
# Levels of the bellows that a cell is compared with.
REFERENCE_LEVELS = (1, 2, 3)
# A vacuum is brought on in steps of this share of the volume, halved at most so often.
VACUUM_STEP, VACUUM_HALVINGS = 0.01, 8
POISSON = 0.36  # of rings of any modulus: that of the PLA


@dataclass(frozen=True)
class Outcome:
    """How a cell ended.

    Attributes
    ----------
    verdict
        ``right``: at the requested load and within the tolerance of what is known; ``refusal``: nothing solved, reason
        named; ``stop``: ended before the load, cause and reason named; ``wrong``: anything else, a crash included.
    share
        Highest load reached over what is known to be reachable (at most the requested load).
    value_mm, reference_mm, source
        Bore or tip, what it is compared with and where that is from; NaN and empty if there is none.
    error_percent, tolerance_percent
        Of the value, and what it may be off.
    pressure_error_percent
        Root mean square error of the pressure in the wall over its largest value; NaN if it is not known.
    reached_kpa
        Highest load reached.
    cause, reason
        Of a refusal, a stop or a wrong answer.
    newton_iterations, rejected
        Work.
    unstable
        Unstable modes in the last state; -1 if not counted.
    seconds
        Wall time.
    """

    verdict: Verdict
    share: float = math.nan
    value_mm: float = math.nan
    reference_mm: float = math.nan
    source: str = ""
    error_percent: float = math.nan
    tolerance_percent: float = TOLERANCE_PERCENT
    pressure_error_percent: float = math.nan
    reached_kpa: float = 0.0
    cause: str = ""
    reason: str = ""
    newton_iterations: int = 0
    rejected: int = 0
    unstable: int = -1
    seconds: float = 0.0


@dataclass(frozen=True)
class Reference:
    """A bellows on several meshes.

    Attributes
    ----------
    tip_mm, uncertainty_mm
        By load, kPa: on the finest mesh that reached it, and its uncertainty; loads that two meshes reached.
    reached_kpa
        Highest load that any mesh reached.
    """

    tip_mm: dict[float, float]
    uncertainty_mm: dict[float, float]
    reached_kpa: float


@dataclass(frozen=True)
class _End:
    """What a solver left behind: the state at the requested load if reached, else why not."""

    reached_kpa: float
    value_mm: float = math.nan
    pressure_error_percent: float = math.nan
    cause: str = ""
    reason: str = ""
    iterations: int = 0
    rejected: int = 0
    unstable: int = -1


# What decides outcomes beside the code that `provenance.code_hash` knows; where cells stand in maps does not.
_CODE: tuple[ModuleType, ...] = (stability_controls, stability_exact, stability_meshes, sys.modules[__name__])


def key_of(thing: Cell | tuple[Bellows, tuple[float, ...]]) -> str:
    """Key of the outcome of a cell, or of a reference with its loads: what is solved, and the code that does it."""
    if isinstance(thing, Cell):
        thing = dataclasses.replace(thing, axis="", row="", column="")
    code = [provenance.code_hash(), *(inspect.getsource(module) for module in _CODE)]
    return hashlib.sha256(json.dumps([repr(thing), *code]).encode()).hexdigest()[:24]


# --- one cell -----------------------------------------------------------------------------------------------


def run_cell(cell: Cell, comm: MPI.Comm, reference: Reference | None = None, alone_mm: float = math.nan) -> Outcome:
    """Solve a cell and judge it; every rank of ``comm`` calls, and nothing is raised.

    Parameters
    ----------
    cell
        Which.
    reference
        Of a bellows.
    alone_mm
        The value on one rank and one thread, for a cell that asks for more.
    """
    begin = time.perf_counter()
    try:
        outcome = _judged(cell, _solve(cell, comm), reference, alone_mm)
    except StepFailed as error:  # a path has to end in one, not to break
        outcome = Outcome("wrong", cause="crash", reason=f"{error.cause}: {error}")
    except REFUSALS as error:
        text = " ".join(str(error).split())
        outcome = Outcome("refusal", cause=type(error).__name__, reason=text)
    except Exception as error:  # a crash without a name is what this study is looking for
        outcome = Outcome("wrong", cause="crash", reason=f"{type(error).__name__}: {error}")
    return dataclasses.replace(outcome, seconds=time.perf_counter() - begin)


def _judged(cell: Cell, end: _End, reference: Reference | None, alone_mm: float) -> Outcome:
    known = _known(cell, reference)
    asked = abs(cell.load_kpa)
    reachable = min(asked, known.reachable_kpa)
    share = end.reached_kpa / reachable if reachable > 0.0 else math.nan
    outcome = Outcome(
        "stop",
        share=share,
        reference_mm=known.value_mm,
        source=known.source,
        tolerance_percent=known.tolerance_percent,
        reached_kpa=end.reached_kpa,
        cause=end.cause,
        reason=end.reason,
        newton_iterations=end.iterations,
        rejected=end.rejected,
        unstable=end.unstable,
    )
    if end.reason:
        return outcome
    error = 100.0 * (end.value_mm - known.value_mm) / abs(known.value_mm)
    faults = []
    if not abs(error) <= known.tolerance_percent:
        faults.append(f"{error:.3g} % off" if math.isfinite(error) else "reached a load that nothing else reaches")
    if end.pressure_error_percent > PRESSURE_TOLERANCE_PERCENT:
        faults.append(f"pressure in the wall {end.pressure_error_percent:.3g} % off")
    if math.isfinite(alone_mm) and abs(end.value_mm / alone_mm - 1.0) > 1e-2 * SAME_PERCENT:
        faults.append(f"{100.0 * (end.value_mm / alone_mm - 1.0):.3g} % from one rank and thread")
    return dataclasses.replace(
        outcome,
        verdict="wrong" if faults else "right",
        value_mm=end.value_mm,
        error_percent=error,
        pressure_error_percent=end.pressure_error_percent,
        cause="wrong answer" if faults else "",
        reason="; ".join(faults),
    )


@dataclass(frozen=True)
class _Known:
    value_mm: float
    tolerance_percent: float
    reachable_kpa: float
    source: str


def _known(cell: Cell, reference: Reference | None) -> _Known:
    if isinstance(cell.body, Round):
        answer = exact_answer(cell.body, 1e-3 * cell.load_kpa)
        return _Known(answer.bore_mm, TOLERANCE_PERCENT, 1e3 * abs(answer.reachable_mpa), f"exact {cell.body.kind}")
    if reference is None:
        return _Known(math.nan, TOLERANCE_PERCENT, abs(cell.load_kpa), "")
    load = abs(cell.load_kpa)
    tip = reference.tip_mm.get(load, math.nan)
    more = 100.0 * reference.uncertainty_mm.get(load, math.nan) / abs(tip)
    return _Known(tip, TOLERANCE_PERCENT + more, reference.reached_kpa, "converged on finer meshes")


# --- solving ------------------------------------------------------------------------------------------------


def _solve(cell: Cell, comm: MPI.Comm) -> _End:
    if isinstance(cell.body, Round):
        return _solve_round(cell, cell.body, comm)
    scene = scene_of(cell.body, abs(cell.load_kpa))
    mesh = comm.bcast(_bellows_mesh(scene, cell.body) if comm.rank == 0 else None)
    problem = _bellows_problem(scene, cell.body, mesh, comm, cell.flaw)
    tip = Tip(scene, mesh)
    ends = _loads(cell, problem, [abs(cell.load_kpa)], tip.mean_mm)
    return ends[0]


def _solve_round(cell: Cell, body: Round, comm: MPI.Comm) -> _End:
    mesh = _round_mesh(body)
    given = dataclasses.replace(mesh, regions=np.full(len(mesh.cells), SOFT)) if comm.rank == 0 else None
    domain = create_domain(comm, given)
    held = ((FACETS["axis"], 0), (FACETS["bottom"], 1), (FACETS["top"], 1))
    vacuum = cell.load_kpa < 0.0
    surfaces = Surfaces(external=FACETS["outer"], held=held) if vacuum else Surfaces(cavity=FACETS["cavity"], held=held)
    inverse = 1.0 / (body.kappa_over_mu * body.law.initial_shear_modulus_mpa)
    element = P2_P0 if body.element == "P2/P0" else None
    problem = problem_with(cell.flaw, domain, body.law, inverse, surfaces, element)
    weights = surface_weights(mesh, "cavity")
    outwards = mesh.points * np.array([1.0, float(body.kind == "sphere")])
    outwards[weights == 0.0] = 0.0
    inside = weights != 0.0
    outwards[inside] /= np.linalg.norm(outwards[inside], axis=1, keepdims=True)
    share = weights / weights.sum()

    def bore(state: State) -> float:
        return float(share @ np.sum(state.displacement_mm * outwards, axis=1))

    def pressure_error(state: State) -> float:
        answer = exact_answer(body, 1e-3 * cell.load_kpa)
        if answer.multiplier_mpa is None:
            return math.nan
        at = mesh.corners
        radius = mesh.points[at, 0] if body.kind == "tube" else np.linalg.norm(mesh.points[at], axis=1)
        # exact stresses are for a free outer surface, and a pressure there adds itself
        exact = answer.multiplier_mpa(radius) - (1e-3 * abs(cell.load_kpa) if vacuum else 0.0)
        found = pressure_at_corners(state, mesh.cells, mesh.cell.corners)[at]
        return float(100.0 * np.sqrt(np.mean((found - exact) ** 2)) / np.abs(exact).max())

    # the multiplier of the raw energy is another quantity
    known = None if cell.flaw == "raw energy" else pressure_error
    return _loads(cell, problem, [abs(cell.load_kpa)], bore, known)[0]


def _settings(cell: Cell) -> PathSettings:
    newton = NewtonSettings(relative_tolerance=cell.tolerance)
    usual = PathSettings(control=cell.control, newton=newton)
    if not cell.leap:
        return usual
    return dataclasses.replace(
        usual,
        start_control="volume" if cell.control == "volume" else "pressure",
        first_step=cell.leap * usual.first_step,
        largest_step=max(cell.leap * usual.first_step, usual.largest_step),
        first_pressure_step=1.0,
        largest_pressure_step=1.0,
    )


def _loads(
    cell: Cell, problem: Problem, loads_kpa: list[float], measure: Any, pressure_error: Any = None
) -> list[_End]:
    """Ends of a path at ascending loads: reached, or why not."""
    factor = Factor(problem)
    if cell.load_kpa < 0.0 and isinstance(cell.body, Bellows):
        scene = scene_of(cell.body, loads_kpa[-1])
        room_mm = 2.0 * scene.geometry.half_pitch_mm - scene.rings.seat_mm
        return _vacuum(problem, factor, loads_kpa, _settings(cell).newton, measure, room_mm)
    path = follow_path(problem, factor, [1e-3 * p for p in loads_kpa], _settings(cell))
    factor.close()
    asked = [s for s in path.states if s.asked]
    highest = max((1e3 * s.state.load_mpa for s in path.states), default=0.0)
    iterations = sum(s.newton.iterations for s in path.states)
    ends = []
    for state, kpa in zip(asked, loads_kpa, strict=False):
        excess = state.newton.excess_negatives
        ends.append(
            _End(
                kpa,
                measure(state.state),
                math.nan if pressure_error is None else pressure_error(state.state),
                iterations=iterations,
                rejected=path.rejected,
                unstable=-1 if excess is None else excess,
            )
        )
    stop = _End(highest, cause=str(path.cause), reason=path.reason, iterations=iterations, rejected=path.rejected)
    return ends + [stop] * (len(loads_kpa) - len(ends))


def _vacuum(
    problem: Problem,
    factor: Factor,
    loads_kpa: list[float],
    newton: NewtonSettings,
    measure: Measure,
    room_mm: float,
) -> list[_End]:
    """Ends of the path of a cavity that is evacuated, which scenes do not ask for: steps of falling volume.

    The path ends where the vacuum has a largest value, as what comes after is another shape of the body, and where
    rings have moved together by the room between them.
    """
    problem.set_state(problem.zero_state())
    unit = problem.volume_unit_mm3
    here = before = (problem.get_state(), problem.cavity_volume())
    step, iterations, rejected = VACUUM_STEP * unit, 0, 0
    ends: list[_End] = []

    def guess(volume: float) -> State:
        span = here[1] - before[1]
        ahead = (volume - here[1]) / span if span else 0.0
        return combine([here[0], before[0]], [1.0 + ahead, -ahead])

    while True:
        reached = -1e3 * here[0].load_mpa
        volume = here[1] - step
        problem.set_state(guess(volume))
        try:
            report = solve_equilibrium(problem, factor, newton, HeldVolume(volume))
            iterations += report.iterations
            found = (problem.get_state(), volume)
            nearest = room_mm + float(np.diff(found[0].bodies_mm[:, 0]).min())
            if nearest <= 0.0:
                why = f"rings touch beyond {reached:.4g} kPa, and contact is not modelled"
                stop = _End(reached, cause="contact", reason=why, iterations=iterations, rejected=rejected)
                return ends + [stop] * (len(loads_kpa) - len(ends))
            for kpa in loads_kpa[len(ends) :]:
                if -1e3 * found[0].load_mpa < kpa:
                    break
                part = (kpa - reached) / (-1e3 * found[0].load_mpa - reached)
                problem.set_state(combine([here[0], found[0]], [1.0 - part, part]))
                report = solve_equilibrium(problem, factor, newton, HeldLoad(-1e-3 * kpa))
                if not found[1] - 1e-6 * unit <= problem.cavity_volume() <= here[1] + 1e-6 * unit:
                    raise StepFailed("pressure control left the path")
                iterations += report.iterations
                excess = report.excess_negatives
                value = measure(problem.get_state())
                unstable = -1 if excess is None else excess
                ends.append(_End(kpa, value, iterations=iterations, rejected=rejected, unstable=unstable))
        except StepFailed as failure:
            rejected, step = rejected + 1, 0.5 * step
            if step < unit * VACUUM_STEP / 2**VACUUM_HALVINGS:
                stop = _End(reached, cause=str(failure.cause), reason=str(failure), rejected=rejected)
                return ends + [stop] * (len(loads_kpa) - len(ends))
            continue
        if len(ends) == len(loads_kpa):
            return ends
        if found[0].load_mpa >= here[0].load_mpa:
            why = (
                f"limit point of the vacuum near {reached:.4g} kPa, at {100.0 * here[1] / unit:.3g} % of the volume: "
                "beyond it the bellows folds in by itself"
            )
            stop = _End(reached, cause=str(Cause.LIMIT_POINT), reason=why, iterations=iterations, rejected=rejected)
            return ends + [stop] * (len(loads_kpa) - len(ends))
        before, here = here, found


# --- bodies -------------------------------------------------------------------------------------------------


def _round_mesh(body: Round) -> SolidMesh:
    inner, outer = body.inner_mm, body.inner_mm + body.wall_mm
    if body.kind == "tube":
        mesh = tube_meridian(inner, outer, body.length_mm, body.along, body.through, body.cells)
    else:
        mesh = sphere_meridian(inner, outer, body.along, body.through, body.cells)
    if body.zigzag:
        mesh = zigzag(mesh, body.zigzag, polar=body.kind == "sphere")
    return shaken(mesh, body.noise, body.seed) if body.noise else mesh


def scene_of(body: Bellows, load_kpa: float) -> Scene:
    """The scene of a bellows, through the same checks as a user's file.

    Raises
    ------
    SceneError
        If a change is not allowed.
    """
    document = tomlkit.parse((provenance.ROOT / "scenes" / f"{SCENE}.toml").read_text(encoding="utf-8"))
    for key, value in (("load.pressure_kpa", [load_kpa]), *body.changes):
        section, name = key.split(".")
        table: Any = document.setdefault(section, {})
        table[name] = list(value) if isinstance(value, tuple) else value
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "scene.toml")
        path.write_text(tomlkit.dumps(document), encoding="utf-8")
        try:
            return load_scene(path)
        except SceneError as error:
            raise SceneError(str(error).replace(f"{path}: ", "")) from None


def _bellows_mesh(scene: Scene, body: Bellows) -> SolidMesh:
    if body.cell_mm is None and body.through is None:
        mesh = scene_meridian(scene, body.level)
    else:
        shape = shape_of(scene)
        usual = default_resolution(shape, body.level, "quadrilaterals")
        fine = dataclasses.replace(usual, cell_mm=body.cell_mm or usual.cell_mm, through=body.through or usual.through)
        mesh = meridian_mesh(shape, fine, None, "quadrilaterals")
    return shaken(mesh, body.noise, body.seed) if body.noise else mesh


def _bellows_problem(scene: Scene, body: Bellows, mesh: SolidMesh, comm: MPI.Comm, flaw: Flaw = "") -> Problem:
    """Of the scene; of meshed rings with another modulus; or of a control, without rings."""
    if body.contrast is None and not flaw:
        return scene_problem(scene, mesh if comm.rank == 0 else None, comm)
    numbers = np.where(mesh.regions == REGIONS["ring"], STIFF, SOFT)
    domain = create_domain(comm, dataclasses.replace(mesh, regions=numbers) if comm.rank == 0 else None)
    law = law_of(scene.material)
    surfaces = Surfaces(cavity=FACETS["cavity"], clamped=FACETS["clamped"], held=((FACETS["axis"], 0),))
    if body.contrast is None:
        assert scene.rings.model == "none"
        return problem_with(flaw, domain, law, inverse_kappa(scene.material), surfaces)
    rings = StiffSolid(3.0 * law.initial_shear_modulus_mpa * body.contrast, POISSON, 1.0)
    return Problem(domain, law, inverse_kappa(scene.material), surfaces, rings)


# --- references ---------------------------------------------------------------------------------------------


def reference_of(body: Bellows, loads_kpa: tuple[float, ...]) -> Reference:
    """The bellows itself on three meshes, at loads of one sign (negative: a vacuum); on this process alone."""
    vacuum = loads_kpa[0] < 0.0
    loads = sorted(abs(p) for p in loads_kpa)
    tips: dict[float, dict[int, float]] = {p: {} for p in loads}
    highest = 0.0
    for level in REFERENCE_LEVELS:
        fine = dataclasses.replace(body.ideal, level=level)
        try:
            scene = scene_of(fine, loads[-1])
            mesh = _bellows_mesh(scene, fine)
            problem = _bellows_problem(scene, fine, mesh, MPI.COMM_SELF)
        except REFUSALS:
            return Reference({}, {}, loads[-1])
        cell = Cell("", "", "", fine, -loads[-1] if vacuum else loads[-1])
        for load, end in zip(loads, _loads(cell, problem, loads, Tip(scene, mesh).mean_mm), strict=True):
            highest = max(highest, end.reached_kpa)
            if not end.reason:
                tips[load][level] = end.value_mm
    values, spreads = {}, {}
    for load, found in tips.items():
        if len(found) < 2:
            continue
        levels = sorted(found)
        sizes, series = [1.0 / n for n in levels], [found[n] for n in levels]
        fit = convergence if len(levels) == 3 else from_two
        values[load] = series[-1]
        spreads[load] = fit(sizes, series, MERIDIAN_ORDER).uncertainty(series[-1])
    return Reference(values, spreads, highest)


# --- files --------------------------------------------------------------------------------------------------


def outcome_text(outcome: Outcome) -> str:
    """As JSON."""
    return json.dumps(asdict(outcome), indent=1) + "\n"


def read_outcome(text: str) -> Outcome:
    """From JSON."""
    return Outcome(**json.loads(text))


def reference_text(reference: Reference) -> str:
    """As JSON; loads are keys as text."""
    return json.dumps(asdict(reference), indent=1) + "\n"


def read_reference(text: str) -> Reference:
    """From JSON."""
    data = json.loads(text)
    tips, spreads = ({float(k): v for k, v in data[name].items()} for name in ("tip_mm", "uncertainty_mm"))
    return Reference(tips, spreads, data["reached_kpa"])
