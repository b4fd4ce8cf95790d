"""Branches beyond bifurcations, against what is known of them: two equal spheres, Rivlin's cube, the bent ring."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest

from analytical.exact import cube
from analytical.exact.elastica import CRITICAL_LOAD, bent_ring
from analytical.exact.sphere import Sphere
from analytical.exact.two_spheres import TwoSpheres
from analytical.laws.isotropic import NeoHooke
from meshes.bodies import block, sphere_meridian, tube_meridian
from meshes.solid import FACETS
from meshes.sweep import revolve_hexahedra
from solvers.errors import Cause, StepFailed
from solvers.linear.factor import Factor
from solvers.paths.branch import BranchSettings, follow_branch
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from solvers.state import State

MU = 0.1
LAW = NeoHooke(MU)
PLANES = ("symmetry_x", "symmetry_y", "symmetry_z")


# ---- Rivlin's cube -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def octant(make_problem) -> SimpleNamespace:
    """An eighth of the cube in one cell between its planes of symmetry, which hold all turning and shearing."""
    mesh = block((1.0, 1.0, 1.0), (1, 1, 1))
    tags = mesh.facet_tags.copy()
    for k, facet in enumerate(mesh.facets):
        for axis in np.flatnonzero(np.abs(mesh.points[facet]).max(axis=0) < 1e-12):
            tags[k] = FACETS[PLANES[axis]]
    mesh = dataclasses.replace(mesh, facet_tags=tags)
    held = tuple((FACETS[name], i) for i, name in enumerate(PLANES))
    problem = make_problem(mesh, LAW, dead=FACETS["outer"], held=held)
    factor = Factor(problem)
    path = follow_path(problem, factor, [2.5 * MU], PathSettings(control="pressure"))
    crossing = path.crossing
    assert crossing is not None and crossing.kind is Cause.BIFURCATION
    assert crossing.pressure_mpa == pytest.approx(cube.trivial_limit_mpa(LAW), rel=1e-5)
    assert crossing.mode is not None
    # several modes cross at once: that of plates and rods is (1, 1, -2)
    shape = mesh.points * [0.5, 0.5, -1.0]
    mode = State(shape, 0.0 * crossing.mode.pressure_mpa, crossing.mode.bodies_mm, 0.0)
    far = int(np.argmax(mesh.points.sum(axis=1)))
    return SimpleNamespace(problem=problem, factor=factor, crossing=crossing, mode=mode, far=far)


@pytest.mark.parametrize("side", [1.0, -1.0], ids=["plates", "rods"])
def test_plates_and_rods_leave_the_cube(octant, side) -> None:
    path = follow_branch(
        octant.problem, octant.factor, octant.crossing, 2.4 * MU, BranchSettings(0.05 * side), mode=octant.mode
    )
    assert path.reached
    assert path.states[-1].state.load_mpa == 2.4 * MU
    stretches = []
    for item in path.states:
        stretch = 1.0 + item.state.displacement_mm[octant.far]
        assert stretch == pytest.approx([stretch[0], stretch[0], stretch[0] ** -2], rel=1e-6)
        exact = float(cube.branch_tension_mpa(LAW, stretch[0]))
        # the states are homogeneous and so exact on one cell: what Newton leaves, 1e-8 of the load
        assert item.state.load_mpa == pytest.approx(exact, rel=1e-6)
        if side > 0.0:  # in the octant plates have the cube's axial and stretching modes only, the rods wrinkle too
            modes = cube.unstable_modes(LAW, cube.CubeState(exact, float(stretch[0])))
            assert item.newton.excess_negatives == modes
        stretches.append(stretch[0])
    assert (np.diff(stretches) * side > 0.0).all()
    loads = np.array([item.state.load_mpa for item in path.states])
    if side > 0.0:
        # plates: the tension falls to that of the tangent point before it rises
        least = cube.tangent_point(LAW)
        assert loads.min() == pytest.approx(least.tension_mpa, rel=5e-3)
        assert loads.argmin() > 0 and [s.newton.excess_negatives for s in path.states][-1] == 0
    else:
        assert (np.diff(loads) > 0.0).all()


def test_branch_that_is_not_there_is_refused(octant) -> None:
    # along a mode that is stiff nothing leaves the cube
    x = octant.problem.domain.mesh.geometry.x
    assert len(x) == len(octant.mode.displacement_mm)
    stiff = dataclasses.replace(octant.mode, displacement_mm=octant.mode.displacement_mm[:, ::-1] ** 2)
    with pytest.raises(StepFailed, match=r"no branch found at .* kPa along the mode"):
        follow_branch(
            octant.problem, octant.factor, octant.crossing, 2.4 * MU, BranchSettings(0.05), mode=stiff
        )  # fmt: skip


# ---- two equal spheres (axisymmetric) ------------------------------------------------------------------


def test_one_of_two_equal_spheres_grows_and_the_other_shrinks(make_problem) -> None:
    sphere = Sphere(5.0, 6.5)
    pair = TwoSpheres(sphere, sphere)
    half = sphere_meridian(5.0, 6.5, 6, 2, "quadrilaterals")
    n, cells = len(half.points), len(half.cells)
    mesh = dataclasses.replace(
        half,
        points=np.vstack([half.points, half.points + [0.0, 50.0]]),
        cells=np.vstack([half.cells, half.cells + n]),
        regions=np.tile(half.regions, 2),
        facets=np.vstack([half.facets, half.facets + n]),
        facet_tags=np.tile(half.facet_tags, 2),
        facet_bodies=np.tile(half.facet_bodies, 2),
    )
    held = ((FACETS["axis"], 0), (FACETS["bottom"], 1))
    problem = make_problem(mesh, LAW, cavity=FACETS["cavity"], held=held)
    factor = Factor(problem)
    limit = pair.limit(LAW)
    path = follow_path(problem, factor, [2.0 * limit.pressure_mpa], PathSettings(control="volume", largest_volume=6.0))
    crossing = path.crossing
    # at its limit point either may go: two modes, one of which a held volume holds
    assert crossing is not None and crossing.kind is Cause.BIFURCATION
    assert (crossing.modes_before, crossing.modes_after) == (0, 2)
    assert crossing.pressure_mpa == pytest.approx(limit.pressure_mpa, rel=1e-4)
    assert crossing.mode is not None
    which = slice(0, n) if np.abs(crossing.mode.displacement_mm[:n]).max() > 0.5 else slice(n, None)
    one, p = crossing.mode.displacement_mm[which], crossing.mode.pressure_mpa
    p = p[:cells] if which.start == 0 else p[cells:]
    mode = State(np.vstack([one, -one]), np.concatenate([p, -p]), crossing.mode.bodies_mm, 0.0)
    grows = 1.0 if (one * half.points).sum() > 0.0 else -1.0
    bore = np.flatnonzero(np.abs(np.hypot(*half.points.T) - 5.0) < 1e-9)

    def stretch(item) -> float:
        return float(np.hypot(*(half.points[bore] + item.state.displacement_mm[bore]).T).mean()) / 5.0

    branch = follow_branch(
        problem,
        factor,
        crossing,
        2.0 * limit.pressure_mpa,
        BranchSettings(0.3 * grows),
        mode=mode,
        until=lambda item: stretch(item) > 2.5,
    )
    assert branch.reached and len(branch.states) >= 5
    stretches = [stretch(item) for item in branch.states]
    assert (np.diff(stretches) > 0.0).all() and stretches[-1] > 2.5
    for item, at in zip(branch.states, stretches, strict=True):
        known = pair.at(LAW, at)
        # asked 0.5 %; six quadrilaterals from equator to pole
        assert item.state.load_mpa == pytest.approx(known.pressure_mpa, rel=2e-4)
        assert item.volume_mm3 == pytest.approx(known.volume_mm3, rel=5e-4)
        # the one that grows is beyond its limit point, the other is not; a held volume holds both
        assert (item.newton.excess_negatives, item.newton.excess_at_volume) == (1, 0)


# ---- the bent ring -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def ring(make_problem) -> SimpleNamespace:
    """A quarter of a thin ring, its path past buckling into two waves."""
    inner, outer = 10.0, 10.4
    mesh = revolve_hexahedra(tube_meridian(inner, outer, 0.2, 1, 2, "quadrilaterals"), 16, 0.5 * math.pi)
    held = ((FACETS["start"], 1), (FACETS["end"], 0), (FACETS["bottom"], 2), (FACETS["top"], 2))
    problem = make_problem(mesh, LAW, external=FACETS["outer"], held=held)
    factor = Factor(problem)
    thin = CRITICAL_LOAD * MU * (outer - inner) ** 3 / (3.0 * (0.5 * (inner + outer)) ** 3)
    path = follow_path(problem, factor, [1.2 * thin], PathSettings())
    middle = 0.5 * (inner + outer)
    ends = [int(np.argmin(np.linalg.norm(mesh.points - at, axis=1))) for at in ([middle, 0.0, 0.0], [0.0, middle, 0.0])]
    return SimpleNamespace(problem=problem, factor=factor, path=path, ends=ends, radius=middle)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_ring_bends_as_the_elastica(ring, side) -> None:
    crossing = ring.path.crossing
    assert crossing is not None and (crossing.modes_before, crossing.modes_after) == (0, 1)

    def moves(item) -> np.ndarray:
        u = item.state.displacement_mm
        return np.array([u[ring.ends[0], 0], u[ring.ends[1], 1]]) / ring.radius

    path = follow_branch(
        ring.problem,
        ring.factor,
        crossing,
        1.3 * crossing.pressure_mpa,
        BranchSettings(0.2 * side, most_states=12),
        until=lambda item: np.abs(moves(item)).max() > 0.35,
    )
    assert path.reached and len(path.states) > 4
    for item in path.states:
        here = moves(item)
        known = bent_ring(here.max())
        # wall 4 % of the radius: 3e-4 at most, where the axis has moved by four tenths
        assert item.state.load_mpa / crossing.pressure_mpa == pytest.approx(known.load / CRITICAL_LOAD, rel=6e-4)
        assert -here.min() == pytest.approx(known.inward, rel=0.05)
        # the bent ring carries more than the round one: stable
        assert item.newton.excess_negatives == 0
    assert np.abs(moves(path.states[-1])).max() > 0.35
    # the two sides of the mode bend it towards the two axes
    assert np.sign(moves(path.states[-1])[0]) == np.sign(side * crossing.mode.displacement_mm[ring.ends[0], 0])


def test_number_of_states_ends_a_branch(ring) -> None:
    crossing = ring.path.crossing
    path = follow_branch(
        ring.problem, ring.factor, crossing, 1.3 * crossing.pressure_mpa, BranchSettings(0.2, most_states=3)
    )
    assert path.reached and len(path.states) == 3
