"""Sizes of a bellows in a scene, measured at the cavity or outside."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, TypeGuard

from pydantic import Field, model_validator

from studies.scene.sections import Length, Section

# A zigzag's straight walls still need some fillet and seat: the least that are meshed here. The paper's has neither.
ZIGZAG_FILLET_MM, ZIGZAG_SEAT_MM = 0.1, 0.5


class Geometry(Section):
    """The bellows, mm; radii are cavity-side, the wall is measured normal to itself.

    ``arcs``: as it could be moulded, straight sides between rounded crests and roots; ``zigzag``: as near as can be
    built to the straight lines from root to crest of the paper's figure 2, with the least fillets and seats;
    ``polyline``: sides that bend at points of one's own, on the wall's middle between a crest and the next root: axial
    distance from the crest's middle, and radius.
    """

    also: ClassVar[Mapping[str, str]] = {
        "outer_diameter_mm": "diameter over the crests, in place of crest_radius_mm: 2 (crest_radius_mm + wall_mm)",
        "pitch_mm": "from a crest to the next, in place of half_pitch_mm",
    }

    kind: Literal["bellows"] = Field(description="an actuator of revolution")
    profile: Literal["arcs", "zigzag", "polyline"] = Field(
        default="arcs",
        description="shape of the side walls: straight between rounded bends, straight with the least bends, own",
    )
    points_mm: Annotated[list[tuple[Length, Length]], Field(max_length=50)] = Field(
        default=[],
        description="of a polyline: points [axial distance from the crest's middle, radius] of the wall's middle line",
    )
    root_radius_mm: Length = Field(description="R_i, radius of the roots (inner bends), cavity side")
    crest_radius_mm: Length = Field(description="R_p, radius of the crests (outer bends), cavity side")
    wall_mm: Length = Field(description="t, wall thickness, normal to the wall")
    half_pitch_mm: Length = Field(description="e, axial distance from a crest to the next root")
    convolutions: Annotated[int, Field(ge=1, le=100)] = Field(description="n, number of convolutions")
    collar_mm: Length = Field(
        default=3.0, description="axial length at either end, to the middle of the crest next to it"
    )
    fillet_mm: Annotated[float, Field(ge=0.1, le=100.0)] = Field(
        default=0.5, description="radius of every concave surface"
    )
    tip: Literal["cap", "rigid"] = Field(
        default="cap", description="end of the cavity: a cap of silicone, or a rigid plate bonded to the open end"
    )
    cap_mm: Length = Field(default=5.0, description="thickness of the cap")
    eccentricity: Annotated[float, Field(ge=0.0, le=0.5)] = Field(
        default=0.0, description="how far the moulding core sat off the axis, as a share of the wall"
    )

    @model_validator(mode="before")
    @classmethod
    def _measured_outside(cls, data: Any) -> Any:
        return _inner_sizes(data) if isinstance(data, dict) else data

    @model_validator(mode="before")
    @classmethod
    def _least_fillets(cls, data: Any) -> Any:
        if isinstance(data, dict) and data.get("profile") == "zigzag":
            return {"fillet_mm": ZIGZAG_FILLET_MM, **data}
        return data

    @model_validator(mode="after")
    def _profile_has_its_keys(self) -> Geometry:
        if self.profile == "zigzag" and self.fillet_mm != ZIGZAG_FILLET_MM:
            raise ValueError(
                f"geometry.fillet_mm = {self.fillet_mm:g}: a zigzag has the least, {ZIGZAG_FILLET_MM:g} mm: "
                'leave the key out, or set geometry.profile = "arcs"'
            )
        if self.profile == "polyline" and not self.points_mm:
            raise ValueError(
                'geometry.profile = "polyline": needs geometry.points_mm, points [axial distance from the crest\'s '
                "middle, radius] of the wall's middle line between a crest and the next root"
            )
        if self.profile != "polyline" and self.points_mm:
            raise ValueError(
                f"geometry.points_mm = {self.points_mm}: of a polyline only: leave the key out, or set "
                'geometry.profile = "polyline"'
            )
        return self


def _inner_sizes(data: Mapping[str, Any]) -> dict[str, Any]:
    """Keys of a geometry with those that are measured outside turned into the others; faults are left to the types."""
    found = dict(data)
    outer, pitch, wall = (found.get(key) for key in ("outer_diameter_mm", "pitch_mm", "wall_mm"))
    if _is_size(outer) and _is_size(wall):
        if outer <= 2.0 * wall:
            raise ValueError(f"geometry.outer_diameter_mm = {outer:g}: must be more than two walls, {2.0 * wall:g} mm")
        _put_in_place_of(found, "outer_diameter_mm", "crest_radius_mm", 0.5 * outer - wall)
    if _is_size(pitch):
        _put_in_place_of(found, "pitch_mm", "half_pitch_mm", 0.5 * pitch)
    return found


def _is_size(value: Any) -> TypeGuard[float]:
    """True for what the types take for a length or more; all else they refuse."""
    return isinstance(value, int | float) and not isinstance(value, bool) and 0.0 < value <= 1e6


def _put_in_place_of(keys: dict[str, Any], outside: str, inside: str, value_mm: float) -> None:
    """Change a key for the one that it stands for, which must not be there too."""
    given = keys.pop(outside)
    if inside in keys:
        raise ValueError(f"geometry.{outside} = {given:g}: stands for {inside}, which is given too: leave one out")
    keys[inside] = value_mm
