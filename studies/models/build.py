"""From a scene to meshes, boundary value problems, first guesses, and what is read off their states."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from analytical.laws.silicones import SILICONE_DENSITY_G_CM3
from meshes.quality import region_volumes_mm3
from meshes.revolve import revolve_scalar, revolve_vector
from meshes.solid import FACETS, REGIONS, SolidMesh
from meshes.surface import surface_weights
from solvers.assembly.surfaces import SOFT, STIFF, Surfaces
from solvers.bodies.rigid import AXIAL, RigidBodies
from solvers.discrete.domain import Domain, create_domain
from solvers.discrete.elements import ENRICHED, P1_P0, P2_P0, Element
from solvers.problem import Problem
from solvers.stability.parity import Plane, symmetric_class
from solvers.state import State, pressure_at_corners
from studies.scene.bellows import (
    RIGID_BOND_MPA_PER_MM,
    BellowsScene,
    bond_grade,
    bond_stiffness,
    ring_material,
    shape_of,
)
from studies.scene.elements import Mesh
from studies.scene.materials import inverse_kappa, law_of
from studies.scene.meshes import SECTORS, Part

# Planes of symmetry at which a part of a body ends.
PLANES: Mapping[Part, tuple[Plane, ...]] = {
    "full3d": (),
    "half": (Plane((FACETS["start"], FACETS["end"]), 1),),
    "sector": (Plane((FACETS["start"],), 1), Plane((FACETS["end"],), 0)),
}


def part_of(mesh: SolidMesh) -> Part:
    """What a mesh is of a body; a meridian is none of its parts, and cut by no plane."""
    if FACETS["start"] not in mesh.facet_tags:
        return "full3d"
    return "half" if mesh.angle_rad.max() > 0.75 * math.pi else "sector"


def element_of(mesh: Mesh) -> Element | None:
    """Displacement and pressure spaces; None for the usual ones of the cells."""
    return {"tet-p0": P2_P0, "tet-p1": P1_P0}.get(mesh.element)


def spaces_of(mesh: Mesh, domain: Domain, richer: bool) -> tuple[Element | None, int | None]:
    """Spaces and their quadrature degree, None for the usual ones; or a richer pair, for `solvers.estimate`."""
    return ENRICHED[domain.cell_name] if richer else (element_of(mesh), None)


def scene_problem(scene: BellowsScene, mesh: SolidMesh | None, comm: MPI.Comm, richer: bool = False) -> Problem:
    """The boundary value problem of a scene on a mesh that rank 0 holds; every rank calls.

    Parameters
    ----------
    richer
        On a meridian: with a richer pair of spaces, which tells the error of the usual one.
    """
    material_numbers = None
    if mesh is not None:
        numbers = np.where(mesh.regions == REGIONS["ring"], STIFF, SOFT)
        material_numbers = dataclasses.replace(mesh, regions=numbers)
    plate = scene.geometry.tip == "rigid"
    if material_numbers is not None and plate:
        material_numbers = _bond_to_plate(material_numbers, _ring_count(scene))
    domain = create_domain(comm, material_numbers)
    stiff = ring_material(scene) if scene.rings.model == "meshed" else None
    part = comm.bcast(None if mesh is None else part_of(mesh))
    symmetric = symmetric_class(PLANES[part])
    bodies = None
    if scene.rings.model == "rigid" or plate:
        shape = shape_of(scene)
        axial = comm.bcast(None if mesh is None else mesh.points[:, -1])
        normal, tangential = bond_stiffness(scene)
        grade = bond_grade(scene, axial)
        centres = shape.crest_positions_mm[: _ring_count(scene)]
        if plate:
            # The plate's bond is at least as stiff as one meant as rigid; no seat reaches as far as the open end.
            grade[np.isclose(axial, shape.cavity_length_mm)] = RIGID_BOND_MPA_PER_MM / min(normal, tangential)
            centres = np.append(centres, shape.cavity_length_mm)
        bodies = RigidBodies(
            normal,
            tangential,
            grade,
            centres,
            shape.seat_radius_mm,
            motions=symmetric.motions,
            plate=len(centres) - 1 if plate else None,
            plate_area_mm2=comm.bcast(None if mesh is None else _rim_area(mesh)) if plate else 0.0,
            plate_held=scene.blocked,
            plate_force_n=scene.load.tip_force_n / SECTORS[part],
        )
    held = ((FACETS["axis"], 0),) if domain.axisymmetric else symmetric.held
    surfaces = Surfaces(
        cavity=FACETS["cavity"] if scene.load.sense > 0.0 else None,
        suction=FACETS["cavity"] if scene.load.sense < 0.0 else None,
        clamped=FACETS["clamped"],
        bond=FACETS["bond"] if bodies is not None else None,
        held=held,
        blocked=FACETS["tip"] if scene.blocked and not plate else None,
    )
    law = law_of(scene.material)
    spaces = spaces_of(scene.mesh, domain, richer)
    return Problem(domain, law, inverse_kappa(scene.material), surfaces, stiff, bodies, *spaces)


def _ring_count(scene: BellowsScene) -> int:
    """Number of rigid rings."""
    return scene.geometry.convolutions + 1 if scene.rings.model == "rigid" else 0


def _bond_to_plate(mesh: SolidMesh, number: int) -> SolidMesh:
    """The mesh with the annulus of its open end bonded to the body of a number."""
    tip = mesh.facet_tags == FACETS["tip"]
    return dataclasses.replace(
        mesh,
        facet_tags=np.where(tip, FACETS["bond"], mesh.facet_tags),
        facet_bodies=np.where(tip, number, mesh.facet_bodies),
    )


def _rim_area(mesh: SolidMesh) -> float:
    """Area within the inner rim of the open end, mm^2: by its parabolas in three dimensions; a sector's is its own."""
    z = mesh.points[:, -1]
    r = np.hypot(mesh.points[:, 0], mesh.points[:, 1]) if mesh.dimension == 3 else mesh.points[:, 0]
    end = np.isclose(z, mesh.points[mesh.tip_centre_node, -1])
    inner = r[end].min()
    rim = np.flatnonzero(end & np.isclose(r, inner))
    if mesh.dimension == 2:
        return float(np.pi * inner**2)
    along = rim[np.argsort(mesh.angle_rad[rim])]  # corners and middles in turn, a corner first
    if FACETS["start"] not in mesh.facet_tags:
        along = np.append(along, along[0])
    corners, middles = mesh.points[along[::2], :2].T, mesh.points[along[1::2], :2].T
    a, b, c = corners[:, :-1], middles, corners[:, 1:]

    def cross(p: np.ndarray, q: np.ndarray) -> np.ndarray:
        return np.asarray(p[0] * q[1] - p[1] * q[0])

    return float(np.sum(4.0 * cross(a, b) + 4.0 * cross(b, c) - cross(a, c)) / 6.0)


def revolve_state(state: State, meridian: SolidMesh, body: SolidMesh) -> State:
    """An axisymmetric state as a first guess on the revolved mesh.

    A pressure with jumps between cells is averaged at corners: displacements decide the guess, the pressure follows
    from them in one Newton step.
    """
    motions = state.bodies_mm
    if len(motions):
        mine = symmetric_class(PLANES[part_of(body)]).motions
        motions = np.zeros((len(motions), len(mine)))
        motions[:, mine.index(AXIAL[0])] = state.bodies_mm[:, 0]
    pressure = revolve_scalar(pressure_at_corners(state, meridian.cells, meridian.cell.corners), body)
    if state.pressure_mpa.ndim == 2:
        pressure = pressure[body.cells[:, : body.cell.corners]]
    return State(revolve_vector(state.displacement_mm, body), pressure, motions, state.load_mpa)


class Tip:
    """Mean axial displacement of the distal rim, weighted by its undeformed area, or the motion of a rigid plate."""

    def __init__(self, scene: BellowsScene, mesh: SolidMesh) -> None:
        self._plate = scene.geometry.tip == "rigid"
        self._axial = 0 if mesh.dimension == 2 else symmetric_class(PLANES[part_of(mesh)]).motions.index(AXIAL[0])
        facets = mesh.facets[mesh.facet_tags == FACETS["tip"]]
        ends = mesh.points[facets]
        if mesh.dimension == 2:
            # area of the cone between two radii
            weight = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) * (ends[:, 0, 0] + ends[:, 1, 0])
        else:
            # The triangles of any three corners; of a quadrilateral's, each of the two diagonals' pairs fills it once.
            weight = np.zeros(len(ends))
            for a, b, c in itertools.combinations(range(ends.shape[1]), 3):
                weight += np.linalg.norm(np.cross(ends[:, b] - ends[:, a], ends[:, c] - ends[:, a]), axis=1)
        self._facets, self._weight = facets, weight / weight.sum()
        self._centre = mesh.tip_centre_node

    def mean_mm(self, state: State) -> float:
        """Mean over the rim."""
        if self._plate:
            return float(state.bodies_mm[-1, self._axial])
        return float(self._weight @ state.displacement_mm[self._facets, -1].mean(axis=1))

    def centre_mm(self, state: State) -> float:
        """At the axis."""
        if self._plate:
            return self.mean_mm(state)
        return float(state.displacement_mm[self._centre, -1])


@dataclass(frozen=True)
class TipPose:
    """The rim of the distal face in a state, as a whole.

    Attributes
    ----------
    sideways_mm, across_mm
        Mean displacement along x and along y.
    bend_deg, bend_across_deg
        Angles by which the rim's plane faces x and y instead of the axis.
    """

    sideways_mm: float
    across_mm: float
    bend_deg: float
    bend_across_deg: float


def tip_pose(mesh: SolidMesh, state: State) -> TipPose:
    """Measure the rim of a whole body, weighted by the undeformed area; its plane is that of least squares."""
    weights = surface_weights(mesh, "tip")
    share = weights / weights.sum()
    moved = share @ state.displacement_mm
    here = mesh.points + state.displacement_mm
    away = (here - share @ here) * np.sqrt(np.abs(share))[:, None]
    normal = np.linalg.svd(away, full_matrices=False)[2][-1]
    normal = normal * math.copysign(1.0, normal[2])
    angles = [math.degrees(math.atan2(normal[k], normal[2])) for k in (0, 1)]
    return TipPose(float(moved[0]), float(moved[1]), angles[0], angles[1])


def masses_g(scene: BellowsScene, meridian: SolidMesh) -> tuple[float, float]:
    """Mass of silicone and rings, g; rings that are not meshed count with their section."""
    volumes = region_volumes_mm3(meridian)
    silicone = (volumes["elastomer"] + volumes["cap"]) * 1e-3 * SILICONE_DENSITY_G_CM3
    ring_mm3 = volumes["ring"]
    if scene.rings.model == "rigid":
        r, rings = shape_of(scene).seat_radius_mm, scene.rings
        section = ((r + rings.height_mm) ** 2 - r**2) * math.pi * rings.seat_mm
        # a quarter circle of radius q replaces a square at each of the two outer edges
        q, outer = rings.edge_radius_mm, r + rings.height_mm
        lost = 2.0 * (1.0 - math.pi / 4.0) * q**2 * 2.0 * math.pi * (outer - 0.2234 * q)
        ring_mm3 = (section - lost) * (scene.geometry.convolutions + 1)
    return silicone, ring_mm3 * 1e-3 * ring_material(scene).density_g_cm3
