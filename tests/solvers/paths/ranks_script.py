"""Run under mpirun by test_ranks.py: a small bellows in 3D on as many ranks as there are; prints one JSON line.

Argument: ``tetrahedra`` or ``hexahedra``.
"""

from __future__ import annotations

import dataclasses
import json
import sys

import numpy as np
from mpi4py import MPI

from analytical.laws.isotropic import Law, NeoHooke, Yeoh
from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.meridian import Resolution, meridian_mesh
from meshes.revolve import revolve, revolve_scalar, revolve_vector
from meshes.shape import BellowsShape
from meshes.solid import FACETS, SolidMesh
from meshes.sweep import revolve_hexahedra
from solvers.assembly.surfaces import Surfaces
from solvers.bodies.rigid import RigidBodies
from solvers.discrete.domain import create_domain
from solvers.equilibrium.newton import NewtonSettings
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from solvers.paths.warm_start import follow_guesses
from solvers.problem import Problem
from solvers.state import State, pressure_at_corners

SHAPE = BellowsShape(5.0, 10.5, 1.0, 5.0, 1, 3.0, 4.0, 0.5, 5.0)
SETTINGS = PathSettings(newton=NewtonSettings(relative_tolerance=1e-11))


def solver(comm: MPI.Comm, mesh: SolidMesh | None, law: Law = DRAGON_SKIN_10) -> tuple[Problem, Factor]:
    arrays = None if mesh is None else dataclasses.replace(mesh, regions=np.ones_like(mesh.regions))
    domain = create_domain(comm, arrays)
    bodies = RigidBodies(5.0, 2.0, np.ones(domain.nodes), SHAPE.crest_positions_mm, SHAPE.seat_radius_mm)
    held = ((FACETS["axis"], 0),) if domain.axisymmetric else ()
    surfaces = Surfaces(FACETS["cavity"], FACETS["clamped"], FACETS["bond"], held)
    problem = Problem(domain, law, 0.0, surfaces, None, bodies)
    return problem, Factor(problem)


def main() -> None:
    comm = MPI.COMM_WORLD
    hexahedra = sys.argv[1] == "hexahedra"
    resolution = Resolution(through=2, cell_mm=1.5, arc_rad=0.8, cap_cells=2)
    meridian = meridian_mesh(SHAPE, resolution, cells="quadrilaterals" if hexahedra else "triangles")
    body = revolve_hexahedra(meridian, 8, core_columns=1) if hexahedra else revolve(meridian, 8)
    guess = None
    if comm.rank == 0:
        path = follow_path(*solver(MPI.COMM_SELF, meridian), [0.005], SETTINGS)
        flat = path.states[-1].state
        motions = np.zeros((2, 6))
        motions[:, 2] = flat.bodies_mm[:, 0]
        u = revolve_vector(flat.displacement_mm, body)
        p = revolve_scalar(pressure_at_corners(flat, meridian.cells, meridian.cell.corners), body)
        guess = State(u, p[body.cells[:, :8]] if hexahedra else p, motions, flat.load_mpa)
    guess = comm.bcast(guess)
    problem, factor = solver(comm, body if comm.rank == 0 else None)
    path = follow_guesses(problem, factor, [guess], SETTINGS)
    # a state handed from rank to rank and back is the same state
    problem.set_state(path.states[-1].state)
    force, on_bodies = problem.internal_force()
    volume = problem.cavity_volume()
    # a soft neo-Hookean meridian over all ranks loses stability at a limit point
    soft, soft_factor = solver(comm, meridian if comm.rank == 0 else None, NeoHooke(0.03))
    crossing = follow_path(soft, soft_factor, [0.02], PathSettings(largest_volume=4.0)).crossing
    assert crossing is not None and crossing.mode is not None
    # one of a law that softens ends where it does
    softening = solver(comm, meridian if comm.rank == 0 else None, Yeoh((0.0222115, 0.0026603, -0.0000735)))
    ended = follow_path(*softening, [0.1], PathSettings(crossing_tolerance=0.0))
    if comm.rank == 0:
        point = path.states[-1]
        rim = np.unique(body.facets[body.facet_tags == FACETS["tip"]])
        print(
            json.dumps(
                {
                    "ranks": comm.size,
                    "reached": path.reached,
                    "tip_mm": point.state.displacement_mm[rim, 2].mean(),
                    "volume_mm3": point.volume_mm3,
                    "volume_again_mm3": volume,
                    "energy_mj": point.energy_mj,
                    "reaction_n": point.reaction_n,
                    "body_mm": point.state.bodies_mm[1, 2],
                    "min_det_f": point.newton.min_det_f,
                    "iterations": point.newton.iterations,
                    "excess_negatives": point.newton.excess_negatives,
                    "expected_negatives": problem.expected_negatives,
                    "limit_mpa": crossing.pressure_mpa,
                    "limit_mm3": crossing.volume_mm3,
                    "modes": [crossing.modes_before, crossing.modes_after],
                    "end": str(ended.cause),
                    "end_mpa": ended.states[-1].state.load_mpa,
                    "largest_stretch": ended.states[-1].newton.largest_stretch,
                    "mode_mm": crossing.mode.displacement_mm[::17].tolist(),
                }
            )
        )


if __name__ == "__main__":
    main()
