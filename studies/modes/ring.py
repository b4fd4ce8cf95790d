"""Buckling of a ring under pressure from outside, by harmonics on its meridian, beside the exact loads."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Final

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
from solvers.paths.states import PathSettings, point_of
from solvers.problem import Problem
from solvers.stability.modes import ModeCounter, mode_crossings
from studies.results.rows import Row, row

RING, LAW = Tube(10.0, 12.0), NeoHooke(0.1)
WAVES = (2, 3)
# Cells through the wall.
LEVELS = (1, 2, 4)


@dataclass(frozen=True)
class Ring:
    """The ring 10/12 mm under a pressure that follows its surface or keeps its direction."""

    load: Load

    @property
    def name(self) -> str:
        """Such as ``ring-dead``."""
        return f"ring-{self.load}"


RINGS: Final = tuple(Ring(load) for load in LOADS)


def ring_rows(ring: Ring) -> list[Row]:
    """Pressures at which a ring buckles into two and three waves, on three meshes."""
    exact = {m: first_buckling(RING, LAW, m, ring.load) for m in WAVES}
    # a dead pressure is given per undeformed area
    known = {m: b.pressure_mpa if ring.load == "follower" else b.nominal_pressure_mpa for m, b in exact.items()}
    rows = []
    for through in LEVELS:
        for m, (pressure, within) in _buckling(ring.load, through, max(known.values())).items():
            quantity, level = f"crossing_m{m}_kpa", f"r{through}"
            kpa, spread, reference = 1e3 * pressure, 1e3 * within, 1e3 * known[m]
            rows.append(
                row(ring.name, quantity, "kPa", math.nan, "axisymmetric", kpa, level, spread, reference, "exact ring")
            )
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
