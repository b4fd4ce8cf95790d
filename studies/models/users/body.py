"""A user's mesh as a boundary value problem: supports, rigid surfaces and the tip; what is read off its states."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from meshes.by_gmsh.user_mesh import read_user_mesh
from meshes.quality import region_volumes_mm3
from meshes.solid import FACETS, FloatArray, IntArray, SolidMesh
from meshes.surface import surface_weights
from meshes.users.refine import refined
from meshes.users.rigid import Rim, body_weights, held_by_symmetry, rim_on
from solvers.assembly.surfaces import Surfaces
from solvers.bodies.rigid import AXIAL, EVERY_MOTION, RigidBodies
from solvers.state import State
from studies.scene.bodies import BodyScene
from studies.scene.body_geometry import MeshGeometry
from studies.scene.materials import law_of
from studies.scene.users_mesh import has_surface

# Stiffness of the layer between the mesh and a rigid body, as a multiple of shear modulus over wall: points slip by so
# much less than the wall is deformed by.
RIGID_TIMES = 1e5

Rigid = tuple[RigidBodies, IntArray]


def users_body(scene: BodyScene, g: MeshGeometry, fine: int) -> tuple[SolidMesh, Surfaces, Rigid | None]:
    """The mesh of a scene with its edges divided by ``fine``, a power of two, its supports and its load.

    Returns
    -------
    tuple
        The last: rigid bodies, and the body that each facet is bonded to, -1 for none; None without any.
    """
    mesh = read_user_mesh(Path(g.file), g.scale)
    for _ in range(fine.bit_length() - 1):
        mesh = refined(mesh)
    axial = mesh.dimension - 1
    planes = {"axis": 0, "bottom": axial, "top": axial, "symmetry_z": axial}
    if mesh.dimension == 3:
        planes = {"symmetry_x": 0, "symmetry_y": 1, "bottom": 2, "top": 2, "symmetry_z": 2}
    held = tuple((FACETS[name], i) for name, i in planes.items() if has_surface(mesh.facet_tags, name))
    rigid = _rigid_surfaces(scene, g, mesh)
    surfaces = Surfaces(
        cavity=FACETS["cavity"],
        clamped=FACETS["clamped"] if has_surface(mesh.facet_tags, "clamped") else None,
        held=held,
        bond=None if rigid is None else FACETS["bond"],
        blocked=FACETS["tip"] if scene.load.tip == "blocked" and g.tip == "elastic" else None,
    )
    return mesh, surfaces, rigid


def _rigid_surfaces(scene: BodyScene, g: MeshGeometry, mesh: SolidMesh) -> Rigid | None:
    """Surfaces named so, then a rigid tip, or the level plate that loads an elastic one."""
    of_facet, count = mesh.facet_bodies, len(mesh.rigid)
    level = g.tip == "elastic" and scene.load.tip_force_n != 0.0
    plate = count if g.tip == "rigid" or level else None
    on_tip = mesh.facet_tags == FACETS["tip"]
    if plate is not None:
        of_facet, count = np.where(on_tip, plate, of_facet), count + 1
    if not count:
        return None
    bodies = dataclasses.replace(mesh, facet_bodies=of_facet)
    corners = [mesh.points[np.unique(mesh.facets[of_facet == body])] for body in range(count)]
    held = None
    if mesh.dimension == 3 and not level:
        held = np.stack([held_by_symmetry(bodies, body) for body in range(count)])
    rim = rim_on(mesh, mesh.facets[on_tip]) if plate is not None else Rim(0, 0.0)
    moduli = [law_of(of).initial_shear_modulus_mpa for of in (scene.material, *scene.materials.values())]
    wall_mm = sum(region_volumes_mm3(mesh).values()) / surface_weights(mesh, "cavity").sum()
    stiffness = RIGID_TIMES * max(moduli) / wall_mm
    return RigidBodies(
        stiffness,
        0.0 if level else stiffness,
        np.ones(len(mesh.points)),
        np.array([float(at[:, -1].mean()) for at in corners]),
        _arm_mm(mesh),
        motions=AXIAL if level and mesh.dimension == 3 else EVERY_MOTION,
        plate=plate,
        plate_area_mm2=rim.area_mm2,
        plate_held=plate is not None and scene.load.tip == "blocked",
        plate_force_n=scene.load.tip_force_n,
        plate_closes=rim.edges > 0,
        held=held,
    ), of_facet


def _arm_mm(mesh: SolidMesh) -> float:
    """Length that turns rotations of rigid bodies into displacements."""
    return 0.5 * float(np.ptp(mesh.points, axis=0).max())


def users_measures(mesh: SolidMesh) -> dict[str, Callable[[State], float]]:
    """What is read off a state, by quantity: the largest displacement, means over the tip and over rigid surfaces."""
    out: dict[str, Callable[[State], float]] = {"displacement_max_mm": _largest}
    if has_surface(mesh.facet_tags, "tip"):
        out["tip_mm"] = partial(_mean, surface_weights(mesh, "tip"), -1)
    for body, name in enumerate(mesh.rigid):
        weights = body_weights(mesh, body)
        out[f"{name}_mm"] = partial(_mean, weights, -1)
        if mesh.dimension == 3:
            out |= {f"{name}_{axis}_mm": partial(_mean, weights, i) for i, axis in enumerate("xy")}
            out[f"{name}_turn_deg"] = partial(_turn_deg, _arm_mm(mesh), body)
    return out


def _mean(weights: FloatArray, component: int, state: State) -> float:
    """Mean of a displacement over a surface, mm."""
    return float(weights @ state.displacement_mm[:, component] / weights.sum())


def _turn_deg(arm_mm: float, body: int, state: State) -> float:
    """Angle by which a rigid body has turned, degrees."""
    return math.degrees(float(np.linalg.norm(state.bodies_mm[body, 3:])) / arm_mm)


def _largest(state: State) -> float:
    return float(np.linalg.norm(state.displacement_mm, axis=1).max())
