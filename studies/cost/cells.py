"""What the cost study measures, as data: bodies, models, cells, meshes, ways of stepping, ranks and threads."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal

from studies.results import provenance
from studies.scene.bellows import BellowsScene
from studies.scene.bodies import BodyScene
from studies.scene.files import load_scene

SCENES = provenance.ROOT / "scenes"
TUBE, BELLOWS, ACTUATOR = "exact/tube", "peers/bellows", "heung-t2-ri5"
BODIES = (TUBE, BELLOWS, ACTUATOR)
# The actuator is asked for its last pressure only: the study is about what a state costs.
ACTUATOR_KPA = (20.0,)
# Share of its wall time in which other processes may compute without disturbing a measurement.
QUIET = 0.1
# Linear elements without a pressure need a compressible material.
P1_KAPPA_OVER_MU = 1000.0

# A closed form has no cells.
Element = Literal["hex", "tet", "tet-p0", "tet-p1", "none"]
Model = Literal["closed_form", "axisymmetric", "sector", "full3d"]
# Paths from zero by what is held; bodies from the revolved axisymmetric state (warm), or by a path of their own (cold).
Strategy = Literal["auto", "pressure", "volume", "warm", "cold"]
CONTROLS: tuple[Strategy, ...] = ("pressure", "volume")
# The closed form's chain, in the place of a mesh.
CHAIN = "corrected"
# Elements that are there to be compared with: one pressure per cell, and linear without a pressure.
POORER: tuple[Element, ...] = ("tet-p0", "tet-p1")


@dataclass(frozen=True)
class Cell:
    """One thing to measure.

    Attributes
    ----------
    body
        Scene file below ``scenes``, without its ending.
    model, element, level
        Model, cells (on a meridian, ``hex`` are quadrilaterals and ``tet`` triangles) and mesh
        (`studies.planning.levels`).
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
    def name(self) -> str:
        """Mesh and way within the model, for instance ``hex n8r2 warm 2x1``."""
        return f"{self.element} {self.level} {self.strategy} {self.ranks}x{self.threads}"


@dataclass(frozen=True)
class Measurement:
    """What one cell cost, and its answer.

    Attributes
    ----------
    value, pressure_kpa
        The tip's (bellows) or the bore's (tube) displacement at the highest requested pressure, mm; NaN if not reached.
    wall_s, work_s
        From start to end of the process, and without start, imports and end.
    cpu_s
        User and system time of all ranks, start and imports included.
    peak_mb
        Peak resident memory of all ranks.
    compile_s
        How much longer the same run takes with an empty cache of compiled forms; NaN where that was not measured.
    split_s
        Wall seconds by activity; ``axisymmetric start`` is the whole of the run that a warm body starts from.
    status
        ``reached``, or why not.
    others_s
        CPU seconds that other processes, or other machines on the same host, took meanwhile; NaN if not known.
    """

    value: float
    pressure_kpa: float
    wall_s: float
    work_s: float
    cpu_s: float
    peak_mb: float
    unknowns: int
    factorisations: int
    compile_s: float
    split_s: dict[str, float] = field(hash=False)
    status: str
    others_s: float = math.nan

    @property
    def disturbed(self) -> bool:
        """True unless others are known to have left the machine to it."""
        return not self.others_s <= QUIET * self.wall_s

    def as_json(self) -> str:
        """One line."""
        return json.dumps(asdict(self))


def measurement(text: str) -> Measurement:
    """From its line."""
    data: dict[str, Any] = json.loads(text)
    return Measurement(**data)


def cell_scene(cell: Cell) -> BellowsScene | BodyScene:
    """The scene of a cell: its body's with the cell's element and control, no fields; hexahedra have rigid rings.

    Raises
    ------
    SceneError
        If the file is not there or at fault.
    """
    scene = load_scene(SCENES / f"{cell.body}.toml")
    control = cell.strategy if cell.strategy in ("pressure", "volume") else "auto"
    load: dict[str, Any] = {"control": control}
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


def _each(
    body: str, model: Model, element: Element, strategy: Strategy, levels: str, ranks: Sequence[int]
) -> list[Cell]:
    """Cells of these levels; one rank has two BLAS threads, two have one each."""
    return [
        Cell(body, model, element, level, strategy, r, 2 if r == 1 else 1) for level in levels.split() for r in ranks
    ]


def tube_cells() -> list[Cell]:
    """The tube with its exact answer; its bodies have paths of their own."""
    found: list[Cell] = []
    meridians: tuple[tuple[Element, str], ...] = (
        ("hex", "r1 r2 r4"),
        ("tet", "r1 r2 r4"),
        ("tet-p0", "r1 r2 r4 r8"),
        ("tet-p1", "r2 r4 r8"),
    )
    for element, levels in meridians:
        found += _each(TUBE, "axisymmetric", element, "auto", levels, (1,))
    found += _each(TUBE, "sector", "hex", "auto", "n8 n16", (1, 2))
    found += _each(TUBE, "sector", "hex", "auto", "n24", (2,))
    found += _each(TUBE, "full3d", "hex", "auto", "n8 n16", (1, 2))
    found += _each(TUBE, "full3d", "tet", "auto", "n12 n16", (1, 2))
    for element in POORER:
        found += _each(TUBE, "full3d", element, "auto", "n12 n16", (2,))
    for control in CONTROLS:
        found += _each(TUBE, "axisymmetric", "hex", control, "r2", (1,))
        found += _each(TUBE, "full3d", "tet", control, "n12", (2,))
    return found


def bellows_cells() -> list[Cell]:
    """The peers' bellows of two convolutions; hexahedra have rigid rings, tetrahedra meshed ones."""
    found = [Cell(BELLOWS, "closed_form", "none", CHAIN, "auto")]
    meridians: tuple[tuple[Element, str], ...] = (
        ("hex", "r1 r2 r4"),
        ("tet", "r1 r2 r4 r8"),
        ("tet-p0", "r1 r2 r4"),
        ("tet-p1", "r1 r2 r4"),
    )
    for element, levels in meridians:
        found += _each(BELLOWS, "axisymmetric", element, "auto", levels, (1,))
    found += _each(BELLOWS, "sector", "hex", "warm", "n8 n16 n8r2 n16r2", (1,))
    found += _each(BELLOWS, "sector", "hex", "warm", "n16r2", (2,))
    found += _each(BELLOWS, "full3d", "hex", "warm", "n6 n8 n12 n8r2", (1, 2))
    found += _each(BELLOWS, "full3d", "hex", "warm", "n12r2", (2,))
    found += _each(BELLOWS, "full3d", "tet", "warm", "n8 n12 n16", (1, 2))
    for element in POORER:
        found += _each(BELLOWS, "full3d", element, "warm", "n8 n12", (2,))
    found += _each(BELLOWS, "full3d", "hex", "cold", "n8", (1, 2))
    found += _each(BELLOWS, "full3d", "tet", "cold", "n8", (2,))
    for control in CONTROLS:
        found += _each(BELLOWS, "axisymmetric", "hex", control, "r2", (1,))
        found += _each(BELLOWS, "axisymmetric", "tet", control, "r2", (1,))
    return found


def actuator_cells() -> list[Cell]:
    """An actuator of the paper."""
    found = [Cell(ACTUATOR, "closed_form", "none", CHAIN, "auto")]
    found += _each(ACTUATOR, "axisymmetric", "hex", "auto", "r1 r2 r4", (1,))
    found += _each(ACTUATOR, "sector", "hex", "warm", "n8", (2,))
    found += _each(ACTUATOR, "full3d", "hex", "warm", "n8 n16", (1, 2))
    found += _each(ACTUATOR, "full3d", "hex", "warm", "n12 n24 n8r2 n12r2 n16r2", (2,))
    return found


def large_cells() -> list[Cell]:
    """Bodies of the actuator up to what fits 24 GB; minutes each."""
    return _each(ACTUATOR, "full3d", "hex", "warm", "n24r2 n32r2", (2,))


def all_cells() -> tuple[Cell, ...]:
    """All cells, the quick ones first within each body."""
    return (*tube_cells(), *bellows_cells(), *actuator_cells(), *large_cells())


# What compiling takes is measured on these.
COMPILED = (
    Cell(BELLOWS, "axisymmetric", "hex", "r1", "auto"),
    Cell(BELLOWS, "full3d", "hex", "n8", "warm"),
    Cell(BELLOWS, "full3d", "tet", "n8", "warm"),
)


# Bodies that the plan makes of these scenes at their tolerance: of the actuator on r1 for its last pressure alone, on
# r2 for all pressures of the paper study.
DEFAULT_BODIES = {BELLOWS: ("n8",), ACTUATOR: ("n8", "n8r2")}


def is_default(cell: Cell) -> bool:
    """True for the settings of `make study-paper`: quadrilaterals, and warm hexahedra as the plan makes them."""
    if cell.element != "hex" or cell.body == TUBE:
        return False
    if cell.model == "axisymmetric":
        return cell.strategy == "auto"
    bodies = DEFAULT_BODIES.get(cell.body, ())
    return cell.model == "full3d" and cell.strategy == "warm" and cell.ranks == 2 and cell.level in bodies


def scene_file(body: str) -> Path:
    """The scene file of a body."""
    return SCENES / f"{body}.toml"
