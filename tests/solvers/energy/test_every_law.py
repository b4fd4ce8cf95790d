"""What every law must hold: its tangent, the exact tube and sphere, and answers that know no units."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from analytical.exact import sphere, tube
from analytical.laws.isotropic import Guccione, Law, NeoHooke, Ogden, OgdenSeries, Yeoh
from analytical.laws.of_invariants import ArrudaBoyce, Gent, MooneyRivlin
from meshes.bodies import sphere_meridian
from meshes.revolve import revolve
from meshes.solid import FACETS
from solvers.equilibrium.controls import HeldLoad
from solvers.equilibrium.newton import NewtonSettings, solve_equilibrium
from solvers.linear.factor import Factor
from solvers.paths.path import follow_path
from solvers.paths.states import PathSettings
from solvers.state import State

LAWS: dict[str, Law] = {
    "neo-hooke": NeoHooke(0.07),
    "yeoh, 3 terms": Yeoh((0.036, 0.0025, 0.00023)),
    "yeoh, 5 terms": Yeoh((0.036, 0.0025, -0.0001, 0.00001, 1e-7)),
    "mooney-rivlin, 2": MooneyRivlin((0.03, 0.005)),
    "mooney-rivlin, 3": MooneyRivlin((0.03, 0.005, 0.0004)),
    "mooney-rivlin, 5": MooneyRivlin((0.03, 0.005, 0.0004, 0.0003, 0.0001)),
    "ogden": Ogden(0.075449, 5.836, "2mu/alpha^2"),
    "ogden, mu/alpha, negative": Ogden(-0.05, -3.0, "mu/alpha"),
    "ogden, 3 terms": OgdenSeries((0.06, 0.002, 0.01), (1.3, 5.0, -2.0), "2mu/alpha^2"),
    "gent": Gent(0.07, 30.0),
    "arruda-boyce": ArrudaBoyce(0.07, 4.0),
    "guccione": Guccione(0.05, 1.0),
}
every_law = pytest.mark.parametrize("name", LAWS)
# Principal stretches: at rest, equal, equal to a hair, distinct, far apart.
STRETCHES = (
    (1.0, 1.0, 1.0),
    (1.4, 1.4, 1.0 / 1.96),
    (1.4, 1.4 * (1.0 + 1e-7), 1.0 / 1.96),
    (0.8, 0.8 * (1.0 - 1e-9), 1.0 / 0.64),
    (1.5, 1.1, 1.0 / 1.65),
    (2.5, 0.7, 1.0 / 1.75),
)
TUBE, SPHERE = tube.Tube(5.0, 7.0), sphere.Sphere(5.0, 7.0)
BORE = 1.3
TIGHT = NewtonSettings(relative_tolerance=1e-12)


def rotation(seed: int) -> np.ndarray:
    q, r = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


@every_law
def test_tangent_is_the_derivative_at_distinct_equal_and_nearly_equal_stretches(
    strip, sides, make_problem, name: str
) -> None:
    mesh = revolve(strip(5.0, 6.5, 2.0, 1, 1, 0.1), 4)
    problem = make_problem(mesh, LAWS[name], cavity=sides.cavity)
    rng = np.random.default_rng(3)
    matrix = problem.new_matrix()
    vector, product = matrix.createVecs()
    for k, stretches in enumerate(STRETCHES):
        f = rotation(k) @ np.diag(stretches) @ rotation(k + 10)
        p = np.full(len(mesh.points), 0.0)
        p[mesh.corners] = 0.02
        problem.set_state(State(mesh.points @ (f - np.eye(3)).T, p, problem.body_values.copy(), 0.0))
        way = np.where(problem.owned_pressure, 0.001, 0.05) * rng.standard_normal(problem.owned)
        problem.assemble_tangent(matrix)
        vector.array[:] = way
        matrix.mult(vector, product)
        start = problem.state.x.array.copy()

        def residual(h: float, start=start, way=way) -> np.ndarray:
            problem.state.x.array[:] = start + h * way
            return problem.internal_force()[0]

        h = 1e-3
        by_differences = (8.0 * (residual(h) - residual(-h)) - (residual(2 * h) - residual(-2 * h))) / (12.0 * h)
        scale = np.abs(by_differences).max()
        # differences of fourth order over 1e-4 of a cell: what they leave is below that
        assert np.abs(product.array - by_differences).max() < 1e-8 * scale, stretches


@every_law
def test_exact_tube_and_sphere_within_a_hundredth_of_a_percent(strip, sides, make_problem, name: str) -> None:
    law = LAWS[name]
    flat = strip(TUBE.inner_radius_mm, TUBE.outer_radius_mm, 1.0, 8, 2, quadrilaterals=True)
    round_ = sphere_meridian(SPHERE.inner_radius_mm, SPHERE.outer_radius_mm, 16, 6)
    cases = [
        (
            flat,
            ((sides.bottom, 1), (sides.top, 1)),
            sides.cavity,
            tube.pressure_at_inner_radius_mpa(TUBE, law, BORE * 5.0),
        ),
        (
            round_,
            ((FACETS["bottom"], 1),),
            FACETS["cavity"],
            sphere.pressure_at_inner_radius_mpa(SPHERE, law, BORE * 5.0),
        ),
    ]
    for mesh, held, cavity, load in cases:
        problem = make_problem(mesh, law, cavity=cavity, held=held)
        path = follow_path(problem, Factor(problem), [load], PathSettings(newton=TIGHT))
        assert path.reached, path.reason
        displacement = path.states[-1].state.displacement_mm
        inner = int(np.argmin(np.abs(mesh.points[:, 0] - 5.0) + np.abs(mesh.points[:, 1])))
        # a node of the bore on z = 0; the wall's displacement there is (BORE - 1) 5 mm
        assert displacement[inner, 0] == pytest.approx((BORE - 1.0) * 5.0, rel=1e-4)


def scaled(law: Law, factor: float) -> Law:
    """The law with all its moduli times a factor."""
    changed = {}
    for field in dataclasses.fields(law):
        value = getattr(law, field.name)
        if field.name.endswith("_mpa"):
            changed[field.name] = tuple(factor * v for v in value) if isinstance(value, tuple) else factor * value
    assert changed
    return dataclasses.replace(law, **changed)  # type: ignore[arg-type]


@every_law
def test_answers_know_no_units(strip, sides, make_problem, name: str) -> None:
    mesh = strip(5.0, 7.0, 1.0, 3, 1, quadrilaterals=True)
    held = ((sides.bottom, 1), (sides.top, 1))
    found = []
    for factor in (1.0, 1000.0):  # kPa in place of MPa
        law = scaled(LAWS[name], factor)
        problem = make_problem(mesh, law, cavity=sides.cavity, held=held)
        load = factor * tube.pressure_at_inner_radius_mpa(TUBE, LAWS[name], BORE * 5.0)
        problem.set_state(problem.zero_state())
        solver = Factor(problem)
        for share in (0.5, 1.0):
            solve_equilibrium(problem, solver, TIGHT, HeldLoad(share * load))
        found.append(problem.get_state().displacement_mm)
    np.testing.assert_allclose(found[1], found[0], atol=1e-12 * np.abs(found[0]).max())
