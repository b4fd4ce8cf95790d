"""Shapes of simple bodies in scenes, told apart by geometry.kind; every length in mm."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from studies.scene.sections import Length, Section


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


class CylinderGeometry(Section):
    """A solid cylinder, clamped at one end and bonded to a rigid plate at the other, which turns about the axis."""

    kind: Literal["cylinder"]
    radius_mm: Length
    length_mm: Length


class CookGeometry(Section):
    """Cook's membrane, 48 mm long and 44 to 16 mm high, in plane strain; clamped on the left."""

    kind: Literal["cook"]


class VentricleGeometry(Section):
    """A wall between two ellipsoids of revolution, cut off by the base plane, which is clamped.

    Semi-axes across and along the axis; the base is ``base_mm`` from the ellipsoids' centre, away from the apex.
    """

    kind: Literal["ventricle"]
    inner_across_mm: Length
    inner_along_mm: Length
    outer_across_mm: Length
    outer_along_mm: Length
    base_mm: Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


class MeshGeometry(Section):
    """A user's gmsh file beside the scene; ``scale`` makes its lengths mm (1000 for metres).

    ``tip = "rigid"``: the surface named tip moves as a rigid body; where the cavity ends on it, it closes the cavity.
    Surfaces named rigid, or rigid_NAME, are rigid bodies each, free to move.
    """

    kind: Literal["mesh"]
    file: Annotated[str, Field(min_length=1)] = Field(description="gmsh file, found from where the scene is")
    scale: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] = Field(
        default=1.0, description="factor that makes the file's lengths mm: 1000 for metres"
    )
    tip: Literal["elastic", "rigid"] = Field(
        default="elastic", description="whether the surface named tip moves as a rigid body"
    )


Geometry = (
    TubeGeometry
    | SphereGeometry
    | RingGeometry
    | BlockGeometry
    | CylinderGeometry
    | CookGeometry
    | VentricleGeometry
    | MeshGeometry
)
