"""The bodies of the stress test: their meshes and problems, and what is measured of their states."""

from __future__ import annotations

import dataclasses
import math
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from mpi4py import MPI

from analytical.laws.stiff import StiffSolid
from meshes.bodies import sphere_meridian, tube_meridian
from meshes.meridian import default_resolution, meridian_mesh
from meshes.solid import FACETS, REGIONS, SolidMesh
from meshes.surface import surface_weights
from solvers.assembly.surfaces import SOFT, STIFF, Surfaces
from solvers.discrete.domain import create_domain
from solvers.discrete.elements import P2_P0
from solvers.problem import Problem
from solvers.state import State, pressure_at_corners
from studies.first_rank import first
from studies.models.build import Tip, scene_problem
from studies.results import provenance
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.load import load_bellows
from studies.scene.materials import inverse_kappa, law_of
from studies.scene.meshes import scene_meridian
from studies.scene.sections import SceneError
from studies.stability.cells import Bellows, Cell, Flaw, Round
from studies.stability.controls import problem_with
from studies.stability.exact import exact_answer
from studies.stability.meshes import shaken, zigzag

SCENE = provenance.ROOT / "scenes" / "smoke-t2-ri5.toml"
POISSON = 0.36  # of rings of any modulus: that of the PLA


@dataclass(frozen=True)
class Posed:
    """A body that can be solved.

    Attributes
    ----------
    problem
        Of the solver.
    value_mm
        Displacement of the bore or of the tip, mm.
    pressure_error_percent
        Root mean square error of the pressure in the wall over its largest value; NaN if it is not known.
    room_mm
        By so much rings can come closer; infinite without rings.
    """

    problem: Problem
    value_mm: Callable[[State], float]
    pressure_error_percent: Callable[[State], float] = lambda state: math.nan
    room_mm: float = math.inf


def pose(cell: Cell, comm: MPI.Comm) -> Posed:
    """The body of a cell on all ranks of ``comm``.

    Raises
    ------
    SceneError, GeometryError, MeshError, MaterialError, SolverError
        If it cannot be.
    """
    if isinstance(cell.body, Round):
        return _pose_round(cell, cell.body, comm)
    return pose_bellows(cell.body, abs(cell.load_kpa), comm, cell.flaw)


def pose_bellows(body: Bellows, load_kpa: float, comm: MPI.Comm, flaw: Flaw = "") -> Posed:
    """The bellows at loads up to a pressure or a vacuum; raises as `pose` does."""
    scene = scene_of(body, load_kpa)
    mesh = first(comm, lambda: _bellows_mesh(scene, body))
    problem = _bellows_problem(scene, body, mesh, comm, flaw)
    room_mm = 2.0 * scene.geometry.half_pitch_mm - scene.rings.seat_mm
    return Posed(problem, Tip(scene, mesh).mean_mm, room_mm=room_mm)


def scene_of(body: Bellows, load_kpa: float) -> BellowsScene:
    """The scene of a bellows, through the same checks as a user's file.

    Raises
    ------
    SceneError
        If a change is not allowed.
    """
    document = tomlkit.parse(SCENE.read_text(encoding="utf-8"))
    for key, value in (("load.pressure_kpa", [load_kpa]), *body.changes):
        section, name = key.split(".")
        table: Any = document.setdefault(section, {})
        table[name] = list(value) if isinstance(value, tuple) else value
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "scene.toml")
        path.write_text(tomlkit.dumps(document), encoding="utf-8")
        try:
            return load_bellows(path)
        except SceneError as error:
            raise SceneError(str(error).replace(f"{path}: ", "")) from None


def _bellows_mesh(scene: BellowsScene, body: Bellows) -> SolidMesh:
    if body.cell_mm is None and body.through is None:
        mesh = scene_meridian(scene, body.level)
    else:
        shape = shape_of(scene)
        usual = default_resolution(shape, body.level, "quadrilaterals")
        fine = dataclasses.replace(usual, cell_mm=body.cell_mm or usual.cell_mm, through=body.through or usual.through)
        mesh = meridian_mesh(shape, fine, None, "quadrilaterals")
    return shaken(mesh, body.noise, body.seed) if body.noise else mesh


def _bellows_problem(scene: BellowsScene, body: Bellows, mesh: SolidMesh, comm: MPI.Comm, flaw: Flaw) -> Problem:
    """Of the scene; of meshed rings with another modulus; or of a control, without rings."""
    if body.contrast is None and not flaw:
        return scene_problem(scene, mesh if comm.rank == 0 else None, comm)
    numbers = np.where(mesh.regions == REGIONS["ring"], STIFF, SOFT)
    domain = create_domain(comm, dataclasses.replace(mesh, regions=numbers) if comm.rank == 0 else None)
    law = law_of(scene.material)
    surfaces = Surfaces(cavity=FACETS["cavity"], clamped=FACETS["clamped"], held=((FACETS["axis"], 0),))
    if body.contrast is None:
        assert scene.rings.model == "none"
        return problem_with(flaw, domain, law, inverse_kappa(scene.material), surfaces)
    rings = StiffSolid(3.0 * law.initial_shear_modulus_mpa * body.contrast, POISSON, 1.0)
    return Problem(domain, law, inverse_kappa(scene.material), surfaces, rings)


def _pose_round(cell: Cell, body: Round, comm: MPI.Comm) -> Posed:
    mesh = _round_mesh(body)
    given = dataclasses.replace(mesh, regions=np.full(len(mesh.cells), SOFT)) if comm.rank == 0 else None
    domain = create_domain(comm, given)
    held = ((FACETS["axis"], 0), (FACETS["bottom"], 1), (FACETS["top"], 1))
    vacuum = cell.load_kpa < 0.0
    surfaces = Surfaces(external=FACETS["outer"], held=held) if vacuum else Surfaces(cavity=FACETS["cavity"], held=held)
    inverse = 1.0 / (body.kappa_over_mu * body.law.initial_shear_modulus_mpa)
    element = P2_P0 if body.element == "P2/P0" else None
    problem = problem_with(cell.flaw, domain, body.law, inverse, surfaces, element)
    if cell.flaw == "raw energy":  # its multiplier is another quantity than the pressure
        return Posed(problem, _bore(body, mesh))
    return Posed(problem, _bore(body, mesh), _pressure_error(body, mesh, 1e-3 * cell.load_kpa))


def _round_mesh(body: Round) -> SolidMesh:
    inner, outer = body.inner_mm, body.inner_mm + body.wall_mm
    if body.kind == "tube":
        mesh = tube_meridian(inner, outer, body.length_mm, body.along, body.through, body.cells)
    else:
        mesh = sphere_meridian(inner, outer, body.along, body.through, body.cells)
    if body.zigzag:
        mesh = zigzag(mesh, body.zigzag, polar=body.kind == "sphere")
    return shaken(mesh, body.noise, body.seed) if body.noise else mesh


def _bore(body: Round, mesh: SolidMesh) -> Callable[[State], float]:
    """Mean displacement of the inner surface outwards, mm."""
    weights = surface_weights(mesh, "cavity")
    inside = weights != 0.0
    outwards = mesh.points * np.array([1.0, float(body.kind == "sphere")])
    outwards[~inside] = 0.0
    outwards[inside] /= np.linalg.norm(outwards[inside], axis=1, keepdims=True)
    share = weights / weights.sum()
    return lambda state: float(share @ np.sum(state.displacement_mm * outwards, axis=1))


def _pressure_error(body: Round, mesh: SolidMesh, load_mpa: float) -> Callable[[State], float]:
    """Error of the pressure in the wall, percent; exact stresses are for a free outer surface."""

    def error_percent(state: State) -> float:
        answer = exact_answer(body, load_mpa)
        if answer.multiplier_mpa is None:
            return math.nan
        at = mesh.corners
        radius = mesh.points[at, 0] if body.kind == "tube" else np.linalg.norm(mesh.points[at], axis=1)
        # a pressure on the outer surface adds itself
        exact = answer.multiplier_mpa(radius) - (abs(load_mpa) if load_mpa < 0.0 else 0.0)
        found = pressure_at_corners(state, mesh.cells, mesh.cell.corners)[at]
        return float(100.0 * np.sqrt(np.mean((found - exact) ** 2)) / np.abs(exact).max())

    return error_percent
