"""The tangent of a whole body is the direct sum of those of its parity classes on a quarter, and so is its inertia."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import ufl
from mpi4py import MPI
from petsc4py import PETSc

from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.errors import MeshError
from meshes.revolve import revolve
from meshes.solid import SolidMesh
from solvers import compat
from solvers.bodies.bond import BondedBodies
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.errors import SolverError
from solvers.linear.factor import Factor
from solvers.problem import Problem
from solvers.stability.parity import ParityClass, ParityFactor, ParityTangent, Plane, parity_classes
from solvers.state import State
from studies.models.build import PLANES, scene_problem
from studies.models.symmetry.mirrored import Diagonal, Mirrored, mirror
from studies.scene.bellows import BellowsScene, core_shift_mm
from studies.scene.load import load_bellows
from studies.scene.meshes import Part, scene_body, scene_meridian

ROOT = Path(__file__).resolve().parents[4]
PARTS: dict[str, Part] = {"cap": "sector", "rigid": "sector", "core": "half"}


@dataclass
class Bodies:
    """A whole body and its quarter."""

    whole: Problem
    part: Problem
    mirrored: Mirrored
    mesh: SolidMesh

    @property
    def rings(self) -> int:
        assert self.part.bonded is not None
        return self.part.bonded.count

    @property
    def classes(self) -> dict[str, ParityClass]:
        return {parity.name: parity for parity in parity_classes(self.mirrored.planes)}

    def factors(self) -> tuple[Factor, ParityFactor]:
        return Factor(self.whole), ParityFactor(self.part, self.mirrored.planes, Diagonal(self.mesh).is_alike)


def scene_of(kind: str, convolutions: int = 1) -> BellowsScene:
    """With a cap, a rigid plate, or a core that is off the axis."""
    scene = load_bellows(ROOT / "scenes" / "heung-t2-ri5.toml")
    changes: dict[str, dict[str, Any]] = {"rigid": {"tip": "rigid"}, "core": {"eccentricity": 0.2}}
    short = scene.geometry.model_copy(update={"convolutions": convolutions, **changes.get(kind, {})})
    return scene.model_copy(update={"geometry": short})


def bodies_of(scene: BellowsScene, part: Part) -> Bodies:
    meridian, shift = scene_meridian(scene, 1), core_shift_mm(scene)
    whole, cut = (scene_body(meridian, model, 8, shift) for model in ("full3d", part))
    of_whole, of_part = (scene_problem(scene, mesh, MPI.COMM_SELF) for mesh in (whole, cut))
    return Bodies(of_whole, of_part, mirror(cut, whole, PLANES[part]), cut)


@pytest.fixture(scope="module", params=PARTS)
def bodies(request) -> Bodies:
    return bodies_of(scene_of(request.param), PARTS[request.param])


# ---- the classes ---------------------------------------------------------------------------------------


def test_what_classes_hold_and_which_motions_they_have() -> None:
    (y,), (x,) = (plane.facets for plane in PLANES["sector"])
    assert {c.name: (set(c.held), c.motions) for c in parity_classes(PLANES["sector"])} == {
        "SS": ({(y, 1), (x, 0)}, (2,)),
        "SA": ({(y, 1), (x, 1), (x, 2)}, (0, 4)),
        "AS": ({(y, 0), (y, 2), (x, 0)}, (1, 3)),
        "AA": ({(y, 0), (y, 2), (x, 1), (x, 2)}, (5,)),
    }


def test_half_a_body_has_two_classes() -> None:
    classes = parity_classes([Plane((7, 8), 1)])
    assert {c.name: (set(c.held), c.motions) for c in classes} == {
        "S": ({(7, 1), (8, 1)}, (0, 2, 4)),
        "A": ({(7, 0), (7, 2), (8, 0), (8, 2)}, (1, 3, 5)),
    }


def test_classes_fill_the_space(bodies) -> None:
    part, whole = bodies.part, bodies.whole
    free = 0
    for parity in bodies.classes.values():
        tangent = ParityTangent(part, [parity])
        free += int((~tangent.supports.is_constrained).sum()) + bodies.rings * len(parity.motions)
    assert free == int((~whole.constrained_owned).sum()) + whole.extra


# ---- the tangent ---------------------------------------------------------------------------------------


def disturbed(bodies: Bodies) -> State:
    """A symmetric state under pressure that is no equilibrium."""
    problem, rng = bodies.part, np.random.default_rng(3)
    x = problem.state.x.array
    x[:] = np.where(problem.owned_pressure, 0.02, 0.02) * rng.standard_normal(len(x))
    x[problem.constrained_owned] = 0.0
    state = dataclasses.replace(problem.get_state(), load_mpa=0.02)
    return dataclasses.replace(state, bodies_mm=0.1 * rng.standard_normal(state.bodies_mm.shape))


def vector_of(problem: Problem, matrix: PETSc.Mat, dofs: np.ndarray, on_bodies: np.ndarray) -> PETSc.Vec:
    vector = matrix.createVecRight()
    vector.array[:] = np.concatenate([dofs, on_bodies.ravel()])
    return vector


def samples(bodies: Bodies, parity: ParityClass, signs: str) -> Iterator[tuple[np.ndarray, np.ndarray, PETSc.Vec]]:
    """Random vectors of a class on the part, and on the whole body with the signs of it or, without bodies, another."""
    part, whole, rng = bodies.part, bodies.whole, np.random.default_rng(5)
    tangent, matrix = ParityTangent(part, [parity]), whole.new_matrix()
    for _ in range(3):
        dofs = rng.standard_normal(part.owned) * ~tangent.supports.is_constrained
        part.state.x.array[:] = dofs
        motions = rng.standard_normal((bodies.rings, len(parity.motions))) * (signs == parity.name)
        moved = motions if signs == parity.name else np.zeros((bodies.rings, len(bodies.classes[signs].motions)))
        field = dataclasses.replace(part.get_state(), bodies_mm=moved)
        whole.set_state(bodies.mirrored.of_class(field, signs))
        values = whole.state.x.array[: whole.owned].copy()
        yield dofs, motions, vector_of(whole, matrix, values, whole.body_values.copy())


def mismatch(bodies: Bodies, first: str, second: str, signs: Callable[[str], str] = lambda name: name) -> float:
    """Largest difference of products with the whole tangent from those with the class's, by the products' size."""
    part, whole, state = bodies.part, bodies.whole, disturbed(bodies)
    rows, columns = (list(samples(bodies, bodies.classes[name], signs(name))) for name in (first, second))
    part.set_state(state)
    whole.set_state(bodies.mirrored.state(state))
    matrix = whole.new_matrix()
    whole.assemble_tangent(matrix)
    tangent = ParityTangent(part, [bodies.classes[first]])
    of_class = tangent.new_matrix()
    tangent.take_state(of_class)
    tangent.assemble_tangent(of_class)
    worst = 0.0
    for (dofs, motions, large), (dofs_2, motions_2, large_2) in itertools.product(rows, columns):
        product = matrix.createVecRight()
        matrix.mult(large_2, product)
        # what rounds off is the sum of the entries' sizes
        size = float(np.abs(large.array) @ np.abs(product.array))
        expected = 0.0
        if first == second:
            small, small_2 = (vector_of(part, of_class, d, b) for d, b in ((dofs, motions), (dofs_2, motions_2)))
            inside = of_class.createVecRight()
            of_class.mult(small_2, inside)
            expected = bodies.mirrored.parts * small.dot(inside)
        worst = max(worst, abs(large.dot(product) - expected) / size)
    return worst


# entries are sums of up to 27 quadrature points in another order, and of a bond a million times as stiff as the wall
ROUND_OFF = 1e-11


def test_tangent_of_a_class_is_the_whole_bodys(bodies) -> None:
    for name in bodies.classes:
        assert mismatch(bodies, name, name) < ROUND_OFF, name


def test_classes_are_not_coupled(bodies) -> None:
    for pair in itertools.combinations(bodies.classes, 2):
        assert mismatch(bodies, *pair) < ROUND_OFF, pair


def test_fields_of_one_class_with_the_signs_of_another_fail(bodies) -> None:
    names = list(bodies.classes)
    for name, signs in (names[::-1][:2], names[-2:]):  # AA and AS, or A and S
        assert mismatch(bodies, name, name, {name: signs}.__getitem__) > 1e-3, name


# ---- counts --------------------------------------------------------------------------------------------


def counted(bodies: Bodies, state: State) -> tuple[int, dict[str, int], int]:
    """Unstable modes of the whole body, of the classes, and their sum."""
    whole, part = bodies.factors()
    bodies.whole.set_state(bodies.mirrored.state(state))
    bodies.part.set_state(state)
    for factor in (whole, part):
        factor.refresh()
    found = whole.unstable_modes(), part.unstable_modes()
    counts = part.counts
    whole.close()
    part.close()
    assert found[0] is not None and found[1] is not None
    return found[0], counts, found[1]


@pytest.mark.parametrize("pressure_mpa", [0.0, 0.03, 0.1, 0.3])
def test_counts_of_the_classes_are_the_whole_bodys(bodies, pressure_mpa: float) -> None:
    # the unloaded shape under a pressure is no equilibrium, but its tangent has up to hundreds of negative eigenvalues
    whole, counts, summed = counted(bodies, dataclasses.replace(bodies.part.zero_state(), load_mpa=pressure_mpa))
    assert summed == whole
    assert summed == sum(counts.values()) + counts.get("SA", 0)
    assert set(counts) == set(bodies.classes) - {"AS"}
    assert (whole > 0) == (pressure_mpa > 0.0)
    if pressure_mpa == 0.3:
        assert min(counts.values()) > 100


def test_a_state_that_is_not_its_image_at_45_degrees_counts_sa_and_as() -> None:
    bodies = bodies_of(scene_of("rigid"), "sector")
    x, y, z = bodies.mesh.points.T
    oval = 0.1 * np.column_stack([x, -0.8 * y, 0.0 * z]) * np.minimum(1.0, z / 5.0)[:, None]
    state = dataclasses.replace(bodies.part.zero_state(), displacement_mm=oval, load_mpa=0.1)
    whole, counts, summed = counted(bodies, state)
    assert set(counts) == {"SS", "SA", "AS", "AA"}
    assert counts["SA"] != counts["AS"]  # so one of them twice would be wrong
    assert summed == sum(counts.values()) == whole


def without_second_variation(bonded: BondedBodies, space) -> None:
    """Rings whose rotations are linearised: what the state's tractions do in them is left out of the tangent."""
    back = bonded._rotation.T
    y, grade, ds = bonded.arm + bonded.slip, bonded.grade, bonded.measure

    def first(k: int):
        return -ufl.cross(bonded._spins[k], y) - back * bonded._shifts[k]

    v = ufl.TestFunctions(space)[0]
    pick = ufl.TestFunction(compat.function_space(space.mesh, ("DG", 0)))
    bonded._column_form = compat.compile_form(ufl.inner(bonded.traction(first(0)), back * v) * grade * ds)
    bonded._block_form = compat.compile_form(ufl.inner(bonded.traction(first(0)), first(1)) * pick * grade * ds)


def test_false_modes_of_linearised_rings_are_in_their_classes() -> None:
    """A pair that drifts and tilts, and torsion: classes see what the whole body sees, also where it is wrong."""
    both = bodies_of(scene_of("rigid", 2), "sector")
    factor = Factor(both.part)
    solve_equilibrium(both.part, factor, NewtonSettings(), HeldLoad(0.01))
    factor.close()
    state = both.part.get_state()
    assert counted(both, state) == (0, {"SS": 0, "SA": 0, "AA": 0}, 0)
    for problem in (both.whole, both.part):
        assert problem.bonded is not None
        without_second_variation(problem.bonded, problem.space)
    assert counted(both, state) == (3, {"SS": 0, "SA": 1, "AA": 1}, 3)


# ---- refusals ------------------------------------------------------------------------------------------


def test_meshes_that_are_no_images_are_refused() -> None:
    scene = scene_of("cap")
    meridian = scene_meridian(scene, 1)
    part = scene_body(meridian, "sector", 8)
    with pytest.raises(MeshError, match="mirror images"):
        mirror(part, scene_body(meridian, "full3d", 12), PLANES["sector"])  # 12 cells round make a core of three kites
    with pytest.raises(MeshError, match="mirror images"):
        mirror(part, part, PLANES["sector"])


def test_a_continuous_pressure_is_refused(make_problem, strip) -> None:
    body = revolve(strip(4.0, 5.0, 2.0, 1, 1), 8)
    problem = make_problem(body, DRAGON_SKIN_10, cavity=1, clamped=2)
    with pytest.raises(SolverError, match="continuous"):
        ParityTangent(problem, parity_classes(PLANES["sector"])[1:2])
