"""Bodies moved by a prescribed amount; the exponential law's forms; a dead shear traction."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytical.exact.torsion import TwistedCylinder, torque_nmm
from analytical.laws.isotropic import Guccione, NeoHooke
from meshes.bodies import cook_membrane, cylinder_meridian
from meshes.revolve import revolve
from meshes.solid import FACETS
from solvers.bodies.rigid import RigidBodies
from solvers.equilibrium.newton import NewtonSettings
from solvers.errors import Cause, SolverError, StepFailed
from solvers.linear.factor import Factor
from solvers.paths import prescribed
from solvers.paths.prescribed import follow_motion


@pytest.fixture(scope="module")
def twisted(make_problem):
    """A short cylinder of 5 mm between a clamped end and a plate, and its factor."""
    mesh = revolve(cylinder_meridian(5.0, 2.0, 3, 1), 8)
    where = FACETS["top"]
    mesh = type(mesh)(**{**mesh.__dict__, "facet_bodies": np.where(mesh.facet_tags == where, 0, -1)})

    def make(law, held=True):
        bodies = RigidBodies(1e5, 1e5, np.ones(len(mesh.points)), np.array([2.0]), 1.0, plate=0, plate_held=held)
        surfaces = {"external": FACETS["outer"], "clamped": FACETS["bottom"], "bond": where}
        problem = make_problem(mesh, law, bodies=bodies, **surfaces)
        return problem, Factor(problem)

    return make


def turn(angle: float) -> np.ndarray:
    return np.array([[0.0, 0.0, 0.0, 0.0, 0.0, angle]])


def test_exponential_law_in_torsion(twisted) -> None:
    law = Guccione(0.01)
    problem, factor = twisted(law)
    path = follow_motion(problem, factor, turn(0.2), NewtonSettings())
    assert path.reached and [s.asked for s in path.states].count(True) == 1
    exact = torque_nmm(TwistedCylinder(5.0, 0.1), law)
    torque = problem.bonded.forces()[5]
    # 8 cells round, 3 inwards; measured 1.2 %
    assert torque == pytest.approx(exact, rel=0.02)
    # the energy is the torque's work: its slope at the end, from a step back
    follow_motion(problem, factor, turn(0.198), NewtonSettings())
    slope = (path.states[-1].energy_mj - problem.energy()) / 0.002
    # the mean of the two torques: the torque bends by 1e-4 of itself in between
    assert slope == pytest.approx(0.5 * (torque + problem.bonded.forces()[5]), rel=1e-4)


def test_motion_that_cannot_be_followed_ends_with_a_reason(twisted, monkeypatch) -> None:
    problem, factor = twisted(NeoHooke(0.07))
    monkeypatch.setattr(prescribed, "SMALLEST_STEP", 0.6)
    # five turns: no cell bears that, and none of them may be jumped over
    path = follow_motion(problem, factor, turn(10.0 * math.pi), NewtonSettings())
    assert not path.reached
    assert path.cause in (Cause.INVERTED_CELL, Cause.STEP_SIZE)
    reached = max((s.state.bodies_mm[0, 5] for s in path.states), default=0.0)
    assert reached < 2.0 * math.pi
    assert f"{100.0 * reached / (10.0 * math.pi):.4g} % of the motion reached" in path.reason
    assert path.rejected >= 1
    free, of_free = twisted(NeoHooke(0.07), held=False)
    with pytest.raises(SolverError, match="no rigid body is held"):
        follow_motion(free, of_free, turn(0.1), NewtonSettings())


def test_tangent_that_cannot_be_factored_ends_the_motion_with_a_reason(twisted, monkeypatch) -> None:
    problem, factor = twisted(NeoHooke(0.07))

    def no_memory():
        raise StepFailed("MUMPS failed with INFOG(1) = -13", Cause.OUT_OF_MEMORY)

    monkeypatch.setattr(factor, "refresh", no_memory)
    path = follow_motion(problem, factor, turn(0.1), NewtonSettings())
    assert (path.cause, path.states, path.rejected) == (Cause.OUT_OF_MEMORY, (), 1)
    assert "0 % of the motion reached" in path.reason


def test_dead_shear_is_the_force_it_says(make_problem) -> None:
    mesh = cook_membrane(2)
    held = ((FACETS["bottom"], 2), (FACETS["top"], 2))
    problem = make_problem(mesh, NeoHooke(80.0), dead_shear=FACETS["tip"], clamped=FACETS["clamped"], held=held)
    assert problem.conservative
    force = problem.load.force()
    components = [force[problem.u_dofs[:, i]].sum() for i in range(3)]
    # the right edge is 16 mm by 1 mm
    assert components == pytest.approx([0.0, 16.0, 0.0], abs=1e-10)
