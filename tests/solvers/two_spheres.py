"""Two neo-Hookean spheres on one cavity: the path whose volume turns back, exactly and as a problem; a script too.

Spheres of different size and wall share a pressure, so their volumes add up at equal pressures (Mueller and Strehlow,
Rubber and Rubber Balloons, 2004). The small one reaches its limit point first; beyond it the large one shrinks by more
than the small one grows, and the whole volume turns back, until the small one has grown enough.

As a script, also under mpirun: follows the path by arc length and prints one JSON line.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from scipy.optimize import brentq, minimize_scalar

from analytical.materials import NeoHooke
from analytical.sphere import Sphere, limit_point, pressure_at_inner_radius_mpa
from meshes.bodies import sphere_meridian
from meshes.solid import FACETS, SolidMesh
from solvers.domain import create_domain
from solvers.linear import Factor
from solvers.path import PathSettings, follow_path
from solvers.problem import Problem, Surfaces

LAW = NeoHooke(0.1)
SMALL, LARGE = Sphere(5.0, 6.5), Sphere(15.0, 19.7)
LIMIT = limit_point(SMALL, LAW)
LARGE_LIMIT = limit_point(LARGE, LAW)


@dataclass(frozen=True)
class Exact:
    """An exact state: stretch of the small bore, common pressure in MPa, volume of both halves in mm^3."""

    stretch: float
    pressure_mpa: float
    volume_mm3: float


def exact(stretch: float) -> Exact:
    """The state at a stretch of the small bore; the large sphere stays on this side of its limit point."""
    small = stretch * SMALL.inner_radius_mm
    pressure = pressure_at_inner_radius_mpa(SMALL, LAW, small)
    assert LARGE_LIMIT is not None
    large = brentq(
        lambda a: pressure_at_inner_radius_mpa(LARGE, LAW, a) - pressure, LARGE.inner_radius_mm, LARGE_LIMIT.inner_mm
    )
    return Exact(stretch, pressure, 2.0 / 3.0 * math.pi * (small**3 + large**3))


def folds() -> tuple[Exact, Exact]:
    """Where the volume turns back, and where it turns forward again."""
    back = minimize_scalar(lambda s: -exact(s).volume_mm3, bounds=(1.4, 1.8), method="bounded")
    forward = minimize_scalar(lambda s: exact(s).volume_mm3, bounds=(1.8, 3.0), method="bounded")
    return exact(back.x), exact(forward.x)


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
