"""Contact problems with exact answers: a tube in a rigid bore, a sphere in a bowl, a tube in a tube."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
from mpi4py import MPI

from analytical.exact import sphere as exact_sphere
from analytical.exact import tube as exact_tube
from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.bodies import joined, sphere_meridian, tube_meridian
from meshes.solid import FACETS, FloatArray, SolidMesh
from meshes.surface import boundary_edges
from solvers.assembly.surfaces import Surfaces
from solvers.contact.contact import Contact
from solvers.contact.obstacles import Bore, Bowl
from solvers.contact.pairs import Against, ContactSettings, Facing, Line, PairReport, Stop
from solvers.discrete.domain import create_domain
from solvers.errors import SolverError
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings, PathState
from solvers.problem import Problem
from studies.models.contact import DEPTH, LIMIT, REACH, SMOOTHING, STIFFNESS
from studies.models.run_rows import work_mj
from studies.results.rows import Row, row

LAW = DRAGON_SKIN_10
TUBE, OUTER_TUBE = exact_tube.Tube(5.0, 6.0), exact_tube.Tube(7.0, 8.5)
SPHERE = exact_sphere.Sphere(5.0, 6.0)
LENGTH_MM, HOUSING_MM, TOGETHER_MM = 2.0, 7.0, 8.0
# Requested pressures, of the one at which the body alone touches; beyond a kink more, for the work.
SHARES = (0.98, 1.0, 1.05, 1.1, 1.2, 1.3, 1.4, 1.5, 1.75, 2.0)
STIFFNESSES = (STIFFNESS / 4.0, STIFFNESS, 4.0 * STIFFNESS)
# Steps so small that the pair is within reach before it meets.
SMALL_STEPS = PathSettings(first_step=0.02, largest_step=0.05)


def penalty(wall_mm: float, stiffness: float = STIFFNESS) -> ContactSettings:
    """The penalty of scenes for a wall; ``stiffness`` in initial shear moduli per wall.

    The gap at which its pressure begins falls with the stiffness: both lengths of the penalty are refined together.
    """
    modulus, smoothing = LAW.initial_shear_modulus_mpa, SMOOTHING * STIFFNESS / stiffness
    return ContactSettings(
        stiffness * modulus / wall_mm, smoothing * wall_mm, DEPTH * wall_mm, REACH * wall_mm, LIMIT * wall_mm
    )


@dataclass(frozen=True)
class ExactProblem:
    """A problem by its name, and what makes its rows: a row per number, with its exact value where it has one."""

    name: str
    rows: Callable[[], list[Row]]


def _line(mesh: SolidMesh, radius: FloatArray, at_mm: float, side: float) -> Line:
    """Nodes at a radius upwards; all facets can touch."""
    nodes = np.flatnonzero(np.isclose(radius, at_mm))
    nodes = nodes[np.argsort(mesh.points[nodes, 1])]
    return Line(nodes, side, np.ones((len(nodes) - 1) // 2, dtype=bool))


def _problem(mesh: SolidMesh, held: tuple[tuple[int, int], ...]) -> Problem:
    cells = dataclasses.replace(mesh, regions=np.ones_like(mesh.regions))
    domain = create_domain(MPI.COMM_SELF, cells)
    return Problem(domain, LAW, 0.0, Surfaces(cavity=FACETS["cavity"], held=held))


def _follow(problem: Problem, loads_mpa: Sequence[float]) -> tuple[list[PathState], list[PairReport]]:
    """States of the path, and the contact of each."""
    factor = Factor(problem)
    path = follow_path(problem, factor, loads_mpa, SMALL_STEPS)
    factor.close()
    if not path.reached:
        raise SolverError(path.reason)
    reports = []
    for item in path.states:
        problem.set_state(item.state)
        assert problem.contact is not None
        reports.append(problem.contact.report()[0])
    return list(path.states), reports


def _in_housing(
    name: str, problem: Problem, contact: Contact, alone_mpa: float, area_mm2: float, wall_mm: float, level: str
) -> list[Row]:
    """Rows of a body pressed against a rigid housing: force, penetration, work and energy."""
    problem.contact = contact
    states, reports = _follow(problem, [share * alone_mpa for share in SHARES])
    last, report = states[-1], reports[-1]
    problem.set_state(problem.zero_state())
    pressure = np.array([0.0, *(s.state.load_mpa for s in states)])
    work = work_mj(pressure, np.array([problem.cavity_volume(), *(s.volume_mm3 for s in states)]))
    force = (last.state.load_mpa - alone_mpa) * area_mm2
    number = partial(row, name, pressure_kpa=1e3 * last.state.load_mpa, model="axisymmetric", level=level)
    return [
        number("contact_force_n", "N", value=report.force_n, reference=force, source="exact"),
        number("penetration_of_wall_percent", "%", value=-100.0 * report.gap_mm / wall_mm),
        number("energy_mj", "mJ", value=last.energy_mj, reference=work, source="work of the pressure, trapezoidal"),
    ]


def _tube_in_bore() -> list[Row]:
    """With a softer and a stiffer penalty too."""
    return [entry for stiffness in STIFFNESSES for entry in _tube_with_penalty(stiffness)]


def _tube_with_penalty(stiffness: float) -> list[Row]:
    wall = TUBE.outer_radius_mm - TUBE.inner_radius_mm
    mesh = tube_meridian(TUBE.inner_radius_mm, TUBE.outer_radius_mm, LENGTH_MM, 4, 4, "quadrilaterals")
    problem = _problem(mesh, ((FACETS["bottom"], 1), (FACETS["top"], 1)))
    line = _line(mesh, mesh.points[:, 0], TUBE.outer_radius_mm, -1.0)
    pair = Against("housing", 0, Bore(HOUSING_MM), None, np.empty(0))
    contact = Contact(problem.unknowns, mesh.points, [line], [pair], penalty(wall, stiffness), boundary_edges(mesh))
    bore = exact_tube.inner_radius_at_outer_mm(TUBE, HOUSING_MM)
    alone = exact_tube.pressure_at_inner_radius_mpa(TUBE, LAW, bore)
    area = 2.0 * math.pi * HOUSING_MM * LENGTH_MM
    return _in_housing("tube in a rigid bore", problem, contact, alone, area, wall, f"k{stiffness:g}")


def _sphere_in_bowl() -> list[Row]:
    a, b = SPHERE.inner_radius_mm, SPHERE.outer_radius_mm
    mesh = sphere_meridian(a, b, 12, 2, "quadrilaterals")
    problem = _problem(mesh, ((FACETS["axis"], 0), (FACETS["bottom"], 1)))
    line = _line(mesh, np.linalg.norm(mesh.points, axis=1), b, -1.0)
    pair = Against("housing", 0, Bowl(HOUSING_MM), None, np.empty(0))
    contact = Contact(problem.unknowns, mesh.points, [line], [pair], penalty(b - a), boundary_edges(mesh))
    bore = (HOUSING_MM**3 - b**3 + a**3) ** (1.0 / 3.0)
    alone = exact_sphere.pressure_at_inner_radius_mpa(SPHERE, LAW, bore)
    area = 2.0 * math.pi * HOUSING_MM**2
    return _in_housing("half a sphere in a rigid bowl", problem, contact, alone, area, b - a, f"k{STIFFNESS:g}")


def _tube_in_tube() -> list[Row]:
    """The inner tube presses the outer one out; their cells do not match."""
    inner = tube_meridian(TUBE.inner_radius_mm, TUBE.outer_radius_mm, LENGTH_MM, 4, 4, "quadrilaterals")
    outer = tube_meridian(OUTER_TUBE.inner_radius_mm, OUTER_TUBE.outer_radius_mm, LENGTH_MM, 3, 5, "quadrilaterals")
    tags = np.where(outer.facet_tags == FACETS["cavity"], FACETS["outer"], outer.facet_tags)
    mesh = joined(inner, dataclasses.replace(outer, facet_tags=tags))
    problem = _problem(mesh, ((FACETS["bottom"], 1), (FACETS["top"], 1)))
    radius = mesh.points[:, 0]
    lines = [_line(mesh, radius, TUBE.outer_radius_mm, -1.0), _line(mesh, radius, OUTER_TUBE.inner_radius_mm, 1.0)]
    pairs: list[Against | Facing | Stop] = [Facing("tubes", 0, 1), Facing("tubes", 1, 0)]
    wall = TUBE.outer_radius_mm - TUBE.inner_radius_mm
    problem.contact = Contact(problem.unknowns, mesh.points, lines, pairs, penalty(wall), boundary_edges(mesh))
    bore = exact_tube.inner_radius_at_outer_mm(TUBE, TOGETHER_MM)
    alone = exact_tube.pressure_at_inner_radius_mpa(TUBE, LAW, bore)
    both = alone + exact_tube.pressure_at_inner_radius_mpa(OUTER_TUBE, LAW, TOGETHER_MM)
    states, reports = _follow(problem, [both])
    inside = np.isclose(radius, TUBE.inner_radius_mm)
    found = float(states[-1].state.displacement_mm[inside, 0].mean())
    force = (both - alone) * 2.0 * math.pi * TOGETHER_MM * LENGTH_MM
    number = partial(row, "tube in a tube", pressure_kpa=1e3 * both, model="axisymmetric", level=f"k{STIFFNESS:g}")
    return [
        number("bore_mm", "mm", value=found, reference=bore - TUBE.inner_radius_mm, source="exact"),
        number("contact_force_n", "N", value=reports[-1].force_n, reference=force, source="exact"),
        number("penetration_of_wall_percent", "%", value=-100.0 * reports[-1].gap_mm / wall),
    ]


PROBLEMS: Final = (
    ExactProblem("tube in a rigid bore", _tube_in_bore),
    ExactProblem("half a sphere in a rigid bowl", _sphere_in_bowl),
    ExactProblem("tube in a tube", _tube_in_tube),
)
