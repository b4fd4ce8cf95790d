"""The cells of the stress test as data: what is solved, and where its outcome stands in which map."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import Any

from analytical.laws.isotropic import Ogden
from analytical.laws.silicones import dragon_skin_30
from meshes.cells import CellKind
from studies.stability.cells import Axis, Bellows, Cell, Control, Kind, Round

MU_MPA = dragon_skin_30("2mu/alpha^2").mu_mpa
# Where controls stand, which are no part of the product.
CONTROL = "control"

KINDS: tuple[Kind, ...] = ("tube", "sphere")
CELLS: tuple[CellKind, ...] = ("quadrilaterals", "triangles")
BODIES = {
    f"{kind}, {cells.replace('quadrilaterals', 'quads')}": Round(kind, cells=cells) for kind in KINDS for cells in CELLS
}
SHARES = (0.0, 0.1, 0.2, 0.3, 0.4, 0.6)
ASPECTS = (0.1, 1.0, 3.0, 10.0, 30.0, 100.0)


def _walled(wall_mm: float, *more: tuple[str, Any], level: int = 1, contrast: float | None = None) -> Bellows:
    """The bellows with another wall, and with more changes of its scene."""
    return Bellows((("geometry.wall_mm", wall_mm), *more), level, contrast)


def _meshed(edge_mm: float = 0.5) -> tuple[tuple[str, Any], ...]:
    """Changes of a scene whose rings are meshed."""
    return ("rings.model", "meshed"), ("rings.edge_radius_mm", edge_mm), ("mesh.element", "tet")


def _with_bellows(round_kpa: float, bellows_kpa: float) -> list[tuple[str, Round | Bellows, float]]:
    """Name, body and load of the round bodies and of the bellows."""
    return [*((name, body, round_kpa) for name, body in BODIES.items()), ("bellows, quads", Bellows(), bellows_kpa)]


def _kappa() -> list[Cell]:
    special = {
        f"{kind}, triangles P2/P0": Round(kind, cells="triangles", element="P2/P0", through=8, along=12)
        for kind in KINDS
    }
    return [
        Cell("kappa", name, f"{ratio:g}".replace("inf", "∞"), replace(body, kappa_over_mu=ratio), 20.0)
        for name, body in (BODIES | special).items()
        for ratio in (1e2, 1e3, 1e4, 1e5, 1e6, math.inf)
    ]


def _wall() -> list[Cell]:
    return [
        Cell("wall", f"{wall:g} ({pitch:g})", f"{kpa:g}", _walled(wall, ("geometry.half_pitch_mm", pitch)), kpa)
        for pitch in (5.0, 7.0)
        for wall in (0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0)
        for kpa in (2.5, 5.0, 10.0, 20.0, 40.0, 60.0)
    ]


def _wall_exact() -> list[Cell]:
    return [
        Cell("wall-exact", f"{kind}, {wall:g}", f"{kpa:g}", Round(kind, wall_mm=wall), kpa)
        for kind in KINDS
        for wall in (0.25, 0.5, 1.0, 2.0, 3.0)
        for kpa in (2.5, 5.0, 10.0, 15.0, 20.0)
    ]


def _noise() -> list[Cell]:
    shaken: list[tuple[str, Round | Bellows, float]] = [
        (name, replace(body, seed=seed), 20.0) for seed, (name, body) in enumerate(BODIES.items())
    ]
    shaken += [
        (f"bellows, {cells}", Bellows((("mesh.element", element),), level=2, seed=seed), 10.0)
        for seed, cells, element in ((10, "quads", "hex"), (11, "triangles", "tet"))
    ]
    return [
        Cell("noise", name, f"{share:g}", replace(body, noise=share), kpa)
        for name, body, kpa in shaken
        for share in (*SHARES, 1.0)
    ]


def _zigzag() -> list[Cell]:
    return [
        Cell("zigzag", name, f"{share:g}", replace(body, zigzag=share), 20.0)
        for name, body in BODIES.items()
        for share in SHARES
    ]


def _aspect() -> list[Cell]:
    found = []
    for name, body in BODIES.items():
        for ratio in ASPECTS:
            shaped = _stretched_tube(body, ratio) if body.kind == "tube" else _stretched_sphere(body, ratio)
            # the load scales with the wall, so that all stretch alike
            kpa = 20.0 if body.kind == "tube" else 10.0 * shaped.wall_mm
            found.append(Cell("aspect", name, f"{ratio:g}", shaped, kpa))
    return found + [Cell("aspect", "bellows, quads", f"{r:g}", _stretched_bellows(r), 10.0) for r in ASPECTS]


def _stretched_tube(body: Round, ratio: float) -> Round:
    return replace(body, along=2, length_mm=ratio * body.wall_mm / body.through * 2)


def _stretched_sphere(body: Round, ratio: float) -> Round:
    """Twelve cells from equator to pole: the wall decides their shape, down to a membrane."""
    arc = 0.5 * math.pi * body.inner_mm / 12
    shaped = replace(body, along=12, through=2, wall_mm=min(2.0 * arc / ratio, 5.0))
    return shaped if ratio >= 1.0 else replace(shaped, along=40, through=max(2, round(ratio * 40)))


def _stretched_bellows(ratio: float) -> Bellows:
    if ratio < 1.0:
        return Bellows(cell_mm=0.1, through=2)
    through = max(1, min(round(1.5 * ratio), 40))
    return Bellows(cell_mm=2.0 / through * ratio if ratio > 1.0 else 1.0, through=through)


def _leap() -> list[Cell]:
    controls: tuple[Control, ...] = ("auto", "pressure", "volume")
    return [
        Cell("leap", f"{name}, {control}", f"{factor:g}", body, factor * kpa, control, leap=factor)
        for name, body, kpa in _with_bellows(10.0, 5.0)
        for control in controls
        for factor in (1, 2, 3, 5, 7, 10)
    ]


def _vacuum() -> list[Cell]:
    return [
        Cell("vacuum", f"{kind}, {wall:g}", f"{kpa:g}", Round(kind, wall_mm=wall), -kpa)
        for kind in KINDS
        for wall in (0.25, 0.5, 1.0, 2.0, 3.0)
        for kpa in (2.0, 5.0, 10.0, 20.0, 50.0)
    ]


def _vacuum_bellows() -> list[Cell]:
    return [
        Cell("vacuum-bellows", f"{wall:g}", f"{kpa:g}", _walled(wall, level=2), -kpa)
        for wall in (0.5, 0.75, 1.0, 1.5, 2.0)
        for kpa in (0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
    ]


def _alpha() -> list[Cell]:
    laws = [Ogden(MU_MPA, alpha, "2mu/alpha^2") for alpha in (-5.0, -3.0, -2.0, -1.0, 1.0, 2.0, 3.5, 5.836, 8.0, 12.0)]
    return [
        Cell("alpha", f"{kind}, {law.alpha:g}", f"{share:g}", Round(kind, law), 1e3 * share * MU_MPA)
        for kind in KINDS
        for law in laws
        for share in (0.1, 0.2, 0.4, 0.6, 1.0)
    ]


def _contrast() -> list[Cell]:
    return [
        Cell("contrast", f"{wall:g}", f"{ratio:g}", _walled(wall, *_meshed(), contrast=ratio), 10.0)
        for wall in (0.75, 1.0, 1.5, 2.0)
        for ratio in (1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6)
    ]


def _edge() -> list[Cell]:
    bonded = ("rings.model", "rigid"), ("rings.bond", "adhesive")
    found = []
    for level in (1, 2, 3):
        for edge in (0.0, 0.1, 0.25, 0.5, 1.0, 2.0):
            body = _walled(1.0, *_meshed(edge), level=level)
            found.append(Cell("edge", f"ring rounded, r{level}", f"{edge:g}", body, 20.0))
        for grading in (0.0, 0.25, 0.5, 1.0, 2.0):
            body = _walled(1.0, *bonded, ("rings.bond_grading_mm", grading), level=level)
            found.append(Cell("edge", f"bond graded, r{level}", f"{grading:g}", body, 20.0))
    return found


def _ranks() -> list[Cell]:
    bodies = _with_bellows(20.0, 10.0)
    bodies += [("bellows, triangles", Bellows((("mesh.element", "tet"),)), 10.0)]
    return [
        Cell("ranks", name, f"{ranks} × {threads}", body, kpa, ranks=ranks, threads=threads)
        for name, body, kpa in bodies
        for ranks, threads in ((1, 1), (1, 2), (2, 1), (2, 2), (3, 1), (4, 1))
    ]


def _tolerance() -> list[Cell]:
    return [
        Cell("tolerance", name, f"{tolerance:.0e}", body, kpa, tolerance=tolerance)
        for name, body, kpa in _with_bellows(20.0, 10.0)
        for tolerance in (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
    ]


def _input() -> list[Cell]:
    """Values of scene keys beside good ones; the first of each row is good."""
    given: dict[str, tuple[Any, ...]] = {
        "geometry.wall_mm": (2.0, 0.0, -1.0, 3.0, math.nan),
        "geometry.fillet_mm": (0.5, 0.0, -0.5, 2.0, 50.0),
        "load.pressure_kpa": ((10.0,), (0.0,), (-5.0, 5.0), (10.0, 5.0), (5000.0,)),
        "material.kappa_over_mu": (1000.0, 0.0, -100.0, 1.0, 10.0),
        "material.alpha": (5.836, 0.0, 25.0, "six", -30.0),
        "rings.edge_radius_mm": (0.5, -0.1, 2.5, 5.0, math.nan),
        "mesh.element": ("tet", "tet-p1", "P1/P1", "P2/P2", ""),
    }
    found = []
    for key, values in given.items():
        ring = (("mesh.element", "tet"), ("rings.model", "meshed")) if key.startswith("rings") else ()
        for place, value in enumerate(values):
            column = f"bad {place}" if place else "good"
            found.append(Cell("input", key, column, Bellows((*ring, (key, value))), 10.0))
    return found


def controls() -> list[Cell]:
    """Controls, which must fail, each followed by the same cell without its flaw."""
    flawed = [
        Cell(CONTROL, name, "κ/µ = 100", replace(body, kappa_over_mu=100.0), 20.0, flaw="raw energy")
        for name, body in BODIES.items()
    ]
    for wall, kpa in itertools.product((1.0, 2.0), (20.0, 30.0)):
        bare, name = _walled(wall, ("rings.model", "none")), f"bellows without rings, wall {wall:g} mm"
        flawed.append(Cell(CONTROL, name, f"{kpa:g} kPa", bare, kpa, flaw="raw energy"))
    flawed += [Cell(CONTROL, name, "incompressible", body, 20.0, flaw="equal order") for name, body in BODIES.items()]
    return [cell for one in flawed for cell in (one, replace(one, flaw=""))]


AXES = (
    Axis("kappa", "Bulk modulus and element", "body and element", "κ/µ", _kappa),
    Axis("wall", "Wall and pressure, bellows", "wall, mm (half pitch, mm)", "pressure, kPa", _wall),
    Axis("wall-exact", "Wall and pressure, exact bodies", "body, wall mm", "pressure, kPa", _wall_exact),
    Axis("noise", "Nodes shaken at random", "body and cells", "largest move, share of an edge", _noise),
    Axis("zigzag", "Distorted rows of cells", "body and cells", "move, share of an edge", _zigzag),
    Axis("aspect", "Aspect ratio of the cells", "body and cells", "length over thickness of a cell", _aspect),
    Axis("leap", "Load in one step", "body and control", "load, multiple of the usual", _leap),
    Axis("vacuum", "Vacuum and wall, exact bodies", "body, wall mm", "vacuum, kPa", _vacuum),
    Axis("vacuum-bellows", "Vacuum and wall, bellows", "wall, mm", "vacuum, kPa", _vacuum_bellows),
    Axis("alpha", "Ogden's exponent and pressure", "body and α", "pressure over µ", _alpha),
    Axis(
        "contrast",
        "Stiffness of the rings and wall",
        "wall, mm",
        "Young's modulus of the rings over the silicone's",
        _contrast,
    ),
    Axis(
        "edge", "Edges of rings and bonds", "edge and meridian level", "ring's edge radius or bond's grading, mm", _edge
    ),
    Axis("ranks", "Ranks and threads", "body and cells", "ranks × threads", _ranks),
    Axis("tolerance", "Tolerance of Newton's method", "body and cells", "relative tolerance", _tolerance),
    Axis("input", "Input that must be refused", "what", "value", _input),
)


def product() -> list[Cell]:
    """All cells of the maps."""
    return [cell for axis in AXES for cell in axis.cells()]


def cases() -> list[Cell]:
    """All cells of the product, then the controls."""
    return [*product(), *controls()]
