"""What the peer study runs, as data: codes, cells, meshes and settings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from studies.peers.exchange import Cells, Level
from studies.results import provenance
from studies.scene.bellows import BellowsScene
from studies.scene.load import load_bellows

SCENE: Final = provenance.ROOT / "scenes" / "peers" / "bellows.toml"
SCRIPTS: Final = provenance.ROOT / "studies" / "peers"
OURS: Final = "ours"


@dataclass(frozen=True)
class Attempt:
    """A run to be made.

    Attributes
    ----------
    code
        ``calculix``, ``ngsolve``, ``felupe``, ``dolfinx_tutorial``, ``dolfinx_tutorial_default_blas``, or ``ours``.
    dimension
        2 for axisymmetric, 3 for full 3D.
    label
        Mesh and setting.
    level
        The peer's mesh; None for ours.
    options
        The script's options; of ours: model, element, rings, tolerance, ranks.
    """

    code: str
    dimension: int
    label: str
    level: Level | None
    options: dict[str, Any]

    @property
    def name(self) -> str:
        """For messages."""
        return f"{self.code} {self.label}"

    @property
    def size(self) -> int:
        """By what the runs of a dimension are put in order; ours come first."""
        return self.level.meridian * max(1, self.level.around) if self.level else 0

    @property
    def family(self) -> str:
        """What is alike in runs that differ in their mesh only; ours, which choose theirs, in tolerance and ranks."""
        if self.level is None:
            return f"{self.code} {self.dimension} {self.options['element']}"
        return f"{self.code} {self.level.cells} {self.quarter} {self.options}"

    @property
    def quarter(self) -> bool:
        """True for a peer's run on a quarter of the body."""
        return self.level is not None and self.level.quarter


# Meridian and cells round, from coarse to fine, for each kind of cells.
_MESHES: Final[Mapping[Cells, tuple[tuple[int, int], ...]]] = {
    "tet10": ((1, 8), (1, 12), (2, 12)),
    "hex27": ((1, 8), (1, 12), (2, 12)),
    "tri6": ((1, 0), (2, 0), (4, 0)),
    "quad9": ((1, 0), (2, 0), (4, 0)),
}
# The bellows has two planes of symmetry: what a peer's user can have who cuts the mesh and holds the planes.
_QUARTERS: Final = ((1, 8), (1, 16), (2, 16))
_ON_A_QUARTER: Final = ("ngsolve", "dolfinx_tutorial")
_TUTORIAL: Final = ({"steps": 5}, {"steps": 10})
_NGSOLVE: Final = ({"first": 0.25, "predict": False}, {"first": 0.1, "predict": True})
_FELUPE: Final = (
    {"formulation": "mean", "first": 0.1},
    {"formulation": "mixed", "first": 0.1},
    {"formulation": "mixed", "first": 0.2},
)
# By code and cells, the options of its script.
_SETTINGS: Final[Mapping[str, Mapping[Cells, tuple[dict[str, Any], ...]]]] = {
    "calculix": {
        "hex27": ({"first": 0.05}, {"first": 0.25}),
        "tet10": ({"first": 0.25},),
        "quad9": ({"first": 0.05}, {"first": 0.25}),
        "tri6": ({"first": 0.25},),
    },
    "ngsolve": {
        "hex27": _NGSOLVE,
        "tet10": _NGSOLVE,
        "tri6": (*_NGSOLVE, {"order": 3, "first": 0.1}),
    },
    "felupe": {"hex27": _FELUPE, "quad9": _FELUPE},
    "dolfinx_tutorial": {"hex27": _TUTORIAL, "tet10": _TUTORIAL, "tri6": _TUTORIAL},
    "dolfinx_tutorial_default_blas": {
        "hex27": _TUTORIAL[:1],
        "tet10": _TUTORIAL[:1],
        "tri6": _TUTORIAL[:1],
    },
}
PEERS: Final = tuple(_SETTINGS)


def _ours(model: str, element: str, rings: str, tolerance: float, ranks: int) -> Attempt:
    """A run by this program: axisymmetric if no model is forced."""
    named = f", {ranks} rank{'s' * (ranks - 1)}" if model else ""
    label = f"{element}, {rings} rings, tolerance {tolerance:g} %{named}"
    options = {"model": model, "rings": rings, "element": element, "tolerance": tolerance, "ranks": ranks}
    return Attempt(OURS, 3 if model else 2, label, None, options)


_OF_OURS: Final = (
    _ours("", "hex", "rigid", 1.0, 1),
    _ours("full3d", "hex", "rigid", 1.0, 2),
    _ours("full3d", "hex", "rigid", 1.0, 1),
    _ours("", "hex", "rigid", 0.1, 1),
    _ours("full3d", "hex", "rigid", 0.1, 2),
    _ours("full3d", "hex", "rigid", 0.1, 1),
    _ours("", "hex", "meshed", 1.0, 1),
    _ours("", "hex", "meshed", 0.1, 1),
    _ours("full3d", "hex", "meshed", 1.0, 1),
    _ours("full3d", "hex", "meshed", 0.1, 1),
    _ours("full3d", "hex", "meshed", 0.1, 2),
    _ours("full3d", "tet", "meshed", 1.0, 2),
    _ours("", "tet", "meshed", 1.0, 1),
)


def attempts(levels: int = 3) -> list[Attempt]:
    """All runs on so many meshes of each kind, those of a dimension from coarse to fine."""
    found = [
        Attempt(code, 3 if level.around else 2, _label(level, options), level, options)
        for code, by_cells in _SETTINGS.items()
        for cells, settings in by_cells.items()
        for level in _meshes(cells)[:levels] + _quarters(code, cells)[:levels]
        for options in settings
    ]
    return sorted([*found, *_OF_OURS], key=lambda a: (a.dimension, a.size))


def _meshes(cells: Cells) -> list[Level]:
    return [Level(cells, meridian, around) for meridian, around in _MESHES[cells]]


def _quarters(code: str, cells: Cells) -> list[Level]:
    meshes = _QUARTERS if cells == "hex27" and code in _ON_A_QUARTER else ()
    return [Level(cells, meridian, around, quarter=True) for meridian, around in meshes]


def _label(level: Level, options: Mapping[str, Any]) -> str:
    return " ".join([level.name, *(f"{name}={value}" for name, value in options.items())])


def peer_scene() -> BellowsScene:
    """The problem, with meshed rings."""
    return load_bellows(SCENE)


def script_of(code: str) -> Path:
    """The script of a peer."""
    return SCRIPTS / ("dolfinx_tutorial.py" if code.startswith("dolfinx") else f"{code}_bellows.py")
