"""Buckling of a ring under pressure from outside, by harmonics on its meridian, beside the exact loads."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from mpi4py import MPI

from analytical.exact.ring import LOADS, Load, first_buckling
from analytical.exact.tube import Tube
from analytical.laws.isotropic import NeoHooke
from meshes.bodies import tube_meridian
from meshes.solid import FACETS
from solvers.assembly.surfaces import SOFT, Surfaces
from solvers.discrete.domain import create_domain
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.records import PathSettings, point_of
from solvers.problem import Problem
from solvers.stability.modes import ModeCounter, mode_crossings
from studies.results.rows import Row, row

RING, LAW = Tube(10.0, 12.0), NeoHooke(0.1)
WAVES = (2, 3)
# Cells through the wall.
LEVELS = (1, 2, 4)


def ring_rows() -> list[Row]:
    """Pressures at which the ring 10/12 mm buckles into two and three waves, follower and dead, on three meshes."""
    rows = []
    for load in LOADS:
        exact = {m: first_buckling(RING, LAW, m, load) for m in WAVES}
        # a dead pressure is given per undeformed area
        known = {m: b.pressure_mpa if load == "follower" else b.nominal_pressure_mpa for m, b in exact.items()}
        for through in LEVELS:
            for waves, (pressure, within) in _buckling(load, through, max(known.values())).items():
                rows.append(
                    row(f"ring-{load}", f"crossing_m{waves}_kpa", "kPa", math.nan, "axisymmetric", 1e3 * pressure,
                        f"r{through}", 1e3 * within, 1e3 * known[waves], "exact ring")
                )  # fmt: skip
    return rows


def _buckling(load: Load, through: int, highest_mpa: float) -> dict[int, tuple[float, float]]:
    """Pressure of each crossing and how exactly it was located, MPa."""
    mesh = tube_meridian(RING.inner_radius_mm, RING.outer_radius_mm, 1.0, 1, through, "quadrilaterals")
    domain = create_domain(MPI.COMM_SELF, dataclasses.replace(mesh, regions=np.full(len(mesh.cells), SOFT)))
    level = ((FACETS["bottom"], 1), (FACETS["top"], 1))
    outer = FACETS["outer"]
    follower = load == "follower"
    surfaces = Surfaces(external=outer, held=level) if follower else Surfaces(dead_pressure=outer, held=level)
    problem = Problem(domain, LAW, 0.0, surfaces)
    factor, counter = Factor(problem), ModeCounter(problem)
    path = follow_path(problem, factor, [0.3 * highest_mpa, 1.2 * highest_mpa], PathSettings(crossing_tolerance=0.0))
    counts = [counter.counts(item.state) for item in path.states]
    found = mode_crossings(counter, factor, [point_of(item) for item in path.states], counts, 1e-5)
    return {c.waves: (c.pressure_mpa, c.within_mpa) for c in found if c.waves in WAVES}
