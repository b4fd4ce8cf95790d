"""The cells of the stress test as data: what is solved, and where its outcome stands in which map.

Bodies are meridians: thick tubes and spheres with exact answers, and a bellows of two convolutions
(scenes/smoke-t2-ri5.toml) that is compared with itself on fine meshes.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, Literal

from analytical.laws.isotropic import Law, Ogden
from analytical.laws.silicones import DRAGON_SKIN_10, dragon_skin_30
from meshes.cells import CellKind

Control = Literal["auto", "pressure", "volume"]
# How a cell departs from the solver on purpose: unsplit energy, or elements with too many pressures.
Flaw = Literal["", "raw energy", "equal order"]

SCENE = "smoke-t2-ri5"
DRAGON_SKIN_30 = dragon_skin_30("2mu/alpha^2")
MU_MPA = DRAGON_SKIN_30.mu_mpa


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

    kind: Literal["tube", "sphere"]
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
        Asked pressure in the cavity; negative is a vacuum. Round bodies, which are incompressible then, take that as a
        pressure from outside: the state is the same.
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
    def name(self) -> str:
        """For rows and messages."""
        return f"{self.row}, {self.column}"


@dataclass(frozen=True)
class Axis:
    """A map: what its rows and columns are."""

    name: str
    title: str
    rows: str
    columns: str


AXES = (
    Axis("kappa", "Bulk modulus and element", "body and element", "κ/µ"),
    Axis("wall", "Wall and pressure, bellows", "wall, mm (half pitch, mm)", "pressure, kPa"),
    Axis("wall-exact", "Wall and pressure, exact bodies", "body, wall mm", "pressure, kPa"),
    Axis("noise", "Nodes shaken at random", "body and cells", "largest move, share of an edge"),
    Axis("zigzag", "Distorted rows of cells", "body and cells", "move, share of an edge"),
    Axis("aspect", "Aspect ratio of the cells", "body and cells", "length over thickness of a cell"),
    Axis("leap", "Load in one step", "body and control", "load, multiple of the usual"),
    Axis("vacuum", "Vacuum and wall, exact bodies", "body, wall mm", "vacuum, kPa"),
    Axis("vacuum-bellows", "Vacuum and wall, bellows", "wall, mm", "vacuum, kPa"),
    Axis("alpha", "Ogden's exponent and pressure", "body and α", "pressure over µ"),
    Axis("contrast", "Stiffness of the rings and wall", "wall, mm", "Young's modulus of the rings over the silicone's"),
    Axis("edge", "Edges of rings and bonds", "edge and meridian level", "ring's edge radius or bond's grading, mm"),
    Axis("ranks", "Ranks and threads", "body and cells", "ranks × threads"),
    Axis("tolerance", "Tolerance of Newton's method", "body and cells", "relative tolerance"),
    Axis("input", "Input that must be refused", "what", "value"),
)

QUADS, TRIS = "quadrilaterals", "triangles"
_SHORT: dict[str, str] = {QUADS: "quads", TRIS: "triangles"}
BODIES = tuple(
    (f"{kind}, {_SHORT[cells]}", Round(kind, cells=cells))  # type: ignore[arg-type]
    for kind in ("tube", "sphere")
    for cells in (QUADS, TRIS)
)


def cells() -> tuple[Cell, ...]:
    """All cells of the product."""
    return (
        *_kappa(), *_wall(), *_wall_exact(), *_noise(), *_zigzag(), *_aspect(), *_leap(), *_vacuum(), *_alpha(),
        *_contrast(), *_edge(), *_ranks(), *_tolerance(), *_input(),
    )  # fmt: skip


def _kappa() -> list[Cell]:
    bodies = [*BODIES]
    bodies += [
        (f"{kind}, triangles P2/P0", Round(kind, cells="triangles", element="P2/P0", through=8, along=12))  # type: ignore[arg-type]
        for kind in ("tube", "sphere")
    ]
    return [
        Cell("kappa", name, f"{ratio:g}".replace("inf", "∞"), dataclasses.replace(body, kappa_over_mu=ratio), 20.0)
        for name, body in bodies
        for ratio in (1e2, 1e3, 1e4, 1e5, 1e6, math.inf)
    ]


def _wall() -> list[Cell]:
    walls = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0)
    return [
        Cell("wall", f"{wall:g} ({pitch:g})", f"{kpa:g}",
             Bellows((("geometry.wall_mm", wall), ("geometry.half_pitch_mm", pitch))), kpa)
        for pitch in (5.0, 7.0)
        for wall in walls
        for kpa in (2.5, 5.0, 10.0, 20.0, 40.0, 60.0)
    ]  # fmt: skip


def _wall_exact() -> list[Cell]:
    return [
        Cell("wall-exact", f"{kind}, {wall:g}", f"{kpa:g}", Round(kind, wall_mm=wall), kpa)  # type: ignore[arg-type]
        for kind in ("tube", "sphere")
        for wall in (0.25, 0.5, 1.0, 2.0, 3.0)
        for kpa in (2.5, 5.0, 10.0, 15.0, 20.0)
    ]


def _noise() -> list[Cell]:
    shares = (0.0, 0.1, 0.2, 0.3, 0.4, 0.6, 1.0)
    out = [
        Cell("noise", name, f"{share:g}", dataclasses.replace(body, noise=share, seed=seed), 20.0)
        for seed, (name, body) in enumerate(BODIES)
        for share in shares
    ]
    for seed, element in enumerate(("hex", "tet")):
        name = "bellows, " + _SHORT[QUADS if element == "hex" else TRIS]
        for share in shares:
            body = Bellows((("mesh.element", element),), level=2, noise=share, seed=10 + seed)
            out.append(Cell("noise", name, f"{share:g}", body, 10.0))
    return out


def _zigzag() -> list[Cell]:
    return [
        Cell("zigzag", name, f"{share:g}", dataclasses.replace(body, zigzag=share), 20.0)
        for name, body in BODIES
        for share in (0.0, 0.1, 0.2, 0.3, 0.4, 0.6)
    ]


def _aspect() -> list[Cell]:
    out = []
    for name, body in BODIES:
        for ratio in (0.1, 1.0, 3.0, 10.0, 30.0, 100.0):
            if body.kind == "tube":
                shaped = dataclasses.replace(body, along=2, length_mm=ratio * body.wall_mm / body.through * 2)
            else:
                # twelve cells from equator to pole: the wall decides their shape, down to a membrane
                arc = 0.5 * math.pi * body.inner_mm / 12
                wall = min(2.0 * arc / ratio, 5.0)
                shaped = dataclasses.replace(body, along=12, through=2, wall_mm=wall)
                if ratio < 1.0:
                    shaped = dataclasses.replace(shaped, along=40, through=max(2, round(ratio * 40)))
            # the load scales with the wall, so that all stretch alike
            kpa = 20.0 if body.kind == "tube" else 10.0 * shaped.wall_mm
            out.append(Cell("aspect", name, f"{ratio:g}", shaped, kpa))
    for ratio in (0.1, 1.0, 3.0, 10.0, 30.0, 100.0):
        through = max(1, min(round(1.5 * ratio), 40))
        body_b = Bellows((), cell_mm=2.0 / through * ratio if ratio > 1.0 else 1.0, through=through)
        if ratio < 1.0:
            body_b = Bellows((), cell_mm=0.1, through=2)
        out.append(Cell("aspect", "bellows, quads", f"{ratio:g}", body_b, 10.0))
    return out


def _leap() -> list[Cell]:
    bodies: list[tuple[str, Round | Bellows, float]] = [(name, body, 10.0) for name, body in BODIES]
    bodies += [("bellows, quads", Bellows(), 5.0)]
    controls: tuple[Control, ...] = ("auto", "pressure", "volume")
    return [
        Cell("leap", f"{name}, {control}", f"{factor:g}", body, factor * kpa, control, leap=factor)
        for name, body, kpa in bodies
        for control in controls
        for factor in (1, 2, 3, 5, 7, 10)
    ]


def _vacuum() -> list[Cell]:
    out = [
        Cell("vacuum", f"{kind}, {wall:g}", f"{kpa:g}", Round(kind, wall_mm=wall), -kpa)  # type: ignore[arg-type]
        for kind in ("tube", "sphere")
        for wall in (0.25, 0.5, 1.0, 2.0, 3.0)
        for kpa in (2.0, 5.0, 10.0, 20.0, 50.0)
    ]
    for wall in (0.5, 0.75, 1.0, 1.5, 2.0):
        for kpa in (0.02, 0.05, 0.1, 0.2, 0.5, 1.0):
            body = Bellows((("geometry.wall_mm", wall),), level=2)
            out.append(Cell("vacuum-bellows", f"{wall:g}", f"{kpa:g}", body, -kpa))
    return out


def _alpha() -> list[Cell]:
    return [
        Cell("alpha", f"{kind}, {alpha:g}", f"{share:g}",
             Round(kind, Ogden(MU_MPA, alpha, "2mu/alpha^2")), 1e3 * share * MU_MPA)  # type: ignore[arg-type]
        for kind in ("tube", "sphere")
        for alpha in (-5.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.5, 5.836, 8.0, 12.0)
        for share in (0.1, 0.2, 0.4, 0.6, 1.0)
    ]  # fmt: skip


def _contrast() -> list[Cell]:
    return [
        Cell("contrast", f"{wall:g}", f"{ratio:g}", Bellows(_meshed(wall), contrast=ratio), 10.0)
        for wall in (0.75, 1.0, 1.5, 2.0)
        for ratio in (1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6)
    ]


def _meshed(wall_mm: float, edge_mm: float = 0.5) -> tuple[tuple[str, Any], ...]:
    return (
        ("geometry.wall_mm", wall_mm),
        ("rings.model", "meshed"),
        ("rings.edge_radius_mm", edge_mm),
        ("mesh.element", "tet"),
    )


def _edge() -> list[Cell]:
    out = []
    for level in (1, 2, 3):
        for edge in (0.0, 0.1, 0.25, 0.5, 1.0, 2.0):
            out.append(Cell("edge", f"ring rounded, r{level}", f"{edge:g}", Bellows(_meshed(1.0, edge), level), 20.0))
        for grading in (0.0, 0.25, 0.5, 1.0, 2.0):
            bond = (
                ("geometry.wall_mm", 1.0),
                ("rings.model", "rigid"),
                ("rings.bond", "adhesive"),
                ("rings.bond_grading_mm", grading),
            )
            out.append(Cell("edge", f"bond graded, r{level}", f"{grading:g}", Bellows(bond, level), 20.0))
    return out


def _ranks() -> list[Cell]:
    bodies: list[tuple[str, Round | Bellows, float]] = [(name, body, 20.0) for name, body in BODIES]
    bodies += [("bellows, quads", Bellows(), 10.0), ("bellows, triangles", Bellows((("mesh.element", "tet"),)), 10.0)]
    return [
        Cell("ranks", name, f"{ranks} × {threads}", body, kpa, ranks=ranks, threads=threads)
        for name, body, kpa in bodies
        for ranks, threads in ((1, 1), (1, 2), (2, 1), (2, 2), (3, 1), (4, 1))
    ]


def _tolerance() -> list[Cell]:
    bodies: list[tuple[str, Round | Bellows, float]] = [(name, body, 20.0) for name, body in BODIES]
    bodies += [("bellows, quads", Bellows(), 10.0)]
    return [
        Cell("tolerance", name, f"{tolerance:.0e}", body, kpa, tolerance=tolerance)
        for name, body, kpa in bodies
        for tolerance in (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
    ]


def _input() -> list[Cell]:
    """Values of scene keys beside good ones; the first of each row is good."""
    asked: dict[str, tuple[Any, ...]] = {
        "geometry.wall_mm": (2.0, 0.0, -1.0, 3.0, math.nan),
        "geometry.fillet_mm": (0.5, 0.0, -0.5, 2.0, 50.0),
        "load.pressure_kpa": ((10.0,), (0.0,), (-5.0, 5.0), (10.0, 5.0), (5000.0,)),
        "material.kappa_over_mu": (1000.0, 0.0, -100.0, 1.0, 10.0),
        "material.alpha": (5.836, 0.0, 25.0, "six", -30.0),
        "rings.edge_radius_mm": (0.5, -0.1, 2.5, 5.0, math.nan),
        "mesh.element": ("tet", "tet-p1", "P1/P1", "P2/P2", ""),
    }
    out = []
    for key, values in asked.items():
        ring = (("mesh.element", "tet"), ("rings.model", "meshed")) if key.startswith("rings") else ()
        for place, value in enumerate(values):
            column = f"bad {place}" if place else "good"
            out.append(Cell("input", key, column, Bellows((*ring, (key, value))), 10.0))
    return out


def controls() -> tuple[tuple[Cell, Cell], ...]:
    """Pairs of a control, which must fail, and the same cell without its flaw."""
    sound = [
        Cell("control", name, "κ/µ = 100", dataclasses.replace(body, kappa_over_mu=100.0), 20.0, flaw="raw energy")
        for name, body in BODIES
    ]
    for wall in (1.0, 2.0):
        for kpa in (20.0, 30.0):
            bare = Bellows((("geometry.wall_mm", wall), ("rings.model", "none")))
            sound.append(Cell("control", f"bellows without rings, wall {wall:g} mm", f"{kpa:g} kPa", bare, kpa,
                              flaw="raw energy"))  # fmt: skip
    sound += [Cell("control", name, "incompressible", body, 20.0, flaw="equal order") for name, body in BODIES]
    return tuple((cell, dataclasses.replace(cell, flaw="")) for cell in sound)
