"""What a cell of the stress test is: a body, its load and how it is solved; and the maps that cells stand in.

Bodies are meridians: thick tubes and spheres with exact answers, and a bellows of two convolutions
(scenes/smoke-t2-ri5.toml) that is compared with itself on fine meshes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from analytical.laws.isotropic import Law
from analytical.laws.silicones import DRAGON_SKIN_10
from meshes.cells import CellKind

Kind = Literal["tube", "sphere"]
Control = Literal["auto", "pressure", "volume"]
# How a cell departs from the solver on purpose: unsplit energy, or elements with too many pressures.
Flaw = Literal["", "raw energy", "equal order"]


@dataclass(frozen=True)
class Round:
    """A tube in plane strain, or the upper half of a sphere: its bore is known exactly.

    Attributes
    ----------
    kind
        Which.
    law, kappa_over_mu
        Material.
    cells, element
        Kind of cells; ``P2/P0`` or empty for the usual pair of the cells.
    inner_mm, wall_mm
        Undeformed bore and wall.
    along, through
        Cells along the meridian and through the wall.
    length_mm
        Of a tube.
    noise, seed, zigzag
        Moves of inner nodes, see `studies.stability.meshes`.
    """

    kind: Kind
    law: Law = DRAGON_SKIN_10
    kappa_over_mu: float = math.inf
    cells: CellKind = "quadrilaterals"
    element: Literal["", "P2/P0"] = ""
    inner_mm: float = 5.0
    wall_mm: float = 2.0
    along: int = 6
    through: int = 4
    length_mm: float = 3.0
    noise: float = 0.0
    seed: int = 0
    zigzag: float = 0.0


@dataclass(frozen=True)
class Bellows:
    """Two convolutions of the reference actuator, with changes of its scene.

    Attributes
    ----------
    changes
        Pairs (section.key, value) of the scene file.
    level
        Meridian level.
    contrast
        Young's modulus of meshed rings over the silicone's; None for rings as in the scene.
    cell_mm, through
        Largest cell along the wall, and cells through it; None for the default of the level.
    noise, seed
        Moves of inner nodes, see `studies.stability.meshes`.
    """

    changes: tuple[tuple[str, Any], ...] = ()
    level: int = 1
    contrast: float | None = None
    cell_mm: float | None = None
    through: int | None = None
    noise: float = 0.0
    seed: int = 0

    @property
    def ideal(self) -> Bellows:
        """The same body with nothing done to its mesh."""
        return Bellows(self.changes, contrast=self.contrast)


@dataclass(frozen=True)
class Cell:
    """One run.

    Attributes
    ----------
    axis, row, column
        Its map and its place there.
    body
        What is solved.
    load_kpa
        Requested pressure in the cavity; negative is a vacuum. Round bodies, which are incompressible then, take that
        as a pressure from outside: the state is the same.
    control
        As in a scene.
    leap
        Steps are this many times the usual ones, and the first in pressure is the whole load; 0: usual steps.
    tolerance
        Relative tolerance of Newton's method.
    ranks, threads
        Run by so many ranks of MPI with so many threads of the BLAS each.
    flaw
        Set in controls, which must fail.
    """

    axis: str
    row: str
    column: str
    body: Round | Bellows
    load_kpa: float
    control: Control = "auto"
    leap: float = 0.0
    tolerance: float = 1e-8
    ranks: int = 1
    threads: int = 1
    flaw: Flaw = ""

    @property
    def place(self) -> str:
        """Row and column."""
        return f"{self.row}, {self.column}"

    @property
    def label(self) -> str:
        """For rows: its flaw and its place."""
        return f"{self.flaw}: {self.place}" if self.flaw else self.place

    @property
    def name(self) -> str:
        """For messages."""
        return f"{self.axis}: {self.label}"


@dataclass(frozen=True)
class Axis:
    """A map: what its rows and columns are, and the cells on it."""

    name: str
    title: str
    rows: str
    columns: str
    cells: Callable[[], list[Cell]]
