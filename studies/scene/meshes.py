"""From a scene of a bellows to its meshes: the meridian, and the body or the sector of it made from one."""

from __future__ import annotations

from dataclasses import replace

from meshes.cells import CellKind
from meshes.eccentric import shift_core
from meshes.errors import GeometryError
from meshes.meridian import Resolution, default_resolution, meridian_mesh
from meshes.revolve import revolve
from meshes.solid import SolidMesh
from meshes.sweep import FULL_CIRCLE, revolve_hexahedra
from studies.scene.bellows import BellowsScene, in_hexahedra, ring_shape, shape_of

# Sectors of one: the quarter, whose faces are the planes x = 0 and y = 0, held by components.
SECTORS = {"full3d": 1, "sector": 4}
# How often cells at a seat's edge are cut, by the thickest wall, mm; triangles, of which there are more through a wall,
# once less. Thicker walls are off by the rest of their mesh (docs/decisions.md, "Edges of the seats").
EDGE_CUTS = ((1.0, 2), (1.5, 1))


def cell_kind(scene: BellowsScene) -> CellKind:
    """Kind of the meridian's cells."""
    return "quadrilaterals" if in_hexahedra(scene) else "triangles"


def scene_resolution(scene: BellowsScene, refinement: int) -> Resolution:
    """Numbers of cells of the meridian at a refinement; small ones at the edges of the seats of rigid rings."""
    kind = cell_kind(scene)
    return replace(default_resolution(shape_of(scene), refinement, kind), edge_cuts=edge_cuts(scene, kind))


def edge_cuts(scene: BellowsScene, kind: CellKind) -> int:
    """How often cells at the seats' edges are cut: not with meshed rings, nor on adhesive that does not fade out."""
    rings, wall = scene.rings, scene.geometry.wall_mm
    if rings.model != "rigid" or (rings.bond == "adhesive" and rings.bond_grading_mm == 0.0):
        return 0
    cuts = next((cuts for thickest, cuts in EDGE_CUTS if wall <= thickest), 0)
    return max(0, cuts - (kind == "triangles"))


def scene_meridian(scene: BellowsScene, refinement: int) -> SolidMesh:
    """The meridian mesh of a scene at a refinement."""
    ring = ring_shape(scene) if scene.rings.model == "meshed" else None
    return meridian_mesh(shape_of(scene), scene_resolution(scene, refinement), ring, cell_kind(scene))


def scene_body(meridian: SolidMesh, model: str, around: int, core_shift_mm: float = 0.0) -> SolidMesh:
    """The body, or the sector of it, made from a meridian; ``around`` counts the cells in the whole circle.

    Raises
    ------
    GeometryError
        If the cells do not share out to the sector, or the core is shifted in one.
    """
    parts = SECTORS[model]
    if core_shift_mm:
        if parts > 1:
            raise GeometryError("a sector of a body whose core is off the axis: take full3d")
        return shift_core(scene_body(meridian, model, around), meridian, core_shift_mm)
    if meridian.cell.name != "quadrilateral" and parts > 1:
        raise GeometryError('a sector is meshed in hexahedra: set mesh.element = "hex" or "auto", and rigid rings')
    if around % parts:
        raise GeometryError(f"cells round the circumference = {around}: must be a multiple of {parts} in a sector")
    return revolved(meridian, around, parts)


def revolved(meridian: SolidMesh, around: int, parts: int = 1) -> SolidMesh:
    """A meridian's body of revolution, or one of so many sectors of it, which takes quadrilaterals.

    Parameters
    ----------
    around
        Cells in the whole circle.
    """
    if meridian.cell.name == "quadrilateral":
        return revolve_hexahedra(meridian, around // parts, FULL_CIRCLE / parts)
    return revolve(meridian, around)
