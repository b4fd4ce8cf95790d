"""A scene of a bellows: what an actuator is and what is requested of it. Every key carries its unit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from analytical.bellows.dimensions import BellowsDimensions
from analytical.laws.stiff import PLA, POLYETHYLENE, StiffSolid
from meshes.bellows import check_shape
from meshes.by_gmsh.ring import RingShape
from meshes.errors import GeometryError
from meshes.shape import BellowsShape
from studies.scene.bellows_geometry import ZIGZAG_SEAT_MM, Geometry
from studies.scene.compare import PRESSURE, Compare, pressures_with
from studies.scene.elements import BellowsMesh, element_faults
from studies.scene.materials import (
    Elastomer,
    describe_material,
    material_faults,
    small_load_faults,
)
from studies.scene.sections import (
    APART,
    LARGEST_VOLUME,
    ONE_OR_MORE,
    Control,
    Fields,
    LargestVolume,
    Length,
    Order,
    SceneName,
    Section,
    Stiffness,
    Tolerance,
    is_ascending,
    order_faults,
)

# A bond meant as rigid is a layer this stiff, MPa/mm: its slip is at most 0.003 mm at 20 kPa, and tips are within
# 0.005 % of those with meshed PLA rings, which share their nodes with the wall (make study-paper; docs/decisions.md).
RIGID_BOND_MPA_PER_MM = 3000.0
# What rigid rings change of the tip at 20 kPa against meshed ones of a material, percent: the largest of the four
# reference actuators (the same), and what of the scene's tolerance it may take.
RING_ERROR_PERCENT = {"pla": 0.005, "polyethylene": 0.04}
RING_SHARE = 0.1


# Of the crest's radius; a thinner wall is a film, which nobody casts and whose meshes take minutes.
THINNEST_WALL = 1.0 / 2000.0
# What may be requested of a tip.
TipQuantity = Literal["tip_mm", "tip_force_n"]


class Rings(Section):
    """Rings on the crests' seats and how they are bonded.

    ``auto`` meshes them only where the scene's tolerance needs it. The bond is rigid, or a layer of ``adhesive`` with a
    normal and a tangential stiffness, which fall to zero over ``bond_grading_mm`` at the seat's edges.
    """

    model: Literal["auto", "rigid", "meshed", "none"] = Field(
        default="auto",
        description="rings as rigid bodies, as meshed solids, none, or rigid unless the tolerance needs a mesh",
    )
    material: Literal["pla", "polyethylene"] = Field(
        default="pla", description="of meshed rings, and for the mass of all"
    )
    seat_mm: Length = Field(default=4.0, description="axial width of a ring and of its seat on a crest")
    bond: Literal["rigid", "adhesive"] = Field(default="rigid", description="tied, or by an elastic layer")
    bond_normal_mpa_per_mm: Stiffness = Field(default=5.0, description="of an adhesive layer: stiffness across it")
    bond_tangential_mpa_per_mm: Stiffness = Field(default=2.0, description="of an adhesive layer: stiffness along it")
    bond_grading_mm: Annotated[float, Field(ge=0.0, le=100.0)] = Field(
        default=1.0,
        description="of an adhesive layer: length at the seat's edges over which its stiffness falls to zero",
    )
    height_mm: Length = Field(default=2.0, description="radial height of a ring")
    edge_radius_mm: Annotated[float, Field(ge=0.0, le=100.0)] = Field(
        default=0.5, description="radius of a ring's outer edges"
    )


class Load(Section):
    """Cavity pressures at which results are requested, kPa, what the steps between are taken in, and the tip.

    Pressures go away from zero: all positive and ascending, or all negative and descending, a vacuum.

    A blocked tip is held axially: the whole rim of a cap's distal face, which may slide and widen as on a wall without
    friction, or a rigid plate with all its motions. ``tip_force_n`` is a dead axial force on a free rigid plate,
    positive pulls it outwards. ``order`` is that of force and pressure (`solvers.paths.orders`): a payload that
    only the pressure can carry is lifted ``pressure-first``, as ``auto`` does where the force alone crushes it.
    """

    pressure_kpa: Annotated[list[Annotated[float, Field(allow_inf_nan=False)]], Field(min_length=1), ONE_OR_MORE] = (
        Field(description="cavity pressures at which results are wanted: ascending, or of a vacuum descending from 0")
    )
    control: Control = "auto"
    tip: Literal["free", "blocked"] = Field(
        default="free", description="free, or held axially: its force is then found"
    )
    tip_force_n: Annotated[float, Field(allow_inf_nan=False)] = Field(
        default=0.0, description="dead axial force on a free rigid plate; positive pulls outwards"
    )
    order: Order = "auto"
    largest_volume: LargestVolume = LARGEST_VOLUME

    @model_validator(mode="after")
    def _away_from_zero(self) -> Load:
        loads = [self.sense * p for p in self.pressure_kpa]
        if loads[0] <= 0.0 or not is_ascending(loads):
            raise ValueError(
                f"load.pressure_kpa = {self.pressure_kpa}: must ascend strictly from above 0, or descend from below 0, "
                f"by more than {APART:g} of each"
            )
        return self

    @property
    def sense(self) -> float:
        """+1 for pressures, -1 for a vacuum."""
        return -1.0 if self.pressure_kpa[0] < 0.0 else 1.0


class Contact(Section):
    """Contact of folds, rings and wall, in axisymmetric runs with rigid rings or none; ``auto``: from first touch."""

    model: Literal["auto", "off"] = Field(
        default="auto", description="frictionless contact from the first touch on, or none"
    )


class Ask(Section):
    """What is wanted, how exactly, whether fields are to be written, and unstable modes counted by harmonic."""

    quantities: list[TipQuantity] = Field(
        default=["tip_mm"], description="elongation at the tip; force at a blocked one"
    )
    tolerance_percent: Tolerance = 1.0
    fields: Fields = False
    modes: bool = Field(default=True, description="count unstable modes of 0 to 6 waves round the axis on the meridian")


class BellowsScene(Section):
    """A whole scene."""

    name: SceneName
    geometry: Geometry
    rings: Rings = Rings()
    mesh: BellowsMesh = BellowsMesh()
    material: Elastomer
    load: Load
    contact: Contact = Contact()
    ask: Ask = Ask()
    compare: Compare | None = None

    @model_validator(mode="before")
    @classmethod
    def _measured_pressures(cls, data: Any) -> Any:
        """What was measured is solved for."""
        compare, load = (data.get(key) for key in ("compare", "load")) if isinstance(data, dict) else (None, None)
        if not (isinstance(compare, dict) and isinstance(compare.get(PRESSURE), list)):
            return data
        load = {} if load is None else load
        if not isinstance(load, dict):
            return data
        return {**data, "load": {**load, PRESSURE: pressures_with(compare[PRESSURE], load.get(PRESSURE))}}

    @model_validator(mode="before")
    @classmethod
    def _least_seats(cls, data: Any) -> Any:
        geometry = data.get("geometry") if isinstance(data, dict) else None
        if not (isinstance(geometry, dict) and geometry.get("profile") == "zigzag"):
            return data
        rings = data.get("rings", {})
        return {**data, "rings": {"seat_mm": ZIGZAG_SEAT_MM, **rings}} if isinstance(rings, dict) else data

    @model_validator(mode="after")
    def _settle_rings(self) -> BellowsScene:
        """``auto`` rings become rigid or meshed here, so that nothing after has to ask."""
        if self.rings.model != "auto":
            return self
        allowed = RING_SHARE * self.ask.tolerance_percent
        model = "rigid" if RING_ERROR_PERCENT[self.rings.material] <= allowed else "meshed"
        return self.model_copy(update={"rings": self.rings.model_copy(update={"model": model})})

    @property
    def main_quantity(self) -> TipQuantity:
        """What the finite elements have to find: the force at a blocked tip, else its elongation."""
        return "tip_force_n" if self.blocked else "tip_mm"

    @property
    def quantities(self) -> tuple[TipQuantity, ...]:
        """What is requested, the main quantity in any case."""
        return tuple(dict.fromkeys((self.main_quantity, *self.ask.quantities)))

    @property
    def loads_kpa(self) -> tuple[float, ...]:
        """Requested pressures, kPa."""
        return tuple(self.load.pressure_kpa)

    @property
    def pressures_mpa(self) -> tuple[float, ...]:
        """Requested loads, MPa: pressures, or how far below the outside's where they are negative."""
        return tuple(1e-3 * abs(p) for p in self.load.pressure_kpa)

    @property
    def title(self) -> str:
        """One line for headings."""
        g = self.geometry
        end = f", core off the axis by {100.0 * g.eccentricity:g} % of t" if g.eccentricity else ""
        end += ", blocked tip" if self.blocked else ""
        end += f", {self.load.tip_force_n:g} N on the tip" if self.load.tip_force_n else ""
        return f"t = {g.wall_mm:g} mm, R_i = {g.root_radius_mm:g} mm, {describe_material(self.material)}{end}"

    @property
    def blocked(self) -> bool:
        """True if the tip is held."""
        return self.load.tip == "blocked"


def without_eccentricity(scene: BellowsScene) -> BellowsScene:
    """The same scene moulded round a centred core, which is rotationally symmetric."""
    if scene.geometry.eccentricity == 0.0:
        return scene
    return scene.model_copy(update={"geometry": scene.geometry.model_copy(update={"eccentricity": 0.0})})


def on_meridian(scene: BellowsScene) -> BellowsScene:
    """What the axisymmetric model knows of a scene: a centred core, and nothing of how bodies are solved."""
    mesh = scene.mesh.model_copy(update={"symmetry": "auto"})
    return without_eccentricity(scene).model_copy(update={"mesh": mesh})


def at_pressures(scene: BellowsScene, pressures_kpa: Sequence[float]) -> BellowsScene:
    """The same scene with other requested pressures."""
    return scene.model_copy(update={"load": scene.load.model_copy(update={"pressure_kpa": list(pressures_kpa)})})


def core_shift_mm(scene: BellowsScene) -> float:
    """How far the core sat off the axis, mm."""
    return scene.geometry.eccentricity * scene.geometry.wall_mm


def shape_of(scene: BellowsScene) -> BellowsShape:
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
        bends_mm=tuple(g.points_mm),
    )


def dimensions_of(scene: BellowsScene) -> BellowsDimensions:
    """The dimensions of the closed form."""
    g = scene.geometry
    return BellowsDimensions(g.root_radius_mm, g.crest_radius_mm, g.wall_mm, g.half_pitch_mm, g.convolutions)


def in_hexahedra(scene: BellowsScene) -> bool:
    """True for quadrilaterals and hexahedra, False for triangles and tetrahedra."""
    return scene.mesh.element == "hex" or (scene.mesh.element == "auto" and scene.rings.model != "meshed")


def ring_material(scene: BellowsScene) -> StiffSolid:
    """The rings' material."""
    return PLA if scene.rings.material == "pla" else POLYETHYLENE


def ring_shape(scene: BellowsScene) -> RingShape:
    """The rings' section."""
    return RingShape(scene.rings.height_mm, scene.rings.edge_radius_mm)


def bond_grade(scene: BellowsScene, axial_mm: np.ndarray) -> np.ndarray:
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


def bond_stiffness(scene: BellowsScene) -> tuple[float, float]:
    """Normal and tangential stiffness of the bond, MPa/mm."""
    if scene.rings.bond == "rigid":
        return RIGID_BOND_MPA_PER_MM, RIGID_BOND_MPA_PER_MM
    return scene.rings.bond_normal_mpa_per_mm, scene.rings.bond_tangential_mpa_per_mm


def bellows_faults(scene: BellowsScene) -> list[str]:
    """What the types cannot see: geometry, material stability, units; a line per fault."""
    faults = []
    try:
        check_shape(shape_of(scene))
    except GeometryError as error:
        faults.append(f"geometry: {error}".replace("bends_mm", "points_mm"))
    g = scene.geometry
    if g.wall_mm < THINNEST_WALL * g.crest_radius_mm:
        faults.append(
            f"geometry.wall_mm = {g.wall_mm:g}: less than 1/{1.0 / THINNEST_WALL:g} of crest_radius_mm = "
            f"{g.crest_radius_mm:g}: are both in mm? walls from {THINNEST_WALL * g.crest_radius_mm:g} mm on are meshed"
        )
    rings = scene.rings
    if rings.model == "meshed" and rings.edge_radius_mm >= min(rings.height_mm, 0.5 * rings.seat_mm):
        faults.append(
            f"rings.edge_radius_mm = {rings.edge_radius_mm:g}: must be less than height_mm = {rings.height_mm:g} "
            f"and half of seat_mm = {rings.seat_mm:g}"
        )
    faults += element_faults(scene.mesh, scene.material.kappa_over_mu)
    if rings.bond == "adhesive" and rings.bond_grading_mm > 0.5 * rings.seat_mm:
        faults.append(
            f"rings.bond_grading_mm = {rings.bond_grading_mm:g}: must be at most half of seat_mm = {rings.seat_mm:g}"
        )
    if scene.compare is not None and getattr(scene.compare, scene.main_quantity) is None:
        faults.append(
            f"compare: has no {scene.main_quantity}, which is what this scene finds: a free tip is compared by tip_mm, "
            "a blocked one by tip_force_n"
        )
    faults += _tip_faults(scene)
    faults += _core_faults(scene)
    faults += small_load_faults(scene.material, scene.load.pressure_kpa, "load.pressure_kpa")
    return faults + material_faults(scene.material, abs(scene.load.pressure_kpa[-1]), "load.pressure_kpa")


def _tip_faults(scene: BellowsScene) -> list[str]:
    faults = []
    given = f"load.tip_force_n = {scene.load.tip_force_n:g}"
    if scene.load.tip_force_n and scene.blocked:
        faults.append(f'{given}: a blocked tip takes no force: it must be 0, or load.tip = "free"')
    faults += order_faults(scene.load.order, scene.load.tip_force_n)
    if scene.load.tip_force_n and scene.geometry.tip != "rigid":
        faults.append(f'{given}: a force acts on a rigid plate: set geometry.tip = "rigid"')
    if "tip_force_n" in scene.ask.quantities and not scene.blocked:
        faults.append('ask.quantities: "tip_force_n" of a free tip is what is given: set load.tip = "blocked"')
    return faults


def _core_faults(scene: BellowsScene) -> list[str]:
    given = f"geometry.eccentricity = {scene.geometry.eccentricity:g}"
    faults = []
    if scene.geometry.eccentricity and scene.geometry.tip == "rigid":
        faults.append(f'{given}: a plate closes a round opening about the axis: set geometry.tip = "cap"')
    if scene.geometry.eccentricity and scene.rings.model == "meshed":
        faults.append(f'{given}: with meshed rings not modelled: set rings.model = "rigid"')
    return faults
