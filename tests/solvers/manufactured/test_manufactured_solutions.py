"""Manufactured solutions: whole operator, follower pressure included, against a chosen large deformation.

Errors of u, grad u and p must fall with orders 3, 2 and 2 on both families of elements, for a law of I1 and for
Ogden's, of finite kappa and incompressible, with the pressure as a potential and as a traction.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from analytical.laws.isotropic import Law
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from meshes.revolve import revolve
from meshes.solid import FACETS, SolidMesh
from meshes.sweep import revolve_hexahedra
from tests.solvers.manufactured import solutions
from tests.solvers.manufactured.discrete import orders, solved
from tests.solvers.manufactured.solutions import HEIGHT_MM, Map, Solution

LAWS: dict[str, Law] = {"yeoh": DRAGON_SKIN_10, "ogden": dragon_skin_30("2mu/alpha^2")}
KAPPA_OVER_MU = 10.0


# ---- meridians --------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def ring(strip, sides):
    """Meridian 1 to 2 mm of curved cells, both ends held in their planes: the pressure has a potential."""

    def of(box: bool):
        def make(n: int) -> tuple[SolidMesh, dict[str, Any]]:
            mesh = strip(1.0, 2.0, HEIGHT_MM, n, n, 0.08, box)
            return mesh, {"cavity": sides.cavity, "held": ((sides.bottom, 1), (sides.top, 1))}

        return make

    return of


@pytest.fixture(scope="module")
def rod(strip, sides):
    """Meridian from the axis to 1 mm, pressed from outside; its top is free, so the pressure has no potential."""

    def of(box: bool):
        def make(n: int) -> tuple[SolidMesh, dict[str, Any]]:
            mesh = strip(0.0, 1.0, HEIGHT_MM, n, n, 0.08, box)
            return mesh, {"external": sides.outer, "held": ((sides.bottom, 1), (sides.cavity, 0))}

        return make

    return of


# map, body, finite kappa; strains to 50 and 70 %
MERIDIANS = {"swollen": (solutions.swollen_ring, "ring", True), "isochoric": (solutions.isochoric_ring, "ring", False)}
MERIDIANS["with the axis"] = (solutions.isochoric_rod, "rod", False)
every_law = pytest.mark.parametrize("law", LAWS)
every_cell = pytest.mark.parametrize("box", [True, False], ids=["Q2/P1", "P2/P1"])


def solution_of(place: Map, law: str, compressible: bool, **controls: bool) -> Solution:
    mu = LAWS[law].initial_shear_modulus_mpa
    return Solution(place, LAWS[law], 1.0 / (KAPPA_OVER_MU * mu) if compressible else 0.0, **controls)


@every_cell
@every_law
@pytest.mark.parametrize("case", MERIDIANS)
def test_orders_on_meridians(ring, rod, case: str, law: str, box: bool) -> None:
    place, body, compressible = MERIDIANS[case]
    make = {"ring": ring, "rod": rod}[body](box)
    found = orders(make, solution_of(place, law, compressible), (4, 8, 16))
    # theory 3, 2, 2, from above: measured 2.92 to 3.52, 1.95 to 2.04 and, as p was reached sooner, 2.17 to 2.86
    assert (found[-1] >= [2.9, 1.9, 1.9]).all(), found


def test_both_forms_of_the_pressure_are_covered(ring, rod) -> None:
    for make, place, conservative in (
        (ring(True), solutions.isochoric_ring, True),
        (rod(True), solutions.isochoric_rod, False),
    ):
        mesh, surfaces = make(2)
        problem, _ = solved(mesh, solution_of(place, "yeoh", False), **surfaces)
        assert problem.conservative is conservative


@pytest.mark.parametrize("control", ["hoop", "follows"])
def test_orders_are_lost_with_a_wrong_term(rod, control: str) -> None:
    # P_theta left out of the force, and the pressure's share of the traction on the undeformed surface
    found = orders(rod(True), solution_of(solutions.isochoric_rod, "yeoh", False, **{control: False}), (8, 16))
    assert found[-1].max() < 0.5, found


# ---- bodies -----------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def quarters(strip, quarter, sides):
    """The same ring's quarter in 3D between planes of symmetry."""

    def of(box: bool):
        def make(n: int) -> tuple[SolidMesh, dict[str, Any]]:
            flat = strip(1.0, 2.0, HEIGHT_MM, n, n, 0.08, box)
            if box:
                mesh, x_plane, y_plane = revolve_hexahedra(flat, 2 * n, 0.5 * np.pi), FACETS["end"], FACETS["start"]
            else:
                mesh, x_plane, y_plane = quarter(revolve(flat, 8 * n)), sides.x_plane, sides.y_plane
            held = ((x_plane, 0), (y_plane, 1), (sides.bottom, 2), (sides.top, 2))
            return mesh, {"cavity": sides.cavity, "held": held}

        return make

    return of


# map, finite kappa
BODIES = {"swollen": (solutions.swollen_quarter, True), "isochoric": (solutions.isochoric_quarter, False)}


@pytest.mark.parametrize(
    ("case", "law", "box"),
    [
        ("swollen", "yeoh", True),
        ("swollen", "ogden", False),
        ("isochoric", "yeoh", True),
        ("isochoric", "ogden", True),
        ("isochoric", "yeoh", False),
    ],
)
def test_orders_in_3d(quarters, case: str, law: str, box: bool) -> None:
    place, compressible = BODIES[case]
    found = orders(quarters(box), solution_of(place, law, compressible), (2, 4) if box else (3, 6))
    # few cells: the gradient of tetrahedra comes from below, 1.87 between 2 and 4 cells and 1.90 between 3 and 6
    assert (found[-1] >= [2.8, 1.9 if box else 1.85, 1.9]).all(), found
