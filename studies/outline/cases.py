"""The outlines: the paper's four actuators with fillets, seats, ends and rings changed one at a time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from analytical.bellows.paper import PaperActuator, actuators
from studies.results import provenance
from studies.scene.bellows import BellowsScene, bellows_faults
from studies.scene.load import load_bellows


@dataclass(frozen=True)
class Outline:
    """An outline.

    Attributes
    ----------
    name
        For folders and rows.
    text
        For tables.
    fillet_mm, seat_mm
        Radius of concave surfaces, and width of a ring's seat.
    rigid_tip
        True for a rigid plate instead of the silicone cap.
    rings
        False leaves the crests free.
    same_free_wall
        True keeps what is beside the seats: the pitch is shorter by what the seats are narrower.
    """

    name: str
    text: str
    fillet_mm: float = 0.1
    seat_mm: float = 0.5
    rigid_tip: bool = False
    rings: bool = True
    same_free_wall: bool = False


# The outline of the reference scenes, and the one nearest to the zigzag of the paper's figure 2 that is meshed here.
MOULDED: Final = Outline("moulded", "as moulded: fillets 0.5, seats 4 mm", 0.5, 4.0)
FILLETS: Final = Outline("fillet-0.1", "fillets 0.1, seats 4 mm", 0.1, 4.0)
ZIGZAG: Final = Outline("zigzag", "near the zigzag: fillets 0.1, seats 0.5 mm")
RIGID_TIP: Final = Outline("zigzag-rigid-tip", "near the zigzag, a rigid plate for the cap", rigid_tip=True)
SAME_WALL: Final = Outline(
    "seat-0.5-same-wall", "fillets 0.1, seats 0.5 mm, free wall as with 4 mm", same_free_wall=True
)
OUTLINES: Final = (
    MOULDED,
    Outline("fillet-1", "fillets 1, seats 4 mm", 1.0, 4.0),
    Outline("fillet-0.2", "fillets 0.2, seats 4 mm", 0.2, 4.0),
    FILLETS,
    Outline("seat-2", "fillets 0.1, seats 2 mm", 0.1, 2.0),
    Outline("seat-1", "fillets 0.1, seats 1 mm", 0.1, 1.0),
    ZIGZAG,
    Outline("seat-0.25", "fillets 0.1, seats 0.25 mm", 0.1, 0.25),
    RIGID_TIP,
    Outline("zigzag-no-rings", "near the zigzag, no rings", rings=False),
    SAME_WALL,
)


@dataclass(frozen=True)
class Case:
    """An actuator with an outline."""

    actuator: PaperActuator
    outline: Outline
    scene: BellowsScene

    @property
    def name(self) -> str:
        """Of its rows and its folder."""
        return f"{self.actuator.name}-{self.outline.name}"

    @property
    def fault(self) -> str:
        """Why it cannot be built; empty if it can."""
        return "; ".join(bellows_faults(self.scene))


def cases(options: Mapping[str, Any]) -> list[Case]:
    """Every actuator with every outline."""
    folder = provenance.ROOT / "scenes"
    return [
        Case(actuator, outline, with_outline(load_bellows(folder / f"{actuator.name}.toml"), actuator, outline))
        for actuator in actuators()
        for outline in OUTLINES
    ]


def with_outline(scene: BellowsScene, actuator: PaperActuator, outline: Outline) -> BellowsScene:
    """A scene with another outline, and with the name of its rows."""
    g, rings = scene.geometry, scene.rings
    shorter = 0.5 * (MOULDED.seat_mm - outline.seat_mm) if outline.same_free_wall else 0.0
    geometry = g.model_copy(
        update={
            "fillet_mm": outline.fillet_mm,
            "half_pitch_mm": g.half_pitch_mm - shorter,
            "tip": "rigid" if outline.rigid_tip else "cap",
        }
    )
    model = rings.model if outline.rings else "none"
    changed = {"seat_mm": outline.seat_mm, "model": model}
    return scene.model_copy(
        update={
            "name": f"{actuator.name}-{outline.name}",
            "geometry": geometry,
            "rings": rings.model_copy(update=changed),
        }
    )
