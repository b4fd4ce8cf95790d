"""Dimensions of the actuators as their scene files have them, and which of them are printed, inferred or chosen."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from analytical.bellows.chains_by_name import SILICONES
from analytical.bellows.paper import PaperActuator
from meshes.bellows import wall_segments
from meshes.shape import BellowsShape
from studies.paper.cases import REFERENCE, SCENES, SETS
from studies.report.tables import Table
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.load import load_bellows

Origin = Literal["printed", "inferred", "chosen"]
# What of a size's line in a scene file says where it comes from; the head of the files says that the rest is chosen.
_SAID: Final = re.compile(r"^(\w+) = .*\((printed|inferred)\)", re.MULTILINE)
# Nearest to the straight lines of the paper's figure 2 that is meshed.
ZIGZAG: Final = "zigzag"


@dataclass(frozen=True)
class Size:
    """A key of a scene file with its letter and meaning; mm, or a number of pieces."""

    letter: str
    key: str
    meaning: str
    of: Callable[[BellowsScene], float]


SIZES: Final = (
    Size("t", "wall_mm", "wall thickness, normal to the wall", lambda s: s.geometry.wall_mm),
    Size("R_i", "root_radius_mm", "root radius, cavity side", lambda s: s.geometry.root_radius_mm),
    Size("R_p", "crest_radius_mm", "crest radius, cavity side", lambda s: s.geometry.crest_radius_mm),
    Size("e", "half_pitch_mm", "half pitch, from a crest to the next root", lambda s: s.geometry.half_pitch_mm),
    Size("n", "convolutions", "number of convolutions", lambda s: float(s.geometry.convolutions)),
    Size("seat", "seat_mm", "width of a ring and of its seat on a crest", lambda s: s.rings.seat_mm),
    Size("fillet", "fillet_mm", "radius of every concave surface", lambda s: s.geometry.fillet_mm),
    Size("collar", "collar_mm", "straight length beyond the last crest, at either end", lambda s: s.geometry.collar_mm),
    Size("cap", "cap_mm", "thickness of the closed end", lambda s: s.geometry.cap_mm),
    Size("ring", "height_mm", "height of a ring", lambda s: s.rings.height_mm),
)


def scene_file(name: str, outline: str = "") -> str:
    """Text of an actuator's scene file."""
    return (SCENES / outline / f"{name}.toml").read_text(encoding="utf-8")


def scene_of(name: str, outline: str = "") -> BellowsScene:
    """The scene of an actuator as moulded, or near the zigzag."""
    return load_bellows(SCENES / outline / f"{name}.toml")


def origins(text: str) -> Mapping[str, Origin]:
    """By key: where a size in a scene file comes from."""
    said = dict(_SAID.findall(text))
    return {size.key: said.get(size.key, "chosen") for size in SIZES}


def called(actuator: PaperActuator) -> str:
    """What tables of answers call an actuator."""
    d = actuator.dimensions
    return f"t = {d.wall_mm:g} mm, R_i = {d.root_radius_mm:g} mm"


# By the name of a scene.
CALLED: Final[Mapping[str, str]] = {actuator.name: called(actuator) for actuator in REFERENCE}


def dimensions() -> Table:
    """Every size of the four actuators as moulded, mm, its origin, and what differs near the zigzag."""
    names = [actuator.name for actuator in REFERENCE]
    moulded, zigzag = [scene_of(name) for name in names], [scene_of(name, ZIGZAG) for name in names]
    said = [origins(scene_file(name)) for name in names]
    lines = []
    for size in SIZES:
        of = tuple(dict.fromkeys(origin[size.key] for origin in said))
        values = [f"{size.of(scene):g}" for scene in moulded]
        where = of[0] if len(of) == 1 else ", ".join(origin[size.key] for origin in said)
        lines.append((size.letter, size.meaning, *values, where))
        near = [f"{size.of(scene):g}" for scene in zigzag]
        if near != values:
            lines.append((size.letter, f"{size.meaning}: zigzag outline", *near, "chosen"))
    straight = [f"{actuator.dimensions.side_length_mm:.2f}" for actuator in REFERENCE]
    lines.append(("l", "straight side wall of the closed form, √(e² + (R_p − R_i)²)", *straight, "follows"))
    for scenes, outline in ((moulded, "as moulded"), (zigzag, "zigzag outline")):
        lengths = [f"{centreline_mm(shape_of(scene)):.2f}" for scene in scenes]
        lines.append(("", f"centreline of half a fold that is meshed: {outline}", *lengths, "follows"))
    header = ("", "mm (n: number)", *map(called, REFERENCE), "origin")
    return Table(header, tuple(lines), left=(0, 1, len(header) - 1))


def centreline_mm(shape: BellowsShape) -> float:
    """Length of the wall's centreline from the middle of a crest to the middle of the next root, mm."""
    folds = [s.length_mm for s in wall_segments(shape) if s.kind in ("crest", "side", "root")]
    return sum(folds) / (2.0 * shape.convolutions) + 0.5 * shape.seat_mm


def sets() -> Table:
    """The sets of inferred dimensions, mm, with the silicone of each actuator."""
    lines = [(label, *_set(actuators)) for label, actuators in SETS.items()]
    header = ("set", "larger R_i", "R_p", "e", "n", "silicones, in the order of the actuators")
    return Table(header, tuple(lines), left=(0, len(header) - 1))


def _set(actuators: Sequence[PaperActuator]) -> tuple[str, ...]:
    d = actuators[1].dimensions
    numbers = (d.root_radius_mm, d.crest_radius_mm, d.half_pitch_mm, d.convolutions)
    return (*(f"{number:g}" for number in numbers), ", ".join(SILICONES[a.silicone] for a in actuators))
