"""Loads from inside, from outside and dead ones; a load without a potential is found out and solved as what it is."""

from __future__ import annotations

import numpy as np
import pytest

from analytical.laws.isotropic import NeoHooke
from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.revolve import revolve
from solvers.equilibrium.controls import HeldLoad, HeldVolume
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import SolverError
from solvers.linear.factor import Factor

TIGHT = NewtonSettings(relative_tolerance=1e-11, reuse_below=0.0, reuse_for=0.0)


@pytest.fixture(scope="module")
def tube(strip):
    return revolve(strip(5.0, 6.0, 2.0, 1, 1), 8)


@pytest.mark.parametrize("named", [{}, {"cavity": 1, "dead": 4}])
def test_a_problem_has_one_load(tube, make_problem, named: dict[str, int]) -> None:
    with pytest.raises(SolverError, match="one loaded surface"):
        make_problem(tube, DRAGON_SKIN_10, **named)


def test_pressure_without_a_potential_is_solved_as_traction(tube, sides, make_problem) -> None:
    problem = make_problem(tube, DRAGON_SKIN_10, cavity=sides.cavity, clamped=sides.bottom)
    assert not problem.conservative  # the upper edge is free
    errors: list[float] = []
    factor = Factor(problem)
    report = solve_equilibrium(
        problem, factor, TIGHT, HeldLoad(0.004), on_iteration=lambda _, error: errors.append(error)
    )
    assert report.excess_negatives is None
    force, _ = problem.internal_force()
    residual = (force - 0.004 * problem.load.traction())[~problem.constrained_owned]
    # Newton's tolerance
    assert np.linalg.norm(residual) < 1e-10 * np.linalg.norm(0.004 * problem.load.traction())
    # quadratic, which the symmetric tangent of the potential would not give: measured 0.2, 4e-3, 3e-7, 7e-15
    assert errors[-2] < errors[-3] ** 2
    # the same state by volume
    volume, pressure = problem.cavity_volume(), 0.004
    problem.set_state(problem.zero_state())
    solve_equilibrium(problem, factor, TIGHT, HeldVolume(volume))
    assert float(problem.pressure.value) == pytest.approx(pressure, rel=1e-9)  # Newton's tolerance


def test_pressure_from_inside_and_from_outside_are_opposite(strip, sides, make_problem) -> None:
    mesh = strip(5.0, 6.0, 2.0, 2, 2)
    radial = {}
    for name, surface in (("cavity", sides.cavity), ("external", sides.outer)):
        problem = make_problem(mesh, NeoHooke(0.1), held=((sides.bottom, 1), (sides.top, 1)), **{name: surface})
        assert problem.conservative
        report = solve_equilibrium(problem, Factor(problem), TIGHT, HeldLoad(0.001))
        assert report.excess_negatives == 0
        assert report.compliance_mm3_per_mpa > 0.0
        radial[name] = problem.get_state().displacement_mm[:, 0]
    # in plane strain the two differ by a hydrostatic pressure, which does nothing, and by the sign; strains of 2 %
    assert np.abs(radial["cavity"] + radial["external"]).max() < 0.1 * np.abs(radial["cavity"]).max()
    assert (radial["cavity"] > 0.0).all() and (radial["external"] < 0.0).all()


def test_dead_tension_stretches_a_rod_as_its_law_says(strip, sides, make_problem) -> None:
    mu, tension = 0.1, 0.15
    mesh = strip(1.0, 2.0, 3.0, 1, 2)
    problem = make_problem(mesh, NeoHooke(mu), dead=sides.top, held=((sides.bottom, 1),))
    assert problem.conservative
    solve_equilibrium(problem, Factor(problem), TIGHT, HeldLoad(tension))
    stretch = 1.0 + problem.get_state().displacement_mm[:, 1].max() / 3.0
    # homogeneous: exact on this mesh but for Newton's tolerance
    assert mu * (stretch - stretch**-2) == pytest.approx(tension, rel=1e-9)
    area = np.pi * (2.0**2 - 1.0**2)
    assert problem.cavity_volume() == pytest.approx(area * 3.0 * (stretch - 1.0), rel=1e-9)
