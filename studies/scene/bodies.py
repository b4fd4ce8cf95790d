"""Scenes of simple bodies with exact answers, and of a user's mesh: the same files, told apart by geometry.kind.

============  =================================================  ==========================================
kind          load                                               what is known exactly
============  =================================================  ==========================================
tube          cavity pressure                                    the bore (ends plane-strain or capped)
sphere        cavity pressure                                    the bore, and the limit point if there is one
ring          pressure from outside, follower or dead            the bore while round, and where it buckles
block         the same dead tension on all faces                 the tension at which the cube gives way
cylinder      twist of one end at constant length                torque and axial force
cook          dead shear traction on the right edge              published or refined: the corner's displacement
ventricle     cavity pressure                                    published: position of the apex
mesh          cavity pressure                                    nothing
============  =================================================  ==========================================
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal, get_args

from pydantic import Field, model_validator

from meshes.errors import MeshError
from studies.scene.body_geometry import (
    BlockGeometry,
    CookGeometry,
    CylinderGeometry,
    Geometry,
    MeshGeometry,
    RingGeometry,
    SphereGeometry,
    TubeGeometry,
    VentricleGeometry,
)
from studies.scene.elements import Mesh, element_faults
from studies.scene.materials import AnyMaterial, describe_material, material_faults, small_load_faults
from studies.scene.sections import (
    APART,
    LARGEST_VOLUME,
    ONE_OR_MORE,
    Control,
    Fields,
    LargestVolume,
    Order,
    SceneName,
    Section,
    Tolerance,
    is_ascending,
    order_faults,
)
from studies.scene.users_mesh import mesh_faults

# Bores this many times smaller than the wall come out right within 0.1 % still (a capped tube of 2 mm); at 1e-300 the
# exact solution divides by zero.
MOST_RATIO = 1e9

Load_kPa = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Loads = Annotated[list[Load_kPa], Field(min_length=1), ONE_OR_MORE]
Quantity = Literal[
    "bore_mm",
    "limit_kpa",
    "crossing_kpa",
    "volume_mm3",
    "displacement_max_mm",
    "tip_mm",
    "tip_force_n",
    "reaction_n",
    "torque_nmm",
    "axial_force_n",
    "corner_mm",
    "apex_inside_mm",
    "apex_outside_mm",
]

# A limit point is looked for until the cavity is this many times its unloaded volume: inner stretches of 2 (sphere) and
# 2.8 (tube), where the laws of the reference actuators have long stiffened.
LIMIT_VOLUME = 8.0
LOAD_LISTS = ("pressure_kpa", "tension_kpa", "traction_kpa")


class BodyLoad(Section):
    """Load at which results are requested, kPa, ascending.

    ``kind``: ``cavity``, a pressure from inside; ``external``, one from outside, both following the surface; ``dead``,
    fixed in size per undeformed area and in direction: a pressure from outside on a ring, a tension on a block, a shear
    traction on Cook's membrane. A cylinder is twisted by so much per undeformed length, without pressure.

    The surface named tip of a user's mesh may be ``blocked``: held axially, its points free to slide as on a wall
    without friction, or, of a rigid tip, with all its motions. ``tip_force_n`` is a dead axial force on a free tip (on
    as much of it as is meshed), positive pulls it along z: on a rigid tip, or through a level plate without friction.
    """

    kind: Literal["cavity", "external", "dead"] | None = Field(
        default=None,
        description="from inside, from outside, or fixed in size and direction; by default what the body usually has",
    )
    pressure_kpa: Loads | None = Field(default=None, description="pressures, ascending")
    tension_kpa: Loads | None = Field(default=None, description="of a block: tensions on all faces, ascending")
    traction_kpa: Loads | None = Field(default=None, description="of Cook's membrane: shear tractions, ascending")
    twist_rad_per_mm: Annotated[float, Field(ge=-1.0, le=1.0)] | None = Field(
        default=None, description="of a cylinder: angle by which it is twisted, per undeformed length"
    )
    control: Control = "auto"
    order: Order = "auto"
    largest_volume: LargestVolume = LARGEST_VOLUME
    tip: Literal["free", "blocked"] = Field(default="free", description="of a mesh: its tip is free, or held axially")
    tip_force_n: Annotated[float, Field(allow_inf_nan=False)] = Field(
        default=0.0, description="of a mesh: dead axial force on a free tip, positive along z"
    )

    @model_validator(mode="after")
    def _ascending(self) -> BodyLoad:
        for name in LOAD_LISTS:
            values = getattr(self, name) or []
            if not is_ascending(values):
                raise ValueError(f"load.{name} = {values}: must ascend strictly, by more than {APART:g} of each")
        return self


class BodyAsk(Section):
    """What is wanted, how exactly, and whether fields are to be written."""

    quantities: Annotated[list[Quantity], Field(min_length=1)] | None = Field(
        default=None, description="what is wanted; by default what is known exactly of the body"
    )
    tolerance_percent: Tolerance = 1.0
    fields: Fields = False


KINDS = tuple(get_args(g.model_fields["kind"].annotation)[0] for g in get_args(Geometry))
# What may be requested of a kind, by default the first; and how it may be loaded, the first if unsaid.
QUANTITIES: dict[str, tuple[Quantity, ...]] = {
    "tube": ("bore_mm", "limit_kpa"),
    "sphere": ("bore_mm", "limit_kpa"),
    "ring": ("crossing_kpa", "bore_mm"),
    "block": ("crossing_kpa",),
    "cylinder": ("torque_nmm", "axial_force_n"),
    "cook": ("corner_mm",),
    "ventricle": ("apex_inside_mm", "apex_outside_mm"),
    "mesh": ("volume_mm3", "displacement_max_mm", "tip_mm", "tip_force_n", "reaction_n"),
}
LOADS = {
    "tube": ("cavity",),
    "sphere": ("cavity",),
    "ring": ("external", "dead"),
    "block": ("dead",),
    "cylinder": (),
    "cook": ("dead",),
    "ventricle": ("cavity",),
    "mesh": ("cavity",),
}


BodyMaterial = Annotated[AnyMaterial, Field(discriminator="law")]


class BodyScene(Section):
    """A whole scene.

    ``materials`` has a table for each physical volume of a user's mesh (surface of a meridian) that is not of
    ``material``: ``[materials.NAME]``.
    """

    name: SceneName
    geometry: Annotated[Geometry, Field(discriminator="kind")]
    mesh: Mesh = Mesh()
    material: BodyMaterial
    materials: dict[str, BodyMaterial] = {}
    load: BodyLoad
    ask: BodyAsk = BodyAsk()

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What is requested."""
        usual = QUANTITIES[self.geometry.kind]
        return tuple(self.ask.quantities or (usual if self.geometry.kind in ("cylinder", "ventricle") else usual[:1]))

    @property
    def load_kind(self) -> str:
        """How it is loaded."""
        return self.load.kind or next(iter(LOADS[self.geometry.kind]), "twist")

    @property
    def loads_kpa(self) -> tuple[float, ...]:
        """Requested pressures, tensions or tractions, kPa; 0 where a twist takes their place."""
        if self.geometry.kind == "cylinder":
            return (0.0,)
        return tuple(self.load.pressure_kpa or self.load.tension_kpa or self.load.traction_kpa or ())

    @property
    def title(self) -> str:
        """One line for headings."""
        others = "".join(f"; {name}: {describe_material(of)}" for name, of in self.materials.items())
        return f"{_body(self)}, {describe_material(self.material)}{others}"


def _body(scene: BodyScene) -> str:
    g = scene.geometry
    if isinstance(g, BlockGeometry):
        return f"cube of {g.edge_mm:g} mm under dead tension"
    if isinstance(g, MeshGeometry):
        return f"mesh {Path(g.file).name}"
    if isinstance(g, CylinderGeometry):
        return f"cylinder of radius {g.radius_mm:g} mm twisted by {scene.load.twist_rad_per_mm:g} rad/mm"
    if isinstance(g, CookGeometry):
        return "Cook's membrane in plane strain"
    if isinstance(g, VentricleGeometry):
        inner, outer = (g.inner_across_mm, g.inner_along_mm), (g.outer_across_mm, g.outer_along_mm)
        return f"ventricle, semi-axes {inner[0]:g}, {inner[1]:g} / {outer[0]:g}, {outer[1]:g} mm"
    radii = f"{g.inner_radius_mm:g} / {g.outer_radius_mm:g} mm"
    if isinstance(g, TubeGeometry):
        return f"tube {radii}, {g.length_mm:g} mm long, {g.ends} ends"
    if isinstance(g, SphereGeometry):
        return f"sphere {radii}"
    how = "follower" if scene.load_kind == "external" else "dead"
    return f"ring {radii} under {how} pressure from outside, {g.waves} waves"


def body_faults(scene: BodyScene) -> list[str]:
    """What the types cannot see, a line per fault."""
    g, load, faults = scene.geometry, scene.load, []
    if isinstance(g, TubeGeometry | SphereGeometry | RingGeometry) and g.inner_radius_mm >= g.outer_radius_mm:
        faults.append(
            f"geometry.inner_radius_mm = {g.inner_radius_mm:g}: must be less than outer_radius_mm = "
            f"{g.outer_radius_mm:g}"
        )
    if isinstance(g, TubeGeometry | SphereGeometry) and g.outer_radius_mm > MOST_RATIO * g.inner_radius_mm:
        faults.append(
            f"geometry.inner_radius_mm = {g.inner_radius_mm:g}: must be at least {g.outer_radius_mm / MOST_RATIO:g}, "
            f"outer_radius_mm / {MOST_RATIO:g}: of a smaller bore round-off is all that is left"
        )
    if load.kind is not None and load.kind not in LOADS[g.kind]:
        faults.append(f"load.kind = {load.kind!r}: allowed for a {g.kind}: {_listed(LOADS[g.kind])}")
    if g.kind == "ring" and load.kind is None:
        faults.append(f"load.kind: missing; allowed for a ring: {_listed(LOADS['ring'])}")
    if isinstance(g, VentricleGeometry):
        faults += _ventricle_faults(g)
    right = {"block": "tension_kpa", "cook": "traction_kpa", "cylinder": "twist_rad_per_mm"}.get(g.kind, "pressure_kpa")
    for wrong in (*LOAD_LISTS, "twist_rad_per_mm"):
        if wrong != right and getattr(load, wrong) is not None:
            faults.append(f"load.{wrong} = {getattr(load, wrong)}: a {g.kind} is loaded by load.{right}")
    if getattr(load, right) is None:
        faults.append(f"load.{right}: missing, and has no default")
    for quantity in scene.quantities:
        if quantity not in QUANTITIES[g.kind]:
            faults.append(f"ask.quantities = {quantity!r}: allowed for a {g.kind}: {_listed(QUANTITIES[g.kind])}")
    if g.kind in ("ring", "block", "cook") and scene.mesh.element.startswith("tet"):
        faults.append(f'mesh.element = "{scene.mesh.element}": a {g.kind} is meshed in hexahedra: "hex" or "auto"')
    if g.kind == "mesh" and scene.mesh.element != "auto":
        faults.append(f'mesh.element = "{scene.mesh.element}": a user\'s mesh has the cells it has: "auto"')
    if scene.mesh.solver == "iterative":
        faults.append(f'mesh.solver = "iterative": a {g.kind} is small and factorised: "direct" or "auto"')
    faults += element_faults(scene.mesh, scene.material.kappa_over_mu)
    if isinstance(g, MeshGeometry):
        try:
            faults += mesh_faults(g, load.tip, load.tip_force_n, scene.quantities, list(scene.materials))
        except MeshError as error:
            faults.append(f"geometry.file: {error}")
    else:
        faults += [f"materials.{name}: a {g.kind} is of one material: leave the table out" for name in scene.materials]
        if load.tip != "free" or load.tip_force_n:
            given = f"load.tip_force_n = {load.tip_force_n:g}" if load.tip_force_n else f"load.tip = {load.tip!r}"
            faults.append(f"{given}: of a bellows or a user's mesh: leave the key out")
    highest = scene.loads_kpa[-1] if scene.loads_kpa else 0.0
    faults += order_faults(load.order, load.tip_force_n)
    faults += small_load_faults(scene.material, scene.loads_kpa, f"load.{right}")
    return faults + _material_faults(scene, highest, f"load.{right}")


def _material_faults(scene: BodyScene, highest_kpa: float, key: str) -> list[str]:
    """What is wrong with the laws; a load is too high if it is for each of them."""
    every = {"material": scene.material, **{f"materials.{name}": of for name, of in scene.materials.items()}}
    found = {name: material_faults(material, highest_kpa, key) for name, material in every.items()}
    own = [(name, fault) for name, faults in found.items() for fault in faults]
    loads = [fault for _, fault in own if not fault.startswith("material")]
    laws = [f"{name}{fault.removeprefix('material')}" for name, fault in own if fault.startswith("material")]
    return laws + (loads[:1] if len(loads) == len(found) else [])


def _ventricle_faults(g: VentricleGeometry) -> list[str]:
    faults = []
    for which in ("across", "along"):
        inner, outer = getattr(g, f"inner_{which}_mm"), getattr(g, f"outer_{which}_mm")
        if inner >= outer:
            faults.append(f"geometry.inner_{which}_mm = {inner:g}: must be less than outer_{which}_mm = {outer:g}")
    if g.base_mm >= g.inner_along_mm:
        faults.append(f"geometry.base_mm = {g.base_mm:g}: must be less than inner_along_mm = {g.inner_along_mm:g}")
    return faults


def _listed(names: Sequence[str]) -> str:
    return ", ".join(repr(name) for name in names)
