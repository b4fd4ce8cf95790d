"""Two neo-Hookean spheres on one cavity as a problem, see `analytical.exact.two_spheres`; a script too.

As a script, also under mpirun: follows the path by arc length and prints one JSON line.
"""

from __future__ import annotations

import json

import numpy as np
from mpi4py import MPI

from analytical.exact.sphere import Sphere
from analytical.laws.isotropic import NeoHooke
from meshes.bodies import sphere_meridian
from meshes.solid import FACETS, SolidMesh
from solvers.assembly.surfaces import Surfaces
from solvers.discrete.domain import create_domain
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from solvers.problem import Problem

LAW = NeoHooke(0.1)
SMALL, LARGE = Sphere(5.0, 6.5), Sphere(15.0, 19.7)


def mesh(along: int = 6, through: int = 2) -> SolidMesh:
    """Meridians of the two halves, apart from each other on one axis."""
    a, b = (
        sphere_meridian(s.inner_radius_mm, s.outer_radius_mm, along, through, "quadrilaterals") for s in (SMALL, LARGE)
    )
    n = len(a.points)
    return SolidMesh(
        points=np.vstack([a.points, b.points + [0.0, 100.0]]),
        cells=np.vstack([a.cells, b.cells + n]),
        regions=np.concatenate([a.regions, b.regions]),
        facets=np.vstack([a.facets, b.facets + n]),
        facet_tags=np.concatenate([a.facet_tags, b.facet_tags]),
        facet_bodies=np.concatenate([a.facet_bodies, b.facet_bodies]),
        tip_centre_node=a.tip_centre_node,
    )


def small_bore(body: SolidMesh) -> np.ndarray:
    """Nodes of the small sphere's bore."""
    return np.flatnonzero(np.abs(np.hypot(*body.points.T) - SMALL.inner_radius_mm) < 1e-9)


def problem_of(comm: MPI.Comm, body: SolidMesh) -> tuple[Problem, Factor]:
    """The problem; every rank calls."""
    domain = create_domain(comm, body if comm.rank == 0 else None)
    held = ((FACETS["axis"], 0), (FACETS["bottom"], 1))
    problem = Problem(domain, LAW, 0.0, Surfaces(cavity=FACETS["cavity"], held=held))
    return problem, Factor(problem)


def main() -> None:
    comm = MPI.COMM_WORLD
    problem, factor = problem_of(comm, mesh())
    settings = PathSettings(control="arc", largest_volume=4.0)
    path = follow_path(problem, factor, [0.03, 0.05], settings)
    if comm.rank == 0:
        print(
            json.dumps(
                {
                    "ranks": comm.size,
                    "pressures": [s.state.load_mpa for s in path.states],
                    "volumes": [s.volume_mm3 for s in path.states],
                    "counts": [[s.newton.excess_negatives, s.newton.excess_at_volume] for s in path.states],
                    "rejected": path.rejected,
                }
            )
        )


if __name__ == "__main__":
    main()
