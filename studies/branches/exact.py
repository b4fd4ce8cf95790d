"""Cases with exact paths: two spheres on one cavity, Rivlin's cube, a ring that bends."""

from __future__ import annotations

import dataclasses
import math
from functools import partial
from typing import Final

import numpy as np
from mpi4py import MPI

from analytical.exact import cube
from analytical.exact.elastica import CRITICAL_LOAD, LARGEST_MOVE, bent_ring
from analytical.exact.ring import first_buckling
from analytical.exact.sphere import Sphere
from analytical.exact.tube import Tube
from analytical.exact.two_spheres import TwoSpheres
from analytical.laws.isotropic import NeoHooke
from meshes.bodies import block, joined, sphere_meridian, tube_meridian
from meshes.solid import FACETS
from meshes.sweep import revolve_hexahedra
from solvers.assembly.surfaces import Surfaces
from solvers.discrete.domain import create_domain
from solvers.linear.factor import Factor
from solvers.paths.branch import BranchSettings, follow_branch
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings, PathState
from solvers.problem import Problem
from studies.branches.findings import Findings, Point, fact, point

LAW: Final = NeoHooke(0.1)
SPHERES: Final = TwoSpheres(Sphere(5.0, 6.5), Sphere(15.0, 19.7))
RING_MM: Final = (10.0, 10.4)
PLANES: Final = ("symmetry_x", "symmetry_y", "symmetry_z")


def two_spheres(comm: MPI.Comm) -> Findings:
    """Two spheres on one cavity: the volume turns back, which arc length passes and volume control does not."""
    small, large = SPHERES.small, SPHERES.large
    one, other = (sphere_meridian(s.inner_radius_mm, s.outer_radius_mm, 8, 2, "quadrilaterals") for s in (small, large))
    mesh = joined(one, dataclasses.replace(other, points=other.points + [0.0, 100.0]))
    surfaces = Surfaces(cavity=FACETS["cavity"], held=((FACETS["axis"], 0), (FACETS["bottom"], 1)))
    problem = Problem(create_domain(comm, mesh), LAW, 0.0, surfaces)
    factor = Factor(problem)
    bore = np.flatnonzero(np.abs(np.hypot(*mesh.points.T) - small.inner_radius_mm) < 1e-9)

    def seen(item: PathState) -> Point:
        here = mesh.points[bore] + item.state.displacement_mm[bore]
        stretch = float(np.hypot(*here.T).mean() / small.inner_radius_mm)
        return point(item, stretch, SPHERES.at(LAW, stretch).pressure_mpa)

    paths = {
        control: follow_path(problem, factor, [0.05], PathSettings(control=control, largest_volume=4.0))
        for control in ("arc", "auto", "volume")
    }
    branches = {control: [seen(item) for item in path.states] for control, path in paths.items()}
    limit, back, forward = SPHERES.limit(LAW), *SPHERES.folds(LAW)
    crossing, stopped = paths["arc"].crossing, branches["volume"][-1]
    assert crossing is not None
    volumes = np.array([p.volume_mm3 for p in branches["arc"]])
    turn = int(np.flatnonzero(np.diff(volumes) < 0.0)[0])
    again = turn + int(np.flatnonzero(np.diff(volumes[turn:]) > 0.0)[0])
    number = partial(fact, "two-spheres")
    facts = (
        number("limit_kpa", "kPa", 1e3 * crossing.pressure_mpa, 1e3 * limit.pressure_mpa, "exact"),
        number("limit_mm3", "mm^3", crossing.volume_mm3, limit.volume_mm3, "exact"),
        number("fold_back_mm3", "mm^3", float(volumes[turn]), back.volume_mm3, "exact"),
        number("fold_forward_mm3", "mm^3", float(volumes[again]), forward.volume_mm3, "exact"),
        number("volume_control_ends_mm3", "mm^3", stopped.volume_mm3, back.volume_mm3, "exact turn of the volume"),
    )
    return Findings(branches, facts, problem.index_map.size_global + problem.extra)


def rivlin_cube(comm: MPI.Comm) -> Findings:
    """An eighth of Rivlin's cube between its planes of symmetry: plates and rods."""
    mesh = block((1.0, 1.0, 1.0), (1, 1, 1))
    tags = mesh.facet_tags.copy()
    for k, facet in enumerate(mesh.facets):
        for axis in np.flatnonzero(np.abs(mesh.points[facet]).max(axis=0) < 1e-12):
            tags[k] = FACETS[PLANES[axis]]
    mesh = dataclasses.replace(mesh, facet_tags=tags)
    held = tuple((FACETS[name], i) for i, name in enumerate(PLANES))
    problem = Problem(create_domain(comm, mesh), LAW, 0.0, Surfaces(dead=FACETS["outer"], held=held))
    factor = Factor(problem)
    mu = LAW.initial_shear_modulus_mpa
    crossing = follow_path(problem, factor, [2.5 * mu], PathSettings(control="pressure")).crossing
    assert crossing is not None and crossing.mode is not None
    mode = dataclasses.replace(crossing.mode, displacement_mm=mesh.points * [0.5, 0.5, -1.0])
    far = int(np.argmax(mesh.points.sum(axis=1)))

    def seen(item: PathState) -> Point:
        stretch = 1.0 + float(item.state.displacement_mm[far, 0])
        return point(item, stretch, float(cube.branch_tension_mpa(LAW, stretch)))

    branches = {}
    for branch, amplitude in (("plates", 0.05), ("rods", -0.05)):
        path = follow_branch(problem, factor, crossing, 2.4 * mu, BranchSettings(amplitude), mode=mode)
        branches[branch] = [seen(item) for item in path.states]
    critical, least = 1e3 * crossing.pressure_mpa, min(p.load_kpa for points in branches.values() for p in points)
    exact_critical, exact_least = 1e3 * cube.trivial_limit_mpa(LAW), 1e3 * cube.tangent_point(LAW).tension_mpa
    facts = (
        fact("cube", "critical_kpa", "kPa", critical, exact_critical, "exact"),
        fact("cube", "least_on_plates_kpa", "kPa", least, exact_least, "exact, next state"),
    )
    return Findings(branches, facts, problem.index_map.size_global + problem.extra)


def thin_ring(comm: MPI.Comm) -> Findings:
    """A thin ring under outside pressure beyond buckling into two waves, beside the elastica."""
    inner, outer = RING_MM
    wall, middle = outer - inner, 0.5 * (inner + outer)
    mesh = revolve_hexahedra(tube_meridian(inner, outer, 0.5 * wall, 1, 2, "quadrilaterals"), 16, 0.5 * math.pi)
    held = ((FACETS["start"], 1), (FACETS["end"], 0), (FACETS["bottom"], 2), (FACETS["top"], 2))
    problem = Problem(create_domain(comm, mesh), LAW, 0.0, Surfaces(external=FACETS["outer"], held=held))
    factor = Factor(problem)
    exact = first_buckling(Tube(inner, outer), LAW, 2, "follower").pressure_mpa
    crossing = follow_path(problem, factor, [1.2 * exact], PathSettings()).crossing
    assert crossing is not None
    critical = crossing.pressure_mpa
    ends = [int(np.argmin(np.linalg.norm(mesh.points - at, axis=1))) for at in ([middle, 0, 0], [0, middle, 0])]

    def outward(item: PathState) -> float:
        u = item.state.displacement_mm
        return float(max(u[ends[0], 0], u[ends[1], 1]) / middle)

    def far(item: PathState) -> bool:
        return outward(item) > 0.9 * LARGEST_MOVE

    def seen(item: PathState) -> Point:
        return point(item, outward(item), bent_ring(outward(item)).load / CRITICAL_LOAD * critical)

    branches = {}
    for branch, amplitude in (("long axis along y", 0.02 * middle), ("long axis along x", -0.02 * middle)):
        settings = BranchSettings(amplitude, most_states=12)
        path = follow_branch(problem, factor, crossing, 1.3 * critical, settings, until=far)
        branches[branch] = [seen(item) for item in path.states]
    facts = (fact("ring", "critical_kpa", "kPa", 1e3 * critical, 1e3 * exact, "exact, thick ring"),)
    return Findings(branches, facts, problem.index_map.size_global + problem.extra)
