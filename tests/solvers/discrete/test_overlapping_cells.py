"""Cells that fold over or overlap are refused: they would count twice, and the answer would be wrong without a sign."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.bodies import block, tube_meridian
from meshes.solid import FACETS, SolidMesh
from solvers.errors import SolverError


def moved(mesh: SolidMesh, by: float) -> SolidMesh:
    """The mesh with an inner corner moved along all directions; nodes between corners stay."""
    points = mesh.points.copy()
    inner = np.setdiff1d(mesh.corners, mesh.facets)
    points[inner[0]] += by
    return dataclasses.replace(mesh, points=points)


@pytest.mark.parametrize("cells", ["quadrilaterals", "triangles"])
def test_an_inner_corner_may_move_but_not_beyond_its_neighbours(cells, make_problem) -> None:
    mesh = tube_meridian(5.0, 7.0, 2.0, 4, 4, cells)
    held = ((FACETS["bottom"], 1), (FACETS["top"], 1))
    make_problem(moved(mesh, 0.05), DRAGON_SKIN_10, cavity=FACETS["cavity"], held=held)
    with pytest.raises(SolverError, match=r"fold over or overlap: they fill 4\.\d+ mm\^2, their surface encloses"):
        make_problem(moved(mesh, 0.5), DRAGON_SKIN_10, cavity=FACETS["cavity"], held=held)


def test_a_body_in_hexahedra_too(make_problem) -> None:
    mesh = block((2.0, 2.0, 2.0), (2, 2, 2))
    pinned = tuple((0, i) for i in range(3))
    make_problem(moved(mesh, 0.1), DRAGON_SKIN_10, dead=FACETS["outer"], pinned=pinned)
    with pytest.raises(SolverError, match="mesh it anew"):
        make_problem(moved(mesh, 1.2), DRAGON_SKIN_10, dead=FACETS["outer"], pinned=pinned)
