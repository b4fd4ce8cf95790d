"""The cases of the branch study: two spheres on one cavity, Rivlin's cube, a bent ring, a blocked bellows that squirms.

Each case is followed through its limit points or onto its branches, beside what is known of it exactly.
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from mpi4py import MPI
from scipy.spatial import cKDTree

from analytical.exact import cube
from analytical.exact.elastica import CRITICAL_LOAD, LARGEST_MOVE, bent_ring
from analytical.exact.ring import first_buckling
from analytical.exact.sphere import Sphere
from analytical.exact.tube import Tube
from analytical.exact.two_spheres import TwoSpheres
from analytical.laws.isotropic import NeoHooke
from meshes.bodies import block, sphere_meridian, tube_meridian
from meshes.solid import FACETS, FloatArray, SolidMesh
from meshes.sweep import revolve_hexahedra
from solvers.assembly.surfaces import Surfaces
from solvers.discrete.domain import create_domain
from solvers.linear.factor import Factor
from solvers.paths.branch import BranchSettings, follow_branch
from solvers.paths.path import follow_path
from solvers.paths.records import Crossing, GuessMemory, PathSettings, PathState
from solvers.paths.warm_start import follow_guesses
from solvers.problem import Problem
from solvers.state import State
from studies.models.build import revolve_state, scene_body, scene_meridian, scene_problem
from studies.results import provenance
from studies.scene.bellows import Scene, load_scene

LAW: Final = NeoHooke(0.1)
SPHERES: Final = TwoSpheres(Sphere(5.0, 6.5), Sphere(15.0, 19.7))
RING_MM: Final = (10.0, 10.4)
SQUIRM_SCENE: Final = provenance.ROOT / "scenes" / "branches" / "short-blocked.toml"
SQUIRM_AROUND: Final = 8
SQUIRM_KPA: Final = 3.0
# What the crossing of the blocked bellows is located to, of its pressure.
SQUIRM_TOLERANCE: Final = 1e-3
_PLANES: Final = ("symmetry_x", "symmetry_y", "symmetry_z")


@dataclass(frozen=True)
class Point:
    """A state of a path or branch.

    Attributes
    ----------
    branch
        Which one, in words.
    load_kpa
        Load factor.
    move
        What is drawn it over, in the case's unit.
    exact_kpa
        The exact load at this move; NaN where nothing is known.
    volume_mm3, force_n
        Volume of the load, and force at the end; NaN where they say nothing.
    unstable, unstable_at_volume
        Unstable modes at held load and at held volume.
    control
        What was held in the solve.
    """

    branch: str
    load_kpa: float
    move: float
    exact_kpa: float
    volume_mm3: float
    force_n: float
    unstable: int
    unstable_at_volume: int
    control: str


@dataclass(frozen=True)
class Fact:
    """A number of a case beside its reference (NaN for none)."""

    quantity: str
    unit: str
    value: float
    reference: float
    source: str


@dataclass(frozen=True)
class CaseResult:
    """What a case gave."""

    name: str
    points: tuple[Point, ...]
    facts: tuple[Fact, ...]
    unknowns: int
    seconds: float


def _point(branch: str, item: PathState, move: float, exact_mpa: float, force: bool = False) -> Point:
    report = item.newton
    assert report.excess_negatives is not None and report.excess_at_volume is not None
    return Point(
        branch,
        1e3 * item.state.load_mpa,
        move,
        1e3 * exact_mpa,
        item.volume_mm3,
        item.end_force_n if force else math.nan,
        report.excess_negatives,
        report.excess_at_volume,
        item.control,
    )


# --- two spheres ----------------------------------------------------------------------------


def two_spheres(_: MPI.Comm) -> CaseResult:
    """Two spheres on one cavity: the volume turns back, which arc length passes and volume control does not."""
    begin = time.perf_counter()
    small, large = SPHERES.small, SPHERES.large
    parts = [sphere_meridian(s.inner_radius_mm, s.outer_radius_mm, 8, 2, "quadrilaterals") for s in (small, large)]
    mesh = _joined(parts[0], dataclasses.replace(parts[1], points=parts[1].points + [0.0, 100.0]))
    surfaces = Surfaces(cavity=FACETS["cavity"], held=((FACETS["axis"], 0), (FACETS["bottom"], 1)))
    problem = Problem(create_domain(MPI.COMM_SELF, mesh), LAW, 0.0, surfaces)
    factor = Factor(problem)
    bore = np.flatnonzero(np.abs(np.hypot(*mesh.points.T) - small.inner_radius_mm) < 1e-9)
    paths = {
        control: follow_path(problem, factor, [0.05], PathSettings(control=control, largest_volume=4.0))
        for control in ("arc", "auto", "volume")
    }
    points = []
    for control, path in paths.items():
        for item in path.states:
            at = np.hypot(*(mesh.points[bore] + item.state.displacement_mm[bore]).T).mean() / small.inner_radius_mm
            points.append(_point(control, item, float(at), SPHERES.at(LAW, float(at)).pressure_mpa))
    limit, back, forward = SPHERES.limit(LAW), *SPHERES.folds(LAW)
    crossing = paths["arc"].crossing
    assert crossing is not None
    volumes = np.array([p.volume_mm3 for p in points if p.branch == "arc"])
    turn = int(np.flatnonzero(np.diff(volumes) < 0.0)[0])
    again = turn + int(np.flatnonzero(np.diff(volumes[turn:]) > 0.0)[0])
    stopped = [p for p in points if p.branch == "volume"][-1]
    facts = (
        Fact("limit_kpa", "kPa", 1e3 * crossing.pressure_mpa, 1e3 * limit.pressure_mpa, "exact"),
        Fact("limit_mm3", "mm^3", crossing.volume_mm3, limit.volume_mm3, "exact"),
        Fact("fold_back_mm3", "mm^3", float(volumes[turn]), back.volume_mm3, "exact"),
        Fact("fold_forward_mm3", "mm^3", float(volumes[again]), forward.volume_mm3, "exact"),
        Fact("volume_control_ends_mm3", "mm^3", stopped.volume_mm3, back.volume_mm3, "exact turn of the volume"),
    )
    return CaseResult("two-spheres", tuple(points), facts, _unknowns(problem), time.perf_counter() - begin)


def _joined(one: SolidMesh, other: SolidMesh) -> SolidMesh:
    """Two meshes of the same cells as one, apart from each other."""
    n = len(one.points)
    return SolidMesh(
        points=np.vstack([one.points, other.points]),
        cells=np.vstack([one.cells, other.cells + n]),
        regions=np.concatenate([one.regions, other.regions]),
        facets=np.vstack([one.facets, other.facets + n]),
        facet_tags=np.concatenate([one.facet_tags, other.facet_tags]),
        facet_bodies=np.concatenate([one.facet_bodies, other.facet_bodies]),
        tip_centre_node=one.tip_centre_node,
    )


def _unknowns(problem: Problem) -> int:
    return int(problem.index_map.size_global + problem.extra)


# --- Rivlin's cube --------------------------------------------------------------------------


def rivlin_cube(_: MPI.Comm) -> CaseResult:
    """An eighth of Rivlin's cube between its planes of symmetry: plates and rods."""
    begin = time.perf_counter()
    mesh = block((1.0, 1.0, 1.0), (1, 1, 1))
    tags = mesh.facet_tags.copy()
    for k, facet in enumerate(mesh.facets):
        for axis in np.flatnonzero(np.abs(mesh.points[facet]).max(axis=0) < 1e-12):
            tags[k] = FACETS[_PLANES[axis]]
    mesh = dataclasses.replace(mesh, facet_tags=tags)
    held = tuple((FACETS[name], i) for i, name in enumerate(_PLANES))
    problem = Problem(create_domain(MPI.COMM_SELF, mesh), LAW, 0.0, Surfaces(dead=FACETS["outer"], held=held))
    factor = Factor(problem)
    mu = LAW.initial_shear_modulus_mpa
    crossing = follow_path(problem, factor, [2.5 * mu], PathSettings(control="pressure")).crossing
    assert crossing is not None and crossing.mode is not None
    mode = dataclasses.replace(crossing.mode, displacement_mm=mesh.points * [0.5, 0.5, -1.0])
    far = int(np.argmax(mesh.points.sum(axis=1)))
    points = []
    for branch, amplitude in (("plates", 0.05), ("rods", -0.05)):
        settings = BranchSettings(amplitude)
        for item in follow_branch(problem, factor, crossing, 2.4 * mu, settings, mode=mode).states:
            stretch = 1.0 + float(item.state.displacement_mm[far, 0])
            points.append(_point(branch, item, stretch, float(cube.branch_tension_mpa(LAW, stretch))))
    least = cube.tangent_point(LAW)
    facts = (
        Fact("critical_kpa", "kPa", 1e3 * crossing.pressure_mpa, 1e3 * cube.trivial_limit_mpa(LAW), "exact"),
        Fact(
            "least_on_plates_kpa", "kPa", min(p.load_kpa for p in points), 1e3 * least.tension_mpa, "exact, next state"
        ),
    )
    return CaseResult("cube", tuple(points), facts, _unknowns(problem), time.perf_counter() - begin)


# --- the bent ring --------------------------------------------------------------------------


def thin_ring(_: MPI.Comm) -> CaseResult:
    """A thin ring under outside pressure beyond buckling into two waves, beside the elastica."""
    begin = time.perf_counter()
    inner, outer = RING_MM
    wall, middle = outer - inner, 0.5 * (inner + outer)
    mesh = revolve_hexahedra(tube_meridian(inner, outer, 0.5 * wall, 1, 2, "quadrilaterals"), 16, 0.5 * math.pi)
    held = ((FACETS["start"], 1), (FACETS["end"], 0), (FACETS["bottom"], 2), (FACETS["top"], 2))
    problem = Problem(create_domain(MPI.COMM_SELF, mesh), LAW, 0.0, Surfaces(external=FACETS["outer"], held=held))
    factor = Factor(problem)
    exact = first_buckling(Tube(inner, outer), LAW, 2, "follower").pressure_mpa
    crossing = follow_path(problem, factor, [1.2 * exact], PathSettings()).crossing
    assert crossing is not None
    ends = [int(np.argmin(np.linalg.norm(mesh.points - at, axis=1))) for at in ([middle, 0, 0], [0, middle, 0])]

    def moves(item: PathState) -> FloatArray:
        u = item.state.displacement_mm
        return np.array([u[ends[0], 0], u[ends[1], 1]]) / middle

    points = []
    for branch, amplitude in (("long axis along y", 0.02 * middle), ("long axis along x", -0.02 * middle)):
        settings = BranchSettings(amplitude, most_states=12)
        path = follow_branch(
            problem, factor, crossing, 1.3 * crossing.pressure_mpa, settings,
            until=lambda item: moves(item).max() > 0.9 * LARGEST_MOVE,
        )  # fmt: skip
        for item in path.states:
            outward = float(moves(item).max())
            known = bent_ring(outward).load / CRITICAL_LOAD * crossing.pressure_mpa
            points.append(_point(branch, item, outward, known))
    facts = (Fact("critical_kpa", "kPa", 1e3 * crossing.pressure_mpa, 1e3 * exact, "exact, thick ring"),)
    return CaseResult("ring", tuple(points), facts, _unknowns(problem), time.perf_counter() - begin)


# --- a blocked bellows ----------------------------------------------------------------------


def mirrored(mesh: SolidMesh, state: State) -> State:
    """A state of a whole body reflected in the plane y = 0; pressures in the solid are left out (zero)."""
    _, other = cKDTree(mesh.points).query(mesh.points * [1.0, -1.0, 1.0])
    # translations along y, and rotations about x and z, change their sign
    bodies = state.bodies_mm * np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    return State(state.displacement_mm[other] * [1.0, -1.0, 1.0], 0.0 * state.pressure_mpa, bodies, state.load_mpa)


def in_plane(mesh: SolidMesh, mode: State) -> State:
    """The part of a mode that keeps the plane y = 0, 1 mm at most.

    Sideways modes of a body of revolution come in pairs, and every direction of a pair is as good: in the plane of
    symmetry the path keeps to one.
    """
    other = mirrored(mesh, mode)
    displacement = 0.5 * (mode.displacement_mm + other.displacement_mm)
    size = float(np.abs(displacement).max())
    bodies = 0.5 * (mode.bodies_mm + other.bodies_mm) / size
    return State(displacement / size, other.pressure_mpa, bodies, mode.load_mpa)


class _Found(Exception):
    """The crossing that a path was followed for has been located."""


def blocked_bellows(comm: MPI.Comm) -> CaseResult:
    """A short bellows with its tip blocked, in full 3D over all ranks: beyond where it bends out sideways."""
    begin = time.perf_counter()
    scene = load_scene(SQUIRM_SCENE)
    meridian = comm.bcast(scene_meridian(scene, 1) if comm.rank == 0 else None)
    straight = comm.bcast(_straight(scene, meridian) if comm.rank == 0 else None)
    body = scene_body(meridian, "full3d", SQUIRM_AROUND)
    problem = scene_problem(scene, body if comm.rank == 0 else None, comm)
    factor = Factor(problem)
    crossing = _crossing(problem, factor, [revolve_state(item.state, meridian, body) for item in straight])
    assert crossing.mode is not None
    at = [item.state.load_mpa for item in straight]
    force = [item.end_force_n for item in straight]
    settings = BranchSettings(0.3, most_states=25)
    path = follow_branch(problem, factor, crossing, 1e-3 * SQUIRM_KPA, settings, mode=in_plane(body, crossing.mode))
    points = [_point("kept straight", item, 0.0, math.nan, force=True) for item in straight]
    for item in path.states:
        sideways = float(np.abs(item.state.bodies_mm[:, 0]).max())
        points.append(_point("bent out", item, sideways, math.nan, force=True))
    last = path.states[-1]
    held = float(np.interp(last.state.load_mpa, at, force))
    facts = (
        Fact("critical_kpa", "kPa", 1e3 * crossing.pressure_mpa, math.nan, ""),
        Fact("modes_at_crossing", "", float(crossing.modes_after - crossing.modes_before), 2.0, "a pair, by symmetry"),
        Fact("last_kpa", "kPa", 1e3 * last.state.load_mpa, math.nan, ""),
        Fact("force_bent_out_n", "N", last.end_force_n, held, "kept straight, axisymmetric"),
        Fact("sideways_mm", "mm", points[-1].move, math.nan, ""),
        Fact("across_mm", "mm", float(np.abs(last.state.bodies_mm[:, 1]).max()), 0.0, "plane of symmetry"),
    )
    return CaseResult("blocked-bellows", tuple(points), facts, _unknowns(problem), time.perf_counter() - begin)


def _straight(scene: Scene, meridian: SolidMesh) -> list[PathState]:
    """The axisymmetric path of the blocked bellows, at the requested pressures."""
    problem = scene_problem(scene, meridian, MPI.COMM_SELF)
    path = follow_path(problem, Factor(problem), scene.pressures_mpa, PathSettings())
    return [item for item in path.states if item.asked]


def _crossing(problem: Problem, factor: Factor, guesses: list[State]) -> Crossing:
    """Where a path along guesses first loses stability."""
    found: list[Crossing] = []

    def look(memory: GuessMemory) -> None:
        if memory.crossing is not None:
            found.append(memory.crossing)
            raise _Found

    settings = PathSettings(crossing_tolerance=SQUIRM_TOLERANCE)
    try:
        follow_guesses(problem, factor, guesses, settings, on_step=look)
    except _Found:
        return found[0]
    raise ValueError(f"the path to {1e3 * guesses[-1].load_mpa:g} kPa is stable: ask for more pressure")


CASES: Final[dict[str, Callable[[MPI.Comm], CaseResult]]] = {
    "two-spheres": two_spheres,
    "cube": rivlin_cube,
    "ring": thin_ring,
    "blocked-bellows": blocked_bellows,
}
# Cases that all ranks share; the others are solved on rank 0.
ON_ALL_RANKS: Final = ("blocked-bellows",)
# Files beside the solver that decide a case's numbers.
SOURCES: Final = (Path(__file__), SQUIRM_SCENE)
