"""Parts ten million times as stiff as the rest: their forces cancel to round-off, and that is not a failure."""

from __future__ import annotations

import numpy as np
import pytest

from analytical.laws.silicones import DRAGON_SKIN_10
from analytical.laws.stiff import StiffSolid
from meshes.bodies import tube_meridian
from meshes.solid import FACETS
from solvers.assembly.surfaces import SOFT, STIFF
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import StepFailed
from solvers.linear.factor import Factor
from solvers.problem import Problem


@pytest.fixture(scope="module")
def half_stiff(make_problem) -> Problem:
    """A tube whose upper half is stiffer by a factor of ten million."""
    mesh = tube_meridian(5.0, 6.0, 6.0, 12, 4)
    upper = mesh.points[mesh.cells, 1].mean(axis=1) > 3.0
    stiff = StiffSolid(3e7 * DRAGON_SKIN_10.initial_shear_modulus_mpa, 0.36, 1.0)
    return make_problem(
        mesh,
        DRAGON_SKIN_10,
        regions=np.where(upper, STIFF, SOFT),
        stiff=stiff,
        cavity=FACETS["cavity"],
        held=((FACETS["bottom"], 1),),
    )


def test_a_state_that_no_increment_moves_is_converged(half_stiff: Problem) -> None:
    factor = Factor(half_stiff)
    half_stiff.set_state(half_stiff.zero_state())
    report = solve_equilibrium(half_stiff, factor, NewtonSettings(), HeldLoad(0.0001))
    assert 1e-6 < report.residual < 1e-4
    found = half_stiff.get_state().displacement_mm
    half_stiff.set_state(half_stiff.zero_state())
    with pytest.raises(StepFailed, match="no convergence"):
        solve_equilibrium(half_stiff, factor, NewtonSettings(stalled_tolerance=1e-6), HeldLoad(0.0001))
    assert np.abs(half_stiff.get_state().displacement_mm - found).max() < 1e-9 * np.abs(found).max()
