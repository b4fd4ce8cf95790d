"""A block with a closed cavity in any orientation and any numbering: the same energy, volume and Newton iterations."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.bodies import block
from meshes.solid import FACETS, SolidMesh
from solvers.assembly.surfaces import Surfaces
from solvers.discrete.domain import create_domain
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.linear.factor import Factor
from solvers.problem import Problem

SIZE_MM = 3.0
PRESSURE_MPA = 0.02
SKEW = {
    "as meshed": np.zeros(3),
    "about x": np.array([0.7, 0.0, 0.0]),
    "skew": np.array([0.4, -1.1, 0.6]),
    "nearly half a turn": np.array([1.7, 1.8, -1.9]),
}


def hollow() -> SolidMesh:
    """26 cells of 27 round an empty one, a little distorted so that no plane of symmetry is left."""
    full = block((SIZE_MM,) * 3, (3, 3, 3))
    centre = full.points[full.cells].mean(axis=1)
    keep = np.abs(centre - 0.5 * SIZE_MM).max(axis=1) > 0.1
    used, back = np.unique(full.cells[keep], return_inverse=True)
    cells, points = back.reshape(-1, 27), full.points[used]
    number = np.full(len(full.points), -1)
    number[used] = np.arange(len(used))
    inner = np.flatnonzero(np.abs(full.points - 0.5 * SIZE_MM).max(axis=1) < 0.5 + 1e-9)
    corners = inner[np.isclose(np.abs(full.points[inner] - 0.5 * SIZE_MM), 0.5).all(axis=1)]
    at = full.points[corners] - 0.5 * SIZE_MM
    faces = [np.sort(number[corners[np.sign(at[:, i]) == s]]) for i in range(3) for s in (-1, 1)]
    x = points / SIZE_MM
    bent = points + 0.15 * np.stack([np.sin(2.0 * x[:, 1]), np.sin(3.0 * x[:, 2]), np.cos(2.5 * x[:, 0])], axis=1)
    outer = number[full.facets]
    return dataclasses.replace(
        full,
        points=bent,
        cells=cells,
        regions=np.ones(len(cells), dtype=np.int64),
        facets=np.vstack([np.sort(outer, axis=1), np.array(faces)]),
        facet_tags=np.concatenate([np.full(len(outer), FACETS["outer"]), np.full(6, FACETS["cavity"])]),
        facet_bodies=np.full(len(outer) + 6, -1),
    )


def shuffled(mesh: SolidMesh, seed: int) -> tuple[SolidMesh, np.ndarray]:
    """The same mesh with its nodes and cells in another order; new number of each old node."""
    rng = np.random.default_rng(seed)
    new = rng.permutation(len(mesh.points))
    order = rng.permutation(len(mesh.cells))
    points = np.empty_like(mesh.points)
    points[new] = mesh.points
    return dataclasses.replace(
        mesh, points=points, cells=new[mesh.cells][order], facets=np.sort(new[mesh.facets], axis=1)
    ), new


def inflate(mesh: SolidMesh, turn: np.ndarray, pins: tuple[int, int, int]) -> dict[str, float | int | None]:
    """Figures of the body under pressure inside, turned before it is loaded; three nodes hold its free motions."""
    matrix = Rotation.from_rotvec(turn).as_matrix()
    turned = dataclasses.replace(mesh, points=mesh.points @ matrix.T)
    a, b, c = pins
    pinned = ((a, 0), (a, 1), (a, 2), (b, 1), (b, 2), (c, 2))
    surfaces = Surfaces(cavity=FACETS["cavity"], pinned=pinned)
    problem = Problem(create_domain(MPI.COMM_SELF, turned), DRAGON_SKIN_10, 0.0, surfaces, frame=matrix)
    assert problem.conservative  # a closed surface, however it lies
    settings = NewtonSettings(relative_tolerance=1e-11)
    report = solve_equilibrium(problem, Factor(problem), settings, HeldLoad(PRESSURE_MPA))
    state = problem.get_state()
    return {
        "energy_mj": problem.energy(),
        "volume_mm3": problem.cavity_volume(),
        "displacement_mm": float(np.linalg.norm(state.displacement_mm)),
        "iterations": report.iterations,
        "unstable": report.excess_negatives,
    }


@pytest.fixture(scope="module")
def body() -> tuple[SolidMesh, tuple[int, int, int], dict[str, float | int | None]]:
    mesh = hollow()
    ends = [np.zeros(3), np.array([SIZE_MM, 0.0, 0.0]), np.array([0.0, SIZE_MM, 0.0])]
    flat = block((SIZE_MM,) * 3, (3, 3, 3))
    used = np.unique(flat.cells[np.abs(flat.points[flat.cells].mean(axis=1) - 1.5).max(axis=1) > 0.1])
    pins = tuple(int(np.argmin(np.linalg.norm(flat.points[used] - end, axis=1))) for end in ends)
    a, b, c = pins
    return mesh, (a, b, c), inflate(mesh, SKEW["as meshed"], (a, b, c))


@pytest.mark.parametrize("name", list(SKEW)[1:])
def test_answers_do_not_depend_on_the_orientation(body, name: str) -> None:
    mesh, pins, expected = body
    found = inflate(mesh, SKEW[name], pins)
    assert float(expected["volume_mm3"] or 0) > 1.2  # inflated from 1 mm3 by so much that rotations of material count
    for quantity in ("energy_mj", "volume_mm3", "displacement_mm"):
        # asked 1e-9; Newton's residual is 1e-11 of the load
        assert found[quantity] == pytest.approx(expected[quantity], rel=1e-9), quantity
    assert found["iterations"] == expected["iterations"]
    assert found["unstable"] == expected["unstable"] == 0


@pytest.mark.parametrize("seed", [1, 2])
def test_answers_do_not_depend_on_the_numbering(body, seed: int) -> None:
    mesh, pins, expected = body
    other, new = shuffled(mesh, seed)
    a, b, c = (int(new[k]) for k in pins)
    found = inflate(other, SKEW["as meshed"], (a, b, c))
    for quantity in ("energy_mj", "volume_mm3", "displacement_mm"):
        assert found[quantity] == pytest.approx(expected[quantity], rel=1e-9), quantity  # as above
    assert found["iterations"] == expected["iterations"]
    assert found["unstable"] == 0
