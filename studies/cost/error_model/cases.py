"""Scenes that the error model is fitted to and checked on, and the meridians each is solved on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from meshes.bellows import check_shape
from meshes.errors import GeometryError, MeshError
from studies.planning.error_model import LONGEST, Cells
from studies.planning.levels import MERIDIANS
from studies.results import provenance
from studies.scene.bellows import BellowsScene, shape_of
from studies.scene.load import load_bellows
from studies.scene.meshes import scene_meridian

TOLERANCE_SCENES: Final = provenance.ROOT / "scenes" / "tolerance"
TRAINING, SEED = 24, 20241
# Of these as many with `LONGEST` convolutions too: what both ends leave of error thins out with their number.
LONGER, PREFIX = 4, "train-"
# Finest meridian: what the others are compared with, extrapolated with the nominal order 2.
FINEST: Final = 8
YEOH: Final[Mapping[str, Any]] = {"law": "yeoh", "c_kpa": [36.0, 2.5, 0.23]}
OGDEN: Final[Mapping[str, Any]] = {"law": "ogden", "mu_kpa": 75.449, "alpha": 5.836, "convention": "2mu/alpha^2"}
KINDS: Final[tuple[Cells, ...]] = ("hex", "tet")


@dataclass(frozen=True)
class Trial:
    """A scene, and the cells it is solved in: ``hex`` or ``tet``, quadrilaterals or triangles."""

    scene: BellowsScene
    cells: Cells

    @property
    def name(self) -> str:
        """For messages."""
        return f"{self.scene.name} {self.cells}"

    @property
    def levels(self) -> tuple[int, ...]:
        """Meridians, coarsest first; the quadrilaterals' finest is what all are compared with."""
        return (*MERIDIANS, FINEST) if self.cells == "hex" else MERIDIANS


def cases(options: Mapping[str, Any]) -> list[Trial]:
    """All scenes in both cells."""
    training = training_scenes()
    return [Trial(scene, of) for of in KINDS for scene in (*training, *longer_scenes(training), *check_scenes())]


def check_scenes() -> list[BellowsScene]:
    """Scenes that were fixed before the fit."""
    return [load_bellows(path) for path in sorted(TOLERANCE_SCENES.glob("*.toml"))]


def training_scenes() -> list[BellowsScene]:
    """Made-up bellows: walls 0.5 to 2 mm, roots 4 to 10 mm, both silicones, seats, fillets, pitches and pressures."""
    random = np.random.default_rng(SEED)
    scenes: list[BellowsScene] = []
    while len(scenes) < TRAINING:
        wall, root, depth, seat, fillet, pitch, load = random.uniform(
            [0.5, 4.0, 4.0, 2.0, 0.3, 4.5, 0.6], [2.0, 10.0, 6.0, 4.0, 1.0, 6.0, 2.4]
        ).round(2)
        crest = round(root + depth, 2)
        # the load in parts of what a wall of this thickness carries, within 2 to 20 kPa
        top = round(min(max(load * 72.0 * wall / crest, 2.0), 20.0), 2)
        scene = BellowsScene.model_validate(
            {
                "name": f"{PREFIX}{len(scenes):02d}",
                "geometry": {
                    "kind": "bellows",
                    "root_radius_mm": root,
                    "crest_radius_mm": crest,
                    "wall_mm": wall,
                    "half_pitch_mm": pitch,
                    "convolutions": 1,
                    "fillet_mm": fillet,
                },
                "rings": {"model": "rigid", "seat_mm": seat},
                "material": OGDEN if len(scenes) % 2 else YEOH,
                "load": {"pressure_kpa": [0.5 * top, top]},
            }
        )
        try:
            check_shape(shape_of(scene))
            scene_meridian(scene, 1)
        except (GeometryError, MeshError):
            continue
        scenes.append(scene)
    return scenes


def longer_scenes(scenes: Sequence[BellowsScene]) -> list[BellowsScene]:
    """Some of the scenes with as many convolutions as the model tells apart."""
    found = []
    for scene in scenes[:LONGER]:
        geometry = scene.geometry.model_copy(update={"convolutions": LONGEST})
        found.append(scene.model_copy(update={"name": f"{scene.name}-n{LONGEST}", "geometry": geometry}))
    return found


def in_cells(scene: BellowsScene, cells: Cells) -> BellowsScene:
    """The scene in these cells, with rigid rings."""
    rings = scene.rings.model_copy(update={"model": "rigid"})
    mesh = scene.mesh.model_copy(update={"element": cells})
    return scene.model_copy(update={"rings": rings, "mesh": mesh})
