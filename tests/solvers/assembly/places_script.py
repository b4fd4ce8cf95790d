"""Run on ranks by test_places.py: tangents of every kind of problem beside dolfinx' own; prints one JSON line.

For each kind: the largest difference of the two matrices relative to the largest entry, and that to the tangent of
another state, which must be far greater.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from analytical.laws.stiff import PLA
from meshes.bodies import tube_meridian
from meshes.meridian import Resolution, RingShape, meridian_mesh
from meshes.revolve import revolve
from meshes.shape import BellowsShape
from meshes.solid import FACETS, REGIONS, SolidMesh
from meshes.sweep import revolve_hexahedra
from solvers import compat
from solvers.assembly.surfaces import SOFT, STIFF, Surfaces
from solvers.bodies.rigid import AXIAL, EVERY_MOTION, RigidBodies
from solvers.discrete.domain import create_domain
from solvers.discrete.elements import P1_P0, P2_P0
from solvers.energy.materials import Material
from solvers.problem import Problem
from solvers.stability.harmonics import Harmonics

OGDEN = dragon_skin_30("2mu/alpha^2")
SHAPE = BellowsShape(5.0, 10.5, 1.0, 5.0, 1, 3.0, 4.0, 0.5, 5.0)
COARSE = Resolution(through=2, cell_mm=1.5, arc_rad=0.8, cap_cells=2)
OTHER = 7  # number of a second soft material


def make(mesh: SolidMesh, law: Any = DRAGON_SKIN_10, regions: Any = None, **rest: Any) -> Problem:
    """Problem on all ranks; what is not named for `Problem` is a surface."""
    names = ("stiff", "bodies", "element", "frame", "others")
    given, surfaces = ({k: v for k, v in rest.items() if (k in names) == of} for of in (True, False))
    cells = np.full(len(mesh.cells), SOFT) if regions is None else regions
    comm = MPI.COMM_WORLD
    domain = create_domain(comm, dataclasses.replace(mesh, regions=cells) if comm.rank == 0 else None)
    return Problem(domain, law, 0.0, Surfaces(cavity=FACETS["cavity"], **surfaces), **given)


def bellows(cells: Any, parts: int = 0, law: Any = DRAGON_SKIN_10) -> Problem:
    """One convolution with bonded rings: its meridian (no parts), or so many of its parts."""
    mesh = meridian_mesh(SHAPE, COARSE, cells=cells)
    held: tuple[tuple[int, int], ...] = ((FACETS["axis"], 0),)
    if parts:
        hexahedra = cells == "quadrilaterals"
        around = 8 // parts
        mesh = revolve_hexahedra(mesh, around, 2.0 * np.pi / parts) if hexahedra else revolve(mesh, around)
        held = ((FACETS["start"], 1), (FACETS["end"], 0)) if parts > 1 else ()
    grade = np.linspace(0.3, 1.0, len(mesh.points))
    bodies = RigidBodies(
        5.0, 2.0, grade, SHAPE.crest_positions_mm, SHAPE.seat_radius_mm, motions=AXIAL if parts > 1 else EVERY_MOTION
    )
    surfaces = {"clamped": FACETS["clamped"], "bond": FACETS["bond"], "held": held}
    return make(mesh, law, bodies=bodies, **surfaces)


def meshed_rings() -> Problem:
    """A meridian with rings of another, stiff material."""
    mesh = meridian_mesh(SHAPE, COARSE, RingShape(2.0, 0.3))
    regions = np.where(mesh.regions == REGIONS["ring"], STIFF, SOFT)
    return make(mesh, regions=regions, stiff=PLA, clamped=FACETS["clamped"], held=((FACETS["axis"], 0),))


def tube(cells: Any = "quadrilaterals", solid: bool = False, two: bool = False, **rest: Any) -> Problem:
    """A tube held at its ends, or clamped at one; of two soft materials if asked for."""
    mesh = tube_meridian(5.0, 6.5, 3.0, 3, 2, cells)
    axial = 2 if solid else 1
    if solid:
        mesh = revolve_hexahedra(mesh, 8) if cells == "quadrilaterals" else revolve(mesh, 8)
    if two:
        upper = mesh.points[mesh.cells, -1].mean(axis=1) > 1.5
        rest |= {"regions": np.where(upper, OTHER, SOFT), "others": {OTHER: Material(OGDEN, 0.2)}}
    if "clamped" not in rest:
        rest["held"] = ((FACETS["bottom"], axial), (FACETS["top"], axial))
    return make(mesh, **rest)


def plate() -> Problem:
    """A tube closed by a rigid plate."""
    mesh = revolve_hexahedra(tube_meridian(5.0, 6.5, 3.0, 3, 2, "quadrilaterals"), 8)
    mesh = dataclasses.replace(mesh, facet_bodies=np.where(mesh.facet_tags == FACETS["top"], 0, -1))
    grade, centre = np.ones(len(mesh.points)), np.array([3.0])
    bodies = RigidBodies(300.0, 300.0, grade, centre, 6.5, plate=0, plate_area_mm2=78.0)
    return make(mesh, bodies=bodies, clamped=FACETS["bottom"], bond=FACETS["top"])


KINDS: dict[str, Callable[[], Problem]] = {
    "meridian of triangles": lambda: bellows("triangles"),
    "meridian of quadrilaterals": lambda: bellows("quadrilaterals"),
    "tetrahedra": lambda: bellows("triangles", 1),
    "hexahedra": lambda: bellows("quadrilaterals", 1, OGDEN),
    "sector": lambda: bellows("quadrilaterals", 4),
    "meshed rings": meshed_rings,
    "two materials, continuous pressure": lambda: tube("triangles", two=True),
    "two materials, hexahedra": lambda: tube(solid=True, two=True),
    "plate": plate,
    "load without a potential": lambda: tube(solid=True, clamped=FACETS["bottom"]),
    "plain linear triangles": lambda: tube("triangles", element=P1_P0),
    "constant pressure, tetrahedra": lambda: tube("triangles", True, element=P2_P0),
}

WITH_HARMONICS = ("meridian of triangles", "meridian of quadrilaterals")


def move(problem: Problem) -> None:
    """A random state under pressure, the same on any number of ranks."""
    rng = np.random.default_rng(5)
    zero, moved = problem.zero_state(), {}
    for name, size in (("displacement_mm", 0.01), ("pressure_mpa", 0.05), ("bodies_mm", 0.5)):
        moved[name] = size * rng.standard_normal(getattr(zero, name).shape)
    problem.set_state(dataclasses.replace(zero, **moved))
    problem.pressure.value = 0.02


def by_dolfinx(problem: Any, bcs: list[Any]) -> PETSc.Mat:
    """The tangent of a problem or of a harmonic as dolfinx assembles it, its terms added as ever."""

    def flush() -> None:
        matrix.assemblyBegin(PETSc.Mat.AssemblyType.FLUSH)
        matrix.assemblyEnd(PETSc.Mat.AssemblyType.FLUSH)

    matrix = problem.new_matrix()
    compat.add_by_dolfinx(matrix, problem._tangent, bcs)
    flush()
    compat.insert_diagonal(matrix, bcs, problem.space)
    adds = [term.add_to for term in problem.terms]
    if isinstance(problem, Harmonics) and problem.bond is not None:
        adds.append(problem._add_border)
    for add in adds:
        flush()
        add(matrix)
    matrix.assemble()
    return matrix


def largest(matrix: PETSc.Mat) -> float:
    """Largest entry, on every rank."""
    return MPI.COMM_WORLD.allreduce(float(np.abs(matrix.getValuesCSR()[2]).max(initial=0.0)), op=MPI.MAX)


def compare(problem: Any, bcs: list[Any], disturb: Callable[[], None]) -> tuple[float, float]:
    """Difference to dolfinx' tangent, and that of dolfinx' to its tangent of a state a little off."""
    matrix = problem.new_matrix()
    for _ in range(2):  # what was there before does not count
        problem.assemble_tangent(matrix)
    exact = by_dolfinx(problem, bcs)
    scale = largest(exact)
    difference = largest(matrix - exact) / scale
    disturb()
    return difference, largest(by_dolfinx(problem, bcs) - exact) / scale


def main() -> None:
    found = {}
    for name, build in KINDS.items():
        problem = build()
        move(problem)

        def disturb(problem: Problem = problem) -> None:
            problem.state.x.array[:] *= 1.0 + 1e-8

        found[name] = compare(problem, problem.unknowns.supports.bcs, disturb)
        if name in WITH_HARMONICS and problem.comm.size == 1:
            harmonics = Harmonics(problem)
            for waves in (0, 1, 3):
                harmonics.select(waves)
                found[f"{name}, harmonic {waves}"] = compare(harmonics, harmonics.bcs, disturb)
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
