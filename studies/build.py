"""From a scene to meshes, boundary value problems, first guesses, and what is read off their states."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from mpi4py import MPI

from analytical.materials import SILICONE_DENSITY_G_CM3
from meshes.meridian import default_resolution, meridian_mesh
from meshes.quality import region_volumes_mm3
from meshes.revolve import revolve_vector
from meshes.solid import FACETS, REGIONS, SolidMesh
from solvers.domain import create_domain
from solvers.problem import SOFT, STIFF, Problem, Surfaces
from solvers.rigid import RigidBodies
from solvers.state import State
from studies.scene import (
    Scene,
    bond_grade,
    bond_stiffness,
    inverse_kappa,
    law_of,
    ring_material,
    ring_shape,
    shape_of,
)


def scene_meridian(scene: Scene, refinement: int) -> SolidMesh:
    """The meridian mesh of a scene at a refinement."""
    shape = shape_of(scene)
    ring = ring_shape(scene) if scene.rings.model == "meshed" else None
    return meridian_mesh(shape, default_resolution(shape, refinement), ring)


def scene_problem(scene: Scene, mesh: SolidMesh | None, comm: MPI.Comm) -> Problem:
    """The boundary value problem of a scene on a mesh that rank 0 holds; every rank calls."""
    material_numbers = None
    if mesh is not None:
        numbers = np.where(mesh.regions == REGIONS["ring"], STIFF, SOFT)
        material_numbers = dataclasses.replace(mesh, regions=numbers)
    domain = create_domain(comm, material_numbers)
    stiff = ring_material(scene) if scene.rings.model == "meshed" else None
    bodies = None
    if scene.rings.model == "rigid":
        shape = shape_of(scene)
        axial = comm.bcast(None if mesh is None else mesh.points[:, -1])
        normal, tangential = bond_stiffness(scene)
        bodies = RigidBodies(
            normal, tangential, bond_grade(scene, axial), shape.crest_positions_mm, shape.seat_radius_mm
        )
    surfaces = Surfaces(
        cavity=FACETS["cavity"],
        clamped=FACETS["clamped"],
        bond=FACETS["bond"] if bodies is not None else None,
        held=((FACETS["axis"], 0),) if domain.axisymmetric else (),
    )
    law = law_of(scene.material)
    return Problem(domain, law, inverse_kappa(scene.material), surfaces, stiff, bodies)


def revolve_state(scene: Scene, state: State, body: SolidMesh) -> State:
    """An axisymmetric state as a first guess on the revolved mesh."""
    bodies = np.zeros((0, 0))
    if scene.rings.model == "rigid":
        bodies = np.zeros((len(state.bodies_mm), 6))
        bodies[:, 2] = state.bodies_mm[:, 0]
    return State(
        revolve_vector(state.displacement_mm, body),
        state.pressure_mpa[body.meridian_node],
        bodies,
        state.load_mpa,
    )


class Tip:
    """Mean axial displacement of the distal rim, weighted by the rim's undeformed length or area."""

    def __init__(self, mesh: SolidMesh) -> None:
        facets = mesh.facets[mesh.facet_tags == FACETS["tip"]]
        ends = mesh.points[facets]
        if mesh.dimension == 2:
            # area of the cone between two radii
            weight = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) * (ends[:, 0, 0] + ends[:, 1, 0])
        else:
            weight = np.linalg.norm(np.cross(ends[:, 1] - ends[:, 0], ends[:, 2] - ends[:, 0]), axis=1)
        self._facets, self._weight = facets, weight / weight.sum()
        self._centre = mesh.tip_centre_node

    def mean_mm(self, state: State) -> float:
        """Mean over the rim."""
        return float(self._weight @ state.displacement_mm[self._facets, -1].mean(axis=1))

    def centre_mm(self, state: State) -> float:
        """At the axis."""
        return float(state.displacement_mm[self._centre, -1])


def masses_g(scene: Scene, meridian: SolidMesh) -> tuple[float, float]:
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
