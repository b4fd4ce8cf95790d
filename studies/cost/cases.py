"""What the cost study measures, as data: bodies, models, cells, meshes, ways of stepping, ranks and threads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, Literal

from analytical.bellows.paper import REFERENCE_FAMILY, actuators
from studies.results import provenance
from studies.scene.bellows import BellowsScene
from studies.scene.bodies import BodyScene
from studies.scene.load import load_scene
from studies.scene.text import changed_text

SCENES: Final = provenance.ROOT / "scenes"
TUBE, BELLOWS, ACTUATOR = "exact/tube", "peers/bellows", "heung-t2-ri5"
# BellowsScene files below scenes/ without their ending, and what their scenes are called.
BODIES: Final[Mapping[str, str]] = {TUBE: "tube", BELLOWS: "peer-bellows", ACTUATOR: "heung-t2-ri5"}
# Of the actuators only the last pressure is requested: the study is about what a state costs.
ACTUATOR_KPA: Final = (20.0,)
# Linear elements without a pressure need a compressible material.
P1_KAPPA_OVER_MU: Final = 1000.0

# tet-p0 has one pressure per cell, tet-p1 is linear without one; a closed form has no cells.
Element = Literal["hex", "tet", "tet-p0", "tet-p1", "none"]
Model = Literal["closed_form", "axisymmetric", "sector", "full3d"]
# Paths from zero by what is held; bodies from the revolved axisymmetric state (warm), or by a path of their own (cold).
Strategy = Literal["auto", "pressure", "volume", "warm", "cold"]


@dataclass(frozen=True)
class Cell:
    """One thing to measure.

    Attributes
    ----------
    body
        One of `BODIES`.
    model, element, level
        Model, cells (on a meridian, ``hex`` are quadrilaterals and ``tet`` triangles) and mesh
        (`studies.planning.levels`; of the closed form, its chain).
    strategy
        How the requested pressures are come to.
    ranks, threads
        MPI ranks, and BLAS threads of each.
    """

    body: str
    model: Model
    element: Element
    level: str
    strategy: Strategy
    ranks: int = 1
    threads: int = 2

    @property
    def setting(self) -> str:
        """Mesh and way within the model, for instance ``hex n8r2 warm 2x1``."""
        return f"{self.element} {self.level} {self.strategy} {self.ranks}x{self.threads}"

    @property
    def name(self) -> str:
        """All of it."""
        return f"{self.body} {self.model} {self.setting}"


@dataclass(frozen=True)
class Batch:
    """The paper's four actuators at their last pressure, on two cores.

    Attributes
    ----------
    model
        Forced model.
    ranks_per_scene
        1: two scenes side by side; 2: one after the other, each on both cores.
    """

    model: Model
    ranks_per_scene: int

    @property
    def name(self) -> str:
        """For messages."""
        return f"batch {self.model}, ranks per scene: {self.ranks_per_scene}"


def _cells(
    body: str, model: Model, element: Element, strategy: Strategy, levels: str, ranks: tuple[int, ...] = (1,)
) -> list[Cell]:
    """Cells of these levels; one rank has two BLAS threads, two have one each."""
    return [
        Cell(body, model, element, level, strategy, r, 2 if r == 1 else 1) for level in levels.split() for r in ranks
    ]


# All cells, the quick ones first within each body. The tube has an exact answer; its bodies have paths of their own.
# On the bellows hexahedra have rigid rings, tetrahedra meshed ones.
CELLS: Final = (
    *_cells(TUBE, "axisymmetric", "hex", "auto", "r1 r2 r4"),
    *_cells(TUBE, "axisymmetric", "tet", "auto", "r1 r2 r4"),
    *_cells(TUBE, "axisymmetric", "tet-p0", "auto", "r1 r2 r4 r8"),
    *_cells(TUBE, "axisymmetric", "tet-p1", "auto", "r2 r4 r8"),
    *_cells(TUBE, "sector", "hex", "auto", "n8 n16", (1, 2)),
    *_cells(TUBE, "sector", "hex", "auto", "n24", (2,)),
    *_cells(TUBE, "full3d", "hex", "auto", "n8 n16", (1, 2)),
    *_cells(TUBE, "full3d", "tet", "auto", "n12 n16", (1, 2)),
    *_cells(TUBE, "full3d", "tet-p0", "auto", "n12 n16", (2,)),
    *_cells(TUBE, "full3d", "tet-p1", "auto", "n12 n16", (2,)),
    *_cells(TUBE, "axisymmetric", "hex", "pressure", "r2"),
    *_cells(TUBE, "full3d", "tet", "pressure", "n12", (2,)),
    *_cells(TUBE, "axisymmetric", "hex", "volume", "r2"),
    *_cells(TUBE, "full3d", "tet", "volume", "n12", (2,)),
    *_cells(BELLOWS, "closed_form", "none", "auto", "corrected"),
    *_cells(BELLOWS, "axisymmetric", "hex", "auto", "r1 r2 r4"),
    *_cells(BELLOWS, "axisymmetric", "tet", "auto", "r1 r2 r4 r8"),
    *_cells(BELLOWS, "axisymmetric", "tet-p0", "auto", "r1 r2 r4"),
    *_cells(BELLOWS, "axisymmetric", "tet-p1", "auto", "r1 r2 r4"),
    *_cells(BELLOWS, "sector", "hex", "warm", "n8 n16 n8r2 n16r2"),
    *_cells(BELLOWS, "sector", "hex", "warm", "n16r2", (2,)),
    *_cells(BELLOWS, "full3d", "hex", "warm", "n6 n8 n12 n8r2", (1, 2)),
    *_cells(BELLOWS, "full3d", "hex", "warm", "n12r2", (2,)),
    *_cells(BELLOWS, "full3d", "tet", "warm", "n8 n12 n16", (1, 2)),
    *_cells(BELLOWS, "full3d", "tet-p0", "warm", "n8 n12", (2,)),
    *_cells(BELLOWS, "full3d", "tet-p1", "warm", "n8 n12", (2,)),
    *_cells(BELLOWS, "full3d", "hex", "cold", "n8", (1, 2)),
    *_cells(BELLOWS, "full3d", "tet", "cold", "n8", (2,)),
    *_cells(BELLOWS, "axisymmetric", "hex", "pressure", "r2"),
    *_cells(BELLOWS, "axisymmetric", "tet", "pressure", "r2"),
    *_cells(BELLOWS, "axisymmetric", "hex", "volume", "r2"),
    *_cells(BELLOWS, "axisymmetric", "tet", "volume", "r2"),
    *_cells(ACTUATOR, "closed_form", "none", "auto", "corrected"),
    *_cells(ACTUATOR, "axisymmetric", "hex", "auto", "r1 r2 r4"),
    *_cells(ACTUATOR, "sector", "hex", "warm", "n8", (2,)),
    *_cells(ACTUATOR, "full3d", "hex", "warm", "n8 n16", (1, 2)),
    *_cells(ACTUATOR, "full3d", "hex", "warm", "n12 n24 n8r2 n12r2 n16r2", (2,)),
)
# Up to what fits 24 GB; minutes each.
LARGE: Final = tuple(_cells(ACTUATOR, "full3d", "hex", "warm", "n24r2 n32r2", (2,)))
BATCHES: Final = tuple(Batch(model, ranks) for model in ("axisymmetric", "full3d") for ranks in (1, 2))
# What compiling takes is measured on these.
COMPILED: Final = (
    Cell(BELLOWS, "axisymmetric", "hex", "r1", "auto"),
    Cell(BELLOWS, "full3d", "hex", "n8", "warm"),
    Cell(BELLOWS, "full3d", "tet", "n8", "warm"),
)
# Bodies that the plan makes of these scenes at their tolerance: of the actuator on r1 for its last pressure alone, on
# r2 for all pressures of the paper study.
DEFAULT_BODIES: Final[Mapping[str, tuple[str, ...]]] = {BELLOWS: ("n8",), ACTUATOR: ("n8", "n8r2")}


def is_default(cell: Cell) -> bool:
    """True for the settings of `make study-paper`: quadrilaterals, and warm hexahedra as the plan makes them."""
    if cell.element != "hex" or cell.body == TUBE:
        return False
    if cell.model == "axisymmetric":
        return cell.strategy == "auto"
    bodies = DEFAULT_BODIES.get(cell.body, ())
    return cell.model == "full3d" and cell.strategy == "warm" and cell.ranks == 2 and cell.level in bodies


def cell_scene(cell: Cell) -> BellowsScene | BodyScene:
    """The scene of a cell: its body's with the cell's element and control, no fields; hexahedra have rigid rings.

    Raises
    ------
    SceneError
        If the file is not there or at fault.
    """
    scene = load_scene(SCENES / f"{cell.body}.toml")
    load: dict[str, Any] = {"control": cell.strategy if cell.strategy in ("pressure", "volume") else "auto"}
    if cell.body == ACTUATOR:
        load["pressure_kpa"] = list(ACTUATOR_KPA)
    parts: dict[str, Any] = {
        "load": scene.load.model_copy(update=load),
        "mesh": scene.mesh.model_copy(update={"element": "auto" if cell.element == "none" else cell.element}),
        "ask": scene.ask.model_copy(update={"fields": False}),
    }
    if isinstance(scene, BellowsScene) and cell.element == "hex":
        parts["rings"] = scene.rings.model_copy(update={"model": "rigid"})
    if cell.element == "tet-p1":
        parts["material"] = scene.material.model_copy(update={"kappa_over_mu": P1_KAPPA_OVER_MU})
    return scene.model_copy(update=parts)


def batch_texts() -> list[str]:
    """The scene files of a batch, only their last pressure requested, without fields."""
    changes = {"load.pressure_kpa": list(ACTUATOR_KPA), "ask.fields": False}
    names = [actuator.name for actuator in actuators(REFERENCE_FAMILY)]
    return [changed_text((SCENES / f"{name}.toml").read_text(encoding="utf-8"), name, changes) for name in names]
