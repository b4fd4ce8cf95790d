"""The exact thick sphere in 3D: observed orders of curved tetrahedra on the upper half, swept round its axis."""

from __future__ import annotations

import numpy as np
import pytest

from analytical.exact.sphere import (
    Sphere,
    hydrostatic_pressure_mpa,
    pressure_at_inner_radius_mpa,
    radial_displacement_mm,
)
from analytical.laws.isotropic import Law
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from meshes.bodies import sphere_meridian
from meshes.revolve import revolve
from meshes.solid import FACETS
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.linear.factor import Factor
from solvers.state import State

SPHERE = Sphere(4.0, 6.0)
LAWS: dict[str, Law] = {"yeoh": DRAGON_SKIN_10, "ogden": dragon_skin_30("2mu/alpha^2")}
# stretch at the bore
STRETCH = {"yeoh": 1.6, "ogden": 1.4}


def observed_orders(name: str, levels, make_problem, rms_errors) -> np.ndarray:
    """Orders of (u, p) in L2 between successive meshes, shape (levels - 1, 2)."""
    law, bore = LAWS[name], STRETCH[name] * SPHERE.inner_radius_mm

    def displacement(x: np.ndarray) -> np.ndarray:
        radius = np.linalg.norm(x, axis=-1)
        return x * (radial_displacement_mm(SPHERE, bore, radius) / radius)[..., None]

    def pressure(x: np.ndarray) -> np.ndarray:
        return -hydrostatic_pressure_mpa(SPHERE, law, bore, np.linalg.norm(x, axis=-1))

    errors = []
    for n in levels:  # cells through the wall
        mesh = revolve(sphere_meridian(SPHERE.inner_radius_mm, SPHERE.outer_radius_mm, 3 * n, n), 12 * n)
        held = ((FACETS["bottom"], 2),)
        # the whole circle can still glide in its plane and turn: a node on the axis and one off it are held
        top = int(np.flatnonzero(np.hypot(mesh.points[:, 0], mesh.points[:, 1]) == 0.0)[0])
        side = int(np.argmax(mesh.points[:, 0]))
        problem = make_problem(mesh, law, cavity=FACETS["cavity"], held=held, pinned=((top, 0), (top, 1), (side, 1)))
        p = np.zeros(len(mesh.points))
        p[mesh.corners] = pressure(mesh.points[mesh.corners])
        load = pressure_at_inner_radius_mpa(SPHERE, law, bore)
        problem.set_state(State(displacement(mesh.points), p, np.zeros((0, 0)), load))
        factor = Factor(problem)
        report = solve_equilibrium(problem, factor, NewtonSettings(relative_tolerance=1e-10), HeldLoad(load))
        factor.close()
        assert report.excess_negatives == 0
        errors.append(rms_errors(mesh, problem.get_state(), displacement, pressure))
    falls = np.log(np.array(errors[:-1]) / np.array(errors[1:]))
    return falls / np.log(np.array(levels[1:]) / np.array(levels[:-1]))[:, None]


@pytest.mark.slow
@pytest.mark.parametrize("name", LAWS)
def test_orders_of_the_sphere_in_3d(name: str, make_problem, rms_errors) -> None:
    orders = observed_orders(name, (2, 3, 4), make_problem, rms_errors)
    # Asked 2.9 and 1.9, of the finer pair: p is still on its way on the coarser one (1.88, 1.86). Measured 3.13, 1.94
    # for Yeoh and 3.14, 1.93 for Ogden.
    assert orders[-1, 0] >= 2.9, orders
    assert orders[-1, 1] >= 1.9, orders
