"""A short bellows with its tip blocked, in full 3D: beyond where it bends out sideways."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from mpi4py import MPI
from scipy.spatial import cKDTree

from meshes.solid import SolidMesh
from solvers.errors import SolverError
from solvers.linear.factor import Factor
from solvers.paths.branch import BranchSettings, follow_branch
from solvers.paths.path import follow_path
from solvers.paths.states import Crossing, GuessMemory, PathSettings, PathState
from solvers.paths.warm_start import follow_guesses
from solvers.problem import Problem
from solvers.state import State
from studies.branches.findings import Findings, fact, point
from studies.first_rank import first
from studies.models.build import revolve_state, scene_problem
from studies.results import provenance
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_body, scene_meridian

SCENE: Final = provenance.ROOT / "scenes" / "branches" / "short-blocked.toml"
NAME: Final = "blocked-bellows"
AROUND: Final = 8
HIGHEST_KPA: Final = 3.0
# What the crossing is located to, of its pressure.
TOLERANCE: Final = 1e-3


def blocked_bellows(comm: MPI.Comm) -> Findings:
    """The bellows over all ranks: its pair of critical modes, and the branch in the plane y = 0."""
    scene = load_bellows(SCENE)
    meridian = first(comm, lambda: scene_meridian(scene, 1))
    straight = first(comm, lambda: _straight(scene, meridian))
    body = scene_body(meridian, "full3d", AROUND)
    problem = scene_problem(scene, body if comm.rank == 0 else None, comm)
    factor = Factor(problem)
    crossing = _crossing(problem, factor, [revolve_state(item.state, meridian, body) for item in straight])
    assert crossing.mode is not None
    settings, mode = BranchSettings(0.3, most_states=25), in_plane(body, crossing.mode)
    bent = follow_branch(problem, factor, crossing, 1e-3 * HIGHEST_KPA, settings, mode=mode).states
    sideways, across = ([float(np.abs(item.state.bodies_mm[:, k]).max()) for item in bent] for k in (0, 1))
    branches = {
        "kept straight": [point(item, 0.0, force_n=item.end_force_n) for item in straight],
        "bent out": [point(item, at, force_n=item.end_force_n) for item, at in zip(bent, sideways, strict=True)],
    }
    last, pair = bent[-1], float(crossing.modes_after - crossing.modes_before)
    loads, forces = [item.state.load_mpa for item in straight], [item.end_force_n for item in straight]
    held = float(np.interp(last.state.load_mpa, loads, forces))
    facts = (
        fact(NAME, "critical_kpa", "kPa", 1e3 * crossing.pressure_mpa),
        fact(NAME, "modes_at_crossing", "", pair, 2.0, "a pair, by symmetry"),
        fact(NAME, "last_kpa", "kPa", 1e3 * last.state.load_mpa),
        fact(NAME, "force_bent_out_n", "N", last.end_force_n, held, "kept straight, axisymmetric"),
        fact(NAME, "sideways_mm", "mm", sideways[-1]),
        fact(NAME, "across_mm", "mm", across[-1], 0.0, "plane of symmetry"),
    )
    return Findings(branches, facts, problem.index_map.size_global + problem.extra)


def _straight(scene: BellowsScene, meridian: SolidMesh) -> list[PathState]:
    """The axisymmetric path, at the requested pressures."""
    problem = scene_problem(scene, meridian, MPI.COMM_SELF)
    path = follow_path(problem, Factor(problem), scene.pressures_mpa, PathSettings())
    return [item for item in path.states if item.asked]


class _Found(Exception):
    """The crossing that a path was followed for has been located."""


def _crossing(problem: Problem, factor: Factor, guesses: Sequence[State]) -> Crossing:
    """Where a path along guesses first loses stability."""
    found: list[Crossing] = []

    def look(memory: GuessMemory) -> None:
        if memory.crossing is not None:
            found.append(memory.crossing)
            raise _Found

    try:
        follow_guesses(problem, factor, guesses, PathSettings(crossing_tolerance=TOLERANCE), on_step=look)
    except _Found:
        return found[0]
    raise SolverError(f"the path to {1e3 * guesses[-1].load_mpa:g} kPa is stable: ask for more pressure")


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
