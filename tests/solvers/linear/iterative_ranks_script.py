"""Run under mpirun by test_iterative.py: one solve of a small bellows, iterative beside direct; one JSON line."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
from mpi4py import MPI

from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.meridian import Resolution, meridian_mesh
from meshes.shape import BellowsShape
from meshes.solid import FACETS
from meshes.sweep import revolve_hexahedra
from solvers.assembly.surfaces import Surfaces
from solvers.bodies.rigid import RigidBodies
from solvers.discrete.domain import create_domain
from solvers.linear.factor import Factor
from solvers.linear.krylov import IterativeSolver
from solvers.problem import Problem

SHAPE = BellowsShape(5.0, 10.5, 1.0, 5.0, 1, 3.0, 4.0, 0.5, 5.0)


def main() -> None:
    comm = MPI.COMM_WORLD
    resolution = Resolution(through=1, cell_mm=2.0, arc_rad=1.2, cap_cells=1)
    body = revolve_hexahedra(meridian_mesh(SHAPE, resolution, cells="quadrilaterals"), 8, core_columns=1)
    arrays = dataclasses.replace(body, regions=np.ones_like(body.regions)) if comm.rank == 0 else None
    domain = create_domain(comm, arrays)
    bodies = RigidBodies(5.0, 2.0, np.ones(domain.nodes), SHAPE.crest_positions_mm, SHAPE.seat_radius_mm)
    surfaces = Surfaces(FACETS["cavity"], FACETS["clamped"], FACETS["bond"])
    problem = Problem(domain, DRAGON_SKIN_10, 0.0, surfaces, None, bodies)
    load = problem.load.force() * ~problem.constrained_owned
    found = {}
    for name, solver in (("direct", Factor(problem)), ("iterative", IterativeSolver(problem))):
        solver.refresh()
        found[name] = solver.solve(load, np.zeros(problem.extra))
    on_u = ~problem.owned_pressure

    def largest(values: np.ndarray) -> float:
        return float(comm.allreduce(float(np.abs(values[on_u]).max()), op=MPI.MAX))

    difference = largest(found["iterative"][0] - found["direct"][0]) / largest(found["direct"][0])
    compliance = comm.allreduce(float(load @ found["iterative"][0]), op=MPI.SUM)
    if comm.rank == 0:
        print(json.dumps({"ranks": comm.size, "difference": difference, "compliance": compliance}), flush=True)


main()
