"""From a scene of a bellows to its meshes: the meridian, and the body or the sector of it made from one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

from meshes.cells import CellKind
from meshes.eccentric import shift_core
from meshes.errors import GeometryError
from meshes.meridian import Resolution, default_resolution, meridian_mesh
from meshes.revolve import revolve
from meshes.solid import SolidMesh
from meshes.sweep import FULL_CIRCLE, revolve_hexahedra
from studies.scene.bellows import BellowsScene, in_hexahedra, ring_shape, shape_of

# What a body is solved on: itself, the half above its plane of symmetry y = 0, the quarter that x = 0 cuts off that.
Part = Literal["full3d", "half", "sector"]
SECTORS: Mapping[str, int] = {"full3d": 1, "half": 2, "sector": 4}
# What is said of a body that is solved on a part, and of one that is not, with the reason.
_ITSELF = '(mesh.symmetry = "off" solves the whole itself)'
ON_A_PART: Mapping[str, str] = {
    "sector": "three quarters of the body: the whole is solved on a quarter between two planes of symmetry, and its "
    f"unstable modes are counted by parity classes, SS + 2 SA + AA {_ITSELF}",
    "half": "half of the body: the whole is solved on one side of its plane of symmetry, and its unstable modes are "
    f"counted by parity classes, S + A {_ITSELF}",
}
AS_A_WHOLE = "planes of symmetry: the whole body is solved, "
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
    """How often cells at the seats' edges are cut: not with meshed rings, nor on adhesive that does not fade out.

    Nor in a zigzag, whose sharp folds strain the small cells so far that steps fail by the hundred.
    """
    rings, wall = scene.rings, scene.geometry.wall_mm
    if (
        scene.geometry.profile == "zigzag"
        or rings.model != "rigid"
        or (rings.bond == "adhesive" and rings.bond_grading_mm == 0.0)
    ):
        return 0
    cuts = next((cuts for thickest, cuts in EDGE_CUTS if wall <= thickest), 0)
    return max(0, cuts - (kind == "triangles"))


def scene_meridian(scene: BellowsScene, refinement: int) -> SolidMesh:
    """The meridian mesh of a scene at a refinement."""
    ring = ring_shape(scene) if scene.rings.model == "meshed" else None
    return meridian_mesh(shape_of(scene), scene_resolution(scene, refinement), ring, cell_kind(scene))


def quarters(scene: BellowsScene) -> int:
    """Of what number the cells round must be a multiple for the body to be four images of a quarter.

    Cells of a cap meet on its axis in pairs.
    """
    return 8 if scene.geometry.tip == "cap" else 4


def solved_part(scene: BellowsScene, around: int) -> tuple[Part, str]:
    """What full 3D is solved on, and why if that is the whole body.

    A core that is off the axis leaves one plane of symmetry of two.

    Parameters
    ----------
    around
        Cells in the whole circle.
    """
    if scene.mesh.symmetry == "off":
        return "full3d", 'mesh.symmetry = "off"'
    if not in_hexahedra(scene):
        return "full3d", "a part is meshed in hexahedra"
    if scene.mesh.solver == "iterative":
        return "full3d", "the iterative solver is for whole bodies"
    if around % quarters(scene):
        return "full3d", f"{around} cells round are no multiple of {quarters(scene)}"
    return ("half" if scene.geometry.eccentricity else "sector"), ""


def symmetry_note(scene: BellowsScene, around: int) -> str:
    """What full 3D is solved on, and why; a sentence of what is left out."""
    part, why = solved_part(scene, around)
    return AS_A_WHOLE + why if why else ON_A_PART[part]


def scene_body(meridian: SolidMesh, model: str, around: int, core_shift_mm: float = 0.0) -> SolidMesh:
    """The body, or the sector of it, made from a meridian; ``around`` counts the cells in the whole circle.

    Raises
    ------
    GeometryError
        If the cells do not share out to the sector, or the core is shifted in a quarter.
    """
    parts = SECTORS[model]
    if core_shift_mm:
        if model == "sector":
            raise GeometryError("a sector of a body whose core is off the axis: take full3d")
        return shift_core(scene_body(meridian, model, around), meridian, core_shift_mm)
    if meridian.cell.name != "quadrilateral" and parts > 1:
        raise GeometryError('a sector is meshed in hexahedra: set mesh.element = "hex"')
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
