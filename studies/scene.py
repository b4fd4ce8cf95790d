"""The scene: what an actuator is and what is asked of it, from a TOML file, checked before anything runs.

Every key carries its unit. Errors are collected and each names the key, its value and what is allowed.
"""

from __future__ import annotations

import difflib
import math
import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from analytical.bellows import BellowsDimensions
from analytical.materials import (
    PLA,
    POLYETHYLENE,
    Law,
    MaterialError,
    NeoHooke,
    Ogden,
    StiffSolid,
    Yeoh,
    check_stability,
)
from meshes.bellows import BellowsShape, check_shape
from meshes.errors import GeometryError
from meshes.ring import RingShape

# Stretches up to this must be stable for a law to be accepted; the reference actuators stay below it to 20 kPa.
STABLE_STRETCH = 4.0
# A bond meant as rigid is a layer this stiff, MPa/mm: its slip under 20 kPa is below 0.01 mm.
RIGID_BOND_MPA_PER_MM = 300.0

Length = Annotated[float, Field(gt=0.0, le=1000.0, allow_inf_nan=False)]
Stiffness = Annotated[float, Field(gt=0.0, le=1e4, allow_inf_nan=False)]
Modulus = Annotated[float, Field(gt=0.0, le=1e5, allow_inf_nan=False)]


class SceneError(ValueError):
    """A scene that cannot be run; one line per fault."""


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=False)


class Geometry(_Section):
    """The bellows, mm; radii are cavity-side, the wall is measured normal to itself."""

    kind: Literal["bellows"]
    profile: Literal["arcs"] = "arcs"
    root_radius_mm: Length
    crest_radius_mm: Length
    wall_mm: Length
    half_pitch_mm: Length
    convolutions: Annotated[int, Field(ge=1, le=100)]
    collar_mm: Length = 3.0
    fillet_mm: Annotated[float, Field(ge=0.1, le=100.0)] = 0.5
    tip: Literal["cap", "rigid"] = "cap"  # rigid: a plate bonded to the open end; cap_mm has no meaning then
    cap_mm: Length = 5.0


class Rings(_Section):
    """Rings on the crests' seats and how they are bonded."""

    model: Literal["rigid", "meshed", "none"] = "rigid"
    material: Literal["pla", "polyethylene"] = "pla"
    seat_mm: Length = 4.0
    bond: Literal["adhesive", "rigid"] = "adhesive"
    bond_normal_mpa_per_mm: Stiffness = 5.0
    bond_tangential_mpa_per_mm: Stiffness = 2.0
    bond_grading_mm: Annotated[float, Field(ge=0.0, le=100.0)] = 1.0
    height_mm: Length = 2.0
    edge_radius_mm: Annotated[float, Field(ge=0.0, le=100.0)] = 0.5


class Mesh(_Section):
    """Kind of cells: hexahedra (quadrilaterals on the meridian), or tetrahedra (triangles) as in the paper.

    ``auto`` takes hexahedra unless the rings are meshed.
    """

    element: Literal["auto", "hex", "tet"] = "auto"


class YeohMaterial(_Section):
    """W = sum C_i (I1 - 3)^i; initial shear modulus 2 C1."""

    law: Literal["yeoh"]
    c_kpa: Annotated[list[float], Field(min_length=1, max_length=3)]
    kappa_over_mu: Annotated[float, Field(gt=10.0)] = math.inf


class OgdenMaterial(_Section):
    """One Ogden term; the convention says what mu is (initial shear modulus mu, or mu alpha / 2)."""

    law: Literal["ogden"]
    mu_kpa: Modulus
    alpha: Annotated[float, Field(ge=-20.0, le=20.0)]
    convention: Literal["2mu/alpha^2", "mu/alpha"]
    kappa_over_mu: Annotated[float, Field(gt=10.0)] = math.inf


class NeoHookeMaterial(_Section):
    """W = mu/2 (I1 - 3); initial shear modulus mu."""

    law: Literal["neo-hooke"]
    mu_kpa: Modulus
    kappa_over_mu: Annotated[float, Field(gt=10.0)] = math.inf


class Load(_Section):
    """Cavity pressures at which results are asked, kPa, ascending, and what the steps between are taken in."""

    pressure_kpa: Annotated[list[Annotated[float, Field(gt=0.0, allow_inf_nan=False)]], Field(min_length=1)]
    control: Literal["auto", "pressure", "volume"] = "auto"

    @model_validator(mode="after")
    def _ascending(self) -> Load:
        if any(b <= a for a, b in zip(self.pressure_kpa[:-1], self.pressure_kpa[1:], strict=True)):
            raise ValueError(f"load.pressure_kpa = {self.pressure_kpa}: must ascend strictly")
        return self


class Ask(_Section):
    """What is wanted, how exactly, and whether fields are to be written."""

    quantities: list[Literal["tip_mm"]] = ["tip_mm"]
    tolerance_percent: Annotated[float, Field(gt=0.0, le=100.0)] = 1.0
    fields: bool = False


class Scene(_Section):
    """A whole scene."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,79}$")]
    geometry: Geometry
    rings: Rings = Rings()
    mesh: Mesh = Mesh()
    material: Annotated[YeohMaterial | OgdenMaterial | NeoHookeMaterial, Field(discriminator="law")]
    load: Load
    ask: Ask = Ask()

    @property
    def pressures_mpa(self) -> tuple[float, ...]:
        """Asked pressures, MPa."""
        return tuple(1e-3 * p for p in self.load.pressure_kpa)

    @property
    def title(self) -> str:
        """One line for headings."""
        g = self.geometry
        return f"t = {g.wall_mm:g} mm, R_i = {g.root_radius_mm:g} mm, {describe_material(self.material)}"


def describe_material(material: YeohMaterial | OgdenMaterial | NeoHookeMaterial) -> str:
    """The law, its numbers and the initial shear modulus."""
    mu = f"initial shear modulus {1e3 * law_of(material).initial_shear_modulus_mpa:.4g} kPa"
    if isinstance(material, YeohMaterial):
        return f"Yeoh C = {', '.join(f'{c:g}' for c in material.c_kpa)} kPa ({mu})"
    if isinstance(material, OgdenMaterial):
        return f"Ogden mu = {material.mu_kpa:g} kPa, alpha = {material.alpha:g}, {material.convention} ({mu})"
    return f"neo-Hooke ({mu})"


def law_of(material: YeohMaterial | OgdenMaterial | NeoHookeMaterial) -> Law:
    """The material law in MPa."""
    if isinstance(material, YeohMaterial):
        return Yeoh(tuple(1e-3 * c for c in material.c_kpa))
    if isinstance(material, OgdenMaterial):
        return Ogden(1e-3 * material.mu_kpa, material.alpha, material.convention)
    return NeoHooke(1e-3 * material.mu_kpa)


def inverse_kappa(material: YeohMaterial | OgdenMaterial | NeoHookeMaterial) -> float:
    """1/kappa in 1/MPa; 0 when incompressible."""
    return 1.0 / (material.kappa_over_mu * law_of(material).initial_shear_modulus_mpa)


def shape_of(scene: Scene) -> BellowsShape:
    """The outline's dimensions; without rings there are no seats."""
    g = scene.geometry
    return BellowsShape(
        root_radius_mm=g.root_radius_mm,
        crest_radius_mm=g.crest_radius_mm,
        wall_mm=g.wall_mm,
        half_pitch_mm=g.half_pitch_mm,
        convolutions=g.convolutions,
        collar_mm=g.collar_mm,
        seat_mm=0.0 if scene.rings.model == "none" else scene.rings.seat_mm,
        fillet_mm=g.fillet_mm,
        cap_mm=g.cap_mm if g.tip == "cap" else 0.0,
    )


def dimensions_of(scene: Scene) -> BellowsDimensions:
    """The dimensions of the closed form."""
    g = scene.geometry
    return BellowsDimensions(g.root_radius_mm, g.crest_radius_mm, g.wall_mm, g.half_pitch_mm, g.convolutions)


def in_hexahedra(scene: Scene) -> bool:
    """True for quadrilaterals and hexahedra, False for triangles and tetrahedra."""
    return scene.mesh.element == "hex" or (scene.mesh.element == "auto" and scene.rings.model != "meshed")


def ring_material(scene: Scene) -> StiffSolid:
    """The rings' material."""
    return PLA if scene.rings.material == "pla" else POLYETHYLENE


def ring_shape(scene: Scene) -> RingShape:
    """The rings' section."""
    return RingShape(scene.rings.height_mm, scene.rings.edge_radius_mm)


def bond_grade(scene: Scene, axial_mm: np.ndarray) -> np.ndarray:
    """Stiffness of the bond relative to its middle, at axial positions: smooth to zero at the seat's edges."""
    rings = scene.rings
    if rings.bond == "rigid" or rings.bond_grading_mm == 0.0:
        return np.ones_like(axial_mm)
    grade = np.zeros_like(axial_mm)
    for centre in shape_of(scene).crest_positions_mm:
        inside = (0.5 * rings.seat_mm - np.abs(axial_mm - centre)) / rings.bond_grading_mm
        s = np.clip(inside, 0.0, 1.0)
        grade = np.maximum(grade, s * s * (3.0 - 2.0 * s))
    return grade


def bond_stiffness(scene: Scene) -> tuple[float, float]:
    """Normal and tangential stiffness of the bond, MPa/mm."""
    if scene.rings.bond == "rigid":
        return RIGID_BOND_MPA_PER_MM, RIGID_BOND_MPA_PER_MM
    return scene.rings.bond_normal_mpa_per_mm, scene.rings.bond_tangential_mpa_per_mm


def load_scene(path: Path) -> Scene:
    """Read and check a scene.

    Raises
    ------
    SceneError
        With one line per fault; nothing has been meshed, solved or written.
    """
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror}); give the path of a scene file") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise SceneError(f"{path}: not a TOML file: {error}") from None
    try:
        scene = Scene.model_validate(data)
    except ValidationError as error:
        raise SceneError("\n".join(f"{path}: {line}" for line in _explain(error))) from None
    faults = _faults(scene)
    if faults:
        raise SceneError("\n".join(f"{path}: {line}" for line in faults))
    return scene


def _faults(scene: Scene) -> list[str]:
    """What the types cannot see: geometry, material stability, units."""
    faults = []
    try:
        check_shape(shape_of(scene))
    except GeometryError as error:
        faults.append(f"geometry: {error}")
    rings = scene.rings
    if rings.model == "meshed" and rings.edge_radius_mm >= min(rings.height_mm, 0.5 * rings.seat_mm):
        faults.append(
            f"rings.edge_radius_mm = {rings.edge_radius_mm:g}: must be less than height_mm = {rings.height_mm:g} "
            f"and half of seat_mm = {rings.seat_mm:g}"
        )
    if rings.model == "meshed" and scene.mesh.element == "hex":
        faults.append('mesh.element = "hex": meshed rings need "tet" (or "auto"), or rings.model = "rigid"')
    if rings.bond_grading_mm > 0.5 * rings.seat_mm:
        faults.append(
            f"rings.bond_grading_mm = {rings.bond_grading_mm:g}: must be at most half of seat_mm = {rings.seat_mm:g}"
        )
    try:
        law = law_of(scene.material)
        check_stability(law, STABLE_STRETCH)
        modulus = 1e3 * law.initial_shear_modulus_mpa
        highest = scene.load.pressure_kpa[-1]
        if highest > 10.0 * modulus:
            faults.append(
                f"load.pressure_kpa reaches {highest:g}: more than 10 times the initial shear modulus, "
                f"{modulus:g} kPa; check the units (kPa)"
            )
    except MaterialError as error:
        faults.append(f"material: {error}")
    return faults


def _explain(error: ValidationError) -> list[str]:
    """Pydantic's findings as lines with key, value and what is allowed."""
    lines = []
    for fault in error.errors():
        where = [str(part) for part in fault["loc"] if part not in ("yeoh", "ogden", "neo-hooke")]
        key, value = ".".join(where), fault.get("input")
        kind, context = fault["type"], fault.get("ctx", {})
        if kind == "extra_forbidden":
            allowed = _allowed_keys(fault["loc"])
            near = difflib.get_close_matches(where[-1], allowed, n=1, cutoff=0.5)
            hint = f"did you mean {near[0]}? " if near else ""
            lines.append(f"{key} = {value!r}: unknown key; {hint}allowed: {', '.join(allowed)}")
        elif kind == "missing":
            lines.append(f"{key}: missing, and has no default")
        elif kind == "union_tag_not_found":
            lines.append(f"{key}.law: missing; allowed: {context.get('discriminator', '')} in yeoh, ogden, neo-hooke")
        elif kind in ("literal_error", "union_tag_invalid"):
            allowed_values = context.get("expected") or context.get("expected_tags")
            shown = value.get("law") if isinstance(value, dict) else value
            name = f"{key}.law" if kind == "union_tag_invalid" else key
            lines.append(f"{name} = {shown!r}: allowed: {allowed_values}")
        else:
            text = fault["msg"].removeprefix("Value error, ").replace("Input should be", "must be")
            unit = next((u for u in ("mm", "kpa") if key.endswith("_" + u)), "").replace("kpa", "kPa")
            text = f"{text} {unit}".rstrip() if kind in ("greater_than", "less_than_equal") else text
            lines.append(text if kind == "value_error" and "=" in text else f"{key} = {value!r}: {text}")
    return lines


def _allowed_keys(location: tuple[Any, ...]) -> list[str]:
    sections: dict[str, type[_Section]] = {
        "geometry": Geometry,
        "rings": Rings,
        "mesh": Mesh,
        "load": Load,
        "ask": Ask,
    }
    materials: dict[str, type[_Section]] = {"yeoh": YeohMaterial, "ogden": OgdenMaterial, "neo-hooke": NeoHookeMaterial}
    if len(location) == 1:
        return list(Scene.model_fields)
    if location[0] == "material":
        return list(materials[str(location[1])].model_fields)
    return list(sections[str(location[0])].model_fields)
