"""Shared bodies, problems and measures. Tests get them as fixtures: under importlib mode nothing is imported."""

from __future__ import annotations

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: small systems, and other work on this machine

import dataclasses
import functools
import json
import subprocess
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import solvers  # noqa: F401 - before dolfinx, PETSc and MPI, see there
from meshes.cells import HEXAHEDRON_NODES, QUADRILATERAL_NODES
from meshes.meridian import Resolution, meridian_mesh
from meshes.revolve import revolve
from meshes.shape import BellowsShape
from meshes.solid import TETRAHEDRON_EDGES, TRIANGLE_EDGES, SolidMesh
from studies import mpi_children

ROOT = Path(__file__).resolve().parents[1]

# Facet numbers of the strips and rings made here.
SIDES = SimpleNamespace(cavity=1, bottom=2, top=3, outer=4, y_plane=5, x_plane=7)


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def sides() -> SimpleNamespace:
    """Facet numbers: y_plane is y = 0 and x_plane is x = 0 of a quarter ring."""
    return SIDES


# ---- child processes -------------------------------------------------------------------------------------


def _start(ranks: int, *arguments, **options) -> subprocess.Popen:
    command = mpi_children.on_ranks(ranks, *map(str, arguments))
    environment = {**mpi_children.environment(), "PYTHONPATH": str(ROOT)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, **options}
    return subprocess.Popen(command, cwd=ROOT, env=environment, **pipes)


def _finish(process: subprocess.Popen) -> str:
    out, errors = process.communicate(timeout=280)
    assert process.returncode == 0, (out or "") + errors[-2000:]
    return out


@pytest.fixture(scope="session")
def python() -> SimpleNamespace:
    """Python in a child on so many ranks: ``start(ranks, *arguments)``, ``finish(process)``, or ``run`` for both.

    What ends well gives its standard output; ``answer`` runs and reads the JSON of the last line.
    """

    def run(ranks: int, *arguments) -> str:
        return _finish(_start(ranks, *arguments))

    def answer(ranks: int, *arguments):
        return json.loads(run(ranks, *arguments).splitlines()[-1])

    return SimpleNamespace(start=_start, finish=_finish, run=run, answer=answer)


# ---- bodies --------------------------------------------------------------------------------------------


@pytest.fixture(scope="session")
def one_convolution() -> BellowsShape:
    """The scene of DESIGN.md with one convolution instead of eight."""
    return BellowsShape(5.0, 10.5, 1.0, 5.0, 1, 3.0, 4.0, 0.5, 5.0)


@pytest.fixture(scope="session")
def coarse() -> Resolution:
    """Coarser than anything to be trusted for its tip, fit for identities that hold on every mesh."""
    return Resolution(through=2, cell_mm=1.5, arc_rad=0.8, cap_cells=2)


@pytest.fixture(scope="session")
def coarse_meridian(one_convolution, coarse) -> SolidMesh:
    return meridian_mesh(one_convolution, coarse)


@pytest.fixture(scope="session")
def coarse_solid(coarse_meridian) -> SolidMesh:
    return revolve(coarse_meridian, 8)


def _boundary(cells, dimension):
    """Sorted corner nodes of the facets that belong to one cell only."""
    corners = cells[:, : dimension + 1]
    facets = np.vstack([np.delete(corners, k, axis=1) for k in range(dimension + 1)])
    unique, count = np.unique(np.sort(facets, axis=1), axis=0, return_counts=True)
    assert count.max() <= 2, "a facet belongs to three cells"
    return unique[count == 1]


@pytest.fixture(scope="session")
def boundary_of():
    return _boundary


def _strip(inner, outer, height, n_r, n_z, warp=0.0, quadrilaterals=False) -> SolidMesh:
    """Rectangle [inner, outer] x [0, height] of quadratic cells; ``warp`` curves the cells inside it."""
    s, t = np.meshgrid(np.linspace(0, 1, 2 * n_r + 1), np.linspace(0, 1, 2 * n_z + 1), indexing="ij")
    bulge = warp * np.sin(np.pi * s) * np.sin(np.pi * t)
    r = inner + (outer - inner) * (s + bulge)
    z = height * (t - bulge)
    points = np.column_stack([r.ravel(), z.ravel()])
    node = np.arange(points.shape[0]).reshape(s.shape)

    def at(i, j):
        return node[i : 2 * n_r - 1 + i : 2, j : 2 * n_z - 1 + j : 2].ravel()

    lower = [at(0, 0), at(2, 0), at(2, 2), at(2, 1), at(1, 1), at(1, 0)]
    upper = [at(0, 0), at(2, 2), at(0, 2), at(1, 2), at(0, 1), at(1, 1)]
    cells = np.vstack([np.column_stack(lower), np.column_stack(upper)])
    if quadrilaterals:
        cells = np.column_stack([at(i, j) for i, j in QUADRILATERAL_NODES])
    edges, tags = [], []
    for number, line in (
        (SIDES.cavity, node[0, ::2]),
        (SIDES.outer, node[-1, ::2]),
        (SIDES.bottom, node[::2, 0]),
        (SIDES.top, node[::2, -1]),
    ):
        edges.append(np.column_stack([line[:-1], line[1:]]))
        tags.append(np.full(len(line) - 1, number))
    facet_tags = np.concatenate(tags)
    bodies = np.where(facet_tags == SIDES.outer, 0, -1)
    regions = np.ones(len(cells), dtype=np.int64)
    return SolidMesh(points, cells, regions, np.sort(np.vstack(edges), axis=1), facet_tags, bodies, 0)


@pytest.fixture(scope="session")
def strip():
    return _strip


def _quarter(ring: SolidMesh) -> SolidMesh:
    """The part x, y >= 0 of a revolved strip, its cut faces named."""
    inside = (ring.points[:, 0] > -1e-9) & (ring.points[:, 1] > -1e-9)
    keep = inside[ring.cells].all(axis=1)
    used, back = np.unique(ring.cells[keep], return_inverse=True)
    cells, points = back.reshape(-1, 10), ring.points[used]
    known = {tuple(f): t for f, t in zip(ring.facets, ring.facet_tags, strict=True)}
    facets = _boundary(cells, 3)
    tags = np.array([known.get(tuple(used[f]), 0) for f in facets])
    new = tags == 0
    on_y = np.abs(points[facets][:, :, 1]).max(axis=1) < 1e-9
    tags[new] = np.where(on_y[new], SIDES.y_plane, SIDES.x_plane)
    bodies = np.where(tags == SIDES.outer, 0, -1)
    return SolidMesh(points, cells, ring.regions[keep], facets, tags, bodies, 0)


@pytest.fixture(scope="session")
def quarter():
    return _quarter


# ---- measures ------------------------------------------------------------------------------------------


def _shape_functions(dimension, at):
    """Linear (q, d + 1) and quadratic (q, k) shape functions and the latter's gradients (q, k, d)."""
    bary = np.column_stack([1.0 - at.sum(axis=1), at])
    slope = np.vstack([-np.ones(dimension), np.eye(dimension)])
    values = [bary[:, i] * (2.0 * bary[:, i] - 1.0) for i in range(dimension + 1)]
    slopes = [(4.0 * bary[:, i] - 1.0)[:, None] * slope[i] for i in range(dimension + 1)]
    for i, j in TRIANGLE_EDGES if dimension == 2 else TETRAHEDRON_EDGES:
        values.append(4.0 * bary[:, i] * bary[:, j])
        slopes.append(4.0 * (bary[:, i][:, None] * slope[j] + bary[:, j][:, None] * slope[i]))
    return bary, np.stack(values, axis=1), np.stack(slopes, axis=1)


def _box_functions(dimension, at):
    """The same on the square and the cube, (q, 2^d) and (q, 3^d): powers fitted to the nodes."""
    nodes = 0.5 * (QUADRILATERAL_NODES if dimension == 2 else HEXAHEDRON_NODES)
    powers = np.array(list(np.ndindex(*[3] * dimension)))

    def monomials(x):
        return np.prod(x[:, None, :] ** powers, axis=-1)

    coefficients = np.linalg.inv(monomials(nodes))
    slopes = []
    for i in range(dimension):
        lower = np.maximum(powers - np.eye(dimension, dtype=int)[i], 0)
        slopes.append((powers[:, i] * np.prod(at[:, None, :] ** lower, axis=-1)) @ coefficients)
    corners = nodes[: 2**dimension]
    linear = np.prod(np.where(corners == 1.0, at[:, None, :], 1.0 - at[:, None, :]), axis=-1)
    return linear, monomials(at) @ coefficients, np.stack(slopes, axis=-1)


def _rule(dimension, box, count=5):
    """Gauss points of the cube, collapsed to the simplex (exact to degree 2 count - d) or not."""
    x, w = np.polynomial.legendre.leggauss(count)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    grids = np.stack(np.meshgrid(*[x] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    weights = np.prod(np.stack(np.meshgrid(*[w] * dimension, indexing="ij"), axis=-1), axis=-1).ravel()
    if box:
        return grids, weights
    at = np.empty_like(grids)
    left = np.ones(len(grids))
    for axis in range(dimension):
        at[:, axis] = grids[:, axis] * left
        weights = weights * left
        left = left * (1.0 - grids[:, axis])
    return at, weights


@pytest.fixture(scope="session")
def rms_errors():
    """Root mean square errors of displacement and pressure against functions of position (plane measure)."""

    def measure(mesh, state, displacement, pressure):
        d = mesh.dimension
        box = mesh.cell.corners > d + 1
        at, weights = _rule(d, box)
        linear, quadratic, slopes = (_box_functions if box else _shape_functions)(d, at)
        x = np.einsum("cki,qk->cqi", mesh.points[mesh.cells], quadratic)
        jacobian = np.einsum("cki,qkj->cqij", mesh.points[mesh.cells], slopes)
        dx = np.abs(np.linalg.det(jacobian)) * weights
        u = np.einsum("cki,qk->cqi", state.displacement_mm[mesh.cells], quadratic)
        p_corners = state.pressure_mpa
        if p_corners.ndim == 1:  # continuous
            p_corners = p_corners[mesh.cells[:, : d + 1]]
        p = np.einsum("ck,qk->cq", p_corners, linear)
        u_error = ((u - displacement(x)) ** 2).sum(axis=-1)
        p_error = (p - pressure(x)) ** 2
        size = dx.sum()
        return float(np.sqrt((u_error * dx).sum() / size)), float(np.sqrt((p_error * dx).sum() / size))

    return measure


# ---- problems ------------------------------------------------------------------------------------------


@pytest.fixture(scope="session")
def make_problem():
    """Problem on a mesh of this file: law, 1/kappa, surfaces by keyword, stiff solid and bodies if any."""
    from mpi4py import MPI

    from solvers.assembly.surfaces import Surfaces
    from solvers.discrete.domain import create_domain
    from solvers.problem import Problem

    def make(
        mesh,
        law,
        inverse_kappa=0.0,
        *,
        regions=None,
        stiff=None,
        bodies=None,
        element=None,
        frame=None,
        others=None,
        quadrature_degree=None,
        **surfaces,
    ):
        cells = np.ones(len(mesh.cells), dtype=np.int64) if regions is None else regions
        domain = create_domain(MPI.COMM_SELF, dataclasses.replace(mesh, regions=cells))
        given = {"frame": frame, "others": others, "quadrature_degree": quadrature_degree}
        return Problem(domain, law, inverse_kappa, Surfaces(**surfaces), stiff, bodies, element, **given)

    return make


@pytest.fixture(scope="session")
def bellows_problem(one_convolution, coarse_meridian, coarse_solid, make_problem):
    """Cached bellows of one convolution with rigid rings, graded bond: its mesh, problem and factor."""
    from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
    from meshes.solid import FACETS
    from solvers.bodies.rigid import RigidBodies
    from solvers.linear.factor import Factor

    laws = {"yeoh": DRAGON_SKIN_10, "ogden": dragon_skin_30("2mu/alpha^2")}

    @functools.cache
    def build(dimension, law="yeoh"):
        mesh = coarse_meridian if dimension == 2 else coarse_solid
        z = mesh.points[:, dimension - 1]
        grade = np.zeros(len(z))
        for centre in one_convolution.crest_positions_mm:
            s = np.clip(0.5 * one_convolution.seat_mm - np.abs(z - centre), 0.0, 1.0)
            grade = np.maximum(grade, s * s * (3.0 - 2.0 * s))
        bodies = RigidBodies(5.0, 2.0, grade, one_convolution.crest_positions_mm, one_convolution.seat_radius_mm)
        problem = make_problem(
            mesh,
            laws[law],
            bodies=bodies,
            cavity=FACETS["cavity"],
            clamped=FACETS["clamped"],
            bond=FACETS["bond"],
            held=((FACETS["axis"], 0),) if dimension == 2 else (),
        )
        return SimpleNamespace(mesh=mesh, problem=problem, factor=Factor(problem))

    return build


@pytest.fixture(scope="session")
def inflated(bellows_problem):
    """Cached path of the axisymmetric bellows to 5 and 10 kPa, solved to 1e-11."""
    from solvers.equilibrium.newton import NewtonSettings
    from solvers.paths.path import follow_path
    from solvers.paths.states import PathSettings

    @functools.cache
    def follow(law="yeoh"):
        case = bellows_problem(2, law)
        settings = PathSettings(newton=NewtonSettings(relative_tolerance=1e-11))
        path = follow_path(case.problem, case.factor, [0.005, 0.010], settings)
        assert path.reached, path.reason
        return path

    return follow


@pytest.fixture(scope="session")
def inflated_solid(bellows_problem, inflated):
    """The same in 3D, started from the revolved axisymmetric states; only the requested pressures."""
    from meshes.revolve import revolve_vector
    from solvers.equilibrium.newton import NewtonSettings
    from solvers.paths.states import PathSettings
    from solvers.paths.warm_start import follow_guesses
    from solvers.state import State

    @functools.cache
    def follow(law="yeoh"):
        case = bellows_problem(3, law)
        guesses = []
        for point in inflated(law).states:
            if point.asked:
                flat = point.state
                motions = np.zeros((len(flat.bodies_mm), 6))
                motions[:, 2] = flat.bodies_mm[:, 0]
                u = revolve_vector(flat.displacement_mm, case.mesh)
                guesses.append(State(u, flat.pressure_mpa[case.mesh.meridian_node], motions, flat.load_mpa))
        settings = PathSettings(newton=NewtonSettings(relative_tolerance=1e-11))
        path = follow_guesses(case.problem, case.factor, guesses, settings)
        assert path.reached, path.reason
        return path

    return follow
