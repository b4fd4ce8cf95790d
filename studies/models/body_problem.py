"""Simple bodies and users' meshes as boundary value problems, and what is read off their states."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from mpi4py import MPI

from meshes.bodies import (
    GRADED_BEYOND,
    block,
    cells_through,
    cook_membrane,
    cylinder_meridian,
    sphere_meridian,
    tube_meridian,
    ventricle_meridian,
)
from meshes.cells import CellKind
from meshes.solid import FACETS, FloatArray, IntArray, SolidMesh
from meshes.surface import surface_weights
from meshes.sweep import revolve_hexahedra
from solvers.assembly.surfaces import SOFT, Surfaces
from solvers.bodies.rigid import AXIAL, RigidBodies
from solvers.discrete.domain import create_domain
from solvers.energy.materials import Material
from solvers.problem import Problem
from solvers.state import State
from studies.models.build import spaces_of
from studies.models.users.body import users_body, users_measures
from studies.planning.bodies import cells_of
from studies.planning.levels import fineness
from studies.scene.bodies import BodyScene
from studies.scene.body_geometry import (
    BlockGeometry,
    CookGeometry,
    CylinderGeometry,
    MeshGeometry,
    RingGeometry,
    SphereGeometry,
    TubeGeometry,
    VentricleGeometry,
)
from studies.scene.materials import inverse_kappa, law_of
from studies.scene.meshes import revolved
from studies.scene.users_mesh import numbers_of_tables

Held = tuple[tuple[int, int], ...]
# Cells of a bonded tube are half a wall long; a longer tube is uniform away from its ends.
LONGEST_ROW = 40
# Stiffness of the layer between a cap and the tube it glides on, MPa/mm: the thrust of the cap comes to the tube at its
# inner edge, which must not sink in. With 1e4 the bore was 0.06 % off on the finest mesh, and the more the finer.
CAP_MPA_PER_MM = 1e6
# Material numbers of volumes with a table of their own: the mesh's region and this.
OTHERS = 10
# Stiffness of the layer between a twisted cylinder and its plate, MPa/mm: it slips by 1e-7 of its own twist.
TWIST_MPA_PER_MM = 1e5
# Both are for silicones: layers on a body of a larger initial shear modulus, MPa, are as much stiffer.
SILICONE_MPA = 0.1


@dataclass(frozen=True)
class Body:
    """A mesh and what holds and loads it.

    Attributes
    ----------
    mesh
        The mesh.
    surfaces
        Facet numbers with a role.
    parts
        The mesh is one of so many of the whole.
    frame
        Directions of the displacement's components as columns, (3, 3); None for those of the coordinates.
    capped
        True if a rigid cap rides on the facets named bond.
    twisted
        True if these facets are bonded to a plate that is turned.
    rigid
        Rigid bodies of a user's mesh, and the facets that are bonded to each, -1 elsewhere.
    """

    mesh: SolidMesh
    surfaces: Surfaces
    parts: int = 1
    frame: FloatArray | None = None
    capped: bool = False
    twisted: bool = False
    rigid: tuple[RigidBodies, IntArray] | None = None


def body_of(scene: BodyScene, model: str, level: str) -> Body:
    """The mesh of a scene on a level, with its supports and its load."""
    g, fine = scene.geometry, fineness(level)
    cells: CellKind = "quadrilaterals" if cells_of(scene, model) == "hexahedra" else "triangles"
    if isinstance(g, TubeGeometry):
        return _tube(g, model, fine, cells)
    if isinstance(g, SphereGeometry):
        return _sphere(g, model, fine, cells)
    if isinstance(g, RingGeometry):
        return _ring(g, fine, scene.load_kind == "dead")
    if isinstance(g, BlockGeometry):
        return _block(g, fine)
    if isinstance(g, CylinderGeometry):
        return _cylinder(g, fine, cells)
    if isinstance(g, CookGeometry):
        return _cook(fine)
    if isinstance(g, VentricleGeometry):
        return _ventricle(g, model, fine, cells)
    mesh, surfaces, rigid = users_body(scene, g, fine)
    return Body(mesh, surfaces, rigid=rigid)


def problem_of(scene: BodyScene, body: Body, comm: MPI.Comm, richer: bool = False) -> Problem:
    """The boundary value problem, or a richer one (see `scene_problem`); every rank calls with the same body."""
    mesh, numbers = body.mesh, {}
    if comm.rank == 0:
        numbers = numbers_of_tables(mesh, list(scene.materials))
        # whatever has no table is of the scene's material
        regions = np.where(np.isin(mesh.regions, list(numbers)), mesh.regions + OTHERS, SOFT)
        mesh = dataclasses.replace(mesh, regions=regions)
        if body.rigid is not None:
            bond = np.where(body.rigid[1] >= 0, FACETS["bond"], mesh.facet_tags)
            mesh = dataclasses.replace(mesh, facet_tags=bond, facet_bodies=body.rigid[1])
    tables = {number + OTHERS: scene.materials[name] for number, name in comm.bcast(numbers).items()}
    others = {number: Material(law_of(of), inverse_kappa(of)) for number, of in tables.items()}
    domain = create_domain(comm, mesh if comm.rank == 0 else None)
    law, bodies = law_of(scene.material), None if body.rigid is None else body.rigid[0]
    if body.capped or body.twisted:
        bodies = _plate(body, max(1.0, law.initial_shear_modulus_mpa / SILICONE_MPA))
    return Problem(
        domain,
        law,
        inverse_kappa(scene.material),
        body.surfaces,
        None,
        bodies,
        *spaces_of(scene.mesh, domain, richer),
        frame=body.frame,
        others=others,
    )


def _plate(body: Body, stiffer: float) -> RigidBodies:
    """The plate that twists a cylinder, or a tube's cap: level, and the end slides on it so that the tube stays one.

    Parameters
    ----------
    stiffer
        By what the stiffness of its layer is multiplied.
    """
    points = body.mesh.points
    grade, centre = np.ones(len(points)), np.array([float(points[:, -1].max())])
    if body.twisted:
        twist = stiffer * TWIST_MPA_PER_MM
        return RigidBodies(twist, twist, grade, centre, 1.0, plate=0, plate_held=True)
    inner = float(np.hypot(points[:, 0], points[:, 1] * (body.mesh.dimension == 3)).min())
    area = math.pi * inner**2
    return RigidBodies(stiffer * CAP_MPA_PER_MM, 0.0, grade, centre, 1.0, motions=AXIAL, plate=0, plate_area_mm2=area)


def measures(scene: BodyScene, mesh: SolidMesh) -> dict[str, Callable[[State], float]]:
    """What is read off a state, by quantity, mm."""
    if isinstance(scene.geometry, BlockGeometry | CylinderGeometry):
        return {}  # a cube stays as it is; what is known of a cylinder are forces
    if isinstance(scene.geometry, CookGeometry):
        return {"corner_mm": lambda state: float(state.displacement_mm[mesh.tip_centre_node, 1])}
    if isinstance(scene.geometry, VentricleGeometry):
        on_axis = np.linalg.norm(mesh.points[:, :-1], axis=1) < 1e-9
        inside = int(np.flatnonzero(on_axis)[mesh.points[on_axis, -1].argmin()])
        nodes = {"apex_inside_mm": inside, "apex_outside_mm": mesh.tip_centre_node}
        # in the published frame the apex points down
        return {name: partial(_depth, mesh.points[node, -1], node) for name, node in nodes.items()}
    if isinstance(scene.geometry, MeshGeometry):
        return users_measures(mesh)
    weights = surface_weights(mesh, "cavity")
    outwards = mesh.points.copy()
    if scene.geometry.kind != "sphere":
        outwards[:, -1] = 0.0
    inside = weights != 0.0
    outwards[inside] /= np.linalg.norm(outwards[inside], axis=1, keepdims=True)
    outwards[~inside] = 0.0
    share = weights / weights.sum()
    return {"bore_mm": lambda state: float(share @ np.sum(state.displacement_mm * outwards, axis=1))}


def _depth(start_mm: float, node: int, state: State) -> float:
    """Position of a node along the axis with the apex pointing down, mm."""
    return -float(start_mm + state.displacement_mm[node, -1])


def enclosed_mm3(scene: BodyScene, load_volume_mm3: float) -> float:
    """Volume inside a body from that on which its load does work; a dead load's is what it is."""
    return -load_volume_mm3 if scene.load_kind == "external" else load_volume_mm3


# --- bodies -------------------------------------------------------------------------------------------------


def _tube(g: TubeGeometry, model: str, fine: int, cells: CellKind) -> Body:
    refine = fine if model == "axisymmetric" else 1
    in_wall = 2 * fine if model == "axisymmetric" else max(2, fine // 4)
    along = in_wall // 2
    if g.ends == "bonded":
        wall = min(g.outer_radius_mm, GRADED_BEYOND * g.inner_radius_mm) - g.inner_radius_mm
        # two at least on the coarsest mesh, so that each finer one has more
        along = min(max(2, math.ceil(2.0 * g.length_mm / wall)), LONGEST_ROW) * refine
        along = along if model == "axisymmetric" else max(2, along * fine // 12)
    through = cells_through(g.outer_radius_mm / g.inner_radius_mm, in_wall)
    meridian = tube_meridian(g.inner_radius_mm, g.outer_radius_mm, g.length_mm, along, through, cells)
    return _swept(meridian, model, fine, g.ends)


def _sphere(g: SphereGeometry, model: str, fine: int, cells: CellKind) -> Body:
    along, in_wall = (6 * fine, 2 * fine) if model == "axisymmetric" else (max(6, fine // 2), max(2, fine // 4))
    through = cells_through(g.outer_radius_mm / g.inner_radius_mm, in_wall)
    meridian = sphere_meridian(g.inner_radius_mm, g.outer_radius_mm, along, through, cells)
    body = _swept(meridian, model, fine, "symmetric")
    return dataclasses.replace(body, parts=2 * body.parts)


def _swept(meridian: SolidMesh, model: str, fine: int, ends: str) -> Body:
    """A meridian, the quarter of its body of revolution or all of it, its ends held."""
    mesh, parts = meridian, 1
    held: list[tuple[int, int]] = []
    pinned: Held = ()
    if model == "axisymmetric":
        held.append((FACETS["axis"], 0))
    elif model == "sector":
        mesh, parts = revolved(meridian, fine, 4), 4
        held += [(FACETS["start"], 1), (FACETS["end"], 0)]
    else:
        mesh = revolved(meridian, fine)
        if ends != "bonded":
            pinned = _three_pins(mesh)
    axial, cavity = mesh.dimension - 1, FACETS["cavity"]
    bottom, top = FACETS["bottom"], FACETS["top"]
    if ends == "capped":
        on_top = mesh.facet_tags == top
        mesh = dataclasses.replace(mesh, facet_bodies=np.where(on_top, 0, -1))
        surfaces = Surfaces(cavity=cavity, held=(*held, (bottom, axial)), pinned=pinned, bond=top)
        return Body(mesh, surfaces, parts, capped=True)
    if ends == "bonded":
        held += [(top, i) for i in range(mesh.dimension)]
        return Body(mesh, Surfaces(cavity=cavity, clamped=bottom, held=tuple(held)), parts)
    held += [(bottom, axial), (top, axial)]
    return Body(mesh, Surfaces(cavity=cavity, held=tuple(held), pinned=pinned), parts)


def _three_pins(mesh: SolidMesh) -> Held:
    """Pins that hold drifting and turning of a body of revolution, where its own motion is nought by symmetry."""
    low = mesh.points[:, 2] < mesh.points[:, 2].min() + 1e-9
    radius = np.hypot(mesh.points[:, 0], mesh.points[:, 1])
    rim = np.flatnonzero(low & (radius > radius[low].max() - 1e-9))
    x, y = mesh.points[rim, 0], mesh.points[rim, 1]
    return ((int(rim[x.argmax()]), 1), (int(rim[x.argmin()]), 1), (int(rim[y.argmax()]), 0))


def _ring(g: RingGeometry, fine: int, dead: bool) -> Body:
    wall = g.outer_radius_mm - g.inner_radius_mm
    through = cells_through(g.outer_radius_mm / g.inner_radius_mm, 2 * fine)
    angle = math.pi / g.waves
    # As thick as cells are in the plane: in thicker ones false modes that vary along the axis cost next to nothing.
    thick = min(wall / through, angle / (6 * fine) * g.inner_radius_mm)
    meridian = tube_meridian(g.inner_radius_mm, g.outer_radius_mm, thick, 1, through, "quadrilaterals")
    mesh = revolve_hexahedra(meridian, 6 * fine, angle)
    # Components along both planes of symmetry: what crosses the one at angle 0 is the second, at the end the first.
    frame = np.eye(3)
    frame[:2, 1] = math.cos(angle), math.sin(angle)
    held = ((FACETS["start"], 1), (FACETS["end"], 0), (FACETS["bottom"], 2), (FACETS["top"], 2))
    outer = FACETS["outer"]
    surfaces = Surfaces(dead_pressure=outer, held=held) if dead else Surfaces(external=outer, held=held)
    return Body(mesh, surfaces, 2 * g.waves, frame if g.waves != 2 else None)


def _block(g: BlockGeometry, fine: int) -> Body:
    mesh = block((g.edge_mm,) * 3, (fine,) * 3)
    corner = mesh.tip_centre_node
    return Body(mesh, Surfaces(dead=FACETS["outer"], pinned=tuple((corner, i) for i in range(3))))


def _cylinder(g: CylinderGeometry, fine: int, cells: CellKind) -> Body:
    along = max(1, round(g.length_mm / g.radius_mm * fine / 4))
    meridian = cylinder_meridian(g.radius_mm, g.length_mm, fine // 2, along, cells)
    mesh = revolved(meridian, fine)
    on_top = mesh.facet_tags == FACETS["top"]
    mesh = dataclasses.replace(mesh, facet_bodies=np.where(on_top, 0, -1))
    # without pressure: the loaded surface only says what residuals are measured by
    surfaces = Surfaces(external=FACETS["outer"], clamped=FACETS["bottom"], bond=FACETS["top"])
    return Body(mesh, surfaces, twisted=True)


def _cook(fine: int) -> Body:
    held = ((FACETS["bottom"], 2), (FACETS["top"], 2))
    return Body(
        cook_membrane(fine, 16.0 / fine), Surfaces(dead_shear=FACETS["tip"], clamped=FACETS["clamped"], held=held)
    )


def _ventricle(g: VentricleGeometry, model: str, fine: int, cells: CellKind) -> Body:
    along, in_wall = (8 * fine, 2 * fine) if model == "axisymmetric" else (fine, max(2, fine // 8))
    inner, outer = (g.inner_across_mm, g.inner_along_mm), (g.outer_across_mm, g.outer_along_mm)
    through = cells_through(max(b / a for a, b in zip(inner, outer, strict=True)), in_wall)
    meridian = ventricle_meridian(inner, outer, g.base_mm, along, through, cells)
    clamped, cavity = FACETS["clamped"], FACETS["cavity"]
    if model == "axisymmetric":
        return Body(meridian, Surfaces(cavity=cavity, clamped=clamped, held=((FACETS["axis"], 0),)))
    if model == "sector":
        mesh = revolved(meridian, fine, 4)
        held = ((FACETS["start"], 1), (FACETS["end"], 0))
        return Body(mesh, Surfaces(cavity=cavity, clamped=clamped, held=held), parts=4)
    mesh = revolved(meridian, fine)
    return Body(mesh, Surfaces(cavity=cavity, clamped=clamped))
