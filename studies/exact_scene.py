"""Scenes of simple bodies with exact answers, and of a user's mesh: the same files, told apart by geometry.kind.

============  =================================================  ==========================================
kind          load                                               what is known exactly
============  =================================================  ==========================================
tube          cavity pressure                                    the bore (ends plane-strain or capped)
sphere        cavity pressure                                    the bore, and the limit point if there is one
ring          pressure from outside, follower or dead            the bore while round, and where it buckles
block         the same dead tension on all faces                 the tension at which the cube gives way
mesh          cavity pressure                                    nothing
============  =================================================  ==========================================
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

from pydantic import Field, model_validator

from meshes.errors import MeshError
from meshes.solid import FACETS
from meshes.user_mesh import read_user_mesh
from studies.scene import (
    Mesh,
    NeoHookeMaterial,
    OgdenMaterial,
    Scene,
    YeohMaterial,
    describe_material,
    element_faults,
    load_scene,
    material_faults,
)
from studies.sections import Length, SceneError, Section, read_toml, validated

Load_kPa = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Quantity = Literal["bore_mm", "limit_kpa", "crossing_kpa", "volume_mm3", "displacement_max_mm", "tip_mm"]


class TubeGeometry(Section):
    """A tube; ``plane-strain`` keeps its length, ``bonded`` also the radius at its ends, ``capped`` closes one."""

    kind: Literal["tube"]
    inner_radius_mm: Length
    outer_radius_mm: Length
    length_mm: Length
    ends: Literal["plane-strain", "bonded", "capped"] = "plane-strain"


class SphereGeometry(Section):
    """A hollow sphere; its upper half is meshed."""

    kind: Literal["sphere"]
    inner_radius_mm: Length
    outer_radius_mm: Length


class RingGeometry(Section):
    """A ring in plane strain; the sector of half a wave is meshed, which admits ``waves``, twice as many, and so on."""

    kind: Literal["ring"]
    inner_radius_mm: Length
    outer_radius_mm: Length
    waves: Literal[2, 3]


class BlockGeometry(Section):
    """A cube."""

    kind: Literal["block"]
    edge_mm: Length = 10.0


class MeshGeometry(Section):
    """A user's gmsh file beside the scene; ``scale`` makes its lengths mm (1000 for metres)."""

    kind: Literal["mesh"]
    file: Annotated[str, Field(min_length=1)]
    scale: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] = 1.0


class ExactLoad(Section):
    """Load at which results are asked, kPa, ascending.

    ``kind``: ``cavity``, a pressure from inside; ``external``, one from outside, both following the surface; ``dead``,
    fixed in size per undeformed area and in direction: a pressure from outside on a ring, a tension on a block.
    """

    kind: Literal["cavity", "external", "dead"] | None = None
    pressure_kpa: Annotated[list[Load_kPa], Field(min_length=1)] | None = None
    tension_kpa: Annotated[list[Load_kPa], Field(min_length=1)] | None = None
    control: Literal["auto", "pressure", "volume", "arc"] = "auto"

    @model_validator(mode="after")
    def _ascending(self) -> ExactLoad:
        for name in ("pressure_kpa", "tension_kpa"):
            values = getattr(self, name) or []
            if any(b <= a for a, b in zip(values[:-1], values[1:], strict=True)):
                raise ValueError(f"load.{name} = {values}: must ascend strictly")
        return self


class ExactAsk(Section):
    """What is wanted, how exactly, and whether fields are to be written."""

    quantities: Annotated[list[Quantity], Field(min_length=1)] | None = None
    tolerance_percent: Annotated[float, Field(gt=0.0, le=100.0)] = 1.0
    fields: bool = False


Geometry = TubeGeometry | SphereGeometry | RingGeometry | BlockGeometry | MeshGeometry
KINDS = tuple(get_args(g.model_fields["kind"].annotation)[0] for g in get_args(Geometry))
# What may be asked of a kind, the first unless something else is asked; and how it may be loaded, the first if unsaid.
QUANTITIES: dict[str, tuple[Quantity, ...]] = {
    "tube": ("bore_mm", "limit_kpa"),
    "sphere": ("bore_mm", "limit_kpa"),
    "ring": ("crossing_kpa", "bore_mm"),
    "block": ("crossing_kpa",),
    "mesh": ("volume_mm3", "displacement_max_mm", "tip_mm"),
}
LOADS = {
    "tube": ("cavity",),
    "sphere": ("cavity",),
    "ring": ("external", "dead"),
    "block": ("dead",),
    "mesh": ("cavity",),
}


class ExactScene(Section):
    """A whole scene."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,79}$")]
    geometry: Annotated[Geometry, Field(discriminator="kind")]
    mesh: Mesh = Mesh()
    material: Annotated[YeohMaterial | OgdenMaterial | NeoHookeMaterial, Field(discriminator="law")]
    load: ExactLoad
    ask: ExactAsk = ExactAsk()

    @property
    def quantities(self) -> tuple[Quantity, ...]:
        """What is asked."""
        return tuple(self.ask.quantities or QUANTITIES[self.geometry.kind][:1])

    @property
    def load_kind(self) -> str:
        """How it is loaded."""
        return self.load.kind or LOADS[self.geometry.kind][0]

    @property
    def loads_kpa(self) -> tuple[float, ...]:
        """Asked pressures or tensions, kPa."""
        return tuple(self.load.pressure_kpa or self.load.tension_kpa or ())

    @property
    def title(self) -> str:
        """One line for headings."""
        return f"{_body(self)}, {describe_material(self.material)}"


AnyScene = Scene | ExactScene


def load_any_scene(path: Path) -> AnyScene:
    """Read and check a scene of any kind.

    Raises
    ------
    SceneError
        With one line per fault; nothing has been solved or written.
    """
    data = read_toml(path)
    kind = _kind(data)
    if kind == "bellows" or kind is None:  # a missing kind is told as the missing key it is
        return load_scene(path)
    if kind not in KINDS:
        allowed = ", ".join(repr(name) for name in ("bellows", *KINDS))
        raise SceneError(f"{path}: geometry.kind = {kind!r}: allowed: {allowed}")
    return validated(ExactScene, _with_place(data, path), path, _faults)


def is_exact(path: Path) -> bool:
    """True if a scene file is of one of the kinds of this module."""
    return _kind(read_toml(path)) in KINDS


def _kind(data: dict[str, Any]) -> Any:
    geometry = data.get("geometry")
    return geometry.get("kind") if isinstance(geometry, dict) else None


def _with_place(data: dict[str, Any], path: Path) -> dict[str, Any]:
    """The contents with the file of a user's mesh found from where the scene is."""
    geometry = data["geometry"]
    if not isinstance(geometry.get("file"), str):
        return data
    return {**data, "geometry": {**geometry, "file": str(path.resolve().parent / geometry["file"])}}


def _body(scene: ExactScene) -> str:
    g = scene.geometry
    if isinstance(g, BlockGeometry):
        return f"cube of {g.edge_mm:g} mm under dead tension"
    if isinstance(g, MeshGeometry):
        return f"mesh {Path(g.file).name}"
    radii = f"{g.inner_radius_mm:g} / {g.outer_radius_mm:g} mm"
    if isinstance(g, TubeGeometry):
        return f"tube {radii}, {g.length_mm:g} mm long, {g.ends} ends"
    if isinstance(g, SphereGeometry):
        return f"sphere {radii}"
    how = "follower" if scene.load_kind == "external" else "dead"
    return f"ring {radii} under {how} pressure from outside, {g.waves} waves"


def _faults(scene: ExactScene) -> list[str]:
    """What the types cannot see."""
    g, load, faults = scene.geometry, scene.load, []
    if not isinstance(g, BlockGeometry | MeshGeometry) and g.inner_radius_mm >= g.outer_radius_mm:
        faults.append(
            f"geometry.inner_radius_mm = {g.inner_radius_mm:g}: must be less than outer_radius_mm = "
            f"{g.outer_radius_mm:g}"
        )
    if load.kind is not None and load.kind not in LOADS[g.kind]:
        faults.append(f"load.kind = {load.kind!r}: allowed for a {g.kind}: {_listed(LOADS[g.kind])}")
    if g.kind == "ring" and load.kind is None:
        faults.append(f"load.kind: missing; allowed for a ring: {_listed(LOADS['ring'])}")
    right, wrong = ("tension_kpa", "pressure_kpa") if g.kind == "block" else ("pressure_kpa", "tension_kpa")
    if getattr(load, wrong) is not None:
        faults.append(f"load.{wrong} = {getattr(load, wrong)}: a {g.kind} is loaded by load.{right}")
    if getattr(load, right) is None:
        faults.append(f"load.{right}: missing, and has no default")
    for quantity in scene.quantities:
        if quantity not in QUANTITIES[g.kind]:
            faults.append(f"ask.quantities = {quantity!r}: allowed for a {g.kind}: {_listed(QUANTITIES[g.kind])}")
    if g.kind in ("ring", "block") and scene.mesh.element.startswith("tet"):
        faults.append(f'mesh.element = "{scene.mesh.element}": a {g.kind} is meshed in hexahedra: "hex" or "auto"')
    if g.kind == "mesh" and scene.mesh.element != "auto":
        faults.append(f'mesh.element = "{scene.mesh.element}": a user\'s mesh has the cells it has: "auto"')
    faults += element_faults(scene.mesh, scene.material.kappa_over_mu)
    if isinstance(g, MeshGeometry):
        try:
            mesh = read_user_mesh(Path(g.file), g.scale)
            if "tip_mm" in scene.quantities and not has_surface(mesh.facet_tags, "tip"):
                faults.append("ask.quantities = 'tip_mm': no surface of the mesh is named 'tip'")
            faults += _free_motions(mesh.facet_tags, mesh.dimension)
        except MeshError as error:
            faults.append(f"geometry.file: {error}")
    highest = scene.loads_kpa[-1] if scene.loads_kpa else 0.0
    return faults + material_faults(scene.material, highest, f"load.{right}")


def has_surface(tags: Any, name: str) -> bool:
    """True if a mesh's facets have a name."""
    return bool((tags == FACETS[name]).any())


def _free_motions(tags: Any, dimension: int) -> list[str]:
    """Directions in which nothing holds a user's mesh."""
    if has_surface(tags, "clamped"):
        return []
    along: dict[str, tuple[str, ...]] = {"z": ("symmetry_z", "bottom", "top")}
    if dimension == 3:
        along = {"x": ("symmetry_x",), "y": ("symmetry_y",), **along}
    free = [axis for axis, names in along.items() if not any(has_surface(tags, name) for name in names)]
    if not free:
        return []
    needed = "; ".join(f"along {axis}: {' or '.join(along[axis])}" for axis in free)
    return [f"geometry.file: nothing holds the body: name a surface 'clamped', or planes that keep it ({needed})"]


def _listed(names: Sequence[str]) -> str:
    return ", ".join(repr(name) for name in names)
